#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(docsrs, feature(doc_cfg))]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(any(test, feature = "std"))]
extern crate std;

mod axis;
mod bezier;
mod bresenham;
mod decimal;
mod decimal_text;
mod extremes;
mod geom;
mod random;
mod rational;
mod root;
mod seconds;
mod steps;
mod turn;
mod whole;

pub mod budget;
#[cfg(feature = "build")]
pub mod build;
#[cfg(feature = "serde")]
mod checked_serde;
pub mod config;
pub mod control;
#[cfg(feature = "alloc")]
pub mod drawing;
#[cfg(all(feature = "alloc", feature = "font"))]
pub mod dxf;
pub mod encoder;
pub mod firmware;
pub mod gcode;
pub mod homing;
pub mod hpgl;
pub mod kinematics;
pub mod planner;
pub mod plant;
pub mod profile;
pub mod protocol;
pub mod safety;
pub mod stepgen;
pub mod testbed;
pub mod toolpath;

pub use axis::{Axis, Direction};
pub use bresenham::{Bresenham, StepPair};
pub use config::{ConfigError, Machine, MachineConfig};
pub use geom::{Point, Segment, Vec2};
pub use planner::{PathMode, Planner, PlannerSettings};
pub use profile::MotionLimits;
pub use random::SplitMix64;
pub use safety::{Demand, Drive, Duty, LimitSwitches, SafetyGate};
pub use stepgen::StepGen;
pub use steps::StepPoint;
pub use toolpath::{Pen, PenMove, PlotOp};
