//! Stepper plotters that speak Marlin's lines or HPGL to their host.

use super::{Simulation, Steppers, Told};
use crate::player::{ControllerError, Hpgl, Marlin};
use core::time::Duration;
use plotter_motion::Machine;

/// The machine with this description, at its origin, with a controller that answers as Marlin.
pub(crate) fn marlin(machine: &Machine) -> Result<Simulation<Marlin, Steppers>, ControllerError> {
    let marlin = Marlin::new(machine)?;
    Ok(Simulation::new(marlin, Steppers::of(machine), machine.config().serial.baud))
}

/// The same that answers as a 7475A.
pub(crate) fn hpgl(machine: &Machine) -> Result<Simulation<Hpgl, Steppers>, ControllerError> {
    let hpgl = Hpgl::new(machine)?;
    Ok(Simulation::new(hpgl, Steppers::of(machine), machine.config().serial.baud))
}

impl Told for Marlin {
    fn told(&self, now: Duration) -> (&'static str, Option<f64>) {
        let (doing, _) = self.plotter().told(now);
        (if self.is_killed() { "halted until it is reset" } else { doing }, None)
    }
}

impl Told for Hpgl {
    fn told(&self, now: Duration) -> (&'static str, Option<f64>) {
        self.plotter().told(now)
    }

    fn lets_bytes_through(&self) -> bool {
        Self::lets_bytes_through(self)
    }
}
