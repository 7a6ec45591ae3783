//! What came of a re-run: equal, or the first difference.

use crate::compare::{Decoder, line};
use crate::log::{Header, Record};
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

impl Difference {
    /// The same, with what each record says beside it, and the whole of the frame that the place is in.
    /// `records` are those of the recording from its beginning, as [`Player::inputs`](super::Player::inputs)
    /// gives them, `header` is the one for these.
    #[must_use]
    pub fn in_words<I: IntoIterator<Item = Record>>(
        &self,
        header: &Header,
        records: impl Fn() -> I,
    ) -> String {
        let bounds = (self.context.first(), self.context.last());
        let (Some(&(began, _)), Some(&(last, _))) = bounds else { return self.head() };
        let mut decoder = Decoder::new(header);
        let mut told = self.head();
        for (index, record) in (0..=last).zip(records()) {
            let words = decoder.words(&record);
            if index >= began {
                let mark = if index == self.index { '>' } else { ' ' };
                told.push_str(&format!("\n  {mark} {index:>6}  {}", line(&record, &words)));
            }
        }
        if let Answer::Byte { .. } = self.expected
            && let Some((index, words)) = Decoder::frame_at(header, records(), self.index)
        {
            told.push_str(&format!("\n  its frame ends at record {index}: {words}"));
        }
        told
    }

    fn head(&self) -> String {
        let Self { time, index, expected, got, until_then, .. } = self;
        format!(
            "first difference at {} us, record {index}\n  recorded: {expected}\n  now:      {got}\n  equal until then: {until_then}",
            time.as_micros()
        )
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.head())?;
        for (index, record) in &self.context {
            let mark = if *index == self.index { '>' } else { ' ' };
            write!(f, "\n  {mark} {index:>6}  {}", line(record, ""))?;
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

impl core::error::Error for Stuck {}

fn name(axis: Axis) -> char {
    match axis {
        Axis::X => 'x',
        Axis::Y => 'y',
    }
}
