//! The text that fed the first semi-virtual gantry: one pen movement a line, in encoder counts.
//!
//! ```text
//! PU, 02993, 13955        lift the pen and go to x = 2993, y = 13955
//! PD, 02995, 15200        draw from there to x = 2995, y = 15200
//! ```
//!
//! The coordinates are five decimal digits, because the controller took them over its serial line as ten
//! digits: nothing below 0 or above 99999 can be said.
//!
//! Source: Öcal's thesis on the semi-virtual plotter, section 3.3.2 and figure 3-15.
//!
//! ```
//! use plotter_motion::hpgl::thesis_text::{Line, read, write_moves};
//! use plotter_motion::{Pen, PenMove, StepPoint};
//!
//! let first = PenMove { pen: Pen::Up, target: StepPoint::new(2993, 13955) };
//! let mut text = String::new();
//! write_moves([first], &mut text)?;
//! assert_eq!(text, "PU, 02993, 13955\n");
//!
//! let lines: Vec<_> = read(b"Command, X coordinate, Y coordinate\r\npu,2993,  13955\r\n").collect();
//! assert_eq!(lines, [Ok(Line::Header { line: 1 }), Ok(Line::Move(first))]);
//! # Ok::<(), plotter_motion::hpgl::thesis_text::WriteError>(())
//! ```

use super::Position;
use crate::{Pen, PenMove, PlotOp, StepPoint};
use core::fmt;

/// Greatest coordinate that five digits hold, encoder counts.
pub const MAX_COUNTS: i32 = crate::protocol::digits::GREATEST;

/// Why a movement could not be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum WriteError {
    /// A coordinate is below 0 or above 99999.
    OutOfRange {
        /// The place asked for, encoder counts.
        to: StepPoint,
    },
    /// The sink refused text.
    Output,
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange { to } => write!(
                f,
                "point ({}, {}) lies outside 0..=99999 encoder counts: move the drawing or take fewer counts per mm",
                to.x, to.y
            ),
            Self::Output => f.write_str("the output refused the text"),
        }
    }
}

impl core::error::Error for WriteError {}

/// Writes one line a movement.
///
/// # Errors
///
/// The first point outside `0..=99999` ends the writing; the lines before it have been written.
pub fn write_moves<W: fmt::Write>(
    moves: impl IntoIterator<Item = PenMove>,
    out: &mut W,
) -> Result<(), WriteError> {
    for PenMove { pen, target: to } in moves {
        let fits = |counts: i32| (0..=MAX_COUNTS).contains(&counts);
        if !fits(to.x) || !fits(to.y) {
            return Err(WriteError::OutOfRange { to });
        }
        let command = match pen {
            Pen::Up => "PU",
            Pen::Down => "PD",
        };
        writeln!(out, "{command}, {:05}, {:05}", to.x, to.y).map_err(|_| WriteError::Output)?;
    }
    Ok(())
}

/// Contents of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Line {
    /// A movement.
    Move(PenMove),
    /// Words before the first movement, such as the names of the columns. Passed over.
    Header {
        /// Number of the line, from 1.
        line: u32,
    },
    /// Nothing. Passed over.
    Blank {
        /// Number of the line, from 1.
        line: u32,
    },
}

/// Faults of a line, which is left out. The lines after it are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Error {
    /// The line begins with something else than `PU` or `PD`.
    UnknownCommand {
        /// The first byte that does not fit.
        at: Position,
    },
    /// A number is expected.
    ExpectedNumber {
        /// Position of the other byte, or of the end of the line.
        at: Position,
        /// The byte there; `None` at the end of the line.
        byte: Option<u8>,
    },
    /// A comma is expected after the command or after x.
    ExpectedComma {
        /// Position of the other byte.
        at: Position,
        /// The byte there.
        byte: u8,
    },
    /// A coordinate is below 0 or above 99999.
    OutOfRange {
        /// Where it starts.
        at: Position,
        /// The coordinate; numbers of more than nine digits end at 999999999.
        value: i32,
    },
    /// Something follows y.
    Trailing {
        /// Its first byte.
        at: Position,
        /// The byte there.
        byte: u8,
    },
}

