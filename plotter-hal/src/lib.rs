#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

pub mod h_bridge;
pub mod quadrature;

pub use embedded_hal;
pub use h_bridge::HBridge;
pub use quadrature::Quadrature;
