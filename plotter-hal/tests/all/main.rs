//! All integration tests of the crate as one program, which is linked once; a module is a subject.
//!
//! `cargo test -p plotter-hal --test all SUBJECT::` runs those of one.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test fails by a panic, and prints its tables"
)]

mod a4988;
#[cfg(feature = "async")]
mod async_inputs;
mod axis;
mod bad_moments;
#[cfg(feature = "defmt")]
mod defmt_formats;
mod dependencies;
mod estop_input;
#[cfg(feature = "async")]
mod executor;
mod faulty;
mod h_bridge;
mod h_bridge_kinds;
mod laser;
mod late_loop;
mod limit_switch;
mod logic_analyser;
mod pen_servo;
mod pins_apart;
mod prop_drivers;
mod pulse_counter;
mod quadrature;
#[cfg(all(feature = "async", feature = "embedded-hal-nb", feature = "embedded-io-06"))]
mod serial_halves;
mod serial_line;
mod tmc2209;
