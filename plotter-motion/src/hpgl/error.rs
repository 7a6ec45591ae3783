//! [`Error`]: what is wrong with a text, where, and what would be right.

use super::{Extension, Mnemonic, Position, Syntax};
use crate::gcode::WrittenNumber;
use core::fmt;

/// Something in an HPGL text that could not be carried out. Reading goes on after it.
///
/// `at` is the byte the complaint is about, `command` the command it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A command that this reader does not carry out. Only a notice: it is well understood where the command
    /// ends, and it is skipped whole. See [`Error::is_notice`].
    Unsupported {
        /// Position of its first letter.
        at: Position,
        /// The command.
        command: Mnemonic,
    },
    /// An extension of HPGL by programs for cutters, for parts that a pen plotter lacks. A notice, once for
    /// each kind.
    Extension {
        /// Position of its first byte.
        at: Position,
        /// The extension.
        extension: Extension,
    },
    /// A byte that no command may hold at this place. The rest of the command is skipped.
    UnexpectedByte {
        /// The byte.
        at: Position,
        /// The command that holds it; `None` between commands.
        command: Option<Mnemonic>,
        /// The byte.
        byte: u8,
    },
    /// A letter that no second letter follows.
    BadMnemonic {
        /// Position after the letter.
        at: Position,
        /// The letter.
        letter: u8,
        /// Byte after the letter; `None` at the end of the text.
        byte: Option<u8>,
    },
    /// A sign or a point without a digit, or a second point. The rest of the command is skipped.
    BadNumber {
        /// Where the number starts.
        at: Position,
        /// The command that holds it.
        command: Mnemonic,
    },
    /// Two commas with nothing between them. The rest of the command is skipped.
    MissingNumber {
        /// The second comma.
        at: Position,
        /// The command that lacks it.
        command: Mnemonic,
    },
    /// A number beyond ±2³⁰. The rest of the command is skipped.
    NumberOutOfRange {
        /// Where the number starts.
        at: Position,
        /// The command that holds it.
        command: Mnemonic,
        /// The number; infinite when it is very long.
        value: f64,
        /// How it was written.
        written: WrittenNumber,
    },
    /// The text ends within a label, a string or encoded data.
    Unterminated {
        /// Where the text ends.
        at: Position,
        /// The command without end.
        command: Mnemonic,
    },
    /// An escape sequence that is none.
    BadEscape {
        /// Position after the escape.
        at: Position,
        /// The byte there; `None` at the end of the text.
        byte: Option<u8>,
    },
    /// An x without its y. The pairs before it have been carried out.
    OddCoordinates {
        /// The lonely x.
        at: Position,
        /// The command that holds it.
        command: Mnemonic,
        /// The lonely x.
        x: f64,
    },
    /// A command that lacks a number it cannot do without. It is skipped.
    MissingParameter {
        /// Position of its first letter.
        at: Position,
        /// The command.
        command: Mnemonic,
        /// The numbers that the command needs, in words.
        expected: &'static str,
    },
    /// A number that the command does not take. The command is skipped.
    BadParameter {
        /// Where the number starts.
        at: Position,
        /// The command that holds it.
        command: Mnemonic,
        /// The number.
        value: f64,
        /// The numbers that the command takes, in words.
        expected: &'static str,
    },
    /// A command that has no place between `PM0` and `PM2`. It is left out.
    NotInPolygon {
        /// Position of its first letter.
        at: Position,
        /// The command.
        command: Mnemonic,
    },
    /// The polygon buffer is full. The sides that do not fit are drawn as they come.
    PolygonTooLong {
        /// The first letter of the command whose side does not fit.
        at: Position,
        /// The command.
        command: Mnemonic,
        /// How many places the buffer has.
        places: u32,
    },
    /// A set of characters whose signs are not known here. Only a notice: labels are drawn in ASCII. See
    /// [`Error::is_notice`].
    UnknownSigns {
        /// The first letter of the command.
        at: Position,
        /// `CS` or `CA`.
        command: Mnemonic,
        /// Number of the set.
        set_number: f64,
    },
    /// A character of `DL` for which there is no room: 255 numbers each, and all together a byte for each
    /// place of the polygon buffer. It is left out.
    NoRoomForCharacter {
        /// The first letter of the command.
        at: Position,
        /// The command.
        command: Mnemonic,
    },
    /// A polygon that did not fit into the buffer is not filled.
    NotFilled {
        /// The command that should fill it.
        at: Position,
        /// The command.
        command: Mnemonic,
    },
    /// Lines so near to each other that a polygon would have more than 16,384 of them. It is not filled.
    TooFine {
        /// The command that should fill it.
        at: Position,
        /// The command.
        command: Mnemonic,
        /// Distance of the lines, mm.
        spacing_mm: f64,
    },
    /// A label whose place depends on its length, or that is drawn later (`BL`), has more than 150
    /// characters: the others are left out.
    LabelTooLong {
        /// Position of its first letter.
        at: Position,
        /// The command.
        command: Mnemonic,
    },
    /// More numbers than the command takes. It is carried out without them.
    TooManyParameters {
        /// Position of its first letter.
        at: Position,
        /// The command.
        command: Mnemonic,
        /// How many it was given.
        given: u32,
        /// How many it takes at most.
        takes: u32,
    },
}

