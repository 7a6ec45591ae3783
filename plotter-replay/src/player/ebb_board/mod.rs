//! [`EbbBoard`]: the board of the AxiDraw and of the EggBot.

mod commands;
mod motion;
mod parameters;
mod servo;

use self::commands::Left;
use self::motion::Motion;
use super::Controller;
use crate::log::SwitchName;
use core::time::Duration;
use plotter_motion::protocol::ebb::TICK_HZ;
use plotter_motion::{Pen, StepPair};
use std::collections::VecDeque;

/// Time of a tick.
const TICK: Duration = Duration::from_nanos(1_000_000_000 / TICK_HZ as u64);
/// Longest line, bytes: what is longer is refused.
const MOST_LINE: usize = 256;
/// Bytes of the host that wait behind a command that waits. A board on USB takes none meanwhile, and they
/// wait at the host.
const MOST_WAITING: usize = 65_536;
/// Sixteenths of a full step.
const MOST_PARTS: u8 = 16;

/// An EBB (EiBotBoard) with firmware 2.8.1, as its commands are documented
/// (evil-mad.github.io/EggBot/ebb2.html): its lines come in, answers and steps go out.
///
/// - Steps come at ticks of 40 µs, as the documented accumulators make them. Each step is given as so many
///   sixteenths of a full step as the step mode makes it.
/// - One command waits behind the one that runs. A third one is answered only when it finds room there, and
///   no line behind it is looked at before: not even the one that stops.
/// - The pen's servo goes to where it is sent by its rate, every 24 ms.
/// - Pressing the emergency stop cuts the motors' supply, as pulling its plug does: the board counts on while
///   they stand, and QC says so. A switch of the name `prg` is the board's button.
///
/// Not there: the analog inputs (A, AC), whole ports (C, I, O), timed readings (T), pulses (PC, PG), memory
/// (MR, MW) and CK, which are answered as unknown.
///
/// ```
/// # use plotter_replay::Controller;
/// # use plotter_replay::player::EbbBoard;
/// # use std::time::Duration;
/// let mut board = EbbBoard::switched_on();
/// b"QS\r".iter().for_each(|&byte| board.receive(Duration::ZERO, byte));
/// let answer: Vec<u8> = std::iter::from_fn(|| board.transmit()).collect();
/// assert_eq!(answer, b"0,0\n\rOK\r\n");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EbbBoard {
    motion: Motion,
    /// Ticks since the start.
    ticks: u64,
    /// The line that comes in, and what comes behind it.
    line: Vec<u8>,
    input: VecDeque<u8>,
    ended_line: bool,
    left: VecDeque<Left>,
    output: VecDeque<u8>,
    /// Steps that were made and not fetched.
    steps: VecDeque<(StepPair, u8)>,
    says_ok: bool,
    checks_limits: bool,
    has_motor_power: bool,
    servo_has_power: bool,
    button_was_pressed: bool,
    is_in_bootloader: bool,
    nickname: Vec<u8>,
    layer: u8,
    nodes: u32,
    outputs: [u8; 5],
}

impl EbbBoard {
    /// The board with its motors' supply, as it starts.
    #[must_use]
    pub fn switched_on() -> Self {
        Self {
            motion: Motion::switched_on(),
            ticks: 0,
            line: Vec::new(),
            input: VecDeque::new(),
            ended_line: false,
            left: VecDeque::new(),
            output: VecDeque::new(),
            steps: VecDeque::new(),
            says_ok: true,
            checks_limits: true,
            has_motor_power: true,
            servo_has_power: false,
            button_was_pressed: false,
            is_in_bootloader: false,
            nickname: Vec::new(),
            layer: 0,
            nodes: 0,
            outputs: [0; 5],
        }
    }

