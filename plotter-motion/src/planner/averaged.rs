//! [`PlannerSettings::averaged`]: what to plan with so that the average of the motion keeps a jerk as a
//! vector.

use super::settings::{AccelLimit, MOST_JERK};
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
    /// Time over which places are averaged, s.
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
        let least = super::settings::LIMITS.0;
        if !(least..=MOST_JERK).contains(&jerk_mm_s3) {
            return Err(PlanError::Setting {
                quantity: "jerk_mm_s3",
                value: jerk_mm_s3,
                least,
                most: MOST_JERK,
            });
        }
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
        let share = planned / accel;
        let accel_limit = match self.accel_limit {
            AccelLimit::Vector => AccelLimit::Vector,
            AccelLimit::Axes { x_mm_s2, y_mm_s2 } => {
                AccelLimit::Axes { x_mm_s2: share * x_mm_s2, y_mm_s2: share * y_mm_s2 }
            }
            AccelLimit::Belts { sum_mm_s2, difference_mm_s2 } => {
                AccelLimit::Belts { sum_mm_s2: share * sum_mm_s2, difference_mm_s2: share * difference_mm_s2 }
            }
        };
        let left_mm = path_tolerance_mm - planned * window_s * window_s / 24.0;
        let settings = Self {
            path: PathMode::Tolerance { path_tolerance_mm: left_mm },
            accel_mm_s2: if accel_limit == AccelLimit::Vector { planned } else { self.accel_mm_s2 },
            accel_limit,
            jerk_mm_s3: None,
            ..*self
        };
        settings.check::<AllModes>()?;
        Ok(Averaged { settings, window_s })
    }
}
