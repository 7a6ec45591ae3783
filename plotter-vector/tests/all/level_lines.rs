//! How precisely a raster of one bit tells the place of a line along its rows:
//! `cargo test -p plotter-vector --test level_lines -- --nocapture`.
#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "a failure shows, and places half a pixel apart are exact"
)]

use crate::segment_distance;

use plotter_vector::{Bitmap, Pixel, PxPoint, Vectorizer};
use segment_distance::segment_distance;

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

/// The same with round ends, from one place to another, either way along the axes.
fn round_ended(width_px: f64, [from, to]: [PxPoint; 2]) -> Bitmap {
    let mut ink = Bitmap::new(100, 100).unwrap();
    for at in (0..100).flat_map(|x| (0..100).map(move |y| Pixel::new(x, y))) {
        ink.set(at, segment_distance(at.into(), from, to) <= 0.5 * width_px);
    }
    ink
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn round_ends_tell_where_in_its_row_a_line_lies() {
    for (width_px, asked_px) in [(2.5, 0.11), (3.0, 0.13), (4.0, 0.13), (5.0, 0.13), (7.0, 0.13)] {
        let (mut off_px, mut middle_px, mut most_px, steps) = (0.0, 0.0, 0.0_f64, 40);
        for step in 0..steps {
            let part = |by: i32| f64::from(step * by % steps) / f64::from(steps);
            let (y_px, from_px, to_px) = (30.0 + part(1), 12.0 + part(7), 86.0 + part(11));
            for is_upright in [false, true] {
                let place = |x: f64| if is_upright { PxPoint::new(y_px, x) } else { PxPoint::new(x, y_px) };
                let ink = round_ended(width_px, [from_px, to_px].map(place));
                let middle = |ink: &Bitmap| {
                    let at = |v: u32| if is_upright { Pixel::new(v, 50) } else { Pixel::new(50, v) };
                    let rows: Vec<u32> = (0..100).filter(|v| ink.get(at(*v))).collect();
                    f64::midpoint(f64::from(rows[0]), f64::from(rows[rows.len() - 1] + 1))
                };
                let drawing = Vectorizer::default().trace(&ink).unwrap().drawing;
                let line: Vec<PxPoint> = drawing.strokes().flatten().copied().collect();
                let across = line.iter().map(|at| if is_upright { at.x } else { at.y });
                let across: Vec<f64> = across.collect();
                assert!(line.len() == 2 && across[0] == across[1], "level stays level: {line:?}");
                off_px += (across[0] - y_px).abs() / f64::from(2 * steps);
                most_px = most_px.max((across[0] - y_px).abs());
                middle_px += (middle(&ink) - y_px).abs() / f64::from(2 * steps);
            }
        }
        println!(
            "a pen of {width_px} px: {off_px:.3} px off in the mean ({most_px:.2} at most), the middle of its rows {middle_px:.3}"
        );
        assert!(off_px <= asked_px && most_px <= 0.5, "{width_px}: {off_px}, {most_px}");
    }
}
