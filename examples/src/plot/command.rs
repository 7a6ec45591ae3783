//! The command line of `plot`, and its course.

use super::figures::Summary;
use super::pictures::Pictures;
use super::recording::{record, replay};
use crate::shared::{
    IN_MACHINE_FILE, PaperOption, SizeOptions, Telling, at, doubted, fit_picture, html_page, lost_ink,
    read_file, run, told_ink, told_notes, vectorized, write_file,
};
use clap::{Parser, ValueEnum};
use plotter_motion::config::DcConfig;
use plotter_motion::{
    Machine, MachineConfig, PenMove, PlotOp,
    config::{ControllerChoice, MachineKind},
    firmware::MarkingBoardSettings,
    hpgl,
    toolpath::{OutOfReach, targets},
};
use plotter_replay::compare::Ways;
use plotter_vector::{
    Drawing, Ours, Scale, TracedSheet, Vectorizer,
    picture::FileNotes,
    trace::VectorizeConfig,
    trace::{Prefer, SheetErrors},
};
use std::fmt::Write as _;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Draws a picture on a simulated pen plotter and shows what its motors did.
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 100,
    name = "plot",
    after_help = "Examples:\n  plotter plot\n  \
                  plotter plot scan.png --controller published --out target/published\n  \
                  plotter plot --algorithm published --controller published\n  \
                  plotter plot scan.png --machine examples/machines/marking-board.toml\n  \
                  plotter plot --firmware qemu\n  \
                  plotter plot scan.png --firmware /dev/ttyUSB0\n\n\
                  In a checkout of the project, `cargo run --release --example plot --` stands for `plotter plot`."
)]
pub struct PlotCommand {
    /// PNG, JPEG, TIFF, WebP, BMP, GIF, PBM, PGM or PPM picture; without one, a flag as line art
    image: Option<PathBuf>,
    /// The machine's TOML file; its table [vectorize] holds for our vectorization [default: the
    /// semi-virtual gantry]
    #[arg(long, value_name = "FILE")]
    pub(super) machine: Option<PathBuf>,
    /// The controller, in place of the one in the machine's file
    #[arg(long)]
    controller: Option<ControllerArg>,
    /// The vectorization; the published one is for lines one pixel wide and draws the wider lines of a
    /// scan two or three times
    #[arg(long, default_value = "ours")]
    algorithm: AlgorithmArg,
    #[command(flatten)]
    size: SizeOptions,
    #[command(flatten)]
    paper: PaperOption,
    /// Number of the picture in a TIFF with several, from 1
    #[arg(long, value_name = "N", default_value_t = 1)]
    page: u32,
    /// Plots with a firmware instead of the simulated machine: `qemu` for the one in examples/firmware, in
    /// the emulator, or the serial port of a machine that speaks the published protocol or the reliable link
    #[arg(long, value_name = "qemu|PORT")]
    pub(super) firmware: Option<String>,
    /// Protocol for a machine on a port
    #[arg(long, value_name = "auto|digits", default_value = "auto")]
    pub(super) link: LinkArg,
    /// The firmware for --firmware qemu [default: the gantry's, as built in examples/firmware]
    #[arg(long, value_name = "ELF", requires = "firmware")]
    pub(super) elf: Option<PathBuf>,
    /// Records the duty of the motors too; the recording is twice as long
    #[arg(long)]
    pub(super) record_drive: bool,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "target/plot")]
    pub(super) out: PathBuf,
    #[command(flatten)]
    pub(super) telling: Telling,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ControllerArg {
    /// PID line tracking as in the thesis
    Published,
    /// A planned speed, errors along and across the line
    Contouring,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub(super) enum LinkArg {
    /// The reliable link if the machine knows it, else the ten digits. The machine must stand at its
    /// origin
    Auto,
    /// The published ten digits
    Digits,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum AlgorithmArg {
    /// Ordered tracking, pre-elimination and dynamic threshold, as in the thesis
    Published,
    /// Fewest vertices within a promised error
    Ours,
}

/// The one name that `--firmware` does not take as a port's.
pub(super) const EMULATED: &str = "qemu";

impl PlotCommand {
    /// Runs the command; its help has the table of exit codes.
    #[must_use]
    pub fn run(self) -> ExitCode {
        run("plot", || plot(&self))
    }
}

pub(super) fn plot(args: &PlotCommand) -> Result<(), String> {
    let began = Instant::now();
    let (machine, vectorize) = machine(args)?;
    let Plan { vectorizer, traced, scale, told } = trace(args, &machine, &vectorize)?;
    std::fs::create_dir_all(&args.out)
        .map_err(|error| at(&args.out, &format!("this folder cannot be made: {error}")))?;
    let file = |name: &str| args.out.join(name);

    let moves = moves(args, &machine, &traced.drawing, scale)?;
    let log_file = file("session.plog");
    let outcome = record(args, &machine, moves, &log_file)?;
    // From here on, the recording is all there is.
    let plotter = replay(&log_file)?;

    let errors = traced.errors.clone().unwrap_or_default();
    let pictures = Pictures::new(&traced.drawing, &errors.report, &promises(&vectorizer), &plotter)?;
    pictures.write(&args.out)?;
    let summary = Summary {
        drawing: &traced.drawing,
        errors: &errors,
        kept: vectorizer.ours().map(|ours| is_kept(ours, &traced, &errors)),
        dirt: traced.removed,
        outcome: &outcome,
        plotted: plotter.contour_error(Ways::Drawn),
        anomalies: plotter.anomaly_count(),
        wall_s: began.elapsed().as_secs_f64(),
        told,
    };
    write_file(&file("report.json"), summary.json())?;
    let table = summary.table();
    let introduction = format!(
        "A picture, vectorized with the {} algorithm and drawn by the {} {} with the {} controller.",
        name(&args.algorithm),
        match args.firmware.as_deref() {
            None => "simulated",
            Some(EMULATED) => "emulated",
            Some(_) => "real",
        },
        machine.config().name,
        controller_name(&machine)
    );
    write_file(&file("report.html"), html_page("Plot report", &introduction, &table, &pictures.figures()))?;

    let mut text = String::new();
    for (name, value) in &table {
        let _ = writeln!(text, "{name:28} {value:>22}");
    }
    for notice in &outcome.notices {
        let _ = writeln!(text, "noticed at {notice}");
    }
    let said = format!("{text}look at {}\n", file("report.html").display());
    args.telling.tell(&said, || Ok(summary.json()))?;
    if outcome.reached < outcome.targets {
        let missed = outcome.targets - outcome.reached;
        eprintln!("warning: {missed} of {} targets were not reached", outcome.targets);
    }
    lost_ink(&vectorizer, &errors, traced.pen_px, traced.look.is_some())
        .map_err(|error| at(picture_path(args), &error))
}

/// Whether all ink is drawn within the greatest error, and nothing else.
fn is_kept(ours: &Ours, traced: &TracedSheet, errors: &SheetErrors) -> bool {
    traced.removed.removed_marks == 0
        && traced.look.is_none_or(|look| look.left_out == 0)
        && errors.are_within(ours.tolerance_px)
}

/// Moves of the machine; the files of the drawing are written meanwhile.
fn moves(
    args: &PlotCommand,
    machine: &Machine,
    drawing: &Drawing,
    scale: Scale,
) -> Result<Vec<PenMove>, String> {
    // The drawing goes through the plotter's own language, so what is plotted is what the file says.
    let mut text = String::new();
    plotter_vector::hpgl(drawing, scale, &mut text).map_err(|error| error.to_string())?;
    write_file(&args.out.join("drawing.hpgl"), &text)?;
    let ops: Vec<PlotOp> =
        hpgl::plot_ops(text.as_bytes()).collect::<Result<_, _>>().map_err(|error| error.to_string())?;
    let moves: Result<Vec<PenMove>, OutOfReach> = if machine.kind() == MachineKind::Belt {
        MarkingBoardSettings::of(machine).moves(ops).collect()
    } else {
        targets(machine, ops).collect()
    };
    moves.map_err(|error| error.to_string())
}

pub(super) fn controller_name(machine: &Machine) -> &'static str {
    match DcConfig::of(machine).control.controller {
        ControllerChoice::Published => "published",
        _ => "contouring",
    }
}

pub(super) fn name(value: &impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

/// The machine, and how pictures become strokes for it.
pub(super) fn machine(args: &PlotCommand) -> Result<(Machine, VectorizeConfig), String> {
    let (mut config, vectorize) = match &args.machine {
        Some(path) => {
            let text = String::from_utf8(read_file(path)?)
                .map_err(|error| at(path, &format!("this is not a text file: {error}")))?;
            let (machine, vectorize) = Machine::from_toml_with(&text).map_err(|error| at(path, &error))?;
            let refusal = match (machine.kind(), &args.firmware) {
                (MachineKind::Steppers, _) => Some(("plot", "plan for this one with the example `stepper`")),
                (MachineKind::Belt, Some(_)) => {
                    Some(("--firmware", "leave --firmware out to simulate this one"))
                }
                (MachineKind::Gantry, _) | (MachineKind::Belt, None) => None,
            };
            if let Some((user, instead)) = refusal {
                machine
                    .require(MachineKind::Gantry, user)
                    .map_err(|error| at(path, &format!("{error}; or {instead}")))?;
            }
            (*machine.config(), vectorize)
        }
        None => (MachineConfig::default(), VectorizeConfig::default()),
    };
    let controller = match args.controller {
        Some(ControllerArg::Published) => Some(ControllerChoice::Published),
        Some(ControllerArg::Contouring) => Some(ControllerChoice::Contouring),
        None => None,
    };
    if let (Some(dc), Some(controller)) = (config.dc_mut(), controller) {
        dc.control.controller = controller;
    }
    let machine = Machine::new(config).map_err(|error| error.to_string())?;
    Ok((machine, vectorize))
}

fn picture_path(args: &PlotCommand) -> &Path {
    args.image.as_deref().unwrap_or(Path::new("flag.png"))
}

/// The strokes of a picture, and their place on the sheet.
struct Plan {
    vectorizer: Vectorizer,
    traced: TracedSheet,
    scale: Scale,
    /// Facts taken from the file or assumed.
    told: Vec<(&'static str, String)>,
}

fn trace(args: &PlotCommand, machine: &Machine, vectorize: &VectorizeConfig) -> Result<Plan, String> {
    let mut bytes = match &args.image {
        Some(path) => read_file(path)?,
        None => include_bytes!("../../data/flag.png").to_vec(),
    };
    let path = picture_path(args);
    let mut notes = FileNotes::read(Cursor::new(&bytes), args.page).map_err(|error| at(path, &error))?;
    let (mut asked, mut page, mut paper) = (args.size, args.page, None);
    // A sheet that is asked for and not found would be drawn as nobody meant it: nothing is drawn.
    let straightened = args.paper.straightened(&bytes, page, false, &asked);
    if let Some(found) = straightened.map_err(|error| at(path, &error.told()))? {
        (asked, page) = (found.paper.sized(&asked), 1);
        (bytes, notes, paper) = (found.file, found.notes, Some(found.paper));
    }
    let (scale, size) = fit_picture(&notes, &asked, machine)?;
    let mut vectorizer = match args.algorithm {
        AlgorithmArg::Published => Vectorizer::published(),
        // One pen, whatever the file says: this machine has no carousel.
        AlgorithmArg::Ours => vectorize.vectorizer(scale.mm_per_px()).map_err(|error| error.to_string())?,
    };
    // A photograph's rims are ragged, in even light, too: ink that is bare there is worth no stroke.
    if paper.is_some()
        && let Some(ours) = vectorizer.ours_mut()
    {
        ours.prefer = Prefer::Strokes;
    }
    let (traced, read) = vectorized(&vectorizer, bytes, page).map_err(|error| at(path, &error))?;
    doubted(traced.doubt, IN_MACHINE_FILE).map_err(|error| at(path, &error))?;
    let mut told = vec![("size", size)];
    told.extend(told_notes(if paper.is_some() { &notes } else { &read }));
    if let Some(paper) = paper {
        told.extend(paper.told());
        told.extend(paper.told_ends(&traced.drawing, traced.pen_px));
    }
    told.extend(told_ink(traced.look, traced.split));
    Ok(Plan { vectorizer, traced, scale, told })
}

/// Notes on the chart of the errors: the thesis' figures, or the bound that ours promises.
pub(super) fn promises(vectorizer: &Vectorizer) -> Vec<String> {
    match vectorizer.ours() {
        None => vec![
            "published: flag mean 0.0991, max 2.0392, sd 0.2435 px;".into(),
            "technical drawing mean 0.0042, max 0.5547, sd 0.0386 px".into(),
        ],
        Some(ours) => vec![format!("promised: {} px at most", ours.tolerance_px)],
    }
}
