//! A stepper plotter on the bench: the controller, two simulated motors, four limit switches and a clock.
#![allow(dead_code, reason = "each test takes what it needs")]

use core::time::Duration;
use plotter_motion::firmware::StepperPlotter;
use plotter_motion::firmware::stepper_plotter::{Activity, Drivers, StepperPlotterSettings};
use plotter_motion::plant::{StepperPlant, StepperSettings};
use plotter_motion::{Axis, Direction, LimitSwitches, Point, SafetyGate, StepPoint};

/// A step as it was made, and what pen and laser did then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Made {
    pub(crate) at: Duration,
    /// Where the controller believes to be after it.
    pub(crate) position: StepPoint,
    pub(crate) pen_deg: u8,
    pub(crate) laser: u16,
}

pub(crate) struct Bench {
    pub(crate) plotter: StepperPlotter,
    pub(crate) now: Duration,
    /// Simulated motors; none where only the steps matter.
    pub(crate) plant: Option<StepperPlant>,
    /// Where both carriages are, steps from the lower switches, if no step is lost.
    pub(crate) carriage: [i32; 2],
    /// Between the switches, steps.
    pub(crate) length: [i32; 2],
    /// The switches are wired.
    pub(crate) switches: bool,
    pub(crate) answers: Vec<u8>,
    pub(crate) made: Vec<Made>,
}

impl Bench {
    pub(crate) fn new(settings: StepperPlotterSettings) -> Self {
        Self {
            plotter: StepperPlotter::new(settings, SafetyGate::new(LimitSwitches::RELEASED, false)).unwrap(),
            now: Duration::ZERO,
            plant: None,
            carriage: [500, 500],
            length: [34_000, 28_000],
            switches: true,
            answers: Vec::new(),
            made: Vec::new(),
        }
    }

    pub(crate) fn with_plant(mut self) -> Self {
        self.plant = Some(StepperPlant::new(StepperSettings::default(), StepperSettings::default()));
        self
    }

    /// Sends text without letting time pass.
    pub(crate) fn send(&mut self, text: &str) {
        self.send_bytes(text.as_bytes());
    }

    /// Likewise bytes that are no text.
    pub(crate) fn send_bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.plotter.receive(self.now, byte);
            self.settle();
        }
    }

    pub(crate) fn stop_button(&mut self, pressed: bool) {
        self.plotter.emergency_stop(self.now, pressed);
        self.settle();
    }

    /// What is due now.
    fn settle(&mut self) {
        while let Some(step) = self.plotter.poll(self.now, Drivers::Ready) {
            let at = step.at;
            let moves = [(Axis::X, step.pulse.x()), (Axis::Y, step.pulse.y())];
            for ((axis, sign), carriage) in moves.into_iter().zip(&mut self.carriage) {
                *carriage += i32::from(sign);
                let direction = if sign > 0 { Direction::Plus } else { Direction::Minus };
                if let Some(plant) = self.plant.as_mut().filter(|_| sign != 0) {
                    plant.pulse(step.at, axis, direction);
                }
            }
            self.switch();
            let (pen_deg, laser) = (self.plotter.pen_deg(), self.plotter.beam().power());
            self.made.push(Made { at, position: self.plotter.position(), pen_deg, laser });
        }
        while let Some(byte) = self.plotter.transmit(self.now) {
            self.answers.push(byte);
        }
    }

    /// Tells the controller of its switches.
    pub(crate) fn switch(&mut self) {
        if !self.switches {
            return;
        }
        for ((axis, carriage), length) in Axis::BOTH.into_iter().zip(self.carriage).zip(self.length) {
            self.plotter.limit_switch(self.now, axis, Direction::Minus, carriage <= 0);
            self.plotter.limit_switch(self.now, axis, Direction::Plus, carriage >= length);
        }
    }

    /// Lets time pass until `end`.
    pub(crate) fn run_to(&mut self, end: Duration) {
        self.switch();
        self.settle();
        while let Some(due) = self.plotter.due().filter(|&due| due <= end) {
            self.now = self.now.max(due);
            self.settle();
        }
        self.now = self.now.max(end);
        self.settle();
    }

    pub(crate) fn run_for(&mut self, time: Duration) {
        self.run_to(self.now + time);
    }

    /// Lets time pass until nothing more is due.
    pub(crate) fn run_out(&mut self) {
        self.switch();
        self.settle();
        while let Some(due) = self.plotter.due() {
            self.now = self.now.max(due);
            self.settle();
        }
    }

    /// The simulated motors, come to rest.
    pub(crate) fn rested(&self) -> Option<StepperPlant> {
        let mut plant = self.plant?;
        plant.x.settle();
        plant.y.settle();
        Some(plant)
    }

    pub(crate) fn is_idle(&self) -> bool {
        self.plotter.status(self.now).activity == Activity::Idle
    }

    /// The answers since the last time.
    pub(crate) fn take_answers(&mut self) -> String {
        String::from_utf8(core::mem::take(&mut self.answers)).unwrap()
    }

    /// Sends text and waits until nothing more happens; gives the answers.
    pub(crate) fn ask(&mut self, text: &str) -> String {
        self.switch();
        self.send(text);
        self.run_out();
        self.take_answers()
    }

    /// Steps that the simulated motors have lost.
    pub(crate) fn lost(&self) -> [i64; 2] {
        self.rested().map_or([0; 2], |plant| [plant.x.lost_steps(), plant.y.lost_steps()])
    }
}

/// Distance of a point from a polyline, mm.
pub(crate) fn distance_mm(at: Point, path: &[Point]) -> f64 {
    let to_segment = |from: Point, to: Point| {
        let (way, out) = (to - from, at - from);
        let share = (out.dot(way) / way.dot(way).max(1e-12)).clamp(0.0, 1.0);
        (out - way * share).length()
    };
    path.windows(2).map(|ends| to_segment(ends[0], ends[1])).fold(f64::INFINITY, f64::min)
}
