//! A controller that is led through recorded time.

use super::unlinked::Unlinked;
use super::{Controller, RecordingTraits, Stuck};
use crate::log::{Event, Header, Record};
use core::time::Duration;
use plotter_motion::protocol::Wire;
use plotter_motion::protocol::digits::Reply;
use plotter_motion::{Axis, Direction, Pen, StepPoint};
use std::collections::VecDeque;

/// Ticks in a row that may leave the next tick where it was.
const MOST_TICKS_AT_ONCE: u32 = 1_000;
/// Ticks in a row of a controller that waits for the line which may find nothing that they can do: a second
/// of them.
const MOST_TICKS_OVERDUE: u32 = 1_000_000;
/// Bytes that may wait for the line: 40 s of it at 256000 baud.
const MOST_WAITING: usize = 1_000_000;
/// How long a re-run message by message waits for an answer that was recorded.
const LONGEST_WAIT: Duration = Duration::from_secs(1);
/// Silence between two records, or before the first, that is still run through tick by tick.
const LONGEST_SILENCE: Duration = Duration::from_secs(3_600);

/// A time as a log has it.
fn whole_micros(time: Duration) -> Duration {
    Duration::new(time.as_secs(), time.subsec_micros().saturating_mul(1_000))
}

/// Where the edges for a re-run come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum EdgeSource {
    /// The log's `@ edge` records: a re-run is exact.
    #[default]
    Records,
    /// The controller's own pulse bytes, for a log without edges. They come one byte later than the edges
    /// came, so that only the order of the other answers is exact.
    Pulses,
    /// The machine's messages on the reliable link, for a log of frames without edges: it is run again
    /// message by message, and its answers are compared without their frames.
    Messages,
}

impl EdgeSource {
    /// What these records allow: their edges if there are any, else the messages or pulses.
    pub fn from_records<'a>(records: impl IntoIterator<Item = &'a Record>) -> Self {
        let mut traits = RecordingTraits::default();
        records.into_iter().for_each(|record| traits.look(record));
        traits.settings(&Header::new(), false).edges
    }
}

/// What a controller does besides sending bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Did {
    /// A motor made a step.
    Step(Axis, Direction),
    /// The pen was lifted or lowered.
    Pen(Pen),
    /// A motor got another duty cycle.
    Duty(Axis, i32),
}

/// A controller, the line that its bytes go over, and how far in time it is.
#[derive(Debug)]
pub(crate) struct Run<C> {
    pub(super) controller: Unlinked<C>,
    edges: EdgeSource,
    wire: Wire,
    /// When the byte is through that is on the line of a controller that waits for it.
    busy_until: Option<Duration>,
    /// When such a controller was ticked last.
    ticked: Option<Duration>,
    now: Duration,
    /// How much later than recorded it is, of a re-run message by message: how long it was waited for
    /// answers.
    late: Duration,
    /// Bytes of answers that were recorded and that were said.
    answers: [u64; 2],
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
    pub(crate) fn new(controller: C, baud: u32, edges: EdgeSource) -> Self {
        let controller = match edges {
            EdgeSource::Messages => Unlinked::behind_a_link(controller),
            EdgeSource::Records | EdgeSource::Pulses => Unlinked::plain(controller),
        };
        Self {
            pen: controller.pen(),
            duties: Axis::BOTH.map(|axis| controller.duty(axis)),
            controller,
            edges,
            wire: Wire::new(baud),
            busy_until: None,
            ticked: None,
            now: Duration::ZERO,
            late: Duration::ZERO,
            answers: [0; 2],
            said: VecDeque::new(),
            did: VecDeque::new(),
            tells_duties: false,
            recorded_pen: Pen::Up,
        }
    }

    /// The same, which also tells when a duty cycle changes.
    pub(crate) fn telling_duties(mut self) -> Self {
        self.tells_duties = true;
        self
    }

    pub(crate) fn now(&self) -> Duration {
        self.now
    }

    pub(crate) fn controller(&self) -> &C {
        &self.controller.inner
    }

    /// Lets time pass for a controller that is not run any further.
    #[cfg(feature = "live")]
    pub(crate) fn stand_until(&mut self, to: Duration) {
        self.now = self.now.max(to);
    }

    /// The next of what was said and done until `to`, in the order of its times.
    pub(crate) fn next_told(&mut self, to: Duration) -> Option<Record> {
        let said = self.said.front().map(|&(time, _)| time).filter(|&time| time <= to);
        let did = self.did.front().map(|&(time, _)| time).filter(|&time| time <= to);
        if did.is_some_and(|did| said.is_none_or(|said| did <= said)) {
            return self.next_act(to);
        }
        let (time, byte) = said.and_then(|_| self.said.pop_front())?;
        Some(Record { time, event: Event::Controller(vec![byte]) })
    }

    /// The next of what was done until `to`.
    pub(super) fn next_act(&mut self, to: Duration) -> Option<Record> {
        let (time, did) = self.did.front().copied().filter(|&(time, _)| time <= to)?;
        self.did.pop_front();
        let event = match did {
            Did::Step(axis, sign) => Event::Edge { axis, sign },
            Did::Pen(pen) => Event::Pen(pen),
            Did::Duty(axis, duty) => Event::Drive { axis, duty },
        };
        Some(Record { time, event })
    }

    /// Runs every tick that is due up to the recorded time `to`, each at its own time.
    pub(crate) fn advance(&mut self, to: Duration) -> Result<(), Stuck> {
        self.run_to(to.saturating_add(self.late))
    }

