//! The drivers of `plotter-hal` with the types of five crates for microcontrollers. That they compile shows
//! that the types fit; nothing here is run.
//!
//! Each module takes pins, ports and timers of one crate and hands them to the drivers as a firmware does.
//! The script `check` compiles each module for its processor.
#![no_std]

#[cfg(feature = "embassy-nrf")]
pub mod embassy_nrf;
#[cfg(feature = "embassy-rp")]
pub mod embassy_rp;
#[cfg(feature = "embassy-stm32")]
pub mod embassy_stm32;
#[cfg(feature = "rp2040-hal")]
pub mod rp2040_hal;
#[cfg(feature = "stm32f4xx-hal")]
pub mod stm32f4xx_hal;
