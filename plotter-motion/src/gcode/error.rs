//! [`Error`]: what is wrong with a text, where, and what would be right.

use super::code::meaning;
use super::{Position, Text, Word};
use crate::gcode::WrittenNumber;
use core::fmt;

/// Something in a text that could not be carried out. Reading goes on with the next line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Error {
    /// The byte the complaint is about.
    pub at: Position,
    /// The problem.
    pub problem: Problem,
}

/// Problems in a program. Unless the variant says otherwise, the line is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Problem {
    /// A byte that no line may hold at this place.
    UnexpectedByte {
        /// The byte.
        byte: u8,
    },
    /// A loop or a subprogram, as `LinuxCNC` has them. What is in it is carried out once, where it stands.
    Control {
        /// The `O` with its number.
        number: Word,
    },
    /// A number without its letter.
    NoLetter,
    /// A letter without its number.
    NoNumber {
        /// The letter.
        letter: u8,
    },
    /// A sign or a point without a digit, a second point, or a comma.
    BadNumber {
        /// The letter before it.
        letter: u8,
    },
    /// A number that an `E` follows without a blank.
    Exponent {
        /// The letter before it.
        letter: u8,
    },
    /// A number beyond ±10⁹.
    NumberOutOfRange {
        /// The letter before it.
        letter: u8,
        /// The number; infinite when it is very long.
        value: f64,
        /// How it was written; `None` of one that a formula gave.
        written: Option<WrittenNumber>,
    },
    /// A comment within a comment, in a line that has words.
    NestedComment,
    /// `M0` or `M1`: the machine waits for a person. A notice.
    Pause {
        /// The command.
        command: Word,
        /// The request, in words.
        text: Text,
    },
    /// A command by its name, whose meaning stands in the controller's configuration. A notice.
    Named {
        /// Name of the command, and the rest of the line.
        name: Text,
    },
    /// Lines behind the end of the program, `M2` or `M30`.
    AfterEnd {
        /// The line in which the program ends.
        line: u32,
    },
    /// A formula that has no value.
    Expression {
        /// The fault, and the remedy.
        what: &'static str,
    },
    /// A variable by its name that has not been set.
    Undefined {
        /// The name.
        name: Text,
    },
    /// A function of a number that has none.
    OutOfDomain {
        /// The function.
        function: &'static str,
        /// The number.
        value: f64,
        /// The range that is allowed, in words.
        expected: &'static str,
    },
    /// A formula whose value is no number, or a greater one than there is.
    NoValue {
        /// The value before the operator; none for a function.
        left: Option<f64>,
        /// The operator or function.
        name: &'static str,
        /// The value behind it.
        right: f64,
    },
    /// A number in a formula that is greater than any there is, as it was written.
    NumberTooGreat {
        /// The number.
        written: WrittenNumber,
    },
    /// A loop, a condition or a subprogram that cannot be carried out.
    Program {
        /// The fault, and the remedy.
        what: &'static str,
    },
    /// A subprogram that is not there.
    NoSubprogram {
        /// Number or name of the subprogram.
        name: Text,
    },
    /// More than 16 words.
    TooManyWords,
    /// A checksum that is another one than the line's.
    BadChecksum {
        /// The number after the `*`; `None` if there is none.
        given: Option<u16>,
        /// The line's.
        expected: u8,
    },
    /// A line that begins with `$`: it speaks to GRBL itself. A notice.
    System,
    /// One letter twice.
    Repeated {
        /// The letter.
        letter: u8,
    },
    /// Two commands that exclude each other.
    TwoCommands {
        /// The former.
        first: Word,
        /// The latter, which the place is of.
        second: Word,
    },
    /// A command that is none.
    Unknown {
        /// The command.
        command: Word,
    },
    /// A command that this reader does not carry out. Only a notice, the rest of the line is carried out.
    Unsupported {
        /// The command.
        command: Word,
        /// The request, in words.
        meaning: &'static str,
    },
    /// A word that the commands of its line do not use. Only a notice, the rest of the line is carried out.
    Unused {
        /// The word.
        word: Word,
    },
    /// A number that its letter does not take.
    BadParameter {
        /// The word.
        word: Word,
        /// The range that is allowed, in words.
        expected: &'static str,
    },
    /// A command without a word that it needs.
    Missing {
        /// The missing word or number.
        expected: &'static str,
    },
    /// Coordinates after `G80`.
    NoMotion,
    /// An arc with a centre and a radius, or with neither.
    ArcForm,
    /// An arc with a radius that ends where it begins: any circle would do.
    ArcWithoutEnd,
    /// An arc of which both ends are unequally far from its centre, by more than 0.5 mm, or by more than
    /// 0.005 mm and a thousandth.
    ArcRadii {
        /// How far its start is, mm.
        start_mm: f64,
        /// How far its end is, mm.
        end_mm: f64,
    },
    /// An arc whose radius does not reach from its start to its end.
    ArcRadius {
        /// The radius, mm.
        radius_mm: f64,
        /// The least that would do, mm.
        least_mm: f64,
    },
}

