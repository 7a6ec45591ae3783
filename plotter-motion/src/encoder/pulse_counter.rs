//! Encoders with one phase: they count up whichever way the motor turns, and the motor's voltage says which
//! way that was.
//!
//! ```text
//!  voltage   ┌───────────┐                          P(t + dt) = P(t) + sgn(V) dP
//!          ──┘           └──────────┐
//!                                   └────────       at 0 V the sign stays: the motor runs down
//!  pulses     ▏▏▏▏▏▏▏▏▏▏▏ ▏ ▏  ▏     ▏ ▏▏▏▏▏        in the way in which it was driven
//!  counted    + + + + + + + +  +     - - - -
//! ```
//!
//! Source: Khan and McGinn, "2D Controlled Marking Board", section 0.2.3: motors of the marking board, 46.3
//! pulses a millimetre. What this cannot see: a motor that still runs on when its voltage has been reversed
//! is counted the wrong way until it has turned round, and one that is turned by hand as it was driven last.
//! Stop it before it is reversed.

use crate::{Direction, Duty};

/// Position of a motor whose encoder only counts up, in pulses.
///
/// ```
/// # use plotter_motion::{Duty, encoder::PulseCounter};
/// let mut counter = PulseCounter::default();
/// counter.driven(Duty::FULL);
/// counter.pulses(100);
/// counter.driven(Duty::ZERO);
/// counter.pulses(7); // runs down
/// assert_eq!(counter.position(), 107);
/// counter.driven(Duty::saturating(-0.5));
/// counter.pulses(10);
/// assert_eq!(counter.position(), 97);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PulseCounter {
    position: i32,
    direction: Option<Direction>,
    undirected: u32,
}

impl PulseCounter {
    /// Takes what the motor gets from now on; without voltage the direction stays.
    pub fn driven(&mut self, duty: Duty) {
        self.direction = duty.direction().or(self.direction);
    }

    /// Takes pulses that have come since the last call. The position wraps at the ends of `i32`.
    pub const fn pulses(&mut self, pulses: u32) {
        let Some(direction) = self.direction else {
            self.undirected = self.undirected.saturating_add(pulses);
            return;
        };
        self.position = match direction {
            Direction::Plus => self.position.wrapping_add_unsigned(pulses),
            Direction::Minus => self.position.wrapping_sub_unsigned(pulses),
        };
    }

    /// Where the motor is, pulses from where it was at first.
    #[must_use]
    pub const fn position(&self) -> i32 {
        self.position
    }

    /// Direction in which pulses are counted; `None` before the motor has been driven.
    #[must_use]
    pub const fn direction(&self) -> Option<Direction> {
        self.direction
    }

    /// Pulses that came before the motor had ever been driven: nobody knows which way, and they are not
    /// counted.
    #[must_use]
    pub const fn undirected(&self) -> u32 {
        self.undirected
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pulses_before_the_first_drive_are_told_apart() {
        let mut counter = PulseCounter::default();
        counter.pulses(3);
        counter.driven(Duty::ZERO);
        counter.pulses(1);
        assert_eq!((counter.position(), counter.undirected()), (0, 4));
    }

    #[test]
    fn the_position_wraps() {
        let mut counter = PulseCounter::default();
        counter.driven(Duty::saturating(-1.0));
        counter.pulses(u32::MAX);
        assert_eq!(counter.position(), 1);
    }
}
