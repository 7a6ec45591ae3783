//! Laws of drawings: what goes through them comes back, and maps keep what they ought to.

use crate::law_cases::cases;
use core::f64::consts::TAU;
use core::time::Duration;
use plotter_motion::drawing::{Affine, Drawing, Mark, PathSegment, Shape, Stroke};
use plotter_motion::{PlotOp, Point, toolpath::chords};
use proptest::prelude::*;

fn place() -> impl Strategy<Value = Point> {
    (-500.0..500.0, -500.0..500.0).prop_map(|(x, y)| Point::new(x, y))
}

/// A segment from a place, whose arc has its end where its angle says.
fn segment(from: Point) -> impl Strategy<Value = PathSegment> {
    let feed = proptest::option::of(1.0..100.0);
    let shape = prop_oneof![
        place().prop_map(PathSegment::line),
        (place(), -TAU..TAU).prop_map(move |(centre, sweep_rad)| {
            PathSegment::arc(centre, sweep_rad, centre + (from - centre).rotated(sweep_rad))
        }),
        (place(), place(), place()).prop_map(|(a, b, to)| PathSegment::cubic([a, b], to)),
    ];
    (shape, feed).prop_map(|(segment, feed_mm_s)| PathSegment { feed_mm_s, ..segment })
}

fn stroke() -> impl Strategy<Value = Stroke> {
    let mark =
        prop_oneof![Just(Mark::NewPage), (0..5000_u64).prop_map(|ms| Mark::Dwell(Duration::from_millis(ms)))];
    (place(), 1..4_u8, proptest::collection::vec(mark, 0..2)).prop_flat_map(|(from, pen, before)| {
        let start = Stroke { pen, layer: 0, before, from, segments: vec![] };
        segment(from).prop_flat_map(move |first| {
            let mut start = start.clone();
            start.segments.push(first);
            (segment(first.to), any::<bool>()).prop_map(move |(second, is_long)| {
                let mut stroke = start.clone();
                stroke.segments.extend(is_long.then_some(second));
                stroke
            })
        })
    })
}

fn drawing() -> impl Strategy<Value = Drawing> {
    proptest::collection::vec(stroke(), 0..6).prop_map(|strokes| Drawing { strokes, ..Drawing::default() })
}

fn without_cubics(mut drawing: Drawing) -> Drawing {
    for segment in drawing.strokes.iter_mut().flat_map(|stroke| &mut stroke.segments) {
        if matches!(segment.shape, Shape::Cubic { .. }) {
            segment.shape = Shape::Line;
        }
    }
    drawing
}

