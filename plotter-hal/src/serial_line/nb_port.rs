//! [`NbPort`]: a port of `embedded-hal-nb` as one of `embedded-io`.

use embedded_hal_nb::nb;
use embedded_hal_nb::serial::{self, Error as _};
use embedded_io::{ErrorKind, ErrorType, Read, ReadReady, Write, WriteReady};

/// A port, or half of one, of `embedded-hal-nb`, which takes and gives a word at a time, as one of
/// `embedded-io` that never waits: with [`SerialLine`](super::SerialLine), [`SerialRx`](super::SerialRx) and
/// [`SerialTx`](super::SerialTx).
///
/// Its errors say which kind they are: an overrun is [`ErrorKind::OutOfMemory`]; framing, parity and noise
/// are [`ErrorKind::InvalidData`]. A byte that the port could not take yet is kept here, and goes first.
///
/// ```
/// # use embedded_hal_nb::{nb, serial};
/// # /// The receiving half of a chip's port.
/// # struct Rx(std::vec::IntoIter<nb::Result<u8, serial::ErrorKind>>);
/// # impl serial::ErrorType for Rx {
/// #     type Error = serial::ErrorKind;
/// # }
/// # impl serial::Read for Rx {
/// #     fn read(&mut self) -> nb::Result<u8, serial::ErrorKind> {
/// #         self.0.next().unwrap_or(Err(nb::Error::WouldBlock))
/// #     }
/// # }
/// use plotter_hal::serial_line::{Fault, NbPort, SerialRx};
/// # let port = Rx(vec![Ok(b'1'), Err(nb::Error::Other(serial::ErrorKind::Noise))].into_iter());
/// let mut rx = SerialRx::new(NbPort::new(port));
/// assert_eq!(rx.receive().map(|received| received.byte), Some(b'1'));
/// assert_eq!(rx.receive().and_then(|received| received.fault), Some(Fault::Broken));
/// assert_eq!(rx.receive(), None);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NbPort<Port> {
    port: Port,
    /// What has been read to see whether there is something.
    read: Option<Result<u8, ErrorKind>>,
    /// What the port did not take.
    unsent: Option<u8>,
}

impl<Port> NbPort<Port> {
    /// The port.
    pub const fn new(port: Port) -> Self {
        Self { port, read: None, unsent: None }
    }

    /// Gives the port back. A byte that was read or that the port did not take is dropped.
    pub fn release(self) -> Port {
        self.port
    }
}

impl<Port> ErrorType for NbPort<Port> {
    type Error = ErrorKind;
}

impl<Port: serial::Read> ReadReady for NbPort<Port> {
    fn read_ready(&mut self) -> Result<bool, ErrorKind> {
        if self.read.is_none() {
            self.read = match self.port.read() {
                Ok(byte) => Some(Ok(byte)),
                Err(nb::Error::WouldBlock) => None,
                Err(nb::Error::Other(error)) => Some(Err(kind(error.kind()))),
            };
        }
        Ok(self.read.is_some())
    }
}

impl<Port: serial::Read> Read for NbPort<Port> {
    /// Waits for a byte.
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, ErrorKind> {
        let Some(place) = bytes.first_mut() else { return Ok(0) };
        loop {
            self.read_ready()?;
            if let Some(read) = self.read.take() {
                *place = read?;
                return Ok(1);
            }
        }
    }
}

impl<Port: serial::Write> NbPort<Port> {
    /// Hands the port the byte that it did not take; says whether it has gone.
    fn is_free(&mut self) -> Result<bool, ErrorKind> {
        let Some(byte) = self.unsent else { return Ok(true) };
        match self.port.write(byte) {
            Ok(()) => {
                self.unsent = None;
                Ok(true)
            }
            Err(nb::Error::WouldBlock) => Ok(false),
            Err(nb::Error::Other(error)) => Err(kind(error.kind())),
        }
    }
}

impl<Port: serial::Write> WriteReady for NbPort<Port> {
    fn write_ready(&mut self) -> Result<bool, ErrorKind> {
        self.is_free()
    }
}

impl<Port: serial::Write> Write for NbPort<Port> {
    /// Takes a byte; waits until the one before has gone.
    fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        let Some(&byte) = bytes.first() else { return Ok(0) };
        while !self.is_free()? {}
        self.unsent = Some(byte);
        // It is taken here, whatever the port says now: that is told by the next call.
        let _ = self.is_free();
        Ok(1)
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        while !self.is_free()? {}
        nb::block!(self.port.flush()).map_err(|error| kind(error.kind()))
    }
}

/// The kind by which [`Fault`](super::Fault) knows it.
const fn kind(kind: serial::ErrorKind) -> ErrorKind {
    match kind {
        serial::ErrorKind::Overrun => ErrorKind::OutOfMemory,
        serial::ErrorKind::FrameFormat | serial::ErrorKind::Parity | serial::ErrorKind::Noise => {
            ErrorKind::InvalidData
        }
        _ => ErrorKind::Other,
    }
}
