//! [`DriveConfig`]: what a machine's description says of its motors, one form for each kind.

use super::{
    AxisConfig, BeltConfig, ConfigError, ControlConfig, HomingConfig, LaserConfig, Machine, MachineConfig,
    MachineKind, PenConfig, PlannerConfig, PointToPointConfig, StepperConfig, SyncStopConfig,
};
#[cfg(feature = "third-motor")]
use super::{SecondMotorConfig, ZConfig};
use crate::kinematics::BeltSigns;
use crate::plant::StepperSettings;

/// The motors of a machine and how they move its pen: the keys `drive` and `kinematics.type` of its file, and
/// the tables that only this kind of machine reads.
///
/// A new kind is a breaking change on purpose: whoever matches on it must say what becomes of such a machine.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a program has one or two machines, and nowhere to box them")]
pub enum DriveConfig {
    /// Two DC motors with encoders, each of which moves an axis.
    Gantry(DcConfig),
    /// Two DC motors with encoders on one belt (`CoreXY`), each of which moves the pen along a diagonal.
    Belt(OneBeltConfig),
    /// Two stepper motors, each of which moves an axis.
    Steppers(SteppersConfig),
}

impl DriveConfig {
    /// Kind of the machine, by its motors and how they move the pen.
    #[must_use]
    pub const fn kind(&self) -> MachineKind {
        match self {
            Self::Gantry(_) => MachineKind::Gantry,
            Self::Belt(_) => MachineKind::Belt,
            Self::Steppers(_) => MachineKind::Steppers,
        }
    }
}

impl Default for DriveConfig {
    /// The documented gantry's.
    fn default() -> Self {
        Self::Gantry(DcConfig::default())
    }
}

/// Two DC motors with encoders, and how they are led along a line.
///
/// The default is the documented gantry's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct DcConfig {
    /// How the motors are led along a line.
    pub control: ControlConfig,
    /// When one motor waits for the other.
    pub sync_stop: SyncStopConfig,
    /// First axis: to the right; the first motor of a belt.
    pub x: AxisConfig,
    /// Second axis: up; the second motor of a belt.
    pub y: AxisConfig,
}

/// Two DC motors on one belt.
///
/// The default is the documented marking board's.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct OneBeltConfig {
    /// The motors, and how they are led.
    pub dc: DcConfig,
    /// Directions of the motors: the key `kinematics.signs`.
    pub signs: BeltSigns,
    /// The belt and its rails.
    pub belt: BeltConfig,
    /// The published controller.
    pub point_to_point: PointToPointConfig,
}

/// Two stepper motors, each of which moves an axis, and the pen, laser and switches of their plotter.
///
/// The default is the documented stepper plotter's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct SteppersConfig {
    /// How moves are planned.
    pub planner: PlannerConfig,
    /// The pen.
    pub pen: PenConfig,
    /// The laser.
    pub laser: LaserConfig,
    /// How the ends of the axes are found.
    pub homing: HomingConfig,
    /// A third axis.
    #[cfg(feature = "third-motor")]
    pub z: ZConfig,
    /// Two motors on an axis.
    #[cfg(feature = "third-motor")]
    pub second_motor: SecondMotorConfig,
    /// The motors, both alike, as they are simulated.
    pub stepper_motor: StepperSettings,
    /// First axis, to the right: the table `[x.stepper]`.
    pub x: StepperConfig,
    /// Second axis, up: the table `[y.stepper]`.
    pub y: StepperConfig,
}

impl DcConfig {
    /// The DC motors of a machine, on a belt or not. A machine with stepper motors has none: of it this is
    /// the documented gantry's, so ask [`Machine::require`] first.
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        machine.config().dc().copied().unwrap_or_default()
    }
}

impl OneBeltConfig {
    /// The belt of a machine. A machine without has none: of it these are its DC motors, or the documented
    /// gantry's, on the documented marking board's belt, so ask [`Machine::require`] first.
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        match &machine.config().drive {
            DriveConfig::Belt(belt) => *belt,
            DriveConfig::Gantry(_) | DriveConfig::Steppers(_) => {
                Self { dc: DcConfig::of(machine), ..Self::default() }
            }
        }
    }
}

impl SteppersConfig {
    /// The stepper motors of a machine. A machine with DC motors has none: of it this is the documented
    /// stepper plotter's, so ask [`Machine::require`] first.
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        machine.config().steppers().copied().unwrap_or_default()
    }
}

