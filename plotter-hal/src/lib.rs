#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod a4988;
pub mod axis;
mod debounce;
pub mod estop_input;
pub mod h_bridge;
pub mod laser;
pub mod limit_switch;
mod no_pin;
pub mod pen_servo;
pub mod pulse_counter;
pub mod quadrature;
pub mod serial_line;
pub mod tmc2209;
#[cfg(feature = "async")]
pub mod waiting;
mod which_pin;

pub use a4988::A4988;
pub use axis::{DcAxes, StepperAxes};
pub use debounce::SwitchSettings;
pub use embedded_hal;
#[cfg(feature = "async")]
pub use embedded_hal_async;
#[cfg(feature = "embedded-hal-nb")]
pub use embedded_hal_nb;
pub use embedded_io;
#[cfg(feature = "embedded-io-06")]
pub use embedded_io_06;
#[cfg(feature = "async")]
pub use embedded_io_async;
pub use estop_input::{EstopChange, EstopInput};
pub use h_bridge::HBridge;
pub use laser::{Laser, power_at_speed};
pub use limit_switch::{LimitSwitch, LimitSwitchGroup};
pub use no_pin::NoPin;
pub use pen_servo::{CheckedPenServo, PenServo, PenServoSettings, ServoPoint};
pub use plotter_motion;
pub use pulse_counter::{CounterDelta, PulseInput, TimerCount};
pub use quadrature::Quadrature;
pub use serial_line::{SerialLine, SerialRx, SerialTx};
pub use tmc2209::Tmc2209;
