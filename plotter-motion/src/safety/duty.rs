//! [`Duty`], and the [`Demand`] of a controller.

use crate::Direction;
use core::fmt;

/// Share of the supply on a motor, with the sign of the direction: -1.0 to 1.0, checked once when made.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Duty(f32);

/// A duty outside -1.0 to 1.0, or not a number.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DutyError {
    /// The value refused.
    pub value: f32,
}

impl fmt::Display for DutyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "duty {} lies outside -1.0..=1.0", self.value)
    }
}

impl core::error::Error for DutyError {}

impl Duty {
    /// No voltage.
    pub const ZERO: Self = Self(0.0);
    /// The whole supply, forwards.
    pub const FULL: Self = Self(1.0);

    /// Checks a duty.
    ///
    /// # Errors
    ///
    /// [`DutyError`] for a value outside -1.0 to 1.0 and for NaN.
    pub fn new(value: f32) -> Result<Self, DutyError> {
        if (-1.0..=1.0).contains(&value) { Ok(Self(value)) } else { Err(DutyError { value }) }
    }

    /// The nearest duty there is; NaN gives none at all.
    ///
    /// ```
    /// # use plotter_motion::Duty;
    /// assert_eq!(Duty::saturating(3.0), Duty::FULL);
    /// assert_eq!(Duty::saturating(f32::NAN), Duty::ZERO);
    /// ```
    #[must_use]
    pub fn saturating(value: f32) -> Self {
        if value.is_nan() { Self::ZERO } else { Self(value.clamp(-1.0, 1.0)) }
    }

    /// The number, -1.0 to 1.0.
    #[must_use]
    pub const fn value(self) -> f32 {
        self.0
    }

    /// What a timer with `pwm_steps` steps (at most 65535) makes of it: rounded to nearest, with sign.
    ///
    /// ```
    /// # use plotter_motion::Duty;
    /// assert_eq!(Duty::saturating(20.0 / 255.0).steps(255), 20);
    /// assert_eq!(Duty::saturating(-1.0).steps(255), -255);
    /// ```
    #[must_use]
    pub fn steps(self, pwm_steps: u16) -> i32 {
        #[expect(clippy::cast_possible_truncation, reason = "at most 65535 in size")]
        let steps = libm::roundf(self.0 * f32::from(pwm_steps)) as i32;
        steps
    }

    /// The direction, if there is any voltage at all.
    #[must_use]
    pub fn direction(self) -> Option<Direction> {
        if self.0 > 0.0 {
            Some(Direction::Plus)
        } else if self.0 < 0.0 {
            Some(Direction::Minus)
        } else {
            None
        }
    }
}

/// Duties that a controller asks for, of both motors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Demand {
    /// First motor.
    pub x: Duty,
    /// Second motor.
    pub y: Duty,
}

impl Demand {
    /// Nothing.
    pub const NONE: Self = Self { x: Duty::ZERO, y: Duty::ZERO };
}
