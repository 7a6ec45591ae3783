//! [`ConfigError`]: what is wrong with a machine's description.

use super::MachineKind;
use core::fmt;

/// Errors in a machine's description, each with key, value and remedy.
///
/// Keys are written as in the TOML file, with dots: `x.motor.resistance_ohm`.
///
/// ```
/// # use plotter_motion::{Machine, MachineConfig, config::SerialConfig};
/// let serial = SerialConfig::default().with_baud(25);
/// let refused = Machine::new(MachineConfig::default().with_serial(serial)).unwrap_err();
/// assert_eq!(
///     refused.to_string(),
///     "serial.baud: 25 baud lies outside 300..=4000000 baud; the documented gantry uses 256000"
/// );
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ConfigError {
    /// The description follows another version of the format.
    Schema {
        /// The version it names.
        found: u32,
    },
    /// A value is not finite or outside what any machine of this kind can have.
    OutOfRange {
        /// The key.
        key: &'static str,
        /// The value of the key.
        value: f64,
        /// The least allowed value.
        least: f64,
        /// The greatest allowed value.
        most: f64,
        /// The unit of all three, empty for a plain number.
        unit: &'static str,
        /// The remedy.
        remedy: &'static str,
    },
    /// A value contradicts another one.
    Conflict {
        /// The key.
        key: &'static str,
        /// The value of the key.
        value: f64,
        /// On which side of the limit it must lie.
        bound: Bound,
        /// The limit that the other values set.
        limit: f64,
        /// The unit of both, empty for a plain number.
        unit: &'static str,
        /// The origin of the limit, and the remedy.
        remedy: &'static str,
    },
    /// A choice that does not go with another one.
    Unfit {
        /// The key.
        key: &'static str,
        /// The choice.
        value: &'static str,
        /// The choice that it contradicts, and the remedy.
        remedy: &'static str,
    },
    /// A good description of a machine of another kind than is needed: see
    /// [`Machine::require`](super::Machine::require).
    OtherKind {
        /// The machine's kind.
        found: MachineKind,
        /// The kind that is needed.
        wanted: MachineKind,
        /// The part of the program that needs it.
        user: &'static str,
    },
}

/// On which side of a limit a value must lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Bound {
    /// At the limit or above.
    AtLeast,
    /// Above the limit.
    MoreThan,
    /// At the limit or below.
    AtMost,
    /// Below the limit.
    LessThan,
}

impl Bound {
    /// Whether `value` lies on this side of `limit`; never true when one of them is NaN.
    pub(super) fn holds(self, value: f64, limit: f64) -> bool {
        match self {
            Self::AtLeast => value >= limit,
            Self::MoreThan => value > limit,
            Self::AtMost => value <= limit,
            Self::LessThan => value < limit,
        }
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AtLeast => "at least",
            Self::MoreThan => "more than",
            Self::AtMost => "at most",
            Self::LessThan => "less than",
        })
    }
}

impl ConfigError {
    /// Refuses `value` behind `key` unless it lies on the right side of a limit that other values set, all in
    /// `unit` (empty for a plain number). NaN lies on no side. `remedy` says where the limit is from and what
    /// would be right.
    ///
    /// # Errors
    ///
    /// [`ConfigError::Conflict`].
    pub fn demand(
        key: &'static str,
        value: f64,
        (bound, limit): (Bound, f64),
        unit: &'static str,
        remedy: &'static str,
    ) -> Result<(), Self> {
        if bound.holds(value, limit) {
            Ok(())
        } else {
            Err(Self::Conflict { key, value, bound, limit, unit, remedy })
        }
    }

    /// The key that is wrong, as written in the TOML file.
    #[must_use]
    pub const fn key(&self) -> &'static str {
        match self {
            Self::Schema { .. } => "schema",
            Self::OutOfRange { key, .. } | Self::Conflict { key, .. } | Self::Unfit { key, .. } => key,
            Self::OtherKind { found, wanted, .. } => found.key_beside(*wanted),
        }
    }
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Schema { found } => {
                write!(
                    f,
                    "schema: version {found} is not known; this program reads version 1: write `schema = 1`"
                )
            }
            Self::OutOfRange { key, value, least, most, unit, remedy } => {
                let (value, least, most) = (Number(value), Number(least), Number(most));
                let space = if unit.is_empty() { "" } else { " " };
                if least.0 == most.0 {
                    return write!(f, "{key}: {value}{space}{unit} is not {least}{space}{unit}; {remedy}");
                }
                write!(f, "{key}: {value}{space}{unit} lies outside {least}..={most}{space}{unit}; {remedy}")
            }
            Self::Conflict { key, value, bound, limit, unit, remedy } => {
                let (value, limit) = (Number(value), Number(limit));
                let space = if unit.is_empty() { "" } else { " " };
                write!(f, "{key}: {value}{space}{unit} must be {bound} {limit}{space}{unit}; {remedy}")
            }
            Self::Unfit { key, value, remedy } => write!(f, "{key}: \"{value}\" {remedy}"),
            Self::OtherKind { found, wanted, user } => found.write_refusal(wanted, user, f),
        }
    }
}

impl core::error::Error for ConfigError {}

/// A number as a person would write it.
///
/// Some settings are held in single precision. Written as the `f64` that they become, 0.1 would read
/// 0.10000000149011612; so a number that single precision can hold is written with its digits only. Very
/// small and very large ones take an exponent.
struct Number(f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        /// From here on (and below its inverse) zeros are harder to count than an exponent is to read.
        const LONG: f64 = 1.0e7;
        /// The same at the small end.
        const SHORT: f64 = 1.0e-4;

        let Self(value) = *self;
        #[expect(clippy::cast_possible_truncation, reason = "compared with the original right below")]
        let single = value as f32;
        let is_single = f64::from(single) == value;
        let size = libm::fabs(value);
        let plain = !value.is_finite() || value == 0.0 || (SHORT..LONG).contains(&size);
        match (is_single, plain) {
            (true, true) => write!(f, "{single}"),
            (true, false) => write!(f, "{single:e}"),
            (false, true) => write!(f, "{value}"),
            (false, false) => write!(f, "{value:e}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    #[test]
    fn numbers_read_as_they_were_written() {
        assert_eq!(Number(f64::from(0.1_f32)).to_string(), "0.1");
        assert_eq!(Number(0.1).to_string(), "0.1");
        assert_eq!(Number(99_999.0).to_string(), "99999");
        assert_eq!(Number(6.5e-5).to_string(), "6.5e-5");
        assert_eq!(Number(f64::NAN).to_string(), "NaN");
        assert_eq!(Number(-f64::INFINITY).to_string(), "-inf");
        assert_eq!(Number(0.0).to_string(), "0");
    }
}
