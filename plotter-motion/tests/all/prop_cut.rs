//! Laws of cropping, of hiding and of hatching: against a test of places in polygons of its own.

use crate::law_cases::cases;
use core::f64::consts::{PI, TAU};
use core::time::Duration;
use plotter_motion::drawing::{
    Bounds, CutCount, Drawing, HatchError, HatchTogether, Hatching, Hides, Keep, Mark, PathSegment, Region,
    Shape, Stroke,
};
use plotter_motion::{Point, Segment};
use proptest::prelude::*;

/// How far beyond the border a place of what is left may lie, mm.
const BORDER_MM: f64 = 1e-9;
/// Length of pieces that go, mm.
const DUST_MM: f64 = 1e-4;
/// How near the border places are not asked for, mm: lines that touch it may go.
const NEAR_MM: f64 = 1e-5;

fn place() -> impl Strategy<Value = Point> {
    // Whole numbers now and then, so that lines run along borders and through corners.
    let number = prop_oneof![2 => -50.0..50.0, 1 => (-5..=5_i32).prop_map(|tens| 10.0 * f64::from(tens))];
    (number.clone(), number).prop_map(|(x, y)| Point::new(x, y))
}

fn segment(from: Point) -> impl Strategy<Value = PathSegment> {
    prop_oneof![
        place().prop_map(PathSegment::line),
        // Some arcs end nearer to their centre than they begin, or farther from it.
        (place(), -TAU..TAU, prop_oneof![Just(1.0), 0.99..1.01]).prop_map(
            move |(centre, sweep_rad, growth)| {
                PathSegment::arc(centre, sweep_rad, centre + (from - centre).rotated(sweep_rad) * growth)
            }
        ),
        (place(), place(), place()).prop_map(|(a, b, to)| PathSegment::cubic([a, b], to)),
    ]
}

fn stroke() -> impl Strategy<Value = Stroke> {
    let mark = (1..5000_u64).prop_map(|ms| Mark::Dwell(Duration::from_millis(ms)));
    (place(), proptest::collection::vec(mark, 0..2), any::<bool>()).prop_flat_map(
        |(from, before, is_closed)| {
            segment(from).prop_flat_map(move |first| {
                let before = before.clone();
                segment(first.to).prop_map(move |second| {
                    let mut segments = vec![first, second];
                    if is_closed {
                        segments.push(PathSegment::line(from));
                    }
                    Stroke { pen: 1, layer: 0, before: before.clone(), from, segments }
                })
            })
        },
    )
}

fn drawing() -> impl Strategy<Value = Drawing> {
    proptest::collection::vec(stroke(), 0..5).prop_map(|strokes| Drawing {
        strokes,
        after: vec![Mark::Dwell(Duration::from_secs(9))],
        ..Drawing::default()
    })
}

fn polygon() -> impl Strategy<Value = Vec<Point>> {
    prop_oneof![
        proptest::collection::vec(place(), 3..8),
        (place(), place()).prop_map(|(a, b)| Bounds::between(a, b).corners().to_vec()),
    ]
}

fn edges(polygon: &[Point]) -> impl Iterator<Item = Segment> + '_ {
    polygon.iter().zip(polygon.iter().cycle().skip(1)).map(|(from, to)| Segment::new(*from, *to))
}

fn to_border_mm(polygon: &[Point], at: Point) -> f64 {
    edges(polygon).map(|edge| edge.distance(at)).fold(f64::INFINITY, f64::min)
}

/// By the sum of the angles under which the edges are seen: the number of turns is odd.
fn is_inside(polygon: &[Point], at: Point) -> bool {
    let angle = |edge: Segment| {
        let (from, to) = (edge.from - at, edge.to - at);
        libm::atan2(from.cross(to), from.dot(to))
    };
    (edges(polygon).map(angle).sum::<f64>() / TAU).round().rem_euclid(2.0) == 1.0
}

fn samples(drawing: &Drawing) -> Vec<(u8, Point)> {
    let shares = (0..=20).map(|index| f64::from(index) / 20.0);
    drawing
        .segments()
        .flat_map(|(stroke, from, segment)| {
            shares.clone().map(move |share| (stroke.pen, segment.at(from, share)))
        })
        .collect()
}

