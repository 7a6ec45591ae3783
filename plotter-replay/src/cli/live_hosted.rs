//! `live` with a machine that is led by lines of text: Grbl, mDraw.

use super::commands::{Done, Verdict, say, say_first};
use super::drawing::DrawingFile;
use super::find_machine::{Found, Wanted, find_machine};
use super::live::{LAST_LOOK, LOOK_EVERY, Live};
use super::machine::lines_header;
use super::open_line::{is_net, open_line};
use crate::PlotterSettings;
use crate::live::{
    Command, Line, LivePage, MachineLog, Recording, Server, Session, SessionSettings, SimulatedMachine,
    Spoken, State, Timetable, terminal,
};
use crate::log::{self, Event};
use crate::resume::DrawingMark;
use crate::serial::find;
use clap::ValueEnum;
use plotter_motion::config::{DcConfig, SteppersConfig};
use plotter_motion::config::{MachineKind, PenLift};
use plotter_motion::gcode::{PenControl, WriteOptions};
use plotter_motion::kinematics::{BeltSigns, Cartesian, CoreXy, Kinematics, MotorScale};
use plotter_motion::protocol::ebb::EbbMotionSettings;
use plotter_motion::protocol::hosts::{
    EbbHost, EbbHostSettings, Grbl, Hpgl, HpglFlow, Language, LineHost, LineHostSettings, MDraw, MachineHost,
    Marlin, Tongue,
};
use plotter_motion::{Machine, Pen, PenMove, PlannerSettings, PlotOp, Point};
use std::io::Write;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What is spoken with a machine that is led by lines of text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Protocol {
    /// Found out: its greeting is waited for, then it is asked once in each language
    #[default]
    Auto,
    /// Grbl 1.1, and what is made after it
    Grbl,
    /// Makeblock's XY plotter with mDraw's firmware
    Mdraw,
    /// Marlin 2, with a pen on its first servo
    Marlin,
    /// HPGL on a serial pen plotter with a buffer, as HP's 7475A
    Hpgl,
    /// The EBB of the `AxiDraw`, both motors on one belt; x goes along its short axis, y along its long one
    Ebb,
    /// The EBB of the `EggBot`, each motor with an axis
    Eggbot,
}

/// How a pen plotter says that it has no room.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Flow {
    /// It is asked behind each line (ESC .B)
    #[default]
    Asked,
    /// It sends XOFF and XON
    XonXoff,
    /// Its line DTR, which the cable leads to CTS here: the plotter's stop waits with the rest
    Dtr,
}

impl From<Flow> for HpglFlow {
    fn from(flow: Flow) -> Self {
        match flow {
            Flow::Asked => Self::Asked,
            Flow::XonXoff => Self::XonXoff,
            Flow::Dtr => Self::Dtr,
        }
    }
}

impl Protocol {
    const fn tongue(self) -> Option<Tongue> {
        match self {
            Self::Auto => None,
            Self::Grbl => Some(Tongue::Grbl),
            Self::Mdraw => Some(Tongue::MDraw),
            Self::Marlin => Some(Tongue::Marlin),
            Self::Hpgl => Some(Tongue::Hpgl),
            Self::Ebb | Self::Eggbot => Some(Tongue::Ebb),
        }
    }
}

/// What a log of this language has for its protocol.
pub(super) const fn protocol_of(tongue: Tongue) -> &'static str {
    match tongue {
        Tongue::MDraw => "mdraw",
        Tongue::Marlin => "marlin",
        Tongue::Hpgl => "hpgl",
        Tongue::Ebb => "ebb",
        _ => "grbl",
    }
}

/// How high above the sheet a pen on a Z axis is lifted, mm: clear of paper that curls.
const LIFT_MM: f64 = 2.0;

/// The operations of a drawing.
type Ops = Box<dyn Iterator<Item = PlotOp> + Send>;

/// How a drawing is: what is shown of it, and how long it takes.
struct Known {
    table: Timetable,
    mark: DrawingMark,
    errors: u64,
}

