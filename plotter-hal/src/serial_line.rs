//! A serial port between a host and a controller without I/O: without waiting, or asynchronously.
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
//!
//! [`SerialLine`] is on a port as a whole, [`SerialRx`] and [`SerialTx`] are on the halves of one. Which of
//! them a chip's crate asks for, of those that are compiled with this one (`examples/hals`):
//!
//! | crate | port | |
//! |---|---|---|
//! | embassy-rp, embassy-stm32 | halves of `BufferedUart` | `received` and `sent`, feature `async`; `receive` too |
//! | embassy-nrf | halves of `BufferedUarte` | the same |
//! | embassy-stm32 | `RingBufferedUartRx`; `UartTx` with DMA, not to be cancelled | `received`; `sent` |
//! | rp2040-hal | `UartPeripheral`, `Reader`, `Writer` | `SerialLine`, `receive`, `send` |
//! | stm32f4xx-hal | `Rx`, `Tx` in an `NbPort`, feature `embedded-hal-nb` | `SerialLine`, `receive`, `send` |
//! | with `embedded-io` 0.6 | in an `Io06Port`, feature `embedded-io-06` | as its traits have it |
//!
//! An `NbPort` also tells the kinds of faults apart where a crate's `embedded-io` calls all of them other, as
//! rp2040-hal, stm32f4xx-hal and embassy-rp do.

mod fault;
#[cfg(feature = "embedded-io-06")]
mod io_06_port;
#[cfg(feature = "embedded-hal-nb")]
mod nb_port;
mod rx;
mod tx;

pub use fault::{Fault, FaultCounts};
#[cfg(feature = "embedded-io-06")]
pub use io_06_port::Io06Port;
#[cfg(feature = "embedded-hal-nb")]
pub use nb_port::NbPort;
pub use rx::{Received, SerialRx};
pub use tx::SerialTx;

use embedded_io::{Read, ReadReady, Write, WriteReady};
#[cfg(doc)]
use plotter_motion::protocol::SUBSTITUTE;
use rx::Reading;
use tx::Writing;

/// A serial port, both directions of it.
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
    reading: Reading,
    /// A byte that the port did not take.
    writing: Writing<1>,
}

impl<Port: Read + ReadReady + Write + WriteReady> SerialLine<Port> {
    /// The line on `port`.
    pub const fn new(port: Port) -> Self {
        Self { port, reading: Reading::new(), writing: Writing::new() }
    }

    /// The next byte for the controller, if one has come. Never waits.
    pub fn receive(&mut self) -> Option<Received> {
        self.reading.receive(&mut self.port)
    }

    /// Sends what `next` gives, as much as the port takes now. Never waits; asks for no byte before there is
    /// room for it.
    ///
    /// # Errors
    ///
    /// [`Fault`]; a byte that was not taken is sent first the next time.
    pub fn send(&mut self, next: impl FnMut() -> Option<u8>) -> Result<(), Fault> {
        self.writing.send(&mut self.port, next)
    }

    /// How many faults there have been in both directions.
    pub const fn faults(&self) -> FaultCounts {
        self.reading.faults.and(self.writing.faults)
    }

    /// Gives the port back.
    pub fn release(self) -> Port {
        self.port
    }
}
