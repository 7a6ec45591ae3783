//! Connections of every simulated machine: the serial line to its host, and the bench that watches it.

use super::bench::{Bench, Told};
use super::line::Line;
use super::registers::Uart;
use crate::board::{Event, Notice};

/// The serial line in both directions, and the bench.
#[derive(Debug)]
pub struct Connection {
    uart: Uart,
    to_controller: Line,
    to_host: Line,
    bench: Bench,
}

impl Connection {
    /// A silent line of `baud` bits a second.
    pub fn new(baud: u32, bench: Bench) -> Self {
        Self { uart: Uart::line(), to_controller: Line::new(baud), to_host: Line::new(baud), bench }
    }

    /// When the next byte of the host is through.
    pub fn to_controller_us(&self) -> Option<u64> {
        self.to_controller.next_us()
    }

    /// When the next byte of the controller is through.
    pub fn to_host_us(&self) -> Option<u64> {
        self.to_host.next_us()
    }

    /// When the host has to be asked how far time may go.
    pub fn horizon_us(&self) -> u64 {
        self.bench.horizon_us()
    }

    /// A byte of the host is through.
    pub fn received(&mut self, at_us: u64) -> Option<Event> {
        let byte = self.to_controller.pop()?;
        self.bench.tell(at_us, Told::HostByte(byte));
        Some(if self.bench.is_overrun() { Event::LineFault } else { Event::Byte(byte) })
    }

    /// A byte of the controller is through; the host may have an answer to one that `asks`.
    pub fn sent(&mut self, at_us: u64, asks: impl FnOnce(u8) -> bool) {
        if let Some(byte) = self.to_host.pop() {
            self.bench.tell(at_us, Told::ControllerByte(byte));
            if asks(byte) {
                self.bench.listen(at_us);
            }
        }
    }

    /// Asks the host how far time may go; what it sends meanwhile is on the line.
    pub fn ask(&mut self, at_us: u64) {
        let line = &mut self.to_controller;
        self.bench.ask(at_us, &mut self.uart, |byte| {
            line.send(at_us, byte);
        });
    }

    /// Whether a byte can be sent.
    pub fn can_send(&self) -> bool {
        self.to_host.has_room()
    }

    /// Sends a byte to the host.
    pub fn send(&mut self, now_us: u64, byte: u8) {
        if self.to_host.send(now_us, byte) {
            self.uart.send(byte);
        }
    }

    /// Tells a person.
    pub fn notify(&mut self, now_us: u64, notice: Notice) {
        self.tell(now_us, Told::Note(format_args!("{notice}")));
    }

    /// Tells the bench.
    pub fn tell(&mut self, now_us: u64, told: Told<'_>) {
        self.bench.tell(now_us, told);
    }
}
