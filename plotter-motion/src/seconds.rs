//! Seconds as a [`Duration`].

use core::time::Duration;

/// As [`Duration::try_from_secs_f64`], which takes 0.4 KB of a microcontroller's flash wherever it is written.
#[inline(never)]
pub(crate) fn duration(seconds: f64) -> Option<Duration> {
    Duration::try_from_secs_f64(seconds).ok()
}