impl MachineConfig {
    /// The DC motors, on a belt or not; `None` for stepper motors.
    #[must_use]
    pub const fn dc(&self) -> Option<&DcConfig> {
        match &self.drive {
            DriveConfig::Gantry(dc) | DriveConfig::Belt(OneBeltConfig { dc, .. }) => Some(dc),
            DriveConfig::Steppers(_) => None,
        }
    }

    /// The same, to be changed.
    #[must_use]
    pub const fn dc_mut(&mut self) -> Option<&mut DcConfig> {
        match &mut self.drive {
            DriveConfig::Gantry(dc) | DriveConfig::Belt(OneBeltConfig { dc, .. }) => Some(dc),
            DriveConfig::Steppers(_) => None,
        }
    }

    /// The two motors on one belt; `None` for other machines.
    #[must_use]
    pub const fn belt(&self) -> Option<&OneBeltConfig> {
        if let DriveConfig::Belt(belt) = &self.drive { Some(belt) } else { None }
    }

    /// The same, to be changed.
    #[must_use]
    pub const fn belt_mut(&mut self) -> Option<&mut OneBeltConfig> {
        if let DriveConfig::Belt(belt) = &mut self.drive { Some(belt) } else { None }
    }

    /// The stepper motors; `None` for DC motors.
    #[must_use]
    pub const fn steppers(&self) -> Option<&SteppersConfig> {
        if let DriveConfig::Steppers(steppers) = &self.drive { Some(steppers) } else { None }
    }

    /// The same, to be changed.
    #[must_use]
    pub const fn steppers_mut(&mut self) -> Option<&mut SteppersConfig> {
        if let DriveConfig::Steppers(steppers) = &mut self.drive { Some(steppers) } else { None }
    }
}

impl From<DcConfig> for MachineConfig {
    /// The documented gantry with these motors.
    fn from(dc: DcConfig) -> Self {
        Self { drive: DriveConfig::Gantry(dc), ..Self::default() }
    }
}

impl From<OneBeltConfig> for MachineConfig {
    /// The documented marking board with these motors.
    fn from(belt: OneBeltConfig) -> Self {
        Self { drive: DriveConfig::Belt(belt), ..Self::marking_board() }
    }
}

impl From<SteppersConfig> for MachineConfig {
    /// The documented stepper plotter with these motors.
    fn from(steppers: SteppersConfig) -> Self {
        Self { drive: DriveConfig::Steppers(steppers), ..Self::stepper_plotter() }
    }
}

impl Machine {
    /// The motors of a gantry.
    ///
    /// # Errors
    ///
    /// [`ConfigError::OtherKind`], as [`Machine::require`], for a machine of another kind.
    pub fn gantry(&self, user: &'static str) -> Result<&DcConfig, ConfigError> {
        match &self.config().drive {
            DriveConfig::Gantry(dc) => Ok(dc),
            other => Err(ConfigError::OtherKind { found: other.kind(), wanted: MachineKind::Gantry, user }),
        }
    }

    /// The motors on a belt.
    ///
    /// # Errors
    ///
    /// [`ConfigError::OtherKind`], as [`Machine::require`], for a machine of another kind.
    pub fn belt(&self, user: &'static str) -> Result<&OneBeltConfig, ConfigError> {
        match &self.config().drive {
            DriveConfig::Belt(belt) => Ok(belt),
            other => Err(ConfigError::OtherKind { found: other.kind(), wanted: MachineKind::Belt, user }),
        }
    }

    /// The stepper motors.
    ///
    /// # Errors
    ///
    /// [`ConfigError::OtherKind`], as [`Machine::require`], for a machine of another kind.
    ///
    /// ```
    /// # use plotter_motion::{Machine, MachineConfig};
    /// let plotter = Machine::new(MachineConfig::stepper_plotter())?;
    /// assert_eq!(plotter.steppers("this example")?.x.steps_per_mm, 87.58);
    /// assert!(plotter.gantry("this example").is_err());
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    pub fn steppers(&self, user: &'static str) -> Result<&SteppersConfig, ConfigError> {
        match &self.config().drive {
            DriveConfig::Steppers(steppers) => Ok(steppers),
            other => Err(ConfigError::OtherKind { found: other.kind(), wanted: MachineKind::Steppers, user }),
        }
    }
}
