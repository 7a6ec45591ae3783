//! [`MarkingBoard`] as a controller that can be re-run.

use super::Controller;
use super::gantry::limit;
use crate::log::SwitchName;
use core::time::Duration;
use plotter_motion::control::LineController;
use plotter_motion::firmware::MarkingBoard;
use plotter_motion::{Axis, Direction, Pen, PenMove, StepPoint};

/// Steps of the PWM timer: 8 bits.
pub(super) const PWM_STEPS: u16 = 255;

/// The board has no serial line: its moves are the `@ pen` and `@ target` records. Its encoders only count
/// up, so that the direction of an `@ edge` record is for people.
impl<C: LineController> Controller for MarkingBoard<C> {
    fn receive(&mut self, _: Duration, _: u8) {}

    fn edge(&mut self, now: Duration, axis: Axis, _: Direction) {
        self.pulse(now, axis);
    }

    fn switch(&mut self, now: Duration, name: &SwitchName, pressed: bool) {
        if let Some((axis, end)) = limit(name) {
            let mut limits = self.gate().limits();
            limits.set(axis, end, pressed);
            self.limit_switches(now, limits);
        } else if name.as_str() == "reset" && pressed {
            self.reset_emergency_stop(now);
        }
    }

    fn emergency_stop(&mut self, now: Duration, pressed: bool) {
        Self::emergency_stop(self, now, pressed);
    }

    fn next_tick(&self) -> Option<Duration> {
        Some(Self::next_tick(self))
    }

    fn tick(&mut self, now: Duration) {
        Self::tick(self, now);
    }

    fn transmit(&mut self) -> Option<u8> {
        None
    }

    fn duty(&self, axis: Axis) -> i32 {
        self.drive().axis(axis).steps(PWM_STEPS)
    }

    fn target(&mut self, now: Duration, pen: Pen, target: StepPoint) {
        self.start(now, PenMove { pen, target });
    }
}
