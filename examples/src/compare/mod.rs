//! `compare_controllers` and `my_controller`: controllers ranked on simulated machines.

mod controller_contest;

pub use controller_contest::compare_controllers;
