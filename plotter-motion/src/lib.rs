#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

#[cfg(any(test, feature = "std"))]
extern crate std;

mod config;
mod geom;
mod steps;
mod toolpath;

pub use config::{
    AreaConfig, AxisConfig, ContouringConfig, ControlConfig, ControllerChoice, Decoding, EncoderConfig,
    LoadConfig, Machine, MachineConfig, MachineName, MotorConfig, PublishedConfig, SerialConfig,
    SyncStopConfig,
};
pub use geom::{Point, Segment, Vec2};
pub use steps::{StepPoint, from_mm};
pub use toolpath::PlotOp;
