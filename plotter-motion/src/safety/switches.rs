//! [`LimitSwitches`], and what they are in the way of.

use crate::{Axis, Direction};
use core::fmt;

/// Why a step may not be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Blocked {
    /// The emergency stop is latched, or the host has stopped the machine.
    Stopped,
    /// The motion leads into a pressed limit switch.
    Limit {
        /// Axis of the switch.
        axis: Axis,
        /// End of that axis.
        end: Direction,
    },
    /// A step of a third motor leads into a pressed limit switch of its axis.
    #[cfg(feature = "third-motor")]
    LimitZ {
        /// End of that axis.
        end: Direction,
    },
}

impl fmt::Display for Blocked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (axis, end) = match self {
            #[cfg(feature = "third-motor")]
            Self::LimitZ { end } => ("z", end),
            Self::Stopped => return f.write_str("the machine is stopped: reset the emergency stop first"),
            Self::Limit { axis: Axis::X, end } => ("x", end),
            Self::Limit { axis: Axis::Y, end } => ("y", end),
        };
        let end = if *end == Direction::Plus { "upper" } else { "lower" };
        write!(f, "the limit switch at the {end} end of {axis} is pressed: step the other way")
    }
}

impl core::error::Error for Blocked {}

/// Limit switches that are pressed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LimitSwitches {
    /// At the left end.
    pub x_min: bool,
    /// At the right end.
    pub x_max: bool,
    /// At the lower end.
    pub y_min: bool,
    /// At the upper end.
    pub y_max: bool,
}

impl LimitSwitches {
    /// None of them is pressed; also what a machine says that has none.
    pub const RELEASED: Self = Self { x_min: false, x_max: false, y_min: false, y_max: false };

    /// Whether the switch at the end that `direction` leads to is pressed.
    #[must_use]
    #[cfg_attr(target_os = "none", inline(never))]
    pub const fn blocks(self, axis: Axis, direction: Direction) -> bool {
        self.blocks_inline(axis, direction)
    }

    /// The same where it has to be quick: for every step and every edge of an encoder.
    #[inline(always)]
    pub(super) const fn blocks_inline(self, axis: Axis, direction: Direction) -> bool {
        match (axis, direction) {
            (Axis::X, Direction::Plus) => self.x_max,
            (Axis::X, Direction::Minus) => self.x_min,
            (Axis::Y, Direction::Plus) => self.y_max,
            (Axis::Y, Direction::Minus) => self.y_min,
        }
    }

    /// Whether any switch is pressed.
    #[must_use]
    pub const fn any(&self) -> bool {
        self.x_min | self.x_max | self.y_min | self.y_max
    }

    /// Notes one switch.
    pub const fn set(&mut self, axis: Axis, end: Direction, pressed: bool) {
        match (axis, end) {
            (Axis::X, Direction::Plus) => self.x_max = pressed,
            (Axis::X, Direction::Minus) => self.x_min = pressed,
            (Axis::Y, Direction::Plus) => self.y_max = pressed,
            (Axis::Y, Direction::Minus) => self.y_min = pressed,
        }
    }
}

/// Which limit switches of a third axis, or of the second motor of an axis, are pressed. Of those that a
/// machine does not have, none is.
#[cfg(feature = "third-motor")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct EndSwitches {
    /// At the lower end.
    pub lower: bool,
    /// At the upper end.
    pub upper: bool,
}

#[cfg(feature = "third-motor")]
impl EndSwitches {
    /// What is left of a step.
    pub(super) const fn lets(self, step: i8) -> i8 {
        match step.signum() {
            1 if self.upper => 0,
            -1 if self.lower => 0,
            sign => sign,
        }
    }
}
