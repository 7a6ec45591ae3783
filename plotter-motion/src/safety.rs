//! From what a controller wants to what a motor gets: [`Demand`] -> [`SafetyGate::pass`] -> [`Drive`].
//!
//! ```text
//!  controller ──Demand──▶ SafetyGate ──Drive──▶ H-bridge, laser, simulated motor
//!            ──StepPair──▶          ──Pulse──▶ step and direction pins
//!                          ▲      ▲
//!            limit switches       emergency stop (latched), the host's stop
//! ```
//!
//! Drivers take nothing but a [`Drive`], a [`Pulse`] or a [`Beam`]. Only a gate makes one, and a gate is made
//! from readings of the machine's switches and its stop button. So a program that goes round the limit
//! switches does not compile:
//!
//! ```
//! # use plotter_motion::{Demand, Duty, LimitSwitches, SafetyGate};
//! let right = Demand { x: Duty::FULL, y: Duty::ZERO };
//! let mut gate = SafetyGate::new(LimitSwitches::RELEASED, false);
//! let drive = gate.pass(right);
//! assert_eq!(drive.x(), Duty::FULL);
//! gate.emergency_stop(true);
//! let drive = gate.pass(right);
//! assert_eq!(drive.x(), Duty::ZERO);
//! ```
//!
//! A drive that no gate has passed:
//!
//! ```compile_fail
//! # use plotter_motion::{Drive, Duty};
//! let forged = Drive { x: Duty::FULL, y: Duty::ZERO };
//! ```
//!
//! A gate that knows nothing of the machine:
//!
//! ```compile_fail,E0599
//! # use plotter_motion::SafetyGate;
//! let gate = SafetyGate::default();
//! ```
//!
//! A copy of a gate, which would not hear of a later stop:
//!
//! ```compile_fail,E0599
//! # use plotter_motion::{LimitSwitches, SafetyGate};
//! let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
//! let copy = gate.clone();
//! ```
//!
//! ```compile_fail,E0382
//! # use plotter_motion::{Demand, LimitSwitches, SafetyGate};
//! let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
//! let mut copy = gate;
//! copy.emergency_stop(true);
//! let drive = gate.pass(Demand::NONE);
//! ```
//!
//! A drive, a step or a beam from before a stop, in use after it: each borrows its gate, so it ends when the
//! gate is told anything.
//!
//! ```compile_fail,E0502
//! # use plotter_motion::{Demand, Duty, LimitSwitches, SafetyGate};
//! # let right = Demand { x: Duty::FULL, y: Duty::ZERO };
//! # let mut gate = SafetyGate::new(LimitSwitches::RELEASED, false);
//! let drive = gate.pass(right);
//! gate.emergency_stop(true);
//! assert_eq!(drive.x(), Duty::FULL);
//! ```
//!
//! ```compile_fail,E0502
//! # use plotter_motion::{LimitSwitches, SafetyGate, StepPair};
//! # let mut gate = SafetyGate::new(LimitSwitches::RELEASED, false);
//! let pulse = gate.pass_step(StepPair { x: 1, y: 0 });
//! gate.set_limits(LimitSwitches { x_max: true, ..LimitSwitches::RELEASED });
//! assert!(pulse.is_ok());
//! ```
//!
//! ```compile_fail,E0502
//! # use plotter_motion::{LimitSwitches, SafetyGate};
//! # let mut gate = SafetyGate::new(LimitSwitches::RELEASED, false);
//! let beam = gate.pass_laser(65_535);
//! gate.stop_by_host(true);
//! assert_eq!(beam.power(), 65_535);
//! ```
//!
//! No type can see whether the readings are true. A program gets what it should not have if it makes a gate
//! from switches that it has not read, if it makes a second gate beside the one that is told of them, or if
//! it does not tell the gate what changed.
//!
//! The block between every controller and the motors is the collision prevention of the marking board.
//! Source: Khan and McGinn, "2D Controlled Marking Board", section 0.3.

use crate::kinematics::BeltSigns;
use crate::{Axis, Direction, StepPair};
use core::fmt;
use core::marker::PhantomData;

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