impl Error {
    /// Where it is.
    #[must_use]
    pub fn position(&self) -> Position {
        match *self {
            Self::UnknownCommand { at }
            | Self::ExpectedNumber { at, .. }
            | Self::ExpectedComma { at, .. }
            | Self::OutOfRange { at, .. }
            | Self::Trailing { at, .. } => at,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.position())?;
        match *self {
            Self::UnknownCommand { .. } => f.write_str("a line begins with PU or PD: `PU, 02993, 13955`"),
            Self::ExpectedNumber { byte: Some(byte), .. } => write!(
                f,
                "`{}` stands where a number belongs: write five digits for x and for y",
                byte.escape_ascii()
            ),
            Self::ExpectedNumber { byte: None, .. } => {
                f.write_str("the line ends where a number belongs: write five digits for x and for y")
            }
            Self::ExpectedComma { byte, .. } => {
                write!(f, "`{}` stands where a comma belongs: `PU, 02993, 13955`", byte.escape_ascii())
            }
            Self::OutOfRange { value, .. } => {
                write!(f, "coordinate {value} lies outside 0..=99999 encoder counts: move the drawing")
            }
            Self::Trailing { byte, .. } => {
                write!(f, "`{}` follows the y coordinate: end the line there", byte.escape_ascii())
            }
        }
    }
}

impl core::error::Error for Error {}

/// A coordinate in progress.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Number {
    at: Position,
    negative: bool,
    /// `None` before the first digit.
    magnitude: Option<i32>,
}

impl Number {
    /// Greatest number of nine digits; longer ones end here.
    const GREATEST: i32 = 999_999_999;

    fn begin(byte: u8, at: Position) -> Option<Self> {
        let number = Self { at, negative: byte == b'-', magnitude: None };
        if matches!(byte, b'-' | b'+') { Some(number) } else { number.with(byte) }
    }

    fn with(self, byte: u8) -> Option<Self> {
        let digit = byte.is_ascii_digit().then(|| i32::from(byte - b'0'))?;
        let magnitude = self.magnitude.unwrap_or(0).saturating_mul(10).saturating_add(digit);
        Some(Self { magnitude: Some(magnitude.min(Self::GREATEST)), ..self })
    }

    /// The coordinate, which `byte` at `at` ends.
    fn counts(self, byte: Option<u8>, at: Position) -> Result<i32, Error> {
        let magnitude = self.magnitude.ok_or(Error::ExpectedNumber { at, byte })?;
        let value = if self.negative { -magnitude } else { magnitude };
        if (0..=MAX_COUNTS).contains(&value) {
            Ok(value)
        } else {
            Err(Error::OutOfRange { at: self.at, value })
        }
    }
}

/// How far into a line the text is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Start,
    /// After a `P`.
    Command,
    /// Before a coordinate: y, if `x` is known. `comma` says whether the comma has come.
    Before {
        pen: Pen,
        x: Option<i32>,
        comma: bool,
    },
    /// Within a coordinate.
    Within {
        pen: Pen,
        x: Option<i32>,
        number: Number,
    },
    /// After y.
    Done(PenMove),
    /// The line is wrong; its end is awaited.
    Wrong(Error),
}

