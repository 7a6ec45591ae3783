//! [`Ramp`]: one change of speed at constant acceleration.

use super::{GREATEST, LEAST_LIMIT, ProfileError, ProfilePoint, within};

/// A change of speed at constant acceleration, faster or slower.
///
/// ```text
/// t = |v1 - v0| / a        s = |v1² - v0²| / 2a
/// ```
///
/// ```
/// # use plotter_motion::profile::Ramp;
/// // from 20 to 80 mm/s at 600 mm/s²: 60/600 = 0.1 s, at 50 mm/s on the mean
/// let ramp = Ramp::between(20.0, 80.0, 600.0)?;
/// assert!((ramp.duration_s() - 0.1).abs() < 1e-15);
/// assert!((ramp.length_mm() - 5.0).abs() < 1e-12);
/// assert!((ramp.at(0.05).speed_mm_s - 50.0).abs() < 1e-12);
/// # Ok::<(), plotter_motion::profile::ProfileError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ramp {
    /// The lower and the higher end speed. All is computed from the lower one, where nothing cancels; a ramp
    /// that slows down is one that speeds up, run backwards.
    low_mm_s: f64,
    high_mm_s: f64,
    slows: bool,
    accel_mm_s2: f64,
    length_mm: f64,
    duration_s: f64,
}

impl Ramp {
    /// From one speed to another.
    ///
    /// # Errors
    ///
    /// [`ProfileError`] names a speed outside 0 to 1e18 or an acceleration outside 1e-18 to 1e18; NaN lies
    /// outside.
    pub fn between(entry_mm_s: f64, exit_mm_s: f64, accel_mm_s2: f64) -> Result<Self, ProfileError> {
        within("entry_mm_s", entry_mm_s, 0.0, GREATEST)?;
        within("exit_mm_s", exit_mm_s, 0.0, GREATEST)?;
        within("accel_mm_s2", accel_mm_s2, LEAST_LIMIT, GREATEST)?;
        let slows = exit_mm_s < entry_mm_s;
        let (low_mm_s, high_mm_s) = (entry_mm_s.min(exit_mm_s), entry_mm_s.max(exit_mm_s));
        let duration_s = (high_mm_s - low_mm_s) / accel_mm_s2;
        let length_mm = duration_s * (0.5 * (low_mm_s + high_mm_s));
        Ok(Self { low_mm_s, high_mm_s, slows, accel_mm_s2, length_mm, duration_s })
    }

    /// Over `length_mm`, with the lower of its end speeds given. All three numbers must have been checked.
    pub(super) fn over(length_mm: f64, low_mm_s: f64, accel_mm_s2: f64, slows: bool) -> Self {
        let mut ramp = Self { low_mm_s, slows, accel_mm_s2, length_mm, ..Self::default() };
        ramp.high_mm_s = ramp.speed_beyond(length_mm);
        ramp.duration_s = ramp.time_beyond(length_mm);
        ramp
    }

    /// How long it takes, s.
    #[must_use]
    pub const fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// How far it goes, mm.
    #[must_use]
    pub const fn length_mm(&self) -> f64 {
        self.length_mm
    }

    /// The speed at its start, mm/s.
    #[must_use]
    pub const fn entry_mm_s(&self) -> f64 {
        if self.slows { self.high_mm_s } else { self.low_mm_s }
    }

    /// The speed at its end, mm/s.
    #[must_use]
    pub const fn exit_mm_s(&self) -> f64 {
        if self.slows { self.low_mm_s } else { self.high_mm_s }
    }

    /// Where the motion is `time_s` after its start; at its ends before and after it.
    #[must_use]
    pub fn at(&self, time_s: f64) -> ProfilePoint {
        let time_s = time_s.max(0.0).min(self.duration_s);
        let since_low_s = if self.slows { self.duration_s - time_s } else { time_s };
        // Both ends are exact, whatever is lost in the last bits between them.
        let (from_low_mm, speed_mm_s) = if since_low_s >= self.duration_s {
            (self.length_mm, self.high_mm_s)
        } else {
            let gained_mm_s = self.accel_mm_s2 * since_low_s;
            let from_low_mm = since_low_s * (self.low_mm_s + 0.5 * gained_mm_s);
            (from_low_mm.min(self.length_mm), (self.low_mm_s + gained_mm_s).min(self.high_mm_s))
        };
        if self.slows {
            let distance_mm = self.length_mm - from_low_mm;
            ProfilePoint { distance_mm, speed_mm_s, accel_mm_s2: -self.accel_mm_s2 }
        } else {
            ProfilePoint { distance_mm: from_low_mm, speed_mm_s, accel_mm_s2: self.accel_mm_s2 }
        }
    }

    /// When the motion has gone `distance_mm`, s after its start; its ends before and beyond it.
    ///
    /// ```text
    /// t = 2 s / (v0 + v)        v² = v0² + 2 a s
    /// ```
    #[must_use]
    pub fn time_at(&self, distance_mm: f64) -> f64 {
        let distance_mm = distance_mm.max(0.0).min(self.length_mm);
        if self.slows {
            self.duration_s - self.time_beyond(self.length_mm - distance_mm)
        } else {
            self.time_beyond(distance_mm)
        }
    }

    /// Speed at `length_mm` from the slower end, mm/s. As a hypotenuse it neither overflows nor underflows.
    fn speed_beyond(&self, length_mm: f64) -> f64 {
        libm::hypot(self.low_mm_s, libm::sqrt(2.0 * self.accel_mm_s2) * libm::sqrt(length_mm))
    }

    /// Time between the slower end and the place `length_mm` from it, s: the length over the mean speed.
    fn time_beyond(&self, length_mm: f64) -> f64 {
        let mean_mm_s = 0.5 * (self.low_mm_s + self.speed_beyond(length_mm));
        if mean_mm_s > 0.0 { length_mm / mean_mm_s } else { 0.0 }
    }
}
