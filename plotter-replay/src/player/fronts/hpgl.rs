//! [`Hpgl`]: a stepper plotter that speaks to its host as a Hewlett-Packard 7475A on a serial line does.

use super::device_control::{DeviceControl, OUT_OF_RANGE, Said};
use super::inner::{Answer, Inner};
use super::plotter_questions::{Followed, Question};
use super::sheet_lines::{arc_line, is_circle_within, line_to, within};
use crate::log::SwitchName;
use crate::player::gantry::limit;
use crate::player::{Controller, ControllerError};
use core::time::Duration;
use plotter_motion::firmware::stepper_plotter::{Dialect, StepperPlotterSettings};
use plotter_motion::hpgl::{Interpreter, ReadOptions, Reader, UNITS_PER_MM};
use plotter_motion::toolpath::chords;
use plotter_motion::{Machine, Pen, PlotOp, Point, StepPair};
use std::collections::VecDeque;

/// Size of the input buffer, bytes.
const BUFFER: usize = 1024;
/// A host that was stopped by XOFF is told to go on when the buffer is half empty. Where the threshold of
/// XOFF lies above that, it is told so one byte above the threshold, as the HP 7470A's manual has it
/// (page 10-20).
const XON_AT: usize = BUFFER / 2;
/// Threshold of XOFF while `ESC .I` gives none, bytes that are free.
const XOFF_AT: usize = 80;
/// The carousel takes as long, s.
const PEN_CHANGE: &str = "G4 P1";
/// Pens in the carousel.
const PENS: u8 = 6;
/// Error of `ESC .E`: the buffer has overflown.
const OVERFLOW: u8 = 16;
/// How far chords may be from an arc that leaves the area, mm.
const CHORD_TOLERANCE_MM: f64 = 0.01;
/// Greatest character that a host may choose: ASCII.
const MOST_CHARACTER: u32 = 127;

/// What is to be done next.
#[derive(Clone, Debug, PartialEq)]
enum Task {
    /// A line for the plotter.
    Line(String),
    /// The host is answered.
    Answer(Question),
}

/// How the host is told to wait, and how it is answered.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Handshake {
    /// XOFF is sent when fewer bytes are free.
    threshold: usize,
    xon: Vec<u8>,
    xoff: Vec<u8>,
    /// `ESC .I` asks for another handshake, by an enquiry.
    enquires: bool,
    terminator: Vec<u8>,
    initiator: Vec<u8>,
}

impl Default for Handshake {
    fn default() -> Self {
        Self {
            threshold: XOFF_AT,
            xon: Vec::new(),
            xoff: Vec::new(),
            enquires: false,
            terminator: vec![b'\r'],
            initiator: Vec::new(),
        }
    }
}

impl Handshake {
    fn stops_host(&self) -> bool {
        !self.enquires && !self.xon.is_empty() && !self.xoff.is_empty()
    }
}

/// A controller that answers as a 7475A with its usual output terminator.
///
/// - Device control acts when its last byte comes; instructions wait in a buffer of 1024 bytes. What finds no
///   room there is lost, which is error 16 of `ESC .E`.
/// - `ESC .B` tells the bytes that are free, `ESC .L` the size of the buffer once it is empty, `ESC .O`
///   whether it is empty (8) and whether the machine was stopped at its own controls (16).
/// - `ESC .I` and `ESC .N` choose the characters and the threshold of XON and XOFF, `ESC .M` those of
///   answers, `ESC .R` the usual ones. `ESC .K` drops what is buffered; what the plotter has planned is still
///   drawn. `ESC .@` lets the line DTR go down below the threshold of XOFF; its buffer has one size. The
///   handshake by enquiry is not there.
/// - A pen change takes 1 s, during which the machine stands. Lines are cut at the area.
/// - A limit switch or the button stops the machine until it is reset.
///
/// Source: *HP 7475A Interfacing and Programming Manual*, chapters on output and on RS-232-C interfacing.
#[derive(Debug)]
pub(crate) struct Hpgl {
    inner: Inner,
    area_mm: [f64; 2],
    feed_mm_min: f64,
    options: ReadOptions,
    control: DeviceControl,
    handshake: Handshake,
    /// XOFF has been sent.
    host_waits: bool,
    /// The line DTR goes down when the buffer is nearly full (`ESC .@`), and is down.
    drives_dtr: bool,
    dtr_is_down: bool,
    buffer: VecDeque<u8>,
    /// The error of the interface.
    error: u8,
    /// The host wants to know the size of the empty buffer.
    wants_size: bool,
    reader: Reader,
    interpreter: Box<Interpreter>,
    followed: Followed,
    tasks: VecDeque<Task>,
    /// Where the text has sent the pen, and where the plotter was sent, mm.
    commanded: Point,
    sent: Point,
    /// Whether the plotter was told to lower it.
    lowered: bool,
    stopped: bool,
    out: VecDeque<u8>,
}

