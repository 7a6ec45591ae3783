//! The published protocol (Öcal's thesis, section 5.2 and appendix A): targets as ten raw digits, motion as
//! single letters.
//!
//! ```text
//!  host ──▶ controller   ten bytes a target, values 0 to 9: x then y, five digits each, units first
//!  controller ──▶ host   1 x+1   2 x-1   3 y+1   4 y-1   (or a b c d)    + target reached    C clear
//! ```
//!
//! Ours adds two bytes, each in both directions: `!` and `~`, see [`Order`].
//!
//! A target of x = 2993, y = 13955 is `3 9 9 2 0  5 5 9 3 1`. There is no frame and no checksum: were the ten
//! bytes simply counted, one lost byte would shift every later target. [`Receiver`] therefore takes up the
//! thread again at a byte that cannot be a digit and at a silence inside a target.

use super::Order;
use crate::{Axis, Direction, StepPoint};
use core::fmt;
use core::time::Duration;

/// Bytes in a target.
pub const TARGET_BYTES: usize = 10;
/// Greatest coordinate that five digits can say, encoder counts.
pub const GREATEST: i32 = 99_999;

/// A target that the protocol has no digits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutOfRange {
    /// The target, encoder counts.
    pub target: StepPoint,
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let StepPoint { x, y } = self.target;
        write!(
            f,
            "target ({x}, {y}) counts lies outside 0..={GREATEST}, which is all that five digits can say: \
             move or shrink the drawing"
        )
    }
}

impl core::error::Error for OutOfRange {}

/// The ten bytes of a target.
///
/// # Errors
///
/// [`OutOfRange`] for a coordinate below 0 or above 99999.
///
/// ```
/// # use plotter_motion::{StepPoint, protocol::digits};
/// let bytes = digits::encode(StepPoint::new(2993, 13955))?;
/// assert_eq!(bytes, [3, 9, 9, 2, 0, 5, 5, 9, 3, 1]);
/// assert!(digits::encode(StepPoint::new(-1, 0)).is_err());
/// # Ok::<(), digits::OutOfRange>(())
/// ```
pub fn encode(target: StepPoint) -> Result<[u8; TARGET_BYTES], OutOfRange> {
    let digits = |coordinate: i32| {
        let mut rest = u32::try_from(coordinate).ok().filter(|_| coordinate <= GREATEST)?;
        Some([(); 5].map(|()| {
            let digit = (rest % 10) as u8;
            rest /= 10;
            digit
        }))
    };
    let (Some([a, b, c, d, e]), Some([f, g, h, i, j])) = (digits(target.x), digits(target.y)) else {
        return Err(OutOfRange { target });
    };
    Ok([a, b, c, d, e, f, g, h, i, j])
}

/// Replies of a controller, each in one byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reply {
    /// A motor went on by one encoder count.
    Pulse(Axis, Direction),
    /// The target is reached: send the next.
    Reached,
    /// Clear: the position is (0, 0) from here.
    Clear,
    /// After a byte that ordered it: the motors are off and stay off.
    Stopped,
    /// After a byte that ordered it: the motors are free again.
    GoesOn,
}

impl Reply {
    /// The byte that says so.
    ///
    /// ```
    /// # use plotter_motion::{Axis, Direction, protocol::digits::Reply};
    /// assert_eq!(Reply::Pulse(Axis::Y, Direction::Minus).byte(), b'4');
    /// ```
    #[must_use]
    pub const fn byte(self) -> u8 {
        match self {
            Self::Pulse(Axis::X, Direction::Plus) => b'1',
            Self::Pulse(Axis::X, Direction::Minus) => b'2',
            Self::Pulse(Axis::Y, Direction::Plus) => b'3',
            Self::Pulse(Axis::Y, Direction::Minus) => b'4',
            Self::Reached => b'+',
            Self::Clear => b'C',
            Self::Stopped => Order::Stop.byte(),
            Self::GoesOn => Order::GoOn.byte(),
        }
    }

    /// Reply of a byte; `None` if it is none. The letters `a` to `d` mean the same as `1` to `4`.
    #[must_use]
    pub const fn from_byte(byte: u8) -> Option<Self> {
        Some(match byte {
            b'1' | b'a' => Self::Pulse(Axis::X, Direction::Plus),
            b'2' | b'b' => Self::Pulse(Axis::X, Direction::Minus),
            b'3' | b'c' => Self::Pulse(Axis::Y, Direction::Plus),
            b'4' | b'd' => Self::Pulse(Axis::Y, Direction::Minus),
            b'+' => Self::Reached,
            b'C' => Self::Clear,
            _ => match Order::from_byte(byte) {
                Some(Order::Stop) => Self::Stopped,
                Some(Order::GoOn) => Self::GoesOn,
                _ => return None,
            },
        })
    }
}

