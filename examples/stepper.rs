//! Plots a drawing on a simulated plotter with stepper motors: time, speed, and every step of its motors.
//!
//! A file in HPGL, G-code, SVG, a cutter's language or the thesis' text is planned with look-ahead and turned
//! into timed steps, as the controller does it; then the steps alone are walked through. From them come the
//! picture that the pen draws, its speed over time, and the greatest speed, acceleration and distance from
//! the drawing.
//!
//! Look at the speed chart: in the mode `exact` the pen brakes for every corner, with `tolerance` it rounds
//! them within a distance that you name. Compare the times. Short lines that turn by no more than the last
//! digit of the file, or a motor step, are a curve in either mode: `--allowance-mm 0` shows what they would
//! cost.
//!
//! ```text
//! cargo run --release --example stepper -- --svg plot.svg --speed-plot speed.svg
//! cargo run --release --example stepper -- drawing.plt --mode tolerance --tolerance-mm 0.05
//! cargo run --release --example stepper -- drawing.gcode --max-speed 100 --accel 1000 --ignore-feed --report plot.json
//! cargo run --release --example stepper -- large.plt --estimate
//! ```
//!
//! With `--estimate` the steps are not made: the plan alone tells how long the plot takes, to the microsecond
//! as the steps would, some hundred times as fast.

use clap::Parser as _;
use plotter_examples::stepper::StepperCommand;
use std::process::ExitCode;

fn main() -> ExitCode {
    StepperCommand::parse().run()
}
