//! `live`: a machine watched and driven while it draws.

use super::commands::{Done, Verdict, say, say_first};
use super::drawing::DrawingFile;
use super::live_hosted::Protocol;
use super::machine::{clock_bits, header_of, read_machine, speed};
use crate::live::{
    Command, Line, LinkChoice, LivePage, MachineLog, PortLine, Recording, Server, Session, SessionSettings,
    SimulatedMachine, State, Telemetry, terminal,
};
use crate::log::{self, FileWriter, LogFile};
use crate::serial::{Port, find};
use crate::{PlotterSettings, ResumePoint, resume::DrawingMark};
use clap::{Args, ValueEnum};
use plotter_motion::{Machine, PenMove, config::MachineKind, toolpath::targets};
use std::cell::RefCell;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// How long a page has for the last of it.
pub(super) const LAST_LOOK: Duration = Duration::from_millis(1_500);

/// How often it is looked whether the machine is stopped.
pub(super) const LOOK_EVERY: Duration = Duration::from_millis(200);

/// What is driven, and what with.
#[derive(Debug, Args)]
pub(crate) struct Live {
    /// The drawing: HPGL, G-code or the thesis' text. Without one, the machine is watched only.
    pub(super) drawing: Option<PathBuf>,
    /// The serial port of a machine: a name, a part of one that only it has, or `auto` for the only one there
    /// is.
    #[arg(long, value_name = "DEV", conflicts_with = "simulate")]
    pub(super) port: Option<String>,
    /// Simulate the machine of this file instead [default without --port: the semi-virtual gantry].
    #[arg(long, value_name = "MACHINE.toml")]
    simulate: Option<PathBuf>,
    /// The description of the machine on the port [default: the semi-virtual gantry].
    #[arg(long, value_name = "MACHINE.toml", conflicts_with = "simulate")]
    machine: Option<PathBuf>,
    /// What is spoken with the machine.
    #[arg(long, value_enum, default_value_t)]
    link: Link,
    /// What a machine with stepper motors speaks.
    #[arg(long, value_enum, default_value_t)]
    pub(super) protocol: Protocol,
    /// Go on with the drawing that the host of this log was sending when it ended; the machine must have been
    /// on since, and speak frames or lines of text.
    #[arg(long, value_name = "LOG", requires_all = ["drawing", "port"])]
    pub(super) resume: Option<PathBuf>,
    /// Seconds of a simulated machine in one of ours; more than this computer can is as fast as it goes.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = speed, conflicts_with = "port")]
    pub(super) speed: f64,
    /// The recording [default: live.plog, or the first of live-2.plog, live-3.plog, ... that is not there].
    #[arg(short, long, value_name = "LOG", default_value_os_t = free_name(), hide_default_value = true)]
    pub(super) output: PathBuf,
    /// Show it in this terminal, not in a browser.
    #[arg(long)]
    pub(super) terminal: bool,
    /// Port of 127.0.0.1 for the page; 0 takes any that is free.
    #[arg(long, value_name = "NUMBER", default_value_t = 0)]
    pub(super) http_port: u16,
    /// Begin at once, without waiting for Start.
    #[arg(long, requires = "drawing")]
    pub(super) start: bool,
}

/// What is spoken.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum Link {
    /// The reliable link if the machine knows it, else digits; it is called at the start, at its origin
    #[default]
    Auto,
    /// The published ten digits a target; the machine is not called
    Digits,
    /// The reliable link, or nothing
    Frames,
}

impl From<Link> for LinkChoice {
    fn from(link: Link) -> Self {
        match link {
            Link::Auto => Self::Auto,
            Link::Digits => Self::Digits,
            Link::Frames => Self::Frames,
        }
    }
}

/// A name for a recording that none before it has: the last one may be needed for --resume.
fn free_name() -> PathBuf {
    let names = core::iter::once(PathBuf::from("live.plog"));
    let more = (2..10_000_u32).map(|n| PathBuf::from(format!("live-{n}.plog")));
    names.chain(more).find(|name| !name.exists()).unwrap_or_else(|| PathBuf::from("live.plog"))
}

/// What a line leads to.
struct Connected {
    line: Arc<dyn Line>,
    telemetry: Option<Arc<Mutex<Telemetry>>>,
    name: String,
}

