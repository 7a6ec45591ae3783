//! [`Gantry`] as a controller that can be re-run.

use super::Controller;
use crate::log::SwitchName;
use core::time::Duration;
use plotter_motion::control::LineController;
use plotter_motion::firmware::Gantry;
use plotter_motion::{Axis, Direction};

/// Steps of the PWM timer of the published controller, and of most others: 8 bits.
pub(super) const PWM_STEPS: u16 = 255;

/// As [`MachineController`](super::MachineController), with motors of 255 steps of PWM.
impl<C: LineController> Controller for Gantry<C> {
    fn receive(&mut self, now: Duration, byte: u8) {
        Self::receive(self, now, byte);
    }

    fn edge(&mut self, now: Duration, axis: Axis, sign: Direction) {
        Self::edge(self, now, axis, sign);
    }

    fn switch(&mut self, now: Duration, name: &SwitchName, pressed: bool) {
        if let Some((axis, end)) = limit(name) {
            self.limit_switch(now, axis, end, pressed);
        } else if name.as_str() == "reset" && pressed {
            self.reset_emergency_stop(now);
        }
    }

    fn emergency_stop(&mut self, now: Duration, pressed: bool) {
        Self::emergency_stop(self, now, pressed);
    }

    fn next_tick(&self) -> Option<Duration> {
        Self::next_tick(self)
    }

    fn tick(&mut self, now: Duration) {
        Self::tick(self, now);
    }

    fn transmit(&mut self) -> Option<u8> {
        Self::transmit(self)
    }

    fn duty(&self, axis: Axis) -> i32 {
        self.drive().axis(axis).steps(PWM_STEPS)
    }
}

/// The limit switch of a name: `x-min`, `x-max`, `y-min`, `y-max`.
pub(crate) fn limit(name: &SwitchName) -> Option<(Axis, Direction)> {
    Some(match name.as_str() {
        "x-min" => (Axis::X, Direction::Minus),
        "x-max" => (Axis::X, Direction::Plus),
        "y-min" => (Axis::Y, Direction::Minus),
        "y-max" => (Axis::Y, Direction::Plus),
        _ => return None,
    })
}
