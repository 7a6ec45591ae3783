//! [`SimulatedMachine`]: a machine that is not there, for a host in this program or at the end of a line.

use super::line::{Line, lock};
use super::machine_line::MachineLine;
use super::machine_log::MachineLog;
use super::pace::Pace;
use super::telling_belt::TellingBelt;
use super::{Command, Showing};
use crate::log::{Event, Record};
use crate::player::{AnsweringBoard, ControllerError};
use crate::serial::{PortError, PortErrorKind};
use crate::simulation::{
    Act, ActError, Script, Seen, Simulation, Take, Told, World, ebb, hpgl, marlin, steppers,
};
use core::fmt;
use core::time::Duration;
use plotter_motion::firmware::stepper_plotter::Dialect;
use plotter_motion::firmware::{Gantry, LinkedGantry};
use plotter_motion::plant::{Bench, BenchController, BenchEvent, BenchSettings};
use plotter_motion::protocol::{LinkSettings, Order};
use plotter_motion::{
    Axis, ConfigError, LimitSwitches, Machine, Pen, PenMove, SafetyGate, config::MachineKind,
};
use std::io::{Sink, Write};
use std::sync::{Arc, Mutex};
use std::time::Instant;

/// What no byte on the line tells of a simulated machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Telemetry {
    /// The machine's own time.
    pub time: Duration,
    /// Duty of both motors, signed steps of their timers.
    pub duty: [i32; 2],
    /// Where the pen belongs, of a machine that is told so.
    pub pen: Option<Pen>,
    /// When the last emergency stop came, in the machine's time, and when both motors were off after it.
    pub stopped: Option<(Duration, Option<Duration>)>,
}

/// How often a simulated machine and its host exchange their bytes, in the machine's time: the frame of
/// full-speed USB, in which an adapter hands on what has come (USB 2.0, section 8.4.3).
pub(super) const EXCHANGE_EVERY: Duration = Duration::from_millis(1);
/// Bytes of the machine that wait for a host to read them.
const MOST_UNREAD: usize = 16_384;
/// How long a machine that is ahead of the clock listens at most at once.
const LISTEN: Duration = Duration::from_millis(1);

/// Whether a simulated machine goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watch {
    /// It does.
    GoOn,
    /// It ends.
    End,
}

/// A simulated machine: controller, motors, and the near end of its line. Its time passes only as it is told
/// to.
///
/// ```
/// # use plotter_motion::{Machine, MachineConfig};
/// # use plotter_replay::live::{Line, SimulatedMachine};
/// # use std::time::Duration;
/// let machine = Machine::new(MachineConfig::default())?;
/// let line = SimulatedMachine::new(&machine, Some(7))?.line(1e6); // as fast as it goes
/// line.send(&[0; 20])?; // a call of the reliable link
/// let mut answer = [0; 64];
/// assert!(line.receive(&mut answer, Duration::from_secs(1))? > 0);
/// assert!(line.now() < Some(Duration::from_millis(10))); // in the machine's time
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct SimulatedMachine<W: Write = Sink> {
    bench: Box<dyn Steps + Send>,
    log: Option<MachineLog<W>>,
    answers: Vec<u8>,
    told: Telemetry,
    telemetry: Arc<Mutex<Telemetry>>,
    script: Script,
    showing: Option<Showing>,
    /// Bytes that the machine has said and that nobody took from the line.
    lost_answers: u64,
}

/// What a simulated machine speaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Spoken {
    /// Ten digits a target: machines with DC motors.
    Digits,
    /// Frames with a host that calls, else digits: DC motors that each move an axis.
    Link {
        /// The machine's number since it was switched on, another one each time.
        boot: u32,
    },
    /// Grbl's lines: stepper motors.
    Grbl,
    /// mDraw's lines: stepper motors.
    MDraw,
    /// Marlin's lines: stepper motors that move a pen.
    Marlin,
    /// HPGL, as a 7475A on a serial line: stepper motors that move a pen.
    Hpgl,
    /// The commands of an EBB: stepper motors.
    Ebb {
        /// Whether both motors move the pen by one belt, as in the AxiDraw; else each moves an axis.
        is_mixed: bool,
    },
}

