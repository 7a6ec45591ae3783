//! [`StretchedArc`]: an arc that is scaled unequally, as lines.

use super::frame::Frame;
use crate::{PlotOp, Point, Vec2};

/// Most lines of one arc: a circle of a kilometre keeps its tolerance.
const MOST_LINES: f64 = 65_536.0;

/// An arc in the coordinates of the text that is drawn as part of an ellipse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StretchedArc {
    centre: Point,
    /// From the centre to where the arc begins, mm.
    out: Vec2,
    sweep_rad: f64,
    to: Point,
    feed_mm_s: Option<f64>,
    lines: u32,
    next: u32,
}

impl StretchedArc {
    /// As so many lines that none is farther than `tolerance_mm` from its ellipse, once the frame has scaled
    /// it.
    ///
    /// A chord over an angle a is r (1 − cos(a/2)) ≤ r a²/8 from its arc, and no farther than the greater
    /// factor times that afterwards.
    pub(super) fn of(op: PlotOp, frame: &Frame, tolerance_mm: f64) -> Option<Self> {
        let PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s } = op else { return None };
        let greatest = frame.unequal()?;
        let end = to - centre;
        let (sin, cos) = libm::sincos(-sweep_rad);
        let out = Vec2::new(end.x * cos - end.y * sin, end.x * sin + end.y * cos);
        let step_rad = libm::sqrt(8.0 * tolerance_mm / libm::fmax(end.length() * greatest, tolerance_mm));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number, clamped"
        )]
        let lines = libm::ceil(sweep_rad.abs() / step_rad).clamp(1.0, MOST_LINES) as u32;
        Some(Self { centre, out, sweep_rad, to, feed_mm_s, lines, next: 1 })
    }

    /// The next line, in the coordinates of the text.
    pub(super) fn next(&mut self) -> Option<PlotOp> {
        if self.next > self.lines {
            return None;
        }
        let (sin, cos) = libm::sincos(self.sweep_rad * f64::from(self.next) / f64::from(self.lines));
        let out = Vec2::new(self.out.x * cos - self.out.y * sin, self.out.x * sin + self.out.y * cos);
        let to = if self.next == self.lines { self.to } else { self.centre + out };
        self.next += 1;
        Some(PlotOp::Draw { to, feed_mm_s: self.feed_mm_s })
    }
}
