//! [`SampledLoop`]: a controller that runs at a fixed rate on a motor, and whether it is stable.

use super::sample_point::SamplePoint;
use super::{Compensator, Complex, IntegratingProcess};
use core::f64::consts::{FRAC_PI_2, PI, TAU};

/// A controller and a motor in a loop that runs every `tick_s`.
///
/// ```text
///            every tick                 held for a tick
///  setpoint ──▶ ( + ) ──▶ compensator ──▶ hold ──▶ process ──┬──▶ counts
///                 ▲ −                                        │
///                 └──────────────────────────────────────────┘
/// ```
///
/// The duty is given at once with the count that it comes from; a controller that gives it later has so much more dead
/// time in `process`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampledLoop {
    /// The motor.
    pub process: IntegratingProcess,
    /// The controller.
    pub compensator: Compensator,
    /// Time between two runs, s; more than 0.
    pub tick_s: f64,
}

/// Frequencies looked at in every decade.
const POINTS_A_DECADE: f64 = 60.0;
/// Lowest frequency looked at, as a share of half the sampling rate.
const LOWEST: f64 = 1e-16;
/// How far a dead time, of up to so many ticks, may turn the response from one frequency to the next.
const MOST_TURN_RAD: f64 = 0.5;
const MOST_DEAD_TICKS: f64 = 300.0;
/// 16 decades, and three hundred ticks of dead time: what it never comes to with numbers.
const MOST_POINTS: usize = 4096;
/// How far below every corner of the loop the sweep begins, as a share.
const BELOW_CORNERS: f64 = 1e-2;

impl SampledLoop {
    /// The response of the cut loop, L = compensator times process, at an angular frequency from above 0 to `pi / tick_s`.
    ///
    /// ```
    /// # use plotter_motion::control::Pid;
    /// # use plotter_motion::control::tuning::{Compensator, IntegratingProcess, SampledLoop};
    /// let process = IntegratingProcess {
    ///     gain_counts_s: 1000.0, time_constant_s: 0.0, second_time_constant_s: 0.0, dead_time_s: 0.0,
    /// };
    /// let pid = Pid { kp: 1.0, ki: 0.0, kd: 0.0, derivative_filter_s: 0.0, output_min: -1.0, output_max: 1.0 };
    /// let cut = SampledLoop { process, compensator: Compensator::Pid(pid), tick_s: 1e-3 };
    /// // K h kp / (z - 1) with z = -1
    /// let last = cut.response(std::f64::consts::PI / 1e-3);
    /// assert!((last.re + 0.5).abs() < 1e-12 && last.im.abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn response(&self, rad_s: f64) -> Complex {
        self.at(&SamplePoint::new(rad_s, self.tick_s))
    }

    fn at(&self, point: &SamplePoint) -> Complex {
        self.process.sampled(point) * self.compensator.sampled(point)
    }

    /// The angular frequencies that say all of the loop, evenly spaced in decades, rad/s: from far below each of its
    /// corners to half the sampling rate.
    pub fn sweep(&self) -> impl Iterator<Item = f64> + use<> {
        self.sweep_at(1.0)
    }

    /// The same for `factor` times the controller's gain.
    fn sweep_at(&self, factor: f64) -> impl Iterator<Item = f64> + use<> {
        let last = PI / self.tick_s;
        let lag = self.process.time_constant_s + self.process.dead_time_s;
        let slow = self.compensator.integral_below_rad_s(self.tick_s).min(1.0 / lag).min(last);
        // Where the loop's gain is 1 if nothing but the integrator were there.
        let middle = SamplePoint::new(slow, self.tick_s);
        let speed =
            factor.abs() * self.compensator.sampled(&middle).size() * self.process.gain_counts_s.abs();
        let lowest = BELOW_CORNERS * if speed > 0.0 { slow.min(speed) } else { slow };
        let lowest = lowest.max(last * LOWEST);
        let ratio = libm::pow(10.0, 1.0 / POINTS_A_DECADE);
        // A dead time turns the response evenly with the frequency.
        let dead_s = self.process.dead_time_s.min(MOST_DEAD_TICKS * self.tick_s);
        let stride = MOST_TURN_RAD / (dead_s + self.tick_s);
        let next = move |rad_s: &f64| (*rad_s < last).then(|| (rad_s * ratio).min(rad_s + stride).min(last));
        core::iter::successors(Some(lowest), next).take(MOST_POINTS)
    }

    /// Whether the closed loop is stable with `factor` times the controller's gain.
    ///
    /// By Nyquist's criterion for sampled loops: with Q the compensator's poles on the unit circle or beyond it, the angle of
    /// `Q (1 + factor L)` grows by 90 degrees from frequency 0, where the motor's integrator has its pole, to half the
    /// sampling rate; every pole of the closed loop outside of the circle takes 180 degrees from that.
    ///
    /// Source: K. J. Åström, B. Wittenmark, "Computer-Controlled Systems" (1997), section 3.3.
    #[must_use]
    pub fn is_stable(&self, factor: f64) -> bool {
        let value = |rad_s: f64| {
            let point = SamplePoint::new(rad_s, self.tick_s);
            self.compensator.denominator(&point) * (Complex::ONE + self.at(&point) * factor)
        };
        let mut turned = 0.0;
        let mut before: Option<(f64, Complex)> = None;
        for rad_s in self.sweep_at(factor) {
            let now = value(rad_s);
            if let Some((last_rad_s, last)) = before {
                turned += turn(&value, (last_rad_s, last), (rad_s, now));
            }
            before = Some((rad_s, now));
        }
        // within half of what a single pole outside would take
        (turned - FRAC_PI_2).abs() < FRAC_PI_2
    }
}

