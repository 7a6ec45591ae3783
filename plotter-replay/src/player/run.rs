//! A controller that is led through recorded time.

use super::{Controller, Stuck};
use crate::log::{Event, Record};
use core::time::Duration;
use plotter_motion::protocol::Wire;
use plotter_motion::protocol::digits::Reply;
use plotter_motion::{Axis, Direction, Pen, StepPoint};
use std::collections::VecDeque;

/// Ticks in a row that may leave the next tick where it was.
const MOST_TICKS_AT_ONCE: u32 = 1_000;
/// Bytes that may wait for the line: 40 s of it at 256000 baud.
const MOST_WAITING: usize = 1_000_000;
/// Silence between two records, or before the first, that is still run through tick by tick.
const LONGEST_SILENCE: Duration = Duration::from_secs(3_600);

/// Where the edges for a re-run come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum EdgeSource {
    /// The log's `@ edge` records: a re-run is exact.
    #[default]
    Records,
    /// The controller's own pulse bytes, for a log without edges. They come one byte later than the edges came,
    /// so that only the order of the other answers is exact.
    Pulses,
}

impl EdgeSource {
    /// What these records allow: their edges if there are any, else the pulses.
    pub fn of<'a>(records: impl IntoIterator<Item = &'a Record>) -> Self {
        let has_edges = records.into_iter().any(|record| matches!(record.event, Event::Edge { .. }));
        if has_edges { Self::Records } else { Self::Pulses }
    }
}

/// What a controller does besides sending bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Did {
    /// A motor made a step.
    Step(Axis, Direction),
    /// The pen was lifted or lowered.
    Pen(Pen),
    /// A motor got another duty cycle.
    Duty(Axis, i32),
}

/// A controller, the line that its bytes go over, and how far in time it is.
#[derive(Debug)]
pub(super) struct Run<C> {
    pub(super) controller: C,
    edges: EdgeSource,
    wire: Wire,
    now: Duration,
    /// What it said, with the time of each byte's last bit.
    pub(super) said: VecDeque<(Duration, u8)>,
    /// What else it did, in its order.
    pub(super) did: VecDeque<(Duration, Did)>,
    tells_duties: bool,
    duties: [i32; 2],
    /// Where it had the pen last.
    pen: Option<Pen>,
    /// Where the log had it last.
    recorded_pen: Pen,
}

impl<C: Controller> Run<C> {
    pub(super) fn new(controller: C, baud: u32, edges: EdgeSource) -> Self {
        Self {
            pen: controller.pen(),
            duties: Axis::BOTH.map(|axis| controller.duty(axis)),
            controller,
            edges,
            wire: Wire::new(baud),
            now: Duration::ZERO,
            said: VecDeque::new(),
            did: VecDeque::new(),
            tells_duties: false,
            recorded_pen: Pen::Up,
        }
    }

    /// The same, which also tells when a duty cycle changes.
    pub(super) fn telling_duties(mut self) -> Self {
        self.tells_duties = true;
        self
    }

    pub(super) fn now(&self) -> Duration {
        self.now
    }

    /// Runs every tick that is due up to `to`, each at its own time.
    pub(super) fn advance(&mut self, to: Duration) -> Result<(), Stuck> {
        if to.saturating_sub(self.now) > LONGEST_SILENCE {
            return Err(Stuck::LongSilence { silence: to.saturating_sub(self.now) });
        }
        let mut at_once = 0;
        while let Some(due) = self.controller.next_tick().filter(|&due| due <= to) {
            let now = due.max(self.now);
            at_once = if now > self.now { 0 } else { at_once + 1 };
            if at_once > MOST_TICKS_AT_ONCE {
                return Err(Stuck::TicksWithoutEnd { time: now });
            }
            self.now = now;
            self.controller.tick(now);
            self.fetch()?;
        }
        self.now = self.now.max(to);
        Ok(())
    }

    /// Hands the controller what the record says, if that is an input.
    pub(super) fn feed(&mut self, record: &Record) -> Result<(), Stuck> {
        let now = self.now;
        match &record.event {
            Event::Host(bytes) => {
                for &byte in bytes {
                    self.controller.receive(now, byte);
                    self.fetch()?;
                }
            }
            Event::Controller(bytes) if self.edges == EdgeSource::Pulses => {
                for &byte in bytes {
                    if let Some(Reply::Pulse(axis, sign)) = Reply::from_byte(byte) {
                        self.controller.edge(now, axis, sign);
                        self.fetch()?;
                    }
                }
            }
            Event::Edge { axis, sign } if self.takes_edges() => {
                self.controller.edge(now, *axis, *sign);
            }
            Event::Pen(pen) => {
                self.recorded_pen = *pen;
                return Ok(());
            }
            Event::Target { x, y } => self.controller.target(now, self.recorded_pen, StepPoint::new(*x, *y)),
            Event::Switch { name, pressed } => self.controller.switch(now, name, *pressed),
            Event::Estop(pressed) => self.controller.emergency_stop(now, *pressed),
            Event::Edge { .. } | Event::Controller(_) | Event::Drive { .. } | Event::Note(_) => return Ok(()),
        }
        self.fetch()
    }

    fn takes_edges(&self) -> bool {
        self.edges == EdgeSource::Records && !self.controller.makes_steps()
    }

    /// Whether a recorded byte is an answer to compare, or an input.
    pub(super) fn is_answer(&self, byte: u8) -> bool {
        self.edges == EdgeSource::Records
            || self.controller.makes_steps()
            || !matches!(Reply::from_byte(byte), Some(Reply::Pulse(..)))
    }

    fn fetch(&mut self) -> Result<(), Stuck> {
        let mut fetched = 0;
        // A step may give an answer, and an answer that is sent room for what gives a step.
        loop {
            let before = fetched;
            while let Some(step) = self.controller.step(self.now) {
                fetched += 1;
                if fetched > MOST_WAITING || self.did.len() >= MOST_WAITING {
                    return Err(Stuck::StepsWithoutEnd { time: self.now });
                }
                for (axis, by) in [(Axis::X, step.x), (Axis::Y, step.y)] {
                    let sign = match by {
                        0 => continue,
                        1.. => Direction::Plus,
                        _ => Direction::Minus,
                    };
                    self.did.push_back((self.now, Did::Step(axis, sign)));
                }
            }
            while let Some(byte) = self.controller.transmit_at(self.now) {
                fetched += 1;
                if fetched > MOST_WAITING || self.said.len() >= MOST_WAITING {
                    return Err(Stuck::BytesWithoutEnd { time: self.now });
                }
                let time = self.wire.send(self.now);
                if self.is_answer(byte) {
                    self.said.push_back((time, byte));
                }
            }
            if fetched == before {
                break;
            }
        }
        let pen = self.controller.pen();
        if let Some(now) = pen.filter(|_| pen != self.pen) {
            self.pen = pen;
            self.did.push_back((self.now, Did::Pen(now)));
        }
        if self.tells_duties {
            for (axis, before) in Axis::BOTH.into_iter().zip(&mut self.duties) {
                let duty = self.controller.duty(axis);
                if duty != *before {
                    *before = duty;
                    self.did.push_back((self.now, Did::Duty(axis, duty)));
                }
            }
        }
        Ok(())
    }
}
