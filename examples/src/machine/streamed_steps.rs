//! A G-code drawing, streamed to the stepper plotter's controller: on the desk, and in its firmware in the
//! emulator.

use crate::machine::{BenchSwitches, Emulator, Told};
use core::time::Duration;
use crc::{CRC_64_XZ, Crc};
use plotter_motion::firmware::StepperPlotter;
use plotter_motion::firmware::stepper_plotter::{Dialect, Drivers, Receive, StepperPlotterSettings};
use plotter_motion::plant::SimulatedLine;
use plotter_motion::{
    Axis, LimitSwitches, Machine, SafetyGate, StepPoint,
    planner::{AllModes, ExactOnly, Modes},
};
use plotter_replay::serial::Port;
use std::collections::VecDeque;
use std::path::Path;

static STEPS_CRC: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);

/// Grbl's receive buffer, bytes: what a program may send ahead.
const RX_BUFFER: usize = 128;

/// The steps that a drawing became.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StreamedSteps {
    /// How many: one of either motor or of both.
    pub steps: u64,
    /// CRC-64/XZ over each step's time in microseconds (8 bytes, the lowest first) and the steps of x and y
    /// (a byte each).
    pub crc: u64,
    /// Where the motors stand in the end.
    pub position: StepPoint,
    /// Lines that were not answered by `ok`.
    pub refused: Vec<String>,
    /// When the controller said its first word: its time begins about then.
    pub first_byte: Duration,
    /// What the machine noticed.
    pub notes: Vec<String>,
}

/// A program that streams to Grbl: it sends as many lines as its receive buffer holds, and counts the
/// answers.
#[derive(Debug)]
struct Streamer {
    lines: VecDeque<Vec<u8>>,
    unanswered: VecDeque<usize>,
    answer: String,
    welcomed: bool,
    refused: Vec<String>,
}

impl Streamer {
    fn new(gcode: &str) -> Self {
        let lines = gcode.lines().filter(|line| !line.trim().is_empty());
        Self {
            lines: lines.map(|line| format!("{}\n", line.trim()).into_bytes()).collect(),
            unanswered: VecDeque::new(),
            answer: String::new(),
            welcomed: false,
            refused: Vec::new(),
        }
    }

    /// Takes a byte of the controller.
    fn receive(&mut self, byte: u8) {
        if byte != b'\n' {
            self.answer.push(char::from(byte));
            return;
        }
        let answer = std::mem::take(&mut self.answer);
        let answer = answer.trim();
        if answer.starts_with("Grbl") {
            self.welcomed = true;
        } else if answer == "ok" || answer.starts_with("error") {
            self.unanswered.pop_front();
            if answer != "ok" {
                self.refused.push(answer.to_owned());
            }
        } else if answer.starts_with("ALARM") {
            self.refused.push(answer.to_owned());
        }
    }

    /// What it sends now.
    fn send(&mut self) -> Vec<u8> {
        let mut bytes = Vec::new();
        while self.welcomed
            && let Some(line) = self.lines.front()
            && self.unanswered.iter().sum::<usize>() + line.len() <= RX_BUFFER
        {
            self.unanswered.push_back(line.len());
            bytes.extend(self.lines.pop_front().unwrap_or_default());
        }
        bytes
    }

    fn is_done(&self) -> bool {
        self.welcomed && self.lines.is_empty() && self.unanswered.is_empty()
    }
}

/// Streams `gcode` to the controller on the desk, built as its firmware is; `start` is when it is switched
/// on.
///
/// # Errors
///
/// A machine that no motion can be planned for.
pub fn streamed_on_the_desk(
    machine: &Machine,
    start: Duration,
    gcode: &str,
) -> Result<StreamedSteps, String> {
    let settings = StepperPlotterSettings::of(machine, Dialect::Grbl);
    if settings.is_plain() {
        streamed::<ExactOnly>(machine, settings, start, gcode)
    } else {
        streamed::<AllModes>(machine, settings, start, gcode)
    }
}

