//! [`Rerun`]: the recording that a controller gives on the inputs of another.

use super::inputs::Inputs;
use super::run::{Did, Run};
use super::{Controller, PlayerSettings, Stuck};
use crate::log::{Event, Record};
use core::time::Duration;
use std::collections::VecDeque;

/// Runs a controller on the inputs among recorded records, and gives the recording that comes of it: the same
/// inputs, with what the controller says and does now. Its time never goes back, so that it can be written as
/// a log.
#[derive(Debug)]
pub struct Rerun<I, C> {
    records: Inputs<I>,
    run: Run<C>,
    ready: VecDeque<Record>,
    is_over: bool,
}

impl<I: Iterator<Item = Record>, C: Controller> Rerun<I, C> {
    pub(super) fn new(records: Inputs<I>, controller: C, settings: PlayerSettings) -> Self {
        let run = Run::new(controller, settings.baud, settings.edges);
        let run = if settings.tells_duties { run.telling_duties() } else { run };
        Self { records, run, ready: VecDeque::new(), is_over: false }
    }

    /// The controller, as it is now.
    pub fn controller(&self) -> &C {
        &self.run.controller.inner
    }

    fn take(&mut self, record: Record) -> Result<(), Stuck> {
        let advanced = self.run.advance(record.time);
        let waits = self.run.controller.waits_for_line();
        if waits {
            // What is through at the time of a record comes after what the controller takes then: it was not
            // free before.
            if let Some(before) = record.time.checked_sub(Duration::from_micros(1)) {
                self.tell(before);
            }
            self.tell_acts(record.time);
        } else {
            self.tell(record.time);
        }
        advanced?;
        let (makes_steps, moves_pen) =
            (self.run.controller.makes_steps(), self.run.controller.pen().is_some());
        let kept = match &record.event {
            Event::Controller(bytes) => {
                let inputs: Vec<_> =
                    bytes.iter().copied().filter(|&byte| !self.run.is_answer(byte)).collect();
                (!inputs.is_empty()).then_some(Event::Controller(inputs))
            }
            // What the controller does is told by it.
            Event::Drive { .. } => None,
            Event::Edge { .. } if makes_steps => None,
            Event::Pen(_) if moves_pen => None,
            event => Some(event.clone()),
        };
        self.ready.extend(kept.map(|event| Record { time: record.time, event }));
        let fed = self.run.feed(&record);
        if waits && matches!(record.event, Event::Controller(_)) {
            self.tell(record.time);
        }
        self.tell_acts(record.time);
        fed
    }

    /// Tells what was said and done until `to`, in the order of its times.
    fn tell(&mut self, to: Duration) {
        loop {
            let said = self.run.said.front().map(|&(time, _)| time).filter(|&time| time <= to);
            let did = self.run.did.front().map(|&(time, _)| time).filter(|&time| time <= to);
            if did.is_some_and(|did| said.is_none_or(|said| did <= said)) {
                self.tell_act();
                continue;
            }
            let Some((time, byte)) = said.and_then(|_| self.run.said.pop_front()) else { return };
            self.ready.push_back(Record { time, event: Event::Controller(vec![byte]) });
        }
    }

    fn tell_acts(&mut self, to: Duration) {
        while self.run.did.front().is_some_and(|&(time, _)| time <= to) {
            self.tell_act();
        }
    }

    fn tell_act(&mut self) {
        let Some((time, did)) = self.run.did.pop_front() else { return };
        let event = match did {
            Did::Step(axis, sign) => Event::Edge { axis, sign },
            Did::Pen(pen) => Event::Pen(pen),
            Did::Duty(axis, duty) => Event::Drive { axis, duty },
        };
        self.ready.push_back(Record { time, event });
    }
}

impl<I: Iterator<Item = Record>, C: Controller> Iterator for Rerun<I, C> {
    type Item = Result<Record, Stuck>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(record) = self.ready.pop_front() {
                return Some(Ok(record));
            }
            if self.is_over {
                return None;
            }
            match self.records.next() {
                Some(record) => {
                    if let Err(stuck) = self.take(record) {
                        self.is_over = true;
                        return Some(Err(stuck));
                    }
                }
                None => {
                    self.is_over = true;
                    self.tell(Duration::MAX);
                }
            }
        }
    }
}