/// A machine whose time passes step by step, whatever its controller.
pub(super) trait Steps {
    fn now(&self) -> Duration;
    fn byte(&mut self, byte: u8);
    /// Bytes of the host that have not come through yet, where a machine tells.
    fn on_line(&self) -> usize;
    fn step(&mut self, sink: Take<'_>);
    fn act(&mut self, act: &Act) -> Result<(), ActError>;
    fn seen(&self) -> Seen;
    /// What it has said since the last time that its log has in another form.
    fn said(&mut self) -> Vec<u8> {
        Vec::new()
    }
}

impl<C: BenchController> Steps for Bench<std::iter::Empty<PenMove>, C> {
    fn now(&self) -> Duration {
        Self::now(self)
    }
    fn byte(&mut self, byte: u8) {
        self.disturb(byte);
    }
    fn on_line(&self) -> usize {
        0
    }
    fn step(&mut self, sink: Take<'_>) {
        Self::step(self, |time, event| {
            let event = match event {
                BenchEvent::HostByte(byte) => Event::Host(vec![byte]),
                BenchEvent::ControllerByte(byte) => Event::Controller(vec![byte]),
                BenchEvent::Edge(axis, sign) => Event::Edge { axis, sign },
                BenchEvent::Drive(axis, duty) => Event::Drive { axis, duty },
                BenchEvent::Controller(notice) => Event::Note(format!("controller: {notice}")),
                // The bench has a host of its own, which sends nothing.
                BenchEvent::Host(_) => return,
            };
            sink(time, event);
        });
    }
    fn act(&mut self, act: &Act) -> Result<(), ActError> {
        match *act {
            Act::Hold { axis, held } => {
                self.axis_mut(axis).stall(held);
                Ok(())
            }
            _ => Err(ActError { message: String::from("a machine with DC motors has hold and let") }),
        }
    }
    fn seen(&self) -> Seen {
        let drives = Axis::BOTH.map(|axis| self.controller().drive().axis(axis).value() != 0.0);
        let doing = if drives == [false; 2] { "idle" } else { "draws" };
        Seen { doing, at: self.position_mm(), pen: self.controller().pen(), ..Seen::default() }
    }
}

impl<C: Told, W: World> Steps for Simulation<C, W> {
    fn now(&self) -> Duration {
        Self::now(self)
    }
    fn byte(&mut self, byte: u8) {
        Self::byte(self, byte);
    }
    fn on_line(&self) -> usize {
        Self::on_line(self)
    }
    fn step(&mut self, sink: Take<'_>) {
        Self::step(self, sink);
    }
    fn act(&mut self, act: &Act) -> Result<(), ActError> {
        Self::act(self, act)
    }
    fn seen(&self) -> Seen {
        Self::seen(self)
    }
}

impl SimulatedMachine {
    /// Duty steps that are the whole supply of a belt's motors, as its log and [`Telemetry`] have them.
    pub const BELT_PWM_STEPS: u32 = AnsweringBoard::PWM_STEPS as u32;

    /// `machine` at rest at its origin. It speaks digits, and with a `boot` frames with a host that calls;
    /// that is its number since it was switched on, another one each time.
    ///
    /// # Errors
    ///
    /// [`ConfigError::OtherKind`] for a machine whose DC motors do not each move an axis.
    pub fn new(machine: &Machine, boot: Option<u32>) -> Result<Self, ConfigError> {
        machine.require(MachineKind::Gantry, "what is simulated on a line")?;
        Ok(Self::of(gantry(machine, boot)))
    }

    /// `machine` at rest where it is switched on, with the controller of its kind.
    ///
    /// ```
    /// # use plotter_motion::{Machine, MachineConfig};
    /// # use plotter_replay::live::{Line, SimulatedMachine, Spoken};
    /// # use std::time::Duration;
    /// let machine = Machine::new(MachineConfig::stepper_plotter())?;
    /// let line = SimulatedMachine::speaking(&machine, Spoken::Grbl)?.line(1e6); // as fast as it goes
    /// let mut greeting = [0; 64];
    /// line.receive(&mut greeting, Duration::from_secs(1))?;
    /// assert!(greeting.starts_with(b"\r\nGrbl 1.1"));
    /// assert!(SimulatedMachine::speaking(&machine, Spoken::Digits).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ControllerError`] for a machine of a kind that does not speak so.
    pub fn speaking(machine: &Machine, spoken: Spoken) -> Result<Self, ControllerError> {
        let refused = |error: ConfigError| ControllerError { message: error.to_string() };
        let bench: Box<dyn Steps + Send> = match (spoken, machine.kind()) {
            (Spoken::Digits, MachineKind::Belt) => Box::new(TellingBelt::new(machine)),
            (Spoken::Digits | Spoken::Link { .. }, _) => {
                machine
                    .require(MachineKind::Gantry, "what is simulated with digits or frames")
                    .map_err(refused)?;
                gantry(machine, if let Spoken::Link { boot } = spoken { Some(boot) } else { None })
            }
            (Spoken::Ebb { is_mixed }, _) => {
                machine.require(MachineKind::Steppers, "what is simulated behind an EBB").map_err(refused)?;
                Box::new(ebb(machine, is_mixed))
            }
            (Spoken::Grbl | Spoken::MDraw | Spoken::Marlin | Spoken::Hpgl, _) => {
                machine
                    .require(MachineKind::Steppers, "what is simulated with lines of text")
                    .map_err(refused)?;
                match spoken {
                    Spoken::Marlin => Box::new(marlin(machine)?),
                    Spoken::Hpgl => Box::new(hpgl(machine)?),
                    Spoken::Grbl => Box::new(steppers(machine, Dialect::Grbl)?),
                    _ => Box::new(steppers(machine, Dialect::MDraw)?),
                }
            }
        };
        Ok(Self::of(bench))
    }

