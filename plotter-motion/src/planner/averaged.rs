//! [`PlannerSettings::averaged`]: what to plan with so that the average of the motion keeps a jerk as a
//! vector.

use super::settings::{AccelLimit, LEAST_TOLERANCE_MM, LIMITS, MOST_JERK};
use super::{AllModes, PathMode, PlanError, PlannerSettings};

/// Share of the tolerance that the average may take, the rest is for the corners. Less makes the window
/// short, and with it the acceleration; more makes corners slow. Of the owl and the curves of the results
/// 0.35, 0.5, 0.65 and 0.8 take 38.3, 37.2, 37.4, 39.3 s and 53.3, 51.1, 49.7, 48.8 s.
const AVERAGE_SHARE: f64 = 0.6;

/// What a planner is given, and the window over which its motion is averaged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Averaged {
    /// The limits to plan with: trapezoids, of an acceleration that may be lower than the machine's.
    pub settings: PlannerSettings,
    /// Time over which places are averaged, s; 0 if they are not.
    pub window_s: f64,
}

impl Averaged {
    /// The window in ticks of a clock, for [`AveragedSteps`](crate::stepgen::AveragedSteps).
    #[must_use]
    pub fn window_ticks(&self, clock_hz: u32) -> u32 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast saturates")]
        let ticks = libm::ceil(self.window_s * f64::from(clock_hz)) as u32;
        ticks
    }
}

impl PlannerSettings {
    /// What to plan with so that the motion, averaged over a window by
    /// [`AveragedSteps`](crate::stepgen::AveragedSteps), has at most this jerk as a vector, in mm/s³, at
    /// every instant, and still keeps the tolerance, the acceleration and the speed of these settings.
    ///
    /// An acceleration of at most A averaged over T changes by at most 2 A / T a second, and the pen is at
    /// most A T² / 24 from the path. So with a jerk J, and σ of the tolerance ε for the average:
    ///
    /// ```text
    /// T = min(2 A / J, (48 σ ε / J)^⅓),   planned with A' = min(A, J T / 2) within ε − A' T² / 24
    /// ```
    ///
    /// It costs time: the acceleration is J T / 2 along straight lines, too, and each rest takes T more.
    ///
    /// ```
    /// # use plotter_motion::{PathMode, PlannerSettings};
    /// let path = PathMode::Tolerance { path_tolerance_mm: 0.05 };
    /// let limits = PlannerSettings { path, ..PlannerSettings::default() }; // 1000 mm/s²
    /// let averaged = limits.averaged(20_000.0)?;
    /// assert!((averaged.window_s - 0.0416).abs() < 1e-4);
    /// assert!((averaged.settings.accel_mm_s2 - 416.0).abs() < 0.2);
    /// assert!((2.0 * averaged.settings.accel_mm_s2 / averaged.window_s - 20_000.0).abs() < 1e-6);
    /// // A machine that cannot do more anyway keeps its acceleration, and takes less of the tolerance.
    /// let slow = PlannerSettings { accel_mm_s2: 100.0, ..limits }.averaged(20_000.0)?;
    /// assert_eq!((slow.settings.accel_mm_s2, slow.window_s), (100.0, 0.01));
    /// # Ok::<(), plotter_motion::planner::PlanError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`PlanError::Corners`] in exact mode. [`PlanError::Setting`] for a jerk or a limit out of range.
    pub fn averaged(&self, jerk_mm_s3: f64) -> Result<Averaged, PlanError> {
        self.check::<AllModes>()?;
        let PathMode::Tolerance { path_tolerance_mm } = self.path else {
            return Err(PlanError::Corners { quantity: "the jerk as a vector" });
        };
        let least = LIMITS.0;
        if !(least..=MOST_JERK).contains(&jerk_mm_s3) {
            return Err(PlanError::Setting {
                quantity: "jerk_mm_s3",
                value: jerk_mm_s3,
                least,
                most: MOST_JERK,
            });
        }
        Ok(self.divided(path_tolerance_mm, jerk_mm_s3))
    }

    /// What to plan with for these settings: [`averaged`](Self::averaged) where they limit the jerk as a
    /// vector. Else they are that themselves, and nothing is averaged: the window is 0.
    ///
    /// ```
    /// # #[cfg(feature = "averaged-steps")] {
    /// # use plotter_motion::{PathMode, PlannerSettings, planner::JerkLimit};
    /// let path = PathMode::Tolerance { path_tolerance_mm: 0.05 };
    /// let along = PlannerSettings { path, jerk_mm_s3: Some(20_000.0), ..PlannerSettings::default() };
    /// assert_eq!(along.planned()?.window_s, 0.0);
    /// let vector = PlannerSettings { jerk_limit: JerkLimit::Vector, ..along };
    /// assert_eq!(vector.planned()?, along.averaged(20_000.0)?);
    /// # }
    /// # Ok::<(), plotter_motion::planner::PlanError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`PlanError`] for settings that nothing can be planned with.
    pub fn planned(&self) -> Result<Averaged, PlanError> {
        self.check::<AllModes>()?;
        Ok(self.planned_of_checked())
    }

