//! [`PlannedPid`]: one axis after its reference, with or without a model of the motor.

use super::{AxisController, AxisState, ShaftModel, TwoAxes};
use crate::config::DcConfig;
use crate::{Duty, Machine, config::AxisConfig};
use core::f64::consts::TAU;

/// Ours for one axis: PID on the error against a planned reference, and, with a model, the duty that the plan
/// itself needs.
///
/// ```text
///   acceleration = kp e + kd de/dt + ki ∫e                     (s + w)³ = s³ + 3w s² + 3w² s + w³: kd, kp, ki
///   feed-forward   + planned acceleration + damping * planned speed + friction against it
///   duty = acceleration / (acceleration by the whole supply)
/// ```
///
/// The integral stops growing while the duty is at its limit (anti-windup), and is forgotten when a line
/// begins. It is also what gets a shaft going that sticks beside its target, in friction greater than known.
///
/// Source of the feed-forward: G. Ellis, "Control System Design Guide" (4th edition, 2012), chapter 8. The
/// gains place all three poles of the error at -w.
///
/// ```
/// # use plotter_motion::control::{AxisController, AxisState, PlannedPid, ShaftModel};
/// let model = ShaftModel { accel_per_volt: 1000.0, damping_per_s: 10.0, dry_friction: 400.0, supply_v: 12.0 };
/// let cruise = AxisState { reference_speed: 2000.0, speed: 2000.0, ..AxisState::default() };
/// // on its reference: nothing to do for the PID; the plan needs (10 * 2000 + 400) / (1000 * 12)
/// assert_eq!(PlannedPid::new(model, 100.0).update(&cruise, 1e-4).value(), 0.0);
/// let duty = PlannedPid::new(model, 100.0).with_feed_forward().update(&cruise, 1e-4);
/// assert!((duty.value() - 1.0).abs() < 1e-6); // 1.7, cut
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedPid {
    model: ShaftModel,
    /// w, rad/s.
    natural_rad_s: f32,
    feeds_forward: bool,
    integral: f32,
}

impl PlannedPid {
    /// Without feed-forward, for a motor and its load, with all poles at `natural_rad_s`.
    #[must_use]
    pub const fn new(model: ShaftModel, natural_rad_s: f32) -> Self {
        Self { model, natural_rad_s, feeds_forward: false, integral: 0.0 }
    }

    /// The same with the duty that the plan itself needs.
    #[must_use]
    pub const fn with_feed_forward(self) -> Self {
        Self { feeds_forward: true, ..self }
    }

    fn of(axis: &AxisConfig, bandwidth_hz: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        Self::new(ShaftModel::new(axis), (bandwidth_hz * TAU) as f32)
    }
}

impl TwoAxes<PlannedPid> {
    /// Both axes of a machine, at the bandwidth of its `[control.contouring]`, without feed-forward.
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        let config = DcConfig::of(machine);
        let bandwidth_hz = config.control.contouring.bandwidth_hz;
        Self { x: PlannedPid::of(&config.x, bandwidth_hz), y: PlannedPid::of(&config.y, bandwidth_hz) }
    }

    /// The same with the duty that the plan itself needs.
    #[must_use]
    pub const fn with_feed_forward(self) -> Self {
        Self { x: self.x.with_feed_forward(), y: self.y.with_feed_forward() }
    }
}

impl AxisController for PlannedPid {
    fn start(&mut self, _duration_s: f32) {
        self.integral = 0.0;
    }

    fn update(&mut self, state: &AxisState, dt_s: f32) -> Duty {
        let Self { model, natural_rad_s: w, .. } = *self;
        let most = model.accel_per_volt * model.supply_v;
        let grown = self.integral + w * w * w * state.error() * dt_s;
        let mut accel = 3.0 * w * (w * state.error() + state.speed_error()) + grown;
        if self.feeds_forward {
            let sense = if state.reference_speed == 0.0 { state.error() } else { state.reference_speed };
            accel += state.reference_accel
                + model.damping_per_s * state.reference_speed
                + libm::copysignf(model.dry_friction, sense);
        }
        let winds_up = accel.abs() > most && grown.abs() > self.integral.abs();
        if !winds_up && grown.is_finite() {
            self.integral = grown.clamp(-most, most);
        }
        Duty::saturating(accel / most)
    }
}
