//! The commands, `render`, and what they share.

use crate::check::Check;
use crate::compare::Compare;
use crate::export::Export;
use crate::import::Import;
use crate::info::Info;
use crate::record::Record;
use crate::replay::Replay;
use clap::{Args, Subcommand};
use plotter_motion::{Machine, PlotOp, hpgl};
use plotter_replay::log::{self, Damage, FileReader, Header, Summary};
use plotter_replay::{Canvas, CanvasStyle, Chart, Layer, PlotterSettings, VirtualPlotter, Visibility};
use std::io::{Read as _, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Longest list of damage or anomalies that is shown.
pub(crate) const MOST_SHOWN: usize = 20;
/// Longest drawing that is read, bytes: some ten million lines.
const MOST_DRAWING_BYTES: u64 = 256 << 20;
/// Longest machine file that is read, bytes; a good one has a few thousand.
const MOST_MACHINE_BYTES: u64 = 1 << 20;
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
        writes pictures/plotted.svg, pictures/plotted.png and pictures/response.svg")]
    Render(Render),
    /// Run the controller again on the recorded bytes and edges and compare every answer and its time.
    #[command(after_help = "Example: plotter-replay check session.plog --machine semi-virtual-gantry.toml")]
    Check(Check),
    /// Run the controller again, show what it says and does, and keep it as a log.
    #[command(after_help = "Example: plotter-replay replay session.plog --speed 1 --skip-gaps 0.5\n\
        shows the session as fast as it was, without its pauses")]
    Replay(Replay),
    /// Compare two logs byte by byte: the first difference, what is round it, and all others in numbers.
    #[command(after_help = "Example: plotter-replay compare before.plog after.plog --tolerance-us 1000")]
    Compare(Compare),
    /// Record a serial line between a host program and a plotter.
    #[command(after_help = "Example: plotter-replay record --port auto --pty plotter -o session.plog\n\
        then let the host program open the port ./plotter; Ctrl-C ends the recording")]
    Record(Record),
    /// Make a log of what another tool recorded.
    #[command(after_help = "Example: plotter-replay import capture.txt -o session.plog\n\
        plotter-replay import --from sigrok --host tx.txt --controller rx.txt -o session.plog")]
    Import(Import),
    /// Write a log as a table, as text with what it says, or as MCAP for Foxglove.
    #[command(after_help = "Example: plotter-replay export session.plog --to csv -o session.csv")]
    Export(Export),
    /// Say what a log holds, its rates and gaps, and what of it is damaged or odd.
    #[command(after_help = "Example: plotter-replay info session.plog.gz")]
    Info(Info),
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
            Self::Replay(replay) => replay.run(out),
            Self::Compare(compare) => compare.run(out),
            Self::Record(record) => record.run(out),
            Self::Import(import) => import.run(out),
            Self::Export(export) => export.run(out),
            Self::Info(info) => info.run(out),
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

pub(crate) fn read(path: &Path, mut take: impl FnMut(&log::Record)) -> Result<Contents, String> {
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

pub(crate) fn say_damage(out: &mut impl Write, contents: &Contents) {
    say(out, &contents.summary.to_string());
    say_first(out, &contents.damage, contents.summary.damaged_lines);
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

pub(crate) fn cannot(be: &str, path: &Path, error: &std::io::Error) -> String {
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

/// The machine that a file describes.
pub(crate) fn read_machine(path: &Path) -> Result<Machine, String> {
    let refused = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let text = String::from_utf8(read_file(path, MOST_MACHINE_BYTES)?)
        .map_err(|error| refused(&error.utf8_error()))?;
    Machine::from_toml(&text).map_err(|error| refused(&error))
}

/// Seconds as people give them.
pub(crate) fn seconds(text: &str) -> Result<Duration, String> {
    let seconds: f64 = text.parse().map_err(|_| format!("expected seconds, found {text:?}"))?;
    Duration::try_from_secs_f64(seconds).map_err(|_| format!("expected 0 or more seconds, found {text:?}"))
}

/// Refuses to write over a file that is there.
pub(crate) fn is_free(path: &Path, force: bool) -> Result<(), String> {
    let is_file = std::fs::metadata(path).is_ok_and(|meta| meta.is_file() && meta.len() > 0);
    if is_file && !force {
        return Err(format!("{}: is there already: give another name, or --force", path.display()));
    }
    Ok(())
}
