//! The command line of `long_sheet`.

use super::course::draw_sheet;
use crate::drawings::DrawingArguments;
use crate::long_sheet::{CrossingSet, told_joints};
use crate::shared::{Telling, run};
use clap::{Parser, ValueEnum};
use std::path::PathBuf;
use std::process::ExitCode;

/// Most frames of one run: a joint of ours takes some milliseconds.
pub(super) const MOST_FRAMES: u32 = 100_000;

/// Draws a drawing of any length on a simulated sheet, frame by frame, and measures the joints; or computes
/// from recorded scans how a sheet lies after it was moved.
///
/// Recorded scans are stitch-trace/1 (one joint) or stitch-batch/1 (many). The output is a list with an
/// object for each joint: theta (rad), tx and ty (mm) of machine = R(theta) frame + t, their standard
/// deviations and the crossings that agree, or refused with the reason.
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 100,
    name = "long_sheet",
    after_help = "Examples:\n  \
                  plotter long-sheet --svg sheet.svg\n  \
                  plotter long-sheet --method published --svg published.svg\n  \
                  plotter long-sheet draft.plt --report sheet.json\n  \
                  plotter long-sheet --frames 1000 --folds 0.01 --report long.json\n  \
                  plotter long-sheet --traces joint.json --out pose.json\n  \
                  plotter long-sheet --traces joints/*.json --set paper --out published.json\n\n\
                  Exit status: 0 all frames are drawn and joined, or every file of scans was read (joints may be refused); 1 they \
                  are not, and the message says why; 2 wrong options.\n\n\
                  In a checkout of the project, `cargo run --release --example long_sheet --` stands for `plotter long-sheet`."
)]
pub struct LongSheetCommand {
    /// Drawing in HPGL, G-code, SVG, DXF, CAMM-GL, GP-GL or the thesis' text, of any length; - is the
    /// standard input [default: a textile pattern of 30 m]
    pub(super) file: Option<PathBuf>,
    #[command(flatten)]
    pub(super) drawing: DrawingArguments,
    /// The machine's TOML file [default: machines/textile-plotter.toml]
    #[arg(long, value_name = "FILE")]
    pub(super) machine: Option<PathBuf>,
    /// Number of frames; those beyond the drawing's end have marks only [default: as many as the drawing
    /// has]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_FRAMES)))]
    pub(super) frames: Option<u32>,
    /// The procedure at a frame change
    #[arg(long, value_enum, default_value = "ours")]
    pub(super) method: Method,
    /// Seed of all random errors: the paper's, the marks' and the head's
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,
    /// The x of both edges of the paper, mm. The head finds them, and the drawing goes in the middle
    /// [default: paper as wide as the head can see]
    #[arg(long, value_name = "LEFT,RIGHT", value_parser = edges, allow_hyphen_values = true)]
    pub(super) paper_edges: Option<[f64; 2]>,
    /// Fraction of the frame changes at which the paper folds, 0 to 1
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = share, allow_negative_numbers = true)]
    pub(super) folds: f64,
    /// Length of the built-in pattern, m
    #[arg(long, value_name = "M", default_value_t = 30.0, value_parser = metres, allow_negative_numbers = true, conflicts_with = "file")]
    pub(super) length_m: f64,
    /// Length of a line of the pattern's waves, mm: at 0.033 a pattern of 30 m has ten million lines
    #[arg(long, value_name = "MM", default_value_t = 1.0, value_parser = chord, allow_negative_numbers = true, conflicts_with = "file")]
    pub(super) chord_mm: f64,
    /// Writes the joints, magnified, and charts of discrepancy and drift
    #[arg(long, value_name = "F.svg")]
    pub(super) svg: Option<PathBuf>,
    /// Writes the table from above at one frame change: both frames, marks, scans and the probe for a fold
    #[arg(long, value_name = "F.svg")]
    pub(super) change: Option<PathBuf>,
    /// Number of that frame, from 1
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..), requires = "change")]
    pub(super) change_frame: u32,
    /// Writes all figures as JSON, joint by joint
    #[arg(long, value_name = "F.json")]
    pub(super) report: Option<PathBuf>,
    /// Files of recorded scans, in place of a drawing
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with_all = ["file", "frames", "method", "svg", "change", "report", "machine", "paper_edges"])]
    traces: Vec<PathBuf>,
    /// Method that is applied to the traces, and the crossings that it uses
    #[arg(long, value_enum, default_value = "strip16", requires = "traces")]
    set: Set,
    /// File for the list of joints of the traces; - is the standard output
    #[arg(long, value_name = "F.json", default_value = "-", requires = "traces")]
    out: PathBuf,
    #[command(flatten)]
    pub(super) telling: Telling,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Set {
    /// The three crossings of the published procedure, by the published method
    Paper,
    /// Sixteen crossings in the strip that can still be reached, by ours
    Strip16,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Method {
    /// Four scans at 0.3 m/s, as published
    Published,
    /// Sixteen crossings in the strip that stays in reach, and the paper's edge
    Ours,
}

fn in_range(text: &str, least: f64, most: f64) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| String::from("give a number"))?;
    if (least..=most).contains(&number) { Ok(number) } else { Err(format!("give {least} to {most}")) }
}

fn edges(text: &str) -> Result<[f64; 2], String> {
    let numbers: Vec<f64> = text
        .split(',')
        .map(|number| number.trim().parse().map_err(|_| String::from("give two numbers, as 300,1500")))
        .collect::<Result<_, _>>()?;
    match numbers[..] {
        [left, right] if left.is_finite() && right.is_finite() && left < right => Ok([left, right]),
        _ => Err("give two numbers, the smaller one first, as 300,1500".into()),
    }
}

fn share(text: &str) -> Result<f64, String> {
    in_range(text, 0.0, 1.0)
}

fn metres(text: &str) -> Result<f64, String> {
    in_range(text, 0.1, 10_000.0)
}

fn chord(text: &str) -> Result<f64, String> {
    in_range(text, 0.001, 100.0)
}

impl LongSheetCommand {
    /// Runs the command; its help has the table of exit codes.
    #[must_use]
    pub fn run(self) -> ExitCode {
        let arguments = self;
        run("long_sheet", || {
            if arguments.traces.is_empty() {
                return draw_sheet(&arguments);
            }
            let set = match arguments.set {
                Set::Paper => CrossingSet::Paper,
                Set::Strip16 => CrossingSet::Strip16,
            };
            told_joints(&arguments.traces, set, &arguments.out, arguments.telling)
        })
    }
}
