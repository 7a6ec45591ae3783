//! Which controller draws straightest? The published ones and ours on the control test bed.
//!
//! Eight lines of 60 mm, in all directions, on simulated motors with a load, friction and coarse encoders;
//! and no controller is told the truth about them: the description that it gets is a quarter wrong. Look at
//! the table first: *rms* and *max* are the true distance of the pen from its line. Then write the page with
//! `--html`, where each controller's way is drawn with its errors magnified.
//!
//! A controller of your own takes part from a file of its own: `my_controller.rs`.

use std::process::ExitCode;

fn main() -> ExitCode {
    plotter_examples::compare::compare_controllers(Vec::new())
}
