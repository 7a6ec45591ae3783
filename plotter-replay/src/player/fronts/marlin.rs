//! [`Marlin`]: a stepper plotter that speaks to its host as Marlin 2.1 does.

use super::emergency_parser::{EmergencyParser, Urgent};
use super::inner::{Answer, Inner};
use super::marlin_command::{Command, checksum, line_number, whole};
use super::sheet_lines::{arc_line, is_circle_within, line_to};
use crate::log::SwitchName;
use crate::player::gantry::limit;
use crate::player::{Controller, ControllerError};
use core::f64::consts::TAU;
use core::time::Duration;
use plotter_motion::firmware::stepper_plotter::{Dialect, StepperPlotterSettings};
use plotter_motion::toolpath::chords;
use plotter_motion::{Machine, Pen, PlotOp, Point, StepPair};
use std::collections::VecDeque;

/// Commands that are read and not over, the one in progress among them: `BUFSIZE`.
const MOST_COMMANDS: usize = 4;
/// Bytes that wait to be read: a ring of `RX_BUFFER_SIZE` 128, of which one place stays empty.
const MOST_BYTES: usize = 127;
/// Longest line that is kept, `MAX_CMD_SIZE` less its end; the rest of a longer one is passed over.
const MOST_LINE: usize = 95;
/// A command that takes longer says so as often: `DEFAULT_KEEPALIVE_INTERVAL`.
const BUSY_EVERY: Duration = Duration::from_secs(2);
/// Longest time between two reports of temperatures, s (`M155`).
const MOST_REPORT_SECONDS: f64 = 60.0;
/// Longest pause of a `G4`, s: a day.
const MOST_DWELL_SECONDS: f64 = 86_400.0;
/// Speed of movements while no `F` has come, mm/min.
const FIRST_FEED: f64 = 1_500.0;
/// Speeds that the planner takes, mm/min: its slowest is 0.05 mm/s (`MINIMUM_PLANNER_SPEED`).
const FEEDS: (f64, f64) = (3.0, 1e6);
/// A heater that is off, in a room.
const TEMPERATURES: &str = " T:20.00 /0.00 @:0";
/// An arc whose ends lie more unequally far from its centre is drawn as chords, mm: the plotter refuses it.
const ARC_SLACK_MM: f64 = 0.004;
/// How far chords may be from their arc, mm.
const CHORD_TOLERANCE_MM: f64 = 0.01;

/// A part of a command.
#[derive(Clone, Debug, PartialEq)]
enum Task {
    /// A line for the plotter.
    Line(String),
    /// A pause.
    Sleep(Duration),
    /// The servo goes to this angle, degrees.
    Servo(u8),
    /// The machine has been homed.
    Homed,
    /// The place is that of the motors.
    Placed,
}

/// What it believes of its place, and how it reads coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pose {
    /// Where the commands so far lead: x, y, z and the extruder, mm.
    at: [f64; 4],
    /// What `G92` has added, mm.
    shift: [f64; 4],
    relative: bool,
    unit_mm: f64,
    feed_mm_min: f64,
    homed: bool,
}

impl Pose {
    const NEW: Self = Self {
        at: [0.0; 4],
        shift: [0.0; 4],
        relative: false,
        unit_mm: 1.0,
        feed_mm_min: FIRST_FEED,
        homed: false,
    };
}