/// Why a [`Receiver`] dropped what it had of a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Dropped {
    /// A byte came that is not a digit.
    NotADigit {
        /// The byte.
        byte: u8,
        /// Digits lost with it.
        digits: u8,
    },
    /// The line was silent inside the target for longer than a host pauses.
    Silence {
        /// How long.
        silence: Duration,
        /// Digits lost.
        digits: u8,
    },
    /// The target before it was reached only now: until then no host that waits for its `+` sends another.
    Early {
        /// Digits lost.
        digits: u8,
    },
}

impl fmt::Display for Dropped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotADigit { byte, digits } => {
                write!(
                    f,
                    "byte 0x{byte:02x} is not a digit (0 to 9): dropped it and {digits} digits before it"
                )
            }
            Self::Silence { silence, digits } => write!(
                f,
                "silence of {} ms inside a target: dropped its first {digits} digits",
                silence.as_millis()
            ),
            Self::Early { digits } => {
                write!(f, "{digits} digits came before the target was reached: dropped them")
            }
        }
    }
}

/// Effect of a byte on the receiver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Received {
    /// Bytes that were dropped as damaged, if any.
    pub dropped: Option<Dropped>,
    /// The target that this byte completed, if it did.
    pub target: Option<StepPoint>,
}

/// The controller's end of the line: bytes in, targets out.
///
/// Two things take up the thread again after a lost or an extra byte: a byte that is no digit drops what came
/// of the present target, itself included; and a pause of more than `resync_gap` inside a target says that
/// the rest of it is lost, so the next byte begins a new one. (The host waits for the answer to each target,
/// so it is always silent for longer than that after a target that came short.)
///
/// ```
/// # use plotter_motion::{StepPoint, protocol::digits::{Receiver, self}};
/// # use core::time::Duration;
/// let mut receiver = Receiver::new(Duration::from_millis(100));
/// let mut now = Duration::ZERO;
/// for byte in [3, 9, 9] { // the line breaks after three digits
///     assert_eq!(receiver.push(now, byte).target, None);
/// }
/// now += Duration::from_secs(1);
/// let mut last = Default::default();
/// for byte in digits::encode(StepPoint::new(2993, 13955)).unwrap() {
///     last = receiver.push(now, byte);
/// }
/// assert_eq!(last.target, Some(StepPoint::new(2993, 13955)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Receiver {
    resync_gap: Duration,
    digits: [u8; TARGET_BYTES],
    count: u8,
    last_byte: Duration,
}

impl Receiver {
    /// A receiver that takes a silence longer than `resync_gap` as the end of a broken target.
    #[must_use]
    pub const fn new(resync_gap: Duration) -> Self {
        Self { resync_gap, digits: [0; TARGET_BYTES], count: 0, last_byte: Duration::ZERO }
    }

    /// Takes one byte, received at `now`.
    pub fn push(&mut self, now: Duration, byte: u8) -> Received {
        let silence = now.saturating_sub(self.last_byte);
        self.last_byte = now;
        if byte > 9 {
            let digits = core::mem::take(&mut self.count);
            return Received { dropped: Some(Dropped::NotADigit { byte, digits }), target: None };
        }
        let mut received = Received::default();
        if self.count > 0 && silence > self.resync_gap {
            received.dropped = Some(Dropped::Silence { silence, digits: self.count });
            self.count = 0;
        }
        if let Some(place) = self.digits.get_mut(usize::from(self.count)) {
            *place = byte;
        }
        self.count += 1;
        if usize::from(self.count) == TARGET_BYTES {
            self.count = 0;
            let number =
                |digits: &[u8]| digits.iter().rev().fold(0, |sum, &digit| sum * 10 + i32::from(digit));
            let (x, y) = self.digits.split_at(TARGET_BYTES / 2);
            received.target = Some(StepPoint::new(number(x), number(y)));
        }
        received
    }

    /// Begins afresh when a target is reached: the host sends the next one from its first digit, so whatever
    /// came of one before belongs to none. Says what was dropped.
    ///
    /// ```
    /// # use plotter_motion::protocol::digits::{Dropped, Receiver};
    /// # use core::time::Duration;
    /// let mut receiver = Receiver::new(Duration::from_millis(100));
    /// assert_eq!(receiver.restart(), None);
    /// let _ = receiver.push(Duration::ZERO, 7); // noise
    /// assert_eq!(receiver.restart(), Some(Dropped::Early { digits: 1 }));
    /// ```
    pub fn restart(&mut self) -> Option<Dropped> {
        let digits = core::mem::take(&mut self.count);
        (digits > 0).then_some(Dropped::Early { digits })
    }
}

/// The host's end of the line: sends targets digit by digit, and the next one on each `+`.
///
/// [`next_byte`](Self::next_byte) says what to send and when; the caller owns port and clock.
///
/// ```
/// # use plotter_motion::{StepPoint, protocol::digits::{OutOfRange, Sender}};
/// # use core::time::Duration;
/// let mut sender = Sender::new(Duration::from_millis(10));
/// sender.start(Duration::ZERO, StepPoint::new(2993, 13955))?;
/// assert_eq!(sender.next_byte(Duration::ZERO), Some(3));
/// assert_eq!(sender.next_byte_at(), Some(Duration::from_millis(10)));
/// assert_eq!(sender.next_byte(Duration::from_millis(9)), None); // too early
/// # Ok::<(), OutOfRange>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sender {
    byte_gap: Duration,
    bytes: [u8; TARGET_BYTES],
    next: usize,
    not_before: Duration,
}