impl Live {
    /// Does it.
    pub(crate) fn run(self, out: &mut impl Write) -> Done {
        let described = self.simulate.as_deref().or(self.machine.as_deref());
        let machine = read_machine(described)?;
        if Self::is_led_by_lines(&machine) {
            return self.run_lines(&machine, out);
        }
        let place = described.map_or_else(String::new, |path| format!("{}: ", path.display()));
        machine.require(MachineKind::Gantry, "live").map_err(|error| format!("{place}{error}"))?;
        let config = machine.config();
        let plotter = PlotterSettings {
            x_mm_per_pulse: 1.0 / config.x.counts_per_mm,
            y_mm_per_pulse: 1.0 / config.y.counts_per_mm,
            ..PlotterSettings::default()
        };
        let mut page = LivePage::new(config.name.as_str(), plotter);
        let drawing = self.drawing.as_deref().map(DrawingFile::open).transpose()?;
        let mut verdict = Verdict::Clean;
        let mut mark = DrawingMark::default();
        if let (Some(drawing), Some(path)) = (&drawing, &self.drawing)
            && look_through(drawing, path, &machine, &mut page, &mut mark, out)? > 0
        {
            verdict = Verdict::Found;
        }
        let resume = self.resume_point(mark)?;
        let port = self.open_port(&machine)?;
        let boot = (port.is_none() && !matches!(self.link, Link::Digits)).then(clock_bits);
        let writer = self.recorder(&machine, mark, resume, boot)?;
        let (connected, recording) = self.connect(&machine, port, boot, writer)?;
        let plan = drawing.is_some().then(|| page.plan());
        let settings = SessionSettings {
            plotter,
            byte_gap: Duration::from_secs_f64(config.serial.byte_gap_ms / 1e3),
            plan,
            pwm_steps: [config.x.motor.pwm_steps, config.y.motor.pwm_steps],
            link: self.link.into(),
            nonce: u16::try_from(clock_bits() & 0xffff).unwrap_or(1),
            baud: config.serial.baud,
            resume: resume.map(|point| point.resume),
            ..SessionSettings::default()
        };
        let area_mm = page.area_mm().unwrap_or([0.0, 0.0, config.area.width_mm, config.area.height_mm]);
        self.describe(&mut page, &machine, &connected.name);
        let moves = drawing.map(|drawing| moves(&drawing, &machine)).transpose()?;
        let session = Session::open(
            Arc::clone(&connected.line),
            moves,
            Some(recording),
            connected.telemetry.clone(),
            settings,
        );
        let begin = || {
            if self.start {
                session.command(Command::Start);
            }
        };
        let state = if self.terminal {
            begin();
            let heading = self.heading(config.name.as_str(), &connected.name, area_mm);
            let quit = terminal::run(&session, &heading).map_err(|error| format!("terminal: {error}"))?;
            if quit { session.state() } else { session.wait(LAST_LOOK) }
        } else {
            let about = page.about.clone();
            let server =
                Server::open(session.clone(), self.http_port, |sources| page.finish(area_mm, sources))
                    .map_err(|error| error.to_string())?;
            say(out, &about);
            say(out, &format!("look at {}", server.address()));
            let _ = out.flush(); // who closed it has seen enough: the machine goes on
            begin(); // only now: nothing moves that cannot be watched and stopped
            let mut was_stopped = false;
            let state = loop {
                let state = session.wait(LOOK_EVERY);
                if state.is_final() {
                    break state;
                }
                let is_stopped = state == State::Stopped;
                if is_stopped && !was_stopped {
                    say(out, "the machine is stopped: it goes on when Resume is pressed on the page");
                    let _ = out.flush();
                }
                was_stopped = is_stopped;
            };
            let until = Instant::now() + LAST_LOOK;
            while server.connections() > 0 && Instant::now() < until {
                std::thread::sleep(Duration::from_millis(20));
            }
            state
        };
        say(out, &format!("wrote {}", self.output.display()));
        match state {
            State::Failed(why) => {
                Err(format!("{why}; the recording up to here is in {}", self.output.display()))
            }
            _ => {
                let targets = plan.map_or(0, |plan| plan.targets);
                let reached = session.reached();
                if plan.is_some() {
                    say(out, &format!("targets: {reached} of {targets} reached"));
                }
                Ok(if reached < targets { Verdict::Found } else { verdict })
            }
        }
    }

    /// The machine's port, if it is on one, and what that is called.
    fn open_port(&self, machine: &Machine) -> Result<Option<(PortLine, String)>, String> {
        let Some(name) = &self.port else { return Ok(None) };
        let name = find(name).map_err(|error| error.to_string())?;
        let port = Port::open(&name, machine.config().serial.baud).map_err(|error| error.to_string())?;
        Ok(Some((PortLine::new(port).map_err(|error| error.to_string())?, name)))
    }

    /// The machine on its port, whose line is recorded here; or a simulated one, which records itself.
    fn connect(
        &self,
        machine: &Machine,
        port: Option<(PortLine, String)>,
        boot: Option<u32>,
        writer: FileWriter,
    ) -> Result<(Connected, Recording<LogFile>), String> {
        if let Some((line, name)) = port {
            let connected = Connected { line: Arc::new(line), telemetry: None, name };
            return Ok((connected, Recording::Line(writer)));
        }
        let log = MachineLog::new(writer);
        let simulated = SimulatedMachine::new(machine, boot).map_err(|error| error.to_string())?;
        let line = simulated.logged(log.clone()).line(self.speed);
        let telemetry = Some(line.telemetry());
        let name = String::from("none: simulated in this program");
        Ok((Connected { line: Arc::new(line), telemetry, name }, Recording::Machine(log)))
    }

