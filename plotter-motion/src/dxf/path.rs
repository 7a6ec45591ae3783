//! [`Bow`] and [`draw`]: arcs of an entity as they are seen, and its strokes whole or dashed.

use crate::drawing::affine::sin_cos;
use crate::drawing::{Affine, PathSegment, Shape, Stroke};
use crate::{PlotOp, Point, Vec2};
use alloc::collections::VecDeque;
use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};

/// Most dashes of one stroke; one with more is drawn whole: 100 m of them at 1 mm.
const MOST_DASHES: f64 = 100_000.0;

/// A part of an ellipse about a centre, with two half axes, within a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bow {
    pub(super) centre: Point,
    pub(super) axes: (Vec2, Vec2),
    /// Where it begins, counted from the first axis towards the second one.
    pub(super) from_rad: f64,
    pub(super) sweep_rad: f64,
}

impl Bow {
    /// Of a circle.
    pub(super) fn round(centre: Point, radius: f64, from_rad: f64, sweep_rad: f64) -> Self {
        let axes = (Vec2::new(radius, 0.0), Vec2::new(0.0, radius));
        Self { centre, axes, from_rad, sweep_rad }
    }

    /// How the circle of radius 1 is seen that it is in its own axes.
    fn seen(&self, plane: &Affine) -> Affine {
        Affine { x: plane.way(self.axes.0), y: plane.way(self.axes.1), origin: plane.apply(self.centre) }
    }

    /// Where it begins on the sheet.
    pub(super) fn from(&self, plane: &Affine) -> Point {
        self.seen(plane).apply(on_circle(self.from_rad))
    }

    /// Goes on with it. It ends at `to` where that is known better than by the angle. It stays an arc where
    /// the plane shows circles; elsewhere it becomes cubic curves.
    pub(super) fn draw(&self, plane: &Affine, to: Option<Point>, stroke: &mut Stroke) {
        let arc = PathSegment::arc(Point::ORIGIN, self.sweep_rad, on_circle(self.from_rad + self.sweep_rad));
        arc.mapped(on_circle(self.from_rad), &self.seen(plane), &mut stroke.segments);
        if let (Some(to), Some(last)) = (to, stroke.segments.last_mut()) {
            last.to = to;
        }
    }
}

fn on_circle(angle_rad: f64) -> Point {
    let (sin, cos) = sin_cos(angle_rad);
    Point::new(cos, sin)
}

/// The operations of a stroke: whole, or in dashes of `pattern`, mm. A stroke without a segment is a dot.
pub(super) fn draw(mut stroke: Stroke, pattern: &[f64], tolerance_mm: f64, ops: &mut VecDeque<PlotOp>) {
    if stroke.segments.is_empty() {
        stroke.segments.push(PathSegment::line(stroke.from));
    }
    if !pattern.is_empty() {
        without_curves(&mut stroke, tolerance_mm);
    }
    let Some(dashes) = Dashes::of(pattern, stroke.length_mm()) else {
        ops.extend(stroke.ops(tolerance_mm));
        return;
    };
    // Each segment with where it begins and ends along the stroke.
    let mut along_mm = 0.0;
    let segments: Vec<(Point, &PathSegment, f64, f64)> = stroke
        .segments()
        .map(|(from, segment)| {
            let begin_mm = along_mm;
            along_mm += segment.length_mm(from);
            (from, segment, begin_mm, along_mm)
        })
        .filter(|(.., begin_mm, end_mm)| end_mm > begin_mm)
        .collect();
    let mut rest = segments.as_slice();
    for (from_mm, to_mm) in dashes {
        // A dash begins in the first segment that ends behind its start; the last one ends where the stroke
        // does.
        while let [(.., end_mm), later @ ..] = rest
            && *end_mm <= from_mm
            && !later.is_empty()
        {
            rest = later;
        }
        let mut dash: Option<Stroke> = None;
        for (from, segment, begin_mm, end_mm) in rest {
            if *begin_mm >= to_mm && dash.is_some() {
                break;
            }
            let share = |mm: f64| ((mm - begin_mm) / (end_mm - begin_mm)).clamp(0.0, 1.0);
            let (begin, end) = (share(from_mm), share(to_mm));
            let start = segment.at(*from, begin);
            let dash = dash.get_or_insert_with(|| Stroke { from: start, ..Stroke::default() });
            dash.segments.push(segment.part(*from, begin, end));
        }
        ops.extend(dash.into_iter().flat_map(|dash| dash.ops(tolerance_mm)));
    }
}

