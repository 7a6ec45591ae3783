//! Settings of a plotter with stepper motors: how its motors step, how it is planned for, its pen, laser and
//! homing.
//!
//! The defaults are the documented stepper plotter: a Makeblock XY plotter with A4988 drivers, a pen on a
//! servo and a laser. A machine with other motors does not read them.

/// How the motors are driven.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub(super) enum DriveChoice {
    /// DC motors with encoders: `[control]`, `[sync_stop]` and the motors, encoders and loads of the axes
    /// hold.
    #[default]
    Dc,
    /// Stepper motors: `[planner]`, `[pen]`, `[laser]`, `[homing]`, `[stepper_motor]` and the steppers of the
    /// axes hold.
    Stepper,
}

/// How one axis steps: `[x.stepper]` and `[y.stepper]`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct StepperConfig {
    /// Pulses (microsteps) to the millimetre.
    pub steps_per_mm: f64,
    /// Whether forward pulses move the pen towards smaller coordinates.
    pub inverted: bool,
    /// Play of the axis where it turns round, mm.
    pub backlash_mm: f64,
    /// Rate at which the motor may start and stop at once, pulses/s.
    pub start_rate_hz: f64,
    /// Greatest rate, reached by acceleration, pulses/s.
    pub max_rate_hz: f64,
}

impl Default for StepperConfig {
    /// 87.58 steps/mm; 2000 pulses/s at once, up to 8000.
    fn default() -> Self {
        Self {
            steps_per_mm: 87.58,
            inverted: false,
            backlash_mm: 0.0,
            start_rate_hz: 2_000.0,
            max_rate_hz: 8_000.0,
        }
    }
}

/// Whether corners are passed exactly or rounded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum PathChoice {
    /// The pen passes through every corner.
    #[default]
    Exact,
    /// The pen stays within a distance of the path.
    Tolerance,
}

/// Quantity that the greatest acceleration limits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum AccelChoice {
    /// The acceleration of the pen as a vector: `accel_mm_s2`.
    #[default]
    Vector,
    /// The limit of each motor: `accel_x_mm_s2` and `accel_y_mm_s2`.
    Axes,
}

/// Quantity that the greatest jerk limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum JerkChoice {
    /// The jerk of the pen as a vector.
    Vector,
    /// The jerk along the path.
    Path,
}

/// How moves are planned: `[planner]`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct PlannerConfig {
    /// Whether corners are passed exactly or rounded.
    pub mode: PathChoice,
    /// Whether the jerk is limited too.
    pub s_curve: bool,
    /// How far the pen may be from the path with [`PathChoice::Tolerance`], mm.
    pub path_tolerance_mm: f64,
    /// How far from a corner the circle passes whose speed the corner is taken with, mm; the pen itself does
    /// not leave the corner.
    pub junction_deviation_mm: f64,
    /// Greatest speed while drawing, mm/s.
    pub speed_mm_s: f64,
    /// Greatest speed with the pen up, mm/s.
    pub travel_speed_mm_s: f64,
    /// Quantity that the greatest acceleration limits.
    pub accel_limit: AccelChoice,
    /// Greatest acceleration of the pen with [`AccelChoice::Vector`], mm/s^2.
    pub accel_mm_s2: f64,
    /// Greatest acceleration of the motor `x` with [`AccelChoice::Axes`], mm/s^2.
    pub accel_x_mm_s2: f64,
    /// The same of the motor `y`.
    pub accel_y_mm_s2: f64,
    /// Quantity that the greatest jerk limits. If a file does not say, it is the vector with
    /// [`PathChoice::Tolerance`]. With [`PathChoice::Exact`] it is along the path, always.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub jerk_limit: Option<JerkChoice>,
    /// Greatest jerk, mm/s^3.
    pub jerk_mm_s3: f64,
}

impl PlannerConfig {
    /// What the greatest jerk limits.
    pub(crate) const fn jerk_limit_in_force(&self) -> JerkChoice {
        match (self.mode, self.jerk_limit) {
            (PathChoice::Exact, _) => JerkChoice::Path,
            (PathChoice::Tolerance, Some(choice)) => choice,
            (PathChoice::Tolerance, None) => JerkChoice::Vector,
        }
    }
}

impl Default for PlannerConfig {
    /// 45 mm/s drawing and 90 mm/s travelling: 4000 and 8000 pulses/s at 87.58 steps/mm, rounded down.
    /// 250 mm/s^2 reach the latter from 2000 pulses/s within half of 2750 steps.
    fn default() -> Self {
        Self {
            mode: PathChoice::Exact,
            s_curve: false,
            path_tolerance_mm: 0.05,
            junction_deviation_mm: 0.01,
            speed_mm_s: 45.0,
            travel_speed_mm_s: 90.0,
            accel_limit: AccelChoice::Vector,
            accel_mm_s2: 250.0,
            accel_x_mm_s2: 250.0,
            accel_y_mm_s2: 250.0,
            jerk_limit: None,
            jerk_mm_s3: 10_000.0,
        }
    }
}

/// By which words of a G-code text a controller lifts the pen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum PenLift {
    /// `M5` lifts, `M3` and `M4` lower.
    #[default]
    Spindle,
    /// The height that `Z` names.
    Height,
}

/// The pen on its servo: `[pen]`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct PenConfig {
    /// Angle of the servo with the pen up, degrees.
    pub up_deg: f64,
    /// Angle with the pen down, degrees.
    pub down_deg: f64,
    /// How long the motors wait after the pen has been moved, ms.
    pub settle_ms: f64,
    /// By which words of a G-code text a controller lifts it.
    pub lifted_by: PenLift,
    /// With [`PenLift::Height`], the pen is down at this Z and below, mm.
    pub down_z_mm: f64,
}

impl Default for PenConfig {
    /// 160 and 90 degrees, 200 ms; lifted by `M5`, or above a height of 0.
    fn default() -> Self {
        let lifted_by = PenLift::Spindle;
        Self { up_deg: 160.0, down_deg: 90.0, settle_ms: 200.0, lifted_by, down_z_mm: 0.0 }
    }
}

/// The laser: `[laser]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct LaserConfig {
    /// Whether there is one, and it may be switched on.
    pub enabled: bool,
    /// The number of a command (S of M3 and M4, the number of mDraw's M4) that means full power.
    pub full_power: u32,
}

impl Default for LaserConfig {
    /// Off; 255 is full power.
    fn default() -> Self {
        Self { enabled: false, full_power: 255 }
    }
}

/// How the ends of the axes are found: `[homing]`. See [`Homing`](crate::homing::Homing).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct HomingConfig {
    /// Greatest rate where the way is known, pulses/s.
    pub fast_rate_hz: f64,
    /// Rate at which a switch is touched, pulses/s.
    pub slow_rate_hz: f64,
    /// From the lower switches to the origin, mm.
    pub pull_off_mm: f64,
    /// Within which way a switch opens when it is left, mm.
    pub release_mm: f64,
    /// How long both axes are at least, mm; 0 if that is not known. Homing is fast up to here.
    pub known_travel_mm: f64,
    /// How long they are at most, mm: a switch that has not come by then is missing.
    pub max_travel_mm: f64,
}

impl Default for HomingConfig {
    /// Fast below 24,000 steps (274 mm) of 87.58/mm.
    fn default() -> Self {
        Self {
            fast_rate_hz: 8_000.0,
            slow_rate_hz: 1_000.0,
            pull_off_mm: 1.0,
            release_mm: 5.0,
            known_travel_mm: 274.0,
            max_travel_mm: 450.0,
        }
    }
}
