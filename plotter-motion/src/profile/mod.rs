//! Speed along a line, planned within limits: [`Ramp`], [`Trapezoid`] and [`SCurve`].
//!
//! ```text
//!  speed     ________                      ______________
//!           /        \                    /              \         Ramp: one slope
//!    ______/          \______ exit      _/                \_       Trapezoid: up, level, down
//!   entry      Trapezoid                      SCurve               SCurve: the same without corners, at rest at both ends
//! ```
//!
//! All three are closed forms: no iteration, so nothing that could fail to converge. They are written so that
//! no difference of nearly equal numbers decides about a result: lengths and times are divided, not speeds
//! subtracted.

mod ramp;
mod s_curve;
mod trapezoid;

pub use ramp::Ramp;
pub use s_curve::{MotionLimits, SCurve};
pub use trapezoid::{Trapezoid, TrapezoidMove};

use core::fmt;

/// Least limit, and greatest limit and length, that a motion is planned with: far beyond any machine, and no
/// product of them overflows.
const LEAST_LIMIT: f64 = 1e-18;
const GREATEST: f64 = 1e18;

/// A number that no motion can be planned with.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ProfileError {
    /// Name of the quantity: `length_mm`, `speed_mm_s`, `accel_mm_s2`, `jerk_mm_s3`, `entry_mm_s` or
    /// `exit_mm_s`.
    pub quantity: &'static str,
    /// Value of the quantity.
    pub value: f64,
    /// Least allowed value.
    pub least: f64,
    /// The most it may be.
    pub most: f64,
}

impl fmt::Display for ProfileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { quantity, value, least, most } = self;
        write!(f, "{quantity} is {value:e}: it must lie in {least:e}..={most:e}")
    }
}

impl core::error::Error for ProfileError {}

/// Refuses what lies outside `least` to `most`, NaN too.
fn within(quantity: &'static str, value: f64, least: f64, most: f64) -> Result<(), ProfileError> {
    if (least..=most).contains(&value) { Ok(()) } else { Err(ProfileError { quantity, value, least, most }) }
}

/// Place, speed and acceleration along a line at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProfilePoint {
    /// Distance from the start, mm.
    pub distance_mm: f64,
    /// Speed, mm/s.
    pub speed_mm_s: f64,
    /// Acceleration, mm/s^2.
    pub accel_mm_s2: f64,
}
