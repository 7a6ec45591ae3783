//! The simulated sheet.

mod noise;
mod sensor;

pub use sensor::{SensedJoint, SensorNoise};