/// A host of lines, which goes on where an earlier one has left the drawing.
fn of_lines<L: Language + Send + 'static>(
    language: L,
    ops: Ops,
    left: Option<(u64, u64)>,
) -> Box<dyn MachineHost + Send> {
    let host = LineHost::new(language, LineHostSettings::default(), ops);
    Box::new(match left {
        Some((done, sent)) => host.resuming(done, sent),
        None => host,
    })
}

/// A host of an EBB.
fn of_ebb<K: Kinematics + Clone + Send + 'static>(
    kinematics: K,
    machine: &Machine,
    ops: Ops,
    left: Option<(u64, u64)>,
) -> Result<Box<dyn MachineHost + Send>, String> {
    let pen_settle = Duration::from_secs_f64(SteppersConfig::of(machine).pen.settle_ms / 1e3);
    let settings = EbbHostSettings {
        planner: PlannerSettings::of(machine),
        motion: EbbMotionSettings { pen_settle, ..EbbMotionSettings::default() },
        ..EbbHostSettings::default()
    };
    let host = EbbHost::new(kinematics, settings, ops).map_err(|error| error.to_string())?;
    Ok(Box::new(match left {
        Some((done, sent)) => host.resuming(done, sent),
        None => host,
    }))
}

/// A host of the language, for this machine.
fn host_of(
    tongue: Tongue,
    is_mixed: bool,
    flow: HpglFlow,
    machine: &Machine,
    ops: Ops,
    left: Option<(u64, u64)>,
) -> Result<Box<dyn MachineHost + Send>, String> {
    let steppers = SteppersConfig::of(machine);
    let settle = Duration::from_secs_f64(steppers.pen.settle_ms / 1e3);
    let height =
        PenControl::Height { up_mm: steppers.pen.down_z_mm + LIFT_MM, down_mm: steppers.pen.down_z_mm };
    let is_height = steppers.pen.lifted_by == PenLift::Height;
    let usual = WriteOptions { settle, feed_mm_s: steppers.planner.speed_mm_s, ..WriteOptions::default() };
    // (once a run, and for as long as it takes)
    let words = |head: &str, degrees: f64| &*format!("{head}{degrees:.0}").leak();
    let (up_deg, down_deg) = (steppers.pen.up_deg, steppers.pen.down_deg);
    Ok(match tongue {
        Tongue::MDraw => of_lines(MDraw::new(words("M1 ", up_deg), words("M1 ", down_deg)), ops, left),
        Tongue::Marlin => {
            // The servo goes at once, in the middle of what is planned: it waits for that.
            let servo = "G4 P0\nM280 P0 S";
            let servo = PenControl::Commands { up: words(servo, up_deg), down: words(servo, down_deg) };
            let pen = if is_height { height } else { servo };
            of_lines(Marlin::new(WriteOptions { pen, ..usual }), ops, left)
        }
        Tongue::Hpgl => of_lines(Hpgl::new().with_flow(flow), ops, left),
        Tongue::Ebb => {
            let steps_per_mm = steppers.x.steps_per_mm;
            if is_mixed {
                let belt = CoreXy::new(BeltSigns::TrackingEquations, steps_per_mm);
                of_ebb(belt.map_err(|error| error.to_string())?, machine, ops, left)?
            } else {
                let scale = |steps_per_mm| MotorScale { steps_per_mm, ..MotorScale::default() };
                let axes = Cartesian::new(scale(steps_per_mm), scale(steppers.y.steps_per_mm));
                of_ebb(axes.map_err(|error| error.to_string())?, machine, ops, left)?
            }
        }
        _ => {
            let pen = if is_height { height } else { usual.pen };
            of_lines(Grbl::new(WriteOptions { pen, ..usual }), ops, left)
        }
    })
}

/// What a session needs of a machine of lines that is led by hand: the line, its host, and its settings.
pub(super) struct LinesByHand {
    pub(super) line: Arc<dyn Line>,
    pub(super) host: Box<dyn MachineHost + Send>,
    pub(super) tongue: Tongue,
    pub(super) settings: SessionSettings,
    pub(super) name: String,
}

