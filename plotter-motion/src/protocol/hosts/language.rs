//! [`Language`]: what a [`LineHost`](super::LineHost) has to know of a machine that answers lines.

use super::{InFlight, MOST_LINE, MachineLimits, Words};
use crate::gcode::WriteError;
use crate::{PlotOp, Point, Vec2};
use core::time::Duration;

/// Text of an operation, all of its lines: an arc of more than three quarters of a turn has two, and before
/// it the pen is lowered and waited for.
pub type OpText = Words<384>;

/// What a machine is doing, as it says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Doing {
    /// It waits.
    Idle,
    /// It moves.
    Moves,
    /// It brakes for a hold.
    Brakes,
    /// It is held, at rest.
    Held,
    /// It searches for its switches.
    Homes,
    /// It is locked.
    Locked,
    /// It sleeps, its door is open, or it only checks lines.
    Elsewhere,
}

/// A machine's report of itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// What it does.
    pub doing: Option<Doing>,
    /// Where the pen is, mm on the sheet.
    pub at: Option<Point>,
}

/// What a machine's line means.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Answer {
    /// The oldest line that waits is taken.
    Taken,
    /// It is refused, with the machine's code.
    Refused(u16),
    /// The machine wants lines again from this one on, counted from the first, 0.
    Again(u64),
    /// A line that is out is refused with this code, if the machine read it whole
    /// ([`complains_of`](Language::complains_of)); else the oldest goes out again.
    Doubtful(u16),
    /// It complains of something, which it does not say, with its code: the drawing pauses.
    Complains(u16),
    /// It has stopped by itself and is locked, with its code.
    Alarm(u16),
    /// It was switched on, or reset.
    Greeting,
    /// It says how it is.
    Report(Report),
    /// It is busy with a long line: that is no silence.
    Busy,
    /// It says something else that is known.
    Known,
    /// That is no line of this language.
    Unknown,
}

/// A language of lines, each of which is answered.
pub trait Language {
    /// What stops the machine at once, in the middle of anything.
    const STOP: &'static [u8] = &[];
    /// What makes it brake and wait with all that it was sent; and what makes it forget that then, so that it
    /// greets. Where there are none, a pause comes when all that was sent is drawn.
    const HOLD: Option<(u8, u8)> = None;
    /// What it answers at once with a [`Report`], in the middle of anything.
    const QUERY: Option<u8> = None;
    /// What ends a jog on its way.
    const END_JOG: Option<u8> = None;
    /// Whether a line is answered when it is carried out, not when it is taken.
    const ANSWERS_WHEN_DONE: bool = false;
    /// Whether lines have numbers and checksums ([`frame`](Self::frame)): the machine takes each once, so
    /// that one that is not answered may go out again.
    const IS_NUMBERED: bool = false;
    /// What it answers at once, in the middle of anything, with whether it has room for a line
    /// ([`Answer::Taken`], else [`Answer::Busy`]): asked while a line is not answered. Empty where there is
    /// none.
    const ROOM_QUERY: &'static [u8] = b"";
    /// Whether the machine changes pens by itself.
    const CHANGES_PENS: bool = false;
    /// Whether it is by a [`Report`] that a machine is known to rest, not by the answer to the lines of
    /// [`rest`](Self::rest).
    const RESTS_BY_REPORT: bool = false;
    /// Whether a machine that greets takes the place where it stands for (0, 0).
    const GREETS_AT_ORIGIN: bool = false;
    /// Longest that a machine takes for a line without a word, at least; the way of the line comes on top.
    const PATIENCE: Duration = Duration::from_secs(10);

    /// Forgets what is known of the modes of the machine and of its pen: all is said anew.
    fn begin(&mut self);

    /// What was sent is forgotten, also by the machine, which may count lines from anywhere.
    fn count_anew(&mut self) {}

    /// Lines that were written last were not sent: what they would have changed is said anew.
    fn unsaid(&mut self) {
        self.begin();
    }

    /// Which pen of its carousel the machine draws with, as far as it was sent; 0 if the drawing has selected
    /// none.
    fn holds(&mut self, _pen: u8) {}

    /// An operation in lines, each with its end.
    ///
    /// # Errors
    ///
    /// [`WriteError`]: it cannot be said, and nothing was.
    fn write(&mut self, op: PlotOp, out: &mut OpText) -> Result<(), WriteError>;

    /// Lifts the pen at this place, where it stands. A language that can say so without a place does: a place
    /// that came wrong before is seen at the rest behind it, not put right with the pen lifted.
    ///
    /// # Errors
    ///
    /// As [`write`](Self::write).
    fn lift(&mut self, at: Point, out: &mut OpText) -> Result<(), WriteError> {
        self.write(PlotOp::Travel { to: at }, out)
    }

    /// A movement by hand, in lines; whether there is a word for it.
    fn jog(&mut self, at: Point, by: Vec2, feed_mm_s: f64, out: &mut OpText) -> bool;

    /// Lines of which the last is answered when all before is done; a [`Report`] of where the machine stands
    /// then comes before it, or by the query.
    fn rest(&mut self, out: &mut OpText);

    /// Lines that ask where the machine stands once all before is done, and leave the pen as it is.
    fn place(&mut self, out: &mut OpText) {
        self.rest(out);
    }

    /// Questions for the beginning.
    fn questions(&mut self, _out: &mut OpText) {}

    /// The search for the switches; whether there is a word for it.
    fn home(&mut self, _out: &mut OpText) -> bool {
        false
    }

    /// What takes a lock off; whether there is a word for it.
    fn unlock(&mut self, _out: &mut OpText) -> bool {
        false
    }

    /// Where the pen is now is this place; whether there is a word for it.
    fn stands_at(&mut self, _place: Point, _out: &mut OpText) -> bool {
        false
    }

    /// The speed of the drawing, from one share to another: bytes past all lines. The share that they make.
    fn feed(&mut self, _from_percent: u8, _to_percent: u8, _out: &mut OpText) -> Option<u8> {
        None
    }

    /// The number that lowers the pen; whether it is one.
    fn pen_down_at(&mut self, _number: u16) -> bool {
        false
    }

    /// A line with its end as it goes out: with its number, counted from 0. Says whether it found room.
    fn frame(&self, _number: u64, line: &[u8], out: &mut Words<MOST_LINE>) -> bool {
        line.iter().all(|&byte| out.push(byte))
    }

    /// How long a machine may stand still for a line of its own, such as while its pen moves, and not answer
    /// it.
    fn stands_for(&self) -> Duration {
        Duration::ZERO
    }

    /// Whether a line of so many bytes may go out while others are.
    fn fits(&self, flight: InFlight, bytes: usize) -> bool;

    /// Takes a byte of the machine that is no part of a line; says whether it is one.
    fn hear_byte(&mut self, _byte: u8) -> bool {
        false
    }

    /// Whether the machine lets no byte through now.
    fn is_held(&self) -> bool {
        false
    }

    /// Whether a machine that works may say nothing for any time.
    fn may_be_silent(&self) -> bool {
        false
    }

    /// Whether lines are answered, or what a question asks for; else a line that is out is taken.
    fn answers_lines(&self) -> bool {
        true
    }

    /// What a line of the machine means, without its end.
    fn hear(&mut self, line: &[u8]) -> Answer;

    /// Whether the machine's last complaint was of this line, as it went out.
    fn complains_of(&self, _line: &[u8]) -> bool {
        true
    }

    /// What the machine has said of itself.
    fn limits(&self) -> MachineLimits {
        MachineLimits::default()
    }
}
