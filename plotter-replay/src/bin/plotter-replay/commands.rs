//! The three commands.

use clap::{Args, Subcommand};
use plotter_motion::{ControllerChoice, Machine, MachineConfig, PlotOp, hpgl};
use plotter_replay::log::{self, Damage, Event, FileReader, Header, Record, Summary};
use plotter_replay::{
    Canvas, CanvasStyle, Chart, EdgeSource, Layer, MachineController, Outcome, Player, PlayerSettings,
    PlotterSettings, VirtualPlotter, Visibility, Ways,
};
use std::io::{Read as _, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Longest list of damage or anomalies that is shown.
const MOST_SHOWN: usize = 20;
/// Longest drawing that is read, bytes: some ten million lines.
const MOST_DRAWING_BYTES: u64 = 256 << 20;
/// Longest machine file that is read, bytes; a good one has a few thousand.
const MOST_MACHINE_BYTES: u64 = 1 << 20;
/// Time by which an answer may be off when the edges are only known from the pulses.
const PULSE_TOLERANCE: Duration = Duration::from_millis(50);

/// What was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Nothing wrong.
    Clean,
    /// Damage or a difference.
    Found,
}

impl Verdict {
    fn of(summary: Summary) -> Self {
        if summary.is_clean() { Self::Clean } else { Self::Found }
    }
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Draw what the motors did, desired beside actual, and their response over time.
    #[command(after_help = "Example: plotter-replay render session.plog -o pictures\n\
        writes pictures/plotted.svg, pictures/plotted.png and pictures/response.svg")]
    Render(Render),
    /// Run the controller again on the recorded bytes and edges and compare every answer and its time.
    #[command(after_help = "Example: plotter-replay check session.plog --machine semi-virtual-gantry.toml")]
    Check(Check),
    /// Say what a log holds, and what of it is damaged or odd.
    #[command(after_help = "Example: plotter-replay info session.plog.gz")]
    Info {
        /// The log; packed if its name ends in .gz.
        log: PathBuf,
    },
}

#[derive(Debug, Args)]
pub(crate) struct Render {
    /// The log; packed if its name ends in .gz.
    log: PathBuf,
    /// Write plotted.svg, plotted.png and response.svg into this directory [default: the current one, unless
    /// a single picture is asked for].
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the drawing as SVG.
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Write the drawing as PNG.
    #[arg(long, value_name = "FILE")]
    png: Option<PathBuf>,
    /// Write the response of both motors as SVG.
    #[arg(long, value_name = "FILE")]
    chart: Option<PathBuf>,
    /// The drawing that was sent, HPGL: tells the pen, and what should have been drawn.
    #[arg(long, value_name = "FILE.hpgl")]
    drawing: Option<PathBuf>,
    /// Show the moves with the pen up, too.
    #[arg(long)]
    travel: bool,
    /// Longer side of the PNG, pixels.
    #[arg(long, value_name = "PX", default_value_t = 1_600, value_parser = clap::value_parser!(u32).range(64..=8192))]
    size: u32,
}

#[derive(Debug, Args)]
pub(crate) struct Check {
    /// The log; packed if its name ends in .gz.
    log: PathBuf,
    /// The machine's description [default: the semi-virtual gantry, with the controller that the log's header
    /// names].
    #[arg(long, value_name = "FILE.toml")]
    machine: Option<PathBuf>,
    /// How far the time of an answer may be off, microseconds [default: 0, or 50000 for a log without edges].
    #[arg(long, value_name = "US")]
    tolerance_us: Option<u64>,
}

type Done = Result<Verdict, String>;

impl Command {
    /// Does it.
    ///
    /// # Errors
    ///
    /// One line that says what cannot be read or written.
    pub(crate) fn run(self, out: &mut impl Write) -> Done {
        match self {
            Self::Render(render) => render.run(out),
            Self::Check(check) => check.run(out),
            Self::Info { log } => info(&log, out),
        }
    }
}

/// Prints a line; what could not be printed is told at the end, by `main`.
fn say(out: &mut impl Write, line: &str) {
    let _ = writeln!(out, "{line}");
}

fn say_first<T: ToString>(out: &mut impl Write, list: &[T], count: u64) {
    for one in list.iter().take(MOST_SHOWN) {
        say(out, &format!("  {}", one.to_string()));
    }
    let more = count.saturating_sub(MOST_SHOWN as u64);
    if more > 0 {
        say(out, &format!("  and {more} more"));
    }
}

fn open(path: &Path) -> Result<FileReader, String> {
    log::open(path).map_err(|error| format!("{}: {error}", path.display()))
}

/// Everything in a log, one record after the other.
struct Contents {
    header: Header,
    summary: Summary,
    damage: Vec<Damage>,
}

