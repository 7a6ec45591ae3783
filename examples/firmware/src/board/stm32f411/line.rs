//! The serial line: bytes come by interrupt, and go from a buffer.

use core::cell::RefCell;
use core::convert::Infallible;
use critical_section::Mutex;
use heapless::spsc::Queue;
use plotter_hal::embedded_io::{ErrorKind, ErrorType, Read, ReadReady, Write, WriteReady};
use plotter_hal::{SerialRx, SerialTx};
use stm32f4xx_hal::pac::{USART2, interrupt};

/// Bytes that came and were not fetched: the loop takes less time than the line for these, a planned block
/// included.
const COME: usize = 32;
/// Bytes that wait to be sent.
const TO_SEND: usize = 128;

/// What came; `None` for a byte that was lost or damaged.
static CAME: Mutex<RefCell<Queue<Option<u8>, COME>>> = Mutex::new(RefCell::new(Queue::new()));

/// The half of the port that receives.
struct Rx(USART2);

impl ErrorType for Rx {
    type Error = ErrorKind;
}

impl ReadReady for Rx {
    fn read_ready(&mut self) -> Result<bool, ErrorKind> {
        let status = self.0.sr().read();
        Ok(status.rxne().bit() || status.ore().bit())
    }
}

impl Read for Rx {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, ErrorKind> {
        // The status first: it is cleared by reading the byte after it.
        let status = self.0.sr().read();
        let [byte, _] = self.0.dr().read().bits().to_le_bytes();
        // Nobody here asks whether it was lost or damaged.
        if status.pe().bit() || status.fe().bit() || status.nf().bit() || status.ore().bit() {
            return Err(ErrorKind::InvalidData);
        }
        let Some(place) = bytes.first_mut() else { return Ok(0) };
        *place = byte;
        Ok(1)
    }
}

/// The half of the port that sends.
struct Tx(USART2);

impl ErrorType for Tx {
    type Error = Infallible;
}

impl WriteReady for Tx {
    fn write_ready(&mut self) -> Result<bool, Infallible> {
        Ok(self.0.sr().read().txe().bit())
    }
}

impl Write for Tx {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        let Some(&byte) = bytes.first() else { return Ok(0) };
        self.0.dr().write(|w| w.dr().set(byte.into()));
        Ok(1)
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        while self.0.sr().read().tc().bit_is_clear() {}
        Ok(())
    }
}

#[interrupt]
#[allow(unsafe_code, reason = "the line's own half of the port is in the loop's hands")]
fn USART2() {
    // SAFETY: the interrupt reads what came, the loop writes what goes, and neither changes how the port is
    // set up.
    let port = unsafe { USART2::steal() };
    if let Some(received) = SerialRx::new(Rx(port)).receive() {
        let came = received.fault.is_none().then_some(received.byte);
        // A full queue is a loop that stands still: its watchdog bites.
        let _ = critical_section::with(|cs| CAME.borrow_ref_mut(cs).enqueue(came));
    }
}

/// The serial line.
pub struct Line {
    tx: SerialTx<Tx, TO_SEND>,
}

impl Line {
    /// Listens on a port that has been set up.
    pub fn new(port: USART2) -> Self {
        port.cr1().modify(|_, w| w.rxneie().set_bit());
        super::gantry::unmask(stm32f4xx_hal::pac::Interrupt::USART2);
        Self { tx: SerialTx::new(Tx(port)) }
    }

    /// What came, if anything: a byte, or `Some(None)` for one that was lost.
    pub fn receive(&mut self) -> Option<Option<u8>> {
        critical_section::with(|cs| CAME.borrow_ref_mut(cs).dequeue())
    }

    /// Whether there is room for another byte.
    pub fn has_room(&self) -> bool {
        self.tx.waiting() < TO_SEND
    }

    /// Sends a byte in its turn.
    #[inline(never)] // both programs call it in a loop of theirs: smaller so
    pub fn send(&mut self, byte: u8) {
        let mut byte = Some(byte);
        // The caller has looked whether there is room.
        self.tx.queue(|| byte.take());
        self.pump();
    }

    /// Hands the transmitter what it takes, which cannot fail.

    pub fn pump(&mut self) {
        let _ = self.tx.send(|| None);
    }
}
