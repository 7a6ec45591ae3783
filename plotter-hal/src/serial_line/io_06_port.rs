//! [`Io06Port`]: a port of `embedded-io` 0.6 as one of 0.7.

use embedded_io::{ErrorKind, ErrorType, Read, ReadReady, Write, WriteReady};
use embedded_io_06::Error as _;

/// A port, or half of one, of a chip's crate that has `embedded-io` 0.6 yet, as one of 0.7. It has the traits
/// that the port has there.
///
/// ```
/// # use core::convert::Infallible;
/// # /// The sending half of a chip's port.
/// # #[derive(Default)]
/// # struct Tx(Vec<u8>);
/// # impl embedded_io_06::ErrorType for Tx {
/// #     type Error = Infallible;
/// # }
/// # impl embedded_io_06::Write for Tx {
/// #     fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
/// #         self.0.extend(bytes);
/// #         Ok(bytes.len())
/// #     }
/// #     fn flush(&mut self) -> Result<(), Infallible> {
/// #         Ok(())
/// #     }
/// # }
/// use plotter_hal::serial_line::{Io06Port, SerialTx};
///
/// let mut tx: SerialTx<_> = SerialTx::new(Io06Port::new(Tx::default()));
/// let mut answers = b"ok\r\n".iter().copied();
/// tx.queue(|| answers.next());
/// tx.write_queued()?;
/// assert_eq!(tx.release().release().0, b"ok\r\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Io06Port<Port>(Port);

impl<Port> Io06Port<Port> {
    /// The port.
    pub const fn new(port: Port) -> Self {
        Self(port)
    }

    /// Gives the port back.
    pub fn release(self) -> Port {
        self.0
    }
}

impl<Port> ErrorType for Io06Port<Port> {
    type Error = ErrorKind;
}

impl<Port: embedded_io_06::Read> Read for Io06Port<Port> {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, ErrorKind> {
        self.0.read(bytes).map_err(|error| kind(error.kind()))
    }
}

impl<Port: embedded_io_06::ReadReady> ReadReady for Io06Port<Port> {
    fn read_ready(&mut self) -> Result<bool, ErrorKind> {
        self.0.read_ready().map_err(|error| kind(error.kind()))
    }
}

impl<Port: embedded_io_06::Write> Write for Io06Port<Port> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        self.0.write(bytes).map_err(|error| kind(error.kind()))
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        self.0.flush().map_err(|error| kind(error.kind()))
    }
}

impl<Port: embedded_io_06::WriteReady> WriteReady for Io06Port<Port> {
    fn write_ready(&mut self) -> Result<bool, ErrorKind> {
        self.0.write_ready().map_err(|error| kind(error.kind()))
    }
}

/// The same kind, as far as a [`Fault`](super::Fault) tells it from others.
const fn kind(kind: embedded_io_06::ErrorKind) -> ErrorKind {
    match kind {
        embedded_io_06::ErrorKind::InvalidData => ErrorKind::InvalidData,
        embedded_io_06::ErrorKind::OutOfMemory => ErrorKind::OutOfMemory,
        embedded_io_06::ErrorKind::BrokenPipe => ErrorKind::BrokenPipe,
        embedded_io_06::ErrorKind::ConnectionAborted => ErrorKind::ConnectionAborted,
        embedded_io_06::ErrorKind::ConnectionReset => ErrorKind::ConnectionReset,
        embedded_io_06::ErrorKind::NotConnected => ErrorKind::NotConnected,
        _ => ErrorKind::Other,
    }
}
