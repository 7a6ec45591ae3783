//! [`Open`]: the command in progress and its numbers.

use super::super::{Error, Mnemonic, Position};
use crate::Vec2;

/// Numbers kept of a command: as many as `UL` takes.
const NUMBERS: usize = 21;
/// Numbers whose places are kept, for complaints.
const PLACES: usize = 7;

/// A command that has begun, and what of its numbers has not been used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Open {
    pub(super) command: Mnemonic,
    pub(super) at: Position,
    numbers: [f64; NUMBERS],
    places: [Position; PLACES],
    count: u32,
    /// An x that waits for its y.
    pub(super) x: Option<(f64, Position)>,
}

impl Open {
    pub(super) fn new(command: Mnemonic, at: Position) -> Self {
        Self { command, at, numbers: [0.0; NUMBERS], places: [at; PLACES], count: 0, x: None }
    }

    /// Takes a number; those beyond what is kept are only counted.
    pub(super) fn push(&mut self, value: f64, at: Position) {
        let index = self.count();
        if let Some(slot) = self.numbers.get_mut(index) {
            *slot = value;
        }
        if let Some(slot) = self.places.get_mut(index) {
            *slot = at;
        }
        self.count = self.count.saturating_add(1);
    }

    /// Forgets the numbers: they have been used.
    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    pub(super) fn given(&self) -> u32 {
        self.count
    }

    pub(super) fn count(&self) -> usize {
        usize::try_from(self.count).unwrap_or(usize::MAX)
    }

    /// The numbers that are kept.
    pub(super) fn numbers(&self) -> &[f64] {
        self.numbers.get(..self.count()).unwrap_or(&self.numbers)
    }

    pub(super) fn get(&self, index: usize) -> Option<f64> {
        self.numbers().get(index).copied()
    }

    /// A number, or what holds where it is missing.
    pub(super) fn or(&self, index: usize, usual: f64) -> f64 {
        self.get(index).unwrap_or(usual)
    }

    /// Two numbers.
    pub(super) fn pair(&self, index: usize) -> Option<Vec2> {
        Some(Vec2::new(self.get(index)?, self.get(index + 1)?))
    }

    /// Complains about a number.
    pub(super) fn bad(&self, index: usize, expected: &'static str) -> Error {
        let at = self.places.get(index).copied().unwrap_or(self.at);
        Error::BadParameter { at, command: self.command, value: self.or(index, 0.0), expected }
    }

    /// Complains about numbers that are not there.
    pub(super) fn missing(&self, expected: &'static str) -> Error {
        Error::MissingParameter { at: self.at, command: self.command, expected }
    }

    /// A whole number from `least` to `greatest`; `usual` where it is missing.
    pub(super) fn whole(
        &self,
        index: usize,
        usual: u8,
        least: u8,
        greatest: u8,
        expected: &'static str,
    ) -> Result<u8, Error> {
        let Some(value) = self.get(index) else { return Ok(usual) };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "compared with the value below"
        )]
        let number = value as u8;
        let fits = f64::from(number) == value && (least..=greatest).contains(&number);
        fits.then_some(number).ok_or_else(|| self.bad(index, expected))
    }

    /// Either no numbers or at least `least`; `false` for none.
    pub(super) fn none_or(&self, least: u32, expected: &'static str) -> Result<bool, Error> {
        match self.count {
            0 => Ok(false),
            count if count >= least => Ok(true),
            _ => Err(self.missing(expected)),
        }
    }
}