impl Hpgl {
    /// The machine with this description, switched on.
    ///
    /// # Errors
    ///
    /// [`ControllerError`] for a machine with a laser, or limits that nothing can be planned with.
    pub(crate) fn new(machine: &Machine) -> Result<Self, ControllerError> {
        let settings = StepperPlotterSettings::of(machine, Dialect::Grbl);
        let stored = settings.stored;
        let area_mm = [stored.width_mm, stored.height_mm].map(f64::from);
        let options = options(area_mm);
        let mut hpgl = Self {
            feed_mm_min: settings.planner.speed_mm_s * 60.0,
            inner: Inner::new(settings)?,
            area_mm,
            options,
            control: DeviceControl::default(),
            handshake: Handshake::default(),
            host_waits: false,
            drives_dtr: false,
            dtr_is_down: false,
            buffer: VecDeque::new(),
            error: 0,
            wants_size: false,
            reader: Reader::new(),
            interpreter: Box::new(Interpreter::with_options(options)),
            followed: Followed::new(&options),
            tasks: VecDeque::new(),
            commanded: Point::ORIGIN,
            sent: Point::ORIGIN,
            lowered: false,
            stopped: false,
            out: VecDeque::new(),
        };
        hpgl.unlock();
        Ok(hpgl)
    }

    /// The plotter behind it.
    #[cfg(feature = "live")]
    pub(crate) fn plotter(&self) -> &plotter_motion::firmware::StepperPlotter {
        self.inner.plotter()
    }

    fn unlock(&mut self) {
        self.tasks.push_back(Task::Line(String::from("$X")));
    }

    /// It is switched off and on again: its motors keep their place.
    fn restart(&mut self, now: Duration) {
        self.inner.restart(now);
        self.drop_drawing();
        *self.interpreter = Interpreter::with_options(self.options);
        self.followed = Followed::new(&self.options);
        (self.control, self.handshake) = (DeviceControl::default(), Handshake::default());
        (self.host_waits, self.error, self.wants_size) = (false, 0, false);
        (self.drives_dtr, self.dtr_is_down) = (false, false);
        (self.lowered, self.stopped) = (false, false);
        self.sent = self.inner.position_mm();
        self.commanded = self.sent;
        self.unlock();
        self.work(now);
    }

    /// Forgets what has been read and is not drawn.
    fn drop_drawing(&mut self) {
        self.buffer.clear();
        self.tasks.clear();
        self.reader = Reader::new();
        while self.interpreter.next_op().is_some() {}
    }

    fn free(&self) -> usize {
        BUFFER.saturating_sub(self.buffer.len())
    }

    fn reply(&mut self, text: &str) {
        let Handshake { initiator, terminator, .. } = &self.handshake;
        self.out.extend(initiator.iter().copied().chain(text.bytes()).chain(terminator.iter().copied()));
    }

    fn data(&mut self, byte: u8) {
        if self.free() == 0 {
            self.error = OVERFLOW;
            return;
        }
        self.buffer.push_back(byte);
        if self.handshake.stops_host() && !self.host_waits && self.free() < self.handshake.threshold {
            self.host_waits = true;
            self.out.extend(&self.handshake.xoff);
        }
        self.dtr_is_down |= self.drives_dtr && self.free() < self.handshake.threshold;
    }

    /// Whether its line DTR lets bytes through.
    #[cfg(feature = "live")]
    pub(crate) const fn lets_bytes_through(&self) -> bool {
        !self.dtr_is_down
    }

    /// Lets the host go on, if there is room again.
    fn let_host_go_on(&mut self) {
        let room = self.handshake.threshold.saturating_add(1).max(XON_AT);
        if self.host_waits && (self.free() >= room || self.buffer.is_empty()) {
            self.host_waits = false;
            self.out.extend(&self.handshake.xon);
        }
        self.dtr_is_down &= self.free() < room && !self.buffer.is_empty();
    }

