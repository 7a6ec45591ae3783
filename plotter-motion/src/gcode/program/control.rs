//! Lines that begin with an `O`: conditions, loops, and where subprograms begin and end.

use super::{Kind, Label, MOST_OPEN, Open, Problem, Program, Skip, Until, label_of};
use crate::gcode::expression::Expression;
use crate::gcode::variables::Variables;

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

impl Program {
    /// The label of a line that begins with an `O`, and the word behind it; and where it stands.
    pub(super) fn control(&self) -> Option<(Label, &'static [u8], usize)> {
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
    pub(super) fn rest<'a>(
        line: &'a [u8],
        word: &[u8],
        at: usize,
        variables: &'a Variables,
    ) -> Expression<'a> {
        Expression::new(line, at + word.len(), variables)
    }

    fn holds_true(&self, word: &[u8], at: usize) -> Result<bool, Problem> {
        Ok(Self::rest(&self.line, word, at, &self.variables).brackets()? != 0.0)
    }

    pub(super) fn control_by(
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
}
