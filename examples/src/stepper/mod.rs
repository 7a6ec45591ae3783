//! `stepper`: a plot by its steps, in pictures and figures.

mod built_in;
mod command;
mod course;
mod drawn_extent;
mod preview;
mod report;
mod speed_chart;
mod step_file;
mod walk;

pub use command::StepperCommand;
pub use drawn_extent::DrawnExtent;
pub use preview::SteppedPreview;
pub use report::{PlotFigures, SteppedReport};
pub use speed_chart::SpeedChart;
pub use step_file::StepFile;
