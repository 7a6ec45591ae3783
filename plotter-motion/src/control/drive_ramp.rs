//! [`DriveRamp`]: a drive that grows by a step every tenth of a second.

use core::time::Duration;

/// The acceleration of the marking board (Khan and McGinn, section 0.2.6): from `start` the drive grows by
/// `step` every `period`, up to `most`.
///
/// ```
/// # use plotter_motion::control::DriveRamp;
/// # use core::time::Duration;
/// let ramp = DriveRamp { start: 0.2, step: 0.1, most: 0.45, period: Duration::from_millis(100) };
/// let at = |ms| ramp.after(Duration::from_millis(ms));
/// assert_eq!((at(0), at(99), at(100)), (0.2, 0.2, 0.3));
/// assert_eq!(at(100_000), 0.45);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct DriveRamp {
    /// Drive at once, 0 to 1.
    pub start: f32,
    /// Increase of the drive per run, 0 to 1.
    pub step: f32,
    /// Drive that it ends at, 0 to 1.
    pub most: f32,
    /// How long a step lasts; without length the drive is `most` at once.
    pub period: Duration,
}

impl DriveRamp {
    /// The drive when the move began `elapsed` ago.
    #[must_use]
    pub fn after(&self, elapsed: Duration) -> f32 {
        let steps = elapsed.as_micros().checked_div(self.period.as_micros()).unwrap_or(u128::MAX);
        let steps = u16::try_from(steps).unwrap_or(u16::MAX);
        let drive = self.start + self.step * f32::from(steps);
        if self.period.is_zero() || drive >= self.most { self.most } else { drive }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_without_a_period_is_at_its_end() {
        let ramp = DriveRamp { start: 0.1, step: 0.0, most: 0.5, period: Duration::ZERO };
        assert_eq!(ramp.after(Duration::ZERO), 0.5);
        let level = DriveRamp { period: Duration::from_millis(100), ..ramp };
        assert_eq!(level.after(Duration::MAX), 0.1);
    }
}
