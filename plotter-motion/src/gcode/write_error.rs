//! [`WriteError`]: what G-code cannot say.

use crate::Point;
use core::fmt;

/// Why an operation could not be written. `index` counts the operations pushed, from 0.
///
/// The operation named is left out and the text is as if it had never been pushed, save for
/// [`WriteError::Output`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum WriteError {
    /// A coordinate is not a finite number or lies outside the machine's range, or an arc is none.
    Point {
        /// Number of the operation, from 0.
        index: u64,
        /// The place asked for, mm.
        to: Point,
        /// [`WriteOptions::limit_mm`](super::WriteOptions::limit_mm).
        limit_mm: f64,
    },
    /// A speed that rounds to 0 mm/min, or is no number, or too great to be written.
    Feed {
        /// Number of the operation, from 0.
        index: u64,
        /// The speed asked for, mm/s.
        feed_mm_s: f64,
    },
    /// A power of a laser that is no share of its full power.
    Power {
        /// Number of the operation, from 0.
        index: u64,
        /// The share asked for.
        share: f64,
    },
    /// A height of the pen is not a finite number or lies outside the machine's range.
    Height {
        /// The height in the options, mm.
        height_mm: f64,
    },
    /// The sink refused text. What it took before may end within a line.
    Output,
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Point { index, to, limit_mm } => write!(
                f,
                "operation {index}: point ({:.3}, {:.3}) mm lies outside -{limit_mm}..={limit_mm} mm: scale or move \
                 the drawing, or raise limit_mm if the machine takes it",
                to.x, to.y,
            ),
            Self::Feed { index, feed_mm_s } => write!(
                f,
                "operation {index}: a speed of {feed_mm_s} mm/s cannot be written: give 0.01 mm/s or more"
            ),
            Self::Power { index, share } => {
                write!(f, "operation {index}: {share} is no power: give a share of full power, 0 to 1")
            }
            Self::Height { height_mm } => {
                write!(f, "pen: {height_mm} mm is no height: give mm along the Z axis, as 5 and 0")
            }
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
