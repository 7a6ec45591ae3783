//! [`SimulatedMachine`]: a machine that is not there, for a host in this program or at the end of a line.

use super::line::{Line, lock};
use super::machine_line::MachineLine;
use super::machine_log::MachineLog;
use super::pace::Pace;
use crate::serial::PortError;
use core::fmt;
use core::time::Duration;
use plotter_motion::firmware::{Gantry, LinkedGantry};
use plotter_motion::plant::{Bench, BenchController, BenchEvent, BenchSettings};
use plotter_motion::protocol::{LinkSettings, Order};
use plotter_motion::{Axis, ConfigError, LimitSwitches, Machine, PenMove, SafetyGate, config::MachineKind};
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
    /// When the last emergency stop came, in the machine's time, and when both motors were off after it.
    pub stopped: Option<(Duration, Option<Duration>)>,
}

/// How often a simulated machine and its host exchange their bytes, in the machine's time: the frame of
/// full-speed USB, in which an adapter hands on what has come (USB 2.0, section 8.4.3).
pub(super) const EXCHANGE_EVERY: Duration = Duration::from_millis(1);
/// How long a machine that is ahead of the clock listens at most at once.
const LISTEN: Duration = Duration::from_millis(1);

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
}

/// A bench, whatever its controller.
trait Steps {
    fn now(&self) -> Duration;
    fn byte(&mut self, byte: u8);
    fn step(&mut self, record: &mut dyn FnMut(Duration, BenchEvent));
}

impl<C: BenchController> Steps for Bench<std::iter::Empty<PenMove>, C> {
    fn now(&self) -> Duration {
        Self::now(self)
    }
    fn byte(&mut self, byte: u8) {
        self.disturb(byte);
    }
    fn step(&mut self, record: &mut dyn FnMut(Duration, BenchEvent)) {
        Self::step(self, record);
    }
}

impl SimulatedMachine {
    /// `machine` at rest at its origin. It speaks digits, and with a `boot` frames with a host that calls;
    /// that is its number since it was switched on, another one each time.
    ///
    /// # Errors
    ///
    /// [`ConfigError::OtherKind`] for a machine whose DC motors do not each move an axis.
    pub fn new(machine: &Machine, boot: Option<u32>) -> Result<Self, ConfigError> {
        machine.require(MachineKind::Gantry, "what is simulated on a line")?;
        let gantry = Gantry::new(machine, SafetyGate::new(LimitSwitches::RELEASED, false));
        let bench: Box<dyn Steps + Send> = match boot {
            Some(boot) => {
                let linked = LinkedGantry::<4, 64>::new(gantry, boot, LinkSettings::default());
                Box::new(bench(machine, linked))
            }
            None => Box::new(bench(machine, gantry)),
        };
        Ok(Self {
            bench,
            log: None,
            answers: Vec::new(),
            told: Telemetry::default(),
            telemetry: Arc::default(),
        })
    }

    /// The same, which writes all that it does into `log`.
    #[must_use]
    pub fn logged<W: Write>(self, log: MachineLog<W>) -> SimulatedMachine<W> {
        let Self { bench, answers, told, telemetry, .. } = self;
        SimulatedMachine { bench, log: Some(log), answers, told, telemetry }
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
    pub fn serve(mut self, line: &dyn Line, speed: f64) -> PortError {
        let mut pace = Pace::new(speed);
        let mut bytes = [0; 256];
        loop {
            let to = self.now().saturating_add(EXCHANGE_EVERY);
            let early = pace.wait(Instant::now(), to);
            match line.receive(&mut bytes, early.min(LISTEN)) {
                Ok(count) => self.take(bytes.get(..count).unwrap_or_default()),
                Err(error) => return error,
            }
            if pace.wait(Instant::now(), to).is_zero() {
                self.run_to(to);
            }
            if !self.answers.is_empty() {
                if let Err(error) = line.send(&self.answers) {
                    return error;
                }
                self.answers.clear();
            }
        }
    }

    pub(super) fn now(&self) -> Duration {
        self.bench.now()
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
        let Self { bench, log, answers, told, telemetry } = self;
        while bench.now() < to {
            bench.step(&mut |at, event| {
                match event {
                    // (a frame may hold this byte, too: then it is no stop)
                    BenchEvent::HostByte(byte) if byte == Order::Stop.byte() && told.duty != [0; 2] => {
                        told.stopped = Some((at, None));
                    }
                    BenchEvent::ControllerByte(byte) => answers.push(byte),
                    BenchEvent::Drive(Axis::X, duty) => told.duty[0] = duty,
                    BenchEvent::Drive(Axis::Y, duty) => told.duty[1] = duty,
                    _ => {}
                }
                if let Some(log) = log {
                    log.record(at, event);
                }
            });
            if let Some((_, off @ None)) = &mut told.stopped
                && told.duty == [0, 0]
            {
                *off = Some(bench.now());
            }
        }
        told.time = bench.now();
        *lock(telemetry) = *told;
        if let Some(log) = log {
            log.tick(told.time);
        }
    }
}

impl<W: Write> fmt::Debug for SimulatedMachine<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SimulatedMachine").field("told", &self.told).finish_non_exhaustive()
    }
}
