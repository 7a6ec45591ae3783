//! [`Player`]: runs a controller again on what a log recorded, and compares every answer and its time.
//!
//! Time is the log's, in whole microseconds. Before a record is handed over, every tick that is due by then
//! is run at its own time; among equal times the order of the records decides. The controller's bytes go over
//! a line of their own, ten bit times each ([`plotter_motion::protocol::Wire`]), and are stamped when the
//! last bit is through, as a log stamps them.

mod answering_board;
mod any;
mod board;
mod controller;
mod ebb_board;
mod fronts;
mod gantry;
mod inputs;
mod linked;
mod linked_machine;
mod machine;
mod outcome;
mod pace;
mod rerun;
mod run;
mod stepper;
mod told;
mod traits;
mod unframed;
mod unlinked;

pub use answering_board::AnsweringBoard;
pub use any::{AnyController, ControllerError};
pub use controller::Controller;
pub use ebb_board::EbbBoard;
#[cfg(feature = "live")]
pub(crate) use fronts::{Hpgl, Marlin};
#[cfg(feature = "live")]
pub(crate) use gantry::limit;
pub use inputs::Inputs;
pub use linked::LinkedController;
pub use linked_machine::LinkedMachine;
pub use machine::MachineController;
pub use outcome::{Answer, Compared, Difference, Outcome, Stuck};
pub use pace::{Pace, PaceSettings};
pub use rerun::Rerun;
pub use run::EdgeSource;
pub use traits::RecordingTraits;
pub(crate) use unframed::SESSION;

use crate::log::{Event, Header, Record};
use core::time::Duration;
use run::Did;
#[cfg(feature = "live")]
pub(crate) use run::Run;
#[cfg(not(feature = "live"))]
use run::Run;
use std::collections::VecDeque;

/// Records that a difference shows on each side of its place.
const CONTEXT: usize = 10;

/// How a recording is re-run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PlayerSettings {
    /// Bits a second on the line.
    pub baud: u32,
    /// How far the time of an answer may be off: zero for what a simulation recorded; a millisecond or two
    /// for a real line, whose recorder groups bytes.
    pub tolerance: Duration,
    /// Where the edges come from.
    pub edges: EdgeSource,
    /// Whether a re-run tells each change of a duty cycle, too.
    pub tells_duties: bool,
}

impl PlayerSettings {
    /// The same with another [`PlayerSettings::baud`].
    #[must_use]
    pub const fn with_baud(self, baud: u32) -> Self {
        Self { baud, ..self }
    }

    /// The same with another [`PlayerSettings::tolerance`].
    #[must_use]
    pub const fn with_tolerance(self, tolerance: Duration) -> Self {
        Self { tolerance, ..self }
    }

    /// The same with another [`PlayerSettings::edges`].
    #[must_use]
    pub const fn with_edges(self, edges: EdgeSource) -> Self {
        Self { edges, ..self }
    }

    /// The same with another [`PlayerSettings::tells_duties`].
    #[must_use]
    pub const fn with_tells_duties(self, tells_duties: bool) -> Self {
        Self { tells_duties, ..self }
    }
}

impl Default for PlayerSettings {
    /// 256000 baud, exact, with the recorded edges.
    fn default() -> Self {
        Self { baud: 256_000, tolerance: Duration::ZERO, edges: EdgeSource::Records, tells_duties: true }
    }
}

impl PlayerSettings {
    /// The defaults with the baud rate that a log's header says, and with what these records of it allow: see
    /// [`RecordingTraits::settings`].
    pub fn for_recording<'a>(header: &Header, records: impl IntoIterator<Item = &'a Record>) -> Self {
        let mut traits = RecordingTraits::default();
        records.into_iter().for_each(|record| traits.look(record));
        traits.settings(header, false)
    }

    /// The defaults with the baud rate that a log's header says.
    #[must_use]
    pub fn from_header(header: &Header) -> Self {
        let base = Self::default();
        Self { baud: header.baud().unwrap_or(base.baud), ..base }
    }
}

/// Runs controllers on recordings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Player {
    settings: PlayerSettings,
}

impl Player {
    /// A player with these settings.
    #[must_use]
    pub const fn new(settings: PlayerSettings) -> Self {
        Self { settings }
    }

