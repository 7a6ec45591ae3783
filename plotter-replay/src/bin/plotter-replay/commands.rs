//! The commands, and what they share.

use crate::machine::read_machine;
use crate::render::Render;
use clap::{Args, Subcommand};
use plotter_motion::{ControllerChoice, Machine, MachineConfig};
use plotter_replay::log::{self, Damage, Event, FileReader, Header, Record, Summary};
use plotter_replay::{
    EdgeSource, MachineController, Outcome, Player, PlayerSettings, PlotterSettings, VirtualPlotter, Ways,
};
use std::io::{Read as _, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Longest list of damage or anomalies that is shown.
const MOST_SHOWN: usize = 20;
/// Longest machine file that is read, bytes; a good one has a few thousand.
pub(crate) const MOST_MACHINE_BYTES: u64 = 1 << 20;
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
    pub(crate) fn of(summary: Summary) -> Self {
        if summary.is_clean() { Self::Clean } else { Self::Found }
    }
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Draw what the motors did, desired beside actual, and their response over time.
    #[command(after_help = "Example: plotter-replay render session.plog -o pictures\n\
        writes pictures/plotted.svg, pictures/plotted.png, pictures/response.svg and pictures/recording.html, a page \
        with a time slider for any browser")]
    Render(Render),
    /// Run the controller again on the recorded bytes and edges and compare every answer and its time.
    #[command(after_help = "Example: plotter-replay check session.plog --machine semi-virtual-gantry.toml")]
    Check(Check),
    /// Drive or watch a machine, real or simulated, in a browser or this terminal, and record it.
    #[cfg(feature = "live")]
    #[command(
        after_help = "Examples:\n  plotter-replay live drawing.hpgl                        on a simulated machine\n  \
        plotter-replay live --port /dev/ttyUSB0 drawing.hpgl    on a real one\n  \
        plotter-replay live --port auto --terminal drawing.hpgl over ssh"
    )]
    Live(crate::live::Live),
    /// Put a simulated machine on a pseudo terminal, for any program that drives a plotter.
    #[cfg(all(feature = "live", unix))]
    #[command(after_help = "Example: plotter-replay simulate semi-virtual-gantry.toml")]
    Simulate(crate::simulate::Simulate),
    /// Drive or watch a machine: not in this program, which was built without the feature `live`.
    #[cfg(not(feature = "live"))]
    #[command(disable_help_flag = true)]
    Live {
        /// What it would have been given.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<String>,
    },
    /// Say what a log holds, and what of it is damaged or odd.
    #[command(after_help = "Example: plotter-replay info session.plog.gz")]
    Info {
        /// The log; packed if its name ends in .gz.
        log: PathBuf,
    },
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

pub(crate) type Done = Result<Verdict, String>;

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
            #[cfg(feature = "live")]
            Self::Live(live) => live.run(out),
            #[cfg(all(feature = "live", unix))]
            Self::Simulate(simulate) => simulate.run(out),
            #[cfg(not(feature = "live"))]
            Self::Live { .. } => Err(String::from(
                "this program was built without the feature live: cargo install plotter-replay --features live",
            )),
            Self::Info { log } => info(&log, out),
        }
    }
}

/// Prints a line; what could not be printed is told at the end, by `main`.
pub(crate) fn say(out: &mut impl Write, line: &str) {
    let _ = writeln!(out, "{line}");
}

pub(crate) fn say_first<T: ToString>(out: &mut impl Write, list: &[T], count: u64) {
    for one in list.iter().take(MOST_SHOWN) {
        say(out, &format!("  {}", one.to_string()));
    }
    let more = count.saturating_sub(MOST_SHOWN as u64);
    if more > 0 {
        say(out, &format!("  and {more} more"));
    }
}

pub(crate) fn open(path: &Path) -> Result<FileReader, String> {
    log::open(path).map_err(|error| format!("{}: {error}", path.display()))
}

/// Everything in a log, one record after the other.
pub(crate) struct Contents {
    pub(crate) header: Header,
    pub(crate) summary: Summary,
    damage: Vec<Damage>,
}

pub(crate) fn read(path: &Path, mut take: impl FnMut(&Record)) -> Result<Contents, String> {
    read_all(path, |item| {
        if let Ok(record) = item {
            take(record);
        }
    })
}

/// The same, with the damage in its place.
pub(crate) fn read_all(
    path: &Path,
    mut take: impl FnMut(Result<&Record, &Damage>),
) -> Result<Contents, String> {
    let mut reader = open(path)?;
    let mut damage = Vec::new();
    for item in reader.by_ref() {
        match item {
            Ok(record) => take(Ok(&record)),
            Err(one) => {
                take(Err(&one));
                if damage.len() < MOST_SHOWN {
                    damage.push(one);
                }
            }
        }
    }
    Ok(Contents { header: reader.header().clone(), summary: reader.summary(), damage })
}

pub(crate) fn plotter_for(path: &Path) -> Result<VirtualPlotter, String> {
    let settings = PlotterSettings::from_header(open(path)?.header())
        .map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(VirtualPlotter::new(settings))
}

pub(crate) fn say_damage(out: &mut impl Write, contents: &Contents) {
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

pub(crate) fn cannot(be: &str, path: &Path, error: &std::io::Error) -> String {
    format!("{}: cannot be {be}: {error}", path.display())
}

/// All of a file, if it has at most `most_bytes`: a device may go on for ever.
pub(crate) fn read_file(path: &Path, most_bytes: u64) -> Result<Vec<u8>, String> {
    let refused = |error: std::io::Error| cannot("read", path, &error);
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(refused)?;
    file.take(most_bytes.saturating_add(1)).read_to_end(&mut bytes).map_err(refused)?;
    if bytes.len() as u64 > most_bytes {
        return Err(format!("{}: longer than {} MiB", path.display(), most_bytes >> 20));
    }
    Ok(bytes)
}

impl Check {
    fn run(self, out: &mut impl Write) -> Done {
        let mut has_edges = false;
        let contents = read(&self.log, |record| has_edges |= matches!(record.event, Event::Edge { .. }))?;
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
        if self.machine.is_some() {
            return read_machine(self.machine.as_deref());
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
