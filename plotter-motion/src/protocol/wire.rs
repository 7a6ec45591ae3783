//! One direction of an 8N1 serial line: when a byte is through.

use core::time::Duration;

/// Keeps the time of one direction of a serial line: ten bit times a byte, one after the other.
///
/// The line counts in nanoseconds, so that thousands of bytes do not gather rounding; a byte's time is given
/// in whole microseconds, rounded up.
///
/// ```
/// # use plotter_motion::protocol::Wire;
/// # use core::time::Duration;
/// let mut wire = Wire::new(256_000); // 39.0625 us a byte
/// assert_eq!(wire.send(Duration::from_micros(100)), Duration::from_micros(140));
/// assert_eq!(wire.send(Duration::from_micros(100)), Duration::from_micros(179)); // waits for the first
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wire {
    byte_ns: u64,
    free_ns: u64,
}

impl Wire {
    /// A silent line of `baud` bits a second (0 is taken as 1).
    #[must_use]
    pub const fn new(baud: u32) -> Self {
        let baud = if baud == 0 { 1 } else { baud as u64 };
        Self { byte_ns: 10_000_000_000 / baud, free_ns: 0 }
    }

    /// Takes a byte offered at `now`; says when its last bit is through. Neither goes beyond 584 years.
    #[must_use]
    pub fn send(&mut self, now: Duration) -> Duration {
        let now_ns = u64::try_from(now.as_nanos()).unwrap_or(u64::MAX);
        self.free_ns = self.free_ns.max(now_ns).saturating_add(self.byte_ns);
        Duration::from_micros(self.free_ns.div_ceil(1_000))
    }
}
