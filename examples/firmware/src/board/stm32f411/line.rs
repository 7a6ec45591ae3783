//! The serial line: bytes come by interrupt, and go from a buffer.

use core::cell::RefCell;
use critical_section::Mutex;
use heapless::spsc::Queue;
use stm32f4xx_hal::pac::{USART2, interrupt};

/// Bytes that came and were not fetched: the loop takes less time than the line for these, a planned block
/// included.
const COME: usize = 32;
/// Bytes that wait to be sent.
const TO_SEND: usize = 128;

/// What came; `None` for a byte that was lost or damaged.
static CAME: Mutex<RefCell<Queue<Option<u8>, COME>>> = Mutex::new(RefCell::new(Queue::new()));

#[interrupt]
#[allow(unsafe_code, reason = "the line's own half of the port is in the loop's hands")]
fn USART2() {
    // SAFETY: the interrupt reads what came, the loop writes what goes, and neither changes how the port is
    // set up.
    let port = unsafe { USART2::steal() };
    // The status first: it is cleared by reading the byte after it.
    let status = port.sr().read();
    let byte = port.dr().read().bits().to_le_bytes()[0];
    let is_bad = status.pe().bit() || status.fe().bit() || status.nf().bit() || status.ore().bit();
    let came = match (is_bad, status.rxne().bit()) {
        (true, _) => None,
        (false, true) => Some(byte),
        (false, false) => return,
    };
    // A full queue is a loop that stands still: its watchdog bites.
    let _ = critical_section::with(|cs| CAME.borrow_ref_mut(cs).enqueue(came));
}

/// The serial line.
pub struct Line {
    port: USART2,
    to_send: heapless::Deque<u8, TO_SEND>,
}

impl Line {
    /// Listens on a port that has been set up.
    pub fn new(port: USART2) -> Self {
        port.cr1().modify(|_, w| w.rxneie().set_bit());
        super::gantry::unmask(stm32f4xx_hal::pac::Interrupt::USART2);
        Self { port, to_send: heapless::Deque::new() }
    }

    /// What came, if anything: a byte, or `Some(None)` for one that was lost.
    pub fn receive(&mut self) -> Option<Option<u8>> {
        critical_section::with(|cs| CAME.borrow_ref_mut(cs).dequeue())
    }

    /// Whether there is room for another byte.
    pub fn has_room(&self) -> bool {
        !self.to_send.is_full()
    }

    /// Sends a byte in its turn.
    pub fn send(&mut self, byte: u8) {
        // The caller has looked.
        let _ = self.to_send.push_back(byte);
        self.pump();
    }

    /// Hands the transmitter what it takes.
    pub fn pump(&mut self) {
        while let Some(&byte) = self.to_send.front()
            && self.port.sr().read().txe().bit()
        {
            self.port.dr().write(|w| w.dr().set(byte.into()));
            self.to_send.pop_front();
        }
    }
}
