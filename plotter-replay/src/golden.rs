//! Recordings as regression tests: what the controller once did, it must do again.
//!
//! ```no_run
//! # use plotter_motion::{Machine, MachineConfig};
//! use plotter_replay::{golden, player::MachineController};
//!
//! // in a test
//! let machine = Machine::new(MachineConfig::default()).unwrap();
//! golden::assert_replays("tests/golden/square.plog", || MachineController::new(&machine));
//! ```
//!
//! With `UPDATE_GOLDEN=1` in the environment the recording is renewed: the same inputs, and what the
//! controller answers now.
//!
//! A first recording comes from a machine (`plotter-replay live -o session.plog`), from a simulated one
//! (`plotter-replay simulate`), or from a list of inputs and the controller itself: [`record`]. Look through
//! what is in it before you keep it: from then on that is right.

use crate::log::{self, Damage, Header, ReadError, Record, WriteError};
use crate::{
    CompareSettings, Controller, Outcome, Player, PlayerSettings,
    compare::compare,
    player::{Difference, EdgeSource, Stuck},
};
use core::fmt;
use std::path::{Path, PathBuf};

/// Why a recording does not hold.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum GoldenError {
    /// The file is no log.
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        error: ReadError,
    },
    /// The file is damaged; a regression test needs all of it.
    Damaged {
        /// The file.
        path: PathBuf,
        /// The first damage.
        damage: Damage,
    },
    /// The controller does something else now.
    Differs {
        /// The file.
        path: PathBuf,
        /// Where what it does now was written to.
        actual: PathBuf,
        /// Where what is different was written to: the first difference with what is round it, and all in
        /// numbers.
        written: PathBuf,
        /// Where it begins to differ.
        difference: Box<Difference>,
    },
    /// The controller cannot be run to the end.
    Stuck(Stuck),
    /// A recording of frames without edges cannot be renewed: it is run message by message, and that gives no
    /// frames.
    NoEdges {
        /// The file.
        path: PathBuf,
    },
    /// A file cannot be written.
    Unwritable {
        /// The file.
        path: PathBuf,
        /// Why.
        error: WriteError,
    },
}

/// Whether a recording is compared or renewed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Mode {
    /// Compared.
    #[default]
    Compare,
    /// Renewed: the same inputs with what the controller answers now.
    Renew,
}

impl Mode {
    /// [`Mode::Renew`] if the environment says `UPDATE_GOLDEN=1`.
    #[must_use]
    pub fn from_env() -> Self {
        if std::env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1") {
            Self::Renew
        } else {
            Self::Compare
        }
    }
}

/// Makes a first recording at `path`: these inputs, in the order of their times, and what the controller
/// answers.
///
/// ```
/// use plotter_motion::{Machine, MachineConfig};
/// use plotter_replay::log::{Event, Header, Record};
/// use plotter_replay::{golden, player::MachineController};
/// use std::time::Duration;
///
/// # let folder = std::env::temp_dir().join(format!("golden-record-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder)?;
/// let path = folder.join("hello.plog");
/// let machine = Machine::new(MachineConfig::default())?;
/// let header = Header::new().with_number("baud", 256_000);
/// let controller = || MachineController::new(&machine);
/// let line = Record { time: Duration::from_millis(1), event: Event::Host(b"1".to_vec()) };
/// golden::record(&path, &header, &[line], controller())?;
/// golden::assert_replays(&path, controller);
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`GoldenError::Stuck`], [`GoldenError::NoEdges`] or [`GoldenError::Unwritable`]; nothing is written but
/// with the last.
pub fn record<C: Controller>(
    path: &Path,
    header: &Header,
    inputs: &[Record],
    controller: C,
) -> Result<(), GoldenError> {
    let settings = settings_for(header, inputs, &controller);
    renew(path, header, inputs, settings, controller)
}

/// Re-runs the recording at `path` with a new controller. Edges come from the log, and times must be exact;
/// or, if it has none, from what the machine told of its motors
/// ([`crate::player::RecordingTraits::settings`]). If the controller does something else, that is written
/// beside the recording as `.actual`, and what is different as `.diff`.
///
/// # Errors
///
/// [`GoldenError`].
pub fn check<C: Controller>(path: &Path, controller: impl Fn() -> C, mode: Mode) -> Result<(), GoldenError> {
    let unreadable = |error| GoldenError::Unreadable { path: path.to_owned(), error };
    let mut reader = log::open(path).map_err(unreadable)?;
    let header = reader.header().clone();
    let records: Vec<Record> = reader
        .by_ref()
        .collect::<Result<_, _>>()
        .map_err(|damage| GoldenError::Damaged { path: path.to_owned(), damage })?;
    let settings = settings_for(&header, &records, &controller());
    let player = Player::new(settings);
    if mode == Mode::Renew {
        return renew(path, &header, &records, settings, controller());
    }
    let outcome = player.check(records.iter().cloned(), controller());
    let (actual, written) = (beside(path, "actual"), beside_text(path));
    let Outcome::FirstDifference(difference) = outcome else {
        // What an earlier failure left is not true any more.
        for old in [actual, written] {
            let _ = std::fs::remove_file(old);
        }
        return Ok(());
    };
    let now = rerun(&player, &records, controller())?;
    let written_header = player.header(&header);
    write(&actual, &written_header, &now)?;
    let wanted = CompareSettings { tolerance: settings.tolerance, ..CompareSettings::default() };
    let recorded = || player.inputs(records.iter().cloned());
    let comparison = compare(&written_header, recorded, || now.iter().cloned(), wanted);
    let told = difference.in_words(&written_header, recorded);
    std::fs::write(&written, format!("{told}\n\nfirst: recorded, second: now\n{comparison}\n")).map_err(
        |error| GoldenError::Unwritable {
            path: written.clone(),
            error: WriteError::Sink { message: error.to_string() },
        },
    )?;
    Err(GoldenError::Differs { path: path.to_owned(), actual, written, difference })
}