/// A machine of lines for who leads it by hand: on a port, or simulated in this program.
pub(super) fn lines_by_hand(
    machine: &Machine,
    port: Option<&str>,
    protocol: Protocol,
    speed: f64,
    out: &mut impl Write,
) -> Result<LinesByHand, String> {
    let config = machine.config();
    let is_mixed = protocol != Protocol::Eggbot;
    let said = |error: &dyn core::fmt::Display| error.to_string();
    let (line, tongue, name, baud): (Arc<dyn Line>, _, _, _) = match port {
        Some(name) => {
            let name = find(name).map_err(|error| said(&error))?;
            let open = |baud| open_line(&name, baud, false);
            let wanted =
                Wanted { tongue: protocol.tongue(), baud: config.serial.baud, is_fixed: is_net(&name) };
            let Found { line, tongue, baud } = match protocol.tongue() {
                Some(tongue) if tongue != Tongue::Hpgl => {
                    Found { line: open(config.serial.baud)?, tongue, baud: config.serial.baud }
                }
                _ => find_machine(&name, wanted, open, out)?,
            };
            (line, tongue, name, baud)
        }
        None => {
            let tongue = protocol.tongue().unwrap_or(Tongue::Grbl);
            let simulated = SimulatedMachine::speaking(machine, spoken_of(tongue, is_mixed))
                .map_err(|error| said(&error))?;
            let name = String::from("none: simulated in this program");
            (Arc::new(simulated.line(speed)), tongue, name, config.serial.baud)
        }
    };
    let plotter = PlotterSettings::from_header(&lines_header(machine, protocol_of(tongue)))
        .map_err(|error| said(&error))?;
    let host = host_of(tongue, is_mixed, HpglFlow::Asked, machine, Box::new(core::iter::empty()), None)?;
    let settings = SessionSettings { plotter, baud, ..SessionSettings::default() };
    Ok(LinesByHand { line, host, tongue, settings, name })
}

/// What a simulated machine speaks.
const fn spoken_of(tongue: Tongue, is_mixed: bool) -> Spoken {
    match tongue {
        Tongue::MDraw => Spoken::MDraw,
        Tongue::Marlin => Spoken::Marlin,
        Tongue::Hpgl => Spoken::Hpgl,
        Tongue::Ebb => Spoken::Ebb { is_mixed },
        _ => Spoken::Grbl,
    }
}

impl Live {
    /// Whether this machine is led by lines of text.
    pub(crate) fn is_led_by_lines(machine: &Machine) -> bool {
        machine.kind() == MachineKind::Steppers
    }