    fn instruct(&mut self, letter: u8, numbers: &[Option<u32>]) {
        match letter {
            b'B' => self.reply(&self.free().to_string()),
            b'E' => {
                let error = core::mem::take(&mut self.error);
                self.reply(&error.to_string());
            }
            b'J' => (self.out, self.wants_size) = (VecDeque::new(), false),
            b'K' => {
                self.drop_drawing();
                self.let_host_go_on();
            }
            b'L' => self.wants_size = true,
            b'O' => {
                let status = if self.buffer.is_empty() { 8 } else { 0 } + if self.stopped { 16 } else { 0 };
                self.reply(&status.to_string());
            }
            b'R' => {
                self.let_host_go_on();
                (self.handshake, self.host_waits) = (Handshake::default(), false);
            }
            b'H' | b'I' | b'M' | b'N' => self.configure(letter, numbers),
            b'@' => {
                self.drives_dtr = numbers.get(1).copied().flatten().is_some_and(|bits| bits & 1 == 1);
                self.dtr_is_down &= self.drives_dtr;
            }
            _ => {}
        }
    }

    /// `ESC .H`, `ESC .I`, `ESC .M`, `ESC .N`; what is left out is as usual.
    fn configure(&mut self, letter: u8, numbers: &[Option<u32>]) {
        let number = |place: usize| numbers.get(place).copied().flatten();
        let characters = |from: usize| -> Option<Vec<u8>> {
            let given = numbers.get(from..).unwrap_or_default().iter().map(|number| number.unwrap_or(0));
            let given = given.map(|number| u8::try_from(number).ok().filter(|_| number <= MOST_CHARACTER));
            given.collect::<Option<Vec<u8>>>().map(|given| given.into_iter().filter(|&c| c != 0).collect())
        };
        let from = match letter {
            b'H' | b'I' => 1,
            b'M' => 3,
            _ => 1,
        };
        let Some(chosen) = characters(from) else {
            self.error = OUT_OF_RANGE;
            return;
        };
        match letter {
            b'H' | b'I' => {
                let threshold = number(0).and_then(|number| usize::try_from(number).ok()).unwrap_or(XOFF_AT);
                if threshold > BUFFER {
                    self.error = OUT_OF_RANGE;
                    return;
                }
                self.handshake.threshold = threshold;
                self.handshake.enquires = letter == b'H' || number(1).is_some_and(|character| character != 0);
                self.handshake.xon = characters(2).unwrap_or_default();
            }
            b'M' => {
                let one = |place: usize| number(place).and_then(|number| u8::try_from(number).ok());
                let terminator: Vec<u8> = [3, 4].into_iter().filter_map(one).filter(|&c| c != 0).collect();
                let is_usual = number(3).is_none() && number(4).is_none();
                self.handshake.terminator = if is_usual { vec![b'\r'] } else { terminator };
                self.handshake.initiator = one(5).into_iter().filter(|&c| c != 0).collect();
            }
            _ => self.handshake.xoff = chosen,
        }
    }

    /// Goes on as far as it can.
    fn work(&mut self, now: Duration) {
        loop {
            while let Some(answer) = self.inner.answer(now) {
                if let Answer::Alarm(_) = answer {
                    self.stopped = true;
                    self.tasks.clear();
                }
            }
            if self.stopped || !self.inner.is_free() {
                return;
            }
            if let Some(task) = self.tasks.pop_front() {
                match task {
                    Task::Line(line) => self.inner.send(now, &line),
                    Task::Answer(question) => {
                        let at = self.inner.position_mm();
                        let answer = self.followed.answer(question, at, self.commanded, self.area_mm);
                        self.reply(&answer);
                    }
                }
            } else if let Some(outcome) = self.interpreter.next_op() {
                match outcome {
                    Ok(op) => self.draw(op),
                    Err(error) => self.followed.complain(&error),
                }
            } else if let Some(byte) = self.buffer.pop_front() {
                self.let_host_go_on();
                self.read(byte);
            } else {
                if core::mem::take(&mut self.wants_size) {
                    self.reply(&BUFFER.to_string());
                }
                return;
            }
        }
    }