    /// Where the motors were is only told every 20 ms, so what is recorded as done may need some more: edges
    /// of the next way must not come before. All that follows is so much later.
    fn wait_for_answers(&mut self) -> Result<(), Stuck> {
        let until = self.now.saturating_add(LONGEST_WAIT);
        let began = self.now;
        while let [recorded, said] = self.answers
            && said < recorded
            && let Some(due) = self.controller.next_tick().filter(|&due| due <= until)
        {
            self.run_to(due)?;
        }
        self.late = self.late.saturating_add(self.now.saturating_sub(began));
        Ok(())
    }

    fn run_to(&mut self, to: Duration) -> Result<(), Stuck> {
        if to.saturating_sub(self.now) > LONGEST_SILENCE {
            return Err(Stuck::LongSilence { silence: to.saturating_sub(self.now) });
        }
        if self.controller.waits_for_line() {
            return self.advance_with_line(to);
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

    /// The same for a controller that waits for the line, in the order of [`plotter_motion::plant::Bench`]:
    /// of what happens at the same time the tick comes first, then what the records say, then the line is
    /// free.
    fn advance_with_line(&mut self, to: Duration) -> Result<(), Stuck> {
        let mut overdue = 0;
        loop {
            let free = self.busy_until.is_none();
            let transmission = self.controller.next_transmission().filter(|_| free);
            let due = [self.controller.next_tick(), transmission].into_iter().flatten().min();
            // What has nothing to say although it is due is asked again a microsecond later.
            let later = self.ticked.map_or(Duration::ZERO, |at| at.saturating_add(Duration::from_micros(1)));
            let tick = due.map(|due| due.max(later).max(self.now)).filter(|&at| at <= to);
            let through = self.busy_until.map(|at| at.max(self.now)).filter(|&at| at < to);
            match (tick, through) {
                (Some(at), through) if through.is_none_or(|through| at <= through) => {
                    overdue = if due.is_some_and(|due| due < at) { overdue + 1 } else { 0 };
                    if overdue > MOST_TICKS_OVERDUE {
                        return Err(Stuck::TicksWithoutEnd { time: at });
                    }
                    self.now = at;
                    self.ticked = Some(at);
                    self.controller.tick(at);
                }
                (_, Some(at)) => {
                    self.now = at;
                    self.busy_until = None;
                }
                _ => break,
            }
            self.fetch()?;
        }
        self.now = self.now.max(to);
        Ok(())
    }

    /// Runs what is due within the microsecond of the last record: in the log it is of the same time.
    pub(super) fn end(&mut self) -> Result<(), Stuck> {
        self.run_to(whole_micros(self.now).saturating_add(Duration::from_nanos(999)))
    }

    /// Hands the controller what the record says, if that is an input.
    pub(crate) fn feed(&mut self, record: &Record) -> Result<(), Stuck> {
        let now = self.now;
        match &record.event {
            Event::Controller(bytes) if self.edges == EdgeSource::Messages => {
                let [recorded, _] = &mut self.answers;
                *recorded = recorded.saturating_add(bytes.len() as u64);
                return self.wait_for_answers();
            }
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
            // What was said at this time is through now, not before.
            Event::Controller(_) if self.busy_until.is_some_and(|at| at <= now) => self.busy_until = None,
            Event::Edge { .. } | Event::Controller(_) | Event::Drive { .. } | Event::Note(_) => return Ok(()),
        }
        self.fetch()
    }

    /// Whether the recording has no steps to compare with, though the controller makes some.
    pub(super) fn has_no_acts(&self) -> bool {
        self.edges == EdgeSource::Pulses && self.controller.makes_steps()
    }

    fn takes_edges(&self) -> bool {
        self.edges != EdgeSource::Pulses && !self.controller.makes_steps()
    }

    /// Whether a recorded byte is an answer to compare, or an input.
    pub(super) fn is_answer(&self, byte: u8) -> bool {
        self.edges != EdgeSource::Pulses
            || self.controller.makes_steps()
            || !matches!(Reply::from_byte(byte), Some(Reply::Pulse(..)))
    }

    fn fetch(&mut self) -> Result<(), Stuck> {
        // In whole microseconds, as a log has it.
        let at = whole_micros(self.now.saturating_sub(self.late));
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
                    self.did.push_back((at, Did::Step(axis, sign)));
                }
            }
            while self.busy_until.is_none()
                && let Some(byte) = self.controller.transmit_at(self.now)
            {
                fetched += 1;
                if fetched > MOST_WAITING || self.said.len() >= MOST_WAITING {
                    return Err(Stuck::BytesWithoutEnd { time: self.now });
                }
                let time = self.wire.send(self.now);
                self.busy_until = self.controller.waits_for_line().then_some(time);
                if self.is_answer(byte) {
                    let [_, said] = &mut self.answers;
                    *said = said.saturating_add(1);
                    self.said.push_back((time.saturating_sub(self.late), byte));
                }
            }
            if fetched == before {
                break;
            }
        }
        let pen = self.controller.pen();
        if let Some(now) = pen.filter(|_| pen != self.pen) {
            self.pen = pen;
            self.did.push_back((at, Did::Pen(now)));
        }
        if self.tells_duties {
            for (axis, before) in Axis::BOTH.into_iter().zip(&mut self.duties) {
                let duty = self.controller.duty(axis);
                if duty != *before {
                    *before = duty;
                    self.did.push_back((at, Did::Duty(axis, duty)));
                }
            }
        }
        Ok(())
    }
}
