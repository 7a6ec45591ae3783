//! Functions that the compiler calls where the processor has no instruction: `f64`, 64-bit division, memory.
//! The compiler's own routines are made for speed and take 7.6 KB of flash, these 2.1 KB. Linking the crate
//! puts them in place of the others:
//!
//! ```text
//! use small_runtime as _;
//! ```
//!
//! The results are the same to the last bit (IEEE 754, to nearest, ties to even); only which NaN a NaN is may
//! differ.
#![no_std]

mod float;
#[cfg(target_arch = "arm")]
mod symbols;
mod whole;

pub use float::{
    Order, add, compare, divide, from_i64, from_u64, multiply, narrow, single_from_u64, to_i64, widen,
};
pub use whole::divide_u64;
