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

mod duty;
mod passed;
mod switches;

pub use duty::{Demand, Duty, DutyError};
pub use passed::{Beam, Drive, Pulse};
#[cfg(feature = "third-motor")]
pub use switches::EndSwitches;
pub use switches::{Blocked, LimitSwitches};

use crate::kinematics::BeltSigns;
use crate::{Axis, Direction, StepPair};
#[cfg(feature = "third-motor")]
use passed::drive_z;
use passed::{beam, drive, pulse};

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
        let (x, y) = (axes.x().value(), axes.y().value());
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
        Ok(pulse(step).with_second(free_second))
    }

    /// Notes the limit switches of a third axis; until then none of them is pressed.
    #[cfg(feature = "third-motor")]
    pub const fn set_z_limits(&mut self, switches: EndSwitches) {
        self.z = switches;
    }

    /// Lets what a DC motor of a third axis is to get through: not into a pressed switch of its axis, nor
    /// while the machine is stopped.
    ///
    /// ```
    /// # use plotter_motion::{Axis, Duty, LimitSwitches, SafetyGate, safety::EndSwitches};
    /// let mut gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    /// gate.set_z_limits(EndSwitches { upper: true, lower: false });
    /// let [up, down] = [Duty::new(0.5)?, Duty::new(-0.5)?];
    /// assert_eq!((gate.pass_z(up).z(), gate.pass_z(down).z()), (Duty::ZERO, down));
    /// assert_eq!(gate.pass_z(down).of_z(Axis::Y).y(), down);
    /// gate.emergency_stop(true);
    /// assert_eq!(gate.pass_z(down).z(), Duty::ZERO);
    /// # Ok::<(), plotter_motion::safety::DutyError>(())
    /// ```
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub fn pass_z(&self, duty: Duty) -> Drive<'_> {
        let into_switch = match duty.direction() {
            Some(Direction::Plus) => self.z.upper,
            Some(Direction::Minus) => self.z.lower,
            None => false,
        };
        drive_z(if self.stopped || into_switch { Duty::ZERO } else { duty })
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
        Ok(pulse(StepPair { x: 0, y: 0 }).with_z(step.signum()))
    }

    /// Lets the power of a laser through, unless the machine is stopped.
    #[must_use]
    pub const fn pass_laser(&self, power: u16) -> Beam<'_> {
        if self.stopped { Beam::OFF } else { beam(power) }
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
