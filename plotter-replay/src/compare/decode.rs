//! [`Decoder`]: records in words.

use super::text_lines::TextLines;
use crate::frames::{FrameReader, FrameStream, Said};
use crate::import::Side;
use crate::log::{Event, Header, Record};
use crate::player::SESSION;
use core::fmt::Write as _;
use core::time::Duration;
use plotter_motion::protocol::digits::{Receiver, Reply};
use plotter_motion::protocol::{Hello, Message, MessageDecoder, MessageError, Order};
use plotter_motion::{Axis, Direction, Pen, StepPoint};

/// Bytes of a record that are put into words; of longer ones it says how many there are.
const MOST_BYTES: usize = 16;

/// How the words of bytes begin that end no frame.
const IN_A_FRAME: &str = "...";

/// Records that a frame may have, byte by byte, and some between them.
const MOST_OF_A_FRAME: u64 = 2_000;

/// Puts what goes over a line into words: `target 900 600`, `pulse x+`, `reached`.
///
/// It must be shown every record from the beginning of a log: the ten bytes of a target come in several.
///
/// ```
/// # use plotter_replay::compare::Decoder;
/// # use plotter_replay::log::{Event, Header, Record};
/// let mut decoder = Decoder::new(&Header::new());
/// assert_eq!(decoder.words(&Record::at_us(0, Event::Host(vec![0, 0, 9, 0, 0]))), "digits 0 0 9 0 0");
/// assert_eq!(decoder.words(&Record::at_us(90, Event::Host(vec![0, 0, 6, 0, 0]))), "digits 0 0 6 0 0, target 900 600");
/// assert_eq!(decoder.words(&Record::at_us(900, Event::Controller(b"13+".to_vec()))), "pulse x+ y+, reached");
/// ```
#[derive(Clone, Debug)]
pub struct Decoder {
    /// Of a protocol of text lines.
    lines: Option<TextLines>,
    /// `None` for a protocol of text lines.
    digits: Option<Receiver>,
    frames: FrameReader,
    /// The session, and what of either side has come in it.
    session: u16,
    streams: [FrameStream; 2],
    /// The host's last target.
    target: StepPoint,
    /// Whether the sides speak frames now.
    is_linked: bool,
    /// Whether messages are recorded without frames.
    is_messages: bool,
    answers: MessageDecoder,
}

impl Decoder {
    /// For the protocol that a log's header names: the ten digits, unless it says another.
    #[must_use]
    pub fn new(header: &Header) -> Self {
        let gap_ms = header.number("resync_gap_ms").filter(|ms| (0.0..=3.6e6).contains(ms)).unwrap_or(100.0);
        let is_digits = header.text("protocol").is_none_or(|protocol| matches!(protocol, "digits" | "link"));
        let gap = Duration::try_from_secs_f64(gap_ms / 1e3).unwrap_or(Duration::from_millis(100));
        Self {
            lines: TextLines::of(header.text("protocol")),
            digits: is_digits.then(|| Receiver::new(gap)),
            frames: FrameReader::default(),
            session: 0,
            streams: Default::default(),
            target: StepPoint::default(),
            is_linked: false,
            is_messages: header.text("protocol") == Some("messages"),
            answers: MessageDecoder::default(),
        }
    }

    /// The controller's frame that record `index` is in: the record that ends it, and what it says. `None`
    /// where no frames are spoken, or the records end before it. `records` are those from the beginning.
    pub fn frame_at(
        header: &Header,
        records: impl IntoIterator<Item = Record>,
        index: u64,
    ) -> Option<(u64, String)> {
        let mut decoder = Self::new(header);
        for (at, record) in (0..=index.saturating_add(MOST_OF_A_FRAME)).zip(records) {
            let words = decoder.words(&record);
            let is_in = at >= index && decoder.is_linked && matches!(record.event, Event::Controller(_));
            if is_in && !words.starts_with(IN_A_FRAME) {
                return Some((at, words));
            }
        }
        None
    }

