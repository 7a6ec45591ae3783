//! [`Trapezoid`]: speed up, go on, slow down, from one given speed to another.

use super::{GREATEST, LEAST_LIMIT, ProfileError, ProfilePoint, Ramp, within};

/// Input of a [`Trapezoid`]: length and speeds of a move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrapezoidMove {
    /// How far, mm.
    pub length_mm: f64,
    /// Speed at the start, mm/s; at most `speed_mm_s`.
    pub entry_mm_s: f64,
    /// Speed wanted at the end, mm/s; at most `speed_mm_s`.
    pub exit_mm_s: f64,
    /// Greatest speed, mm/s.
    pub speed_mm_s: f64,
    /// Greatest acceleration, speeding up and slowing down, mm/s^2.
    pub accel_mm_s2: f64,
}

/// The quickest motion over a length from one speed to another, with limited speed and acceleration.
///
/// ```text
///  speed        peak           s1: speeding up      v1, v0: exit and entry speed
///        ______________        s2: peak speed       s1 = L/2 + (v1² - v0²)/4a     where full speed is not reached
///       /              \       s3: slowing down     s1 = (v² - v0²)/2a            where it is
///   v0 /  s1    s2   s3 \ v1
/// ```
///
/// Where the length is too short for the wanted exit speed, the whole length is one ramp at full
/// acceleration: the motion ends as fast as it can become, or as slowly. [`Trapezoid::exit_mm_s`] says at
/// which speed. (A planner that looks ahead never asks for such a motion.)
///
/// Source: L. Biagiotti, C. Melchiorri, "Trajectory Planning for Automatic Machines and Robots" (2008),
/// section 3.2 (linear trajectory with parabolic blends), with lengths instead of speeds as unknowns, so that
/// nothing cancels however short the motion.
///
/// ```
/// # use plotter_motion::profile::{Trapezoid, TrapezoidMove};
/// let asked = TrapezoidMove { length_mm: 30.0, entry_mm_s: 0.0, exit_mm_s: 50.0, speed_mm_s: 100.0, accel_mm_s2: 500.0 };
/// // up to 100 mm/s in 10 mm and 0.2 s, down to 50 mm/s in 7.5 mm and 0.1 s; 12.5 mm between them take 0.125 s
/// let motion = Trapezoid::plan(asked)?;
/// assert!((motion.duration_s() - 0.425).abs() < 1e-15);
/// // over 2 mm it becomes no faster than sqrt(2 * 500 * 2) = 44.72 mm/s
/// let short = Trapezoid::plan(TrapezoidMove { length_mm: 2.0, ..asked })?;
/// assert!((short.exit_mm_s() - 44.721).abs() < 1e-3);
/// # Ok::<(), plotter_motion::profile::ProfileError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Trapezoid {
    length_mm: f64,
    up: Ramp,
    cruise_mm: f64,
    peak_mm_s: f64,
    down: Ramp,
}

impl Trapezoid {
    /// Plans the quickest motion.
    ///
    /// # Errors
    ///
    /// [`ProfileError`] names a limit outside 1e-18 to 1e18, a length outside 0 to 1e18, or an entry or exit
    /// speed outside 0 to `speed_mm_s`; NaN lies outside.
    pub fn plan(asked: TrapezoidMove) -> Result<Self, ProfileError> {
        let TrapezoidMove { length_mm, entry_mm_s, exit_mm_s, speed_mm_s, accel_mm_s2 } = asked;
        within("length_mm", length_mm, 0.0, GREATEST)?;
        within("speed_mm_s", speed_mm_s, LEAST_LIMIT, GREATEST)?;
        within("accel_mm_s2", accel_mm_s2, LEAST_LIMIT, GREATEST)?;
        within("entry_mm_s", entry_mm_s, 0.0, speed_mm_s)?;
        within("exit_mm_s", exit_mm_s, 0.0, speed_mm_s)?;

        let to_full = |from_mm_s| Ramp::between(from_mm_s, speed_mm_s, accel_mm_s2);
        let (up, down) = (to_full(entry_mm_s)?, Ramp::between(speed_mm_s, exit_mm_s, accel_mm_s2)?);
        let cruise_mm = length_mm - up.length_mm() - down.length_mm();
        if cruise_mm >= 0.0 {
            return Ok(Self { length_mm, up, cruise_mm, peak_mm_s: speed_mm_s, down });
        }
        // Full speed is not reached: both ramps meet where they have the same speed.
        let apart_mm = (exit_mm_s - entry_mm_s) * ((exit_mm_s + entry_mm_s) / (4.0 * accel_mm_s2));
        let up_mm = 0.5 * length_mm + apart_mm;
        let exit_mm_s = if up_mm < 0.0 {
            let lost = 2.0 * accel_mm_s2 * length_mm;
            libm::sqrt(libm::fma(entry_mm_s, entry_mm_s, -lost).max(0.0)).max(exit_mm_s)
        } else {
            exit_mm_s
        };
        // A ramp that there is no room for has no length, at the peak's speed.
        let up_mm = up_mm.max(0.0).min(length_mm);
        let (mut up, mut down) = (
            Ramp::over(up_mm, entry_mm_s, accel_mm_s2, false),
            Ramp::over(length_mm - up_mm, exit_mm_s, accel_mm_s2, true),
        );
        if up_mm == length_mm {
            down = Ramp::over(0.0, up.exit_mm_s(), accel_mm_s2, true);
        } else if up_mm == 0.0 {
            up = Ramp::over(0.0, down.entry_mm_s(), accel_mm_s2, false);
        }
        let peak_mm_s = up.exit_mm_s().min(speed_mm_s);
        Ok(Self { length_mm, up, cruise_mm: 0.0, peak_mm_s, down })
    }

