//! HPGL, the language of pen plotters.

mod writer;

pub use writer::{WriteError, WriteOptions, Writer, write_ops};

/// Plotter units in a millimetre: one unit is 0.025 mm.
pub const UNITS_PER_MM: f64 = 40.0;
