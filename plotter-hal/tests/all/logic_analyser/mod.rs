//! A logic analyser on all the pins of a driver: one log of their levels over one simulated clock, and a
//! fault where it is wanted.

#![allow(dead_code, reason = "each test file uses its part")]

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use plotter_hal::a4988::Timing;
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::time::Duration;

/// Steps of each PWM.
pub(crate) const FULL: u16 = 200;

/// One access to a pin, and when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Access {
    pub(crate) at: Duration,
    pub(crate) wire: &'static str,
    /// Level (0 or 1) or duty.
    pub(crate) to: u16,
    pub(crate) failed: bool,
    pub(crate) took_effect: bool,
}

/// Which accesses fail.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Fault {
    #[default]
    None,
    /// The access of this number, from 0, fails; the next one works.
    Once { at: usize, takes_effect: bool },
    /// The access of this number fails without effect, and the one so many later.
    Two { at: usize, later: usize },
    /// The access of this number and all later ones to the same wire fail without effect.
    Wire { at: usize },
    /// All accesses from this number on fail without effect.
    All { at: usize },
}

impl Fault {
    /// Every way to fail at the access of this number.
    pub(crate) fn at(at: usize) -> [Self; 4] {
        [
            Self::Once { at, takes_effect: false },
            Self::Once { at, takes_effect: true },
            Self::Wire { at },
            Self::All { at },
        ]
    }
}

#[derive(Debug, Default)]
pub(crate) struct Analyser {
    pub(crate) now: Cell<Duration>,
    fault: Cell<Fault>,
    log: RefCell<Vec<Access>>,
    broken: Cell<Option<&'static str>>,
}

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

impl Analyser {
    pub(crate) fn failing(fault: Fault) -> Self {
        Self { fault: Cell::new(fault), ..Self::default() }
    }

    pub(crate) fn set_fault(&self, fault: Fault) {
        self.fault.set(fault);
    }

    pub(crate) fn wire(&self, name: &'static str) -> Wire<'_> {
        Wire { analyser: self, name }
    }

    pub(crate) fn clock(&self) -> Clock<'_> {
        Clock(self)
    }

    pub(crate) fn accesses(&self) -> usize {
        self.log.borrow().len()
    }

    pub(crate) fn log(&self) -> Vec<Access> {
        self.log.borrow().clone()
    }

    /// Level or duty of each wire after each access that took effect, and when.
    pub(crate) fn history(&self) -> Vec<(Duration, BTreeMap<&'static str, u16>)> {
        let mut levels = BTreeMap::new();
        let mut history = Vec::new();
        for access in self.log.borrow().iter().filter(|access| access.took_effect) {
            levels.insert(access.wire, access.to);
            history.push((access.at, levels.clone()));
        }
        history
    }

    /// What a wire is now; low if it was never set.
    pub(crate) fn level(&self, wire: &str) -> u16 {
        let log = self.log.borrow();
        log.iter()
            .rev()
            .find(|access| access.took_effect && access.wire == wire)
            .map_or(0, |access| access.to)
    }

    /// The changes of one wire: when, and to what. The first is from low.
    pub(crate) fn edges(&self, wire: &str) -> Vec<(Duration, u16)> {
        let mut level = 0;
        let mut edges = Vec::new();
        for access in self.log.borrow().iter().filter(|access| access.took_effect && access.wire == wire) {
            if access.to != level {
                edges.push((access.at, access.to));
                level = access.to;
            }
        }
        edges
    }

    /// What a chip with these minima would have to say about its inputs, over the whole log.
    pub(crate) fn too_short(&self, step: &str, dir: &str, timing: Timing) -> Vec<String> {
        let mut complaints = Vec::new();
        let mut expect = |what: &str, from: Duration, to: Duration, minimum: Duration| {
            if to - from < minimum {
                complaints.push(format!("{what} {from:?} to {to:?}, minimum {minimum:?}"));
            }
        };
        let (steps, turns) = (self.edges(step), self.edges(dir));
        for pair in steps.windows(2) {
            let minimum = if pair[0].1 == 1 { timing.high } else { timing.low };
            expect("STEP", pair[0].0, pair[1].0, minimum);
        }
        for &(rise, _) in steps.iter().filter(|(_, level)| *level == 1) {
            for &(turn, _) in &turns {
                // At one and the same time they are in the order of the log: a turn comes before its rise.
                if turn <= rise {
                    expect("setup", turn, rise, timing.setup);
                } else {
                    expect("hold", rise, turn, timing.hold);
                }
            }
        }
        complaints
    }

    /// Rising edges of a wire.
    pub(crate) fn rises(&self, wire: &str) -> usize {
        self.edges(wire).iter().filter(|(_, level)| *level == 1).count()
    }

    /// The log as a table: time in ns, wire, value.
    pub(crate) fn table(&self) -> String {
        let mut table = String::new();
        for Access { at, wire, to, failed, .. } in self.log.borrow().iter() {
            let note = if *failed { " FAILED" } else { "" };
            let _ = writeln!(table, "{:>9} ns  {wire:<8} {to}{note}", at.as_nanos());
        }
        table
    }

    fn access(&self, wire: &'static str, to: u16) -> Result<(), Broken> {
        let number = self.accesses();
        let (failed, takes_effect) = match self.fault.get() {
            Fault::Once { at, takes_effect } if at == number => (true, takes_effect),
            Fault::Two { at, later } if at == number || at + later == number => (true, false),
            Fault::Wire { at } => {
                if at == number {
                    self.broken.set(Some(wire));
                }
                (self.broken.get() == Some(wire), false)
            }
            Fault::All { at } => (number >= at, false),
            _ => (false, true),
        };
        let took_effect = !failed || takes_effect;
        self.log.borrow_mut().push(Access { at: self.now.get(), wire, to, failed, took_effect });
        if failed { Err(Broken) } else { Ok(()) }
    }
}

/// One pin, as output or as PWM.
#[derive(Clone, Debug)]
pub(crate) struct Wire<'a> {
    analyser: &'a Analyser,
    name: &'static str,
}

impl digital::ErrorType for Wire<'_> {
    type Error = Broken;
}

impl OutputPin for Wire<'_> {
    fn set_low(&mut self) -> Result<(), Broken> {
        self.analyser.access(self.name, 0)
    }

    fn set_high(&mut self) -> Result<(), Broken> {
        self.analyser.access(self.name, 1)
    }
}

impl pwm::ErrorType for Wire<'_> {
    type Error = Broken;
}

impl SetDutyCycle for Wire<'_> {
    fn max_duty_cycle(&self) -> u16 {
        FULL
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Broken> {
        self.analyser.access(self.name, duty)
    }
}

/// Lets the simulated time pass.
#[derive(Debug)]
pub(crate) struct Clock<'a>(&'a Analyser);

impl DelayNs for Clock<'_> {
    fn delay_ns(&mut self, ns: u32) {
        self.0.now.set(self.0.now.get() + Duration::from_nanos(ns.into()));
    }
}
