//! [`Simc`]: gains from a model, by lambda tuning.

use super::{Compensator, IntegratingProcess, LoopMargins, SampledLoop, TuningError};
use crate::control::Pid;

/// Gains by lambda tuning (internal model control) in Skogestad's form: the lag is cancelled by the derivative, and what is
/// left, an integrator with a delay, is led with the closed loop's time constant lambda.
///
/// ```text
///   with lag T and delay theta (half a tick of holding, half of each small lag, and of the derivative's filter all)
///   Kc = 1 / (K (lambda + theta))    tau_I = 4 (lambda + theta)    tau_D = T             (series form)
///   kp = Kc (1 + tau_D / tau_I)      ki = Kc / tau_I               kd = Kc tau_D         (as in Pid)
/// ```
///
/// [`tune`](Self::tune) takes the smallest lambda, the quickest loop, that keeps the sensitivity of the loop as it runs at or
/// below `max_sensitivity`, and whose output leaps by no more than `most_leap` when the encoder goes on by a count.
///
/// A greatest sensitivity Ms promises a gain margin of at least Ms / (Ms - 1) and a phase margin of at least
/// 2 asin(1 / (2 Ms)): with 1.7 these are 2.43 and 34.2 degrees.
///
/// Sources: D. E. Rivera, M. Morari, S. Skogestad, "Internal Model Control. 4. PID Controller Design", Industrial & Engineering
/// Chemistry Process Design and Development 25 (1986); S. Skogestad, "Simple analytic rules for model reduction and PID
/// controller tuning", Journal of Process Control 13 (2003), table 1 and equations 23 to 25, 36; of the promise
/// K. J. Åström, T. Hägglund, "Advanced PID Control" (2006), section 4.6.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Simc {
    /// Greatest sensitivity Ms, more than 1; 1.2 to 2 are usual.
    pub max_sensitivity: f64,
    /// Greatest leap of the duty when the encoder goes on by a count, 0 to 1.
    pub most_leap: f64,
}

impl Default for Simc {
    /// Ms 1.7, which Skogestad's own choice, lambda = theta, has on an integrator with a delay; and an eighth of the duty a
    /// count, so that the grain of the encoder is heard no louder than that.
    fn default() -> Self {
        Self { max_sensitivity: 1.7, most_leap: 0.125 }
    }
}

/// Gains, and the margins that a loop with them has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TunedPid {
    /// The gains, duty a count; output from -1 to 1.
    pub pid: Pid,
    /// Lambda, the closed loop's time constant, s.
    pub lambda_s: f64,
    /// On the process that they were made for.
    pub margins: LoopMargins,
}

/// The time constant of the derivative's filter, as a share of lambda.
const FILTER_SHARE: f64 = 0.25;

impl Simc {
    /// The gains for one lambda.
    ///
    /// ```
    /// # use plotter_motion::control::tuning::{IntegratingProcess, Simc};
    /// let process = IntegratingProcess {
    ///     gain_counts_s: 1000.0, time_constant_s: 0.1, second_time_constant_s: 0.0, dead_time_s: 0.009,
    /// };
    /// let pid = Simc::gains(&process, 2e-3, 0.04);
    /// // filter 10 ms, delay 9 + 1 + 10 ms, lambda + delay 60 ms: Kc = 1/60, tau_I = 0.24 s
    /// assert!((pid.kp - 0.023_611).abs() < 1e-6); // 1/60 (1 + 0.1 / 0.24)
    /// assert!((pid.ki - 0.069_444).abs() < 1e-6); // 1/60 / 0.24
    /// assert!((pid.kd - 0.001_667).abs() < 1e-6); // 1/60 * 0.1
    /// assert_eq!(pid.derivative_filter_s, 0.01);
    /// ```
    #[must_use]
    pub fn gains(process: &IntegratingProcess, tick_s: f64, lambda_s: f64) -> Pid {
        let (lag_s, delay_s) = process.lag_and_delay_s(tick_s);
        let filter_s = FILTER_SHARE * lambda_s;
        let both_s = lambda_s + delay_s + filter_s;
        let kc = 1.0 / (process.gain_counts_s * both_s);
        let integral_s = 4.0 * both_s;
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        Pid {
            kp: (kc * (1.0 + lag_s / integral_s)) as f32,
            ki: (kc / integral_s) as f32,
            kd: (kc * lag_s) as f32,
            derivative_filter_s: filter_s as f32,
            output_min: -1.0,
            output_max: 1.0,
        }
    }

