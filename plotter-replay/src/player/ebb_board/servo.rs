//! [`Servo`]: the servo of the pen.

use plotter_motion::Pen;
use plotter_motion::protocol::ebb::TICKS_PER_MS;

/// The servo that lifts the pen: a pulse whose length changes by a rate each time that it comes. Lengths are
/// in units of 1/12 µs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Servo {
    /// Length of the pulse with the pen up, and with the pen down.
    pub(super) up: u16,
    pub(super) down: u16,
    /// What it changes by from pulse to pulse on the way up, and on the way down; 0 changes at once.
    pub(super) rate_up: u16,
    pub(super) rate_down: u16,
    /// So many servos have a pulse one after the other, each of them so many ms after the one before.
    pub(super) slots: u16,
    pub(super) slot_ms: u16,
    /// What was asked for last, and is under way.
    pub(super) asked: Pen,
    value: u16,
    target: u16,
    rate: u16,
}

impl Default for Servo {
    /// Documented with the commands SC,4, SC,5, SC,8 and SC,9; the rates are those of firmware 2.8.1.
    fn default() -> Self {
        Self {
            up: 12_000,
            down: 16_000,
            rate_up: 400,
            rate_down: 400,
            slots: 8,
            slot_ms: 3,
            asked: Pen::Up,
            value: 12_000,
            target: 12_000,
            rate: 0,
        }
    }
}

impl Servo {
    /// Where it goes for the pen, and at which rate.
    pub(super) fn way(&self, pen: Pen) -> (u16, u16) {
        if pen == Pen::Up { (self.up, self.rate_up) } else { (self.down, self.rate_down) }
    }

    pub(super) fn go(&mut self, position: u16, rate: u16) {
        self.asked = if position == self.up { Pen::Up } else { Pen::Down };
        (self.target, self.rate) = (position, rate);
    }

    /// Ticks from one pulse to the next.
    pub(super) fn period_ticks(&self) -> u64 {
        u64::from(TICKS_PER_MS) * u64::from(self.slots.max(1)) * u64::from(self.slot_ms.max(1))
    }

    pub(super) fn is_under_way(&self) -> bool {
        self.value != self.target
    }

    /// The next pulse.
    pub(super) fn pulse(&mut self) {
        let way = self.target.abs_diff(self.value);
        let by = if self.rate == 0 { way } else { way.min(self.rate) };
        self.value = if self.target > self.value { self.value + by } else { self.value - by };
    }

    /// Where the pen is: at which end it is nearer.
    pub(super) fn pen(&self) -> Pen {
        if self.value.abs_diff(self.down) < self.value.abs_diff(self.up) { Pen::Down } else { Pen::Up }
    }

    /// What SC sets. Other parameters change nothing here.
    pub(super) fn set(&mut self, parameter: u16, value: u16) {
        match parameter {
            4 => self.up = value,
            5 => self.down = value,
            8 => self.slots = value.clamp(1, 24),
            9 => self.slot_ms = value.clamp(1, 6),
            10 => (self.rate_up, self.rate_down) = (value, value),
            11 => self.rate_up = value,
            12 => self.rate_down = value,
            _ => {}
        }
    }
}
