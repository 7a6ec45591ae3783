//! [`Order`]: what a machine obeys at once, past everything that waits.

/// An order that passes targets by.
///
/// In the digits protocol it is this byte by itself, of which no target has one, and the controller answers
/// with the byte of what holds then. On the reliable link it is a frame outside the streams
/// ([`Link::order`](super::Link::order)).
///
/// ```
/// # use plotter_motion::protocol::Order;
/// assert_eq!(Order::Stop.byte(), b'!');
/// assert_eq!(Order::from_byte(b'~'), Some(Order::GoOn));
/// assert_eq!(Order::from_byte(9), None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Order {
    /// Neither held nor stopped any more.
    #[default]
    GoOn,
    /// Finish the target under way, begin no other. A controller of digits has no other, and takes no notice.
    Hold,
    /// Emergency stop: both motors off, and they stay off until [`GoOn`](Self::GoOn). What is counted is
    /// kept.
    Stop,
}

impl Order {
    /// The byte that says so: `~`, `|`, `!`.
    #[must_use]
    pub const fn byte(self) -> u8 {
        match self {
            Self::GoOn => b'~',
            Self::Hold => b'|',
            Self::Stop => b'!',
        }
    }

    /// Order of a byte; `None` if it is none.
    #[must_use]
    pub const fn from_byte(byte: u8) -> Option<Self> {
        Some(match byte {
            b'~' => Self::GoOn,
            b'|' => Self::Hold,
            b'!' => Self::Stop,
            _ => return None,
        })
    }
}
