//! [`FrameReader`]: the frames of a recorded reliable link, both directions, and [`FrameStream`], their payloads in order.

use crate::import::Side;
use plotter_motion::protocol::frame::{DecodeError, Decoder, Kind};
use plotter_motion::protocol::{Hello, Message, MessageDecoder, MessageError, Order};

/// What a frame says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Said {
    Hello(Hello),
    /// The number of a payload, what it is, and up to where the other side's have come.
    Data(u8, Vec<u8>, u8),
    /// Up to where the other side's payloads have come.
    Acknowledge(u8),
    /// An order with its number; 0 for a stop by itself.
    Order(u8, Option<Order>),
    /// It came damaged, or is of a session that the recording does not show the beginning of.
    Damaged(DecodeError),
}

/// Finds frames in both directions of a line.
#[derive(Clone, Debug, Default)]
pub(crate) struct FrameReader {
    host: Decoder,
    controller: Decoder,
    session: u16,
    /// The host's bytes since the last zero: how many, and the last.
    host_run: (u32, u8),
}

impl FrameReader {
    /// Takes a byte; says what came to its end with it.
    pub(crate) fn push(&mut self, side: Side, byte: u8) -> Option<Said> {
        let decoder = match side {
            Side::Host => &mut self.host,
            Side::Controller => &mut self.controller,
        };
        let frame = decoder.push(byte, self.session);
        let said = frame.map(|frame| match frame {
            Err(error) => Said::Damaged(error),
            Ok(frame) => match frame.kind {
                Kind::Hello => Hello::from_bytes(frame.payload)
                    .map_or(Said::Damaged(DecodeError::Malformed), Said::Hello),
                Kind::Data => Said::Data(frame.sequence, frame.payload.to_vec(), frame.acknowledged),
                Kind::Acknowledge => Said::Acknowledge(frame.acknowledged),
                Kind::Order => {
                    let order = frame.payload.first().copied().and_then(Order::from_byte);
                    Said::Order(frame.sequence, order)
                }
            },
        });
        if let (Side::Host, Some(Said::Hello(Hello { session: session @ 1.., .. }))) = (side, &said) {
            self.session = *session;
        }
        if side == Side::Host {
            let run = core::mem::replace(&mut self.host_run, (0, byte));
            if byte != 0 {
                self.host_run.0 = run.0.saturating_add(1);
            } else if run == (1, Order::Stop.byte()) {
                return Some(Said::Order(0, Some(Order::Stop)));
            }
        }
        said
    }

    /// The session that the host has opened; 0 for none.
    pub(crate) const fn session(&self) -> u16 {
        self.session
    }
}

/// The stream of one side: payloads in the order of their numbers, each once.
#[derive(Clone, Debug, Default)]
pub(crate) struct FrameStream {
    next: u8,
    /// Payloads after a gap, by their number.
    kept: Vec<(u8, Vec<u8>)>,
    decoder: MessageDecoder,
    missing: u64,
}

/// Payloads that a side can have on the way, so many more than the next may be ahead of it.
const WINDOW: u8 = 32;

impl FrameStream {
    /// Takes a payload; gives the messages that are complete with it.
    pub(crate) fn data(&mut self, number: u8, payload: Vec<u8>) -> Vec<Result<Message, MessageError>> {
        let ahead = number.wrapping_sub(self.next);
        if ahead >= WINDOW || self.kept.iter().any(|(kept, _)| *kept == number) {
            return Vec::new(); // sent again
        }
        self.kept.push((number, payload));
        let mut messages = Vec::new();
        while self.step(&mut messages) {}
        messages
    }

    /// The other side has all payloads before this number: those that are not here are missing in the recording.
    pub(crate) fn acknowledged(&mut self, until: u8) -> Vec<Result<Message, MessageError>> {
        let mut messages = Vec::new();
        while matches!(until.wrapping_sub(self.next), 1..=WINDOW) {
            if !self.step(&mut messages) {
                self.missing = self.missing.saturating_add(1);
                self.next = self.next.wrapping_add(1);
                self.decoder = MessageDecoder::default();
            }
        }
        messages
    }

    fn step(&mut self, messages: &mut Vec<Result<Message, MessageError>>) -> bool {
        let Some(at) = self.kept.iter().position(|(kept, _)| *kept == self.next) else {
            return false;
        };
        let (_, payload) = self.kept.swap_remove(at);
        self.next = self.next.wrapping_add(1);
        messages.extend(payload.into_iter().filter_map(|byte| self.decoder.push(byte)));
        true
    }

    /// Payloads that were found missing since the last call.
    pub(crate) fn take_missing(&mut self) -> u64 {
        core::mem::take(&mut self.missing)
    }
}
