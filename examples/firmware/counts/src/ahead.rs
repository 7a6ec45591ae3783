//! The stepper plotter's controller in two halves on a processor of 100 MHz: what planning takes is how long
//! it takes, and of every tenth of a second the main loop is away for 20 ms. Or on that of an RP2040, which
//! has no unit for numbers with a point.

use crate::counter::{Counter, Tally};
use core::fmt::Write as _;
use core::time::Duration;
use plotter_motion::firmware::StepperPlotter;
use plotter_motion::firmware::stepper_plotter::{
    Activity, Dialect, Drivers, Grbl, Planning, StepperPlotterSettings, Stepping, StepsAhead,
};
use plotter_motion::{LimitSwitches, PlannerSettings, PlotOp, SafetyGate, StepPair};

/// Instructions in a microsecond: at 100 MHz each is taken for a cycle. At the RP2040's 125 MHz for two, as a
/// Cortex-M0+ takes for a load or a branch (Cortex-M0+ Technical Reference Manual, 3.3); others take one.
pub const PER_US: u64 = if cfg!(feature = "rp2040") { 62 } else { 100 };
/// The main loop is away for the last of every so many us.
const EVERY_US: u64 = 100_000;
const AWAY_US: u64 = 20_000;
/// Words between the halves.
pub const WORDS: usize = 8192;

type Plotter = StepperPlotter<Grbl>;

/// What came of a drawing.
#[derive(Default)]
pub struct Figures {
    pub steps: u32,
    pub late: u32,
    pub slowed: u32,
    /// Steps of the way and their times as of the controller in one piece.
    pub is_same: bool,
    pub plan: Tally,
    pub tick: Tally,
    /// Instructions that planning and stepping take, and the share of the processor that this is, 1/1000.
    pub instructions: u64,
    pub busy: u64,
    pub ms: u64,
}

/// A row of steps and of the times between them, as a number: FNV-1a.
struct Row {
    sum: u64,
    last_us: u64,
    count: u32,
}

impl Row {
    const fn new() -> Self {
        Self { sum: 0xCBF2_9CE4_8422_2325, last_us: 0, count: 0 }
    }

    fn add(&mut self, us: u64, step: StepPair) {
        let after = us - self.last_us;
        // Where it stood it may begin again whenever the main loop is there.
        let after = if after > AWAY_US || self.count == 0 { 0 } else { after };
        for byte in after.to_le_bytes().into_iter().chain([step.x as u8, step.y as u8]) {
            self.sum = (self.sum ^ u64::from(byte)).wrapping_mul(0x100_0000_01B3);
        }
        self.last_us = us;
        self.count += 1;
    }
}

/// A line of G-code.
#[derive(Clone, Copy)]
pub struct Line {
    bytes: [u8; 48],
    len: usize,
}

impl Line {
    const EMPTY: Self = Self { bytes: [0; 48], len: 0 };

    /// A line of a text, with its end.
    fn of(text: &str) -> Self {
        let mut line = Self::EMPTY;
        // What is too long is left out, and then the steps are others.
        let _ = write!(line, "{text}\n");
        line
    }
}

impl core::fmt::Write for Line {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        for byte in text.bytes() {
            *self.bytes.get_mut(self.len).ok_or(core::fmt::Error)? = byte;
            self.len += 1;
        }
        Ok(())
    }
}

/// The lines of a text.
pub fn lines(text: &str) -> impl Iterator<Item = Line> {
    text.lines().map(Line::of)
}

/// A drawing in lines.
pub struct Written<I> {
    ops: I,
    is_down: bool,
    /// An operation that waits until the pen is where it should be.
    waits: Option<PlotOp>,
    ended: bool,
}

impl<I: Iterator<Item = PlotOp>> Written<I> {
    pub fn new(ops: I) -> Self {
        Self { ops, is_down: false, waits: None, ended: false }
    }
}

impl<I: Iterator<Item = PlotOp>> Iterator for Written<I> {
    type Item = Line;

    fn next(&mut self) -> Option<Line> {
        let mut line = Line::EMPTY;
        let op = self.waits.take().or_else(|| self.ops.next());
        let _ = match op {
            Some(PlotOp::Travel { to }) if !self.is_down => write!(line, "G0X{:.3}Y{:.3}\n", to.x, to.y),
            Some(PlotOp::Draw { to, .. }) if self.is_down => {
                write!(line, "G1X{:.3}Y{:.3}F50000\n", to.x, to.y)
            }
            Some(op) => {
                self.is_down = !self.is_down;
                self.waits = Some(op);
                line.write_str(if self.is_down { "M3\n" } else { "M5\n" })
            }
            None if core::mem::replace(&mut self.ended, true) => return None,
            None => line.write_str("M5\n"),
        };
        Some(line)
    }
}

/// A program that sends lines and counts characters.
struct Host<I> {
    lines: I,
    /// The next line, which the machine's buffer has not taken.
    line: Option<Line>,
    owed: [usize; 128],
    first: usize,
    count: usize,
    sum: usize,
}

impl<I: Iterator<Item = Line>> Host<I> {
    fn new(mut lines: I) -> Self {
        let line = lines.next();
        Self { lines, line, owed: [0; 128], first: 0, count: 0, sum: 0 }
    }

    /// The next line, if the buffer of the machine takes it.
    fn next(&mut self) -> Option<Line> {
        let line = self.line?;
        if self.sum + line.len > 127 || self.count == self.owed.len() {
            return None;
        }
        self.owed[(self.first + self.count) % self.owed.len()] = line.len;
        (self.count, self.sum) = (self.count + 1, self.sum + line.len);
        self.line = self.lines.next();
        Some(line)
    }

