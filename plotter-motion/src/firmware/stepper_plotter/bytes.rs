//! [`Bytes`]: a ring of bytes.

/// At most `N` bytes, first in, first out.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bytes<const N: usize> {
    bytes: [u8; N],
    first: usize,
    len: usize,
}

impl<const N: usize> Bytes<N> {
    pub(super) const fn new() -> Self {
        Self { bytes: [0; N], first: 0, len: 0 }
    }

    /// Appends a byte; says whether there was room for it.
    pub(super) fn push(&mut self, byte: u8) -> bool {
        let place = (self.first + self.len) % N;
        let Some(slot) = self.bytes.get_mut(place).filter(|_| self.len < N) else { return false };
        *slot = byte;
        self.len += 1;
        true
    }

    pub(super) fn pop(&mut self) -> Option<u8> {
        if self.len == 0 {
            return None;
        }
        let byte = self.bytes.get(self.first).copied();
        self.first = (self.first + 1) % N;
        self.len -= 1;
        byte
    }

    pub(super) const fn room(&self) -> usize {
        N - self.len
    }
}