/// What a controller asks of both motors.
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

/// What both motors get: made by [`SafetyGate::pass`] only. It ends when its gate is told anything; the
/// default is none at all.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Drive<'gate> {
    x: Duty,
    y: Duty,
    gate: PhantomData<&'gate SafetyGate>,
}

impl Drive<'_> {
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

    /// Those of both motors.
    #[must_use]
    pub const fn duties(self) -> [Duty; 2] {
        [self.x, self.y]
    }

    /// The same without its end: for a controller that keeps its gate in the same place, and passes the
    /// demand again whenever it tells the gate anything. It lends the drive no longer than itself.
    pub(crate) const fn kept(self) -> Drive<'static> {
        drive(self.x, self.y)
    }
}

const fn drive(x: Duty, y: Duty) -> Drive<'static> {
    Drive { x, y, gate: PhantomData }
}

/// A step of either motor or of both that may be made: by [`SafetyGate::pass_step`] only. It ends when its
/// gate is told anything.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pulse<'gate> {
    x: i8,
    y: i8,
    #[cfg(feature = "third-motor")]
    z: i8,
    /// What the second motor of an axis makes, where that is not what the first makes.
    #[cfg(feature = "third-motor")]
    apart: Option<i8>,
    gate: PhantomData<&'gate SafetyGate>,
}

impl Pulse<'_> {
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

    /// The step of a third motor: -1, 0 or 1. It comes alone.
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub const fn z(self) -> i8 {
        self.z
    }

    /// The step of the second motor of an axis that has two: that of the first, but where both are made
    /// square.
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub const fn second(self, axis: Axis) -> i8 {
        match (self.apart, axis) {
            (Some(step), _) => step,
            (None, Axis::X) => self.x,
            (None, Axis::Y) => self.y,
        }
    }

    /// The share of a third axis, as the driver of an axis takes it.
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub const fn of_z(self, axis: Axis) -> Self {
        self.alone(axis, self.z)
    }

    /// The share of the second motor of an axis, as the driver of that axis takes it.
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub const fn of_second(self, axis: Axis) -> Self {
        self.alone(axis, self.second(axis))
    }

    #[cfg(feature = "third-motor")]
    const fn alone(self, axis: Axis, step: i8) -> Self {
        let (x, y) = match axis {
            Axis::X => (step, 0),
            Axis::Y => (0, step),
        };
        Self { x, y, z: 0, apart: None, gate: self.gate }
    }

    /// As [`Drive::kept`].
    pub(crate) const fn kept(self) -> Pulse<'static> {
        Pulse {
            x: self.x,
            y: self.y,
            #[cfg(feature = "third-motor")]
            z: self.z,
            #[cfg(feature = "third-motor")]
            apart: self.apart,
            gate: PhantomData,
        }
    }
}

impl From<Pulse<'_>> for StepPair {
    fn from(pulse: Pulse<'_>) -> Self {
        Self { x: pulse.x, y: pulse.y }
    }
}

const fn pulse(step: StepPair) -> Pulse<'static> {
    Pulse {
        x: step.x,
        y: step.y,
        #[cfg(feature = "third-motor")]
        z: 0,
        #[cfg(feature = "third-motor")]
        apart: None,
        gate: PhantomData,
    }
}

/// Power of a laser, in 65535ths, that may be switched on: by [`SafetyGate::pass_laser`] only. It ends when
/// its gate is told anything; the default is off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Beam<'gate> {
    power: u16,
    gate: PhantomData<&'gate SafetyGate>,
}

impl Beam<'_> {
    /// No power.
    pub const OFF: Self = Self { power: 0, gate: PhantomData };

    /// The power, in 65535ths.
    #[must_use]
    pub const fn power(self) -> u16 {
        self.power
    }

    /// As [`Drive::kept`].
    pub(crate) const fn kept(self) -> Beam<'static> {
        Beam { power: self.power, gate: PhantomData }
    }
}

