//! [`FrameReader`]: the frames of a recorded reliable link, both directions, and [`FrameStream`], their
//! payloads in order.

use crate::import::Side;
use crate::log::{Event, Record};
use plotter_motion::StepPoint;
use plotter_motion::protocol::frame::{DecodeError, Decoder, Kind};
use plotter_motion::protocol::{Hello, Message, MessageDecoder, MessageError, Order};

/// What a machine says of itself before anything else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Introduction {
    pub(crate) hello: Hello,
    pub(crate) boot: u32,
    /// Targets taken and reached before.
    pub(crate) taken: u32,
    pub(crate) reached: u32,
    pub(crate) position: StepPoint,
}

/// Looks for the first [`Introduction`] in a recording.
#[derive(Clone, Debug, Default)]
pub(crate) struct IntroductionSearch {
    frames: FrameReader,
    stream: FrameStream,
    session: u16,
    hello: Option<Hello>,
    pub(crate) found: Option<Introduction>,
}

impl IntroductionSearch {
    /// Takes the next record.
    pub(crate) fn push(&mut self, record: &Record) {
        let (side, bytes) = match &record.event {
            Event::Host(bytes) => (Side::Host, bytes),
            Event::Controller(bytes) => (Side::Controller, bytes),
            _ => return,
        };
        if self.found.is_none() {
            bytes.iter().for_each(|&byte| self.byte(side, byte));
        }
    }

    fn byte(&mut self, side: Side, byte: u8) {
        let said = self.frames.push(side, byte);
        if self.frames.session() != self.session {
            (self.session, self.stream) = (self.frames.session(), FrameStream::default());
        }
        match (side, said) {
            (Side::Controller, Some(Said::Hello(hello))) => self.hello = Some(hello),
            (Side::Controller, Some(Said::Data(number, payload, _))) => {
                for message in self.stream.data(number, payload) {
                    if let (Ok(Message::Status { boot, taken, reached, position }), Some(hello)) =
                        (message, self.hello)
                    {
                        let new = Introduction { hello, boot, taken, reached, position };
                        self.found.get_or_insert(new);
                    }
                }
            }
            _ => {}
        }
    }
}

impl Introduction {
    /// The first in a recording; `None` where no machine says anything over frames.
    pub(crate) fn find(records: impl IntoIterator<Item = Record>) -> Option<Self> {
        let mut search = IntroductionSearch::default();
        records.into_iter().find_map(|record| {
            search.push(&record);
            search.found
        })
    }
}

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

    /// The other side has all payloads before this number: those that are not here are missing in the
    /// recording.
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
