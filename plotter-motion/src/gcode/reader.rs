//! [`Reader`]: bytes in, lines of words out.

use super::block::is_among;
use super::remark::RemarkReader;
use super::{Block, Cursor, Error, Position, Problem, Remark, Word};
use crate::decimal::Decimal;

/// Greatest magnitude of a number: what [`Writer`](super::Writer) writes at most.
pub(crate) const MOST: f64 = 1e9;

/// Commands whose words are a text for people, or the name of a file.
const TEXT_COMMANDS: [f64; 3] = [23.0, 117.0, 118.0];

/// How `sub`, `endsub`, `call`, `if`, `do`, `while`, `repeat`, `break` and `return` begin, which `LinuxCNC` has after an `O` with its
/// number.
const CONTROL_WORDS: &[u8] = b"SECIDWRB";

/// The mark that some editors put before a text.
const BYTE_ORDER_MARK: [u8; 3] = [0xef, 0xbb, 0xbf];

/// What separates two words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Spacing {
    /// Nothing needs to: `G1X10Y5` has three words.
    #[default]
    Free,
    /// Blanks only, as the firmware of mDraw's machines has it: what follows a number up to the next blank is lost, so that
    /// `G1X10 Y5` has two words. There are neither comments nor errors, and numbers may lack their letter anywhere.
    Required,
}

/// Where in a line the reader stands.
#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    /// Between words. A number without a letter may follow an `M`.
    Between { after_m: bool },
    /// After a letter.
    Letter { letter: u8, at: Position },
    /// Within a number.
    Number { letter: u8, at: Position, number: Decimal },
    /// Within parentheses, or after a semicolon.
    Comment { parentheses: bool, remark: RemarkReader },
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
/// It takes words with and without blanks, in either case; numbers with sign and point; comments in `( )` and after `;`; `%`
/// and `/` before a line; checksums (`*71`, the bytes before it by exclusive or), which must be right; lines that end with
/// LF, CR or both. Control characters are blanks. Lines without words give nothing, but for `(pen 2)`.
///
/// An error ends the line: what stands in it is not carried out, and the next one is read as if nothing had been.
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
        Self { state: START, spacing, cursor: Cursor::START, block: Block::empty(), sum: 0 }
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

    /// As [`Reader::push`]; the line that has ended is the [block](Self::block), until that is [cleared](Self::clear_block), which must be
    /// before the next byte.
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

    /// Forgets the line that has ended.
    pub(crate) fn clear_block(&mut self) {
        self.block.clear();
    }

    fn take_block(&mut self) -> Block {
        core::mem::replace(&mut self.block, Block::empty())
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

    /// Ends the text; gives its last line, if no line end has done so. The reader then waits for another line.
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
            State::Text | State::Skip | State::Lost => Ok(()),
            State::Comment { parentheses: true, remark } if byte == b')' => {
                self.block.remark = remark.finish().or(self.block.remark);
                self.state = START;
                Ok(())
            }
            State::Comment { remark, .. } => {
                remark.push(byte);
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
            State::Number { letter, at: start, number } => {
                let (letter, start, number) = (*letter, *start, *number);
                match byte {
                    b'.' | b',' => return Err(Problem::BadNumber { letter }.at(start)),
                    b'e' | b'E' => return Err(Problem::Exponent { letter }.at(start)),
                    _ => self.word(letter, start, Some(number))?,
                }
                if self.state == State::Text {
                    return Ok(());
                }
                self.between(byte, at, letter == b'M' && is_blank(byte))
            }
            State::Letter { letter, at: start } => {
                let (letter, start) = (*letter, *start);
                if let Some(number) = Decimal::begin(byte) {
                    self.state = State::Number { letter, at: start, number };
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
                self.state = State::Letter { letter, at };
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
                Some(number) if after_m => self.state = State::Number { letter: Word::BARE, at, number },
                Some(_) => return Err(Problem::NoLetter.at(at)),
                None => return Err(Problem::UnexpectedByte { byte }.at(at)),
            },
        }
        Ok(())
    }

    /// A byte of a line whose words are separated by blanks.
    fn spaced(&mut self, byte: u8, at: Position) -> Result<(), Error> {
        match &mut self.state {
            State::Number { letter, at: start, number } => {
                let (letter, start, number) = (*letter, *start, *number);
                self.word(letter, start, Some(number))?;
                self.state = if is_blank(byte) { START } else { State::Lost };
            }
            State::Letter { letter, at: start } => {
                let (letter, at) = (*letter, *start);
                if let Some(number) = Decimal::begin(byte) {
                    self.state = State::Number { letter, at, number };
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
                    Some(number) => State::Number { letter: Word::BARE, at, number },
                    None => State::Lost,
                };
            }
            State::Lost if is_blank(byte) => self.state = START,
            _ => {}
        }
        Ok(())
    }

    fn comment(&mut self, parentheses: bool) {
        self.state = State::Comment { parentheses, remark: RemarkReader::default() };
    }

    fn word(&mut self, letter: u8, at: Position, number: Option<Decimal>) -> Result<(), Error> {
        let number = match number.map(|number| number.value().ok_or(number)) {
            None => None,
            Some(Ok(value)) if value.abs() <= MOST => Some(value),
            Some(Ok(value)) => return Err(Problem::NumberOutOfRange { letter, value }.at(at)),
            Some(Err(_)) if self.spacing == Spacing::Required => None,
            Some(Err(_)) => return Err(Problem::BadNumber { letter }.at(at)),
        };
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
            State::Letter { letter, at } => self.word(letter, at, None),
            State::Number { letter, at, number } => self.word(letter, at, Some(number)),
            State::Checksum { at, .. } => self.check(at),
            State::Comment { remark, .. } => {
                self.block.remark = remark.finish().or(self.block.remark);
                Ok(())
            }
            State::Between { .. } | State::Text | State::Lost => Ok(()),
        };
        (self.state, self.sum) = (START, 0);
        if let Err(error) = ended {
            self.block.clear();
            return Some(Err(error));
        }
        // A pen's number counts without words too.
        if self.block.words().is_empty() && !matches!(self.block.remark, Some(Remark::Pen(_))) {
            self.block.clear();
            return None;
        }
        Some(Ok(()))
    }
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
