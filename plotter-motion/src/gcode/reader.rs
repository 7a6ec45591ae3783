//! [`Reader`]: bytes in, lines of words out.

use super::block::is_among;
use super::remark::RemarkReader;
use super::text::Text;
use super::{Block, Cursor, Error, Position, Problem, Remark, Word};
use crate::decimal::Decimal;

/// Greatest magnitude of a number: what [`Writer`](super::Writer) writes at most.
pub(crate) const MOST: f64 = 1e9;

/// Commands whose words are a text for people, or the name of a file.
const TEXT_COMMANDS: [f64; 3] = [23.0, 117.0, 118.0];

/// How `sub`, `endsub`, `call`, `if`, `do`, `while`, `repeat`, `break` and `return` begin, which `LinuxCNC`
/// has after an `O` with its number.
const CONTROL_WORDS: &[u8] = b"SECIDWRB";

/// The mark that some editors put before a text.
const BYTE_ORDER_MARK: [u8; 3] = [0xef, 0xbb, 0xbf];

/// Separators between words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Spacing {
    /// Nothing needs to: `G1X10Y5` has three words.
    #[default]
    Free,
    /// Blanks only, as the firmware of mDraw's machines has it: what follows a number up to the next blank is
    /// lost, so that `G1X10 Y5` has two words. There are neither comments nor errors, and numbers may lack
    /// their letter anywhere.
    Required,
}

/// Where in a line the reader stands.
#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    /// Between words. A number without a letter may follow an `M`.
    Between { after_m: bool },
    /// After a letter.
    Letter { letter: u8, at: Position },
    /// Within a number, or after a blank behind its last digit, where more digits may follow.
    Number { letter: u8, at: Position, number: Decimal, blank: bool },
    /// Within so many parentheses, or with none after a semicolon.
    Comment { parentheses: u16, remark: RemarkReader },
    /// After the `*`.
    Checksum { at: Position, given: Option<u16> },
    /// In what is not read, up to the end of the line.
    Text,
    /// After a number in a line whose words are separated by blanks.
    Lost,
    /// In a line that is left out.
    Skip,
}

const START: State = State::Between { after_m: false };

/// Splits G-code into lines and their words, byte by byte, in constant memory.
///
/// It takes words with and without blanks, also within numbers, in either case; numbers with sign and point;
/// comments in `( )` and after `;`; `%` and `/` before a line; checksums (`*71`, the bytes before it by
/// exclusive or), which must be right; lines that end with LF, CR or both. Control characters are blanks.
/// Lines without words give nothing, but for `(pen 2)`.
///
/// An error ends the line: what stands in it is not carried out, and the next one is read as if nothing had
/// been.
///
/// ```
/// # use plotter_motion::gcode::Reader;
/// let mut reader = Reader::new();
/// let lines: Vec<_> = b"G1X10Y-2\nG1 X1O\nM3 S90 ;down\n".iter().filter_map(|byte| reader.push(*byte)).collect();
/// let words: Vec<String> = lines[0]?.words().iter().map(|word| word.to_string()).collect();
/// assert_eq!(words, ["G1", "X10", "Y-2"]);
/// assert_eq!(lines[1]?.words()[2].to_string(), "O"); // a letter without a number: the interpreter will complain
/// assert_eq!(lines[2]?.number(b'S'), Some(90.0));
/// # Ok::<(), plotter_motion::gcode::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reader {
    state: State,
    spacing: Spacing,
    /// The byte to come.
    cursor: Cursor,
    /// The words of the line in progress, or of the one that has just ended.
    block: Block,
    /// The bytes of the line by exclusive or.
    sum: u8,
    /// Where a comment begins within a comment of this line.
    nested: Option<Position>,
    /// A text for people may begin: after `M0` or `M1` and a blank.
    pauses: bool,
    /// The last comment of the line, or what stands behind `M0`; or a message of a line before it.
    text: Text,
}

impl Default for Reader {
    fn default() -> Self {
        Self::new()
    }
}

impl Reader {
    /// A reader before the first byte.
    #[must_use]
    pub fn new() -> Self {
        Self::with_spacing(Spacing::Free)
    }

    /// A reader before the first byte.
    ///
    /// ```
    /// # use plotter_motion::gcode::{Reader, Spacing};
    /// let mut reader = Reader::with_spacing(Spacing::Required);
    /// let block = b"G1X10 Y5\n".iter().find_map(|byte| reader.push(*byte)).unwrap()?;
    /// assert_eq!((block.number(b'X'), block.number(b'Y')), (None, Some(5.0)));
    /// # Ok::<(), plotter_motion::gcode::Error>(())
    /// ```
    #[must_use]
    pub fn with_spacing(spacing: Spacing) -> Self {
        Self {
            state: START,
            spacing,
            cursor: Cursor::START,
            block: Block::empty(),
            sum: 0,
            nested: None,
            pauses: false,
            text: Text::default(),
        }
    }

