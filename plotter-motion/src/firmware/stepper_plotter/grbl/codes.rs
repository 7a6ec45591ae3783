//! Grbl's numbers of errors and alarms.
//!
//! Source: the Grbl project's wiki, "Grbl v1.1 Interface", and its tables of errors and alarms (`doc/csv`).

use crate::decimal_text::Thousandths;
use crate::gcode::{Complaint, Position, Problem, Word};
use crate::homing::HomingError;
use crate::whole::is_whole;

/// What stands after `error:`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Code(pub(super) u8);

impl Code {
    /// G-code words consist of a letter and a value; the letter was not found.
    pub(super) const NO_LETTER: Self = Self(1);
    /// The value of a word is missing, or is no number.
    pub(super) const BAD_NUMBER: Self = Self(2);
    /// A `$` command that is not known.
    pub(super) const BAD_STATEMENT: Self = Self(3);
    /// A negative value where one above 0 is expected.
    pub(super) const NEGATIVE: Self = Self(4);
    /// `$H` where homing is not asked for (`$22`).
    pub(super) const NO_HOMING: Self = Self(5);
    /// A `$` command that is only carried out at rest.
    pub(super) const NOT_IDLE: Self = Self(8);
    /// G-code is locked out in an alarm.
    pub(super) const LOCKED: Self = Self(9);
    /// Too many characters in a line; it was not carried out.
    pub(super) const OVERFLOW: Self = Self(11);
    /// A setting asks a motor for more steps than it can be given.
    pub(super) const STEP_RATE: Self = Self(12);
    /// The target of a jog lies outside the area; it was not carried out.
    pub(super) const JOG_TARGET: Self = Self(15);
    /// A jog with a command that has no place in it.
    pub(super) const BAD_JOG: Self = Self(16);
    /// A command that is not supported.
    pub(super) const UNSUPPORTED: Self = Self(20);
    /// Two commands of the same modal group in a line.
    pub(super) const MODAL_GROUP: Self = Self(21);
    /// The feed rate has not been set.
    pub(super) const NO_FEED: Self = Self(22);
    /// A command that takes a whole number.
    pub(super) const NOT_WHOLE: Self = Self(23);
    /// Two commands that use the axis words.
    pub(super) const AXIS_CONFLICT: Self = Self(24);
    /// A word twice.
    pub(super) const REPEATED: Self = Self(25);
    /// A command that needs axis words has none.
    pub(super) const NO_AXES: Self = Self(26);
    /// The number of a line is too great.
    pub(super) const LINE_NUMBER: Self = Self(27);
    /// A command lacks a word.
    pub(super) const MISSING: Self = Self(28);
    /// There is no such coordinate system.
    pub(super) const NO_SYSTEM: Self = Self(29);
    /// `G53` goes with `G0` and `G1` only.
    pub(super) const NOT_STRAIGHT: Self = Self(30);
    /// Axis words that no command uses.
    pub(super) const AXIS_UNUSED: Self = Self(31);
    /// None of the axes of an arc's plane is named.
    pub(super) const NO_AXES_IN_PLANE: Self = Self(32);
    /// The target of a motion is invalid.
    pub(super) const TARGET: Self = Self(33);
    /// The radius of an arc is invalid.
    pub(super) const RADIUS: Self = Self(34);
    /// An arc lacks its centre.
    pub(super) const CENTRE: Self = Self(35);
    /// Words that nothing uses.
    pub(super) const UNUSED: Self = Self(36);
    /// The length of a tool is along z, and nothing else.
    pub(super) const LENGTH_AXIS: Self = Self(37);
    /// The value of a setting is out of its range. Grbl 1.1 has no number for it; this is that of its
    /// successor grblHAL.
    pub(super) const SETTING_RANGE: Self = Self(52);
    /// `M0`. It is no error: the interpreter leaves it to the controller, which pauses.
    pub(super) const PAUSE: Self = Self(0);
}

