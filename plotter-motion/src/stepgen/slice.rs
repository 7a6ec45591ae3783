//! [`Slice`]: a short time of a phase in whole numbers.

use crate::planner::Modes;
use crate::planner::Phase;

/// Bits of the fraction of a distance in mm.
pub(super) const FRACTION_BITS: u32 = 32;
/// Bits of the fraction of the speed in mm a tick, of half the acceleration, and of a sixth of the jerk.
const SPEED_BITS: u32 = 52;
const ACCEL_BITS: u32 = 72;
const JERK_BITS: u32 = 84;
/// Parts of a tick, and their bits.
const PARTS: f32 = 4_294_967_296.0;
pub(super) const PART_BITS: u32 = 32;
/// Longest slice, ticks: with it no product leaves 128 bits, and what the roundings make stays below 10⁻⁹ mm.
const LONGEST_TICKS: i64 = (1 << 20) - 1;
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
    /// The first slice of `phase`, which starts a part of a tick after `tick`, in 2^32ths, and ends in the
    /// tick `ticks` after that.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn new<M: Modes>(
        phase: &Phase,
        seconds_per_tick: f32,
        (tick, part): (u64, u32),
        ticks: i64,
    ) -> Self {
        let dt = seconds_per_tick;
        #[expect(clippy::cast_precision_loss, reason = "a 2^24th of a tick is enough")]
        let t = -(part as f32 / PARTS) * dt;
        let accel = phase.accel_mm_s2 + if M::ALL { t * phase.jerk_mm_s3 } else { 0.0 };
        Self {
            base: tick,
            last: ticks.min(LONGEST_TICKS),
            start: fixed(phase.from_mm, FRACTION_BITS)
                .saturating_add(fixed(phase.way_mm::<M>(t), FRACTION_BITS)),
            speed: fixed(phase.speed_at::<M>(t) * dt, SPEED_BITS),
            half_accel: fixed(accel * dt * dt * 0.5, ACCEL_BITS),
            sixth_jerk: if M::ALL { fixed(phase.jerk_mm_s3 * dt * dt * dt / 6.0, JERK_BITS) } else { 0 },
        }
    }

    /// The slice after this one, of a phase that goes on for so many ticks from here.
    pub(super) fn following<M: Modes>(&self, ticks: i64) -> Self {
        let thrice = if M::ALL {
            product(self.sixth_jerk.saturating_mul(3), self.last, JERK_BITS - ACCEL_BITS)
        } else {
            0
        };
        Self {
            base: self.base.saturating_add_signed(self.last),
            last: ticks.min(LONGEST_TICKS),
            start: self.distance::<M>(self.last),
            speed: self.speed::<M>(self.last),
            half_accel: self.half_accel.saturating_add(thrice),
            ..*self
        }
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

    /// The tick nearest to the time at which the distance is `target`; `None` if that is after the slice.
    /// `from` is a tick at which it has not been reached, `guess` one near to where it may be.
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

/// A time in 2^32ths of a tick, which is cut off at 2^31 ticks: half an hour of microseconds.
pub(super) fn parts_of(duration_s: f32, clock_hz: u32) -> i64 {
    times(duration_s, clock_hz, PART_BITS)
}

/// As a whole number with so many bits of fraction, from 0 to 90: cut off below the last of them, saturating.
pub(super) fn fixed(value: f32, bits: u32) -> i64 {
    times(value, 1, bits)
}

/// So many times the value, as [`fixed`].
#[cfg_attr(target_os = "none", inline(never))]
fn times(value: f32, factor: u32, bits: u32) -> i64 {
    /// Exponent of the last bit of the least number, with its sign.
    const LEAST: u32 = 149;
    const MANTISSA: u32 = 0x7f_ffff;
    let raw = value.to_bits();
    let (exponent, mantissa) = (raw >> 23 & 0xff, raw & MANTISSA);
    let (exponent, mantissa) =
        if exponent == 0 { (1, mantissa) } else { (exponent, mantissa | (MANTISSA + 1)) };
    // It is product · 2^(exponent − 1 − LEAST).
    let product = u64::from(mantissa) * u64::from(factor);
    let up = exponent + bits;
    let magnitude = match up.checked_sub(LEAST + 1) {
        Some(up) if up < product.leading_zeros() => product << up,
        Some(_) => u64::MAX,
        None => product.checked_shr(LEAST + 1 - up).unwrap_or(0),
    };
    let magnitude = i64::try_from(magnitude).unwrap_or(i64::MAX);
    if value < 0.0 { -magnitude } else { magnitude }
}

/// A speed in mm a tick as a slice has it.
pub(super) fn speed_fixed(mm_per_tick: f32) -> i64 {
    fixed(mm_per_tick, SPEED_BITS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planner::AllModes;

    const SECONDS_PER_TICK: f32 = 1e-6;

    fn start(phase: Phase, ticks: i64) -> Slice {
        // A quarter of a tick later than the clock's.
        Slice::new::<AllModes>(&phase, SECONDS_PER_TICK, (1000, 1 << 30), ticks)
    }

    #[test]
    fn speeding_up_from_rest_reaches_a_millimetre_when_it_should() {
        // t = sqrt(2 s / a) = sqrt(2 / 1000) s = 44721.36 us, and a quarter of a tick later by the clock
        let phase = Phase { duration_s: 0.1, accel_mm_s2: 1000.0, ..Phase::default() };
        let slice = start(phase, 100_000);
        let millimetre = 1 << FRACTION_BITS;
        assert_eq!(slice.tick_of::<AllModes>(millimetre, 0, 0), Some(44_722));
        assert_eq!(slice.tick_of::<AllModes>(millimetre, 0, 44_700), Some(44_722));
        assert_eq!(slice.tick_of::<AllModes>(6 * millimetre, 0, 0), None); // it goes only 5 mm
    }

    #[test]
    fn a_steady_speed_steps_at_the_nearest_tick() {
        let phase = Phase { duration_s: 1.0, speed_mm_s: 30.0, ..Phase::default() };
        let slice = start(phase, 1_000_000);
        for step in 1..100_i64 {
            // every 0.01 mm: every 333.33 us
            let tick = slice.tick_of::<AllModes>(fixed(0.01, FRACTION_BITS) * step, 0, 333 * step).unwrap();
            let meant = step as f64 * 1e4 / 30.0 + 0.25;
            assert!((tick as f64 - meant).abs() <= 0.51, "step {step}: {tick} for {meant}");
        }
    }

    #[test]
    fn a_float_becomes_the_whole_number_that_it_is() {
        for value in [0.0, 1.0, -1.0, 0.1, 123.456, -1e-3, 3e-5, 1e6, f32::MIN_POSITIVE, 1e-42] {
            for bits in [0, 32, 40, 52, 72, 84] {
                let exact = f64::from(value) * 2.0_f64.powi(i32::try_from(bits).unwrap());
                assert_eq!(
                    fixed(value, bits),
                    crate::whole::whole(exact).max(-i64::MAX),
                    "{value} with {bits} bits"
                );
            }
        }
        for (value, end) in [(f32::INFINITY, i64::MAX), (f32::NEG_INFINITY, -i64::MAX), (1e30, i64::MAX)] {
            assert_eq!(fixed(value, 32), end);
        }
    }

    #[test]
    fn slices_follow_one_another_without_a_gap() {
        let phase =
            Phase { duration_s: 5.0, speed_mm_s: 1.0, accel_mm_s2: 2.0, jerk_mm_s3: 3.0, ..Phase::default() };
        let first = start(phase, 5_000_000);
        let second = first.following::<AllModes>(5_000_000 - first.last);
        assert_eq!(second.base, 1000 + u64::try_from(first.last).unwrap());
        assert_eq!(second.distance::<AllModes>(0), first.distance::<AllModes>(first.last));
        // 3 s: 3 + 9 + 13.5 mm, a quarter of a tick earlier
        let at = second.distance::<AllModes>(3_000_000 - first.last);
        assert!((at as f64 / 2.0_f64.powi(32) - 25.5).abs() < 1e-5);
    }
}
