//! Two-phase incremental encoders: which way and how far a shaft turned.
//!
//! ```text
//!        ┌───┐   ┌───┐         forwards: B leads; at a rising A, B is high
//!   A  ──┘   └───┘   └──       backwards: A leads; at a rising A, B is low
//!      ┌───┐   ┌───┐
//!   B  ┘   └───┘   └────       ×1: rising edges of A   ×2: every edge of A   ×4: every edge
//! ```
//!
//! [`QuadratureX1`] is the published decoder (Öcal's thesis, section 6.4.1): at each rising edge of A, B high
//! counts up and B low counts down. It has a weakness that its author did not meet or did not mention: the
//! rising edge lies at the *start* of A's high half when the shaft turns forwards and at its *end* when it
//! turns backwards. A shaft that trembles about the start of the high half rises again and again and is
//! counted up each time, though it goes nowhere. [`QuadratureX2`] counts at the same edges in both directions
//! and does not drift, with an interrupt on one pin still; [`QuadratureX4`] has an edge of its own for every
//! quarter of a period, and sees when it missed one.

mod pulse_counter;

use crate::Direction;
pub use pulse_counter::PulseCounter;

/// Levels of both phases.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Phases {
    /// Phase A.
    pub a: bool,
    /// Phase B.
    pub b: bool,
}

impl Phases {
    /// The levels in quarter `quarter` of a period, counted forwards from the rising edge of A.
    #[must_use]
    pub const fn of_quarter(quarter: i64) -> Self {
        match quarter.rem_euclid(4) {
            0 => Self { a: true, b: true },
            1 => Self { a: true, b: false },
            2 => Self { a: false, b: false },
            _ => Self { a: false, b: true },
        }
    }

    /// The quarter of the period that shows these levels, 0 to 3.
    const fn quarter(self) -> u8 {
        match (self.a, self.b) {
            (true, true) => 0,
            (true, false) => 1,
            (false, false) => 2,
            (false, true) => 3,
        }
    }
}

/// Published ×1 decoding: the rising edges of phase A.
///
/// ```
/// # use plotter_motion::{Direction, encoder::{Phases, QuadratureX1}};
/// let mut decoder = QuadratureX1::new(Phases { a: false, b: true });
/// assert_eq!(decoder.update(Phases { a: true, b: true }), Some(Direction::Plus));
/// assert_eq!(decoder.update(Phases { a: true, b: false }), None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct QuadratureX1 {
    a_was_high: bool,
}

impl QuadratureX1 {
    /// A decoder that starts with the shaft where it shows `phases`.
    #[must_use]
    pub const fn new(phases: Phases) -> Self {
        Self { a_was_high: phases.a }
    }

    /// Takes the present levels; says whether the shaft went on by a period.
    pub const fn update(&mut self, phases: Phases) -> Option<Direction> {
        let rising = phases.a && !self.a_was_high;
        self.a_was_high = phases.a;
        match (rising, phases.b) {
            (false, _) => None,
            (true, true) => Some(Direction::Plus),
            (true, false) => Some(Direction::Minus),
        }
    }
}

/// ×2 decoding: both edges of phase A. Right after one, B is at A's level if the shaft turns forwards, and at
/// the other one if it turns backwards.
///
/// ```
/// # use plotter_motion::{Direction, encoder::{Phases, QuadratureX2}};
/// let mut decoder = QuadratureX2::new(Phases::of_quarter(0));
/// assert_eq!(decoder.update(Phases::of_quarter(1)), None); // B's edge
/// assert_eq!(decoder.update(Phases::of_quarter(2)), Some(Direction::Plus)); // A falls while B is low
/// assert_eq!(decoder.update(Phases::of_quarter(1)), Some(Direction::Minus)); // and rises again
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct QuadratureX2 {
    a_was_high: bool,
}

