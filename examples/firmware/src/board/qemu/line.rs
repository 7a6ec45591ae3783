//! One direction of the serial line: bytes that are on their way.

use core::time::Duration;
use heapless::Deque;
use plotter_motion::protocol::Wire;

/// Bytes that may be on their way at once, with those that wait in the sender's buffer.
pub const BYTES: usize = 512;

/// Bytes with the time at which the last bit of each is through, us.
#[derive(Debug)]
pub struct Line {
    wire: Wire,
    bytes: Deque<(u64, u8), BYTES>,
}

impl Line {
    /// A silent line.
    pub const fn new(baud: u32) -> Self {
        Self { wire: Wire::new(baud), bytes: Deque::new() }
    }

    /// Puts a byte on the line; says whether there was room.
    pub fn send(&mut self, now_us: u64, byte: u8) -> bool {
        if self.bytes.is_full() {
            return false;
        }
        let through = self.wire.send(Duration::from_micros(now_us)).as_micros() as u64;
        self.bytes.push_back((through, byte)).is_ok()
    }

    /// When the next byte is through.
    pub fn next_us(&self) -> Option<u64> {
        self.bytes.front().map(|&(at, _)| at)
    }

    /// Takes it off.
    pub fn pop(&mut self) -> Option<u8> {
        self.bytes.pop_front().map(|(_, byte)| byte)
    }

    /// Whether there is room for another.
    pub fn has_room(&self) -> bool {
        !self.bytes.is_full()
    }
}
