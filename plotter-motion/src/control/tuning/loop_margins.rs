//! [`LoopMargins`]: how far a loop is from swinging.

use super::{Complex, SampledLoop};
use core::f64::consts::PI;

/// The margins of a loop, as the field defines them (K. J. Åström, T. Hägglund, "Advanced PID Control", 2006, section 4.6),
/// for the loop as it runs: sampled, its duties held over a tick, its derivative filtered.
///
/// ```text
///                  Im L
///                   │        gain margin    1 / a
///     ─────●────a───┼───     phase margin   φ, the least of all crossings of the unit circle
///         -1  ╲    ╱│        sensitivity    1 / d, d the least distance from -1
///          φ   ◟__╱ │        delay margin   φ / ω there
/// ```
///
/// An integrator that runs every millisecond, with a gain of one count a count:
///
/// ```
/// # use plotter_motion::control::Pid;
/// # use plotter_motion::control::tuning::{Compensator, IntegratingProcess, LoopMargins, SampledLoop};
/// let process = IntegratingProcess {
///     gain_counts_s: 1000.0, time_constant_s: 0.0, second_time_constant_s: 0.0, dead_time_s: 0.0,
/// };
/// let pid = Pid { kp: 1.0, ki: 0.0, kd: 0.0, derivative_filter_s: 0.0, output_min: -1.0, output_max: 1.0 };
/// let cut = SampledLoop { process, compensator: Compensator::Pid(pid), tick_s: 1e-3 };
/// let margins = LoopMargins::from_loop(&cut);
/// // L = 1 / (z - 1): -1/2 at z = -1; of size 1 at 60 degrees, where it has the angle -120 degrees
/// assert!((margins.gain_margin - 2.0).abs() < 1e-9);
/// assert!((margins.phase_margin_deg - 60.0).abs() < 1e-6);
/// assert!((margins.delay_margin_s - 1e-3).abs() < 1e-9); // 60 degrees at 60 degrees a tick
/// assert!((margins.max_sensitivity - 2.0).abs() < 1e-9); // |z - 1| / |z| at z = -1
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopMargins {
    /// Whether the closed loop is stable.
    pub stable: bool,
    /// What the gain may be multiplied by until the loop swings; infinite if it never does. Below 1 for a loop that is not
    /// stable: what its gain must be multiplied by to become so, 0 if nothing helps.
    pub gain_margin: f64,
    /// What the gain may fall to, as a factor, until a stable loop swings: 0 for one that stands any loss of gain.
    pub gain_reduction: f64,
    /// Least phase margin, degrees; negative for a loop that is not stable, 180 for one whose gain is never 1.
    pub phase_margin_deg: f64,
    /// Greatest sensitivity Ms = max |1 / (1 + L)|; infinite for a loop that is not stable.
    pub max_sensitivity: f64,
    /// Dead time that may be added until the loop swings, s; 0 for a loop that is not stable, infinite if its gain is
    /// never 1. Whole ticks exactly; parts of one nearly, as long as the crossover is far below the sampling rate.
    pub delay_margin_s: f64,
    /// Highest frequency at which the cut loop has the gain 1, Hz; 0 if it never does.
    pub crossover_hz: f64,
    /// Frequency at which a stable loop swings at the gain margin, Hz; 0 if it never does.
    pub swing_hz: f64,
}

/// Crossings of the real axis that are kept; a loop of these parts has a handful.
const MOST_CROSSINGS: usize = 12;
/// Halvings of a piece of the sweep: to the last bits of a frequency.
const HALVINGS: u32 = 60;

#[derive(Clone, Copy, Debug, Default)]
struct Crossings {
    /// Factor by which the curve passes through -1, and the angular frequency.
    found: [(f64, f64); MOST_CROSSINGS],
    count: usize,
}

impl Crossings {
    fn push(&mut self, factor: f64, rad_s: f64) {
        if let Some(place) = self.found.get_mut(self.count) {
            *place = (factor, rad_s);
            self.count += 1;
        }
    }

    fn iter(&self) -> impl Iterator<Item = (f64, f64)> {
        self.found.iter().take(self.count).copied()
    }
}

