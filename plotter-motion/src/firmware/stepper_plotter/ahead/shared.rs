//! [`StepsAhead`]: the memory between the two halves.

use super::super::play::Gap;
use super::words::{MOST_WORDS, Word};
#[cfg(feature = "third-motor")]
use crate::safety::EndSwitches;
use crate::{Axis, Direction, LimitSwitches, StepPoint, safety::Blocked};
use core::sync::atomic::{AtomicI32, AtomicU16, AtomicU32, Ordering};

/// The memory of a [`Planning`](super::Planning) and a [`Stepping`](super::Stepping): the steps between them,
/// `N` words of 16 bits, and what each lets the other know. `N` is a power of two from 64 to 32,768.
///
/// A step takes one word, a stretch of up to sixteen of them four more. How many are needed: the steps of
/// both motors on the way that the machine needs to brake from its greatest speed, and those of the longest
/// time that the main loop is away. With less the machine keeps to a speed from which it can brake.
///
/// Each word and each number is written by one half alone, and read by the other when it has been told: loads
/// and stores, which all processors with 32 bits have, and no locks.
#[derive(Debug)]
pub struct StepsAhead<const N: usize> {
    words: [AtomicU16; N],
    shared: Shared,
}

/// What each half lets the other know.
#[derive(Debug)]
pub(super) struct Shared {
    /// Words put in, and the sums of all energies that can be braked away on them, to the end and to where
    /// the machine stands last: by planning.
    pub(super) head: AtomicU32,
    pub(super) end: AtomicU32,
    pub(super) rest: AtomicU32,
    /// [`Orders`], by planning.
    pub(super) orders: AtomicU32,
    /// Words whose things are done, by stepping.
    pub(super) tail: AtomicU32,
    pub(super) x: AtomicI32,
    pub(super) y: AtomicI32,
    #[cfg(feature = "third-motor")]
    pub(super) z: AtomicI32,
    /// The switches of a third motor ([`Third`]), by planning.
    #[cfg(feature = "third-motor")]
    pub(super) third: AtomicU32,
    pub(super) gap: AtomicU32,
    /// [`Found`], by stepping.
    pub(super) found: AtomicU32,
    /// How much all has been put off since the start, us.
    pub(super) put_off_us: AtomicU32,
    pub(super) late_steps: AtomicU32,
    pub(super) latest_us: AtomicU32,
    pub(super) slowed_steps: AtomicU32,
    pub(super) stops: AtomicU32,
}

impl<const N: usize> StepsAhead<N> {
    /// So that a place in the ring is found by leaving out bits, a stretch has room, and the energies of all
    /// steps are less than [`PASSED`].
    const POWER_OF_TWO: () =
        assert!(N.is_power_of_two() && N >= 64 && N <= 32_768, "a power of two of words from 64 to 32,768");

    /// Empty memory.
    #[must_use]
    pub const fn new() -> Self {
        () = Self::POWER_OF_TWO;
        const fn number() -> AtomicU32 {
            AtomicU32::new(0)
        }
        Self {
            words: [const { AtomicU16::new(0) }; N],
            shared: Shared {
                head: number(),
                end: number(),
                rest: number(),
                orders: number(),
                tail: number(),
                x: AtomicI32::new(0),
                y: AtomicI32::new(0),
                #[cfg(feature = "third-motor")]
                z: AtomicI32::new(0),
                #[cfg(feature = "third-motor")]
                third: number(),
                gap: number(),
                found: number(),
                put_off_us: number(),
                late_steps: number(),
                latest_us: number(),
                slowed_steps: number(),
                stops: number(),
            },
        }
    }

    /// Both ends of it, of a machine that stands at `at`.
    pub(super) fn ends(&mut self, at: StepPoint, gap: Gap) -> (In<'_>, Out<'_>) {
        *self = Self::new();
        self.shared.x = AtomicI32::new(at.x);
        self.shared.y = AtomicI32::new(at.y);
        self.shared.gap = AtomicU32::new(gap.bits());
        let (words, shared) = (&self.words, &self.shared);
        (In { words, shared, head: 0, end: 0 }, Out { words, shared, read: 0 })
    }
}

