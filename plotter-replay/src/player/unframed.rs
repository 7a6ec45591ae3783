//! [`Unframed`]: what a recording of frames says, without the frames, for a re-run that has no edges to go
//! by.
//!
//! Which frames a machine sends depends on where its motors were when each began, and that is only told every
//! 20 ms. So a recording without edges is run again message by message: a target comes when its frame was
//! whole, an order when the machine took it, the edges of the motors are spread over the time of which a
//! message tells, and the machine's answers are compared without its frames.
//!
//! ```text
//!   > 02 44 01 ... 00        > 02 88 0e b0 09        target 900 600, pen up
//!   < 0f 44 01 ... 00        @ edge x+ ...           (moved 900 600)
//!                            < 12 01                 reached 1
//! ```

use crate::frames::{FrameReader, FrameStream, Said};
use crate::import::Side;
use crate::log::{Event, Record, SwitchName};
use core::time::Duration;
use plotter_motion::protocol::{Hello, Message, MessageError, Order};
use plotter_motion::{Axis, Direction, StepPoint};
use std::collections::VecDeque;

/// How often a machine tells where its motors are: what it tells has happened since then.
const TOLD_EVERY: Duration = Duration::from_millis(20);
/// Edges that may be told at once beyond one a microsecond since the beginning, which is more than any motor
/// makes: where a machine stood before, and what it went on while a cable was out. More are left out.
const MOST_AT_ONCE: u64 = 1 << 18;
/// Records that wait for edges before them.
const MOST_WAITING: usize = 1 << 20;
/// First byte by which a host opens a session in such a recording; the number of it follows, low byte first.
/// No message begins with it.
pub(crate) const SESSION: u8 = b'H';

/// Takes the frames off a recording.
#[derive(Debug)]
pub(super) struct Unframed<I> {
    records: I,
    frames: FrameReader,
    host: FrameStream,
    machine: FrameStream,
    session: u16,
    /// The last order with its number, until the machine has taken it; and what the machine does.
    order: Option<(u32, Order)>,
    state: Order,
    /// Whether the host has sent a stop by itself that is not answered; and whether the machine's own button
    /// has stopped it.
    stop_is_new: bool,
    is_pressed: bool,
    /// Whether the machine has begun the session, and targets taken before the first.
    is_open: bool,
    before: Option<u32>,
    position: StepPoint,
    told: Duration,
    /// Edges so far.
    edges: u64,
    /// In the order of their times; edges may still come between them.
    waiting: VecDeque<Record>,
    now: Duration,
    is_over: bool,
}

impl<I: Iterator<Item = Record>> Unframed<I> {
    pub(super) fn new(records: I) -> Self {
        Self {
            records,
            frames: FrameReader::default(),
            host: FrameStream::default(),
            machine: FrameStream::default(),
            session: 0,
            order: None,
            state: Order::GoOn,
            stop_is_new: false,
            is_pressed: false,
            is_open: false,
            before: None,
            position: StepPoint::default(),
            told: Duration::ZERO,
            edges: 0,
            waiting: VecDeque::new(),
            now: Duration::ZERO,
            is_over: false,
        }
    }

    fn take(&mut self, record: Record) {
        self.now = record.time;
        let (side, bytes) = match record.event {
            Event::Host(bytes) => (Side::Host, bytes),
            Event::Controller(bytes) => (Side::Controller, bytes),
            event => return self.put(event),
        };
        for byte in bytes {
            if let Some(said) = self.frames.push(side, byte) {
                self.said(side, said);
            }
        }
    }

    fn put(&mut self, event: Event) {
        self.waiting.push_back(Record { time: self.now, event });
    }

    fn said(&mut self, side: Side, said: Said) {
        let session = self.frames.session();
        if session != self.session {
            (self.session, self.order, self.is_open) = (session, None, false);
            self.state = Order::GoOn;
            (self.host, self.machine) = (FrameStream::default(), FrameStream::default());
        }
        // The machine has begun the session when it says anything in it.
        let begins = match said {
            Said::Hello(Hello { session: named, .. }) => named == session,
            Said::Data(..) | Said::Acknowledge(_) => true,
            Said::Order(..) | Said::Damaged(_) => false,
        };
        if begins && side == Side::Controller && session != 0 && !self.is_open {
            self.is_open = true;
            let [low, high] = session.to_le_bytes();
            self.put(Event::Host(vec![SESSION, low, high]));
        }
        let acknowledged = match said {
            Said::Order(0, order) => {
                self.stop_is_new |= order == Some(Order::Stop);
                return;
            }
            Said::Order(number, Some(order)) => {
                self.order = Some((number.into(), order));
                return;
            }
            Said::Hello(_) | Said::Order(..) | Said::Damaged(_) => return,
            Said::Acknowledge(until) => until,
            Said::Data(number, payload, until) => {
                let stream = if side == Side::Host { &mut self.host } else { &mut self.machine };
                let messages = stream.data(number, payload);
                self.messages(messages);
                until
            }
        };
        let other = if side == Side::Host { &mut self.machine } else { &mut self.host };
        let messages = other.acknowledged(acknowledged);
        self.messages(messages);
    }

