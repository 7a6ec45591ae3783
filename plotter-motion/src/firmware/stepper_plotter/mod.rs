//! The stepper plotter's controller.

mod area;
mod command;
mod grbl;
mod homing_run;
mod link;
mod mdraw;
mod motion;
mod output;
mod plotter;
mod queue;
mod receive;
mod settings;
mod status;

pub use command::{Command, Report, Signal, Stop};
pub use link::{COMMANDS, Link, REPORTS};
pub use motion::{Motion, Step};
pub use plotter::StepperPlotter;
pub use queue::Queue;
pub use receive::Receive;
pub use settings::{Dialect, SettingsError, StepperPlotterSettings, StoredSettings};
pub use status::{Activity, Status};
