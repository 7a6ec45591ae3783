//! A drawing longer than the table: frame by frame on a sheet that walks, turns and never stops where it
//! should.
//!
//! The drawing is divided into frames, a simulated machine draws them one after the other, and between two of
//! them the paper moves on and an optical head looks for the lines of the frame before, as published or with
//! ours. What is left at the joints is measured where lines really go over them.
//!
//! With `--traces` nothing is simulated: the scans over the marks of real joints are in files, and how the
//! sheet lay is told, with how sure that is, or refused where dust was taken for marks or too few are left.
//!
//! Look at the magnified joints (`--svg`): with `--method published` lines miss each other by half of the
//! pen's width, with ours by a few hundredths of a millimetre. Then at the drift: nothing in the joints holds
//! the sheet straight but the paper's edge.
//!
//! ```text
//! cargo run --release --example long_sheet -- --svg sheet.svg
//! cargo run --release --example long_sheet -- --method published --svg published.svg
//! cargo run --release --example long_sheet -- draft.plt --report sheet.json
//! cargo run --release --example long_sheet -- --frames 1000 --report long.json
//! cargo run --release --example long_sheet -- --traces joint1.json joint2.json --out joints.json
//! ```

use clap::Parser as _;
use plotter_examples::long_sheet::LongSheetCommand;
use std::process::ExitCode;

fn main() -> ExitCode {
    LongSheetCommand::parse().run()
}
