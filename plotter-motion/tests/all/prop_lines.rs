//! Laws of what makes fewer lines: doubles dropped, lines simplified, arcs fitted. Distances are reckoned
//! here anew, from many places.

use crate::law_cases::cases;
use core::f64::consts::{FRAC_PI_4, PI, TAU};
use core::time::Duration;
use plotter_motion::drawing::{Doubles, Drawing, Mark, PathSegment, Shape, Stroke};
use plotter_motion::{Point, Segment};
use proptest::prelude::*;

/// What rounding may add to a distance, mm.
const ROUNDING_MM: f64 = 1e-7;

fn p(x: f64, y: f64) -> Point {
    Point::new(x, y)
}

fn of(strokes: impl IntoIterator<Item = Stroke>) -> Drawing {
    Drawing { strokes: strokes.into_iter().collect(), ..Drawing::default() }
}

fn through(places: &[(f64, f64)]) -> Stroke {
    Stroke::through(places.iter().map(|&(x, y)| p(x, y))).unwrap()
}

/// The segments of a pen, each with the place where it begins.
fn pieces(drawing: &Drawing, pen: u8) -> Vec<(Point, PathSegment)> {
    let of_pen = drawing.segments().filter(|(stroke, _, _)| stroke.pen == pen);
    of_pen.map(|(_, from, segment)| (from, *segment)).collect()
}

/// Distance of a place from a segment, mm; a curve is 200 lines.
fn away_mm(at: Point, (from, segment): &(Point, PathSegment)) -> f64 {
    match segment.shape {
        Shape::Line => Segment::new(*from, segment.to).distance(at),
        Shape::Arc { centre, sweep_rad } => {
            let (begin, out) = (*from - centre, at - centre);
            let angle = begin.cross(out).atan2(begin.dot(out)) * sweep_rad.signum();
            let ends = at.distance(*from).min(at.distance(segment.to));
            let share = angle.rem_euclid(TAU) / sweep_rad.abs();
            let radius = begin.length() + share * (segment.to.distance(centre) - begin.length());
            if share <= 1.0 { ends.min((out.length() - radius).abs()) } else { ends }
        }
        Shape::Cubic { .. } => {
            let line =
                |index: u8| [0.0, 1.0].map(|next| segment.at(*from, (f64::from(index) + next) / 200.0));
            (0..200).map(line).map(|[a, b]| Segment::new(a, b).distance(at)).fold(f64::INFINITY, f64::min)
        }
    }
}

/// How far nine places of each of some segments are from others, at most, mm.
fn farthest_mm(of: &[(Point, PathSegment)], from: &[(Point, PathSegment)]) -> f64 {
    let places = of.iter().flat_map(|(begin, segment)| {
        (0..9).map(|eighth| segment.at(*begin, f64::from(eighth) / 8.0)).collect::<Vec<_>>()
    });
    let nearest = |at: Point| from.iter().map(|piece| away_mm(at, piece)).fold(f64::INFINITY, f64::min);
    places.map(nearest).fold(0.0, f64::max)
}

/// Places of a lattice, so that much lies on each other.
fn lattice() -> impl Strategy<Value = Point> {
    (0..4_u8, 0..4_u8).prop_map(|(x, y)| p(2.0 * f64::from(x), 2.0 * f64::from(y)))
}

/// A segment of a lattice from a place: a line, an arc of eighths of a turn, or one of few curves.
fn lattice_segment(from: Point) -> impl Strategy<Value = PathSegment> {
    let arc = (0..8_u8, 1..=8_u8, any::<bool>()).prop_map(move |(towards, eighths, is_left)| {
        let centre = from + (p(2.0, 0.0) - Point::ORIGIN).rotated(f64::from(towards) * FRAC_PI_4);
        let sweep = f64::from(eighths) * if is_left { FRAC_PI_4 } else { -FRAC_PI_4 };
        let to = if eighths == 8 { from } else { centre + (from - centre).rotated(sweep) };
        PathSegment::arc(centre, sweep, to)
    });
    let cubic = (lattice(), 0..2_u8).prop_map(move |(to, bend)| {
        let bend = (to - from).perpendicular() * f64::from(bend);
        PathSegment::cubic([from + bend, to + bend], to)
    });
    prop_oneof![4 => lattice().prop_map(PathSegment::line), 2 => arc, 1 => cubic]
}