    fn of(bench: Box<dyn Steps + Send>) -> Self {
        Self {
            bench,
            log: None,
            answers: Vec::new(),
            told: Telemetry::default(),
            telemetry: Arc::default(),
            script: Script::default(),
            showing: None,
            lost_answers: 0,
        }
    }

    /// The same, to which a script does what it says.
    #[must_use]
    pub fn with_script(self, script: Script) -> Self {
        Self { script, ..self }
    }

    /// The same, which shows what it does; what is asked of it there is done.
    #[must_use]
    pub fn shown(self, showing: Showing) -> Self {
        Self { showing: Some(showing), ..self }
    }

    /// The same, which writes all that it does into `log`.
    #[must_use]
    pub fn logged<W: Write>(self, log: MachineLog<W>) -> SimulatedMachine<W> {
        let Self { bench, answers, told, telemetry, script, showing, lost_answers, .. } = self;
        SimulatedMachine { bench, log: Some(log), answers, told, telemetry, script, showing, lost_answers }
    }
}

fn gantry(machine: &Machine, boot: Option<u32>) -> Box<dyn Steps + Send> {
    let gantry = Gantry::new(machine, SafetyGate::new(LimitSwitches::RELEASED, false));
    match boot {
        Some(boot) => {
            let linked = LinkedGantry::<4, 64>::new(gantry, boot, LinkSettings::default());
            Box::new(bench(machine, linked))
        }
        None => Box::new(bench(machine, gantry)),
    }
}

fn bench<C: BenchController>(machine: &Machine, controller: C) -> Bench<std::iter::Empty<PenMove>, C> {
    Bench::with_controller(machine, BenchSettings::default(), controller, std::iter::empty())
}

impl<W: Write> SimulatedMachine<W> {
    /// What no byte on the line tells.
    #[must_use]
    pub fn telemetry(&self) -> Arc<Mutex<Telemetry>> {
        Arc::clone(&self.telemetry)
    }

    /// The line of a host in this program: its time is the machine's, so that nothing on it depends on how
    /// fast or busy this computer is. At most `speed` seconds of it pass in one of ours.
    #[must_use]
    pub fn line(self, speed: f64) -> MachineLine<W> {
        MachineLine::new(self, speed)
    }

    /// Answers on `line` until that is closed; says how that was. `speed` seconds of the machine pass in one
    /// of ours; the host at the other end goes by a clock of its own. On a computer too slow for that the
    /// machine falls behind, and stays so.
    #[must_use]
    pub fn serve(self, line: &dyn Line, speed: f64) -> PortError {
        let ended = self.serve_until(line, speed, |_| Watch::GoOn);
        // (nothing else ends it)
        ended.err().unwrap_or(PortError { port: String::new(), kind: PortErrorKind::Gone })
    }

    /// The same, until `watch` ends it, which is shown the machine each millisecond of its time.
    ///
    /// # Errors
    ///
    /// [`PortError`] if the line is closed.
    pub fn serve_until(
        mut self,
        line: &dyn Line,
        speed: f64,
        mut watch: impl FnMut(&mut Self) -> Watch,
    ) -> Result<(), PortError> {
        let mut pace = Pace::new(speed);
        let mut bytes = [0; 256];
        loop {
            let to = self.now().saturating_add(EXCHANGE_EVERY);
            let early = pace.wait(Instant::now(), to);
            // What does not fit on the line waits at the host's end of it, as behind an adapter on USB.
            if self.has_line_room() {
                let count = line.receive(&mut bytes, early.min(LISTEN))?;
                self.take(bytes.get(..count).unwrap_or_default());
            } else {
                std::thread::sleep(early.min(LISTEN));
            }
            if pace.wait(Instant::now(), to).is_zero() {
                self.run_to(to);
                if watch(&mut self) == Watch::End {
                    return Ok(());
                }
            }
            if !self.answers.is_empty() {
                let sent = line.offer(&self.answers)?;
                self.answers.drain(..sent.min(self.answers.len()));
                // Nobody reads: what is said is lost, as on a line that nobody listens to.
                let more = self.answers.len().saturating_sub(MOST_UNREAD);
                self.lost_answers = self.lost_answers.saturating_add(more as u64);
                self.answers.truncate(MOST_UNREAD);
            }
        }
    }

