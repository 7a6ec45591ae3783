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
