//! From what a controller wants to what a motor gets: [`Demand`] -> [`SafetyGate::pass`] -> [`Drive`].
//!
//! ```text
//!  controller ──Demand──▶ SafetyGate ──Drive──▶ H-bridge, laser, simulated motor
//!            ──StepPair──▶          ──Pulse──▶ step and direction pins
//!                          ▲      ▲
//!            limit switches       emergency stop (latched)
//! ```
//!
//! Drivers take nothing but a [`Drive`], and only the gate makes one, so no controller can go round the
//! limit switches: a program that tries does not compile.
//!
//! ```compile_fail
//! # use plotter_motion::{Drive, Duty};
//! let forged = Drive { x: Duty::FULL, y: Duty::ZERO };
//! ```
//!
//! Source of the block between every controller and the motors: the marking board's collision prevention
//! (spec 2.6).

use crate::kinematics::BeltSigns;
use crate::{Axis, Direction, StepPair};
use core::fmt;

/// Share of the supply on a motor, with the sign of the direction: -1.0 to 1.0, checked once when made.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Duty(f32);

/// A duty outside -1.0 to 1.0, or not a number.
#[derive(Clone, Copy, Debug, PartialEq)]
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

/// What a controller asks of both motors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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

/// What both motors get: made by [`SafetyGate::pass`] only.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drive {
    x: Duty,
    y: Duty,
}

impl Drive {
    /// The duty of the first motor.
    #[must_use]
    pub const fn x(self) -> Duty {
        self.x
    }

    /// The duty of the second motor.
    #[must_use]
    pub const fn y(self) -> Duty {
        self.y
    }

    /// The duty of the motor of `axis`.
    #[must_use]
    pub const fn axis(self, axis: Axis) -> Duty {
        match axis {
            Axis::X => self.x,
            Axis::Y => self.y,
        }
    }
}

/// A step of either motor or of both that may be made: by [`SafetyGate::pass_step`] only.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Pulse {
    x: i8,
    y: i8,
}

impl Pulse {
    /// The step of the first motor: -1, 0 or 1.
    #[must_use]
    pub const fn x(self) -> i8 {
        self.x
    }

    /// The step of the second motor: -1, 0 or 1.
    #[must_use]
    pub const fn y(self) -> i8 {
        self.y
    }
}

/// Power of a laser, in 65535ths, that may be switched on: by [`SafetyGate::pass_laser`] only; the default is off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Beam(u16);

impl Beam {
    /// No power.
    pub const OFF: Self = Self(0);

    /// The power, in 65535ths.
    #[must_use]
    pub const fn power(self) -> u16 {
        self.0
    }
}

/// Why a step may not be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Blocked {
    /// The emergency stop is latched.
    Stopped,
    /// It leads into a pressed limit switch.
    Limit {
        /// Of which axis.
        axis: Axis,
        /// At which of its ends.
        end: Direction,
    },
}

/// Which limit switches are pressed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
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
    /// Whether the switch at the end that `direction` leads to is pressed.
    #[must_use]
    #[cfg_attr(target_os = "none", inline(never))]
    pub const fn blocks(self, axis: Axis, direction: Direction) -> bool {
        self.blocks_inline(axis, direction)
    }

    /// The same where it has to be quick: for every step and every edge of an encoder.
    #[inline(always)]
    const fn blocks_inline(self, axis: Axis, direction: Direction) -> bool {
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

/// The only way from a [`Demand`] to a [`Drive`].
///
/// A pressed limit switch takes the drive *towards* it and leaves every other. The emergency stop takes all
/// drive at once and latches: letting the button go changes nothing until [`SafetyGate::reset`].
///
/// ```
/// # use plotter_motion::{Demand, Duty, LimitSwitches, SafetyGate};
/// let mut gate = SafetyGate::default();
/// let right_and_up = Demand { x: Duty::FULL, y: Duty::FULL };
///
/// gate.set_limits(LimitSwitches { x_max: true, ..LimitSwitches::default() });
/// assert_eq!(gate.pass(right_and_up).x(), Duty::ZERO); // not into the switch
/// assert_eq!(gate.pass(right_and_up).y(), Duty::FULL); // but along it
///
/// gate.emergency_stop(true);
/// gate.emergency_stop(false); // the button is let go: still stopped
/// assert_eq!(gate.pass(right_and_up).y(), Duty::ZERO);
/// assert!(gate.reset());
/// assert_eq!(gate.pass(right_and_up).y(), Duty::FULL);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SafetyGate {
    limits: LimitSwitches,
    button_pressed: bool,
    latched: bool,
    /// Whether any of them is in the way of anything: what a step is asked first.
    in_the_way: bool,
}