/// Reads the text byte by byte, in constant memory; see the [module](self).
///
/// Lines end with a line feed; carriage returns, blanks around anything, either case, fewer than five digits
/// and blanks in place of commas are tolerated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reader {
    state: State,
    at: Position,
    any_move: bool,
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
        Self { state: State::Start, at: Position::START, any_move: false }
    }

    /// Takes the next byte; gives the line that it ends, if it does.
    pub fn push(&mut self, byte: u8) -> Option<Result<Line, Error>> {
        let at = self.at;
        self.at = at.after(byte);
        if byte == b'\n' {
            return Some(self.end_line(at));
        }
        self.state = match self.state {
            State::Start | State::Before { .. } | State::Done(_) if is_blank(byte) => self.state,
            State::Start if byte.eq_ignore_ascii_case(&b'P') => State::Command,
            State::Command if byte.eq_ignore_ascii_case(&b'U') => {
                State::Before { pen: Pen::Up, x: None, comma: false }
            }
            State::Command if byte.eq_ignore_ascii_case(&b'D') => {
                State::Before { pen: Pen::Down, x: None, comma: false }
            }
            State::Start | State::Command => State::Wrong(Error::UnknownCommand { at }),
            State::Before { pen, x, comma: false } if byte == b',' => State::Before { pen, x, comma: true },
            State::Before { pen, x, comma } => match Number::begin(byte, at) {
                Some(number) => State::Within { pen, x, number },
                None if comma => State::Wrong(Error::ExpectedNumber { at, byte: Some(byte) }),
                None => State::Wrong(Error::ExpectedComma { at, byte }),
            },
            State::Within { pen, x, number } => match number.with(byte) {
                Some(number) => State::Within { pen, x, number },
                None => after_number(pen, x, number, byte, at).unwrap_or_else(State::Wrong),
            },
            State::Done(_) => State::Wrong(Error::Trailing { at, byte }),
            State::Wrong(error) => State::Wrong(error),
        };
        None
    }

    /// Ends the text; gives its last line, if that has no line feed. The reader is then at the start of a
    /// line.
    pub fn finish(&mut self) -> Option<Result<Line, Error>> {
        if self.at.column == 1 {
            return None;
        }
        let line = self.end_line(self.at);
        self.at.column = 1;
        Some(line)
    }

    fn end_line(&mut self, at: Position) -> Result<Line, Error> {
        let line = at.line;
        let movement = match core::mem::replace(&mut self.state, State::Start) {
            State::Start => return Ok(Line::Blank { line }),
            State::Wrong(Error::UnknownCommand { .. }) | State::Command if !self.any_move => {
                return Ok(Line::Header { line });
            }
            State::Command => return Err(Error::UnknownCommand { at }),
            State::Wrong(error) => return Err(error),
            State::Before { .. } | State::Within { x: None, .. } => {
                return Err(Error::ExpectedNumber { at, byte: None });
            }
            State::Within { pen, x: Some(x), number } => {
                PenMove { pen, target: StepPoint::new(x, number.counts(None, at)?) }
            }
            State::Done(movement) => movement,
        };
        self.any_move = true;
        Ok(Line::Move(movement))
    }
}

/// The state after a byte that is not part of the coordinate before it.
fn after_number(pen: Pen, x: Option<i32>, number: Number, byte: u8, at: Position) -> Result<State, Error> {
    let counts = number.counts(Some(byte), at)?;
    match x {
        None if byte == b',' || is_blank(byte) => {
            Ok(State::Before { pen, x: Some(counts), comma: byte == b',' })
        }
        None => Err(Error::ExpectedComma { at, byte }),
        Some(x) if is_blank(byte) => Ok(State::Done(PenMove { pen, target: StepPoint::new(x, counts) })),
        Some(_) => Err(Error::Trailing { at, byte }),
    }
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r')
}

/// The lines of a text that is in memory. For one that is not, see [`Reader`].
pub fn read(text: &[u8]) -> impl Iterator<Item = Result<Line, Error>> + Clone {
    let mut reader = Reader::new();
    // One place more than the text has bytes: there the last line ends.
    text.iter().map(Some).chain([None]).filter_map(move |byte| match byte {
        Some(byte) => reader.push(*byte),
        None => reader.finish(),
    })
}

