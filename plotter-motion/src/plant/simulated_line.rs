//! [`SimulatedLine`]: one direction of a serial line, with the bytes that are on it.

use crate::protocol::Wire;
use alloc::collections::VecDeque;
use core::time::Duration;

/// Bytes on their way from a sender to a receiver.
///
/// ```
/// # use core::time::Duration;
/// # use plotter_motion::plant::SimulatedLine;
/// let mut line = SimulatedLine::new(100_000); // 100 us a byte
/// line.send(Duration::ZERO, b'+');
/// assert_eq!(line.next(), Some(Duration::from_micros(100)));
/// assert_eq!((line.take(), line.take()), (Some(b'+'), None));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SimulatedLine {
    wire: Wire,
    bytes: VecDeque<(Duration, u8)>,
}

impl SimulatedLine {
    /// A silent line of `baud` bits a second.
    #[must_use]
    pub const fn new(baud: u32) -> Self {
        Self { wire: Wire::new(baud), bytes: VecDeque::new() }
    }

    /// Puts a byte on the line.
    pub fn send(&mut self, now: Duration, byte: u8) {
        let through = self.wire.send(now);
        self.bytes.push_back((through, byte));
    }

    /// When the next byte is through.
    #[must_use]
    pub fn next(&self) -> Option<Duration> {
        self.bytes.front().map(|&(at, _)| at)
    }

    /// Takes the next byte off the line, whether it is through or not.
    pub fn take(&mut self) -> Option<u8> {
        self.bytes.pop_front().map(|(_, byte)| byte)
    }
}
