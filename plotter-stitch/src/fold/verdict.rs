//! [`FoldTest`]: whether two strokes lie on each other.

use core::fmt;

/// What a scan across the line saw of it: from where to where, mm along the scan.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Seen {
    /// Where ink was first seen.
    pub from_mm: f64,
    /// Where it was last seen.
    pub to_mm: f64,
}

/// Most scans that are looked at.
const MOST_SCANS: usize = 64;

/// For how many scans the roughness that is expected counts against the one that is seen.
const EXPECTED_SCANS: f64 = 4.0;

/// No paper is taken to be rougher than this many times what is expected: its limit stays where a fold of 0.2
/// mm is never missed.
const ROUGHEST: f64 = 1.2;

/// From the median of absolute deviations to a standard deviation, for normal numbers: 1 / Φ⁻¹(3/4).
const OF_DEVIATION: f64 = 1.482_602_218_505_602;

/// How a fold is told from none.
///
/// Each scan is made twice, over the first stroke and over both. If the strokes lie beside each other by d,
/// the line has become wider by d; whatever the paper does to the first stroke is the same both times and
/// cancels. The median over all scans is compared with a limit,
///
/// ```text
/// limit = mean + z √(common² + (1.2533 each)² / n)
/// ```
///
/// with z from the share of false alarms that is allowed: P(N > z) = [`false_alarms`](Self::false_alarms).
/// 1.2533 is √(π/2), what the median of normal numbers spreads wider than their mean. The median stays where
/// it is if less than half of the scans meet dust. Where the scans differ from one another by more than is
/// expected the paper is rougher, and `mean` and `each` are taken for as much larger.
///
/// ```
/// use plotter_stitch::{FoldTest, FoldVerdict, fold::Seen};
///
/// let test = FoldTest::default();
/// // z = 3.09: 0.025 + 3.09 √(0.012² + (1.2533 · 0.033)² / 9) = 0.081 mm
/// assert!((test.limit_mm(9) - 0.0814).abs() < 1e-4);
/// let once = [Some(Seen { from_mm: 2.5, to_mm: 3.4 }); 9];
/// let twice = [Some(Seen { from_mm: 2.5, to_mm: 3.6 }); 9];
/// assert!(matches!(test.judge(&once, &once), FoldVerdict::Flat { .. }));
/// assert!(matches!(test.judge(&once, &twice), FoldVerdict::Fold { .. })); // wider by 0.2 mm
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct FoldTest {
    /// Share of the flat sheets that may be taken for folded ones; above 0, below one half.
    pub false_alarms: f64,
    /// By how much a second stroke widens the line of a flat sheet on average, mm: both strokes have rough
    /// edges, and the outer ones are seen.
    pub mean_mm: f64,
    /// Standard deviation of that, common to all scans, mm: how exactly the pen comes back.
    pub common_mm: f64,
    /// Standard deviation of that from scan to scan, mm.
    pub each_mm: f64,
    /// Least number of scans that must see the line both times.
    pub least_scans: usize,
}

impl FoldTest {
    /// The same with another [`FoldTest::false_alarms`].
    #[must_use]
    pub const fn with_false_alarms(self, false_alarms: f64) -> Self {
        Self { false_alarms, ..self }
    }

    /// The same with another [`FoldTest::mean_mm`].
    #[must_use]
    pub const fn with_mean_mm(self, mean_mm: f64) -> Self {
        Self { mean_mm, ..self }
    }

    /// The same with another [`FoldTest::common_mm`].
    #[must_use]
    pub const fn with_common_mm(self, common_mm: f64) -> Self {
        Self { common_mm, ..self }
    }

    /// The same with another [`FoldTest::each_mm`].
    #[must_use]
    pub const fn with_each_mm(self, each_mm: f64) -> Self {
        Self { each_mm, ..self }
    }

    /// The same with another [`FoldTest::least_scans`].
    #[must_use]
    pub const fn with_least_scans(self, least_scans: usize) -> Self {
        Self { least_scans, ..self }
    }
}

impl Default for FoldTest {
    /// One false alarm in a thousand, with edges that are rough by 0.02 mm and a pen that comes back within
    /// 0.014 mm: found by simulation (`cargo test --release --test all sim_fold:: -- --ignored --nocapture`).
    fn default() -> Self {
        Self { false_alarms: 1e-3, mean_mm: 0.025, common_mm: 0.012, each_mm: 0.033, least_scans: 5 }
    }
}

/// What the probe says.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum FoldVerdict {
    /// Both strokes lie on each other: go on.
    Flat {
        /// By how much the line has become wider, mm.
        wider_mm: f64,
    },
    /// They do not: stop, and fit the paper by hand.
    Fold {
        /// By how much the line has become wider, mm.
        wider_mm: f64,
        /// From where on that is a fold, mm.
        limit_mm: f64,
    },
    /// The line was seen too seldom to say.
    Unclear {
        /// How many scans saw it both times.
        scans: usize,
        /// How many would have to.
        least: usize,
    },
}

