//! [`SCurve`]: from rest to rest within limits of speed, acceleration and jerk.
//!
//! ```text
//!  speed      ______________          seven phases: jerk +, 0, -, cruise, jerk -, 0, +
//!            /              \         each of the first three as long as its counterpart;
//!         _ /                \ _      phases that a short line has no room for have length 0
//!  ______/                      \_____
//! ```
//!
//! Source: L. Biagiotti, C. Melchiorri, "Trajectory Planning for Automatic Machines and Robots" (2008),
//! section 3.4 (double S velocity profile), for equal end speeds of zero. There it has a closed form: which
//! phases have a length follows from the limits alone, and no equation needs an iteration.

use super::{GREATEST, LEAST_LIMIT, ProfileError, ProfilePoint, within};

/// Limits of a motion along a line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct MotionLimits {
    /// Greatest speed, mm/s.
    pub speed_mm_s: f64,
    /// Greatest acceleration, mm/s^2.
    pub accel_mm_s2: f64,
    /// Greatest jerk, mm/s^3.
    pub jerk_mm_s3: f64,
}

/// A planned motion from rest to rest.
///
/// ```
/// # use plotter_motion::{MotionLimits, profile::SCurve};
/// let limits = MotionLimits { speed_mm_s: 10.0, accel_mm_s2: 100.0, jerk_mm_s3: 1000.0 };
/// // 0.1 s of each jerk phase reach 100 mm/s^2 and 10 mm/s; 0.2 s up and 0.2 s down cover 2 mm;
/// // the other 8 mm take 0.8 s
/// let motion = SCurve::plan(10.0, limits)?;
/// assert!((motion.duration_s() - 1.2).abs() < 1e-12);
/// assert!((motion.at(0.6).distance_mm - 5.0).abs() < 1e-12);
/// # Ok::<(), plotter_motion::profile::ProfileError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SCurve {
    length_mm: f64,
    jerk_mm_s3: f64,
    /// Length of a phase of jerk, of constant acceleration, and of cruise, s.
    jerk_s: f64,
    steady_s: f64,
    cruise_s: f64,
}

impl SCurve {
    /// Plans the quickest motion over `length_mm` within `limits`.
    ///
    /// # Errors
    ///
    /// [`ProfileError`] names a limit outside 1e-18 to 1e18, or a length outside 0 to 1e18; NaN lies outside.
    pub fn plan(length_mm: f64, limits: MotionLimits) -> Result<Self, ProfileError> {
        let MotionLimits { speed_mm_s, accel_mm_s2, jerk_mm_s3 } = limits;
        within("length_mm", length_mm, 0.0, GREATEST)?;
        for (quantity, value) in
            [("speed_mm_s", speed_mm_s), ("accel_mm_s2", accel_mm_s2), ("jerk_mm_s3", jerk_mm_s3)]
        {
            within(quantity, value, LEAST_LIMIT, GREATEST)?;
        }
        // With full speed: is full acceleration reached on the way to it?
        let reaches_accel = speed_mm_s * jerk_mm_s3 >= accel_mm_s2 * accel_mm_s2;
        let (mut jerk_s, mut steady_s) = if reaches_accel {
            // never negative, whatever the last bits of the two quotients
            let jerk_s = accel_mm_s2 / jerk_mm_s3;
            (jerk_s, (speed_mm_s / accel_mm_s2 - jerk_s).max(0.0))
        } else {
            (libm::sqrt(speed_mm_s / jerk_mm_s3), 0.0)
        };
        // Speeding up and slowing down take the same time, at half the speed on the mean.
        let ramp_s = 2.0 * jerk_s + steady_s;
        let mut cruise_s = length_mm / speed_mm_s - ramp_s;
        if cruise_s < 0.0 {
            cruise_s = 0.0;
            // Full speed is not reached. With full acceleration: length = a (tj + ts)(2 tj + ts).
            let full_jerk_s = accel_mm_s2 / jerk_mm_s3;
            let root = libm::sqrt(full_jerk_s * full_jerk_s + 4.0 * length_mm / accel_mm_s2);
            let steady = 0.5 * (root - 3.0 * full_jerk_s);
            if steady >= 0.0 {
                (jerk_s, steady_s) = (full_jerk_s, steady);
            } else {
                // length = 2 j tj³; by two roots, since the quotient of the shortest length there is has few
                // bits
                (jerk_s, steady_s) = (cube_root(length_mm) / cube_root(2.0 * jerk_mm_s3), 0.0);
            }
        }
        Ok(Self { length_mm, jerk_mm_s3, jerk_s, steady_s, cruise_s })
    }

