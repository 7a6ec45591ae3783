//! All strokes lie within the picture, whatever the picture.

use crate::law_cases::cases;
use plotter_vector::{
    Colour, Drawing, Gray, Mode, Ours, Progress, PxPoint, Vectorizer,
    areas::{AreaStyle, Areas, Hatch},
    ink::Pens,
    picture::GrayRows,
    stroke::Pieces,
};
use proptest::prelude::*;

/// All that strokes may be made of.
const PIECES: [Pieces; 3] = [Pieces::Lines, Pieces::Arcs, Pieces::Cubics];

/// What arcs and cubic curves may bulge over the border, px: a rounding.
const ROUNDING_PX: f64 = 1e-6;

/// How far the chords that stand for them may lie off, px.
const CHORD_ERROR_PX: f64 = 1e-3;

/// Noise of any density: of grey levels, of black and white, of a few levels, or of grey on white; or strokes
/// of it.
fn noise() -> impl Strategy<Value = Gray> {
    (1_usize..40, 1_usize..40, 0_u8..5, any::<u8>(), 1_usize..4)
        .prop_flat_map(|(width, height, kind, share, thick)| {
            let level = move |(dice, level): (u8, u8)| match kind {
                0 => level,
                1 if dice < share => 0,
                2 => [0, 64, 128, 200, 255][usize::from(level) % 5],
                3 if dice < share => level,
                4 if dice < share => level,
                4 => u8::MAX * (dice % 2),
                _ => u8::MAX,
            };
            let levels = prop::collection::vec(any::<(u8, u8)>().prop_map(level), width * height);
            (Just((width, height, thick)), levels)
        })
        .prop_map(|((width, height, thick), levels)| {
            // Each pixel as dark as the darkest of those left of and above it: lines wider than a pixel.
            let darkest = |x: usize, y: usize| {
                let rows = y.saturating_sub(thick - 1)..=y;
                let row = |y: usize| &levels[y * width + x.saturating_sub(thick - 1)..=y * width + x];
                *rows.flat_map(row).min().unwrap()
            };
            let levels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            let levels = levels.map(|(x, y)| darkest(x, y)).collect();
            Gray::new(u32::try_from(width).unwrap(), u32::try_from(height).unwrap(), levels).unwrap()
        })
}

fn vectorizers() -> impl Strategy<Value = Vectorizer> {
    let hatch = Hatch::default().with_pitch_px(2.0).with_angle_rad(0.7);
    let areas = Areas::default().with_style(AreaStyle::OutlineAndHatch(hatch)).with_pen_px(1.5);
    let hatched = Ours::default().with_mode(Mode::Mixed).with_max_line_px(3).with_areas(areas).into();
    let mode = prop::sample::select(vec![
        Vectorizer::default(),
        Vectorizer::from(Ours::default().with_mode(Mode::Outline)),
        hatched,
        Vectorizer::published(),
    ]);
    (mode, prop::sample::select(PIECES.to_vec()), prop::sample::select(vec![0.1, 0.5, 2.0])).prop_map(
        |(mut vectorizer, pieces, tolerance_px)| {
            if let Some(ours) = vectorizer.ours_mut() {
                *ours = ours.with_pieces(pieces).with_tolerance_px(tolerance_px);
            }
            vectorizer
        },
    )
}

/// The first place of a drawing that lies outside of its picture: vertices not even by a rounding, nor what
/// is no number.
fn outside(drawing: &Drawing) -> Option<PxPoint> {
    let (width, height) = (f64::from(drawing.width_px()), f64::from(drawing.height_px()));
    let beyond = |by_px: f64| {
        let inside = move |v: f64, side: f64| (-by_px..=side + by_px).contains(&v);
        move |at: &PxPoint| !(inside(at.x, width) && inside(at.y, height))
    };
    let on_its_way =
        |index| drawing.curve(index).chords(CHORD_ERROR_PX).into_iter().find(beyond(ROUNDING_PX));
    let vertex = drawing.strokes().flatten().copied().find(beyond(0.0));
    vertex.or_else(|| (0..drawing.strokes().len()).find_map(on_its_way))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    #[ignore = "long: .ci/run has it in release"]
    fn a_drawing_lies_within_its_picture(gray in noise(), vectorizer in vectorizers(), band_rows in 1_u32..40) {
        let traced = vectorizer.vectorize(&gray).unwrap();
        prop_assert_eq!(outside(&traced.drawing), None, "{:?}", vectorizer);
        prop_assert!(traced.error.max_px.is_finite());
        let mut by_bands = vectorizer;
        if let Some(ours) = by_bands.ours_mut() {
            ours.band_rows = band_rows;
        }
        let sheet = by_bands.vectorize_rows(&mut GrayRows::new(gray), &mut Progress::silent()).unwrap();
        prop_assert!(sheet.drawing == traced.drawing, "by bands of {band_rows} rows, {vectorizer:?}");
    }
}

proptest! {
    #![proptest_config(cases(40))]

    #[test]
    fn a_drawing_in_colour_lies_within_its_picture(red in noise(), vectorizer in vectorizers()) {
        // Green and blue are red from elsewhere.
        let levels = red.pixels();
        let at = |place: usize| levels[place % levels.len()];
        let pixels: Vec<u8> = (0..levels.len()).flat_map(|i| [at(i), at(3 * i + 7), at(5 * i + 1)]).collect();
        let picture = Colour::new(red.width(), red.height(), pixels).unwrap();
        let found = vectorizer.vectorize_colour(&picture, &Pens::Count(2)).unwrap();
        prop_assert_eq!(outside(&found.traced.drawing), None, "{:?}", vectorizer);
    }
}
