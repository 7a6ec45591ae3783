//! The one-letter languages of cutters and of the pen plotters they come from: Roland's CAMM-GL mode 1 and
//! Graphtec's GP-GL.
//!
//! ```text
//! CAMM-GL, one command a line        GP-GL, a byte 3 behind each
//! H                                  H
//! M400,400                           M100,100            pen up, go to (10, 10) mm
//! D800,400,800,800                   D200,100,200,200    pen down, draw two lines
//! I-400,-400                         E-100,-100          draw a way from here
//! C800,800,200,0,360                 W200,200,50,50,0,3600   a circle of 5 mm about (20, 20) mm
//! ```
//!
//! Coordinates count steps, whose size the text does not say and the machine's panel may change: see
//! [`Dialect::step_mm`] and [`ReadOptions::step_mm`].
//!
//! | CAMM-GL | GP-GL | meaning |
//! |---|---|---|
//! | `M` `D` | `M` `D` | travels, or draws, to places |
//! | `R` `I` | `O` `E` | travels, or draws, along ways |
//! | | `MP` `DP` `OP` `EP` | the same by distance and angle, 0.1° |
//! | `H` | `H` | travels to the origin |
//! | `C` | `W` | circle or arc about a centre: radius, where it begins and ends (degrees; 0.1°, with a radius for each end) |
//! | `E` | `]` | the same, begun where the pen stands |
//! | `A` `G` | | a centre, and an arc about it |
//! | | `BZ` | a cubic curve |
//! | `J` | `J` | takes a pen |
//! | | `^` | moves the origin |
//!
//! What else would be seen on the sheet is left out, and said with what to do: letters and marks (`P` `N`),
//! curves through places (`Y`), axes and hatching (`X` `T`), line types (`L`: the lines are drawn, solid),
//! what begins with `^` in CAMM-GL. Of force, speed and blade each kind is said once. Nothing is said about
//! letters' sizes and questions to the machine.
//!
//! An [`Error`] stands in the place of what could not be carried out; reading goes on.
//!
//! Source: Roland's *DXY-1300 Command Reference Manual*, chapter 2; Graphtec's table of GP-GL for its Craft
//! Robo cutters.
//!
//! ```
//! use plotter_motion::hpgl::cutter::{Dialect, plot_ops};
//! use plotter_motion::{PlotOp, Point};
//!
//! let ops: Result<Vec<PlotOp>, _> = plot_ops(b"H\nM400,400\nD800,400\n", Dialect::CammGl).collect();
//! let to = Point::new(20.0, 10.0); // 800 and 400 steps of 0.025 mm
//! assert_eq!(ops?.last(), Some(&PlotOp::Draw { to, feed_mm_s: None }));
//! # Ok::<(), plotter_motion::hpgl::cutter::Error>(())
//! ```

mod command;
mod dialect;
mod error;
mod plot_ops;

pub use command::Command;
pub use dialect::Dialect;
pub use error::{Error, Problem};
pub use plot_ops::{PlotOps, ReadOptions, plot_ops};