    /// How long the motion takes, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.cruise_s + 2.0 * self.ramp_s()
    }

    /// How far it goes, mm.
    #[must_use]
    pub const fn length_mm(&self) -> f64 {
        self.length_mm
    }

    /// How long each of the seven phases takes, s: jerk forwards, none, backwards; cruise; jerk backwards,
    /// none, forwards.
    #[must_use]
    pub const fn phases_s(&self) -> [f64; 7] {
        let Self { jerk_s, steady_s, cruise_s, .. } = *self;
        [jerk_s, steady_s, jerk_s, cruise_s, jerk_s, steady_s, jerk_s]
    }

    /// Where the motion is `time_s` after its start; at rest at either end before and after it.
    #[must_use]
    pub fn at(&self, time_s: f64) -> ProfilePoint {
        let duration_s = self.duration_s();
        // The second half mirrors the first.
        if time_s > 0.5 * duration_s {
            let mirrored = self.first_half(duration_s - time_s);
            ProfilePoint {
                distance_mm: self.length_mm - mirrored.distance_mm,
                speed_mm_s: mirrored.speed_mm_s,
                accel_mm_s2: 0.0 - mirrored.accel_mm_s2, // not a negative zero
            }
        } else {
            self.first_half(time_s)
        }
    }

    fn ramp_s(&self) -> f64 {
        2.0 * self.jerk_s + self.steady_s
    }

    fn first_half(&self, time_s: f64) -> ProfilePoint {
        let mut point = ProfilePoint::default();
        let mut rest_s = time_s.max(0.0);
        let jerk = self.jerk_mm_s3;
        for (phase_s, phase_jerk) in
            [(self.jerk_s, jerk), (self.steady_s, 0.0), (self.jerk_s, -jerk), (self.cruise_s, 0.0)]
        {
            if rest_s <= 0.0 {
                break; // the phases to come would add nothing
            }
            let t = rest_s.min(phase_s);
            point.distance_mm +=
                t * (point.speed_mm_s + t * (point.accel_mm_s2 / 2.0 + t * phase_jerk / 6.0));
            point.speed_mm_s += t * (point.accel_mm_s2 + t * phase_jerk / 2.0);
            point.accel_mm_s2 += t * phase_jerk;
            rest_s -= t;
        }
        point
    }
}

/// Cube root of a number above 0, to the last bit or the one before it. `libm::cbrt` is right to the last
/// bit, and takes 2.8 KB of a firmware for that.
///
/// A third of the exponent, and of the fraction with it, is right to 5 bits; each turn of Halley's method
/// triples them. Source of the start: W. Kahan, "Computing a Real Cube Root" (1991).
fn cube_root(value: f64) -> f64 {
    /// 2/3 of the exponent's bias less 0.033, which halves the greatest error of the start.
    const BIAS: u64 = 715_094_163 << 32;
    const TWO_TO_54: f64 = (1_u64 << 54) as f64;
    const TWO_TO_18: f64 = (1_u64 << 18) as f64;
    if value < f64::MIN_POSITIVE {
        let scaled = value * TWO_TO_54;
        return if scaled > 0.0 { cube_root(scaled) / TWO_TO_18 } else { 0.0 };
    }
    let mut root = f64::from_bits(value.to_bits() / 3 + BIAS);
    for _ in 0..4 {
        let cube = root * root * root;
        root *= (cube + 2.0 * value) / (2.0 * cube + value);
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: MotionLimits = MotionLimits { speed_mm_s: 60.0, accel_mm_s2: 600.0, jerk_mm_s3: 20_000.0 };

    #[test]
    fn impossible_limits_are_named() {
        let error = SCurve::plan(1.0, MotionLimits { jerk_mm_s3: 0.0, ..LIMITS }).unwrap_err();
        assert_eq!(std::format!("{error}"), "jerk_mm_s3 is 0e0: it must lie in 1e-18..=1e18");
        assert!(SCurve::plan(-1.0, LIMITS).is_err());
        assert!(SCurve::plan(f64::NAN, LIMITS).is_err());
    }

    #[test]
    fn a_line_without_length_takes_no_time() {
        let motion = SCurve::plan(0.0, LIMITS).unwrap();
        assert_eq!(motion.duration_s(), 0.0);
        assert_eq!(motion.at(1.0), ProfilePoint { accel_mm_s2: 0.0, ..ProfilePoint::default() });
    }

    #[test]
    fn a_cube_root_is_right_to_its_last_bits() {
        assert_eq!(cube_root(27.0), 3.0);
        assert_eq!(cube_root(0.0), 0.0);
        // A few units in the last place.
        const RELATIVE_ERROR: f64 = 1e-15;
        for exponent in -1074..1000 {
            for fraction in [1.0, 1.3, 1.999] {
                let value = libm::ldexp(fraction, exponent);
                let (found, right) = (cube_root(value), libm::cbrt(value));
                assert!((found / right - 1.0).abs() < RELATIVE_ERROR, "{value:e}: {found:e} {right:e}");
            }
        }
    }
}