fn read(path: &Path, mut take: impl FnMut(&Record)) -> Result<Contents, String> {
    let mut reader = open(path)?;
    let mut damage = Vec::new();
    for item in reader.by_ref() {
        match item {
            Ok(record) => take(&record),
            Err(one) if damage.len() < MOST_SHOWN => damage.push(one),
            Err(_) => {}
        }
    }
    Ok(Contents { header: reader.header().clone(), summary: reader.summary(), damage })
}

fn plotter_for(path: &Path) -> Result<VirtualPlotter, String> {
    let settings = PlotterSettings::from_header(open(path)?.header())
        .map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(VirtualPlotter::new(settings))
}

fn say_damage(out: &mut impl Write, contents: &Contents) {
    say(out, &contents.summary.to_string());
    say_first(out, &contents.damage, contents.summary.damaged_lines);
}

fn info(path: &Path, out: &mut impl Write) -> Done {
    let mut plotter = plotter_for(path)?;
    let mut counts: [(&str, u64); 9] = [
        ("host bytes", 0),
        ("controller bytes", 0),
        ("edges", 0),
        ("duty cycles", 0),
        ("switches", 0),
        ("emergency stops", 0),
        ("pen", 0),
        ("targets taken", 0),
        ("notes", 0),
    ];
    let contents = read(path, |record| {
        let (place, amount) = match &record.event {
            Event::Host(bytes) => (0, bytes.len() as u64),
            Event::Controller(bytes) => (1, bytes.len() as u64),
            Event::Edge { .. } => (2, 1),
            Event::Drive { .. } => (3, 1),
            Event::Switch { .. } => (4, 1),
            Event::Estop(_) => (5, 1),
            Event::Pen(_) => (6, 1),
            Event::Target { .. } => (7, 1),
            _ => (8, 1),
        };
        if let Some((_, count)) = counts.get_mut(place) {
            *count = count.saturating_add(amount);
        }
        plotter.push(record);
    })?;
    plotter.finish();
    say(out, &path.display().to_string());
    for (key, value) in contents.header.entries() {
        say(out, &format!("  {key}: {value}"));
    }
    say_damage(out, &contents);
    if let (Some(first), Some(last)) = (contents.summary.first, contents.summary.last) {
        let seconds = last.saturating_sub(first).as_secs_f64();
        say(out, &format!("duration: {seconds:.6} s, from {} us", first.as_micros()));
    }
    for (name, count) in counts.iter().filter(|&&(_, count)| count > 0) {
        say(out, &format!("{name}: {count}"));
    }
    say(out, &format!("targets: {} sent, {} reached", plotter.target_count(), plotter.reached_count()));
    let (at, counted) = (plotter.position(), plotter.raw_counts());
    say(out, &format!("ends at ({:.3}, {:.3}) mm, counted ({}, {})", at.x, at.y, counted.x, counted.y));
    let error = plotter.contour_error(Ways::Drawn);
    if error.samples > 0 {
        say(out, &format!("contour error: rms {:.4} mm, max {:.4} mm", error.rms_mm, error.max_mm));
    }
    say(out, &format!("anomalies: {}", plotter.anomaly_count()));
    say_first(out, plotter.anomalies(), plotter.anomaly_count());
    Ok(Verdict::of(contents.summary))
}

impl Render {
    fn run(self, out: &mut impl Write) -> Done {
        let mut plotter = plotter_for(&self.log)?;
        let mut verdict = Verdict::Clean;
        let drawing = match &self.drawing {
            None => None,
            Some(path) => {
                let (ops, errors) = read_drawing(path)?;
                if !errors.is_empty() {
                    verdict = Verdict::Found;
                    say(out, &format!("{}: {} errors, left out", path.display(), errors.len()));
                    say_first(out, &errors, errors.len() as u64);
                }
                plotter = plotter.with_drawing(ops.iter().copied());
                Some(ops)
            }
        };
        let contents = read(&self.log, |record| plotter.push(record))?;
        plotter.finish();
        let single = self.svg.is_some() || self.png.is_some() || self.chart.is_some();
        let directory = self.out.clone().or_else(|| (!single).then(|| PathBuf::from(".")));
        let places = |one: &Option<PathBuf>, name: &str| {
            let in_directory = directory.as_ref().map(|directory| directory.join(name));
            one.clone().into_iter().chain(in_directory).collect::<Vec<_>>()
        };
        if let Some(directory) = &directory {
            std::fs::create_dir_all(directory).map_err(|error| cannot("written", directory, &error))?;
        }
        let mut canvas = Canvas::from_plotter(&plotter, CanvasStyle::default().tolerance_mm);
        if let Some(ops) = drawing {
            canvas.remove(Layer::Desired);
            canvas.add_drawing(Layer::Desired, ops);
        }
        let travel = if self.travel { Visibility::Shown } else { Visibility::Hidden };
        let style = CanvasStyle { travel, longest_px: self.size, ..canvas.fitted_style() };
        let mut write = |path: &Path, bytes: &[u8]| -> Result<(), String> {
            std::fs::write(path, bytes).map_err(|error| cannot("written", path, &error))?;
            say(out, &format!("wrote {}", path.display()));
            Ok(())
        };
        for path in places(&self.svg, "plotted.svg") {
            write(&path, canvas.to_svg(&style).as_bytes())?;
        }
        let pngs = places(&self.png, "plotted.png");
        #[cfg(feature = "image")]
        for path in pngs {
            write(&path, &canvas.to_png(&style).map_err(|error| error.to_string())?)?;
        }
        #[cfg(not(feature = "image"))]
        if self.png.is_some() && !pngs.is_empty() {
            return Err(String::from("--png: this program was built without the feature image"));
        }
        let title = self.log.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        for path in places(&self.chart, "response.svg") {
            write(&path, Chart::response(&title, &plotter).to_svg().as_bytes())?;
        }
        if canvas.lines(Layer::Ink).next().is_none() {
            say(out, "nothing was drawn");
        }
        say_damage(out, &contents);
        Ok(if verdict == Verdict::Found { verdict } else { Verdict::of(contents.summary) })
    }
}

