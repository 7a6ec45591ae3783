//! [`Rerun`]: the recording that a controller gives on the inputs of another.

use super::inputs::Inputs;
use super::run::Run;
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
        self.run.controller()
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
        while let Some(record) = self.run.next_told(to) {
            self.ready.push_back(record);
        }
    }

    fn tell_acts(&mut self, to: Duration) {
        while let Some(record) = self.run.next_act(to) {
            self.ready.push_back(record);
        }
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
                    if let Err(stuck) = self.run.end() {
                        return Some(Err(stuck));
                    }
                    self.tell(Duration::MAX);
                }
            }
        }
    }
}
