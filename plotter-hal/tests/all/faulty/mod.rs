//! Pins and PWMs that note what happens to them, and fail where they are told to.

#![allow(dead_code, reason = "each test uses what it needs")]

use embedded_hal::digital::{self, InputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use std::cell::RefCell;
use std::collections::VecDeque;

/// The access failed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Broken;

impl digital::Error for Broken {
    fn kind(&self) -> digital::ErrorKind {
        digital::ErrorKind::Other
    }
}

impl pwm::Error for Broken {
    fn kind(&self) -> pwm::ErrorKind {
        pwm::ErrorKind::Other
    }
}

/// A PWM's output: what it was set to, in order, and whether that worked.
#[derive(Debug, Default)]
pub(crate) struct Output {
    pub(crate) journal: RefCell<Vec<(u16, bool)>>,
    /// Numbers, from 0, of the accesses that fail without effect.
    pub(crate) failing: Vec<usize>,
}

impl Output {
    pub(crate) fn failing_at(failing: impl IntoIterator<Item = usize>) -> Self {
        Self { failing: failing.into_iter().collect(), ..Self::default() }
    }

    pub(crate) fn pwm(&self, full: u16) -> Pwm<'_> {
        Pwm { output: self, full }
    }

    pub(crate) fn accesses(&self) -> usize {
        self.journal.borrow().len()
    }

    /// The duty now: the last that took effect, 0 at first.
    pub(crate) fn duty(&self) -> u16 {
        self.journal.borrow().iter().rev().find(|(_, worked)| *worked).map_or(0, |(duty, _)| *duty)
    }

    /// What was set and took effect, in order.
    pub(crate) fn duties(&self) -> Vec<u16> {
        self.journal.borrow().iter().filter(|(_, worked)| *worked).map(|(duty, _)| *duty).collect()
    }
}

#[derive(Debug)]
pub(crate) struct Pwm<'a> {
    output: &'a Output,
    full: u16,
}

impl pwm::ErrorType for Pwm<'_> {
    type Error = Broken;
}

impl SetDutyCycle for Pwm<'_> {
    fn max_duty_cycle(&self) -> u16 {
        self.full
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Broken> {
        assert!(duty <= self.full, "{duty} of {}", self.full);
        let mut journal = self.output.journal.borrow_mut();
        let works = !self.output.failing.contains(&journal.len());
        journal.push((duty, works));
        if works { Ok(()) } else { Err(Broken) }
    }
}

/// An input whose levels are known beforehand, one for each read; `None` fails.
#[derive(Debug)]
pub(crate) struct Levels(pub(crate) VecDeque<Option<bool>>);

impl Levels {
    pub(crate) fn new(levels: impl IntoIterator<Item = Option<bool>>) -> Self {
        Self(levels.into_iter().collect())
    }
}

impl digital::ErrorType for Levels {
    type Error = Broken;
}

impl InputPin for Levels {
    fn is_high(&mut self) -> Result<bool, Broken> {
        assert!(!self.0.is_empty(), "a level for each read");
        self.0.pop_front().flatten().ok_or(Broken)
    }

    fn is_low(&mut self) -> Result<bool, Broken> {
        self.is_high().map(|high| !high)
    }
}
