#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![cfg_attr(docsrs, feature(doc_cfg))]

mod date;
mod frames;
mod number;

#[cfg(feature = "cli")]
pub mod cli;
pub mod compare;
pub mod draw;
pub mod export;
pub mod golden;
pub mod import;
#[cfg(feature = "live")]
pub mod live;
pub mod log;
pub mod player;
pub mod record;
pub mod resume;
#[cfg(feature = "serial")]
pub mod serial;
#[cfg(feature = "live")]
pub mod simulation;
pub mod transport;
pub mod virtual_plotter;

pub use compare::{CompareSettings, Comparison};
pub use draw::{Canvas, CanvasStyle, Chart, PageSettings, RecordingPage};
pub use player::{AnyController, Controller, Outcome, Player, PlayerSettings, Rerun};
pub use plotter_motion;
pub use record::BenchRecorder;
pub use resume::ResumePoint;
pub use virtual_plotter::{PlotterSettings, Reached, VirtualPlotter};
