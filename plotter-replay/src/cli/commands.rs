//! The commands, and what they share.

use super::check::Check;
use super::compare::Compare;
use super::export::Export;
use super::import::Import;
use super::info::Info;
use super::record::Record;
use super::render::Render;
use super::replay::Replay;
use crate::import::protocol_of;
use crate::log::{self, Damage, FileReader, Header, Summary};
use clap::{ArgMatches, FromArgMatches as _, Subcommand};
use std::io::{Read as _, Write};
use std::path::Path;
use std::time::Duration;

/// Longest list of damage or anomalies that is shown.
pub(crate) const MOST_SHOWN: usize = 20;
/// Longest machine file that is read, bytes; a good one has a few thousand.
pub(crate) const MOST_MACHINE_BYTES: u64 = 1 << 20;
/// Findings, which decide on the exit code.
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

/// The commands.
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
    /// Run the controller again, show what it says and does, and keep it as a log.
    #[command(after_help = "Example: plotter-replay replay session.plog --speed 1 --skip-gaps 0.5\n\
        shows the session as fast as it was, without its pauses")]
    Replay(Replay),
    /// Compare two logs byte by byte: the first difference with its surroundings, and the number of all
    /// others.
    #[command(after_help = "Example: plotter-replay compare before.plog after.plog --tolerance-us 1000")]
    Compare(Compare),
    /// Record a serial line between a host program and a plotter.
    #[command(after_help = "Example: plotter-replay record --port auto --pty plotter -o session.plog\n\
        then let the host program open the port ./plotter; Ctrl-C ends the recording")]
    Record(Record),
    /// Convert a recording by another tool to a log.
    #[command(after_help = "Example: plotter-replay import capture.txt -o session.plog\n\
        plotter-replay import --from sigrok --host tx.txt --controller rx.txt -o session.plog")]
    Import(Import),
    /// Write a log as a table, as text with the meaning of each record, or as MCAP for Foxglove.
    #[command(after_help = "Example: plotter-replay export session.plog --to csv -o session.csv")]
    Export(Export),
    /// Drive or watch a machine, real or simulated, in a browser or this terminal, and record it.
    #[cfg(feature = "live")]
    #[command(
        after_help = "Examples:\n  plotter-replay live drawing.hpgl                        on a simulated machine\n  \
        plotter-replay live --port /dev/ttyUSB0 drawing.hpgl    on a real one\n  \
        plotter-replay live --port auto --terminal drawing.hpgl over ssh"
    )]
    Live(super::live::Live),
    /// Put a simulated machine on a pseudo terminal, for any program that drives a plotter.
    #[cfg(all(feature = "live", unix))]
    #[command(after_help = "Example: plotter-replay simulate semi-virtual-gantry.toml")]
    Simulate(super::simulate::Simulate),
    /// Drive or watch a machine: not in this program, which was built without the feature `live`.
    #[cfg(not(feature = "live"))]
    #[command(disable_help_flag = true)]
    Live {
        /// The arguments, which are ignored.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<String>,
    },
    /// Summarize a log: its contents, rates and gaps, and what is damaged or does not fit.
    #[command(after_help = "Example: plotter-replay info session.plog.gz")]
    Info(Info),
}

pub(crate) type Done = Result<Verdict, String>;

impl Command {
    /// The command of that name, with what was given to it.
    ///
    /// # Errors
    ///
    /// There is none of that name, or something is missed in it.
    pub(crate) fn of_subcommand(name: &str, matches: &ArgMatches) -> Result<Self, clap::Error> {
        Ok(match name {
            "render" => Self::Render(Render::from_arg_matches(matches)?),
            "check" => Self::Check(Check::from_arg_matches(matches)?),
            "replay" => Self::Replay(Replay::from_arg_matches(matches)?),
            "compare" => Self::Compare(Compare::from_arg_matches(matches)?),
            "record" => Self::Record(Record::from_arg_matches(matches)?),
            "import" => Self::Import(Import::from_arg_matches(matches)?),
            "export" => Self::Export(Export::from_arg_matches(matches)?),
            "info" => Self::Info(Info::from_arg_matches(matches)?),
            #[cfg(feature = "live")]
            "live" => Self::Live(super::live::Live::from_arg_matches(matches)?),
            #[cfg(all(feature = "live", unix))]
            "simulate" => Self::Simulate(super::simulate::Simulate::from_arg_matches(matches)?),
            #[cfg(not(feature = "live"))]
            "live" => Self::Live { arguments: Vec::new() },
            _ => return Err(clap::Error::new(clap::error::ErrorKind::InvalidSubcommand)),
        })
    }

