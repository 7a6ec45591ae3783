//! [`Bench`]: the emulated UART1, on which the bench tells what happens and asks how far its time may go.
//!
//! The bench receives records:
//!
//! ```text
//!   1 byte    kind, and 16 times the microseconds since the record before, at most 15
//!   LEB128    how many more than 15 they are, if they are 15 or more
//!   ...       what the kind has to say
//! ```
//!
//! | kind | what it says | |
//! |---|---|---|
//! | 0 | time stands still until it is told how far to go | |
//! | 1, 2 | a byte of the host, of the controller is through | the byte |
//! | 3 to 6 | an encoder counted: x+, x-, y+, y- | |
//! | 7, 8 | the duty on the pins of the x, the y motor | steps, LEB128 of 2n, or of -2n-1 below 0 |
//! | 9 | the emergency stop button | 1 pressed, 0 free |
//! | 10 | a note | length, text |
//! | 11 | steps so far | their number, LEB128, and their CRC-64/XZ, 8 bytes |
//! | 14, 15 | where the pulses on STEP have led the x, the y motor | steps, as the duty |
//! | 12 | the processor starts | 1 after a reset by its watchdog, 0 otherwise |
//! | 13 | the firmware has stopped for good | length, text |
//!
//! The answer to kind 0: how many bytes the host puts on the line now (they come over UART0), and how many
//! microseconds later it is to be asked again, 0 for never; both LEB128.

use super::registers::{self, Timer, Uart};
use core::fmt;

/// What the switches say; see [`registers::switch`].
mod switch {
    /// 1: time is the host's. 0: time is the emulator's clock, and nothing is told.
    pub(super) const LOCKSTEP: usize = 0;
    pub(super) const STOP_PRESSED: usize = 1;
    pub(super) const BITE_AT_US: usize = 2;
    pub(super) const OVERRUN_AT_BYTE: usize = 3;
}

/// What outlives a reset.
mod kept {
    pub(super) const TIME_LOW: usize = 0;
    pub(super) const TIME_HIGH: usize = 1;
    pub(super) const BITTEN: usize = 2;
}

