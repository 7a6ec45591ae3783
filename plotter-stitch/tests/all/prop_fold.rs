//! Laws of the search for an empty square: none that is found is drawn in, and one is found wherever there is
//! one.

use plotter_motion::{PlotOp, Point, Segment};
use plotter_stitch::{
    FoldProbe,
    fold::{EmptySquare, FoldDirection},
};
use proptest::prelude::*;

const FRAME_MM: f64 = 400.0;
const HEIGHT_MM: f64 = 300.0;

/// Strokes of two places each.
fn lines() -> impl Strategy<Value = Vec<(Point, Point)>> {
    let place = || (0.0..FRAME_MM, 0.0..HEIGHT_MM).prop_map(|(x, y)| Point::new(x, y));
    prop::collection::vec((place(), place()), 0..40)
}

/// Distance from the middle of a square to a line, in the norm in which the square is the disc.
fn apart(middle: Point, line: Segment) -> f64 {
    // Along the line the norm is convex: halve the interval by thirds.
    let at = |t: f64| {
        let off = line.from.lerp(line.to, t) - middle;
        off.x.abs().max(off.y.abs())
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..100 {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if at(a) < at(b) { high = b } else { low = a }
    }
    at(0.5 * (low + high))
}

proptest! {
    #[test]
    fn squares_are_empty_and_are_found_where_there_is_one(lines in lines(), falls in any::<bool>()) {
        let direction = if falls { FoldDirection::Falling } else { FoldDirection::Rising };
        let mut search = EmptySquare::new(direction, FRAME_MM, HEIGHT_MM);
        for (from, to) in &lines {
            search.push(PlotOp::Travel { to: *from });
            search.push(PlotOp::Draw { to: *to, feed_mm_s: None });
        }
        let nearest = |middle: Point| {
            lines.iter().map(|(from, to)| apart(middle, Segment::new(*from, *to))).fold(f64::INFINITY, f64::min)
        };
        /// Half the square, half the pen, and what chords may be off.
        const REACH_MM: f64 = 10.0 + 0.25 + 0.05;
        /// Rounding of the interval's ends.
        const ROUNDING_MM: f64 = 1e-6;
        let begin = if falls { Point::new(0.0, HEIGHT_MM) } else { Point::ORIGIN };
        let along = direction.along(FRAME_MM, HEIGHT_MM);
        match search.find() {
            Some(middle) => {
                prop_assert!(nearest(middle) >= REACH_MM - ROUNDING_MM);
                prop_assert!(along.cross(middle - begin).abs() < ROUNDING_MM);
                prop_assert!(middle.x >= 10.0 - ROUNDING_MM && middle.x <= FRAME_MM - 10.0 + ROUNDING_MM);
                prop_assert!(middle.y >= 10.0 - ROUNDING_MM && middle.y <= HEIGHT_MM - 10.0 + ROUNDING_MM);
                // The probe stays within the square.
                let probe = FoldProbe::new(middle, direction, FRAME_MM, HEIGHT_MM);
                let scans = probe.scans().flat_map(|scan| [scan.from, scan.to]);
                for place in probe.strokes().into_iter().flatten().filter_map(PlotOp::target).chain(scans) {
                    prop_assert!((place.x - middle.x).abs() < 10.0 && (place.y - middle.y).abs() < 10.0);
                }
            }
            None => {
                // Then no place of the diagonal has one, looked at every half millimetre.
                let mut way_mm = 10.0 / along.x.abs().min(along.y.abs());
                while way_mm <= FRAME_MM.hypot(HEIGHT_MM) - 10.0 / along.x.abs().min(along.y.abs()) {
                    prop_assert!(nearest(begin + along * way_mm) <= REACH_MM + ROUNDING_MM);
                    way_mm += 0.5;
                }
            }
        }
    }
}

#[test]
fn a_frame_full_of_lines_has_no_empty_square() {
    let mut search = EmptySquare::new(FoldDirection::Falling, FRAME_MM, HEIGHT_MM);
    for row in 0..=15 {
        let y = f64::from(row) * 20.0;
        search.push(PlotOp::Travel { to: Point::new(0.0, y) });
        search.push(PlotOp::Draw { to: Point::new(FRAME_MM, y), feed_mm_s: None });
    }
    assert_eq!(search.find(), None);
}

#[test]
fn a_circle_around_the_middle_leaves_its_inside() {
    let mut search = EmptySquare::new(FoldDirection::Rising, FRAME_MM, HEIGHT_MM);
    let (centre, to) = (Point::new(200.0, 150.0), Point::new(220.0, 150.0));
    search.push(PlotOp::Travel { to });
    search.push(PlotOp::DrawArc { centre, sweep_rad: std::f64::consts::TAU, to, feed_mm_s: None });
    assert!(search.find().unwrap().distance(centre) < 1e-9);
}