    /// A record in words; empty for one that says it itself.
    pub fn words(&mut self, record: &Record) -> String {
        let frames = match &record.event {
            Event::Host(bytes) if self.is_messages => Some(self.host_message(bytes)),
            Event::Controller(bytes) if self.is_messages => Some(self.answers(bytes)),
            Event::Host(bytes) if self.digits.is_some() => self.frames(Side::Host, bytes),
            Event::Controller(bytes) if self.digits.is_some() => self.frames(Side::Controller, bytes),
            _ => None,
        };
        if let Some(words) = frames {
            return words;
        }
        match (&record.event, &mut self.lines) {
            (Event::Host(bytes), Some(lines)) => return lines.words(Side::Host, bytes),
            (Event::Controller(bytes), Some(lines)) => return lines.words(Side::Controller, bytes),
            _ => {}
        }
        match &record.event {
            Event::Host(bytes) => self.host(record.time, bytes),
            Event::Controller(bytes) if self.digits.is_some() => replies(bytes),
            Event::Controller(bytes) => quoted(bytes),
            _ => String::new(),
        }
    }

    /// What comes to its end with these bytes, once a machine has greeted.
    fn frames(&mut self, side: Side, bytes: &[u8]) -> Option<String> {
        let mut parts = Vec::new();
        for &byte in bytes {
            let Some(said) = self.frames.push(side, byte) else { continue };
            self.is_linked |= side == Side::Controller && matches!(said, Said::Hello(_));
            let words = self.frame(side, said);
            parts.push(words);
        }
        if !self.is_linked {
            return None;
        }
        let plural = if bytes.len() == 1 { "" } else { "s" };
        Some(if parts.is_empty() {
            format!("{IN_A_FRAME} {} byte{plural} of a frame", bytes.len())
        } else {
            parts.join(", ")
        })
    }

    /// A frame in words.
    fn frame(&mut self, side: Side, said: Said) -> String {
        let session = self.frames.session();
        if session != self.session {
            (self.session, self.streams, self.target) = (session, Default::default(), StepPoint::default());
        }
        let [host, machine] = &mut self.streams;
        let (stream, other) = if side == Side::Host { (host, machine) } else { (machine, host) };
        let (number, messages) = match said {
            Said::Data(number, payload, until) => {
                // (what the recording does not have, the stream goes on without)
                let _ = other.acknowledged(until);
                (number, stream.data(number, payload))
            }
            said => {
                if let Said::Acknowledge(until) = said {
                    let _ = other.acknowledged(until);
                }
                return unnumbered(&said);
            }
        };
        let words: Vec<_> = messages.into_iter().map(|message| self.said(message)).collect();
        if words.is_empty() {
            // It was sent again, or one before it is missing, or its message goes on in the next.
            format!("data {number}: nothing new yet")
        } else {
            format!("data {number}: {}", words.join(", "))
        }
    }

    fn said(&mut self, message: Result<Message, MessageError>) -> String {
        match message {
            Ok(Message::Target { pen, by }) => {
                let StepPoint { x, y } = self.target;
                self.target = StepPoint::new(x.wrapping_add(by.x), y.wrapping_add(by.y));
                let pen = if pen == Pen::Up { "pen up" } else { "pen down" };
                format!("target {} {} {pen}", self.target.x, self.target.y)
            }
            Ok(message) => said_in_words(message),
            Err(error) => error.to_string(),
        }
    }

    /// What a host says in a recording without frames: see [`crate::player::EdgeSource::Messages`].
    fn host_message(&mut self, bytes: &[u8]) -> String {
        match *bytes {
            [SESSION, low, high] => {
                self.target = StepPoint::default();
                format!("session {:#06x}", u16::from_le_bytes([low, high]))
            }
            [byte] if Order::from_byte(byte).is_some() => unnumbered(&Said::Order(0, Order::from_byte(byte))),
            _ => {
                let mut decoder = MessageDecoder::default();
                let messages: Vec<_> = bytes.iter().filter_map(|&byte| decoder.push(byte)).collect();
                messages.into_iter().map(|message| self.said(message)).collect::<Vec<_>>().join(", ")
            }
        }
    }

    /// What a machine answers in such a recording, perhaps byte by byte.
    fn answers(&mut self, bytes: &[u8]) -> String {
        let messages: Vec<_> = bytes.iter().filter_map(|&byte| self.answers.push(byte)).collect();
        if messages.is_empty() {
            return format!("{IN_A_FRAME} part of a message");
        }
        messages.into_iter().map(|message| self.said(message)).collect::<Vec<_>>().join(", ")
    }