    /// How long the motion takes, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.up.duration_s() + self.cruise_s() + self.down.duration_s()
    }

    /// How far it goes, mm.
    #[must_use]
    pub const fn length_mm(&self) -> f64 {
        self.length_mm
    }

    /// Greatest speed of the profile, mm/s.
    #[must_use]
    pub const fn peak_mm_s(&self) -> f64 {
        self.peak_mm_s
    }

    /// The speed at its end, mm/s: the wanted one, unless the length is too short for that.
    #[must_use]
    pub const fn exit_mm_s(&self) -> f64 {
        self.down.exit_mm_s()
    }

    /// Where the motion is `time_s` after its start; at its ends before and after it.
    #[must_use]
    pub fn at(&self, time_s: f64) -> ProfilePoint {
        let duration_s = self.duration_s();
        let left_s = duration_s - time_s;
        let down_s = self.down.duration_s();
        if left_s <= down_s {
            // Measured from the end, so that the end is exact.
            let point = self.down.at(down_s - left_s.max(0.0));
            let left_mm = self.down.length_mm() - point.distance_mm;
            return ProfilePoint { distance_mm: self.length_mm - left_mm, ..point };
        }
        if time_s > self.up.duration_s() {
            let gone_mm = (time_s - self.up.duration_s()) * self.peak_mm_s;
            let distance_mm = self.up.length_mm() + gone_mm.min(self.cruise_mm);
            return ProfilePoint { distance_mm, speed_mm_s: self.peak_mm_s, accel_mm_s2: 0.0 };
        }
        self.up.at(time_s)
    }

    /// When the motion has gone `distance_mm`, s after its start; its ends before and beyond it.
    #[must_use]
    pub fn time_at(&self, distance_mm: f64) -> f64 {
        let cruised_mm = distance_mm - self.up.length_mm();
        if cruised_mm <= 0.0 {
            return self.up.time_at(distance_mm);
        }
        let up_s = self.up.duration_s();
        if cruised_mm <= self.cruise_mm {
            return up_s + cruised_mm / self.peak_mm_s;
        }
        up_s + self.cruise_s() + self.down.time_at(cruised_mm - self.cruise_mm)
    }

    fn cruise_s(&self) -> f64 {
        if self.cruise_mm > 0.0 { self.cruise_mm / self.peak_mm_s } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ASKED: TrapezoidMove = TrapezoidMove {
        length_mm: 10.0,
        entry_mm_s: 30.0,
        exit_mm_s: 0.0,
        speed_mm_s: 60.0,
        accel_mm_s2: 600.0,
    };

    #[test]
    fn entry_and_exit_above_the_greatest_speed_are_refused() {
        let error = Trapezoid::plan(TrapezoidMove { entry_mm_s: 61.0, ..ASKED }).unwrap_err();
        assert_eq!(std::format!("{error}"), "entry_mm_s is 6.1e1: it must lie in 0e0..=6e1");
        assert!(Trapezoid::plan(TrapezoidMove { exit_mm_s: f64::NAN, ..ASKED }).is_err());
    }

    #[test]
    fn a_length_too_short_to_stop_in_is_braked_along_all_of_it() {
        /// Rounding of a square root of numbers of a few hundred.
        const ROUNDING: f64 = 1e-12;
        // 30² - 2 * 600 * 0.5 = 300
        let motion = Trapezoid::plan(TrapezoidMove { length_mm: 0.5, ..ASKED }).unwrap();
        assert!((motion.exit_mm_s() - libm::sqrt(300.0)).abs() < ROUNDING);
        assert_eq!(motion.at(0.0).accel_mm_s2, -600.0);
        assert!((motion.at(0.0).speed_mm_s - 30.0).abs() < ROUNDING);
    }

    #[test]
    fn a_motion_without_length_takes_no_time() {
        let motion = Trapezoid::plan(TrapezoidMove { length_mm: 0.0, entry_mm_s: 0.0, ..ASKED }).unwrap();
        assert_eq!((motion.duration_s(), motion.exit_mm_s()), (0.0, 0.0));
        let passing = Trapezoid::plan(TrapezoidMove { length_mm: 0.0, exit_mm_s: 30.0, ..ASKED }).unwrap();
        assert_eq!((passing.duration_s(), passing.exit_mm_s()), (0.0, 30.0));
    }
}
