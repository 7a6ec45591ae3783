//! Laws of ordering drawings of the sheet: the same ink, pen by pen, with what belongs to it.

use plotter_motion::Point;
use plotter_motion::drawing::{Drawing, Mark, PathSegment, Shape, Stroke};
use plotter_vector::{Order, OrderEffort};
use proptest::prelude::*;
use std::time::Duration;

/// Places of a coarse grid, so that ends meet.
fn place() -> impl Strategy<Value = Point> {
    (0..9_i32, 0..9_i32).prop_map(|(x, y)| Point::new(f64::from(x), f64::from(y)))
}

fn stroke() -> impl Strategy<Value = Stroke> {
    let segment = (place(), place(), place(), 0..4_u8, proptest::option::of(1..4_u8)).prop_map(
        |(a, b, to, kind, feed)| {
            let segment = match kind {
                0 => PathSegment::cubic([a, b], to),
                _ => PathSegment::line(to),
            };
            PathSegment { feed_mm_s: feed.map(f64::from), ..segment }
        },
    );
    let closes = proptest::bool::weighted(0.3);
    let mark = proptest::option::weighted(
        0.1,
        prop_oneof![Just(Mark::NewPage), Just(Mark::Dwell(Duration::from_secs(1)))],
    );
    (place(), proptest::collection::vec(segment, 1..5), closes, 0..3_u8, 0..3_u32, mark).prop_map(
        |(from, mut segments, closes, pen, layer, mark)| {
            if closes {
                segments.push(PathSegment::line(from));
            }
            Stroke { pen, layer, before: mark.into_iter().collect(), from, segments }
        },
    )
}

fn drawing() -> impl Strategy<Value = Drawing> {
    proptest::collection::vec(stroke(), 0..20).prop_map(|strokes| Drawing {
        strokes,
        layers: vec!["one".into(), "two".into()],
        ..Drawing::default()
    })
}

/// What is drawn with which pen and speed, whichever way round and in whatever order, sheet by sheet; dots on lines are not counted.
fn ink(drawing: &Drawing) -> Vec<String> {
    let mut ink = Vec::new();
    let mut sheet = 0;
    for stroke in &drawing.strokes {
        sheet += stroke.before.iter().filter(|mark| **mark == Mark::NewPage).count();
        for (from, segment) in stroke.segments() {
            if segment.shape == Shape::Line && segment.to == from {
                continue;
            }
            let key = |from: Point, segment: PathSegment| format!("{from:?}{segment:?}");
            let text = key(from, *segment).min(key(segment.to, segment.reversed(from)));
            ink.push(format!("{sheet} {} {} {text}", stroke.pen, stroke.layer));
        }
    }
    ink.sort();
    ink
}

fn marks(drawing: &Drawing) -> Vec<String> {
    let mut marks: Vec<String> =
        drawing.strokes.iter().flat_map(|stroke| &stroke.before).map(|mark| format!("{mark:?}")).collect();
    marks.sort();
    marks
}

proptest! {
    #[test]
    fn the_same_is_drawn_with_no_more_travel(drawing in drawing(), across_pens in any::<bool>(), is_best in any::<bool>()) {
        let effort = if is_best { OrderEffort::Best } else { OrderEffort::Fast };
        let order = Order { merge_gap_px: 0.0, across_pens, effort, ..Order::default() };
        let ordered = order.apply_to(drawing.clone());
        prop_assert_eq!(ink(&ordered), ink(&drawing));
        prop_assert_eq!(marks(&ordered), marks(&drawing));
        prop_assert!((ordered.length_mm() - drawing.length_mm()).abs() <= 1e-9 * (1.0 + drawing.length_mm()));
        prop_assert_eq!(ordered.check(), Ok(()));
        if across_pens {
            let travel = |drawing: &Drawing| drawing.strokes.windows(2).map(|pair| pair[0].to().distance(pair[1].from)).sum::<f64>();
            let is_one_sheet = !marks(&drawing).iter().any(|mark| mark.contains("Page"));
            prop_assert!(!is_one_sheet || travel(&ordered) <= travel(&drawing) + 1e-9);
        } else {
            let sheets = ordered.strokes.chunk_by(|_, next| !next.before.contains(&Mark::NewPage));
            for sheet in sheets {
                prop_assert!(sheet.is_sorted_by_key(|stroke| stroke.pen));
            }
        }
        // Ordered again, nothing is lost either, and the order stays as short.
        prop_assert_eq!(ink(&order.apply_to(ordered)), ink(&drawing));
    }
}

#[test]
fn a_gap_is_bridged_at_the_speed_of_what_follows_and_a_dwell_keeps_its_stroke() {
    let line = |from: f64, to: f64, feed: f64| {
        let mut stroke = Stroke::through([Point::new(from, 0.0), Point::new(to, 0.0)]).unwrap();
        stroke.segments[0].feed_mm_s = Some(feed);
        stroke
    };
    let strokes = vec![line(0.0, 10.0, 1.0), line(10.03, 20.0, 2.0)];
    let joined = Order::default().apply_to(Drawing { strokes: strokes.clone(), ..Drawing::default() });
    assert_eq!(joined.strokes.len(), 1);
    assert_eq!(
        joined.strokes[0].segments.iter().map(|segment| segment.feed_mm_s).collect::<Vec<_>>(),
        [Some(1.0), Some(2.0), Some(2.0)]
    );
    let mut waits = strokes;
    waits[1].before.push(Mark::Dwell(Duration::from_secs(2)));
    assert_eq!(Order::default().apply_to(Drawing { strokes: waits, ..Drawing::default() }).strokes.len(), 2);
}
