//! [`Reader`]: bytes in, commands and their numbers out.

use super::escape::{Escape, Step};
use super::extension::Extension;
use super::run::{Commands, Run};
use super::{Cursor, Error, Mnemonic, Position, Syntax};
use crate::decimal::Decimal;

/// Greatest magnitude of a number: 2³⁰, the range of the widest HP-GL/2 plotters.
const MAX_NUMBER: f64 = 1_073_741_824.0;
/// What some editors put before a text.
const BYTE_ORDER_MARK: [u8; 3] = [0xef, 0xbb, 0xbf];
/// Ends a label unless `DT` says otherwise: the control character ETX.
const ETX: u8 = 3;

/// One piece of an HPGL text.
///
/// A command comes as [`Event::Command`], then its numbers or bytes as they are read, then its end: the last
/// number or byte says `last`, and where it cannot be known to be the last, [`Event::End`] follows. An
/// [`Error`] in place of an event ends the command too.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Event {
    /// The two letters of a command.
    Command {
        /// The command.
        command: Mnemonic,
        /// Position of its first letter.
        at: Position,
    },
    /// A number of the command; within ±2³⁰.
    Number {
        /// The number.
        value: f64,
        /// Position of its first byte.
        at: Position,
        /// Whether the command ends with it.
        last: bool,
    },
    /// A byte of a label, a string or encoded data.
    Byte {
        /// The byte.
        byte: u8,
        /// Position of the byte.
        at: Position,
        /// Whether the command ends with it.
        last: bool,
    },
    /// The command ends.
    End,
    /// The encoded data of a command ended without their `;` where these commands begin: their letters looked
    /// like digits of a number until a byte came that is none, and have been given as [`Event::Byte`] before.
    /// The last number has to be forgotten. Of the commands each but the last has ended too.
    EndedBy {
        /// The commands.
        commands: Commands,
        /// The first letter of the first of them; the others follow without a gap.
        at: Position,
        /// Whether the last one has ended too.
        last: bool,
        /// The first byte of the last one's data, which is encoded too.
        byte: Option<u8>,
    },
    /// An extension that a cutter's program writes between commands.
    Extension {
        /// The extension.
        extension: Extension,
        /// Position of its first byte.
        at: Position,
    },
    /// An escape sequence. `ESC .` speaks to the plotter's interface and may stand anywhere, also between the
    /// numbers of a command, which it does not disturb. Any other one ends the command.
    Escape {
        /// The byte after the escape: `.` for device control, `%` for a change of language.
        kind: u8,
        /// The byte that says which one: the `Y` of `ESC .Y`, the `B` of `ESC %0B`.
        name: u8,
    },
}

/// Where in the text the reader stands.
#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    /// Between two commands.
    Idle,
    /// One letter of a mnemonic has been read.
    Letter { letter: u8, at: Position },
    /// Before, between or within the numbers of a command.
    Numbers { command: Mnemonic, number: Option<(Decimal, Position)>, comma: Comma },
    /// Within a label.
    Label { command: Mnemonic },
    /// Right after `DT`.
    Terminator { command: Mnemonic },
    /// Right after `SM`.
    Symbol,
    /// Right after `CO`, before its first byte that is not blank.
    Comment { command: Mnemonic },
    /// Within double quotes.
    Quoted { command: Mnemonic },
    /// Within bytes that only `;` ends.
    UntilSemicolon { command: Mnemonic },
    /// Within what a cutter is told about itself, as `!ST1`, before its `;`: after the `!`, or one letter
    /// more, or behind its letters.
    Cutter { at: Position, letters: CutterLetters },
    /// After an error, before the next `;` or letter.
    Skip,
    /// In the other language of a printer, after `ESC %0A`.
    OtherLanguage,
    /// At the start of a line of printer job language, after `ESC %-12345X`, or within one.
    JobLanguage { within: bool },
}

/// How many letters of a cutter's command have been read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CutterLetters {
    None,
    One(u8),
    All,
}

/// What the last separator was, so that a missing number is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Comma {
    /// No number yet: a comma right after the mnemonic is tolerated.
    Leading,
    /// The last thing that was not blank is a number.
    No,
    /// The last thing that was not blank is a comma.
    Yes,
}

