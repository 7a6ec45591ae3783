//! Boards of others, as controllers of a simulated stepper plotter.

mod ebb;

pub(crate) use ebb::ebb;