fn streamed<M: Modes>(
    machine: &Machine,
    settings: StepperPlotterSettings,
    start: Duration,
    gcode: &str,
) -> Result<StreamedSteps, String> {
    #[derive(PartialEq, Eq, PartialOrd, Ord)]
    enum Next {
        Due,
        ToController,
        ToHost,
    }
    let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    let mut plotter =
        StepperPlotter::<Receive, M>::with_modes(settings, gate).map_err(|error| error.to_string())?;
    let mut host = Streamer::new(gcode);
    let baud = machine.config().serial.baud;
    let (mut to_controller, mut to_host) = (SimulatedLine::new(baud), SimulatedLine::new(baud));
    let (mut now, mut asked, mut due) = (start, true, None);
    let mut digest = STEPS_CRC.digest();
    let mut made = StreamedSteps::default();
    loop {
        if asked {
            while let Some(step) = plotter.poll(now, Drivers::Ready) {
                made.steps += 1;
                let at_us = u64::try_from(step.at.as_micros()).unwrap_or(u64::MAX);
                digest.update(&at_us.to_le_bytes());
                digest.update(&[step.pulse.x().cast_unsigned(), step.pulse.y().cast_unsigned()]);
            }
            while let Some(byte) = plotter.transmit(now) {
                to_host.send(now, byte);
            }
            due = plotter.due();
        }
        let next =
            [(due, Next::Due), (to_controller.next(), Next::ToController), (to_host.next(), Next::ToHost)];
        let Some((at, next)) = next.into_iter().filter_map(|(at, next)| Some((at?.max(now), next))).min()
        else {
            break;
        };
        now = at;
        asked = next != Next::ToHost;
        match next {
            Next::Due => {}
            Next::ToController => {
                if let Some(byte) = to_controller.take() {
                    plotter.receive(now, byte);
                }
            }
            Next::ToHost => {
                if let Some(byte) = to_host.take() {
                    if made.first_byte.is_zero() {
                        made.first_byte = now;
                    }
                    host.receive(byte);
                    for byte in host.send() {
                        to_controller.send(now, byte);
                    }
                }
            }
        }
    }
    made.crc = digest.finalize();
    made.position = plotter.position();
    made.refused = host.refused;
    Ok(made)
}

/// Streams `gcode` to the firmware in `elf`.
///
/// # Errors
///
/// The emulator or the port fails.
pub fn streamed_in_emulator(
    machine: &Machine,
    elf: &Path,
    switches: BenchSwitches,
    gcode: &str,
) -> Result<StreamedSteps, String> {
    /// How often the host looks at a machine that says nothing, and how long it stands when it has drawn all.
    const LOOK: Duration = Duration::from_secs(1);
    let mut emulator = Emulator::start(elf, switches)?;
    let mut port = Port::open(emulator.port(), machine.config().serial.baud).map_err(|e| e.to_string())?;
    let mut host = Streamer::new(gcode);
    let mut made = StreamedSteps::default();
    let (mut before, mut looked, mut idle) = (0, Duration::ZERO, false);
    loop {
        let (now, told) = emulator.next_told()?;
        match told {
            Told::Ask => {
                let bytes = host.send();
                port.send(&bytes).map_err(|error| error.to_string())?;
                if now >= looked + LOOK {
                    let stands = std::mem::replace(&mut before, made.steps) == made.steps;
                    if stands && idle && (host.is_done() || !host.refused.is_empty() || !host.welcomed) {
                        return Ok(StreamedSteps { refused: host.refused, ..made });
                    }
                    idle = stands;
                    looked = now;
                }
                emulator.go_on(bytes.len(), Some(looked + LOOK - now))?;
            }
            Told::ControllerByte(byte) => {
                let mut came = [0];
                if port.receive(&mut came, Duration::from_secs(5)).map_err(|e| e.to_string())? == 0
                    || came != [byte]
                {
                    return Err(format!("the machine sent {byte:#04x}, and {came:?} came over the line"));
                }
                if made.first_byte.is_zero() {
                    made.first_byte = now;
                }
                host.receive(byte);
            }
            Told::Steps { count, crc } => (made.steps, made.crc) = (count, crc),
            Told::Position(Axis::X, steps) => made.position.x = steps,
            Told::Position(Axis::Y, steps) => made.position.y = steps,
            Told::Note(note) => made.notes.push(note),
            _ => {}
        }
    }
}