    /// Takes a byte of an answer: each `ok` has one k.
    fn hear(&mut self, byte: u8) {
        if byte == b'k' && self.count > 0 {
            self.sum -= self.owed[self.first];
            self.first = (self.first + 1) % self.owed.len();
            self.count -= 1;
        }
    }

    fn is_done(&self) -> bool {
        self.line.is_none() && self.count == 0
    }
}

pub fn settings(planner: PlannerSettings) -> StepperPlotterSettings {
    StepperPlotterSettings { dialect: Dialect::Grbl, planner, ..StepperPlotterSettings::default() }
}

fn plotter(settings: StepperPlotterSettings) -> Option<Plotter> {
    Plotter::with_modes(settings, SafetyGate::new(LimitSwitches::RELEASED, false)).ok()
}

/// The row of steps of the controller in one piece, whose main loop is always there.
#[inline(never)]
pub fn in_one(planner: PlannerSettings, lines: impl Iterator<Item = Line>) -> u64 {
    let (mut row, mut host) = (Row::new(), Host::new(lines));
    let Some(mut plotter) = plotter(settings(planner)) else { return 0 };
    let mut now = Duration::ZERO;
    // The greeting, which no line is answered by.
    while plotter.transmit(now).is_some() {}
    loop {
        while let Some(step) = plotter.poll(now, Drivers::Ready) {
            row.add(step.at.as_micros() as u64, step.pulse.into());
        }
        let mut heard = false;
        while let Some(byte) = plotter.transmit(now) {
            host.hear(byte);
            heard = true;
        }
        while let Some(line) = host.next() {
            for byte in &line.bytes[..line.len] {
                plotter.receive(now, *byte);
            }
            heard = true;
        }
        match plotter.due() {
            _ if heard => {}
            Some(due) => now = now.max(due),
            None if host.is_done() => return row.sum,
            None => {}
        }
    }
}

/// Both halves and their clock.
struct Board<'a, 'b> {
    planning: Planning<'a, Grbl>,
    stepping: Stepping<'a>,
    counter: &'b Counter,
    /// Instructions since the start.
    now: u64,
    busy: u64,
    row: Row,
    figures: Figures,
}

impl Board<'_, '_> {
    fn us(&self) -> u64 {
        self.now / PER_US
    }

    /// The interrupt, whenever it was due up to now.
    fn interrupts(&mut self) {
        let end_us = self.us();
        let end_32 = end_us as u32;
        // Called since there may be something new.
        if self.stepping.due().is_none() {
            self.interrupt(end_us);
        }
        while let Some(due) = self.stepping.due()
            && end_32.wrapping_sub(due) <= u32::MAX / 2
        {
            self.interrupt(end_us - u64::from(end_32.wrapping_sub(due)));
        }
    }

    fn interrupt(&mut self, at_us: u64) {
        loop {
            let at = core::hint::black_box(at_us as u32);
            let (step, instructions) =
                self.counter.count(|| self.stepping.tick(at, Drivers::Ready).map(StepPair::from));
            // It takes its time from the main loop.
            self.now += u64::from(instructions);
            self.busy += u64::from(instructions);
            let Some(step) = step else { return };
            self.row.add(at_us, step);
            self.figures.tick.add(instructions);
            if self.stepping.due().is_none_or(|due| due.wrapping_sub(at_us as u32) != 0) {
                return;
            }
        }
    }

    /// A call of the main loop, which takes its time.
    fn take(&mut self, instructions: u32) {
        self.now += u64::from(instructions);
        self.busy += u64::from(instructions);
        self.interrupts();
    }

    fn now(&self) -> Duration {
        Duration::from_micros(self.us())
    }
}

/// Draws in two halves; `alone` is the row of steps of the controller in one piece.
#[inline(never)]
pub fn draw(
    counter: &Counter,
    planner: PlannerSettings,
    memory: &mut StepsAhead<WORDS>,
    lines: impl Iterator<Item = Line>,
    alone: u64,
) -> Figures {
    let Some(plotter) = plotter(settings(planner)) else { return Figures::default() };
    let Ok((planning, stepping)) = plotter.split(memory) else { return Figures::default() };
    let figures = Figures::default();
    let mut board = Board { planning, stepping, counter, now: 0, busy: 0, row: Row::new(), figures };
    let mut host = Host::new(lines);
    while board.planning.transmit(Duration::ZERO).is_some() {}
    loop {
        if board.us() % EVERY_US >= EVERY_US - AWAY_US {
            board.now = board.now.next_multiple_of(EVERY_US * PER_US);
            board.interrupts();
        }
        let now = board.now();
        let (more, instructions) = counter.count(|| board.planning.plan(now));
        board.figures.plan.add(instructions);
        board.take(instructions);
        let mut heard = more;
        loop {
            let now = board.now();
            let (byte, instructions) = counter.count(|| board.planning.transmit(now));
            board.take(instructions);
            let Some(byte) = byte else { break };
            host.hear(byte);
            heard = true;
        }
        while let Some(line) = host.next() {
            for byte in &line.bytes[..line.len] {
                let now = board.now();
                let (_, instructions) = counter.count(|| board.planning.receive(now, *byte));
                board.take(instructions);
            }
            heard = true;
        }
        if !heard {
            if host.is_done() && board.planning.status(board.now()).activity == Activity::Idle {
                break;
            }
            board.now += 100 * PER_US;
            board.interrupts();
        }
    }
    board.figures.steps = board.row.count;
    board.figures.late = board.planning.lateness().steps();
    board.figures.slowed = board.planning.underruns().slowed_steps;
    board.figures.is_same = board.row.sum == alone;
    board.figures.instructions = board.busy;
    board.figures.busy = board.busy * 1000 / board.now.max(1);
    board.figures.ms = board.us() / 1000;
    board.figures
}