fn lattice_stroke() -> impl Strategy<Value = Stroke> {
    (lattice(), 1..3_u8).prop_flat_map(|(from, pen)| {
        let start = Stroke { pen, from, ..Stroke::default() };
        let more = |stroke: Stroke| {
            lattice_segment(stroke.to()).prop_map(move |segment| {
                let mut longer = stroke.clone();
                longer.segments.push(segment);
                longer
            })
        };
        more(start).prop_flat_map(more).prop_flat_map(more).prop_flat_map(move |stroke| {
            (0..3_usize).prop_map(move |left_out| {
                let mut stroke = stroke.clone();
                stroke.segments.truncate(3 - left_out);
                stroke
            })
        })
    })
}

/// The same with each place moved by up to a thousandth of a mm.
fn shaken(mut drawing: Drawing, seed: u64) -> Drawing {
    let mut state = seed | 1;
    let mut shake = |at: Point| {
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / f64::from(1 << 24) * 2e-3 - 1e-3
        };
        p(at.x + next(), at.y + next())
    };
    for stroke in &mut drawing.strokes {
        stroke.from = shake(stroke.from);
        for segment in &mut stroke.segments {
            if segment.shape == Shape::Line {
                segment.to = shake(segment.to);
            }
        }
    }
    drawing
}

