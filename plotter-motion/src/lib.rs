#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(any(test, feature = "std"))]
extern crate std;

mod axis;
mod bezier;
mod bresenham;
mod budget;
mod chords;
mod config;
pub mod control;
mod decimal;
mod decimal_text;
#[cfg(feature = "alloc")]
pub mod drawing;
#[cfg(all(feature = "alloc", feature = "font"))]
pub mod dxf;
mod encoder;
mod extremes;
pub mod firmware;
pub mod gcode;
mod geom;
mod homing;
pub mod hpgl;
pub mod kinematics;
mod pid;
mod planner;
pub mod plant;
mod profile;
pub mod protocol;
mod pulse_counter;
mod root;
mod safety;
mod seconds;
mod shapes;
mod stepgen;
mod steps;
mod sync_stop;
mod targets;
pub mod testbed;
mod toolpath;
mod turn;
mod whole;

pub use axis::{Axis, Direction};
pub use bresenham::{Bresenham, StepPair};
pub use budget::{Budget, BudgetError, BudgetLimits, BudgetPart};
pub use chords::chords;
pub use config::{
    AccelChoice, AreaConfig, AxisConfig, BeltConfig, Bound, ConfigError, ContouringConfig, ControlConfig,
    ControllerChoice, Decoding, DriveChoice, EncoderConfig, FileName, HomingConfig, KinematicsChoice,
    KinematicsConfig, KnownMotors, LaserConfig, LoadConfig, Machine, MachineConfig, MachineKind, MachineName,
    MotorConfig, PathChoice, PenConfig, PenLift, PensChoice, PlannerConfig, PointToPointConfig,
    PublishedConfig, SerialConfig, SheetConfig, ShortText, StepperConfig, StrokeOrder, SyncStopConfig,
    ThresholdChoice, TransmissionConfig, VectorizeConfig, VectorizeMode,
};
#[cfg(feature = "toml")]
pub use config::{TomlError, TomlPlace};
pub use decimal::WrittenNumber;
pub use encoder::{Phases, QuadratureX1, QuadratureX2, QuadratureX4};
pub use geom::{Point, Segment, Vec2};
pub(crate) use homing::HomingProgress;
pub use homing::{Homed, Homing, HomingAxis, HomingError, HomingStatus, HomingStep};
pub use pid::{Pid, PidState, SumPid, SumPidState};
pub use planner::{
    AccelLimit, Action, AllModes, Course, ExactOnly, ExactPen, Modes, PathMode, Phase, PlanError, Planner,
    PlannerSettings, Shape, junction_speed,
};
pub use profile::{MotionLimits, ProfileError, ProfilePoint, Ramp, SCurve, Trapezoid, TrapezoidMove};
pub use pulse_counter::PulseCounter;
pub use safety::{Beam, Blocked, Demand, Drive, Duty, DutyError, LimitSwitches, Pulse, SafetyGate};
pub use shapes::{circle, rectangle};
pub use stepgen::{
    BacklashSteps, Busy, Estimator, MotorEvent, PlotTime, PlotTimer, QueuedEvent, StepGen, StepGenSettings,
    StepQueue, TimedEvent,
};
pub use steps::{StepPoint, from_mm};
pub use sync_stop::SyncStop;
pub use targets::{OutOfReach, targets};
pub use toolpath::{Pen, PenMove, PlotOp};
