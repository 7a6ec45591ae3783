//! The registers of `mps2-an386` that the simulated plotter needs: the only file here that touches memory by
//! its address.
//!
//! Source: Arm, *Cortex-M System Design Kit Technical Reference Manual* (DDI 0479), "APB UART", table 4-3;
//! addresses: Arm, *Application Note AN386*, table 3-2. We know of no crate for these peripherals.
#![allow(unsafe_code, reason = "memory-mapped registers have no other access")]

use core::ptr::{read_volatile, write_volatile};

/// Reads the word at `address`, which must be one of those in this file.
fn read(address: usize) -> u32 {
    // SAFETY: a register, or memory that the linker script leaves free; aligned, and always there on this
    // machine.
    unsafe { read_volatile(address as *const u32) }
}

/// Writes the word at `address`, which must be one of those in this file.
fn write(address: usize, value: u32) {
    // SAFETY: as above, and nothing in Rust's memory lies there.
    unsafe { write_volatile(address as *mut u32, value) }
}

/// One of the UARTs.
#[derive(Debug)]
pub struct Uart {
    base: usize,
}

const DATA: usize = 0x0;
const STATE: usize = 0x4;
const TX_FULL: u32 = 1 << 0;
const RX_FULL: u32 = 1 << 1;
const CTRL: usize = 0x8;
const TX_AND_RX_ON: u32 = 0b11;
const BAUD_DIVIDER: usize = 0x10;
/// The least that the UART takes; the emulator sends at once whatever it says.
const LEAST_DIVIDER: u32 = 16;

impl Uart {
    /// UART0: the plotter's serial line.
    pub fn line() -> Self {
        Self::on(0x4000_4000)
    }

    /// UART1: the bench's own.
    pub fn bench() -> Self {
        Self::on(0x4000_5000)
    }

    fn on(base: usize) -> Self {
        write(base + BAUD_DIVIDER, LEAST_DIVIDER);
        write(base + CTRL, TX_AND_RX_ON);
        Self { base }
    }

    /// Sends a byte, as soon as there is room for it.
    pub fn send(&mut self, byte: u8) {
        while read(self.base + STATE) & TX_FULL != 0 {}
        write(self.base + DATA, byte.into());
    }

    /// The byte that has come, if one has.
    pub fn try_receive(&mut self) -> Option<u8> {
        (read(self.base + STATE) & RX_FULL != 0).then(|| read(self.base + DATA).to_le_bytes()[0])
    }

    /// The next byte, whenever it comes.
    pub fn receive(&mut self) -> u8 {
        loop {
            if let Some(byte) = self.try_receive() {
                return byte;
            }
        }
    }
}

/// Words above the linker's memory, which QEMU sets at every reset (`-device loader`): how the bench is set
/// up.
const SWITCHES: usize = 0x2030_0000;
/// Words beside them that a reset leaves alone.
const KEPT: usize = 0x2030_1000;
/// How many there are of each.
pub const WORDS: usize = 8;

/// The bench's switch `index`; 0 if QEMU was not told. Beyond the last one: the last.
pub fn switch(index: usize) -> u32 {
    read(SWITCHES + 4 * index.min(WORDS - 1))
}

/// A word that outlives a reset; 0 at power-up.
pub fn kept(index: usize) -> u32 {
    read(KEPT + 4 * index.min(WORDS - 1))
}

/// Keeps a word over a reset.
pub fn keep(index: usize, word: u32) {
    write(KEPT + 4 * index.min(WORDS - 1), word);
}

/// APB timer 0: 25 MHz, counting down.
const TIMER: usize = 0x4000_0000;
const TIMER_VALUE: usize = TIMER + 0x4;
const TIMER_RELOAD: usize = TIMER + 0x8;
const TIMER_TICKS_PER_US: u64 = 25;

/// The emulator's own clock.
#[derive(Debug)]
pub struct Timer {
    last: u32,
    ticks: u64,
}

impl Timer {
    /// Starts it.
    pub fn start() -> Self {
        write(TIMER_RELOAD, u32::MAX);
        write(TIMER_VALUE, u32::MAX);
        write(TIMER, 1);
        Self { last: u32::MAX, ticks: 0 }
    }

    /// Microseconds since the start; to be read once in two minutes at least.
    pub fn now_us(&mut self) -> u64 {
        let value = read(TIMER_VALUE);
        self.ticks += u64::from(self.last.wrapping_sub(value));
        self.last = value;
        self.ticks / TIMER_TICKS_PER_US
    }
}
