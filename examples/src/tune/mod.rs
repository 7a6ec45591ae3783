//! `tune`: gains for an axis by every method, and what they do.

mod command;
mod loop_chart;
mod report;
mod tuned_axis;
mod tuning;

pub use command::TuneCommand;
pub use loop_chart::{LoopChart, LoopCurve, loop_charts_svg};
pub use report::{TuningReport, tuned_lines};
pub use tuned_axis::{Law, SimulatedAxis, StepResponse};
pub use tuning::{TunedAxis, TuningMethod, TuningSettings};
