//! HPGL, the language of pen plotters.

mod command;
mod decimal;
mod error;
mod escape;
mod interpreter;
mod plot_ops;
mod position;
mod reader;
pub mod thesis_text;
mod writer;

pub use command::{Mnemonic, Syntax};
pub use error::Error;
pub use interpreter::{Interpreter, Undrained};
pub use plot_ops::{PlotOps, plot_ops};
pub use position::Position;
pub use reader::{Event, Reader};
pub use writer::{WriteError, WriteOptions, Writer, write_ops};

/// Plotter units in a millimetre: one unit is 0.025 mm.
pub const UNITS_PER_MM: f64 = 40.0;
