//! Fewer samples for a picture, with every peak.

use super::Sample;
use core::time::Duration;

/// Stretches that the time is cut into; about a pixel each.
const BINS: u128 = 800;
/// First, least, greatest and last of each stretch.
pub(super) const MOST_SAMPLES: usize = 4 * 801;

/// Keeps at most four samples of each of 800 stretches of time.
pub(super) struct Decimator {
    from: Duration,
    span_ns: u128,
    kept: Vec<Sample>,
    bin: Option<Bin>,
}

struct Bin {
    index: u128,
    first: Sample,
    least: Sample,
    greatest: Sample,
    last: Sample,
}

impl Decimator {
    pub(super) fn new(from: Duration, to: Duration) -> Self {
        let span_ns = to.saturating_sub(from).as_nanos().max(1);
        Self { from, span_ns, kept: Vec::new(), bin: None }
    }

    pub(super) fn push(&mut self, sample: Sample) {
        let (time, value) = sample;
        if !value.is_finite() {
            return;
        }
        let since_ns = time.saturating_sub(self.from).as_nanos().min(self.span_ns);
        let index = since_ns.saturating_mul(BINS).checked_div(self.span_ns).unwrap_or(0);
        match &mut self.bin {
            // A sample before its time goes to the stretch that is open.
            Some(bin) if index <= bin.index => {
                if value < bin.least.1 {
                    bin.least = sample;
                }
                if value > bin.greatest.1 {
                    bin.greatest = sample;
                }
                bin.last = sample;
            }
            _ => {
                self.close();
                self.bin = Some(Bin { index, first: sample, least: sample, greatest: sample, last: sample });
            }
        }
    }

    pub(super) fn finish(mut self) -> Vec<Sample> {
        self.close();
        self.kept
    }

    fn close(&mut self) {
        if let Some(Bin { first, least, greatest, last, .. }) = self.bin.take() {
            let (one, other) = if least.0 <= greatest.0 { (least, greatest) } else { (greatest, least) };
            for sample in [first, one, other, last] {
                if self.kept.last() != Some(&sample) {
                    self.kept.push(sample);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const US: Duration = Duration::from_micros(1);

    #[test]
    fn a_million_samples_become_few_and_keep_the_peak() {
        let mut decimator = Decimator::new(Duration::ZERO, US * 1_000_000);
        for n in 0..=1_000_000_u32 {
            let peak = if n == 123_456 { 9.0 } else { 0.0 };
            decimator.push((US * n, peak + f64::from(n) * 1e-6));
        }
        let kept = decimator.finish();
        assert!(kept.len() <= MOST_SAMPLES, "{}", kept.len());
        assert!(kept.contains(&(US * 123_456, 9.123_456)));
        assert_eq!(kept.first(), Some(&(Duration::ZERO, 0.0)));
        assert_eq!(kept.last(), Some(&(US * 1_000_000, 1.0)));
        assert!(kept.is_sorted_by_key(|&(time, _)| time));
    }

    #[test]
    fn few_samples_all_stay() {
        let samples = [(US, 1.0), (US * 50, 2.0), (US * 99, -1.0)];
        let mut decimator = Decimator::new(Duration::ZERO, US * 100);
        samples.into_iter().for_each(|sample| decimator.push(sample));
        decimator.push((US * 99, f64::NAN));
        assert_eq!(decimator.finish(), samples);
    }
}