    /// The same of settings that have been checked.
    pub(crate) fn planned_of_checked(&self) -> Averaged {
        match (self.vector_jerk(), self.path) {
            (Some(jerk_mm_s3), PathMode::Tolerance { path_tolerance_mm }) => {
                self.divided(path_tolerance_mm, jerk_mm_s3)
            }
            _ => Averaged { settings: *self, window_s: 0.0 },
        }
    }

    /// Whether the steps of motion with these limits, averaged, are at most `room` within the window.
    ///
    /// T is at most room / rate if J is at least one of what makes its two bounds as long. The rate is that
    /// of both motors at full speed, which is more than any direction has.
    #[cfg(feature = "averaged-steps")]
    pub(crate) const fn check_room(
        &self,
        x_steps_per_mm: f64,
        y_steps_per_mm: f64,
        room: u32,
    ) -> Result<(), PlanError> {
        let (Some(jerk_mm_s3), PathMode::Tolerance { path_tolerance_mm }) = (self.vector_jerk(), self.path)
        else {
            return Ok(());
        };
        let accel = match self.accel_limit {
            AccelLimit::Vector => self.accel_mm_s2,
            AccelLimit::Axes { x_mm_s2: one, y_mm_s2: other }
            | AccelLimit::Belts { sum_mm_s2: one, difference_mm_s2: other } => one + other,
        };
        let most_s =
            room as f64 / (self.speed_mm_s.max(self.travel_speed_mm_s) * (x_steps_per_mm + y_steps_per_mm));
        let of_tolerance = 48.0 * AVERAGE_SHARE * path_tolerance_mm / (most_s * most_s * most_s);
        let least_mm_s3 = of_tolerance.min(2.0 * accel / most_s);
        if jerk_mm_s3 >= least_mm_s3 { Ok(()) } else { Err(PlanError::Window { jerk_mm_s3, least_mm_s3 }) }
    }

    fn divided(&self, path_tolerance_mm: f64, jerk_mm_s3: f64) -> Averaged {
        // The greatest acceleration as a vector.
        let accel = match self.accel_limit {
            AccelLimit::Vector => self.accel_mm_s2,
            AccelLimit::Axes { x_mm_s2, y_mm_s2 } => libm::hypot(x_mm_s2, y_mm_s2),
            AccelLimit::Belts { sum_mm_s2, difference_mm_s2 } => {
                libm::hypot(sum_mm_s2, difference_mm_s2) * core::f64::consts::FRAC_1_SQRT_2
            }
        };
        let of_tolerance_s = libm::cbrt(48.0 * AVERAGE_SHARE * path_tolerance_mm / jerk_mm_s3);
        let window_s = of_tolerance_s.min(2.0 * accel / jerk_mm_s3);
        let planned = accel.min(0.5 * jerk_mm_s3 * window_s);
        // What is less than any limit may be is the least: a micrometre a second more, or a nanometre.
        let shared = |limit: f64| (limit * planned / accel).max(LIMITS.0);
        let accel_limit = match self.accel_limit {
            AccelLimit::Vector => AccelLimit::Vector,
            AccelLimit::Axes { x_mm_s2, y_mm_s2 } => {
                AccelLimit::Axes { x_mm_s2: shared(x_mm_s2), y_mm_s2: shared(y_mm_s2) }
            }
            AccelLimit::Belts { sum_mm_s2, difference_mm_s2 } => {
                AccelLimit::Belts { sum_mm_s2: shared(sum_mm_s2), difference_mm_s2: shared(difference_mm_s2) }
            }
        };
        let left_mm = path_tolerance_mm - planned * window_s * window_s / 24.0;
        let settings = Self {
            path: PathMode::Tolerance { path_tolerance_mm: left_mm.max(LEAST_TOLERANCE_MM) },
            accel_mm_s2: if accel_limit == AccelLimit::Vector {
                planned.max(LIMITS.0)
            } else {
                self.accel_mm_s2
            },
            accel_limit,
            jerk_mm_s3: None,
            #[cfg(feature = "averaged-steps")]
            jerk_limit: super::JerkLimit::Path,
            ..*self
        };
        Averaged { settings, window_s }
    }
}