    /// Does it with such a machine.
    pub(crate) fn run_lines(self, machine: &Machine, out: &mut impl Write) -> Done {
        let config = machine.config();
        let dc = DcConfig::of(machine);
        let is_mixed = self.protocol != Protocol::Eggbot;
        let drawing = self.drawing.as_deref().map(DrawingFile::open).transpose()?;
        let plotter = PlotterSettings::from_header(&lines_header(machine, "grbl"))
            .map_err(|error| error.to_string())?;
        let mut page = LivePage::new(config.name.as_str(), plotter);
        let known =
            drawing.as_ref().map(|drawing| self.look_at(drawing, machine, &mut page, out)).transpose()?;
        let left = self.left(known.as_ref())?;
        let mut verdict = Verdict::Clean;
        if known.as_ref().is_some_and(|known| known.errors > 0) {
            verdict = Verdict::Found;
        }
        let mut baud = self.baud.unwrap_or(config.serial.baud);
        let (line, tongue, name, log): (Arc<dyn Line>, _, _, _) = match &self.port {
            Some(name) => {
                let name = find(name).map_err(|error| error.to_string())?;
                let (line, tongue, found) = self.open_lines(&name, config.serial.baud, out)?;
                baud = found;
                (line, tongue, name, None)
            }
            None => {
                let tongue = self.protocol.tongue().unwrap_or(Tongue::Grbl);
                let spoken = spoken_of(tongue, is_mixed);
                let simulated =
                    SimulatedMachine::speaking(machine, spoken).map_err(|error| error.to_string())?;
                let log =
                    self.lines_writer(machine, tongue, known.as_ref(), "simulated").map(MachineLog::new)?;
                let line = simulated.logged(log.clone()).line(self.speed);
                (Arc::new(line), tongue, String::from("none: simulated in this program"), Some(log))
            }
        };
        let header = lines_header(machine, protocol_of(tongue));
        let plotter = PlotterSettings::from_header(&header).map_err(|error| error.to_string())?;
        let recording = match log {
            Some(log) => Recording::Machine(log),
            None => Recording::Line(self.lines_writer(machine, tongue, known.as_ref(), "host")?),
        };
        let counts_per_mm = dc.x.counts_per_mm;
        let ops: Ops = match &drawing {
            Some(drawing) => Box::new(drawing.ops(counts_per_mm)?.filter_map(Result::ok)),
            None => Box::new(core::iter::empty()),
        };
        let host = host_of(tongue, is_mixed, self.flow.into(), machine, ops, left)?;
        let area_mm = [0.0, 0.0, config.area.width_mm, config.area.height_mm];
        self.describe_lines(&mut page, machine, tongue, &name, known.as_ref());
        let settings =
            SessionSettings { plotter, baud, pens: self.pens.clone(), ..SessionSettings::default() };
        let targets = known.as_ref().map_or(0, |known| known.table.plan().targets);
        let has_drawing = known.is_some();
        let session = Session::hosted(line, host, known.map(|known| known.table), Some(recording), settings);
        let state = self.watch_lines(&session, page, machine, &name, area_mm, out)?;
        say(out, &format!("wrote {}", self.output.display()));
        match state {
            State::Failed(why) => {
                Err(format!("{why}; the recording up to here is in {}", self.output.display()))
            }
            _ => {
                let done = session.reached();
                if has_drawing {
                    say(out, &format!("operations: {done} of {targets} drawn"));
                }
                Ok(if done < targets { Verdict::Found } else { verdict })
            }
        }
    }

    /// The port with the machine, in the language that was asked for or that it is found to speak. A pen
    /// plotter's speed is looked for, too: it is set by switches at its back.
    fn open_lines(
        &self,
        name: &str,
        baud: u32,
        out: &mut impl Write,
    ) -> Result<(Arc<dyn Line>, Tongue, u32), String> {
        let open = |baud| open_line(name, baud, self.flow == Flow::Dtr);
        let baud = self.baud.unwrap_or(baud);
        match self.protocol.tongue() {
            Some(tongue) if tongue != Tongue::Hpgl => Ok((open(baud)?, tongue, baud)),
            tongue => {
                let is_fixed = self.baud.is_some() || is_net(name);
                let wanted = Wanted { tongue, baud, is_fixed };
                let Found { line, tongue, baud } = find_machine(name, wanted, open, out)?;
                Ok((line, tongue, baud))
            }
        }
    }