impl Error {
    /// Where it is.
    #[must_use]
    pub fn position(&self) -> Position {
        match *self {
            Self::Unsupported { at, .. }
            | Self::Extension { at, .. }
            | Self::UnexpectedByte { at, .. }
            | Self::BadMnemonic { at, .. }
            | Self::BadNumber { at, .. }
            | Self::MissingNumber { at, .. }
            | Self::NumberOutOfRange { at, .. }
            | Self::Unterminated { at, .. }
            | Self::BadEscape { at, .. }
            | Self::OddCoordinates { at, .. }
            | Self::MissingParameter { at, .. }
            | Self::BadParameter { at, .. }
            | Self::NotInPolygon { at, .. }
            | Self::PolygonTooLong { at, .. }
            | Self::UnknownSigns { at, .. }
            | Self::NoRoomForCharacter { at, .. }
            | Self::NotFilled { at, .. }
            | Self::TooFine { at, .. }
            | Self::LabelTooLong { at, .. }
            | Self::TooManyParameters { at, .. } => at,
        }
    }

    /// The command it is about; `None` outside of commands.
    #[must_use]
    pub fn command(&self) -> Option<Mnemonic> {
        match *self {
            Self::UnexpectedByte { command, .. } => command,
            Self::Extension { .. } | Self::BadMnemonic { .. } | Self::BadEscape { .. } => None,
            Self::Unsupported { command, .. }
            | Self::BadNumber { command, .. }
            | Self::MissingNumber { command, .. }
            | Self::NumberOutOfRange { command, .. }
            | Self::Unterminated { command, .. }
            | Self::OddCoordinates { command, .. }
            | Self::MissingParameter { command, .. }
            | Self::BadParameter { command, .. }
            | Self::NotInPolygon { command, .. }
            | Self::PolygonTooLong { command, .. }
            | Self::UnknownSigns { command, .. }
            | Self::NoRoomForCharacter { command, .. }
            | Self::NotFilled { command, .. }
            | Self::TooFine { command, .. }
            | Self::LabelTooLong { command, .. }
            | Self::TooManyParameters { command, .. } => Some(command),
        }
    }

    /// Whether the text is right as it is, and only asks for something that is not done here. Strict reading
    /// passes over it.
    #[must_use]
    pub fn is_notice(&self) -> bool {
        match self {
            Self::Unsupported { command, .. } => command.meaning().is_some(),
            Self::UnknownSigns { .. } | Self::Extension { .. } => true,
            _ => false,
        }
    }
}

