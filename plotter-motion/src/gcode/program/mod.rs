//! [`Program`]: variables, loops and subprograms, as `LinuxCNC` has them; and Fanuc's `M98`.

mod calls;
mod control;

use super::expression::Expression;
use super::pen_words::{PenWords, is_named};
use super::variables::Variables;
use super::{Cursor, Error, Position, Problem, Reader, Text};
use alloc::collections::BTreeMap;
use alloc::vec::Vec;

/// Longest line that is held as a whole, bytes: 16 times that of `LinuxCNC`. A longer one is read byte by
/// byte, and has no variables.
const MOST_LINE: usize = 4096;

/// Most bytes of loops and subprograms together: a thousand times what people write by hand.
const MOST_HELD: usize = 16 << 20;

/// Deepest calls: as in `LinuxCNC`.
const MOST_CALLS: usize = 10;

/// Most loops and conditions in each other.
const MOST_OPEN: usize = 100;

/// Most lines that loops and subprograms repeat: as many as the greatest drawings have, so that a loop
/// without an end ends.
const MOST_AGAIN: u32 = 1_000_000;

const TOO_MANY_LINES: &str = "more than a million lines by loops and subprograms, and the program is ended here: check the \
                              condition of its loop, or write it out";

type Label = Vec<u8>;

#[derive(Clone, Debug, PartialEq)]
struct Held {
    text: Vec<u8>,
    start: Cursor,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    If,
    While { start: usize },
    Do { start: usize },
    Repeat { start: usize, rest: u32 },
}

/// A loop or condition that has begun.
#[derive(Clone, Debug, PartialEq)]
struct Open {
    label: Label,
    kind: Kind,
}