    fn watch_lines(
        &self,
        session: &Session,
        page: LivePage,
        machine: &Machine,
        port: &str,
        area_mm: [f64; 4],
        out: &mut impl Write,
    ) -> Result<State, String> {
        let is_begun = core::cell::Cell::new(!self.start);
        let begin = || {
            if !is_begun.get() && session.state() == State::Ready {
                is_begun.set(true);
                session.command(Command::Start);
            }
        };
        if self.terminal {
            let name = machine.config().name.as_str();
            let is_simulated = self.port.is_none();
            let machine = if is_simulated {
                format!("{name}: no motor turns, at up to {} times its time", self.speed)
            } else {
                format!("on {port}, taken for a {name}")
            };
            let heading = terminal::Heading { machine, is_simulated, area_mm };
            while !is_begun.get() && !session.wait(LOOK_EVERY).is_final() {
                begin();
            }
            let quit = terminal::run(session, &heading).map_err(|error| format!("terminal: {error}"))?;
            return Ok(if quit { session.state() } else { session.wait(LAST_LOOK) });
        }
        let about = page.about.clone();
        let server = Server::open(session.clone(), self.http_port, |sources| page.finish(area_mm, sources))
            .map_err(|error| error.to_string())?;
        say(out, &about);
        say(out, &format!("look at {}", server.address()));
        let _ = out.flush(); // who closed it has seen enough: the machine goes on
        let mut told = State::Connecting;
        let state = loop {
            let state = session.wait(LOOK_EVERY);
            begin(); // only now: nothing moves that cannot be watched and stopped
            if state.is_final() {
                break state;
            }
            if state != told && matches!(state, State::Paused | State::Stopped | State::Locked) {
                say(out, &format!("{}: see the page", state.name()));
                let _ = out.flush();
            }
            told = state;
        };
        let until = Instant::now() + LAST_LOOK;
        while server.connections() > 0 && Instant::now() < until {
            std::thread::sleep(Duration::from_millis(20));
        }
        Ok(state)
    }

    /// Goes through a drawing once: what of it cannot be read, whether the machine reaches all of it, how
    /// long it takes.
    fn look_at(
        &self,
        drawing: &DrawingFile,
        machine: &Machine,
        page: &mut LivePage,
        out: &mut impl Write,
    ) -> Result<Known, String> {
        let path = self.drawing.as_deref().unwrap_or_else(|| std::path::Path::new("-")).display();
        let config = machine.config();
        let dc = DcConfig::of(machine);
        let mut table = Timetable::new(machine).map_err(|error| error.to_string())?;
        let (mut mark, mut errors, mut first) = (DrawingMark::default(), 0_u64, Vec::new());
        let (mut at, mut pen) = (Point::ORIGIN, 1);
        for item in drawing.ops(dc.x.counts_per_mm)? {
            let op = match item {
                Ok(op) => op,
                Err(error) => {
                    errors = errors.saturating_add(1);
                    if first.len() < 20 {
                        first.push(error);
                    }
                    continue;
                }
            };
            table.push(op);
            if let PlotOp::SelectPen { pen: number } = op {
                pen = number.max(1);
            }
            if let Some(to) = op.target() {
                page.push_op(at, op, pen);
                at = to;
                let down = if matches!(op, PlotOp::Travel { .. }) { Pen::Up } else { Pen::Down };
                // (a thousandth of a millimetre tells one drawing from another)
                mark.push(PenMove {
                    pen: down,
                    ..PenMove::from_op(PlotOp::Travel { to }, 1e3).unwrap_or_default()
                });
            }
        }
        if errors > 0 {
            say(out, &format!("{path}: {errors} errors, left out"));
            say_first(out, &first, errors);
        }
        if mark.moves == 0 {
            return Err(format!("{path}: there is nothing in it that this machine could draw"));
        }
        let [x0, y0, x1, y1] = page.area_mm().unwrap_or_default();
        let within = |least: f64, most: f64, size: f64| least >= -0.001 && most <= size + 0.001;
        if !(within(x0, x1, config.area.width_mm) && within(y0, y1, config.area.height_mm)) {
            return Err(format!(
                "{path}: it goes from ({x0:.1}, {y0:.1}) to ({x1:.1}, {y1:.1}) mm, and the machine from (0, 0) to ({}, {}) mm: \
                 move or scale it (`plotter convert --fit`)",
                config.area.width_mm, config.area.height_mm
            ));
        }
        let total = table.finish();
        page.takes(total);
        Ok(Known { table, mark, errors })
    }