impl LoopMargins {
    /// The margins of a loop, by a sweep over all frequencies and halving where something is crossed.
    #[must_use]
    pub fn from_loop(cut: &SampledLoop) -> Self {
        let stable = cut.is_stable(1.0);
        let mut crossings = Crossings::default();
        let mut phase_margin_rad = PI;
        let (mut delay_margin_s, mut crossover) = (f64::INFINITY, 0.0_f64);
        let mut nearest = (f64::INFINITY, 0.0);
        let mut before: Option<(f64, Complex)> = None;
        for rad_s in cut.sweep() {
            let now = cut.response(rad_s);
            let distance = (Complex::ONE + now).size();
            if distance < nearest.0 {
                nearest = (distance, rad_s);
            }
            if let Some((last_rad_s, last)) = before {
                if (last.size() >= 1.0) != (now.size() >= 1.0) {
                    let at = halved(last_rad_s, rad_s, |w| cut.response(w).size() >= 1.0);
                    let margin = (-cut.response(at)).angle_rad();
                    // above the real axis it is what the loop has lost already
                    phase_margin_rad = phase_margin_rad.min(margin.abs());
                    delay_margin_s = delay_margin_s.min(until_swinging(margin) / at);
                    crossover = crossover.max(at);
                }
                if (last.im >= 0.0) != (now.im >= 0.0) && (last.re < 0.0 || now.re < 0.0) {
                    let at = halved(last_rad_s, rad_s, |w| cut.response(w).im >= 0.0);
                    let there = cut.response(at);
                    if there.re < 0.0 {
                        crossings.push(1.0 / there.size(), at);
                    }
                }
            }
            before = Some((rad_s, now));
        }
        // At half the sampling rate the response is real: the curve ends there, or meets its mirror image.
        if let Some((rad_s, last)) = before.filter(|(_, last)| last.re < 0.0) {
            crossings.push(1.0 / last.size(), rad_s);
        }
        let (gain_margin, swing) = gain_margin(cut, stable, &crossings);
        let gain_reduction = crossings.iter().map(|(factor, _)| factor).filter(|factor| *factor < 1.0);
        let distance = refined_distance(cut, nearest.1).min(nearest.0);
        Self {
            stable,
            gain_margin,
            gain_reduction: if stable { gain_reduction.fold(0.0, f64::max) } else { 0.0 },
            phase_margin_deg: if stable { phase_margin_rad } else { -phase_margin_rad }.to_degrees(),
            max_sensitivity: if stable { 1.0 / distance } else { f64::INFINITY },
            delay_margin_s: if stable { delay_margin_s } else { 0.0 },
            crossover_hz: crossover / (2.0 * PI),
            swing_hz: swing / (2.0 * PI),
        }
    }
}

/// The angle by which more delay turns a point of the unit circle, `margin_rad` from -1, into -1.
fn until_swinging(margin_rad: f64) -> f64 {
    if margin_rad >= 0.0 { margin_rad } else { margin_rad + 2.0 * PI }
}

/// The factor at which a loop swings, and the angular frequency at which it does.
fn gain_margin(cut: &SampledLoop, stable: bool, crossings: &Crossings) -> (f64, f64) {
    if stable {
        let above = crossings.iter().filter(|(factor, _)| *factor > 1.0);
        return above.fold((f64::INFINITY, 0.0), |least, next| if next.0 < least.0 { next } else { least });
    }
    /// Just below a factor at which the loop swings, as a share of it.
    const JUST_BELOW: f64 = 1.0 - 1e-3;
    let below = crossings.iter().filter(|(factor, _)| *factor <= 1.0 && cut.is_stable(factor * JUST_BELOW));
    below.fold((0.0, 0.0), |most, next| if next.0 > most.0 { next } else { most })
}

