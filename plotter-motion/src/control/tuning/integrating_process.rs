//! [`IntegratingProcess`]: a motor that turns a position, as a transfer function.

use super::Complex;
use super::sample_point::SamplePoint;
use crate::config::AxisConfig;
use core::f64::consts::TAU;

/// A motor with its load and its encoder, from duty to counts: an integrator behind a lag, with a dead time.
///
/// ```text
///                    K e^(-theta s)                  K: speed at full duty, counts/s
///   P(s) = ----------------------------              T: what the speed takes to follow, s
///           s (1 + T s (1 + Te s))                   Te: what the current takes before it, s
/// ```
///
/// For a DC motor under voltage (Öcal, section 4.6.1, with a load's inertia and viscous friction b) it is
/// exact, with
///
/// ```text
///   c = Kt Ke + R b     K = V Kt / c     T = (R J + L b) / c     Te = L J / (R J + L b)
/// ```
///
/// times encoder counts to the radian. Dry friction is no part of it: it takes a constant share of the duty
/// ([`dry_friction_duty`](Self::dry_friction_duty)), which a step does not see once the shaft turns.
///
/// ```
/// # use plotter_motion::{config::AxisConfig, control::tuning::IntegratingProcess};
/// let motor = IntegratingProcess::of(&AxisConfig::default());
/// // c = 13.4e-3 * 13.369e-3 + 1.9 * 1e-6 = 1.81045e-4; 12 * 13.4e-3 / c = 888.2 rad/s, 500 counts a turn
/// assert!((motor.gain_counts_s - 70_679.0).abs() < 1.0);
/// assert!((motor.time_constant_s - 5.982e-3).abs() < 1e-6); // 1.9 * 5.7e-7 / c
/// assert!((motor.second_time_constant_s - 34.2e-6).abs() < 1e-7); // L/R
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegratingProcess {
    /// K, speed at full duty without dry friction, counts/s; more than 0.
    pub gain_counts_s: f64,
    /// T, 0 or more; s.
    pub time_constant_s: f64,
    /// Te, 0 for none; s.
    pub second_time_constant_s: f64,
    /// theta, from a duty to its effect, beyond the sampling itself; 0 or more, at most 300 ticks; s.
    pub dead_time_s: f64,
}

impl IntegratingProcess {
    /// The motor and the load of an axis of a checked [`Machine`](crate::Machine), from its description;
    /// without dead time.
    #[must_use]
    pub fn of(axis: &AxisConfig) -> Self {
        let (motor, load) = (&axis.motor, &axis.load);
        let (r, l) = (motor.resistance_ohm, motor.inductance_h);
        let j = motor.inertia_kg_m2 + load.inertia_kg_m2;
        let c = motor.torque_n_m_per_a * motor.back_emf_v_s + r * load.viscous_n_m_s;
        let lag = r * j + l * load.viscous_n_m_s;
        Self {
            gain_counts_s: motor.supply_v * motor.torque_n_m_per_a / c * axis.counts_per_turn() / TAU,
            time_constant_s: lag / c,
            second_time_constant_s: l * j / lag,
            dead_time_s: 0.0,
        }
    }

    /// The share of the duty that the Coulomb friction of an axis takes, from its description:
    /// `Tc R / (Kt V)`.
    ///
    /// ```
    /// # use plotter_motion::{config::AxisConfig, control::tuning::IntegratingProcess};
    /// let share = IntegratingProcess::dry_friction_duty(&AxisConfig::default());
    /// assert!((share - 0.01536).abs() < 1e-5); // 1.3e-3 * 1.9 / (13.4e-3 * 12)
    /// ```
    #[must_use]
    pub fn dry_friction_duty(axis: &AxisConfig) -> f64 {
        let motor = &axis.motor;
        axis.load.coulomb_n_m * motor.resistance_ohm / (motor.torque_n_m_per_a * motor.supply_v)
    }

    /// Lag and dead time of the simplest process that a loop with `tick_s` between its runs is near: all of T
    /// and half of Te, and beyond the dead time the other half of Te and half a tick, for which a duty is
    /// held.
    ///
    /// Source: S. Skogestad, "Simple analytic rules for model reduction and PID controller tuning", Journal
    /// of Process Control 13 (2003), section 2 (the half rule).
    #[must_use]
    pub fn lag_and_delay_s(&self, tick_s: f64) -> (f64, f64) {
        let half = 0.5 * self.second_time_constant_s;
        (self.time_constant_s + half, self.dead_time_s + half + 0.5 * tick_s)
    }

    /// The response to duties that are held over ticks, from tick to tick, at a place on the unit circle:
    /// exact, by partial fractions of the step response (K. J. Åström, B. Wittenmark, "Computer-Controlled
    /// Systems", 1997, section 2.6).
    pub(super) fn sampled(&self, at: &SamplePoint) -> Complex {
        let Self { gain_counts_s: k, time_constant_s: t, dead_time_s, .. } = *self;
        let h = at.tick_s;
        let whole = libm::floor(dead_time_s / h);
        let rest_s = (dead_time_s - whole * h).max(0.0).min(h);
        // Of the step response k (t - T) + sum of c e^(p t): the ramp, the constant, and the lags.
        let ramp = at.delay / at.one_less_delay * h;
        let constant = at.delay * (-t - rest_s);
        let lags = self.poles().into_iter().flatten().map(|(pole, share)| {
            // 1 - e^(p h) z^-1, without the digits that two numbers near 1 lose
            let below = at.one_less_delay - (pole * h).exp_m1() * at.delay;
            share * (pole * (h - rest_s)).exp() * at.delay * at.one_less_delay / below
        });
        let sum = lags.fold(ramp + constant, |sum, lag| sum + lag);
        sum * Complex::polar(k, -whole * at.angle_rad)
    }

