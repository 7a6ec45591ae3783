//! [`Path`]: the lines and arcs of an entity on the sheet, whole or dashed.

use super::frame::{Plane, sin_cos};
use crate::{PlotOp, Point, Vec2};
use alloc::collections::VecDeque;
use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};

/// Most chords of one ellipse: as far apart as 0.01 mm allows on one of 1 km.
const MOST_CHORDS: f64 = 65_536.0;
/// Most dashes of one path; one with more is drawn whole.
const MOST_DASHES: f64 = 100_000.0;

/// A stretch of a path, from where the one before it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stretch {
    Line { to: Point },
    Arc { centre: Point, sweep_rad: f64, to: Point },
}

/// Lines and arcs that follow each other, mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Path {
    from: Point,
    stretches: Vec<Stretch>,
}

impl Path {
    pub(super) fn new(from: Point) -> Self {
        Self { from, stretches: Vec::new() }
    }

    fn end(&self) -> Point {
        match self.stretches.last() {
            Some(Stretch::Line { to } | Stretch::Arc { to, .. }) => *to,
            None => self.from,
        }
    }

    pub(super) fn line_to(&mut self, to: Point) {
        self.stretches.push(Stretch::Line { to });
    }

    /// An arc of the circle with this radius about `centre`, both within `plane`, counter-clockwise where `sweep_rad` is above 0. It
    /// ends at `to` where that is known better than by the angle. Arcs stay arcs where the plane is seen without distortion; elsewhere
    /// they become chords within `tolerance_mm`.
    ///
    /// The chords of an ellipse are at most as far from it as those of the circle about it that touches its longer axis, which divide
    /// it at equal angles: r (1 − cos(step / 2)).
    pub(super) fn arc(
        &mut self,
        plane: &Plane,
        centre: Vec2,
        axes: (Vec2, Vec2),
        (from_rad, sweep_rad): (f64, f64),
        to: Option<Point>,
        tolerance_mm: f64,
    ) {
        let seen = Plane { x: plane.way(axes.0), y: plane.way(axes.1), origin: plane.place(centre) };
        let at = |angle_rad: f64| {
            let (sin, cos) = sin_cos(angle_rad);
            seen.place(Vec2::new(cos, sin))
        };
        let to = to.unwrap_or_else(|| at(from_rad + sweep_rad));
        if let Some((_, sense)) = seen.similar() {
            self.stretches.push(Stretch::Arc { centre: seen.origin, sweep_rad: sense * sweep_rad, to });
            return;
        }
        let radius_mm = longer_axis(&seen);
        let half_step =
            libm::acos((1.0 - tolerance_mm / libm::fmax(radius_mm, tolerance_mm)).clamp(-1.0, 1.0));
        let chords = libm::ceil(libm::fabs(sweep_rad) / (2.0 * half_step)).clamp(4.0, MOST_CHORDS);
        let mut chord = 1.0;
        while chord < chords {
            self.line_to(at(from_rad + sweep_rad * (chord / chords)));
            chord += 1.0;
        }
        self.line_to(to);
    }

    /// As operations: whole, or in dashes of `pattern`, mm.
    pub(super) fn draw(&self, pattern: &[f64], ops: &mut VecDeque<PlotOp>) {
        let Some(dashes) = Dashes::of(pattern, self.length_mm()) else {
            ops.push_back(PlotOp::Travel { to: self.from });
            ops.extend(self.stretches.iter().map(|stretch| stretch.op()));
            if self.stretches.is_empty() {
                ops.push_back(PlotOp::Draw { to: self.from, feed_mm_s: None });
            }
            return;
        };
        for (from_mm, to_mm) in dashes {
            self.draw_part(from_mm, to_mm, ops);
        }
    }

    /// The part of it between two lengths from its start.
    fn draw_part(&self, from_mm: f64, to_mm: f64, ops: &mut VecDeque<PlotOp>) {
        let (mut at, mut before_mm, mut is_down) = (self.from, 0.0, false);
        for stretch in &self.stretches {
            let length_mm = stretch.length_mm(at);
            let after_mm = before_mm + length_mm;
            if after_mm >= from_mm && before_mm <= to_mm && length_mm > 0.0 {
                let share = |mm: f64| ((mm - before_mm) / length_mm).clamp(0.0, 1.0);
                let (begin, end) = (share(from_mm), share(to_mm));
                if !is_down {
                    ops.push_back(PlotOp::Travel { to: stretch.at(at, begin) });
                    is_down = true;
                }
                if end > begin || from_mm >= to_mm {
                    ops.push_back(stretch.part(at, begin, end).op());
                }
                if after_mm > to_mm || from_mm >= to_mm {
                    return;
                }
            }
            (at, before_mm) = (stretch.to(), after_mm);
        }
    }

    fn length_mm(&self) -> f64 {
        let mut at = self.from;
        let mut length_mm = 0.0;
        for stretch in &self.stretches {
            length_mm += stretch.length_mm(at);
            at = stretch.to();
        }
        length_mm
    }

    /// Its places, with those of arcs as chords within `tolerance_mm`.
    pub(super) fn places(&self, tolerance_mm: f64) -> Vec<Point> {
        let mut ops = VecDeque::new();
        self.draw(&[], &mut ops);
        crate::chords(ops, tolerance_mm).filter_map(PlotOp::target).collect()
    }

    /// Ends it where it began.
    pub(super) fn close(&mut self) {
        if self.end().distance(self.from) > 0.0 {
            self.line_to(self.from);
        }
    }
}

impl Stretch {
    fn to(&self) -> Point {
        match self {
            Self::Line { to } | Self::Arc { to, .. } => *to,
        }
    }