/// Whether a place is drawn by a pen, but for the tolerance of the lines that curves are made of here.
fn is_drawn(drawing: &Drawing, pen: u8, at: Point) -> bool {
    const LINES_MM: f64 = 1e-3;
    drawing.strokes.iter().filter(|stroke| stroke.pen == pen).any(|stroke| {
        let places: Vec<Point> = stroke.places(LINES_MM).collect();
        places.windows(2).any(|pair| Segment::new(pair[0], pair[1]).distance(at) <= 3.0 * LINES_MM)
    })
}

fn marks(drawing: &Drawing) -> Vec<Mark> {
    drawing.strokes.iter().flat_map(|stroke| &stroke.before).chain(&drawing.after).copied().collect()
}

fn check_crop(drawing: &Drawing, polygon: &[Point]) -> Result<(), TestCaseError> {
    let region = Region::polygons([polygon.iter().copied()]);
    let (mut inner, mut outer) = (drawing.clone(), drawing.clone());
    let count = inner.crop(&region, Keep::Inside);
    outer.crop(&region, Keep::Outside);
    prop_assert!(count.removed <= drawing.strokes.len());
    for (_, at) in samples(&inner) {
        let off = to_border_mm(polygon, at);
        prop_assert!(is_inside(polygon, at) || off <= BORDER_MM, "{at:?} {off}");
    }
    for (_, at) in samples(&outer) {
        let off = to_border_mm(polygon, at);
        prop_assert!(!is_inside(polygon, at) || off <= BORDER_MM, "{at:?} {off}");
    }
    for (pen, at) in samples(drawing) {
        if to_border_mm(polygon, at) > NEAR_MM {
            let kept = if is_inside(polygon, at) { &inner } else { &outer };
            prop_assert!(is_drawn(kept, pen, at), "{at:?}");
        }
    }
    let (parts, all) = (inner.length_mm() + outer.length_mm(), drawing.length_mm());
    let pieces = 1 + inner.strokes.len() + outer.strokes.len();
    prop_assert!((parts - all).abs() <= 1e-6 * all + DUST_MM * pieces as f64, "{parts} {all}");
    prop_assert_eq!(marks(&inner), marks(drawing));
    prop_assert_eq!(marks(&outer), marks(drawing));
    let mut again = inner.clone();
    again.crop(&region, Keep::Inside);
    prop_assert!((again.length_mm() - inner.length_mm()).abs() <= 1e-6 * (1.0 + all));
    Ok(())
}