    /// The records as a controller is run on them; those of which an outcome tells.
    pub fn inputs<I: IntoIterator<Item = Record>>(&self, records: I) -> Inputs<I::IntoIter> {
        Inputs::new(records.into_iter(), self.settings.edges)
    }

    /// The header of what comes of a re-run: that of the recording, unless it is run message by message.
    #[must_use]
    pub fn header(&self, header: &Header) -> Header {
        match self.settings.edges {
            EdgeSource::Messages => header.clone().with_text("protocol", "messages"),
            EdgeSource::Records | EdgeSource::Pulses => header.clone(),
        }
    }

    /// Runs `controller` on the records and compares each answered byte with its time, and each recorded duty
    /// cycle. What the controller would say after the last record is not compared: the recorder may have been
    /// stopped.
    pub fn check(&self, records: impl IntoIterator<Item = Record>, controller: impl Controller) -> Outcome {
        let mut records = (0_u64..).zip(self.inputs(records));
        let mut check = Check {
            run: Run::new(controller, self.settings.baud, self.settings.edges),
            tolerance: self.settings.tolerance,
            recorded: VecDeque::new(),
            acted: VecDeque::new(),
            context: VecDeque::new(),
            compared: Compared::default(),
        };
        let mut result = Ok(());
        for (index, record) in records.by_ref() {
            result = check.push(index, record);
            if result.is_err() {
                break;
            }
        }
        match result.and_then(|()| check.end()) {
            Ok(()) => Outcome::Equal(check.compared),
            Err(mut difference) => {
                difference.context = check.context.into_iter().chain(records.take(CONTEXT)).collect();
                Outcome::FirstDifference(difference)
            }
        }
    }

    /// Runs `controller` on the inputs among the records, and hands `sink` the recording that this gives: the
    /// same inputs, with what the controller says and drives now.
    ///
    /// # Errors
    ///
    /// [`Stuck`] if the controller cannot be run to the end; `sink` has had what came before.
    pub fn rerun(
        &self,
        records: impl IntoIterator<Item = Record>,
        controller: impl Controller,
        mut sink: impl FnMut(Record),
    ) -> Result<(), Stuck> {
        self.rerun_iter(records, controller).try_for_each(|record| record.map(&mut sink))
    }

    /// The same, record by record.
    pub fn rerun_iter<I: IntoIterator<Item = Record>, C: Controller>(
        &self,
        records: I,
        controller: C,
    ) -> Rerun<I::IntoIter, C> {
        Rerun::new(self.inputs(records), controller, self.settings)
    }
}

/// A re-run that is being compared.
struct Check<C> {
    run: Run<C>,
    tolerance: Duration,
    /// Recorded answers that were not compared yet: index of the record, time, byte.
    recorded: VecDeque<(u64, Duration, u8)>,
    /// Recorded steps and moves of the pen that were not compared yet.
    acted: VecDeque<(u64, Duration, Did)>,
    context: VecDeque<(u64, Record)>,
    compared: Compared,
}

impl<C: Controller> Check<C> {
    fn push(&mut self, index: u64, record: Record) -> Result<(), Box<Difference>> {
        if self.context.len() > CONTEXT {
            self.context.pop_front();
        }
        let time = record.time;
        self.context.push_back((index, record.clone()));
        // Of two changes of a duty at one time, the first is over when the ticks of that time are run.
        let before = match record.event {
            Event::Drive { axis, .. } if self.run.now() == time => Some(self.run.controller.duty(axis)),
            _ => None,
        };
        self.run.advance(time).map_err(|stuck| self.stuck(index, time, stuck))?;
        self.run.feed(&record).map_err(|stuck| self.stuck(index, time, stuck))?;
        match record.event {
            Event::Controller(bytes) => {
                let answers = bytes.into_iter().filter(|&byte| self.run.is_answer(byte));
                self.recorded.extend(answers.map(|byte| (index, time, byte)));
            }
            Event::Drive { axis, duty } => {
                let now = self.run.controller.duty(axis);
                if now != duty && before != Some(duty) {
                    let (expected, got) = (Answer::Duty { axis, duty }, Answer::Duty { axis, duty: now });
                    return Err(self.difference(index, time, expected, got));
                }
                self.compared.duties = self.compared.duties.saturating_add(1);
            }
            Event::Edge { axis, sign } if self.run.controller.makes_steps() => {
                self.acted.push_back((index, time, Did::Step(axis, sign)));
            }
            Event::Pen(pen) if self.run.controller.pen().is_some() => {
                self.acted.push_back((index, time, Did::Pen(pen)));
            }
            _ => {}
        }
        self.compare(index, time)?;
        self.compare_acts(index, time)?;
        self.compared.records = self.compared.records.saturating_add(1);
        Ok(())
    }