impl SafetyGate {
    /// Notes the state of all limit switches.
    pub const fn set_limits(&mut self, limits: LimitSwitches) {
        self.limits = limits;
        self.note();
    }

    const fn note(&mut self) {
        self.in_the_way = self.latched | self.limits.any();
    }

    /// The limit switches as last noted.
    #[must_use]
    pub const fn limits(&self) -> LimitSwitches {
        self.limits
    }

    /// Notes the emergency stop button; pressed, it latches.
    pub const fn emergency_stop(&mut self, pressed: bool) {
        self.button_pressed = pressed;
        self.latched |= pressed;
        self.note();
    }

    /// Whether the emergency stop is latched.
    #[must_use]
    pub const fn is_stopped(&self) -> bool {
        self.latched
    }

    /// Whether the emergency stop button is pressed.
    #[must_use]
    pub const fn is_button_pressed(&self) -> bool {
        self.button_pressed
    }

    /// Unlatches the emergency stop, unless the button is still pressed; says whether drive may flow again.
    pub const fn reset(&mut self) -> bool {
        self.latched = self.button_pressed;
        self.note();
        !self.latched
    }

    /// Lets through what is safe of a demand.
    #[must_use]
    pub fn pass(&self, demand: Demand) -> Drive {
        Drive { x: self.pass_axis(Axis::X, demand.x), y: self.pass_axis(Axis::Y, demand.y) }
    }

    /// The same for a machine whose two motors share a belt: `demand` is that of the *axes* (x to the right, y up), the drive
    /// is that of the *motors*.
    ///
    /// ```text
    ///   axes ──▶ towards a pressed switch? taken ──▶ mixed into motors ──▶ along a pressed switch? the motor that ──▶ Drive
    ///                                                                      pushes at it gets less
    /// ```
    ///
    /// A switch belongs to a sum of both motors, so it must be asked before they are mixed. What asks for more than the
    /// supply is made smaller as a whole, so that it keeps its direction.
    ///
    /// A move *along* a pressed switch drives one motor towards it and the other away from it, equally. If the first is the
    /// stronger one the carriage goes into the switch all the same. `unequal_share` is by how much each motor's speed may
    /// differ from their mean, 0 to 1 (NaN counts as 1): the motor that pushes gets (1 − share)/(1 + share) of what the other gets, so
    /// that whatever they are the carriage stays or retreats. Where both ends of one axis are pressed nothing can retreat,
    /// and nothing is let through.
    ///
    /// ```
    /// # use plotter_motion::{kinematics::BeltSigns, Demand, Duty, LimitSwitches, SafetyGate};
    /// let mut gate = SafetyGate::default();
    /// gate.set_limits(LimitSwitches { x_max: true, ..LimitSwitches::default() });
    /// let right_and_up = Demand { x: Duty::saturating(0.5), y: Duty::saturating(0.5) };
    /// let drive = gate.pass_belt(right_and_up, BeltSigns::DirectionTable, 0.0);
    /// assert_eq!((drive.x().value(), drive.y().value()), (-0.5, 0.5)); // up alone
    /// let careful = gate.pass_belt(right_and_up, BeltSigns::DirectionTable, 0.2);
    /// assert_eq!(careful.x().value(), -0.5);
    /// assert!((careful.y().value() - 0.5 * 0.8 / 1.2).abs() < 1e-6); // and away from the switch
    /// ```
    #[must_use]
    pub fn pass_belt(&self, demand: Demand, signs: BeltSigns, unequal_share: f32) -> Drive {
        let axes = self.pass(demand);
        let (x, y) = (axes.x.value(), axes.y.value());
        let size = (x.abs() + y.abs()).max(1.0);
        let mut motors = signs.motors(x / size, y / size);
        let share = if unequal_share.is_nan() { 1.0 } else { unequal_share.clamp(0.0, 1.0) };
        let kept = (1.0 - share) / (1.0 + share);
        // what a turn of each motor does to both axes: 1 or -1
        let (first, second) = (signs.twice_axes(1.0, 0.0), signs.twice_axes(0.0, 1.0));
        for (axis, first, second) in [(Axis::X, first.0, second.0), (Axis::Y, first.1, second.1)] {
            let ends = [Direction::Plus, Direction::Minus].map(|end| self.limits.blocks_inline(axis, end));
            let towards = match ends {
                [false, false] => continue,
                [true, true] => return Drive::default(),
                [true, false] => 1.0,
                [false, true] => -1.0,
            };
            let push = (motors.0 * first * towards, motors.1 * second * towards);
            let most = |other: f32| (-other).max(0.0) * kept;
            motors =
                (push.0.min(most(push.1)) * first * towards, push.1.min(most(push.0)) * second * towards);
        }
        Drive { x: Duty::saturating(motors.0), y: Duty::saturating(motors.1) }
    }