fn cannot(be: &str, path: &Path, error: &std::io::Error) -> String {
    format!("{}: cannot be {be}: {error}", path.display())
}

/// All of a file, if it has at most `most_bytes`: a device may go on for ever.
fn read_file(path: &Path, most_bytes: u64) -> Result<Vec<u8>, String> {
    let refused = |error: std::io::Error| cannot("read", path, &error);
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(refused)?;
    file.take(most_bytes.saturating_add(1)).read_to_end(&mut bytes).map_err(refused)?;
    if bytes.len() as u64 > most_bytes {
        return Err(format!("{}: longer than {} MiB", path.display(), most_bytes >> 20));
    }
    Ok(bytes)
}

/// The operations of a drawing and what of it could not be read.
fn read_drawing(path: &Path) -> Result<(Vec<PlotOp>, Vec<hpgl::Error>), String> {
    let text = read_file(path, MOST_DRAWING_BYTES)?;
    let (mut ops, mut errors) = (Vec::new(), Vec::new());
    for outcome in hpgl::plot_ops(&text) {
        match outcome {
            Ok(op) => ops.push(op),
            Err(error) if error.is_notice() => {}
            Err(error) => errors.push(error),
        }
    }
    Ok((ops, errors))
}

impl Check {
    fn run(self, out: &mut impl Write) -> Done {
        let mut has_edges = false;
        let contents = read(&self.log, |record| has_edges |= matches!(record.event, Event::Edge { .. }))?;
        if let Some(protocol) = contents.header.text("protocol").filter(|&protocol| protocol != "digits") {
            return Err(format!(
                "{}: its protocol is {protocol:?}, and only a controller that was led by the one called digits can be run \
                 again; `render` shows what it did",
                self.log.display()
            ));
        }
        let machine = self.machine(&contents.header)?;
        let edges = if has_edges { EdgeSource::Records } else { EdgeSource::Pulses };
        let usual = if has_edges { Duration::ZERO } else { PULSE_TOLERANCE };
        let tolerance = self.tolerance_us.map_or(usual, Duration::from_micros);
        let settings = PlayerSettings { edges, tolerance, ..PlayerSettings::from_header(&contents.header) };
        if !has_edges {
            say(
                out,
                &format!(
                    "no edges in the log: taken from the pulses, times within {} us, pulses not compared",
                    tolerance.as_micros()
                ),
            );
        }
        say_damage(out, &contents);
        let records = open(&self.log)?.filter_map(Result::ok);
        let outcome = Player::new(settings).check(records, MachineController::new(&machine));
        say(out, &outcome.to_string());
        Ok(match outcome {
            Outcome::Equal(_) => Verdict::of(contents.summary),
            Outcome::FirstDifference(_) => Verdict::Found,
        })
    }

    fn machine(&self, header: &Header) -> Result<Machine, String> {
        if let Some(path) = &self.machine {
            let refused = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
            let text = String::from_utf8(read_file(path, MOST_MACHINE_BYTES)?)
                .map_err(|error| refused(&error.utf8_error()))?;
            return Machine::from_toml(&text).map_err(|error| refused(&error));
        }
        let mut config = MachineConfig::default();
        match header.text("controller") {
            None => {}
            Some("published") => config.control.controller = ControllerChoice::Published,
            Some("contouring") => config.control.controller = ControllerChoice::Contouring,
            Some(other) => {
                return Err(format!(
                    "{}: header key controller: expected published or contouring, found {other:?}; give --machine",
                    self.log.display()
                ));
            }
        }
        Machine::new(config).map_err(|error| error.to_string())
    }
}