/// Where between `low` and `high` the answer of `test` changes.
fn halved(mut low: f64, mut high: f64, test: impl Fn(f64) -> bool) -> f64 {
    let first = test(low);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if test(middle) == first {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// The least distance from -1 near a frequency of the sweep: by golden sections of the two pieces beside it.
fn refined_distance(cut: &SampledLoop, near_rad_s: f64) -> f64 {
    /// More than a piece of the sweep.
    const PIECE: f64 = 1.05;
    const ROUNDS: u32 = 60;
    let golden = 0.5 * (libm::sqrt(5.0) - 1.0);
    let distance = |rad_s: f64| (Complex::ONE + cut.response(rad_s)).size();
    let (mut low, mut high) = (near_rad_s / PIECE, (near_rad_s * PIECE).min(PI / cut.tick_s));
    let mut left = high - golden * (high - low);
    let mut right = low + golden * (high - low);
    let (mut at_left, mut at_right) = (distance(left), distance(right));
    for _ in 0..ROUNDS {
        if at_left < at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - golden * (high - low);
            at_left = distance(left);
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + golden * (high - low);
            at_right = distance(right);
        }
    }
    at_left.min(at_right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::tuning::{Compensator, IntegratingProcess};
    use crate::{
        config::AxisConfig,
        control::{Pid, SumPid},
    };

    const PI_ONLY: Pid =
        Pid { kp: 1.0, ki: 0.0, kd: 0.0, derivative_filter_s: 0.0, output_min: -1.0, output_max: 1.0 };

    fn cut(gain_counts_s: f64, dead_time_s: f64, pid: Pid, tick_s: f64) -> SampledLoop {
        let process = IntegratingProcess {
            gain_counts_s,
            time_constant_s: 0.0,
            second_time_constant_s: 0.0,
            dead_time_s,
        };
        SampledLoop { process, compensator: Compensator::Pid(pid), tick_s }
    }

    #[test]
    fn an_integrator_with_a_ticks_delay_has_the_margins_of_the_book() {
        // L = k / (z (z - 1)), k = 1/2: real at 60 degrees, where it is -k; so k may double.
        let margins = LoopMargins::from_loop(&cut(500.0, 1e-3, PI_ONLY, 1e-3));
        assert!(margins.stable);
        assert!((margins.gain_margin - 2.0).abs() < 1e-9, "{margins:?}");
        assert!((margins.swing_hz - 1000.0 / 6.0).abs() < 1e-6, "{margins:?}");
        // |z - 1| = 1/2 at 2 asin(1/4) = 28.955 degrees: 180 - 90 - 28.955 * 1.5
        assert!((margins.phase_margin_deg - 46.567).abs() < 1e-3, "{margins:?}");
        assert_eq!(margins.gain_reduction, 0.0);
    }

    /// Table 1 of Skogestad's paper: SIMC on an integrating process with the closed loop's time constant equal to theta; here with a loop so quick that
    /// its sampling hardly counts.
    #[test]
    fn simc_on_an_integrator_has_its_published_margins() {
        let theta = 0.1;
        let pid = Pid { kp: 5.0, ki: 5.0 / 0.8, ..PI_ONLY }; // 1 / (k' 2 theta), tau_I = 8 theta
        let margins = LoopMargins::from_loop(&cut(1.0, theta - 0.5e-5, pid, 1e-5));
        assert!((margins.gain_margin - 2.96).abs() < 0.01, "{margins:?}");
        assert!((margins.phase_margin_deg - 46.9).abs() < 0.1, "{margins:?}");
        assert!((margins.max_sensitivity - 1.70).abs() < 0.01, "{margins:?}");
        assert!((margins.delay_margin_s / theta - 1.59).abs() < 0.01, "{margins:?}");
        assert_eq!(margins.gain_reduction, 0.0);
    }

    #[test]
    fn a_loop_that_is_not_stable_says_what_gain_it_would_need() {
        let margins = LoopMargins::from_loop(&cut(4000.0, 1e-3, PI_ONLY, 1e-3));
        assert!(!margins.stable);
        assert!((margins.gain_margin - 0.25).abs() < 1e-9, "{margins:?}");
        assert!(margins.phase_margin_deg < 0.0 && margins.max_sensitivity == f64::INFINITY);
        assert_eq!(margins.delay_margin_s, 0.0);
        // a controller with the wrong sign
        assert_eq!(LoopMargins::from_loop(&cut(-10.0, 0.0, PI_ONLY, 1e-3)).gain_margin, 0.0);
    }

    /// Kp = 15 and Kd = 0 for x, 10 for y, in steps of 255 a count, with the gantry's motor.
    #[test]
    fn the_published_gains_leave_next_to_no_margin() {
        let published = |kd, hz| {
            let gains = SumPid { kp: 15.0, ki: 1e-5, kd };
            let compensator = Compensator::SumPid { gains, full_output: 255.0 };
            let process = IntegratingProcess::of(&AxisConfig::default());
            LoopMargins::from_loop(&SampledLoop { process, compensator, tick_s: 1.0 / hz })
        };
        let (x, y) = (published(0.0, 2500.0), published(10.0, 2500.0));
        assert!(x.stable && x.phase_margin_deg < 0.5 && x.gain_margin < 1.04, "{x:?}");
        assert!(y.stable && (11.0..13.0).contains(&y.phase_margin_deg) && y.max_sensitivity > 4.0, "{y:?}");
        // called half as often, the x axis swings
        assert!(!published(0.0, 1250.0).stable);
    }
}
