//! Distances between a drawing and the ink, in both directions.

pub(crate) mod coverage;
pub(crate) mod covered_figures;
mod drawn_error;
mod error_chart;
mod error_report;
mod followed_lines;

pub use coverage::{Beyond, Spot, Spots, beyond_ink, coverage, worst_pixel};
pub use drawn_error::InkDistance;
pub use error_chart::error_chart;
pub use error_report::{Bin, ErrorReport, ErrorTally};
pub use followed_lines::{FollowedLines, followed_lines};
