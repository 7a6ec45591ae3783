//! [`Decoder`]: records in words.

use crate::frames::{FrameReader, Said};
use crate::import::Side;
use crate::log::{Event, Header, Record};
use core::fmt::Write as _;
use core::time::Duration;
use plotter_motion::protocol::digits::{Receiver, Reply};
use plotter_motion::protocol::{Hello, Message, MessageDecoder, Order};
use plotter_motion::{Axis, Direction, Pen};

/// Bytes of a record that are put into words; of longer ones it says how many there are.
const MOST_BYTES: usize = 16;

/// Puts what goes over a line into words: `target 900 600`, `pulse x+`, `reached`.
///
/// It must be shown every record from the beginning of a log: the ten bytes of a target come in several.
///
/// ```
/// # use plotter_replay::Decoder;
/// # use plotter_replay::log::{Event, Header, Record};
/// let mut decoder = Decoder::new(&Header::new());
/// assert_eq!(decoder.words(&Record::at_us(0, Event::Host(vec![0, 0, 9, 0, 0]))), "digits 0 0 9 0 0");
/// assert_eq!(decoder.words(&Record::at_us(90, Event::Host(vec![0, 0, 6, 0, 0]))), "digits 0 0 6 0 0, target 900 600");
/// assert_eq!(decoder.words(&Record::at_us(900, Event::Controller(b"13+".to_vec()))), "pulse x+ y+, reached");
/// ```
#[derive(Clone, Debug)]
pub struct Decoder {
    /// `None` for a protocol of text lines.
    digits: Option<Receiver>,
    frames: FrameReader,
    /// Whether the sides speak frames now.
    is_linked: bool,
}

impl Decoder {
    /// For the protocol that a log's header names: the ten digits, unless it says another.
    #[must_use]
    pub fn new(header: &Header) -> Self {
        let gap_ms = header.number("resync_gap_ms").filter(|ms| (0.0..=3.6e6).contains(ms)).unwrap_or(100.0);
        let is_digits = header.text("protocol").is_none_or(|protocol| matches!(protocol, "digits" | "link"));
        let gap = Duration::try_from_secs_f64(gap_ms / 1e3).unwrap_or(Duration::from_millis(100));
        Self {
            digits: is_digits.then(|| Receiver::new(gap)),
            frames: FrameReader::default(),
            is_linked: false,
        }
    }

    /// A record in words; empty for one that says it itself.
    pub fn words(&mut self, record: &Record) -> String {
        let frames = match &record.event {
            Event::Host(bytes) if self.digits.is_some() => self.frames(Side::Host, bytes),
            Event::Controller(bytes) if self.digits.is_some() => self.frames(Side::Controller, bytes),
            _ => None,
        };
        if let Some(words) = frames {
            return words;
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
            parts.push(said);
        }
        if !self.is_linked {
            return None;
        }
        Some(if parts.is_empty() {
            format!("... ({} bytes of a frame)", bytes.len())
        } else {
            parts.iter().map(frame).collect::<Vec<_>>().join(", ")
        })
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
                parts.push(frame(&Said::Order(0, Some(order))));
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

/// A frame in words. Messages that go on from one frame to the next are told as far as they are in this one.
fn frame(said: &Said) -> String {
    match said {
        Said::Hello(Hello { session: 0, .. }) => String::from("hello"),
        Said::Hello(Hello { session, .. }) => format!("hello, session {session:#06x}"),
        Said::Acknowledge(until) => format!("has all before {until}"),
        Said::Order(_, Some(Order::Stop)) => String::from("order stop"),
        Said::Order(_, Some(Order::Hold)) => String::from("order hold"),
        Said::Order(_, Some(Order::GoOn)) => String::from("order go on"),
        Said::Order(number, None) => format!("order {number}, unknown"),
        Said::Damaged(error) => error.to_string(),
        Said::Data(number, payload, _) => {
            let mut decoder = MessageDecoder::default();
            let mut words = format!("data {number}:");
            for message in payload.iter().filter_map(|&byte| decoder.push(byte)) {
                let _ = match message {
                    Ok(message) => write!(words, " {}", said_in_words(message)),
                    Err(_) => write!(words, " ..."),
                };
            }
            words
        }
    }
}

fn said_in_words(message: Message) -> String {
    match message {
        Message::Target { pen: Pen::Down, by } => format!("draw by {} {}", by.x, by.y),
        Message::Target { pen: Pen::Up, by } => format!("travel by {} {}", by.x, by.y),
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
