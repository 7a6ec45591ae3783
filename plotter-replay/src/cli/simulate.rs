//! `simulate`: a machine that is not there, on a pseudo terminal or a port of this computer.

use super::commands::{Done, Verdict, cannot, is_free, read_file, say};
use super::machine::{clock_bits, read_machine, simulated_header};
use crate::PlotterSettings;
use crate::live::{
    Line, LivePage, MachineLog, PortLine, Server, Showing, SimulatedMachine, Spoken, TcpLine, Watch,
};
use crate::log::{self, LogFile};
use crate::serial::Port;
use crate::simulation::{Act, ActError, Script, Seen};
use clap::{Args, ValueEnum};
use plotter_motion::{Direction, Machine, Pen, config::MachineKind};
use std::io::{BufRead as _, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// How often it is looked what the machine does, in our time.
const LOOK_EVERY: Duration = Duration::from_millis(250);
/// How often its place is told while nothing else changes.
const TELL_PLACE_EVERY: Duration = Duration::from_secs(2);
/// Longest script that is read, bytes.
const MOST_SCRIPT_BYTES: u64 = 1 << 20;

/// Options of a simulated machine.
#[derive(Debug, Args)]
pub(crate) struct Simulate {
    /// The machine's description [default: the semi-virtual gantry].
    machine: Option<PathBuf>,
    /// Protocol of the machine [default: grbl with stepper motors, digits with a belt, else link].
    #[arg(long, value_enum)]
    dialect: Option<Dialect>,
    /// Seconds of simulated time per second; the time-outs of the host are not scaled.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = super::machine::speed)]
    speed: f64,
    /// Speak the published digits only, as a machine without the reliable link does: --dialect digits.
    #[arg(long, conflicts_with = "dialect")]
    digits: bool,
    /// Listen on this port of 127.0.0.1 in place of a pseudo terminal; 0 takes any that is free.
    #[arg(long, value_name = "PORT")]
    tcp: Option<u16>,
    /// What is done to the machine, and when: lines as `2.5 press x-min`, seconds of the machine. There are
    /// press NAME, release NAME, cut NAME, stop, free, reset, restart, hold x, let x, lose x STEPS,
    /// paper WIDTH HEIGHT.
    #[arg(long, value_name = "FILE")]
    script: Option<PathBuf>,
    /// Also take lines of a script, without the time, from the keyboard.
    #[arg(long)]
    by_hand: bool,
    /// Also show the machine on a page of this computer, with an emergency stop.
    #[arg(long)]
    page: bool,
    /// Port of 127.0.0.1 for the page; 0 takes any that is free.
    #[arg(long, value_name = "NUMBER", default_value_t = 0, requires = "page")]
    http_port: u16,
    /// Record the inside of the machine, with each edge, duty and step, so that `check` can run its
    /// controller again to the same bytes.
    #[arg(short, long, value_name = "LOG")]
    output: Option<PathBuf>,
    /// Overwrite LOG if it exists.
    #[arg(long, requires = "output")]
    force: bool,
}

/// Protocols.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Dialect {
    /// Grbl 1.1's lines: stepper motors
    Grbl,
    /// The lines of Makeblock's mDraw: stepper motors
    Mdraw,
    /// Lines with checksums, as Marlin 2.1 answers them: stepper motors
    Marlin,
    /// HPGL with device control, as a 7475A on a serial line: stepper motors
    Hpgl,
    /// The commands of an EBB, its motors on one belt as in the AxiDraw: stepper motors
    Ebb,
    /// The commands of an EBB, each motor with an axis of its own as in the EggBot: stepper motors
    Eggbot,
    /// The published ten digits a target: DC motors
    Digits,
    /// The reliable link with a host that calls, else digits: DC motors that each move an axis
    Link,
}

impl Simulate {
    /// Does it until it is ended by Ctrl-C, or the terminal is closed.
    pub(crate) fn run(self, out: &mut impl Write) -> Done {
        let machine = read_machine(self.machine.as_deref())?;
        let spoken = self.spoken(&machine);
        let place = self.machine.as_deref().map_or_else(String::new, |path| format!("{}: ", path.display()));
        let simulated =
            SimulatedMachine::speaking(&machine, spoken).map_err(|error| format!("{place}{error}"))?;
        let simulated = match &self.script {
            Some(path) => simulated.with_script(read_script(path)?),
            None => simulated,
        };
        let (simulated, server) = match self.page {
            true => self.on_page(simulated, &machine, spoken)?,
            false => (simulated, None),
        };
        let log = self.output.as_deref().map(|path| self.log(path, &machine, spoken)).transpose()?;
        let stop = Arc::new(AtomicBool::new(false));
        let asked = Arc::clone(&stop);
        ctrlc::set_handler(move || asked.store(true, Ordering::Relaxed))
            .map_err(|error| format!("Ctrl-C cannot be waited for: {error}"))?;
        let look = server.as_ref().map(|server| format!("look at {}", server.address()));
        let ended = if let Some(port) = self.tcp {
            let line = TcpLine::open(port).map_err(|error| error.to_string())?;
            tell_where(&machine, line.name(), look, out);
            self.serve(simulated, &log, &line, || line.take_news(), &stop, out)
        } else {
            let (end, port) = Port::pseudo_terminal().map_err(|error| error.to_string())?;
            let hint = self.hint(&machine, port.name());
            tell_where(&machine, port.name(), look.into_iter().chain(hint), out);
            let line = PortLine::new(end).map_err(|error| error.to_string())?;
            let ended = self.serve(simulated, &log, &line, Vec::new, &stop, out);
            drop(port); // kept open until here: a program that closes its end must not hang up the machine
            ended
        };
        if let (Some(log), Some(path)) = (log, &self.output) {
            log.finish().map_err(|error| format!("{}: {error}", path.display()))?;
            say(out, &format!("wrote {}", path.display()));
        }
        ended.map(|()| Verdict::Clean)
    }

