//! [`PlotOp`]: the operations that every front end (vectorizer, HPGL, G-code) emits and every back end
//! (controller, writer, splitter, canvas) takes.

pub(crate) mod chords;
mod modal_state;
pub(crate) mod shapes;
mod targets;

pub use crate::steps::from_mm;
use crate::{Point, StepPoint};
pub use chords::chords;
use core::time::Duration;
pub use modal_state::ModalState;
pub use shapes::{circle, rectangle};
pub use targets::{OutOfReach, targets};

/// Whether the pen touches the sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Pen {
    /// Lifted.
    #[default]
    Up,
    /// On the sheet.
    Down,
}

/// A straight move of both motors to a target, with the pen up or down, for a controller that takes targets
/// one by one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PenMove {
    /// The pen during the move.
    pub pen: Pen,
    /// Target, encoder counts or steps.
    pub target: StepPoint,
}

impl PenMove {
    /// The move of a plot operation; `None` for one that is not a straight move. An arc becomes straight
    /// moves by [`chords`]. Rounds as [`from_mm`] does.
    ///
    /// ```
    /// # use plotter_motion::{Pen, PenMove, PlotOp, Point, StepPoint};
    /// let op = PlotOp::Draw { to: Point::new(10.0, 20.0), feed_mm_s: None };
    /// let expected = PenMove { pen: Pen::Down, target: StepPoint::new(400, 800) };
    /// assert_eq!(PenMove::from_op(op, 40.0), Some(expected));
    /// ```
    #[must_use]
    pub fn from_op(op: PlotOp, counts_per_mm: f64) -> Option<Self> {
        let pen = match op {
            PlotOp::Travel { .. } => Pen::Up,
            PlotOp::Draw { .. } => Pen::Down,
            _ => return None,
        };
        let to = op.target()?;
        Some(Self { pen, target: StepPoint::new(from_mm(to.x, counts_per_mm), from_mm(to.y, counts_per_mm)) })
    }

    /// The same move in mm. `counts_per_mm` must be finite and not 0.
    #[must_use]
    pub fn to_op(self, counts_per_mm: f64) -> PlotOp {
        let to =
            Point::new(f64::from(self.target.x) / counts_per_mm, f64::from(self.target.y) / counts_per_mm);
        match self.pen {
            Pen::Up => PlotOp::Travel { to },
            Pen::Down => PlotOp::Draw { to, feed_mm_s: None },
        }
    }
}

/// An operation of a plotter. All coordinates are absolute, in mm on the sheet.
///
/// Before the first operation the pen is up at the origin. After the last one it is lifted where it stands:
/// whatever takes operations does so at its end ([`Planner::finish`](crate::Planner::finish), `finish` of the
/// writers), so no drawing needs an operation for it. A travel to the pen's position lifts it earlier.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
#[repr(u32)] // a tag of the width of a float costs small processors a second comparison everywhere
pub enum PlotOp {
    /// Lifts the pen and moves, without a mark.
    Travel {
        /// Target, mm.
        to: Point,
    },
    /// Lowers the pen and draws a straight line. A line to the pen's position is a dot.
    Draw {
        /// Target, mm.
        to: Point,
        /// Speed along the line, mm/s; `None` leaves the choice to the machine.
        feed_mm_s: Option<f64>,
    },
    /// Lowers the pen and draws an arc of a circle from where the pen stands.
    ///
    /// The pen should be as far from the centre as `to` is; otherwise the radius changes linearly along the
    /// arc.
    DrawArc {
        /// Centre of the circle, mm.
        centre: Point,
        /// Angle of the arc, rad: positive counter-clockwise; at most a whole turn, ±2π.
        sweep_rad: f64,
        /// End of the arc, mm: the pen's position, turned about the centre by the sweep.
        to: Point,
        /// Speed along the arc, mm/s; `None` leaves the choice to the machine.
        feed_mm_s: Option<f64>,
    },
    /// Sets the power of a laser for everything drawn from here on; a pen ignores it.
    LaserPower {
        /// Fraction of full power, 0 to 1.
        share: f64,
    },
    /// Takes another pen; 0 puts the pen away.
    SelectPen {
        /// Number in the carousel, from 1.
        pen: u8,
    },
    /// Waits.
    Dwell {
        /// Length of the wait.
        duration: Duration,
    },
    /// Changes the sheet.
    NewPage,
}

impl PlotOp {
    /// Target of the operation; `None` if it does not move the pen.
    #[must_use]
    pub fn target(self) -> Option<Point> {
        match self {
            Self::Travel { to } | Self::Draw { to, .. } | Self::DrawArc { to, .. } => Some(to),
            Self::LaserPower { .. } | Self::SelectPen { .. } | Self::Dwell { .. } | Self::NewPage => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operations_that_do_not_move_are_no_pen_moves() {
        assert_eq!(PenMove::from_op(PlotOp::NewPage, 40.0), None);
        let up = PenMove { pen: Pen::Up, target: StepPoint::new(400, 40) };
        assert_eq!(up.to_op(40.0), PlotOp::Travel { to: Point::new(10.0, 1.0) });
    }
}
