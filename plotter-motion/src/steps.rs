//! Motor positions as integers: microsteps of a stepper, or counts of an encoder.
//!
//! Integers are the truth on the machine; millimetres are a view of them, made in one place. The two are
//! different types and do not mix:
//!
//! ```compile_fail
//! # use plotter_motion::{Point, StepPoint};
//! let wrong: Point = StepPoint { x: 40, y: 0 };
//! ```

use crate::whole::nearest;

/// Position of both motors, in microsteps or encoder counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StepPoint {
    /// First motor.
    pub x: i32,
    /// Second motor.
    pub y: i32,
}

impl StepPoint {
    /// The position `x`, `y`.
    #[must_use]
    pub const fn new(x: i32, y: i32) -> Self {
        Self { x, y }
    }
}

/// Steps for a length: `mm * steps_per_mm`, rounded to nearest with halves away from zero, saturating at
/// the ends of `i32`; a NaN gives 0.
///
/// ```
/// # use plotter_motion::toolpath::from_mm;
/// assert_eq!(from_mm(60.0, 40.0), 2400);
/// assert_eq!(from_mm(-0.0125, 40.0), -1); // a half, away from zero
/// ```
#[must_use]
pub fn from_mm(mm: f64, steps_per_mm: f64) -> i32 {
    whole_steps(mm * steps_per_mm)
}

/// The nearest whole number of steps, as [`from_mm`] rounds.
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn whole_steps(steps: f64) -> i32 {
    let steps = nearest(steps);
    i32::try_from(steps).unwrap_or(if steps < 0 { i32::MIN } else { i32::MAX })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_saturates_and_survives_nan() {
        assert_eq!(from_mm(1e12, 80.0), i32::MAX);
        assert_eq!(from_mm(-1e12, 80.0), i32::MIN);
        assert_eq!(from_mm(f64::NAN, 80.0), 0);
        assert_eq!(from_mm(2.5, 1.0), 3);
    }
}
