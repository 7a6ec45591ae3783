//! How the motors move the pen: each its axis, or both by one belt, and what only a machine with a belt
//! needs.
//!
//! The defaults are the documented marking board. A machine whose motors each move an axis does not read
//! `[belt]` and `[point_to_point]`.

use super::{AxisConfig, DcConfig, DriveConfig, Machine, MotorConfig};
use crate::config::LoadConfig;
use crate::kinematics::BeltSigns;

/// How the two motors move the pen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub(super) enum KinematicsChoice {
    /// `x` moves the pen to the right and `y` up.
    #[default]
    Cartesian,
    /// `x` and `y` are the first and the second motor of one belt, each of which moves the pen along a
    /// diagonal.
    CoreXy,
}

/// How the two motors move the pen: `[kinematics]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub(super) struct KinematicsConfig {
    /// Each its axis, or both by one belt; the key `type`.
    #[cfg_attr(feature = "serde", serde(rename = "type"))]
    pub(super) kind: KinematicsChoice,
    /// Directions of the motors of a belt.
    pub(super) signs: BeltSigns,
}

/// Model of the two motors of a belt for a controller with a plan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum KnownMotors {
    /// Each as it is described.
    Each,
    /// Both alike, the mean of both descriptions: as who has a data sheet, and has measured neither.
    #[default]
    Mean,
}

/// A machine with one belt: `[belt]`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct BeltConfig {
    /// Where the pen is when the machine is switched on, to the right, mm.
    pub start_x_mm: f64,
    /// The same, up.
    pub start_y_mm: f64,
    /// Speed of the pen from which on the window of the speed meter has its full length, mm/s.
    pub speed_window_mm_s: f64,
    /// Model of the motors for the contouring controller.
    pub known_motors: KnownMotors,
    /// How long no pulse must have come from a motor until it is driven the other way, ms.
    pub run_down_ms: f64,
    /// By how much the speed of either motor may differ from their mean, 0 to 1; for the limit switches.
    pub unequal_share: f64,
    /// Sliding friction of the rail along x, as it is simulated, N.
    pub x_rail_coulomb_n: f64,
    /// Its friction at rest, N.
    pub x_rail_static_n: f64,
    /// Sliding friction of the rail along y, N.
    pub y_rail_coulomb_n: f64,
    /// Its friction at rest, N.
    pub y_rail_static_n: f64,
}

impl Default for BeltConfig {
    /// Switched on in the middle of 300 mm by 200 mm; rails that differ by half.
    fn default() -> Self {
        Self {
            start_x_mm: 150.0,
            start_y_mm: 100.0,
            speed_window_mm_s: 30.0,
            known_motors: KnownMotors::Mean,
            run_down_ms: 30.0,
            unequal_share: 0.15,
            x_rail_coulomb_n: 6.0,
            x_rail_static_n: 8.0,
            y_rail_coulomb_n: 9.0,
            y_rail_static_n: 12.0,
        }
    }
}

/// The published controller of a machine with a belt, from point to point in eight directions:
/// `[point_to_point]`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct PointToPointConfig {
    /// Error of an axis at which it gets no drive, mm.
    pub allowed_error_mm: f64,
    /// How often it runs, ms.
    pub period_ms: f64,
    /// Drive at the start of a move, 0 to 1.
    pub drive_start: f64,
    /// Increase of the drive per run, 0 to 1.
    pub drive_step: f64,
    /// How long a step of the drive lasts, ms; 0 for the full drive at once.
    pub drive_step_ms: f64,
    /// Greatest drive, 0 to 1.
    pub drive_most: f64,
    /// Within so many mm of where an axis gets no drive the drive falls back to that at the start; 0 for
    /// never.
    pub slow_mm: f64,
    /// Factor for the drive of the first motor, found by hand, 0 to 1.
    pub factor_x: f64,
    /// The same for the second motor.
    pub factor_y: f64,
    /// How long no pulse must have come from a motor until it is driven the other way, ms; 0 as published.
    pub run_down_ms: f64,
    /// By how much the speed of either motor may differ from their mean, 0 to 1; 0 as published.
    pub unequal_share: f64,
    /// Whether both motors' speeds are made equal by what was measured of them.
    pub equalize: bool,
    /// Time constant of the motors with what they move, ms.
    pub equalizer_time_constant_ms: f64,
    /// The three poles of the equalizer, rad/s.
    pub equalizer_pole_rad_s: f64,
    /// Speed at full drive, mm/s of a motor's belt.
    pub equalizer_full_speed_mm_s: f64,
    /// Greatest trim of a drive, 0 to 1.
    pub equalizer_most_trim: f64,
}

