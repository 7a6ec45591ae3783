//! HPGL, the language of pen plotters: reader, interpreter and writer.
//!
//! # The language in short
//!
//! A text is a row of commands. A command is two letters, in either case, and what it needs; a `;` ends it, and
//! so does the next command. Numbers are decimal and stand between commas or blanks:
//!
//! ```text
//! IN;                        start afresh: pen up, absolute coordinates
//! SP1;                       take pen 1
//! PU400,400;                 pen up, go to (10, 10) mm
//! PD800,400,800,800;         pen down, draw two lines
//! CI200;                     a circle of 5 mm about (20, 20) mm
//! PU;SP0;                    pen up, put it away
//! ```
//!
//! ```text
//!                 y ▲
//!   (800, 800) ..................( o )       40 units = 1 mm, so that
//!                   .              |         a unit is 0.025 mm
//!   (400, 400) .....+--------------+
//!                   .
//!                   0 ─────────────────▶ x
//! ```
//!
//! Source: Hewlett-Packard's programming manuals of the 7475A (HPGL) and *The HP-GL/2 and HP RTL Reference
//! Guide*.
//!
//! # From text to drawing and back
//!
//! ```text
//! bytes ──▶ Reader ──▶ Event ──▶ Interpreter ──▶ PlotOp ──▶ Writer ──▶ text
//!           └──────────── plot_ops ────────────┘  mm
//! ```
//!
//! [`plot_ops`] does it for a text in memory, [`PlotOps`] for any iterator of bytes. [`Reader`] and
//! [`Interpreter`] are what both are made of: they take one byte and one event at a time, and own neither a port
//! nor a buffer, so that a text of any length needs the same few hundred bytes. [`Writer`] and [`write_ops`] go
//! the other way.
//!
//! ```
//! use plotter_motion::{PlotOp, hpgl};
//!
//! let text = b"IN;SP1;PU400,400;PD800,400,800,800;RP2;CI200;PU;SP0;";
//! let mut again = String::new();
//! let mut drawing = hpgl::Writer::new(&mut again);
//! let mut reports = Vec::new();
//! for op in hpgl::plot_ops(text) {
//!     match op {
//!         Ok(op) => drawing.push(op)?,
//!         Err(report) => reports.push(report.to_string()),
//!     }
//! }
//! drawing.finish()?;
//! assert!(again.starts_with("IN;\nSP1;\nPU400,400;\nPD800,400,800,800;\nPU1000,800;\nPD;\nAA800,800,90;\n"));
//! assert_eq!(reports, ["line 1, column 36 (byte 35): RP (replot) is not supported and is left out"]);
//! # Ok::<(), hpgl::WriteError>(())
//! ```
//!
//! # What is carried out
//!
//! | command | numbers | meaning |
//! |---|---|---|
//! | `IN` | | pen up where it stands; absolute coordinates; label terminator and speed of the start |
//! | `DF` | | absolute coordinates; label terminator of the start |
//! | `SP` | pen, 0 when missing | takes a pen; 0 puts it away |
//! | `VS` | speed in cm/s, pen | speed of all pens, or of one from 1 to 8; without numbers the plotter's own |
//! | `PU` | x, y, … | lifts the pen, then moves |
//! | `PD` | x, y, … | lowers the pen, then draws |
//! | `PA` | x, y, … | from here on coordinates count from the origin; moves with the pen as it is |
//! | `PR` | x, y, … | from here on coordinates count from where the pen stands; moves likewise |
//! | `CI` | radius, chord angle in degrees | circle about where the pen stands; 5° when missing, 0.36° at the least |
//! | `AA` | x, y, angle, chord angle in degrees | arc about a centre, with the pen as it is; counter-clockwise for angles above 0 |
//! | `AR` | x, y, angle, chord angle in degrees | as `AA`, the centre from where the pen stands |
//! | `PG` | | a new sheet |
//! | `DT` | a byte, mode | ends labels from here on; with mode 0 the byte belongs to the label |
//! | `CO` | a string | a comment |
//!
//! Every other command of HPGL and HP-GL/2 is known by name and by how its end is found (see [`Syntax`]), and
//! is reported as [`Error::Unsupported`]: labels are never read as commands, nor are polygons encoded with
//! `PE`. A drawing scaled with `SC` and `IP` comes out in plotter units, with that report.
//!
//! # Bad input
//!
//! An [`Error`] says where (line, column, byte), which command, what is wrong and what would be right. What had
//! been read of the command stands, the rest of it is skipped, and reading goes on with the next one;
//! [`PlotOps::strict`] stops instead.

mod arc;
mod bezier;
mod command;
mod decimal;
mod encoded;
mod error;
mod escape;
#[cfg(feature = "font")]
mod font;
mod hatch;
mod interpreter;
mod lettering;
mod line_type;
mod pen_path;
mod piece;
mod plot_ops;
mod polygon;
mod position;
mod read_options;
mod reader;
mod scaling;
pub mod thesis_text;
mod window;
mod write_error;
mod write_options;
mod writer;

pub use command::{Mnemonic, Syntax};
pub use error::Error;
pub use interpreter::{Interpreter, Undrained};
pub use plot_ops::{PlotOps, plot_ops};
pub use position::Position;
pub use read_options::ReadOptions;
pub use reader::{Event, Reader};
pub use write_error::WriteError;
pub use write_options::{Coordinates, Opening, WriteOptions};
pub use writer::{Writer, write_ops};

/// Plotter units in a millimetre: one unit is 0.025 mm.
pub const UNITS_PER_MM: f64 = 40.0;
