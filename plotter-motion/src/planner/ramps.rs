//! [`Ramps`]: the phases of a block with constant accelerations.

use super::Phase;
use super::block::Block;

/// Speeding up, cruising, braking: what is left of the phases of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ramps {
    entry: f64,
    peak: f64,
    exit: f64,
    up_mm: f64,
    down_mm: f64,
    length_mm: f64,
    /// How many phases have been taken.
    taken: u8,
}

/// How many phases there are.
const PHASES: u8 = 3;

impl Default for Ramps {
    /// Nothing left.
    fn default() -> Self {
        Self { entry: 0.0, peak: 0.0, exit: 0.0, up_mm: 0.0, down_mm: 0.0, length_mm: 0.0, taken: PHASES }
    }
}

impl Ramps {
    /// The quickest way along a block that leaves it with the given square of a speed.
    pub(super) fn new(block: &Block, exit2: f64, accel_mm_s2: f64) -> Self {
        let (entry2, cruise2, length_mm) =
            (f64::from(block.entry2), f64::from(block.cruise2), block.length());
        if !(block.is_path() && length_mm > 0.0 && cruise2 > 0.0) {
            return Self::default();
        }
        // Where speeding up and braking meet.
        let peak2 = (0.5 * (entry2 + exit2) + accel_mm_s2 * length_mm).min(cruise2).max(entry2).max(exit2);
        let up_mm = ((peak2 - entry2) / (2.0 * accel_mm_s2)).min(length_mm);
        let down_mm = ((peak2 - exit2) / (2.0 * accel_mm_s2)).min(length_mm - up_mm);
        let (entry, peak, exit) = (libm::sqrt(entry2), libm::sqrt(peak2), libm::sqrt(exit2));
        Self { entry, peak, exit, up_mm, down_mm, length_mm, taken: 0 }
    }

    pub(super) const fn is_over(&self) -> bool {
        self.taken >= PHASES
    }

    /// The next phase.
    pub(super) fn next(&mut self) -> Option<Phase> {
        let Self { entry, peak, exit, up_mm, down_mm, length_mm, .. } = *self;
        while !self.is_over() {
            let (from_mm, way_mm, from, to) = match self.taken {
                0 => (0.0, up_mm, entry, peak),
                1 => (up_mm, length_mm - up_mm - down_mm, peak, peak),
                _ => (length_mm - down_mm, down_mm, peak, exit),
            };
            self.taken += 1;
            if way_mm > 0.0 && from + to > 0.0 {
                let duration_s = 2.0 * way_mm / (from + to);
                let accel_mm_s2 = (to - from) / duration_s;
                return Some(Phase { duration_s, from_mm, speed_mm_s: from, accel_mm_s2, jerk_mm_s3: 0.0 });
            }
        }
        None
    }
}