/// A controller that answers as Marlin 2.1 with `EMERGENCY_PARSER`, `ARC_SUPPORT` and a servo for the pen,
/// but without `ADVANCED_OK`.
///
/// - A line may have a number and a checksum. One that is damaged, or not the next, is asked for again, and
///   the bytes behind it are dropped.
/// - `ok` comes when a command has been carried out: of a movement, when it is planned.
/// - Movements go at the speed `F` whether the pen is up or down. Until it has been homed the place where it
///   was switched on is (0, 0), and nothing but the frame ends its way; afterwards targets end at the area.
/// - `M280` moves the pen at once, also in the middle of planned ways: a host waits by `M400` before. `M3`
///   and `M5` wait by themselves; they lower and lift.
/// - `M112`, the button, and a limit switch that is met outside of homing halt it until it is reset
///   (`KILL_PIN`). It has lost its place then.
///
/// Source: Marlin's documentation of G-codes; `gcode/queue.cpp`, `feature/e_parser.h` and
/// `gcode/host/M114.cpp` of its source.
#[derive(Debug)]
pub(crate) struct Marlin {
    inner: Inner,
    name: String,
    area_mm: [f64; 2],
    steps_per_mm: [f64; 2],
    /// The servo with the pen up and down, and where it is, degrees.
    up_deg: u8,
    down_deg: u8,
    servo_deg: u8,
    settle: Duration,
    /// Where (0, 0) lies for the plotter, mm.
    origin: Point,
    pose: Pose,
    emergency: EmergencyParser,
    bytes: VecDeque<u8>,
    line: Vec<u8>,
    in_comment: bool,
    last_line: i64,
    commands: VecDeque<Vec<u8>>,
    tasks: VecDeque<Task>,
    sleeps_until: Option<Duration>,
    /// When the command in progress says next that it is not over.
    busy_at: Option<Duration>,
    /// The command in progress has said its `ok`.
    answered: bool,
    /// How often temperatures are told, and when next.
    temperatures: Option<(Duration, Duration)>,
    killed: bool,
    out: VecDeque<u8>,
}

impl Marlin {
    /// The machine with this description, switched on.
    ///
    /// # Errors
    ///
    /// [`ControllerError`] for a machine with a laser, or limits that nothing can be planned with.
    pub(crate) fn new(machine: &Machine) -> Result<Self, ControllerError> {
        let config = machine.config();
        let mut settings = StepperPlotterSettings::of(machine, Dialect::Grbl);
        let settle = settings.pen_settle;
        // The plotter's own pen stays down: this controller moves it, and at the speed of F either way.
        settings.pen_settle = Duration::ZERO;
        settings.planner.speed_mm_s = settings.planner.speed_mm_s.max(settings.planner.travel_speed_mm_s);
        let stored = settings.stored;
        let mut marlin = Self {
            inner: Inner::new(settings)?,
            name: config.name.as_str().to_owned(),
            area_mm: [stored.width_mm, stored.height_mm].map(f64::from),
            steps_per_mm: [settings.x_steps_per_mm, settings.y_steps_per_mm],
            up_deg: stored.pen_up_deg,
            down_deg: stored.pen_down_deg,
            servo_deg: stored.pen_up_deg,
            settle,
            origin: Point::ORIGIN,
            pose: Pose::NEW,
            emergency: EmergencyParser::default(),
            bytes: VecDeque::new(),
            line: Vec::new(),
            in_comment: false,
            last_line: 0,
            commands: VecDeque::new(),
            tasks: VecDeque::new(),
            sleeps_until: None,
            busy_at: None,
            answered: false,
            temperatures: None,
            killed: false,
            out: VecDeque::new(),
        };
        marlin.begin();
        Ok(marlin)
    }

    /// The plotter behind it.
    #[cfg(feature = "live")]
    pub(crate) fn plotter(&self) -> &plotter_motion::firmware::StepperPlotter {
        self.inner.plotter()
    }

    /// Whether it is halted.
    #[cfg(feature = "live")]
    pub(crate) fn is_killed(&self) -> bool {
        self.killed
    }

    /// What it does as soon as it has power.
    fn begin(&mut self) {
        self.tell("start");
        self.tell("echo:Marlin 2.1.2 (simulated)");
        self.unlock();
    }

    /// Makes the plotter take movements.
    fn unlock(&mut self) {
        self.tasks.extend(["$X", "M3"].map(|line| Task::Line(line.to_owned())));
    }

    /// It is reset by its button, or by who opens the port.
    fn restart(&mut self, now: Duration) {
        self.inner.restart(now);
        self.origin = self.inner.position_mm();
        (self.pose, self.emergency) = (Pose::NEW, EmergencyParser::default());
        (self.servo_deg, self.last_line, self.killed, self.answered) = (self.up_deg, 0, false, false);
        (self.sleeps_until, self.busy_at, self.temperatures) = (None, None, None);
        self.drop_bytes();
        self.commands.clear();
        self.tasks.clear();
        self.begin();
        self.work(now);
    }

