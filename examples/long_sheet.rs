//! A drawing longer than the table: frame by frame on a sheet that drifts, turns and never stops where it
//! should.
//!
//! The drawing is divided into frames, and a simulated machine draws one after the other. Between two frames
//! the paper moves on, and an optical head finds the marks of the frame before, at the joint: by the method
//! of Ivanov et al. or by ours. The misalignment that remains is measured where lines cross a joint.
//! `plotter-stitch/README.md` explains frames, joints and marks.
//!
//! With `--traces` nothing is simulated: scans of real joints are read from files, whose format is described
//! in `docs/stitch-traces.md`. It prints how the sheet lay and how certain that is, or refuses if too few
//! marks are left or dust may be among them.
//!
//! Look at the magnified joints (`--svg`): with `--method published` lines miss each other by half of the
//! pen's width, with ours by a few hundredths of a millimetre. Then look at the drift: nothing in the joints
//! holds the sheet straight but the paper's edge.
//!
//! ```text
//! cargo run --release --example long_sheet -- --svg sheet.svg
//! cargo run --release --example long_sheet -- --method published --svg published.svg
//! cargo run --release --example long_sheet -- drawing.plt --report sheet.json
//! cargo run --release --example long_sheet -- --frames 1000 --report long.json
//! cargo run --release --example long_sheet -- --traces joint1.json joint2.json --out joints.json
//! ```

use clap::Parser as _;
use plotter_examples::long_sheet::LongSheetCommand;
use std::process::ExitCode;

fn main() -> ExitCode {
    LongSheetCommand::parse().run()
}
