//! [`PathSegment`]: a line, an arc or a cubic curve of a stroke.

use super::{Affine, Bounds};
use crate::bezier::Bezier;
use crate::{PlotOp, Point, toolpath::chords};
use alloc::vec::Vec;
use core::f64::consts::{FRAC_PI_8, PI, TAU};

/// What lies between two places of a stroke.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Shape {
    /// A straight line.
    #[default]
    Line,
    /// An arc of a circle, as [`PlotOp::DrawArc`] has it.
    Arc {
        /// Centre of the circle, mm.
        centre: Point,
        /// How far round, rad: counter-clockwise above 0; at most a whole turn, ±2π.
        sweep_rad: f64,
    },
    /// A cubic Bézier curve.
    Cubic {
        /// The two places between its ends that it is drawn towards, mm.
        handles: [Point; 2],
    },
}

/// A part of a stroke: it begins where the one before it ends.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PathSegment {
    /// What it looks like.
    pub shape: Shape,
    /// Where it ends, mm.
    pub to: Point,
    /// Speed along it, mm/s; `None` leaves the choice to the machine.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub feed_mm_s: Option<f64>,
    /// Power of a laser on it, as a share of its full power; `None` where nothing is said.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub power: Option<f64>,
}

impl PathSegment {
    /// A straight line to a place.
    #[must_use]
    pub const fn line(to: Point) -> Self {
        Self { shape: Shape::Line, to, feed_mm_s: None, power: None }
    }

    /// An arc about a centre to a place.
    #[must_use]
    pub const fn arc(centre: Point, sweep_rad: f64, to: Point) -> Self {
        Self { shape: Shape::Arc { centre, sweep_rad }, to, feed_mm_s: None, power: None }
    }

    /// A cubic curve to a place.
    #[must_use]
    pub const fn cubic(handles: [Point; 2], to: Point) -> Self {
        Self { shape: Shape::Cubic { handles }, to, feed_mm_s: None, power: None }
    }

    /// Whether from there it is one place: also an arc about it, and a curve all of whose places are there.
    #[must_use]
    pub fn is_dot(&self, from: Point) -> bool {
        let is_place = match self.shape {
            Shape::Line => true,
            Shape::Arc { centre, sweep_rad } => centre == from || sweep_rad == 0.0,
            Shape::Cubic { handles } => handles == [from; 2],
        };
        is_place && self.to == from
    }

