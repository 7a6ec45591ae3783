//! [`PlannerSettings`]: the limits of a machine's motion, and how its path is followed.

use super::{Modes, PlanError};
#[cfg(feature = "averaged-steps")]
use crate::config::JerkChoice;
use crate::{
    Machine,
    config::{AccelChoice, PathChoice, PlannerConfig, SteppersConfig},
};

/// How nearly a path is followed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum PathMode {
    /// Through every vertex, give or take [`PlannerSettings::allowance_mm`]. Corners are taken at the speed
    /// of junction deviation.
    #[default]
    Exact,
    /// Corners become arcs, and vertices that are not needed are left out, so that no place of the path is
    /// farther than this from what was asked for, mm.
    Tolerance {
        /// Greatest distance either way, mm; above 0.
        path_tolerance_mm: f64,
    },
}

/// Quantities that the limit of the acceleration may limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum AccelLimit {
    /// The acceleration as a vector: what speeds up along the path and what turns across it, together, are at
    /// most [`PlannerSettings::accel_mm_s2`].
    #[default]
    Vector,
    /// Each axis for itself, where a motor moves each: `accel_mm_s2` is not looked at. Along a diagonal of
    /// two like axes the machine speeds up √2 times as hard as along either.
    Axes {
        /// Greatest acceleration along x, mm/s².
        x_mm_s2: f64,
        /// Greatest acceleration along y, mm/s².
        y_mm_s2: f64,
    },
    /// Each motor of a belt machine for itself, in mm of the belt: one motor moves x + y, the other x − y.
    /// Along a diagonal one of them does all of it, √2 times what the pen does.
    Belts {
        /// Greatest acceleration of x + y, mm/s².
        sum_mm_s2: f64,
        /// Greatest acceleration of x − y, mm/s².
        difference_mm_s2: f64,
    },
}

/// Quantities that the limit of the jerk may limit.
#[cfg(feature = "averaged-steps")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum JerkLimit {
    /// What changes the acceleration along the path. As a vector the jerk is not limited: the acceleration
    /// across begins and ends at once with a curve.
    #[default]
    Path,
    /// The jerk as a vector, at every instant, with [`PathMode::Tolerance`]: the steps of the motion are
    /// averaged over some hundredths of a second. A [`Planner`](super::Planner) by itself does not do that:
    /// see [`PlannerSettings::planned`].
    Vector,
}

impl AccelLimit {
    /// The limit of a machine with stepper motors.
    const fn of(planner: &PlannerConfig) -> Self {
        match planner.accel_limit {
            AccelChoice::Vector => Self::Vector,
            AccelChoice::Axes => {
                Self::Axes { x_mm_s2: planner.accel_x_mm_s2, y_mm_s2: planner.accel_y_mm_s2 }
            }
        }
    }
}

/// The limits that a [`Planner`](super::Planner) keeps. Read by serde, they are those that it takes.
///
/// The default suits a light pen plotter with belts: 100 mm/s, 1000 mm/s².
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PlannerSettings {
    /// How nearly the path is followed.
    pub path: PathMode,
    /// Greatest speed with the pen down, mm/s. An operation may ask for less.
    pub speed_mm_s: f64,
    /// Speed with the pen up, mm/s.
    pub travel_speed_mm_s: f64,
    /// Greatest acceleration, mm/s², as [`PlannerSettings::accel_limit`] says.
    pub accel_mm_s2: f64,
    /// What that is a limit of. It holds at every instant but in a corner of [`PathMode::Exact`], which is a
    /// jump of the velocity.
    pub accel_limit: AccelLimit,
    /// Greatest jerk, mm/s³; `None` lets the acceleration change at once (trapezoidal profiles). It is that
    /// along the path, which makes S-curves of them, or with the feature `averaged-steps` what `jerk_limit`
    /// says. As a vector the jerk of an S-curve is not limited: the acceleration across begins and ends at
    /// once with a curve. 0.9 of the acceleration is used along the path in exact mode and 0.7 within a
    /// tolerance; what that leaves is for turning.
    pub jerk_mm_s3: Option<f64>,
    /// How far a machine that rounds a corner by itself may miss its vertex, mm: see
    /// [`junction_speed`](super::junction_speed).
    pub junction_deviation_mm: f64,
    /// Vertices nearer than this to the one before are left out unless they end a stroke, mm; 0 keeps all.
    /// Half a step is what a motor cannot tell apart.
    pub resolution_mm: f64,
    /// How far a vertex may be missed in exact mode because it is known no better, mm: half of the last digit
    /// that its file writes, or a motor step, whichever is greater. Within it one arc stands for vertices
    /// that are noise to it; what is more is a corner. Less than a nanometre, as 0, takes every vertex as it
    /// is. [`ExactOnly`](super::ExactOnly) and [`ExactPen`](super::ExactPen) do that whatever it is.
    pub allowance_mm: f64,
    /// What `jerk_mm_s3` is a limit of.
    #[cfg(feature = "averaged-steps")]
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "JerkLimit::is_path"))]
    pub jerk_limit: JerkLimit,
}

