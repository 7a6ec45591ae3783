//! [`Position`]: a place in a text.

use core::fmt;

/// Where a byte stands in a text. Counting stops at the greatest number rather than start again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Position {
    /// Bytes before it.
    pub offset: u64,
    /// Line, from 1. A line ends with a line feed.
    pub line: u32,
    /// Byte within the line, from 1.
    pub column: u32,
}

impl Position {
    /// The first byte of a text.
    pub const START: Self = Self { offset: 0, line: 1, column: 1 };

    /// The place after `byte`, which stands here.
    #[must_use]
    pub const fn after(self, byte: u8) -> Self {
        let offset = self.offset.saturating_add(1);
        if byte == b'\n' {
            Self { offset, line: self.line.saturating_add(1), column: 1 }
        } else {
            Self { offset, line: self.line, column: self.column.saturating_add(1) }
        }
    }
}

/// Where a reader stands in its text. A byte changes one number, but for line ends, and the [`Position`] is
/// reckoned when it is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Cursor {
    offset: u64,
    line: u32,
    /// Offset of the first byte of the line.
    line_start: u64,
}

impl Cursor {
    /// Before the first byte of a text.
    pub(crate) const START: Self = Self { offset: 0, line: 1, line_start: 0 };

    /// The place of the byte to come.
    pub(crate) fn here(&self) -> Position {
        let before = u32::try_from(self.offset - self.line_start).unwrap_or(u32::MAX);
        Position { offset: self.offset, line: self.line, column: before.saturating_add(1) }
    }

    /// Goes past a byte.
    pub(crate) fn pass(&mut self, byte: u8) {
        self.offset = self.offset.saturating_add(1);
        if byte == b'\n' {
            self.line = self.line.saturating_add(1);
            self.line_start = self.offset;
        }
    }
}

impl Default for Position {
    fn default() -> Self {
        Self::START
    }
}

impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {} (byte {})", self.line, self.column, self.offset)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cursor_is_where_the_bytes_before_it_lead() {
        let (mut cursor, mut position) = (Cursor::START, Position::START);
        for byte in *b"IN;\r\n\nPU0,0;\n" {
            assert_eq!(cursor.here(), position);
            cursor.pass(byte);
            position = position.after(byte);
        }
        assert_eq!(cursor.here(), Position { offset: 13, line: 4, column: 1 });
        let long = Cursor { offset: u64::MAX, ..Cursor::START };
        assert_eq!(long.here().column, u32::MAX);
    }
}
