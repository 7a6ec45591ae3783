//! [`PenWords`]: the lines that lift and lower a pen, in a person's own words.

use super::{Block, Error, Problem, Reader};
use alloc::boxed::Box;
use alloc::vec::Vec;

/// The lines that lift and lower the pen, as somebody says who knows the machine: `M42 P4 S0` and
/// `M42 P4 S255`, `M9` and `M8`, `M107` and `M106`, or commands by name such as `PEN_UP` and `PEN_DOWN`.
///
/// A line of the text lifts or lowers the pen if it has all these words, in any order and beside others;
/// where more than one fits, the longest does. A command by its name fits with all that follows the name, but
/// for blanks and case. `M3`, `M4` and `M5` mean nothing beside them, unless they are these words.
///
/// ```
/// use plotter_motion::{PlotOp, Point, gcode};
/// let words = gcode::PenWords::new(["PEN_UP", "M42 P4 S0"], ["PEN_DOWN", "M42 P4 S255"])?;
/// let text = b"PEN_UP\nG1 X5\nPEN_DOWN\nG1 X9\nM42 P4 S0\nG1 X0\n";
/// let options = gcode::Detection::from_bytes(text.iter().copied()).options();
/// let ops = gcode::PlotOps::with_options(text.iter().copied(), options).with_pen_words(words);
/// let ops: Vec<PlotOp> = ops.collect::<Result<_, _>>()?;
/// assert_eq!(
///     ops,
///     [
///         PlotOp::Travel { to: Point::new(5.0, 0.0) },
///         PlotOp::Draw { to: Point::new(9.0, 0.0), feed_mm_s: None },
///         PlotOp::Travel { to: Point::ORIGIN },
///     ]
/// );
/// # Ok::<(), gcode::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PenWords {
    /// Those with most words first.
    patterns: Vec<Pattern>,
}

#[derive(Clone, Debug, PartialEq)]
struct Pattern {
    line: Line,
    is_down: bool,
}

#[derive(Clone, Debug, PartialEq)]
enum Line {
    Words(Box<Block>),
    Named(Vec<u8>),
}

impl PenWords {
    /// Lines that lift, and lines that lower.
    ///
    /// # Errors
    ///
    /// What is wrong with the first line that is none of G-code, or has no words.
    pub fn new<'a>(
        up: impl IntoIterator<Item = &'a str>,
        down: impl IntoIterator<Item = &'a str>,
    ) -> Result<Self, Error> {
        let lines = up.into_iter().map(|line| (line, false)).chain(down.into_iter().map(|line| (line, true)));
        let patterns: Result<Vec<_>, Error> =
            lines.map(|(line, is_down)| Ok(Pattern { line: Line::of(line)?, is_down })).collect();
        let mut patterns = patterns?;
        patterns.sort_by_key(|pattern| match &pattern.line {
            Line::Words(block) => core::cmp::Reverse(block.words().len()),
            Line::Named(_) => core::cmp::Reverse(0),
        });
        Ok(Self { patterns })
    }

    /// What a command by its name does to the pen, as a line that every machine knows.
    pub(super) fn named(&self, line: &[u8]) -> Option<&'static [u8]> {
        let line = plain(line);
        let fits = |pattern: &&Pattern| matches!(&pattern.line, Line::Named(named) if *named == line);
        self.patterns.iter().find(fits).map(|pattern| if pattern.is_down { b"M3".as_slice() } else { b"M5" })
    }

    /// Puts `M3` or `M5` in the place of the words that lower or lift the pen.
    pub(super) fn replace(&self, block: &mut Block) {
        let found = self.patterns.iter().find_map(|pattern| match &pattern.line {
            Line::Words(words) if words.words().iter().all(|word| has(block, *word)) => {
                Some((words, pattern.is_down))
            }
            _ => None,
        });
        let words = found.map_or(&[][..], |(words, _)| words.words());
        block.retain(|word| {
            let is_spindle = word.letter == b'M' && matches!(word.tenths(), Some(30 | 40 | 50));
            // A way of moving holds further on.
            let is_own = word.letter != b'G' && words.iter().any(|one| is_same(*one, *word));
            !(is_spindle || is_own)
        });
        if let Some((_, is_down)) = found {
            block.insert(b'M', if is_down { 3.0 } else { 5.0 });
        }
    }
}

impl Line {
    fn of(text: &str) -> Result<Self, Error> {
        if is_named(text.as_bytes()) {
            return Ok(Self::Named(plain(text.as_bytes())));
        }
        let mut reader = Reader::new();
        let block = text.bytes().find_map(|byte| reader.push(byte)).or_else(|| reader.finish());
        let missing =
            Problem::Missing { expected: "a line that moves the pen has a word, such as `M3` or `PEN_DOWN`" };
        let block = block.ok_or(Error { at: super::Position::START, problem: missing })??;
        Ok(Self::Words(Box::new(block)))
    }
}

fn has(block: &Block, word: super::Word) -> bool {
    block.words().iter().any(|one| is_same(*one, word))
}

fn is_same(one: super::Word, other: super::Word) -> bool {
    one.letter == other.letter && one.number == other.number
}

/// Without blanks and comments, in capitals.
fn plain(line: &[u8]) -> Vec<u8> {
    let end = line.iter().position(|byte| matches!(byte, b';' | b'(')).unwrap_or(line.len());
    let bytes = line.iter().take(end).filter(|byte| !byte.is_ascii_whitespace());
    bytes.map(u8::to_ascii_uppercase).collect()
}

/// Whether a line is a command by its name, as Klipper's macros are: letters, digits and `_`, of which two
/// letters or a `_` come first; without a `_` nothing follows it but `NAME=`.
///
/// ```
/// # use plotter_motion::gcode::is_named;
/// assert!(is_named(b"PEN_UP") && is_named(b" SET_SERVO SERVO=pen ANGLE=30") && is_named(b"penup ; lift"));
/// assert!(!is_named(b"G1 X5") && !is_named(b"G28 X Y") && !is_named(b"Once upon a time"));
/// ```
#[must_use]
pub fn is_named(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    let length = line.iter().take_while(|byte| byte.is_ascii_alphanumeric() || **byte == b'_').count();
    let (Some(name), Some(rest)) = (line.get(..length), line.get(length..)) else { return false };
    let [first, second, _, ..] = name else { return false };
    let rest = rest.trim_ascii_start();
    let ends = rest.is_empty() || matches!(rest.first(), Some(b';' | b'('));
    let has_mark = name.contains(&b'_');
    first.is_ascii_alphabetic()
        && (second.is_ascii_alphabetic() || *second == b'_')
        && (has_mark || name.iter().all(u8::is_ascii_alphabetic))
        && (ends || (has_mark && rest.len() < line.len() - length) || rest.contains(&b'='))
}
