//! [`CommandQueue`]: commands on their way to the motion side, each in as little room as it needs.

use super::{Command, Setting};
use crate::{PlotOp, Point};
use core::time::Duration;

/// Most commands that wait: fifteen, and those of one more line of G-code.
pub const COMMANDS: usize = 27;
/// Most commands that one line of G-code becomes: what the interpreter gives, and what goes before and after
/// it.
pub(super) const COMMANDS_OF_A_LINE: usize = 12;
/// Words that the commands of one line take at most, and some: an arc, two dots, the power of a laser for
/// each, a pause, the pen that is lifted.
const WORDS_OF_A_LINE: usize = 56;
/// Words of a line that is drawn, and of the longest command, an arc.
const WORDS_OF_A_DRAW: usize = 7;
const MOST_WORDS: usize = 13;
/// Words for all: fifteen lines that are drawn, or eight arcs, and one more line of G-code.
const WORDS: usize = (COMMANDS - COMMANDS_OF_A_LINE) * WORDS_OF_A_DRAW + WORDS_OF_A_LINE;
/// Most numbers of a command.
const MOST_NUMBERS: usize = 6;

/// The commands that wait, first in, first out: fifteen lines or eight arcs, and those of one more line of
/// G-code.
///
/// ```
/// # use plotter_motion::firmware::stepper_plotter::{Command, CommandQueue};
/// let mut queue = CommandQueue::new();
/// assert_eq!((queue.push(Command::Servo(90)), queue.push(Command::Home)), (Ok(()), Ok(())));
/// assert_eq!((queue.pop(), queue.pop(), queue.pop()), (Some(Command::Servo(90)), Some(Command::Home), None));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CommandQueue {
    /// Of each command first what it is, how many numbers follow, and two small ones; then those numbers, the
    /// bits of an `f64` in two words.
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
        let speed = |feed_mm_s: Option<f64>| feed_mm_s.unwrap_or(f64::NAN);
        let is_taken = match command {
            Command::Plot(PlotOp::Travel { to }) => self.put(0, [0; 2], &[to.x, to.y]),
            Command::Plot(PlotOp::Draw { to, feed_mm_s }) => {
                self.put(1, [0; 2], &[to.x, to.y, speed(feed_mm_s)])
            }
            Command::Plot(PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s }) => {
                self.put(2, [0; 2], &[to.x, to.y, speed(feed_mm_s), centre.x, centre.y, sweep_rad])
            }
            Command::Plot(PlotOp::LaserPower { share }) => self.put(3, [0; 2], &[share]),
            Command::Plot(PlotOp::Dwell { duration }) => {
                let (whole_s, nanos) = (duration.as_secs(), duration.subsec_nanos());
                self.put(4, [0; 2], &[f64::from_bits(whole_s), f64::from_bits(nanos.into())])
            }
            Command::Plot(PlotOp::SelectPen { pen }) => self.put(5, [pen, 0], &[]),
            Command::Plot(PlotOp::NewPage) => self.put(6, [0; 2], &[]),
            Command::Servo(deg) => self.put(7, [deg, 0], &[]),
            Command::PenAngles { up_deg, down_deg } => self.put(8, [up_deg, down_deg], &[]),
            Command::Home => self.put(9, [0; 2], &[]),
            Command::Pause => self.put(10, [0; 2], &[]),
            Command::Finish => self.put(11, [0; 2], &[]),
            Command::GoOn => self.put(12, [0; 2], &[]),
            Command::Unlock => self.put(13, [0; 2], &[]),
            Command::Jog { to, speed_mm_s } => self.put(14, [0; 2], &[to.x, to.y, speed_mm_s]),
            Command::Set(Setting { number, value }) => self.put(15, [number, 0], &[value]),
            Command::End => self.put(16, [0; 2], &[]),
            Command::Restore => self.put(17, [0; 2], &[]),
            #[cfg(feature = "third-motor")]
            Command::ToZ(mm) => self.put(18, [0; 2], &[mm]),
            #[cfg(feature = "third-motor")]
            Command::JogZ { to, to_z_mm, speed_mm_s } => {
                self.put(19, [0; 2], &[to.x, to.y, speed_mm_s, to_z_mm])
            }
        };
        if is_taken { Ok(()) } else { Err(command) }
    }

    /// Appends what a command is, two small numbers and its others, if there is room for all.
    #[cfg_attr(target_os = "none", inline(never))]
    fn put(&mut self, kind: u8, [low, high]: [u8; 2], numbers: &[f64]) -> bool {
        let count = u8::try_from(numbers.len()).unwrap_or(u8::MAX);
        if self.len == COMMANDS || WORDS - self.used < words(count) {
            return false;
        }
        self.put_word(u32::from_le_bytes([kind, count, low, high]));
        for number in numbers {
            let [a, b, c, d, e, f, g, h] = number.to_le_bytes();
            self.put_word(u32::from_le_bytes([a, b, c, d]));
            self.put_word(u32::from_le_bytes([e, f, g, h]));
        }
        self.len += 1;
        true
    }

    fn put_word(&mut self, word: u32) {
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
                duration: Duration::new(a.to_bits(), u32::try_from(b.to_bits()).unwrap_or_default()),
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
            16 => Command::End,
            17 => Command::Restore,
            #[cfg(feature = "third-motor")]
            18 => Command::ToZ(a),
            #[cfg(feature = "third-motor")]
            19 => Command::JogZ { to, to_z_mm: d, speed_mm_s: c },
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
            Command::End,
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
                // One after a stop: two dots and an arc of a laser, a pause for another pen, and the pen is
                // lifted.
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
