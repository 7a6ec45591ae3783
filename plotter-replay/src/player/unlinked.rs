//! [`Unlinked`]: a controller that speaks frames, with a host's end of the link before it, so that messages
//! go in and come out.

use super::Controller;
use super::unframed::{SESSION, answer_bytes};
use crate::log::SwitchName;
use core::time::Duration;
use plotter_motion::protocol::{Link, LinkSettings, Message, MessageDecoder, Order};
use plotter_motion::{Axis, Direction, Pen, StepPair, StepPoint};
use std::collections::VecDeque;

/// Bytes of messages that may wait for room in the link.
const MOST_WAITING: usize = 1 << 20;
/// Bytes that either side may have to say at one time.
const MOST_AT_ONCE: usize = 100_000;
/// How soon a link that has something to say, and no room for it, is asked again.
const ASK_AGAIN: Duration = Duration::from_millis(1);

/// A controller as it is, or behind the other end of a link that takes no time and loses nothing.
#[derive(Debug)]
pub(super) struct Unlinked<C> {
    pub(super) inner: C,
    end: Option<Box<End>>,
}

#[derive(Debug)]
struct End {
    /// `None` until a session is opened.
    link: Option<Link<8, 128>>,
    /// What the host says and is not whole yet.
    said: Vec<u8>,
    said_decoder: MessageDecoder,
    waiting: VecDeque<u8>,
    heard: MessageDecoder,
    answers: VecDeque<u8>,
    /// What the machine said last that holds.
    state: Order,
    asked: Duration,
}

impl<C: Controller> Unlinked<C> {
    /// The controller as it is.
    pub(super) const fn plain(inner: C) -> Self {
        Self { inner, end: None }
    }

    /// The controller behind a link, as [`Unframed`](super::unframed::Unframed) speaks to it.
    pub(super) fn behind_a_link(inner: C) -> Self {
        let end = End {
            link: None,
            said: Vec::new(),
            said_decoder: MessageDecoder::default(),
            waiting: VecDeque::new(),
            heard: MessageDecoder::default(),
            answers: VecDeque::new(),
            state: Order::GoOn,
            asked: Duration::ZERO,
        };
        Self { inner, end: Some(Box::new(end)) }
    }

    /// Lets both ends say what they have to say.
    fn converse(&mut self, now: Duration) {
        let Some(End { link: Some(link), waiting, heard, answers, state, asked, .. }) =
            self.end.as_deref_mut()
        else {
            return;
        };
        *asked = now;
        for _ in 0..MOST_AT_ONCE {
            while let Some(&byte) = waiting.front() {
                if link.write(&[byte]) == 0 {
                    break;
                }
                waiting.pop_front();
            }
            let down = link.transmit(now);
            if let Some(byte) = down {
                self.inner.receive(now, byte);
            }
            let up = self.inner.transmit_at(now);
            if let Some(byte) = up {
                link.receive(now, byte);
            }
            let mut byte = [0];
            while link.read(&mut byte) == 1 {
                let [byte] = byte;
                let Some(Ok(message)) = heard.push(byte) else { continue };
                if let Message::Stands { order, state: now } = message {
                    link.order_taken(u8::try_from(order).unwrap_or(0));
                    if core::mem::replace(state, now) == now {
                        continue;
                    }
                }
                answers.extend(answer_bytes(message, 0).into_iter().flatten());
            }
            if down.is_none() && up.is_none() {
                return;
            }
        }
    }
}

impl End {
    /// What the host says, byte by byte.
    fn says(&mut self, byte: u8) {
        self.said.push(byte);
        match (&*self.said, &mut self.link) {
            (&[SESSION, low, high], link) => {
                let session = u16::from_le_bytes([low, high]);
                match link {
                    Some(link) => link.call(session),
                    None => *link = Some(Link::host(session, LinkSettings::default())),
                }
                (self.heard, self.state) = (MessageDecoder::default(), Order::GoOn);
                self.waiting.clear();
            }
            (&[SESSION, ..], _) => return,
            (&[byte], Some(link)) if Order::from_byte(byte).is_some() => {
                if let Some(order) = Order::from_byte(byte) {
                    link.order(order);
                }
            }
            _ => {
                let Some(whole) = self.said_decoder.push(byte) else { return };
                if whole.is_ok() && self.waiting.len() < MOST_WAITING {
                    self.waiting.extend(&self.said);
                }
            }
        }
        self.said.clear();
    }
}

impl<C: Controller> Controller for Unlinked<C> {
    fn receive(&mut self, now: Duration, byte: u8) {
        match &mut self.end {
            Some(end) => {
                end.says(byte);
                self.converse(now);
            }
            None => self.inner.receive(now, byte),
        }
    }
    fn edge(&mut self, now: Duration, axis: Axis, sign: Direction) {
        self.inner.edge(now, axis, sign);
        self.converse(now);
    }
    fn switch(&mut self, now: Duration, name: &SwitchName, pressed: bool) {
        self.inner.switch(now, name, pressed);
        self.converse(now);
    }
    fn emergency_stop(&mut self, now: Duration, pressed: bool) {
        self.inner.emergency_stop(now, pressed);
        self.converse(now);
    }
    fn next_tick(&self) -> Option<Duration> {
        let Some(end) = &self.end else { return self.inner.next_tick() };
        let wakes = [self.inner.next_transmission(), end.link.as_ref().and_then(Link::next_wake)];
        let wakes = wakes.into_iter().flatten().map(|wake| wake.max(end.asked.saturating_add(ASK_AGAIN)));
        self.inner.next_tick().into_iter().chain(wakes).min()
    }
    fn tick(&mut self, now: Duration) {
        self.inner.tick(now);
        self.converse(now);
        if let Some(end) = &mut self.end {
            end.asked = now;
        }
    }
    fn transmit(&mut self) -> Option<u8> {
        None // asked with the time only
    }
    fn transmit_at(&mut self, now: Duration) -> Option<u8> {
        match &mut self.end {
            Some(end) => end.answers.pop_front(),
            None => self.inner.transmit_at(now),
        }
    }
    fn waits_for_line(&self) -> bool {
        self.end.is_none() && self.inner.waits_for_line()
    }
    fn next_transmission(&self) -> Option<Duration> {
        self.inner.next_transmission()
    }
    fn duty(&self, axis: Axis) -> i32 {
        self.inner.duty(axis)
    }
    fn target(&mut self, now: Duration, pen: Pen, target: StepPoint) {
        self.inner.target(now, pen, target);
    }
    fn makes_steps(&self) -> bool {
        self.inner.makes_steps()
    }
    fn step(&mut self, now: Duration) -> Option<StepPair> {
        self.inner.step(now)
    }
    fn pen(&self) -> Option<Pen> {
        self.inner.pen()
    }
}