    /// Where an earlier host left the drawing: operations done, and sent at most.
    fn left(&self, known: Option<&Known>) -> Result<Option<(u64, u64)>, String> {
        let Some(path) = &self.resume else { return Ok(None) };
        let refused = |error: &dyn core::fmt::Display| format!("{}: {error}", path.display());
        if *path == self.output {
            return Err(refused(&"this log is read for --resume: give another one with -o"));
        }
        let reader = log::open(path).map_err(|error| refused(&error))?;
        let number = |key| reader.header().number(key);
        let wanted = known.map(|known| known.mark);
        #[expect(clippy::cast_precision_loss, reason = "below 2^53")]
        let is_other = wanted.is_some_and(|mark| {
            number("drawing_moves").is_some_and(|moves| moves != mark.moves as f64)
                || number("drawing_check").is_some_and(|check| check != f64::from(mark.check))
        });
        if is_other {
            return Err(refused(&"it was another drawing that this host was sending"));
        }
        let mut left = None;
        for record in reader.filter_map(Result::ok) {
            if let Event::Note(words) = &record.event
                && let Some(numbers) = words.strip_prefix(crate::live::MARK)
                && let Some((done, sent)) = numbers.split_once(' ')
                && let (Ok(done), Ok(sent)) = (done.parse::<u64>(), sent.parse::<u64>())
            {
                left = Some((done, sent));
            }
        }
        // Behind the last note it may have sent as many as a queue holds.
        left.map(|(done, sent)| Some((done, sent.saturating_add(64))))
            .ok_or_else(|| refused(&"no host says in it how far the drawing was: begin the drawing anew"))
    }

    fn lines_writer(
        &self,
        machine: &Machine,
        tongue: Tongue,
        known: Option<&Known>,
        clock: &str,
    ) -> Result<log::FileWriter, String> {
        let header = lines_header(machine, protocol_of(tongue)).with_text("clock", clock);
        let header = known.map_or(header.clone(), |known| known.mark.written_to(header));
        log::create(&self.output, &header).map_err(|error| format!("{}: {error}", self.output.display()))
    }

    fn describe_lines(
        &self,
        page: &mut LivePage,
        machine: &Machine,
        tongue: Tongue,
        port: &str,
        known: Option<&Known>,
    ) {
        let config = machine.config();
        page.is_simulated = self.port.is_none();
        (page.has_hand, page.is_lines) = (true, true);
        page.pens.clone_from(&self.pens);
        page.shows_done = matches!(tongue, Tongue::Marlin | Tongue::Hpgl | Tongue::Ebb);
        page.about = if page.is_simulated {
            format!("{} is SIMULATED: no motor turns, at up to {} times its time.", config.name, self.speed)
        } else {
            format!("The machine on {port} speaks {tongue} and is taken for a {}.", config.name)
        };
        page.stops = String::from(match tongue {
            Tongue::Grbl | Tongue::Ebb => {
                "The stop is sent at once, past all that waits: the controller stops its motors and forgets what it was sent. \
                 Resume unlocks it and lifts the pen; Resume again goes on with the drawing where it was stopped."
            }
            Tongue::Marlin => {
                "The stop sends M112 at once, past all that waits: the controller halts until it is reset at its own button or \
                 switched off and on, and has lost its place then. Lead it home, or say where it stands, before it goes on."
            }
            Tongue::Hpgl => {
                "This machine's language has NO emergency stop: the button drops what the plotter's buffer holds, and the line under \
                 way is drawn to its end. Keep your hand at the machine's own switch."
            }
            _ => {
                "This machine's language has NO emergency stop: the button sends nothing more, and the line under way is drawn to \
                 its end. Keep your hand at the machine's own switch."
            }
        });
        let fact = |name: &str, value: String| (name.to_owned(), value);
        page.facts = vec![
            fact("port", port.to_owned()),
            fact("language", tongue.to_string()),
            fact("baud", config.serial.baud.to_string()),
            fact("area", format!("{} × {} mm", config.area.width_mm, config.area.height_mm)),
            fact("recording", self.output.display().to_string()),
        ];
        if let Some(known) = known {
            let plan = known.table.plan();
            page.facts.push(fact(
                "drawing",
                format!("{} operations, {:.2} m of way", plan.targets, plan.way_mm / 1e3),
            ));
        }
    }
}