    /// Whether a file goes to the standard output, so that no words may go there.
    pub(crate) fn prints_file(&self) -> bool {
        matches!(self, Self::Export(export) if export.prints_file())
    }

    /// Runs the command.
    ///
    /// # Errors
    ///
    /// One line that names the file that cannot be read or written, and why.
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
            #[cfg(feature = "live")]
            Self::Live(live) => live.run(out),
            #[cfg(all(feature = "live", unix))]
            Self::Simulate(simulate) => simulate.run(out),
            #[cfg(not(feature = "live"))]
            Self::Live { .. } => Err(format!(
                "this program was built without the feature live: {}",
                super::with_feature("live")
            )),
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

/// Bytes of each side by which a protocol is told, some hundred lines, and records that are read for them:
/// one a byte.
const TELLING_BYTES: usize = 4_096;
const TELLING_RECORDS: usize = 2 * TELLING_BYTES;

/// A log. Where nobody has said of which protocol it is, as while it was recorded, its beginning tells.
pub(crate) fn open(path: &Path) -> Result<FileReader, String> {
    let open = || log::open(path).map_err(|error| format!("{}: {error}", path.display()));
    let reader = open()?;
    if reader.header().has("protocol") {
        return Ok(reader);
    }
    let (mut host, mut machine) = (Vec::new(), Vec::new());
    for record in open()?.filter_map(Result::ok).take(TELLING_RECORDS) {
        match record.event {
            log::Event::Host(bytes) if host.len() < TELLING_BYTES => host.extend(bytes),
            log::Event::Controller(bytes) if machine.len() < TELLING_BYTES => machine.extend(bytes),
            _ => {}
        }
    }
    let header = reader.header().clone().with_text("protocol", protocol_of(&host, &machine));
    Ok(reader.with_header(header))
}

/// Everything in a log, one record after the other.
pub(crate) struct Contents {
    pub(crate) header: Header,
    pub(crate) summary: Summary,
    damage: Vec<Damage>,
}

pub(crate) fn read(path: &Path, mut take: impl FnMut(&log::Record)) -> Result<Contents, String> {
    read_all(path, |item| {
        if let Ok(record) = item {
            take(record);
        }
    })
}

/// The same, with the damage in its place.
pub(crate) fn read_all(
    path: &Path,
    mut take: impl FnMut(Result<&log::Record, &Damage>),
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

pub(crate) fn say_damage(out: &mut impl Write, contents: &Contents) {
    say(out, &contents.summary.to_string());
    say_first(out, &contents.damage, contents.summary.damaged_lines);
}

pub(crate) fn cannot(be: &str, path: &Path, error: &std::io::Error) -> String {
    format!("{}: cannot be {be}: {error}", path.display())
}

/// A whole file, if it has at most `most_bytes`: a device may never end.
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

/// Seconds, as given on the command line.
pub(crate) fn seconds(text: &str) -> Result<Duration, String> {
    let seconds: f64 = text.parse().map_err(|_| format!("expected seconds, found {text:?}"))?;
    Duration::try_from_secs_f64(seconds).map_err(|_| format!("expected 0 or more seconds, found {text:?}"))
}

/// Refuses to overwrite an existing file.
pub(crate) fn is_free(path: &Path, force: bool) -> Result<(), String> {
    let is_file = std::fs::metadata(path).is_ok_and(|meta| meta.is_file() && meta.len() > 0);
    if is_file && !force {
        return Err(format!("{}: is there already: give another name, or --force", path.display()));
    }
    Ok(())
}