impl<const N: usize> Default for StepsAhead<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// How far behind a standstill is told to be at most, as an energy: farther than all of a queue, and less
/// than half of what the numbers count, so that it is not taken for one ahead. The machine may draw for hours
/// without one.
const PASSED: u32 = 1 << 30;

/// A place in the ring.
#[inline(always)]
fn slot(words: &[AtomicU16], at: u32) -> Option<&AtomicU16> {
    // There are a power of two of them.
    words.get(at as usize & (words.len() - 1))
}

/// Where planning puts words in.
#[derive(Debug)]
pub(super) struct In<'a> {
    words: &'a [AtomicU16],
    pub(super) shared: &'a Shared,
    head: u32,
    /// Sum of the energies that can be braked away on all that has been put in.
    end: u32,
}

impl In<'_> {
    /// How many words have room.
    pub(super) fn room(&self) -> u32 {
        u32::try_from(self.words.len()).unwrap_or(u32::MAX).saturating_sub(self.waiting())
    }

    /// How many words wait.
    pub(super) fn waiting(&self) -> u32 {
        self.head.wrapping_sub(self.shared.tail.load(Ordering::Acquire))
    }

    /// Whether all is done that has been put in.
    pub(super) fn is_drained(&self) -> bool {
        self.waiting() == 0
    }

    /// Whether more than half of the words wait.
    pub(super) fn is_half_full(&self) -> bool {
        self.waiting() > self.room()
    }

    /// Puts a thing in, for which room was looked at; it is there for the other half once it is told.
    pub(super) fn put(&mut self, word: Word) {
        debug_assert!(self.room() >= MOST_WORDS, "room was looked at before");
        let (count, words) = word.encoded();
        for word in words.into_iter().take(count as usize) {
            if let Some(slot) = slot(self.words, self.head) {
                slot.store(word, Ordering::Relaxed);
            }
            self.head = self.head.wrapping_add(1);
        }
    }

    /// On what has been put in since it was told last, so much energy can be braked away.
    pub(super) fn tell(&mut self, energy: u32) {
        self.end = self.end.wrapping_add(energy);
        if self.end.wrapping_sub(self.shared.rest.load(Ordering::Relaxed)) > PASSED {
            self.shared.rest.store(self.end.wrapping_sub(PASSED), Ordering::Release);
        }
        self.shared.end.store(self.end, Ordering::Relaxed);
        self.shared.head.store(self.head, Ordering::Release);
    }

    /// Behind all that has been put in the machine stands.
    pub(super) fn tell_rest(&self) {
        self.shared.rest.store(self.end, Ordering::Release);
    }

    /// Steps really made, and how far each motor has come within its play.
    pub(super) fn made(&self) -> (StepPoint, Gap) {
        let at = StepPoint::new(self.shared.x.load(Ordering::Acquire), self.shared.y.load(Ordering::Acquire));
        (at, Gap::of_bits(self.shared.gap.load(Ordering::Acquire)))
    }

    /// The same of a third motor, from where it stood at first.
    #[cfg(feature = "third-motor")]
    pub(super) fn made_z(&self) -> i32 {
        self.shared.z.load(Ordering::Acquire)
    }
}

/// Where stepping takes them out.
#[derive(Debug)]
pub(super) struct Out<'a> {
    words: &'a [AtomicU16],
    pub(super) shared: &'a Shared,
    /// Words read: more than those that are done while one waits for its time.
    read: u32,
}