    /// The place of the byte to come.
    #[must_use]
    pub fn position(&self) -> Position {
        self.cursor.here()
    }

    /// Takes the next byte; gives the line that it ends, or what is wrong with it.
    pub fn push(&mut self, byte: u8) -> Option<Result<Block, Error>> {
        let ended = self.advance(byte)?;
        Some(ended.map(|()| self.take_block()))
    }

    /// As [`Reader::push`]; the line that has ended is the [block](Self::block), until that is
    /// [cleared](Self::clear_block), which must be before the next byte.
    #[cfg_attr(not(target_os = "none"), inline)]
    pub(crate) fn advance(&mut self, byte: u8) -> Option<Result<(), Error>> {
        // Most bytes are digits: such a one changes nothing but its number.
        if let State::Number { number, .. } = &mut self.state
            && number.push(byte)
        {
            self.cursor.pass(byte);
            self.sum ^= byte;
            return None;
        }
        self.advance_other(byte)
    }

    /// The line that has ended.
    pub(crate) const fn block(&self) -> &Block {
        &self.block
    }

    /// What the line that has ended tells people: its last comment, or a message of the lines before it.
    pub(crate) const fn text(&self) -> Text {
        self.text
    }

    /// Forgets the line that has ended.
    pub(crate) fn clear_block(&mut self) {
        self.block.clear();
        self.text = Text::default();
    }

    fn take_block(&mut self) -> Block {
        core::mem::replace(&mut self.block, Block::empty())
    }

    /// The byte to come stands there.
    #[cfg(feature = "alloc")]
    pub(super) fn stand_at(&mut self, cursor: Cursor) {
        self.cursor = cursor;
    }

