//! The command line of the contest.

use super::contest::compare;
use crate::shared::{Telling, run};
use clap::Parser;
use plotter_motion::testbed::Entry;
use std::path::PathBuf;
use std::process::ExitCode;

/// Lets controllers draw on simulated machines whose descriptions are wrong, and ranks them by how near to
/// the lines the pen truly was.
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 100,
    name = "compare_controllers",
    after_help = "Examples:\n  plotter compare\n  \
                  plotter compare --drawing builtin --html target/controllers.html\n  \
                  plotter compare --machine examples/machines/loaded-gantry.toml \
                  --machine mine.toml --csv figures.csv\n\n\
                  A controller of your own: copy examples/my_controller.rs.\n\n\
                  In a checkout of the project, `cargo run --release --example compare_controllers --` stands for `plotter compare`."
)]
pub struct CompareCommand {
    /// A machine's TOML file; may be given several times [default: the loaded gantry, with its encoders
    /// decoded x1 and x4]
    #[arg(long, value_name = "FILE")]
    pub(super) machine: Vec<PathBuf>,
    /// What is drawn besides the eight lines: a picture (PNG, JPEG, PBM, PGM), HPGL (.plt, .hpgl), or
    /// `builtin` for a flag as line art
    #[arg(long, value_name = "FILE|builtin")]
    pub(super) drawing: Option<PathBuf>,
    /// Width of a drawn picture, mm
    #[arg(long, value_name = "MM", default_value_t = 50.0, allow_negative_numbers = true)]
    pub(super) width_mm: f64,
    /// By which share the description that controllers are given is wrong in each of its figures, 0 to 0.5
    #[arg(long, value_name = "SHARE", default_value_t = 0.25, allow_negative_numbers = true)]
    pub(super) wrong: f64,
    /// Only these controllers, by their names with commas between them
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(super) only: Vec<String>,
    /// Writes a page with tables and pictures, which needs no other file
    #[arg(long, value_name = "FILE")]
    pub(super) html: Option<PathBuf>,
    /// Writes the figures of every line
    #[arg(long, value_name = "FILE")]
    pub(super) csv: Option<PathBuf>,
    #[command(flatten)]
    pub(super) telling: Telling,
}

impl CompareCommand {
    /// Runs the command; its help has the table of exit codes.
    #[must_use]
    pub fn run(self) -> ExitCode {
        self.run_with(Vec::new())
    }

    /// The same with controllers of one's own beside those that are always there.
    fn run_with(self, more: Vec<Entry>) -> ExitCode {
        run("compare_controllers", || compare(&self, more))
    }
}

/// Runs the command line of `compare_controllers` with the controllers that are always there and `more` of
/// one's own.
#[must_use]
pub fn compare_controllers(more: Vec<Entry>) -> ExitCode {
    CompareCommand::parse().run_with(more)
}
