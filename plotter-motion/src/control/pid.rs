//! Proportional, integral, derivative: the published sum form and ours.
//!
//! | | [`SumPid`] (published: Öcal, section 4.4) | [`Pid`] (ours) |
//! |---|---|---|
//! | integral | sum of errors, unlimited | limited with the output (anti-windup) |
//! | derivative | difference of errors between two calls | of the measurement, filtered |
//! | time | none: gains hold for one calling rate | `dt_s` in every call |

/// The published controller: `u = Kp e + Ki sum(e) + Kd (e - e_prev)`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SumPid {
    /// Proportional gain, output per unit of error.
    pub kp: f32,
    /// Sum gain, output per unit of error and call.
    pub ki: f32,
    /// Difference gain, output per unit of error change between calls.
    pub kd: f32,
}

/// State of [`SumPid`]; a reset is `SumPidState::default()`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SumPidState {
    sum: f32,
    previous: f32,
}

impl SumPid {
    /// The output for `error`.
    ///
    /// ```
    /// # use plotter_motion::control::{SumPid, SumPidState};
    /// let pid = SumPid { kp: 15.0, ki: 0.0, kd: 10.0 };
    /// let mut state = SumPidState::default();
    /// assert_eq!(pid.update(&mut state, 2.0), 50.0); // 15*2 + 10*(2-0)
    /// assert_eq!(pid.update(&mut state, 1.0), 5.0); //  15*1 + 10*(1-2)
    /// ```
    #[must_use]
    pub fn update(&self, state: &mut SumPidState, error: f32) -> f32 {
        state.sum += error * self.ki;
        let output = self.kp * error + state.sum + self.kd * (error - state.previous);
        state.previous = error;
        output
    }
}

/// Ours: gains in units of time, output and integral kept within limits, derivative of the measurement
/// through a first-order filter, so that neither a step of the setpoint nor the grain of an encoder kicks.
///
/// Source: K. J. Åström, T. Hägglund, "Advanced PID Control" (2006), sections 3.3 to 3.6 (derivative on the
/// measurement, filtering, clamping of the integral).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pid {
    /// Proportional gain, output per unit.
    pub kp: f32,
    /// Integral gain, output per unit and second.
    pub ki: f32,
    /// Derivative gain, output seconds per unit.
    pub kd: f32,
    /// Time constant of the derivative's filter, s; 0 for none.
    pub derivative_filter_s: f32,
    /// Least output.
    pub output_min: f32,
    /// Greatest output; not below the least.
    pub output_max: f32,
}

/// State of [`Pid`]; a reset is `PidState::default()`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PidState {
    integral: f32,
    derivative: f32,
    measured: Option<f32>,
}

impl PidState {
    /// The integral's share of the output.
    #[must_use]
    pub const fn integral(&self) -> f32 {
        self.integral
    }
}

impl Pid {
    /// The output that leads `measured` to `setpoint`, `dt_s` seconds after the last call.
    ///
    /// The output always lies in `output_min..=output_max`. The integral grows only while the output is not
    /// held at the limit that it pushes towards. A `dt_s` that is not positive leaves integral and derivative
    /// as they are; a NaN among the inputs gives `output_min..=output_max`'s nearest value to 0 and changes
    /// nothing.
    ///
    /// ```
    /// # use plotter_motion::control::{Pid, PidState};
    /// let pid = Pid { kp: 2.0, ki: 4.0, kd: 0.0, derivative_filter_s: 0.0, output_min: -10.0, output_max: 10.0 };
    /// let mut state = PidState::default();
    /// assert_eq!(pid.update(&mut state, 3.0, 1.0, 0.5), 8.0); // 2*2 + 4*2*0.5
    /// assert_eq!(pid.update(&mut state, 9.0, 0.0, 0.5), 10.0); // limited, and the integral stays
    /// assert_eq!(state.integral(), 4.0);
    /// ```
    #[must_use]
    pub fn update(&self, state: &mut PidState, setpoint: f32, measured: f32, dt_s: f32) -> f32 {
        let limit = |value: f32| {
            let value = if value.is_nan() { 0.0 } else { value };
            value.max(self.output_min).min(self.output_max)
        };
        let error = setpoint - measured;
        if !error.is_finite() || !dt_s.is_finite() {
            return limit(0.0);
        }
        if dt_s > 0.0 {
            let slope = state.measured.map_or(0.0, |before| (measured - before) / dt_s);
            let share = dt_s / (dt_s + self.derivative_filter_s.max(0.0));
            let derivative = state.derivative + (slope - state.derivative) * share;
            // a slope too steep for a number, over next to no time, is none
            state.derivative = if derivative.is_finite() { derivative } else { state.derivative };
            let grown = state.integral + self.ki * error * dt_s;
            let wanted = self.kp * error + grown - self.kd * state.derivative;
            let pushes_out = (wanted > self.output_max && grown > state.integral)
                || (wanted < self.output_min && grown < state.integral);
            if !pushes_out {
                state.integral = limit(grown);
            }
        }
        state.measured = Some(measured);
        limit(self.kp * error + state.integral - self.kd * state.derivative)
    }
}

impl Pid {
    /// The published form of these gains, for `dt_s` from call to call and an output that is full at
    /// `full_output` instead of at 1: without the derivative's filter, which that form does not have.
    ///
    /// ```
    /// # use plotter_motion::control::Pid;
    /// let pid = Pid { kp: 0.02, ki: 2.0, kd: 6e-5, derivative_filter_s: 2e-4, output_min: -1.0, output_max: 1.0 };
    /// let sum = pid.sum_form(4e-4, 255.0);
    /// assert!((sum.kp - 5.1).abs() < 1e-5); // 0.02 * 255
    /// assert!((sum.ki - 0.204).abs() < 1e-5); // 2 * 4e-4 * 255
    /// assert!((sum.kd - 38.25).abs() < 1e-4); // 6e-5 / 4e-4 * 255
    /// ```
    #[must_use]
    pub fn sum_form(&self, dt_s: f32, full_output: f32) -> SumPid {
        SumPid {
            kp: self.kp * full_output,
            ki: self.ki * dt_s * full_output,
            kd: self.kd / dt_s * full_output,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PID: Pid =
        Pid { kp: 1.0, ki: 10.0, kd: 0.5, derivative_filter_s: 0.0, output_min: -1.0, output_max: 1.0 };

    #[test]
    fn a_step_of_the_setpoint_does_not_kick_the_derivative() {
        let pid = Pid { ki: 0.0, output_min: -100.0, output_max: 100.0, ..PID };
        let mut state = PidState::default();
        let _ = pid.update(&mut state, 0.0, 0.0, 0.01);
        assert_eq!(pid.update(&mut state, 5.0, 0.0, 0.01), 5.0);
    }

    #[test]
    fn the_integral_does_not_wind_up_while_the_output_is_limited() {
        let mut state = PidState::default();
        for _ in 0..10_000 {
            assert_eq!(PID.update(&mut state, 100.0, 0.0, 0.01), 1.0);
        }
        assert_eq!(PID.update(&mut state, -0.5, 0.0, 0.01), -0.55);
    }

    #[test]
    fn nan_changes_nothing() {
        let mut state = PidState::default();
        let _ = PID.update(&mut state, 0.05, 0.0, 0.01);
        let before = state;
        assert_eq!(PID.update(&mut state, f32::NAN, 0.0, 0.01), 0.0);
        assert_eq!(state, before);
    }
}
