//! [`Fault`]: what was wrong with a serial port, and how often.

use core::fmt;
use embedded_io::ErrorKind;

/// What was wrong with a serial port. `embedded-io` has few kinds of errors, and chips' crates use them
/// differently: what they call other may be any of these.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Fault {
    /// A byte came broken: framing, parity or noise ([`ErrorKind::InvalidData`]).
    Broken,
    /// Bytes came faster than they were read, and were lost ([`ErrorKind::OutOfMemory`]).
    Overrun,
    /// The other end has gone: an unplugged USB port, say.
    Gone,
    /// Something else.
    Other,
}

impl Fault {
    pub(crate) const fn of(kind: ErrorKind) -> Self {
        match kind {
            ErrorKind::InvalidData => Self::Broken,
            ErrorKind::OutOfMemory => Self::Overrun,
            ErrorKind::BrokenPipe
            | ErrorKind::ConnectionAborted
            | ErrorKind::ConnectionReset
            | ErrorKind::NotConnected => Self::Gone,
            _ => Self::Other,
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Broken => "a byte came broken (framing, parity or noise): check baud rate and ground",
            Self::Overrun => "bytes came faster than they were read, and were lost",
            Self::Gone => "the other end has gone",
            Self::Other => "the port failed",
        })
    }
}

impl core::error::Error for Fault {}

/// How many faults there have been, of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FaultCounts {
    /// [`Fault::Broken`].
    pub broken: u32,
    /// [`Fault::Overrun`].
    pub overrun: u32,
    /// [`Fault::Gone`].
    pub gone: u32,
    /// [`Fault::Other`].
    pub other: u32,
}

impl FaultCounts {
    pub(super) const NONE: Self = Self { broken: 0, overrun: 0, gone: 0, other: 0 };

    /// Those of both halves of a line.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self {
            broken: self.broken.saturating_add(other.broken),
            overrun: self.overrun.saturating_add(other.overrun),
            gone: self.gone.saturating_add(other.gone),
            other: self.other.saturating_add(other.other),
        }
    }

    /// Counts what a port says, and gives it its name.
    pub(super) fn note(&mut self, error: &impl embedded_io::Error) -> Fault {
        let fault = Fault::of(error.kind());
        self.count(fault);
        fault
    }

    pub(super) fn count(&mut self, fault: Fault) {
        let count = match fault {
            Fault::Broken => &mut self.broken,
            Fault::Overrun => &mut self.overrun,
            Fault::Gone => &mut self.gone,
            Fault::Other => &mut self.other,
        };
        *count = count.saturating_add(1);
    }
}
