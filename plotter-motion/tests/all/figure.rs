//! The worst value of a figure that tests hold to a bound: told, so that `.ci/faults` can write today's
//! beside the bound.

use std::sync::atomic::{AtomicU64, Ordering};

/// The greatest value so far, not negative, and its unit.
pub(crate) struct Figure {
    bits: AtomicU64,
    unit: &'static str,
}

impl Figure {
    pub(crate) const fn of(unit: &'static str) -> Self {
        Self { bits: AtomicU64::new(0), unit }
    }

    /// Notes a value that is not negative, and prints it if it is the greatest: the last line with this unit
    /// is the worst of all.
    pub(crate) fn note(&self, value: f64) {
        // Numbers that are not negative are in the order of their bits.
        let bits = value.to_bits();
        if bits > self.bits.fetch_max(bits, Ordering::Relaxed) {
            println!("figure: {value:.5} {}", self.unit);
        }
    }
}
