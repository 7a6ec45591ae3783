//! Lines one pixel wide that cross: how many strokes they become, and how near these stay.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    reason = "a failure shows, and places are small"
)]

use crate::random;
use crate::segment_distance;

use plotter_vector::{Bitmap, Ours, Pixel, PxPoint, Vectorized, Vectorizer};
use random::Random;
use segment_distance::segment_distance;

const SIDE_PX: u32 = 300;

/// A straight line, from and to.
type Line = [PxPoint; 2];

fn place(random: &mut Random) -> PxPoint {
    let side = f64::from(SIDE_PX) - 16.0;
    PxPoint::new(8.0 + side * random.unit(), 8.0 + side * random.unit())
}

/// Forty straight lines of 100 px and more.
fn lines() -> Vec<Line> {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let line = std::iter::repeat_with(|| [place(&mut random), place(&mut random)]);
    line.filter(|[from, to]| from.distance(*to) >= 100.0).take(40).collect()
}

/// Ten lines across ten, turned by some degrees.
fn grid() -> Vec<Line> {
    let (sine, cosine) = (libm::sin(0.2), libm::cos(0.2));
    let at = |x: f64, y: f64| PxPoint::new(150.0 + x * cosine - y * sine, 150.0 + x * sine + y * cosine);
    let pair = |step: u32| {
        let across = 20.0 * f64::from(step) - 90.0;
        [[at(across, -100.0), at(across, 100.0)], [at(-100.0, across), at(100.0, across)]]
    };
    (0..10).flat_map(pair).collect()
}

/// A pixel for each step along the longer side of each line.
fn ink_of(lines: &[Line]) -> Bitmap {
    let mut ink = Bitmap::new(SIDE_PX, SIDE_PX).unwrap();
    for [from, to] in lines {
        let (dx, dy) = (to.x.floor() - from.x.floor(), to.y.floor() - from.y.floor());
        let steps = dx.abs().max(dy.abs()).max(1.0);
        for step in 0..=steps as u32 {
            let part = f64::from(step) / steps;
            let at = |from: f64, far: f64| (from.floor() + 0.5 + far * part).floor() as u32;
            ink.set(Pixel::new(at(from.x, dx), at(from.y, dy)), true);
        }
    }
    ink
}

fn traced(ink: &Bitmap, tolerance_px: f64) -> Vectorized {
    let vectorizer = Vectorizer::from(Ours::default().with_tolerance_px(tolerance_px));
    vectorizer.trace(ink).unwrap()
}

#[test]
fn lines_that_cross_are_mostly_one_stroke_each() {
    for (lines, strokes, vertices) in [(grid(), 20, 52), (lines(), 82, 572)] {
        let drawing = traced(&ink_of(&lines), 0.5).drawing;
        let found = (drawing.strokes().len(), drawing.vertices());
        assert!(found.0 <= strokes && found.1 <= vertices, "{found:?} of {}", lines.len());
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_way_over_a_crossing_keeps_the_promise_both_ways() {
    for ink in [ink_of(&lines()), ink_of(&grid())] {
        for tolerance_px in [0.5, 0.75, 1.0, 2.0] {
            let Vectorized { drawing, error, .. } = traced(&ink, tolerance_px);
            assert_eq!(error.pixels, ink.count());
            assert!(error.max_px <= tolerance_px + 1e-9);
            let segments: Vec<Line> = drawing
                .strokes()
                .flat_map(|stroke| stroke.windows(2))
                .map(|pair| [pair[0], pair[1]])
                .collect();
            let dots: Vec<PxPoint> =
                drawing.strokes().filter(|stroke| stroke.len() == 1).map(|dot| dot[0]).collect();
            for at in ink.ink().map(PxPoint::from) {
                let near = |[from, to]: &Line| segment_distance(at, *from, *to) <= tolerance_px + 1e-9;
                assert!(segments.iter().any(near) || dots.contains(&at), "{at:?} at {tolerance_px} px");
            }
            // Between the middles of two pixels of a diagonal a line is half a diagonal from both.
            let reach_px = tolerance_px.hypot(0.5_f64.sqrt()) + 1e-9;
            let reach = reach_px.ceil() as i32;
            for [from, to] in &segments {
                let steps = (4.0 * from.distance(*to)).ceil().max(1.0);
                for step in 0..=steps as u32 {
                    let part = f64::from(step) / steps;
                    let at = PxPoint::new(from.x + (to.x - from.x) * part, from.y + (to.y - from.y) * part);
                    let column = |d: i32| (at.x as u32).checked_add_signed(d);
                    let row = |d: i32| (at.y as u32).checked_add_signed(d);
                    let mut round = (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy)));
                    let is_near = round.any(|(dx, dy)| {
                        let Some((x, y)) = column(dx).zip(row(dy)) else { return false };
                        let pixel = Pixel::new(x, y);
                        ink.get(pixel) && at.distance(pixel.into()) <= reach_px
                    });
                    assert!(is_near, "{at:?} at {tolerance_px} px");
                }
            }
        }
    }
}
