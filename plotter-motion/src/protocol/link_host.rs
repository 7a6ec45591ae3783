//! [`LinkHost`]: sends a drawing over the reliable link, or by the digits protocol to a machine that knows no
//! other.

use super::link::{Link, LinkSettings, LinkState};
use super::message::{Message, MessageDecoder};
use super::{Host, HostEvent, HostNotice, HostSettings, Order};
use crate::{PenMove, StepPoint};
use core::time::Duration;

/// Targets that are sent ahead of the one that is drawn, at most; as many are kept to be sent again in
/// another session.
const AHEAD: usize = 32;

/// Where a drawing was left that another host had begun.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Resume {
    /// The machine's number when the drawing was begun ([`LinkHost::progress`]): had it been switched off
    /// since, it would not know where its motors stand.
    pub boot: u32,
    /// Targets that it had taken before the drawing's first.
    pub before: u32,
}

/// How far a drawing is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct LinkProgress {
    /// For [`Resume`], once the machine has said how it stands.
    pub resume: Option<Resume>,
    /// Moves reached, those before a [`Resume`] among them.
    pub reached: u32,
}

/// Sends the moves of a drawing over a [`Link`], ahead of the machine as far as that has room; sans-IO.
///
/// Every move is drawn once, whatever happens on the line; after a cable was out it goes on by itself. A host
/// started anew goes on where the last one was, with the same moves and [`Resume`]: the machine says how many
/// targets it has taken. To a machine that knows digits only, it is a [`Host`].
///
/// Feed it bytes ([`receive`](Self::receive)) and [`poll`](Self::poll) it after each, and at
/// [`next_wake`](Self::next_wake), until it has nothing new; send what [`next_byte`](Self::next_byte) says as
/// the line takes it.
#[derive(Clone, Debug)]
pub struct LinkHost<I, const WINDOW: usize, const PAYLOAD: usize> {
    moves: Option<I>,
    link: Link<WINDOW, PAYLOAD>,
    decoder: MessageDecoder,
    byte_gap: Duration,
    host_settings: HostSettings,
    digits: Option<Host<I>>,
    resume: Option<Resume>,
    /// Targets not known to be reached, the oldest first; and how many of them are written in this session.
    ahead: [PenMove; AHEAD],
    ahead_length: usize,
    written: usize,
    /// Number, since the machine was switched on, of the oldest.
    oldest: u32,
    /// Whether the machine has said in this session how it stands.
    status: bool,
    begun: bool,
    /// How many targets the machine is done with, and which of them was refused last.
    reached_there: u32,
    refused: Option<u32>,
    last_target: StepPoint,
    position: StepPoint,
    reached: u32,
    interrupted: bool,
    finished: bool,
    event: Option<HostEvent>,
    session: u16,
    /// What the machine says it does, and the last order by digits that is not out.
    state: Order,
    order_byte: Option<u8>,
    /// Whether it is never done for want of moves.
    stays: bool,
    /// Whether the machine is called anew to take moves back, and how many it has kept.
    withdraws: bool,
    kept: Option<usize>,
}

impl<I: Iterator<Item = PenMove>, const WINDOW: usize, const PAYLOAD: usize> LinkHost<I, WINDOW, PAYLOAD> {
    /// A host with a drawing to send. `nonce`: see [`Link::host`]. `byte_gap` and `host_settings` are for a
    /// machine that knows digits only: see [`Host::new`].
    #[must_use]
    pub fn new(
        nonce: u16,
        link_settings: LinkSettings,
        byte_gap: Duration,
        host_settings: HostSettings,
        moves: I,
    ) -> Self {
        Self {
            moves: Some(moves),
            link: Link::host(nonce, link_settings),
            decoder: MessageDecoder::default(),
            byte_gap,
            host_settings,
            digits: None,
            resume: None,
            ahead: [PenMove::default(); AHEAD],
            ahead_length: 0,
            written: 0,
            oldest: 0,
            status: false,
            begun: false,
            reached_there: 0,
            refused: None,
            last_target: StepPoint::default(),
            position: StepPoint::default(),
            reached: 0,
            interrupted: false,
            finished: false,
            event: None,
            session: 0,
            state: Order::GoOn,
            order_byte: None,
            stays: false,
            withdraws: false,
            kept: None,
        }
    }

    /// The same, which is never done for want of moves: it asks for more at each [`poll`](Self::poll), as a
    /// person leads a machine by hand.
    #[must_use]
    pub const fn staying(mut self) -> Self {
        self.stays = true;
        self
    }

    /// Takes back the moves that the machine has not begun, by another session. How many it keeps, and
    /// finishes, [`take_kept`](Self::take_kept) says; until then give it no others. A machine of digits has
    /// none that it has not begun.
    pub fn withdraw(&mut self) {
        if self.digits.is_some() || self.ahead_length == 0 {
            self.kept = Some(self.ahead_length);
            return;
        }
        self.withdraws = true;
        let next = self.link.session().wrapping_add(1);
        self.link.call(next);
    }