    fn drop_bytes(&mut self) {
        self.bytes.clear();
        self.line.clear();
        self.in_comment = false;
    }

    fn tell(&mut self, line: &str) {
        self.out.extend(line.bytes().chain([b'\n']));
    }

    fn kill(&mut self, now: Duration) {
        if self.killed {
            return;
        }
        self.inner.reset(now);
        self.killed = true;
        self.drop_bytes();
        self.commands.clear();
        self.tasks.clear();
        (self.sleeps_until, self.busy_at, self.temperatures) = (None, None, None);
        self.tell("Error:Printer halted. kill() called!");
    }

    /// Drops what is planned. The commands that wait are carried out from where it stands.
    fn quick_stop(&mut self, now: Duration) {
        self.inner.reset(now);
        self.tasks.clear();
        self.unlock();
        self.tasks.push_back(Task::Placed);
    }

    /// Goes on as far as it can.
    fn work(&mut self, now: Duration) {
        loop {
            while let Some(answer) = self.inner.answer(now) {
                // 3 and 6 are of a reset that was asked for.
                if matches!(answer, Answer::Alarm(number) if number != 3 && number != 6) {
                    self.kill(now);
                }
            }
            if self.killed {
                return;
            }
            self.gather();
            if !self.inner.is_free() || self.sleeps_until.is_some_and(|until| until > now) {
                return;
            }
            self.sleeps_until = None;
            if let Some(task) = self.tasks.pop_front() {
                self.carry_out(now, task);
            } else if self.busy_at.take().is_some() {
                if !core::mem::take(&mut self.answered) {
                    self.tell("ok");
                }
                self.commands.pop_front();
            } else if let Some(line) = self.commands.front() {
                let command = Command::parse(line);
                self.busy_at = Some(now.saturating_add(BUSY_EVERY));
                self.start(now, &command);
            } else {
                return;
            }
        }
    }

    fn carry_out(&mut self, now: Duration, task: Task) {
        match task {
            Task::Line(line) => self.inner.send(now, &line),
            Task::Sleep(pause) => self.sleeps_until = Some(now.saturating_add(pause)),
            Task::Servo(deg) => self.servo_deg = deg,
            Task::Homed => {
                (self.origin, self.pose.homed) = (Point::ORIGIN, true);
                self.place();
                let place = self.place_words();
                self.tell(&place);
            }
            Task::Placed => self.place(),
        }
    }

    /// Takes the place of the motors for that of the commands.
    fn place(&mut self) {
        let at = self.inner.position_mm() - self.origin;
        let [x, y, ..] = &mut self.pose.at;
        (*x, *y) = (at.x, at.y);
    }

    /// Reads lines as long as there is room for commands.
    fn gather(&mut self) {
        while self.commands.len() < MOST_COMMANDS
            && let Some(byte) = self.bytes.pop_front()
        {
            match byte {
                b'\n' | b'\r' => {
                    self.in_comment = false;
                    let line = core::mem::take(&mut self.line);
                    if !line.is_empty() {
                        self.take_line(line);
                    }
                }
                b';' => self.in_comment = true,
                _ if self.in_comment || self.line.len() >= MOST_LINE => {}
                _ => self.line.push(byte),
            }
        }
    }

    /// Takes a whole line, or asks for it again.
    fn take_line(&mut self, line: Vec<u8>) {
        let text = line.trim_ascii_start();
        if let Some(number) = line_number(text) {
            let sets = text.windows(4).any(|window| window == b"M110");
            // M110 N5: the number that is set stands behind, or is the line's own.
            let number = match text.iter().rposition(|&byte| byte == b'N') {
                Some(place) if sets => whole(text.get(place + 1..).unwrap_or_default()),
                _ => number,
            };
            if number != self.last_line.saturating_add(1) && !sets {
                return self.ask_again("Line Number is not Last Line Number+1");
            }
            let Some(star) = text.iter().rposition(|&byte| byte == b'*') else {
                return self.ask_again("No Checksum with line number");
            };
            let (before, after) = text.split_at_checked(star).unwrap_or_default();
            if whole(after.get(1..).unwrap_or_default()) != i64::from(checksum(before)) {
                return self.ask_again("checksum mismatch");
            }
            self.last_line = number;
        }
        self.commands.push_back(line);
    }