fn nothing_is_lost_or_new(before: &Drawing, after: &Drawing, tolerance_mm: f64) -> Result<(), TestCaseError> {
    for pen in 0..3 {
        let (before, after) = (pieces(before, pen), pieces(after, pen));
        let lost = farthest_mm(&before, &after);
        prop_assert!(before.is_empty() || lost <= tolerance_mm + ROUNDING_MM, "{lost} lost by pen {pen}");
        let new = farthest_mm(&after, &before);
        prop_assert!(after.is_empty() || new <= ROUNDING_MM, "{new} new by pen {pen}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(256))]
    #[test]
    fn doubles_keep_the_ink_and_drop_it_once(strokes in proptest::collection::vec(lattice_stroke(), 0..9)) {
        let before = of(strokes);
        let mut after = before.clone();
        let doubles = after.drop_doubles(0.01);
        nothing_is_lost_or_new(&before, &after, 0.01)?;
        prop_assert!((before.length_mm() - after.length_mm() - doubles.length_mm).abs() < 1e-6);
        prop_assert!(after.check().is_ok());
        let once = after.clone();
        prop_assert_eq!(after.drop_doubles(0.01), Doubles::default());
        prop_assert_eq!(&after, &once);
        // Twice the drawing is once the drawing.
        let mut twice = of(before.strokes.iter().chain(&before.strokes).cloned());
        twice.drop_doubles(0.01);
        prop_assert_eq!(twice, once);
    }

    #[test]
    fn doubles_of_rounded_places_keep_the_ink(strokes in proptest::collection::vec(lattice_stroke(), 0..9), seed: u64, tolerance in 1e-4..5e-2) {
        let before = shaken(of(strokes), seed);
        let mut after = before.clone();
        after.drop_doubles(tolerance);
        nothing_is_lost_or_new(&before, &after, tolerance)?;
    }

    #[test]
    fn overlaps_are_as_long_as_their_union(
        parts in proptest::collection::vec((0..60_u8, 0..60_u8, 1..3_u8), 1..30),
        angle in prop_oneof![Just(0.0), Just(0.5 * PI), 0.0..TAU],
        is_round: bool,
    ) {
        let along = (p(1.0, 0.0) - Point::ORIGIN).rotated(angle);
        let stroke = |&(a, b, pen): &(u8, u8, u8)| {
            let (a, b) = (f64::from(a), f64::from(b));
            if is_round {
                let at = |length: f64| p(30.0, 40.0) + along.rotated(0.1 * length) * 10.0;
                Stroke { pen, from: at(a), segments: vec![PathSegment::arc(p(30.0, 40.0), 0.1 * (b - a), at(b))], ..Stroke::default() }
            } else {
                Stroke { pen, ..Stroke::through([p(30.0, 40.0) + along * a, p(30.0, 40.0) + along * b]).unwrap() }
            }
        };
        let mut drawing = of(parts.iter().filter(|part| part.0 != part.1).map(stroke));
        drawing.drop_doubles(1e-3);
        let has = |pen: u8, at: u8| parts.iter().any(|&(a, b, of)| of == pen && (a.min(b)..a.max(b)).contains(&at));
        let union = (1..3).map(|pen| (0..60).filter(|&at| has(pen, at)).count()).sum::<usize>() as f64;
        prop_assert!((drawing.length_mm() - union).abs() < 1e-6, "{} {union}", drawing.length_mm());
    }
}

#[test]
fn cells_of_a_table_share_their_borders() {
    let cells = (0..5).flat_map(|x| (0..4).map(move |y| (8.0 * f64::from(x), 6.0 * f64::from(y))));
    let square =
        |(x, y): (f64, f64)| through(&[(x, y), (x + 8.0, y), (x + 8.0, y + 6.0), (x, y + 6.0), (x, y)]);
    let frame = through(&[(0.0, 0.0), (40.0, 0.0), (40.0, 24.0), (0.0, 24.0), (0.0, 0.0)]);
    let mut drawing = of(cells.map(square).chain([frame.clone()]));
    let doubles = drawing.drop_doubles(0.01);
    // Six lines of 24 mm and five of 40 mm.
    assert!((drawing.length_mm() - 344.0).abs() < 1e-9);
    assert!((doubles.length_mm - (20.0 * 28.0 + 128.0 - 344.0)).abs() < 1e-9);
    // The frame first: all of the cells' outer sides are gone.
    let cells = drawing.strokes.clone();
    let mut drawing = of(core::iter::once(frame).chain(cells));
    drawing.drop_doubles(0.01);
    assert!((drawing.length_mm() - 344.0).abs() < 1e-9);
    assert_eq!(drawing.strokes[0].length_mm(), 128.0);
}

#[test]
fn a_closed_stroke_that_loses_a_side_stays_one() {
    let square = through(&[(0.0, 0.0), (8.0, 0.0), (8.0, 8.0), (0.0, 8.0), (0.0, 0.0)]);
    let mut drawing = of([through(&[(8.0, -1.0), (8.0, 9.0)]), square]);
    drawing.drop_doubles(0.01);
    assert_eq!(drawing.strokes.len(), 2);
    assert_eq!(drawing.strokes[1], through(&[(8.0, 8.0), (0.0, 8.0), (0.0, 0.0), (8.0, 0.0)]));
}

#[test]
fn lines_that_cross_or_lie_beside_each_other_stay() {
    let star = (0..180).map(|degrees| {
        let way = (p(50.0, 0.0) - Point::ORIGIN).rotated(f64::from(degrees).to_radians());
        Stroke::through([Point::ORIGIN + way, Point::ORIGIN + -way]).unwrap()
    });
    let hatch =
        (0..100).map(|line| through(&[(0.0, 0.06 * f64::from(line)), (80.0, 0.06 * f64::from(line))]));
    for strokes in [star.collect::<Vec<_>>(), hatch.collect()] {
        let mut drawing = of(strokes);
        let before = drawing.clone();
        assert_eq!(drawing.drop_doubles(0.05), Doubles::default());
        assert_eq!(drawing, before);
    }
}

#[test]
fn lines_beside_each_other_within_the_tolerance_are_doubles() {
    for (beside, left) in [(0.049, 1.0), (0.051, 2.0)] {
        let mut drawing = of([
            through(&[(0.0, 0.0), (80.0, 60.0)]),
            through(&[(80.0, 60.0 + 1.25 * beside), (0.0, 1.25 * beside)]),
        ]);
        drawing.drop_doubles(0.05);
        let short: f64 = drawing.strokes.iter().map(|stroke| stroke.length_mm().min(1.0)).sum();
        assert_eq!(short.round(), left, "{beside}");
    }
}

#[test]
fn sheets_pens_and_powers_are_apart_and_marks_stay() {
    let line = through(&[(0.0, 0.0), (10.0, 0.0)]);
    let pen = |pen: u8| Stroke { pen, ..line.clone() };
    let before = |mark: Mark| Stroke { before: vec![mark], ..line.clone() };
    let power = |share: f64, feed: f64| {
        let mut stroke = line.clone();
        stroke.segments[0] = PathSegment { power: Some(share), feed_mm_s: Some(feed), ..stroke.segments[0] };
        stroke
    };
    let feed = |feed: f64| {
        let mut stroke = line.clone();
        stroke.segments[0].feed_mm_s = Some(feed);
        stroke
    };
    let left = |strokes: Vec<Stroke>| {
        let mut drawing = of(strokes);
        drawing.drop_doubles(0.01);
        drawing
    };
    assert_eq!(left(vec![pen(1), pen(2), pen(1)]).strokes.len(), 2);
    assert_eq!(left(vec![feed(1.0), feed(2.0)]).strokes.len(), 1);
    assert_eq!(
        left(vec![power(0.2, 9.0), power(0.4, 9.0), power(0.4, 8.0), power(0.2, 9.0)]).strokes.len(),
        3
    );
    let sheets = left(vec![line.clone(), before(Mark::NewPage), line.clone()]);
    assert_eq!((sheets.strokes.len(), sheets.strokes[1].before.as_slice()), (2, &[Mark::NewPage][..]));
    let dwell = Mark::Dwell(Duration::from_secs(1));
    let marks = left(vec![
        line.clone(),
        before(dwell),
        before(Mark::PutPenAway),
        through(&[(0.0, 1.0), (9.0, 1.0)]),
        before(dwell),
    ]);
    assert_eq!(marks.strokes.len(), 2);
    assert_eq!(marks.strokes[1].before, [dwell, Mark::PutPenAway]);
    assert_eq!(marks.after, [dwell]);
    // The stroke that took pen 2 is gone; what pen 2 drew after it is still drawn by it.
    let other = through(&[(0.0, 1.0), (9.0, 1.0)]);
    let pens = left(vec![pen(2), pen(1), pen(2), other.clone(), before(Mark::PutPenAway), other]);
    assert_eq!(pens.strokes.iter().map(|stroke| stroke.pen).collect::<Vec<_>>(), [2, 1, 2, 0, 0]);
}

#[test]
fn what_is_drawn_to_and_fro_is_drawn_once() {
    let mut drawing = of([through(&[(0.0, 0.0), (10.0, 0.0), (0.0, 0.0), (0.0, 5.0)])]);
    assert_eq!(drawing.drop_doubles(0.01).length_mm, 10.0);
    assert_eq!(drawing.strokes, [through(&[(0.0, 0.0), (10.0, 0.0)]), through(&[(0.0, 0.0), (0.0, 5.0)])]);
}

#[test]
fn numbers_that_are_none_or_huge_do_no_harm() {
    let odd = [f64::NAN, f64::INFINITY, 1e30, -1e200, 0.0, 1e-300];
    let strokes = odd.iter().flat_map(|&x| odd.map(|y| through(&[(x, y), (y, x), (1.0, x), (x, y)])));
    let arcs = odd.iter().flat_map(|&x| {
        odd.map(|y| Stroke {
            segments: vec![
                PathSegment::arc(p(x, y), y, p(y, 2.0)),
                PathSegment::cubic([p(x, 0.0), p(0.0, y)], p(1.0, 1.0)),
            ],
            ..Stroke::default()
        })
    });
    let all: Vec<Stroke> = strokes.chain(arcs).collect();
    for tolerance in [0.1, 0.0, -1.0, f64::NAN, f64::INFINITY, 1e300] {
        let mut drawing = of(all.clone());
        drawing.drop_doubles(tolerance);
        drawing.simplify(tolerance);
        drawing.fit_arcs(tolerance);
    }
    assert_eq!(Drawing::new().drop_doubles(0.1), Doubles::default());
}

/// A walk with noise: straight stretches, curves, turns back, and places twice.
fn walk() -> impl Strategy<Value = Vec<Point>> {
    let step = prop_oneof![
        4 => (0.0..0.3_f64, -0.1..0.1_f64),
        2 => (0.0..3.0_f64, -0.02..0.02_f64),
        1 => (0.0..1.0_f64, -PI..PI),
        1 => Just((0.0, 0.0)),
        1 => Just((0.5, PI)),
    ];
    (proptest::collection::vec(step, 1..120), any::<bool>()).prop_map(|(steps, is_closed)| {
        let (mut at, mut angle) = (p(50.0, 50.0), 0.0);
        let mut places = vec![at];
        for (length, turn) in steps {
            angle += turn;
            at += (p(length, 0.0) - Point::ORIGIN).rotated(angle);
            places.push(at);
        }
        if is_closed {
            places.push(places[0]);
        }
        places
    })
}

/// Douglas and Peucker's places.
fn halved(places: &[Point], tolerance: f64) -> usize {
    let (from, to) = (places[0], places[places.len() - 1]);
    let away = |at: &Point| Segment::new(from, to).distance(*at);
    let far = (0..places.len()).max_by(|&a, &b| away(&places[a]).total_cmp(&away(&places[b]))).unwrap();
    if away(&places[far]) <= tolerance {
        return 1;
    }
    halved(&places[..=far], tolerance) + halved(&places[far..], tolerance)
}

/// The fewest lines, by trying all.
fn fewest(places: &[Point], tolerance: f64) -> usize {
    let mut reached = vec![usize::MAX; places.len()];
    reached[0] = 0;
    for begin in 0..places.len() {
        for end in begin + 1..places.len() {
            let line = Segment::new(places[begin], places[end]);
            if places[begin..end].iter().all(|&place| line.distance(place) <= tolerance) {
                reached[end] = reached[end].min(reached[begin] + 1);
            }
        }
    }
    reached[places.len() - 1]
}

proptest! {
    #![proptest_config(cases(256))]
    #[test]
    fn fewer_lines_are_within_the_tolerance(places in walk(), tolerance in 0.001..0.5_f64) {
        let before = of([Stroke::through(places.iter().copied()).unwrap()]);
        let mut after = before.clone();
        let left_out = after.simplify(tolerance);
        let (old, new) = (pieces(&before, 0), pieces(&after, 0));
        prop_assert!(farthest_mm(&old, &new) <= tolerance + ROUNDING_MM);
        prop_assert!(farthest_mm(&new, &old) <= tolerance + ROUNDING_MM);
        let (one, other) = (&before.strokes[0], &after.strokes[0]);
        prop_assert_eq!((one.from, one.to(), one.is_closed()), (other.from, other.to(), other.is_closed()));
        prop_assert_eq!(one.segments.len() - left_out, other.segments.len());
        // Places are places of before, in their order.
        let mut rest = one.segments.iter();
        prop_assert!(other.segments.iter().all(|segment| rest.any(|old| old == segment)));
        if !one.is_closed() {
            prop_assert_eq!(other.segments.len(), fewest(&places, tolerance));
            prop_assert!(other.segments.len() <= halved(&places, tolerance));
        }
    }
}

#[test]
fn lines_of_different_speeds_and_arcs_stay_apart() {
    let mut stroke = through(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.0), (4.0, 0.0)]);
    stroke.segments[2].feed_mm_s = Some(5.0);
    stroke.segments[3].feed_mm_s = Some(5.0);
    stroke.segments.push(PathSegment::arc(p(4.0, 1.0), PI, p(4.0, 2.0)));
    stroke.segments.push(PathSegment::line(p(3.0, 2.0)));
    stroke.segments.push(PathSegment { power: Some(0.5), ..PathSegment::line(p(2.0, 2.0)) });
    let mut drawing = of([stroke.clone()]);
    assert_eq!(drawing.simplify(0.1), 2);
    assert_eq!(drawing.strokes[0].segments, [1, 3, 4, 5, 6].map(|index| stroke.segments[index]));
}

