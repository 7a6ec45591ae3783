//! [`Program`]: variables, loops and subprograms, as `LinuxCNC` has them; and Fanuc's `M98`.

use super::expression::Expression;
use super::pen_words::{PenWords, is_named};
use super::variables::{OWN, Variables};
use super::{Cursor, Error, Position, Problem, Reader, Text};
use alloc::collections::BTreeMap;
use alloc::vec::Vec;

/// Longest line that is held as a whole, bytes: 16 times that of `LinuxCNC`. A longer one is read byte by byte, and has no variables.
const MOST_LINE: usize = 4096;

/// Most bytes of loops and subprograms together: a thousand times what people write by hand.
const MOST_HELD: usize = 16 << 20;

/// Deepest calls: as in `LinuxCNC`.
const MOST_CALLS: usize = 10;

/// Most loops and conditions in each other.
const MOST_OPEN: usize = 100;

/// Most lines that loops and subprograms repeat: as many as the greatest drawings have, so that a loop without an end ends.
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
                let failed = |problem| (at, problem);
                let variable = expression.variable().map_err(failed)?;
                let value = expression.assigned().map_err(failed)?;
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
                let value = expression.value().map_err(|problem| (at, problem))?;
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

    /// The label of a line that begins with an `O`, and the word behind it; and where it stands.
    fn control(&self) -> Option<(Label, &'static [u8], usize)> {
        let blanks = |at: usize| {
            let rest = self.line.get(at..).unwrap_or_default();
            at + rest.iter().take_while(|byte| byte.is_ascii_whitespace()).count()
        };
        let mut at = blanks(0);
        if matches!(self.line.get(at), Some(b'N' | b'n')) {
            at = blanks(at + 1);
            let rest = self.line.get(at..).unwrap_or_default();
            at = blanks(at + rest.iter().take_while(|byte| byte.is_ascii_digit()).count());
        }
        let from = at;
        if !matches!(self.line.get(at), Some(b'O' | b'o')) {
            return None;
        }
        at = blanks(at + 1);
        let rest = self.line.get(at..)?;
        let label: Label = match rest.first()? {
            b'<' => {
                let end = rest.iter().position(|byte| *byte == b'>')?;
                let name = rest.get(..end)?.iter().filter(|byte| !byte.is_ascii_whitespace());
                at += end + 1;
                name.map(u8::to_ascii_lowercase).collect()
            }
            b'#' | b'[' => {
                let mut expression = Expression::new(&self.line, at, &self.variables);
                let number = expression.value().ok()?;
                at = expression.at();
                label_of(number)?
            }
            _ => {
                let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
                let zeros =
                    rest.iter().take(digits.saturating_sub(1)).take_while(|byte| **byte == b'0').count();
                at += digits;
                rest.get(zeros..digits).filter(|digits| !digits.is_empty())?.to_vec()
            }
        };
        at = blanks(at);
        let rest = self.line.get(at..)?;
        let letters = rest.iter().take_while(|byte| byte.is_ascii_alphabetic()).count();
        let word = rest.get(..letters)?;
        let known = WORDS.into_iter().find(|known| known.eq_ignore_ascii_case(word));
        // A program's number, and what it is called.
        let is_number = word.is_empty() && matches!(rest.first(), None | Some(b'(' | b';'));
        let word = if is_number { b"".as_slice() } else { known? };
        Some((label, word, if is_number { from } else { at }))
    }

    /// What stands behind the word of a control line.
    fn rest<'a>(line: &'a [u8], word: &[u8], at: usize, variables: &'a Variables) -> Expression<'a> {
        Expression::new(line, at + word.len(), variables)
    }

    fn holds_true(&self, word: &[u8], at: usize) -> Result<bool, Problem> {
        Ok(Self::rest(&self.line, word, at, &self.variables).brackets()? != 0.0)
    }

    fn control_by(
        &mut self,
        label: Label,
        word: &'static [u8],
        at: usize,
        is_held: bool,
    ) -> Result<(), Problem> {
        if let Some(skip) = &self.skip {
            if skip.label != label {
                return Ok(());
            }
            match (skip.until, word) {
                (Until::EndOfSub, b"endsub") => {
                    self.kept = self.held.len();
                    self.skip = None;
                }
                (Until::Branch, b"elseif") if self.holds_true(word, at)? => {
                    self.skip = None;
                    self.begin(label, Kind::If)?;
                }
                (Until::Branch, b"else") => {
                    self.skip = None;
                    self.begin(label, Kind::If)?;
                }
                (Until::Branch | Until::EndOfIf, b"endif") => self.skip = None,
                (Until::EndOfLoop(end), _) if end == word => self.skip = None,
                (Until::Test, b"while") => {
                    self.skip = None;
                    return self.test(&label, word, at);
                }
                _ => {}
            }
            return Ok(());
        }
        if !is_held && matches!(word, b"while" | b"do" | b"repeat" | b"sub") {
            self.hold().map_err(|error| error.problem)?;
        }
        let here = self.at.saturating_sub(1);
        let wrong = |what| Err(Problem::Program { what });
        match word {
            b"sub" => {
                self.subs.insert(label.clone(), self.at);
                self.pass_to(label, Until::EndOfSub);
                Ok(())
            }
            b"endsub" | b"return" => {
                let mut value = Self::rest(&self.line, word, at, &self.variables);
                let value = if value.begins_bracket() { Some(value.brackets()?) } else { None };
                if self.calls.is_empty() {
                    return wrong("it ends a subprogram that has not been called");
                }
                self.end_call();
                match value {
                    Some(value) => self.variables.set_returned(value),
                    None => Ok(()),
                }
            }
            b"call" => self.call(&label, word, at),
            b"if" if self.holds_true(word, at)? => self.begin(label, Kind::If),
            b"if" => {
                self.pass_to(label, Until::Branch);
                Ok(())
            }
            b"else" | b"elseif" if self.ends(&label, |kind| kind == Kind::If) => {
                self.pass_to(label, Until::EndOfIf);
                Ok(())
            }
            b"endif" if self.ends(&label, |kind| kind == Kind::If) => Ok(()),
            b"while" if self.is_open(&label, |kind| matches!(kind, Kind::Do { .. })) => {
                self.test(&label, word, at)
            }
            b"while" if self.holds_true(word, at)? => self.begin(label, Kind::While { start: here }),
            b"while" => {
                self.pass_to(label, Until::EndOfLoop(b"endwhile"));
                Ok(())
            }
            b"do" => self.begin(label, Kind::Do { start: self.at }),
            b"repeat" => {
                let count = Self::rest(&self.line, word, at, &self.variables).brackets()?;
                match u32::try_from(crate::whole::whole(count)) {
                    Ok(count @ 1..) => self.begin(label, Kind::Repeat { start: self.at, rest: count - 1 }),
                    _ => {
                        self.pass_to(label, Until::EndOfLoop(b"endrepeat"));
                        Ok(())
                    }
                }
            }
            b"endwhile" | b"endrepeat" | b"continue" | b"break" => self.go_on(&label, word),
            b"" => {
                self.labels = self.labels.saturating_add(1);
                Ok(())
            }
            _ => wrong("it ends what has not begun: its number or name is that of the `if` or loop"),
        }
    }

    fn pass_to(&mut self, label: Label, until: Until) {
        self.skip = Some(Skip { label, until, from: self.start.here() });
    }

    fn begin(&mut self, label: Label, kind: Kind) -> Result<(), Problem> {
        if self.open.len() >= MOST_OPEN {
            return Err(Problem::Program { what: "more than 100 loops and conditions in each other" });
        }
        self.open.push(Open { label, kind });
        Ok(())
    }

    /// Where a loop or condition of the subprogram that runs stands among those that have begun.
    fn find(&self, label: &[u8], fits: impl Fn(Kind) -> bool) -> Option<usize> {
        let floor = self.calls.last().map_or(0, |call| call.open);
        let found = self.open.iter().rposition(|open| open.label == label && fits(open.kind));
        found.filter(|at| *at >= floor)
    }

    fn is_open(&self, label: &[u8], fits: impl Fn(Kind) -> bool) -> bool {
        self.find(label, fits).is_some()
    }

    fn ends(&mut self, label: &[u8], fits: impl Fn(Kind) -> bool) -> bool {
        let found = self.find(label, fits);
        if let Some(at) = found {
            self.open.truncate(at);
        }
        found.is_some()
    }

    /// The `while` at the end of a `do`.
    fn test(&mut self, label: &[u8], word: &[u8], at: usize) -> Result<(), Problem> {
        let goes_on = self.holds_true(word, at)?;
        let Some(found) = self.find(label, |kind| matches!(kind, Kind::Do { .. })) else { return Ok(()) };
        match self.open.get(found).map(|open| open.kind) {
            Some(Kind::Do { start }) if goes_on => {
                self.open.truncate(found + 1);
                self.at = start;
            }
            _ => self.open.truncate(found),
        }
        Ok(())
    }

    /// The end of a loop, or a way out of it.
    fn go_on(&mut self, label: &[u8], word: &'static [u8]) -> Result<(), Problem> {
        let found = self.find(label, |kind| kind != Kind::If);
        let kind = found.and_then(|at| self.open.get(at)).map(|open| open.kind);
        let (Some(found), Some(kind)) = (found, kind) else {
            return Err(Problem::Program {
                what: "its loop has not begun: its number or name is that of the loop",
            });
        };
        if word == b"break" {
            self.open.truncate(found);
            let end: &'static [u8] = match kind {
                Kind::While { .. } => b"endwhile",
                Kind::Repeat { .. } => b"endrepeat",
                _ => b"while",
            };
            self.pass_to(label.to_vec(), Until::EndOfLoop(end));
            return Ok(());
        }
        match kind {
            Kind::While { start } => {
                self.open.truncate(found);
                self.at = start;
            }
            Kind::Repeat { start, rest: rest @ 1.. } => {
                self.open.truncate(found);
                self.at = start;
                self.begin(label.to_vec(), Kind::Repeat { start, rest: rest - 1 })?;
            }
            Kind::Do { .. } => {
                self.open.truncate(found + 1);
                self.pass_to(label.to_vec(), Until::Test);
            }
            _ => {
                self.open.truncate(found);
                if word == b"continue" {
                    self.pass_to(label.to_vec(), Until::EndOfLoop(b"endrepeat"));
                }
            }
        }
        Ok(())
    }

    fn call(&mut self, label: &[u8], word: &[u8], at: usize) -> Result<(), Problem> {
        let mut values = Vec::new();
        let mut rest = Self::rest(&self.line, word, at, &self.variables);
        while rest.begins_bracket() {
            values.push(rest.brackets()?);
            if values.len() > usize::from(OWN) {
                return Err(Problem::Program { what: "more than 30 values for a subprogram" });
            }
        }
        let Some(start) = self.subs.get(label).copied() else {
            let mut name = Text::default();
            label.iter().for_each(|byte| name.push(*byte));
            return Err(Problem::NoSubprogram { name });
        };
        self.enter(start, 1, true)?;
        self.variables.enter(&values);
        Ok(())
    }

    fn enter(&mut self, start: usize, count: u32, has_own: bool) -> Result<(), Problem> {
        if self.calls.len() >= MOST_CALLS {
            return Err(Problem::Program {
                what: "more than 10 subprograms in each other: one of them calls itself",
            });
        }
        self.calls.push(Call { back: self.at, open: self.open.len(), start, rest: count - 1, has_own });
        self.at = start;
        Ok(())
    }

    fn end_call(&mut self) {
        let Some(call) = self.calls.last_mut() else { return };
        self.open.truncate(call.open);
        if call.rest > 0 {
            call.rest -= 1;
            self.at = call.start;
            return;
        }
        self.at = call.back;
        if call.has_own {
            self.variables.leave();
        }
        self.calls.pop();
    }

    /// `M98 P… L…` and `M99`, in a line that the reader has read.
    fn call_by_m98(
        &mut self,
        bytes: &mut impl Iterator<Item = u8>,
        reader: &mut Reader,
    ) -> Option<Result<(), Error>> {
        let block = reader.block();
        let is_m = |word: &super::Word, tenths| word.letter == b'M' && word.tenths() == Some(tenths);
        if !self.calls.is_empty() && block.words().iter().any(|word| is_m(word, 990)) {
            reader.clear_block();
            self.end_call();
            return None;
        }
        let Some(word) = block.words().iter().find(|word| is_m(word, 980)).copied() else {
            return Some(Ok(()));
        };
        let at = block.place(word);
        let number = block.number(b'P').unwrap_or(-1.0);
        let count = block.number(b'L');
        reader.clear_block();
        // Older controls have both in one: 30015 is O15 three times.
        let number_only = libm::fmod(number, 10_000.0);
        let (number, count) = match count {
            None if number >= 10_000.0 => (number_only, libm::trunc(number / 10_000.0)),
            count => (number, count.unwrap_or(1.0)),
        };
        let count = u32::try_from(crate::whole::whole(count)).unwrap_or_default();
        let Some(label) = label_of(number) else {
            return Some(Err(Self::error(at, "M98 needs a P: the number after the O of its subprogram")));
        };
        if count == 0 {
            return None;
        }
        let start = match self.subs.get(&label).copied() {
            Some(start) => start,
            None => match self.search(&label, bytes, reader) {
                Ok(Some(start)) => start,
                Ok(None) => {
                    let mut name = Text::default();
                    label.iter().for_each(|byte| name.push(*byte));
                    return Some(Err(Error { at, problem: Problem::NoSubprogram { name } }));
                }
                Err(error) => return Some(Err(error)),
            },
        };
        self.enter(start, count, false).err().map(|problem| Err(Error { at, problem }))
    }

    /// Looks for a subprogram in what follows, all of which is held for that.
    fn search(
        &mut self,
        label: &[u8],
        bytes: &mut impl Iterator<Item = u8>,
        reader: &mut Reader,
    ) -> Result<Option<usize>, Error> {
        let here = self.at;
        let mut found = None;
        let mut place = self.at;
        while found.is_none() {
            if let Some(held) = self.held.get(place) {
                self.line.clone_from(&held.text);
            } else {
                match self.fetch(bytes, reader) {
                    Fetched::Whole => {}
                    Fetched::Long(_) => {
                        reader.clear_block();
                        continue;
                    }
                    Fetched::None => break,
                }
                self.hold()?;
            }
            place += 1;
            if let Some((found_label, b"", _)) = self.control()
                && found_label == label
            {
                self.subs.insert(found_label, place);
                found = Some(place);
            }
        }
        // It goes on to M99, and so does all behind it.
        while self.fetch_and_hold(bytes, reader)? {}
        self.kept = self.held.len();
        self.at = here;
        Ok(found)
    }

    fn fetch_and_hold(
        &mut self,
        bytes: &mut impl Iterator<Item = u8>,
        reader: &mut Reader,
    ) -> Result<bool, Error> {
        match self.fetch(bytes, reader) {
            Fetched::Whole => self.hold().map(|()| true),
            Fetched::Long(_) => {
                reader.clear_block();
                Ok(true)
            }
            Fetched::None => Ok(false),
        }
    }
}

/// Words behind an `O` with its number or name.
const WORDS: [&[u8]; 15] = [
    b"sub",
    b"endsub",
    b"call",
    b"return",
    b"if",
    b"elseif",
    b"else",
    b"endif",
    b"while",
    b"endwhile",
    b"do",
    b"repeat",
    b"endrepeat",
    b"continue",
    b"break",
];

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