/// Splits an HPGL text into commands and their numbers, byte by byte, in constant memory.
///
/// It owns no buffer: a `PD` with a hundred thousand coordinates is a hundred thousand events. It takes
/// - either case, a missing `;`, and a lone `;` anywhere;
/// - numbers with sign and point, separated by commas, blanks or line ends, or by nothing before a sign;
/// - what begins with `!` up to its `;` (a Roland's own settings, as `!ST1;`), and `@` and a byte 3 between
///   commands, as programs for cutters write them ([`Event::Extension`]);
/// - encoded data without their `;` where the next commands begin, as AutoCAD writes them
///   ([`Event::EndedBy`]), or where the text ends;
/// - labels up to their terminator, which `DT` sets and `IN` and `DF` set back, so that a label is never read
///   as commands; strings, comments, and encoded data likewise;
/// - escape sequences: device control (`ESC .`) between any two bytes, and the change of a printer's language
///   (`ESC %0A` … `ESC %0B`), between which nothing is read.
///
/// Control characters count as blanks. After an error the rest of the command is skipped, up to `;` or a
/// letter.
///
/// ```
/// # use plotter_motion::hpgl::{Event, Reader};
/// let mut reader = Reader::new();
/// let mut numbers = Vec::new();
/// for byte in *b"pd10-2.5 , +7;" {
///     if let Some(Event::Number { value, .. }) = reader.push(byte).transpose()? {
///         numbers.push(value);
///     }
/// }
/// assert_eq!(numbers, [10.0, -2.5, 7.0]);
/// # Ok::<(), plotter_motion::hpgl::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reader {
    state: State,
    escape: Escape,
    /// The byte to come.
    cursor: Cursor,
    terminator: u8,
    /// Letters within encoded data that may be commands.
    run: Run,
    /// Whether the terminator belongs to the label (`DT` with a second argument of 0).
    terminator_shows: bool,
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
        Self {
            state: State::Idle,
            escape: Escape::None,
            cursor: Cursor::START,
            terminator: ETX,
            run: Run::NONE,
            terminator_shows: false,
        }
    }

    /// The place of the byte to come.
    #[must_use]
    pub fn position(&self) -> Position {
        self.cursor.here()
    }

    /// Takes the next byte; gives the piece that it completes, if it does.
    ///
    /// The error, if any, says what is wrong with the command in progress, which thereby ends. The next byte
    /// can be pushed all the same.
    #[cfg_attr(not(target_os = "none"), inline)]
    pub fn push(&mut self, byte: u8) -> Option<Result<Event, Error>> {
        // Most bytes are digits: such a one changes nothing but its number.
        if let (State::Numbers { number: Some((digits, _)), .. }, Escape::None) =
            (&mut self.state, self.escape)
            && digits.push(byte)
        {
            self.cursor.pass(byte);
            return None;
        }
        self.push_other(byte)
    }

    /// A byte that does not go on with a number.
    fn push_other(&mut self, byte: u8) -> Option<Result<Event, Error>> {
        let at = self.cursor.here();
        self.cursor.pass(byte);
        match self.escape.push(byte) {
            Step::NotMine => self.plain(byte, at).transpose(),
            Step::Begun => self.interrupt().transpose(),
            Step::Within => None,
            Step::Named { kind, name } => Some(Ok(self.escaped(kind, name))),
            Step::Broken => Some(Err(Error::BadEscape { at, byte: Some(byte) })),
        }
    }

    /// Ends the text; gives the piece that the end completes, if it does. The reader is then between
    /// commands.
    pub fn finish(&mut self) -> Option<Result<Event, Error>> {
        let (state, at) = (self.state, self.cursor.here());
        self.state = State::Idle;
        if self.escape.finish() {
            return Some(Err(Error::BadEscape { at, byte: None }));
        }
        match state {
            State::Idle | State::Skip | State::OtherLanguage | State::JobLanguage { .. } => None,
            State::Cutter { at, letters } => self.cutter_ends(at, letters),
            State::Letter { letter, .. } => Some(Err(Error::BadMnemonic { at, letter, byte: None })),
            State::Numbers { command, number: Some((number, start)), .. } => {
                Some(self.number(command, number, start, true))
            }
            State::Numbers { .. } | State::Terminator { .. } | State::Symbol | State::Comment { .. } => {
                Some(Ok(Event::End))
            }
            // Data say by themselves whether a number is complete.
            State::UntilSemicolon { command } => {
                Some(Ok(self.encoded_ends(command.syntax() == Syntax::Encoded)))
            }
            State::Label { command } | State::Quoted { command } => {
                Some(Err(Error::Unterminated { at, command }))
            }
        }
    }

    /// A byte that is no part of an escape sequence.
    fn plain(&mut self, byte: u8, at: Position) -> Result<Option<Event>, Error> {
        match self.state {
            State::Idle => self.idle(byte, at),
            State::Letter { letter, at: start } => self.second_letter(letter, byte, start, at),
            State::Numbers { command, number, comma } => self.numbers(command, number, comma, byte, at),
            State::Label { .. } if byte == self.terminator => {
                self.state = State::Idle;
                Ok(Some(if self.terminator_shows {
                    Event::Byte { byte, at, last: true }
                } else {
                    Event::End
                }))
            }
            State::Label { .. } => Ok(Some(Event::Byte { byte, at, last: false })),
            State::Terminator { command } => Ok(self.set_terminator(command, byte, at)),
            State::Symbol if byte == b'\r' || byte == b'\n' => Ok(None),
            State::Symbol => {
                self.state = if byte == b';' { State::Idle } else { State::Skip };
                Ok(Some(if byte == b';' { Event::End } else { Event::Byte { byte, at, last: true } }))
            }
            State::Comment { command } => {
                if byte == b'"' {
                    self.state = State::Quoted { command };
                } else if byte == b';' {
                    self.state = State::Idle;
                    return Ok(Some(Event::End));
                } else if !is_blank(byte) {
                    self.state = State::UntilSemicolon { command };
                    return Ok(Some(Event::Byte { byte, at, last: false }));
                }
                Ok(None)
            }
            State::Quoted { command } => {
                if byte == b'"' {
                    self.state = State::Numbers { command, number: None, comma: Comma::No };
                    return Ok(None);
                }
                Ok(Some(Event::Byte { byte, at, last: false }))
            }
            State::UntilSemicolon { command } => {
                if byte == b';' {
                    self.state = State::Idle;
                    return Ok(Some(self.encoded_ends(command.syntax() == Syntax::Encoded)));
                }
                if command.syntax() == Syntax::Encoded
                    && let Some(event) = self.ended_by(byte, at)
                {
                    return Ok(Some(event));
                }
                Ok(Some(Event::Byte { byte, at, last: false }))
            }
            State::Cutter { at: start, letters } => Ok(self.cutter(start, letters, byte)),
            State::Skip => {
                if byte == b';' {
                    self.state = State::Idle;
                } else if byte.is_ascii_alphabetic() {
                    self.state = State::Letter { letter: byte, at };
                }
                Ok(None)
            }
            State::OtherLanguage => Ok(None),
            State::JobLanguage { within } => {
                if within || byte == b'@' || is_blank(byte) {
                    self.state = State::JobLanguage { within: byte == b'@' || (within && byte != b'\n') };
                    return Ok(None);
                }
                self.idle(byte, at)
            }
        }
    }

    fn idle(&mut self, byte: u8, at: Position) -> Result<Option<Event>, Error> {
        if byte.is_ascii_alphabetic() {
            self.state = State::Letter { letter: byte, at };
        } else if let Some(extension) = Extension::of_sign(byte) {
            self.state = State::Idle;
            return Ok(Some(Event::Extension { extension, at }));
        } else if byte == b';' || is_blank(byte) || is_mark(byte, at) {
            self.state = State::Idle;
        } else if byte == b'!' {
            self.state = State::Cutter { at, letters: CutterLetters::None };
        } else {
            self.state = State::Skip;
            return Err(Error::UnexpectedByte { at, command: None, byte });
        }
        Ok(None)
    }

    fn second_letter(
        &mut self,
        letter: u8,
        byte: u8,
        start: Position,
        at: Position,
    ) -> Result<Option<Event>, Error> {
        if is_blank(byte) {
            return Ok(None);
        }
        let Some(command) = Mnemonic::new(letter, byte) else {
            self.state = if byte == b';' { State::Idle } else { State::Skip };
            return Err(Error::BadMnemonic { at, letter, byte: Some(byte) });
        };
        self.state = match command.syntax() {
            Syntax::Numbers | Syntax::Quoted => {
                State::Numbers { command, number: None, comma: Comma::Leading }
            }
            Syntax::Label => State::Label { command },
            Syntax::Terminator => State::Terminator { command },
            Syntax::Symbol => State::Symbol,
            Syntax::Comment => State::Comment { command },
            Syntax::Encoded => {
                self.run = Run::START;
                State::UntilSemicolon { command }
            }
        };
        if matches!(command.letters(), b"IN" | b"DF") {
            self.terminator = ETX;
            self.terminator_shows = false;
        }
        Ok(Some(Event::Command { command, at: start }))
    }

    /// One more byte of what a cutter is told about itself.
    fn cutter(&mut self, at: Position, letters: CutterLetters, byte: u8) -> Option<Event> {
        if matches!(byte, b';' | b'\n' | b'\r') {
            self.state = State::Idle;
            return self.cutter_ends(at, letters).and_then(Result::ok);
        }
        let (letters, extension) = match letters {
            CutterLetters::None if byte.is_ascii_alphabetic() => (CutterLetters::One(byte), None),
            CutterLetters::None => (CutterLetters::All, Some(Extension::setting([0, 0]))),
            CutterLetters::One(first) => {
                let second = if byte.is_ascii_alphabetic() { byte } else { 0 };
                (CutterLetters::All, Some(Extension::setting([first, second])))
            }
            CutterLetters::All => (CutterLetters::All, None),
        };
        self.state = State::Cutter { at, letters };
        extension.map(|extension| Event::Extension { extension, at })
    }

    /// What it was, if that has not been said.
    fn cutter_ends(&self, at: Position, letters: CutterLetters) -> Option<Result<Event, Error>> {
        let letters = match letters {
            CutterLetters::None => [0, 0],
            CutterLetters::One(first) => [first, 0],
            CutterLetters::All => return None,
        };
        Some(Ok(Event::Extension { extension: Extension::setting(letters), at }))
    }

    /// The end of encoded data, or of a comment: maybe of commands that have been taken for data.
    fn encoded_ends(&self, encoded: bool) -> Event {
        match self.run.all_ended() {
            Some((commands, at)) if encoded => Event::EndedBy { commands, at, last: true, byte: None },
            _ => Event::End,
        }
    }

    /// One more byte of encoded data, where it shows that commands have begun.
    fn ended_by(&mut self, byte: u8, at: Position) -> Option<Event> {
        let (commands, start) = self.run.push(byte, at)?;
        let command = commands.last()?;
        let mut event = Event::EndedBy { commands, at: start, last: false, byte: None };
        if command.syntax() == Syntax::Encoded {
            self.run = Run::START;
            let _ = self.run.push(byte, at);
            if let Event::EndedBy { byte: first, .. } = &mut event {
                *first = Some(byte);
            }
            self.state = State::UntilSemicolon { command };
            return Some(event);
        }
        // It is a digit, a sign, a point or a letter: none of them is an error here.
        if let Ok(Some(Event::End)) = self.numbers(command, None, Comma::Leading, byte, at)
            && let Event::EndedBy { last, .. } = &mut event
        {
            *last = true;
        }
        Some(event)
    }

    fn numbers(
        &mut self,
        command: Mnemonic,
        number: Option<(Decimal, Position)>,
        comma: Comma,
        byte: u8,
        at: Position,
    ) -> Result<Option<Event>, Error> {
        // The byte is not part of a number in progress, which takes its own at once: it decides where the
        // reader goes, and whether the number before it, if there is one, is the last.
        let begun = Decimal::begin(byte).map(|digits| (digits, at));
        let (next, last) = if let Some(begun) = begun {
            (State::Numbers { command, number: Some(begun), comma: Comma::No }, false)
        } else if byte == b';' {
            (State::Idle, true)
        } else if byte.is_ascii_alphabetic() {
            (State::Letter { letter: byte, at }, true)
        } else if is_blank(byte) {
            (State::Numbers { command, number: None, comma: after_number(number, comma) }, false)
        } else if byte == b',' && (number.is_some() || comma != Comma::Yes) {
            let comma = if number.is_none() && comma == Comma::Leading { Comma::Leading } else { Comma::Yes };
            (State::Numbers { command, number: None, comma }, false)
        } else if byte == b'"' && number.is_none() && command.syntax() == Syntax::Quoted {
            (State::Quoted { command }, false)
        } else {
            self.state = State::Skip;
            return Err(match byte {
                b',' => Error::MissingNumber { at, command },
                _ => Error::UnexpectedByte { at, command: Some(command), byte },
            });
        };
        // A point right after a complete number, as in 1.2.3, is no new number.
        if let Some((_, start)) = number
            && byte == b'.'
        {
            self.state = State::Skip;
            return Err(Error::BadNumber { at: start, command });
        }
        self.state = next;
        match number {
            Some((number, start)) => self.number(command, number, start, last).map(Some),
            None => Ok(last.then_some(Event::End)),
        }
    }

    /// The event for a number that is complete.
    fn number(
        &mut self,
        command: Mnemonic,
        number: Decimal,
        at: Position,
        last: bool,
    ) -> Result<Event, Error> {
        let error = match number.value() {
            Some(value) if value.abs() <= MAX_NUMBER => {
                if command.letters() == b"DT" {
                    self.terminator_shows = value == 0.0;
                }
                return Ok(Event::Number { value, at, last });
            }
            Some(value) => Error::NumberOutOfRange { at, command, value, written: number.written() },
            None => Error::BadNumber { at, command },
        };
        if !last {
            self.state = State::Skip;
        }
        Err(error)
    }

    fn set_terminator(&mut self, command: Mnemonic, byte: u8, at: Position) -> Option<Event> {
        self.terminator_shows = false;
        if matches!(byte, b';' | b'\n' | 0) {
            self.terminator = ETX;
            self.state = State::Idle;
            return Some(Event::End);
        }
        self.terminator = byte;
        self.state = State::Numbers { command, number: None, comma: Comma::Leading };
        Some(Event::Byte { byte, at, last: false })
    }

    /// An escape byte: it ends a number in progress, and nothing else as yet.
    fn interrupt(&mut self) -> Result<Option<Event>, Error> {
        if let State::Numbers { command, number: Some((number, start)), .. } = self.state {
            self.state = State::Numbers { command, number: None, comma: Comma::No };
            return self.number(command, number, start, false).map(Some);
        }
        Ok(None)
    }

    /// A whole escape sequence.
    fn escaped(&mut self, kind: u8, name: u8) -> Event {
        let opaque = matches!(
            self.state,
            State::Label { .. }
                | State::Quoted { .. }
                | State::OtherLanguage
                | State::Terminator { .. }
                | State::Symbol
        );
        match (kind, name) {
            (b'%', b'A') => self.state = State::OtherLanguage,
            (b'%', b'X') => self.state = State::JobLanguage { within: false },
            (b'%', _) => self.state = State::Idle,
            (b'.', _) => {}
            _ if !opaque => self.state = State::Idle,
            _ => {}
        }
        Event::Escape { kind, name }
    }
}

fn after_number(number: Option<(Decimal, Position)>, comma: Comma) -> Comma {
    if number.is_some() { Comma::No } else { comma }
}

/// Whether a byte is of the mark before a text.
fn is_mark(byte: u8, at: Position) -> bool {
    usize::try_from(at.offset).is_ok_and(|offset| BYTE_ORDER_MARK.get(offset) == Some(&byte))
}

/// Space, line end, or a control character such as the padding and end marks of old files.
fn is_blank(byte: u8) -> bool {
    byte == b' ' || byte.is_ascii_control()
}
