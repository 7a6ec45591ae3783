//! Ticks at round values.

/// A stretch of an axis that begins and ends at a tick.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scale {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) ticks: Vec<f64>,
    /// Decimals that tell the ticks apart.
    pub(super) decimals: usize,
}

impl Scale {
    /// A scale over `low` to `high` with about `count` ticks, 1, 2 or 5 times a power of ten apart, the ends
    /// widened to the next tick; a stretch without length is widened to one of 1.
    pub(super) fn over(low: f64, high: f64, count: f64) -> Self {
        let (low, high) = if high > low { (low, high) } else { (low - 0.5, low + 0.5) };
        let step = step(low, high, count);
        let (first, last) = (libm::floor(low / step.size), libm::ceil(high / step.size));
        let ticks = step.ticks(first, last);
        Self { low: first * step.size, high: last * step.size, ticks, decimals: step.decimals }
    }

    /// The same without widening: ticks only inside.
    pub(super) fn within(low: f64, high: f64, count: f64) -> Self {
        let high = if high > low { high } else { low + 1e-3 };
        let step = step(low, high, count);
        let ticks = step.ticks(libm::ceil(low / step.size), libm::floor(high / step.size));
        Self { low, high, ticks, decimals: step.decimals }
    }

    /// Where `value` lies: 0 at the low end, 1 at the high one.
    pub(super) fn share(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }
}

struct Step {
    size: f64,
    decimals: usize,
}

impl Step {
    fn ticks(&self, first: f64, last: f64) -> Vec<f64> {
        // Bounded whatever rounding does to the ends.
        let mut ticks = Vec::new();
        let mut n = first;
        while n <= last && ticks.len() < 50 {
            ticks.push(n * self.size);
            n += 1.0;
        }
        ticks
    }
}

fn step(low: f64, high: f64, count: f64) -> Step {
    // Not finer than what the numbers can tell apart.
    let rough = ((high - low) / count).max((low.abs().max(high.abs())) * 1e-12).max(1e-300);
    let exponent = libm::floor(libm::log10(rough));
    let power = libm::pow(10.0, exponent);
    let size = [1.0, 2.0, 5.0].into_iter().map(|n| n * power).find(|&size| size >= rough * 0.999);
    let (size, exponent) = size.map_or((10.0 * power, exponent + 1.0), |size| (size, exponent));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a float cast saturates, and a label has at most 9 decimals"
    )]
    let decimals = (-exponent).clamp(0.0, 9.0) as usize;
    Step { size, decimals }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::plain;

    fn labels(scale: &Scale) -> Vec<String> {
        scale.ticks.iter().map(|&tick| plain(tick, scale.decimals)).collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(labels(&Scale::over(0.3, 9.6, 5.0)), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(labels(&Scale::over(-0.02, 0.04, 3.0)), ["-0.02", "0", "0.02", "0.04"]);
        assert_eq!(labels(&Scale::within(1.0, 3.15, 5.0)), ["1", "1.5", "2", "2.5", "3"]);
        assert_eq!(
            labels(&Scale::over(99_000.0, 101_000.0, 4.0)),
            ["99000", "99500", "100000", "100500", "101000"]
        );
    }

    #[test]
    fn a_stretch_without_length_still_has_ticks() {
        assert!(Scale::over(7.0, 7.0, 5.0).ticks.len() >= 2);
        assert!(Scale::within(0.0, 0.0, 5.0).ticks.len() >= 2);
        assert!(Scale::over(1e300, 1e300, 5.0).ticks.len() < 60);
    }
}
