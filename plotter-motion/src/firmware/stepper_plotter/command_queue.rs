//! [`CommandQueue`]: commands on their way to the motion side, each in as little room as it needs.

use super::{Command, Setting};
use crate::whole::whole;
use crate::{PlotOp, Point};
use core::time::Duration;

/// Most commands that wait: fifteen, and those of one more line of G-code.
pub const COMMANDS: usize = 27;
/// Most commands that one line of G-code becomes: what the interpreter gives, and what goes before and after it.
pub(super) const COMMANDS_OF_A_LINE: usize = 12;
/// Words that the commands of one line take at most, and some: an arc, two dots, the power of a laser for each, a pause, the pen that is
/// lifted.
const WORDS_OF_A_LINE: usize = 56;
/// Words of a line that is drawn, and of the longest command, an arc.
const WORDS_OF_A_DRAW: usize = 7;
const MOST_WORDS: usize = 13;
/// Words for all: fifteen lines that are drawn, or eight arcs, and one more line of G-code.
const WORDS: usize = (COMMANDS - COMMANDS_OF_A_LINE) * WORDS_OF_A_DRAW + WORDS_OF_A_LINE;
/// Most numbers of a command.
const MOST_NUMBERS: usize = 6;

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
    /// Of each command first what it is, how many numbers follow, and two small ones; then those numbers, the bits of an `f64` in two words.
    words: [u32; WORDS],
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
        let Packed { head, numbers } = Packed::of(command);
        let [_, count, ..] = head;
        if self.len == COMMANDS || WORDS - self.used < words(count) {
            return Err(command);
        }
        self.put(u32::from_le_bytes(head));
        for number in numbers.iter().take(count.into()) {
            let [a, b, c, d, e, f, g, h] = number.to_le_bytes();
            self.put(u32::from_le_bytes([a, b, c, d]));
            self.put(u32::from_le_bytes([e, f, g, h]));
        }
        self.len += 1;
        Ok(())
    }

    fn put(&mut self, word: u32) {
        if let Some(slot) = self.words.get_mut((self.first + self.used) % WORDS) {
            *slot = word;
            self.used += 1;
        }
    }

    fn word(&self, index: usize) -> [u8; 4] {
        self.words.get((self.first + index) % WORDS).copied().unwrap_or_default().to_le_bytes()
    }

    /// The first command, which stays.
    #[must_use]
    pub fn first(&self) -> Option<Command> {
        if self.len == 0 {
            return None;
        }
        let head = self.word(0);
        let [_, count, ..] = head;
        let mut numbers = [0.0; MOST_NUMBERS];
        for (slot, index) in numbers.iter_mut().zip(0..count) {
            let ([a, b, c, d], [e, f, g, h]) = (self.word(words(index)), self.word(words(index) + 1));
            *slot = f64::from_le_bytes([a, b, c, d, e, f, g, h]);
        }
        Some(Packed { head, numbers }.command())
    }

    /// Takes the first command out.
    pub fn pop(&mut self) -> Option<Command> {
        let command = self.first()?;
        let [_, count, ..] = self.word(0);
        self.first = (self.first + words(count)) % WORDS;
        (self.used, self.len) = (self.used - words(count), self.len - 1);
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

/// Words of a command with so many numbers.
fn words(numbers: u8) -> usize {
    1 + 2 * usize::from(numbers)
}

/// A command as it is kept: what it is, how many numbers it has, two small ones; and the numbers.
struct Packed {
    head: [u8; 4],
    numbers: [f64; MOST_NUMBERS],
}

impl Packed {
    fn of(command: Command) -> Self {
        let head = match command {
            Command::Plot(op) => return Self::of_op(op),
            Command::Jog { to, speed_mm_s } => {
                return Self { head: [14, 3, 0, 0], numbers: [to.x, to.y, speed_mm_s, 0.0, 0.0, 0.0] };
            }
            Command::Set(Setting { number, value }) => {
                return Self { head: [15, 1, number, 0], numbers: [value, 0.0, 0.0, 0.0, 0.0, 0.0] };
            }
            Command::Servo(deg) => [7, 0, deg, 0],
            Command::PenAngles { up_deg, down_deg } => [8, 0, up_deg, down_deg],
            Command::Home => [9, 0, 0, 0],
            Command::Pause => [10, 0, 0, 0],
            Command::Finish => [11, 0, 0, 0],
            Command::GoOn => [12, 0, 0, 0],
            Command::Unlock => [13, 0, 0, 0],
        };
        Self { head, numbers: [0.0; MOST_NUMBERS] }
    }

    fn of_op(op: PlotOp) -> Self {
        let mut numbers = [0.0; MOST_NUMBERS];
        let [a, b, c, d, e, f] = &mut numbers;
        // A speed that is left to the machine is no number.
        let speed = |feed_mm_s: Option<f64>| feed_mm_s.unwrap_or(f64::NAN);
        let head = match op {
            PlotOp::Travel { to } => {
                (*a, *b) = (to.x, to.y);
                [0, 2, 0, 0]
            }
            PlotOp::Draw { to, feed_mm_s } => {
                (*a, *b, *c) = (to.x, to.y, speed(feed_mm_s));
                [1, 3, 0, 0]
            }
            PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s } => {
                (*a, *b, *c) = (to.x, to.y, speed(feed_mm_s));
                (*d, *e, *f) = (centre.x, centre.y, sweep_rad);
                [2, 6, 0, 0]
            }
            PlotOp::LaserPower { share } => {
                *a = share;
                [3, 1, 0, 0]
            }
            PlotOp::Dwell { duration } => {
                (*a, *b) = (f64::from_bits(duration.as_secs()), duration.subsec_nanos().into());
                [4, 2, 0, 0]
            }
            PlotOp::SelectPen { pen } => [5, 0, pen, 0],
            PlotOp::NewPage => [6, 0, 0, 0],
        };
        Self { head, numbers }
    }

    fn command(self) -> Command {
        let Self { head: [kind, _, low, high], numbers: [a, b, c, d, e, f] } = self;
        let to = Point::new(a, b);
        let feed_mm_s = (!c.is_nan()).then_some(c);
        match kind {
            0 => Command::Plot(PlotOp::Travel { to }),
            1 => Command::Plot(PlotOp::Draw { to, feed_mm_s }),
            2 => Command::Plot(PlotOp::DrawArc { centre: Point::new(d, e), sweep_rad: f, to, feed_mm_s }),
            3 => Command::Plot(PlotOp::LaserPower { share: a }),
            4 => Command::Plot(PlotOp::Dwell {
                duration: Duration::from_secs(a.to_bits())
                    .saturating_add(Duration::from_nanos(whole(b).unsigned_abs())),
            }),
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
                // One after a stop: two dots and an arc of a laser, a pause for another pen, and the pen is lifted.
                let mut most = queue.clone();
                let power = Command::Plot(PlotOp::LaserPower { share: 1.0 });
                let dwell = Command::Plot(PlotOp::Dwell { duration: Duration::ZERO });
                let travel = Command::Plot(PlotOp::Travel { to: Point::ORIGIN });
                let pen = Command::Plot(PlotOp::SelectPen { pen: 1 });
                for command in [Command::GoOn, power, LINE, pen, power, LINE, dwell, power, ARC] {
                    most.push(command).unwrap();
                }
                for command in [travel, Command::Pause, Command::Finish] {
                    most.push(command).unwrap();
                }
                queue.push(command).unwrap();
                taken += 1;
            }
            assert_eq!(taken, count + 1, "{command:?}");
        }
    }
}
