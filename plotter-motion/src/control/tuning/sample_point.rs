//! [`SamplePoint`]: a place on the unit circle, which is a frequency of a sampled loop.

use super::Complex;

/// `z = e^(j w h)` for an angular frequency w and the time h between two runs, with what all formulas take of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SamplePoint {
    pub(super) tick_s: f64,
    /// w h, rad.
    pub(super) angle_rad: f64,
    /// `z^-1`, the delay by a tick.
    pub(super) delay: Complex,
    /// `1 - z^-1`, with all its digits at low frequencies.
    pub(super) one_less_delay: Complex,
}

impl SamplePoint {
    pub(super) fn new(rad_s: f64, tick_s: f64) -> Self {
        let angle_rad = rad_s * tick_s;
        let half = libm::sin(0.5 * angle_rad);
        let one_less_delay = Complex { re: 2.0 * half * half, im: libm::sin(angle_rad) };
        Self { tick_s, angle_rad, delay: Complex::ONE - one_less_delay, one_less_delay }
    }
}