    /// How many of the moves that are not reached the machine keeps, once it has said so after
    /// [`withdraw`](Self::withdraw).
    pub const fn take_kept(&mut self) -> Option<usize> {
        self.kept.take()
    }

    /// Goes on with a drawing that another host has begun: `moves` are all of it, from its first.
    #[must_use]
    pub const fn resuming(mut self, resume: Resume) -> Self {
        self.resume = Some(resume);
        self
    }

    /// Gives an order, which goes out before anything else; what became of it, a notice says. An order that
    /// was not answered is repeated, over frames. To a machine of digits a hold is nothing: it has one target
    /// at a time, so send it no other.
    pub const fn order(&mut self, order: Order) {
        if self.digits.is_none() {
            self.link.order(order);
        } else if !matches!(order, Order::Hold) {
            self.order_byte = Some(order.byte());
        }
    }

    /// State that the machine has reported.
    #[must_use]
    pub const fn state(&self) -> Order {
        self.state
    }

    /// Whether the machine is known to speak the digits protocol only.
    #[must_use]
    pub const fn is_digits(&self) -> bool {
        self.digits.is_some()
    }

    /// Takes a byte from the machine.
    pub fn receive(&mut self, now: Duration, byte: u8) {
        match &mut self.digits {
            Some(host) => {
                self.event = host.receive(now, byte);
                match self.event {
                    Some(HostEvent::Notice(HostNotice::Stopped)) => self.state = Order::Stop,
                    Some(HostEvent::Notice(HostNotice::GoesOn)) => self.state = Order::GoOn,
                    _ => {}
                }
            }
            None => self.link.receive(now, byte),
        }
    }

    /// Says what is new, one after the other; `None` if there is nothing more.
    pub fn poll(&mut self, now: Duration) -> Option<HostEvent> {
        if let Some(event) = self.event.take() {
            return Some(event);
        }
        if let Some(host) = &mut self.digits {
            return host.poll(now);
        }
        if self.finished {
            return None;
        }
        match self.link.state() {
            LinkState::DigitsOnly => {
                let moves = self.moves.take()?;
                let host = Host::new(self.byte_gap, self.host_settings, moves);
                self.digits = Some(if self.stays { host.staying() } else { host });
                if core::mem::take(&mut self.withdraws) {
                    self.kept = Some(0);
                }
                return Some(HostEvent::Notice(HostNotice::DigitsOnly));
            }
            LinkState::Restarted => {
                let next = self.link.session().wrapping_add(1);
                self.link.call(next);
            }
            state @ (LinkState::Open | LinkState::Interrupted) => {
                let interrupted = state == LinkState::Interrupted;
                if interrupted != core::mem::replace(&mut self.interrupted, interrupted) {
                    return Some(HostEvent::Notice(if interrupted {
                        HostNotice::Interrupted
                    } else {
                        HostNotice::Resumed
                    }));
                }
            }
            _ => return None,
        }
        if self.link.session() != self.session {
            self.session = self.link.session();
            (self.decoder, self.status, self.written) = (MessageDecoder::default(), false, 0);
            (self.last_target, self.state) = (StepPoint::default(), Order::GoOn);
        }
        let mut byte = [0];
        while self.link.read(&mut byte) == 1 {
            let [byte] = byte;
            match self.decoder.push(byte) {
                None => {}
                Some(Ok(message)) => {
                    if let Some(event) = self.said(message).or_else(|| self.done_with()) {
                        return Some(event);
                    }
                }
                Some(Err(error)) => {
                    self.finished = true;
                    return Some(HostEvent::Notice(HostNotice::NotUnderstood(error)));
                }
            }
        }
        if let Some(event) = self.done_with() {
            return Some(event);
        }
        self.send_ahead();
        self.finished =
            !self.stays && self.status && self.ahead_length == 0 && self.reached_there == self.oldest;
        if self.status && !self.begun && self.ahead_length > 0 {
            self.begun = true;
            return self.ahead.first().map(|&first| HostEvent::Begun(first));
        }
        None
    }

    fn said(&mut self, message: Message) -> Option<HostEvent> {
        match message {
            Message::Status { boot, taken, reached, position } => {
                (self.status, self.reached_there, self.position) = (true, reached, position);
                self.stands(boot, taken)
            }
            Message::Moved(by) => {
                self.position.x = self.position.x.wrapping_add(by.x);
                self.position.y = self.position.y.wrapping_add(by.y);
                None
            }
            Message::Reached(count) => {
                self.reached_there = count;
                None
            }
            Message::Refused(count) => {
                (self.reached_there, self.refused) = (count, Some(count));
                None
            }
            Message::Stands { order, state } => {
                let order = u8::try_from(order).unwrap_or(0);
                self.link.order_taken(order);
                let is_new = core::mem::replace(&mut self.state, state) != state;
                is_new.then_some(HostEvent::Notice(match state {
                    Order::Stop => HostNotice::Stopped,
                    Order::Hold => HostNotice::Held,
                    Order::GoOn => HostNotice::GoesOn,
                }))
            }
            Message::Target { .. } => None,
        }
    }