/// Why a step may not be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Blocked {
    /// The emergency stop is latched, or the host has stopped the machine.
    Stopped,
    /// It leads into a pressed limit switch.
    Limit {
        /// Of which axis.
        axis: Axis,
        /// At which of its ends.
        end: Direction,
    },
    /// A step of a third motor leads into a pressed limit switch of its axis.
    #[cfg(feature = "third-motor")]
    LimitZ {
        /// At which of its ends.
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

/// Which limit switches are pressed.
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

/// Which limit switches of a third axis, or of the second motor of an axis, are pressed. Of those that a machine
/// does not have, none is.
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
    const fn lets(self, step: i8) -> i8 {
        match step.signum() {
            1 if self.upper => 0,
            -1 if self.lower => 0,
            sign => sign,
        }
    }
}

/// The only way from a [`Demand`] to a [`Drive`].
///
/// A pressed limit switch takes the drive *towards* it and leaves every other. The emergency stop takes all
/// drive at once and latches: letting the button go changes nothing until [`SafetyGate::reset`]. The host's
/// stop takes all drive until the host takes it back. Neither ends the other.
///
/// A machine has one gate. It is made when switches and button have been read, it moves, and it is not
/// copied.
///
/// ```
/// # use plotter_motion::{Demand, Duty, LimitSwitches, SafetyGate};
/// let mut gate = SafetyGate::new(LimitSwitches { x_max: true, ..LimitSwitches::RELEASED }, false);
/// let right_and_up = Demand { x: Duty::FULL, y: Duty::FULL };
/// assert_eq!(gate.pass(right_and_up).x(), Duty::ZERO); // not into the switch
/// assert_eq!(gate.pass(right_and_up).y(), Duty::FULL); // but along it
///
/// gate.emergency_stop(true);
/// gate.emergency_stop(false); // the button is let go: still stopped
/// assert_eq!(gate.pass(right_and_up).y(), Duty::ZERO);
/// assert!(gate.reset());
/// assert_eq!(gate.pass(right_and_up).y(), Duty::FULL);
///
/// gate.stop_by_host(true);
/// assert_eq!(gate.pass(right_and_up).y(), Duty::ZERO);
/// gate.stop_by_host(false);
/// assert_eq!(gate.pass(right_and_up).y(), Duty::FULL);
/// ```
#[derive(Debug, PartialEq, Eq)]
pub struct SafetyGate {
    limits: LimitSwitches,
    #[cfg(feature = "third-motor")]
    z: EndSwitches,
    /// Those of the second motor of an axis.
    #[cfg(feature = "third-motor")]
    second: Option<(Axis, EndSwitches)>,
    button_pressed: bool,
    latched: bool,
    stopped_by_host: bool,
    /// Whether either of both stops is in force.
    stopped: bool,
    /// Whether anything is in the way of anything: what a step is asked first.
    in_the_way: bool,
}

impl SafetyGate {
    /// The gate of a machine, from what its limit switches and its emergency stop button say now. A button
    /// that is pressed, or that has not been read yet, latches from the start. A machine without switches or
    /// without a button says so by [`LimitSwitches::RELEASED`] and `false`.
    ///
    /// ```
    /// # use plotter_motion::{LimitSwitches, SafetyGate, StepPair, safety::Blocked};
    /// let gate = SafetyGate::new(LimitSwitches::RELEASED, true);
    /// assert_eq!(gate.pass_step(StepPair { x: 1, y: 0 }), Err(Blocked::Stopped));
    /// ```
    #[must_use]
    pub const fn new(limits: LimitSwitches, button_pressed: bool) -> Self {
        let mut gate = Self {
            limits,
            #[cfg(feature = "third-motor")]
            z: EndSwitches { lower: false, upper: false },
            #[cfg(feature = "third-motor")]
            second: None,
            button_pressed,
            latched: button_pressed,
            stopped_by_host: false,
            stopped: false,
            in_the_way: false,
        };
        gate.note();
        gate
    }

    /// Notes the state of all limit switches.
    pub const fn set_limits(&mut self, limits: LimitSwitches) {
        self.limits = limits;
        self.note();
    }