/// What is told.
#[derive(Clone, Copy, Debug)]
pub enum Told<'a> {
    /// Kind 1.
    HostByte(u8),
    /// Kind 2.
    ControllerByte(u8),
    /// Kinds 3 to 6: 0 for x+ to 3 for y-.
    Edge(u8),
    /// Kinds 7 and 8: 0 for x.
    Duty(u8, i32),
    /// Kind 9.
    Stop(bool),
    /// Kind 10.
    Note(fmt::Arguments<'a>),
    /// Kind 11.
    Steps(u64, u64),
    /// Kinds 14 and 15: 0 for x.
    Position(u8, i32),
    /// Kind 12.
    Start {
        /// By its watchdog.
        bitten: bool,
    },
    /// Kind 13.
    Dead(fmt::Arguments<'a>),
}

/// The bench's own line, and its time.
#[derive(Debug)]
pub struct Bench {
    uart: Uart,
    /// `None` while time is the host's.
    clock: Option<Timer>,
    /// Time of the last record.
    told_us: u64,
    /// Until when time may go on without asking.
    horizon_us: u64,
    bytes_until_overrun: Option<u32>,
    bite_at_us: Option<u64>,
    start_us: u64,
    restarted: bool,
}

impl Bench {
    /// The bench after a reset.
    pub fn new() -> Self {
        let restarted = registers::kept(kept::BITTEN) != 0;
        registers::keep(kept::BITTEN, 0);
        let start_us = if restarted {
            u64::from(registers::kept(kept::TIME_LOW)) | u64::from(registers::kept(kept::TIME_HIGH)) << 32
        } else {
            0
        };
        let set = |index| Some(registers::switch(index)).filter(|&value| value != 0);
        let mut bench = Self {
            uart: Uart::bench(),
            clock: set(switch::LOCKSTEP).is_none().then(Timer::start),
            told_us: start_us,
            horizon_us: start_us,
            bytes_until_overrun: set(switch::OVERRUN_AT_BYTE),
            // It bites once.
            bite_at_us: set(switch::BITE_AT_US).map(u64::from).filter(|_| !restarted),
            start_us,
            restarted,
        };
        bench.tell(start_us, Told::Start { bitten: restarted });
        bench
    }

    /// When the processor started, us of the bench's time.
    pub fn start_us(&self) -> u64 {
        self.start_us
    }

    /// Whether its watchdog reset it.
    pub fn restarted(&self) -> bool {
        self.restarted
    }

    /// Whether the emergency stop button is pressed from the start.
    pub fn stop_pressed(&self) -> bool {
        registers::switch(switch::STOP_PRESSED) != 0
    }

    /// Until when time may go on without [`ask`](Self::ask).
    pub fn horizon_us(&self) -> u64 {
        self.horizon_us
    }

    /// The host may have something to say to what it has just heard.
    pub fn listen(&mut self, now_us: u64) {
        self.horizon_us = now_us;
    }

    /// Asks how far time may go. The bytes that the host puts on the line meanwhile go to `send`.
    pub fn ask(&mut self, now_us: u64, line: &mut Uart, mut send: impl FnMut(u8)) {
        if self.bite_at_us.is_some_and(|at| now_us >= at) {
            self.bite(now_us);
        }
        let horizon_us = match &mut self.clock {
            Some(clock) => {
                let origin = self.start_us;
                // What the wall's clock says, and never back.
                loop {
                    if let Some(byte) = line.try_receive() {
                        send(byte);
                    }
                    let clock_us = origin.saturating_add(clock.now_us());
                    if clock_us > now_us {
                        break clock_us;
                    }
                }
            }
            None => {
                self.record(now_us, 0);
                for _ in 0..self.number() {
                    let byte = line.receive();
                    send(byte);
                }
                match self.number() {
                    0 => u64::MAX,
                    us => now_us.saturating_add(us),
                }
            }
        };
        self.horizon_us = self.bite_at_us.map_or(horizon_us, |bite_us| horizon_us.min(bite_us));
    }

    /// The watchdog, which nobody has fed: the processor begins anew, and knows only this.
    fn bite(&mut self, now_us: u64) -> ! {
        registers::keep(kept::TIME_LOW, now_us as u32);
        registers::keep(kept::TIME_HIGH, (now_us >> 32) as u32);
        registers::keep(kept::BITTEN, 1);
        cortex_m::peripheral::SCB::sys_reset()
    }

    /// Whether this byte of the host comes while the one before still lies in the receiver, and is lost.
    pub fn is_overrun(&mut self) -> bool {
        let Some(left) = self.bytes_until_overrun.take() else { return false };
        self.bytes_until_overrun = left.checked_sub(1).filter(|&left| left > 0);
        self.bytes_until_overrun.is_none()
    }

    /// Tells what happens.
    pub fn tell(&mut self, now_us: u64, told: Told<'_>) {
        if self.clock.is_some() {
            return;
        }
        match told {
            Told::HostByte(byte) => self.record_with(now_us, 1, byte),
            Told::ControllerByte(byte) => self.record_with(now_us, 2, byte),
            Told::Edge(which) => self.record(now_us, 3 + which.min(3)),
            Told::Duty(axis, steps) => {
                self.record(now_us, 7 + axis.min(1));
                self.put_signed(steps);
            }
            Told::Position(axis, steps) => {
                self.record(now_us, 14 + axis.min(1));
                self.put_signed(steps);
            }
            Told::Stop(pressed) => self.record_with(now_us, 9, pressed.into()),
            Told::Note(text) => self.text(now_us, 10, text),
            Told::Steps(count, crc) => {
                self.record(now_us, 11);
                self.put(count);
                for byte in crc.to_le_bytes() {
                    self.uart.send(byte);
                }
            }
            Told::Start { bitten } => self.record_with(now_us, 12, bitten.into()),
            Told::Dead(text) => self.text(now_us, 13, text),
        }
    }

    fn record_with(&mut self, now_us: u64, kind: u8, byte: u8) {
        self.record(now_us, kind);
        self.uart.send(byte);
    }

    fn record(&mut self, now_us: u64, kind: u8) {
        let since_us = now_us.saturating_sub(self.told_us);
        self.told_us = now_us;
        let short = u8::try_from(since_us).unwrap_or(15).min(15);
        self.uart.send(kind | short << 4);
        if short == 15 {
            self.put(since_us - 15);
        }
    }

    fn text(&mut self, now_us: u64, kind: u8, text: fmt::Arguments<'_>) {
        let mut line = heapless::String::<250>::new();
        // What is too long is cut.
        let _ = fmt::Write::write_fmt(&mut line, text);
        self.record(now_us, kind);
        self.put(line.len() as u64);
        for byte in line.bytes() {
            self.uart.send(byte);
        }
    }

    fn put_signed(&mut self, number: i32) {
        self.put(u64::from(((number << 1) ^ (number >> 31)).cast_unsigned()));
    }

    /// LEB128: seven bits a byte, the least first, the eighth says that more follow.
    fn put(&mut self, mut number: u64) {
        while number > 0x7f {
            self.uart.send(number.to_le_bytes()[0] | 0x80);
            number >>= 7;
        }
        self.uart.send(number.to_le_bytes()[0]);
    }

    fn number(&mut self) -> u64 {
        let (mut number, mut shift) = (0_u64, 0);
        loop {
            let byte = self.uart.receive();
            number |= u64::from(byte & 0x7f) << shift;
            shift += 7;
            if byte & 0x80 == 0 || shift > 56 {
                return number;
            }
        }
    }
}

/// The firmware panicked: tells it, past everything else.
pub fn last_words(text: fmt::Arguments<'_>) {
    if registers::switch(switch::LOCKSTEP) != 0 {
        let mut bench = Bench {
            uart: Uart::bench(),
            clock: None,
            told_us: 0,
            horizon_us: 0,
            bytes_until_overrun: None,
            bite_at_us: None,
            start_us: 0,
            restarted: false,
        };
        bench.tell(0, Told::Dead(text));
    }
}
