//! [`Linked`]: the reliable link in a recording, as what it tells of targets and motors.

use super::{AnomalyKind, VirtualPlotter};
use crate::frames::{FrameReader, FrameStream, Said};
use crate::import::Side;
use plotter_motion::protocol::{CALL_ZEROS, Message, MessageError, Order};
use plotter_motion::{Pen, PenMove, StepPoint};
use std::collections::VecDeque;

/// Targets that a host sends ahead at most, and some more: what is kept of those not reached.
const MOST_AHEAD: usize = 256;

/// How a recorded line is spoken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Speech {
    /// By ten digits a target. A controller's greeting ends that.
    Digits,
    /// The host calls, and may speak digits if nobody answers: so many zeros so far.
    Calling(u32),
    /// By frames.
    Frames,
}

/// What is known of a link.
#[derive(Clone, Debug)]
pub(super) struct Linked {
    pub(super) speech: Speech,
    reader: FrameReader,
    host: FrameStream,
    controller: FrameStream,
    session: u16,
    /// Whether the machine has begun it: what comes before is of an earlier one.
    is_open: bool,
    /// Targets sent and not reached, with their number since the machine was switched on, the first of them
    /// under way.
    ahead: VecDeque<(u32, PenMove)>,
    next_number: u32,
    last_target: StepPoint,
    /// What the machine said last of itself.
    order: Order,
}

impl Linked {
    pub(super) fn new(speech: Speech) -> Self {
        Self {
            speech,
            reader: FrameReader::default(),
            host: FrameStream::default(),
            controller: FrameStream::default(),
            session: 0,
            is_open: false,
            ahead: VecDeque::new(),
            next_number: 1,
            last_target: StepPoint::default(),
            order: Order::GoOn,
        }
    }
}

impl VirtualPlotter {
    /// Takes a byte of the host; says whether it belongs to the link.
    pub(super) fn host_link_byte(&mut self, byte: u8) -> bool {
        match self.linked.speech {
            Speech::Digits => false,
            Speech::Calling(zeros) => {
                let _ = self.linked.reader.push(Side::Host, byte);
                if byte == 0 {
                    self.linked.speech = Speech::Calling(zeros.saturating_add(1));
                } else if byte <= 9 {
                    // Nobody has answered the calls, so that is a digit, as are the zeros after the last of
                    // them.
                    self.linked.speech = Speech::Digits;
                    for _ in 0..zeros % u32::from(CALL_ZEROS) {
                        let decoded = self.host.push(self.now, 0);
                        self.take(decoded);
                    }
                    return false;
                }
                true
            }
            Speech::Frames => {
                let said = self.linked.reader.push(Side::Host, byte);
                self.said(Side::Host, said);
                true
            }
        }
    }

    /// Takes a byte of the controller; says whether it belongs to the link.
    pub(super) fn controller_link_byte(&mut self, byte: u8) -> bool {
        let said = self.linked.reader.push(Side::Controller, byte);
        match (self.linked.speech, &said) {
            (Speech::Digits | Speech::Calling(_), Some(Said::Hello(_))) => {
                // (a session that began before the recording greets again)
                self.host.drop_partial();
                self.next = None;
                self.under_way = 0;
                self.forget_call();
                self.linked.speech = Speech::Frames;
                true
            }
            // A machine of digits answers to a call that it is there already.
            (Speech::Calling(_), _) => !matches!(byte, b'1'..=b'4' | b'a'..=b'd'),
            (Speech::Digits, _) => false,
            (Speech::Frames, _) => {
                self.said(Side::Controller, said);
                true
            }
        }
    }

    /// What a log of digits has noted of a call and its answer was neither.
    fn forget_call(&mut self) {
        let is_greeting = |kind: &AnomalyKind| {
            matches!(kind, AnomalyKind::UnknownReply { .. } | AnomalyKind::BeganInsideTarget { .. })
        };
        while self.anomalies.last().is_some_and(|anomaly| is_greeting(&anomaly.kind)) {
            self.anomalies.pop();
            self.anomaly_count = self.anomaly_count.saturating_sub(1);
        }
        while self.targets.last().is_some_and(|&(_, target)| target == StepPoint::default()) {
            self.targets.pop();
            self.target_count = self.target_count.saturating_sub(1);
        }
        self.leg.target = None;
    }

