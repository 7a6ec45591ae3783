//! The registers of an ATmega328P at 16 MHz: the only place with `unsafe` in it.
//!
//! ```text
//!  PB0, PB1   phases A and B of the x encoder       PD6 (OC0A), PD4   PWM and direction of the x motor
//!  PB2, PB3   those of the y encoder                PD5 (OC0B), PD7   those of the y motor
//!  PC0, PC1   STEP and DIR of the x motor           PD0, PD1          serial line, 250,000 baud
//!  PC2, PC3   those of the y motor
//! ```
//!
//! Addresses and bits: data sheet of the ATmega328P (Microchip DS40002061), section "Register Summary".

use core::ptr::{read_volatile, write_volatile};
use core::time::Duration;
use plotter_motion::{Axis, Drive, encoder::Phases, safety::Pulse};

/// A register of this microcontroller by its address in data space.
#[derive(Clone, Copy)]
struct Register(u8);

impl Register {
    fn read(self) -> u8 {
        // SAFETY: every register below exists on this microcontroller, and reading one has no effect on
        // memory.
        unsafe { read_volatile(usize::from(self.0) as *const u8) }
    }

    fn write(self, value: u8) {
        // SAFETY: as above; none of them is in memory that the compiler uses.
        unsafe { write_volatile(usize::from(self.0) as *mut u8, value) }
    }
}

const PINB: Register = Register(0x23);
const DDRC: Register = Register(0x27);
const PORTC: Register = Register(0x28);
const DDRD: Register = Register(0x2A);
const PORTD: Register = Register(0x2B);
const TCCR0A: Register = Register(0x44);
const TCCR0B: Register = Register(0x45);
const OCR0A: Register = Register(0x47);
const OCR0B: Register = Register(0x48);
const TCCR1B: Register = Register(0x81);
const TCNT1L: Register = Register(0x84);
const TCNT1H: Register = Register(0x85);
const UCSR0A: Register = Register(0xC0);
const UCSR0B: Register = Register(0xC1);
const UCSR0C: Register = Register(0xC2);
const UBRR0L: Register = Register(0xC4);
const UDR0: Register = Register(0xC6);

/// Both motors on an 8-bit timer.
pub const PWM_STEPS: u16 = 255;
/// A tick of timer 1: 16 MHz by 64.
const TICK_NS: u32 = 4_000;
/// The line has received a byte; it takes another one.
const RXC0: u8 = 1 << 7;
const UDRE0: u8 = 1 << 5;

/// The board.
pub struct Board {
    now: Duration,
    ticks: u16,
}

impl Board {
    /// Sets the board up. There must be but one.
    pub fn new() -> Self {
        // phase correct PWM on both outputs, so that a duty of 0 is no pulse at all; 16 MHz by 8 and 510:
        // 3.9 kHz
        TCCR0A.write(0b1010_0001);
        TCCR0B.write(0b010);
        DDRD.write(1 << 4 | 1 << 5 | 1 << 6 | 1 << 7);
        DDRC.write(0b1111);
        TCCR1B.write(0b011); // by 64
        // double speed, 16 MHz by 8 and 7 + 1: 250,000 baud; 8 bits, no parity, one stop bit
        UCSR0A.write(1 << 1);
        UBRR0L.write(7);
        UCSR0C.write(0b110);
        UCSR0B.write(1 << 4 | 1 << 3);
        Self { now: Duration::ZERO, ticks: 0 }
    }

    /// Time since the start. Must be called every quarter of a second at least.
    pub fn now(&mut self) -> Duration {
        // the low byte first: reading it keeps the high one
        let low = TCNT1L.read();
        let ticks = u16::from_le_bytes([low, TCNT1H.read()]);
        let since = u32::from(ticks.wrapping_sub(self.ticks));
        self.ticks = ticks;
        self.now = self.now.saturating_add(Duration::new(0, since * TICK_NS));
        self.now
    }

    /// A byte from the host, if one has come.
    pub fn receive(&mut self) -> Option<u8> {
        (UCSR0A.read() & RXC0 != 0).then(|| UDR0.read())
    }

    /// Whether the line takes another byte.
    pub fn can_transmit(&self) -> bool {
        UCSR0A.read() & UDRE0 != 0
    }

    /// Sends a byte to the host; the line must take it.
    pub fn transmit(&mut self, byte: u8) {
        UDR0.write(byte);
    }

    /// The levels of an encoder.
    pub fn phases(&self, axis: Axis) -> Phases {
        let pins = PINB.read() >> if axis == Axis::X { 0 } else { 2 };
        Phases { a: pins & 1 != 0, b: pins & 2 != 0 }
    }

    /// Puts a drive on both H-bridges.
    pub fn drive(&mut self, drive: Drive) {
        let (x, y) = (drive.x().steps(PWM_STEPS), drive.y().steps(PWM_STEPS));
        let duty = |steps: i32| u8::try_from(steps.unsigned_abs()).unwrap_or(u8::MAX);
        PORTD.write(u8::from(x < 0) << 4 | u8::from(y < 0) << 7);
        OCR0A.write(duty(x));
        OCR0B.write(duty(y));
    }

    /// Makes a step: direction first, then a pulse of at least 1 us.
    pub fn step(&mut self, pulse: Pulse) {
        let direction = u8::from(pulse.x() < 0) << 1 | u8::from(pulse.y() < 0) << 3;
        let steps = u8::from(pulse.x() != 0) | u8::from(pulse.y() != 0) << 2;
        PORTC.write(direction);
        // 16 writes of a cycle or more: at least the microsecond that an A4988 asks for
        for _ in 0..16 {
            PORTC.write(direction | steps);
        }
        PORTC.write(direction);
    }
}

impl Default for Board {
    fn default() -> Self {
        Self::new()
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    OCR0A.write(0);
    OCR0B.write(0);
    loop {}
}
