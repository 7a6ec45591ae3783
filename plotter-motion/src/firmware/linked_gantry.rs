//! [`LinkedGantry`]: the gantry's controller behind the reliable link, and behind the digits as before.

use super::{Gantry, Notice};
use crate::control::{ChosenController, LineController};
use crate::protocol::digits::{Reply, TARGET_BYTES};
use crate::protocol::{Link, LinkSettings, LinkState, Message, MessageDecoder, Order};
use crate::{Axis, Direction, Pen, StepPoint};
use core::time::Duration;

/// How often the host is told where the motors are.
const REPORT_EVERY: Duration = Duration::from_millis(20);
/// Most bytes of a message of that: its kind and two numbers.
const MOST_MOVED: usize = 1 + 2 * 5;
/// How long digits wait, lest they are part of a call.
const DIGITS_WAIT: Duration = Duration::from_millis(5);

/// A [`Gantry`] whose host may speak either protocol: the digits from the first byte on, or frames once it
/// has called. After the first session it knows frames only, until it is switched off.
///
/// The next targets wait in the link's window, so the motors need not wait for the line. The host is told
/// every 20 ms where the motors are, and of each target reached. Orders pass the window by: a stop has acted
/// when [`receive`](Self::receive) of its last byte returns.
///
/// Time, edges and switches go to the gantry itself ([`gantry_mut`](Self::gantry_mut)); after each of them,
/// and after each byte, [`poll`](Self::poll) this one, and fetch the bytes for the line.
#[derive(Debug, PartialEq)]
pub struct LinkedGantry<const WINDOW: usize, const PAYLOAD: usize, C = ChosenController> {
    gantry: Gantry<C>,
    link: Link<WINDOW, PAYLOAD>,
    decoder: MessageDecoder,
    boot: u32,
    session: u16,
    /// Targets taken and done with since the machine was switched on.
    taken: u32,
    reached: u32,
    last_target: StepPoint,
    under_way: bool,
    /// What became of the last target, while it is not told.
    answer: Option<Message>,
    pen: Pen,
    /// Where the host was told that the motors are, and where they are.
    told: StepPoint,
    position: StepPoint,
    told_at: Duration,
    status_due: bool,
    /// No further target is begun.
    is_held: bool,
    /// The last order in a session, and what the host was told of it.
    order: u8,
    told_order: (u8, Order),
    /// Bytes of digits that wait, and when the last of them came.
    held: [u8; TARGET_BYTES],
    held_length: u8,
    held_at: Duration,
}

impl<const WINDOW: usize, const PAYLOAD: usize, C: LineController> LinkedGantry<WINDOW, PAYLOAD, C> {
    /// Puts `gantry`, with its motors at rest, behind the link. `boot` is another number each time that the
    /// machine is switched on: a count in non-volatile memory, or noise.
    #[must_use]
    pub fn new(gantry: Gantry<C>, boot: u32, settings: LinkSettings) -> Self {
        Self {
            gantry,
            link: Link::machine(settings),
            decoder: MessageDecoder::default(),
            boot,
            session: 0,
            taken: 0,
            reached: 0,
            last_target: StepPoint::default(),
            under_way: false,
            answer: None,
            pen: Pen::Up,
            told: StepPoint::default(),
            position: StepPoint::default(),
            told_at: Duration::ZERO,
            status_due: false,
            is_held: false,
            order: 0,
            told_order: (0, Order::GoOn),
            held: [0; TARGET_BYTES],
            held_length: 0,
            held_at: Duration::ZERO,
        }
    }

    /// The controller.
    #[must_use]
    pub const fn gantry(&self) -> &Gantry<C> {
        &self.gantry
    }

    /// The controller, for time, edges and switches.
    pub const fn gantry_mut(&mut self) -> &mut Gantry<C> {
        &mut self.gantry
    }

    /// The link.
    #[must_use]
    pub const fn link(&self) -> &Link<WINDOW, PAYLOAD> {
        &self.link
    }

    /// Where the pen belongs: as the target under way has it, and up where none is, at the end, in a hold or
    /// a stop. The digits protocol does not say: up.
    #[must_use]
    pub const fn pen(&self) -> Pen {
        if self.under_way && !self.gantry.is_stopped() { self.pen } else { Pen::Up }
    }

    /// State of the machine, by the last order and the button.
    #[must_use]
    pub const fn state(&self) -> Order {
        if self.gantry.is_stopped() {
            Order::Stop
        } else if self.is_held {
            Order::Hold
        } else {
            Order::GoOn
        }
    }

    fn obey(&mut self, number: u8, order: Order) {
        self.is_held = order == Order::Hold;
        self.gantry.stop_by_host(order == Order::Stop);
        if number > 0 {
            // An order that comes again was not known to have come: it is answered again.
            self.order = number;
            self.told_order.0 = 0;
        }
    }

    /// Takes a byte from the host. An order is obeyed when this returns.
    pub fn receive(&mut self, now: Duration, byte: u8) {
        self.link.receive(now, byte);
        if let Some((number, order)) = self.link.take_order() {
            self.obey(number, order);
        }
        if self.link.state() != LinkState::Idle {
            return;
        }
        if Order::from_byte(byte).is_some() {
            return self.gantry.receive(now, byte); // before any digits that wait
        }
        if now > self.held_at.saturating_add(DIGITS_WAIT) {
            self.let_digits_pass(now);
        }
        if let Some(place) = self.held.get_mut(usize::from(self.held_length)) {
            *place = byte;
        }
        (self.held_length, self.held_at) = (self.held_length.saturating_add(1), now);
    }