/// Where a subprogram goes back to.
#[derive(Clone, Debug, PartialEq)]
struct Call {
    back: usize,
    open: usize,
    start: usize,
    /// How often it is still done.
    rest: u32,
    has_own: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Until {
    EndOfSub,
    /// The next branch, or the end.
    Branch,
    EndOfIf,
    EndOfLoop(&'static [u8]),
    /// The condition at the end of a `do`.
    Test,
}

/// Lines that are passed over.
#[derive(Clone, Debug, PartialEq)]
struct Skip {
    label: Label,
    until: Until,
    from: Position,
}

/// Takes lines from a text, holds those that are repeated, and reckons their values.
#[derive(Clone, Debug)]
pub(super) struct Program {
    /// The line that is carried out, and where it begins.
    line: Vec<u8>,
    start: Cursor,
    /// Where the next line of the text begins.
    next: Cursor,
    held: Vec<Held>,
    held_bytes: usize,
    /// Held lines before this one belong to subprograms.
    kept: usize,
    /// The next of the held lines; as many as there are where it is one of the text.
    at: usize,
    subs: BTreeMap<Label, usize>,
    open: Vec<Open>,
    calls: Vec<Call>,
    skip: Option<Skip>,
    again: u32,
    is_over: bool,
    /// What `M98` may call has been taken down.
    is_indexed: bool,
    /// Lines with an `O` and its number alone.
    labels: u32,
    variables: Variables,
    pen_words: Option<PenWords>,
}

impl Default for Program {
    fn default() -> Self {
        Self {
            line: Vec::new(),
            start: Cursor::START,
            next: Cursor::START,
            held: Vec::new(),
            held_bytes: 0,
            kept: 0,
            at: 0,
            subs: BTreeMap::new(),
            open: Vec::new(),
            calls: Vec::new(),
            skip: None,
            again: 0,
            is_over: false,
            is_indexed: false,
            labels: 0,
            variables: Variables::default(),
            pen_words: None,
        }
    }
}

/// What a line of the text is.
enum Fetched {
    Whole,
    /// It was longer than is held, and has been read.
    Long(Option<Result<(), Error>>),
    None,
}

impl Program {
    pub(super) fn with_pen_words(self, words: PenWords) -> Self {
        Self { pen_words: Some(words), ..self }
    }

    pub(super) const fn labels(&self) -> u32 {
        self.labels
    }

    pub(super) fn advance(
        &mut self,
        bytes: &mut impl Iterator<Item = u8>,
        reader: &mut Reader,
    ) -> Option<Result<(), Error>> {
        loop {
            let is_held = self.at < self.held.len();
            match self.load(bytes, reader) {
                Ok(Fetched::Whole) => {}
                Ok(Fetched::Long(None)) => continue,
                Ok(Fetched::Long(found)) => return found.map(|found| self.with_pen(found, reader)),
                Ok(Fetched::None) => return self.finish(),
                Err(error) => return Some(Err(error)),
            }
            let outcome = if self.line.is_empty() { None } else { self.take(is_held, bytes, reader) };
            if let Some(Err(_)) = outcome {
                reader.clear_block();
            }
            if outcome.is_some() {
                return outcome;
            }
        }
    }

    /// The end of the text.
    fn finish(&mut self) -> Option<Result<(), Error>> {
        let skip = self.skip.take()?;
        Some(Err(Self::error(
            skip.from,
            "its end lacks: every `sub`, `if` and loop has one, with the same number or name",
        )))
    }

    fn error(at: Position, what: &'static str) -> Error {
        Error { at, problem: Problem::Program { what } }
    }

    /// Ends the program where it is.
    fn stop(&mut self, what: &'static str) -> Error {
        self.is_over = true;
        self.skip = None;
        Self::error(self.start.here(), what)
    }

    /// Gets the next line.
    fn load(&mut self, bytes: &mut impl Iterator<Item = u8>, reader: &mut Reader) -> Result<Fetched, Error> {
        if self.is_over {
            return Ok(Fetched::None);
        }
        if let Some(held) = self.held.get(self.at) {
            self.line.clone_from(&held.text);
            self.start = held.start;
            self.at += 1;
            self.again += 1;
            if self.again > MOST_AGAIN {
                return Err(self.stop(TOO_MANY_LINES));
            }
            return Ok(Fetched::Whole);
        }
        if self.open.is_empty() && self.calls.is_empty() && self.skip.is_none() && self.held.len() > self.kept
        {
            self.held.truncate(self.kept);
            self.held_bytes = self.held.iter().map(|held| held.text.len()).sum();
            self.at = self.held.len();
        }
        let fetched = self.fetch(bytes, reader);
        let holds =
            !self.open.is_empty() || matches!(&self.skip, Some(skip) if skip.until == Until::EndOfSub);
        if holds && matches!(fetched, Fetched::Whole) {
            self.hold()?;
        }
        Ok(fetched)
    }

    /// Reads a line of the text.
    fn fetch(&mut self, bytes: &mut impl Iterator<Item = u8>, reader: &mut Reader) -> Fetched {
        self.start = self.next;
        self.line.clear();
        let mut any = false;
        while let Some(byte) = bytes.next() {
            any = true;
            self.next.pass(byte);
            if matches!(byte, b'\n' | b'\r') {
                return Fetched::Whole;
            }
            if self.line.len() == MOST_LINE {
                return Fetched::Long(self.read_long(byte, bytes, reader));
            }
            self.line.push(byte);
        }
        if any { Fetched::Whole } else { Fetched::None }
    }

    fn read_long(
        &mut self,
        byte: u8,
        bytes: &mut impl Iterator<Item = u8>,
        reader: &mut Reader,
    ) -> Option<Result<(), Error>> {
        reader.stand_at(self.start);
        let mut failed = None;
        for byte in self.line.drain(..).chain([byte]) {
            failed = failed.or(reader.advance(byte));
        }
        for byte in bytes.by_ref() {
            self.next.pass(byte);
            if matches!(byte, b'\n' | b'\r') {
                break;
            }
            failed = failed.or(reader.advance(byte));
        }
        let ended = reader.advance_to_end();
        if self.skip.is_some() {
            reader.clear_block();
            return None;
        }
        failed.or(ended)
    }

    /// Keeps the line of the text.
    fn hold(&mut self) -> Result<(), Error> {
        if self.held_bytes + self.line.len() > MOST_HELD {
            return Err(self.stop("its loops and subprograms have more than 16 MiB: write them out"));
        }
        self.held_bytes += self.line.len() + 1;
        self.held.push(Held { text: self.line.clone(), start: self.start });
        self.at = self.held.len();
        Ok(())
    }

    /// Carries a line out, or gives it to the reader.
    fn take(
        &mut self,
        is_held: bool,
        bytes: &mut impl Iterator<Item = u8>,
        reader: &mut Reader,
    ) -> Option<Result<(), Error>> {
        if let Some((label, word, at)) = self.control() {
            let holds = is_held || !self.open.is_empty() || self.skip.is_some();
            let outcome = self.control_by(label, word, at, holds);
            return outcome.err().map(|problem| Err(self.placed(at, problem)));
        }
        if self.skip.is_some() {
            return None;
        }
        if is_named(&self.line) {
            return self.take_named(reader);
        }
        reader.stand_at(self.start);
        let reckons = self.line.iter().any(|byte| matches!(byte, b'#' | b'['));
        let found = if reckons { self.read_reckoned(reader) } else { read(&self.line, reader) };
        match found {
            Some(Ok(())) => self.call_by_m98(bytes, reader).map(|found| self.with_pen(found, reader)),
            other => other,
        }
    }

    fn placed(&self, at: usize, problem: Problem) -> Error {
        let mut cursor = self.start;
        self.line.iter().take(at).for_each(|byte| cursor.pass(*byte));
        Error { at: cursor.here(), problem }
    }

    fn with_pen(&self, found: Result<(), Error>, reader: &mut Reader) -> Result<(), Error> {
        if let (Ok(()), Some(words)) = (found, &self.pen_words) {
            words.replace(reader.block_mut());
        }
        found
    }

    /// A command by its name.
    fn take_named(&mut self, reader: &mut Reader) -> Option<Result<(), Error>> {
        reader.stand_at(self.start);
        if let Some(line) = self.pen_words.as_ref().and_then(|words| words.named(&self.line)) {
            return read(line, reader);
        }
        let mut name = Text::default();
        let end = self.line.iter().position(|byte| matches!(byte, b';' | b'('));
        self.line.iter().take(end.unwrap_or(self.line.len())).for_each(|byte| name.push(*byte));
        let before = self.line.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        Some(Err(self.placed(before, Problem::Named { name })))
    }

    /// Reads a line with variables and formulas.
    fn read_reckoned(&mut self, reader: &mut Reader) -> Option<Result<(), Error>> {
        let line = core::mem::take(&mut self.line);
        let found = self.reckon(&line, reader);
        self.line = line;
        match found {
            Ok(()) => reader.advance_to_end(),
            Err((at, problem)) => {
                reader.give_up();
                Some(Err(self.placed(at, problem)))
            }
        }
    }

    fn reckon(&mut self, line: &[u8], reader: &mut Reader) -> Result<(), (usize, Problem)> {
        // All values of a line are read before one is set.
        let mut set = Vec::new();
        let (mut at, mut comments) = (0, 0_u32);
        while let Some(&byte) = line.get(at) {
            if comments > 0 || byte == b'(' {
                comments = match byte {
                    b'(' => comments + 1,
                    b')' => comments - 1,
                    _ => comments,
                };
            } else if byte == b';' {
                for byte in line.get(at..).unwrap_or_default() {
                    let _ = reader.advance(*byte);
                }
                break;
            } else if byte == b'#' {
                let mut expression = Expression::new(line, at, &self.variables);
                // Where it went wrong.
                let variable = expression.variable().map_err(|problem| (expression.at(), problem))?;
                let value = expression.assigned().map_err(|problem| (expression.at(), problem))?;
                let end = expression.at();
                set.push((at, variable, value));
                reader.pass_over(line.get(at..end).unwrap_or_default());
                at = end;
                continue;
            }
            if let Some(Err(error)) = reader.advance(byte) {
                return Err((at, error.problem));
            }
            at += 1;
            if comments == 0
                && byte.is_ascii_alphabetic()
                && Expression::new(line, at, &self.variables).begins()
            {
                let mut expression = Expression::new(line, at, &self.variables);
                let value = expression.value().map_err(|problem| (expression.at(), problem))?;
                let end = expression.at();
                reader.pass_over(line.get(at..end).unwrap_or_default());
                reader.give_number(value).map_err(|error| (at, error.problem))?;
                at = end;
            }
        }
        for (at, variable, value) in set {
            self.variables.set(&variable, value).map_err(|problem| (at, problem))?;
        }
        Ok(())
    }
}

/// A whole number as it is written.
fn label_of(number: f64) -> Option<Label> {
    let whole =
        u32::try_from(crate::whole::whole(number)).ok().filter(|whole| f64::from(*whole) == number)?;
    Some(alloc::format!("{whole}").into_bytes())
}

/// A whole line to the reader.
fn read(line: &[u8], reader: &mut Reader) -> Option<Result<(), Error>> {
    let mut failed = None;
    for byte in line {
        failed = failed.or(reader.advance(*byte));
    }
    let ended = reader.advance_to_end();
    failed.or(ended)
}
