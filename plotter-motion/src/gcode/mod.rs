//! G-code, the language of machine tools, as pen plotters and lasers understand it: reader, interpreter and
//! writer.
//!
//! # The language in short
//!
//! A text is a row of lines, each a few words of a letter and a number. Numbers are decimal, in mm and
//! mm/min; what is in parentheses or after `;` is a comment:
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
//! # From text to drawing and back
//!
//! ```text
//! bytes ──▶ Reader ──▶ Block ──▶ Interpreter ──▶ PlotOp ──▶ Writer ──▶ text
//!           └──────────── plot_ops ────────────┘  mm
//! ```
//!
//! [`plot_ops`] does it for a text in memory, [`PlotOps`] for any iterator of bytes. [`Reader`] and
//! [`Interpreter`] are what both are made of: they take one byte and one line at a time, and own neither a
//! port nor a buffer, so that a text of any length needs the same memory. A controller that is sent its lines
//! one by one takes them from a [`Reader`] as [`Block`]s. [`Writer`] and [`write_ops`] go the other way.
//!
//! ```
//! use plotter_motion::{PlotOp, gcode};
//!
//! let text = b"G21 G90\nM5\nG0 X10 Y10\nM3 S90\nG1 X20 F1800\nG3 Y20 J5\nG1 X1O\nM5\nM2\n";
//! let options = gcode::WriteOptions { settle: core::time::Duration::ZERO, ..Default::default() };
//! let mut again = gcode::Writer::with_options(String::new(), options);
//! let mut reports = Vec::new();
//! for op in gcode::plot_ops(text) {
//!     match op {
//!         Ok(op) => again.push(op)?,
//!         Err(report) => reports.push(report.to_string()),
//!     }
//! }
//! assert_eq!(
//!     again.finish()?,
//!     "G21\nG90\nM5\nG0 X10 Y10\nM3 S90\nG1 X20 Y10 F1800\nG3 X20 Y20 I0 J5\nM5\nG0 X20 Y20\nM2\n"
//! );
//! assert_eq!(reports, ["line 7, column 6 (byte 57): O lacks its number: a word is like `O10`"]); // not 10 but 1O
//! # Ok::<(), gcode::WriteError>(())
//! ```
//!
//! # How pens are lifted
//!
//! The language knows no pens, so every machine has its own way. The writer is told it by [`PenControl`], the
//! interpreter by [`PenConvention`]; [`Detection`] finds it out from a text.
//!
//! | machine | up, down | written by | read by |
//! |---|---|---|---|
//! | GRBL with a servo as its spindle | `M5`, `M3 S…` | [`PenControl::Spindle`] | [`PenConvention::Spindle`] |
//! | the same, told its angles | `M3 S…`, `M3 S…` | [`PenControl::Commands`] | [`ServoCommand::M3`] |
//! | the same, in another sense | `M3`, `M5`; or `M4`, `M3` | [`PenControl::Commands`] | [`PenConvention::SpindleWords`] |
//! | a mill or a printer that holds a pen | `G0 Z…`, `G1 Z…` | [`PenControl::Height`] | [`PenConvention::Height`] |
//! | Unicorn | `M300 S50`, `M300 S30` | [`PenControl::Commands`] | [`ServoCommand::M300`] |
//! | Marlin with a servo | `M280 P0 S…` | [`PenControl::Commands`] | [`ServoCommand::M280`] |
//! | mDraw (Makeblock) | `M1 …`, degrees | [`PenControl::Commands`] | [`ServoCommand::M1`] |
//! | older Makeblock | `Z…`, degrees | [`PenControl::Commands`] | [`ServoCommand::Z`] |
//! | a laser on GRBL | `M5`, `M4 S…` or `M3 S…` | [`PenControl::Laser`] | [`LaserCommand::Spindle`] |
//! | a laser for a printer's fan | `M107`, `M106 S…` | [`PenControl::Commands`] | [`LaserCommand::Fan`] |
//! | a laser on mDraw | `M4 0`, `M4 …` | [`PenControl::Commands`] | [`LaserCommand::M4`] |
//! | none of these: G0 travels, G1 draws | | | [`PenConvention::Motion`] |
//! | any other words, as `M42 P4 S0` or Klipper's `PEN_UP` | a person says them | [`PenControl::Commands`] | `PenWords` |
//!
//! mDraw leaves G2, G3 and G4 undone without a word: give it chords, and no time to settle. Its firmware
//! takes words apart at blanks only: [`Spacing::Required`].
//!
//! # What is carried out
//!
//! | word | with | meaning |
//! |---|---|---|
//! | `G0` | X Y Z | goes there, as fast as can be; with the pen down it draws |
//! | `G1` | X Y Z F | goes there at the speed F |
//! | `G2`, `G3` | X Y, and I J or R | an arc, clockwise or counter-clockwise; R below 0 for more than half a turn; a whole circle by I J where it ends as it begins; P turns of it |
//! | `G5`, `G5.1` | X Y, I J, P Q | a cubic or quadratic curve, as chords within 0.01 mm |
//! | `G5.2` … `G5.3` | X Y, P, L | a NURBS curve: each line in between is a control point, P its weight, L the order up to 6; as chords within 0.01 mm |
//! | `G15`, `G16` | | X and Y are places; or a radius and an angle |
//! | `G17`, `G18`, `G19` | | arcs lie in the sheet; or stand on it, and are lines to their ends |
//! | `G4` | P or S | waits: P as [`ReadOptions::dwell_unit`] says, S seconds |
//! | `G28`, `G30` | X Y Z | travels to the origin, or along the axes named only; numbers do not count |
//! | `G53` | | coordinates of this line without the offsets of `G10` and `G92` |
//! | `G90`, `G91` | | coordinates are places, or ways |
//! | `G90.1`, `G91.1` | | I and J are a place, or count from where the arc begins |
//! | `G20`, `G21` | | inches, millimetres |
//! | `G92` | X Y Z | here is that place; without words, the origin |
//! | `G92.1`, `G92.2`, `G92.3` | | that no longer; after `G92.2`, `G92.3` has it again |
//! | `G52` | X Y | coordinates count from there, in place of `G92` |
//! | `G50`, `G51` | X Y, P or I J | what is drawn is scaled about X Y, by a factor, from 100 on in thousandths; or by X and Y alone about the origin. Arcs of unequal factors are chords within 0.01 mm |
//! | `G68`, `G69` | X Y R | it is turned about X Y by degrees, counter-clockwise |
//! | `G54` … `G59`, `G59.1` … `G59.3` | | coordinates count from the origin that `G10` has set for this one; `G54` at first |
//! | `G10` | L2 or L20, P0 to P9, X Y | its origin is there; or here is that place, as the button *zero* of most programs has it. P1 is that of `G54`, P6 that of `G59`, P0 the one in force |
//! | `G73`, `G81` … `G89` | X Y Z R | down to Z and up again in each place, a dot; where the pen is lifted by Z. `G98`, `G99`: up to where it was, or to R |
//! | `G80` | | coordinates without a command are an error from here on |
//! | `M3`, `M4`, `M5`, `S` | | pens, servos and lasers, as above; so `M1 …`, `M4 …`, `M106`, `M107`, `M280`, `M300` |
//! | `M6` | T | takes the pen T, also one of an earlier line |
//! | `M0 (pen 2)`, `(pen 1)`, `M0 (new sheet)` | | what [`Writer`] writes for another pen, the first one, and a new sheet; every other `M0` and `M1` is a pause, and reported with its text |
//! | `M2`, `M30` | | pen up; modes as GRBL sets them back then. For [`PlotOps`] the program ends; [`Interpreter`] reads on |
//! | `#1 = …`, `#<name> = …`, `[ ]` | | values are reckoned, with `LinuxCNC`'s operators and functions, angles in degrees |
//! | `O…` `sub`, `call`, `if`, `while`, `do`, `repeat` | | as in `LinuxCNC`, in [`PlotOps`] |
//! | `M98`, `M99` | P L | Fanuc's subprogram `O…`, behind the end of the program; `P30015` is `P15 L3` |
//! | `F`, `S`, `T` | | hold until another one comes |
//! | coordinates alone | | the last of `G0` to `G3` again; `G0` at first |
//! | `N`, `O`, `%` | | nothing |
//!
//! Nothing is done for `G17 G40 G49 G61 G64 G94`, coolant, drives (`M17 M18 M84`), and questions and settings
//! of printers and of mDraw; what else is known by name is reported as [`Problem::Unsupported`], a notice;
//! the end of a movement that is left out, and of an arc that is none, is gone to with the pen up, so that
//! what follows stands where it should. All `G` and `M` words of a line are done, but two that exclude each
//! other are an error.
//!
//! # Bad input
//!
//! An [`Error`] says where (line, column, byte), what is wrong and what would be right. Its line is left out
//! as a whole, and reading goes on with the next one; [`PlotOps::strict`] stops instead. Arcs are refused as
//! GRBL refuses them, whose ends lie more than 0.5 mm unequally far from the centre, or more than 0.005 mm
//! and a thousandth.
//!
//! Variables, loops and subprograms need memory, and with it the feature `alloc`: loops and subprograms of a
//! text are held, 16 MiB of them at most, and repeat a million lines at most. Without it they are errors.
//! [`Reader`] and [`Interpreter`] by themselves do without.
//!
//! # Why not the crate `gcode`
//!
//! Version 0.7 of that crate takes words apart without allocation, with a line number and offset for each. It
//! reads a `&str` that holds whole lines in UTF-8, so bytes from a serial line have to be gathered first.
//! Numbers are `f32`, of 7 digits. It finds commands and their arguments, and no arcs, units or pens, which
//! are the larger part here. Of the dialects above it reports `M1 90`, `/`, `$` and checksums as wrong;
//! `X1e3` it takes for an X and an E.
//!
//! Sources: the `LinuxCNC` project's G-code and O-code reference; NIST, *The NIST RS274NGC Interpreter,
//! Version 3* (2000); the GRBL project's wiki on version 1.1.

