//! [`LineQueue`]: the lines of a host, from their writing to their answer.

use super::ring::Ring;

/// Longest line, with its end: GRBL takes 80 bytes, mDraw 64, Marlin 96.
pub const MOST_LINE: usize = 96;
/// Lines that wait, for the line or for their answers. GRBL's buffer of 128 bytes holds 8 usual ones.
const MOST_LINES: usize = 32;

/// What a line is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// An operation of the drawing, by its number from 0; `ends` with its last line.
    Drawing {
        /// Which operation.
        op: u64,
        /// Whether it is the last of its lines.
        ends: bool,
    },
    /// What a person has asked for.
    ByHand,
    /// A movement by hand that may be ended on its way.
    Jog,
    /// A question about the machine.
    Question,
    /// Answered when all before it is done.
    Rest,
    /// The search for the limit switches.
    Homing,
    /// Takes a lock off.
    Unlocking,
}

#[derive(Clone, Copy, Debug)]
struct Line {
    bytes: [u8; MOST_LINE],
    count: usize,
    purpose: Purpose,
}

/// Lines in the order in which they are sent, kept until they are answered.
#[derive(Clone, Debug)]
pub(super) struct LineQueue {
    lines: Ring<Line, MOST_LINES>,
    /// How many of them are on the line or beyond it.
    sent: usize,
    /// How many bytes of the next are.
    bytes_sent: usize,
    /// Lines answered since the beginning.
    answered: u64,
}

/// What is out and not answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InFlight {
    /// Lines.
    pub lines: usize,
    /// Their bytes, ends of lines too.
    pub bytes: usize,
}

impl LineQueue {
    pub(super) const fn new() -> Self {
        Self { lines: Ring::new(), sent: 0, bytes_sent: 0, answered: 0 }
    }

    /// Lines for which there is room.
    pub(super) const fn room(&self) -> usize {
        MOST_LINES - self.lines.len()
    }

    /// Takes a line with its end; says whether it found room.
    pub(super) fn push(&mut self, text: &[u8], purpose: Purpose) -> bool {
        let mut line = Line { bytes: [0; MOST_LINE], count: text.len(), purpose };
        let Some(bytes) = line.bytes.get_mut(..text.len()) else { return false };
        bytes.copy_from_slice(text);
        self.lines.push(line).is_ok()
    }

    pub(super) fn in_flight(&self) -> InFlight {
        let lines = (0..self.sent).filter_map(|place| self.lines.get(place));
        InFlight { lines: self.sent, bytes: lines.map(|line| line.count).sum() }
    }

    /// Bytes of the next line, what it is for, and whether it is begun; `None` if all are out.
    pub(super) fn next(&self) -> Option<(usize, Purpose, bool)> {
        self.lines.get(self.sent).map(|line| (line.count, line.purpose, self.bytes_sent > 0))
    }

    /// The next byte, which counts as sent.
    pub(super) fn next_byte(&mut self) -> Option<u8> {
        let line = self.lines.get(self.sent)?;
        let byte = line.bytes.get(..line.count)?.get(self.bytes_sent).copied();
        self.bytes_sent += 1;
        if self.bytes_sent >= line.count {
            self.bytes_sent = 0;
            self.sent += 1;
        }
        byte
    }

    /// The oldest line that is out is answered: what it was for.
    pub(super) fn answer(&mut self) -> Option<Purpose> {
        if self.sent == 0 {
            return None;
        }
        self.sent -= 1;
        self.answered = self.answered.saturating_add(1);
        self.lines.pop().map(|line| line.purpose)
    }

    /// Sends again from the line of this number on; says whether that is still here.
    pub(super) fn again_from(&mut self, number: u64) -> bool {
        let place = number.checked_sub(self.answered).and_then(|place| usize::try_from(place).ok());
        let Some(place) = place.filter(|&place| place <= self.sent) else { return false };
        (self.sent, self.bytes_sent) = (place, 0);
        true
    }

    /// Forgets all of them: the machine has, too.
    pub(super) fn clear(&mut self) {
        *self = Self { answered: self.answered, ..Self::new() };
    }
}
