//! A drawing longer than the table: frame by frame on a sheet that walks, turns and never stops where it should.
//!
//! The drawing is divided into frames, a simulated machine draws them one after the other, and between two of them the paper moves on
//! and an optical head looks for the lines of the frame before, as published or with ours. What is left at the joints is
//! measured where lines really go over them.
//!
//! With `--traces` nothing is simulated: the scans over the marks of real joints are in files, and how the sheet lay is told, with how sure
//! that is, or refused where dust was taken for marks or too few are left.
//!
//! Look at the magnified joints (`--svg`): with `--method published` lines miss each other by half of the pen's width, with ours by a
//! few hundredths of a millimetre. Then at the drift: nothing in the joints holds the sheet straight but the paper's edge.
//!
//! ```text
//! cargo run --release --example long_sheet -- --svg sheet.svg
//! cargo run --release --example long_sheet -- --method published --svg published.svg
//! cargo run --release --example long_sheet -- draft.plt --report sheet.json
//! cargo run --release --example long_sheet -- --frames 1000 --report long.json
//! cargo run --release --example long_sheet -- --traces joint1.json joint2.json --out joints.json
//! ```

use clap::{Parser, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use plotter_examples::drawings::{
    Arrangement, Diagnostics, DrawingFile, Language, PenLines, Reading, Severity, SvgReading,
};
use plotter_examples::long_sheet::{
    CrossingSet, JointFigures, LongSheetMachine, LongSheetReport, LongSheetRun, TextilePattern,
    long_sheet_svg, told_joints,
};
use plotter_examples::shared::{at, print, read_file, run, write_file};
use plotter_motion::{Machine, MachineConfig, PlotOp, config::MachineKind};
use plotter_stitch::{sheet::JoinFrames, split::FramePasses};
use std::path::PathBuf;
use std::process::ExitCode;

/// Most frames of one run: a joint of ours takes some milliseconds.
const MOST_FRAMES: u32 = 100_000;

/// Draws a drawing of any length on a simulated sheet, frame by frame, and measures the joints; or tells from recorded scans how a
/// sheet lies between two frames.
///
/// Recorded scans are stitch-trace/1 (one joint) and stitch-batch/1 (many). Of them a list is written with an object for each
/// joint: theta (rad), tx and ty (mm) of machine = R(theta) frame + t, their standard deviations and the crossings that agree, or
/// refused with the reason.
#[derive(Debug, Parser)]
#[command(
    name = "long_sheet",
    after_help = "Examples:\n  \
                  long_sheet --svg sheet.svg\n  \
                  long_sheet --method published --svg published.svg\n  \
                  long_sheet draft.plt --report sheet.json\n  \
                  long_sheet --frames 1000 --folds 0.01 --report long.json\n  \
                  long_sheet --traces joint.json --out pose.json\n  \
                  long_sheet --traces joints/*.json --set paper --out published.json\n\n\
                  Exit status: 0 all frames are drawn and joined, or every file of scans was read (joints may be refused); 1 they \
                  are not, and the message says why; 2 wrong options."
)]
struct Arguments {
    /// Drawing in HPGL, G-code, SVG, DXF, CAMM-GL, GP-GL or the thesis' text, of any length; - is the standard input [default: a
    /// textile pattern of 30 m]
    file: Option<PathBuf>,
    /// What the file is written in [default: told by its contents]
    #[arg(long, value_enum)]
    language: Option<Language>,
    /// Size of a step in CAMM-GL and GP-GL, or of the unit of a DXF, mm: 25.4 for inches [default: 0.025, 0.1, Silhouette's 0.05; what
    /// the DXF says, else 1]
    #[arg(long, value_name = "S", value_parser = step, allow_negative_numbers = true)]
    step_mm: Option<f64>,
    #[command(flatten)]
    svg_reading: SvgReading,
    #[command(flatten)]
    arrangement: Arrangement,
    #[command(flatten)]
    pen_lines: PenLines,
    /// The machine's TOML file [default: machines/textile-plotter.toml]
    #[arg(long, value_name = "FILE")]
    machine: Option<PathBuf>,
    /// Frames to draw; beyond the drawing's end they stay blank, but for their marks [default: as many as the drawing has]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_FRAMES)))]
    frames: Option<u32>,
    /// The procedure at a frame change
    #[arg(long, value_enum, default_value = "ours")]
    method: Method,
    /// Seed of the paper, its marks and the head
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Paper of that width somewhere on the table: the x of both edges, mm. The head finds it, and the
    /// drawing goes in its middle [default: as wide as the head can see]
    #[arg(long, value_name = "LEFT,RIGHT", value_parser = edges, allow_hyphen_values = true)]
    paper_edges: Option<[f64; 2]>,
    /// Share of the frame changes at which the paper folds
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = share, allow_negative_numbers = true)]
    folds: f64,
    /// Length of the built-in pattern, m
    #[arg(long, value_name = "M", default_value_t = 30.0, value_parser = metres, allow_negative_numbers = true, conflicts_with = "file")]
    length_m: f64,
    /// Length of the lines of its waves, mm: 0.033 makes ten million of 30 m
    #[arg(long, value_name = "MM", default_value_t = 1.0, value_parser = chord, allow_negative_numbers = true, conflicts_with = "file")]
    chord_mm: f64,
    /// Writes the joints, magnified, and charts of discrepancy and drift
    #[arg(long, value_name = "F.svg")]
    svg: Option<PathBuf>,
    /// Writes the table from above at one frame change: both frames, marks, scans and the probe for a fold
    #[arg(long, value_name = "F.svg")]
    change: Option<PathBuf>,
    /// The frame whose change that is, from 1
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..), requires = "change")]
    change_frame: u32,
    /// Writes all figures as JSON, joint by joint
    #[arg(long, value_name = "F.json")]
    report: Option<PathBuf>,
    /// Recorded scans, in place of a drawing
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with_all = ["file", "frames", "method", "svg", "change", "report", "machine", "paper_edges"])]
    traces: Vec<PathBuf>,
    /// Which crossings of the traces are used, and by which method
    #[arg(long, value_enum, default_value = "strip16", requires = "traces")]
    set: Set,
    /// Where the list of their joints is written; - is the standard output
    #[arg(long, value_name = "F.json", default_value = "-", requires = "traces")]
    out: PathBuf,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Set {
    /// The three crossings of the published procedure, by the published method
    Paper,
    /// Sixteen crossings in the strip that can still be reached, by ours
    Strip16,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Method {
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

fn step(text: &str) -> Result<f64, String> {
    in_range(text, 1e-6, 1e6)
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    run("long_sheet", || {
        if arguments.traces.is_empty() {
            return draw_sheet(&arguments);
        }
        let set = match arguments.set {
            Set::Paper => CrossingSet::Paper,
            Set::Strip16 => CrossingSet::Strip16,
        };
        told_joints(&arguments.traces, set, &arguments.out)
    })
}

fn draw_sheet(arguments: &Arguments) -> Result<(), String> {
    let machine = machine(arguments)?;
    let mut sheet = LongSheetMachine::new(&machine)?;
    if let Some(edges_mm) = arguments.paper_edges {
        /// As a roll lies that was mounted by hand, rad.
        const TURN_RAD: f64 = 0.0005;
        sheet = sheet.on_paper(edges_mm, TURN_RAD, arguments.seed)?;
    }
    sheet.sheet.feed.folds = arguments.folds;
    match &arguments.file {
        None => {
            let pattern = TextilePattern {
                length_mm: 1e3 * arguments.length_m,
                width_mm: sheet.layout.width_mm,
                chord_mm: arguments.chord_mm,
            };
            let name = format!("textile pattern of {} m", arguments.length_m);
            draw(arguments, &sheet, &name, || pattern.ops())
        }
        Some(path) => {
            let drawing = DrawingFile::open(path, arguments.language)?
                .with_svg(&arguments.svg_reading)?
                .arranged(&arguments.arrangement)
                .with_pen_lines(&arguments.pen_lines)?;
            let reading = Reading { counts_per_mm: 40.0, step_mm: arguments.step_mm, ..Reading::default() };
            let mut said = Diagnostics::default();
            // Nothing is drawn of a drawing with errors: read it once before.
            for found in drawing.ops(reading)?.filter_map(Result::err) {
                if found.severity == Severity::Error {
                    return Err(format!("{}: {found}", drawing.name()));
                }
                said.push(found);
            }
            draw(arguments, &sheet, drawing.name(), || {
                drawing.ops(reading).into_iter().flatten().filter_map(Result::ok)
            })?;
            said.complain(drawing.name());
            Ok(())
        }
    }
}

fn machine(arguments: &Arguments) -> Result<Machine, String> {
    match &arguments.machine {
        Some(path) => {
            let text = String::from_utf8(read_file(path)?)
                .map_err(|error| at(path, &format!("this is not a text file: {error}")))?;
            let machine = Machine::from_toml(&text).map_err(|error| at(path, &error))?;
            machine.require(MachineKind::Steppers, "long_sheet").map_err(|error| at(path, &error))?;
            Ok(machine)
        }
        None => Machine::new(MachineConfig::textile_plotter()).map_err(|error| error.to_string()),
    }
}

fn draw<I: Iterator<Item = PlotOp>>(
    arguments: &Arguments,
    sheet: &LongSheetMachine,
    name: &str,
    drawing: impl FnMut() -> I,
) -> Result<(), String> {
    match arguments.method {
        Method::Published => {
            let mut sheet = sheet.clone();
            sheet.sheet.anchor_mm = 0.0;
            let method = sheet.published_join();
            draw_with(arguments, sheet, "published", method, name, drawing)
        }
        Method::Ours => {
            let method = sheet.strip_join();
            draw_with(arguments, sheet.clone(), "ours", method, name, drawing)
        }
    }
}

fn draw_with<M: JoinFrames, I: Iterator<Item = PlotOp>>(
    arguments: &Arguments,
    sheet: LongSheetMachine,
    method: &str,
    join: M,
    name: &str,
    drawing: impl FnMut() -> I,
) -> Result<(), String> {
    let layout = sheet.layout;
    let mut sheet = LongSheetRun::new(sheet, join, arguments.seed)?;
    let mut frames = FramePasses::new(drawing, layout);
    let bar = ProgressBar::new_spinner();
    if let Ok(style) = ProgressStyle::with_template("{spinner} frame {pos}, {elapsed}") {
        bar.set_style(style);
    }
    if arguments.change.is_some() {
        sheet.shown.0 = arguments.change_frame;
    }
    let in_file = |error: plotter_stitch::SplitError| format!("{name}: {error}");
    let first = frames.next().transpose().map_err(in_file)?;
    sheet.first(first.as_ref())?;
    drop(first);
    let mut joints: Vec<JointFigures> = Vec::new();
    let most = arguments.frames.unwrap_or(MOST_FRAMES) as usize;
    while joints.len() + 1 < most {
        let frame = frames.next().transpose().map_err(in_file)?;
        if frame.is_none() && arguments.frames.is_none() {
            break;
        }
        joints.push(sheet.next(frame.as_ref())?);
        bar.inc(1);
    }
    bar.finish_and_clear();

    let report = LongSheetReport::new(name, method, arguments.seed, layout.frame_mm, &joints, &sheet.frames);
    if let Some(path) = &arguments.svg {
        let title = format!("{name}, {method}: {:.3} mm at the worst joint", report.joint_worst_mm);
        write_file(path, long_sheet_svg(&title, &joints, &sheet.frames))?;
    }
    if let Some(path) = &arguments.change {
        let change = sheet.shown.1.as_ref().ok_or_else(|| {
            format!("--change-frame {}: the drawing has {} frames", arguments.change_frame, joints.len() + 1)
        })?;
        write_file(path, change.svg())?;
    }
    if let Some(path) = &arguments.report {
        let text = serde_json::to_string_pretty(&report).map_err(|error| error.to_string())?;
        write_file(path, text + "\n")?;
    }
    print(&report.table())
}