    /// Lets a step of stepper motors through. One that leads into a switch with either motor is not made with the other: the pen
    /// would leave its line.
    ///
    /// ```
    /// # use plotter_motion::{Axis, Blocked, Direction, LimitSwitches, SafetyGate, StepPair};
    /// let mut gate = SafetyGate::default();
    /// gate.set_limits(LimitSwitches { x_max: true, ..LimitSwitches::default() });
    /// let end = Direction::Plus;
    /// assert_eq!(gate.pass_step(StepPair { x: 1, y: 1 }), Err(Blocked::Limit { axis: Axis::X, end }));
    /// assert_eq!(gate.pass_step(StepPair { x: -1, y: 1 }).map(|pulse| pulse.x()), Ok(-1));
    /// ```
    ///
    /// # Errors
    ///
    /// [`Blocked`] says what is in the way.
    pub const fn pass_step(&self, step: StepPair) -> Result<Pulse, Blocked> {
        if !self.in_the_way {
            return Ok(Pulse { x: step.x, y: step.y });
        }
        if self.latched {
            return Err(Blocked::Stopped);
        }
        if step.x > 0 && self.limits.x_max {
            return Err(Blocked::Limit { axis: Axis::X, end: Direction::Plus });
        }
        if step.x < 0 && self.limits.x_min {
            return Err(Blocked::Limit { axis: Axis::X, end: Direction::Minus });
        }
        if step.y > 0 && self.limits.y_max {
            return Err(Blocked::Limit { axis: Axis::Y, end: Direction::Plus });
        }
        if step.y < 0 && self.limits.y_min {
            return Err(Blocked::Limit { axis: Axis::Y, end: Direction::Minus });
        }
        Ok(Pulse { x: step.x, y: step.y })
    }

    /// Lets the power of a laser through, unless the emergency stop is latched.
    #[must_use]
    pub const fn pass_laser(&self, power: u16) -> Beam {
        if self.latched { Beam::OFF } else { Beam(power) }
    }

    fn pass_axis(&self, axis: Axis, duty: Duty) -> Duty {
        let into_switch =
            duty.direction().is_some_and(|direction| self.limits.blocks_inline(axis, direction));
        if self.latched || into_switch { Duty::ZERO } else { duty }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_duty_out_of_range_is_refused_by_value() {
        assert_eq!(Duty::new(1.5), Err(DutyError { value: 1.5 }));
        assert!(Duty::new(f32::NAN).is_err());
        assert_eq!(Duty::new(-1.0).map(Duty::value), Ok(-1.0));
    }

    #[test]
    fn reset_does_nothing_while_the_button_is_pressed() {
        let mut gate = SafetyGate::default();
        gate.emergency_stop(true);
        assert!(!gate.reset());
        assert!(gate.is_stopped());
    }
}