impl Sender {
    /// A sender that waits `byte_gap` after each byte (10 ms as published).
    #[must_use]
    pub const fn new(byte_gap: Duration) -> Self {
        Self { byte_gap, bytes: [0; TARGET_BYTES], next: TARGET_BYTES, not_before: Duration::ZERO }
    }

    /// Starts to send `target`; what was left of the one before is not sent.
    ///
    /// # Errors
    ///
    /// [`OutOfRange`] for a coordinate below 0 or above 99999: nothing is sent then.
    pub fn start(&mut self, now: Duration, target: StepPoint) -> Result<(), OutOfRange> {
        self.bytes = encode(target)?;
        self.next = 0;
        self.not_before = self.not_before.max(now);
        Ok(())
    }

    /// When the next byte may go out, if there is one.
    #[must_use]
    pub fn next_byte_at(&self) -> Option<Duration> {
        self.bytes.get(self.next).map(|_| self.not_before)
    }

    /// The next byte, if there is one and `now` is not too early for it.
    #[must_use]
    pub fn next_byte(&mut self, now: Duration) -> Option<u8> {
        let byte = *self.bytes.get(self.next)?;
        if now < self.not_before {
            return None;
        }
        self.next += 1;
        self.not_before = now.saturating_add(self.byte_gap);
        Some(byte)
    }

    /// Whether the whole target is out.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        self.next >= TARGET_BYTES
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAP: Duration = Duration::from_millis(100);

    fn targets(bytes: &[(u64, u8)]) -> std::vec::Vec<Received> {
        let mut receiver = Receiver::new(GAP);
        bytes
            .iter()
            .map(|&(ms, byte)| receiver.push(Duration::from_millis(ms), byte))
            .filter(|received| *received != Received::default())
            .collect()
    }

    #[test]
    fn a_lost_byte_costs_one_target() {
        let first = encode(StepPoint::new(12345, 67890)).unwrap();
        let second = encode(StepPoint::new(11, 22)).unwrap();
        let mut line = std::vec::Vec::new();
        line.extend(first.iter().skip(1).zip(0..).map(|(&b, ms)| (ms, b)));
        line.extend(second.iter().zip(500..).map(|(&b, ms)| (ms, b)));
        let got = targets(&line);
        assert_eq!(
            got.first().unwrap().dropped,
            Some(Dropped::Silence { silence: Duration::from_millis(492), digits: 9 })
        );
        assert_eq!(got.last().unwrap().target, Some(StepPoint::new(11, 22)));
    }

    #[test]
    fn an_impossible_digit_drops_the_partial_target() {
        let good = encode(StepPoint::new(7, 8)).unwrap();
        let mut line = std::vec![(0, 1), (1, 2), (2, b'7')];
        line.extend(good.iter().zip(3..).map(|(&b, ms)| (ms, b)));
        let got = targets(&line);
        assert_eq!(got.first().unwrap().dropped, Some(Dropped::NotADigit { byte: b'7', digits: 2 }));
        assert_eq!(got.last().unwrap().target, Some(StepPoint::new(7, 8)));
    }

    #[test]
    fn a_broken_byte_costs_its_target_and_no_other_is_made_of_its_rest() {
        let target = encode(StepPoint::new(12345, 67890)).unwrap();
        let mut line: std::vec::Vec<(u64, u8)> = (0..).zip(target).collect();
        line[4].1 = crate::protocol::SUBSTITUTE;
        line.extend((500..).zip(target)); // the host has had no answer, and sends it again
        let silence = Duration::from_millis(491);
        let got = targets(&line);
        assert_eq!(
            got.iter().map(|received| received.dropped).collect::<std::vec::Vec<_>>(),
            [
                Some(Dropped::NotADigit { byte: 0x1A, digits: 4 }),
                Some(Dropped::Silence { silence, digits: 5 }),
                None
            ]
        );
        assert_eq!(got.last().unwrap().target, Some(StepPoint::new(12345, 67890)));
    }

    #[test]
    fn the_sender_pauses_after_each_byte() {
        let mut sender = Sender::new(Duration::from_millis(10));
        assert!(sender.is_idle());
        sender.start(Duration::from_millis(5), StepPoint::new(3, 0)).unwrap();
        assert_eq!(sender.next_byte(Duration::from_millis(5)), Some(3));
        assert_eq!(sender.next_byte(Duration::from_millis(14)), None);
        assert_eq!(sender.next_byte_at(), Some(Duration::from_millis(15)));
        assert_eq!(sender.next_byte(Duration::from_millis(15)), Some(0));
    }
}
