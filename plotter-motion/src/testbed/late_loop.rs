//! [`LateLoop`]: a control loop whose runs do not come when they should.

use crate::SplitMix64;
use core::time::Duration;

/// By how much the runs of a loop are late: each a little, as interrupts and other work make it, and one now
/// and then by a lot.
///
/// A run that is due while another one is late is left out, as a timer's interrupt is that comes twice before
/// it is served. Edges are told when they come.
///
/// ```
/// # use plotter_motion::testbed::LateLoop;
/// # use core::time::Duration;
/// let (jitter, late) = (Duration::from_micros(20), Duration::from_millis(1));
/// let mean = |loop_: LateLoop| (0..10_000).map(|run| loop_.delay(run).as_secs_f64()).sum::<f64>() / 10_000.0;
/// assert_eq!(mean(LateLoop::default()), 0.0);
/// let one_in_100 = LateLoop { jitter, late, one_in: 100, seed: 1 };
/// assert!((mean(one_in_100) - 20e-6).abs() < 2e-6); // half of the jitter, and a hundredth of a millisecond
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct LateLoop {
    /// Each run is late by a time from 0 to this.
    pub jitter: Duration,
    /// One run in [`one_in`](Self::one_in) is later by this.
    pub late: Duration,
    /// How rare such a run is; 0 for never.
    pub one_in: u32,
    /// Seed of the times.
    pub seed: u64,
}

impl LateLoop {
    /// By how much a run is late, by its number since the start.
    #[must_use]
    pub fn delay(&self, run: u64) -> Duration {
        let mut random = SplitMix64::from_index(self.seed, run.wrapping_mul(2));
        let (jitter, late) = (random.unit(), random.bits());
        let is_late = self.one_in > 0 && late % u64::from(self.one_in) == 0;
        self.jitter.mul_f64(jitter) + if is_late { self.late } else { Duration::ZERO }
    }
}
