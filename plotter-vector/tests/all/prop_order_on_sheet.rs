//! Laws of ordering drawings of the sheet: the same ink, pen by pen, with what belongs to it.

use crate::law_cases::cases;
use crate::seams::unsplit_sheet;
use plotter_motion::Point;
use plotter_motion::drawing::{Drawing, Mark, PathSegment, Shape, Stroke};
use plotter_vector::{Order, order::OrderEffort};
use proptest::prelude::*;
use std::f64::consts::{FRAC_1_PI, FRAC_1_SQRT_2, FRAC_PI_2, TAU};
use std::time::Duration;

/// What the lengths of a curve's parts differ from its own, mm of each: lengths of lines within a nanometre
/// of them.
const CURVE_MM: f64 = 1e-6;

/// Places of a coarse grid, so that ends meet.
fn place() -> impl Strategy<Value = Point> {
    (0..9_i32, 0..9_i32).prop_map(|(x, y)| Point::new(f64::from(x), f64::from(y)))
}

/// Handles are off the grid, so that no curve is straight: two whose handles are their ends do not tell by
/// their parts where they were cut.
fn handle(at: Point) -> Point {
    Point::new(at.x + FRAC_1_PI, at.y + FRAC_1_SQRT_2)
}

fn stroke() -> impl Strategy<Value = Stroke> {
    let segment = (place(), place(), place(), 0..4_u8, proptest::option::of(1..4_u8)).prop_map(
        |(a, b, to, kind, feed)| {
            let segment = match kind {
                0 => PathSegment::cubic([a, b].map(handle), to),
                // By how much it turns; where it ends follows.
                1 => PathSegment::arc(a, FRAC_PI_2 * (b.x - 4.0), to),
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
            } else if segments.len() == 1 {
                // A loop.
                segments[0].to = from;
                if let Shape::Arc { sweep_rad, .. } = &mut segments[0].shape {
                    *sweep_rad = TAU.copysign(*sweep_rad);
                }
            }
            let mut at = from;
            for segment in &mut segments {
                if let Shape::Arc { centre, sweep_rad } = &mut segment.shape {
                    if sweep_rad.abs() == TAU {
                        // No other stroke ends half way round.
                        centre.x += 0.25;
                    }
                    let to = *centre + (at - *centre).rotated(*sweep_rad);
                    segment.to = Point::new(to.x.round() + 0.0, to.y.round() + 0.0);
                }
                at = segment.to;
            }
            // Dots on the way are no ink.
            let mut at = from;
            segments.retain(|segment| !segment.is_dot(std::mem::replace(&mut at, segment.to)));
            if segments.is_empty() {
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

/// What is drawn with which pen and speed, whichever way round and in whatever order, sheet by sheet; dots on
/// lines are not counted.
fn ink(drawing: &Drawing) -> Vec<String> {
    let mut ink = Vec::new();
    let mut sheet = 0;
    for stroke in &drawing.strokes {
        sheet += stroke.before.iter().filter(|mark| **mark == Mark::NewPage).count();
        for (from, segment) in stroke.segments() {
            if segment.is_dot(from) {
                continue;
            }
            let key = |from: Point, segment: PathSegment| match segment.shape {
                // Wherever it begins.
                Shape::Arc { centre, .. } if segment.to == from => {
                    format!("{centre:?} {:.6} {:?}", from.distance(centre), segment.feed_mm_s)
                }
                _ => format!("{from:?}{segment:?}"),
            };
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

/// Of the two, what the first has and the second has not.
fn missing(all: &[String], among: &[String]) -> Vec<String> {
    let mut rest = among.to_vec();
    let is_gone = |text: &&String| match rest.iter().position(|other| other == *text) {
        Some(at) => {
            rest.swap_remove(at);
            false
        }
        None => true,
    };
    all.iter().filter(is_gone).cloned().collect()
}

fn efforts() -> impl Strategy<Value = OrderEffort> {
    prop_oneof![Just(OrderEffort::Join), Just(OrderEffort::Fast), Just(OrderEffort::Best)]
}

proptest! {
    #![proptest_config(cases(256))]
    #[test]
    fn the_same_is_drawn_with_no_more_travel_and_lifts(
        drawing in drawing(),
        across_pens in any::<bool>(),
        effort in efforts(),
        lift_px in prop_oneof![Just(0.0), Just(200.0)],
    ) {
        let order = Order::default().with_merge_gap_px(0.0).with_across_pens(across_pens).with_effort(effort).with_lift_px(lift_px);
        let ordered = order.apply_to(drawing.clone());
        prop_assert_eq!(ink(&unsplit_sheet(&ordered, &drawing)), ink(&drawing));
        prop_assert_eq!(marks(&ordered), marks(&drawing));
        prop_assert!((ordered.length_mm() - drawing.length_mm()).abs() <= CURVE_MM * (1.0 + drawing.length_mm()));
        prop_assert_eq!(ordered.check(), Ok(()));
        prop_assert!(ordered.strokes.len() <= drawing.strokes.len());
        let is_one_sheet = !marks(&drawing).iter().any(|mark| mark.contains("Page"));
        if across_pens && is_one_sheet && effort != OrderEffort::Join {
            let cost = |drawing: &Drawing| {
                let travel = drawing.strokes.windows(2).map(|pair| pair[0].to().distance(pair[1].from)).sum::<f64>();
                travel + f64::from(u32::try_from(drawing.strokes.len()).unwrap()) * lift_px / Order::PX_PER_MM
            };
            prop_assert!(cost(&ordered) <= cost(&drawing) + 1e-9);
        }
        if effort != OrderEffort::Join && is_one_sheet {
            for (travel_mm, least_mm) in starts(&ordered) {
                prop_assert!(travel_mm <= least_mm + SAVED_MM, "{travel_mm} mm where {least_mm} mm do");
            }
        }
        if !across_pens {
            let sheets = ordered.strokes.chunk_by(|_, next| !next.before.contains(&Mark::NewPage));
            for sheet in sheets {
                prop_assert!(sheet.is_sorted_by_key(|stroke| stroke.pen));
            }
        }
        // Ordered again, nothing is lost either.
        let again = order.apply_to(ordered);
        prop_assert!((again.length_mm() - drawing.length_mm()).abs() <= CURVE_MM * (1.0 + drawing.length_mm()));
    }

    #[test]
    fn over_gaps_nothing_is_lost_and_only_gaps_are_added(
        drawing in drawing(),
        effort in efforts(),
        bridges_corners in any::<bool>(),
    ) {
        // Places of the grid beside each other, but not over its diagonals.
        let gap_mm = 1.1;
        let order = Order::default().with_merge_gap_px(gap_mm * Order::PX_PER_MM).with_effort(effort).with_bridges_corners(bridges_corners);
        let ordered = order.apply_to(drawing.clone());
        prop_assert_eq!(missing(&ink(&drawing), &ink(&unsplit_sheet(&ordered, &drawing))), Vec::<String>::new());
        let added = ordered.length_mm() - drawing.length_mm();
        // Each joint, and each trail that is closed besides.
        let joints = drawing.strokes.len() - ordered.strokes.len();
        let most = gap_mm * f64::from(u32::try_from(joints + ordered.strokes.len()).unwrap());
        prop_assert!(added >= -CURVE_MM * drawing.length_mm() && added <= most + CURVE_MM, "{added} {most}");
        prop_assert_eq!(ordered.check(), Ok(()));
    }
}

/// Greatest travel that a better start of one closed stroke may save, mm: a start at a vertex may cost a
/// tenth, and its neighbours may have moved by a two hundredth each since.
const SAVED_MM: f64 = 0.1 + 0.01 + 1e-3;

/// The travel before and after each closed stroke, and the least that there is anywhere on it, mm.
fn starts(ordered: &Drawing) -> Vec<(f64, f64)> {
    let strokes = &ordered.strokes;
    let start = |index: usize| {
        let before = index.checked_sub(1).map(|before| strokes[before].to());
        let after = strokes.get(index + 1).map(|after| after.from);
        let travel =
            |at: Point| [before, after].into_iter().flatten().map(|end| end.distance(at)).sum::<f64>();
        // Within a straight side none begins.
        let along = |(from, segment): (Point, &PathSegment)| {
            let segment = *segment;
            let parts = if matches!(segment.shape, plotter_motion::drawing::Shape::Line) { 1 } else { 500 };
            (0..parts).map(move |k| segment.at(from, f64::from(k) / 500.0))
        };
        let places = strokes[index].segments().flat_map(along);
        (travel(strokes[index].from), places.map(travel).fold(f64::INFINITY, f64::min))
    };
    (0..strokes.len()).filter(|index| strokes[*index].is_closed()).map(start).collect()
}

#[test]
fn a_closed_stroke_begins_where_the_travel_before_and_after_it_is_least() {
    // Between two lines: a circle of two arcs and of one, a loop of one curve, a square.
    let centre = Point::new(100.0, 100.0);
    let circle = |radius_mm: f64, arcs: u32| {
        let from = Point::new(centre.x + radius_mm, centre.y);
        let sweep_rad = TAU / f64::from(arcs);
        let to = |arc: u32| {
            if arc == arcs { from } else { centre + (from - centre).rotated(sweep_rad * f64::from(arc)) }
        };
        let segments = (1..=arcs).map(|arc| PathSegment::arc(centre, sweep_rad, to(arc))).collect();
        Stroke { from, segments, ..Stroke::default() }
    };
    let curve = PathSegment::cubic([Point::new(180.0, 120.0), Point::new(20.0, 160.0)], centre);
    let curve = Stroke { from: centre, segments: vec![curve], ..Stroke::default() };
    let corners = [(60.0, 60.0), (140.0, 60.0), (140.0, 140.0), (60.0, 140.0), (60.0, 60.0)];
    let square = Stroke::through(corners.map(|(x, y)| Point::new(x, y))).unwrap();
    let line = |[x, y, u, v]: [f64; 4]| Stroke::through([Point::new(x, y), Point::new(u, v)]).unwrap();
    for (name, closed) in
        [("two arcs", circle(40.0, 2)), ("one arc", circle(40.0, 1)), ("curve", curve), ("square", square)]
    {
        for ends in [
            [0.0, 0.0, 30.0, 5.0, 180.0, 150.0, 200.0, 130.0],
            [115.0, 0.0, 115.0, 20.0, 120.0, 200.0, 120.0, 300.0],
        ] {
            let [a, b, c, d, e, f, g, h] = ends;
            let strokes = vec![line([a, b, c, d]), closed.clone(), line([e, f, g, h])];
            let drawing = Drawing { strokes, ..Drawing::default() };
            let ordered = Order::default().apply_to(drawing.clone());
            let [(travel_mm, least_mm)] = starts(&ordered)[..] else { panic!("{ordered:?}") };
            assert!(
                travel_mm <= least_mm + 1e-3,
                "{name}: {travel_mm} mm where {least_mm} mm do: {ordered:?}"
            );
            let most_mm = if name == "curve" { CURVE_MM * drawing.length_mm() } else { 1e-9 };
            assert!((ordered.length_mm() - drawing.length_mm()).abs() < most_mm, "{name}");
            assert_eq!(ordered.check(), Ok(()));
            // A circle stays one arc, wherever it begins.
            let segments =
                |drawing: &Drawing| drawing.strokes.iter().map(|stroke| stroke.segments.len()).sum::<usize>();
            let more = usize::from(name != "one arc" && name != "square");
            assert_eq!(segments(&ordered), segments(&drawing) + more, "{name}: {ordered:?}");
        }
    }
}

#[test]
fn places_that_are_none_keep_the_order_and_all_strokes() {
    let odd = [f64::NAN, f64::INFINITY, 1e30, -1e30, 5.0, 5.0, 0.0];
    let strokes: Vec<Stroke> = odd
        .iter()
        .flat_map(|x| {
            [
                Stroke::through([Point::new(*x, 1.0), Point::new(3.0, *x)]),
                Stroke::through([Point::new(*x, *x)]),
            ]
        })
        .flatten()
        .collect();
    for effort in [OrderEffort::None, OrderEffort::Join, OrderEffort::Fast, OrderEffort::Best] {
        for merge_gap_px in [0.0, f64::NAN, 1e300] {
            let order = Order::default()
                .with_effort(effort)
                .with_merge_gap_px(merge_gap_px)
                .with_bridges_corners(true)
                .with_lift_px(f64::NAN);
            let ordered = order.apply_to(Drawing { strokes: strokes.clone(), ..Drawing::default() });
            assert_eq!(format!("{:?}", ordered.strokes), format!("{strokes:?}"), "{order:?}");
        }
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