/// What becomes of a complaint: an [`Error`] for people; for a small program no more than it tells.
pub(crate) trait Complaint: Copy + fmt::Debug + PartialEq {
    /// A problem and where it is.
    fn of(problem: Problem, at: Position) -> Self;

    /// A command that is known and not carried out.
    fn undone(command: Word, at: Position) -> Self;
}

impl Complaint for Error {
    fn of(problem: Problem, at: Position) -> Self {
        Self { at, problem }
    }

    fn undone(command: Word, at: Position) -> Self {
        Self::of(Problem::Unsupported { command, meaning: meaning(command) }, at)
    }
}

impl Problem {
    /// The same, with its place.
    #[inline(always)] // so that a complaint that is no more than a number is never put together
    pub(super) fn at<C: Complaint>(self, at: Position) -> C {
        C::of(self, at)
    }
}

impl Error {
    /// Whether the text is right as it is, and only asks for something that is not done here. Strict reading
    /// passes over it.
    #[must_use]
    pub fn is_notice(&self) -> bool {
        matches!(
            self.problem,
            Problem::Unsupported { .. }
                | Problem::Unused { .. }
                | Problem::System
                | Problem::Pause { .. }
                | Problem::Named { .. }
        )
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.at, self.problem)
    }
}

impl core::error::Error for Error {}

/// As people read it: it quotes what was written, which `defmt` has no other form for.
#[cfg(feature = "defmt")]
impl defmt::Format for Error {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "{}", defmt::Display2Format(self));
    }
}

/// A letter as a person would write it.
struct Letter(u8);

