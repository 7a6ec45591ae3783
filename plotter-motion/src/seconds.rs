//! Seconds as a [`Duration`], and whether one has passed.

use crate::whole::nearest;
use core::time::Duration;

/// Longest one, s: what a whole number of 63 bits holds in nanoseconds, 285 years.
const MOST_S: f64 = 9e9;

/// The nearest nanosecond; none for what is below zero, too long or no number.
/// [`Duration::try_from_secs_f64`] takes 0.4 KB of a microcontroller's flash, and differs by the last
/// nanosecond where a number lies half way between two of them.
#[inline(never)]
pub(crate) fn duration(seconds: f64) -> Option<Duration> {
    if !(0.0..=MOST_S).contains(&seconds) {
        return None;
    }
    Some(Duration::from_nanos(nearest(seconds * 1e9).unsigned_abs()))
}

/// Whether that time has come. On a small processor each comparison of two [`Duration`]s is 44 bytes wherever
/// it stands, and half of that where it is called.
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn has_come(at: Duration, now: Duration) -> bool {
    at <= now
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_what_the_standard_library_makes_of_them() {
        for number in 0..200_000_u32 {
            for unit in [1e-6, 1e-4, 1e-3, 0.5, 7.0] {
                let seconds = f64::from(number) * unit;
                assert_eq!(duration(seconds), Duration::try_from_secs_f64(seconds).ok(), "{seconds}");
            }
        }
        assert_eq!(duration(0.999_999_999_9), Some(Duration::from_secs(1)));
        for odd in [-1.0, -1e-12, f64::NAN, f64::INFINITY, 1e300] {
            assert_eq!(duration(odd), None, "{odd}");
        }
        assert_eq!(duration(-0.0), Some(Duration::ZERO));
    }
}
