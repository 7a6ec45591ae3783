//! Any bytes become an error, or a drawing within the picture.
#![no_main]

use libfuzzer_sys::fuzz_target;
use plotter_vector::{Ours, Vectorizer, decode, stroke::Pieces};

/// What the ends of arcs and cubic curves may lie beyond the rim of the outermost pixels.
const ROUNDING_PX: f64 = 1e-6;

fuzz_target!(|bytes: &[u8]| {
    if !plotter_fuzz::is_small(bytes) {
        return;
    }
    let Ok(gray) = decode(bytes) else { return };
    let (width, height) = (f64::from(gray.width()), f64::from(gray.height()));
    let published = Vectorizer::published();
    let arcs = Vectorizer::from(Ours::default().with_pieces(Pieces::Arcs));
    let curves = Vectorizer::from(Ours::default().with_pieces(Pieces::Cubics));
    for vectorizer in [Vectorizer::default(), arcs, curves, published] {
        let traced = vectorizer.vectorize(&gray).expect("a small picture has few figures");
        for at in traced.drawing.strokes().flatten() {
            assert!(
                (-ROUNDING_PX..=width + ROUNDING_PX).contains(&at.x)
                    && (-ROUNDING_PX..=height + ROUNDING_PX).contains(&at.y),
                "{at:?} in {width} x {height}"
            );
        }
        assert!(traced.error.max_px.is_finite());
    }
});