/// Makes lines of cubic curves, of which parts cannot be taken by their length.
fn without_curves(stroke: &mut Stroke, tolerance_mm: f64) {
    let mut segments = Vec::with_capacity(stroke.segments.len());
    for (from, segment) in stroke.segments() {
        match segment.shape {
            Shape::Cubic { .. } => segments.extend(segment.places(from, tolerance_mm).map(PathSegment::line)),
            _ => segments.push(*segment),
        }
    }
    stroke.segments = segments;
}

/// Where the dashes of a stroke begin and end, as lengths from its start: each end of the stroke lies in a
/// dash, and both of these are equally long. A stroke shorter than the pattern is whole.
struct Dashes<'p> {
    pattern: &'p [f64],
    /// Which part of the pattern comes next, and where it begins.
    next: usize,
    at_mm: f64,
    first_mm: f64,
    length_mm: f64,
}

impl<'p> Dashes<'p> {
    fn of(pattern: &'p [f64], length_mm: f64) -> Option<Self> {
        let [dash_mm, rest @ ..] = pattern else { return None };
        let total_mm: f64 = pattern.iter().map(|part| libm::fabs(*part)).sum();
        let has_gaps = rest.iter().any(|part| *part < 0.0);
        if !has_gaps || *dash_mm < 0.0 || total_mm <= 0.0 || length_mm < total_mm {
            return None;
        }
        let patterns = libm::floor((length_mm - dash_mm) / total_mm);
        if patterns < 1.0 || patterns * rest.len() as f64 > MOST_DASHES {
            return None;
        }
        let first_mm = 0.5 * (length_mm - patterns * total_mm + dash_mm);
        Some(Self { pattern, next: 0, at_mm: 0.0, first_mm, length_mm })
    }
}

impl Iterator for Dashes<'_> {
    type Item = (f64, f64);

    fn next(&mut self) -> Option<(f64, f64)> {
        loop {
            // What is left when the last dash begins, but for rounding.
            if self.at_mm >= self.length_mm {
                return None;
            }
            let is_first = self.at_mm == 0.0;
            let part = self.pattern.get(self.next).copied()?;
            self.next = (self.next + 1) % self.pattern.len();
            let from_mm = self.at_mm;
            let mut long_mm = if is_first { self.first_mm } else { libm::fabs(part) };
            let is_last = self.next == 1 % self.pattern.len()
                && from_mm + self.first_mm * (1.0 + 1e-9) >= self.length_mm;
            if is_last {
                long_mm = self.length_mm - from_mm;
            }
            self.at_mm = if is_last { self.length_mm } else { from_mm + long_mm };
            if part >= 0.0 || is_first {
                return Some((from_mm, libm::fmin(from_mm + long_mm, self.length_mm)));
            }
        }
    }
}

/// The arc of a polyline by its bulge: the tangent of a quarter of the angle.
///
/// Source: Autodesk, *DXF Reference*, group 42 of LWPOLYLINE. With half the chord h and the bulge b the
/// radius is h (1 + b²) / 2b, so that the centre lies h (1 − b²) / 2b to the left of the chord.
pub(super) fn of_bulge(from: Point, to: Point, bulge: f64) -> Option<Bow> {
    let chord = to - from;
    // Straighter than this, the arc leaves its chord by less than a millionth of its length.
    if libm::fabs(bulge) < 2e-6 || chord.length_squared() <= 0.0 {
        return None;
    }
    let sweep_rad = (4.0 * libm::atan(bulge)).clamp(-TAU, TAU);
    let centre = from + chord * 0.5 + chord.perpendicular() * ((1.0 - bulge * bulge) / (4.0 * bulge));
    let out = from - centre;
    Some(Bow::round(centre, out.length(), libm::atan2(out.y, out.x), sweep_rad))
}

/// From one angle counter-clockwise to another: above 0, at most a whole turn.
pub(super) fn sweep(from_rad: f64, to_rad: f64) -> f64 {
    let sweep = libm::fmod(to_rad - from_rad, TAU);
    /// An arc shorter than this is a whole turn: programs write one as 0° to 360°, or from an angle to
    /// itself.
    const NONE_RAD: f64 = 1e-9;
    let sweep = if sweep < 0.0 { sweep + TAU } else { sweep };
    if (NONE_RAD..=TAU - NONE_RAD).contains(&sweep) { sweep } else { TAU }
}