    fn read(&mut self, byte: u8) {
        let Some(event) = self.reader.push(byte) else { return };
        let question = event.as_ref().ok().and_then(|event| self.followed.look(event));
        // (all of the event before has been taken)
        let _ = self.interpreter.push(event);
        if let Some(question) = question {
            // When all before is drawn.
            self.tasks.extend([Task::Line(String::from("G4 P0")), Task::Answer(question)]);
        } else if self.followed.pen == Pen::Up {
            self.lift();
        }
    }

    fn line(&mut self, line: String) {
        self.tasks.push_back(Task::Line(line));
    }

    fn lift(&mut self) {
        if core::mem::take(&mut self.lowered) {
            self.line(String::from("M5"));
        }
    }

    /// Lowers it at a place.
    fn lower_at(&mut self, at: Point) {
        if at != self.sent {
            self.lift();
            self.sent = at;
            self.line(line_to(at, None));
        }
        if !core::mem::replace(&mut self.lowered, true) {
            self.line(String::from("M3"));
        }
    }

    /// Carries an operation out, as far as it lies within the area.
    fn draw(&mut self, op: PlotOp) {
        let feed = |feed_mm_s: Option<f64>| {
            feed_mm_s.map_or(self.feed_mm_min, |feed| (feed * 60.0).clamp(1.0, self.feed_mm_min))
        };
        match op {
            PlotOp::Travel { to } => {
                self.lift();
                self.commanded = to;
                if within(to, to, self.area_mm).is_some() && to != self.sent {
                    self.sent = to;
                    self.line(line_to(to, None));
                }
            }
            PlotOp::Draw { to, feed_mm_s } => self.draw_line(to, feed(feed_mm_s)),
            PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s } => {
                let (feed, from) = (feed(feed_mm_s), self.commanded);
                let radius = (from - centre).length().max((to - centre).length());
                if is_circle_within(centre, radius, self.area_mm) {
                    self.lower_at(from);
                    (self.commanded, self.sent) = (to, to);
                    self.line(arc_line(to, centre - from, sweep_rad, Some(feed)));
                    return;
                }
                let path = [PlotOp::Travel { to: from }, op];
                for to in chords(path, CHORD_TOLERANCE_MM).skip(1).filter_map(PlotOp::target) {
                    self.draw_line(to, feed);
                }
            }
            PlotOp::SelectPen { pen } if pen <= PENS => {
                self.lift();
                self.line(String::from(PEN_CHANGE));
            }
            PlotOp::Dwell { duration } => self.line(format!("G4 P{:.3}", duration.as_secs_f64())),
            PlotOp::NewPage => self.lift(),
            _ => {}
        }
    }

    fn draw_line(&mut self, to: Point, feed_mm_min: f64) {
        let from = core::mem::replace(&mut self.commanded, to);
        let Some((begin, end)) = within(from, to, self.area_mm) else {
            return self.lift();
        };
        self.lower_at(begin);
        self.sent = end;
        self.line(line_to(end, Some(feed_mm_min)));
        if end != to {
            self.lift();
        }
    }
}

/// The sheet is the area. P1 and P2 are those of A4 where they lie within, else the area's corners.
fn options(area_mm: [f64; 2]) -> ReadOptions {
    #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
    let [width, height] = area_mm.map(|mm| libm::round(mm * UNITS_PER_MM) as i32);
    let usual = ReadOptions::default();
    let (x2, y2) = usual.p2_units;
    let sheet = ReadOptions { sheet_units: (width, height), ..usual };
    if x2 <= width && y2 <= height {
        return sheet;
    }
    ReadOptions { p1_units: (0, 0), p2_units: (width, height), ..sheet }
}

impl Controller for Hpgl {
    fn receive(&mut self, now: Duration, byte: u8) {
        match self.control.push(byte) {
            Some(Said::Data(byte, second)) => {
                self.data(byte);
                second.into_iter().for_each(|byte| self.data(byte));
            }
            Some(Said::Instruction(letter, numbers)) => self.instruct(letter, &numbers),
            Some(Said::Wrong(error)) => self.error = error,
            None => {}
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
        self.work(now);
    }

    fn next_tick(&self) -> Option<Duration> {
        self.inner.due() // and is done when the steps are fetched: there is nothing to tick
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
        self.inner.pen()
    }
}
