//! [`LinkedMachine`]: what a re-run must know of a machine that spoke frames.

use crate::log::Header;

/// What a machine that spoke frames has said of itself, and its log does not say elsewhere. With it, and with
/// the edges of the motors in the log, a re-run says the same again, byte for byte.
///
/// A log's header may have it, as the keys `boot`, `link_window` and `link_payload` (without the latter two:
/// 4 and 64); the machine's greeting and its first word have it, too
/// ([`RecordingTraits::header`](crate::player::RecordingTraits::header)).
///
/// ```
/// # use plotter_replay::{log::Header, player::LinkedMachine};
/// let machine = LinkedMachine { boot: 7, window: 4, payload: 64 };
/// assert_eq!(LinkedMachine::of_header(&machine.written_to(Header::new())), Some(machine));
/// assert_eq!(LinkedMachine::of_header(&Header::new().with_number("boot", 7)), Some(machine));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LinkedMachine {
    /// Its number since it was switched on.
    pub boot: u32,
    /// Frames that it can keep.
    pub window: u8,
    /// Most bytes of payload that it takes in a frame.
    pub payload: u8,
}

impl LinkedMachine {
    /// What a header says; `None` for one that says of no such machine.
    #[must_use]
    pub fn of_header(header: &Header) -> Option<Self> {
        let whole = |key: &str, most: u32, usual: Option<u32>| match header.number(key) {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "within 32 bits, as checked"
            )]
            Some(number) if (0.0..=f64::from(most)).contains(&number) => Some(number as u32),
            Some(_) => None,
            None => usual,
        };
        let byte = |key, usual| whole(key, 255, Some(usual)).and_then(|number| u8::try_from(number).ok());
        Some(Self {
            boot: whole("boot", u32::MAX, None)?,
            window: byte("link_window", 4)?,
            payload: byte("link_payload", 64)?,
        })
    }

    /// The header that says so.
    #[must_use]
    pub fn written_to(self, header: Header) -> Header {
        let header = header.with_number("boot", self.boot.into());
        header.with_number("link_window", self.window.into()).with_number("link_payload", self.payload.into())
    }
}