    fn said(&mut self, side: Side, said: Option<Said>) {
        let session = self.linked.reader.session();
        if session != self.linked.session {
            self.linked.session = session;
            (self.linked.host, self.linked.controller) = (FrameStream::default(), FrameStream::default());
            (self.linked.last_target, self.linked.is_open) = (StepPoint::default(), false);
        }
        let acknowledged = match said {
            Some(Said::Hello(hello)) => {
                self.linked.is_open |= side == Side::Controller && session != 0 && hello.session == session;
                return;
            }
            None | Some(Said::Order(..)) => return,
            Some(Said::Damaged(_)) if self.linked.is_open => {
                return self.note(self.now, AnomalyKind::DamagedFrame { side });
            }
            Some(Said::Damaged(_)) => return,
            Some(Said::Acknowledge(until)) => until,
            Some(Said::Data(number, payload, until)) => {
                let stream = match side {
                    Side::Host => &mut self.linked.host,
                    Side::Controller => &mut self.linked.controller,
                };
                let messages = stream.data(number, payload);
                self.messages(messages);
                until
            }
        };
        let other = match side {
            Side::Host => &mut self.linked.controller,
            Side::Controller => &mut self.linked.host,
        };
        let messages = other.acknowledged(acknowledged);
        let count = other.take_missing();
        self.messages(messages);
        if count > 0 {
            self.note(self.now, AnomalyKind::FramesMissing { count });
        }
    }

    fn messages(&mut self, messages: Vec<Result<Message, MessageError>>) {
        for message in messages {
            match message {
                Ok(message) => self.message(message),
                Err(_) => self.note(self.now, AnomalyKind::FramesMissing { count: 0 }),
            }
        }
    }

    fn message(&mut self, message: Message) {
        match message {
            Message::Target { pen, by } => {
                let StepPoint { x, y } = self.linked.last_target;
                let target = StepPoint::new(x.wrapping_add(by.x), y.wrapping_add(by.y));
                self.linked.last_target = target;
                let number = self.linked.next_number;
                self.linked.next_number = number.wrapping_add(1);
                self.target_count = self.target_count.saturating_add(1);
                if self.targets.len() < self.settings.max_entries {
                    self.targets.push((self.now, target));
                }
                if self.linked.ahead.len() < MOST_AHEAD {
                    self.linked.ahead.push_back((number, PenMove { pen, target }));
                }
                self.begin_ahead();
            }
            Message::Status { taken, reached, position, .. } => {
                self.done_until(reached);
                // What was not taken is sent again, or never.
                let before = self.linked.ahead.len();
                self.linked.ahead.retain(|&(number, _)| number <= taken);
                let dropped = (before - self.linked.ahead.len()) as u64;
                self.target_count = self.target_count.saturating_sub(dropped);
                if self.linked.ahead.is_empty() {
                    (self.next, self.leg.target, self.under_way) = (None, None, 0);
                }
                self.linked.next_number = taken.wrapping_add(1);
                if position != self.counted {
                    if self.target_count == 0 {
                        self.begin_at(position);
                    } else {
                        self.counted = position;
                        self.add_point();
                    }
                }
            }
            Message::Moved(by) => {
                self.counted.x = self.counted.x.wrapping_add(by.x);
                self.counted.y = self.counted.y.wrapping_add(by.y);
                self.add_point();
            }
            Message::Reached(count) => self.done_until(count),
            Message::Refused(count) => {
                self.done_until(count.wrapping_sub(1));
                if let Some((_, PenMove { target, .. })) = self.linked.ahead.pop_front() {
                    self.note(self.now, AnomalyKind::Refused { target });
                }
                (self.next, self.under_way) = (None, 0);
                self.begin_ahead();
            }
            Message::Stands { state, .. } => {
                if state == Order::Stop && self.linked.order != Order::Stop {
                    self.stop_count = self.stop_count.saturating_add(1);
                }
                self.linked.order = state;
            }
            _ => {}
        }
    }

    /// The machine is done with all targets up to this number.
    fn done_until(&mut self, count: u32) {
        while self.linked.ahead.front().is_some_and(|&(number, _)| number <= count) {
            self.linked.ahead.pop_front();
            self.target_reached();
            self.begin_ahead();
        }
    }

    /// The first target that is not reached is the one under way.
    fn begin_ahead(&mut self) {
        if let (None, Some(&(_, PenMove { pen, target }))) = (self.next, self.linked.ahead.front()) {
            self.pen_recorded = true;
            self.set_pen(pen);
            (self.next, self.under_way) = (Some(target), 1);
            self.leg.target = Some(target);
        }
    }

    /// The machine stands somewhere else than at the origin before the first target.
    fn begin_at(&mut self, position: StepPoint) {
        self.end_leg(None);
        (self.counted, self.from, self.pen) = (position, position, Pen::Up);
        self.leg = self.begin_leg();
    }
}
