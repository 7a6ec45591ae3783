//! `live` with a machine that takes targets: DC motors, by digits or over the reliable link.

use super::commands::{Done, Verdict, say, say_first};
use super::drawing::DrawingFile;
use super::live::{LAST_LOOK, LOOK_EVERY, Link, Live};
use super::machine::{belt_header, belt_tolerance, clock_bits, header_of};
use super::open_line::open_line;
use crate::live::{
    Command, DrawingStep, Line, LinkChoice, LivePage, MachineLog, Recording, Server, Session,
    SessionSettings, SimulatedMachine, Spoken, State, Telemetry, drawing_steps, terminal,
};
use crate::log::{self, FileWriter, LogFile};
use crate::serial::find;
use crate::{PlotterSettings, ResumePoint, resume::DrawingMark};
use plotter_motion::config::{DcConfig, OneBeltConfig};
use plotter_motion::protocol::HostSettings;
use plotter_motion::toolpath::from_mm;
use plotter_motion::{Machine, PenMove, Point, StepPoint, config::MachineKind};
use std::cell::RefCell;
use std::io::Write;
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// The line to a machine, and what its port is called.
type NamedLine = (Arc<dyn Line>, String);

/// What a line leads to.
struct Connected {
    line: Arc<dyn Line>,
    telemetry: Option<Arc<Mutex<Telemetry>>>,
    name: String,
}

