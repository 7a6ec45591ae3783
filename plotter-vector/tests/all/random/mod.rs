//! A small generator of numbers: the same on each run.

/// Marsaglia's xorshift (2003).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// A number from 0 to 1.
    #[allow(clippy::cast_precision_loss, reason = "53 bits")]
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}