    fn host(&mut self, time: Duration, bytes: &[u8]) -> String {
        let Some(receiver) = &mut self.digits else {
            return quoted(bytes);
        };
        let mut parts = Vec::new();
        let mut run = String::new();
        let end_run = |run: &mut String, parts: &mut Vec<String>| {
            if !run.is_empty() {
                parts.push(format!("digits{}", core::mem::take(run)));
            }
        };
        for (at, &byte) in bytes.iter().enumerate() {
            if let Some(order) = Order::from_byte(byte) {
                end_run(&mut run, &mut parts);
                parts.push(unnumbered(&Said::Order(0, Some(order))));
                continue;
            }
            let received = receiver.push(time, byte);
            if at >= MOST_BYTES {
                continue;
            }
            if let Some(dropped) = received.dropped {
                end_run(&mut run, &mut parts);
                parts.push(dropped.to_string());
            }
            if byte <= 9 {
                let _ = write!(run, " {byte}");
            }
            if let Some(target) = received.target {
                end_run(&mut run, &mut parts);
                parts.push(format!("target {} {}", target.x, target.y));
            }
        }
        end_run(&mut run, &mut parts);
        more(parts, bytes)
    }
}

/// A frame that is none of a stream in words.
fn unnumbered(said: &Said) -> String {
    match said {
        Said::Hello(Hello { session: 0, .. }) => String::from("hello"),
        Said::Hello(Hello { session, .. }) => format!("hello, session {session:#06x}"),
        Said::Acknowledge(until) | Said::Data(_, _, until) => format!("has all before {until}"),
        Said::Order(_, Some(Order::Stop)) => String::from("order stop"),
        Said::Order(_, Some(Order::Hold)) => String::from("order hold"),
        Said::Order(_, Some(Order::GoOn)) => String::from("order go on"),
        Said::Order(number, None) => format!("order {number}, unknown"),
        Said::Damaged(error) => error.to_string(),
    }
}

fn said_in_words(message: Message) -> String {
    match message {
        Message::Status { boot, taken, reached, position } => {
            format!("status boot {boot} taken {taken} reached {reached} at {} {}", position.x, position.y)
        }
        Message::Moved(by) => format!("moved {} {}", by.x, by.y),
        Message::Reached(count) => format!("reached {count}"),
        Message::Refused(count) => format!("refused {count}"),
        Message::Stands { state: Order::Stop, .. } => String::from("stopped"),
        Message::Stands { state: Order::Hold, .. } => String::from("held"),
        Message::Stands { state: Order::GoOn, .. } => String::from("goes on"),
        _ => String::from("something newer"),
    }
}

fn more(mut parts: Vec<String>, bytes: &[u8]) -> String {
    if bytes.len() > MOST_BYTES {
        parts.push(format!("... ({} bytes)", bytes.len()));
    }
    parts.join(", ")
}

fn replies(bytes: &[u8]) -> String {
    let mut parts: Vec<String> = Vec::new();
    let mut in_pulses = false;
    for &byte in bytes.iter().take(MOST_BYTES) {
        let words = reply(byte);
        match (words.strip_prefix("pulse "), parts.last_mut()) {
            (Some(pulse), Some(last)) if in_pulses => {
                last.push(' ');
                last.push_str(pulse);
            }
            (pulse, _) => {
                in_pulses = pulse.is_some();
                parts.push(words);
            }
        }
    }
    more(parts, bytes)
}

/// What a controller's byte says in the protocol of ten digits.
pub(super) fn reply(byte: u8) -> String {
    match Reply::from_byte(byte) {
        Some(Reply::Pulse(axis, sign)) => format!("pulse {}", pulse(axis, sign)),
        Some(Reply::Reached) => String::from("reached"),
        Some(Reply::Clear) => String::from("clear"),
        Some(Reply::Stopped) => String::from("stopped"),
        Some(Reply::GoesOn) => String::from("goes on"),
        None => format!("0x{byte:02x} says nothing"),
    }
}

pub(super) fn pulse(axis: Axis, sign: Direction) -> &'static str {
    match (axis, sign) {
        (Axis::X, Direction::Plus) => "x+",
        (Axis::X, Direction::Minus) => "x-",
        (Axis::Y, Direction::Plus) => "y+",
        (Axis::Y, Direction::Minus) => "y-",
    }
}

fn quoted(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes.get(..bytes.len().min(64)).unwrap_or(bytes));
    format!("{text:?}")
}
