//! A serial port between a host and a controller without I/O, one byte at a time and without waiting.
//!
//! ```text
//!  port ──▶ receive ──byte──────────────▶ controller.receive(now, byte)
//!             │  └───SUBSTITUTE for a broken one, with its Fault ──▶ whoever should know
//!             └ counts faults
//!  port ◀── send ◀── controller.transmit(), as long as the port takes it
//! ```
//!
//! A byte that came broken is not data, and leaving it out is no better: `G1 X12` would become `G1 X1`. In
//! its place the controller gets [`SUBSTITUTE`], for which both controllers of [`plotter_motion`] drop what
//! it belongs to, and say so.

use core::fmt;
use embedded_io::{Error as _, ErrorKind, Read, ReadReady, Write, WriteReady};
use plotter_motion::protocol::SUBSTITUTE;

/// A serial port.
///
/// ```
/// # use core::convert::Infallible;
/// # use embedded_io::{ErrorType, Read, ReadReady, Write, WriteReady};
/// # /// A port whose answers come back as they are.
/// # #[derive(Default)]
/// # struct Loopback(std::collections::VecDeque<u8>);
/// # impl ErrorType for Loopback {
/// #     type Error = Infallible;
/// # }
/// # impl ReadReady for Loopback {
/// #     fn read_ready(&mut self) -> Result<bool, Infallible> {
/// #         Ok(!self.0.is_empty())
/// #     }
/// # }
/// # impl Read for Loopback {
/// #     fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
/// #         bytes[0] = self.0.pop_front().unwrap_or_default();
/// #         Ok(1)
/// #     }
/// # }
/// # impl WriteReady for Loopback {
/// #     fn write_ready(&mut self) -> Result<bool, Infallible> {
/// #         Ok(true)
/// #     }
/// # }
/// # impl Write for Loopback {
/// #     fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
/// #         self.0.extend(bytes);
/// #         Ok(bytes.len())
/// #     }
/// #     fn flush(&mut self) -> Result<(), Infallible> {
/// #         Ok(())
/// #     }
/// # }
/// use core::time::Duration;
/// use plotter_hal::SerialLine;
/// use plotter_motion::firmware::Gantry;
/// use plotter_motion::protocol::digits;
/// use plotter_motion::{LimitSwitches, Machine, MachineConfig, SafetyGate, StepPoint};
///
/// # let port = Loopback(digits::encode(StepPoint::new(400, 0))?.into());
/// let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// let mut gantry = Gantry::new(&Machine::new(MachineConfig::default())?, gate);
/// let mut line = SerialLine::new(port);
/// let now = Duration::ZERO;
/// // again and again, in the main loop or when the port's interrupt says that there is something:
/// while let Some(received) = line.receive() {
///     if let Some(fault) = received.fault {
///         eprintln!("serial line: {fault}"); // or defmt, or a lamp
///     }
///     gantry.receive(now, received.byte);
/// }
/// line.send(|| gantry.transmit())?;
/// # while let Some(now) = gantry.next_tick().filter(|&at| at < Duration::from_millis(10)) {
/// #     gantry.tick(now);
/// # }
/// assert!(gantry.drive().x().value() > 0.0); // ten milliseconds later it is on its way
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialLine<Port> {
    port: Port,
    faults: FaultCounts,
    /// Faults since a good byte.
    in_a_row: u8,
    /// A byte that the port did not take.
    unsent: Option<u8>,
}

/// After so many faults without a good byte [`SerialLine::receive`] gives nothing once: a port that fails for
/// ever must not keep its reader for ever.
const MOST_IN_A_ROW: u8 = 8;

/// A byte for the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Received {
    /// The byte, or [`SUBSTITUTE`] if there was a fault.
    pub byte: u8,
    /// What was wrong with it.
    pub fault: Option<Fault>,
}

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
    fn of(kind: ErrorKind) -> Self {
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
    fn count(&mut self, fault: Fault) {
        let count = match fault {
            Fault::Broken => &mut self.broken,
            Fault::Overrun => &mut self.overrun,
            Fault::Gone => &mut self.gone,
            Fault::Other => &mut self.other,
        };
        *count = count.saturating_add(1);
    }
}

impl<Port: Read + ReadReady + Write + WriteReady> SerialLine<Port> {
    /// The line on `port`.
    pub const fn new(port: Port) -> Self {
        let faults = FaultCounts { broken: 0, overrun: 0, gone: 0, other: 0 };
        Self { port, faults, in_a_row: 0, unsent: None }
    }

    /// The next byte for the controller, if one has come. Never waits.
    pub fn receive(&mut self) -> Option<Received> {
        if self.in_a_row >= MOST_IN_A_ROW {
            self.in_a_row = 0;
            return None;
        }
        let mut byte = [0];
        let read = match self.port.read_ready() {
            Ok(false) => Ok(0),
            Ok(true) => self.port.read(&mut byte),
            Err(error) => Err(error),
        };
        match read {
            // Nothing there, or the port has been closed.
            Ok(0) => None,
            Ok(_) => {
                self.in_a_row = 0;
                let [byte] = byte;
                Some(Received { byte, fault: None })
            }
            Err(error) => {
                self.in_a_row += 1;
                let fault = self.fault(&error);
                Some(Received { byte: SUBSTITUTE, fault: Some(fault) })
            }
        }
    }

    /// Sends what `next` gives, as much as the port takes now. Never waits; asks for no byte before there is
    /// room for it.
    ///
    /// # Errors
    ///
    /// [`Fault`]; a byte that was not taken is sent first the next time.
    pub fn send(&mut self, mut next: impl FnMut() -> Option<u8>) -> Result<(), Fault> {
        loop {
            match self.port.write_ready() {
                Ok(true) => {}
                Ok(false) => return Ok(()),
                Err(error) => return Err(self.fault(&error)),
            }
            self.unsent = self.unsent.or_else(&mut next);
            let Some(byte) = self.unsent else { return Ok(()) };
            match self.port.write(&[byte]) {
                Ok(0) => return Ok(()),
                Ok(_) => self.unsent = None,
                Err(error) => return Err(self.fault(&error)),
            }
        }
    }

    /// How many faults there have been in both directions.
    pub const fn faults(&self) -> FaultCounts {
        self.faults
    }

    /// Gives the port back.
    pub fn release(self) -> Port {
        self.port
    }

    fn fault(&mut self, error: &Port::Error) -> Fault {
        let fault = Fault::of(error.kind());
        self.faults.count(fault);
        fault
    }
}
