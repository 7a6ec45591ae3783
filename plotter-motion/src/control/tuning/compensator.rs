//! [`Compensator`]: what the controllers of this crate are, seen from a loop that is cut open.

use super::sample_point::SamplePoint;
use super::{Complex, ContouringFeedback};
use crate::control::{Pid, SumPid};

/// A controller as a linear filter from the error, in counts, to the duty. Limits and rounding are no part of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Compensator {
    /// Ours, with a duty of 1 as full output.
    Pid(Pid),
    /// The published one, whose output is full at `full_output` (255).
    SumPid {
        /// Gains, output per count and call.
        gains: SumPid,
        /// Output that is a duty of 1.
        full_output: f64,
    },
    /// One axis of [`Contouring`](crate::control::Contouring), with its estimator.
    Contouring(ContouringFeedback),
}

impl Compensator {
    /// Frequency response at a point of the unit circle.
    pub(super) fn sampled(&self, at: &SamplePoint) -> Complex {
        match self {
            Self::Pid(pid) => {
                let h = at.tick_s;
                let share = h / (h + f64::from(pid.derivative_filter_s).max(0.0));
                let filter = Complex::real(share) / (Complex::ONE - at.delay * (1.0 - share));
                Complex::real(f64::from(pid.kp))
                    + integral(f64::from(pid.ki) * h, at)
                    + at.one_less_delay * filter * (f64::from(pid.kd) / h)
            }
            Self::SumPid { gains, full_output } => {
                let sum = Complex::real(f64::from(gains.kp))
                    + integral(f64::from(gains.ki), at)
                    + at.one_less_delay * f64::from(gains.kd);
                sum * (1.0 / full_output)
            }
            Self::Contouring(feedback) => feedback.sampled(at).0,
        }
    }

    /// The part of its denominator that may vanish on the unit circle or beyond it: 1 if there is none.
    pub(super) fn denominator(&self, at: &SamplePoint) -> Complex {
        match self {
            Self::Pid(Pid { ki, .. }) | Self::SumPid { gains: SumPid { ki, .. }, .. } => {
                if *ki == 0.0 {
                    Complex::ONE
                } else {
                    at.one_less_delay
                }
            }
            Self::Contouring(feedback) => feedback.sampled(at).1,
        }
    }

    /// An angular frequency below which its integral rules, rad/s; infinite if it has none.
    pub(super) fn integral_below_rad_s(&self, tick_s: f64) -> f64 {
        let of = |ki: f64, kp: f64| if ki == 0.0 { f64::INFINITY } else { (ki / kp).abs() };
        match self {
            Self::Pid(pid) => of(f64::from(pid.ki), f64::from(pid.kp)),
            Self::SumPid { gains, .. } => of(f64::from(gains.ki) / tick_s, f64::from(gains.kp)),
            Self::Contouring(feedback) => f64::from(feedback.gains.speed),
        }
    }
}

/// `gain / (1 - z^-1)`; nothing for no gain, also at z = 1.
fn integral(gain: f64, at: &SamplePoint) -> Complex {
    if gain == 0.0 { Complex::ZERO } else { Complex::real(gain) / at.one_less_delay }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::{PidState, SumPidState};
    use core::f64::consts::TAU;

    const TICK_S: f64 = 1e-3;
    const TICKS_A_PERIOD: u16 = 20;
    /// The controllers reckon with 24 bits.
    const RELATIVE_ERROR: f64 = 1e-3;

    /// Size and angle of what a controller answers to a sine, when it has settled; a slow trend of its sum apart.
    fn measured(mut answer: impl FnMut(f64) -> f64) -> Complex {
        let (mut sum, mut before) = (Complex::ZERO, 0.0);
        let angle = |tick: u16| TAU * f64::from(tick % TICKS_A_PERIOD) / f64::from(TICKS_A_PERIOD);
        for tick in 0..60 * TICKS_A_PERIOD {
            let output = answer(libm::cos(angle(tick)));
            if tick >= 59 * TICKS_A_PERIOD {
                sum = sum + Complex::polar(output - before, -angle(tick));
            } else if tick % TICKS_A_PERIOD == 0 {
                before = output;
            }
        }
        sum * (2.0 / f64::from(TICKS_A_PERIOD))
    }

    #[test]
    #[expect(clippy::cast_possible_truncation, reason = "the controllers take f32")]
    fn the_responses_are_those_of_the_controllers() {
        let at = SamplePoint::new(TAU / (f64::from(TICKS_A_PERIOD) * TICK_S), TICK_S);
        let pid =
            Pid { kp: 2.0, ki: 70.0, kd: 0.01, derivative_filter_s: 2e-3, output_min: -1e6, output_max: 1e6 };
        let mut state = PidState::default();
        // the setpoint stands at 0: the error is less the measurement
        let ours = measured(|error| {
            let output = pid.update(&mut state, 0.0, -error as f32, TICK_S as f32);
            f64::from(output)
        });
        let expected = Compensator::Pid(pid).sampled(&at);
        assert!((ours - expected).size() < RELATIVE_ERROR * expected.size(), "{ours:?} {expected:?}");

        let gains = SumPid { kp: 15.0, ki: 0.8, kd: 10.0 };
        let mut state = SumPidState::default();
        let published = measured(|error| f64::from(gains.update(&mut state, error as f32)) / 255.0);
        let expected = Compensator::SumPid { gains, full_output: 255.0 }.sampled(&at);
        assert!(
            (published - expected).size() < RELATIVE_ERROR * expected.size(),
            "{published:?} {expected:?}"
        );
    }
}
