//! [`FileConfig`]: all that a machine's file may say, for machines of every kind.
//!
//! A file has the tables of all kinds of motors, and a machine reads those of its own. What it does not read
//! is checked key by key as the rest is, so that a file is right for whatever its `drive` says.

use super::kinematics::{KinematicsChoice, KinematicsConfig};
use super::stepper::DriveChoice;
use super::{
    AreaConfig, AxisConfig, BeltConfig, ControlConfig, DcConfig, DriveConfig, EncoderConfig, HomingConfig,
    LaserConfig, LoadConfig, MachineConfig, MachineName, MotorConfig, OneBeltConfig, PenConfig,
    PlannerConfig, PointToPointConfig, SerialConfig, StepperConfig, SyncStopConfig, TransmissionConfig,
};
#[cfg(feature = "third-motor")]
use super::{SecondMotorConfig, ZConfig};
use crate::plant::StepperSettings;

/// What a file says, table by table.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub(crate) struct FileConfig {
    pub(super) schema: u32,
    pub(super) name: MachineName,
    pub(super) drive: DriveChoice,
    pub(super) area: AreaConfig,
    pub(super) serial: SerialConfig,
    pub(super) control: ControlConfig,
    pub(super) sync_stop: SyncStopConfig,
    pub(super) planner: PlannerConfig,
    pub(super) pen: PenConfig,
    pub(super) laser: LaserConfig,
    pub(super) homing: HomingConfig,
    #[cfg(feature = "third-motor")]
    pub(super) z: ZConfig,
    #[cfg(feature = "third-motor")]
    pub(super) second_motor: SecondMotorConfig,
    pub(super) stepper_motor: StepperSettings,
    pub(super) kinematics: KinematicsConfig,
    pub(super) belt: BeltConfig,
    pub(super) point_to_point: PointToPointConfig,
    pub(super) x: FileAxis,
    pub(super) y: FileAxis,
}

/// An axis with a motor of either kind.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub(crate) struct FileAxis {
    pub(super) counts_per_mm: f64,
    pub(super) encoder: EncoderConfig,
    pub(super) motor: MotorConfig,
    pub(super) load: LoadConfig,
    pub(super) transmission: TransmissionConfig,
    pub(super) stepper: StepperConfig,
}

impl FileAxis {
    const fn new(axis: AxisConfig, stepper: StepperConfig) -> Self {
        let AxisConfig { counts_per_mm, encoder, motor, load, transmission } = axis;
        Self { counts_per_mm, encoder, motor, load, transmission, stepper }
    }
}

impl Default for FileAxis {
    fn default() -> Self {
        Self::new(AxisConfig::default(), StepperConfig::default())
    }
}

impl Default for FileConfig {
    /// What a key has that a file leaves out: the documented gantry's, of stepper motors the documented
    /// stepper plotter's, of a belt the documented marking board's.
    fn default() -> Self {
        Self {
            schema: 1,
            name: MachineName::SEMI_VIRTUAL_GANTRY,
            drive: DriveChoice::Dc,
            area: AreaConfig::default(),
            serial: SerialConfig::default(),
            control: ControlConfig::default(),
            sync_stop: SyncStopConfig::default(),
            planner: PlannerConfig::default(),
            pen: PenConfig::default(),
            laser: LaserConfig::default(),
            homing: HomingConfig::default(),
            #[cfg(feature = "third-motor")]
            z: ZConfig::default(),
            #[cfg(feature = "third-motor")]
            second_motor: SecondMotorConfig::default(),
            stepper_motor: StepperSettings::default(),
            kinematics: KinematicsConfig::default(),
            belt: BeltConfig::default(),
            point_to_point: PointToPointConfig::default(),
            x: FileAxis::default(),
            y: FileAxis::default(),
        }
    }
}

impl FileConfig {
    const fn with_dc(self, dc: DcConfig) -> Self {
        let DcConfig { control, sync_stop, x, y } = dc;
        let (x, y) = (FileAxis::new(x, self.x.stepper), FileAxis::new(y, self.y.stepper));
        Self { control, sync_stop, x, y, ..self }
    }
}

impl From<MachineConfig> for FileConfig {
    /// What the machine does not have is as in a file that leaves it out.
    fn from(config: MachineConfig) -> Self {
        let MachineConfig { schema, name, area, serial, drive } = config;
        let common = Self { schema, name, area, serial, ..Self::default() };
        match drive {
            DriveConfig::Gantry(dc) => common.with_dc(dc),
            DriveConfig::Belt(OneBeltConfig { dc, signs, belt, point_to_point }) => Self {
                kinematics: KinematicsConfig { kind: KinematicsChoice::CoreXy, signs },
                belt,
                point_to_point,
                ..common.with_dc(dc)
            },
            DriveConfig::Steppers(steppers) => Self {
                drive: DriveChoice::Stepper,
                planner: steppers.planner,
                pen: steppers.pen,
                laser: steppers.laser,
                homing: steppers.homing,
                #[cfg(feature = "third-motor")]
                z: steppers.z,
                #[cfg(feature = "third-motor")]
                second_motor: steppers.second_motor,
                stepper_motor: steppers.stepper_motor,
                x: FileAxis { stepper: steppers.x, ..common.x },
                y: FileAxis { stepper: steppers.y, ..common.y },
                ..common
            },
        }
    }
}
