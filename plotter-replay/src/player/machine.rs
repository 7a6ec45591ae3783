//! The controller of the semi-virtual gantry, to be re-run.

use super::Controller;
use crate::log::SwitchName;
use core::time::Duration;
use plotter_motion::firmware::Gantry;
use plotter_motion::{Axis, Direction, Machine};

/// [`Gantry`] as a machine's description makes it.
///
/// Switches are known by name: `x-min`, `x-max`, `y-min`, `y-max` are the limits, and pressing `reset` lets the
/// motors go on after an emergency stop. Other names do nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineController {
    gantry: Gantry,
    pwm_steps: [u16; 2],
}

impl MachineController {
    /// The controller of this machine, at rest at (0, 0).
    #[must_use]
    pub fn new(machine: &Machine) -> Self {
        let config = machine.config();
        let steps = [config.x.motor.pwm_steps, config.y.motor.pwm_steps];
        Self {
            gantry: Gantry::new(machine),
            pwm_steps: steps.map(|steps| u16::try_from(steps).unwrap_or(u16::MAX)),
        }
    }

    /// The controller itself.
    #[must_use]
    pub fn gantry(&self) -> &Gantry {
        &self.gantry
    }
}

impl Controller for MachineController {
    fn receive(&mut self, now: Duration, byte: u8) {
        self.gantry.receive(now, byte);
    }

    fn edge(&mut self, now: Duration, axis: Axis, sign: Direction) {
        self.gantry.edge(now, axis, sign);
    }

    fn switch(&mut self, now: Duration, name: &SwitchName, pressed: bool) {
        let (axis, end) = match name.as_str() {
            "x-min" => (Axis::X, Direction::Minus),
            "x-max" => (Axis::X, Direction::Plus),
            "y-min" => (Axis::Y, Direction::Minus),
            "y-max" => (Axis::Y, Direction::Plus),
            "reset" => {
                if pressed {
                    self.gantry.reset_emergency_stop(now);
                }
                return;
            }
            _ => return,
        };
        self.gantry.limit_switch(now, axis, end, pressed);
    }

    fn emergency_stop(&mut self, now: Duration, pressed: bool) {
        self.gantry.emergency_stop(now, pressed);
    }

    fn next_tick(&self) -> Option<Duration> {
        self.gantry.next_tick()
    }

    fn tick(&mut self, now: Duration) {
        self.gantry.tick(now);
    }

    fn transmit(&mut self) -> Option<u8> {
        self.gantry.transmit()
    }

    fn duty(&self, axis: Axis) -> i32 {
        let [x_steps, y_steps] = self.pwm_steps;
        let steps = match axis {
            Axis::X => x_steps,
            Axis::Y => y_steps,
        };
        self.gantry.drive().axis(axis).steps(steps)
    }
}
