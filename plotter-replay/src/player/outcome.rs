//! What came of a re-run: equal, or the first difference.

use crate::log::{Event, Record};
use core::fmt;
use core::time::Duration;
use plotter_motion::{Axis, Direction, Pen};

/// What came of a re-run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Every answer was the recorded one, at the recorded time.
    Equal(Compared),
    /// The first answer that was not.
    FirstDifference(Box<Difference>),
}

/// How much was compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Compared {
    /// Records gone through.
    pub records: u64,
    /// Answered bytes that are equal.
    pub bytes: u64,
    /// Duty cycles that are equal.
    pub duties: u64,
    /// Steps and moves of the pen that are equal.
    pub steps: u64,
}

/// The first difference between a recording and its re-run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// When, by the recording if it says something there, else by the re-run.
    pub time: Duration,
    /// The record at which it shows, from 0.
    pub index: u64,
    /// What was recorded.
    pub expected: Answer,
    /// What the controller did now.
    pub got: Answer,
    /// What was equal until then.
    pub until_then: Compared,
    /// Records before and after, with their index.
    pub context: Vec<(u64, Record)>,
}

/// Something that a controller did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Answer {
    /// Nothing.
    Nothing,
    /// It sent a byte.
    Byte {
        /// When its last bit was through.
        time: Duration,
        /// The byte.
        byte: u8,
    },
    /// It drove a motor.
    Duty {
        /// Which.
        axis: Axis,
        /// Signed steps of the PWM timer.
        duty: i32,
    },
    /// A motor made a step.
    Step {
        /// When.
        time: Duration,
        /// Which.
        axis: Axis,
        /// Which way.
        sign: Direction,
    },
    /// It lifted or lowered the pen.
    Pen {
        /// When.
        time: Duration,
        /// Where to.
        pen: Pen,
    },
    /// It could not be run any further.
    Stuck(Stuck),
}

/// Why a controller cannot be run any further.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stuck {
    /// Its next tick does not go on.
    TicksWithoutEnd {
        /// Where it stays.
        time: Duration,
    },
    /// It sends more than the line can ever take.
    BytesWithoutEnd {
        /// When.
        time: Duration,
    },
    /// It makes more steps at once than a machine can.
    StepsWithoutEnd {
        /// When.
        time: Duration,
    },
    /// The recording is silent for more than an hour.
    LongSilence {
        /// How long.
        silence: Duration,
    },
}

impl Outcome {
    /// Whether all was equal.
    #[must_use]
    pub const fn is_equal(&self) -> bool {
        matches!(self, Self::Equal(_))
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Equal(compared) => write!(f, "equal: {compared}"),
            Self::FirstDifference(difference) => difference.fmt(f),
        }
    }
}

impl fmt::Display for Compared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { records, bytes, duties, steps } = self;
        write!(f, "{bytes} answered bytes and {duties} duty cycles")?;
        if *steps > 0 {
            write!(f, " and {steps} steps and moves of the pen")?;
        }
        write!(f, " in {records} records")
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "first difference at {} us, record {}", self.time.as_micros(), self.index)?;
        writeln!(f, "  recorded: {}", self.expected)?;
        writeln!(f, "  now:      {}", self.got)?;
        write!(f, "  equal until then: {}", self.until_then)?;
        for (index, record) in &self.context {
            let mark = if *index == self.index { '>' } else { ' ' };
            write!(f, "\n  {mark} {index:>6}  {}", Line(record))?;
        }
        Ok(())
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing => write!(f, "nothing"),
            Self::Byte { time, byte } => {
                write!(f, "byte 0x{byte:02x}")?;
                if byte.is_ascii_graphic() {
                    write!(f, " '{}'", char::from(*byte))?;
                }
                write!(f, " at {} us", time.as_micros())
            }
            Self::Duty { axis, duty } => write!(f, "duty {duty} on motor {}", name(*axis)),
            Self::Step { time, axis, sign } => {
                let sign = if *sign == Direction::Plus { '+' } else { '-' };
                write!(f, "step {}{sign} at {} us", name(*axis), time.as_micros())
            }
            Self::Pen { time, pen } => {
                write!(f, "pen {} at {} us", if *pen == Pen::Up { "up" } else { "down" }, time.as_micros())
            }
            Self::Stuck(stuck) => stuck.fmt(f),
        }
    }
}

impl fmt::Display for Stuck {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TicksWithoutEnd { time } => {
                write!(
                    f,
                    "the controller's next tick stays at {} us however often it is run",
                    time.as_micros()
                )
            }
            Self::BytesWithoutEnd { time } => {
                write!(f, "at {} us the controller sends more than the line can take", time.as_micros())
            }
            Self::StepsWithoutEnd { time } => {
                write!(f, "at {} us the controller makes steps without end", time.as_micros())
            }
            Self::LongSilence { silence } => {
                write!(f, "the recording is silent for {} s, too long to be run through", silence.as_secs())
            }
        }
    }
}

fn name(axis: Axis) -> char {
    match axis {
        Axis::X => 'x',
        Axis::Y => 'y',
    }
}

/// A record as its line in the log, without the checksum; long runs of bytes are shortened.
struct Line<'a>(&'a Record);

impl fmt::Display for Line<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const MOST: usize = 16;
        let (channel, bytes) = match &self.0.event {
            Event::Host(bytes) => ('>', bytes),
            Event::Controller(bytes) => ('<', bytes),
            event => {
                let mut line = Vec::new();
                let time_us = u64::try_from(self.0.time.as_micros()).unwrap_or(u64::MAX);
                crate::log::write_line(&mut line, time_us, &event.view());
                let line = String::from_utf8_lossy(&line);
                let covered = line.rsplit_once(" *").map_or(&*line, |(covered, _)| covered);
                return f.write_str(covered);
            }
        };
        write!(f, "{} {channel}", self.0.time.as_micros())?;
        bytes.iter().take(MOST).try_for_each(|byte| write!(f, " {byte:02x}"))?;
        if bytes.len() > MOST { write!(f, " ... ({} bytes)", bytes.len()) } else { Ok(()) }
    }
}
