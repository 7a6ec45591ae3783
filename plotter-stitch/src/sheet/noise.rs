//! Random numbers that are the same everywhere.

use plotter_motion::SplitMix64;

/// Noise of a seed, any of which is a good one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Noise {
    random: SplitMix64,
}

impl Noise {
    pub(crate) const fn new(seed: u64) -> Self {
        Self { random: SplitMix64::new(seed) }
    }

    pub(crate) fn bits(&mut self) -> u64 {
        self.random.bits()
    }

    /// Evenly spread from 0 up to but without 1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.random.unit()
    }

    /// Evenly spread between two numbers.
    pub(crate) fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.unit()
    }

    /// Two independent normal numbers with that standard deviation (Marsaglia's polar method).
    pub(crate) fn normals(&mut self, sigma: f64) -> [f64; 2] {
        if sigma <= 0.0 {
            return [0.0; 2];
        }
        // A place in the unit disc: one try in five lies outside, so a thousand tries always end.
        for _ in 0..1000 {
            let (x, y) = (self.between(-1.0, 1.0), self.between(-1.0, 1.0));
            let square = x * x + y * y;
            if square > 0.0 && square < 1.0 {
                let scale = sigma * libm::sqrt(-2.0 * libm::log(square) / square);
                return [x * scale, y * scale];
            }
        }
        [0.0; 2]
    }
}

#[cfg(test)]
mod tests {
    use super::Noise;

    #[test]
    fn normal_numbers_have_the_asked_deviation_and_no_bias() {
        let mut noise = Noise::new(1);
        let values: std::vec::Vec<f64> = (0..50_000).flat_map(|_| noise.normals(0.02)).collect();
        let mean = values.iter().sum::<f64>() / 1e5;
        let sigma = (values.iter().map(|v| v * v).sum::<f64>() / 1e5).sqrt();
        // Four standard deviations of the mean and of the deviation of 100,000 numbers.
        assert!(mean.abs() < 4.0 * 0.02 / 1e5_f64.sqrt(), "{mean}");
        assert!((sigma / 0.02 - 1.0).abs() < 4.0 / 2e5_f64.sqrt(), "{sigma}");
    }
}
