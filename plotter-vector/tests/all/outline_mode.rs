//! Outlines of everything: of lines thinner than the pen as of areas, nothing is lost.
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small numbers")]

use crate::segment_distance;

use plotter_vector::{
    Bitmap, Drawing, Mode, Ours, Pixel, Progress, PxPoint, Vectorizer,
    areas::{AreaStyle, Areas},
    picture::BitmapRows,
};
use segment_distance::segment_distance;

/// Side of the field around each line, px.
const CELL: u32 = 60;
/// Directions of the lines.
const TURNS: u32 = 10;
const WIDTHS_PX: [f64; 6] = [1.0, 1.5, 2.0, 2.5, 3.0, 5.0];

fn pixels(width: u32, height: u32) -> impl Iterator<Item = Pixel> {
    (0..height).flat_map(move |y| (0..width).map(move |x| Pixel::new(x, y)))
}

/// Lines of each width in each direction, one in a field, and a filled square in the last column.
fn sheet() -> Bitmap {
    let mut ink = Bitmap::new(CELL * (WIDTHS_PX.len() as u32 + 1), CELL * TURNS).unwrap();
    for pixel in pixels(ink.width(), ink.height()) {
        let at = PxPoint::new(f64::from(pixel.x % CELL) + 0.5, f64::from(pixel.y % CELL) + 0.5);
        let is_ink = match WIDTHS_PX.get((pixel.x / CELL) as usize) {
            Some(width_px) => {
                let angle = std::f64::consts::PI * f64::from(pixel.y / CELL) / f64::from(TURNS);
                let (x, y) = (22.0 * angle.cos(), 22.0 * angle.sin());
                let (from, to) = (PxPoint::new(30.2 - x, 30.4 - y), PxPoint::new(30.2 + x, 30.4 + y));
                // A line of one pixel has no gaps.
                segment_distance(at, from, to) <= width_px.max(1.05) / 2.0
            }
            None => (at.x - 30.0).abs().max((at.y - 30.0).abs()) < 20.0 && pixel.y < CELL,
        };
        ink.set(pixel, is_ink);
    }
    ink
}

fn outlined(pen_px: f64) -> Ours {
    let areas = Areas::default().with_style(AreaStyle::Outline).with_pen_px(pen_px);
    Ours::default().with_mode(Mode::Outline).with_areas(areas)
}

/// Distance of a pixel from the nearest stroke, px.
fn distance(drawing: &Drawing, pixel: Pixel) -> f64 {
    let at = PxPoint::from(pixel);
    let each = |stroke: &[PxPoint]| {
        let dot = stroke.first().map_or(f64::INFINITY, |dot| at.distance(*dot));
        stroke.windows(2).map(|pair| segment_distance(at, pair[0], pair[1])).fold(dot, f64::min)
    };
    drawing.strokes().map(each).fold(f64::INFINITY, f64::min)
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn every_pixel_of_a_line_is_near_a_stroke() {
    let ink = sheet();
    for pen_px in [1.0, 3.0] {
        let traced = Vectorizer::from(outlined(pen_px)).trace(&ink).unwrap();
        let lines = pixels(CELL * WIDTHS_PX.len() as u32, ink.height()).filter(|pixel| ink.get(*pixel));
        for pixel in lines {
            let width_px = WIDTHS_PX[(pixel.x / CELL) as usize];
            let far_px = distance(&traced.drawing, pixel);
            assert!(far_px <= width_px / 2.0 + 1.0, "{far_px} px at {pixel:?}, {width_px} px, pen {pen_px}");
        }
    }
}

#[test]
fn a_square_is_its_outline_and_a_thin_line_one_stroke() {
    let traced = Vectorizer::from(outlined(1.0)).trace(&sheet()).unwrap();
    let in_field = |column: u32, row: u32| {
        let own = |at: &PxPoint| (at.x as u32 / CELL, at.y as u32 / CELL) == (column, row);
        traced.drawing.strokes().filter(|stroke| stroke.iter().all(own)).collect::<Vec<_>>()
    };
    let square = in_field(WIDTHS_PX.len() as u32, 0);
    assert!(square.len() == 1 && square[0].first() == square[0].last(), "{square:?}");
    for turn in 0..TURNS {
        let line = in_field(0, turn);
        assert!(line.len() == 1 && line[0].first() != line[0].last(), "{turn}: {line:?}");
        // What is wider than the pen is gone around, corners and all.
        for column in [4, 5] {
            let wide = in_field(column, turn);
            assert!(wide.len() == 1 && wide[0].first() == wide[0].last(), "{column}, {turn}: {wide:?}");
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn bands_change_nothing() {
    let ink = sheet();
    for pen_px in [0.0, 1.0, 3.0] {
        let whole = Vectorizer::from(outlined(pen_px)).trace(&ink).unwrap().drawing;
        for band_rows in [7, 64, 2048] {
            let settings = Vectorizer::from(outlined(pen_px).with_band_rows(band_rows));
            let sheet = settings.vectorize_rows(&mut BitmapRows::new(&ink), &mut Progress::silent()).unwrap();
            assert!(sheet.drawing == whole, "{band_rows} rows, pen {pen_px}");
        }
    }
}

/// A line of 4 px and a bar, one below the other.
fn line_and_bar(bar_px: u32) -> Bitmap {
    let mut ink = Bitmap::new(300, 120).unwrap();
    for pixel in pixels(300, 120).filter(|pixel| (20..280).contains(&pixel.x)) {
        ink.set(pixel, (20..24).contains(&pixel.y) || (50..50 + bar_px).contains(&pixel.y));
    }
    ink
}

#[test]
fn a_bar_four_times_as_wide_as_the_lines_is_an_area_where_both_are_mixed() {
    let closed = |mode, bar_px| {
        let areas = Areas::default().with_style(AreaStyle::Outline).with_pen_px(1.0);
        let traced = Vectorizer::from(Ours::default().with_mode(mode).with_areas(areas))
            .trace(&line_and_bar(bar_px))
            .unwrap();
        let drawing = traced.drawing;
        assert_eq!(drawing.strokes().len(), 2);
        drawing.strokes().filter(|stroke| stroke.first() == stroke.last()).count()
    };
    assert_eq!((closed(Mode::Centreline, 16), closed(Mode::Mixed, 16), closed(Mode::Outline, 16)), (0, 1, 2));
    assert_eq!((closed(Mode::Mixed, 8), closed(Mode::Centreline, 40)), (0, 1));
}

#[test]
fn what_is_too_narrow_for_a_wide_pen_is_followed() {
    // Round a bar of 16 px a pen of 30 px finds no way inside; nothing of it is lost.
    let areas = Areas::default().with_style(AreaStyle::Outline).with_pen_px(30.0);
    let traced = Vectorizer::from(Ours::default().with_mode(Mode::Mixed).with_areas(areas))
        .trace(&line_and_bar(16))
        .unwrap();
    let middle: Vec<f64> = traced.drawing.strokes().map(|stroke| stroke[0].y).collect();
    assert!(middle.len() == 2 && middle.iter().any(|y| (y - 58.0).abs() < 0.5), "{middle:?}");
}
