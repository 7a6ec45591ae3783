//! [`SplitError`]: what cannot be divided into frames.

use core::fmt;

/// What cannot be divided into frames, and what helps. Operations are counted from 1.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SplitError {
    /// A number of the layout divides no sheet.
    Layout {
        /// Which one.
        quantity: &'static str,
        /// Its value, mm.
        value: f64,
        /// The least that is taken, mm.
        least: f64,
        /// The most that is taken, mm.
        most: f64,
    },
    /// A number of an operation is not finite, or no place on a sheet.
    NotFinite {
        /// Number of the operation.
        op: u64,
        /// The number.
        value: f64,
    },
    /// The drawing is wider than the frame.
    TooWide {
        /// Number of the operation.
        op: u64,
        /// How far to the side, mm.
        x_mm: f64,
        /// As far as the frame reaches, mm.
        width_mm: f64,
    },
    /// Something lies before the first frame.
    BeforeBegin {
        /// Number of the operation.
        op: u64,
        /// How far along the sheet, mm.
        y_mm: f64,
        /// Where the first frame begins, mm.
        begin_mm: f64,
    },
    /// A stroke goes back to a frame that has been given out: the operations are not in the order of the
    /// sheet.
    OutOfOrder {
        /// Number of the operation.
        op: u64,
        /// The frame, from 0.
        frame: u32,
    },
    /// Something is drawn on a second page.
    SecondPage {
        /// Number of the operation.
        op: u64,
    },
    /// An operation that is not known here.
    Unknown {
        /// Number of the operation.
        op: u64,
    },
    /// Nothing is drawn.
    Empty,
}

impl fmt::Display for SplitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Layout { quantity, value, least, most } => {
                write!(f, "{quantity} is {value}: it must lie in {least}..={most} mm")
            }
            Self::NotFinite { op, value } => {
                write!(
                    f,
                    "operation {op}: {value} is no place on a sheet; coordinates must be finite and within ±1e9 mm"
                )
            }
            Self::TooWide { op, x_mm, width_mm } => write!(
                f,
                "operation {op}: x = {x_mm} mm lies beside the frame, which takes 0..={width_mm} mm, and the paper moves \
                 along y; turn, move or shrink the drawing"
            ),
            Self::BeforeBegin { op, y_mm, begin_mm } => write!(
                f,
                "operation {op}: y = {y_mm} mm lies before the first frame, which begins at {begin_mm} mm; let it \
                 begin there"
            ),
            Self::OutOfOrder { op, frame } => write!(
                f,
                "operation {op} goes back to frame {frame}, which has been given out; order the drawing along the \
                 sheet, or read it once for each frame"
            ),
            Self::SecondPage { op } => write!(
                f,
                "operation {op} draws on a second page, and an endless sheet has one; split the file by its pages"
            ),
            Self::Unknown { op } => write!(f, "operation {op} is not known here"),
            Self::Empty => f.write_str("nothing is drawn"),
        }
    }
}

impl core::error::Error for SplitError {}
