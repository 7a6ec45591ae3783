#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod frame_transform;
mod readings;
mod residual;

pub use frame_transform::{FrameTransform, TransformError};
pub use readings::{FrameReadings, Mark, Reading};
pub use residual::Residual;
