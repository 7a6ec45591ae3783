//! A machine that is not there: its controller as the player runs it, and round it what the controller sees
//! of the world. What happens in it is a recording, and a player runs that again to the same microsecond.
//!
//! ```text
//!   bytes of a host ──▶ line ──▶ Run<controller> ──▶ line ──▶ bytes of the machine
//!                                  │ steps, duties   ▲ switches, pulses
//!                                  ▼                 │
//!                                World: motors, carriage, paper ◀── Act: a hand at a switch, a held carriage
//! ```

mod act;
mod belt;
mod ebb;
mod fronts;
mod script;
mod steppers;

pub use act::{Act, ActError};
pub(crate) use belt::{Belt, belt};
pub(crate) use ebb::ebb;
pub(crate) use fronts::{hpgl, marlin};
pub use script::{Script, ScriptError};
pub(crate) use steppers::{Steppers, steppers};

use crate::log::{Event, Record};
use crate::player::{Controller, Run, Stuck};
use core::time::Duration;
use plotter_motion::protocol::Wire;
use plotter_motion::protocol::digits::Receiver;
use plotter_motion::{Axis, Direction, LimitSwitches, Pen, Point, StepPoint};
use std::collections::VecDeque;

/// Takes what happens, with its time.
pub(crate) type Take<'a> = &'a mut dyn FnMut(Duration, Event);

/// Where a simulated machine stands.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seen {
    /// Activity, in a word of the machine's controller.
    pub doing: &'static str,
    /// Where the pen truly is, mm.
    pub at: Point,
    /// Whether it is down, where the controller moves it.
    pub pen: Option<Pen>,
    /// Power of the laser, per cent, where there is one.
    pub laser_percent: Option<f64>,
    /// Limit switches that are pressed.
    pub pressed: LimitSwitches,
    /// Steps that each motor was told and has not made.
    pub lost_steps: [i64; 2],
    /// Whether the pen is beside the paper.
    pub is_off_paper: bool,
    /// Why it does nothing any more, if so.
    pub broken: Option<String>,
}

/// What surrounds a controller.
pub(crate) trait World {
    /// How far it goes on at once at most.
    fn slice(&self) -> Duration;

    /// A motor was told to make a step.
    fn step(&mut self, _at: Duration, _axis: Axis, _sign: Direction) {}

    /// Goes on until `at`, with these duties and the pen so; what the controller is told of it.
    fn go_on(&mut self, at: Duration, duties: [i32; 2], pen: Option<Pen>) -> Vec<Event>;

    /// Somebody does something to the machine.
    ///
    /// # Errors
    ///
    /// This machine has not got that.
    fn act(&mut self, act: &Act) -> Result<Vec<Event>, ActError>;

    /// What is to be seen of it.
    fn look(&self, seen: &mut Seen);

    /// Where counts of the axes lie, in counts of the motors, for a machine that is told targets in digits
    /// and reads none itself; `None` for one outside.
    fn target(&self, _counts: StepPoint) -> Option<StepPoint> {
        None
    }
}

/// A controller of which more can be told than a player asks.
pub(crate) trait Told: Controller {
    /// Activity, in a word, and the power of the laser.
    fn told(&self, now: Duration) -> (&'static str, Option<f64>);

    /// Whether it lets bytes through: by a line of its cable that the host's end of it goes by.
    fn lets_bytes_through(&self) -> bool {
        true
    }

    /// Which way it counts the pulses of a motor whose encoder does not tell.
    fn counting(&self, _motor: Axis) -> Option<Direction> {
        None
    }
}

/// A simulated machine.
pub(crate) struct Simulation<C, W> {
    run: Run<C>,
    world: W,
    line: Wire,
    /// Bytes of the host that are on the line, with the times when they are through.
    on_line: VecDeque<(Duration, u8)>,
    /// Reads targets in digits for a controller that reads nothing.
    reader: Option<Receiver>,
    /// What somebody has done since the last time.
    acts: VecDeque<Event>,
    stuck: Option<Stuck>,
}

impl<C: Told, W: World> Simulation<C, W> {
    /// A machine that has just been switched on.
    pub(crate) fn new(controller: C, world: W, baud: u32) -> Self {
        let run = Run::new(controller, baud, crate::player::EdgeSource::Records).telling_duties();
        Self {
            run,
            world,
            line: Wire::new(baud),
            on_line: VecDeque::new(),
            reader: None,
            // With it a controller comes to say its greeting.
            acts: steppers::switch("power", true).into_iter().collect(),
            stuck: None,
        }
    }

    /// The same, whose controller is told its targets by who reads digits for it.
    pub(crate) fn reading_digits(self, silence: Duration) -> Self {
        Self { reader: Some(Receiver::new(silence)), ..self }
    }

