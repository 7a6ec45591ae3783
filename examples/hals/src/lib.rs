//! The drivers of `plotter-hal` on the types of chips' crates: that they fit is shown by compiling it.
//!
//! Each module takes what its crate gives, and hands it to the drivers as a firmware does. `check` compiles
//! each for its processor.
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
