#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod bench_recorder;
mod canvas;
mod chart;
mod compare;
pub mod export;
mod frames;
pub mod golden;
pub mod import;
#[cfg(feature = "live")]
pub mod live;
pub mod log;
mod number;
mod page;
mod player;
pub mod record;
mod resume;
#[cfg(feature = "serial")]
pub mod serial;
mod thin;
pub mod transport;
mod virtual_plotter;

pub use bench_recorder::BenchRecorder;
#[cfg(feature = "image")]
pub use canvas::PngError;
pub use canvas::{Canvas, CanvasStyle, DesiredLine, Layer, Sketch, Visibility};
pub use chart::{Chart, Curve, Panel, Role, Run};
pub use compare::{
    CompareSettings, Comparison, ContourError, ContourSample, ContourTally, Decoder, FirstDifference,
    LaneSummary, Place, Ways, compare, contour_samples,
};
pub use page::{PageSettings, RecordingPage};
pub use player::{
    Answer, AnyController, Compared, Controller, ControllerError, Difference, EdgeSource, Inputs,
    LinkedController, LinkedMachine, MachineController, MotorStep, Outcome, Pace, PaceSettings, Player,
    PlayerSettings, RecordingTraits, Rerun, Stuck,
};
pub use resume::{DrawingMark, ResumeError, ResumePoint};
pub use thin::thin;
pub use virtual_plotter::{
    Anomaly, AnomalyKind, CountedBy, Leg, Noted, PlotterSettings, Reached, SettingsError, TrackPoint,
    VirtualPlotter,
};
