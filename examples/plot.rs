//! From a scan to ink: the whole semi-virtual plotter.
//!
//! A scanned line drawing becomes strokes, the strokes become HPGL, the HPGL goes target by target over the
//! serial line to a controller that drives two simulated DC motors, and everything on that line is recorded. From the
//! recording alone a virtual plotter draws what the motors did, beside what they should have done.
//!
//! Look at `report.html` first: the drawing, the plot, both coordinates over time, and where the errors are. Then run it
//! again with `--controller published` and compare. Both the vectorization and the controller of the thesis are an option away:
//! `--algorithm published --controller published`.

use clap::{Parser, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use plotter_examples::machine::{
    BenchSwitches, PlotOutcome, Recorded, board_header, built_firmware, plot_in_emulator, simulate,
    simulate_board,
};
use plotter_examples::plot::{PortLanguage, plot_on_port};
use plotter_examples::shared::{
    Figure, at, fit_drawing, html_page, lost_ink, print, read_file, run, vectorized, vectorizer, write_file,
};
use plotter_motion::firmware::MarkingBoardSettings;
use plotter_motion::{
    Machine, MachineConfig, PenMove, PlotOp,
    config::{ControllerChoice, MachineKind},
    hpgl,
    toolpath::{OutOfReach, targets},
};
use plotter_replay::log::{self, Header};
use plotter_replay::{
    BenchRecorder, Canvas, Chart, PlotterSettings, VirtualPlotter,
    compare::{ContourError, Ways},
};
use plotter_vector::{
    Algorithm, Drawing, ErrorReport, FileRows, TracedSheet, Vectorizer,
    ink::Despeckled,
    picture::RowSource as _,
    report::{Beyond, error_chart},
    svg,
};
use serde_json::json;
use std::fmt::Write as _;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Draws a picture on a simulated pen plotter and shows what its motors did.
#[derive(Parser)]
#[command(
    name = "plot",
    after_help = "Examples:\n  cargo run --release --example plot\n  \
                  cargo run --release --example plot -- scan.png --controller published --out target/published\n  \
                  cargo run --release --example plot -- --algorithm published --controller published\n  \
                  cargo run --release --example plot -- scan.png --machine examples/machines/marking-board.toml\n  \
                  cargo run --release --example plot -- --firmware qemu\n  \
                  cargo run --release --example plot -- scan.png --firmware /dev/ttyUSB0"
)]
struct Args {
    /// PNG, JPEG, PBM or PGM picture; without one, a flag as line art
    image: Option<PathBuf>,
    /// The machine's TOML file, whose table [vectorize] ours takes too [default: the semi-virtual gantry]
    #[arg(long, value_name = "FILE")]
    machine: Option<PathBuf>,
    /// The controller, whatever the machine's file says
    #[arg(long)]
    controller: Option<ControllerArg>,
    /// The vectorization; the published one is for lines one pixel wide, and draws the wider lines of a scan two or three times
    #[arg(long, default_value = "ours")]
    algorithm: AlgorithmArg,
    /// Width of the drawing on the sheet, mm; less where the machine is smaller
    #[arg(long, value_name = "MM", default_value_t = 50.0, allow_negative_numbers = true)]
    width_mm: f64,
    /// Plots with a firmware instead of the simulated machine: `qemu` for the one in examples/firmware, in the emulator, or the
    /// serial port of a machine that speaks the published protocol or the reliable link
    #[arg(long, value_name = "qemu|PORT")]
    firmware: Option<String>,
    /// What is spoken with a machine on a port
    #[arg(long, value_name = "auto|digits", default_value = "auto")]
    link: LinkArg,
    /// The firmware for --firmware qemu [default: the gantry's, as built in examples/firmware]
    #[arg(long, value_name = "ELF", requires = "firmware")]
    elf: Option<PathBuf>,
    /// Records the duty of the motors too: twice as much
    #[arg(long)]
    record_drive: bool,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "target/plot")]
    out: PathBuf,
}