/// Writes a recording with what the controller answers now.
fn renew(
    path: &Path,
    header: &Header,
    records: &[Record],
    settings: PlayerSettings,
    controller: impl Controller,
) -> Result<(), GoldenError> {
    if settings.edges == EdgeSource::Messages {
        return Err(GoldenError::NoEdges { path: path.to_owned() });
    }
    let player = Player::new(settings);
    let now = rerun(&player, records, controller)?;
    write(path, &player.header(header), &now)
}

fn rerun(
    player: &Player,
    records: &[Record],
    controller: impl Controller,
) -> Result<Vec<Record>, GoldenError> {
    player
        .rerun_iter(records.iter().cloned(), controller)
        .collect::<Result<_, _>>()
        .map_err(GoldenError::Stuck)
}

fn write(path: &Path, header: &Header, records: &[Record]) -> Result<(), GoldenError> {
    let unwritable = |error| GoldenError::Unwritable { path: path.to_owned(), error };
    let mut writer = log::create(path, header).map_err(unwritable)?;
    for record in records {
        writer.write(record).map_err(unwritable)?;
    }
    writer.finish().map_err(unwritable).map(drop)
}

fn settings_for(header: &Header, records: &[Record], controller: &impl Controller) -> PlayerSettings {
    let settings = PlayerSettings::for_recording(header, records);
    if controller.makes_steps() {
        PlayerSettings { edges: EdgeSource::Records, ..settings }
    } else {
        settings
    }
}

/// For tests: [`check`]s a recording, renewing it if the environment says `UPDATE_GOLDEN=1`.
///
/// # Panics
///
/// If the recording does not hold; the message is the first difference.
#[expect(clippy::panic, reason = "made for tests, which fail by a panic")]
pub fn assert_replays<C: Controller>(path: impl AsRef<Path>, controller: impl Fn() -> C) {
    if let Err(error) = check(path.as_ref(), controller, Mode::from_env()) {
        panic!("{error}");
    }
}

/// `session.plog` to `session.plog.actual`, and `session.plog.gz` to `session.plog.actual.gz`, so that it
/// stays packed.
fn beside(path: &Path, what: &str) -> PathBuf {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let packed = name.strip_suffix(".gz").map_or("", |_| ".gz");
    path.with_file_name(format!("{}.{what}{packed}", name.trim_end_matches(".gz")))
}

/// `session.plog` and `session.plog.gz` to `session.plog.diff`: never packed, it is for people.
fn beside_text(path: &Path) -> PathBuf {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    path.with_file_name(format!("{}.diff", name.trim_end_matches(".gz")))
}

impl fmt::Display for GoldenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable { path, error } => write!(f, "{}: {error}", path.display()),
            Self::Damaged { path, damage } => write!(f, "{}: {damage}", path.display()),
            Self::Differs { path, actual, written, difference } => write!(
                f,
                "{}: {difference}\n  what happened now: {} (UPDATE_GOLDEN=1 takes it over)\n  what is different: {}",
                path.display(),
                actual.display(),
                written.display()
            ),
            Self::Stuck(stuck) => stuck.fmt(f),
            Self::NoEdges { path } => write!(
                f,
                "{}: it has no edges of the motors, so its frames cannot be made anew: record it again (`plotter-replay simulate -o` \
                 and `live` without --port record edges, too)",
                path.display()
            ),
            Self::Unwritable { path, error } => write!(f, "{}: {error}", path.display()),
        }
    }
}

impl core::error::Error for GoldenError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Unreadable { error, .. } => Some(error),
            Self::Stuck(error) => Some(error),
            Self::Unwritable { error, .. } => Some(error),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_happened_lies_beside_the_recording() {
        assert_eq!(beside(Path::new("golden/square.plog"), "actual"), Path::new("golden/square.plog.actual"));
        assert_eq!(beside(Path::new("square.plog.gz"), "actual"), Path::new("square.plog.actual.gz"));
    }
}