    /// The quickest gains within both bounds.
    ///
    /// # Errors
    ///
    /// [`TuningError::MarginOutOfReach`] with the least sensitivity that any lambda gives.
    pub fn tune(&self, process: &IntegratingProcess, tick_s: f64) -> Result<TunedPid, TuningError> {
        /// From quicker than any loop to slower than any: 10 to the power of this many tenths.
        const TENTHS: u32 = 80;
        const HALVINGS: u32 = 12;
        let tuned = |lambda_s: f64| {
            let pid = Self::gains(process, tick_s, lambda_s);
            let compensator = Compensator::Pid(pid);
            let margins = LoopMargins::from_loop(&SampledLoop { process: *process, compensator, tick_s });
            TunedPid { pid, lambda_s, margins }
        };
        let is_good = |tuned: &TunedPid| {
            tuned.margins.max_sensitivity <= self.max_sensitivity
                && leap(&tuned.pid, tick_s) <= self.most_leap
        };
        let (_, delay_s) = process.lag_and_delay_s(tick_s);
        let mut best = f64::INFINITY;
        let mut too_quick_s = None;
        for tenth in 0..=TENTHS {
            let lambda_s = 0.1 * delay_s * libm::pow(10.0, 0.1 * f64::from(tenth));
            let mut found = tuned(lambda_s);
            best = best.min(found.margins.max_sensitivity);
            if !is_good(&found) {
                too_quick_s = Some(lambda_s);
                continue;
            }
            let mut low = too_quick_s.unwrap_or(lambda_s);
            for _ in 0..HALVINGS {
                let middle = tuned(0.5 * (low + found.lambda_s));
                if is_good(&middle) {
                    found = middle;
                } else {
                    low = middle.lambda_s;
                }
            }
            return Ok(found);
        }
        Err(TuningError::MarginOutOfReach { asked: self.max_sensitivity, best })
    }
}

/// What a single count makes of the duty at once.
fn leap(pid: &Pid, tick_s: f64) -> f64 {
    f64::from(pid.kp) + f64::from(pid.kd) / (tick_s + f64::from(pid.derivative_filter_s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::AxisConfig;

    #[test]
    fn the_quickest_loop_within_both_bounds_is_taken() {
        let process = IntegratingProcess::of(&AxisConfig::default());
        for (tick_s, most_leap, max_sensitivity) in
            [(4e-4, 1.0, 1.4), (4e-4, 1.0, 1.8), (1e-3, 0.125, 1.6), (1e-4, 0.05, 1.6)]
        {
            let rule = Simc { max_sensitivity, most_leap };
            let tuned = rule.tune(&process, tick_s).unwrap();
            let (sensitivity, leap) = (tuned.margins.max_sensitivity, leap(&tuned.pid, tick_s));
            assert!(tuned.margins.stable && sensitivity <= max_sensitivity && leap <= most_leap, "{tuned:?}");
            // one of the bounds is met
            assert!(sensitivity > 0.999 * max_sensitivity || leap > 0.995 * most_leap, "{tuned:?} {leap}");
            // and it promises the other margins
            assert!(tuned.margins.gain_margin >= sensitivity / (sensitivity - 1.0));
            let promised = 2.0 * libm::asin(0.5 / sensitivity);
            assert!(tuned.margins.phase_margin_deg.to_radians() >= promised);
        }
    }

    #[test]
    fn a_sensitivity_that_no_loop_has_is_refused() {
        // Bode's integral: what is below 1 at low frequencies is above it elsewhere.
        let process = IntegratingProcess::of(&AxisConfig::default());
        for asked in [1.0, 0.5, f64::NAN] {
            let refused = Simc { max_sensitivity: asked, ..Simc::default() }.tune(&process, 4e-4);
            assert!(
                matches!(refused, Err(TuningError::MarginOutOfReach { best, .. }) if best > 1.0),
                "{refused:?}"
            );
        }
    }
}
