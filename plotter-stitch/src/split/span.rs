//! [`Span`]: what one operation draws, as a curve that can be cut.

use core::f64::consts::{FRAC_PI_2, TAU};
use plotter_motion::{PlotOp, Point, Vec2};

/// Steps of a bisection. 60 halve an interval of 1 to below its last bit in `f64`.
const HALVINGS: u32 = 60;

/// Greatest change of a circle's radius, as a share, that counts as rounding: thousands of last bits of
/// `f64`.
const ROUNDING: f64 = 1e-12;

/// What one operation draws: a line or an arc, with a parameter from 0 at its start to 1 at its end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    from: Point,
    op: PlotOp,
    shape: Shape,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    Line { to: Point },
    Arc(Arc),
}

#[derive(Clone, Copy, Debug)]
struct Arc {
    centre: Point,
    /// From the centre to the start.
    out: Vec2,
    /// How far round, so that the arc ends where the operation says.
    sweep_rad: f64,
    /// How much farther from the centre it ends than it begins, as a share of the radius.
    growth: f64,
    to: Point,
}

impl Span {
    /// What `op` draws from `from`; `None` if it draws nothing.
    pub(super) fn new(from: Point, op: PlotOp) -> Option<Self> {
        let shape = match op {
            PlotOp::Draw { to, .. } => Shape::Line { to },
            PlotOp::DrawArc { centre, sweep_rad, to, .. } => {
                let out = from - centre;
                let radius_mm = out.length();
                if radius_mm > 0.0 && sweep_rad != 0.0 {
                    let growth = (to - centre).length() / radius_mm - 1.0;
                    // The end is the truth: the sweep of a file is rounded, or its end is.
                    let end = out.rotated(sweep_rad);
                    let rest_rad = libm::atan2(end.cross(to - centre), end.dot(to - centre));
                    Shape::Arc(Arc { centre, out, sweep_rad: sweep_rad + rest_rad, growth, to })
                } else {
                    Shape::Line { to }
                }
            }
            _ => return None,
        };
        Some(Self { from, op, shape })
    }

    /// The operation itself.
    pub(super) const fn op(&self) -> PlotOp {
        self.op
    }

    /// Where it is at `t`.
    pub(super) fn at(&self, t: f64) -> Point {
        match self.shape {
            _ if t <= 0.0 => self.from,
            Shape::Line { to } if t >= 1.0 => to,
            Shape::Line { to } => self.from.lerp(to, t),
            Shape::Arc(arc) if t >= 1.0 => arc.to,
            Shape::Arc(arc) => arc.centre + arc.out.rotated(arc.sweep_rad * t) * (1.0 + arc.growth * t),
        }
    }

    /// The operation that draws the part from `t0` to `t1`, when the pen stands at its start. The whole is
    /// the operation itself, to the last bit.
    pub(super) fn part(&self, t0: f64, t1: f64) -> PlotOp {
        if t0 <= 0.0 && t1 >= 1.0 {
            return self.op;
        }
        match (self.op, self.shape) {
            (PlotOp::DrawArc { centre, feed_mm_s, .. }, Shape::Arc(arc)) => {
                PlotOp::DrawArc { centre, sweep_rad: arc.sweep_rad * (t1 - t0), to: self.at(t1), feed_mm_s }
            }
            (PlotOp::Draw { feed_mm_s, .. } | PlotOp::DrawArc { feed_mm_s, .. }, _) => {
                PlotOp::Draw { to: self.at(t1), feed_mm_s }
            }
            (op, _) => op,
        }
    }

    /// Length of the part from `t0` to `t1`, mm; that of a spiral to first order.
    pub(super) fn length_mm(&self, t0: f64, t1: f64) -> f64 {
        match self.shape {
            Shape::Line { to } => self.from.distance(to) * (t1 - t0),
            Shape::Arc(arc) => {
                let middle = 1.0 + 0.5 * arc.growth * (t0 + t1);
                libm::fabs(arc.sweep_rad) * arc.out.length() * middle * (t1 - t0)
            }
        }
    }

    /// How far round it goes, rad, without sign; 0 for a line.
    pub(super) fn sweep_rad(&self) -> f64 {
        match self.shape {
            Shape::Line { .. } => 0.0,
            Shape::Arc(arc) => libm::fabs(arc.sweep_rad),
        }
    }

