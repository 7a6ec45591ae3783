//! [`EbbBoard`]: a simulated controller board of the AxiDraw and the EggBot.

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

/// Length of a tick, 40 µs.
const TICK: Duration = Duration::from_nanos(1_000_000_000 / TICK_HZ as u64);
/// Longest line, bytes; a longer one is refused.
const MOST_LINE: usize = 256;
/// Most bytes from the host that are held while a command waits. A real board on USB takes none meanwhile, so
/// that they wait at the host.
const MOST_WAITING: usize = 65_536;
/// Most sixteenths of a full step in one step: a full step.
const MOST_PARTS: u8 = 16;

/// An EBB (EiBotBoard) with firmware 2.8.1, by the documentation of its commands
/// (evil-mad.github.io/EggBot/ebb2.html): it takes lines and gives answers and steps.
///
/// - Steps come at ticks of 40 µs, by the documented accumulators. A step is given as the number of
///   sixteenths of a full step that the step mode makes of it.
/// - One command waits behind the running one. A third is answered only when there is room for it, and no
///   line behind it is read before: not even the one that stops.
/// - The pen's servo moves at its rate, every 24 ms.
/// - The emergency stop cuts the motors' supply, as pulling the plug does: the board continues to count while
///   they stand, and QC reports it. The switch `prg` is the board's button.
///
/// Not simulated, and answered as unknown: the analog inputs (A, AC), whole ports (C, I, O), timed readings
/// (T), pulses (PC, PG), memory (MR, MW) and CK.
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
    /// The line so far.
    line: Vec<u8>,
    /// Bytes that have come and are not read yet.
    input: VecDeque<u8>,
    /// Whether the last byte ended a line.
    ended_line: bool,
    /// Actions of the last line that are left to do.
    left: VecDeque<Left>,
    /// Bytes for the host.
    output: VecDeque<u8>,
    /// Steps made and not fetched yet, each with its sixteenths of a full step.
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
    /// The board after power-on, with its motors' supply connected.
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

    /// Steps of both motors since their counters were cleared, as QS reports them.
    #[must_use]
    pub const fn counted(&self) -> [i32; 2] {
        self.motion.counted
    }

    /// Restarts the firmware. Time, supply and the nickname are kept.
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

    /// Skips ticks in which nothing happens.
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
        // Ticks are skipped only while nothing but the servo moves, and its pulse is in this tick.
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