impl FoldTest {
    /// From where on a widening is a fold on paper as rough as expected, for the median of that many scans,
    /// mm; infinite without a scan.
    #[must_use]
    pub fn limit_mm(&self, scans: usize) -> f64 {
        /// √(π/2)
        const OF_MEDIAN: f64 = 1.253_314_137_315_500_3;
        #[expect(clippy::cast_precision_loss, reason = "at most 64 are looked at")]
        let count = scans as f64;
        let each_mm = OF_MEDIAN * self.each_mm;
        let sigma_mm = libm::sqrt(self.common_mm * self.common_mm + each_mm * each_mm / count);
        self.mean_mm + normal_quantile(self.false_alarms) * sigma_mm
    }

    /// The same for a paper on which the scans differ more than expected: its edges are rougher, so that a
    /// second stroke widens the line by more on average too. What is expected counts for as many scans as
    /// [`EXPECTED_SCANS`].
    fn rougher(&self, wider_mm: &[f64], middle_mm: f64) -> Self {
        let mut off_mm = [0.0; MOST_SCANS];
        let off_mm = off_mm.get_mut(..wider_mm.len()).unwrap_or_default();
        for (off_mm, wider_mm) in off_mm.iter_mut().zip(wider_mm) {
            *off_mm = libm::fabs(wider_mm - middle_mm);
        }
        off_mm.sort_unstable_by(f64::total_cmp);
        let seen_mm = OF_DEVIATION * off_mm.get(off_mm.len() / 2).copied().unwrap_or(0.0);
        #[expect(clippy::cast_precision_loss, reason = "at most 64 are looked at")]
        let count = wider_mm.len() as f64;
        let ratio = if self.each_mm > 0.0 { seen_mm / self.each_mm } else { 0.0 };
        let factor = libm::sqrt((EXPECTED_SCANS + count * ratio * ratio) / (EXPECTED_SCANS + count))
            .clamp(1.0, ROUGHEST);
        Self { mean_mm: self.mean_mm * factor, each_mm: self.each_mm * factor, ..*self }
    }

    /// What the scans over the first stroke and over both say; scan by scan, `None` where no line was seen.
    /// At most 64 are looked at.
    #[must_use]
    pub fn judge(&self, once: &[Option<Seen>], twice: &[Option<Seen>]) -> FoldVerdict {
        let mut wider = [0.0; MOST_SCANS];
        let mut count = 0;
        let both = once.iter().zip(twice).filter_map(|(once, twice)| Some(((*once)?, (*twice)?)));
        let changes = both.map(|(once, twice)| (twice.to_mm - twice.from_mm) - (once.to_mm - once.from_mm));
        for (slot, change) in wider.iter_mut().zip(changes.filter(|change| change.is_finite())) {
            *slot = change;
            count += 1;
        }
        let wider = wider.get_mut(..count).unwrap_or_default();
        wider.sort_unstable_by(f64::total_cmp);
        let middle = |index: usize| wider.get(index).copied();
        let pair = middle(count / 2).zip(middle(count.saturating_sub(1) / 2));
        let Some((high, low)) = pair.filter(|_| count >= self.least_scans) else {
            return FoldVerdict::Unclear { scans: count, least: self.least_scans };
        };
        let wider_mm = 0.5 * (high + low);
        let limit_mm = self.rougher(wider, wider_mm).limit_mm(count);
        if wider_mm > limit_mm {
            FoldVerdict::Fold { wider_mm, limit_mm }
        } else {
            FoldVerdict::Flat { wider_mm }
        }
    }
}

impl fmt::Display for FoldVerdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flat { wider_mm } => write!(f, "flat: both strokes within {wider_mm:.3} mm"),
            Self::Fold { wider_mm, limit_mm } => write!(
                f,
                "fold: the strokes lie {wider_mm:.3} mm apart, more than {limit_mm:.3} mm; fit the paper by hand"
            ),
            Self::Unclear { scans, least } => write!(
                f,
                "unclear: {scans} scans saw the probe, at least {least} are needed; look whether the pen writes"
            ),
        }
    }
}

/// What a normal number exceeds with the given probability, by halving the interval in which the
/// complementary error function has it.
fn normal_quantile(probability: f64) -> f64 {
    let (mut low, mut high) = (0.0, 38.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if 0.5 * libm::erfc(middle * core::f64::consts::FRAC_1_SQRT_2) > probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        assert!((normal_quantile(0.025) - 1.959_964).abs() < 1e-6);
        assert!((normal_quantile(0.001) - 3.090_232).abs() < 1e-6);
    }

    #[test]
    fn too_few_scans_say_nothing() {
        let seen = Some(Seen { from_mm: 0.0, to_mm: 0.9 });
        let verdict = FoldTest::default().judge(&[seen, None, seen], &[seen, seen, None]);
        assert_eq!(verdict, FoldVerdict::Unclear { scans: 1, least: 5 });
    }

    #[test]
    fn dust_in_a_few_scans_is_no_fold() {
        let mut twice = [Some(Seen { from_mm: 0.0, to_mm: 0.95 }); 9];
        for scan in &mut twice[..4] {
            *scan = Some(Seen { from_mm: -1.0, to_mm: 0.95 });
        }
        let once = [Some(Seen { from_mm: 0.0, to_mm: 0.9 }); 9];
        assert!(matches!(FoldTest::default().judge(&once, &twice), FoldVerdict::Flat { .. }));
    }
}