    /// How `live` leads it, where it does.
    fn hint(&self, machine: &Machine, port: &str) -> Option<String> {
        let described = match (&self.machine, machine.kind()) {
            (_, MachineKind::Belt) => return None,
            (Some(path), _) => format!(" --machine {}", path.display()),
            (None, _) => String::new(),
        };
        Some(format!("try: {} live --port {port}{described} drawing.hpgl", super::program()))
    }

    /// The machine on a page, which is there as long as its server.
    fn on_page(
        &self,
        simulated: SimulatedMachine,
        machine: &Machine,
        spoken: Spoken,
    ) -> Result<(SimulatedMachine, Option<Server>), String> {
        let config = machine.config();
        let settings = PlotterSettings::from_header(&simulated_header(machine, spoken))
            .map_err(|error| error.to_string())?;
        let (session, showing) = Showing::new(settings);
        showing.recording(if self.output.is_some() { "on" } else { "none" });
        let mut page = LivePage::new(config.name.as_str(), settings);
        page.is_simulated = true;
        page.about =
            format!("{} is SIMULATED: no motor turns, at up to {} times its time.", config.name, self.speed);
        page.stops = String::from(
            "The stop presses the simulated machine's emergency stop button; Resume releases it.",
        );
        let fact = |name: &str, value: String| (name.to_owned(), value);
        page.facts = vec![
            fact("baud", config.serial.baud.to_string()),
            fact("area", format!("{} × {} mm", config.area.width_mm, config.area.height_mm)),
        ];
        let area_mm = [0.0, 0.0, config.area.width_mm, config.area.height_mm];
        let server = Server::open(session, self.http_port, |sources| page.finish(area_mm, sources))
            .map_err(|error| error.to_string())?;
        Ok((simulated.shown(showing), Some(server)))
    }

    fn spoken(&self, machine: &Machine) -> Spoken {
        let usual = match machine.kind() {
            _ if self.digits => Dialect::Digits,
            MachineKind::Steppers => Dialect::Grbl,
            MachineKind::Belt => Dialect::Digits,
            MachineKind::Gantry => Dialect::Link,
        };
        match self.dialect.unwrap_or(usual) {
            Dialect::Grbl => Spoken::Grbl,
            Dialect::Mdraw => Spoken::MDraw,
            Dialect::Marlin => Spoken::Marlin,
            Dialect::Hpgl => Spoken::Hpgl,
            Dialect::Ebb => Spoken::Ebb { is_mixed: true },
            Dialect::Eggbot => Spoken::Ebb { is_mixed: false },
            Dialect::Digits => Spoken::Digits,
            Dialect::Link => Spoken::Link { boot: clock_bits() },
        }
    }

    fn log(&self, path: &Path, machine: &Machine, spoken: Spoken) -> Result<MachineLog<LogFile>, String> {
        is_free(path, self.force)?;
        let header = simulated_header(machine, spoken);
        let writer = log::create(path, &header).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(MachineLog::new(writer))
    }

    /// Serves the line, and says what changes.
    fn serve(
        &self,
        simulated: SimulatedMachine,
        log: &Option<MachineLog<LogFile>>,
        line: &dyn Line,
        news: impl Fn() -> Vec<&'static str>,
        stop: &AtomicBool,
        out: &mut impl Write,
    ) -> Result<(), String> {
        let now = Instant::now();
        let typed = self.by_hand.then(typed_acts);
        let mut desk = Desk { typed, looked: now, told: now, seen: Seen::default(), lost_answers: 0 };
        let mut watch = |at: &mut dyn Watched| {
            if stop.load(Ordering::Relaxed) {
                return Watch::End;
            }
            desk.look(at, &news, out);
            Watch::GoOn
        };
        let ended = match log {
            Some(log) => {
                simulated.logged(log.clone()).serve_until(line, self.speed, |machine| watch(machine))
            }
            None => simulated.serve_until(line, self.speed, |machine| watch(machine)),
        };
        ended.map_err(|error| error.to_string())
    }
}

