//! [`RelayPoint`]: a point of the frequency response, and the gains that follow from it.

use super::sample_point::SamplePoint;
use super::{Compensator, Complex, TuningError};
use crate::control::Pid;
use core::f64::consts::{PI, TAU};

/// How a motor answers, counts to the duty, at the frequency at which a relay swings it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelayPoint {
    /// Angular frequency of the swing, rad/s.
    pub rad_s: f64,
    /// The response there, counts to a duty of 1, as the loop's ticks see it; near the negative real axis.
    pub response: Complex,
    /// Time between two ticks, s.
    pub tick_s: f64,
    /// Duty of the relay.
    pub duty: f64,
    /// How far beyond the start it turned round, counts.
    pub hysteresis_counts: i32,
    /// The swing from end to end, counts.
    pub swing_counts: i32,
    /// Greatest distance from the start, counts.
    pub used_counts: i32,
    /// How long the experiment took, s.
    pub took_s: f64,
}

/// The derivative's filter in gains of both rules, as a share of the derivative's time.
const FILTER_SHARE: f64 = 0.1;

impl RelayPoint {
    /// Ku, the gain with which a proportional controller would swing at this point, duty a count: 1 / |P|. (With hysteresis
    /// the point is not quite there.)
    #[must_use]
    pub fn ultimate_gain(&self) -> f64 {
        1.0 / self.response.size()
    }

    /// Pu, the period of the swing, s.
    #[must_use]
    pub fn ultimate_period_s(&self) -> f64 {
        TAU / self.rad_s
    }

    /// The same point without what dry friction made of it: friction takes `dry_friction_duty` of the duty, against the speed,
    /// so that its fundamental wave is a quarter of a period ahead of the counts'. In `P = Y / U` it is put to the duty:
    ///
    /// ```text
    ///   P' = P / (1 - f/d e^(j (arg P + 90 degrees)))
    /// ```
    ///
    /// Source: the describing function of a relay, K. J. Åström, T. Hägglund, "Advanced PID Control" (2006), section 8.4.
    ///
    /// ```
    /// # use plotter_motion::control::tuning::{Complex, RelayPoint};
    /// let point = RelayPoint {
    ///     rad_s: 10.0, response: Complex::real(-10.0), tick_s: 1e-3,
    ///     duty: 0.5, hysteresis_counts: 2, swing_counts: 13, used_counts: 10, took_s: 2.0,
    /// };
    /// // 10 % friction: -10 / (1 + 0.1 j), 5.7 degrees later
    /// let without = point.without_friction(0.05);
    /// assert!((without.response.angle_rad().to_degrees() - 174.29).abs() < 0.01);
    /// ```
    #[must_use]
    pub fn without_friction(&self, dry_friction_duty: f64) -> Self {
        let against = Complex::polar(
            dry_friction_duty / self.duty,
            self.response.angle_rad() + core::f64::consts::FRAC_PI_2,
        );
        Self { response: self.response / (Complex::ONE - against), ..*self }
    }

    /// Gains by Tyreus and Luyben: `kp = Ku / 2.2`, `Ti = 2.2 Pu`, `Td = Pu / 6.3`.
    ///
    /// Made for integrating processes with a delay; no margin is promised, so look at what
    /// [`LoopMargins`](super::LoopMargins) says.
    ///
    /// Source: B. D. Tyreus, W. L. Luyben, "Tuning PI controllers for integrator/dead time processes", Industrial & Engineering
    /// Chemistry Research 31 (1992); with derivative W. L. Luyben, M. L. Luyben, "Essentials of Process Control" (1997).
    ///
    /// ```
    /// # use plotter_motion::control::tuning::{Complex, RelayPoint};
    /// let point = RelayPoint {
    ///     rad_s: std::f64::consts::TAU / 0.063, response: Complex::real(-10.0), tick_s: 1e-3,
    ///     duty: 0.5, hysteresis_counts: 2, swing_counts: 13, used_counts: 10, took_s: 2.0,
    /// };
    /// let pid = point.tyreus_luyben();
    /// assert!((pid.kp - 0.045_455).abs() < 1e-6); // 0.1 / 2.2
    /// assert!((pid.ki - 0.327_955).abs() < 1e-5); // kp / (2.2 * 0.063 s)
    /// assert!((pid.kd - 0.000_454_5).abs() < 1e-7); // kp * 0.01 s
    /// ```
    #[must_use]
    pub fn tyreus_luyben(&self) -> Pid {
        let period_s = self.ultimate_period_s();
        pid(self.ultimate_gain() / 2.2, 2.2 * period_s, period_s / 6.3)
    }