    fn messages(&mut self, messages: Vec<Result<Message, MessageError>>) {
        for message in messages.into_iter().flatten() {
            match message {
                Message::Target { .. } => {
                    let (bytes, length) = message.encode();
                    self.put(Event::Host(bytes.get(..length).unwrap_or_default().to_vec()));
                }
                Message::Moved(by) => self.moved(by),
                Message::Status { taken, position, .. } => {
                    self.before.get_or_insert(taken);
                    let StepPoint { x, y } = self.position;
                    self.moved(StepPoint::new(position.x.wrapping_sub(x), position.y.wrapping_sub(y)));
                    self.answer(message);
                }
                Message::Stands { order, state } => {
                    self.stands(order, state);
                    // (it says so for each order, and for a stop by itself: what holds is what counts)
                    if core::mem::replace(&mut self.state, state) != state {
                        self.answer(message);
                    }
                }
                message => self.answer(message),
            }
        }
    }

    /// What has come to the machine before it said so: an order, or its own button.
    fn stands(&mut self, number: u32, state: Order) {
        let taken = self.order.take_if(|&mut (given, _)| given == number);
        if let Some((_, order)) = taken {
            self.put(Event::Host(vec![order.byte()]));
        } else if state == Order::Stop && self.stop_is_new {
            self.put(Event::Host(vec![Order::Stop.byte()]));
        } else if state == Order::Stop && self.state != Order::Stop {
            self.is_pressed = true;
            self.put(Event::Estop(true));
        } else if self.is_pressed && state != Order::Stop {
            self.is_pressed = false;
            self.put(Event::Estop(false));
            if let Ok(name) = SwitchName::new("reset") {
                self.put(Event::Switch { name, pressed: true });
            }
        }
        self.stop_is_new &= state != Order::Stop;
    }

    fn answer(&mut self, message: Message) {
        if let Some(bytes) = answer_bytes(message, self.before.unwrap_or(0)) {
            self.put(Event::Controller(bytes));
        }
    }

    /// The edges of a way, evenly over the time since the last was told.
    fn moved(&mut self, by: StepPoint) {
        let (x, y) = (by.x.unsigned_abs(), by.y.unsigned_abs());
        let most = x.max(y);
        let since = self.told.max(self.now.saturating_sub(TOLD_EVERY));
        self.told = self.now;
        self.position =
            StepPoint::new(self.position.x.wrapping_add(by.x), self.position.y.wrapping_add(by.y));
        let micros = |time: Duration| u64::try_from(time.as_micros()).unwrap_or(u64::MAX);
        let edges = self.edges.saturating_add(most.into());
        if most == 0 || edges > micros(self.now).saturating_add(MOST_AT_ONCE) {
            return;
        }
        self.edges = edges;
        let lasts_us = micros(self.now.saturating_sub(since));
        for n in 1..=most {
            let time = since + Duration::from_micros(lasts_us * u64::from(n) / u64::from(most));
            for (axis, way, total) in [(Axis::X, by.x, x), (Axis::Y, by.y, y)] {
                // Bresenham: the n-th of `most` brings this axis on if its share grows by a whole count.
                let share = |n: u32| u64::from(n) * u64::from(total) / u64::from(most);
                if share(n) > share(n - 1) {
                    let sign = if way > 0 { Direction::Plus } else { Direction::Minus };
                    self.waiting.push_back(Record { time, event: Event::Edge { axis, sign } });
                }
            }
        }
        self.waiting.make_contiguous().sort_by_key(|record| record.time);
    }
}

/// What a machine's message is in a recording without frames: the same, targets counted from `before`, no
/// place, which depends on when a session began, and no number of an order.
pub(super) fn answer_bytes(message: Message, before: u32) -> Option<Vec<u8>> {
    let message = match message {
        Message::Moved(_) | Message::Target { .. } => return None,
        Message::Status { taken, reached, .. } => Message::Status {
            boot: 0,
            taken: taken.wrapping_sub(before),
            reached: reached.wrapping_sub(before),
            position: StepPoint::default(),
        },
        Message::Reached(count) => Message::Reached(count.wrapping_sub(before)),
        Message::Refused(count) => Message::Refused(count.wrapping_sub(before)),
        Message::Stands { state, .. } => Message::Stands { order: 0, state },
        message => message,
    };
    let (bytes, length) = message.encode();
    bytes.get(..length).map(<[u8]>::to_vec)
}

impl<I: Iterator<Item = Record>> Iterator for Unframed<I> {
    type Item = Record;

    fn next(&mut self) -> Option<Record> {
        loop {
            // Later edges come after this.
            let settled = self.now.saturating_sub(TOLD_EVERY);
            let is_full = self.is_over || self.waiting.len() > MOST_WAITING;
            if self.waiting.front().is_some_and(|record| is_full || record.time <= settled) {
                return self.waiting.pop_front();
            }
            if self.is_over {
                return None;
            }
            match self.records.next() {
                Some(record) => self.take(record),
                None => self.is_over = true,
            }
        }
    }
}