    /// Where the last host left the drawing.
    fn resume_point(&self, mark: DrawingMark) -> Result<Option<ResumePoint>, String> {
        let Some(log) = &self.resume else { return Ok(None) };
        let same = |a: &Path, b: &Path| {
            a == b || a.canonicalize().ok().is_some_and(|a| b.canonicalize().is_ok_and(|b| a == b))
        };
        if same(log, &self.output) {
            return Err(format!(
                "{}: this log is read for --resume: give another one with -o",
                log.display()
            ));
        }
        if matches!(self.link, Link::Digits) {
            return Err(String::from(
                "--resume: a machine of digits does not say where it stands: --link auto or frames",
            ));
        }
        let point = ResumePoint::read(log).map_err(|error| format!("{}: {error}", log.display()))?;
        if point.drawing.is_some_and(|drawing| drawing != mark) {
            return Err(format!(
                "{}: it was another drawing, or of another machine or scale, that this host was sending",
                log.display()
            ));
        }
        Ok(Some(point))
    }

    fn recorder(
        &self,
        machine: &Machine,
        mark: DrawingMark,
        resume: Option<ResumePoint>,
        boot: Option<u32>,
    ) -> Result<FileWriter, String> {
        let header =
            header_of(machine, if matches!(self.link, Link::Digits) { "digits" } else { "link" }, boot)
                .with_text("clock", if self.port.is_some() { "host" } else { "simulated" });
        let header = if mark.moves > 0 { mark.written_to(header) } else { header };
        let header = resume.map_or(header.clone(), |point| point.written_to(header));
        log::create(&self.output, &header).map_err(|error| format!("{}: {error}", self.output.display()))
    }

    fn heading(&self, machine: &str, port: &str, area_mm: [f64; 4]) -> terminal::Heading {
        let is_simulated = self.port.is_none();
        let machine = if is_simulated {
            format!("{machine}: no motor turns, at up to {} times its time", self.speed)
        } else {
            format!("on {port}, taken for a {machine}")
        };
        terminal::Heading { machine, is_simulated, area_mm }
    }

    fn describe(&self, page: &mut LivePage, machine: &Machine, port: &str) {
        let config = machine.config();
        page.is_simulated = self.port.is_none();
        if page.is_simulated {
            page.about = format!(
                "{} is SIMULATED: no motor turns, at up to {} times its time.",
                config.name, self.speed
            );
            page.stops =
                String::from("The stop takes the voltage off the simulated motors at its next time step.");
        } else {
            page.about = format!("The machine on {port}, taken for a {}.", config.name);
            page.stops = String::from(
                "The stop sends the byte `!` at once and no further target. Controllers of this family take the voltage off both \
                 motors at it; one that does not know it finishes its target: keep your hand at the machine's own switch.",
            );
        }
        let fact = |name: &str, value: String| (name.to_owned(), value);
        page.facts = vec![
            fact("port", port.to_owned()),
            fact("baud", config.serial.baud.to_string()),
            fact("resolution", format!("{} × {} counts/mm", config.x.counts_per_mm, config.y.counts_per_mm)),
            fact("area", format!("{} × {} mm", config.area.width_mm, config.area.height_mm)),
            fact("origin P1", String::from("0, 0 mm (lower left)")),
            fact("recording", self.output.display().to_string()),
        ];
    }
}

/// The moves of a drawing, as they are asked for; what cannot be read or reached was said before.
fn moves(
    drawing: &DrawingFile,
    machine: &Machine,
) -> Result<Box<dyn Iterator<Item = PenMove> + Send>, String> {
    let ops = drawing.ops(machine.config().x.counts_per_mm)?.filter_map(Result::ok);
    Ok(Box::new(targets(machine, ops).filter_map(Result::ok)))
}

/// Goes through a drawing once, for its length and picture; says what of it cannot be drawn, and how much
/// that is.
fn look_through(
    drawing: &DrawingFile,
    path: &Path,
    machine: &Machine,
    page: &mut LivePage,
    mark: &mut DrawingMark,
    out: &mut impl Write,
) -> Result<u64, String> {
    // Reading and reaching take turns, and both may fail.
    let said = RefCell::new((Vec::new(), 0_u64));
    let note = |error: String| {
        let (first, errors) = &mut *said.borrow_mut();
        *errors = errors.saturating_add(1);
        if first.len() < 20 {
            first.push(error);
        }
    };
    let ops = drawing.ops(machine.config().x.counts_per_mm)?;
    let ops = ops.filter_map(|item| item.map_err(note).ok());
    for next in targets(machine, ops) {
        match next {
            Ok(next) => {
                page.push(next);
                mark.push(next);
            }
            Err(error) => note(error.to_string()),
        }
    }
    let (first, errors) = said.take();
    if errors > 0 {
        say(out, &format!("{}: {errors} errors, left out", path.display()));
        say_first(out, &first, errors);
    }
    if page.plan().targets == 0 {
        return Err(format!("{}: there is nothing in it that this machine could draw", path.display()));
    }
    Ok(errors)
}
