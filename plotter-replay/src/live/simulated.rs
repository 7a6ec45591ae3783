//! [`SimulatedMachine`]: a machine at the other end of a line, in the time of the clock on the wall.

use super::line::{Line, lock};
use super::machine_log::MachineLog;
use crate::serial::PortError;
use core::time::Duration;
use plotter_motion::firmware::{Gantry, LinkedGantry};
use plotter_motion::plant::{Bench, BenchController, BenchEvent, BenchSettings};
use plotter_motion::protocol::{LinkSettings, Order};
use plotter_motion::{Axis, Machine, PenMove};
use std::io::{Sink, Write};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
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

/// A simulated machine that answers on a line until that is closed.
///
/// Its time runs with the clock. On a computer too slow for that it falls behind, and stays so.
#[derive(Debug)]
pub struct SimulatedMachine {
    telemetry: Arc<Mutex<Telemetry>>,
    thread: Option<JoinHandle<PortError>>,
}

/// How long it listens at most before it goes on in its time.
const LISTEN: Duration = Duration::from_micros(200);
/// Time that it makes up at most at once.
const MOST_BEHIND: Duration = Duration::from_millis(50);

impl SimulatedMachine {
    /// Starts `machine` at the end `line` of a line; `speed` seconds of it pass in one of ours. It speaks digits, and frames with
    /// a host that calls; `boot` is its number since it was switched on, another one each time.
    #[must_use]
    pub fn start(machine: &Machine, line: Arc<dyn Line>, speed: f64, boot: u32) -> Self {
        Self::logged(machine, line, speed, Some(boot), None::<MachineLog<Sink>>)
    }

    /// The same with a controller that speaks digits only.
    #[must_use]
    pub fn of_digits(machine: &Machine, line: Arc<dyn Line>, speed: f64) -> Self {
        Self::logged(machine, line, speed, None, None::<MachineLog<Sink>>)
    }

    /// Either of them (without `boot`: digits only), which writes all that it does into `log`.
    #[must_use]
    pub fn logged<W: Write + Send + 'static>(
        machine: &Machine,
        line: Arc<dyn Line>,
        speed: f64,
        boot: Option<u32>,
        log: Option<MachineLog<W>>,
    ) -> Self {
        let gantry = Gantry::new(machine);
        match boot {
            Some(boot) => {
                let linked = LinkedGantry::<4, 64>::new(gantry, boot, LinkSettings::default());
                Self::with_controller(machine, linked, line, speed, log)
            }
            None => Self::with_controller(machine, gantry, line, speed, log),
        }
    }

    fn with_controller<C: BenchController + Send + 'static, W: Write + Send + 'static>(
        machine: &Machine,
        controller: C,
        line: Arc<dyn Line>,
        speed: f64,
        log: Option<MachineLog<W>>,
    ) -> Self {
        let moves = std::iter::empty::<PenMove>();
        let bench = Bench::with_controller(machine, BenchSettings::default(), controller, moves);
        let telemetry = Arc::<Mutex<Telemetry>>::default();
        let shared = Arc::clone(&telemetry);
        let thread = thread::spawn(move || run(bench, &*line, speed, &shared, log.as_ref()));
        Self { telemetry, thread: Some(thread) }
    }

    /// What no byte on the line tells.
    #[must_use]
    pub fn telemetry(&self) -> Arc<Mutex<Telemetry>> {
        Arc::clone(&self.telemetry)
    }

    /// Waits until the line is closed; says how that was.
    #[must_use]
    pub fn wait(mut self) -> Option<PortError> {
        self.thread.take()?.join().ok()
    }
}

fn run<C: BenchController, W: Write>(
    mut bench: Bench<std::iter::Empty<PenMove>, C>,
    line: &dyn Line,
    speed: f64,
    telemetry: &Mutex<Telemetry>,
    log: Option<&MachineLog<W>>,
) -> PortError {
    let mut before = Instant::now();
    let mut due = Duration::ZERO;
    let (mut bytes, mut answers) = ([0; 256], Vec::new());
    let mut told = Telemetry::default();
    loop {
        let count = match line.receive(&mut bytes, LISTEN) {
            Ok(count) => count,
            Err(error) => return error,
        };
        for &byte in bytes.get(..count).unwrap_or_default() {
            bench.disturb(byte);
        }
        let now = Instant::now();
        due = due.saturating_add(now.saturating_duration_since(before).mul_f64(speed));
        before = now;
        due = due.min(bench.now().saturating_add(MOST_BEHIND.mul_f64(speed)));
        while bench.now() < due {
            bench.step(|at, event| {
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
        *lock(telemetry) = told;
        if let Some(log) = log {
            log.tick(told.time);
        }
        if !answers.is_empty() {
            if let Err(error) = line.send(&answers) {
                return error;
            }
            answers.clear();
        }
    }
}
