//! [`Envelope`] and [`Tally`]: values over a time whose length is not known before, in a bounded number of
//! stretches.

use serde_json::{Value, json};

/// Stretches of time that are kept at most.
const MOST_BINS: usize = 2_048;

/// Equal stretches of time, twice as long whenever there would be too many.
#[derive(Clone, Debug)]
struct Bins<T> {
    origin_us: Option<u64>,
    width_us: u64,
    bins: Vec<Option<T>>,
}

impl<T: Copy> Bins<T> {
    const fn new() -> Self {
        Self { origin_us: None, width_us: 1, bins: Vec::new() }
    }

    /// The stretch of a time; one before the first time is put into the first stretch.
    fn at(&mut self, at_us: u64, join: impl Fn(T, T) -> T) -> Option<&mut Option<T>> {
        let origin_us = *self.origin_us.get_or_insert(at_us);
        let since_us = at_us.saturating_sub(origin_us);
        while since_us / self.width_us >= MOST_BINS as u64 {
            self.width_us = self.width_us.saturating_mul(2);
            self.bins =
                self.bins.chunks(2).map(|pair| pair.iter().copied().flatten().reduce(&join)).collect();
        }
        let index = usize::try_from(since_us / self.width_us).unwrap_or(usize::MAX);
        if index >= self.bins.len() {
            self.bins.resize(index.saturating_add(1), None);
        }
        self.bins.get_mut(index)
    }
}

/// Least and greatest value in each stretch of time.
#[derive(Clone, Debug)]
pub(super) struct Envelope(Bins<(f64, f64)>);

impl Envelope {
    pub(super) const fn new() -> Self {
        Self(Bins::new())
    }

    pub(super) fn push(&mut self, at_us: u64, value: f64) {
        if !value.is_finite() {
            return;
        }
        let join = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1));
        if let Some(bin) = self.0.at(at_us, join) {
            let new = (value, value);
            *bin = Some(bin.map_or(new, |old| join(old, new)));
        }
    }

    /// Start, width (us), and for each stretch the least and the greatest value in `unit`, as whole numbers.
    pub(super) fn to_json(&self, unit: f64) -> Value {
        let side = |pick: fn((f64, f64)) -> f64| -> Vec<Value> {
            self.0
                .bins
                .iter()
                .map(|bin| bin.map_or(Value::Null, |bin| json!(whole(pick(bin) / unit))))
                .collect()
        };
        json!({
            "from_us": self.0.origin_us.unwrap_or(0), "width_us": self.0.width_us, "unit": unit,
            "low": side(|bin| bin.0), "high": side(|bin| bin.1),
        })
    }
}

/// How many in each stretch of time.
#[derive(Clone, Debug)]
pub(super) struct Tally(Bins<u64>);

impl Tally {
    pub(super) const fn new() -> Self {
        Self(Bins::new())
    }

    pub(super) fn push(&mut self, at_us: u64, count: u64) {
        if let Some(bin) = self.0.at(at_us, u64::saturating_add) {
            *bin = Some(bin.unwrap_or(0).saturating_add(count));
        }
    }

    /// How many a second in each stretch, as [`Envelope::to_json`] has values. Stretches shorter than
    /// `least_us` are taken together: a rate needs a time over which it is one.
    pub(super) fn to_json(&self, least_us: u64) -> Value {
        let group = usize::try_from(least_us.div_ceil(self.0.width_us)).unwrap_or(1).max(1);
        let width_us = self.0.width_us.saturating_mul(group as u64);
        let rates: Vec<_> = self
            .0
            .bins
            .chunks(group)
            .map(|bins| {
                let count = bins.iter().flatten().fold(0_u64, |sum, &count| sum.saturating_add(count));
                let rate = u128::from(count) * 1_000_000 / u128::from(width_us);
                u64::try_from(rate).unwrap_or(u64::MAX)
            })
            .collect();
        json!({
            "from_us": self.0.origin_us.unwrap_or(0), "width_us": width_us, "unit": 1,
            "low": rates, "high": rates,
        })
    }
}

/// To the nearest whole number.
pub(super) fn whole(value: f64) -> i64 {
    #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
    let whole = libm::round(value) as i64;
    whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_time_has_few_stretches_and_keeps_its_peak() {
        let mut envelope = Envelope::new();
        for n in 0..1_000_000_u64 {
            envelope.push(5_000 + n * 37, if n == 123_456 { 9.0 } else { 1.0 });
        }
        let Bins { origin_us, width_us, ref bins } = envelope.0;
        assert_eq!(origin_us, Some(5_000));
        assert!(bins.len() <= MOST_BINS && width_us * bins.len() as u64 >= 37 * 999_999);
        let peak = usize::try_from(123_456 * 37 / width_us).unwrap();
        assert_eq!(bins[peak], Some((1.0, 9.0)));
        assert_eq!(bins.iter().flatten().filter(|bin| bin.1 > 1.0).count(), 1);
    }

    #[test]
    fn a_rate_is_counts_by_time() {
        let mut tally = Tally::new();
        (0..50_000).for_each(|n| tally.push(n * 100, 1)); // 10000 a second for 5 s
        let json = tally.to_json(10_000);
        let rates: Vec<_> = json["high"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).collect();
        let inner = &rates[..rates.len() - 1]; // the last one may be cut
        assert!(inner.iter().all(|rate| (9_900..=10_100).contains(rate)), "{inner:?}");
    }

    #[test]
    fn times_at_the_end_of_the_world_do_no_harm() {
        let mut tally = Tally::new();
        tally.push(7, 1);
        tally.push(u64::MAX, 1);
        tally.push(3, 1);
        assert!(tally.0.bins.len() <= MOST_BINS);
        assert_eq!(tally.0.bins.iter().flatten().sum::<u64>(), 3);
    }
}