    fn ask_again(&mut self, why: &str) {
        let last = self.last_line;
        self.tell(&format!("Error:{why}, Last Line: {last}"));
        self.drop_bytes();
        self.tell(&format!("Resend: {}", last.saturating_add(1)));
        self.tell("ok");
    }

    /// Begins with a command: what it says at once, and what it does.
    fn start(&mut self, now: Duration, command: &Command) {
        let line = |text: &str| Task::Line(text.to_owned());
        match command.code {
            (b'G', 0 | 1) => self.go(command),
            (b'G', 2) => self.go_round(command, true),
            (b'G', 3) => self.go_round(command, false),
            (b'G', 4) => {
                let milliseconds = command.number(b'P').map(|number| number / 1e3);
                let seconds = command.number(b'S').or(milliseconds).unwrap_or(0.0);
                let pause = Duration::from_secs_f64(seconds.clamp(0.0, MOST_DWELL_SECONDS));
                self.tasks.extend([line("G4 P0"), Task::Sleep(pause)]);
            }
            (b'G', 20) => self.pose.unit_mm = 25.4,
            (b'G', 21) => self.pose.unit_mm = 1.0,
            (b'G', 28) => self.tasks.extend([line("G4 P0"), line("$H"), Task::Homed, line("M3")]),
            (b'G', 90) => self.pose.relative = false,
            (b'G', 91) => self.pose.relative = true,
            (b'G', 92) => self.shift(command),
            (b'M', 3) => self.move_pen(self.down_deg),
            (b'M', 5) => self.move_pen(self.up_deg),
            // The motors stay as they are; what had to be at once has been done when its bytes came.
            (b'M', 17 | 112 | 410) => {}
            (b'M', 18 | 84 | 400) => self.tasks.push_back(line("G4 P0")),
            (b'M', 105) => {
                self.tell(&format!("ok{TEMPERATURES}"));
                self.answered = true;
            }
            (b'M', 110) => {
                if let Some(number) = command.number(b'N') {
                    #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
                    let number = number as i32;
                    self.last_line = i64::from(number);
                }
            }
            (b'M', 114) => {
                let place = self.place_words();
                self.tell(&place);
            }
            (b'M', 115) => self.introduce(),
            (b'M', 155) => {
                let seconds = command.number(b'S').unwrap_or(0.0).clamp(0.0, MOST_REPORT_SECONDS);
                let every = Duration::from_secs_f64(libm::floor(seconds));
                self.temperatures = (!every.is_zero()).then(|| (every, now.saturating_add(every)));
            }
            (b'M', 280) => self.move_servo(command),
            _ => self.tell(&format!("echo:Unknown command: \"{}\"", command.text)),
        }
    }

    fn introduce(&mut self) {
        self.tell(&format!(
            "FIRMWARE_NAME:Marlin 2.1.2 (simulated) SOURCE_CODE_URL:github.com/MarlinFirmware/Marlin \
             PROTOCOL_VERSION:1.0 MACHINE_TYPE:{} EXTRUDER_COUNT:1",
            self.name
        ));
        for (name, has) in [
            ("SERIAL_XON_XOFF", 0),
            ("EEPROM", 0),
            ("AUTOREPORT_POS", 0),
            ("AUTOREPORT_TEMP", 1),
            ("EMERGENCY_PARSER", 1),
            ("HOST_ACTION_COMMANDS", 0),
            ("ARCS", 1),
        ] {
            self.tell(&format!("Cap:{name}:{has}"));
        }
    }

    /// Where the commands so far lead, as `M114` tells it.
    fn place_words(&self) -> String {
        let Pose { at: [x, y, z, e], shift: [shift_x, shift_y, shift_z, shift_e], .. } = self.pose;
        let [x_steps, y_steps] = self.steps_per_mm;
        // (no minus before a zero)
        let [x, y, z, e] = [x + shift_x, y + shift_y, z + shift_z, e + shift_e]
            .map(|mm| if mm.abs() < 0.005 { 0.0 } else { mm });
        let [native_x, native_y, native_z, _] = self.pose.at;
        #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
        let [counts_x, counts_y] =
            [native_x * x_steps, native_y * y_steps].map(|steps| libm::round(steps) as i64);
        #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
        let counts_z = libm::round(native_z) as i64;
        format!("X:{x:.2} Y:{y:.2} Z:{z:.2} E:{e:.2} Count X:{counts_x} Y:{counts_y} Z:{counts_z}")
    }

