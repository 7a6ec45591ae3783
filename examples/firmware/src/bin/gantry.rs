//! The semi-virtual gantry's firmware: the published protocol on the serial line, two DC motors on an
//! H-bridge each.
//!
//! The controller is `plotter_motion::firmware::Gantry`, the same that the desktop simulates; the drivers are
//! those of `plotter-hal`. What is left for a firmware is this file: which pin is what, and what to do when
//! something happens.
#![no_std]
#![no_main]

use core::time::Duration;
use cortex_m::singleton;
use cortex_m_rt::entry;
use plotter_firmware::board::{self, Event, Notice};
use plotter_firmware::machine;
use plotter_hal::{DcAxes, EstopChange, EstopInput, HBridge, Quadrature, SwitchSettings};
use plotter_motion::protocol::SUBSTITUTE;
use plotter_motion::{Axis, LimitSwitches, SafetyGate};

/// How often the buttons are looked at, and the watchdog is fed.
const LOOK: Duration = Duration::from_millis(1);

#[entry]
fn main() -> ! {
    let Some(parts) = board::gantry::take() else { board::halt() };
    let mut motors = DcAxes::new(
        HBridge::new(Axis::X, parts.x.enable, parts.x.forward, parts.x.reverse),
        HBridge::new(Axis::Y, parts.y.enable, parts.y.forward, parts.y.reverse),
        // The bridge takes the duty away before it turns the direction, and has a dead time of its own.
        Duration::ZERO,
    );
    // Whatever happened before, nothing turns.
    let started = motors.start().is_ok();
    let mut button = EstopInput::new(parts.stop, SwitchSettings::default());

    // Pressed until it has shown that it is not. The machine has no limit switches.
    let gate = SafetyGate::new(LimitSwitches::RELEASED, button.is_pressed());
    let Some(gantry) = singleton!(GANTRY: machine::Gantry = machine::gantry(gate)) else { board::halt() };
    let was_bitten = parts.rest.was_bitten();
    let [(xa, xb), (ya, yb)] = [parts.x_phases, parts.y_phases];
    let [x_decoding, y_decoding] = machine::DECODING;
    let mut board =
        parts.rest.start(Quadrature::new(xa, xb, x_decoding), Quadrature::new(ya, yb, y_decoding));
    if was_bitten {
        board.notify(Notice::Bitten);
    }
    let mut failed = !started;
    let mut look = board.now();
    loop {
        let due = gantry.next_tick().map_or(look, |tick| tick.min(look));
        let (now, event) = board.wait(Some(due));
        match event {
            Event::Due => gantry.tick(now),
            Event::Byte(byte) => gantry.receive(now, byte),
            Event::LineFault => {
                board.notify(Notice::LineFault);
                gantry.receive(now, SUBSTITUTE);
            }
            Event::Edge(axis, direction) => gantry.edge(now, axis, direction),
            Event::EncoderFault => failed = true,
        }
        if now >= look {
            look = now + LOOK;
            board.feed_watchdog();
            let change = button.tick(now);
            gantry.emergency_stop(now, button.is_pressed());
            match change {
                // Where the motors stand after a reset by the watchdog is not known: a person looks first,
                // and switches the machine off and on.
                Ok(Some(EstopChange::FreeSinceStart)) if !was_bitten && !failed => {
                    gantry.reset_emergency_stop(now);
                }
                Ok(Some(EstopChange::Pressed)) => board.notify(Notice::Stopped),
                Ok(_) => {}
                Err(_) => failed = true,
            }
        }
        while board.can_send()
            && let Some(byte) = gantry.transmit()
        {
            board.send(byte);
        }
        while let Some(notice) = gantry.take_notice() {
            board.notify(Notice::Controller(notice));
        }
        if motors.drive(gantry.drive(), now).is_err() || failed {
            // A motor or an encoder that cannot be trusted: both motors stop, and stay so until the machine
            // is switched off and on.
            let _ = motors.stop();
            board.notify(Notice::PinFailed);
            board::halt();
        }
    }
}
