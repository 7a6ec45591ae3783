//! From a scan to ink: the whole semi-virtual plotter.
//!
//! A scanned line drawing becomes strokes, the strokes become HPGL, the HPGL goes target by target over the
//! serial line to a controller that drives two simulated DC motors, and everything on that line is recorded.
//! From the recording alone a virtual plotter draws what the motors did, beside what they should have done.
//!
//! Look at `report.html` first: the drawing, the plot, both coordinates over time, and where the errors are. Then run it
//! again with `--controller published` and compare. Both the vectorization and the controller of the thesis are an option away:
//! `--algorithm published --controller published`.

use clap::Parser as _;
use plotter_examples::plot::PlotCommand;
use std::process::ExitCode;

fn main() -> ExitCode {
    PlotCommand::parse().run()
}
