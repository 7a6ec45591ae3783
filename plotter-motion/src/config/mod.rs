//! A machine as data: [`MachineConfig`] says what a file says, [`Machine`] is what has been checked.
//!
//! What one kind of motors needs stands in a variant of [`DriveConfig`]; the crates above have sections of
//! their own in the same file ([`Section`]).
//!
//! ```text
//!  machine.toml ──from_toml──▶ MachineConfig ──Machine::new──▶ Machine ──▶ controller, simulated motors
//!                  │ TomlError                  │ ConfigError
//!                  line, column, key, remedy    key, value, range, remedy
//! ```

mod belt_check;
mod belt_rules;
mod drive_config;
mod error;
mod file_config;
mod kinematics;
mod machine;
mod machine_config;
mod machine_kind;
mod name;
#[cfg(feature = "serde")]
mod of_file;
mod presets;
mod rules;
mod section;
#[cfg(feature = "toml")]
mod spelling;
mod stepper;
#[cfg(feature = "third-motor")]
mod third_motor;
#[cfg(feature = "toml")]
mod toml_error;
#[cfg(feature = "toml")]
mod toml_file;
mod transmission;

pub use drive_config::{DcConfig, DriveConfig, OneBeltConfig, SteppersConfig};
pub use error::{Bound, ConfigError};
pub(crate) use file_config::FileConfig;
pub use kinematics::{BeltConfig, KnownMotors, PointToPointConfig};
pub use machine::Machine;
pub(crate) use machine_config::CLAMPS_V;
pub use machine_config::{
    AreaConfig, AxisConfig, ContouringConfig, ControlConfig, ControllerChoice, Decoding, EncoderConfig,
    LoadConfig, MachineConfig, MotorConfig, PublishedConfig, SerialConfig, SyncStopConfig,
};
pub use machine_kind::MachineKind;
pub use name::{FileName, MachineName, ShortText};
pub use section::{Key, Section};
pub use stepper::{
    AccelChoice, HomingConfig, JerkChoice, LaserConfig, PathChoice, PenConfig, PenLift, PlannerConfig,
    StepperConfig,
};
#[cfg(feature = "third-motor")]
pub use third_motor::{SecondMotorChoice, SecondMotorConfig, ZConfig};
#[cfg(feature = "toml")]
pub use toml_error::{TomlError, TomlPlace};
pub use transmission::TransmissionConfig;
