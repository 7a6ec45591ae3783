//! [`SerialTx`]: the half of a serial port that sends.

use super::{Fault, FaultCounts};
use embedded_io::{Write, WriteReady};

/// The half of a serial port that sends, with room for `N` bytes of its own.
///
/// | the port | call | waits |
/// |---|---|---|
/// | says whether it is ready (`WriteReady`) | [`send`](Self::send) | never |
/// | has a blocking `Write` alone | [`queue`](Self::queue) in the loop, [`write_queued`](Self::write_queued) in the interrupt of a free transmitter, or where a byte's time does no harm | as the port does |
/// | has an asynchronous `Write` (feature `async`) | `sent` | asynchronously |
///
/// A byte is taken from its source when there is room for it here, and given up when the port has taken it:
/// in no form is one lost or sent twice, whatever fails in between.
///
/// ```
/// # use core::convert::Infallible;
/// # use embedded_io::{ErrorType, Write};
/// # /// A port that only has a blocking `Write`, and takes a byte at a time.
/// # #[derive(Default)]
/// # struct Tx(Vec<u8>);
/// # impl ErrorType for Tx {
/// #     type Error = Infallible;
/// # }
/// # impl Write for Tx {
/// #     fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
/// #         self.0.push(bytes[0]);
/// #         Ok(1)
/// #     }
/// #     fn flush(&mut self) -> Result<(), Infallible> {
/// #         Ok(())
/// #     }
/// # }
/// use plotter_hal::serial_line::SerialTx;
///
/// let mut answers = b"ok\r\n".iter().copied(); // a controller's `transmit`
/// let mut tx: SerialTx<_, 3> = SerialTx::new(Tx::default());
/// assert_eq!(tx.queue(|| answers.next()), 3); // no more has room; the port is not asked
/// tx.write_queued()?; // all that waits, a byte at a time
/// tx.queue(|| answers.next());
/// tx.write_queued()?;
/// assert_eq!(tx.waiting(), 0);
/// assert_eq!(tx.release().0, b"ok\r\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialTx<Port, const N: usize = 64> {
    port: Port,
    writing: Writing<N>,
}

impl<Port, const N: usize> SerialTx<Port, N> {
    /// Sends on `port`.
    pub const fn new(port: Port) -> Self {
        Self { port, writing: Writing::new() }
    }

    /// Takes what `next` gives, as much as there is room for; says how many bytes wait now. Asks nothing of
    /// the port.
    pub fn queue(&mut self, next: impl FnMut() -> Option<u8>) -> usize {
        self.writing.fill(next);
        self.waiting()
    }

    /// How many bytes wait for the port.
    pub const fn waiting(&self) -> usize {
        self.writing.waiting()
    }

    /// How many faults there have been.
    pub const fn faults(&self) -> FaultCounts {
        self.writing.faults
    }

    /// Gives the port back. Bytes that wait are dropped.
    pub fn release(self) -> Port {
        self.port
    }
}

impl<Port: Write, const N: usize> SerialTx<Port, N> {
    /// Sends what waits, until it is gone or the port takes nothing. Waits where the port's own `write` does.
    ///
    /// # Errors
    ///
    /// [`Fault`]; what was not taken is sent first the next time.
    pub fn write_queued(&mut self) -> Result<(), Fault> {
        self.writing.write(&mut self.port, |_| Ok(true), || None)
    }
}

impl<Port: Write + WriteReady, const N: usize> SerialTx<Port, N> {
    /// Sends what `next` gives, as much as the port takes now. Never waits; asks for no byte before there is
    /// room for it.
    ///
    /// # Errors
    ///
    /// [`Fault`]; what was not taken is sent first the next time.
    pub fn send(&mut self, next: impl FnMut() -> Option<u8>) -> Result<(), Fault> {
        self.writing.send(&mut self.port, next)
    }
}

