//! [`Moment`]: the time as a step generator counts it.

use super::slice::{PART_BITS, parts_of};
use core::time::Duration;

/// Nanoseconds in a second.
const NANOS: u64 = 1_000_000_000;
/// 2^32 / 10⁹, with 31 bits of fraction.
const PARTS_PER_NANO: u64 = 9_223_372_037;

/// A time since the start: whole ticks of the clock, and the part of one, in 2^32ths. So times add up without
/// error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Moment {
    pub(super) tick: u64,
    pub(super) part: u32,
}

impl Moment {
    /// The end of a phase that begins now, and how many ticks it is from that in which it begins.
    pub(super) fn after_phase(self, duration_s: f32, clock_hz: u32) -> (Self, i64) {
        let parts = parts_of(duration_s, clock_hz).saturating_add(self.part.into());
        let ticks = parts >> PART_BITS;
        (Self { tick: self.tick.saturating_add_signed(ticks), part: low(parts.cast_unsigned()) }, ticks)
    }

    /// The end of so many phases of one length.
    pub(super) fn after_phases(self, duration_s: f32, count: u32, clock_hz: u32) -> Self {
        if count == 1 {
            return self.after_phase(duration_s, clock_hz).0;
        }
        let one = u128::from(parts_of(duration_s, clock_hz).unsigned_abs());
        let parts = one * u128::from(count) + u128::from(self.part);
        let ticks = u64::try_from(parts >> PART_BITS).unwrap_or(u64::MAX);
        #[expect(clippy::cast_possible_truncation, reason = "what is less than a tick")]
        let part = parts as u32;
        Self { tick: self.tick.saturating_add(ticks), part }
    }

    /// The end of a standstill that begins now.
    pub(super) fn after(self, duration: Duration, clock_hz: u32) -> Self {
        let clock_hz = u64::from(clock_hz);
        let nanos = u64::from(duration.subsec_nanos()) * clock_hz;
        let (ticks, rest) = (nanos / NANOS, nanos % NANOS);
        // rest · 2^32 / 10⁹
        let parts = u64::from(self.part) + ((rest * PARTS_PER_NANO) >> 31);
        let seconds = u64::from(u32::try_from(duration.as_secs()).unwrap_or(u32::MAX));
        let tick = self.tick.saturating_add(seconds * clock_hz + ticks + (parts >> PART_BITS));
        Self { tick, part: low(parts) }
    }
}

/// The lower half: what is less than a tick.
fn low(parts: u64) -> u32 {
    #[expect(clippy::cast_possible_truncation, reason = "that is meant")]
    let low = parts as u32;
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_phases_end_where_they_do_one_by_one() {
        for duration_s in [3e-7, 0.046_875, 0.012_345_678, 1e-9] {
            for clock_hz in [1000, 1_000_000, 1_000_000_000] {
                let begin = Moment { tick: 7, part: 1 << 31 };
                let one_by_one = (0..1000).fold(begin, |now, _| now.after_phase(duration_s, clock_hz).0);
                assert_eq!(begin.after_phases(duration_s, 1000, clock_hz), one_by_one, "{duration_s} s");
            }
        }
    }
}