    /// Compares what both sides have said; what only one has said is a difference once the other is too late.
    fn compare(&mut self, index: u64, now: Duration) -> Result<(), Box<Difference>> {
        loop {
            match (self.recorded.front().copied(), self.run.said.front().copied()) {
                (Some((at, time, byte)), Some((said, said_byte))) => {
                    if byte != said_byte || time.abs_diff(said) > self.tolerance {
                        let (expected, got) =
                            (Answer::Byte { time, byte }, Answer::Byte { time: said, byte: said_byte });
                        return Err(self.difference(at, time, expected, got));
                    }
                    self.recorded.pop_front();
                    self.run.said.pop_front();
                    self.compared.bytes = self.compared.bytes.saturating_add(1);
                }
                (Some((at, time, byte)), None) if time.saturating_add(self.tolerance) < now => {
                    return Err(self.difference(at, time, Answer::Byte { time, byte }, Answer::Nothing));
                }
                (None, Some((time, byte))) if time.saturating_add(self.tolerance) < now => {
                    return Err(self.difference(index, time, Answer::Nothing, Answer::Byte { time, byte }));
                }
                _ => return Ok(()),
            }
        }
    }

    /// The same for steps and the pen.
    fn compare_acts(&mut self, index: u64, now: Duration) -> Result<(), Box<Difference>> {
        if self.run.has_no_acts() {
            self.run.did.clear();
            return Ok(());
        }
        loop {
            match (self.acted.front().copied(), self.run.did.front().copied()) {
                (Some((at, time, act)), Some((done, did))) => {
                    if act != did || time.abs_diff(done) > self.tolerance {
                        return Err(self.difference(at, time, answer(time, act), answer(done, did)));
                    }
                    self.acted.pop_front();
                    self.run.did.pop_front();
                    self.compared.steps = self.compared.steps.saturating_add(1);
                }
                (Some((at, time, act)), None) if time.saturating_add(self.tolerance) < now => {
                    return Err(self.difference(at, time, answer(time, act), Answer::Nothing));
                }
                (None, Some((done, did))) if done.saturating_add(self.tolerance) < now => {
                    return Err(self.difference(index, done, Answer::Nothing, answer(done, did)));
                }
                _ => return Ok(()),
            }
        }
    }

    fn end(&mut self) -> Result<(), Box<Difference>> {
        let Some(&(index, ref last)) = self.context.back() else {
            return Ok(());
        };
        let end = last.time;
        self.run
            .advance(end.saturating_add(self.tolerance))
            .and_then(|()| self.run.end())
            .map_err(|stuck| self.stuck(index, end, stuck))?;
        self.compare(index, end)?;
        self.compare_acts(index, end)?;
        if let Some(&(at, time, act)) = self.acted.front() {
            return Err(self.difference(at, time, answer(time, act), Answer::Nothing));
        }
        match self.recorded.front().copied() {
            Some((at, time, byte)) => {
                Err(self.difference(at, time, Answer::Byte { time, byte }, Answer::Nothing))
            }
            None => Ok(()),
        }
    }

    fn stuck(&self, index: u64, time: Duration, stuck: Stuck) -> Box<Difference> {
        self.difference(index, time, Answer::Nothing, Answer::Stuck(stuck))
    }

    fn difference(&self, index: u64, time: Duration, expected: Answer, got: Answer) -> Box<Difference> {
        Box::new(Difference { time, index, expected, got, until_then: self.compared, context: Vec::new() })
    }
}

fn answer(time: Duration, did: Did) -> Answer {
    match did {
        Did::Step(axis, sign) => Answer::Step { time, axis, sign },
        Did::Pen(pen) => Answer::Pen { time, pen },
        Did::Duty(axis, duty) => Answer::Duty { axis, duty },
    }
}
