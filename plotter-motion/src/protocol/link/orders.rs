//! [`Given`] and [`Taken`]: orders past the streams, as a host gives and a machine takes them.

use super::super::Order;
use core::time::Duration;

/// A host's last order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Given {
    /// Until the machine has answered it.
    order: Option<Order>,
    /// 1 to 255, then from 1.
    number: u8,
    /// When it was sent last, and whether in a session.
    sent: Option<(Duration, bool)>,
}

impl Given {
    pub(super) const fn give(&mut self, order: Order) -> u8 {
        let number = match self.number {
            u8::MAX => 1,
            number => number + 1,
        };
        *self = Self { order: Some(order), number, sent: None };
        number
    }

    /// The same order for another session.
    pub(super) const fn unsent(self) -> Self {
        Self { sent: None, ..self }
    }

    pub(super) fn answered(&mut self, number: u8) {
        if number == self.number {
            self.order = None;
        }
    }

    /// When it is to be sent, if it is. Outside a session only a stop can be heard, once.
    pub(super) fn due_at(&self, is_open: bool, retry: Duration) -> Option<Duration> {
        let order = self.order?;
        match self.sent {
            None if is_open || order == Order::Stop => Some(Duration::ZERO),
            Some((_, false)) if is_open => Some(Duration::ZERO),
            Some((at, true)) if is_open => Some(at.saturating_add(retry)),
            _ => None,
        }
    }

    /// The order that goes out now. Only one that was not sent before may cut what is on the line.
    pub(super) fn due(
        &mut self,
        now: Duration,
        is_open: bool,
        is_sending: bool,
        retry: Duration,
    ) -> Option<(Order, u8)> {
        let at = self.due_at(is_open, retry)?;
        if now < at || (is_sending && self.sent.is_some()) {
            return None;
        }
        self.sent = Some((now, is_open));
        self.order.map(|order| (order, self.number))
    }
}

/// A machine's last order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Taken {
    next: Option<(u8, Order)>,
    lone: Lone,
}

/// How much has come of a stop by itself, `00 21 00`. No frame is as short as that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Lone {
    #[default]
    Nothing,
    Zero,
    ZeroStop,
}

impl Taken {
    /// A byte came, whatever it belongs to.
    pub(super) fn byte(&mut self, byte: u8) {
        let stops = self.lone == Lone::ZeroStop && byte == 0;
        self.lone = match byte {
            0 => Lone::Zero,
            byte if byte == Order::Stop.byte() && self.lone == Lone::Zero => Lone::ZeroStop,
            _ => Lone::Nothing,
        };
        if stops {
            self.next = Some((0, Order::Stop));
        }
    }

    /// An order came in a frame. One that came before is taken again: its answer may have been lost.
    pub(super) const fn frame(&mut self, number: u8, order: Order) {
        self.next = Some((number, order));
    }

    pub(super) const fn take(&mut self) -> Option<(u8, Order)> {
        self.next.take()
    }
}