    /// The poles beside that of the integrator, and their shares of the step response by K.
    fn poles(&self) -> [Option<(Complex, Complex)>; 2] {
        /// Two poles nearer than this, as a share, are taken to be so far apart: partial fractions need two.
        const LEAST_APART: f64 = 1e-6;
        let Self { time_constant_s: t, second_time_constant_s: te, .. } = *self;
        if t <= 0.0 {
            return [None, None];
        }
        if te <= 0.0 {
            return [Some((Complex::real(-1.0 / t), Complex::real(t))), None];
        }
        let apart = 1.0 - 4.0 * te / t;
        let apart = if apart.abs() < LEAST_APART { LEAST_APART } else { apart };
        let root = if apart > 0.0 {
            Complex::real(libm::sqrt(apart))
        } else {
            Complex { re: 0.0, im: libm::sqrt(-apart) }
        };
        let sum = Complex::ONE + root;
        let slow = Complex::real(-2.0 / t) / sum;
        let quick = sum * (-0.5 / te);
        let share = |pole: Complex| {
            let slope = Complex::real(t) + pole * (2.0 * t * te);
            Complex::ONE / (pole * pole * slope)
        };
        [Some((slow, share(slow))), Some((quick, share(quick)))]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{LoadConfig, MotorConfig};
    use crate::plant::{DcMotor, DcMotorState};

    /// What a motor under a sine does after a while is size and angle of its transfer function; the simulated
    /// motor knows nothing of partial fractions.
    fn response_of_motor(axis: &AxisConfig, tick_s: f64, ticks_a_period: u32) -> Complex {
        const PERIODS_BEFORE: u32 = 600;
        let motor = DcMotor::new(&axis.motor, &axis.load, tick_s);
        let mut state = DcMotorState::default();
        let angle = |tick: u32| TAU * f64::from(tick % ticks_a_period) / f64::from(ticks_a_period);
        let mut sum = Complex::ZERO;
        let mut drift = [0.0; 2];
        for tick in 0..(PERIODS_BEFORE + 1) * ticks_a_period {
            if tick == PERIODS_BEFORE * ticks_a_period {
                drift[0] = state.angle_rad;
            }
            if tick >= PERIODS_BEFORE * ticks_a_period {
                sum = sum + Complex::polar(state.angle_rad - drift[0], -angle(tick));
            }
            state = motor.step(state, axis.motor.supply_v * libm::cos(angle(tick)), 0.0);
        }
        drift[1] = state.angle_rad;
        assert!((drift[1] - drift[0]).abs() < 1e-6 * sum.size(), "not settled: {drift:?}");
        sum * (2.0 / f64::from(ticks_a_period) * axis.counts_per_turn() / TAU)
    }

    #[test]
    fn the_sampled_response_is_that_of_the_simulated_motor() {
        const RELATIVE_ERROR: f64 = 1e-6;
        let load = LoadConfig { viscous_n_m_s: 2e-5, ..LoadConfig::default() };
        // Te / T: 0.006, 0.6 (complex poles) and 3.
        for inductance_h in [6.5e-5, 6e-3, 3e-2] {
            let motor = MotorConfig { inductance_h, ..MotorConfig::default() };
            let axis = AxisConfig { motor, load, ..AxisConfig::default() };
            for (tick_s, ticks_a_period) in [(4e-4, 40), (4e-4, 6), (1e-3, 24)] {
                let at = SamplePoint::new(TAU / (f64::from(ticks_a_period) * tick_s), tick_s);
                let (ours, motors) = (
                    IntegratingProcess::of(&axis).sampled(&at),
                    response_of_motor(&axis, tick_s, ticks_a_period),
                );
                let error = (ours - motors).size() / motors.size();
                assert!(error < RELATIVE_ERROR, "{inductance_h} H, {tick_s} s: {ours:?} {motors:?} {error}");
            }
        }
    }

    #[test]
    fn a_dead_time_of_whole_ticks_turns_the_angle_only() {
        let without = IntegratingProcess::of(&AxisConfig::default());
        let at = SamplePoint::new(500.0, 1e-3);
        for (dead_time_s, ticks) in [(3e-3, 3.0), (3e-3 - 1e-12, 3.0)] {
            let with = IntegratingProcess { dead_time_s, ..without }.sampled(&at);
            let expected = without.sampled(&at) * Complex::polar(1.0, -500.0 * 1e-3 * ticks);
            assert!((with - expected).size() < 1e-6 * expected.size(), "{with:?} {expected:?}");
        }
    }

    #[test]
    fn a_quick_loop_sees_the_continuous_process() {
        // K e^(-theta s) / (s (1 + T s)) at s = jw, within what half a tick of holding turns.
        let process = IntegratingProcess {
            gain_counts_s: 2.0,
            time_constant_s: 0.5,
            second_time_constant_s: 0.0,
            dead_time_s: 0.033_33,
        };
        let (w, tick_s) = (3.0, 1e-4);
        let s = Complex { re: 0.0, im: w };
        let continuous = Complex::polar(2.0, -w * (0.033_33 + 0.5 * tick_s)) / (s * (Complex::ONE + s * 0.5));
        let sampled = process.sampled(&SamplePoint::new(w, tick_s));
        assert!((sampled - continuous).size() < 1e-7 * continuous.size(), "{sampled:?} {continuous:?}");
    }
}
