#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

pub mod a4988;
pub mod axis;
pub mod h_bridge;
mod no_pin;
pub mod quadrature;

pub use a4988::A4988;
pub use axis::{DcAxes, StepperAxes};
pub use embedded_hal;
pub use h_bridge::HBridge;
pub use no_pin::NoPin;
pub use quadrature::Quadrature;
