//! [`SerialRx`]: the half of a serial port that receives.

use super::{Fault, FaultCounts};
use embedded_io::{Read, ReadReady};
use plotter_motion::protocol::SUBSTITUTE;

/// After so many faults without a good byte the reader gets a pause: a port that fails for ever must not keep
/// it for ever.
const MOST_IN_A_ROW: u8 = 8;

/// A byte for the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Received {
    /// The byte, or [`SUBSTITUTE`] if there was a fault.
    pub byte: u8,
    /// Fault of the byte, if any.
    pub fault: Option<Fault>,
}

/// The half of a serial port that receives, for ports that come in two halves: one task or interrupt has
/// this one, another has [`SerialTx`](super::SerialTx).
///
/// ```
/// # use core::convert::Infallible;
/// # use embedded_io::{ErrorKind, ErrorType, Read, ReadReady};
/// # /// The receiving half of a port: what came, and what came broken.
/// # struct Rx(std::vec::IntoIter<Result<u8, ErrorKind>>);
/// # impl ErrorType for Rx {
/// #     type Error = ErrorKind;
/// # }
/// # impl ReadReady for Rx {
/// #     fn read_ready(&mut self) -> Result<bool, ErrorKind> {
/// #         Ok(self.0.len() > 0)
/// #     }
/// # }
/// # impl Read for Rx {
/// #     fn read(&mut self, bytes: &mut [u8]) -> Result<usize, ErrorKind> {
/// #         bytes[0] = self.0.next().unwrap_or(Err(ErrorKind::Other))?;
/// #         Ok(1)
/// #     }
/// # }
/// use plotter_hal::serial_line::{Fault, SerialRx};
/// # let port = Rx(vec![Ok(b'G'), Err(ErrorKind::InvalidData), Ok(b'\n')].into_iter());
/// let mut rx = SerialRx::new(port);
/// let bytes: Vec<u8> = core::iter::from_fn(|| rx.receive()).map(|received| received.byte).collect();
/// assert_eq!(bytes, [b'G', 0x1A, b'\n']); // the second one came broken: no controller takes it for data
/// assert_eq!(rx.faults().broken, 1);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialRx<Port> {
    port: Port,
    reading: Reading,
}

impl<Port> SerialRx<Port> {
    /// Listens on `port`.
    pub const fn new(port: Port) -> Self {
        Self { port, reading: Reading::new() }
    }

    /// How many faults there have been.
    pub const fn faults(&self) -> FaultCounts {
        self.reading.faults
    }

    /// Gives the port back.
    pub fn release(self) -> Port {
        self.port
    }
}

impl<Port: Read + ReadReady> SerialRx<Port> {
    /// The next byte for the controller, if one has come. Never waits.
    pub fn receive(&mut self) -> Option<Received> {
        self.reading.receive(&mut self.port)
    }
}

#[cfg(feature = "async")]
impl<Port: embedded_io_async::Read> SerialRx<Port> {
    /// Waits for the next byte for the controller. `None` if the port has been closed.
    ///
    /// A future that is dropped before it is done has taken no byte, if the port's own `read` is
    /// side-effect-free on cancel: those with a buffer behind an interrupt are.
    pub async fn received(&mut self) -> Option<Received> {
        if self.reading.is_enough() {
            crate::waiting::turn().await;
        }
        let mut byte = [0];
        let read = self.port.read(&mut byte).await;
        self.reading.received(read, byte)
    }
}

/// What is known of a port that is read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Reading {
    pub(super) faults: FaultCounts,
    /// Faults since a good byte.
    in_a_row: u8,
}

impl Reading {
    pub(super) const fn new() -> Self {
        Self { faults: FaultCounts::NONE, in_a_row: 0 }
    }

    pub(super) fn receive(&mut self, port: &mut (impl Read + ReadReady)) -> Option<Received> {
        if self.is_enough() {
            return None;
        }
        let mut byte = [0];
        let read = match port.read_ready() {
            Ok(false) => Ok(0),
            Ok(true) => port.read(&mut byte),
            Err(error) => Err(error),
        };
        self.received(read, byte)
    }

    /// Whether the reader must have a pause; the next call begins anew.
    fn is_enough(&mut self) -> bool {
        let is_enough = self.in_a_row >= MOST_IN_A_ROW;
        if is_enough {
            self.in_a_row = 0;
        }
        is_enough
    }

    /// A byte, or what stands for it; `None` if nothing is there, or the port has been closed.
    fn received(
        &mut self,
        read: Result<usize, impl embedded_io::Error>,
        [byte]: [u8; 1],
    ) -> Option<Received> {
        match read {
            Ok(0) => None,
            Ok(_) => {
                self.in_a_row = 0;
                Some(Received { byte, fault: None })
            }
            Err(error) => {
                self.in_a_row += 1;
                let fault = self.faults.note(&error);
                Some(Received { byte: SUBSTITUTE, fault: Some(fault) })
            }
        }
    }
}