    pub(crate) fn now(&self) -> Duration {
        self.run.now()
    }

    /// Puts a byte of the host on the line.
    pub(crate) fn byte(&mut self, byte: u8) {
        let through = self.line.send(self.run.now());
        self.on_line.push_back((through, byte));
    }

    /// Bytes of the host that are not through.
    pub(crate) fn on_line(&self) -> usize {
        self.on_line.len()
    }

    pub(crate) fn controller(&self) -> &C {
        self.run.controller()
    }

    pub(crate) fn act(&mut self, act: &Act) -> Result<(), ActError> {
        let events = self.world.act(act)?;
        self.acts.extend(events);
        Ok(())
    }

    pub(crate) fn seen(&self) -> Seen {
        let (doing, laser_percent) = self.run.controller().told(self.run.now());
        let broken = self.stuck.as_ref().map(ToString::to_string);
        let pen = self.run.controller().pen();
        let mut seen = Seen { doing, pen, laser_percent, broken, ..Seen::default() };
        self.world.look(&mut seen);
        seen
    }

    /// Goes on by a slice; each event goes to `sink`, in the order of their times.
    pub(crate) fn step(&mut self, sink: Take<'_>) {
        let to = self.run.now().saturating_add(self.world.slice());
        loop {
            let lets = self.run.controller().lets_bytes_through();
            let next = self.on_line.front().filter(|_| lets).map(|&(through, _)| through);
            let due = [self.run.controller().next_tick(), next].into_iter().flatten().min();
            let at = due.map_or(to, |due| due.max(self.run.now())).min(to);
            if let Err(stuck) = self.go_on(at, sink) {
                // A controller that cannot be run any further stands, as one that has crashed.
                self.stuck.get_or_insert(stuck);
                self.run.stand_until(to);
                return;
            }
            if at >= to {
                return;
            }
        }
    }

    fn go_on(&mut self, at: Duration, sink: Take<'_>) -> Result<(), Stuck> {
        if self.stuck.is_some() {
            self.run.stand_until(at);
            return Ok(());
        }
        self.run.advance(at)?;
        self.tell(at, sink);
        // A log has whole microseconds: what the controller is told comes at one.
        let at = Duration::from_micros(u64::try_from(at.as_nanos().div_ceil(1_000)).unwrap_or(u64::MAX));
        let duties = Axis::BOTH.map(|axis| self.run.controller().duty(axis));
        let happened = self.world.go_on(at, duties, self.run.controller().pen());
        let acts = core::mem::take(&mut self.acts);
        for event in happened.into_iter().chain(acts) {
            self.run.advance(at)?;
            self.tell(at, sink);
            let event = match event {
                Event::Edge { axis, .. } => {
                    let sign = self.run.controller().counting(axis).unwrap_or(Direction::Plus);
                    Event::Edge { axis, sign }
                }
                event => event,
            };
            self.feed(at, event, sink)?;
        }
        while self.run.controller().lets_bytes_through()
            && self.on_line.front().is_some_and(|&(through, _)| through <= at)
        {
            let Some((_, byte)) = self.on_line.pop_front() else { break };
            self.run.advance(at)?;
            self.tell(at, sink);
            self.host_byte(at, byte, sink)?;
        }
        Ok(())
    }

    fn host_byte(&mut self, at: Duration, byte: u8, sink: Take<'_>) -> Result<(), Stuck> {
        let Some(reader) = &mut self.reader else {
            return self.feed(at, Event::Host(vec![byte]), sink);
        };
        let Some(counts) = reader.push(at, byte).target else { return Ok(()) };
        match self.world.target(counts) {
            Some(StepPoint { x, y }) => {
                self.feed(at, Event::Pen(Pen::Down), sink)?;
                self.feed(at, Event::Target { x, y }, sink)
            }
            None => {
                let StepPoint { x, y } = counts;
                self.feed(at, Event::Note(format!("target ({x}, {y}) lies outside: left out")), sink)
            }
        }
    }

    /// The controller is told this.
    fn feed(&mut self, at: Duration, event: Event, sink: Take<'_>) -> Result<(), Stuck> {
        let record = Record { time: at, event };
        let fed = self.run.feed(&record);
        sink(at, record.event);
        self.tell(at, sink);
        fed
    }

    /// What the controller has said and done by now.
    fn tell(&mut self, to: Duration, sink: Take<'_>) {
        while let Some(Record { time, event }) = self.run.next_told(to) {
            if let Event::Edge { axis, sign } = event {
                self.world.step(time, axis, sign);
            }
            sink(time, event);
        }
    }
}