#[cfg(all(feature = "averaged-steps", feature = "serde"))]
impl JerkLimit {
    fn is_path(&self) -> bool {
        *self == Self::Path
    }
}

impl Default for PlannerSettings {
    fn default() -> Self {
        Self {
            path: PathMode::Exact,
            speed_mm_s: 100.0,
            travel_speed_mm_s: 100.0,
            accel_mm_s2: 1000.0,
            accel_limit: AccelLimit::Vector,
            jerk_mm_s3: None,
            junction_deviation_mm: 0.01,
            resolution_mm: 0.005,
            allowance_mm: 0.0,
            #[cfg(feature = "averaged-steps")]
            jerk_limit: JerkLimit::Path,
        }
    }
}

/// [`PlannerSettings`] whose jerk, if it is limited, is so along the path or as a vector, with the field for
/// that or without it, as it is built in: for constants that a build script writes.
#[cfg(feature = "averaged-steps")]
#[doc(hidden)]
#[macro_export]
macro_rules! jerk_limited {
    ($limit:ident $settings:ident { $($field:ident: $value:expr),* $(,)? }) => {
        $settings { $($field: $value,)* jerk_limit: $crate::planner::JerkLimit::$limit }
    };
}

#[cfg(not(feature = "averaged-steps"))]
#[doc(hidden)]
#[macro_export]
macro_rules! jerk_limited {
    (Path $settings:ident { $($field:ident: $value:expr),* $(,)? }) => {
        $settings { $($field: $value),* }
    };
    (Vector $($settings:tt)*) => {
        compile_error!(
            "the machine's file limits the jerk as a vector: build with plotter-motion's feature averaged-steps, or write \
             planner.jerk_limit = \"path\""
        )
    };
}

#[cfg(feature = "serde")]
crate::checked_serde::checked_deserialize!(
    PlannerSettings {
        path: PathMode,
        speed_mm_s: f64,
        travel_speed_mm_s: f64,
        accel_mm_s2: f64,
        accel_limit: AccelLimit,
        jerk_mm_s3: Option<f64>,
        junction_deviation_mm: f64,
        resolution_mm: f64,
        allowance_mm: f64,
        #[cfg(feature = "averaged-steps")]
        jerk_limit: JerkLimit,
    },
    PlannerSettings::check::<super::AllModes>
);

/// Least and greatest limit that a motion is planned with: a micrometre a second to ten kilometres a second.
pub(super) const LIMITS: (f64, f64) = (1e-3, 1e7);
/// Greatest jerk, mm/s³: a motion with it is a trapezoid for any machine.
pub(super) const MOST_JERK: f64 = 1e12;
/// Least and greatest tolerance, mm: a nanometre, below any motor's step, and a metre, beyond any drawing's
/// detail.
pub(super) const LEAST_TOLERANCE_MM: f64 = 1e-6;
const MOST_TOLERANCE_MM: f64 = 1e3;

