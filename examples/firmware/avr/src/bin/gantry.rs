//! The gantry's controller on 8 bits: published line tracking, published protocol, x4 decoding of the
//! encoders.
#![no_std]
#![no_main]

use avr_firmware::board::Board;
use plotter_motion::control::{LineTracking, LineTrackingSettings};
use plotter_motion::firmware::{Gantry, GantrySettings};
use plotter_motion::{Axis, LimitSwitches, SafetyGate, StepPoint, config::PublishedConfig, control::SyncStop, encoder::QuadratureX4};

/// The documented gantry.
const GANTRY: GantrySettings =
    GantrySettings { resync_gap_us: 100_000, most: StepPoint::new(23_760, 16_800) };
const TRACKING: LineTrackingSettings = LineTrackingSettings {
    published: PublishedConfig {
        kp: 15.0,
        ki: 0.00001,
        kd_x: 0.0,
        kd_y: 10.0,
        duty_limit_x: 20.0,
        duty_limit_y: 255.0,
        duty_limit_y_vertical: 15.0,
    },
    sync_stop: SyncStop { slope_counts: 10.0, offset_counts: 10.0 },
};

/// Called by the start-up code of avr-libc.
// SAFETY: there is no other `main`.
#[unsafe(no_mangle)]
extern "C" fn main() -> ! {
    let mut board = Board::new();
    // It has neither limit switches nor a stop button.
    let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    let mut gantry = Gantry::with_settings(GANTRY, LineTracking::with_settings(TRACKING), gate);
    let mut encoders = [Axis::X, Axis::Y].map(|axis| (axis, QuadratureX4::new(board.phases(axis))));
    loop {
        let now = board.now();
        for (axis, encoder) in &mut encoders {
            if let Some(direction) = encoder.update(board.phases(*axis)) {
                gantry.edge(now, *axis, direction);
                board.drive(gantry.drive());
            }
        }
        if let Some(byte) = board.receive() {
            gantry.receive(now, byte);
            board.drive(gantry.drive());
        }
        if board.can_transmit()
            && let Some(reply) = gantry.transmit()
        {
            board.transmit(reply);
        }
    }
}