    /// Whether a command runs or waits.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        !self.motion.is_idle() || !self.left.is_empty()
    }

    /// Whether the motors have their supply.
    #[must_use]
    pub const fn has_motor_power(&self) -> bool {
        self.has_motor_power
    }

    /// Steps of both motors since they were counted from 0, as QS says them.
    #[must_use]
    pub const fn counted(&self) -> [i32; 2] {
        self.motion.counted
    }

    /// Starts anew. Time, supply and the nickname stay.
    fn restart(&mut self) {
        let Self { ticks, has_motor_power, .. } = *self;
        let (nickname, output) = (core::mem::take(&mut self.nickname), core::mem::take(&mut self.output));
        *self = Self { ticks, has_motor_power, nickname, output, ..Self::switched_on() };
    }

    fn whole_ticks(time: Duration) -> u64 {
        u64::try_from(time.as_nanos() / TICK.as_nanos()).unwrap_or(u64::MAX)
    }

    fn time_of(tick: u64) -> Duration {
        Duration::from_nanos(tick.saturating_mul(u64::try_from(TICK.as_nanos()).unwrap_or(1)))
    }

    /// Ticks in which nothing happens are left out.
    fn skip_to(&mut self, now: Duration) {
        self.ticks = self.ticks.max(Self::whole_ticks(now));
    }

    /// Reads lines until one of them waits.
    fn read(&mut self) {
        loop {
            while let Some(left) = self.left.pop_front() {
                match left {
                    Left::Queue(command) if self.motion.has_room() => self.motion.push(command),
                    Left::Home(rate, to) if self.motion.is_idle() => match self.home(rate, to) {
                        Ok(moves) => moves.into_iter().rev().for_each(|command| {
                            self.left.push_front(Left::Queue(command));
                        }),
                        Err(words) => {
                            self.left.clear();
                            self.say(&format!("!0 Err: {words}\n\r"));
                        }
                    },
                    Left::Queue(_) | Left::Home(..) => {
                        self.left.push_front(left);
                        return;
                    }
                    Left::Say(words) => self.output.extend(words),
                    Left::Ok if self.says_ok => self.output.extend(b"OK\r\n"),
                    Left::Ok => {}
                }
            }
            let Some(byte) = self.input.pop_front() else { return };
            self.take(byte);
        }
    }

    fn take(&mut self, byte: u8) {
        match byte {
            _ if self.is_in_bootloader => {}
            b'\r' | b'\n' if self.ended_line => {}
            b'\r' | b'\n' => {
                self.ended_line = true;
                let line = core::mem::take(&mut self.line);
                self.obey(&line);
            }
            8 => {
                self.line.pop();
            }
            b' '.. => {
                self.ended_line = false;
                self.line.push(byte);
                if self.line.len() >= MOST_LINE {
                    self.line.clear();
                    self.say("!3 Err: RX Buffer overrun\r\n");
                }
            }
            _ => {}
        }
    }
}

impl Controller for EbbBoard {
    fn receive(&mut self, now: Duration, byte: u8) {
        if self.motion.is_idle() {
            self.skip_to(now);
        }
        if self.input.len() < MOST_WAITING {
            self.input.push_back(byte);
        }
        self.read();
    }

    fn transmit(&mut self) -> Option<u8> {
        self.output.pop_front()
    }

    fn switch(&mut self, _: Duration, name: &SwitchName, pressed: bool) {
        match (name.as_str(), pressed) {
            ("prg", true) => self.button_was_pressed = true,
            ("restart", true) => self.restart(),
            _ => {}
        }
    }

    fn emergency_stop(&mut self, _: Duration, pressed: bool) {
        self.has_motor_power = !pressed;
    }

    fn next_tick(&self) -> Option<Duration> {
        let next = self.ticks.saturating_add(1);
        if !self.motion.is_idle() {
            return Some(Self::time_of(next));
        }
        let period = self.motion.servo.period_ticks();
        self.motion.servo.is_under_way().then(|| Self::time_of(next.next_multiple_of(period)))
    }

    fn tick(&mut self, now: Duration) {
        let to = Self::whole_ticks(now);
        // Ticks are left out only where nothing but the servo is under way, which has its pulse in this one.
        if to <= self.ticks {
            return;
        }
        self.ticks = to;
        let steps = self.motion.tick();
        if self.has_motor_power && steps != StepPair::default() {
            let parts = 1_u8 << self.motion.step_mode.clamp(1, 5).saturating_sub(1);
            self.steps.push_back((steps, parts.min(MOST_PARTS)));
        }
        if self.ticks.is_multiple_of(self.motion.servo.period_ticks()) {
            self.motion.servo.pulse();
        }
        self.read();
    }

    fn makes_steps(&self) -> bool {
        true
    }

    fn step(&mut self, _: Duration) -> Option<StepPair> {
        let (steps, parts) = self.steps.front_mut()?;
        let step = *steps;
        *parts -= 1;
        if *parts == 0 {
            self.steps.pop_front();
        }
        Some(step)
    }

    fn pen(&self) -> Option<Pen> {
        Some(self.motion.servo.pen())
    }
}
