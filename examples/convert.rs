//! One language of plotters into another: HPGL, G-code, SVG and the thesis' text; from CAMM-GL and GP-GL of
//! cutters, and DXF of CAD programs, too.
//!
//! All of them say the same few things: take a pen, go there, draw there, along a line or an arc. What one
//! language says and the other cannot is told on the standard error, with its line and column; the rest is
//! converted. HPGL and G-code stream through: a file of any size needs the same memory.
//!
//! Look at how an arc fares: `AA` in HPGL, `G2` and `G3` in G-code and `A` in SVG are the same arc, and stay
//! one; where there are none, chords take its place within a tolerance.
//!
//! ```text
//! cargo run --release --example convert -- drawing.plt drawing.gcode
//! cargo run --release --example convert -- drawing.svg drawing.plt
//! cargo run --release --example convert -- plan.svg plan.plt --font DejaVuSans.ttf
//! cargo run --release --example convert -- drawing.svg - --to gcode --pen-up "M280 P0 S60" --pen-down "M280 P0 S30"
//! ```

use clap::Parser as _;
use plotter_examples::convert::ConvertCommand;
use std::process::ExitCode;

fn main() -> ExitCode {
    ConvertCommand::parse().run()
}
