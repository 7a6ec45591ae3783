//! Whole controllers as sans-IO state machines: time, bytes, edges and switches in; bytes and drive out.
//!
//! The same struct runs on a microcontroller, against simulated motors, and against a recorded log.

mod gantry;
mod linked_gantry;
mod marking_board;
pub mod stepper_plotter;

pub use gantry::{Gantry, GantrySettings, Notice};
pub use linked_gantry::LinkedGantry;
pub use marking_board::{MarkingBoard, MarkingBoardSettings};
pub use stepper_plotter::StepperPlotter;