impl QuadratureX2 {
    /// A decoder that starts with the shaft where it shows `phases`.
    #[must_use]
    pub const fn new(phases: Phases) -> Self {
        Self { a_was_high: phases.a }
    }

    /// Takes the present levels; says whether the shaft went on by half a period.
    pub const fn update(&mut self, phases: Phases) -> Option<Direction> {
        let edge = phases.a != self.a_was_high;
        self.a_was_high = phases.a;
        match (edge, phases.a == phases.b) {
            (false, _) => None,
            (true, true) => Some(Direction::Plus),
            (true, false) => Some(Direction::Minus),
        }
    }
}

/// ×4 decoding: every edge of both phases, and a count of the transitions that no shaft can make.
///
/// ```
/// # use plotter_motion::{Direction, encoder::{Phases, QuadratureX4}};
/// let mut decoder = QuadratureX4::new(Phases::of_quarter(0));
/// assert_eq!(decoder.update(Phases::of_quarter(1)), Some(Direction::Plus));
/// assert_eq!(decoder.update(Phases::of_quarter(0)), Some(Direction::Minus));
/// assert_eq!(decoder.update(Phases::of_quarter(2)), None); // both phases at once: an edge was missed
/// assert_eq!(decoder.illegal(), 1);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct QuadratureX4 {
    quarter: u8,
    illegal: u32,
}

impl QuadratureX4 {
    /// A decoder that starts with the shaft where it shows `phases`.
    #[must_use]
    pub const fn new(phases: Phases) -> Self {
        Self { quarter: phases.quarter(), illegal: 0 }
    }

    /// Takes the present levels; says whether the shaft went on by a quarter of a period.
    pub const fn update(&mut self, phases: Phases) -> Option<Direction> {
        let quarter = phases.quarter();
        let turned = (quarter + 4 - self.quarter) % 4;
        self.quarter = quarter;
        match turned {
            1 => Some(Direction::Plus),
            3 => Some(Direction::Minus),
            2 => {
                self.illegal = self.illegal.saturating_add(1);
                None
            }
            _ => None,
        }
    }

    /// How many times both phases changed at once, so that an edge was missed.
    #[must_use]
    pub const fn illegal(&self) -> u32 {
        self.illegal
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(mut update: impl FnMut(Phases) -> Option<Direction>, quarters: &[i64]) -> i32 {
        quarters.iter().filter_map(|&quarter| update(Phases::of_quarter(quarter))).map(Direction::sign).sum()
    }

    #[test]
    fn x1_counts_a_period_forwards_and_backwards() {
        let mut decoder = QuadratureX1::new(Phases::of_quarter(0));
        assert_eq!(counts(|p| decoder.update(p), &[1, 2, 3, 4, 5, 6, 7, 8]), 2);
        assert_eq!(counts(|p| decoder.update(p), &[7, 6, 5, 4, 3, 2, 1, 0]), -2);
    }

    #[test]
    fn x2_counts_half_a_period_in_both_directions() {
        let mut decoder = QuadratureX2::new(Phases::of_quarter(0));
        assert_eq!(counts(|p| decoder.update(p), &[1, 2, 3, 4, 5, 6, 7, 8]), 4);
        assert_eq!(counts(|p| decoder.update(p), &[7, 6, 5, 4, 3, 2, 1, 0]), -4);
    }

    #[test]
    fn x1_drifts_when_the_shaft_trembles_about_one_edge_and_the_others_do_not() {
        let tremble = [-1, 0, -1, 0, -1, 0];
        let mut x2 = QuadratureX2::new(Phases::of_quarter(0));
        assert_eq!(counts(|p| x2.update(p), &tremble), 0);
        let mut x1 = QuadratureX1::new(Phases::of_quarter(0));
        assert_eq!(counts(|p| x1.update(p), &tremble), 3);
        let mut x4 = QuadratureX4::new(Phases::of_quarter(0));
        assert_eq!(counts(|p| x4.update(p), &tremble), 0);
    }
}
