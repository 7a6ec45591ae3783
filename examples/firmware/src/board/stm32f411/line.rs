//! The serial line: bytes come by interrupt, and go from a buffer.

use core::cell::RefCell;
use critical_section::Mutex;
use heapless::spsc::Queue;
use stm32f4xx_hal::pac::{USART2, interrupt};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::serial::{Rx, Tx};

/// Bytes that came and were not fetched: the loop takes less time than the line for these, a planned block included.
const COME: usize = 32;
/// Bytes that wait to be sent.
const TO_SEND: usize = 128;

static RECEIVER: Mutex<RefCell<Option<Rx<USART2>>>> = Mutex::new(RefCell::new(None));
/// What came; `None` for a byte that was lost or damaged.
static CAME: Mutex<RefCell<Queue<Option<u8>, COME>>> = Mutex::new(RefCell::new(Queue::new()));

#[interrupt]
fn USART2() {
    critical_section::with(|cs| {
        if let Some(rx) = RECEIVER.borrow_ref_mut(cs).as_mut() {
            let came = match rx.read() {
                Err(nb::Error::WouldBlock) => return,
                Ok(byte) => Some(byte),
                Err(nb::Error::Other(_)) => None,
            };
            // A full queue is a loop that stands still: its watchdog bites.
            let _ = CAME.borrow_ref_mut(cs).enqueue(came);
        }
    });
}

/// The serial line.
pub struct Line {
    tx: Tx<USART2>,
    to_send: heapless::Deque<u8, TO_SEND>,
}

impl Line {
    /// Listens.
    pub fn new(tx: Tx<USART2>, mut rx: Rx<USART2>) -> Self {
        rx.listen();
        critical_section::with(|cs| {
            RECEIVER.borrow_ref_mut(cs).replace(rx);
        });
        super::gantry::unmask(stm32f4xx_hal::pac::Interrupt::USART2);
        Self { tx, to_send: heapless::Deque::new() }
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
            && self.tx.write(byte).is_ok()
        {
            self.to_send.pop_front();
        }
    }
}