    /// Gains by Åström and Hägglund: the point is moved to where the loop has the gain 1 and this phase margin.
    ///
    /// Integral and derivative time are as 4 to 1; the derivative time is the least with which the controller, as it runs,
    /// turns the point to `phase_margin_deg` from -1, the gain is what brings it to the unit circle.
    ///
    /// Source: K. J. Åström, T. Hägglund, "Automatic tuning of simple regulators with specifications on phase and amplitude
    /// margins", Automatica 20 (1984), section 4.
    ///
    /// ```
    /// # use plotter_motion::control::tuning::{Complex, RelayPoint};
    /// let point = RelayPoint {
    ///     rad_s: 10.0, response: Complex::real(-10.0), tick_s: 1e-6,
    ///     duty: 0.5, hysteresis_counts: 2, swing_counts: 13, used_counts: 10, took_s: 2.0,
    /// };
    /// // As published, without a filter, Td = (tan φ + sqrt(1 + tan² φ)) / (2 w) and kp = Ku cos φ: 0.0866 s, 0.0866 at
    /// // 30 degrees; the filter asks for a little more of the derivative.
    /// let pid = point.astrom_hagglund(30.0)?;
    /// assert!((pid.kp - 0.0866).abs() < 0.01 && (pid.kd / pid.kp - 0.0866).abs() < 0.01);
    /// # Ok::<(), plotter_motion::control::tuning::TuningError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`TuningError::MarginOutOfReach`] with the greatest phase margin that such a controller gives at this point.
    pub fn astrom_hagglund(&self, phase_margin_deg: f64) -> Result<Pid, TuningError> {
        /// Derivative times looked at: 10 to the power of this many fiftieths, from a hundredth of the period.
        const FIFTIETHS: u32 = 200;
        const HALVINGS: u32 = 40;
        let at = SamplePoint::new(self.rad_s, self.tick_s);
        let least_s = 1e-2 / self.rad_s;
        let of = |derivative_s: f64| pid(1.0, 4.0 * derivative_s, derivative_s);
        // How far the point is from -1 then, in angle.
        let margin_rad = |derivative_s: f64| {
            let response = Compensator::Pid(of(derivative_s)).sampled(&at);
            (-(self.response * response)).angle_rad()
        };
        let asked = phase_margin_deg.to_radians();
        let mut best = -PI;
        let mut low = least_s;
        for fiftieth in 0..=FIFTIETHS {
            let derivative_s = least_s * libm::pow(10.0, 0.02 * f64::from(fiftieth));
            let margin = margin_rad(derivative_s);
            best = best.max(margin);
            if margin < asked {
                low = derivative_s;
                continue;
            }
            let mut high = derivative_s;
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if margin_rad(middle) < asked {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            let size = (self.response * Compensator::Pid(of(high)).sampled(&at)).size();
            return Ok(pid(1.0 / size, 4.0 * high, high));
        }
        Err(TuningError::MarginOutOfReach { asked: phase_margin_deg, best: best.to_degrees() })
    }
}

fn pid(gain: f64, integral_s: f64, derivative_s: f64) -> Pid {
    #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
    Pid {
        kp: gain as f32,
        ki: (gain / integral_s) as f32,
        kd: (gain * derivative_s) as f32,
        derivative_filter_s: (FILTER_SHARE * derivative_s) as f32,
        output_min: -1.0,
        output_max: 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::AxisConfig;
    use crate::control::tuning::{IntegratingProcess, LoopMargins, SampledLoop};

    #[test]
    fn the_point_of_a_known_motor_gets_its_phase_margin() {
        /// The gains have 24 bits.
        const ROUNDING_DEG: f64 = 1e-3;
        let (process, tick_s) = (IntegratingProcess::of(&AxisConfig::default()), 4e-4);
        for rad_s in [500.0, 700.0, 900.0] {
            let response = process.sampled(&SamplePoint::new(rad_s, tick_s));
            let point = RelayPoint {
                rad_s,
                response,
                tick_s,
                duty: 0.5,
                hysteresis_counts: 2,
                swing_counts: 20,
                used_counts: 20,
                took_s: 1.0,
            };
            for asked in [30.0, 45.0] {
                let compensator = Compensator::Pid(point.astrom_hagglund(asked).unwrap());
                let margins = LoopMargins::from_loop(&SampledLoop { process, compensator, tick_s });
                assert!(
                    (margins.phase_margin_deg - asked).abs() < ROUNDING_DEG,
                    "{rad_s} {asked} {margins:?}"
                );
                assert!(
                    (margins.crossover_hz * TAU / rad_s - 1.0).abs() < 1e-4,
                    "{rad_s} {asked} {margins:?}"
                );
            }
            assert!(matches!(point.astrom_hagglund(120.0), Err(TuningError::MarginOutOfReach { .. })));
        }
    }
}
