//! Sheets by rows: the same strokes as of the whole picture, whatever the bands and the threads.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "places on pictures of 900 px, and levels"
)]

use plotter_vector::{
    Bitmap, Drawing, Gray, Mode, Ours, Pixel, Progress, Threshold, ThresholdMethod, Vectorizer,
    areas::{AreaStyle, Areas, Hatch},
    ink::Polarity,
    picture::{BitmapRows, Depth, GrayRows, RowSource},
    report::{coverage, worst_pixel},
    stroke::Pieces,
};
use proptest::prelude::*;

const BANDS: [u32; 4] = [16, 64, 200, u32::MAX];
/// All that strokes may be made of.
const PIECES: [Pieces; 3] = [Pieces::Arcs, Pieces::Cubics, Pieces::Lines];

/// A stroke of a pen: from, to, px.
type Line = ((i32, i32), (i32, i32));

/// Lines and discs (lines of no length drawn by a wider pen) on a sheet of paper, as levels.
fn drawn(width: u32, height: u32, pen_px: f64, lines: &[Line]) -> Gray {
    let mut levels = vec![255_u8; (width * height) as usize];
    for &((x0, y0), (x1, y1)) in lines {
        let half = if (x0, y0) == (x1, y1) { 8.0 * pen_px } else { pen_px / 2.0 };
        let (x0, y0, x1, y1) = (f64::from(x0), f64::from(y0), f64::from(x1), f64::from(y1));
        let (dx, dy) = (x1 - x0, y1 - y0);
        let reach = half + 2.0;
        let rows = (y0.min(y1) - reach).max(0.0) as u32..((y0.max(y1) + reach).max(0.0) as u32).min(height);
        for y in rows {
            for x in (x0.min(x1) - reach).max(0.0) as u32..((x0.max(x1) + reach).max(0.0) as u32).min(width) {
                let (px, py) = (f64::from(x) + 0.5 - x0, f64::from(y) + 0.5 - y0);
                let t = ((px * dx + py * dy) / (dx * dx + dy * dy).max(1e-9)).clamp(0.0, 1.0);
                let cover = (half + 0.5 - libm::hypot(px - t * dx, py - t * dy)).clamp(0.0, 1.0);
                let level = &mut levels[(y * width + x) as usize];
                *level = (*level).min(255 - (250.0 * cover) as u8);
            }
        }
    }
    Gray::new(width, height, levels).unwrap()
}

fn ink_of(gray: &Gray) -> Bitmap {
    let mut ink = Bitmap::new(gray.width(), gray.height()).unwrap();
    for (y, row) in (0..).zip(gray.rows()) {
        (0..).zip(row).for_each(|(x, level)| ink.set(Pixel::new(x, y), *level < 128));
    }
    ink
}

/// A picture of 1 bit as levels: what a decoder makes of it.
fn levels_of(black: &Bitmap) -> Gray {
    let places = (0..black.height()).flat_map(|y| (0..black.width()).map(move |x| Pixel::new(x, y)));
    let levels = places.map(|at| if black.get(at) { 0 } else { 255 }).collect();
    Gray::new(black.width(), black.height(), levels).unwrap()
}

/// White where it was black.
fn inverted(picture: &Bitmap) -> Bitmap {
    let mut other = picture.clone();
    for at in (0..picture.height()).flat_map(|y| (0..picture.width()).map(move |x| Pixel::new(x, y))) {
        other.set(at, !picture.get(at));
    }
    other
}

/// By rows and whole the same: strokes, split, errors and the worst pixel.
fn assert_as_whole(vectorizer: Vectorizer, whole: &Gray, source: &mut impl RowSource) {
    let expected = vectorizer.vectorize(whole).unwrap();
    let sheet = vectorizer.vectorize_rows_with_errors(source, &mut Progress::silent()).unwrap();
    assert!(sheet.drawing == expected.drawing, "strokes, {vectorizer:?}");
    assert_eq!(sheet.split, expected.split);
    let errors = sheet.errors.clone().unwrap();
    assert_eq!(errors.report, expected.error, "{vectorizer:?}");
    assert_eq!(errors.beyond, expected.beyond, "{vectorizer:?}");
    let mut one_band = vectorizer;
    if let Some(ours) = one_band.ours_mut() {
        ours.band_rows = u32::MAX;
    }
    let at_once = one_band.vectorize_rows_with_errors(source, &mut Progress::silent()).unwrap();
    // Of ink that is wider than any line the strokes depend on the bands.
    if at_once.drawing == sheet.drawing {
        assert_eq!(sheet.errors, at_once.errors, "{vectorizer:?}");
    }
    let (ink, drawing) = (vectorizer.ink(whole), &expected.drawing);
    if coverage(&ink, drawing) == expected.error {
        // Nothing of it is an area.
        assert_eq!(errors.worst, worst_pixel(&ink, drawing), "{vectorizer:?}");
    }
    let worst_px = errors.worst.map_or(0.0, |(_, error_px)| error_px);
    assert_eq!(worst_px, errors.report.max_px, "{:?}", errors.report);
    let plain = vectorizer.vectorize_rows(source, &mut Progress::silent()).unwrap();
    assert_eq!((plain.errors, plain.drawing), (None, sheet.drawing));
}

