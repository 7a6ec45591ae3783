//! From what a file says to the machine of its kind.

use super::file_config::{FileAxis, FileConfig};
use super::kinematics::KinematicsChoice;
use super::stepper::DriveChoice;
use super::{AxisConfig, ConfigError, DcConfig, DriveConfig, MachineConfig, OneBeltConfig, SteppersConfig};

impl FileAxis {
    const fn dc(self) -> AxisConfig {
        let Self { counts_per_mm, encoder, motor, load, transmission, .. } = self;
        AxisConfig { counts_per_mm, encoder, motor, load, transmission }
    }
}

impl FileConfig {
    const fn dc(&self) -> DcConfig {
        DcConfig { control: self.control, sync_stop: self.sync_stop, x: self.x.dc(), y: self.y.dc() }
    }
}

impl TryFrom<FileConfig> for MachineConfig {
    type Error = ConfigError;

    /// What machines of the file's kind read.
    fn try_from(file: FileConfig) -> Result<Self, ConfigError> {
        let FileConfig { schema, name, area, serial, .. } = file;
        let drive = match (file.drive, file.kinematics.kind) {
            (DriveChoice::Dc, KinematicsChoice::Cartesian) => DriveConfig::Gantry(file.dc()),
            (DriveChoice::Dc, KinematicsChoice::CoreXy) => DriveConfig::Belt(OneBeltConfig {
                dc: file.dc(),
                signs: file.kinematics.signs,
                belt: file.belt,
                point_to_point: file.point_to_point,
            }),
            (DriveChoice::Stepper, KinematicsChoice::Cartesian) => DriveConfig::Steppers(SteppersConfig {
                planner: file.planner,
                pen: file.pen,
                laser: file.laser,
                homing: file.homing,
                #[cfg(feature = "third-motor")]
                z: file.z,
                #[cfg(feature = "third-motor")]
                second_motor: file.second_motor,
                stepper_motor: file.stepper_motor,
                x: file.x.stepper,
                y: file.y.stepper,
            }),
            (DriveChoice::Stepper, KinematicsChoice::CoreXy) => {
                return Err(ConfigError::Unfit {
                    key: "kinematics.type",
                    value: "corexy",
                    remedy: "does not go with drive = \"stepper\", whose controller moves each axis by its own motor: write \
                             \"cartesian\", or drive = \"dc\" for the motors of a belt",
                });
            }
        };
        Ok(Self { schema, name, area, serial, drive })
    }
}
