//! [`CommandQueue`]: commands on their way to the motion side, each in as little room as it needs.

use super::{Command, Setting};
use crate::{PlotOp, Point};
use core::time::Duration;

/// Most commands that wait: fifteen, and those of one more line of G-code.
pub const COMMANDS: usize = 27;
/// Most commands that one line of G-code becomes: what the interpreter gives, and what goes before and after it.
pub(super) const COMMANDS_OF_A_LINE: usize = 12;
/// Words that the commands of one line take at most: an arc, three dots with the power of a laser, and what takes a word or two.
const WORDS_OF_A_LINE: usize = 48;
/// Words of a line that is drawn, and of the longest command, an arc.
const WORDS_OF_A_DRAW: usize = 4;
const MOST_WORDS: usize = 7;
/// Words for all: fifteen lines that are drawn, or eight arcs, and one more line of G-code.
const WORDS: usize = (COMMANDS - COMMANDS_OF_A_LINE) * WORDS_OF_A_DRAW + WORDS_OF_A_LINE;

/// The commands that wait, first in, first out: fifteen lines or eight arcs, and those of one more line of G-code.
///
/// ```
/// # use plotter_motion::firmware::stepper_plotter::{Command, CommandQueue};
/// let mut queue = CommandQueue::new();
/// assert_eq!((queue.push(Command::Servo(90)), queue.push(Command::Home)), (Ok(()), Ok(())));
/// assert_eq!((queue.pop(), queue.pop(), queue.pop()), (Some(Command::Servo(90)), Some(Command::Home), None));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CommandQueue {
    /// Of each command first what it is, how many numbers follow, and a small number; then those numbers, the bits of an `f64` each.
    words: [u64; WORDS],
    first: usize,
    used: usize,
    len: usize,
}

impl Default for CommandQueue {
    fn default() -> Self {
        Self::new()
    }
}

impl CommandQueue {
    /// An empty queue.
    #[must_use]
    pub const fn new() -> Self {
        Self { words: [0; WORDS], first: 0, used: 0, len: 0 }
    }

    /// Appends `command`.
    ///
    /// # Errors
    ///
    /// `command` itself when there is no room for it.
    pub fn push(&mut self, command: Command) -> Result<(), Command> {
        let Packed { kind, small, numbers, count } = Packed::of(command);
        if self.len == COMMANDS || WORDS - self.used < count + 1 {
            return Err(command);
        }
        self.put(u64::from(kind) | (count as u64) << 8 | u64::from(small) << 32);
        for number in numbers.iter().take(count) {
            self.put(number.to_bits());
        }
        self.len += 1;
        Ok(())
    }

    fn put(&mut self, word: u64) {
        if let Some(slot) = self.words.get_mut((self.first + self.used) % WORDS) {
            *slot = word;
            self.used += 1;
        }
    }

    fn word(&self, index: usize) -> u64 {
        self.words.get((self.first + index) % WORDS).copied().unwrap_or_default()
    }

    /// The first command, which stays.
    #[must_use]
    pub fn first(&self) -> Option<Command> {
        if self.len == 0 {
            return None;
        }
        let head = self.word(0);
        let [kind, count, ..] = head.to_le_bytes();
        let mut numbers = [0.0; MOST_WORDS - 1];
        for (slot, index) in numbers.iter_mut().zip(1..=usize::from(count)) {
            *slot = f64::from_bits(self.word(index));
        }
        let small = (head >> 32) as u32;
        Some(Packed { kind, small, numbers, count: count.into() }.command())
    }

    /// Takes the first command out.
    pub fn pop(&mut self) -> Option<Command> {
        let command = self.first()?;
        let [_, count, ..] = self.word(0).to_le_bytes();
        let words = 1 + usize::from(count);
        self.first = (self.first + words) % WORDS;
        (self.used, self.len) = (self.used - words, self.len - 1);
        Some(command)
    }

    /// How many more it takes. While that is as many as a line of G-code gives, it takes those of any line.
    #[must_use]
    pub fn room(&self) -> usize {
        let free = WORDS - self.used;
        match free.checked_sub(WORDS_OF_A_LINE) {
            Some(more) => (COMMANDS - self.len).min(COMMANDS_OF_A_LINE + more / WORDS_OF_A_DRAW),
            None => (COMMANDS - self.len).min(free / MOST_WORDS),
        }
    }

    /// How many wait.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Whether there is nothing in it.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }
}

/// A command as words: numbers are those of its operation, in their order.
struct Packed {
    kind: u8,
    small: u32,
    numbers: [f64; MOST_WORDS - 1],
    count: usize,
}

impl Packed {
    fn of(command: Command) -> Self {
        let (kind, small) = match command {
            Command::Plot(op) => return Self::of_op(op),
            Command::Jog { to, speed_mm_s } => {
                let numbers = [to.x, to.y, speed_mm_s, 0.0, 0.0, 0.0];
                return Self { kind: 14, small: 0, numbers, count: 3 };
            }
            Command::Set(Setting { number, value }) => {
                let numbers = [value, 0.0, 0.0, 0.0, 0.0, 0.0];
                return Self { kind: 15, small: number.into(), numbers, count: 1 };
            }
            Command::Servo(deg) => (7, deg.into()),
            Command::PenAngles { up_deg, down_deg } => (8, u32::from(up_deg) | u32::from(down_deg) << 8),
            Command::Home => (9, 0),
            Command::Pause => (10, 0),
            Command::Finish => (11, 0),
            Command::GoOn => (12, 0),
            Command::Unlock => (13, 0),
        };
        Self { kind, small, numbers: [0.0; MOST_WORDS - 1], count: 0 }
    }

