//! The semi-virtual gantry's firmware: the published protocol on the serial line, two DC motors on an H-bridge each.
//!
//! The controller is `plotter_motion::firmware::Gantry`, the same that the desktop simulates; the drivers are those of
//! `plotter-hal`. What is left for a firmware is this file: which pin is what, and what to do when something happens.
#![no_std]
#![no_main]

use core::time::Duration;
use cortex_m_rt::entry;
use plotter_firmware::board::{self, Event, Notice};
use plotter_firmware::machine;
use plotter_hal::{HBridge, Quadrature};
use plotter_motion::Axis;
use plotter_motion::firmware::Gantry;

/// How often the buttons are looked at.
const LOOK: Duration = Duration::from_millis(1);

#[entry]
fn main() -> ! {
    let Some(parts) = board::gantry::take() else { unreachable!() };
    let mut x = HBridge::new(Axis::X, parts.x.enable, parts.x.forward, parts.x.reverse);
    let mut y = HBridge::new(Axis::Y, parts.y.enable, parts.y.forward, parts.y.reverse);
    // Whatever happened before: nothing turns.
    let _ = (x.coast(), y.coast());

    let mut gantry = Gantry::new(&machine::machine());
    let was_bitten = parts.rest.was_bitten();
    let [(xa, xb), (ya, yb)] = [parts.x_phases, parts.y_phases];
    let mut board = parts.rest.start(
        Quadrature::new(xa, xb, machine::X.encoder.decoding),
        Quadrature::new(ya, yb, machine::Y.encoder.decoding),
    );
    if was_bitten {
        // Where the motors stand is not known: a target would lead them anywhere. A person looks first.
        gantry.emergency_stop(board.now(), true);
        board.notify(Notice::Bitten);
    }
    let mut look = board.now();
    loop {
        let due = gantry.next_tick().map_or(look, |tick| tick.min(look));
        let (now, event) = board.wait(Some(due));
        match event {
            Event::Due => gantry.tick(now),
            Event::Byte(byte) => gantry.receive(now, byte),
            Event::LineFault => board.notify(Notice::LineFault),
            Event::Edge(axis, direction) => gantry.edge(now, axis, direction),
        }
        while board.can_send()
            && let Some(byte) = gantry.transmit()
        {
            board.send(byte);
        }
        while let Some(notice) = gantry.take_notice() {
            board.notify(Notice::Controller(notice));
        }
        let drive = gantry.drive();
        let _ = (x.drive(drive), y.drive(drive));
        if now >= look {
            look = now + LOOK;
            board.feed_watchdog();
        }
    }
}
