//! [`SplitMix64`]: numbers that look random and are the same everywhere.

/// A row of numbers that its seed decides: for simulated faults, noise and searches, not for secrets.
///
/// Source: G. L. Steele, D. Lea, C. H. Flood, "Fast splittable pseudorandom number generators" (2014),
/// section 5; the constants are those of its figure 17.
///
/// ```
/// # use plotter_motion::SplitMix64;
/// let mut random = SplitMix64::new(0);
/// assert_eq!(random.bits(), 0xe220_a839_7b1d_cdaf); // as every implementation has it
/// assert!((0.0..1.0).contains(&random.unit()) && random.below(6) < 6);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SplitMix64(u64);

/// 2^64 divided by the golden ratio, made odd: added to the state for each number.
const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

impl SplitMix64 {
    /// The row of a seed; any is a good one.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The row of a seed from its number `index` on, of which the first is 0.
    #[must_use]
    pub const fn from_index(seed: u64, index: u64) -> Self {
        Self(seed.wrapping_add(index.wrapping_mul(STEP)))
    }

    /// The next number: 64 bits, each as often 1 as 0.
    #[must_use = "each call draws another number"]
    pub const fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(STEP);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// Evenly spread from 0 up to, but without, 1.
    #[must_use = "each call draws another number"]
    pub const fn unit(&mut self) -> f64 {
        const BITS: u32 = f64::MANTISSA_DIGITS;
        #[expect(clippy::cast_precision_loss, reason = "as many bits as a float has")]
        let share = (self.bits() >> (u64::BITS - BITS)) as f64 / (1_u64 << BITS) as f64;
        share
    }

    /// A number below `limit`; 0 if that is 0.
    #[must_use = "each call draws another number"]
    pub fn below(&mut self, limit: usize) -> usize {
        // The upper half of the product is evenly spread enough, and always below the limit.
        usize::try_from((u128::from(self.bits()) * limit as u128) >> u64::BITS).unwrap_or(0)
    }
}
