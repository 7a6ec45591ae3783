//! Comparisons: the pen with its line ([`ContourError`]), one log with another ([`compare`]).

mod contour;
mod decode;
mod difference;
mod lane;
mod logs;
mod text_lines;

pub use contour::{ContourError, ContourSample, ContourTally, Ways, contour_samples};
pub use decode::Decoder;
pub(crate) use difference::line;
pub use difference::{Comparison, FirstDifference, LaneSummary, Place};
pub use logs::{CompareSettings, compare};