    /// Does something to the machine.
    ///
    /// # Errors
    ///
    /// [`ActError`] if it has not got that.
    pub fn act(&mut self, act: &Act) -> Result<(), ActError> {
        self.bench.act(act)
    }

    /// Where it stands.
    #[must_use]
    pub fn seen(&self) -> Seen {
        self.bench.seen()
    }

    /// Bytes that the machine has said and that no host took from the line.
    #[must_use]
    pub fn lost_answers(&self) -> u64 {
        self.lost_answers
    }

    /// Its time.
    #[must_use]
    pub fn now(&self) -> Duration {
        self.bench.now()
    }

    /// Bytes of a host that are on the line at most; more wait until these are through.
    pub(super) const MOST_ON_LINE: usize = 512;

    /// Whether more bytes of the host may go on the line.
    pub(super) fn has_line_room(&self) -> bool {
        self.bench.on_line() < Self::MOST_ON_LINE
    }

    /// Takes bytes of the host, which go over the line now.
    pub(super) fn take(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.bench.byte(byte));
    }

    /// Gives what the machine has said, as far as it finds room.
    pub(super) fn give(&mut self, bytes: &mut [u8]) -> usize {
        let count = self.answers.len().min(bytes.len());
        for (place, byte) in bytes.iter_mut().zip(self.answers.drain(..count)) {
            *place = byte;
        }
        count
    }

    /// Goes on until `to`, by whole time steps.
    pub(super) fn run_to(&mut self, to: Duration) {
        let Self { bench, log, answers, told, telemetry, script, showing, .. } = self;
        let mut new = Vec::new();
        while bench.now() < to {
            for act in script.due(bench.now()) {
                if let (Err(error), Some(log)) = (bench.act(&act), &log) {
                    log.record(bench.now(), Event::Note(format!("script: {error}")));
                }
            }
            bench.step(&mut |at, event| {
                match &event {
                    // (a frame may hold this byte, too: then it is no stop)
                    Event::Host(bytes) if **bytes == [Order::Stop.byte()] && told.duty != [0; 2] => {
                        told.stopped = Some((at, None));
                    }
                    Event::Controller(bytes) => new.extend(bytes),
                    Event::Drive { axis: Axis::X, duty } => told.duty[0] = *duty,
                    Event::Drive { axis: Axis::Y, duty } => told.duty[1] = *duty,
                    _ => {}
                }
                if let Some(showing) = showing {
                    showing.push(&Record { time: at, event: event.clone() });
                }
                if let Some(log) = log {
                    log.record(at, event);
                }
            });
            answers.append(&mut bench.said());
            answers.append(&mut new);
            if let Some((_, off @ None)) = &mut told.stopped
                && told.duty == [0, 0]
            {
                *off = Some(bench.now());
            }
        }
        (told.time, told.pen) = (bench.now(), bench.seen().pen);
        *lock(telemetry) = *told;
        if let Some(log) = log {
            log.tick(told.time);
        }
        if let Some(showing) = showing {
            showing.tick(told.time);
            let asked = showing.commands();
            asked.into_iter().for_each(|command| self.obey(command));
        }
    }

    /// Somebody presses a button on the page.
    fn obey(&mut self, command: Command) {
        let (acts, order) = match command {
            Command::Stop => (&[Act::Button { pressed: true }][..], Order::Stop),
            Command::Resume => (&[Act::Button { pressed: false }, Act::Reset][..], Order::GoOn),
            Command::Start | Command::Pause | Command::Clear | Command::Hand(_) => return,
        };
        // A machine without such a button is stopped over its line: by a byte between zeros, if need be.
        if acts.iter().any(|act| self.bench.act(act).is_err()) {
            self.take(&[0, order.byte(), 0]);
        }
    }
}

impl<W: Write> fmt::Debug for SimulatedMachine<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SimulatedMachine").field("told", &self.told).finish_non_exhaustive()
    }
}
