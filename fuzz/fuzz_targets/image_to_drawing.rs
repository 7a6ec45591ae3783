//! Any bytes become an error, or a drawing within the picture.
#![no_main]

use libfuzzer_sys::fuzz_target;
use plotter_vector::{Algorithm, Vectorizer, decode};

fuzz_target!(|bytes: &[u8]| {
    if !plotter_fuzz::is_small(bytes) {
        return;
    }
    let Ok(gray) = decode(bytes) else { return };
    let (width, height) = (f64::from(gray.width()), f64::from(gray.height()));
    for algorithm in [Algorithm::Ours, Algorithm::Published] {
        let vectorizer = Vectorizer { algorithm, ..Vectorizer::default() };
        let traced = vectorizer.vectorize(&gray).expect("a small picture has few figures");
        for at in traced.drawing.strokes().flatten() {
            assert!(
                (0.0..=width).contains(&at.x) && (0.0..=height).contains(&at.y),
                "{at:?} in {width} x {height}"
            );
        }
        assert!(traced.error.max_px.is_finite());
    }
});
