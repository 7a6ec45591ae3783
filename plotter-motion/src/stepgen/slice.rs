//! [`Slice`]: a short time of a phase in whole numbers.

use crate::Phase;
use crate::extremes::{greater, smaller};
use crate::planner::Modes;
use crate::whole::{float, nearest_even, whole};

/// Bits of the fraction of a distance in mm.
pub(super) const FRACTION_BITS: u32 = 32;
/// Bits of the fraction of the speed in mm a tick, of half the acceleration, and of a sixth of the jerk.
const SPEED_BITS: u32 = 52;
const ACCEL_BITS: u32 = 72;
const JERK_BITS: u32 = 84;
/// Longest slice, ticks: with it no product leaves 128 bits, and what the roundings make stays below 10⁻⁹ mm.
const LONGEST_TICKS: i64 = 1 << 20;
/// A guess that is farther off than this is refined, ticks.
const NEAR_TICKS: i64 = 4;
/// Slowest speed at which Newton's method is trusted without a bracket: 0.1 mm/s at a clock of 1 MHz.
const TRUSTED_SPEED: i64 = (1 << SPEED_BITS) / 10_000_000;
/// Most halvings until a slice of the longest is one tick.
const MOST_HALVINGS: u32 = 24;

/// A short time of a phase: the distance along the course as a polynomial of the ticks, in whole numbers.
///
/// ```text
/// s(t) = s₀ + t (v + t (a/2 + t j/6))        32, 52, 72 and 84 bits of fraction
/// ```
///
/// t counts whole ticks of the clock from [`Slice::base`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Slice {
    /// The tick from which it counts.
    pub(super) base: u64,
    /// Last tick of it, from the base.
    pub(super) last: i64,
    start: i64,
    speed: i64,
    half_accel: i64,
    sixth_jerk: i64,
}

impl Slice {
    /// The slice of `phase` from `time_ticks` after its start on. The phase starts `offset_ticks` (0 to 1) after the tick
    /// `phase_base`. Gives the ticks that the slice lasts, too.
    pub(super) fn new<M: Modes>(
        phase: &Phase,
        clock_hz: f64,
        phase_base: u64,
        offset_ticks: f64,
        time_ticks: f64,
    ) -> (Self, f64) {
        let duration_ticks = phase.duration_s * clock_hz;
        let rest_ticks = greater(duration_ticks - time_ticks, 0.0);
        // The slice's first tick is the last one that is not after its begin.
        let begin = offset_ticks + time_ticks;
        let first = whole(begin);
        let lasts_ticks = smaller(rest_ticks, float(LONGEST_TICKS) - 1.0);
        let at = phase.at_with::<M>((float(first) - offset_ticks) / clock_hz);
        let per_tick = 1.0 / clock_hz;
        let base = phase_base.saturating_add_signed(first);
        let last = whole(begin - float(first) + lasts_ticks);
        let slice = Self {
            base,
            last,
            start: fixed(at.distance_mm, FRACTION_BITS),
            speed: fixed(at.speed_mm_s * per_tick, SPEED_BITS),
            half_accel: fixed(at.accel_mm_s2 * per_tick * per_tick / 2.0, ACCEL_BITS),
            sixth_jerk: if M::ALL {
                fixed(phase.jerk_mm_s3 * per_tick * per_tick * per_tick / 6.0, JERK_BITS)
            } else {
                0
            },
        };
        (slice, lasts_ticks)
    }

    /// Distance along the course at a tick, 32 bits of fraction.
    pub(super) fn distance<M: Modes>(&self, t: i64) -> i64 {
        let accel = if M::ALL {
            product(self.sixth_jerk, t, JERK_BITS - ACCEL_BITS).saturating_add(self.half_accel)
        } else {
            self.half_accel
        };
        let speed = product(accel, t, ACCEL_BITS - SPEED_BITS).saturating_add(self.speed);
        product(speed, t, SPEED_BITS - FRACTION_BITS).saturating_add(self.start)
    }

    /// Speed at a tick, mm a tick, 52 bits of fraction.
    pub(super) fn speed<M: Modes>(&self, t: i64) -> i64 {
        let twice = self.half_accel.saturating_mul(2);
        let accel = if M::ALL {
            product(self.sixth_jerk.saturating_mul(3), t, JERK_BITS - ACCEL_BITS).saturating_add(twice)
        } else {
            twice
        };
        product(accel, t, ACCEL_BITS - SPEED_BITS).saturating_add(self.speed)
    }