/// A byte as a person would write it.
pub(super) struct Shown(pub(super) u8);

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_ascii_graphic() {
            write!(f, "`{}`", char::from(self.0))
        } else {
            write!(f, "byte 0x{:02X}", self.0)
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.position())?;
        match *self {
            Self::Unsupported { command, .. } => match command.meaning() {
                Some(meaning) => write!(f, "{command} ({meaning}) is not supported and is left out"),
                None => write!(f, "{command} is no known command and is left out: check its two letters"),
            },
            Self::Extension { extension, .. } => write!(
                f,
                "{extension} ({}) is for cutters and means nothing to a pen: it is left out, here and below",
                extension.meaning()
            ),
            Self::UnexpectedByte { command: Some(command), byte, .. }
                if command.syntax() == Syntax::Encoded =>
            {
                write!(
                    f,
                    "{} does not belong into {command}, whose rest is left out: its data are digits from `?` on and the flags \
                     `<`, `=`, `>`, `:` and `7`; end them with `;`",
                    Shown(byte)
                )
            }
            Self::UnexpectedByte { command: Some(command), byte, .. } => write!(
                f,
                "{} does not belong into {command}, whose rest is left out: separate numbers by commas and end \
                 the command with `;`",
                Shown(byte)
            ),
            Self::UnexpectedByte { command: None, byte, .. } => {
                write!(f, "{} begins no command: a command is two letters", Shown(byte))
            }
            Self::BadMnemonic { letter, byte: Some(byte), .. } => write!(
                f,
                "{} after the letter {} makes no command: a command is two letters",
                Shown(byte),
                Shown(letter)
            ),
            Self::BadMnemonic { letter, byte: None, .. } => {
                write!(f, "the text ends after the letter {}: a command is two letters", Shown(letter))
            }
            Self::BadNumber { command, .. } => write!(
                f,
                "{command} holds a malformed number, and its rest is left out: a number is like `-12` or `0.5`"
            ),
            Self::MissingNumber { command, .. } => write!(
                f,
                "{command} lacks a number between two commas, and its rest is left out: write the number, \
                 0 included"
            ),
            Self::NumberOutOfRange { command, written, .. } => write!(
                f,
                "{command} holds the number {written}, and its rest is left out: numbers reach from -1073741824 to \
                 1073741824"
            ),
            Self::Unterminated { command, .. } => write!(
                f,
                "the text ends within {command}: it must be ended by {}",
                match command.syntax() {
                    Syntax::Label => "the label terminator (byte 0x03 unless DT sets another)",
                    Syntax::Quoted | Syntax::Comment => "`\"`",
                    _ => "`;`",
                }
            ),
            Self::BadEscape { byte: Some(byte), .. } => {
                write!(f, "{} after an escape byte begins no sequence: remove the escape", Shown(byte))
            }
            Self::BadEscape { byte: None, .. } => f.write_str("the text ends within an escape sequence"),
            Self::OddCoordinates { command, x, .. } => {
                write!(
                    f,
                    "{command} has an x of {x} without a y, which is left out: give coordinates in pairs"
                )
            }
            Self::MissingParameter { command, expected, .. } => {
                write!(f, "{command} lacks {expected} and is left out")
            }
            Self::BadParameter { command, value, expected, .. } => {
                write!(f, "{command} with {value} is left out: it takes {expected}")
            }
            Self::NotInPolygon { command, .. } => {
                write!(
                    f,
                    "{command} has no place in a polygon and is left out: end the polygon with PM2 first"
                )
            }
            Self::PolygonTooLong { command, places, .. } => write!(
                f,
                "{command} adds to a polygon that is longer than the {places} places there are for it: what follows is \
                 drawn at once, and the polygon cannot be filled"
            ),
            Self::UnknownSigns { command, set_number, .. } => write!(
                f,
                "{command} chooses character set {set_number}, whose signs are not known here: labels are drawn in ASCII; known \
                 are 0, 6, 7, 9, 30 to 39, and -1 for the characters of DL"
            ),
            Self::NoRoomForCharacter { command, .. } => write!(
                f,
                "{command} has no room for its character, which is left out: it may have 255 numbers, and fewer if many \
                 are kept; DL without numbers forgets all"
            ),
            Self::NotFilled { command, .. } => {
                write!(f, "{command} fills no polygon that did not fit: divide it into smaller ones")
            }
            Self::TooFine { command, spacing_mm, .. } => write!(
                f,
                "{command} would fill with more than 16384 lines, {spacing_mm:.6} mm apart, and is left out: set a wider \
                 pen (PW) or distance (FT)"
            ),
            Self::LabelTooLong { command, .. } => write!(
                f,
                "{command} has more than 150 characters, and those are left out: only LB with label origin 1 (LO1) may be \
                 longer"
            ),
            Self::TooManyParameters { command, given, takes, .. } => {
                write!(f, "{command} has {given} numbers and takes {takes}: the others are left out")
            }
        }
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