/// The plot operations of a text, for a machine of so many counts a millimetre; lines that move nothing are
/// left out.
///
/// ```
/// # use plotter_motion::hpgl::thesis_text::plot_ops;
/// # use plotter_motion::{PlotOp, Point};
/// let mut ops = plot_ops(*b"PU, 00400, 00000\nPD, 00400, 00200\n", 40.0);
/// assert_eq!(ops.next(), Some(Ok(PlotOp::Travel { to: Point::new(10.0, 0.0) })));
/// assert_eq!(ops.next(), Some(Ok(PlotOp::Draw { to: Point::new(10.0, 5.0), feed_mm_s: None })));
/// assert_eq!(ops.next(), None);
/// ```
pub fn plot_ops<I: IntoIterator<Item = u8>>(
    bytes: I,
    counts_per_mm: f64,
) -> impl Iterator<Item = Result<PlotOp, Error>> + use<I> {
    let mut reader = Reader::new();
    bytes.into_iter().map(Some).chain([None]).filter_map(move |byte| {
        let line = match byte {
            Some(byte) => reader.push(byte),
            None => reader.finish(),
        };
        match line? {
            Ok(Line::Move(pen_move)) => Some(Ok(pen_move.to_op(counts_per_mm))),
            Ok(_) => None,
            Err(error) => Some(Err(error)),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::{String, ToString};
    use std::vec::Vec;

    fn up(x: i32, y: i32) -> PenMove {
        PenMove { pen: Pen::Up, target: StepPoint::new(x, y) }
    }

    fn shown(text: &[u8]) -> String {
        let lines: Vec<String> = read(text)
            .map(|line| line.map_or_else(|error| error.to_string(), |line| std::format!("{line:?}")))
            .collect();
        lines.join("\n")
    }

    #[test]
    fn the_figure_of_the_thesis_is_read() {
        let text = b"Command, X coordinate, Y coordinate\nPU, 02993, 13955\nPD, 02995, 15200\n";
        let expected = [
            Ok(Line::Header { line: 1 }),
            Ok(Line::Move(up(2993, 13955))),
            Ok(Line::Move(PenMove { pen: Pen::Down, target: StepPoint::new(2995, 15200) })),
        ];
        assert_eq!(read(text).collect::<Vec<_>>(), expected);
    }

    #[test]
    fn blanks_case_line_ends_and_short_numbers_are_tolerated() {
        for text in ["PU, 00001, 00002", "pu,1,2\r\n", "  PU\t1 2  \n", "PU , +1 , 2", "Pu1,000000002"] {
            assert_eq!(read(text.as_bytes()).collect::<Vec<_>>(), [Ok(Line::Move(up(1, 2)))], "{text:?}");
        }
    }

    #[test]
    fn blank_lines_are_reported_as_such() {
        let lines = [Ok(Line::Blank { line: 1 }), Ok(Line::Blank { line: 2 }), Ok(Line::Move(up(0, 99_999)))];
        assert_eq!(read(b"\n \r\nPU, 00000, 99999").collect::<Vec<_>>(), lines);
        assert_eq!(read(b"").count(), 0);
    }

    #[test]
    fn every_malformed_line_says_what_would_be_right_and_costs_only_itself() {
        insta::assert_snapshot!(shown(
            b"PU, 1, 1\nPX, 1, 2\nP\nPU\nPU, 1\nPU, 1,\nPU, , 2\nPU; 1, 2\nPU, 1; 2\nPU, -, 2\nPU, 1, 2, 3\nPU, 1.5, 2\n\
              PU, -1, 2\nPU, 1, 100000\nPU, 1, 99999999999999\nPU, 1, 2\xff\nPU, 1, 2"
        ), @r#"
        Move(PenMove { pen: Up, target: StepPoint { x: 1, y: 1 } })
        line 2, column 2 (byte 10): a line begins with PU or PD: `PU, 02993, 13955`
        line 3, column 2 (byte 19): a line begins with PU or PD: `PU, 02993, 13955`
        line 4, column 3 (byte 22): the line ends where a number belongs: write five digits for x and for y
        line 5, column 6 (byte 28): the line ends where a number belongs: write five digits for x and for y
        line 6, column 7 (byte 35): the line ends where a number belongs: write five digits for x and for y
        line 7, column 5 (byte 40): `,` stands where a number belongs: write five digits for x and for y
        line 8, column 3 (byte 46): `;` stands where a comma belongs: `PU, 02993, 13955`
        line 9, column 6 (byte 58): `;` stands where a comma belongs: `PU, 02993, 13955`
        line 10, column 6 (byte 67): `,` stands where a number belongs: write five digits for x and for y
        line 11, column 9 (byte 79): `,` follows the y coordinate: end the line there
        line 12, column 6 (byte 88): `.` stands where a comma belongs: `PU, 02993, 13955`
        line 13, column 5 (byte 98): coordinate -1 lies outside 0..=99999 encoder counts: move the drawing
        line 14, column 8 (byte 111): coordinate 100000 lies outside 0..=99999 encoder counts: move the drawing
        line 15, column 8 (byte 125): coordinate 999999999 lies outside 0..=99999 encoder counts: move the drawing
        line 16, column 9 (byte 148): `\xff` follows the y coordinate: end the line there
        Move(PenMove { pen: Up, target: StepPoint { x: 1, y: 2 } })
        "#);
    }

    #[test]
    fn points_that_five_digits_cannot_say_are_refused_by_name() {
        let mut text = String::new();
        let refused = write_moves([up(0, 99_999), up(100_000, 5)], &mut text).unwrap_err();
        assert_eq!(text, "PU, 00000, 99999\n");
        assert_eq!(
            refused.to_string(),
            "point (100000, 5) lies outside 0..=99999 encoder counts: move the drawing or take fewer counts per mm"
        );
        assert!(write_moves([up(3, -1)], &mut text).is_err());
    }
}