    const fn note(&mut self) {
        self.stopped = self.latched | self.stopped_by_host;
        self.in_the_way = self.stopped | self.limits.any();
        #[cfg(feature = "third-motor")]
        if let Some((_, switches)) = self.second {
            self.in_the_way |= switches.lower | switches.upper;
        }
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

    /// Notes whether the host wants the machine to be stopped. It takes back its own stop only.
    pub const fn stop_by_host(&mut self, stopped: bool) {
        self.stopped_by_host = stopped;
        self.note();
    }

    /// Whether all drive is taken: the emergency stop is latched, or the host has stopped the machine.
    #[must_use]
    pub const fn is_stopped(&self) -> bool {
        self.stopped
    }

    /// Whether the emergency stop of the button is latched.
    #[must_use]
    pub const fn is_latched(&self) -> bool {
        self.latched
    }

    /// Whether the emergency stop button is pressed.
    #[must_use]
    pub const fn is_button_pressed(&self) -> bool {
        self.button_pressed
    }

    /// Unlatches the emergency stop, unless the button is still pressed; says whether it did. The host's stop
    /// stays.
    pub const fn reset(&mut self) -> bool {
        self.latched = self.button_pressed;
        self.note();
        !self.latched
    }

    /// Lets through what is safe of a demand.
    #[must_use]
    pub fn pass(&self, demand: Demand) -> Drive<'_> {
        drive(self.pass_axis(Axis::X, demand.x), self.pass_axis(Axis::Y, demand.y))
    }

