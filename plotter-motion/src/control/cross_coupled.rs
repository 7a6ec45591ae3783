//! [`CrossCoupled`]: a loop around both axes that controls the contour error.

use super::{ContourController, ContourState, ShaftModel};
use crate::config::DcConfig;
use crate::{Demand, Duty, Machine};
use core::f64::consts::TAU;

/// Cross-coupled control: beside the two axis controllers, a third loop drives the contour error, the
/// distance from the line, to zero with both motors.
///
/// ```text
///        ╱ line         Axis controllers see ex and ey. Small ex and ey can still be mostly contour error e;
///   ex  ╱               large ones are harmless if they point along the line.
///   ●──╱
///    ╲╱ e               a = kp·e + kd·de/dt + ki·∫e dt, along the normal n = (−uy, ux) of the direction u;
///                       each axis adds a·n / (acceleration at full duty) to its duty
/// ```
///
/// Lengths are encoder counts, and u is a unit vector in counts, as everywhere in [`ContourState`]. The
/// controller wraps those of the axes; [`Learning`](super::Learning) in turn wraps this one.
///
/// Sources: Y. Koren, "Cross-Coupled Biaxial Computer Control for Manufacturing Systems", Journal of Dynamic
/// Systems, Measurement, and Control 102 (1980); Y. Koren and C. C. Lo, "Variable-Gain Cross-Coupling
/// Controller for Contouring", CIRP Annals 40 (1991), for the normal that follows the line's direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossCoupled<C> {
    axes: C,
    settings: CrossCoupledSettings,
    /// Acceleration by the integral so far, counts/s².
    integral_accel: f32,
}

/// Gains of [`CrossCoupled`]: from the contour error, in counts, to an acceleration in counts/s².
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct CrossCoupledSettings {
    /// Gain of the contour error, 1/s².
    pub kp: f32,
    /// Gain of its rate of change, 1/s.
    pub kd: f32,
    /// Gain of its integral, 1/s³.
    pub ki: f32,
    /// Acceleration of each axis at full duty, x and y, counts/s², above 0.
    pub max_accel: [f32; 2],
}

impl CrossCoupledSettings {
    /// Gains for a machine: half of those of an axis controller with the machine's contouring bandwidth. With
    /// more, motors that are much stronger than described oscillate.
    ///
    /// With all three poles of an axis at −w, (s + w)³ = s³ + 3w·s² + 3w²·s + w³, the gains are 3w² for the
    /// position, 3w for the speed and w³ for the integral.
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        /// Part of an axis controller's gains that comes in addition.
        const ADDED_GAIN: f32 = 0.5;
        let config = DcConfig::of(machine);
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        let bandwidth_rad_s = (config.control.contouring.bandwidth_hz * TAU) as f32;
        let w = bandwidth_rad_s;
        let max_accel = |axis| {
            let model = ShaftModel::new(axis);
            model.accel_per_volt * model.supply_v
        };
        Self {
            kp: ADDED_GAIN * 3.0 * w * w,
            kd: ADDED_GAIN * 3.0 * w,
            ki: ADDED_GAIN * w * w * w,
            max_accel: [max_accel(&config.x), max_accel(&config.y)],
        }
    }
}

impl<C: ContourController> CrossCoupled<C> {
    /// Adds the third loop to the axis controllers `axes`.
    #[must_use]
    pub const fn new(axes: C, settings: CrossCoupledSettings) -> Self {
        Self { axes, settings, integral_accel: 0.0 }
    }
}

impl<C: ContourController> ContourController for CrossCoupled<C> {
    fn start(&mut self, duration_s: f32) {
        self.integral_accel = 0.0;
        self.axes.start(duration_s);
    }

    fn update(&mut self, state: &ContourState) -> Demand {
        let CrossCoupledSettings { kp, kd, ki, max_accel: [max_x, max_y] } = self.settings;
        let error = state.across_error();
        let grown = self.integral_accel + ki * error * state.dt_s;
        // Anti-windup: no more than the weaker axis can do alone, for along that axis nothing helps it. A
        // value that is not finite, of a broken measurement, must not stay in the sum.
        let limit = max_x.min(max_y);
        if grown.is_finite() {
            self.integral_accel = grown.clamp(-limit, limit);
        }
        let accel = kp * error + kd * state.across_speed_error() + self.integral_accel;
        // The error is positive where the pen must move to the left, along the normal (−uy, ux).
        let [ux, uy] = state.direction;
        let demand = self.axes.update(state);
        Demand {
            x: Duty::saturating(demand.x.value() - uy * accel / max_x),
            y: Duty::saturating(demand.y.value() + ux * accel / max_y),
        }
    }
}
