//! [`Word`]: what the halves tell each other, in words of 16 bits.
//!
//! A step is one word: which motors, and how long after the thing before. What all steps of a stretch have in
//! common, their directions and how the machine may brake on them, stands before them.

#[cfg(feature = "third-motor")]
use crate::Axis;
use crate::StepPair;

/// Words of the longest thing: a stretch without its steps.
pub(super) const MOST_WORDS: u32 = 4;
/// Longest time before a step, us; what is longer is a wait, and a step behind it.
pub(super) const MOST_AFTER_US: u16 = 0x3FFF;
/// Longest wait, us: nine minutes, so that a time and another one that is due can be told apart in 32 bits.
pub(super) const MOST_WAIT_US: u32 = 1 << 29;

const KIND: u16 = 0x3800;
const SMALL: u16 = 0x07FF;
const STRETCH: u16 = 0x0000;
const WAIT: u16 = 0x0800;
const PEN: u16 = 0x1000;
const LASER: u16 = 0x1800;
#[cfg(feature = "third-motor")]
const STEP_Z: u16 = 0x2000;
#[cfg(feature = "third-motor")]
const APART: u16 = 0x2800;

/// A stretch of steps in one direction each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Stretch {
    /// Whether the machine stands before it.
    pub(super) from_rest: bool,
    /// Which way each motor steps: 1 towards larger coordinates.
    pub(super) ways: StepPair,
    /// How much of its energy the machine can brake away on each step: see [`super::energy`].
    pub(super) per_step: u16,
    /// The energy that it has, at most.
    pub(super) energy: u32,
}

/// One thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Word {
    /// What holds for the steps that follow.
    Stretch(Stretch),
    /// Nothing for so long, us.
    Wait(u32),
    /// A step of the motors, so long after what was before, us.
    Step {
        /// The first motor.
        x: bool,
        /// The second one.
        y: bool,
        /// At most [`MOST_AFTER_US`].
        after_us: u16,
    },
    /// A step of the third motor, so long after what was before, us.
    #[cfg(feature = "third-motor")]
    StepZ {
        /// Upwards.
        up: bool,
        after_us: u16,
    },
    /// Steps of both motors of an axis, each for itself, so long after what was before, us.
    #[cfg(feature = "third-motor")]
    Apart { axis: Axis, ways: [i8; 2], after_us: u16 },
    /// The servo turns there, degrees.
    Pen(u8),
    /// The laser's power, in 65535ths; whether it ends a darkness that was asked for at once.
    Laser { power: u16, ends_darkness: bool },
}

/// The two halves of a number.
const fn halves(number: u32) -> [u16; 2] {
    let [a, b, c, d] = number.to_le_bytes();
    [u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d])]
}

const fn whole([low, high]: [u16; 2]) -> u32 {
    let ([a, b], [c, d]) = (low.to_le_bytes(), high.to_le_bytes());
    u32::from_le_bytes([a, b, c, d])
}

impl Word {
    /// How many words it takes, and these.
    pub(super) fn encoded(self) -> (u32, [u16; MOST_WORDS as usize]) {
        match self {
            Self::Step { x, y, after_us } => {
                let motors = u16::from(x) << 14 | u16::from(y) << 15;
                (1, [motors | after_us.min(MOST_AFTER_US), 0, 0, 0])
            }
            Self::Stretch(Stretch { from_rest, ways, per_step, energy }) => {
                let head = u16::from(from_rest) | u16::from(ways.x < 0) << 1 | u16::from(ways.y < 0) << 2;
                let [low, high] = halves(energy);
                (4, [STRETCH | head, per_step, low, high])
            }
            Self::Wait(us) => {
                let [low, high] = halves(us);
                (3, [WAIT, low, high, 0])
            }
            #[cfg(feature = "third-motor")]
            Self::StepZ { up, after_us } => (2, [STEP_Z | u16::from(up), after_us, 0, 0]),
            #[cfg(feature = "third-motor")]
            Self::Apart { axis, ways: [first, second], after_us } => {
                let way = |way: i8| u16::from(way > 0) | u16::from(way < 0) << 1;
                let head = u16::from(axis == Axis::Y) | way(first) << 1 | way(second) << 3;
                (2, [APART | head, after_us, 0, 0])
            }
            Self::Pen(deg) => (1, [PEN | u16::from(deg), 0, 0, 0]),
            Self::Laser { power, ends_darkness } => (2, [LASER | u16::from(ends_darkness), power, 0, 0]),
        }
    }

    /// The thing that begins with `head`, of which `word` gives the others, and how many words it takes.
    #[inline(always)] // once, in the interrupt
    pub(super) fn decoded(head: u16, word: impl Fn(u32) -> u16) -> (u32, Self) {
        if head > MOST_AFTER_US {
            return (
                1,
                Self::Step { x: head & 0x4000 != 0, y: head & 0x8000 != 0, after_us: head & MOST_AFTER_US },
            );
        }
        match head & KIND {
            WAIT => (3, Self::Wait(whole([word(1), word(2)]))),
            PEN => (1, Self::Pen(u8::try_from(head & SMALL).unwrap_or(u8::MAX))),
            LASER => (2, Self::Laser { power: word(1), ends_darkness: head & 1 != 0 }),
            #[cfg(feature = "third-motor")]
            STEP_Z => (2, Self::StepZ { up: head & 1 != 0, after_us: word(1) }),
            #[cfg(feature = "third-motor")]
            APART => {
                let axis = if head & 1 == 0 { Axis::X } else { Axis::Y };
                let way = |bits: u16| if bits & 1 != 0 { 1 } else { -i8::from(bits & 2 != 0) };
                (2, Self::Apart { axis, ways: [way(head >> 1), way(head >> 3)], after_us: word(1) })
            }
            _ => {
                let way = |negative: u16| if head & negative == 0 { 1 } else { -1 };
                let ways = StepPair { x: way(2), y: way(4) };
                let energy = whole([word(2), word(3)]);
                (4, Self::Stretch(Stretch { from_rest: head & 1 != 0, ways, per_step: word(1), energy }))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_comes_out_as_it_went_in() {
        let ways = StepPair { x: -1, y: 1 };
        for (word, count) in [
            (Word::Step { x: true, y: false, after_us: 25 }, 1),
            (Word::Step { x: false, y: true, after_us: MOST_AFTER_US }, 1),
            (Word::Step { x: true, y: true, after_us: 0 }, 1),
            (Word::Stretch(Stretch { from_rest: true, ways, per_step: 16_384, energy: 0x1234_5678 }), 4),
            (Word::Wait(MOST_WAIT_US), 3),
            (Word::Pen(180), 1),
            (Word::Laser { power: 65_535, ends_darkness: true }, 2),
            (Word::Laser { power: 0, ends_darkness: false }, 2),
        ] {
            comes_out(word, count);
        }
    }

    fn comes_out(word: Word, count: u32) {
        let (len, words) = word.encoded();
        assert_eq!(len, count);
        let [head, ..] = words;
        assert_eq!(Word::decoded(head, |at| words[at as usize]), (len, word));
    }

    #[cfg(feature = "third-motor")]
    #[test]
    fn so_does_what_a_third_motor_makes() {
        for up in [true, false] {
            comes_out(Word::StepZ { up, after_us: u16::MAX }, 2);
        }
        for axis in [Axis::X, Axis::Y] {
            for first in -1..=1 {
                for second in -1..=1 {
                    comes_out(Word::Apart { axis, ways: [first, second], after_us: 7 }, 2);
                }
            }
        }
    }
}