fn tell_where(machine: &Machine, port: &str, hints: impl IntoIterator<Item = String>, out: &mut impl Write) {
    say(out, &format!("{} is simulated on {port}", machine.config().name));
    hints.into_iter().for_each(|hint| say(out, &hint));
    let _ = out.flush(); // who closed it has seen enough: the machine goes on
}

/// A simulated machine, whatever its log is written to.
trait Watched {
    fn now(&self) -> Duration;
    fn seen(&self) -> Seen;
    fn lost_answers(&self) -> u64;
    fn act(&mut self, act: &Act) -> Result<(), ActError>;
}

impl<W: Write> Watched for SimulatedMachine<W> {
    fn now(&self) -> Duration {
        Self::now(self)
    }
    fn seen(&self) -> Seen {
        Self::seen(self)
    }
    fn lost_answers(&self) -> u64 {
        Self::lost_answers(self)
    }
    fn act(&mut self, act: &Act) -> Result<(), ActError> {
        Self::act(self, act)
    }
}

/// Whoever sits before the machine.
#[derive(Debug)]
struct Desk {
    typed: Option<Receiver<String>>,
    looked: Instant,
    told: Instant,
    seen: Seen,
    lost_answers: u64,
}

impl Desk {
    /// Does what is typed, and says what has changed: at once, but where only the place has, now and then.
    fn look(
        &mut self,
        machine: &mut dyn Watched,
        news: impl Fn() -> Vec<&'static str>,
        out: &mut impl Write,
    ) {
        for text in self.typed.iter().flat_map(Receiver::try_iter) {
            let done = text.parse().and_then(|act| machine.act(&act));
            if let Err(error) = done {
                say(out, &error.to_string());
            }
        }
        if self.looked.elapsed() < LOOK_EVERY {
            return;
        }
        self.looked = Instant::now();
        for words in news() {
            say(out, &format!("{:9.3} s  {words}", machine.now().as_secs_f64()));
        }
        let (seen, lost_answers) = (machine.seen(), machine.lost_answers());
        let elsewhere = seen.at != self.seen.at && self.told.elapsed() >= TELL_PLACE_EVERY;
        self.seen.at = seen.at;
        if elsewhere || seen != self.seen || lost_answers != self.lost_answers {
            self.told = Instant::now();
            say(out, &words(machine.now(), &seen, lost_answers));
            (self.seen, self.lost_answers) = (seen, lost_answers);
        }
        let _ = out.flush(); // who closed it has seen enough: the machine goes on
    }
}

/// The lines that are typed, as they come.
fn typed_acts() -> Receiver<String> {
    let (sender, receiver) = channel();
    // Not waited for: the process ends before it.
    std::thread::spawn(move || {
        for line in std::io::stdin().lock().lines().map_while(Result::ok) {
            if !line.trim().is_empty() && sender.send(line).is_err() {
                return;
            }
        }
    });
    receiver
}

fn read_script(path: &Path) -> Result<Script, String> {
    let bytes = read_file(path, MOST_SCRIPT_BYTES)?;
    let text = String::from_utf8(bytes)
        .map_err(|error| cannot("read", path, &std::io::Error::other(error.utf8_error())))?;
    Script::parse(&text).map_err(|error| format!("{}: {error}", path.display()))
}

/// A state in a line.
fn words(now: Duration, seen: &Seen, lost_answers: u64) -> String {
    let mut words = format!(
        "{:9.3} s  {} at ({:.2}, {:.2}) mm",
        now.as_secs_f64(),
        seen.doing,
        // (no minus before a zero)
        seen.at.x + 0.0,
        seen.at.y + 0.0
    );
    match seen.pen {
        Some(Pen::Down) => words.push_str(", pen down"),
        Some(Pen::Up) => words.push_str(", pen up"),
        None => {}
    }
    if let Some(percent) = seen.laser_percent {
        words.push_str(&format!(", laser {percent:.0} %"));
    }
    for (name, axis, end) in [
        ("x-min", plotter_motion::Axis::X, Direction::Minus),
        ("x-max", plotter_motion::Axis::X, Direction::Plus),
        ("y-min", plotter_motion::Axis::Y, Direction::Minus),
        ("y-max", plotter_motion::Axis::Y, Direction::Plus),
    ] {
        if seen.pressed.blocks(axis, end) {
            words.push_str(&format!(", {name} pressed"));
        }
    }
    let [x, y] = seen.lost_steps;
    if [x, y] != [0, 0] {
        words.push_str(&format!(", lost steps: x {x}, y {y}"));
    }
    if seen.is_off_paper {
        words.push_str(", beside the paper");
    }
    if lost_answers > 0 {
        words.push_str(&format!(", {lost_answers} bytes said that nobody has read"));
    }
    if let Some(why) = &seen.broken {
        words.push_str(&format!(", stands for ever: {why}"));
    }
    words
}
