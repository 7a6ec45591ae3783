//! [`ResumePoint`]: where a drawing was left, from the log of the host that sent it.

use crate::frames::Introduction;
use crate::log::{self, Event, Header, ReadError};
use core::fmt;
use crc::{CRC_32_ISO_HDLC, Crc, Table};
use plotter_motion::protocol::Resume;
use plotter_motion::{Pen, PenMove};
use std::path::Path;

/// Before the number of a move by hand, in a note of a recording, and behind it when it was given and when it
/// was reached.
pub(crate) const BY_HAND: &str = "host: move by hand ";
pub(crate) const GIVEN: &str = " given";
pub(crate) const REACHED: &str = " reached";

static CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// Tells one drawing from another: how many moves it has, and a check over them.
///
/// ```
/// # use plotter_motion::{Pen, PenMove, StepPoint};
/// # use plotter_replay::resume::DrawingMark;
/// let (mut one, mut other) = (DrawingMark::default(), DrawingMark::default());
/// one.push(PenMove { pen: Pen::Down, target: StepPoint::new(40, 20) });
/// other.push(PenMove { pen: Pen::Up, target: StepPoint::new(40, 20) });
/// assert_eq!((one.moves, other.moves), (1, 1));
/// assert_ne!(one, other);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DrawingMark {
    /// Moves.
    pub moves: u64,
    /// CRC-32 over them, each over the one before.
    pub check: u32,
}

impl DrawingMark {
    /// Takes the next move.
    pub fn push(&mut self, next: PenMove) {
        let mut digest = CRC.digest();
        digest.update(&self.check.to_le_bytes());
        digest.update(&[u8::from(next.pen == Pen::Down)]);
        digest.update(&next.target.x.to_le_bytes());
        digest.update(&next.target.y.to_le_bytes());
        self.check = digest.finalize();
        self.moves = self.moves.saturating_add(1);
    }

    /// The header with what [`ResumePoint::read`] looks for.
    #[must_use]
    pub fn written_to(self, header: Header) -> Header {
        header.with_number("drawing_moves", self.moves).with_number("drawing_check", self.check.into())
    }
}

/// Where a drawing was left that went over the reliable link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ResumePoint {
    /// Report of the machine when the drawing was begun.
    pub resume: Resume,
    /// Mark of the drawing, if the log has one.
    pub drawing: Option<DrawingMark>,
}

/// Why a log says not where a drawing was left.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ResumeError {
    /// It cannot be read.
    Unreadable(ReadError),
    /// No machine has said in it over the reliable link how it stands.
    NoStatus,
    /// It ends while the machine was led by hand: which move it has taken last, it does not say.
    LedByHand,
}

impl fmt::Display for ResumeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(error) => error.fmt(f),
            Self::NoStatus => f.write_str(
                "no machine says in it over the reliable link how it stands, and one of digits cannot: lead the machine to \
                 its origin and begin the drawing anew",
            ),
            Self::LedByHand => f.write_str(
                "it ends in the middle of a move by hand, which the machine counts like one of the drawing's: lead the \
                 machine to its origin and begin the drawing anew",
            ),
        }
    }
}

impl core::error::Error for ResumeError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Unreadable(error) => Some(error),
            _ => None,
        }
    }
}

/// How many moves by hand a machine has taken, as its log has them.
fn led_by_hand(path: &Path) -> Result<u32, ResumeError> {
    let (mut given, mut reached) = (0, 0);
    for record in log::open(path).map_err(ResumeError::Unreadable)?.filter_map(Result::ok) {
        let Event::Note(words) = &record.event else { continue };
        let Some(words) = words.strip_prefix(BY_HAND) else { continue };
        let number = |end| words.strip_suffix(end).and_then(|number| number.parse::<u32>().ok());
        given = number(GIVEN).unwrap_or(given);
        reached = number(REACHED).unwrap_or(reached);
    }
    if given == reached { Ok(reached) } else { Err(ResumeError::LedByHand) }
}

impl ResumePoint {
    /// What a log says: of the drawing's begin, if it goes on with one already, else the first word of its
    /// machine. Damaged lines are passed over.
    ///
    /// # Errors
    ///
    /// [`ResumeError`] if there is no such word in it.
    pub fn read(path: &Path) -> Result<Self, ResumeError> {
        let reader = log::open(path).map_err(ResumeError::Unreadable)?;
        let header = reader.header();
        let whole = |key| {
            let number = header.number(key).filter(|n| (0.0..=4_294_967_295.0).contains(n));
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "within 32 bits, as checked"
            )]
            number.map(|number| number as u32)
        };
        let drawing = whole("drawing_moves").zip(whole("drawing_check"));
        let drawing = drawing.map(|(moves, check)| DrawingMark { moves: moves.into(), check });
        let led = led_by_hand(path)?;
        let (boot, before) = match whole("link_boot").zip(whole("link_before")) {
            Some(earlier) => earlier,
            None => {
                let first = Introduction::find(reader.filter_map(Result::ok)).ok_or(ResumeError::NoStatus)?;
                (first.boot, first.taken)
            }
        };
        // What was done by hand is none of the drawing's.
        Ok(Self { resume: Resume { boot, before: before.wrapping_add(led) }, drawing })
    }

    /// The header of a log that goes on with the drawing.
    #[must_use]
    pub fn written_to(self, header: Header) -> Header {
        let Resume { boot, before } = self.resume;
        header.with_number("link_boot", boot.into()).with_number("link_before", before.into())
    }
}
