//! Bresenham's line on 8 bits: targets by the published protocol, step pulses on pins, through the safety
//! gate.
#![no_std]
#![no_main]

use avr_firmware::board::Board;
use core::time::Duration;
use plotter_motion::protocol::digits::{Receiver, Reply};
use plotter_motion::{Bresenham, LimitSwitches, SafetyGate, StepPoint};

/// Time between two steps.
const STEP: Duration = Duration::from_micros(500);

/// Called by the start-up code of avr-libc.
// SAFETY: there is no other `main`.
#[unsafe(no_mangle)]
extern "C" fn main() -> ! {
    let mut board = Board::new();
    let mut receiver = Receiver::new(Duration::from_millis(100));
    // It has neither limit switches nor a stop button.
    let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    let mut line = Bresenham::new(StepPoint::default(), StepPoint::default());
    let mut drawing = false;
    let mut due = Duration::ZERO;
    loop {
        let now = board.now();
        if let Some(byte) = board.receive()
            && let Some(target) = receiver.push(now, byte).target
        {
            line = Bresenham::new(line.position(), target);
            (drawing, due) = (true, now);
        }
        if !drawing || now < due {
            continue;
        }
        match line.next() {
            Some(step) => {
                if let Ok(pulse) = gate.pass_step(step) {
                    board.step(pulse);
                }
                due = due.saturating_add(STEP);
            }
            None if board.can_transmit() => {
                board.transmit(Reply::Reached.byte());
                drawing = false;
            }
            None => {}
        }
    }
}