impl Complaint for Code {
    /// The number that fits a problem best.
    #[inline(always)] // what is complained of is known where that happens, so that one number is left of all this
    fn of(problem: Problem, _: Position) -> Self {
        match problem {
            Problem::UnexpectedByte { .. } | Problem::NoLetter | Problem::BadChecksum { .. } => {
                Self::NO_LETTER
            }
            Problem::NoNumber { .. }
            | Problem::BadNumber { .. }
            | Problem::Exponent { .. }
            | Problem::NumberOutOfRange { .. } => Self::BAD_NUMBER,
            Problem::System => Self::BAD_STATEMENT,
            Problem::TooManyWords => Self::OVERFLOW,
            Problem::Repeated { .. } => Self::REPEATED,
            Problem::TwoCommands { first, second } if takes_axes(first) && takes_axes(second) => {
                Self::AXIS_CONFLICT
            }
            Problem::TwoCommands { .. } => Self::MODAL_GROUP,
            Problem::Unknown { command } if command.letter == b'M' && is_fraction(command) => Self::NOT_WHOLE,
            Problem::Unused { .. } => Self::UNUSED,
            Problem::BadParameter { word, .. } => match word.number {
                Some(number) if number < 0.0 => Self::NEGATIVE,
                Some(_) if word.letter == b'F' => Self::NO_FEED,
                _ if is_fraction(word) => Self::NOT_WHOLE,
                _ => Self::BAD_NUMBER,
            },
            Problem::Missing { .. } => Self::MISSING,
            Problem::NoMotion => Self::AXIS_UNUSED,
            Problem::ArcForm => Self::CENTRE,
            Problem::ArcWithoutEnd | Problem::ArcRadii { .. } => Self::TARGET,
            Problem::ArcRadius { .. } => Self::RADIUS,
            _ => Self::UNSUPPORTED,
        }
    }

    fn undone(command: Word, _: Position) -> Self {
        if command.letter == b'M' && command.tenths() == Some(0) { Self::PAUSE } else { Self::UNSUPPORTED }
    }
}

/// Whether a command takes the axis words of its line: G0 to G3, G10, G28, G30, G92.
pub(super) fn takes_axes(command: Word) -> bool {
    command.letter == b'G' && matches!(command.tenths(), Some(0 | 10 | 20 | 30 | 100 | 280 | 300 | 920))
}

fn is_fraction(word: Word) -> bool {
    word.number.is_some_and(|number| !is_whole(number))
}

/// What stands after `ALARM:`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Alarm(pub(super) u8);

impl Alarm {
    /// Switched on and not homed, or woken from sleep. It has no number and is not reported as an alarm.
    pub(super) const LOCKED: Self = Self(0);
    /// A limit switch stopped the machine.
    pub(super) const HARD_LIMIT: Self = Self(1);
    /// The target of a motion lies outside the area.
    pub(super) const SOFT_LIMIT: Self = Self(2);
    /// A reset while it moved.
    pub(super) const ABORT: Self = Self(3);
    /// A reset while it homed.
    pub(super) const HOMING_RESET: Self = Self(6);
    /// The emergency stop button. Grbl 1.1 has no number for it; this is that of its successor grblHAL.
    pub(super) const EMERGENCY: Self = Self(10);

    /// As [`Alarm::of`].
    #[cfg(feature = "third-motor")]
    pub(super) const fn of_z(error: super::super::ZHomingError) -> Self {
        match error {
            super::super::ZHomingError::Stuck { .. } => Self(8),
            _ => Self(9),
        }
    }

    /// As [`Alarm::of`].
    #[cfg(feature = "third-motor")]
    pub(super) const fn of_squaring(error: super::super::SquaringError) -> Self {
        match error {
            super::super::SquaringError::Stuck { .. } => Self(8),
            _ => Self(9),
        }
    }

    /// 8: a switch did not open; 9: a switch was not found where it should be.
    pub(super) const fn of(error: HomingError) -> Self {
        match error {
            HomingError::Stuck { .. } | HomingError::Both { .. } => Self(8),
            _ => Self(9),
        }
    }
}

/// The coordinates of a place or a way, mm; the third where there may be one.
#[cfg(not(feature = "third-motor"))]
pub(super) fn coordinates(x: f64, y: f64) -> (Thousandths, Thousandths) {
    (Thousandths::of(x), Thousandths::of(y))
}

/// The coordinates of a place or a way, mm.
#[cfg(feature = "third-motor")]
pub(super) fn coordinates(x: f64, y: f64, z: Option<f64>) -> (Thousandths, Thousandths, Thousandths) {
    (Thousandths::of(x), Thousandths::of(y), Thousandths::of(z.unwrap_or(0.0)))
}

/// A text with the coordinates of a place between two others: where there are two axes, the third is part of
/// the text.
#[cfg(not(feature = "third-motor"))]
macro_rules! placed {
    ($before:literal ($($first:expr),*), $at:expr, $after:literal ($($last:expr),*)) => {
        format_args!(concat!($before, "{},{},0.000", $after), $($first,)* $at.0, $at.1, $($last),*)
    };
}

#[cfg(feature = "third-motor")]
macro_rules! placed {
    ($before:literal ($($first:expr),*), $at:expr, $after:literal ($($last:expr),*)) => {
        format_args!(concat!($before, "{},{},{}", $after), $($first,)* $at.0, $at.1, $at.2, $($last),*)
    };
}

pub(super) use placed;
