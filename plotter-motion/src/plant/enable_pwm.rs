//! [`EnablePwm`]: an H-bridge whose enable pin carries the pulses, so that the motor coasts between them.
//!
//! ```text
//!  enable  ▔▔▔▔▔▔▔▔▔▔▔▔▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▔▔▔▔
//!  voltage  supply      -(supply + clamps)   open: the motor's own voltage
//!  current  ___/▔▔▔▔▔▔▔▔\____________________/▔▔
//!                        through the clamp diodes, back into the supply
//! ```
//!
//! A bridge that brakes between its pulses short-circuits the winding there; then the circuit is linear, and
//! the mean voltage does what the pulses do. This one opens it: its current dies soon, and the motor runs
//! free until the next pulse. So little duty gives little torque, and nearly none of the braking by which a
//! motor's own voltage holds its speed.

use super::dc_motor::DcMotorState;
use crate::config::CLAMPS_V;
use crate::config::MotorConfig;

/// Pulses on an enable pin, in fixed time steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EnablePwm {
    supply_v: f64,
    back_emf_v_s: f64,
    resistance_ohm: f64,
    /// Share of a current that is left after a step without voltage.
    decay: f64,
    /// A step as a share of the pulses' period, and how much of the period is over.
    step_share: f64,
    phase: f64,
    /// Share of the last step in which the supply was on the motor.
    on: f64,
}

impl EnablePwm {
    /// The bridge of a motor, over steps of `dt_s`; `None` for one that brakes between its pulses.
    pub(super) fn of(motor: &MotorConfig, dt_s: f64) -> Option<Self> {
        (motor.enable_pwm_hz > 0.0).then(|| Self {
            supply_v: motor.supply_v,
            back_emf_v_s: motor.back_emf_v_s,
            resistance_ohm: motor.resistance_ohm,
            decay: libm::exp(-motor.resistance_ohm / motor.inductance_h * dt_s),
            step_share: motor.enable_pwm_hz * dt_s,
            phase: 0.0,
            on: 0.0,
        })
    }

    /// Into how many steps one of `dt_s` is cut, so that a pulse and the death of its current are seen: at
    /// most 1000.
    pub(super) fn steps_in(motor: &MotorConfig, dt_s: f64) -> u32 {
        if motor.enable_pwm_hz <= 0.0 {
            return 1;
        }
        // 32 steps a pulse and four while a current falls to 1/e; beyond a thousand a step is no step of a
        // bench any more.
        const A_PULSE: f64 = 32.0;
        const A_TIME_CONSTANT: f64 = 4.0;
        const MOST: f64 = 1000.0;
        let finest_hz = f64::max(
            A_PULSE * motor.enable_pwm_hz,
            A_TIME_CONSTANT * motor.resistance_ohm / motor.inductance_h,
        );
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 1000")]
        let steps = libm::ceil(finest_hz * dt_s).clamp(1.0, MOST) as u32;
        steps
    }

    /// The voltage on the motor's winding in the next step, V: its mean, for a motor in this state and a duty
    /// from -1 to 1.
    pub(super) fn voltage_v(&mut self, duty: f64, state: DcMotorState) -> f64 {
        let width = duty.abs();
        let end = self.phase + self.step_share;
        // the part of the pulse, and of the next one, that lies in this step
        let covered = (width.min(end) - self.phase).max(0.0) + (end - 1.0).clamp(0.0, width);
        self.on = covered / self.step_share;
        self.phase = end - libm::floor(end);
        let driven_v = libm::copysign(self.supply_v, duty);
        self.on * driven_v + (1.0 - self.on) * self.clamped_v(state)
    }

    /// The voltage on a winding that is open: what the diodes leave while its current lasts, then its own.
    fn clamped_v(&self, state: DcMotorState) -> f64 {
        let own_v = self.back_emf_v_s * state.speed_rad_s;
        let left_a = self.decay * state.current_a;
        let clamped_v = -libm::copysign(self.supply_v + CLAMPS_V, state.current_a);
        let a_per_v = (1.0 - self.decay) / self.resistance_ohm;
        let next_a = left_a + (clamped_v - own_v) * a_per_v;
        if next_a * state.current_a > 0.0 { clamped_v } else { own_v - left_a / a_per_v }
    }

    /// What the supply gives for a current, W.
    pub(super) fn power_w(&self, duty: f64, current_a: f64) -> f64 {
        self.on * libm::copysign(self.supply_v, duty) * current_a
    }
}