    /// The same for a machine whose two motors share a belt: `demand` is that of the *axes* (x to the right,
    /// y up), the drive is that of the *motors*.
    ///
    /// ```text
    ///   axes ──▶ towards a pressed switch? taken ──▶ mixed into motors ──▶ along a pressed switch? the motor that ──▶ Drive
    ///                                                                      pushes at it gets less
    /// ```
    ///
    /// A switch belongs to a sum of both motors, so it must be asked before they are mixed. What asks for
    /// more than the supply is made smaller as a whole, so that it keeps its direction.
    ///
    /// A move *along* a pressed switch drives one motor towards it and the other away from it, equally. If
    /// the first is the stronger one the carriage goes into the switch all the same. `unequal_share` is by
    /// how much each motor's speed may differ from their mean, 0 to 1 (NaN counts as 1): the motor that
    /// pushes gets (1 − share)/(1 + share) of what the other gets, so that whatever they are the carriage
    /// stays or retreats. Where both ends of one axis are pressed nothing can retreat, and nothing is let
    /// through.
    ///
    /// ```
    /// # use plotter_motion::{Demand, Duty, LimitSwitches, SafetyGate, kinematics::BeltSigns};
    /// let gate = SafetyGate::new(LimitSwitches { x_max: true, ..LimitSwitches::RELEASED }, false);
    /// let right_and_up = Demand { x: Duty::saturating(0.5), y: Duty::saturating(0.5) };
    /// let drive = gate.pass_belt(right_and_up, BeltSigns::DirectionTable, 0.0);
    /// assert_eq!((drive.x().value(), drive.y().value()), (-0.5, 0.5)); // up alone
    /// let careful = gate.pass_belt(right_and_up, BeltSigns::DirectionTable, 0.2);
    /// assert_eq!(careful.x().value(), -0.5);
    /// assert!((careful.y().value() - 0.5 * 0.8 / 1.2).abs() < 1e-6); // and away from the switch
    /// ```
    #[must_use]
    pub fn pass_belt(&self, demand: Demand, signs: BeltSigns, unequal_share: f32) -> Drive<'_> {
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
        drive(Duty::saturating(motors.0), Duty::saturating(motors.1))
    }

    /// Lets a step of stepper motors through. One that leads into a switch with either motor is not made with
    /// the other: the pen would leave its line.
    ///
    /// ```
    /// # use plotter_motion::{Axis, Direction, LimitSwitches, SafetyGate, StepPair, safety::Blocked};
    /// let gate = SafetyGate::new(LimitSwitches { x_max: true, ..LimitSwitches::RELEASED }, false);
    /// let end = Direction::Plus;
    /// assert_eq!(gate.pass_step(StepPair { x: 1, y: 1 }), Err(Blocked::Limit { axis: Axis::X, end }));
    /// assert_eq!(gate.pass_step(StepPair { x: -1, y: 1 }).map(|pulse| pulse.x()), Ok(-1));
    /// ```
    ///
    /// # Errors
    ///
    /// [`Blocked`] says what is in the way.
    pub const fn pass_step(&self, step: StepPair) -> Result<Pulse<'_>, Blocked> {
        if !self.in_the_way {
            return Ok(pulse(step));
        }
        if self.stopped {
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
        #[cfg(feature = "third-motor")]
        if let Some((axis, switches)) = self.second {
            let step = match axis {
                Axis::X => step.x,
                Axis::Y => step.y,
            };
            if step > 0 && switches.upper {
                return Err(Blocked::Limit { axis, end: Direction::Plus });
            }
            if step < 0 && switches.lower {
                return Err(Blocked::Limit { axis, end: Direction::Minus });
            }
        }
        Ok(pulse(step))
    }

    /// Notes the limit switches of the second motor of an axis that has two.
    #[cfg(feature = "third-motor")]
    pub const fn set_second_limits(&mut self, axis: Axis, switches: EndSwitches) {
        self.second = Some((axis, switches));
        self.note();
    }

    /// The limit switches of the second motor of an axis as last noted.
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub const fn second_limits(&self) -> EndSwitches {
        match self.second {
            Some((_, switches)) => switches,
            None => EndSwitches { lower: false, upper: false },
        }
    }

    /// Lets steps of both motors of an axis through, each for itself: a motor that its own pressed switch is
    /// in the way of makes none, and the other one does.
    ///
    /// ```
    /// # use plotter_motion::{Axis, LimitSwitches, SafetyGate, safety::EndSwitches};
    /// let mut gate = SafetyGate::new(LimitSwitches { y_min: true, ..LimitSwitches::RELEASED }, false);
    /// gate.set_second_limits(Axis::Y, EndSwitches::default());
    /// let pulse = gate.pass_apart(Axis::Y, [-1, -1]).map_err(|_| "stopped")?;
    /// assert_eq!((pulse.x(), pulse.y(), pulse.second(Axis::Y)), (0, 0, -1));
    /// # Ok::<(), &str>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Blocked`] says what is in the way of both.
    #[cfg(feature = "third-motor")]
    pub const fn pass_apart(&self, axis: Axis, [first, second]: [i8; 2]) -> Result<Pulse<'_>, Blocked> {
        if self.stopped {
            return Err(Blocked::Stopped);
        }
        let own = EndSwitches {
            lower: self.limits.blocks_inline(axis, Direction::Minus),
            upper: self.limits.blocks_inline(axis, Direction::Plus),
        };
        let (free, free_second) = (own.lets(first), self.second_limits().lets(second));
        if free == 0 && free_second == 0 && (first != 0 || second != 0) {
            let end = if first + second > 0 { Direction::Plus } else { Direction::Minus };
            return Err(Blocked::Limit { axis, end });
        }
        let step = match axis {
            Axis::X => StepPair { x: free, y: 0 },
            Axis::Y => StepPair { x: 0, y: free },
        };
        Ok(Pulse { apart: Some(free_second), ..pulse(step) })
    }

    /// Notes the limit switches of a third axis; until then none of them is pressed.
    #[cfg(feature = "third-motor")]
    pub const fn set_z_limits(&mut self, switches: EndSwitches) {
        self.z = switches;
    }

    /// The limit switches of a third axis as last noted.
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub const fn z_limits(&self) -> EndSwitches {
        self.z
    }

    /// Lets a step of a third motor through, 1 upwards and -1 downwards: not into a pressed switch of its
    /// axis, nor while the machine is stopped.
    ///
    /// ```
    /// # use plotter_motion::{Direction, LimitSwitches, SafetyGate, safety::{Blocked, EndSwitches}};
    /// let mut gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    /// gate.set_z_limits(EndSwitches { upper: true, lower: false });
    /// assert_eq!(gate.pass_z_step(1), Err(Blocked::LimitZ { end: Direction::Plus }));
    /// assert_eq!(gate.pass_z_step(-1).map(|pulse| (pulse.x(), pulse.y(), pulse.z())), Ok((0, 0, -1)));
    /// ```
    ///
    /// # Errors
    ///
    /// [`Blocked`] says what is in the way.
    #[cfg(feature = "third-motor")]
    pub const fn pass_z_step(&self, step: i8) -> Result<Pulse<'_>, Blocked> {
        if self.stopped {
            return Err(Blocked::Stopped);
        }
        if step > 0 && self.z.upper {
            return Err(Blocked::LimitZ { end: Direction::Plus });
        }
        if step < 0 && self.z.lower {
            return Err(Blocked::LimitZ { end: Direction::Minus });
        }
        Ok(Pulse { z: step.signum(), ..pulse(StepPair { x: 0, y: 0 }) })
    }

    /// Lets the power of a laser through, unless the machine is stopped.
    #[must_use]
    pub const fn pass_laser(&self, power: u16) -> Beam<'_> {
        if self.stopped { Beam::OFF } else { Beam { power, gate: PhantomData } }
    }

    fn pass_axis(&self, axis: Axis, duty: Duty) -> Duty {
        let into_switch =
            duty.direction().is_some_and(|direction| self.limits.blocks_inline(axis, direction));
        if self.stopped || into_switch { Duty::ZERO } else { duty }
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

    const RIGHT_AND_UP: Demand = Demand { x: Duty::FULL, y: Duty::FULL };
    const STEP: StepPair = StepPair { x: 1, y: 1 };

    fn flows(gate: &SafetyGate) -> bool {
        let by = [
            gate.pass(RIGHT_AND_UP) != Drive::default(),
            gate.pass_belt(RIGHT_AND_UP, BeltSigns::DirectionTable, 0.0) != Drive::default(),
            gate.pass_step(STEP) != Err(Blocked::Stopped),
            gate.pass_laser(u16::MAX) != Beam::OFF,
        ];
        assert!(by.iter().all(|&flows| flows == by[0]), "{gate:?}: {by:?}");
        by[0]
    }

    #[test]
    fn a_gate_knows_from_the_start_what_it_is_made_from() {
        let x_max = LimitSwitches { x_max: true, ..LimitSwitches::RELEASED };
        let gate = SafetyGate::new(x_max, false);
        assert_eq!(gate.pass(RIGHT_AND_UP).duties(), [Duty::ZERO, Duty::FULL]);
        assert_eq!(gate.pass_step(STEP), Err(Blocked::Limit { axis: Axis::X, end: Direction::Plus }));
        assert!(flows(&SafetyGate::new(LimitSwitches::RELEASED, false)));
        assert!(!flows(&SafetyGate::new(LimitSwitches::RELEASED, true)));
    }

    #[test]
    fn reset_does_nothing_while_the_button_is_pressed() {
        let mut gate = SafetyGate::new(LimitSwitches::RELEASED, true);
        assert!(!gate.reset());
        assert!(gate.is_stopped());
        gate.emergency_stop(false);
        assert!(!flows(&gate) && gate.reset() && flows(&gate));
    }

    #[test]
    fn each_side_takes_back_its_own_stop_only() {
        let mut gate = SafetyGate::new(LimitSwitches::RELEASED, false);
        gate.stop_by_host(true);
        assert!(!flows(&gate) && gate.is_stopped() && !gate.is_latched());
        assert!(gate.reset()); // nothing is latched, and the host's stop stays
        assert!(!flows(&gate));
        gate.emergency_stop(true);
        gate.emergency_stop(false);
        gate.stop_by_host(false);
        assert!(!flows(&gate) && gate.is_latched());
        assert!(gate.reset() && flows(&gate));
    }
}