impl Out<'_> {
    /// The next thing.
    #[inline(always)] // once, in the interrupt
    pub(super) fn next(&mut self) -> Option<Word> {
        if self.read == self.shared.head.load(Ordering::Acquire) {
            return None;
        }
        let word = |at: u32| {
            slot(self.words, self.read.wrapping_add(at)).map_or(0, |slot| slot.load(Ordering::Relaxed))
        };
        let (count, found) = Word::decoded(word(0), word);
        self.read = self.read.wrapping_add(count);
        Some(found)
    }

    /// All that has been taken out is done.
    #[inline(always)] // once, in the interrupt
    pub(super) fn done(&self) {
        self.shared.tail.store(self.read, Ordering::Release);
    }

    /// Leaves out all that waits.
    pub(super) fn leave_out(&mut self) {
        self.read = self.shared.head.load(Ordering::Acquire);
        self.done();
    }
}

/// What planning orders at once, past the queue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Orders {
    pub(super) limits: LimitSwitches,
    pub(super) button: bool,
    /// The emergency stop is latched; the host has stopped the machine.
    pub(super) latched: bool,
    pub(super) host_stop: bool,
    /// With all that waits the place is forgotten, too: the motors stand at the origin.
    pub(super) homed: bool,
    /// How often the laser has been ordered dark, the latch to be reset, and all that waits to be left out:
    /// each another number than before orders it again.
    pub(super) dark: u8,
    pub(super) resets: u8,
    pub(super) flushes: u8,
}

const fn limit_bits(limits: LimitSwitches) -> u8 {
    let LimitSwitches { x_min, x_max, y_min, y_max } = limits;
    x_min as u8 | (x_max as u8) << 1 | (y_min as u8) << 2 | (y_max as u8) << 3
}

/// Those that either of them has.
pub(super) const fn either(one: LimitSwitches, other: LimitSwitches) -> LimitSwitches {
    limits_of(limit_bits(one) | limit_bits(other))
}

const fn limits_of(bits: u8) -> LimitSwitches {
    LimitSwitches { x_min: bits & 1 != 0, x_max: bits & 2 != 0, y_min: bits & 4 != 0, y_max: bits & 8 != 0 }
}

impl Orders {
    pub(super) fn bits(self) -> u32 {
        let flags = limit_bits(self.limits)
            | u8::from(self.button) << 4
            | u8::from(self.latched) << 5
            | u8::from(self.host_stop) << 6
            | u8::from(self.homed) << 7;
        u32::from_le_bytes([flags, self.dark, self.resets, self.flushes])
    }

    pub(super) fn of_bits(bits: u32) -> Self {
        let [flags, dark, resets, flushes] = bits.to_le_bytes();
        Self {
            limits: limits_of(flags),
            button: flags & 0x10 != 0,
            latched: flags & 0x20 != 0,
            host_stop: flags & 0x40 != 0,
            homed: flags & 0x80 != 0,
            dark,
            resets,
            flushes,
        }
    }
}

/// The limit switches of a third axis, and of the second motor of an axis.
#[cfg(feature = "third-motor")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Third {
    pub(super) z: EndSwitches,
    pub(super) second: EndSwitches,
}

#[cfg(feature = "third-motor")]
impl Third {
    pub(super) fn bits(self) -> u8 {
        let of = |ends: EndSwitches| u8::from(ends.lower) | u8::from(ends.upper) << 1;
        of(self.z) | of(self.second) << 2
    }

    pub(super) fn of_bits(bits: u8) -> Self {
        let ends = |bits: u8| EndSwitches { lower: bits & 1 != 0, upper: bits & 2 != 0 };
        Self { z: ends(bits), second: ends(bits >> 2) }
    }

    /// Those that either of them has.
    pub(super) fn or(self, other: Self) -> Self {
        Self::of_bits(self.bits() | other.bits())
    }
}

/// What stepping has found out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Found {
    /// What it has itself been told of switches and button.
    pub(super) limits: LimitSwitches,
    pub(super) button: bool,
    #[cfg(feature = "third-motor")]
    pub(super) third: Third,
    /// Why a step was not made. Nothing more is made until all that waits has been left out.
    pub(super) blocked: Option<Blocked>,
    /// [`Orders::flushes`] as they have been carried out.
    pub(super) flushes: u8,
    /// How often it has been told that the button is pressed: a press that is over when planning looks is
    /// one.
    pub(super) presses: u8,
}