fn by_rows(vectorizer: Vectorizer, source: &mut impl RowSource) -> Drawing {
    vectorizer.vectorize_rows(source, &mut Progress::silent()).unwrap().drawing
}

fn lines(width: i32, height: i32, count: usize) -> impl Strategy<Value = Vec<Line>> {
    let place = move || (-10..width + 10, -10..height + 10);
    prop::collection::vec(
        prop_oneof![9 => (place(), place()), 1 => place().prop_map(|place| (place, place))],
        1..count,
    )
}

/// Few cases, for each is a sheet in several bands; `PROPTEST_CASES` asks for more.
fn few() -> ProptestConfig {
    let asked = std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok());
    ProptestConfig { cases: asked.unwrap_or(5), max_shrink_iters: 60, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(few())]

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn bands_do_not_show(pen_px in 2.0..6.0_f64, lines in lines(200, 900, 10), mode in 0..3_usize, hatched: bool, pieces in prop::sample::select(PIECES.to_vec())) {
        let gray = drawn(200, 900, pen_px, &lines);
        let ink = ink_of(&gray);
        let mode = [Mode::Centreline, Mode::Outline, Mode::Mixed][mode];
        let style = if hatched { AreaStyle::OutlineAndHatch(Hatch::default()) } else { AreaStyle::Outline };
        let areas = Areas::default().with_style(style).with_pen_px(2.0);
        let ours = Ours::default().with_mode(mode).with_areas(areas).with_pieces(pieces);
        let whole = Vectorizer::from(ours.with_band_rows(u32::MAX));
        let expected = whole.trace(&ink).unwrap().drawing;
        let expected_grey = whole.vectorize(&gray).unwrap();
        for band_rows in BANDS {
            let vectorizer = Vectorizer::from(ours.with_band_rows(band_rows));
            prop_assert!(vectorizer.trace(&ink).unwrap().drawing == expected, "whole, {}", band_rows);
            prop_assert!(by_rows(vectorizer, &mut BitmapRows::new(&ink)) == expected, "{}", band_rows);
            let mut rows = GrayRows::new(gray.clone());
            prop_assert_eq!(rows.depth(), Depth::Grey8);
            let grey = vectorizer.vectorize_rows(&mut rows, &mut Progress::silent()).unwrap();
            prop_assert!(grey.drawing == expected_grey.drawing, "{}", band_rows);
            prop_assert_eq!(grey.split, expected_grey.split);
        }
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn long_strokes_are_cut_alike(
        ends in prop::collection::vec((10..90_i32, 0..9500_i32, 10..90_i32, 0..9500_i32), 1..4),
        ring in 0..4000_i32,
    ) {
        // Narrow and long; a frame, which is a ring, besides.
        let mut lines: Vec<Line> = ends.into_iter().map(|(x0, y0, x1, y1)| ((x0, y0), (x1, y1))).collect();
        let corners = [(12, ring), (88, ring), (88, ring + 5200), (12, ring + 5200), (12, ring)];
        lines.extend(corners.iter().zip(&corners[1..]).map(|(from, to)| (*from, *to)));
        let ink = ink_of(&drawn(100, 9500, 4.0, &lines));
        let ours = Ours::default();
        let whole = Vectorizer::from(ours.with_band_rows(u32::MAX));
        let expected = whole.trace(&ink).unwrap().drawing;
        for band_rows in [700, 2048, u32::MAX] {
            let vectorizer = Vectorizer::from(ours.with_band_rows(band_rows));
            prop_assert!(vectorizer.trace(&ink).unwrap().drawing == expected, "whole, {}", band_rows);
            prop_assert!(by_rows(vectorizer, &mut BitmapRows::new(&ink)) == expected, "{}", band_rows);
        }
    }

    #[test]
    #[ignore = "long: .ci/run has it in release"]
    fn noise_has_no_bands_either(seed: u64, density in 1..6_u32) {
        let mut ink = Bitmap::new(100, 260).unwrap();
        let mut random = seed | 1;
        for (x, y) in (0..260).flat_map(|y| (0..100).map(move |x| (x, y))) {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            if random % 40 < u64::from(density) {
                for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    ink.set(Pixel::new(x + dx, y + dy), true);
                }
            }
        }
        let pieces = PIECES[(seed % 3) as usize];
        let ours = Ours::default().with_tolerance_px(0.7).with_pieces(pieces);
        let whole = Vectorizer::from(ours.with_band_rows(u32::MAX));
        let expected = whole.trace(&ink).unwrap().drawing;
        for band_rows in BANDS {
            let vectorizer = Vectorizer::from(ours.with_band_rows(band_rows));
            prop_assert!(by_rows(vectorizer, &mut BitmapRows::new(&ink)) == expected, "{}", band_rows);
        }
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn errors_are_those_of_the_whole_picture(
        pen_px in 1.0..6.0_f64,
        lines in lines(200, 700, 8),
        dirt in prop::collection::vec((0..200_u32, 0..700_u32), 0..40),
        mode in 0..3_usize,
        pieces in prop::sample::select(PIECES.to_vec()),
    ) {
        let mut gray = drawn(200, 700, pen_px, &lines);
        let mut levels = gray.pixels().to_vec();
        dirt.iter().for_each(|(x, y)| levels[(y * 200 + x) as usize] ^= 0xff);
        gray = Gray::new(200, 700, levels).unwrap();
        let mode = [Mode::Centreline, Mode::Outline, Mode::Mixed][mode];
        for band_rows in BANDS {
            let vectorizer = Vectorizer::from(Ours::default().with_mode(mode).with_pieces(pieces).with_band_rows(band_rows));
            assert_as_whole(vectorizer, &gray, &mut GrayRows::new(gray.clone()));
        }
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn the_ink_of_1_bit_is_found_as_of_levels(
        pen_px in 1.0..6.0_f64,
        lines in lines(200, 500, 10),
        holes in prop::collection::vec((0..200_u32, 0..500_u32), 0..40),
        polarity in 0..3_usize,
        method in 0..5_usize,
        pieces in prop::sample::select(PIECES.to_vec()),
    ) {
        let mut black = ink_of(&drawn(200, 500, pen_px, &lines));
        holes.iter().for_each(|(x, y)| black.set(Pixel::new(*x, *y), (x + y) % 2 == 0));
        let polarity = [Polarity::Minority, Polarity::DarkInk, Polarity::LightInk][polarity];
        let level = ThresholdMethod::Level;
        let method = [ThresholdMethod::Otsu, ThresholdMethod::Adaptive, level(0), level(128), level(255)][method];
        let threshold = Threshold::default().with_polarity(polarity).with_method(method);
        let vectorizer = Vectorizer::from(Ours::default().with_pieces(pieces).with_band_rows(64)).with_threshold(threshold);
        for black in [inverted(&black), black] {
            assert_as_whole(vectorizer, &levels_of(&black), &mut BitmapRows::new(&black));
        }
    }
}

#[test]
fn white_lines_on_black_are_the_ink() {
    let lines = ink_of(&drawn(200, 300, 4.0, &[((20, 30), (180, 40)), ((100, 20), (90, 280))]));
    let dark =
        Vectorizer::default().vectorize_rows(&mut BitmapRows::new(&lines), &mut Progress::silent()).unwrap();
    let black = inverted(&lines);
    let light =
        Vectorizer::default().vectorize_rows(&mut BitmapRows::new(&black), &mut Progress::silent()).unwrap();
    assert_eq!((light.pen_px, light.ink_pixels), (Some(4), lines.count()));
    assert_eq!((dark.split.unwrap().ink_is_dark, light.split.unwrap().ink_is_dark), (true, false));
    assert_eq!(light.drawing, dark.drawing);
    assert_eq!(light.drawing.strokes().len(), 2);
}

#[test]
fn sheets_without_ink_are_empty_drawings_with_no_errors() {
    for (width, height) in [(0, 0), (0, 3), (3, 0), (1, 1), (1, 5000), (5000, 1), (70, 9)] {
        let white = Bitmap::new(width, height).unwrap();
        for bits in [inverted(&white), white] {
            assert_as_whole(Vectorizer::default(), &levels_of(&bits), &mut BitmapRows::new(&bits));
        }
    }
}

#[test]
fn the_published_algorithm_reports_its_own_errors() {
    let black = ink_of(&drawn(120, 200, 1.0, &[((10, 12), (110, 60)), ((20, 180), (60, 15))]));
    let vectorizer = Vectorizer::published();
    assert_as_whole(vectorizer, &levels_of(&black), &mut BitmapRows::new(&black));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_worst_place_of_a_thin_line_is_the_one_that_is_reported() {
    let holes = [(67, 222), (75, 178), (42, 254), (143, 468), (134, 438), (197, 359), (18, 380)];
    let mut black = ink_of(&drawn(200, 500, 1.0, &[((187, 208), (101, 265))]));
    holes.iter().for_each(|&(x, y)| black.set(Pixel::new(x, y), (x + y) % 2 == 0));
    let threshold = Threshold::default().with_polarity(Polarity::DarkInk);
    let vectorizer = Vectorizer::from(Ours::default().with_band_rows(64)).with_threshold(threshold);
    for black in [inverted(&black), black] {
        assert_as_whole(vectorizer, &levels_of(&black), &mut BitmapRows::new(&black));
    }
}
