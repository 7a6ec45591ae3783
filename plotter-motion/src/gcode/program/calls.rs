//! Subprograms: `call`, `M98` and `M99`.

use super::{Call, Error, Fetched, MOST_CALLS, Problem, Program, Reader, Text, label_of};
use crate::gcode::variables::OWN;
use alloc::vec::Vec;

impl Program {
    pub(super) fn call(&mut self, label: &[u8], word: &[u8], at: usize) -> Result<(), Problem> {
        let mut values = Vec::new();
        let mut rest = Self::rest(&self.line, word, at, &self.variables);
        while rest.begins_bracket() {
            values.push(rest.brackets()?);
            if values.len() > usize::from(OWN) {
                return Err(Problem::Program { what: "more than 30 values for a subprogram" });
            }
        }
        let Some(start) = self.subs.get(label).copied() else {
            return Err(no_subprogram(label));
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

    pub(super) fn end_call(&mut self) {
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
    pub(super) fn call_by_m98(
        &mut self,
        bytes: &mut impl Iterator<Item = u8>,
        reader: &mut Reader,
    ) -> Option<Result<(), Error>> {
        let block = reader.block();
        let is_m = |word: &crate::gcode::Word, tenths| word.letter == b'M' && word.tenths() == Some(tenths);
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
        if !self.subs.contains_key(&label)
            && let Err(error) = self.index(bytes, reader)
        {
            return Some(Err(error));
        }
        let Some(start) = self.subs.get(&label).copied() else {
            return Some(Err(Error { at, problem: no_subprogram(&label) }));
        };
        self.enter(start, count, false).err().map(|problem| Err(Error { at, problem }))
    }

    /// Takes down where subprograms begin in what follows, all of which is held for that; once, so that a
    /// call of what is not there costs no more than another one.
    fn index(&mut self, bytes: &mut impl Iterator<Item = u8>, reader: &mut Reader) -> Result<(), Error> {
        if core::mem::replace(&mut self.is_indexed, true) {
            return Ok(());
        }
        let here = self.at;
        let mut place = self.at;
        loop {
            if let Some(held) = self.held.get(place) {
                self.line.clone_from(&held.text);
            } else {
                match self.fetch(bytes, reader) {
                    Fetched::Whole => self.hold()?,
                    Fetched::Long(_) => {
                        reader.clear_block();
                        continue;
                    }
                    Fetched::None => break,
                }
            }
            place += 1;
            if let Some((label, b"", _)) = self.control() {
                self.subs.entry(label).or_insert(place);
            }
        }
        self.kept = self.held.len();
        self.at = here;
        Ok(())
    }
}

fn no_subprogram(label: &[u8]) -> Problem {
    let mut name = Text::default();
    label.iter().for_each(|byte| name.push(*byte));
    Problem::NoSubprogram { name }
}