    /// Direction of the way at `t`; none for a dot.
    pub(super) fn heading(&self, t: f64) -> Option<Vec2> {
        match self.shape {
            Shape::Line { to } => (to - self.from).normalized(),
            Shape::Arc(arc) => {
                let out = arc.out.rotated(arc.sweep_rad * t);
                (out * arc.growth + out.perpendicular() * (arc.sweep_rad * (1.0 + arc.growth * t)))
                    .normalized()
            }
        }
    }

    /// A box that holds it, perhaps with room to spare: the corners with the least and the greatest
    /// coordinates.
    pub(super) fn bounds(&self) -> (Point, Point) {
        match self.shape {
            Shape::Line { to } => (
                Point::new(self.from.x.min(to.x), self.from.y.min(to.y)),
                Point::new(self.from.x.max(to.x), self.from.y.max(to.y)),
            ),
            Shape::Arc(arc) => {
                let radius_mm = arc.out.length() * (1.0 + arc.growth.max(0.0));
                let reach = Vec2::new(radius_mm, radius_mm);
                (arc.centre - reach, arc.centre + reach)
            }
        }
    }

    /// The corners of the least box that holds it. Bends inwards of a spiral's quarter turns are left out.
    pub(super) fn exact_bounds(&self) -> (Point, Point) {
        let turns = self.turning_points();
        let mut least = self.from;
        let mut most = self.from;
        for t in turns.iter() {
            let Point { x, y } = self.at(t);
            least = Point::new(least.x.min(x), least.y.min(y));
            most = Point::new(most.x.max(x), most.y.max(y));
        }
        (least, most)
    }

    /// Between two of these, and between 0 and the first, y rises or falls throughout: ends with 1.
    pub(super) fn turning_points(&self) -> TurningPoints {
        let mut points = TurningPoints { at: [1.0; MOST_TURNS], len: 0 };
        if let Shape::Arc(arc) = self.shape {
            let begin_rad = libm::atan2(arc.out.y, arc.out.x);
            // Quarter turns: those of a half turn are the circle's own extremes, and between two of them a
            // spiral has one at most (cot φ (1 + g t) s = -g has one root, since the left side is monotone
            // where its sign fits).
            let first = libm::ceil(begin_rad.min(begin_rad + arc.sweep_rad) / FRAC_PI_2);
            let mut quarters = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
                .map(|quarter: f64| ((first + quarter) * FRAC_PI_2 - begin_rad) / arc.sweep_rad);
            if arc.sweep_rad < 0.0 {
                quarters.reverse();
            }
            let mut before = 0.0;
            let inner = quarters.into_iter().filter(|t| *t > 0.0 && *t < 1.0);
            for t in inner.chain([1.0]) {
                let is_spiral = libm::fabs(arc.growth) > ROUNDING;
                if let Some(extreme) = is_spiral.then(|| arc.extreme_between(before, t)).flatten() {
                    points.push(extreme);
                }
                if t < 1.0 {
                    points.push(t);
                }
                before = t;
            }
        }
        points.push(1.0);
        points
    }

    /// Where, between `t0` and `t1`, y is `y_mm`: y rises or falls throughout between them, past `y_mm`.
    pub(super) fn crossing(&self, t0: f64, t1: f64, y_mm: f64) -> f64 {
        match self.shape {
            Shape::Line { to } => ((y_mm - self.from.y) / (to.y - self.from.y)).clamp(t0, t1),
            Shape::Arc(_) => {
                let rises = self.at(t1).y > self.at(t0).y;
                bisect(t0, t1, |t| (self.at(t).y < y_mm) == rises)
            }
        }
    }
}

impl Arc {
    /// Where between `t0` and `t1` the derivative of y changes its sign.
    fn extreme_between(&self, t0: f64, t1: f64) -> Option<f64> {
        let slope = |t: f64| {
            let out = self.out.rotated(self.sweep_rad * t);
            self.growth * out.y + (1.0 + self.growth * t) * self.sweep_rad * out.x
        };
        let (begins, ends) = (slope(t0) > 0.0, slope(t1) > 0.0);
        (begins != ends).then(|| bisect(t0, t1, |t| (slope(t) > 0.0) == begins))
    }
}