    /// The oldest target that the machine is done with, if it is done with any.
    fn done_with(&mut self) -> Option<HostEvent> {
        let done_there = self.reached_there.wrapping_sub(self.oldest) as usize;
        if !self.status || done_there == 0 || done_there > self.ahead_length {
            return None;
        }
        let oldest = self.ahead.first().copied().unwrap_or_default();
        if !core::mem::replace(&mut self.begun, true) {
            return Some(HostEvent::Begun(oldest));
        }
        self.ahead.rotate_left(1);
        self.ahead_length = self.ahead_length.saturating_sub(1);
        self.written = self.written.saturating_sub(1);
        self.oldest = self.oldest.wrapping_add(1);
        self.begun = false;
        if self.refused == Some(self.oldest) {
            return Some(HostEvent::Notice(HostNotice::OutOfArea(oldest.target)));
        }
        self.reached = self.reached.saturating_add(1);
        Some(HostEvent::Reached(oldest))
    }

    /// The machine says how it stands as a session begins.
    fn stands(&mut self, boot: u32, taken: u32) -> Option<HostEvent> {
        match self.resume {
            None => {
                self.resume = Some(Resume { boot, before: taken });
                self.oldest = taken;
            }
            Some(resume) if resume.boot != boot => {
                self.finished = true;
                return Some(HostEvent::Notice(HostNotice::MachineRestarted));
            }
            Some(resume) if self.reached == 0 && self.ahead_length == 0 => {
                // A host started anew: what the machine has taken, it has drawn or draws now.
                self.oldest = taken;
                self.reached = taken.wrapping_sub(resume.before);
                for _ in 0..self.reached {
                    if self.moves.as_mut().and_then(Iterator::next).is_none() {
                        break;
                    }
                }
            }
            Some(_) => {
                // Another session of the same host: what was taken is not sent again.
                self.written = (taken.wrapping_sub(self.oldest) as usize).min(self.ahead_length);
                if core::mem::take(&mut self.withdraws) {
                    self.ahead_length = self.written;
                    self.begun &= self.written > 0;
                    self.kept = Some(self.written);
                }
            }
        }
        None
    }

    /// Writes targets while there is room for them.
    fn send_ahead(&mut self) {
        if !self.status {
            return;
        }
        loop {
            if self.written == self.ahead_length {
                let Some(place) = self.ahead.get_mut(self.ahead_length) else { return };
                let Some(next) = self.moves.as_mut().and_then(Iterator::next) else { return };
                *place = next;
                self.ahead_length += 1;
            }
            let Some(&next) = self.ahead.get(self.written) else { return };
            let StepPoint { x, y } = next.target;
            let by = StepPoint::new(x.wrapping_sub(self.last_target.x), y.wrapping_sub(self.last_target.y));
            let (bytes, length) = Message::Target { pen: next.pen, by }.encode();
            let bytes = bytes.get(..length).unwrap_or_default();
            if self.link.room() < bytes.len() {
                return;
            }
            self.link.write(bytes);
            self.last_target = next.target;
            self.written += 1;
        }
    }

    /// The next byte for the line, if it is time for one.
    #[must_use]
    pub fn next_byte(&mut self, now: Duration) -> Option<u8> {
        match &mut self.digits {
            Some(host) => self.order_byte.take().or_else(|| host.next_byte(now)),
            None => self.link.transmit(now),
        }
    }

    /// When [`poll`](Self::poll) or [`next_byte`](Self::next_byte) has something to do, unless a byte comes
    /// before.
    #[must_use]
    pub fn next_wake(&self) -> Option<Duration> {
        match &self.digits {
            Some(_) if self.order_byte.is_some() => Some(Duration::ZERO),
            Some(host) => host.next_wake(),
            None => self.link.next_wake(),
        }
    }

    /// Whether all is drawn, or cannot be.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.digits.as_ref().map_or(self.finished, Host::is_done)
    }

    /// Where the machine says that its motors are.
    #[must_use]
    pub fn position(&self) -> StepPoint {
        self.digits.as_ref().map_or(self.position, Host::position)
    }

    /// How far the drawing is.
    #[must_use]
    pub fn progress(&self) -> LinkProgress {
        match &self.digits {
            Some(host) => LinkProgress { resume: None, reached: host.progress().1 },
            None => LinkProgress { resume: self.resume.filter(|_| self.status), reached: self.reached },
        }
    }

    /// The link.
    #[must_use]
    pub const fn link(&self) -> &Link<WINDOW, PAYLOAD> {
        &self.link
    }
}
