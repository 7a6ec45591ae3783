//! One greatest error, from the scan to the ink.
//!
//! You say how far the drawing may be from the scan, in mm. How finely the lines are traced, how far corners
//! are rounded, and how fast the machine may go follow from it: the rest of the example finds the split with
//! which the drawing is done soonest. Then the simulated machine draws, and what it drew is compared with the
//! scan's ink, both ways.
//!
//! Look at `--picture`: the pale band is as wide as the error that you allowed, and the ink stays in it. Ask
//! for less and less: it takes longer and longer, until you are told what is in the way, and what the
//! smallest error is.
//!
//! Near some ink is not enough: each line of the scan, from where it meets others to where it meets others
//! again, is followed from its beginning to its end by something drawn that stands for no other line. Where
//! lines closer together than the error may become one, say so with `--allow-merged-lines`; how many did is
//! told.
//!
//! ```text
//! cargo run --release --example max_error
//! cargo run --release --example max_error -- scan.png --max-error-mm 0.2 --picture drawn.svg
//! cargo run --release --example max_error -- scan.png --max-error-mm 0.05 --machine examples/machines/marking-board.toml
//! ```

use clap::Parser as _;
use plotter_examples::max_error::MaxErrorCommand;
use std::process::ExitCode;

fn main() -> ExitCode {
    MaxErrorCommand::parse().run()
}
