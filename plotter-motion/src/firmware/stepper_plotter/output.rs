//! [`Output`]: text on its way to the host.

use super::bytes::Bytes;
use core::fmt;

/// At most `N` bytes that wait for the line. Whoever writes has looked at [`Output::room`] before; what finds
/// no room is lost.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Output<const N: usize>(Bytes<N>);

impl<const N: usize> Output<N> {
    pub(super) const fn new() -> Self {
        Self(Bytes::new())
    }

    pub(super) const fn room(&self) -> usize {
        self.0.room()
    }

    pub(super) fn pop(&mut self) -> Option<u8> {
        self.0.pop()
    }

    /// Writes a line with its end.
    pub(super) fn line(&mut self, text: fmt::Arguments<'_>) {
        // Writing to it does not fail.
        let _ = fmt::Write::write_fmt(self, text);
        let _ = fmt::Write::write_str(self, "\r\n");
    }
}

impl<const N: usize> fmt::Write for Output<N> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for &byte in text.as_bytes() {
            let written = self.0.push(byte);
            debug_assert!(written, "room was looked at before");
        }
        Ok(())
    }

    /// Digits, signs and points; the standard library's way for every character there is takes 140 bytes of
    /// flash.
    fn write_char(&mut self, character: char) -> fmt::Result {
        let byte = u8::try_from(character).map_err(|_| fmt::Error)?;
        let written = self.0.push(byte);
        debug_assert!(
            written && byte.is_ascii(),
            "room was looked at before, and no other characters are written"
        );
        Ok(())
    }
}
