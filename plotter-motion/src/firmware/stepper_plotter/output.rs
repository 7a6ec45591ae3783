//! [`Output`]: text on its way to the host.

use core::fmt;

/// Bytes that wait to be sent.
const SIZE: usize = 512;

/// Bytes that wait for the line. Whoever writes has looked at [`Output::room`] before; what finds no room is lost.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Output {
    bytes: [u8; SIZE],
    first: usize,
    len: usize,
}

impl Output {
    pub(super) const fn new() -> Self {
        Self { bytes: [0; SIZE], first: 0, len: 0 }
    }

    pub(super) const fn room(&self) -> usize {
        SIZE - self.len
    }

    pub(super) fn pop(&mut self) -> Option<u8> {
        if self.len == 0 {
            return None;
        }
        let byte = self.bytes.get(self.first).copied();
        self.first = (self.first + 1) % SIZE;
        self.len -= 1;
        byte
    }

    /// Writes a line with its end.
    pub(super) fn line(&mut self, text: fmt::Arguments<'_>) {
        // Writing to it does not fail.
        let _ = fmt::Write::write_fmt(self, text);
        let _ = fmt::Write::write_str(self, "\r\n");
    }
}

impl fmt::Write for Output {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for &byte in text.as_bytes() {
            debug_assert!(self.len < SIZE, "room was looked at before");
            let place = (self.first + self.len) % SIZE;
            if self.len < SIZE
                && let Some(slot) = self.bytes.get_mut(place)
            {
                *slot = byte;
                self.len += 1;
            }
        }
        Ok(())
    }
}
