//! [`RxBuffer`]: received bytes that wait to be read.

use super::super::bytes::Bytes;

/// Bytes that the controller keeps: as many as Grbl 1.1 does. A program that counts characters sends no more
/// before they are answered.
pub(super) const RX_BYTES: usize = 128;
/// Stands for the rest of a lost line: makes the line too long, and ends it. Received bytes of this value are
/// not let in.
pub(super) const LOST: u8 = 0xFF;
/// Room in bytes for the end of a line whose other bytes have found room.
const SPARE: usize = 1;
/// A byte with this bit stands for lines that were lost in this place; its other bits are their number.
/// Received bytes above 0x7F never come here: they are real-time commands.
const LINES: u8 = 0x80;
/// Most lines that one such byte counts: what seven bits hold. If more in a row are lost, because a host
/// waits for no answer, only these are answered.
const MOST_LINES: u8 = 0x7F;

/// Received bytes that wait to be read. An LF after a CR belongs to it and takes no room.
///
/// Bytes without room are lost, as in Grbl. Grbl loses single bytes, and the rest may be a line with another
/// meaning. Here a line is lost as a whole: the part of it that found room makes no line, and each lost line
/// is read in its place as [`LOST`].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RxBuffer {
    bytes: Bytes<{ RX_BYTES + SPARE }>,
    /// The previous byte.
    last: u8,
    /// The line that is being received is lost.
    losing: bool,
    /// Lines that were lost before the first of the bytes, and after the last.
    lost_before: u8,
    lost_after: u8,
}

impl RxBuffer {
    pub(super) const fn new() -> Self {
        Self { bytes: Bytes::new(), last: b'\n', losing: false, lost_before: 0, lost_after: 0 }
    }

    pub(super) fn push(&mut self, byte: u8) {
        let last = core::mem::replace(&mut self.last, byte);
        if last == b'\r' && byte == b'\n' {
            return;
        }
        let (begins, ends) = (is_end(last), is_end(byte));
        let needed = if self.lost_after > 0 { 2 } else { 1 };
        if !self.losing && (self.room() >= needed || (ends && !begins)) {
            if self.lost_after > 0 {
                let lines = core::mem::take(&mut self.lost_after);
                self.keep(LINES | lines);
            }
            self.keep(byte);
            return;
        }
        self.losing = !ends;
        if ends {
            self.lost_after = (self.lost_after + 1).min(MOST_LINES);
        }
    }

    fn keep(&mut self, byte: u8) {
        let pushed = self.bytes.push(byte);
        debug_assert!(pushed, "its room was looked at, or it is the end that has room of its own");
    }

    pub(super) fn pop(&mut self) -> Option<u8> {
        if self.lost_before == 0 {
            match self.bytes.pop() {
                Some(lines) if lines >= LINES => self.lost_before = lines - LINES,
                Some(byte) => return Some(byte),
                None => self.lost_before = core::mem::take(&mut self.lost_after),
            }
        }
        self.lost_before = self.lost_before.checked_sub(1)?;
        Some(LOST)
    }

    /// How many more bytes find room.
    pub(super) const fn room(&self) -> usize {
        self.bytes.room().saturating_sub(SPARE)
    }

    pub(super) fn clear(&mut self) {
        *self = Self::new();
    }
}

fn is_end(byte: u8) -> bool {
    byte == b'\n' || byte == b'\r'
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// 41 bytes: of four the fourth is cut.
    const LINE: &[u8; 41] = b"0123456789012345678901234567890123456789\n";

    fn push(buffer: &mut RxBuffer, bytes: &[u8]) {
        for &byte in bytes {
            buffer.push(byte);
        }
    }

    fn read(buffer: &mut RxBuffer) -> Vec<u8> {
        core::iter::from_fn(|| buffer.pop()).collect()
    }

    #[test]
    fn what_finds_no_room_is_lost_by_lines_and_told_where_it_was() {
        let mut buffer = RxBuffer::new();
        push(&mut buffer, &LINE.repeat(6));
        assert_eq!(buffer.room(), 0);
        // Two are read, and there is room again.
        assert_eq!((0..82).map(|_| buffer.pop()).last(), Some(Some(b'\n')));
        push(&mut buffer, &LINE.repeat(3));
        let expected = [&LINE[..], b"01234", &[LOST; 3], LINE, LINE, &[LOST]];
        assert_eq!(read(&mut buffer), expected.concat());
        push(&mut buffer, b"G1\n");
        assert_eq!(read(&mut buffer), b"G1\n");
    }

    #[test]
    fn a_line_that_is_lost_while_all_is_read_is_told_at_its_end() {
        let mut buffer = RxBuffer::new();
        push(&mut buffer, &LINE.repeat(4)[..150]);
        assert_eq!(read(&mut buffer).len(), 128);
        push(&mut buffer, &LINE[27..]);
        assert_eq!(read(&mut buffer), [LOST]);
    }

    #[test]
    fn the_end_of_a_line_always_finds_room_and_an_empty_line_does_not() {
        let mut buffer = RxBuffer::new();
        push(&mut buffer, &[b'X'; RX_BYTES]);
        push(&mut buffer, b"\n\n\n");
        let kept = read(&mut buffer);
        assert_eq!((kept.len(), &kept[RX_BYTES..]), (RX_BYTES + 3, &[b'\n', LOST, LOST][..]));
    }

    #[test]
    fn as_many_lost_lines_as_are_counted_are_told() {
        let mut buffer = RxBuffer::new();
        push(&mut buffer, &[b'X'; RX_BYTES]);
        push(&mut buffer, &[b'\n'; 1000]);
        assert_eq!(read(&mut buffer).iter().filter(|byte| **byte == LOST).count(), usize::from(MOST_LINES));
    }
}
