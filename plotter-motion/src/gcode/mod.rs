//! G-code, the language of machine tools, as pen plotters understand it: writer.
//!
//! # The language in short
//!
//! A text is a row of lines, each a few words of a letter and a number. Numbers are decimal, in mm and mm/min:
//!
//! ```text
//! G21                        millimetres
//! G90                        coordinates are places, not ways
//! M5                         pen up
//! G0 X10 Y10                 travel
//! M3 S90                     pen down
//! G1 X20 Y10 F1800           draw a line at 30 mm/s
//! G3 X20 Y20 I0 J5           draw half a circle, counter-clockwise; its centre is (0, 5) from where the pen is
//! M5
//! M2                         end
//! ```
//!
//! # How pens are lifted
//!
//! The language knows no pens, so every machine has its own way: see [`PenControl`].
//!
//! | machine | up, down | |
//! |---|---|---|
//! | GRBL with a servo as its spindle | `M5`, `M3 S…` | [`PenControl::Spindle`] |
//! | a mill or a printer that holds a pen | `G0 Z…`, `G1 Z…` | [`PenControl::Height`] |
//! | mDraw (Makeblock) | `M1 …`, degrees | [`PenControl::Commands`] |
//! | Unicorn | `M300 S50`, `M300 S30` | [`PenControl::Commands`] |
//! | Marlin with a servo | `M280 P0 S…` | [`PenControl::Commands`] |
//!
//! mDraw leaves G2, G3 and G4 undone without a word: give it chords, and no time to settle.
//!
//! Sources: NIST, *The NIST RS274NGC Interpreter, Version 3* (2000); the GRBL project's wiki on version 1.1.

mod arc;
mod block;
mod code;
mod detection;
mod error;
mod interpreter;
mod line;
mod machine;
mod number;
mod pen_convention;
mod plot_ops;
mod read_options;
mod reader;
mod remark;
mod write_error;
mod write_options;
mod writer;

pub use crate::hpgl::{Position, Undrained};
pub use block::{Block, Remark, Word};
pub use detection::{Detection, detect};
pub use error::{Error, Problem};
pub use interpreter::Interpreter;
pub use pen_convention::{LaserCommand, PenConvention, ServoCommand};
pub use plot_ops::{PlotOps, plot_ops};
pub use read_options::{BlockDelete, ReadOptions};
pub use reader::{Reader, Spacing};
pub use write_error::WriteError;
pub use write_options::{DwellUnit, PenChange, PenControl, WriteOptions};
pub use writer::{Writer, write_ops};