    /// Whether all its numbers are finite, and its arc is at most a whole turn.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        let is_number = |number: Option<f64>| number.is_none_or(f64::is_finite);
        let is_shape = match self.shape {
            Shape::Line => true,
            Shape::Arc { centre, sweep_rad } => centre.is_finite() && libm::fabs(sweep_rad) <= TAU,
            Shape::Cubic { handles: [a, b] } => a.is_finite() && b.is_finite(),
        };
        is_shape && self.to.is_finite() && is_number(self.feed_mm_s) && is_number(self.power)
    }

    /// The place at a share of the way along its parameter: of a line and an arc the share of its length.
    ///
    /// ```
    /// use plotter_motion::{Point, drawing::PathSegment};
    /// let quarter = PathSegment::arc(Point::new(0.0, 0.0), std::f64::consts::FRAC_PI_2, Point::new(0.0, 1.0));
    /// let half_way = quarter.at(Point::new(1.0, 0.0), 0.5);
    /// assert!(half_way.distance(Point::new(0.5_f64.sqrt(), 0.5_f64.sqrt())) < 1e-12);
    /// ```
    #[must_use]
    pub fn at(&self, from: Point, share: f64) -> Point {
        if share >= 1.0 {
            return self.to;
        }
        match self.shape {
            Shape::Line => from.lerp(self.to, share),
            Shape::Arc { centre, sweep_rad } => {
                let out = from - centre;
                let radius = out.length();
                let growth = if radius > 0.0 { self.to.distance(centre) / radius - 1.0 } else { 0.0 };
                centre + out.rotated(sweep_rad * share) * (1.0 + growth * share)
            }
            Shape::Cubic { handles: [a, b] } => {
                let (s, t) = (1.0 - share, share);
                let out = |place: Point| place - from;
                from + out(a) * (3.0 * s * s * t) + out(b) * (3.0 * s * t * t) + out(self.to) * (t * t * t)
            }
        }
    }

    /// Its length, mm. That of a cubic curve is that of its lines within a nanometre, which is less by some
    /// billionths.
    #[must_use]
    pub fn length_mm(&self, from: Point) -> f64 {
        match self.shape {
            Shape::Line => from.distance(self.to),
            Shape::Arc { centre, sweep_rad } => {
                0.5 * (from.distance(centre) + self.to.distance(centre)) * libm::fabs(sweep_rad)
            }
            Shape::Cubic { .. } => {
                /// Greatest distance of the chords by which a curve's length is measured, mm: a nanometre.
                const EXACT_MM: f64 = 1e-6;
                let mut at = from;
                self.places(from, EXACT_MM)
                    .fold(0.0, |length, to| length + core::mem::replace(&mut at, to).distance(to))
            }
        }
    }

    /// The ends of its lines, of which none is farther than `tolerance_mm` from it; the last one is where it
    /// ends.
    pub fn places(&self, from: Point, tolerance_mm: f64) -> impl Iterator<Item = Point> + use<> {
        let segment = *self;
        let count = match self.shape {
            Shape::Line => 1,
            Shape::Arc { centre, sweep_rad } => {
                let arc = [
                    PlotOp::Travel { to: from },
                    PlotOp::DrawArc { centre, sweep_rad, to: self.to, feed_mm_s: None },
                ];
                u32::try_from(chords(arc, tolerance_mm).count().saturating_sub(1)).unwrap_or(1)
            }
            Shape::Cubic { handles: [a, b] } => {
                Bezier::new([from, a, b, self.to].map(|at| at - Point::ORIGIN), tolerance_mm).lines()
            }
        };
        (1..=count).map(move |index| segment.at(from, f64::from(index) / f64::from(count)))
    }

    /// The other way round: from where it ends to `from`.
    #[must_use]
    pub fn reversed(&self, from: Point) -> Self {
        let shape = match self.shape {
            Shape::Line => Shape::Line,
            Shape::Arc { centre, sweep_rad } => Shape::Arc { centre, sweep_rad: -sweep_rad },
            Shape::Cubic { handles: [a, b] } => Shape::Cubic { handles: [b, a] },
        };
        Self { shape, to: from, ..*self }
    }

    /// The part of it between two shares of its parameter, from `at(from, begin)` on.
    #[must_use]
    pub fn part(&self, from: Point, begin: f64, end: f64) -> Self {
        let to = self.at(from, end);
        let shape = match self.shape {
            Shape::Line => Shape::Line,
            Shape::Arc { centre, sweep_rad } => Shape::Arc { centre, sweep_rad: sweep_rad * (end - begin) },
            // The polar form at (begin, begin, end) and (begin, end, end): L. Ramshaw, "Blossoming" (1987).
            Shape::Cubic { handles: [a, b] } => {
                let polar = |r: f64, s: f64, t: f64| {
                    let (ab, bc, cd) = (from.lerp(a, r), a.lerp(b, r), b.lerp(self.to, r));
                    ab.lerp(bc, s).lerp(bc.lerp(cd, s), t)
                };
                Shape::Cubic { handles: [polar(begin, begin, end), polar(begin, end, end)] }
            }
        };
        Self { shape, to, ..*self }
    }

    /// Puts the corners of the box round it, its start included, into `grow`.
    pub(super) fn extremes(&self, from: Point, grow: &mut impl FnMut(Point)) {
        grow(from);
        grow(self.to);
        match self.shape {
            Shape::Line => {}
            Shape::Arc { centre, sweep_rad } => {
                let out = from - centre;
                let begin = libm::atan2(out.y, out.x);
                let (low, high) =
                    if sweep_rad < 0.0 { (begin + sweep_rad, begin) } else { (begin, begin + sweep_rad) };
                let quarter = 0.5 * PI;
                let first = libm::ceil(low / quarter);
                // A whole turn has five quarters in it, its ends included; more turns have the same places.
                for index in 0..5 {
                    let angle = (first + f64::from(index)) * quarter;
                    if angle <= high && sweep_rad != 0.0 {
                        grow(self.at(from, (angle - begin) / sweep_rad));
                    }
                }
            }
            // Where the derivative, a quadratic, is 0 in x or in y.
            Shape::Cubic { handles: [a, b] } => {
                for coordinate in [|at: Point| at.x, |at: Point| at.y] {
                    let [p, q, r, s] = [from, a, b, self.to].map(coordinate);
                    let (u, v, w) = (q - p, r - q, s - r);
                    for share in roots(u - 2.0 * v + w, 2.0 * (v - u), u) {
                        if share > 0.0 && share < 1.0 {
                            grow(self.at(from, share));
                        }
                    }
                }
            }
        }
    }

    /// The box round it.
    pub(super) fn bounds(&self, from: Point) -> Bounds {
        let mut bounds = Bounds::at(from);
        self.extremes(from, &mut |at| bounds.grow(at));
        bounds
    }

    /// It as `map` shows it. An arc that becomes one of an ellipse is cubic curves, of an eighth of a turn at
    /// most, which are within 4·10⁻⁶ of the radius.
    pub(crate) fn mapped(&self, from: Point, map: &Affine, into: &mut Vec<Self>) {
        let to = map.apply(self.to);
        match self.shape {
            Shape::Line => into.push(Self { to, ..*self }),
            Shape::Cubic { handles } => {
                into.push(Self {
                    shape: Shape::Cubic { handles: handles.map(|at| map.apply(at)) },
                    to,
                    ..*self
                });
            }
            Shape::Arc { centre, sweep_rad } => {
                if let Some(sense) = map.turns_circles() {
                    let shape = Shape::Arc { centre: map.apply(centre), sweep_rad: sense * sweep_rad };
                    into.push(Self { shape, to, ..*self });
                    return;
                }
                let count = libm::ceil(libm::fabs(sweep_rad) / (2.0 * FRAC_PI_8)).clamp(1.0, 8.0);
                let mut begin = 0.0;
                while begin < count {
                    let (here, there) = (self.at(from, begin / count), self.at(from, (begin + 1.0) / count));
                    // Handles of a circle's arc: 4/3 of the tangent of a quarter of its angle.
                    let reach = 4.0 / 3.0 * libm::tan(0.25 * sweep_rad / count);
                    let handle = |at: Point, sign: f64| at + (at - centre).perpendicular() * (sign * reach);
                    let handles = [handle(here, 1.0), handle(there, -1.0)].map(|at| map.apply(at));
                    let to = map.apply(there);
                    into.push(Self { shape: Shape::Cubic { handles }, to, ..*self });
                    begin += 1.0;
                }
            }
        }
    }
}

/// Where a t² + b t + c is 0.
pub(super) fn roots(a: f64, b: f64, c: f64) -> impl Iterator<Item = f64> {
    let root = b * b - 4.0 * a * c;
    let q = -0.5 * (b + libm::copysign(libm::sqrt(libm::fmax(root, 0.0)), b));
    let share = |over: f64, under: f64| (root >= 0.0 && under != 0.0).then(|| over / under);
    share(q, a).into_iter().chain(share(c, q))
}
