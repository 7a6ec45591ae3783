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

/// Lines in the order in which they are sent, kept until they are answered, and the last of them beyond that.
#[derive(Clone, Debug)]
pub(super) struct LineQueue {
    lines: Ring<Line, MOST_LINES>,
    /// How many answered lines are kept.
    keeps: usize,
    /// How many of the lines are answered.
    kept: usize,
    /// How many behind them are on the line or beyond it.
    sent: usize,
    /// How many bytes of the next are.
    bytes_sent: usize,
    /// Lines answered since the beginning.
    answered: u64,
    /// Lines that were ever out whole, of which some may go out again.
    ever_sent: u64,
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
    /// Of what is answered it keeps so many lines: an answer may have been misread.
    pub(super) const fn keeping(keeps: usize) -> Self {
        Self { lines: Ring::new(), keeps, kept: 0, sent: 0, bytes_sent: 0, answered: 0, ever_sent: 0 }
    }

    /// The number of the oldest line that is not answered.
    pub(super) const fn oldest(&self) -> u64 {
        self.answered
    }

    /// That line.
    pub(super) fn oldest_bytes(&self) -> &[u8] {
        self.lines.get(self.kept).and_then(|line| line.bytes.get(..line.count)).unwrap_or_default()
    }

    /// The number of the next line that comes in.
    pub(super) const fn next_number(&self) -> u64 {
        self.answered.saturating_add((self.lines.len() - self.kept) as u64)
    }

    /// Whether all lines are out.
    pub(super) const fn is_out(&self) -> bool {
        self.kept + self.sent >= self.lines.len()
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
        let lines = (self.kept..self.kept + self.sent).filter_map(|place| self.lines.get(place));
        InFlight { lines: self.sent, bytes: lines.map(|line| line.count).sum() }
    }

    /// Whether the last line that went out is whole.
    pub(super) const fn is_between(&self) -> bool {
        self.bytes_sent == 0
    }

    /// Bytes of the next line, what it is for, and whether it is begun; `None` if all are out.
    pub(super) fn next(&self) -> Option<(usize, Purpose, bool)> {
        let line = self.lines.get(self.kept + self.sent)?;
        Some((line.count, line.purpose, self.bytes_sent > 0))
    }

    /// The next byte, which counts as sent.
    pub(super) fn next_byte(&mut self) -> Option<u8> {
        let line = self.lines.get(self.kept + self.sent)?;
        let byte = line.bytes.get(..line.count)?.get(self.bytes_sent).copied();
        self.bytes_sent += 1;
        if self.bytes_sent >= line.count {
            self.bytes_sent = 0;
            self.sent += 1;
            self.ever_sent = self.ever_sent.max(self.answered.saturating_add(self.sent as u64));
        }
        byte
    }

    /// The oldest line that is out is answered: what it was for.
    pub(super) fn answer(&mut self) -> Option<Purpose> {
        if self.sent == 0 { None } else { self.pass() }
    }

    /// The machine wants the line of this number: the oldest before it is taken, whether it is out again or
    /// not. What it was for; `None` where there is none, or the number is that of no line that was ever out,
    /// nor of the next.
    pub(super) fn take_before(&mut self, number: u64) -> Option<Purpose> {
        if self.answered >= number || number > self.ever_sent { None } else { self.pass() }
    }

    fn pass(&mut self) -> Option<Purpose> {
        let purpose = self.lines.get(self.kept).map(|line| line.purpose)?;
        (self.sent, self.kept) = (self.sent.saturating_sub(1), self.kept + 1);
        self.answered = self.answered.saturating_add(1);
        if self.kept > self.keeps {
            self.lines.pop();
            self.kept -= 1;
        }
        Some(purpose)
    }

    /// Sends again from the line of this number on, also one whose answer was misread; says whether that is
    /// still here.
    pub(super) fn again_from(&mut self, number: u64) -> bool {
        let first = self.answered.saturating_sub(self.kept as u64);
        let place = number.checked_sub(first).and_then(|place| usize::try_from(place).ok());
        let Some(place) = place.filter(|&place| place <= self.kept + self.sent) else { return false };
        if place < self.kept {
            self.answered = number;
            self.kept = place;
        }
        (self.sent, self.bytes_sent) = (place - self.kept, 0);
        true
    }

    /// Forgets what the machine cannot have seen, but for the rest of an operation of which it has seen a
    /// part. The first operation of the drawing that is forgotten, if one is.
    pub(super) fn drop_unsent(&mut self) -> Option<u64> {
        let ever_sent = usize::try_from(self.ever_sent.saturating_sub(self.answered)).unwrap_or(usize::MAX);
        let mut keep = self.kept + (self.sent + usize::from(self.bytes_sent > 0)).max(ever_sent);
        while keep > 0
            && let Some(Line { purpose: Purpose::Drawing { ends: false, .. }, .. }) = self.lines.get(keep - 1)
        {
            keep += 1;
        }
        let mut first = None;
        while self.lines.len() > keep
            && let Some(line) = self.lines.pop_back()
        {
            if let Purpose::Drawing { op, .. } = line.purpose {
                first = Some(op);
            }
        }
        first
    }

    /// Forgets movements by hand that are not begun.
    pub(super) fn drop_jogs(&mut self) {
        let keep = self.kept + self.sent + usize::from(self.bytes_sent > 0);
        while self.lines.len() > keep
            && self.lines.get(self.lines.len() - 1).is_some_and(|line| line.purpose == Purpose::Jog)
        {
            self.lines.pop_back();
        }
    }

    /// Forgets all of them: the machine has, too.
    pub(super) fn clear(&mut self) {
        let answered = self.answered;
        *self = Self { answered, ever_sent: answered, ..Self::keeping(self.keeps) };
    }
}