    /// A host of digits sends a target, ten bytes at most, and waits for its answer; more in a row are a
    /// call, or what became of one.
    fn let_digits_pass(&mut self, now: Duration) {
        let length = usize::from(core::mem::take(&mut self.held_length));
        let held = self.held;
        for &byte in held.get(..length).unwrap_or_default() {
            self.gantry.receive(now, byte);
        }
    }

    /// Takes targets and notes what the motors did.
    pub fn poll(&mut self, now: Duration) {
        if self.link.session() == 0 {
            if now >= self.held_at.saturating_add(DIGITS_WAIT) {
                self.let_digits_pass(now);
            }
            return;
        }
        if self.link.session() != self.session {
            // What the last host sent and was not taken, this one sends itself.
            self.session = self.link.session();
            (self.decoder, self.answer) = (MessageDecoder::default(), None);
            self.last_target = StepPoint::default();
            self.status_due = true;
            (self.order, self.told_order) = (0, (0, Order::GoOn));
        }
        self.note_pulses();
        self.report(now);
        // The pen and the motors are led to one target at a time.
        while self.answer.is_none() && !self.under_way && !self.status_due && self.state() == Order::GoOn {
            let Some((pen, target)) = self.next_target() else { break };
            self.taken = self.taken.wrapping_add(1);
            if self.gantry.go_to(now, target) {
                (self.pen, self.under_way) = (pen, true);
                self.note_pulses();
            } else {
                self.reached = self.reached.wrapping_add(1);
                self.answer = Some(Message::Refused(self.reached));
            }
            self.report(now);
        }
    }

    fn next_target(&mut self) -> Option<(Pen, StepPoint)> {
        let mut byte = [0];
        while self.link.read(&mut byte) == 1 {
            let [byte] = byte;
            // The other side's mistakes cost their message; a host says what it does not understand.
            if let Some(Ok(Message::Target { pen, by })) = self.decoder.push(byte) {
                let StepPoint { x, y } = self.last_target;
                self.last_target = StepPoint::new(x.wrapping_add(by.x), y.wrapping_add(by.y));
                return Some((pen, self.last_target));
            }
        }
        None
    }

    /// What the gantry says to a host of digits.
    fn note_pulses(&mut self) {
        while let Some(byte) = self.gantry.transmit() {
            match Reply::from_byte(byte) {
                Some(Reply::Pulse(axis, direction)) => self.count(axis, direction),
                Some(Reply::Reached) if self.under_way => {
                    self.under_way = false;
                    self.reached = self.reached.wrapping_add(1);
                    self.answer = Some(Message::Reached(self.reached));
                }
                _ => {}
            }
        }
    }

    fn count(&mut self, axis: Axis, direction: Direction) {
        let coordinate = match axis {
            Axis::X => &mut self.position.x,
            Axis::Y => &mut self.position.y,
        };
        *coordinate = coordinate.wrapping_add(direction.sign());
    }

    /// Tells the host what is new, as far as the link has room; the rest later, in one.
    fn report(&mut self, now: Duration) {
        if self.status_due {
            let Self { boot, taken, reached, position, .. } = *self;
            if !self.tell(Message::Status { boot, taken, reached, position }) {
                return;
            }
            (self.status_due, self.told) = (false, position);
        }
        let (order, state) = (self.order, self.state());
        if self.told_order != (order, state) && self.tell(Message::Stands { order: order.into(), state }) {
            self.told_order = (order, state);
        }
        let by = StepPoint::new(
            self.position.x.wrapping_sub(self.told.x),
            self.position.y.wrapping_sub(self.told.y),
        );
        let time = self.answer.is_some() || now.saturating_sub(self.told_at) >= REPORT_EVERY;
        if by != StepPoint::default() && time {
            if !self.tell(Message::Moved(by)) {
                return;
            }
            (self.told, self.told_at) = (self.position, now);
        }
        if let Some(answer) = self.answer
            && self.tell(answer)
        {
            self.answer = None;
        }
    }

    fn tell(&mut self, message: Message) -> bool {
        let (bytes, length) = message.encode();
        let bytes = bytes.get(..length).unwrap_or_default();
        self.link.room() >= bytes.len() && self.link.write(bytes) == bytes.len()
    }

    /// The next byte for the host, if there is one.
    #[must_use]
    pub fn transmit(&mut self, now: Duration) -> Option<u8> {
        if self.link.session() != 0 {
            return self.link.transmit(now);
        }
        if self.link.is_sending() {
            return self.link.transmit(now);
        }
        let byte = self.gantry.transmit();
        match byte.and_then(Reply::from_byte) {
            Some(Reply::Pulse(axis, direction)) => self.count(axis, direction),
            Some(_) => {}
            None => return self.link.transmit(now),
        }
        byte
    }

    /// When [`poll`](Self::poll) or [`transmit`](Self::transmit) has something to do, unless something
    /// happens before.
    #[must_use]
    pub fn next_wake(&self) -> Option<Duration> {
        // What finds no room is told when some comes, with a byte of the host.
        let report = (self.session != 0 && self.told != self.position && self.link.room() >= MOST_MOVED)
            .then(|| self.told_at.saturating_add(REPORT_EVERY));
        let digits = (self.held_length > 0).then(|| self.held_at.saturating_add(DIGITS_WAIT));
        [self.link.next_wake(), report, digits].into_iter().flatten().min()
    }

    /// The oldest notice of the controller that was not fetched yet.
    pub fn take_notice(&mut self) -> Option<Notice> {
        self.gantry.take_notice()
    }
}