impl fmt::Display for Letter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 == Word::BARE { f.write_str("M") } else { write!(f, "{}", char::from(self.0)) }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::UnexpectedByte { byte: byte @ (b'#' | b'[') } => write!(
                f,
                "`{}` begins {}, which is not reckoned here: have the numbers written out",
                char::from(byte),
                if byte == b'#' { "a variable" } else { "an expression" }
            ),
            Self::Control { number } => {
                write!(
                    f,
                    "{number} controls a loop or a subprogram, which is not done here: have it written out"
                )
            }
            Self::UnexpectedByte { byte } if byte.is_ascii_graphic() => {
                write!(f, "`{}` begins no word: a word is a letter and a number", char::from(byte))
            }
            Self::UnexpectedByte { byte } => {
                write!(f, "byte 0x{byte:02X} begins no word: a word is a letter and a number")
            }
            Self::NoLetter => f.write_str("a number without its letter: a word is like `X10`"),
            Self::NoNumber { letter } => {
                write!(f, "{} lacks its number: a word is like `{0}10`", Letter(letter))
            }
            Self::BadNumber { letter } => {
                write!(f, "{} has a malformed number: a number is like `-12` or `0.5`", Letter(letter))
            }
            Self::Exponent { letter } => {
                write!(f, "{} has a number with an exponent: write `1500`, not `1.5e3`", Letter(letter))
            }
            Self::NumberOutOfRange { letter, value, written } => {
                let letter = Letter(letter);
                match written {
                    Some(written) => write!(f, "{letter} with {written}")?,
                    None => write!(f, "{letter} with {}", Shown(value))?,
                }
                f.write_str(": numbers reach from -1000000000 to 1000000000")
            }
            Self::NestedComment => f.write_str(
                "a comment begins within a comment, of which controllers end the outer one with the inner one: take the inner \
                 parentheses away",
            ),
            Self::Pause { command, text } if text.is_empty() => {
                write!(f, "{command} (pause) is not supported and is left out")
            }
            Self::Pause { command, text } => {
                write!(f, "{command} (pause: {text}) is not supported and is left out")
            }
            Self::Named { name } => write!(
                f,
                "`{name}` is a command of the controller's own, by its name, and is left out; if it lifts or lowers the pen, say \
                 so"
            ),
            Self::AfterEnd { line } => write!(
                f,
                "the program has ended in line {line} by M2 or M30, and what follows is not drawn: take that word away to draw it"
            ),
            Self::Expression { what } | Self::Program { what } => f.write_str(what),
            Self::Undefined { name } => write!(f, "#<{name}> has no value: set it before, as in `#<{name}> = 5`"),
            Self::OutOfDomain { function, value, expected } => {
                write!(f, "{function} of {} is no number: it takes {expected}", Shown(value))
            }
            Self::NoValue { left: Some(left), name, right } => {
                write!(f, "`{} {name} {}` is no number, or one beyond {LARGEST}", Shown(left), Shown(right))
            }
            Self::NoValue { left: None, name, right } => {
                write!(f, "{name} of {} is a number beyond {LARGEST}", Shown(right))
            }
            Self::NumberTooGreat { written } => write!(f, "{written} lies beyond {LARGEST}"),
            Self::NoSubprogram { name } => write!(
                f,
                "there is no subprogram `{name}`: LinuxCNC's begins with `O{name} sub`, before its call, and Fanuc's with `O{name}` in a \
                 line of its own, in the same file"
            ),
            Self::TooManyWords => f.write_str("more than 16 words: divide the line"),
            Self::BadChecksum { given: Some(given), expected } => {
                write!(f, "checksum *{given} of a line whose bytes make *{expected}: send it again")
            }
            Self::BadChecksum { given: None, expected } => {
                write!(f, "a checksum without its number: the bytes make *{expected}")
            }
            Self::System => f.write_str("$ speaks to the controller, not the plotter, and is left out"),
            Self::Repeated { letter } => write!(f, "{} stands twice: divide the line", Letter(letter)),
            Self::TwoCommands { first, second } => {
                write!(f, "{second} excludes {first}, which stands before it: divide the line")
            }
            Self::Unknown { command } => write!(f, "{command} is no known command: check its number"),
            Self::Unsupported { command, meaning } => {
                write!(f, "{command} ({meaning}) is not supported and is left out")
            }
            Self::Unused { word } => {
                write!(f, "{word} means nothing to the commands of its line and is left out")
            }
            Self::BadParameter { word, expected } => write!(f, "{word} is wrong: {expected}"),
            Self::Missing { expected } => f.write_str(expected),
            Self::NoMotion => f.write_str("coordinates that no command asks for: put G0 or G1 before them"),
            Self::ArcForm => f.write_str("an arc needs its centre, I and J, or its radius, R, and not both"),
            Self::ArcWithoutEnd => f.write_str(
                "an arc that ends where it begins needs its centre, I and J: a radius does not tell it",
            ),
            Self::ArcRadii { start_mm, end_mm } => write!(
                f,
                "an arc begins {start_mm:.3} mm from its centre and ends {end_mm:.3} mm from it: check I and J, which \
                 count from its beginning"
            ),
            Self::ArcRadius { radius_mm, least_mm } => write!(
                f,
                "an arc of a radius of {radius_mm:.3} mm does not reach its end: it needs {least_mm:.3} mm or more"
            ),
        }
    }
}

/// The greatest number that a formula can have, in words.
const LARGEST: &str = "1.8e308: write the formula so that smaller numbers come of it";

/// A number of a formula: a long one with an exponent, which tells more than three hundred digits.
struct Shown(f64);

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let magnitude = self.0.abs();
        if magnitude != 0.0 && !(1e-6..1e15).contains(&magnitude) {
            write!(f, "{:e}", self.0)
        } else {
            write!(f, "{}", self.0)
        }
    }
}
