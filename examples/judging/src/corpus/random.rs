//! Reproducible noise.

/// A stream of random numbers: `SplitMix64`.
///
/// Source: Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014, fig. 17.
#[derive(Debug)]
pub(crate) struct Random {
    state: u64,
}

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    pub(crate) fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Evenly from 0, included, to 1, excluded.
    pub(crate) fn unit(&mut self) -> f64 {
        let high = u32::try_from(self.bits() >> 32).unwrap_or(0);
        f64::from(high) / 4_294_967_296.0
    }

    /// Evenly from `low`, included, to `high`, excluded.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A whole number below `count`, which is not 0. (Of 2^64 numbers the last few are not shared out evenly;
    /// counts here are small.)
    pub(crate) fn below(&mut self, count: u32) -> u32 {
        u32::try_from(self.bits() % u64::from(count.max(1))).unwrap_or(0)
    }

    /// True with this probability.
    pub(crate) fn chance(&mut self, share: f64) -> bool {
        self.unit() < share
    }

    /// One of several.
    pub(crate) fn pick<'a, T>(&mut self, several: &'a [T]) -> Option<&'a T> {
        let count = u32::try_from(several.len()).unwrap_or(u32::MAX);
        several.get(usize::try_from(self.below(count)).unwrap_or(0))
    }

    /// Normally distributed with mean 0 and variance 1 (Box and Muller 1958).
    pub(crate) fn normal(&mut self) -> f64 {
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - self.unit()));
        radius * libm::cos(core::f64::consts::TAU * self.unit())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_number_is_the_published_one() {
        // Reference output of `SplitMix64` for the seed 0.
        assert_eq!(Random::new(0).bits(), 0xE220_A839_7B1D_CDAF);
    }

    #[test]
    fn normal_numbers_have_the_variance_one() {
        let mut random = Random::new(1);
        let squares: f64 = (0..10_000).map(|_| libm::pow(random.normal(), 2.0)).sum();
        // The standard deviation of the mean is sqrt(2 / 10 000) = 0.014.
        assert!((squares / 10_000.0 - 1.0).abs() < 0.05);
    }
}
