//! [`Inner`]: the stepper plotter behind a front.

use crate::log::SwitchName;
use crate::player::machine::gate;
use crate::player::{Controller, ControllerError};
use core::time::Duration;
use plotter_motion::firmware::StepperPlotter;
use plotter_motion::firmware::stepper_plotter::StepperPlotterSettings;
use plotter_motion::gcode::PenConvention;
use plotter_motion::{Point, StepPair};

/// Longest line of the plotter that is kept, bytes: its status reports are the longest, and none is asked
/// for.
const MOST_ANSWER: usize = 128;
/// Stops at once; the place stays known.
const RESET: u8 = 0x18;

/// What the plotter has said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    /// The line lies in its queue, or has been refused: the next one may come.
    Free,
    /// It stands, and takes no movement until it is unlocked; the number is Grbl's.
    Alarm(u8),
}

/// A stepper plotter that is told lines of Grbl's, each after the answer to the one before.
#[derive(Debug)]
pub(super) struct Inner {
    plotter: StepperPlotter,
    /// The line that it is saying.
    answer: Vec<u8>,
    /// It has not answered yet. One that has been switched on or reset says its greeting first.
    waits: bool,
    /// It was told something since it was asked for a step: it has to be asked now.
    told: Option<Duration>,
}

impl Inner {
    /// A plotter that has been switched on, locked. Its pen is moved by `M3` and `M5`.
    pub(super) fn new(settings: StepperPlotterSettings) -> Result<Self, ControllerError> {
        if settings.laser {
            let message = String::from("a machine with a laser is simulated with Grbl's or mDraw's lines");
            return Err(ControllerError { message });
        }
        let settings = StepperPlotterSettings { homing: true, pen: PenConvention::Spindle, ..settings };
        let plotter = StepperPlotter::new(settings, gate())
            .map_err(|error| ControllerError { message: error.to_string() })?;
        Ok(Self { plotter, answer: Vec::new(), waits: true, told: None })
    }

    #[cfg(feature = "live")]
    pub(super) fn plotter(&self) -> &StepperPlotter {
        &self.plotter
    }

    pub(super) fn position_mm(&self) -> Point {
        self.plotter.position_mm()
    }

    /// Whether it takes a line.
    pub(super) fn is_free(&self) -> bool {
        !self.waits
    }

    /// Tells it a line; it [must be free](Self::is_free).
    pub(super) fn send(&mut self, now: Duration, line: &str) {
        (self.waits, self.told) = (true, Some(now));
        for byte in line.bytes().chain([b'\n']) {
            self.plotter.receive(now, byte);
        }
    }

    /// Stops it at once. It is locked then, if it moved, and forgets what was queued.
    pub(super) fn reset(&mut self, now: Duration) {
        (self.waits, self.told) = (true, Some(now));
        self.answer.clear();
        self.plotter.receive(now, RESET);
    }

    /// It is switched on again, locked; where it stands stays known.
    pub(super) fn restart(&mut self, now: Duration) {
        (self.waits, self.told) = (true, Some(now));
        self.answer.clear();
        self.plotter.restart(now);
    }

    /// The next thing that it says.
    pub(super) fn answer(&mut self, now: Duration) -> Option<Answer> {
        while let Some(byte) = self.plotter.transmit(now) {
            if byte != b'\n' && byte != b'\r' {
                if self.answer.len() < MOST_ANSWER {
                    self.answer.push(byte);
                }
                continue;
            }
            let line = core::mem::take(&mut self.answer);
            if line == b"ok" || line.starts_with(b"error:") || line.starts_with(b"Grbl ") {
                self.waits = false;
                return Some(Answer::Free);
            }
            if let Some(number) = line.strip_prefix(b"ALARM:") {
                let number = core::str::from_utf8(number).ok().and_then(|text| text.parse().ok());
                return Some(Answer::Alarm(number.unwrap_or(0)));
            }
        }
        None
    }

    pub(super) fn switch(&mut self, now: Duration, name: &SwitchName, pressed: bool) {
        Controller::switch(&mut self.plotter, now, name, pressed);
    }

    pub(super) fn emergency_stop(&mut self, now: Duration, pressed: bool) {
        self.plotter.emergency_stop(now, pressed);
    }

    pub(super) fn due(&self) -> Option<Duration> {
        [self.told, self.plotter.due()].into_iter().flatten().min()
    }

    pub(super) fn step(&mut self, now: Duration) -> Option<StepPair> {
        self.told = None;
        Controller::step(&mut self.plotter, now)
    }

    pub(super) fn pen(&self) -> Option<plotter_motion::Pen> {
        Controller::pen(&self.plotter)
    }
}
