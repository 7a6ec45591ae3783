//! The controller of the semi-virtual gantry, to be re-run.

use super::Controller;
use crate::log::SwitchName;
use core::time::Duration;
use plotter_motion::config::DcConfig;
use plotter_motion::firmware::Gantry;
use plotter_motion::{Axis, Direction, LimitSwitches, Machine, SafetyGate};

/// [`Gantry`] as a machine's description makes it.
///
/// Switches are known by name: `x-min`, `x-max`, `y-min`, `y-max` are the limits, and pressing `reset` lets
/// the motors go on after an emergency stop. Other names do nothing.
#[derive(Debug, PartialEq)]
pub struct MachineController {
    gantry: Gantry,
    pwm_steps: [u16; 2],
}

impl MachineController {
    /// The controller of this machine, at rest at (0, 0).
    #[must_use]
    pub fn new(machine: &Machine) -> Self {
        Self { gantry: Gantry::new(machine, gate()), pwm_steps: pwm_steps(machine) }
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
        Controller::switch(&mut self.gantry, now, name, pressed);
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
        self.gantry.drive().axis(axis).steps(steps_of(self.pwm_steps, axis))
    }
}

/// The gate of a machine that is run again: nothing is pressed until the recording says so.
pub(super) const fn gate() -> SafetyGate {
    SafetyGate::new(LimitSwitches::RELEASED, false)
}

/// Steps of the PWM timers of both motors.
pub(super) fn pwm_steps(machine: &Machine) -> [u16; 2] {
    let dc = DcConfig::of(machine);
    let steps = [dc.x.motor.pwm_steps, dc.y.motor.pwm_steps];
    steps.map(|steps| u16::try_from(steps).unwrap_or(u16::MAX))
}

pub(super) const fn steps_of([x_steps, y_steps]: [u16; 2], axis: Axis) -> u16 {
    match axis {
        Axis::X => x_steps,
        Axis::Y => y_steps,
    }
}
