//! HPGL, the language of pen plotters: reader, interpreter and writer.
//!
//! # The language in short
//!
//! A text is a row of commands. A command is two letters, in either case, and what it needs; a `;` ends it,
//! and so does the next command. Numbers are decimal and stand between commas or blanks:
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
//! [`Interpreter`] are what both are made of: they take one byte and one event at a time, and own neither a
//! port nor a buffer, so that a text of any length needs the same few hundred bytes. [`Writer`] and
//! [`write_ops`] go the other way.
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
//! | commands | meaning |
//! |---|---|
//! | `IN` `DF` `BP` `PG` | start afresh (see [`Interpreter`]); a new plot, with all that `IN` does; a new sheet (`AF` `AH` `FR` likewise) |
//! | `PU` `PD` `PA` `PR` | lifts or lowers the pen; from here on coordinates are places or steps; each with any number of pairs |
//! | `SP` `VS` | takes a pen, 0 to put it away; speed in cm/s, of all pens or of one from 1 to 8 |
//! | `PW` `PT` `WU` | width of the pen in mm or percent, which solid filling goes by |
//! | `CI` `AA` `AR` `AT` `RT` `CT` | circles, arcs about a centre and through places: as arcs, or as chords where more than 5° are asked for |
//! | `BZ` `BR` | cubic curves, as lines within [`ReadOptions::tolerance_mm`] |
//! | `PE` | encoded polylines, of 5 or 6 bits; a text whose bytes were taken for Latin-1 and written as UTF-8 is read all the same, and so are data that the next command ends instead of a `;` |
//! | `IP` `IR` `SC` `RO` `PS` | what coordinates mean: see [`ReadOptions`] for what holds before. P1, P2 and the window keep their numbers when the axes turn; `IR`, and `IP` without numbers, go by the sheet along the turned axes. `PS` says the sheet as it lies |
//! | `IW` | nothing is drawn outside of this window, which turns with the axes; arcs are cut exactly |
//! | `LT` `UL` | line types 1 to 8, fitted ones from −1, dots at the ends with 0; patterns of the text's own |
//! | `PM` `EP` `FP` | polygons: kept, edged, filled (even-odd or winding) |
//! | `EA` `ER` `RA` `RR` `EW` `WG` | rectangles and wedges, edged and filled; they stay in the polygon buffer |
//! | `FT` `AC` `UF` `RF` | solid, lines, crossed lines, shading, and lines at the mean of distances of the text's own; where the lines lie; a raster (`RF`) is shaded as much as it inks |
//! | `LB` `DT` `BL` `PB` | labels in Latin-1 or UTF-8, with carriage return, line feed, backspace and tabulator; kept, and drawn later |
//! | `CS` `CA` `SS` `SA` | letters of a language in the place of signs (ISO 646), HP's Roman Extensions; shift out and shift in |
//! | `SI` `SR` `DI` `DR` `SL` `DV` `LO` `ES` `CP` `SD` | size, direction, slant, path and origin of labels, room between characters; of a printer's font its height and set (also `AD`) |
//! | `SM` `UC` `DL` | a symbol at each place; a character of the text's own, once or as part of a set |
//! | `XT` `YT` `TL` | ticks |
//! | `ESC .` `ESC %` `ESC E` | device control is passed over; so is what another language says; `ESC E` starts afresh |
//!
//! Labels and symbols need the feature `font` (part of `std`), 5 KiB of strokes; without it they are reported
//! as unsupported.
//!
//! What means nothing to a machine with one pen that draws what it is told is passed over without a word:
//! colours and their order (`PC` `NP` `CR` `TR` `MC` …), ends and joins of thick lines (`LA`), the looks of
//! fonts (`FI` `CF` …), accelerations, and motion without stops (`CV`), which is the planner's business,
//! questions to the plotter (`OE` `OP` `OS` …), its display, comments. What would be seen and is not done is
//! said, as [`Error::Unsupported`]: `RP` (replot: whoever has the text can read it again; a reader in
//! constant memory has not kept it), `NR` (wait), `SV` (screened lines), `PP`, `TD`, digitizing.
//!
//! What is for cutters is named, with what it does there: force (`FS`), blade (`FC`, `FD`), registration
//! marks (`TB`), and as [`Error::Extension`] what begins with `!` (Roland's own: `!ST` `!FS` `!PG` …), `@`,
//! and a byte 3 between commands. Each kind is named once, but for the marks. The one-letter languages of
//! cutters are in [`cutter`].
//!
//! # Bad input
//!
//! An [`Error`] says where (line, column, byte), which command, what is wrong and what would be right. What
//! had been read of the command stands, the rest of it is skipped, and reading goes on with the next one;
//! [`PlotOps::strict`] stops instead.

pub use crate::decimal::WrittenNumber;
mod arc;
mod character_set;
mod command;
pub mod cutter;
mod encoded;
mod error;
mod escape;
mod extension;
#[cfg(feature = "font")]
mod font;
mod hatch;
mod interpreter;
mod lettering;
mod line_type;
mod own_characters;
mod pen_path;
mod piece;
mod plot_ops;
mod polygon;
mod position;
mod read_options;
mod reader;
mod run;
mod scaling;
pub mod thesis_text;
mod window;
mod write_error;
mod write_options;
mod writer;

pub use command::{Mnemonic, Syntax};
pub use error::Error;
pub use extension::Extension;
#[cfg(feature = "font")]
pub use font::letter_strokes;
pub use interpreter::{Interpreter, Undrained};
pub use lettering::{LETTER_ADVANCE, LETTER_HEIGHT, LETTER_WIDTH};
pub use plot_ops::{PlotOps, plot_ops};
pub(crate) use position::Cursor;
pub use position::Position;
pub use read_options::ReadOptions;
pub use reader::{Event, Reader};
pub use run::Commands;
pub use write_error::WriteError;
pub use write_options::{Coordinates, Opening, WriteOptions};
pub use writer::{Writer, write_ops};

/// Plotter units in a millimetre: one unit is 0.025 mm.
pub const UNITS_PER_MM: f64 = 40.0;
