//! `check`: the controller again, compared with its recording.

use super::commands::{Contents, Done, Verdict, open, read, say, say_damage};
use super::machine::read_machine;
use crate::log::{Event, Header, Record};
use crate::{
    AnyController, CompareSettings, Controller, Outcome, Player, PlayerSettings,
    compare::{Decoder, compare},
    player::{EdgeSource, RecordingTraits},
};
use clap::Args;
use plotter_motion::Machine;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

#[derive(Debug, Args)]
pub(crate) struct Check {
    /// The log; packed if its name ends in .gz.
    log: PathBuf,
    /// The machine's description [default: the preset of the controller that the log's header names].
    #[arg(long, value_name = "FILE.toml")]
    machine: Option<PathBuf>,
    /// Tolerance for the time of an answer, microseconds [default: 0; for a log without edges 50000, or
    /// 1000000 if it is one of frames].
    #[arg(long, value_name = "US")]
    tolerance_us: Option<u64>,
}

/// A log on which a controller is run again.
pub(crate) struct Rerunnable {
    pub(crate) contents: Contents,
    header: Header,
    traits: RecordingTraits,
    machine: Option<Machine>,
    log: PathBuf,
}

impl Rerunnable {
    /// Reads a log, and the machine's description if there is one.
    pub(crate) fn read(log: &Path, machine: Option<&Path>) -> Result<Self, String> {
        let mut traits = RecordingTraits::default();
        let contents = read(log, |record| traits.look(record))?;
        let machine = machine.map(|path| read_machine(Some(path))).transpose()?;
        let header = traits.header(&contents.header);
        let said = |key| header.text(key);
        if said("protocol") == Some("counts")
            && said("controller") != Some("marking-board")
            && machine.is_none()
        {
            return Err(format!(
                "{}: its protocol is \"counts\", and only a controller that was led by bytes or by moves on its line can be run \
                 again; `render` shows what it did",
                log.display()
            ));
        }
        if traits.under_way_before() > 0 {
            return Err(format!(
                "{}: it begins while the machine is on its way to a target of an earlier host, and does not say to which; \
                 `render` shows what it did",
                log.display()
            ));
        }
        Ok(Self { contents, header, traits, machine, log: log.to_owned() })
    }

    /// A new controller of its machine.
    pub(crate) fn controller(&self) -> Result<Box<dyn Controller>, String> {
        AnyController::for_recording(&self.header, &self.traits, self.machine.as_ref())
            .map_err(|error| format!("{}: {error} (--machine)", self.log.display()))
    }

    /// Name of the controller, and the reason for which it was chosen.
    fn which(&self) -> String {
        let protocol = self.header.text("protocol").unwrap_or("digits");
        match (&self.machine, self.header.text("controller"), AnyController::named(&self.header)) {
            (Some(machine), ..) => {
                format!("controller: that of {} (--machine), {protocol}", machine.config().name)
            }
            (None, Some(named), _) => format!("controller: {named} (as the log's header says), {protocol}"),
            (None, None, Some(named)) => {
                format!("controller: {named} (the preset for this protocol), {protocol}")
            }
            (None, None, None) => {
                format!("controller: contouring (the preset; the log names none), {protocol}")
            }
        }
    }

    /// Settings of the run.
    pub(crate) fn settings(&self, controller: &dyn Controller) -> PlayerSettings {
        self.traits.settings(&self.header, controller.makes_steps())
    }

    /// The records of the log, from the beginning.
    pub(crate) fn records(&self) -> impl Iterator<Item = Record> + use<> {
        open(&self.log).into_iter().flatten().filter_map(Result::ok)
    }
}

impl Check {
    pub(crate) fn run(self, out: &mut impl Write) -> Done {
        let log = Rerunnable::read(&self.log, self.machine.as_deref())?;
        let first = log.controller()?;
        let mut settings = log.settings(&*first);
        settings.tolerance = self.tolerance_us.map_or(settings.tolerance, Duration::from_micros);
        say(out, &log.which());
        let by = match settings.edges {
            EdgeSource::Records => None,
            EdgeSource::Pulses if first.makes_steps() => {
                Some("the controller makes its own, which are not compared")
            }
            EdgeSource::Pulses => Some("taken from the pulses, which are not compared"),
            EdgeSource::Messages => Some(
                "the motors are where the machine told, and not led; its messages are compared, not its frames",
            ),
        };
        if let Some(by) = by {
            let within = settings.tolerance.as_micros();
            say(out, &format!("no edges in the log: {by}; times within {within} us"));
        }
        let lacks_steps = settings.edges == EdgeSource::Pulses && first.makes_steps();
        say_damage(out, &log.contents);
        let player = Player::new(settings);
        let outcome = player.check(log.records(), first);
        let Outcome::FirstDifference(difference) = outcome else {
            say(out, &outcome.to_string());
            return Ok(Verdict::of(log.contents.summary));
        };
        let header = player.header(&log.header);
        say(out, &difference.in_words(&header, || player.inputs(log.records())));
        // The rest in numbers: how much of all is other than recorded.
        let again = || {
            let controller = log.controller().into_iter();
            controller
                .flat_map(|controller| player.rerun_iter(log.records(), controller).map_while(Result::ok))
                // What the log cannot have is not compared.
                .filter(|record| !(lacks_steps && matches!(record.event, Event::Edge { .. } | Event::Pen(_))))
        };
        let wanted = CompareSettings { tolerance: settings.tolerance, ..CompareSettings::default() };
        let comparison = compare(&header, || player.inputs(log.records()), again, wanted);
        if let Some(first) = comparison.first {
            say(out, "what is done now, there:");
            for (index, line) in first.right.around {
                let mark = if Some(index) == first.right.record { '>' } else { ' ' };
                say(out, &format!("  {mark} {index:>6}  {line}"));
            }
            let frame = first.right.record.and_then(|record| Decoder::frame_at(&header, again(), record));
            if let Some((index, words)) = frame {
                say(out, &format!("  its frame ends at record {index}: {words}"));
            }
        }
        say(out, "in all (first: recorded, second: now):");
        for lane in comparison.lanes {
            say(out, &format!("  {lane}"));
        }
        Ok(Verdict::Found)
    }
}