proptest! {
    #![proptest_config(cases(256))]
    #[test]
    fn what_lies_inside_stays_and_the_rest_lies_outside(drawing in drawing(), polygon in polygon()) {
        check_crop(&drawing, &polygon)?;
    }

    #[test]
    fn a_rectangle_crops_as_its_polygon_does(drawing in drawing(), a in place(), b in place()) {
        let bounds = Bounds::between(a, b);
        let (mut one, mut other) = (drawing.clone(), drawing);
        one.crop_to_rectangle(bounds);
        other.crop_to_polygon(&bounds.corners());
        prop_assert!((one.length_mm() - other.length_mm()).abs() <= 1e-6 * (1.0 + other.length_mm()));
        for (_, at) in samples(&one) {
            let over = [bounds.least.x - at.x, bounds.least.y - at.y, at.x - bounds.most.x, at.y - bounds.most.y];
            prop_assert!(over.into_iter().all(|over| over <= BORDER_MM), "{at:?}");
        }
    }

    #[test]
    fn later_closed_strokes_hide_what_lies_within_them(polygons in proptest::collection::vec((polygon(), any::<bool>()), 1..6)) {
        let mut drawing = Drawing::default();
        for (pen, (polygon, is_closed)) in (1_u8..).zip(&polygons) {
            let last = is_closed.then_some(polygon[0]);
            let stroke = Stroke::through(polygon.iter().copied().chain(last)).unwrap();
            drawing.strokes.push(Stroke { pen, ..stroke });
        }
        let mut seen = drawing.clone();
        seen.occlude(Hides::All, 0.01);
        // One that comes back to its first place by chance is closed, too.
        let is_closed = |(polygon, is_closed): &&(Vec<Point>, bool)| *is_closed || polygon.first() == polygon.last();
        let above = |pen: u8| polygons.iter().skip(usize::from(pen)).filter(is_closed);
        for (pen, at) in samples(&seen) {
            for (polygon, _) in above(pen) {
                let off = to_border_mm(polygon, at);
                prop_assert!(!is_inside(polygon, at) || off <= BORDER_MM, "{at:?} {off}");
            }
        }
        for (pen, at) in samples(&drawing) {
            if above(pen).all(|(polygon, _)| !is_inside(polygon, at) && to_border_mm(polygon, at) > NEAR_MM) {
                prop_assert!(is_drawn(&seen, pen, at), "{pen} {at:?}");
            }
        }
        let mut own = drawing.clone();
        prop_assert_eq!(own.occlude(Hides::SamePen, 0.01), CutCount::default());
        prop_assert_eq!(own, drawing);
    }

    #[test]
    fn discs_hide_what_lies_within_them(discs in proptest::collection::vec((place(), 0.5..40.0_f64), 1..6)) {
        const TOLERANCE_MM: f64 = 0.01;
        let mut drawing = Drawing::default();
        for (pen, (centre, radius)) in (1_u8..).zip(&discs) {
            drawing.strokes.push(Stroke { pen, ..circle(*centre, *radius) });
        }
        let mut seen = drawing.clone();
        seen.occlude(Hides::All, TOLERANCE_MM);
        let depth = |pen: u8, at: Point| {
            discs.iter().skip(usize::from(pen)).map(|(centre, radius)| radius - at.distance(*centre)).fold(f64::MIN, f64::max)
        };
        for (pen, at) in samples(&seen) {
            prop_assert!(depth(pen, at) <= TOLERANCE_MM, "{at:?}");
        }
        for (pen, at) in samples(&drawing) {
            prop_assert!(depth(pen, at) > -2.0 * TOLERANCE_MM || is_drawn(&seen, pen, at), "{pen} {at:?}");
        }
    }

    #[test]
    fn hatch_lines_lie_within_at_their_distance_and_cover_the_area(
        polygons in proptest::collection::vec(polygon(), 1..4),
        angle_rad in prop_oneof![Just(0.0), Just(PI / 2.0), -TAU..TAU],
        distance_mm in 0.3..5.0_f64,
    ) {
        let strokes = polygons.iter().filter_map(|polygon| {
            Stroke::through(polygon.iter().copied().chain([polygon[0]]))
        });
        let mut drawing = Drawing { strokes: strokes.collect(), ..Drawing::default() };
        let outlines = drawing.strokes.len();
        let perimeter_mm = drawing.length_mm();
        let mut hatching = Hatching::default();
        (hatching.distance_mm, hatching.angle_rad) = (distance_mm, angle_rad);
        let count = drawing.hatch(&hatching, |_| true).unwrap();
        prop_assert_eq!(count, drawing.strokes.len() - outlines);
        let lines = &drawing.strokes[outlines..];
        let (sin, cos) = angle_rad.sin_cos();
        let row = |at: Point| (cos * at.y - sin * at.x) / distance_mm - 0.5;
        let mut length_mm = 0.0;
        for line in lines {
            let (from, to) = (line.from, line.to());
            prop_assert!((row(from) - row(from).round()).abs() < 1e-9 && (row(from) - row(to)).abs() < 1e-9);
            for share in [0.01, 0.3, 0.5, 0.9] {
                let at = from.lerp(to, share);
                let inside = polygons.iter().filter(|polygon| is_inside(polygon, at)).count() % 2 == 1;
                let is_border = polygons.iter().any(|polygon| to_border_mm(polygon, at) <= 1e-6);
                prop_assert!(inside || is_border, "{at:?}");
            }
            length_mm += from.distance(to);
        }
        // Each row stands for its strip, and each middle for its square: wrong where an outline runs through,
        // at the most.
        let area_mm2 = area_mm2(&polygons);
        let most = (distance_mm + 1.0) * perimeter_mm;
        prop_assert!((length_mm * distance_mm - area_mm2).abs() <= most, "{length_mm} {area_mm2}");
    }
}

/// A rectangle between whole millimetres: left, right, lower and upper.
type Sides = [i32; 4];

fn sides() -> impl Strategy<Value = Sides> {
    (0..12_i32, 1..9_i32, 0..12_i32, 1..9_i32).prop_map(|(x, width, y, height)| [x, x + width, y, y + height])
}

