//! [`ModalState`]: what holds before a drawing is gone on with.

use crate::{PlotOp, Point};

/// What earlier operations have left on the machine: where the pen stands, which pen it is, and the power.
/// With it a drawing that was interrupted is gone on with from any of its operations.
///
/// ```
/// use plotter_motion::{PlotOp, Point, hpgl, toolpath::ModalState};
/// let mut ops = hpgl::plot_ops(b"SP3;PU0,0;PD400,0,400,400;").filter_map(Result::ok);
/// let mut state = ModalState::default();
/// ops.by_ref().take(3).for_each(|op| state.pass(&op)); // the first side is drawn
/// let rest: Vec<PlotOp> = ops.next().into_iter().flat_map(|first| state.resume(first)).chain(ops).collect();
/// let to = |x, y| Point::new(x, y); // 40 units of HPGL are a millimetre
/// let expected = [
///     PlotOp::SelectPen { pen: 3 },
///     PlotOp::Travel { to: to(10.0, 0.0) },
///     PlotOp::Draw { to: to(10.0, 10.0), feed_mm_s: None },
/// ];
/// assert_eq!(rest, expected);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ModalState {
    /// Where the pen stands, mm.
    pub at: Point,
    /// The pen that was selected last; `None` as long as none was.
    pub pen: Option<u8>,
    /// The power that was set last, 0 to 1; `None` as long as none was.
    pub power: Option<f64>,
}

impl ModalState {
    /// An operation has been carried out, or is left out.
    pub fn pass(&mut self, op: &PlotOp) {
        match *op {
            PlotOp::SelectPen { pen } => self.pen = Some(pen),
            PlotOp::LaserPower { share } => self.power = Some(share),
            _ => self.at = op.target().unwrap_or(self.at),
        }
    }

    /// The operations that go on with `first`: the pen, the power, the way to where it begins if it draws,
    /// and itself.
    pub fn resume(self, first: PlotOp) -> impl Iterator<Item = PlotOp> {
        let draws = matches!(first, PlotOp::Draw { .. } | PlotOp::DrawArc { .. });
        let pen = self.pen.map(|pen| PlotOp::SelectPen { pen });
        let power = self.power.map(|share| PlotOp::LaserPower { share });
        let way = draws.then_some(PlotOp::Travel { to: self.at });
        pen.into_iter().chain(power).chain(way).chain([first])
    }
}
