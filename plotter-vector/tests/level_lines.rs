//! What a raster of one bit tells about the place of a line along its rows: `cargo test -p plotter-vector --test
//! level_lines -- --nocapture`.
#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "a failure shows, and places half a pixel apart are exact"
)]

use plotter_vector::{Bitmap, Pixel, Vectorizer};

const PEN_PX: f64 = 3.0;

/// Middle of a row of pixels.
const ROW_PX: f64 = 20.5;

/// What a pen leaves along a level line.
fn ink(y_px: f64) -> Bitmap {
    let mut ink = Bitmap::new(100, 40).unwrap();
    for (x, y) in (10..90).flat_map(|x| (0..40).map(move |y| (x, y))) {
        ink.set(Pixel::new(x, y), (f64::from(y) + 0.5 - y_px).abs() <= PEN_PX / 2.0);
    }
    ink
}

#[test]
fn a_level_line_is_known_to_half_a_pixel() {
    let (mut off_px, steps) = (0.0, 49);
    for step in -steps..=steps {
        let place_px = ROW_PX + 0.01 * f64::from(step);
        let ink = ink(place_px);
        // Wherever within the row the pen went, it left the same.
        assert_eq!(ink, self::ink(ROW_PX), "{place_px}");
        let drawing = Vectorizer::default().trace(&ink).unwrap().drawing;
        let line: Vec<f64> = drawing.strokes().flatten().map(|at| at.y).collect();
        // The middle is the guess that is never more than half a pixel off, and a quarter in the mean.
        assert_eq!(line, [ROW_PX; 2], "{place_px}");
        off_px += (place_px - ROW_PX).abs();
    }
    let mean_px = off_px / f64::from(2 * steps + 1);
    println!("a pen of {PEN_PX} px anywhere within a row: {mean_px:.3} px off in the mean, at best");
    assert!((mean_px - 0.25).abs() < 0.005);
}