#[derive(Clone, Copy, ValueEnum)]
enum ControllerArg {
    /// PID line tracking as in the thesis
    Published,
    /// A planned speed, errors along and across the line
    Contouring,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum LinkArg {
    /// The reliable link if the machine knows it, else the ten digits; it is called at its origin
    Auto,
    /// The published ten digits
    Digits,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum AlgorithmArg {
    /// Ordered tracking, pre-elimination and dynamic threshold, as in the thesis
    Published,
    /// Fewest vertices within a promised error
    Ours,
}

/// The one name that `--firmware` does not take as a port's.
const EMULATED: &str = "qemu";

fn main() -> ExitCode {
    run("plot", || plot(&Args::parse()))
}

fn plot(args: &Args) -> Result<(), String> {
    let began = Instant::now();
    let machine = machine(args)?;
    let (vectorizer, traced) = trace(args, &machine)?;
    std::fs::create_dir_all(&args.out)
        .map_err(|error| at(&args.out, &format!("this folder cannot be made: {error}")))?;
    let file = |name: &str| args.out.join(name);

    // The drawing goes through the plotter's own language, so what is plotted is what the file says.
    let size_px = (traced.drawing.width_px(), traced.drawing.height_px());
    let scale = fit_drawing(size_px, &machine, args.width_mm)?;
    let mut text = String::new();
    plotter_vector::hpgl(&traced.drawing, scale, &mut text).map_err(|error| error.to_string())?;
    write_file(&file("drawing.hpgl"), &text)?;
    let ops: Vec<PlotOp> =
        hpgl::plot_ops(text.as_bytes()).collect::<Result<_, _>>().map_err(|error| error.to_string())?;
    let moves: Result<Vec<PenMove>, OutOfReach> = if machine.kind() == MachineKind::Belt {
        MarkingBoardSettings::of(&machine).moves(ops).collect()
    } else {
        targets(&machine, ops).collect()
    };
    let moves = moves.map_err(|error| error.to_string())?;

    let log_file = file("session.plog");
    let outcome = record(args, &machine, moves, &log_file)?;
    // From here on, the recording is all there is.
    let plotter = replay(&log_file)?;

    let errors = traced.errors.clone().unwrap_or_default();
    let pictures = Pictures::new(&traced.drawing, &errors.report, &promises(&vectorizer), &plotter)?;
    pictures.write(&args.out)?;
    let summary = Summary {
        drawing: &traced.drawing,
        error: &errors.report,
        beyond: errors.beyond,
        dirt: traced.removed,
        outcome: &outcome,
        plotted: plotter.contour_error(Ways::Drawn),
        anomalies: plotter.anomaly_count(),
        wall_s: began.elapsed().as_secs_f64(),
    };
    write_file(&file("report.json"), summary.json())?;
    let table = summary.table();
    let figures = [
        Figure::Svg(&pictures.drawing, "The strokes, in pixels of the picture"),
        Figure::Svg(
            &pictures.plotted,
            "What the motors drew (dark) on what was meant (pale), from the recording",
        ),
        Figure::Svg(
            &pictures.response,
            "Both coordinates over time, desired beside actual, and the contour error",
        ),
        Figure::Svg(&pictures.errors, "Distance of the picture's pixels from the strokes"),
        Figure::Png(&pictures.plotted_png, "The plot once more, as PNG"),
    ];
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
    write_file(&file("report.html"), html_page("Plot report", &introduction, &table, &figures))?;

    let mut text = String::new();
    for (name, value) in &table {
        let _ = writeln!(text, "{name:28} {value:>22}");
    }
    for notice in &outcome.notices {
        let _ = writeln!(text, "noticed at {notice}");
    }
    print(&format!("{text}look at {}\n", file("report.html").display()))?;
    if outcome.reached < outcome.targets {
        let missed = outcome.targets - outcome.reached;
        eprintln!("warning: {missed} of {} targets were not reached", outcome.targets);
    }
    lost_ink(&vectorizer, &errors, traced.pen_px).map_err(|error| at(picture_path(args), &error))
}

fn controller_name(machine: &Machine) -> &'static str {
    match machine.config().control.controller {
        ControllerChoice::Published => "published",
        _ => "contouring",
    }
}

fn name(value: &impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

fn machine(args: &Args) -> Result<Machine, String> {
    let mut config = match &args.machine {
        Some(path) => {
            let text = String::from_utf8(read_file(path)?)
                .map_err(|error| at(path, &format!("this is not a text file: {error}")))?;
            let machine = Machine::from_toml(&text).map_err(|error| at(path, &error))?;
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
            *machine.config()
        }
        None => MachineConfig::default(),
    };
    match args.controller {
        Some(ControllerArg::Published) => config.control.controller = ControllerChoice::Published,
        Some(ControllerArg::Contouring) => config.control.controller = ControllerChoice::Contouring,
        None => {}
    }
    Machine::new(config).map_err(|error| error.to_string())
}

fn picture_path(args: &Args) -> &Path {
    args.image.as_deref().unwrap_or(Path::new("flag.png"))
}

fn trace(args: &Args, machine: &Machine) -> Result<(Vectorizer, TracedSheet), String> {
    let bytes = match &args.image {
        Some(path) => read_file(path)?,
        None => include_bytes!("data/flag.png").to_vec(),
    };
    let path = picture_path(args);
    let vectorizer = match args.algorithm {
        AlgorithmArg::Published => Vectorizer { algorithm: Algorithm::Published, ..Vectorizer::default() },
        // One pen, whatever the file says: this machine has no carousel.
        AlgorithmArg::Ours => {
            let scan = FileRows::new(Cursor::new(&bytes)).map_err(|error| at(path, &error))?;
            let scale = fit_drawing((scan.width(), scan.height()), machine, args.width_mm)?;
            vectorizer(&machine.config().vectorize, scale.mm_per_px())?
        }
    };
    let traced = vectorized(&vectorizer, bytes).map_err(|error| at(path, &error))?;
    Ok((vectorizer, traced))
}

/// What the chart of the errors says beside them: the thesis' figures, or what ours promises.
fn promises(vectorizer: &Vectorizer) -> Vec<String> {
    match vectorizer.algorithm {
        Algorithm::Published => vec![
            "published: flag mean 0.0991, max 2.0392, sd 0.2435 px;".into(),
            "technical drawing mean 0.0042, max 0.5547, sd 0.0386 px".into(),
        ],
        Algorithm::Ours => vec![format!("promised: {} px at most", vectorizer.ours.tolerance_px)],
    }
}

/// Plots on the simulated machine, or with a firmware, and records the serial line.
fn record(args: &Args, machine: &Machine, moves: Vec<PenMove>, path: &Path) -> Result<PlotOutcome, String> {
    let config = machine.config();
    let is_real = args.firmware.as_ref().is_some_and(|firmware| firmware != EMULATED);
    let is_belt = machine.kind() == MachineKind::Belt;
    let may_be_linked = is_real && args.link == LinkArg::Auto;
    let header = if is_belt { board_header(machine) } else { line_header(machine, may_be_linked) };
    let header = header
        .with_text("machine", config.name.as_str())
        .with_text("controller", controller_name(machine))
        .with_text("clock", if is_real { "host" } else { "simulated" });
    let writer = log::create(path, &header).map_err(|error| at(path, &error))?;
    let bar = ProgressBar::new(moves.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("plotting {bar:40} {pos}/{len} targets, {elapsed}") {
        bar.set_style(style);
    }
    let mut recorder = BenchRecorder::new(writer);
    let recorded = Recorded { drive: args.record_drive };
    let progress = |reached: u32| bar.set_position(reached.into());
    let outcome = match args.firmware.as_deref() {
        None if is_belt => Ok(simulate_board(machine, moves, recorded, &mut recorder, progress)),
        None => Ok(simulate(machine, moves, recorded, &mut recorder, progress)),
        Some(EMULATED) => {
            let elf = args.elf.clone().unwrap_or_else(|| built_firmware("gantry"));
            let switches = BenchSwitches::default();
            plot_in_emulator(machine, &elf, switches, moves, recorded, &mut recorder, progress)
        }
        Some(port) => {
            let language =
                if may_be_linked { PortLanguage::Link(clock_bits()) } else { PortLanguage::Digits };
            plot_on_port(machine, port, language, moves, &mut recorder, progress)
        }
    };
    bar.finish_and_clear();
    let outcome = outcome?;
    recorder.finish().map_err(|error| at(path, &error))?;
    Ok(outcome)
}

/// Bits that are others each time.
fn clock_bits() -> u16 {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    u16::try_from(since.as_millis() & 0xffff).unwrap_or(1)
}

/// What a log says of its line: that of the published protocol, or of the reliable link.
fn line_header(machine: &Machine, may_be_linked: bool) -> Header {
    let config = machine.config();
    Header::new()
        .with_number("baud", config.serial.baud.into())
        .with_text("protocol", if may_be_linked { "link" } else { "digits" })
        .with_decimal("x_mm_per_pulse", 1.0 / config.x.counts_per_mm)
        .with_decimal("y_mm_per_pulse", 1.0 / config.y.counts_per_mm)
}

/// Draws on the virtual plotter what a recording says.
fn replay(path: &Path) -> Result<VirtualPlotter, String> {
    let mut reader = log::open(path).map_err(|error| at(path, &error))?;
    let settings = PlotterSettings::from_header(reader.header()).map_err(|error| at(path, &error))?;
    let mut plotter = VirtualPlotter::new(settings);
    for record in &mut reader {
        plotter.push(&record.map_err(|damage| at(path, &damage))?);
    }
    plotter.finish();
    Ok(plotter)
}

/// The files that show something.
struct Pictures {
    drawing: String,
    errors: String,
    plotted: String,
    plotted_png: Vec<u8>,
    response: String,
}

impl Pictures {
    fn new(
        traced: &Drawing,
        error: &ErrorReport,
        promises: &[String],
        plotter: &VirtualPlotter,
    ) -> Result<Self, String> {
        const STROKE_PX: f64 = 1.0;
        let (mut drawing, mut errors) = (String::new(), String::new());
        svg(traced, STROKE_PX, &mut drawing).map_err(|error| error.to_string())?;
        let promises: Vec<&str> = promises.iter().map(String::as_str).collect();
        error_chart(error, "Vectorization error", &promises, &mut errors)
            .map_err(|error| error.to_string())?;
        let canvas = Canvas::from_plotter(plotter, 0.002);
        let style = canvas.fitted_style();
        Ok(Self {
            drawing,
            errors,
            plotted: canvas.to_svg(&style),
            plotted_png: canvas.to_png(&style).map_err(|error| error.to_string())?,
            response: Chart::response("Response", plotter).to_svg(),
        })
    }

    fn write(&self, out: &Path) -> Result<(), String> {
        write_file(&out.join("drawing.svg"), &self.drawing)?;
        write_file(&out.join("errors.svg"), &self.errors)?;
        write_file(&out.join("plotted.svg"), &self.plotted)?;
        write_file(&out.join("plotted.png"), &self.plotted_png)?;
        write_file(&out.join("response.svg"), &self.response)
    }
}

/// All figures of a plot.
struct Summary<'a> {
    drawing: &'a Drawing,
    error: &'a ErrorReport,
    beyond: Beyond,
    dirt: Despeckled,
    outcome: &'a PlotOutcome,
    plotted: ContourError,
    anomalies: u64,
    wall_s: f64,
}

impl Summary<'_> {
    fn json(&self) -> String {
        let ErrorReport { mean_px, max_px, sd_px, .. } = *self.error;
        let report = json!({
            "vertices": self.drawing.vertices(),
            "strokes": self.drawing.strokes().len(),
            "vector_error_px": { "mean": mean_px, "max": max_px, "sd": sd_px },
            "beyond_ink": { "px": self.beyond.pixels, "max_px": self.beyond.max_px },
            "dirt": {
                "marks": self.dirt.removed_marks,
                "px": self.dirt.removed_px,
                "largest_px": self.dirt.largest_removed_px,
            },
            "contour_error_mm": { "rms": self.plotted.rms_mm, "max": self.plotted.max_mm },
            "true_contour_error_mm": { "rms": self.outcome.true_rms_mm, "max": self.outcome.true_max_mm },
            "targets": self.outcome.targets,
            "reached": self.outcome.reached,
            "anomalies": self.anomalies,
            "simulated_s": self.outcome.duration.as_secs_f64(),
            "wall_s": self.wall_s,
        });
        format!("{report:#}\n")
    }

    fn table(&self) -> Vec<(&'static str, String)> {
        let Self { error, outcome, .. } = *self;
        let Despeckled { removed_marks, largest_removed_px, .. } = self.dirt;
        let dirt = (removed_marks > 0)
            .then(|| ("marks left out as dirt", format!("{removed_marks}, up to {largest_removed_px} px")));
        let figures = vec![
            ("vertices", self.drawing.vertices().to_string()),
            ("strokes", self.drawing.strokes().len().to_string()),
            ("vector error, mean", format!("{:.4} px", error.mean_px)),
            ("vector error, max", format!("{:.4} px", error.max_px)),
            ("vector error, sd", format!("{:.4} px", error.sd_px)),
            ("drawn beyond ink, max", format!("{:.4} px", self.beyond.max_px)),
            ("contour error counted, rms", format!("{:.4} mm", self.plotted.rms_mm)),
            ("contour error counted, max", format!("{:.4} mm", self.plotted.max_mm)),
            ("contour error true, rms", known_mm(outcome.true_rms_mm)),
            ("contour error true, max", known_mm(outcome.true_max_mm)),
            ("targets reached", format!("{} of {}", outcome.reached, outcome.targets)),
            ("anomalies", self.anomalies.to_string()),
            ("time of the machine", format!("{:.2} s", outcome.duration.as_secs_f64())),
            ("wall time", format!("{:.2} s", self.wall_s)),
        ];
        figures.into_iter().chain(dirt).collect()
    }
}

fn known_mm(value: Option<f64>) -> String {
    value.map_or_else(|| String::from("only the machine knows"), |value| format!("{value:.4} mm"))
}