    /// Goes past bytes that somebody else has read.
    #[cfg(feature = "alloc")]
    pub(super) fn pass_over(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.cursor.pass(*byte));
    }

    /// The number of the letter that has been read, which somebody else has reckoned.
    #[cfg(feature = "alloc")]
    pub(super) fn give_number(&mut self, value: f64) -> Result<(), Error> {
        let State::Letter { letter, at } = self.state else { return Ok(()) };
        let letter = letter.to_ascii_uppercase();
        if value.abs() > MOST {
            return Err(Problem::NumberOutOfRange { letter, value, written: None }.at(at));
        }
        self.put(letter, at, Some(value))
    }

    /// Leaves the line out.
    #[cfg(feature = "alloc")]
    pub(super) fn give_up(&mut self) {
        self.state = State::Skip;
        let _ = self.end_line();
    }

    #[cfg(feature = "alloc")]
    pub(super) fn block_mut(&mut self) -> &mut Block {
        &mut self.block
    }

    /// A byte that does not go on with a number.
    fn advance_other(&mut self, byte: u8) -> Option<Result<(), Error>> {
        let at = self.cursor.here();
        self.cursor.pass(byte);
        if byte == b'\n' || byte == b'\r' {
            return self.end_line();
        }
        let taken = match self.spacing {
            Spacing::Free => self.free(byte, at),
            Spacing::Required => self.spaced(byte, at),
        };
        self.sum ^= byte;
        taken.err().map(|error| {
            self.state = State::Skip;
            Err(error)
        })
    }

    /// Ends the text; gives its last line, if no line end has done so. The reader then waits for another
    /// line.
    pub fn finish(&mut self) -> Option<Result<Block, Error>> {
        let ended = self.end_line()?;
        Some(ended.map(|()| self.take_block()))
    }

    /// As [`Reader::finish`], with the block as [`Reader::advance`] has it.
    pub(crate) fn advance_to_end(&mut self) -> Option<Result<(), Error>> {
        self.end_line()
    }

    /// A byte of a line whose words need no blanks between them.
    fn free(&mut self, byte: u8, at: Position) -> Result<(), Error> {
        match &mut self.state {
            State::Text => {
                self.text.push(byte);
                Ok(())
            }
            State::Skip | State::Lost => Ok(()),
            State::Comment { parentheses: 1, remark } if byte == b')' => {
                self.block.remark = remark.finish().or(self.block.remark);
                self.state = START;
                Ok(())
            }
            State::Comment { parentheses, remark } => {
                remark.push(byte);
                self.text.push(byte);
                match (byte, *parentheses) {
                    (b'(', 1..) => {
                        *parentheses = parentheses.saturating_add(1);
                        self.nested = self.nested.or(Some(at));
                    }
                    (b')', 2..) => *parentheses -= 1,
                    _ => {}
                }
                Ok(())
            }
            State::Checksum { at: star, given } => {
                let star = *star;
                match byte {
                    b'0'..=b'9' => {
                        let digits = given.unwrap_or(0).saturating_mul(10);
                        *given = Some(digits.saturating_add(u16::from(byte - b'0')));
                    }
                    b';' | b'(' => {
                        self.check(star)?;
                        self.comment(byte == b'(');
                    }
                    _ if is_blank(byte) => {}
                    _ => return Err(Problem::UnexpectedByte { byte }.at(at)),
                }
                // Exclusive or with itself: what follows the `*` is no part of the sum.
                self.sum ^= byte;
                Ok(())
            }
            State::Number { letter, at: start, number, blank } => {
                // After the number of an M another one may follow: that of mDraw.
                if is_blank(byte) && !matches!(*letter, b'M' | Word::BARE) {
                    *blank = true;
                    return Ok(());
                }
                let (letter, start, number, blank) = (*letter, *start, *number, *blank);
                match byte {
                    b'.' | b',' => return Err(Problem::BadNumber { letter }.at(start)),
                    b'e' | b'E' if !blank => return Err(Problem::Exponent { letter }.at(start)),
                    _ => self.word(letter, start, Some(number))?,
                }
                if self.state == State::Text {
                    return Ok(());
                }
                let after_m = letter == b'M' && is_blank(byte);
                self.pauses |= after_m && self.block.words().last().is_some_and(is_pause);
                self.between(byte, at, after_m)
            }
            State::Letter { letter, at: start } => {
                let (raw, start) = (*letter, *start);
                let letter = raw.to_ascii_uppercase();
                if let Some(number) = Decimal::begin(byte) {
                    self.state = State::Number { letter, at: start, number, blank: false };
                } else if self.pauses && !matches!(byte, b'(' | b';' | b'*') {
                    self.begin_text(&[raw, byte]);
                } else if !is_blank(byte) {
                    self.word(letter, start, None)?;
                    return self.between(byte, at, false);
                }
                Ok(())
            }
            State::Between { after_m } => {
                let after_m = *after_m;
                self.between(byte, at, after_m)
            }
        }
    }

    /// A byte that is no part of the word before it.
    fn between(&mut self, byte: u8, at: Position, after_m: bool) -> Result<(), Error> {
        let is_first = self.block.words().is_empty();
        self.state = State::Between { after_m };
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' => {
                let letter = byte.to_ascii_uppercase();
                if let Some(number) = self.block.words().last().filter(|word| is_control(word, letter)) {
                    return Err(Problem::Control { number: *number }.at(self.block.place(*number)));
                }
                self.state = State::Letter { letter: byte, at };
            }
            b'(' | b';' => {
                if is_first {
                    self.block.at = at;
                }
                self.comment(byte == b'(');
            }
            b'*' if !is_first => {
                // With this byte it is what it was before.
                self.sum ^= byte;
                self.state = State::Checksum { at, given: None };
            }
            b'%' if is_first => {}
            b'/' if is_first => self.block.deleted = true,
            b'$' if is_first => return Err(Problem::System.at(at)),
            _ if is_blank(byte) => {}
            _ if usize::try_from(at.offset)
                .is_ok_and(|offset| BYTE_ORDER_MARK.get(offset) == Some(&byte)) => {}
            _ => match Decimal::begin(byte) {
                Some(number) if after_m && !self.stops() => {
                    self.state = State::Number { letter: Word::BARE, at, number, blank: false };
                }
                _ if self.pauses => self.begin_text(&[byte]),
                Some(_) => return Err(Problem::NoLetter.at(at)),
                None => return Err(Problem::UnexpectedByte { byte }.at(at)),
            },
        }
        Ok(())
    }

    /// A byte of a line whose words are separated by blanks.
    fn spaced(&mut self, byte: u8, at: Position) -> Result<(), Error> {
        match &mut self.state {
            State::Number { letter, at: start, number, .. } => {
                let (letter, start, number) = (*letter, *start, *number);
                self.word(letter, start, Some(number))?;
                self.state = if is_blank(byte) { START } else { State::Lost };
            }
            State::Letter { letter, at: start } => {
                let (letter, at) = (*letter, *start);
                if let Some(number) = Decimal::begin(byte) {
                    self.state = State::Number { letter, at, number, blank: false };
                } else {
                    self.word(letter, at, None)?;
                    self.state = if is_blank(byte) { START } else { State::Lost };
                }
            }
            State::Between { .. } if byte.is_ascii_alphabetic() => {
                self.state = State::Letter { letter: byte.to_ascii_uppercase(), at };
            }
            State::Between { .. } if !is_blank(byte) => {
                self.state = match Decimal::begin(byte) {
                    Some(number) => State::Number { letter: Word::BARE, at, number, blank: false },
                    None => State::Lost,
                };
            }
            State::Lost if is_blank(byte) => self.state = START,
            _ => {}
        }
        Ok(())
    }

    fn comment(&mut self, parentheses: bool) {
        self.state = State::Comment { parentheses: u16::from(parentheses), remark: RemarkReader::default() };
        self.text = Text::default();
    }

    /// What stands behind `M0` and `M1` and is no word is for people.
    fn begin_text(&mut self, bytes: &[u8]) {
        self.text = Text::default();
        for byte in bytes {
            self.text.push(*byte);
        }
        self.state = State::Text;
    }

    /// Whether the last word is `M0`: a number behind that belongs to its text.
    fn stops(&self) -> bool {
        self.pauses && self.block.words().last().is_some_and(|word| word.number == Some(0.0))
    }

    fn word(&mut self, letter: u8, at: Position, number: Option<Decimal>) -> Result<(), Error> {
        let number = match number.map(|number| (number.value(), number.written())) {
            None => None,
            Some((Some(value), _)) if value.abs() <= MOST => Some(value),
            Some((Some(value), written)) => {
                return Err(Problem::NumberOutOfRange { letter, value, written: Some(written) }.at(at));
            }
            Some((None, _)) if self.spacing == Spacing::Required => None,
            Some((None, _)) => return Err(Problem::BadNumber { letter }.at(at)),
        };
        self.put(letter, at, number)
    }

    fn put(&mut self, letter: u8, at: Position, number: Option<f64>) -> Result<(), Error> {
        if !self.block.push(Word { letter, number, column: at.column }, at) {
            return Err(Problem::TooManyWords.at(at));
        }
        self.state = if is_text(letter, number) { State::Text } else { START };
        Ok(())
    }

    fn check(&mut self, star: Position) -> Result<(), Error> {
        let State::Checksum { given, .. } = self.state else { return Ok(()) };
        if given != Some(u16::from(self.sum)) {
            return Err(Problem::BadChecksum { given, expected: self.sum }.at(star));
        }
        self.block.checked = true;
        Ok(())
    }

    fn end_line(&mut self) -> Option<Result<(), Error>> {
        let ended = match self.state {
            State::Skip => {
                self.block.clear();
                Ok(())
            }
            State::Letter { letter, .. } if self.pauses => {
                self.begin_text(&[letter]);
                Ok(())
            }
            State::Letter { letter, at } => self.word(letter.to_ascii_uppercase(), at, None),
            State::Number { letter, at, number, .. } => self.word(letter, at, Some(number)),
            State::Checksum { at, .. } => self.check(at),
            State::Comment { remark, .. } => {
                self.block.remark = remark.finish().or(self.block.remark);
                Ok(())
            }
            State::Text => {
                let remark = self.pauses.then(|| self.text.remark()).flatten();
                self.block.remark = remark.or(self.block.remark);
                Ok(())
            }
            State::Between { .. } | State::Lost => Ok(()),
        };
        let is_open = matches!(self.state, State::Comment { parentheses: 1.., .. });
        let is_skipped = self.state == State::Skip;
        (self.state, self.sum, self.pauses) = (START, 0, false);
        let nested = self.nested.take().filter(|_| !is_skipped);
        let ended = match nested.filter(|_| is_open || !self.block.words().is_empty()) {
            Some(at) => ended.and(Err(Problem::NestedComment.at(at))),
            None => ended,
        };
        if let Err(error) = ended {
            self.block.clear();
            return Some(Err(error));
        }
        // A pen's number counts without words too.
        if self.block.words().is_empty() && !matches!(self.block.remark, Some(Remark::Pen(_))) {
            self.block.clear();
            self.text = self.text.message();
            return None;
        }
        Some(Ok(()))
    }
}

/// Whether this word is `M0` or `M1`.
fn is_pause(word: &Word) -> bool {
    word.letter == b'M' && matches!(word.number, Some(0.0 | 1.0))
}

/// Whether a letter after this word begins a loop or a subprogram.
pub(crate) fn is_control(before: &Word, letter: u8) -> bool {
    before.letter == b'O' && is_among(letter, CONTROL_WORDS)
}

/// Whether what follows this word up to the end of its line is a text for people, or the name of a file.
pub(crate) fn is_text(letter: u8, number: Option<f64>) -> bool {
    letter == b'M' && number.is_some_and(|number| TEXT_COMMANDS.contains(&number))
}

/// Space, or a control character such as the padding and end marks of old files.
fn is_blank(byte: u8) -> bool {
    byte == b' ' || byte.is_ascii_control()
}
