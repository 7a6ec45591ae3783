//! [`Variables`]: what the numbers and names of a program stand for.

use super::expression::Variable;
use super::{Problem, Text};
use alloc::collections::BTreeMap;
use alloc::vec::Vec;

/// Most variables of a program: `LinuxCNC` has 5602 with numbers.
const MOST: usize = 10_000;

/// How many of the first ones are a subprogram's own.
pub(super) const OWN: u16 = 30;

/// States of the machine and of its probe in `LinuxCNC`, which a drawing has not.
const STATES: core::ops::RangeInclusive<u16> = 5061..=5070;
const PLACES: core::ops::RangeInclusive<u16> = 5420..=5428;

#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Variables {
    numbered: BTreeMap<u16, f64>,
    /// Those that begin with `_` are everybody's.
    shared: BTreeMap<Vec<u8>, f64>,
    /// Those of the subprogram that runs, and of all that wait for it.
    own: Vec<Own>,
    base: Own,
}

/// The variables of one subprogram.
#[derive(Clone, Debug, Default, PartialEq)]
struct Own {
    named: BTreeMap<Vec<u8>, f64>,
    /// What the first numbers stood for before.
    before: Vec<(u16, f64)>,
}

impl Variables {
    pub(super) fn value(&self, variable: &Variable) -> Result<f64, Problem> {
        match variable {
            Variable::Numbered(number) if STATES.contains(number) || PLACES.contains(number) => {
                Err(Problem::Expression {
                    what: "#5061 to #5070 and #5420 to #5428 are states of a machine: write the number out",
                })
            }
            Variable::Numbered(number) => Ok(self.numbered.get(number).copied().unwrap_or_default()),
            Variable::Named(name) => {
                let found = self.names(name).get(name.as_bytes());
                found.copied().ok_or(Problem::Undefined { name: *name })
            }
        }
    }

    fn names(&self, name: &Text) -> &BTreeMap<Vec<u8>, f64> {
        let own = &self.own.last().unwrap_or(&self.base).named;
        if name.as_bytes().starts_with(b"_") { &self.shared } else { own }
    }

    pub(super) fn set(&mut self, variable: &Variable, value: f64) -> Result<(), Problem> {
        let own: usize = self.own.iter().map(|own| own.named.len()).sum();
        if self.numbered.len() + self.shared.len() + self.base.named.len() + own >= MOST {
            return Err(Problem::Expression { what: "more than 10000 variables" });
        }
        match variable {
            Variable::Numbered(number) => {
                self.numbered.insert(*number, value);
            }
            Variable::Named(name) => {
                let own = &mut self.own.last_mut().unwrap_or(&mut self.base).named;
                let names = if name.as_bytes().starts_with(b"_") { &mut self.shared } else { own };
                names.insert(name.as_bytes().to_vec(), value);
            }
        }
        Ok(())
    }

    /// What a subprogram gives back: `#<_value>`.
    pub(super) fn set_returned(&mut self, value: f64) -> Result<(), Problem> {
        let mut name = Text::default();
        b"_value".iter().for_each(|byte| name.push(*byte));
        self.set(&Variable::Named(name), value)
    }

    /// A subprogram begins with these values as its first ones; all else of its own is 0.
    pub(super) fn enter(&mut self, values: &[f64]) {
        let before = (1..=OWN).filter_map(|number| Some((number, self.numbered.remove(&number)?))).collect();
        self.own.push(Own { named: BTreeMap::new(), before });
        for (number, value) in (1..=OWN).zip(values) {
            self.numbered.insert(number, *value);
        }
    }

    /// The subprogram ends.
    pub(super) fn leave(&mut self) {
        let Some(own) = self.own.pop() else { return };
        self.numbered.retain(|number, _| *number > OWN);
        self.numbered.extend(own.before);
    }
}
