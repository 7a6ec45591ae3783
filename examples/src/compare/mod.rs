//! `compare_controllers` and `my_controller`: controllers ranked on simulated machines.

mod command;
mod contest;
mod page;

pub use command::{CompareCommand, compare_controllers};