/// The place up to which `is_before` holds.
fn bisect(t0: f64, t1: f64, is_before: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (t0, t1);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if is_before(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// A whole turn from anywhere has five quarters or parts of them, each with an extreme and an end.
const MOST_TURNS: usize = 14;

/// Ends of the monotone parts of a span.
#[derive(Clone, Copy, Debug)]
pub(super) struct TurningPoints {
    at: [f64; MOST_TURNS],
    len: usize,
}

impl TurningPoints {
    fn push(&mut self, t: f64) {
        if let Some(slot) = self.at.get_mut(self.len) {
            *slot = t;
            self.len += 1;
        }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = f64> + use<> {
        self.at.into_iter().take(self.len)
    }
}

/// Whether an angle is within one turn.
pub(super) fn is_sweep(sweep_rad: f64) -> bool {
    /// What rounding may add to a whole turn, rad.
    const ROUNDING_RAD: f64 = 1e-6;
    (-TAU - ROUNDING_RAD..=TAU + ROUNDING_RAD).contains(&sweep_rad)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;

    fn arc(from: Point, centre: Point, sweep_rad: f64, growth: f64) -> Span {
        let to = centre + (from - centre).rotated(sweep_rad) * (1.0 + growth);
        Span::new(from, PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s: None }).unwrap()
    }

    #[test]
    fn a_circle_turns_where_it_is_highest_and_lowest() {
        // From the right, counter-clockwise: highest at a quarter, lowest at three quarters.
        let circle = arc(Point::new(5.0, 0.0), Point::ORIGIN, TAU, 0.0);
        let extremes: std::vec::Vec<f64> = circle.turning_points().iter().collect();
        for t in [0.25, 0.75] {
            assert!(extremes.iter().any(|found| (found - t).abs() < 1e-12), "{extremes:?}");
        }
        let (least, most) = circle.exact_bounds();
        assert!((least.y + 5.0).abs() < 1e-12 && (most.y - 5.0).abs() < 1e-12);
    }

    #[test]
    fn between_turning_points_y_is_monotone() {
        for (sweep_rad, growth) in [(TAU, 0.0), (-TAU, 3.0), (5.0, -0.9), (-4.0, 0.5), (0.3, 2.0)] {
            for begin in 0..24 {
                let from = Point::new(10.0, 0.0) - Point::ORIGIN;
                let from = Point::ORIGIN + from.rotated(f64::from(begin) * PI / 12.0);
                let span = arc(from, Point::ORIGIN, sweep_rad, growth);
                let mut before = 0.0;
                for end in span.turning_points().iter() {
                    let rises = span.at(end).y > span.at(before).y;
                    let mut y = span.at(before).y;
                    for step in 1..=50 {
                        let next = span.at(before + (end - before) * f64::from(step) / 50.0).y;
                        /// What the root of the derivative is off by shows squared.
                        const ROUNDING_MM: f64 = 1e-12;
                        assert!(if rises { next >= y - ROUNDING_MM } else { next <= y + ROUNDING_MM });
                        y = next;
                    }
                    before = end;
                }
            }
        }
    }

    #[test]
    fn an_arc_without_radius_is_a_line() {
        let op = PlotOp::DrawArc {
            centre: Point::ORIGIN,
            sweep_rad: 1.0,
            to: Point::new(3.0, 4.0),
            feed_mm_s: None,
        };
        let span = Span::new(Point::ORIGIN, op).unwrap();
        assert_eq!(span.length_mm(0.0, 1.0), 5.0);
        assert_eq!(span.part(0.0, 1.0), op);
        assert_eq!(span.part(0.5, 1.0), PlotOp::Draw { to: Point::new(3.0, 4.0), feed_mm_s: None });
    }

    #[test]
    fn half_a_half_turn_is_a_quarter() {
        let half = arc(Point::new(0.0, 2.0), Point::ORIGIN, PI, 0.0);
        assert!((half.crossing(0.0, 1.0, 0.0) - 0.5).abs() < 1e-15);
        let PlotOp::DrawArc { sweep_rad, .. } = half.part(0.0, 0.5) else { panic!("an arc stays one") };
        assert!((sweep_rad - FRAC_PI_2).abs() < 1e-15);
    }
}