proptest! {
    #[test]
    fn what_is_hatched_first_and_hidden_then_is_what_is_seen_of_each_shape(
        rectangles in proptest::collection::vec((sides(), 1..3_u8), 1..9),
    ) {
        let stroke = |([left, right, lower, upper], pen): &(Sides, u8)| {
            let corner = |x: i32, y: i32| Point::new(f64::from(x), f64::from(y));
            let corners = Bounds::between(corner(*left, *lower), corner(*right, *upper)).corners();
            let stroke = Stroke::through(corners.into_iter().chain([corners[0]])).unwrap();
            Stroke { pen: *pen, ..stroke }
        };
        let mut drawing = drawing_of(rectangles.iter().map(stroke));
        let mut hatching = Hatching::default();
        (hatching.angle_rad, hatching.together) = (0.0, HatchTogether::Within);
        drawing.hatch(&hatching, |_| true).unwrap();
        drawing.occlude(Hides::All, 0.01);
        // Within another one of its pen that is filled, it is a hole.
        let mut filled: Vec<bool> = Vec::new();
        for (index, (own, pen)) in rectangles.iter().enumerate() {
            let holds = |[left, right, lower, upper]: Sides| {
                left < own[0] && own[1] < right && lower < own[2] && own[3] < upper
            };
            let around = (0..index).rev().find(|other| rectangles[*other].1 == *pen && holds(rectangles[*other].0));
            filled.push(around.is_none_or(|around| !filled[around]));
        }
        // Lines run through the middles of squares of 1 mm: each square is drawn by the shape on top of it.
        let mut squares = [0.0; 3];
        for (x, y) in (0..21).flat_map(|x| (0..21).map(move |y| (x, y))) {
            let has = |[left, right, lower, upper]: Sides| (left..right).contains(&x) && (lower..upper).contains(&y);
            let top = rectangles.iter().zip(&filled).rev().find(|((sides, _), _)| has(*sides));
            if let Some(((_, pen), true)) = top {
                squares[usize::from(*pen)] += 1.0;
            }
        }
        for pen in 1..3 {
            let lines = drawing.strokes.iter().filter(|stroke| stroke.pen == pen && (stroke.from.y + 0.5).fract() == 0.0);
            let lines = lines.filter(|stroke| stroke.to().y == stroke.from.y && stroke.segments.len() == 1);
            let length_mm: f64 = lines.map(Stroke::length_mm).sum();
            prop_assert!((length_mm - squares[usize::from(pen)]).abs() < 1e-6, "pen {pen}: {length_mm} {squares:?}");
        }
    }
}

/// The area within an odd number of polygons, by counting the middles of squares of 1 mm.
fn area_mm2(polygons: &[Vec<Point>]) -> f64 {
    let middles = || (-50..50).map(|at| f64::from(at) + 0.5);
    let inside = middles()
        .flat_map(|x| middles().map(move |y| Point::new(x, y)))
        .filter(|at| polygons.iter().filter(|polygon| is_inside(polygon, *at)).count() % 2 == 1);
    inside.fold(0.0, |area, _| area + 1.0)
}

fn circle(centre: Point, radius_mm: f64) -> Stroke {
    let from = Point::new(centre.x + radius_mm, centre.y);
    Stroke { from, segments: vec![PathSegment::arc(centre, TAU, from)], ..Stroke::default() }
}

fn square(least: f64, most: f64) -> Stroke {
    let corners = Bounds::between(Point::new(least, least), Point::new(most, most)).corners();
    Stroke::through(corners.into_iter().chain([corners[0]])).unwrap()
}

fn line(from: (f64, f64), to: (f64, f64)) -> Stroke {
    Stroke::through([Point::new(from.0, from.1), Point::new(to.0, to.1)]).unwrap()
}

fn dot(x: f64, y: f64) -> Stroke {
    Stroke::through([Point::new(x, y)]).unwrap()
}

fn drawing_of(strokes: impl IntoIterator<Item = Stroke>) -> Drawing {
    Drawing { strokes: strokes.into_iter().collect(), ..Drawing::default() }
}

#[test]
fn what_touches_the_border_is_not_cut() {
    let region = Region::rectangle(Bounds::between(Point::new(0.0, 0.0), Point::new(10.0, 10.0)));
    let within =
        drawing_of([circle(Point::new(5.0, 5.0), 5.0), square(0.0, 10.0), line((0.0, 10.0), (10.0, 0.0))]);
    let mut cropped = within.clone();
    assert_eq!(cropped.crop(&region, Keep::Inside), CutCount::default());
    assert_eq!(cropped, within);
    let without = drawing_of([
        circle(Point::new(15.0, 5.0), 5.0),
        line((-5.0, 5.0), (5.0, -5.0)),
        line((9.0, 11.0), (11.0, 9.0)),
    ]);
    let mut cropped = without.clone();
    assert_eq!(cropped.crop(&region, Keep::Outside), CutCount::default());
    assert_eq!(cropped, without);
    let mut cropped = without;
    assert_eq!(cropped.crop(&region, Keep::Inside), CutCount { removed: 3, shortened: 0 });
}