#[test]
fn a_closed_stroke_of_no_size_is_no_dot() {
    let mut drawing = of([through(&[(0.0, 0.0), (0.01, 0.0), (0.01, 0.01), (0.0, 0.01), (0.0, 0.0)])]);
    drawing.simplify(0.1);
    assert!(drawing.strokes[0].is_closed() && !drawing.strokes[0].is_dot());
}

/// A stroke of arcs and lines as lines, with some noise.
fn rounded() -> impl Strategy<Value = Vec<Point>> {
    let part = (0.3..20.0_f64, -1.9 * PI..1.9 * PI, 1..40_u8, any::<bool>());
    (proptest::collection::vec(part, 1..4), 0.0..0.01_f64).prop_map(|(parts, noise)| {
        let (mut at, mut angle, mut count) = (p(50.0, 50.0), 0.0_f64, 0.0_f64);
        let mut places = vec![at];
        for (size, turn, lines, is_line) in parts {
            for _ in 0..lines {
                let step = turn / f64::from(lines);
                let length =
                    if is_line { size / f64::from(lines) } else { 2.0 * size * (0.5 * step).sin().abs() };
                angle += if is_line { 0.0 } else { step };
                at += (p(length, 0.0) - Point::ORIGIN).rotated(angle - 0.5 * step);
                count += 1.0;
                places.push(p(at.x + noise * (7.0 * count).sin(), at.y + noise * (5.0 * count).cos()));
            }
        }
        places
    })
}

