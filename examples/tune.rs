//! Finds the gains of a DC machine's motors, and says what margins they leave.
//!
//! The motors are simulated from the machine's file, if you like so many percent off it, as a real one would
//! be; the experiments do with them what they would do with yours: let them go a few millimetres to and fro,
//! or let a relay swing them. From what the encoder counted come a model, gains by a named rule, and the
//! margins of the loop as it runs, beside those of the published gains.
//!
//! Look at the column *phase margin*: the published x axis has less than half a degree, and swings. Then at
//! the picture, where its curve passes through -1.
//!
//! ```text
//! cargo run --release --example tune -- --svg tune.svg
//! cargo run --release --example tune -- --motor-off 0.3 --method step
//! cargo run --release --example tune -- --machine mine.toml --margin 1.4 --report tune.json
//! ```

use clap::Parser as _;
use plotter_examples::tune::TuneCommand;
use std::process::ExitCode;

fn main() -> ExitCode {
    TuneCommand::parse().run()
}
