//! [`Figures`]: errors, time and energy of a run.

use super::Moment;
use core::time::Duration;

/// Figures of a run, or of several added up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Figures {
    /// Sum of the squares of the pen's distance from the line, mm^2, over all measured time steps.
    pub square_mm2: f64,
    /// Number of measured time steps.
    pub samples: u64,
    /// Greatest distance, mm.
    pub max_mm: f64,
    /// When the pen came near the last target for good, as far as it was watched; `None` if it did not.
    pub settled: Option<Duration>,
    /// How long it took until the controller said that the last target was reached, or the limit.
    pub time: Duration,
    /// Electrical energy taken from the supply, J.
    pub energy_j: f64,
    /// Targets given.
    pub targets: u32,
    /// Targets that the controller reached within the limit.
    pub reached: u32,
    /// By how many whole counts the controller's place of an axis was off in the end, of the worse axis.
    pub lost_counts: u32,
}

impl Figures {
    /// Root of the mean square of the distance from the line, mm; 0 where nothing was measured.
    ///
    /// ```
    /// # use plotter_motion::testbed::Figures;
    /// let figures = Figures { square_mm2: 36.0, samples: 4, ..Figures::default() };
    /// assert_eq!(figures.rms_mm(), 3.0);
    /// ```
    #[must_use]
    pub fn rms_mm(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "samples stay far below 2^53")]
        let samples = self.samples.max(1) as f64;
        libm::sqrt(self.square_mm2 / samples)
    }

    /// Whether every target was reached.
    #[must_use]
    pub const fn is_finished(&self) -> bool {
        self.reached == self.targets
    }

    pub(super) fn note(&mut self, moment: &Moment, settled_mm: f64) {
        if moment.is_measured {
            self.square_mm2 += moment.error_mm * moment.error_mm;
            self.samples += 1;
            self.max_mm = self.max_mm.max(moment.error_mm);
        }
        if moment.pen.distance(moment.target) > settled_mm {
            self.settled = None;
        } else if self.settled.is_none() {
            self.settled = Some(moment.time);
        }
    }
}

impl core::iter::Sum for Figures {
    /// Several runs as one: the distances of all of them together, times and energies added, the most lost
    /// counts. They have settled if each of them has.
    fn sum<I: Iterator<Item = Self>>(runs: I) -> Self {
        let none = Self { settled: Some(Duration::ZERO), ..Self::default() };
        runs.fold(none, |sum, run| Self {
            square_mm2: sum.square_mm2 + run.square_mm2,
            samples: sum.samples + run.samples,
            max_mm: sum.max_mm.max(run.max_mm),
            settled: sum.settled.zip(run.settled).map(|(sum, run)| sum + run),
            time: sum.time + run.time,
            energy_j: sum.energy_j + run.energy_j,
            targets: sum.targets + run.targets,
            reached: sum.reached + run.reached,
            lost_counts: sum.lost_counts.max(run.lost_counts),
        })
    }
}