proptest! {
    // A case takes millions of distances.
    #![proptest_config(cases(32))]
    #[test]
    fn arcs_are_within_the_tolerance_and_end_where_the_lines_did(places in prop_oneof![rounded(), walk()], tolerance in 0.001..0.2_f64, bend in proptest::option::of(0.0..1.0_f64)) {
        let mut stroke = Stroke::through(places).unwrap();
        // Every fifth line is a curve.
        let lines_of_it: Vec<Point> = stroke.segments().map(|(from, _)| from).collect();
        if let Some(bend) = bend {
            for (segment, from) in stroke.segments.iter_mut().zip(lines_of_it).step_by(5) {
                let across = (segment.to - from).perpendicular() * bend;
                segment.shape = Shape::Cubic { handles: [from.lerp(segment.to, 0.3) + across, from.lerp(segment.to, 0.7) + across] };
            }
        }
        let before = of([stroke]);
        let mut after = before.clone();
        let arcs = after.fit_arcs(tolerance);
        let (old, new) = (pieces(&before, 0), pieces(&after, 0));
        let (lost, wrong) = (farthest_mm(&old, &new), farthest_mm(&new, &old));
        // A curve is measured as 200 lines.
        let most = tolerance + if bend.is_some() { 2e-4 } else { ROUNDING_MM };
        prop_assert!(lost <= most && wrong <= most, "{lost} {wrong} {tolerance}");
        prop_assert_eq!(after.check(), Ok(()));
        let mut begins = before.strokes[0].segments().map(|(from, segment)| (from, segment.to));
        let is_arc = |segment: &PathSegment| matches!(segment.shape, Shape::Arc { .. });
        prop_assert_eq!(after.segments().filter(|(_, _, segment)| is_arc(segment)).count(), arcs);
        for (_, from, segment) in after.segments() {
            prop_assert!(begins.clone().any(|line| line.0 == from));
            prop_assert!(begins.any(|line| line.1 == segment.to));
            if let Shape::Arc { centre, .. } = segment.shape {
                prop_assert!((from.distance(centre) - segment.to.distance(centre)).abs() < ROUNDING_MM);
            }
        }
    }

    #[test]
    fn an_arc_of_lines_is_one_arc(radius in 0.5..50.0_f64, begin in -PI..PI, sweep in 0.4..TAU - 0.1, lines in 36..400_u16) {
        let at = |share: f64| p(60.0, 60.0) + (p(radius, 0.0) - Point::ORIGIN).rotated(begin + sweep * share);
        let places = (0..=lines).map(|line| at(f64::from(line) / f64::from(lines)));
        let mut drawing = of([Stroke::through(places).unwrap()]);
        // Lines of less than a 36th of a turn are within 0.4 % of the radius.
        let tolerance = 0.004 * radius;
        prop_assert_eq!(drawing.fit_arcs(tolerance), 1);
        prop_assert_eq!(drawing.strokes[0].segments.len(), 1);
        prop_assert!((drawing.length_mm() - radius * sweep).abs() < 0.03 * radius);
    }
}