    /// `G92`: the place has other coordinates; without any, zeros.
    fn shift(&mut self, command: &Command) {
        let Pose { at, shift, unit_mm, .. } = &mut self.pose;
        let letters = [b'X', b'Y', b'Z', b'E'];
        let all = !letters.iter().any(|&letter| command.has(letter));
        for ((letter, at), shift) in letters.into_iter().zip(at).zip(shift) {
            if let Some(number) = command.number(letter).or(all.then_some(0.0)) {
                *shift = number * *unit_mm - *at;
            }
        }
    }

    /// Where a command leads, and its `F`.
    fn target(&mut self, command: &Command) -> [f64; 4] {
        let Pose { at, shift, relative, unit_mm, .. } = self.pose;
        if let Some(feed) = command.number(b'F').filter(|&feed| feed > 0.0) {
            self.pose.feed_mm_min = (feed * unit_mm).clamp(FEEDS.0, FEEDS.1);
        }
        let mut to = at;
        for ((letter, to), shift) in [b'X', b'Y', b'Z', b'E'].into_iter().zip(&mut to).zip(shift) {
            if let Some(number) = command.number(letter) {
                *to = if relative { *to + number * unit_mm } else { number * unit_mm - shift };
            }
        }
        if self.pose.homed {
            for (to, limit) in to.iter_mut().zip(self.area_mm) {
                *to = to.clamp(0.0, limit);
            }
        }
        to
    }

    /// A place for the plotter: the frame ends every way.
    fn on_machine(&self, [x, y, ..]: [f64; 4]) -> Point {
        let [width, height] = self.area_mm;
        let to = Point::new(x, y) + (self.origin - Point::ORIGIN);
        Point::new(to.x.clamp(0.0, width), to.y.clamp(0.0, height))
    }

    fn go(&mut self, command: &Command) {
        let to = self.target(command);
        let (from, place) = (self.on_machine(self.pose.at), self.on_machine(to));
        self.pose.at = to;
        // z and the extruder have no motors.
        if from != place {
            self.tasks.push_back(Task::Line(line_to(place, Some(self.pose.feed_mm_min))));
        }
    }

    fn go_round(&mut self, command: &Command, clockwise: bool) {
        let from = self.pose.at;
        let to = self.target(command);
        let ([x, y, ..], [to_x, to_y, ..]) = (from, to);
        let (from, end) = (Point::new(x, y), Point::new(to_x, to_y));
        let Some(centre) = centre(command, self.pose.unit_mm, from, end, clockwise) else {
            self.tell("Error:G2/G3 bad parameters");
            return;
        };
        self.pose.at = to;
        let (out, back) = (from - centre, end - centre);
        let turned = libm::atan2(out.x * back.y - out.y * back.x, out.x * back.x + out.y * back.y);
        let sweep_rad = match clockwise {
            true if turned >= 0.0 => turned - TAU,
            false if turned <= 0.0 => turned + TAU,
            _ => turned,
        };
        let offset = self.origin - Point::ORIGIN;
        let (radius, feed) = (out.length(), self.pose.feed_mm_min);
        let is_even = (radius - back.length()).abs() <= ARC_SLACK_MM;
        if is_even && is_circle_within(centre + offset, radius, self.area_mm) {
            let line = arc_line(end + offset, centre - from, sweep_rad, Some(feed));
            self.tasks.push_back(Task::Line(line));
            return;
        }
        let path =
            [PlotOp::Travel { to: from }, PlotOp::DrawArc { centre, sweep_rad, to: end, feed_mm_s: None }];
        let places = chords(path, CHORD_TOLERANCE_MM).skip(1).filter_map(PlotOp::target);
        let places: Vec<Point> = places.map(|to| self.on_machine([to.x, to.y, 0.0, 0.0])).collect();
        self.tasks.extend(places.into_iter().map(|place| Task::Line(line_to(place, Some(feed)))));
    }

