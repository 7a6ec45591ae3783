//! [`Receive`]: the task that talks to the host.

use super::grbl::Grbl;
use super::mdraw::MDraw;
use super::{Dialect, Link, Signal, Status, StepperPlotterSettings, StoredSettings};
use crate::Point;

/// The receive side: bytes from the host in, commands for the motion side out, and answers.
///
/// After each byte and each report call [`work`](Self::work), and fetch the answers with [`transmit`](Self::transmit).
#[derive(Clone, Debug, PartialEq)]
pub struct Receive {
    host: Host,
}

#[expect(clippy::large_enum_variant, reason = "there is one host to a machine, and no heap to put it on")]
#[derive(Clone, Debug, PartialEq)]
enum Host {
    MDraw(MDraw),
    Grbl(Grbl),
}

impl Receive {
    /// The receive side of a machine that has just been switched on.
    #[must_use]
    pub fn new(settings: StepperPlotterSettings) -> Self {
        let host = match settings.dialect {
            Dialect::MDraw => Host::MDraw(MDraw::new(settings)),
            Dialect::Grbl => Host::Grbl(Grbl::new(settings)),
        };
        Self { host }
    }

    /// Takes a byte from the host; gives what the motion side must know at once.
    pub fn receive(&mut self, byte: u8) -> Option<Signal> {
        match &mut self.host {
            Host::MDraw(mdraw) => mdraw.receive(byte),
            Host::Grbl(grbl) => grbl.receive(byte),
        }
    }

    /// Takes reports, carries out lines and answers them, as far as both queues have room.
    pub fn work(&mut self, status: &Status, link: &mut Link) {
        match &mut self.host {
            Host::MDraw(mdraw) => mdraw.work(status, link),
            Host::Grbl(grbl) => grbl.work(status, link),
        }
    }

    /// The next byte for the host, if there is one.
    pub fn transmit(&mut self) -> Option<u8> {
        match &mut self.host {
            Host::MDraw(mdraw) => mdraw.transmit(),
            Host::Grbl(grbl) => grbl.transmit(),
        }
    }

    /// What the host has stored up to now, to be kept.
    #[must_use]
    pub const fn stored(&self) -> StoredSettings {
        match &self.host {
            Host::MDraw(mdraw) => mdraw.stored(),
            Host::Grbl(grbl) => grbl.stored(),
        }
    }

    /// Begins anew with what has been stored, the pen at `at`.
    pub fn restart(&mut self, at: Point) {
        match &mut self.host {
            Host::MDraw(mdraw) => mdraw.restart(at),
            Host::Grbl(grbl) => grbl.restart(at),
        }
    }
}
