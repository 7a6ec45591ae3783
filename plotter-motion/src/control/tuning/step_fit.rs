//! [`StepFit`]: speed, lag and dead time from the counts after a step of the duty.

/// The curve of a motor that is switched on at time 0,
///
/// ```text
///   y(t) = y0 + v (t' - T (1 - e^(-t'/T)))    t' = t - theta, from 0 on
/// ```
///
/// fitted to counts by least squares (Gauss-Newton with Marquardt's damping; D. W. Marquardt, "An Algorithm for
/// Least-Squares Estimation of Nonlinear Parameters", Journal of SIAM 11, 1963). `y0` is the part of a count that the shaft
/// stood beside an edge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct StepFit {
    /// v, counts/s.
    pub(super) speed_counts_s: f64,
    /// T, s.
    pub(super) time_constant_s: f64,
    /// theta, s.
    pub(super) dead_time_s: f64,
    /// y0, counts.
    pub(super) offset_counts: f64,
    /// Root of the mean square of what is left, counts: that of rounding to whole counts is 0.29.
    pub(super) rms_counts: f64,
}

/// Parameters, in the order speed, lag, dead time, offset.
const PARAMETERS: usize = 4;
const MOST_ROUNDS: u32 = 60;

impl StepFit {
    /// No curve yet.
    pub(super) const NONE: Self = Self {
        speed_counts_s: 0.0,
        time_constant_s: 0.0,
        dead_time_s: 0.0,
        offset_counts: 0.0,
        rms_counts: 0.0,
    };

    /// Fits the curve to `samples` of (time, s; counts), which end at a steady speed; `None` if nothing like a motor fits.
    /// There must be ten at least.
    pub(super) fn of(samples: &[(f64, f64)]) -> Option<Self> {
        const LEAST_SAMPLES: usize = 10;
        if samples.len() < LEAST_SAMPLES {
            return None;
        }
        let (end_s, end) = *samples.last()?;
        let (from_s, from) = *samples.get(samples.len() * 3 / 4)?;
        let speed = (end - from) / (end_s - from_s);
        // The line of the steady part meets 0 after lag and dead time.
        let both_s = end_s - end / speed;
        if !(speed > 0.0 && both_s.is_finite()) {
            return None;
        }
        let both_s = both_s.max(1e-3 * end_s).min(end_s);
        let start = Self {
            speed_counts_s: speed,
            time_constant_s: 0.9 * both_s,
            dead_time_s: 0.1 * both_s,
            ..Self::default()
        };
        let found = start.improved(samples, PARAMETERS)?;
        if found.dead_time_s >= 0.0 {
            return Some(found);
        }
        // No answer comes before its question: without dead time then.
        Self { dead_time_s: 0.0, ..found }.improved(samples, PARAMETERS - 1)
    }

    /// What the curve says for a time, and its slopes by the parameters.
    fn at(&self, time_s: f64) -> (f64, [f64; PARAMETERS]) {
        let since_s = time_s - self.dead_time_s;
        if since_s <= 0.0 {
            return (self.offset_counts, [0.0, 0.0, 0.0, 1.0]);
        }
        let t = self.time_constant_s;
        let fallen = -libm::expm1(-since_s / t);
        let way = since_s - t * fallen;
        let by_lag = self.speed_counts_s * (since_s / t * (1.0 - fallen) - fallen);
        let value = self.offset_counts + self.speed_counts_s * way;
        (value, [way, by_lag, -self.speed_counts_s * fallen, 1.0])
    }

    fn square(&self, samples: &[(f64, f64)]) -> f64 {
        samples.iter().map(|&(t, y)| (y - self.at(t).0) * (y - self.at(t).0)).sum()
    }

    /// The best curve found from this one by all parameters, or by all but the dead time.
    fn improved(self, samples: &[(f64, f64)], parameters: usize) -> Option<Self> {
        /// Steps that make so little difference, as a share of the squares, are the last.
        const LAST_GAIN: f64 = 1e-10;
        let mut best = self;
        let mut square = best.square(samples);
        let mut damping = 1e-3;
        for _ in 0..MOST_ROUNDS {
            let Some(next) = best.stepped(samples, parameters, damping) else {
                damping *= 10.0;
                continue;
            };
            let next_square = next.square(samples);
            if next_square < square {
                let gain = (square - next_square) / square;
                (best, square) = (next, next_square);
                damping = (0.3 * damping).max(1e-12);
                if gain < LAST_GAIN {
                    break;
                }
            } else {
                damping *= 10.0;
            }
        }
        #[expect(clippy::cast_precision_loss, reason = "some hundred samples")]
        let mean = square / samples.len() as f64;
        best.rms_counts = libm::sqrt(mean);
        (best.speed_counts_s > 0.0 && best.rms_counts.is_finite()).then_some(best)
    }

