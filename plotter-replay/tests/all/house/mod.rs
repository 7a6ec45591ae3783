//! The drawing of the recorded sessions, and its machine.

#![allow(dead_code, clippy::unwrap_used, reason = "each test uses its part of this, and may panic")]

use plotter_motion::{Machine, MachineConfig, Pen, PenMove, StepPoint, config::ControllerChoice};

/// A house, 10 mm wide; in encoder counts of 1/40 mm. The pen ends at the origin.
pub(crate) fn house() -> Vec<PenMove> {
    let (up, down) = (Pen::Up, Pen::Down);
    let corners = [
        (up, 100, 100),
        (down, 500, 100),
        (down, 500, 400),
        (down, 300, 560),
        (down, 100, 400),
        (down, 100, 100),
        (up, 0, 0),
    ];
    corners.map(|(pen, x, y)| PenMove { pen, target: StepPoint::new(x, y) }).to_vec()
}

/// The gantry with one of its controllers.
pub(crate) fn machine(controller: ControllerChoice) -> Machine {
    let mut config = MachineConfig::default();
    config.dc_mut().unwrap().control.controller = controller;
    // The published pause of 10 ms after each byte makes a test long, and changes nothing else.
    config.serial.byte_gap_ms = 1.0;
    Machine::new(config).unwrap()
}