#[test]
fn a_closed_stroke_goes_on_through_the_place_where_it_began() {
    // It begins within the rectangle, leaves it and comes back.
    let mut drawing = drawing_of([square(0.0, 10.0)]);
    drawing.strokes[0].before.push(Mark::PutPenAway);
    let count = drawing.crop_to_rectangle(Bounds::between(Point::new(-1.0, -1.0), Point::new(4.0, 4.0)));
    assert_eq!(count, CutCount { removed: 0, shortened: 1 });
    let places: Vec<Point> = drawing.strokes[0].places(1.0).collect();
    assert_eq!(places, [Point::new(0.0, 4.0), Point::new(0.0, 0.0), Point::new(4.0, 0.0)]);
    assert_eq!((drawing.strokes.len(), drawing.strokes[0].before.as_slice()), (1, &[Mark::PutPenAway][..]));
}

#[test]
fn marks_of_strokes_that_go_happen_before_the_next_one_or_at_the_end() {
    let with =
        |ms: u64, stroke: Stroke| Stroke { before: vec![Mark::Dwell(Duration::from_millis(ms))], ..stroke };
    let mut drawing = drawing_of([with(1, dot(50.0, 0.0)), with(2, dot(0.0, 0.0)), with(3, dot(0.0, 50.0))]);
    drawing.after.push(Mark::PutPenAway);
    let before = marks(&drawing);
    let all = Bounds::between(Point::new(-1.0, -1.0), Point::new(1.0, 1.0));
    assert_eq!(drawing.crop_to_rectangle(all), CutCount { removed: 2, shortened: 0 });
    assert_eq!((drawing.strokes.len(), drawing.strokes[0].before.len(), drawing.after.len()), (1, 2, 2));
    assert_eq!(marks(&drawing), before);
}

#[test]
fn the_same_shape_again_hides_the_first_one_and_its_dots() {
    for shape in [square(0.0, 10.0), circle(Point::new(5.0, 5.0), 5.0)] {
        let mut drawing = drawing_of([shape.clone(), dot(3.0, 4.0), dot(0.1, 9.9), shape.clone()]);
        drawing.occlude(Hides::All, 0.01);
        let in_corner = usize::from(shape.segments.len() == 1);
        assert_eq!(drawing.strokes.len(), 1 + in_corner, "{drawing:?}");
        assert_eq!(drawing.strokes[in_corner], shape);
    }
}

#[test]
fn shapes_hide_nothing_on_other_sheets_pens_or_layers() {
    let hidden = Stroke { pen: 1, layer: 1, ..line((1.0, 1.0), (2.0, 2.0)) };
    let above = Stroke { pen: 1, layer: 2, ..square(0.0, 10.0) };
    let both = Drawing { layers: vec!["a".into(), "b".into()], ..drawing_of([hidden, above]) };
    for (hides, left) in [(Hides::All, 1), (Hides::SamePen, 1), (Hides::SameLayer, 2)] {
        let mut drawing = both.clone();
        drawing.occlude(hides, 0.01);
        assert_eq!(drawing.strokes.len(), left, "{hides:?}");
    }
    let mut turned = both;
    turned.strokes[1].before.push(Mark::NewPage);
    assert_eq!(turned.occlude(Hides::All, 0.01), CutCount::default());
}

#[test]
fn hatches_keep_to_their_pen_layer_and_sheet() {
    let ring = |pen: u8| [square(0.0, 10.0), square(3.0, 7.0)].map(|stroke| Stroke { pen, ..stroke });
    let mut drawing = drawing_of(ring(1).into_iter().chain(ring(2)));
    drawing.strokes[2].before.push(Mark::NewPage);
    drawing.strokes[0].segments[0].feed_mm_s = Some(7.0);
    drawing.strokes[0].segments[0].power = Some(0.25);
    let mut hatching = Hatching::default();
    hatching.angle_rad = 0.0;
    // Ten lines, of which four are in two parts: 14, of 10 · 10 − 4 · 4 mm.
    assert_eq!(drawing.hatch(&hatching, |stroke| stroke.pen == 1), Ok(14));
    let lines = &drawing.strokes[2..16];
    assert!((lines.iter().map(Stroke::length_mm).sum::<f64>() - 84.0).abs() < 1e-9);
    let style = |stroke: &Stroke| (stroke.pen, stroke.segments[0].feed_mm_s, stroke.segments[0].power);
    assert!(lines.iter().all(|line| style(line) == (1, Some(7.0), Some(0.25))));
    // The pen never goes farther between them than across the hole and to the next row.
    assert!(lines.windows(2).all(|pair| pair[0].to().distance(pair[1].from) < 4.2), "{lines:?}");
    assert_eq!((drawing.strokes.len(), drawing.strokes[16].before.len()), (18, 1));
}