impl PlannerSettings {
    /// The limits of a machine with stepper motors. Places nearer together than half a step count as one.
    ///
    /// ```
    /// # use plotter_motion::{Machine, MachineConfig, PlannerSettings};
    /// let machine = Machine::new(MachineConfig::stepper_plotter())?; // 87.58 steps to the millimetre
    /// let settings = PlannerSettings::of(&machine);
    /// assert_eq!((settings.speed_mm_s, settings.jerk_mm_s3), (45.0, None));
    /// assert!((settings.resolution_mm - 0.00571).abs() < 1e-5);
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        Self::of_steppers(&SteppersConfig::of(machine))
    }

    pub(crate) fn of_steppers(steppers: &SteppersConfig) -> Self {
        let SteppersConfig { planner, x, y, .. } = steppers;
        let path = match planner.mode {
            PathChoice::Exact => PathMode::Exact,
            PathChoice::Tolerance => PathMode::Tolerance { path_tolerance_mm: planner.path_tolerance_mm },
        };
        let finest = x.steps_per_mm.max(y.steps_per_mm);
        Self {
            path,
            speed_mm_s: planner.speed_mm_s,
            travel_speed_mm_s: planner.travel_speed_mm_s,
            accel_mm_s2: planner.accel_mm_s2,
            accel_limit: AccelLimit::of(planner),
            jerk_mm_s3: planner.s_curve.then_some(planner.jerk_mm_s3),
            junction_deviation_mm: planner.junction_deviation_mm,
            resolution_mm: 0.5 / finest,
            allowance_mm: 1.0 / finest,
            #[cfg(feature = "averaged-steps")]
            jerk_limit: match planner.jerk_limit_in_force() {
                JerkChoice::Path => JerkLimit::Path,
                JerkChoice::Vector => JerkLimit::Vector,
            },
        }
    }

    /// The same with another way to follow the path. Exactly, the jerk is limited along it: a corner is a
    /// jump of the velocity.
    ///
    /// ```
    /// # use plotter_motion::{PathMode, PlannerSettings};
    /// let path = PathMode::Tolerance { path_tolerance_mm: 0.05 };
    /// assert_eq!(PlannerSettings::default().following(path).path, path);
    /// ```
    #[must_use]
    pub fn following(self, path: PathMode) -> Self {
        Self {
            path,
            #[cfg(feature = "averaged-steps")]
            jerk_limit: if path == PathMode::Exact { JerkLimit::Path } else { self.jerk_limit },
            ..self
        }
    }

    /// The jerk as a vector, if that is what is limited.
    pub(crate) const fn vector_jerk(&self) -> Option<f64> {
        #[cfg(feature = "averaged-steps")]
        if matches!(self.jerk_limit, JerkLimit::Vector) {
            return self.jerk_mm_s3;
        }
        None
    }

    /// The same for a drawing whose file writes places to `digit_mm`: half of that is the allowance, where it
    /// is more than the machine's. Of a digit of more than 0.1 mm half of 0.1 mm is: who writes whole
    /// millimetres means corners.
    ///
    /// ```
    /// # use plotter_motion::{Machine, MachineConfig, PlannerSettings};
    /// let machine = Machine::new(MachineConfig::stepper_plotter())?; // a step is 0.0114 mm
    /// let settings = PlannerSettings::of(&machine);
    /// assert_eq!(settings.for_digits_of(0.1).allowance_mm, 0.05);
    /// assert_eq!(settings.for_digits_of(0.001).allowance_mm, settings.allowance_mm);
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    #[must_use]
    pub fn for_digits_of(self, digit_mm: f64) -> Self {
        /// Greatest last digit that counts as rounding, mm. Of a coarser one only this much is allowed for.
        const MOST_DIGIT_MM: f64 = 0.1;
        let half_mm = if digit_mm > 0.0 { 0.5 * digit_mm.min(MOST_DIGIT_MM) } else { 0.0 };
        Self { allowance_mm: self.allowance_mm.max(half_mm), ..self }
    }

    /// The limit of the first or of the second motor; where they have one together, that.
    pub(crate) const fn accel_of_motor(&mut self, is_second: bool) -> &mut f64 {
        match &mut self.accel_limit {
            AccelLimit::Vector => &mut self.accel_mm_s2,
            AccelLimit::Axes { x_mm_s2: first, y_mm_s2: second }
            | AccelLimit::Belts { sum_mm_s2: first, difference_mm_s2: second } => {
                if is_second {
                    second
                } else {
                    first
                }
            }
        }
    }

    /// Checks every number by itself, and whether these modes are built in.
    pub(crate) const fn check<M: Modes>(&self) -> Result<(), PlanError> {
        if !M::ALL && matches!(self.path, PathMode::Tolerance { .. }) {
            return Err(PlanError::Mode { quantity: "path" });
        }
        if !M::ALL && self.jerk_mm_s3.is_some() {
            return Err(PlanError::Mode { quantity: "jerk_mm_s3" });
        }
        if self.vector_jerk().is_some() && matches!(self.path, PathMode::Exact) {
            return Err(PlanError::Corners { quantity: "the jerk as a vector" });
        }
        let (least, most) = LIMITS;
        let jerk_mm_s3 = if let Some(jerk_mm_s3) = self.jerk_mm_s3 { jerk_mm_s3 } else { least };
        let path_tolerance_mm = match self.path {
            PathMode::Exact => LEAST_TOLERANCE_MM,
            PathMode::Tolerance { path_tolerance_mm } => path_tolerance_mm,
        };
        let motors = match self.accel_limit {
            AccelLimit::Vector => [self.accel_mm_s2; 2],
            AccelLimit::Axes { x_mm_s2, y_mm_s2 } => [x_mm_s2, y_mm_s2],
            AccelLimit::Belts { sum_mm_s2, difference_mm_s2 } => [sum_mm_s2, difference_mm_s2],
        };
        let [one, other] = motors;
        let checks = [
            ("speed_mm_s", self.speed_mm_s, least, most),
            ("travel_speed_mm_s", self.travel_speed_mm_s, least, most),
            ("accel_mm_s2", self.accel_mm_s2, least, most),
            ("accel_limit", one, least, most),
            ("accel_limit", other, least, most),
            ("jerk_mm_s3", jerk_mm_s3, least, MOST_JERK),
            ("junction_deviation_mm", self.junction_deviation_mm, 0.0, MOST_TOLERANCE_MM),
            ("resolution_mm", self.resolution_mm, 0.0, MOST_TOLERANCE_MM),
            ("allowance_mm", self.allowance_mm, 0.0, MOST_TOLERANCE_MM),
            ("path_tolerance_mm", path_tolerance_mm, LEAST_TOLERANCE_MM, MOST_TOLERANCE_MM),
        ];
        let mut rest = checks.as_slice();
        while let [(quantity, value, least, most), after @ ..] = rest {
            let (value, least, most) = (*value, *least, *most);
            if !(value >= least && value <= most) {
                return Err(PlanError::Setting { quantity, value, least, most });
            }
            rest = after;
        }
        Ok(())
    }
}
