//! Where straight lines end whose pen was not lifted there: square ends, and lines that the picture's rim
//! cuts.

use crate::segment_distance;

use plotter_vector::{Bitmap, Drawing, Pixel, PxPoint, Vectorizer};
use segment_distance::segment_distance;

/// What a raster of one bit explains, and half a pixel of tolerance.
const NEAR_PX: f64 = 1.0;

/// Angles of the lines: a little off the raster's own.
const ANGLES: u16 = 40;

/// The ends of a line of `length_px` around a place of a pixel near the picture's middle.
fn line(number: u16, side: u32, length_px: f64) -> [PxPoint; 2] {
    let angle = f64::from(number) * core::f64::consts::PI / f64::from(ANGLES) + 0.003;
    let off_px = |step: u16| f64::from(number * step % 8) / 8.0;
    let middle = f64::from(side) / 2.0;
    let (sin, cos) = libm::sincos(angle);
    [-0.5, 0.5].map(|part| {
        let along = part * length_px;
        PxPoint::new(middle + off_px(3) + along * cos, middle + off_px(5) + along * sin)
    })
}

/// The ink that is at most half the width from a line, and no farther along than its ends.
fn ink(side: u32, [from, to]: [PxPoint; 2], width_px: f64) -> Bitmap {
    let mut ink = Bitmap::new(side, side).unwrap();
    let length_px = from.distance(to);
    let (u, v) = ((to.x - from.x) / length_px, (to.y - from.y) / length_px);
    for at in (0..side).flat_map(|y| (0..side).map(move |x| Pixel::new(x, y))) {
        let place = PxPoint::from(at);
        let (x, y) = (place.x - from.x, place.y - from.y);
        let (along, across) = (x * u + y * v, x * v - y * u);
        ink.set(at, (0.0..=length_px).contains(&along) && across.abs() <= 0.5 * width_px);
    }
    ink
}

fn traced(ink: &Bitmap) -> Drawing {
    Vectorizer::default().trace(ink).unwrap().drawing
}

/// How far the ends of the only stroke are from a line's ends, and its vertices from the line, px.
fn off_px(found: &Drawing, [from, to]: [PxPoint; 2]) -> f64 {
    let stroke = found.stroke(0);
    let (first, last) = (*stroke.first().unwrap(), *stroke.last().unwrap());
    let ends = |one: PxPoint, other: PxPoint| first.distance(one).max(last.distance(other));
    let beside = stroke.iter().map(|at| segment_distance(*at, from, to)).fold(0.0, f64::max);
    ends(from, to).min(ends(to, from)).max(beside)
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_line_with_square_ends_is_one_stroke_that_ends_half_its_width_before_them() {
    for width_px in [6.0, 9.0, 12.0, 16.0] {
        let (mut vertices, mut wrong) = (0, Vec::new());
        for number in 0..ANGLES {
            const LENGTH_PX: f64 = 60.0;
            let found = traced(&ink(90, line(number, 90, LENGTH_PX), width_px));
            vertices += found.vertices();
            let off_px = off_px(&found, line(number, 90, LENGTH_PX - width_px));
            if found.strokes().len() != 1 || off_px > NEAR_PX {
                wrong.push((number, off_px, found));
            }
        }
        // The raster of one bit makes a fork of a single end, and a bend of some lines.
        assert!(wrong.len() <= 1, "{width_px} px wide: {wrong:?}");
        assert!(vertices <= usize::from(ANGLES) * 9 / 4, "{width_px} px wide: {vertices} vertices");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_line_that_the_rim_cuts_is_one_stroke_that_ends_on_it() {
    const SIDE: u32 = 150;
    for width_px in [3.0, 5.0, 9.0, 14.0] {
        for number in 0..ANGLES {
            let far = line(number, SIDE, 400.0);
            let corners = [(0.0, 0.0), (0.0, 150.0), (150.0, 0.0), (150.0, 150.0)];
            let is_near =
                |(x, y): (f64, f64)| segment_distance(PxPoint::new(x, y), far[0], far[1]) <= 1.5 * width_px;
            // Where two rims cut a line its end is neither's.
            if corners.into_iter().any(is_near) {
                continue;
            }
            let found = traced(&ink(SIDE, far, width_px));
            let name = format!("{width_px} px wide, line {number}: {found:?}");
            assert_eq!(found.strokes().len(), 1, "{name}");
            let stroke = found.stroke(0);
            let side = f64::from(SIDE);
            let rim_px = |at: &PxPoint| at.x.min(side - at.x).min(at.y).min(side - at.y);
            let ends = [stroke.first(), stroke.last()].map(|end| rim_px(end.unwrap()));
            let beside = stroke.iter().map(|at| segment_distance(*at, far[0], far[1])).fold(0.0, f64::max);
            assert!(ends.iter().all(|end_px| *end_px <= NEAR_PX), "{ends:?}, {name}");
            assert!(beside <= NEAR_PX, "{beside} px, {name}");
        }
    }
}
