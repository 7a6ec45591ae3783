//! [`Message`]: what host and machine say over the reliable link.
//!
//! A byte for its kind, then numbers in LEB128 (seven bits a byte, low ones first, the eighth set where more
//! follow; DWARF 5, section 7.6); those that may be below 0 as 2n, or -2n-1.

use super::Order;
use crate::{Pen, StepPoint};
use core::fmt;

/// Messages over the link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Message {
    /// Host: go to this target on a straight line. Sent as the difference from the target before it in the
    /// session, of which the first counts from (0, 0).
    Target {
        /// Up or down on the way.
        pen: Pen,
        /// Difference from the target before, encoder counts.
        by: StepPoint,
    },
    /// Machine: how it stands as the session begins.
    Status {
        /// Another number each time that the machine is switched on.
        boot: u32,
        /// Targets taken since then.
        taken: u32,
        /// How many of them have been reached, refused ones among them.
        reached: u32,
        /// Where the motors stand, encoder counts.
        position: StepPoint,
    },
    /// Machine: the motors have gone on by so many counts.
    Moved(StepPoint),
    /// Machine: so many targets have been reached since it was switched on, refused ones among them.
    Reached(u32),
    /// Machine: the target after so many is outside its area; it was left out, and counts as reached.
    Refused(u32),
    /// Machine: whether it is stopped or held now; said when that changes, after each order, and after the
    /// status of one that is not free.
    Stands {
        /// The last order taken in this session, by its number; 0 for none.
        order: u32,
        /// The order in force.
        state: Order,
    },
}

const DRAW: u8 = 0x01;
const TRAVEL: u8 = 0x02;
const STATUS: u8 = 0x10;
const MOVED: u8 = 0x11;
const REACHED: u8 = 0x12;
const REFUSED: u8 = 0x13;
const STANDS: u8 = 0x14;

/// Most bytes of a message.
pub const MOST_MESSAGE: usize = 1 + 5 * 5;

impl Message {
    /// Its bytes, and how many there are.
    ///
    /// ```
    /// # use plotter_motion::{Pen, StepPoint, protocol::Message};
    /// let (bytes, length) = Message::Target { pen: Pen::Down, by: StepPoint::new(100, -3) }.encode();
    /// assert_eq!(bytes[..length], [0x01, 0xc8, 0x01, 5]); // 200 = 0x48 + 0x80; then 2 * 3 - 1
    /// ```
    #[must_use]
    pub fn encode(self) -> ([u8; MOST_MESSAGE], usize) {
        let (kind, numbers, count) = match self {
            Self::Target { pen, by } => {
                (if pen == Pen::Down { DRAW } else { TRAVEL }, [zigzag(by.x), zigzag(by.y), 0, 0, 0], 2)
            }
            Self::Status { boot, taken, reached, position } => {
                (STATUS, [boot, taken, reached, zigzag(position.x), zigzag(position.y)], 5)
            }
            Self::Moved(by) => (MOVED, [zigzag(by.x), zigzag(by.y), 0, 0, 0], 2),
            Self::Reached(count) => (REACHED, [count, 0, 0, 0, 0], 1),
            Self::Refused(count) => (REFUSED, [count, 0, 0, 0, 0], 1),
            Self::Stands { order, state } => (STANDS, [order, u32::from(state.byte()), 0, 0, 0], 2),
        };
        let mut bytes = [0; MOST_MESSAGE];
        let mut places = bytes.iter_mut();
        let mut length = 0;
        let mut put = |byte: u8| {
            if let Some(place) = places.next() {
                *place = byte;
                length += 1;
            }
        };
        put(kind);
        for mut number in numbers.into_iter().take(count) {
            while number >= 0x80 {
                put((number & 0x7f) as u8 | 0x80);
                number >>= 7;
            }
            put((number & 0x7f) as u8);
        }
        (bytes, length)
    }
}

fn zigzag(value: i32) -> u32 {
    ((value << 1) ^ (value >> 31)).cast_unsigned()
}

fn unzigzag(value: u32) -> i32 {
    (value >> 1).cast_signed() ^ -(value & 1).cast_signed()
}

/// A stream that is none of messages. A link loses and changes nothing, so the other side speaks another
/// language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum MessageError {
    /// A kind that this version does not know.
    Kind(u8),
    /// A number of more than 32 bits.
    Number,
    /// A state that this version does not know.
    State(u32),
}

impl fmt::Display for MessageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Kind(kind) => write!(f, "a message of the unknown kind {kind:#04x}: is one side newer?"),
            Self::State(state) => write!(f, "the unknown state {state:#04x}: is one side newer?"),
            Self::Number => f.write_str("a message with a number of more than 32 bits"),
        }
    }
}

impl core::error::Error for MessageError {}

/// Finds messages in a stream, sans-IO.
///
/// ```
/// # use plotter_motion::protocol::{Message, MessageDecoder};
/// let mut decoder = MessageDecoder::default();
/// assert_eq!(decoder.push(0x12), None);
/// assert_eq!(decoder.push(0x80 | 1), None);
/// assert_eq!(decoder.push(2), Some(Ok(Message::Reached(257))));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MessageDecoder {
    kind: u8,
    numbers: [u32; 5],
    /// Numbers complete, and bits of the next.
    complete: u8,
    bits: u8,
}

impl MessageDecoder {
    /// Takes a byte; says what came to its end with it.
    pub fn push(&mut self, byte: u8) -> Option<Result<Message, MessageError>> {
        if self.kind == 0 {
            if matches!(byte, DRAW | TRAVEL | STATUS | MOVED | REACHED | REFUSED | STANDS) {
                self.kind = byte;
                return None;
            }
            return Some(Err(MessageError::Kind(byte)));
        }
        let part = u32::from(byte & 0x7f);
        if self.bits > 28 || (self.bits == 28 && part > 0xf) {
            *self = Self::default();
            return Some(Err(MessageError::Number));
        }
        if let Some(number) = self.numbers.get_mut(usize::from(self.complete)) {
            *number |= part << self.bits;
        }
        self.bits += 7;
        if byte & 0x80 != 0 {
            return None;
        }
        self.complete += 1;
        self.bits = 0;
        let wanted = match self.kind {
            STATUS => 5,
            REACHED | REFUSED => 1,
            _ => 2,
        };
        if self.complete < wanted {
            return None;
        }
        let Self { kind, numbers: [a, b, c, d, e], .. } = core::mem::take(self);
        let point = StepPoint::new(unzigzag(a), unzigzag(b));
        Some(Ok(match kind {
            DRAW => Message::Target { pen: Pen::Down, by: point },
            TRAVEL => Message::Target { pen: Pen::Up, by: point },
            MOVED => Message::Moved(point),
            REACHED => Message::Reached(a),
            REFUSED => Message::Refused(a),
            STANDS => match u8::try_from(b).ok().and_then(Order::from_byte) {
                Some(state) => Message::Stands { order: a, state },
                None => return Some(Err(MessageError::State(b))),
            },
            _ => Message::Status {
                boot: a,
                taken: b,
                reached: c,
                position: StepPoint::new(unzigzag(d), unzigzag(e)),
            },
        }))
    }
}
