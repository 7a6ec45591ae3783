//! [`Plan`] and [`Pace`]: how much there is to draw, and how long the rest will take.

use core::time::Duration;

/// How much a drawing is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Plan {
    /// Targets.
    pub targets: u64,
    /// Way of the pen, up and down, mm.
    pub way_mm: f64,
}

/// Learns what a target and a millimetre take from those that are done: the time of a target is a + b · its
/// length, with a and b by least squares over all targets so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pace {
    targets: f64,
    length_mm: f64,
    square_mm2: f64,
    time_s: f64,
    time_length: f64,
}

impl Pace {
    pub(super) fn target(&mut self, length_mm: f64, time: Duration) {
        let time_s = time.as_secs_f64();
        self.targets += 1.0;
        self.length_mm += length_mm;
        self.square_mm2 += length_mm * length_mm;
        self.time_s += time_s;
        self.time_length += time_s * length_mm;
    }

    /// Time for the rest of a plan; `None` before the first target.
    pub(super) fn remaining(&self, plan: Plan, done: Plan) -> Option<Duration> {
        if self.targets < 1.0 || self.time_s <= 0.0 {
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "targets below 2^53")]
        let targets = plan.targets.saturating_sub(done.targets) as f64;
        let way_mm = (plan.way_mm - done.way_mm).max(0.0);
        let mean = |sum: f64| sum / self.targets;
        let spread = mean(self.square_mm2) - mean(self.length_mm) * mean(self.length_mm);
        let slope = if spread > 1e-9 {
            ((mean(self.time_length) - mean(self.time_s) * mean(self.length_mm)) / spread).max(0.0)
        } else {
            0.0
        };
        let each = (mean(self.time_s) - slope * mean(self.length_mm)).max(0.0);
        Duration::try_from_secs_f64(each * targets + slope * way_mm).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_and_short_targets_are_told_apart() {
        let mut pace = Pace::default();
        assert_eq!(pace.remaining(Plan { targets: 3, way_mm: 1.0 }, Plan::default()), None);
        // 0.1 s for each target and 0.01 s for each mm
        for length_mm in [1.0, 2.0, 30.0, 5.0] {
            pace.target(length_mm, Duration::from_secs_f64(0.1 + 0.01 * length_mm));
        }
        let plan = Plan { targets: 14, way_mm: 1_038.0 };
        let rest = pace.remaining(plan, Plan { targets: 4, way_mm: 38.0 }).unwrap();
        assert!((rest.as_secs_f64() - 11.0).abs() < 1e-6, "{rest:?}");
    }
}
