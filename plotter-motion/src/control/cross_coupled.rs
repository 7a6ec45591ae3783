//! [`CrossCoupled`]: both axes answer for the distance from the line.

use super::{ContourController, ContourState, ShaftModel};
use crate::{Demand, Duty, Machine};
use core::f64::consts::TAU;

/// Cross-coupled control: beside what leads the two axes, the distance from the line itself is led to zero,
/// by both motors.
///
/// ```text
///        ╱ line         an axis controller sees ex and ey; that both are small does not make e small against them,
///   ex  ╱               and that both are large does not matter as long as they point along the line
///   ●──╱
///    ╲╱ e               duty += gains * (e, de/dt, ∫e), along the normal
/// ```
///
/// Source: Y. Koren, "Cross-Coupled Biaxial Computer Control for Manufacturing Systems" (1980); Y. Koren, C.
/// C. Lo, "Variable-Gain Cross-Coupling Controller for Contouring" (1991), for gains that follow the line's
/// direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossCoupled<C> {
    axes: C,
    settings: CrossCoupledSettings,
    integral: f32,
}

/// How stiffly [`CrossCoupled`] holds the line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct CrossCoupledSettings {
    /// Acceleration by the distance from the line, 1/s^2.
    pub position: f32,
    /// Acceleration by its rate, 1/s.
    pub speed: f32,
    /// Acceleration by its integral, 1/s^3.
    pub integral: f32,
    /// Acceleration by the whole supply, of each axis, counts/s^2.
    pub most: [f32; 2],
}

impl CrossCoupledSettings {
    /// For a machine: half of what the axes' controllers have at its bandwidth, in addition. With more,
    /// motors that are much stronger than described begin to tremble.
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        const SHARE: f32 = 0.5;
        let config = machine.config();
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        let w = (config.control.contouring.bandwidth_hz * TAU) as f32;
        let most = |axis| {
            let model = ShaftModel::new(axis);
            model.accel_per_volt * model.supply_v
        };
        Self {
            position: SHARE * 3.0 * w * w,
            speed: SHARE * 3.0 * w,
            integral: SHARE * w * w * w,
            most: [most(&config.x), most(&config.y)],
        }
    }
}

impl<C: ContourController> CrossCoupled<C> {
    /// Holds the line beside what `axes` does.
    #[must_use]
    pub const fn new(axes: C, settings: CrossCoupledSettings) -> Self {
        Self { axes, settings, integral: 0.0 }
    }
}

impl<C: ContourController> ContourController for CrossCoupled<C> {
    fn start(&mut self, duration_s: f32) {
        self.integral = 0.0;
        self.axes.start(duration_s);
    }

    fn update(&mut self, state: &ContourState) -> Demand {
        let CrossCoupledSettings { position, speed, integral, most: [most_x, most_y] } = self.settings;
        let error = state.across_error();
        let grown = self.integral + integral * error * state.dt_s;
        let most = most_x.min(most_y);
        self.integral = if grown.is_finite() { grown.clamp(-most, most) } else { self.integral };
        let push = position * error + speed * state.across_speed_error() + self.integral;
        let [ux, uy] = state.direction;
        let demand = self.axes.update(state);
        Demand {
            x: Duty::saturating(demand.x.value() - uy * push / most_x),
            y: Duty::saturating(demand.y.value() + ux * push / most_y),
        }
    }
}