#[cfg(feature = "async")]
impl<Port: embedded_io_async::Write, const N: usize> SerialTx<Port, N> {
    /// Sends what waits and what `next` gives, and comes back when the port has taken all of it.
    ///
    /// A future that is dropped before it is done has lost no byte and sent none twice, if the port's own
    /// `write` is side-effect-free on cancel: those with a buffer behind an interrupt are. One that hands the
    /// bytes to DMA is not; let it run to its end, in a task of its own.
    ///
    /// # Errors
    ///
    /// [`Fault`]; what was not taken is sent first the next time. A port that takes nothing is one that
    /// failed.
    pub async fn sent(&mut self, mut next: impl FnMut() -> Option<u8>) -> Result<(), Fault> {
        loop {
            self.writing.fill(&mut next);
            let bytes = self.writing.first();
            if bytes.is_empty() {
                return Ok(());
            }
            match self.port.write(bytes).await {
                Ok(0) => {
                    self.writing.faults.count(Fault::Other);
                    return Err(Fault::Other);
                }
                Ok(taken) => self.writing.taken(taken),
                Err(error) => return Err(self.writing.faults.note(&error)),
            }
        }
    }
}

/// What waits for a port, and what is known of it.
#[derive(Clone, Debug)]
pub(super) struct Writing<const N: usize> {
    pub(super) faults: FaultCounts,
    /// A ring: [`Writing::first`] is what goes in one piece, what else waits begins at 0.
    bytes: [u8; N],
    from: usize,
    waiting: usize,
}

impl<const N: usize> Writing<N> {
    pub(super) const fn new() -> Self {
        const { assert!(N > 0, "no byte can be sent from no room") };
        Self { faults: FaultCounts::NONE, bytes: [0; N], from: 0, waiting: 0 }
    }

    const fn waiting(&self) -> usize {
        self.waiting
    }

    pub(super) fn send(
        &mut self,
        port: &mut (impl Write + WriteReady),
        next: impl FnMut() -> Option<u8>,
    ) -> Result<(), Fault> {
        self.write(port, WriteReady::write_ready, next)
    }

    /// Sends what waits and what `next` gives while the port `is_ready`, and takes something.
    fn write<Port: Write>(
        &mut self,
        port: &mut Port,
        is_ready: impl Fn(&mut Port) -> Result<bool, Port::Error>,
        mut next: impl FnMut() -> Option<u8>,
    ) -> Result<(), Fault> {
        loop {
            match is_ready(port) {
                Ok(true) => {}
                Ok(false) => return Ok(()),
                Err(error) => return Err(self.faults.note(&error)),
            }
            self.fill(&mut next);
            let bytes = self.first();
            if bytes.is_empty() {
                return Ok(());
            }
            match port.write(bytes) {
                Ok(0) => return Ok(()),
                Ok(taken) => self.taken(taken),
                Err(error) => return Err(self.faults.note(&error)),
            }
        }
    }

    /// Takes bytes until there is no more room, or no more of them.
    fn fill(&mut self, mut next: impl FnMut() -> Option<u8>) {
        while self.waiting < N {
            let to = (self.from + self.waiting) % N;
            let Some(place) = self.bytes.get_mut(to) else { return };
            let Some(byte) = next() else { return };
            *place = byte;
            self.waiting += 1;
        }
    }

    /// What goes next, in one piece.
    fn first(&self) -> &[u8] {
        let end = self.from.saturating_add(self.waiting).min(N);
        self.bytes.get(self.from..end).unwrap_or_default()
    }

    /// All that waits, the next one first.
    fn in_turn(&self) -> impl Iterator<Item = &u8> {
        self.bytes.iter().cycle().skip(self.from).take(self.waiting)
    }

    /// The port has taken so many of them.
    fn taken(&mut self, bytes: usize) {
        let bytes = bytes.min(self.waiting);
        self.from = (self.from + bytes) % N;
        self.waiting -= bytes;
    }
}

// What stood in the places of bytes that have gone makes no difference.
impl<const N: usize> PartialEq for Writing<N> {
    fn eq(&self, other: &Self) -> bool {
        self.faults == other.faults && self.in_turn().eq(other.in_turn())
    }
}

impl<const N: usize> Eq for Writing<N> {}