impl Found {
    pub(super) fn bits(self) -> u32 {
        let flags = limit_bits(self.limits) | u8::from(self.button) << 4;
        let blocked = match self.blocked {
            None => 0,
            Some(Blocked::Limit { axis, end }) => {
                2 | u8::from(axis == Axis::Y) << 2 | u8::from(end == Direction::Plus) << 3
            }
            #[cfg(feature = "third-motor")]
            Some(Blocked::LimitZ { end }) => 3 | u8::from(end == Direction::Plus) << 3,
            Some(Blocked::Stopped) => 1,
        };
        #[cfg(feature = "third-motor")]
        let blocked = blocked | self.third.bits() << 4;
        u32::from_le_bytes([flags, blocked, self.flushes, self.presses])
    }

    pub(super) fn of_bits(bits: u32) -> Self {
        let [flags, blocked, flushes, presses] = bits.to_le_bytes();
        #[cfg(feature = "third-motor")]
        let third = Third::of_bits(blocked >> 4);
        let end = if blocked & 8 == 0 { Direction::Minus } else { Direction::Plus };
        let blocked = match blocked & 3 {
            0 => None,
            1 => Some(Blocked::Stopped),
            #[cfg(feature = "third-motor")]
            3 => Some(Blocked::LimitZ { end }),
            _ => Some(Blocked::Limit { axis: if blocked & 4 == 0 { Axis::X } else { Axis::Y }, end }),
        };
        Self {
            limits: limits_of(flags),
            button: flags & 0x10 != 0,
            #[cfg(feature = "third-motor")]
            third,
            blocked,
            flushes,
            presses,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_and_what_was_found_come_out_as_they_went_in() {
        let limits = LimitSwitches { x_max: true, y_min: true, ..LimitSwitches::RELEASED };
        let orders = Orders {
            limits,
            button: true,
            latched: false,
            host_stop: true,
            homed: true,
            dark: 7,
            resets: 255,
            flushes: 1,
        };
        assert_eq!(Orders::of_bits(orders.bits()), orders);
        for axis in [Axis::X, Axis::Y] {
            for end in [Direction::Minus, Direction::Plus] {
                for blocked in [None, Some(Blocked::Stopped), Some(Blocked::Limit { axis, end })] {
                    let found = Found { limits, blocked, flushes: 200, presses: 3, ..Found::default() };
                    assert_eq!(Found::of_bits(found.bits()), found);
                }
            }
        }
    }

    #[cfg(feature = "third-motor")]
    #[test]
    fn what_was_found_of_a_third_motor_comes_out_as_it_went_in() {
        for bits in 0..16 {
            let third = Third::of_bits(bits);
            assert_eq!(third.bits(), bits);
            for end in [Direction::Minus, Direction::Plus] {
                let found = Found { third, blocked: Some(Blocked::LimitZ { end }), ..Found::default() };
                assert_eq!(Found::of_bits(found.bits()), found);
            }
        }
    }

    #[test]
    fn words_go_round_the_end_of_the_ring_and_are_there_once_they_are_told() {
        let mut memory = StepsAhead::<64>::new();
        let (mut inward, mut out) = memory.ends(StepPoint::default(), Gap::default());
        let mut next_us = 0;
        for after_us in 0..1000_u32 {
            inward.put(Word::Wait(after_us));
            if after_us % 7 == 6 {
                assert_eq!((inward.waiting(), out.next()), (21, None));
                inward.tell(0);
                while let Some(word) = out.next() {
                    assert_eq!(word, Word::Wait(next_us));
                    next_us += 1;
                    out.done();
                }
                assert!(inward.is_drained() && inward.room() == 64);
            }
        }
    }
}