impl Live {
    /// Does it with a machine of targets.
    pub(crate) fn run_targets(self, machine: &Machine, out: &mut impl Write) -> Done {
        let config = machine.config();
        let dc = DcConfig::of(machine);
        let is_belt = machine.kind() == MachineKind::Belt;
        let link = self.link_with(is_belt)?;
        let plotter = targets_plotter(machine);
        let mut page = LivePage::new(config.name.as_str(), plotter);
        let drawing = self.drawing.as_deref().map(DrawingFile::open).transpose()?;
        let mut verdict = Verdict::Clean;
        let mut known = Known::default();
        if let (Some(drawing), Some(path)) = (&drawing, &self.drawing)
            && known.look_through(drawing, path, machine, &mut page, out)? > 0
        {
            verdict = Verdict::Found;
        }
        let resume = self.resume_point(link, known.mark)?;
        let port = self.open_port(machine)?;
        let boot = (port.is_none() && !matches!(link, Link::Digits)).then(clock_bits);
        let writer = self.recorder(machine, link, known.mark, resume, boot)?;
        let (connected, recording) = self.connect(machine, port, boot, writer)?;
        let plan = drawing.is_some().then(|| page.plan());
        let settings = SessionSettings {
            plotter,
            byte_gap: Duration::from_secs_f64(config.serial.byte_gap_ms / 1e3),
            plan,
            pwm_steps: if is_belt {
                [SimulatedMachine::BELT_PWM_STEPS; 2]
            } else {
                [dc.x.motor.pwm_steps, dc.y.motor.pwm_steps]
            },
            host: HostSettings {
                tolerance_counts: plotter.reached_tolerance_counts,
                ..HostSettings::default()
            },
            most: Some(most_counts(machine)),
            bounds: known.bounds,
            stands_at: plotter.begins_at.map_or(StepPoint::default(), |at| plotter.to_counts(at)),
            ramps: is_belt,
            pens: self.pens.clone(),
            link: link.into(),
            nonce: u16::try_from(clock_bits() & 0xffff).unwrap_or(1),
            baud: config.serial.baud,
            resume: resume.map(|point| point.resume),
        };
        let area_mm = [0.0, 0.0, config.area.width_mm, config.area.height_mm];
        self.describe(&mut page, machine, &connected.name);
        let steps = drawing.map(|drawing| steps(&drawing, machine)).transpose()?;
        let session = Session::open(
            Arc::clone(&connected.line),
            steps,
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
            let (mut was_stopped, mut wanted) = (false, String::new());
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
                let wants = session.wants();
                if wants != wanted && !wants.is_empty() {
                    say(out, &wants);
                    let _ = out.flush();
                }
                wanted = wants;
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
    fn open_port(&self, machine: &Machine) -> Result<Option<NamedLine>, String> {
        let Some(name) = &self.port else { return Ok(None) };
        let name = find(name).map_err(|error| error.to_string())?;
        Ok(Some((open_line(&name, machine.config().serial.baud, false)?, name)))
    }

    /// The machine on its port, whose line is recorded here; or a simulated one, which records itself.
    fn connect(
        &self,
        machine: &Machine,
        port: Option<NamedLine>,
        boot: Option<u32>,
        writer: FileWriter,
    ) -> Result<(Connected, Recording<LogFile>), String> {
        if let Some((line, name)) = port {
            let connected = Connected { line, telemetry: None, name };
            return Ok((connected, Recording::Line(writer)));
        }
        let log = MachineLog::new(writer);
        let spoken = boot.map_or(Spoken::Digits, |boot| Spoken::Link { boot });
        let simulated = SimulatedMachine::speaking(machine, spoken).map_err(|error| error.to_string())?;
        let line = simulated.logged(log.clone()).line(self.speed);
        let telemetry = Some(line.telemetry());
        let name = String::from("none: simulated in this program");
        Ok((Connected { line: Arc::new(line), telemetry, name }, Recording::Machine(log)))
    }

    /// Where the last host left the drawing.
    fn resume_point(&self, link: Link, mark: DrawingMark) -> Result<Option<ResumePoint>, String> {
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
        if matches!(link, Link::Digits) {
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

    /// What is spoken with the machine: one with a belt knows digits only.
    fn link_with(&self, is_belt: bool) -> Result<Link, String> {
        match (is_belt, self.link) {
            (true, Link::Frames) => Err(String::from(
                "--link frames: a machine with one belt has digits only: --link digits, or no --link",
            )),
            (true, _) => Ok(Link::Digits),
            (false, link) => Ok(link),
        }
    }

    fn recorder(
        &self,
        machine: &Machine,
        link: Link,
        mark: DrawingMark,
        resume: Option<ResumePoint>,
        boot: Option<u32>,
    ) -> Result<FileWriter, String> {
        let header = match (machine.kind(), &self.port) {
            (MachineKind::Belt, None) => belt_header(machine),
            (MachineKind::Belt, Some(_)) => {
                let start = &OneBeltConfig::of(machine).belt;
                header_of(machine, "digits", None)
                    .with_decimal("begins_x_mm", start.start_x_mm)
                    .with_decimal("begins_y_mm", start.start_y_mm)
                    .with_decimal("reached_tolerance_counts", belt_tolerance(machine))
            }
            _ => header_of(machine, if matches!(link, Link::Digits) { "digits" } else { "link" }, boot),
        };
        let header = header.with_text("clock", if self.port.is_some() { "host" } else { "simulated" });
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
        let dc = DcConfig::of(machine);
        page.is_simulated = self.port.is_none();
        page.has_hand = true;
        page.ramps = machine.kind() == MachineKind::Belt;
        page.supply_v = Some([dc.x.motor.supply_v, dc.y.motor.supply_v]);
        page.pens.clone_from(&self.pens);
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
            fact("resolution", format!("{} × {} counts/mm", dc.x.counts_per_mm, dc.y.counts_per_mm)),
            fact("area", format!("{} × {} mm", config.area.width_mm, config.area.height_mm)),
            fact("origin P1", String::from("0, 0 mm (lower left)")),
            fact("recording", self.output.display().to_string()),
        ];
    }
}

/// What a session needs of a machine of targets that is led by hand.
pub(super) struct TargetsByHand {
    pub(super) line: Arc<dyn Line>,
    pub(super) settings: SessionSettings,
    pub(super) name: String,
}

/// A machine of targets for who leads it by hand: on a port, or simulated in this program.
pub(super) fn targets_by_hand(
    machine: &Machine,
    port: Option<&str>,
    speed: f64,
) -> Result<TargetsByHand, String> {
    let config = machine.config();
    let is_belt = machine.kind() == MachineKind::Belt;
    let plotter = targets_plotter(machine);
    let boot = clock_bits();
    let (line, name): (Arc<dyn Line>, _) = match port {
        Some(name) => {
            let name = find(name).map_err(|error| error.to_string())?;
            (open_line(&name, config.serial.baud, false)?, name)
        }
        None => {
            let spoken = if is_belt { Spoken::Digits } else { Spoken::Link { boot } };
            let simulated = SimulatedMachine::speaking(machine, spoken).map_err(|error| error.to_string())?;
            (Arc::new(simulated.line(speed)), String::from("none: simulated in this program"))
        }
    };
    let settings = SessionSettings {
        plotter,
        byte_gap: Duration::from_secs_f64(config.serial.byte_gap_ms / 1e3),
        host: HostSettings { tolerance_counts: plotter.reached_tolerance_counts, ..HostSettings::default() },
        most: Some(most_counts(machine)),
        stands_at: plotter.begins_at.map_or(StepPoint::default(), |at| plotter.to_counts(at)),
        link: if is_belt { LinkChoice::Digits } else { LinkChoice::Auto },
        nonce: u16::try_from(boot & 0xffff).unwrap_or(1),
        baud: config.serial.baud,
        ..SessionSettings::default()
    };
    Ok(TargetsByHand { line, settings, name })
}

/// Where the sheet lies under the counts of a machine of targets, and where it stands when it is switched on.
fn targets_plotter(machine: &Machine) -> PlotterSettings {
    let OneBeltConfig { dc, belt, .. } = OneBeltConfig::of(machine);
    let scale = PlotterSettings {
        x_mm_per_pulse: 1.0 / dc.x.counts_per_mm,
        y_mm_per_pulse: 1.0 / dc.y.counts_per_mm,
        ..PlotterSettings::default()
    };
    if machine.kind() != MachineKind::Belt {
        return scale;
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "counts of an allowed error that is at most 100 mm"
    )]
    let tolerance = belt_tolerance(machine) as u32;
    PlotterSettings {
        begins_at: Some(Point::new(belt.start_x_mm, belt.start_y_mm)),
        reached_tolerance_counts: tolerance,
        ..scale
    }
}

/// The greatest counts that the machine reaches.
fn most_counts(machine: &Machine) -> StepPoint {
    let config = machine.config();
    let dc = DcConfig::of(machine);
    StepPoint::new(
        from_mm(config.area.width_mm, dc.x.counts_per_mm),
        from_mm(config.area.height_mm, dc.y.counts_per_mm),
    )
}

/// The steps of a drawing, as they are asked for; what cannot be read or reached was said before.
fn steps(
    drawing: &DrawingFile,
    machine: &Machine,
) -> Result<Box<dyn Iterator<Item = DrawingStep> + Send>, String> {
    let ops = drawing.ops(DcConfig::of(machine).x.counts_per_mm)?.filter_map(Result::ok);
    Ok(Box::new(drawing_steps(machine, ops).filter_map(Result::ok)))
}

/// What is known of a drawing before it begins.
#[derive(Debug, Default)]
struct Known {
    mark: DrawingMark,
    bounds: Option<(StepPoint, StepPoint)>,
    time: TargetsTime,
}

impl Known {
    /// Goes through a drawing once, for its length and picture; says what of it cannot be drawn, and how much
    /// that is.
    fn look_through(
        &mut self,
        drawing: &DrawingFile,
        path: &Path,
        machine: &Machine,
        page: &mut LivePage,
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
        let ops = drawing.ops(DcConfig::of(machine).x.counts_per_mm)?;
        let ops = ops.filter_map(|item| item.map_err(note).ok());
        for step in drawing_steps(machine, ops) {
            match step {
                Ok(DrawingStep::Move(next)) => self.push(next, machine, page),
                Ok(DrawingStep::Pen(pen)) => page.take_pen(pen),
                Ok(DrawingStep::Sheet) => {}
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
        page.takes(self.time.total());
        Ok(errors)
    }

    fn push(&mut self, next: PenMove, machine: &Machine, page: &mut LivePage) {
        let before = page.plan().way_mm;
        page.push(next);
        self.mark.push(next);
        self.time.push(machine, page.plan().way_mm - before);
        let StepPoint { x, y } = next.target;
        let (low, high) = self.bounds.unwrap_or_default(); // from the origin on, where the drawing begins
        let least = StepPoint::new(low.x.min(x), low.y.min(y));
        self.bounds = Some((least, StepPoint::new(high.x.max(x), high.y.max(y))));
    }
}

/// How long a machine takes that comes to rest at each target: a trapezoid of its speed and acceleration for
/// each.
#[derive(Clone, Copy, Debug, Default)]
struct TargetsTime {
    time_s: f64,
}

impl TargetsTime {
    fn push(&mut self, machine: &Machine, length_mm: f64) {
        let plan = &DcConfig::of(machine).control.contouring;
        let (speed, accel) = (plan.feed_mm_s, plan.accel_mm_s2);
        let ramps_mm = speed * speed / accel;
        self.time_s += if length_mm >= ramps_mm {
            length_mm / speed + speed / accel
        } else {
            2.0 * (length_mm / accel).sqrt()
        };
        self.time_s += plan.settle_ms / 1e3;
    }

    fn total(self) -> Duration {
        Duration::try_from_secs_f64(self.time_s).unwrap_or_default()
    }
}