proptest! {
    #![proptest_config(cases(256))]
    #[test]
    fn operations_and_back_lose_nothing(drawing in drawing()) {
        let drawing = without_cubics(drawing);
        let again: Drawing = drawing.ops(0.01).collect();
        prop_assert_eq!(&again, &drawing);
        prop_assert_eq!(drawing.check(), Ok(()));
    }

    #[test]
    fn cubic_curves_become_lines_within_the_tolerance(drawing in drawing()) {
        let again: Drawing = drawing.ops(0.01).collect();
        prop_assert_eq!(again.strokes.len(), drawing.strokes.len());
        prop_assert!((again.length_mm() - drawing.length_mm()).abs() <= 1e-3 * (1.0 + drawing.length_mm()));
    }

    #[test]
    fn reversing_twice_is_nothing_and_once_keeps_length_and_bounds(drawing in drawing()) {
        let mut turned = drawing.clone();
        turned.reverse();
        prop_assert!((turned.length_mm() - drawing.length_mm()).abs() <= 1e-9 * (1.0 + drawing.length_mm()));
        let (a, b) = (turned.bounds(), drawing.bounds());
        if !b.is_empty() {
            prop_assert!(a.least.distance(b.least) < 1e-6 && a.most.distance(b.most) < 1e-6, "{a:?} {b:?}");
        }
        turned.reverse();
        prop_assert_eq!(turned, drawing);
    }

    #[test]
    fn bounds_hold_all_places_and_touch_them(drawing in drawing()) {
        let bounds = drawing.bounds();
        let places = || chords(drawing.ops(1e-4), 1e-4).filter_map(PlotOp::target);
        for at in places() {
            prop_assert!(at.x >= bounds.least.x - 1e-3 && at.y >= bounds.least.y - 1e-3, "{at:?} {bounds:?}");
            prop_assert!(at.x <= bounds.most.x + 1e-3 && at.y <= bounds.most.y + 1e-3, "{at:?} {bounds:?}");
        }
        if !bounds.is_empty() {
            let left = places().map(|at| at.x).fold(f64::INFINITY, f64::min);
            let above = places().map(|at| at.y).fold(f64::NEG_INFINITY, f64::max);
            prop_assert!((left - bounds.least.x).abs() < 1e-2 && (above - bounds.most.y).abs() < 1e-2);
        }
    }

    #[test]
    fn what_is_turned_and_scaled_is_as_long_as_it_should_be(drawing in drawing(), angle in -TAU..TAU, factor in 0.1..9.0_f64) {
        let mut mapped = drawing.clone();
        mapped.map(&Affine::turned(angle).then(&Affine::scaled(factor, -factor)).then(&Affine::moved(3.0, 4.0)));
        let (before, after) = (drawing.length_mm() * factor, mapped.length_mm());
        prop_assert!((before - after).abs() <= 1e-6 * (1.0 + before), "{before} {after}");
    }

    #[test]
    fn parts_of_a_segment_join(segment in place().prop_flat_map(|from| (Just(from), segment(from))), cut in 0.01..0.99_f64) {
        let (from, segment) = segment;
        let (first, second) = (segment.part(from, 0.0, cut), segment.part(from, cut, 1.0));
        for share in [0.0, 0.3, 0.8] {
            let one = first.at(from, share).distance(segment.at(from, cut * share));
            let two = second.at(first.to, share).distance(segment.at(from, cut + (1.0 - cut) * share));
            prop_assert!(one < 1e-6 && two < 1e-6, "{one} {two}");
        }
        prop_assert!(second.to.distance(segment.to) < 1e-9);
    }

    #[test]
    fn a_circle_that_is_stretched_is_its_ellipse(centre in place(), radius in 0.1..100.0_f64, sweep in -TAU..TAU, factor in 0.2..5.0_f64) {
        let from = Point::new(centre.x + radius, centre.y);
        let arc = PathSegment::arc(centre, sweep, centre + (from - centre).rotated(sweep));
        let stroke = Stroke { from, segments: vec![arc], ..Stroke::default() };
        let seen = stroke.mapped(&Affine::scaled(factor, 1.0));
        for at in seen.places(1e-6 * radius) {
            let off = libm::hypot(at.x / factor - centre.x, at.y - centre.y) - radius;
            prop_assert!(off.abs() < 1e-5 * radius, "{off}");
        }
    }
}

#[test]
fn dots_pens_and_marks_stay() {
    let ops = [
        PlotOp::SelectPen { pen: 2 },
        PlotOp::Travel { to: Point::new(1.0, 1.0) },
        PlotOp::Draw { to: Point::new(1.0, 1.0), feed_mm_s: None },
        PlotOp::LaserPower { share: 0.5 },
        PlotOp::NewPage,
        PlotOp::Travel { to: Point::new(2.0, 1.0) },
        PlotOp::Draw { to: Point::new(3.0, 1.0), feed_mm_s: Some(9.0) },
        PlotOp::SelectPen { pen: 0 },
    ];
    let drawing: Drawing = ops.into_iter().collect();
    assert!(drawing.strokes[0].is_dot() && !drawing.strokes[1].is_dot());
    assert_eq!(
        (drawing.strokes[1].before.as_slice(), drawing.after.as_slice()),
        (&[Mark::NewPage][..], &[Mark::PutPenAway][..])
    );
    assert_eq!(drawing.strokes[1].segments[0].power, Some(0.5));
    let again: Drawing = drawing.ops(0.1).collect();
    assert_eq!(again, drawing);
    assert_eq!(drawing.of_pen(2).strokes.len(), 2);
}

#[cfg(feature = "serde")]
#[test]
fn drawings_that_contradict_themselves_are_refused() {
    let drawing: Drawing = [PlotOp::Draw { to: Point::new(1.0, 2.0), feed_mm_s: None }].into_iter().collect();
    assert_eq!(drawing.check(), Ok(()));
    let unsound =
        Drawing { strokes: vec![Stroke { layer: 3, ..drawing.strokes[0].clone() }], ..Drawing::default() };
    assert_eq!(unsound.check().unwrap_err().stroke, 0);
}