impl Default for PointToPointConfig {
    /// As published: one level of drive from the start, 0.45 mm allowed, no equalizer.
    fn default() -> Self {
        Self {
            allowed_error_mm: 0.45,
            period_ms: 5.0,
            drive_start: 0.45,
            drive_step: 0.0,
            drive_step_ms: 0.0,
            drive_most: 0.45,
            slow_mm: 0.0,
            factor_x: 1.0,
            factor_y: 1.0,
            run_down_ms: 0.0,
            unequal_share: 0.0,
            equalize: false,
            equalizer_time_constant_ms: 25.0,
            equalizer_pole_rad_s: 40.0,
            equalizer_full_speed_mm_s: 73.43,
            equalizer_most_trim: 0.5,
        }
    }
}

impl DriveConfig {
    /// How much farther a motor's belt goes than the pen, at most: 1 where each motor moves an axis, √2 along
    /// a diagonal of a machine with one belt, where one motor does it alone.
    pub(super) fn motor_mm_per_mm(&self) -> f64 {
        match self {
            Self::Gantry(_) | Self::Steppers(_) => 1.0,
            Self::Belt(_) => core::f64::consts::SQRT_2,
        }
    }
}

impl Machine {
    /// The two DC motors as a controller takes them that leads them along a line of *their* counts.
    ///
    /// On a belt a line of the motors is √2 times as long as that of the pen in any direction, so speed,
    /// acceleration and jerk are.
    pub(crate) fn led_motors(&self) -> DcConfig {
        let mut led = DcConfig::of(self);
        let times = self.config().drive.motor_mm_per_mm();
        let contouring = &mut led.control.contouring;
        contouring.feed_mm_s *= times;
        contouring.accel_mm_s2 *= times;
        contouring.jerk_mm_s3 *= times;
        if self.config().belt().is_some_and(|belt| belt.belt.known_motors == KnownMotors::Mean) {
            let mean = mean(&led.x, &led.y);
            (led.x, led.y) = (mean, mean);
        }
        led
    }
}

/// A motor and its load between two others.
fn mean(first: &AxisConfig, second: &AxisConfig) -> AxisConfig {
    let mean = |of: fn(&AxisConfig) -> f64| 0.5 * (of(first) + of(second));
    AxisConfig {
        motor: MotorConfig {
            supply_v: mean(|axis| axis.motor.supply_v),
            resistance_ohm: mean(|axis| axis.motor.resistance_ohm),
            inductance_h: mean(|axis| axis.motor.inductance_h),
            back_emf_v_s: mean(|axis| axis.motor.back_emf_v_s),
            torque_n_m_per_a: mean(|axis| axis.motor.torque_n_m_per_a),
            inertia_kg_m2: mean(|axis| axis.motor.inertia_kg_m2),
            ..first.motor
        },
        load: LoadConfig {
            inertia_kg_m2: mean(|axis| axis.load.inertia_kg_m2),
            coulomb_n_m: mean(|axis| axis.load.coulomb_n_m),
            static_n_m: mean(|axis| axis.load.static_n_m),
            viscous_n_m_s: mean(|axis| axis.load.viscous_n_m_s),
        },
        ..*first
    }
}
