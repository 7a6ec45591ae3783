//! [`Recording`]: a curve of any length in a fixed number of samples.

/// Samples that are kept at the most.
const MOST: usize = 160;

/// Counts at equal times from the start of a run. When the room is full every second sample goes, and from then on only
/// every second one comes: there are always at least half of `MOST`, over the whole run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Recording {
    samples: [(f64, f64); MOST],
    count: usize,
    /// Ticks from sample to sample.
    stride: u32,
}

impl Recording {
    pub(super) const fn new() -> Self {
        Self { samples: [(0.0, 0.0); MOST], count: 0, stride: 1 }
    }

    pub(super) fn as_slice(&self) -> &[(f64, f64)] {
        self.samples.get(..self.count).unwrap_or_default()
    }

    /// Takes the counts of the tick `tick`; says whether they were kept.
    pub(super) fn push(&mut self, tick: u32, tick_s: f64, counts: f64) -> bool {
        if !tick.is_multiple_of(self.stride) {
            return false;
        }
        if self.count == MOST {
            self.stride = self.stride.saturating_mul(2);
            let old = self.samples;
            for (place, kept) in self.samples.iter_mut().zip(old.iter().step_by(2)) {
                *place = *kept;
            }
            self.count = MOST / 2;
            if !tick.is_multiple_of(self.stride) {
                return false;
            }
        }
        if let Some(place) = self.samples.get_mut(self.count) {
            *place = (f64::from(tick) * tick_s, counts);
            self.count += 1;
        }
        true
    }

    /// Whether the speed is steady: the last quarter of the time brought hardly more counts than the one before.
    pub(super) fn is_steady(&self) -> bool {
        /// What is left of the start is 2 % of the speed after six lags.
        const STEADY: f64 = 0.02;
        /// Fewer counts say nothing of a speed.
        const LEAST_COUNTS: f64 = 16.0;
        const LEAST_SAMPLES: usize = 20;
        if self.count < LEAST_SAMPLES {
            return false;
        }
        let last = self.count - 1;
        let quarter = last / 4;
        let at = |i: usize| self.samples.get(i).map_or(0.0, |sample| sample.1);
        let newest = at(last) - at(last - quarter);
        let before = at(last - quarter) - at(last - 2 * quarter);
        // a count more or less is the rounding of both ends
        newest >= LEAST_COUNTS && newest - before <= STEADY * newest + 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_length_fits_and_times_are_even() {
        let mut recording = Recording::new();
        for tick in 0..10_000 {
            recording.push(tick, 1e-3, f64::from(tick));
        }
        let kept = recording.as_slice();
        assert!(kept.len() >= MOST / 2 && kept.len() <= MOST, "{}", kept.len());
        assert!(kept.windows(2).all(|pair| (pair[1].0 - pair[0].0 - kept[1].0).abs() < 1e-9));
        assert_eq!(kept[0], (0.0, 0.0));
        assert!(kept.iter().all(|&(t, y)| (y - 1e3 * t).abs() < 1e-6));
    }

    #[test]
    fn a_steady_speed_is_told_from_a_growing_one() {
        let steady_after = |lag: f64| {
            let mut recording = Recording::new();
            (0..5000).find(|&tick| {
                let t = f64::from(tick);
                recording.push(tick, 1.0, libm::floor(20.0 * (t - lag * (1.0 - libm::exp(-t / lag)))));
                recording.is_steady()
            })
        };
        let after = steady_after(100.0).unwrap();
        assert!((450..1000).contains(&after), "{after}");
        assert_eq!(steady_after(10_000.0), None);
    }
}