    fn of_op(op: PlotOp) -> Self {
        let mut numbers = [0.0; MOST_WORDS - 1];
        let [a, b, c, d, e, f] = &mut numbers;
        let (mut kind, mut small, mut count) = (0, 0, 2);
        // A speed that is left to the machine is none at all.
        let speed = |feed_mm_s: Option<f64>| feed_mm_s.unwrap_or(f64::NAN);
        match op {
            PlotOp::Travel { to } => (*a, *b) = (to.x, to.y),
            PlotOp::Draw { to, feed_mm_s } => {
                (*a, *b, *c) = (to.x, to.y, speed(feed_mm_s));
                (kind, count) = (1, 3);
            }
            PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s } => {
                (*a, *b, *c) = (to.x, to.y, speed(feed_mm_s));
                (*d, *e, *f) = (centre.x, centre.y, sweep_rad);
                (kind, count) = (2, 6);
            }
            PlotOp::LaserPower { share } => {
                *a = share;
                (kind, count) = (3, 1);
            }
            PlotOp::Dwell { duration } => {
                *a = f64::from_bits(duration.as_secs());
                (kind, small, count) = (4, duration.subsec_nanos(), 1);
            }
            PlotOp::SelectPen { pen } => (kind, small, count) = (5, pen.into(), 0),
            PlotOp::NewPage => (kind, count) = (6, 0),
        }
        Self { kind, small, numbers, count }
    }

    fn command(self) -> Command {
        let Self { kind, small, numbers: [a, b, c, d, e, f], .. } = self;
        let [low, high, ..] = small.to_le_bytes();
        let to = Point::new(a, b);
        let feed_mm_s = (!c.is_nan()).then_some(c);
        match kind {
            0 => Command::Plot(PlotOp::Travel { to }),
            1 => Command::Plot(PlotOp::Draw { to, feed_mm_s }),
            2 => Command::Plot(PlotOp::DrawArc { centre: Point::new(d, e), sweep_rad: f, to, feed_mm_s }),
            3 => Command::Plot(PlotOp::LaserPower { share: a }),
            4 => Command::Plot(PlotOp::Dwell { duration: Duration::new(a.to_bits(), small) }),
            5 => Command::Plot(PlotOp::SelectPen { pen: low }),
            6 => Command::Plot(PlotOp::NewPage),
            7 => Command::Servo(low),
            8 => Command::PenAngles { up_deg: low, down_deg: high },
            9 => Command::Home,
            10 => Command::Pause,
            11 => Command::Finish,
            12 => Command::GoOn,
            14 => Command::Jog { to, speed_mm_s: c },
            15 => Command::Set(Setting { number: low, value: a }),
            _ => Command::Unlock,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ARC: Command = Command::Plot(PlotOp::DrawArc {
        centre: Point { x: 1.0, y: -2.0 },
        sweep_rad: 3.0,
        to: Point { x: 4.0, y: 5.0 },
        feed_mm_s: None,
    });
    const LINE: Command = Command::Plot(PlotOp::Draw { to: Point { x: 4.0, y: 5.0 }, feed_mm_s: Some(6.0) });

    #[test]
    fn every_command_comes_out_as_it_went_in_round_the_end_of_the_ring() {
        let commands = [
            ARC,
            LINE,
            Command::Plot(PlotOp::Travel { to: Point { x: -0.0, y: 1e7 } }),
            Command::Plot(PlotOp::LaserPower { share: 0.25 }),
            Command::Plot(PlotOp::Dwell { duration: Duration::new(u64::MAX, 999_999_999) }),
            Command::Plot(PlotOp::SelectPen { pen: 255 }),
            Command::Plot(PlotOp::NewPage),
            Command::Servo(180),
            Command::PenAngles { up_deg: 160, down_deg: 90 },
            Command::Home,
            Command::Pause,
            Command::Finish,
            Command::GoOn,
            Command::Unlock,
            Command::Jog { to: Point { x: 1.0, y: 2.0 }, speed_mm_s: 3.0 },
            Command::Set(Setting { number: 130, value: 200.0 }),
        ];
        let mut queue = CommandQueue::new();
        for _ in 0..20 {
            for command in commands {
                queue.push(command).unwrap();
            }
            assert_eq!(queue.len(), commands.len());
            for command in commands {
                assert_eq!((queue.first(), queue.pop()), (Some(command), Some(command)));
            }
        }
        assert!(queue.is_empty() && queue.pop().is_none());
    }

    #[test]
    fn it_takes_fifteen_lines_or_eight_arcs_and_one_more_line_of_g_code() {
        for (command, count) in [(LINE, 15), (ARC, 8)] {
            let mut queue = CommandQueue::new();
            let mut taken = 0;
            while queue.room() >= COMMANDS_OF_A_LINE {
                // An arc, three dots with power, and more.
                let mut most = queue.clone();
                most.push(ARC).unwrap();
                for _ in 0..3 {
                    most.push(LINE).unwrap();
                    most.push(Command::Plot(PlotOp::LaserPower { share: 1.0 })).unwrap();
                }
                for _ in 0..5 {
                    most.push(Command::Plot(PlotOp::Dwell { duration: Duration::ZERO })).unwrap();
                }
                queue.push(command).unwrap();
                taken += 1;
            }
            assert_eq!(taken, count + 1, "{command:?}");
        }
    }
}