proptest! {
    #![proptest_config(cases(256))]
    /// HPGL rounds places to 0.025 mm: up to 0.018 mm beside the circle, at the ends of its arcs as well. So an
    /// arc through one of them may be 0.036 mm beside the next: with 0.03 mm one circle of 5,000 begins with a
    /// line.
    #[test]
    fn a_circle_rounded_to_units_is_two_arcs_at_most(x in 60.0..61.0_f64, y in 60.0..61.0_f64, radius in 2.0..30.0_f64, begin in 0.0..TAU, lines in 120..400_u16) {
        let round = |mm: f64| (mm / 0.025).round() * 0.025;
        let at = |line: u16| begin + TAU * f64::from(line % lines) / f64::from(lines);
        let mut places: Vec<Point> =
            (0..=lines).map(|line| p(round(x + radius * at(line).cos()), round(y + radius * at(line).sin()))).collect();
        places.dedup();
        let before = of([Stroke::through(places).unwrap()]);
        for (tolerance, most) in [(0.036, 2), (0.03, 4)] {
            let mut after = before.clone();
            prop_assert!(after.fit_arcs(tolerance) <= most);
            prop_assert!(after.strokes[0].segments.len() <= most);
            let (old, new) = (pieces(&before, 0), pieces(&after, 0));
            let off_mm = farthest_mm(&old, &new).max(farthest_mm(&new, &old));
            prop_assert!(off_mm <= tolerance + ROUNDING_MM, "{} mm", off_mm);
        }
    }
}

