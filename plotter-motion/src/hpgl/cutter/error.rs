//! [`Error`]: what is wrong with a text, or left out of it, and where.

use super::super::Position;
use super::super::error::Shown;
use super::Command;
use core::fmt;

/// Something in a text of a cutter that was not carried out. Reading goes on after it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Error {
    /// Where: the command, or the byte that does not belong there.
    pub at: Position,
    /// What.
    pub problem: Problem,
}

/// Problems in a text for a cutter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Problem {
    /// A command that would draw something and does not here. A notice.
    LeftOut {
        /// The command.
        command: Command,
        /// The remedy.
        remedy: &'static str,
    },
    /// A command that sets what a pen has not: force, speed, blade. A notice, once for each command.
    Setting {
        /// The command.
        command: Command,
    },
    /// A line type: the lines are drawn solid. A notice, once.
    Solid {
        /// The command.
        command: Command,
    },
    /// No such command.
    Unknown {
        /// Letters of the command.
        command: Command,
    },
    /// A byte that no command begins with or holds.
    UnexpectedByte {
        /// The byte.
        byte: u8,
    },
    /// A sign or a point without a digit, a second point, or a number beyond ±2³⁰. The rest of the command is
    /// left out.
    BadNumber {
        /// The command that holds it.
        command: Command,
    },
    /// A command that lacks numbers it cannot do without.
    MissingNumbers {
        /// The command.
        command: Command,
        /// The numbers that the command takes, in words.
        expected: &'static str,
    },
    /// A number that the command does not take.
    BadParameter {
        /// The command.
        command: Command,
        /// The number.
        value: f64,
        /// The numbers that the command takes, in words.
        expected: &'static str,
    },
    /// A number without the other one of its pair.
    OddCoordinates {
        /// The command.
        command: Command,
        /// The lonely number.
        value: f64,
    },
}

impl Error {
    /// Whether the text is right as it is, and only asks for something that is not done here.
    #[must_use]
    pub fn is_notice(&self) -> bool {
        matches!(self.problem, Problem::LeftOut { .. } | Problem::Setting { .. } | Problem::Solid { .. })
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.at)?;
        match self.problem {
            Problem::LeftOut { command, remedy } => {
                write!(f, "{command} ({}) is not supported and is left out: {remedy}", command.meaning())
            }
            Problem::Setting { command } => {
                write!(
                    f,
                    "{command} ({}) means nothing to a pen and is left out, here and below",
                    command.meaning()
                )
            }
            Problem::Solid { command } => {
                write!(
                    f,
                    "{command} ({}) is not supported: its lines are drawn solid, here and below",
                    command.meaning()
                )
            }
            Problem::Unknown { command } => {
                write!(f, "{command} is no known command and is left out: check the language and the letters")
            }
            Problem::UnexpectedByte { byte } => write!(
                f,
                "{} does not belong here: a command is a letter and its numbers, separated by commas",
                Shown(byte)
            ),
            Problem::BadNumber { command } => write!(
                f,
                "{command} holds a malformed number, and its rest is left out: a number is like `-12` or `0.5`, from \
                 -1073741824 to 1073741824"
            ),
            Problem::MissingNumbers { command, expected } => {
                write!(f, "{command} lacks numbers and is left out: it takes {expected}")
            }
            Problem::BadParameter { command, value, expected } => {
                write!(f, "{command} with {value} is left out: it takes {expected}")
            }
            Problem::OddCoordinates { command, value } => {
                write!(f, "{command} has {value} alone, which is left out: give coordinates in pairs")
            }
        }
    }
}

impl core::error::Error for Error {}