/// Degrees in radians.
pub(super) fn rad(degrees: f64) -> f64 {
    degrees * (PI / 180.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dashes(pattern: &[f64], length_mm: f64) -> Vec<(f64, f64)> {
        Dashes::of(pattern, length_mm).map(Iterator::collect).unwrap_or_default()
    }

    #[test]
    fn both_ends_lie_in_dashes_that_are_equally_long() {
        // 2 patterns of 3 mm and a dash of 2: 8 of 9 mm, so that each end gets half of what is left.
        assert_eq!(dashes(&[2.0, -1.0], 9.0), [(0.0, 2.5), (3.5, 5.5), (6.5, 9.0)]);
        assert_eq!(dashes(&[2.0, -1.0], 2.9), []);
        // Dashes and dots.
        assert_eq!(dashes(&[2.0, -1.0, 0.0, -1.0], 6.0), [(0.0, 2.0), (3.0, 3.0), (4.0, 6.0)]);
        assert_eq!(dashes(&[1.0, -1e-9], 1e9), []);
    }

    #[test]
    fn a_bulge_of_one_is_half_a_circle() {
        let bow = of_bulge(Point::ORIGIN, Point::new(2.0, 0.0), 1.0).unwrap();
        assert_eq!((bow.centre, bow.sweep_rad), (Point::new(1.0, 0.0), PI));
        // A quarter: its centre is above the chord, half a chord away.
        let bow = of_bulge(Point::ORIGIN, Point::new(2.0, 0.0), libm::tan(PI / 8.0)).unwrap();
        assert!(bow.centre.distance(Point::new(1.0, 1.0)) < 1e-12);
        assert_eq!(of_bulge(Point::ORIGIN, Point::new(2.0, 0.0), 0.0), None);
    }

    fn drawn(bow: Bow, plane: &Affine, pattern: &[f64]) -> VecDeque<PlotOp> {
        let mut stroke = Stroke { from: bow.from(plane), ..Stroke::default() };
        bow.draw(plane, None, &mut stroke);
        let mut ops = VecDeque::new();
        draw(stroke, pattern, 0.01, &mut ops);
        ops
    }

    #[test]
    fn dashes_of_an_arc_are_arcs() {
        let ops = drawn(Bow::round(Point::ORIGIN, 1.0, 0.0, PI), &Affine::IDENTITY, &[1.0, -0.5]);
        assert!(ops.iter().all(|op| matches!(op, PlotOp::Travel { .. } | PlotOp::DrawArc { .. })));
        let turn = |op: &PlotOp| if let PlotOp::DrawArc { sweep_rad, .. } = op { *sweep_rad } else { 0.0 };
        let turned: f64 = ops.iter().map(turn).sum();
        // A pattern and a dash, one gap.
        assert!((turned - (PI - 0.5)).abs() < 1e-12, "{turned}");
        let end = ops.back().and_then(|op| op.target()).unwrap();
        assert!(end.distance(Point::new(-1.0, 0.0)) < 1e-12, "{end:?}");
    }

    #[test]
    fn dashes_go_round_corners_and_dots_are_drawn() {
        let corner = [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0)].map(|(x, y)| Point::new(x, y));
        let places = |pattern: &[f64]| -> Vec<Point> {
            let mut ops = VecDeque::new();
            draw(Stroke::through(corner).unwrap(), pattern, 0.01, &mut ops);
            ops.iter().filter_map(|op| op.target()).collect()
        };
        // 6 mm are two patterns and a dash, and half a millimetre more for each end.
        let expected = [(0.0, 0.0), (1.5, 0.0), (2.5, 0.0), (3.0, 0.0), (3.0, 0.5), (3.0, 1.5), (3.0, 3.0)];
        assert_eq!(places(&[1.0, -1.0]), expected.map(|(x, y)| Point::new(x, y)));
        // Two dashes of 2 mm with a dot between them, at the corner.
        let expected = [(0.0, 0.0), (2.0, 0.0), (3.0, 0.0), (3.0, 0.0), (3.0, 1.0), (3.0, 3.0)];
        assert_eq!(places(&[2.0, -1.0, 0.0, -1.0]), expected.map(|(x, y)| Point::new(x, y)));
    }

    #[test]
    fn what_is_seen_askew_is_chords_within_the_tolerance() {
        let plane = Affine::scaled(3.0, 1.0);
        for pattern in [&[][..], &[5.0, -0.01]] {
            let ops = drawn(Bow::round(Point::ORIGIN, 1.0, 0.0, TAU), &plane, pattern);
            let places: Vec<Point> = ops.iter().filter_map(|op| op.target()).collect();
            for pair in places.windows(2) {
                let middle = pair[0].lerp(pair[1], 0.5);
                let radius = libm::hypot(middle.x / 3.0, middle.y);
                assert!(1.0 - radius < 0.011, "{radius}");
            }
            assert!((16..60).contains(&places.len()), "{}", places.len());
        }
    }
}