    fn op(&self) -> PlotOp {
        match *self {
            Self::Line { to } => PlotOp::Draw { to, feed_mm_s: None },
            Self::Arc { centre, sweep_rad, to } => PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s: None },
        }
    }

    fn length_mm(&self, from: Point) -> f64 {
        match *self {
            Self::Line { to } => from.distance(to),
            Self::Arc { centre, sweep_rad, .. } => from.distance(centre) * libm::fabs(sweep_rad),
        }
    }

    fn at(&self, from: Point, share: f64) -> Point {
        match *self {
            Self::Line { to } => from.lerp(to, share),
            Self::Arc { to, .. } if share >= 1.0 => to,
            Self::Arc { centre, sweep_rad, .. } => centre + (from - centre).rotated(sweep_rad * share),
        }
    }

    fn part(&self, from: Point, begin: f64, end: f64) -> Self {
        let to = self.at(from, end);
        match *self {
            Self::Line { .. } => Self::Line { to },
            Self::Arc { centre, sweep_rad, .. } => {
                Self::Arc { centre, sweep_rad: sweep_rad * (end - begin), to }
            }
        }
    }
}

/// Half the longer axis of the ellipse that a circle of radius 1 becomes: the greater singular value of the map.
fn longer_axis(seen: &Plane) -> f64 {
    let sum = seen.x.length_squared() + seen.y.length_squared();
    let area = seen.x.cross(seen.y);
    libm::sqrt(0.5 * (sum + libm::sqrt(libm::fmax(0.0, sum * sum - 4.0 * area * area))))
}

/// Where the dashes of a path begin and end, as lengths from its start: each end of the path lies in a dash, and both of these are
/// equally long. A path shorter than the pattern is whole.
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

/// How far the arc of a polyline turns, and where its centre lies, by its bulge: the tangent of a quarter of the angle.
///
/// Source: Autodesk, *DXF Reference*, group 42 of LWPOLYLINE. With half the chord h and the bulge b the radius is h (1 + b²) / 2b, so that
/// the centre lies h (1 − b²) / 2b to the left of the chord.
pub(super) fn of_bulge(from: Vec2, to: Vec2, bulge: f64) -> Option<(Vec2, f64)> {
    let chord = to - from;
    // Straighter than this, the arc leaves its chord by less than a millionth of its length.
    if libm::fabs(bulge) < 2e-6 || chord.length_squared() <= 0.0 {
        return None;
    }
    let sweep_rad = (4.0 * libm::atan(bulge)).clamp(-TAU, TAU);
    let centre = from + chord * 0.5 + chord.perpendicular() * ((1.0 - bulge * bulge) / (4.0 * bulge));
    Some((centre, sweep_rad))
}

/// From one angle counter-clockwise to another: above 0, at most a whole turn.
pub(super) fn sweep(from_rad: f64, to_rad: f64) -> f64 {
    let sweep = libm::fmod(to_rad - from_rad, TAU);
    /// An arc shorter than this is a whole turn: programs write one as 0° to 360°, or from an angle to itself.
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
        let (centre, sweep_rad) = of_bulge(Vec2::new(0.0, 0.0), Vec2::new(2.0, 0.0), 1.0).unwrap();
        assert_eq!((centre, sweep_rad), (Vec2::new(1.0, 0.0), PI));
        // A quarter: its centre is above the chord, half a chord away.
        let (centre, _) = of_bulge(Vec2::new(0.0, 0.0), Vec2::new(2.0, 0.0), libm::tan(PI / 8.0)).unwrap();
        assert!((centre - Vec2::new(1.0, 1.0)).length() < 1e-12);
        assert_eq!(of_bulge(Vec2::new(0.0, 0.0), Vec2::new(2.0, 0.0), 0.0), None);
    }

    #[test]
    fn dashes_of_an_arc_are_arcs() {
        let plane = super::super::frame::Frame::WORLD.seen();
        let mut path = Path::new(Point::new(1.0, 0.0));
        path.arc(&plane, Vec2::default(), (Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0)), (0.0, PI), None, 0.01);
        let mut ops = VecDeque::new();
        path.draw(&[1.0, -0.5], &mut ops);
        assert!(ops.iter().all(|op| matches!(op, PlotOp::Travel { .. } | PlotOp::DrawArc { .. })));
        let turned: f64 = ops
            .iter()
            .map(|op| if let PlotOp::DrawArc { sweep_rad, .. } = op { *sweep_rad } else { 0.0 })
            .sum();
        // A pattern and a dash, one gap.
        assert!((turned - (PI - 0.5)).abs() < 1e-12, "{turned}");
        assert_eq!(
            ops.back().and_then(|op| op.target()).map(|to| to.distance(Point::new(-1.0, 0.0)) < 1e-12),
            Some(true)
        );
    }

    #[test]
    fn what_is_seen_askew_is_chords_within_the_tolerance() {
        let plane = Plane { x: Vec2::new(3.0, 0.0), y: Vec2::new(0.0, 1.0), origin: Point::ORIGIN };
        let mut path = Path::new(Point::new(3.0, 0.0));
        path.arc(&plane, Vec2::default(), (Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0)), (0.0, TAU), None, 0.01);
        let places = path.places(0.01);
        for pair in places.windows(2) {
            let middle = pair[0].lerp(pair[1], 0.5);
            let radius = libm::hypot(middle.x / 3.0, middle.y);
            assert!(1.0 - radius < 0.01, "{radius}");
        }
        assert!(places.len() < 50, "{}", places.len());
    }
}
