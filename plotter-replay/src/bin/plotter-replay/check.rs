//! `check`: the controller again, compared with its recording.

use crate::commands::{Done, Verdict, open, read, say, say_damage};
use crate::machine::read_machine;
use clap::Args;
use plotter_motion::Machine;
use plotter_replay::log::{Event, Header};
use plotter_replay::{
    AnyController, CompareSettings, Controller, EdgeSource, Player, PlayerSettings, compare,
};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Time by which an answer may be off when the edges are only known from the pulses.
const PULSE_TOLERANCE: Duration = Duration::from_millis(50);

#[derive(Debug, Args)]
pub(crate) struct Check {
    /// The log; packed if its name ends in .gz.
    log: PathBuf,
    /// The machine's description [default: the preset of the controller that the log's header names].
    #[arg(long, value_name = "FILE.toml")]
    machine: Option<PathBuf>,
    /// How far the time of an answer may be off, microseconds [default: 0, or 50000 for a log without edges].
    #[arg(long, value_name = "US")]
    tolerance_us: Option<u64>,
}

/// What a log has that decides how it is re-run.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Traits {
    has_edges: bool,
    has_duties: bool,
}

impl Traits {
    pub(crate) fn look(&mut self, event: &Event) {
        self.has_edges |= matches!(event, Event::Edge { .. });
        self.has_duties |= matches!(event, Event::Drive { .. });
    }

    /// How a log with this header and these traits is re-run.
    pub(crate) fn settings(self, header: &Header, makes_steps: bool) -> PlayerSettings {
        let knows_edges = self.has_edges || makes_steps;
        let edges = if knows_edges { EdgeSource::Records } else { EdgeSource::Pulses };
        let tolerance = if knows_edges { Duration::ZERO } else { PULSE_TOLERANCE };
        PlayerSettings {
            edges,
            tolerance,
            tells_duties: self.has_duties,
            ..PlayerSettings::from_header(header)
        }
    }
}

/// A new controller for a log.
pub(crate) fn controller(
    log: &Path,
    header: &Header,
    machine: Option<&Machine>,
) -> Result<Box<dyn Controller>, String> {
    if header.text("protocol") == Some("counts") && header.text("controller") != Some("marking-board") {
        return Err(format!(
            "{}: its protocol is \"counts\", and only a controller that was led by bytes or by moves on its line can be run again; \
             `render` shows what it did",
            log.display()
        ));
    }
    if header.text("protocol") == Some("link") {
        return Err(format!(
            "{}: its protocol is \"link\", and a recording of that has no edges to run a controller on; `render` shows what it did",
            log.display()
        ));
    }
    AnyController::of(header, machine).map_err(|error| format!("{}: {error} (--machine)", log.display()))
}

impl Check {
    pub(crate) fn run(self, out: &mut impl Write) -> Done {
        let mut traits = Traits::default();
        let contents = read(&self.log, |record| traits.look(&record.event))?;
        let header = &contents.header;
        let machine = self.machine.as_deref().map(|path| read_machine(Some(path))).transpose()?;
        let first = controller(&self.log, header, machine.as_ref())?;
        let mut settings = traits.settings(header, first.makes_steps());
        settings.tolerance = self.tolerance_us.map_or(settings.tolerance, Duration::from_micros);
        if settings.edges == EdgeSource::Pulses {
            say(
                out,
                &format!(
                    "no edges in the log: taken from the pulses, times within {} us, pulses not compared",
                    settings.tolerance.as_micros()
                ),
            );
        }
        say_damage(out, &contents);
        let player = Player::new(settings);
        let records = || open(&self.log).into_iter().flatten().filter_map(Result::ok);
        let outcome = player.check(records(), first);
        say(out, &outcome.to_string());
        if outcome.is_equal() {
            return Ok(Verdict::of(contents.summary));
        }
        // The rest in numbers: how much of all is other than recorded.
        let again = || {
            let controller = controller(&self.log, header, machine.as_ref()).into_iter();
            controller.flat_map(|controller| player.rerun_iter(records(), controller).map_while(Result::ok))
        };
        let wanted = CompareSettings { tolerance: settings.tolerance, ..CompareSettings::default() };
        say(out, "in all (first: recorded, second: now):");
        for lane in compare(header, records, again, wanted).lanes {
            say(out, &format!("  {lane}"));
        }
        Ok(Verdict::Found)
    }
}
