//! [`WriteError`]: what HPGL cannot say.

use super::UNITS_PER_MM;
use crate::Point;
use core::fmt;
use core::time::Duration;

/// Why an operation could not be written. `index` counts the operations pushed, from 0.
///
/// The operation named is left out and the text is as if it had never been pushed, save for
/// [`WriteError::Output`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum WriteError {
    /// A coordinate is not a finite number or lies outside the plotter's range.
    Point {
        /// Number of the operation, from 0.
        index: u64,
        /// The place asked for, mm.
        to: Point,
        /// [`WriteOptions::limit_units`](super::WriteOptions::limit_units).
        limit_units: i32,
    },
    /// A speed is not a finite number of at least 0.005 mm/s, or too great to be written.
    Feed {
        /// Number of the operation, from 0.
        index: u64,
        /// The speed asked for, mm/s.
        feed_mm_s: f64,
    },
    /// HPGL has no word for standing still.
    Dwell {
        /// Number of the operation, from 0.
        index: u64,
        /// How long it should have stood.
        duration: Duration,
    },
    /// The sink refused text. What it took before may end within a command.
    Output,
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Point { index, to, limit_units } => write!(
                f,
                "operation {index}: point ({:.3}, {:.3}) mm lies outside -{limit:.3}..={limit:.3} mm: scale or move \
                 the drawing, or raise limit_units if the plotter takes it",
                to.x,
                to.y,
                limit = f64::from(limit_units) / UNITS_PER_MM,
            ),
            Self::Feed { index, feed_mm_s } => write!(
                f,
                "operation {index}: a speed of {feed_mm_s} mm/s cannot be written: give 0.01 mm/s or more, or none"
            ),
            Self::Dwell { index, duration } => write!(
                f,
                "operation {index}: HPGL cannot stand still for {} ms: leave the dwell out",
                duration.as_millis()
            ),
            Self::Output => f.write_str("the output refused the text"),
        }
    }
}

impl core::error::Error for WriteError {}

impl From<fmt::Error> for WriteError {
    fn from(_: fmt::Error) -> Self {
        Self::Output
    }
}