    /// `M3` and `M5`: when all before is drawn.
    fn move_pen(&mut self, deg: u8) {
        let wait = Task::Line(String::from("G4 P0"));
        self.tasks.extend([wait, Task::Servo(deg), Task::Sleep(self.settle)]);
    }

    /// `M280`: at once.
    fn move_servo(&mut self, command: &Command) {
        let Some(index) = command.number(b'P') else { return };
        if index != 0.0 {
            self.tell(&format!("Error:Servo {index} out of range"));
            return;
        }
        match command.number(b'S') {
            Some(deg) => {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "0 to 180, as clamped"
                )]
                let deg = deg.clamp(0.0, 180.0) as u8;
                self.tasks.extend([Task::Servo(deg), Task::Sleep(self.settle)]);
            }
            None => self.tell(&format!("echo: Servo 0: {}", self.servo_deg)),
        }
    }
}

/// The centre of an arc, mm: by `I` and `J`, or by `R`; the arc of more than half a turn where `R` is
/// negative.
fn centre(command: &Command, unit_mm: f64, from: Point, to: Point, clockwise: bool) -> Option<Point> {
    if let Some(radius) = command.number(b'R').filter(|&radius| radius != 0.0 && from != to) {
        let radius = radius * unit_mm;
        let way = to - from;
        let half = 0.5 * way.length();
        let height = libm::sqrt((radius.abs() - half) * (radius.abs() + half)).max(0.0);
        let side = if clockwise == (radius < 0.0) { 1.0 } else { -1.0 };
        let across = plotter_motion::Vec2::new(-way.y, way.x) * (side * height / (2.0 * half));
        return Some(from + way * 0.5 + across);
    }
    let [i, j] = [b'I', b'J'].map(|letter| command.number(letter).unwrap_or(0.0) * unit_mm);
    (i != 0.0 || j != 0.0).then(|| from + plotter_motion::Vec2::new(i, j))
}

impl Controller for Marlin {
    fn receive(&mut self, now: Duration, byte: u8) {
        if self.killed {
            return;
        }
        match self.emergency.push(byte) {
            Some(Urgent::Kill) => return self.kill(now),
            Some(Urgent::QuickStop) => self.quick_stop(now),
            None => {}
        }
        // What finds no room is lost.
        if self.bytes.len() < MOST_BYTES {
            self.bytes.push_back(byte);
        }
        self.work(now);
    }

    fn switch(&mut self, now: Duration, name: &SwitchName, pressed: bool) {
        if limit(name).is_some() {
            self.inner.switch(now, name, pressed);
            self.work(now);
        } else if pressed && matches!(name.as_str(), "reset" | "restart") {
            self.restart(now);
        }
    }

    fn emergency_stop(&mut self, now: Duration, pressed: bool) {
        self.inner.emergency_stop(now, pressed);
        if pressed {
            self.kill(now);
        }
    }

    fn next_tick(&self) -> Option<Duration> {
        let report = self.temperatures.map(|(_, at)| at);
        [self.inner.due(), self.sleeps_until, self.busy_at, report].into_iter().flatten().min()
    }

    fn tick(&mut self, now: Duration) {
        if let Some(at) = self.busy_at.filter(|&at| at <= now) {
            self.busy_at = Some(at.saturating_add(BUSY_EVERY));
            self.tell("echo:busy: processing");
        }
        if let Some((every, at)) = self.temperatures.filter(|&(_, at)| at <= now) {
            self.temperatures = Some((every, at.saturating_add(every)));
            self.tell(TEMPERATURES);
        }
        self.work(now);
    }

    fn transmit(&mut self) -> Option<u8> {
        None // asked with the time only
    }

    fn transmit_at(&mut self, now: Duration) -> Option<u8> {
        self.work(now);
        self.out.pop_front()
    }

    fn makes_steps(&self) -> bool {
        true
    }

    fn step(&mut self, now: Duration) -> Option<StepPair> {
        self.inner.step(now)
    }

    fn pen(&self) -> Option<Pen> {
        let is_down = self.servo_deg.abs_diff(self.down_deg) < self.servo_deg.abs_diff(self.up_deg);
        Some(if is_down { Pen::Down } else { Pen::Up })
    }
}
