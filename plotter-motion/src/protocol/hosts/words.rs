//! [`Words`]: a text of bounded length.

use core::fmt;

/// A text of at most `N` bytes, without memory from anywhere.
#[derive(Clone, Copy, Debug)]
pub struct Words<const N: usize> {
    bytes: [u8; N],
    count: usize,
}

impl<const N: usize> Default for Words<N> {
    fn default() -> Self {
        Self { bytes: [0; N], count: 0 }
    }
}

impl<const N: usize> Words<N> {
    /// What it says.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8] {
        self.bytes.get(..self.count).unwrap_or_default()
    }

    /// Forgets all of it.
    pub const fn clear(&mut self) {
        self.count = 0;
    }

    /// Takes a byte more; what finds no room is left out, and this says so.
    pub(super) fn push(&mut self, byte: u8) -> bool {
        let slot = self.bytes.get_mut(self.count);
        let has_room = slot.is_some();
        if let Some(slot) = slot {
            *slot = byte;
            self.count += 1;
        }
        has_room
    }
}

impl<const N: usize> fmt::Write for Words<N> {
    /// All of it, or an error and none of it.
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let end = self.count.saturating_add(text.len());
        let room = self.bytes.get_mut(self.count..end).ok_or(fmt::Error)?;
        room.copy_from_slice(text.as_bytes());
        self.count = end;
        Ok(())
    }
}
