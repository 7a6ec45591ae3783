//! Controllers that speak another protocol to their host than the stepper plotter behind them.
//!
//! ```text
//!   bytes of the host ──▶ front: buffers, checksums, answers ──▶ lines of Grbl's ──▶ StepperPlotter ──▶ steps
//!                     ◀──                                    ◀── ok, ALARM:n
//! ```
//!
//! A front keeps the buffers and gives the answers that its protocol documents. The plotter behind it plans
//! and steps; it is told one line at a time.

mod device_control;
mod emergency_parser;
mod hpgl;
mod inner;
mod marlin;
mod marlin_command;
mod plotter_questions;
mod sheet_lines;

pub(crate) use hpgl::Hpgl;
pub(crate) use marlin::Marlin;
