//! The command line of `stepper`.

use super::course::plot;
use crate::drawings::DrawingArguments;
use crate::shared::{ExitStatus, Telling, run};
use clap::{Parser, ValueEnum};
use std::path::PathBuf;
use std::process::ExitCode;

/// Plots a drawing on a simulated plotter with stepper motors, and measures time, speed and accuracy.
///
/// The file is planned with look-ahead and turned into timed steps; all figures except lengths are measured
/// on the steps. The time in motion does not include the pen's delays and pauses.
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 100,
    name = "stepper",
    after_help = "Examples:\n  \
                  plotter stepper --svg plot.svg --speed-plot speed.svg\n  \
                  plotter stepper drawing.plt --mode tolerance --tolerance-mm 0.05 --report plot.json\n  \
                  plotter stepper drawing.gcode --max-speed 100 --accel 1000 --ignore-feed\n  \
                  plotter stepper large.plt --estimate\n  \
                  cat drawing.svg | plotter stepper - --s-curve --jerk 20000 --steps steps.txt\n\n\
                  Exit status: 0 plotted; 1 nothing that can be plotted, or with --strict any error or point outside of the \
                  area; 2 wrong options.\n\n\
                  In a checkout of the project, `cargo run --release --example stepper --` stands for `plotter stepper`."
)]
pub struct StepperCommand {
    /// Drawing in HPGL, G-code, SVG, DXF, CAMM-GL, GP-GL or the thesis' text; - is the standard input
    /// [default: a spiral, hatching and letters]
    pub(super) file: Option<PathBuf>,
    #[command(flatten)]
    pub(super) drawing: DrawingArguments,
    /// The machine's TOML file [default: machines/stepper-plotter.toml]
    #[arg(long, value_name = "FILE")]
    pub(super) machine: Option<PathBuf>,
    /// How corners are passed [default: the machine's]
    #[arg(long, value_enum)]
    pub(super) mode: Option<Mode>,
    /// Greatest distance of the pen from the drawing, mm; chooses --mode tolerance [default: the
    /// machine's]
    #[arg(long, value_name = "T", value_parser = positive, allow_negative_numbers = true)]
    pub(super) tolerance_mm: Option<f64>,
    /// Greatest distance by which --mode exact may miss a vertex, mm: what rounding has moved it by
    /// already [default: half the last digit of the file's numbers or a step, whichever is greater]
    #[arg(long, value_name = "A", value_parser = allowance, allow_negative_numbers = true)]
    pub(super) allowance_mm: Option<f64>,
    /// Limits the jerk too
    #[arg(long)]
    pub(super) s_curve: bool,
    /// Greatest speed with the pen down and up, mm/s [default: the machine's, 45 and 90]
    #[arg(long, value_name = "V", value_parser = positive, allow_negative_numbers = true)]
    pub(super) max_speed: Option<f64>,
    /// Greatest acceleration of the pen, as a vector, mm/s² [default: the machine's, 250]
    #[arg(long, value_name = "A", value_parser = positive, allow_negative_numbers = true)]
    pub(super) accel: Option<f64>,
    /// Greatest acceleration of each motor instead, mm/s²; of a belt machine mm of the belt
    #[arg(long, value_names = ["X", "Y"], num_args = 2, value_parser = positive, allow_negative_numbers = true, conflicts_with = "accel")]
    pub(super) accel_axes: Option<Vec<f64>>,
    /// Junction deviation, mm: a corner is taken at the speed of the circle that passes it at this
    /// distance [default: the machine's, 0.01]
    #[arg(long, value_name = "D", value_parser = not_negative, allow_negative_numbers = true)]
    pub(super) junction_deviation: Option<f64>,
    /// Greatest jerk, mm/s³; used with --s-curve [default: the machine's, 10000]
    #[arg(long, value_name = "J", value_parser = positive, allow_negative_numbers = true)]
    pub(super) jerk: Option<f64>,
    /// What the jerk is limited of; used with --s-curve [default: the machine's; if its file does not say,
    /// vector in the mode tolerance, path in the mode exact]
    #[arg(long, value_enum)]
    pub(super) jerk_limit: Option<Limit>,
    /// Steps per millimetre of both motors [default: the machine's, 87.58]
    #[arg(long, value_name = "N", value_parser = steps_per_mm, allow_negative_numbers = true)]
    pub(super) steps_per_mm: Option<f64>,
    /// Ignores the speeds (F, VS) in the file, which otherwise hold if they are lower than the machine's
    #[arg(long)]
    pub(super) ignore_feed: bool,
    /// Whether movements outside the machine's area are drawn or left out; there is a warning either way
    #[arg(long, value_enum, default_value = "draw")]
    pub(super) outside: Outside,
    /// Computes times and lengths from the plan alone, without its steps: the same figures in a
    /// hundredth of the time
    #[arg(long, conflicts_with_all = ["svg", "speed_plot", "steps"])]
    pub(super) estimate: bool,
    /// Writes the picture that the pen draws: true scale in mm, travel dashed, the machine's area as a
    /// frame
    #[arg(long, value_name = "F.svg")]
    pub(super) svg: Option<PathBuf>,
    /// Writes speed and acceleration over time as a chart
    #[arg(long, value_name = "F.svg")]
    pub(super) speed_plot: Option<PathBuf>,
    /// Writes the steps as text, one per line: time in us, dx, dy, pen (1 is down)
    #[arg(long, value_name = "F")]
    pub(super) steps: Option<PathBuf>,
    /// Writes all figures and diagnostics as JSON
    #[arg(long, value_name = "F.json")]
    pub(super) report: Option<PathBuf>,
    /// Stops at the first error or point outside the area, with exit status 1; notices do not count
    #[arg(long)]
    pub(super) strict: bool,
    #[command(flatten)]
    pub(super) telling: Telling,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Mode {
    /// Through every corner
    Exact,
    /// Corners rounded, and short lines joined, within the tolerance
    Tolerance,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Limit {
    /// The whole motion, in the mode tolerance: it is averaged over some hundredths of a second, which takes
    /// part of the tolerance, and time
    Vector,
    /// The motion along the path
    Path,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Outside {
    /// Draws them
    Draw,
    /// Leaves out lines that begin or end outside
    LeaveOut,
}

fn positive(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| String::from("give a number"))?;
    if (1e-3..=1e12).contains(&number) { Ok(number) } else { Err("give 0.001 or more".into()) }
}

fn not_negative(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| String::from("give a number"))?;
    if number >= 0.0 && number.is_finite() { Ok(number) } else { Err("give 0 or more".into()) }
}

fn allowance(text: &str) -> Result<f64, String> {
    let number = not_negative(text)?;
    if number <= 1000.0 { Ok(number) } else { Err("give 0 to 1000".into()) }
}

pub(super) fn steps_per_mm(text: &str) -> Result<f64, String> {
    let number = positive(text)?;
    if (0.1..=100_000.0).contains(&number) { Ok(number) } else { Err("give 0.1 to 100000".into()) }
}

impl StepperCommand {
    /// Runs the command; its help has the table of exit codes.
    #[must_use]
    pub fn run(self) -> ExitCode {
        let arguments = self;
        if arguments.mode == Some(Mode::Exact) && arguments.tolerance_mm.is_some() {
            eprintln!("stepper: --tolerance-mm does not go with --mode exact: leave one of them out");
            return ExitStatus::WrongUse.into();
        }
        run("stepper", || plot(&arguments))
    }
}
