//! [`PlotOp`]: what every front end (vectorizer, HPGL, G-code) emits and every back end (controller, writer,
//! splitter, canvas) takes.

use crate::{Point, StepPoint};
use core::time::Duration;

/// Whether the pen touches the sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Pen {
    /// Lifted.
    #[default]
    Up,
    /// On the sheet.
    Down,
}

/// A straight move of both motors to a target, with the pen up or down: what a drawing becomes for a
/// controller that takes targets one by one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PenMove {
    /// The pen during the move.
    pub pen: Pen,
    /// Where to, encoder counts or steps.
    pub target: StepPoint,
}

/// One thing for a plotter to do. All coordinates are absolute, in mm on the sheet.
///
/// Before the first operation the pen is up at the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PlotOp {
    /// Lifts the pen and moves, without a mark.
    Travel {
        /// Where to.
        to: Point,
    },
    /// Lowers the pen and draws a straight line. A line to where the pen stands is a dot.
    Draw {
        /// Where to.
        to: Point,
        /// Speed along the line, mm/s; `None` leaves the choice to the machine.
        feed_mm_s: Option<f64>,
    },
    /// Takes another pen; 0 puts the pen away.
    SelectPen {
        /// Number in the carousel, from 1.
        pen: u8,
    },
    /// Stands still.
    Dwell {
        /// How long.
        duration: Duration,
    },
    /// A new sheet.
    NewPage,
}

impl PlotOp {
    /// Where this operation takes the pen, if it moves it.
    #[must_use]
    pub fn target(self) -> Option<Point> {
        match self {
            Self::Travel { to } | Self::Draw { to, .. } => Some(to),
            Self::SelectPen { .. } | Self::Dwell { .. } | Self::NewPage => None,
        }
    }
}
