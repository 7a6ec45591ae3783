//! [`StepperPlotter`] as a controller that can be re-run.

use super::Controller;
use super::gantry::limit;
use crate::log::SwitchName;
use core::time::Duration;

use plotter_motion::firmware::StepperPlotter;
use plotter_motion::firmware::stepper_plotter::Drivers;
use plotter_motion::{Pen, StepPair};

/// Its steps are the log's `@ edge` records, the pen its `@ pen` records; both are compared. Pressing `reset`
/// lets it go on after an emergency stop, `restart` is the host that opens the port.
impl Controller for StepperPlotter {
    fn receive(&mut self, now: Duration, byte: u8) {
        Self::receive(self, now, byte);
    }

    fn switch(&mut self, now: Duration, name: &SwitchName, pressed: bool) {
        if let Some((axis, end)) = limit(name) {
            self.limit_switch(now, axis, end, pressed);
        } else if pressed && name.as_str() == "reset" {
            self.reset_emergency_stop(now);
        } else if pressed && name.as_str() == "restart" {
            self.restart(now);
        }
    }

    fn emergency_stop(&mut self, now: Duration, pressed: bool) {
        Self::emergency_stop(self, now, pressed);
    }

    fn next_tick(&self) -> Option<Duration> {
        self.due() // and is done when the steps are fetched: there is nothing to tick
    }

    fn transmit(&mut self) -> Option<u8> {
        None // asked with the time only
    }

    fn transmit_at(&mut self, now: Duration) -> Option<u8> {
        Self::transmit(self, now)
    }

    fn makes_steps(&self) -> bool {
        true
    }

    fn step(&mut self, now: Duration) -> Option<StepPair> {
        self.poll(now, Drivers::Ready).map(|step| step.pulse.into())
    }

    fn pen(&self) -> Option<Pen> {
        // Halfway between up and down.
        let stored = self.stored();
        let (up, down) = (stored.pen_up_deg, stored.pen_down_deg);
        let nearer_down = self.pen_deg().abs_diff(down) < self.pen_deg().abs_diff(up);
        Some(if nearer_down { Pen::Down } else { Pen::Up })
    }
}