pub use crate::decimal::WrittenNumber;
mod arc;
mod block;
mod code;
mod detection;
mod error;
mod expansion;
#[cfg(feature = "alloc")]
mod expression;
mod frame;
mod interpreter;
mod line;
mod lines;
mod machine;
mod modes;
mod nurbs;
mod pen_convention;
#[cfg(feature = "alloc")]
mod pen_words;
mod plot_ops;
#[cfg(feature = "alloc")]
mod program;
mod read_options;
mod reader;
mod remark;
mod stretched_arc;
mod text;
#[cfg(feature = "alloc")]
mod variables;
mod write_error;
mod write_options;
mod writer;

pub(crate) use crate::hpgl::Cursor;
pub use crate::hpgl::{Position, Undrained};
pub use block::{Block, Remark, Word};
pub use detection::{Detection, detect};
pub(crate) use error::Complaint;
pub use error::{Error, Problem};
pub use interpreter::Interpreter;
pub(crate) use interpreter::{LineInterpreter, Outcomes};
pub use modes::Modes;
pub(crate) use modes::SYSTEMS;
pub use pen_convention::{LaserCommand, PenConvention, ServoCommand};
#[cfg(feature = "alloc")]
pub use pen_words::{PenWords, is_named};
pub use plot_ops::{PlotOps, plot_ops};
pub use read_options::{BlockDelete, ReadOptions, Words};
pub(crate) use reader::{MOST, is_control, is_text};
pub use reader::{Reader, Spacing};
pub use text::Text;
pub use write_error::WriteError;
pub use write_options::{DwellUnit, PenChange, PenControl, WriteOptions};
pub use writer::{Writer, write_ops};
