//! [`Block`]: the words of one line.

use super::Position;
use crate::whole::nearest;
use core::fmt;

/// Most words of one line.
pub(super) const MOST_WORDS: usize = 16;

/// A letter and its number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Word {
    /// The letter, in upper case; [`Word::BARE`] for a number that has none.
    pub letter: u8,
    /// Its number, within ±10⁹; `None` where only the letter stands there, as in `G28 X Y`.
    pub number: Option<f64>,
    /// Where the letter stands in its line, counted as [`Position::column`].
    pub column: u32,
}

impl Word {
    /// The letter of a number without one: the degrees of mDraw's `M1 90`.
    pub const BARE: u8 = b' ';

    const NONE: Self = Self { letter: Self::BARE, number: None, column: 0 };

    /// Ten times the number of a `G` or `M` word, so that `G92.1` is 921; `None` if it can be no such word.
    #[must_use]
    pub fn tenths(self) -> Option<u16> {
        let tenths = self.number? * 10.0;
        let whole = u16::try_from(nearest(tenths)).ok()?;
        ((tenths - f64::from(whole)).abs() < 1e-6).then_some(whole)
    }
}

impl fmt::Display for Word {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.letter != Self::BARE {
            write!(f, "{}", char::from(self.letter))?;
        }
        self.number.map_or(Ok(()), |number| write!(f, "{number}"))
    }
}

/// What a comment says that a program acts upon: [`Writer`](super::Writer) writes these after `M0`, or a pen
/// in a line of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Remark {
    /// `(new sheet)`.
    NewSheet,
    /// `(pen 2)`.
    Pen(u8),
}

/// The words of one line, in their order; at most 16, and at least one where no comment names a pen.
///
/// ```
/// # use plotter_motion::gcode::Reader;
/// let mut reader = Reader::new();
/// let block = b"N7 g1 x-2.5Y4 (there)\n".iter().find_map(|byte| reader.push(*byte)).unwrap()?;
/// assert_eq!(block.number(b'X'), Some(-2.5));
/// assert_eq!((block.line_number(), block.words().len()), (Some(7), 4));
/// assert_eq!(block.place(block.words()[3]).to_string(), "line 1, column 12 (byte 11)");
/// # Ok::<(), plotter_motion::gcode::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    pub(super) at: Position,
    words: [Word; MOST_WORDS],
    count: u8,
    pub(super) deleted: bool,
    pub(super) checked: bool,
    pub(super) remark: Option<Remark>,
}

impl Block {
    // As a constant it is 400 bytes of program memory.
    #[inline(never)]
    pub(crate) fn empty() -> Self {
        Self {
            at: Position::START,
            words: core::array::from_fn(|_| Word::NONE),
            count: 0,
            deleted: false,
            checked: false,
            remark: None,
        }
    }

    /// Forgets all of it: as [`Block::empty`] makes one.
    pub(crate) fn clear(&mut self) {
        for word in self.words.iter_mut().take(self.count.into()) {
            *word = Word::NONE;
        }
        (self.at, self.count, self.deleted, self.checked, self.remark) =
            (Position::START, 0, false, false, None);
    }

    /// Takes one more word, the first of which stands at `at`; `false` if there is no room.
    pub(crate) fn push(&mut self, word: Word, at: Position) -> bool {
        let Some(slot) = self.words.get_mut(usize::from(self.count)) else { return false };
        if self.count == 0 {
            self.at = at;
        }
        *slot = word;
        self.count += 1;
        true
    }

    /// Keeps the words that are asked for.
    pub(super) fn retain(&mut self, mut keeps: impl FnMut(&Word) -> bool) {
        let before = *self;
        self.words = [Word::NONE; MOST_WORDS];
        self.count = 0;
        for word in before.words().iter().filter(|word| keeps(word)) {
            self.push(*word, before.at);
        }
    }

    /// One more word, where the line stands; there is none where the line is full.
    pub(super) fn insert(&mut self, letter: u8, number: f64) {
        let (at, column) = (self.at, self.at.column);
        self.push(Word { letter, number: Some(number), column }, at);
    }

    /// The number of this letter, from here on.
    pub(super) fn set(&mut self, letter: u8, number: f64) {
        let count = usize::from(self.count);
        match self.words.iter_mut().take(count).find(|word| word.letter == letter) {
            Some(word) => word.number = Some(number),
            None => self.insert(letter, number),
        }
    }

    /// Where its first word stands, or its comment.
    #[must_use]
    pub fn position(&self) -> Position {
        self.at
    }

    /// All words.
    #[must_use]
    #[cfg_attr(target_os = "none", inline(never))]
    pub fn words(&self) -> &[Word] {
        self.words.get(..usize::from(self.count)).unwrap_or_default()
    }

    /// The number of the first word with this letter, in upper case.
    #[must_use]
    pub fn number(&self, letter: u8) -> Option<f64> {
        self.words().iter().find(|word| word.letter == letter)?.number
    }

    /// The number after `N`, if it is a whole one.
    #[must_use]
    pub fn line_number(&self) -> Option<u32> {
        let number = self.number(b'N')?;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked right after")]
        let whole = number as u32;
        (f64::from(whole) == number).then_some(whole)
    }

    /// Where a word of this block stands.
    #[inline(never)] // for the sake of small processors: it is in every complaint
    #[must_use]
    pub fn place(&self, word: Word) -> Position {
        let further = word.column.saturating_sub(self.at.column);
        Position {
            offset: self.at.offset.saturating_add(u64::from(further)),
            line: self.at.line,
            column: self.at.column.saturating_add(further),
        }
    }

    /// Whether the line begins with `/`, by which a person can have it left out.
    #[must_use]
    pub fn is_deleted(&self) -> bool {
        self.deleted
    }

    /// Whether the line had a checksum, which then was right.
    #[must_use]
    pub fn is_checked(&self) -> bool {
        self.checked
    }

    /// Meaning of a comment of the line, if it is one of the few that have one.
    #[must_use]
    pub fn remark(&self) -> Option<Remark> {
        self.remark
    }
}

/// Whether `letter` is one of a few.
#[expect(
    clippy::manual_contains,
    reason = "the search that `contains` calls is made for long texts and takes 240 bytes of flash"
)]
pub(super) fn is_among(letter: u8, letters: &[u8]) -> bool {
    letters.iter().any(|one| *one == letter)
}