#[test]
fn rings_in_rings_are_hatched_as_rings_whether_hidden_or_not() {
    // A ring with an island in its hole, and the same square once more on top of all: nothing of the others
    // is seen.
    let rings = || [square(0.0, 12.0), square(2.0, 10.0), square(4.0, 8.0)];
    let mut hatching = Hatching::default();
    hatching.angle_rad = 0.0;
    for together in [HatchTogether::All, HatchTogether::Within] {
        hatching.together = together;
        let mut drawing = drawing_of(rings());
        drawing.hatch(&hatching, |_| true).unwrap();
        drawing.occlude(Hides::All, 0.01);
        let lines_mm = drawing.length_mm() - 4.0 * (12.0 + 8.0 + 4.0);
        // Behind the last one they are hidden by none; so are those that stand behind their own.
        assert!((lines_mm - (144.0 - 64.0 + 16.0)).abs() < 1e-9, "{together:?}: {lines_mm}");
    }
    let mut twice = drawing_of(rings().into_iter().chain([square(0.0, 12.0)]));
    twice.hatch(&hatching, |_| true).unwrap();
    twice.occlude(Hides::All, 0.01);
    assert!((twice.length_mm() - (48.0 + 144.0)).abs() < 1e-9, "{}", twice.length_mm());
}

#[test]
fn hatches_that_cannot_be_are_refused_with_a_remedy() {
    let mut drawing = drawing_of([square(0.0, 1000.0)]);
    let mut hatching = Hatching::default();
    for distance_mm in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        hatching.distance_mm = distance_mm;
        assert!(matches!(drawing.hatch(&hatching, |_| true), Err(HatchError::Distance { .. })));
    }
    hatching.distance_mm = 0.001;
    let error = drawing.hatch(&hatching, |_| true).unwrap_err();
    let text = error.to_string();
    assert!(text.ends_with("lines, more than 100000: choose a greater distance"), "{text}");
    hatching.distance_mm = 1e-300;
    assert!(drawing.hatch(&hatching, |_| true).is_err());
    (hatching.distance_mm, hatching.angle_rad) = (1.0, f64::NAN);
    assert!(matches!(drawing.hatch(&hatching, |_| true), Err(HatchError::Angle { .. })));
    assert_eq!(drawing.strokes.len(), 1);
}

#[test]
fn odd_drawings_end_soon() {
    let far = [1e30, -1e30, 1e300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, 1.0];
    let mut drawing = Drawing::default();
    for (index, x) in far.into_iter().enumerate() {
        let (here, there) = (Point::new(x, far[(index + 3) % 8]), Point::new(far[(index + 5) % 8], 1.0));
        for sweep_rad in [1.0, 1e300, f64::INFINITY, f64::NAN] {
            for shape in [
                Shape::Line,
                Shape::Arc { centre: there, sweep_rad },
                Shape::Cubic { handles: [there, here] },
            ] {
                let segments =
                    vec![PathSegment { shape, ..PathSegment::line(there) }, PathSegment::line(here)];
                drawing.strokes.push(Stroke { from: here, segments, ..Stroke::default() });
            }
        }
    }
    let pile = core::iter::repeat_n([dot(1.0, 1.0), square(0.0, 2.0)], 5_000).flatten();
    drawing.strokes.splice(0..0, pile);
    let mut cropped = drawing.clone();
    cropped.crop_to_rectangle(Bounds::between(Point::new(0.0, 0.0), Point::new(f64::INFINITY, 1e300)));
    cropped.crop_to_polygon(&[]);
    assert!(cropped.strokes.is_empty());
    let mut hatched = drawing.clone();
    hatched.strokes.push(square(1e29, 1e30));
    assert!(hatched.hatch(&Hatching::default(), |_| true).is_err());
    drawing.occlude(Hides::All, f64::NAN);
    assert!(drawing.strokes.len() < 200, "{}", drawing.strokes.len());
    let mut empty = Drawing::new();
    empty.occlude(Hides::All, 0.01);
    empty.crop_to_rectangle(Bounds::default());
    assert_eq!((empty.hatch(&Hatching::default(), |_| true), &empty), (Ok(0), &Drawing::new()));
}