    /// The tick nearest to the time at which the distance is `target`; `None` if that is after the slice. `from` is a tick at
    /// which it has not been reached, `guess` one near to where it may be.
    pub(super) fn tick_of<M: Modes>(&self, target: i64, from: i64, guess: i64) -> Option<i64> {
        // Most guesses are good: the steps before say when the next is due.
        let mut at = guess.min(self.last).max(from);
        for _ in 0..3 {
            let speed = self.speed::<M>(at);
            if speed < TRUSTED_SPEED {
                break;
            }
            let ahead = target.saturating_sub(self.distance::<M>(at));
            if ahead.unsigned_abs() >= 1 << 34 {
                break;
            }
            // In quarters of a tick, then to nearest.
            let quarters = (ahead << 22).checked_div(speed).unwrap_or_default();
            let next = at + ((quarters + 2) >> 2);
            if (next - at).abs() <= NEAR_TICKS {
                return (next <= self.last).then_some(next.max(from));
            }
            if next < from || next > self.last {
                break;
            }
            at = next;
        }
        self.halve::<M>(target, from)
    }

    /// As [`Slice::tick_of`], by halving the time.
    fn halve<M: Modes>(&self, target: i64, from: i64) -> Option<i64> {
        if self.distance::<M>(self.last) < target {
            return None;
        }
        let (mut before, mut after) = (from, self.last);
        for _ in 0..MOST_HALVINGS {
            if after - before <= 1 {
                break;
            }
            let middle = before + (after - before) / 2;
            if self.distance::<M>(middle) >= target {
                after = middle;
            } else {
                before = middle;
            }
        }
        let early = target - self.distance::<M>(before) < self.distance::<M>(after) - target;
        Some(if early { before } else { after })
    }
}

/// The product of a fixed point number and ticks, with `bits` less of fraction.
fn product(number: i64, ticks: i64, bits: u32) -> i64 {
    #[expect(clippy::cast_possible_truncation, reason = "numbers of this size are far from any machine")]
    let shifted = ((i128::from(number) * i128::from(ticks)) >> bits) as i64;
    shifted
}

/// To the nearest with so many bits of fraction; saturates.
pub(super) fn fixed(value: f64, bits: u32) -> i64 {
    nearest_even(value * power_of_two(bits))
}

/// 2^bits, exactly.
const fn power_of_two(bits: u32) -> f64 {
    const BIAS: u64 = 1023;
    f64::from_bits((BIAS + bits as u64) << 52)
}

/// A speed in mm a tick as a slice has it.
pub(super) fn speed_fixed(mm_per_tick: f64) -> i64 {
    fixed(mm_per_tick, SPEED_BITS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planner::AllModes;

    const CLOCK_HZ: f64 = 1e6;

    fn start(phase: Phase) -> Slice {
        Slice::new::<AllModes>(&phase, CLOCK_HZ, 1000, 0.25, 0.0).0
    }

    #[test]
    fn speeding_up_from_rest_reaches_a_millimetre_when_it_should() {
        // t = sqrt(2 s / a) = sqrt(2 / 1000) s = 44721.36 us, and a quarter of a tick later by the clock
        let phase = Phase { duration_s: 0.1, accel_mm_s2: 1000.0, ..Phase::default() };
        let slice = start(phase);
        let millimetre = 1 << FRACTION_BITS;
        assert_eq!(slice.tick_of::<AllModes>(millimetre, 0, 0), Some(44_722));
        assert_eq!(slice.tick_of::<AllModes>(millimetre, 0, 44_700), Some(44_722));
        assert_eq!(slice.tick_of::<AllModes>(6 * millimetre, 0, 0), None); // it goes only 5 mm
    }

    #[test]
    fn a_steady_speed_steps_at_the_nearest_tick() {
        let phase = Phase { duration_s: 1.0, speed_mm_s: 30.0, ..Phase::default() };
        let slice = start(phase);
        for step in 1..100_i64 {
            // every 0.01 mm: every 333.33 us
            let tick = slice.tick_of::<AllModes>(fixed(0.01, FRACTION_BITS) * step, 0, 333 * step).unwrap();
            let meant = float(step) * 1e4 / 30.0 + 0.25;
            assert!((float(tick) - meant).abs() <= 0.51, "step {step}: {tick} for {meant}");
        }
    }
}