/// How far a curve turns about 0 between two frequencies: by halves where it turns quickly.
fn turn(value: &impl Fn(f64) -> Complex, from: (f64, Complex), to: (f64, Complex)) -> f64 {
    /// A straight piece turns by less than half a turn; this leaves room for a bent one.
    const MOST_RAD: f64 = 0.6;
    /// Halvings: a curve that turns within a millionth of a piece passes through 0.
    const MOST_DEPTH: u32 = 20;
    /// Pieces: more turns there are not in one piece of the sweep.
    const MOST_PIECES: u32 = 40;
    let mut turned = 0.0;
    let (mut low, mut depth, mut pieces) = (from, 0_u32, 0_u32);
    let mut high = to;
    // The piece from `low` to `high`, at `depth` halvings; what is beyond it comes after.
    loop {
        let angle = wrapped(high.1.angle_rad() - low.1.angle_rad());
        if angle.abs() > MOST_RAD && depth < MOST_DEPTH && pieces < MOST_PIECES {
            let middle = 0.5 * (low.0 + high.0);
            high = (middle, value(middle));
            depth += 1;
            continue;
        }
        turned += angle;
        pieces += 1;
        // A frequency that is no number is the last too.
        if high.0.partial_cmp(&to.0) != Some(core::cmp::Ordering::Less) {
            return turned;
        }
        low = high;
        high = to;
        // Back to a piece as long as may be: halved again where needed.
        depth = 0;
    }
}

fn wrapped(angle_rad: f64) -> f64 {
    angle_rad - TAU * libm::round(angle_rad / TAU)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::Pid;

    fn integrator(kp: f32, delay_ticks: f64) -> SampledLoop {
        SampledLoop {
            process: IntegratingProcess {
                gain_counts_s: 1000.0,
                time_constant_s: 0.0,
                second_time_constant_s: 0.0,
                dead_time_s: delay_ticks * 1e-3,
            },
            compensator: Compensator::Pid(Pid {
                kp,
                ki: 0.0,
                kd: 0.0,
                derivative_filter_s: 0.0,
                output_min: -1.0,
                output_max: 1.0,
            }),
            tick_s: 1e-3,
        }
    }

    #[test]
    fn an_integrator_is_stable_up_to_the_gain_of_the_book() {
        // z - 1 + k: k < 2. With a tick of delay z² - z + k: k < 1; with two z³ - z² + k: k < (sqrt 5 - 1) / 2.
        for (delay_ticks, most) in [(0.0, 2.0), (1.0, 1.0), (2.0, 0.618_034)] {
            let cut = integrator(1.0, delay_ticks);
            assert!(cut.is_stable(0.999 * most), "{delay_ticks}");
            assert!(!cut.is_stable(1.001 * most), "{delay_ticks}");
            assert!(cut.is_stable(1e-6) && !cut.is_stable(1e6) && !cut.is_stable(-0.1), "{delay_ticks}");
        }
    }
}