#[test]
fn circles_and_rounded_corners_are_arcs_and_corners_are_none() {
    let polygon = |sides: i32, radius: f64| {
        let places = (0..sides).chain([0]).map(|side| TAU * f64::from(side) / f64::from(sides));
        of([Stroke::through(places.map(|angle| p(radius * angle.cos(), radius * angle.sin()))).unwrap()])
    };
    for (sides, radius, segments) in
        [(360, 50.0, 1), (72, 5.0, 1), (36, 1.0, 1), (4, 10.0, 4), (4, 0.1, 4), (6, 0.1, 6), (8, 0.2, 8)]
    {
        let mut drawing = polygon(sides, radius);
        drawing.fit_arcs(0.01);
        assert_eq!(drawing.strokes[0].segments.len(), segments, "{sides} {radius}");
    }
    // A rectangle of 40 mm by 30 mm with corners of 5 mm, each of nine lines, and its sides of one line or
    // ten.
    for sides in [1, 10] {
        let mut places = vec![p(5.0, 0.0)];
        for (corner, to) in [p(35.0, 5.0), p(35.0, 25.0), p(5.0, 25.0), p(5.0, 5.0)].into_iter().zip([
            p(35.0, 0.0),
            p(40.0, 25.0),
            p(5.0, 30.0),
            p(0.0, 5.0),
        ]) {
            let from = places[places.len() - 1];
            places.extend((1..=sides).map(|part| from.lerp(to, f64::from(part) / f64::from(sides))));
            places.extend(
                (1..=9).map(|tenth| corner + (to - corner).rotated(f64::from(tenth) * 10.0_f64.to_radians())),
            );
        }
        let mut drawing = of([Stroke::through(places).unwrap()]);
        assert_eq!(drawing.fit_arcs(0.03), 4, "{sides}");
        drawing.simplify(0.03);
        assert_eq!(drawing.strokes[0].segments.len(), 8, "{sides}");
    }
    // A circle of four curves is an arc, and one of a curve is a quarter.
    let quarter = 4.0 / 3.0 * (PI / 8.0).tan() * 10.0;
    let curve = PathSegment::cubic([p(10.0, quarter), p(quarter, 10.0)], p(0.0, 10.0));
    let mut drawing = of([Stroke { from: p(10.0, 0.0), segments: vec![curve], ..Stroke::default() }]);
    assert_eq!(drawing.fit_arcs(0.01), 1);
    assert!((drawing.length_mm() - 5.0 * PI).abs() < 0.01);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn much_in_one_place_takes_no_square_of_the_time() {
    const MANY: u32 = 20_000;
    let dots = (0..MANY).map(|_| through(&[(5.0, 5.0)]));
    let line = (0..MANY).map(|_| through(&[(0.0, 0.0), (100.0, 70.0)]));
    let dashes = (0..MANY)
        .map(|dash| through(&[(0.01 * f64::from(dash), 9.0), (0.01 * f64::from(dash) + 0.006, 9.0)]));
    let longer = (0..MANY).map(|part| through(&[(0.0, 3.0), (100.0 + 0.01 * f64::from(part), 3.0)]));
    let over = (0..MANY).map(|_| through(&[(0.0, 9.0), (200.0, 9.0)]));
    let mut drawing = of(dots.chain(line).chain(dashes).chain(over).chain(longer));
    drawing.drop_doubles(1e-3);
    let length = 200.0 + 100.0_f64.hypot(70.0) + 100.0 + 0.01 * f64::from(MANY - 1);
    assert!((drawing.length_mm() - length).abs() < 1e-3, "{} {length}", drawing.length_mm());
    // A hundred thousand places on one line, in one place, and to and fro.
    let straight = Stroke::through((0..100_000).map(|at| p(1e-3 * f64::from(at), 0.0))).unwrap();
    let still = Stroke::through((0..100_000).map(|_| p(5.0, 0.0))).unwrap();
    let swing = Stroke::through(
        (0..100_000).map(|at| p(1e3 / f64::from(at + 1) * if at % 2 == 0 { 1.0 } else { -1.0 }, 0.0)),
    )
    .unwrap();
    let mut drawing = of([straight, still, swing]);
    drawing.simplify(0.01);
    assert_eq!(drawing.strokes[0].segments.len(), 1);
    drawing.fit_arcs(0.01);
}
