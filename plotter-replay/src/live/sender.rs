//! [`Sender`]: the host of a session, by either protocol.

use super::desk::Tray;
use super::{LinkChoice, SessionSettings};
use core::time::Duration;
use plotter_motion::PenMove;
use plotter_motion::protocol::{
    Host, HostEvent, HostNotice, LinkHost, LinkSettings, LinkState, Order, Resume, Wire,
};

/// With room for so many frames that wait for their answers, and so many bytes in each.
type Linked = LinkHost<Tray, 8, 128>;

/// A host, and the line as far as it is free.
pub(super) struct Sender {
    host: Spoken,
    wire: Wire,
    free: Duration,
    /// Whether a machine that knows digits only is refused.
    frames_only: bool,
}

enum Spoken {
    Digits(Host<Tray>),
    Linked(Box<Linked>),
}

impl Sender {
    pub(super) fn new(settings: &SessionSettings, moves: Tray) -> Self {
        let host = if settings.link == LinkChoice::Digits {
            let host = Host::new(settings.byte_gap, settings.host, moves);
            Spoken::Digits(host.staying().standing_at(settings.stands_at))
        } else {
            let link = LinkSettings::default();
            let host = LinkHost::new(settings.nonce, link, settings.byte_gap, settings.host, moves);
            let host = host.staying();
            Spoken::Linked(Box::new(match settings.resume {
                Some(resume) => host.resuming(resume),
                None => host,
            }))
        };
        let frames_only = settings.link == LinkChoice::Frames || settings.resume.is_some();
        Self { host, wire: Wire::new(settings.baud), free: Duration::ZERO, frames_only }
    }

    /// Whether the digits protocol is spoken, and nothing else can be any more.
    pub(super) fn is_digits(&self) -> bool {
        match &self.host {
            Spoken::Digits(_) => true,
            Spoken::Linked(host) => host.is_digits(),
        }
    }

    /// Whether a session of frames is open.
    pub(super) fn is_linked(&self) -> bool {
        matches!(&self.host, Spoken::Linked(host)
            if matches!(host.link().state(), LinkState::Open | LinkState::Interrupted))
    }

    /// Gives an order to a machine; to one of digits the bytes that are returned do.
    pub(super) fn order(&mut self, order: Order) -> Option<u8> {
        match &mut self.host {
            Spoken::Linked(host) if !host.is_digits() => {
                host.order(order);
                None
            }
            _ => (order != Order::Hold).then_some(order.byte()),
        }
    }

    /// Takes back what the machine has not begun; [`take_kept`](Self::take_kept) says what of it is left.
    pub(super) fn withdraw(&mut self) {
        if let Spoken::Linked(host) = &mut self.host {
            host.withdraw();
        }
    }

    /// How many moves the machine keeps, once it has said so.
    pub(super) fn take_kept(&mut self) -> Option<usize> {
        match &mut self.host {
            Spoken::Digits(_) => None,
            Spoken::Linked(host) => host.take_kept(),
        }
    }

    /// Leads a machine of digits to another target than the one under way; says whether it does.
    pub(super) fn redirect(&mut self, now: Duration, next: PenMove) -> bool {
        match &mut self.host {
            Spoken::Digits(host) => host.redirect(now, next),
            Spoken::Linked(_) => false,
        }
    }

    /// What is new.
    pub(super) fn poll(&mut self, now: Duration) -> Option<HostEvent> {
        match &mut self.host {
            Spoken::Digits(host) => host.poll(now),
            Spoken::Linked(host) => host.poll(now),
        }
    }

    /// Whether a notice is the end of the drawing.
    pub(super) fn ends_by(&self, notice: HostNotice) -> bool {
        match notice {
            HostNotice::MachineRestarted | HostNotice::NotUnderstood(_) => true,
            HostNotice::DigitsOnly => self.frames_only,
            _ => false,
        }
    }

    /// The bytes for a line that takes those of so long a time ahead.
    pub(super) fn bytes(&mut self, now: Duration, ahead: Duration) -> Vec<u8> {
        let mut bytes = Vec::new();
        while self.free <= now.saturating_add(ahead) {
            let byte = match &mut self.host {
                Spoken::Digits(host) => host.next_byte(now),
                Spoken::Linked(host) => host.next_byte(now),
            };
            let Some(byte) = byte else { break };
            self.free = self.wire.send(now);
            bytes.push(byte);
        }
        bytes
    }

    pub(super) fn receive(&mut self, now: Duration, byte: u8) -> Option<HostEvent> {
        match &mut self.host {
            Spoken::Digits(host) => host.receive(now, byte),
            Spoken::Linked(host) => {
                host.receive(now, byte);
                host.poll(now)
            }
        }
    }

    /// When it has something to do, for a line that takes the bytes of so long a time ahead.
    pub(super) fn next_wake(&self, ahead: Duration) -> Option<Duration> {
        let wake = match &self.host {
            Spoken::Digits(host) => host.next_wake(),
            Spoken::Linked(host) => host.next_wake(),
        };
        wake.map(|wake| wake.max(self.free.saturating_sub(ahead)))
    }

    pub(super) fn is_done(&self) -> bool {
        match &self.host {
            Spoken::Digits(host) => host.is_done(),
            Spoken::Linked(host) => host.is_done(),
        }
    }

    /// Moves reached before this host came, and where the drawing was begun.
    pub(super) fn resumed(&self) -> Option<(Resume, u32)> {
        match &self.host {
            Spoken::Linked(host) => {
                let progress = host.progress();
                progress.resume.map(|resume| (resume, progress.reached))
            }
            Spoken::Digits(_) => None,
        }
    }
}
