//! [`RxBuffer`]: bytes that have come and wait to be read.

use super::super::bytes::Bytes;

/// Bytes that the controller keeps: a program that counts characters sends no more before they are answered.
pub(super) const RX_BYTES: usize = 128;
/// Stands for bytes that were lost: makes its line too long. No byte of this value is let in otherwise.
pub(super) const LOST: u8 = 0xFF;
/// Room to end a line that has lost some of its bytes.
const SPARE: usize = 2;

/// Bytes that have come and wait to be read. An LF after a CR belongs to it and takes no room.
///
/// A program that counts characters never sends more than there is room for. One that does loses lines, never parts of them:
/// half a coordinate would be drawn. A line of which a part had found room is answered as too long.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RxBuffer {
    bytes: Bytes<{ RX_BYTES + SPARE }>,
    /// The byte before.
    last: u8,
    losing: Losing,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Losing {
    Nothing,
    /// The rest of a line whose beginning is there: it still gets its end.
    Rest,
    Line,
}

impl RxBuffer {
    pub(super) const fn new() -> Self {
        Self { bytes: Bytes::new(), last: b'\n', losing: Losing::Nothing }
    }

    pub(super) fn push(&mut self, byte: u8) {
        let last = core::mem::replace(&mut self.last, byte);
        if last == b'\r' && byte == b'\n' {
            return;
        }
        let (begins, ends) = (is_end(last), is_end(byte));
        let (kept, losing) = match self.losing {
            Losing::Line => (None, if ends { Losing::Nothing } else { Losing::Line }),
            Losing::Rest if ends => (Some(byte), Losing::Nothing),
            Losing::Rest => (None, Losing::Rest),
            Losing::Nothing if self.room() > 0 || (ends && !begins) => (Some(byte), Losing::Nothing),
            Losing::Nothing if begins && ends => (None, Losing::Nothing),
            Losing::Nothing if begins => (None, Losing::Line),
            Losing::Nothing => (Some(LOST), Losing::Rest),
        };
        self.losing = losing;
        if let Some(byte) = kept {
            let pushed = self.bytes.push(byte);
            debug_assert!(pushed, "a line needs no more than the spare room to end");
        }
    }

    pub(super) fn pop(&mut self) -> Option<u8> {
        self.bytes.pop()
    }

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

    #[test]
    fn what_finds_no_room_is_lost_by_lines() {
        let mut buffer = RxBuffer::new();
        let line = b"0123456789012345678901234567890123456789\n"; // 41 bytes: the fourth is cut
        for byte in line.repeat(6) {
            buffer.push(byte);
        }
        let kept: Vec<u8> = core::iter::from_fn(|| buffer.pop()).collect();
        let lines: Vec<&[u8]> = kept.split(|byte| *byte == b'\n').collect();
        assert_eq!(lines.len(), 5, "three, the one that was cut, and nothing after it");
        assert!(lines[..3].iter().all(|kept| *kept == &line[..40]));
        assert_eq!((lines[3], lines[4]), (&[b'0', b'1', b'2', b'3', b'4', LOST][..], &[][..]));
        buffer.push(b'G');
        assert_eq!(buffer.pop(), Some(b'G'));
    }
}
