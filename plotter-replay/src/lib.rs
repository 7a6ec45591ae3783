#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod bench_recorder;
mod canvas;
mod chart;
mod compare;
pub mod golden;
#[cfg(feature = "live")]
pub mod live;
pub mod log;
mod number;
mod page;
mod player;
#[cfg(feature = "serial")]
pub mod serial;
mod thin;
mod virtual_plotter;

pub use bench_recorder::BenchRecorder;
#[cfg(feature = "image")]
pub use canvas::PngError;
pub use canvas::{Canvas, CanvasStyle, DesiredLine, Layer, Sketch, Visibility};
pub use chart::{Chart, Curve, Panel, Role, Run};
pub use compare::{ContourError, ContourSample, Ways, contour_samples};
pub use page::{PageSettings, RecordingPage};
pub use player::{
    Answer, Compared, Controller, Difference, EdgeSource, MachineController, Outcome, Player, PlayerSettings,
    Stuck,
};
pub use virtual_plotter::{
    Anomaly, AnomalyKind, Leg, Noted, PlotterSettings, Reached, SettingsError, TrackPoint, VirtualPlotter,
};
