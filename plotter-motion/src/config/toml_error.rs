//! [`TomlError`]: what is wrong with a machine's file, and where.

use super::ConfigError;
use alloc::string::String;
use core::fmt;

/// A place in a text: line and column, both from 1, the column in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TomlPlace {
    /// Line, from 1.
    pub line: usize,
    /// Character in the line, from 1.
    pub column: usize,
}

impl TomlPlace {
    /// The place of byte `offset` of `text`; the end of the text if it has fewer.
    pub(super) fn of(text: &str, offset: usize) -> Self {
        let mut place = Self { line: 1, column: 1 };
        for (_, letter) in text.char_indices().take_while(|(at, _)| *at < offset) {
            if letter == '\n' {
                place = Self { line: place.line + 1, column: 1 };
            } else {
                place.column += 1;
            }
        }
        place
    }
}

impl fmt::Display for TomlPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}", self.line, self.column)
    }
}

/// Errors in a machine's file, each with place, key and remedy.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum TomlError {
    /// The text is longer than any machine's file.
    TooLong {
        /// Length of the file, bytes.
        bytes: usize,
        /// The greatest length that is read.
        limit: usize,
    },
    /// The text is not TOML, or has a key twice.
    Syntax {
        /// Where.
        at: TomlPlace,
        /// Message of the TOML parser.
        message: String,
    },
    /// The file does not say which version of the format it follows.
    MissingSchema,
    /// A key that machines do not have.
    UnknownKey {
        /// Where it stands.
        at: TomlPlace,
        /// The key with its tables.
        key: String,
        /// The key that may have been meant.
        remedy: String,
    },
    /// A value of another kind than the key takes.
    WrongType {
        /// Where it stands.
        at: TomlPlace,
        /// The key with its tables.
        key: String,
        /// The value in the file.
        found: String,
        /// The remedy.
        remedy: String,
    },
    /// A value that no machine can have.
    Invalid {
        /// Where it stands; `None` when the file does not have the key, so that its default holds.
        at: Option<TomlPlace>,
        /// The error in the description.
        error: ConfigError,
    },
}

impl TomlError {
    /// Where in the file it stands, if it stands anywhere.
    #[must_use]
    pub const fn place(&self) -> Option<TomlPlace> {
        match self {
            Self::TooLong { .. } | Self::MissingSchema => None,
            Self::Syntax { at, .. } | Self::UnknownKey { at, .. } | Self::WrongType { at, .. } => Some(*at),
            Self::Invalid { at, .. } => *at,
        }
    }
}

impl fmt::Display for TomlError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLong { bytes, limit } => {
                write!(f, "{bytes} bytes are no machine's file: at most {limit} are read")
            }
            Self::Syntax { at, message } => write!(f, "{at}: {message}"),
            Self::MissingSchema => {
                f.write_str("schema: missing; write `schema = 1` at the top of the file, above all tables")
            }
            Self::UnknownKey { at, key, remedy } => write!(f, "{at}: unknown key `{key}`; {remedy}"),
            Self::WrongType { at, key, found, remedy } => write!(f, "{at}: {key}: {found}; {remedy}"),
            Self::Invalid { at: Some(at), error } => write!(f, "{at}: {error}"),
            Self::Invalid { at: None, error } => write!(f, "{error} (not in the file: the default holds)"),
        }
    }
}

impl core::error::Error for TomlError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Invalid { error, .. } => Some(error),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_not_bytes() {
        let text = "# öä\nx";
        assert_eq!(TomlPlace::of(text, 6), TomlPlace { line: 1, column: 5 });
        assert_eq!(TomlPlace::of(text, 7), TomlPlace { line: 2, column: 1 });
        assert_eq!(TomlPlace::of(text, 999), TomlPlace { line: 2, column: 2 });
    }
}
