//! `stepper`: pictures and figures of a plot by its steps.

mod drawn_extent;
mod preview;
mod report;
mod speed_chart;
mod step_file;

pub use drawn_extent::DrawnExtent;
pub use preview::SteppedPreview;
pub use report::{PlotFigures, SteppedReport};
pub use speed_chart::SpeedChart;
pub use step_file::StepFile;
