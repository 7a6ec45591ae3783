//! What can be wrong with a line of a log, and what was lost in all.

use super::MAX_LINE_BYTES;
use core::fmt;
use core::time::Duration;

/// A line that had to be skipped: where, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Damage {
    /// The line, from 1 (the header).
    pub line: u64,
    /// Where the line begins in the (unpacked) log, bytes from 0.
    pub byte_offset: u64,
    /// Length of the line with its end, bytes.
    pub bytes: u64,
    /// Time of the last good record before it.
    pub after: Option<Duration>,
    /// What is wrong.
    pub kind: DamageKind,
}

/// What is wrong with a line.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DamageKind {
    /// The checksum does not fit the line.
    Checksum {
        /// What the line says.
        found: u8,
        /// What its bytes give.
        computed: u8,
    },
    /// The checksum fits, if there is one, but the line does not say a record.
    Syntax(SyntaxError),
    /// The record is earlier than one before it.
    TimeWentBack {
        /// Its time.
        time: Duration,
        /// The greatest time before it.
        previous: Duration,
    },
    /// The log ends inside this line.
    CutEnd,
    /// The end of the line was hit, and nothing else: the records before and after it are read.
    LineEnd,
    /// The line is not UTF-8 text.
    NotUtf8,
    /// The line is longer than [`MAX_LINE_BYTES`].
    TooLong,
    /// The first line is damaged: the log is read with what of its settings can be read.
    Header {
        /// What the JSON reader says.
        message: String,
    },
    /// The source failed; nothing after this place can be read.
    Source {
        /// What the source says.
        message: String,
    },
}

/// Which part of a line makes no sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SyntaxError {
    /// No asterisk and two hex digits at the end.
    NoChecksum,
    /// The time is no whole number of microseconds in 64 bits.
    Time,
    /// The channel is not `>`, `<` or `@`.
    Channel,
    /// The bytes are not pairs of hex digits.
    Bytes,
    /// The event is unknown or its arguments are.
    Payload,
}

/// What a whole log held and what of it was lost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    /// Good records.
    pub records: u64,
    /// Lines that had to be skipped.
    pub damaged_lines: u64,
    /// Bytes in those lines.
    pub damaged_bytes: u64,
    /// Time of the first good record.
    pub first: Option<Duration>,
    /// Time of the last good record.
    pub last: Option<Duration>,
}

impl Summary {
    /// Whether nothing was lost.
    #[must_use]
    pub const fn is_clean(&self) -> bool {
        self.damaged_lines == 0
    }
}

impl From<SyntaxError> for DamageKind {
    fn from(error: SyntaxError) -> Self {
        Self::Syntax(error)
    }
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {} (byte {}", self.line, self.byte_offset)?;
        if let Some(after) = self.after {
            write!(f, ", after {} us", after.as_micros())?;
        }
        write!(f, "): {}", self.kind)
    }
}

impl fmt::Display for DamageKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Checksum { found, computed } => {
                write!(f, "checksum *{found:02x} does not fit the line, whose bytes give *{computed:02x}")
            }
            Self::Syntax(error) => write!(f, "{error}"),
            Self::TimeWentBack { time, previous } => {
                write!(f, "time goes back to {} us after {} us", time.as_micros(), previous.as_micros())
            }
            Self::CutEnd => write!(f, "the log ends inside this line"),
            Self::LineEnd => write!(f, "the line end is damaged; the records on both sides of it are whole"),
            Self::NotUtf8 => write!(f, "not UTF-8 text"),
            Self::TooLong => write!(f, "longer than {MAX_LINE_BYTES} bytes"),
            Self::Header { message } => {
                write!(f, "the first line is damaged: {message}")
            }
            Self::Source { message } => write!(f, "cannot be read any further: {message}"),
        }
    }
}

impl fmt::Display for SyntaxError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoChecksum => "no checksum: expected * and two hex digits at the end",
            Self::Time => "expected a time in whole microseconds, 0 to 2^64 - 1",
            Self::Channel => "expected a channel: >, < or @",
            Self::Bytes => "expected bytes as pairs of hex digits, a space between",
            Self::Payload => {
                "expected edge, drive, switch, estop, pen, target or note with its arguments, and a space before the *"
            }
        })
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plural = |n: u64| if n == 1 { "" } else { "s" };
        write!(f, "{} record{}", self.records, plural(self.records))?;
        if self.is_clean() {
            return write!(f, ", nothing lost");
        }
        write!(
            f,
            ", lost {} line{} ({} byte{})",
            self.damaged_lines,
            plural(self.damaged_lines),
            self.damaged_bytes,
            plural(self.damaged_bytes)
        )
    }
}
