//! [`Frame`]: scaling and rotation of what is drawn.

use crate::{PlotOp, Point, Vec2};

/// `G51` and `G68`: first what is scaled, then what is turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    /// About where, and by how much along each axis.
    scaling: Option<(Point, f64, f64)>,
    /// About where, and sine and cosine of the angle.
    turning: Option<(Point, f64, f64)>,
}

impl Frame {
    pub(super) const NONE: Self = Self { scaling: None, turning: None };

    pub(super) fn scale(&mut self, scaling: Option<(Point, f64, f64)>) {
        self.scaling = scaling;
    }

    /// About a point, counter-clockwise.
    pub(super) fn turn(&mut self, turning: Option<(Point, f64)>) {
        self.turning = turning.map(|(centre, angle_rad)| {
            let (sin, cos) = libm::sincos(angle_rad);
            (centre, sin, cos)
        });
    }

    pub(super) fn apply(&self, mut point: Point) -> Point {
        if let Some((centre, x, y)) = self.scaling {
            let out = point - centre;
            point = centre + Vec2::new(out.x * x, out.y * y);
        }
        if let Some((centre, sin, cos)) = self.turning {
            point = turned(point, centre, sin, cos);
        }
        point
    }

    pub(super) fn inverse(&self, mut point: Point) -> Point {
        if let Some((centre, sin, cos)) = self.turning {
            point = turned(point, centre, -sin, cos);
        }
        if let Some((centre, x, y)) = self.scaling {
            let out = point - centre;
            point = centre + Vec2::new(out.x / x, out.y / y);
        }
        point
    }

    /// The greater factor, if both axes have another one: arcs are no arcs then.
    pub(super) fn unequal(&self) -> Option<f64> {
        let (_, x, y) = self.scaling?;
        (x.abs() != y.abs()).then_some(x.abs().max(y.abs()))
    }

    pub(super) fn apply_to(&self, op: PlotOp) -> PlotOp {
        if *self == Self::NONE {
            return op;
        }
        match op {
            PlotOp::Travel { to } => PlotOp::Travel { to: self.apply(to) },
            PlotOp::Draw { to, feed_mm_s } => PlotOp::Draw { to: self.apply(to), feed_mm_s },
            PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s } => {
                let is_mirrored = self.scaling.is_some_and(|(_, x, y)| x * y < 0.0);
                let sweep_rad = if is_mirrored { -sweep_rad } else { sweep_rad };
                PlotOp::DrawArc { centre: self.apply(centre), sweep_rad, to: self.apply(to), feed_mm_s }
            }
            other => other,
        }
    }
}

fn turned(point: Point, centre: Point, sin: f64, cos: f64) -> Point {
    let out = point - centre;
    centre + Vec2::new(out.x * cos - out.y * sin, out.x * sin + out.y * cos)
}