    /// One step of the method; `None` where it leads to no motor.
    fn stepped(&self, samples: &[(f64, f64)], parameters: usize, damping: f64) -> Option<Self> {
        let mut normal = [[0.0; PARAMETERS + 1]; PARAMETERS];
        for &(time_s, counts) in samples {
            let (value, mut slopes) = self.at(time_s);
            if parameters < PARAMETERS {
                slopes = without_dead_time(slopes);
            }
            for (row, a) in normal.iter_mut().zip(slopes) {
                for (entry, b) in row.iter_mut().zip(slopes.into_iter().chain([counts - value])) {
                    *entry += a * b;
                }
            }
        }
        for (i, row) in normal.iter_mut().enumerate() {
            if let Some(entry) = row.get_mut(i) {
                *entry *= 1.0 + damping;
                if *entry == 0.0 {
                    *entry = 1.0; // a parameter that counts for nothing stays as it is
                }
            }
        }
        let [speed, lag, dead, offset] = solved(normal)?;
        let next = Self {
            speed_counts_s: self.speed_counts_s + speed,
            // Never below a hundredth at once: a lag is positive.
            time_constant_s: (self.time_constant_s + lag).max(0.01 * self.time_constant_s),
            dead_time_s: self.dead_time_s + dead,
            offset_counts: self.offset_counts + offset,
            rms_counts: 0.0,
        };
        next.speed_counts_s.is_finite().then_some(next)
    }
}

fn without_dead_time([speed, lag, _, offset]: [f64; PARAMETERS]) -> [f64; PARAMETERS] {
    [speed, lag, 0.0, offset]
}

/// Solves linear equations, each with its right side last (Gauss' elimination with the greatest pivot).
fn solved(mut rows: [[f64; PARAMETERS + 1]; PARAMETERS]) -> Option<[f64; PARAMETERS]> {
    for column in 0..PARAMETERS {
        let size = |row: &[f64; PARAMETERS + 1]| row.get(column).map_or(0.0, |v| v.abs());
        let pivot = (column..PARAMETERS).max_by(|&i, &j| {
            let of = |k: usize| rows.get(k).map_or(0.0, size);
            of(i).total_cmp(&of(j))
        })?;
        rows.swap(column, pivot);
        let pivot_row = *rows.get(column)?;
        let by = *pivot_row.get(column)?;
        if by == 0.0 || !by.is_finite() {
            return None;
        }
        for (i, row) in rows.iter_mut().enumerate() {
            if i == column {
                continue;
            }
            let factor = row.get(column)? / by;
            for (entry, v) in row.iter_mut().zip(pivot_row) {
                *entry -= factor * v;
            }
        }
    }
    let mut answer = [0.0; PARAMETERS];
    for (i, (entry, row)) in answer.iter_mut().zip(rows).enumerate() {
        *entry = row.last()? / row.get(i)?;
    }
    Some(answer)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn curve(fit: &StepFit, tick_s: f64, end_s: f64, rounded: bool) -> Vec<(f64, f64)> {
        (0..)
            .map(|k| f64::from(k) * tick_s)
            .take_while(|&t| t <= end_s)
            .map(|t| (t, if rounded { libm::floor(fit.at(t).0) } else { fit.at(t).0 }))
            .collect()
    }

    #[test]
    fn an_exact_curve_gives_its_parameters() {
        for (time_constant_s, dead_time_s) in [(6e-3, 1e-3), (6e-3, 0.0), (0.5, 0.02), (1e-3, 2e-3)] {
            let truth = StepFit {
                speed_counts_s: 20_000.0,
                time_constant_s,
                dead_time_s,
                offset_counts: 0.3,
                rms_counts: 0.0,
            };
            let end_s = 6.0 * (time_constant_s + dead_time_s);
            let found = StepFit::of(&curve(&truth, end_s / 100.0, end_s, false)).unwrap();
            assert!((found.speed_counts_s / 20_000.0 - 1.0).abs() < 1e-4, "{truth:?} {found:?}");
            assert!((found.time_constant_s / time_constant_s - 1.0).abs() < 1e-3, "{truth:?} {found:?}");
            assert!((found.dead_time_s - dead_time_s).abs() < 1e-3 * time_constant_s, "{truth:?} {found:?}");
        }
    }

    #[test]
    fn whole_counts_cost_some_percent() {
        // 100 counts in all
        let truth = StepFit {
            speed_counts_s: 3000.0,
            time_constant_s: 6e-3,
            dead_time_s: 0.0,
            offset_counts: 0.25,
            rms_counts: 0.0,
        };
        let found = StepFit::of(&curve(&truth, 4e-4, 0.042, true)).unwrap();
        assert!((found.speed_counts_s / 3000.0 - 1.0).abs() < 0.02, "{found:?}");
        assert!((found.time_constant_s / 6e-3 - 1.0).abs() < 0.1, "{found:?}");
        assert!(found.rms_counts < 0.35, "{found:?}");
    }

    #[test]
    fn what_is_no_step_response_is_none() {
        let line = |slope: f64| -> Vec<(f64, f64)> {
            (0..50).map(|k| (f64::from(k), slope * f64::from(k))).collect()
        };
        assert_eq!(StepFit::of(&line(0.0)), None);
        assert_eq!(StepFit::of(&line(-1.0)), None);
        assert_eq!(StepFit::of(&[]), None);
    }
}
