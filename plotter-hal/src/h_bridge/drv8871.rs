//! A DC motor on a bridge with two inputs and no enable, of the DRV8871 kind: the PWM goes to one of the
//! inputs.
//!
//! ```text
//!  IN1   IN2  │ motor                           fast decay          slow decay
//!  ─────────────────────────────────────        IN1   IN2           IN1   IN2
//!  low   low  │ coasts: both ends open     rest low   low           high  high
//!  high  low  │ turns to larger            +d   d     low           high  1 - d
//!  low   high │ turns to smaller           -d   low   d             1 - d high
//!  high  high │ brakes: short-circuited
//! ```
//!
//! Source: Texas Instruments, *DRV8871 3.6-A Brushed DC Motor Driver*, SLVSCY9B, section 7.3.1 "Bridge
//! Control", Table 1 "H-Bridge Control"; the same table in the DRV8870, SLVSCY8. The chip keeps the dead time
//! of its own transistors (220 ns, section 7.3.4).

use super::{Bridge, Error, steps};
use core::convert::Infallible;
use embedded_hal::pwm::{self, SetDutyCycle};
use plotter_motion::{Axis, Direction, Drive, Duty};

/// Path of the motor's current while the PWM is off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Decay {
    /// The motor coasts in between and at rest; the current is gone soon.
    Fast,
    /// The motor brakes in between and at rest; the speed follows the duty more closely.
    Slow,
}

crate::which_pin::which_pin! {
    /// The PWM of an input of a bridge failed.
    InputError: pwm, In1 "IN1: {}", In2 "IN2: {}"
}

/// One motor on two PWM inputs. It turns by nothing but a [`Drive`], which only a safety gate makes.
///
/// From rest to any drive, from any drive to rest, and through rest to the other direction, one input changes
/// at a time and none of these steps drives the motor elsewhere than asked. Between coast and brake there is
/// no such way: one input is always first. So each decay has its own rest, and the first drive with slow
/// decay, which begins at coast, gives the motor the whole supply in its own direction until the second input
/// is set.
///
/// The chip has no enable, so that a motor whose PWM fails twice cannot be stopped by another pin: see
/// [`Error::NotStopped`]. Dropping the driver leaves the pins as they are; [`stop`](Bridge::stop) first.
///
/// ```
/// use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as SetDuty};
/// use plotter_hal::h_bridge::{Bridge, Decay, Drv8871};
/// use plotter_motion::{Axis, Demand, Duty, LimitSwitches, SafetyGate};
///
/// let in1 = Pwm::new(&[SetDuty::max_duty_cycle(200), SetDuty::set_duty_cycle(50)]);
/// let in2 = Pwm::new(&[SetDuty::set_duty_cycle(0)]);
/// let mut motor = Drv8871::new(Axis::X, in1, in2, Decay::Fast);
/// let quarter = Demand { x: Duty::new(0.25)?, y: Duty::ZERO };
/// let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// motor.drive(gate.pass(quarter))?;
/// # let (mut in1, mut in2) = motor.release();
/// # in1.done();
/// # in2.done();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Drv8871<In1, In2> {
    axis: Axis,
    in1: In1,
    in2: In2,
    decay: Decay,
    /// The direction last driven in; `None` when the pins are not known.
    direction: Option<Direction>,
    /// At rest both inputs are high: with slow decay, from the first drive on.
    braked: bool,
}

/// What can fail at a bridge on these inputs.
type ErrorOf<In1, In2> =
    Error<Infallible, InputError<<In1 as pwm::ErrorType>::Error, <In2 as pwm::ErrorType>::Error>>;

impl<In1, In2> Drv8871<In1, In2>
where
    In1: SetDutyCycle,
    In2: SetDutyCycle,
{
    /// The motor of `axis`. Leaves the pins as they are: call [`start`](Bridge::start) for a known state.
    pub const fn new(axis: Axis, in1: In1, in2: In2, decay: Decay) -> Self {
        Self { axis, in1, in2, decay, direction: None, braked: false }
    }

    /// Gives both PWMs back, as they are: [`stop`](Bridge::stop) first.
    pub fn release(self) -> (In1, In2) {
        (self.in1, self.in2)
    }

    /// One input stays as at rest, the other one is modulated.
    fn set(&mut self, direction: Direction, duty: Duty) -> Result<(), InputError<In1::Error, In2::Error>> {
        let slow = self.decay == Decay::Slow;
        let modulates_in1 = (direction == Direction::Plus) != slow;
        if self.direction != Some(direction) {
            self.direction = None;
            if modulates_in1 {
                hold(&mut self.in2, slow).map_err(InputError::In2)?
            } else {
                hold(&mut self.in1, slow).map_err(InputError::In1)?
            }
            self.direction = Some(direction);
            self.braked = slow;
        }
        if modulates_in1 {
            modulate(&mut self.in1, duty, slow).map_err(InputError::In1)
        } else {
            modulate(&mut self.in2, duty, slow).map_err(InputError::In2)
        }
    }

    /// A PWM failed: takes the drive away, and tries each input once more for that.
    fn after_pwm(&mut self, cause: InputError<In1::Error, In2::Error>) -> ErrorOf<In1, In2> {
        self.direction = None;
        let high = self.braked;
        let in1 = hold(&mut self.in1, high).or_else(|_| hold(&mut self.in1, high));
        let in2 = hold(&mut self.in2, high).or_else(|_| hold(&mut self.in2, high));
        if in1.is_ok() && in2.is_ok() { Error::Pwm(cause) } else { Error::NotStopped(cause) }
    }
}

impl<In1, In2> Bridge for Drv8871<In1, In2>
where
    In1: SetDutyCycle,
    In2: SetDutyCycle,
{
    type Error = ErrorOf<In1, In2>;

    fn axis(&self) -> Axis {
        self.axis
    }

    /// As [`stop`](Self::stop); before the first drive, the motor coasts. Inputs that are both high when a
    /// new driver takes them over go low one after the other, which drives the motor in between; after a
    /// reset of the chip they are low.
    fn start(&mut self) -> Result<(), Self::Error> {
        self.stop()
    }

    /// A duty of 0 is [`stop`](Self::stop); every other is rounded to the nearest step of the PWM.
    fn drive(&mut self, drive: Drive) -> Result<(), Self::Error> {
        let duty = drive.axis(self.axis);
        match duty.direction() {
            Some(direction) => self.set(direction, duty).map_err(|cause| self.after_pwm(cause)),
            None => self.stop(),
        }
    }

    /// Lets the motor coast with fast decay, brakes it with slow.
    fn stop(&mut self) -> Result<(), Self::Error> {
        let in1 = hold(&mut self.in1, self.braked).map_err(InputError::In1);
        let in2 = hold(&mut self.in2, self.braked).map_err(InputError::In2);
        in1.and(in2).map_err(|cause| self.after_pwm(cause))
    }
}

/// All the time high, or low.
fn hold<Pwm: SetDutyCycle>(input: &mut Pwm, high: bool) -> Result<(), Pwm::Error> {
    if high { input.set_duty_cycle_fully_on() } else { input.set_duty_cycle_fully_off() }
}

/// High, or low with slow decay, for the share of the time that the duty says.
fn modulate<Pwm: SetDutyCycle>(input: &mut Pwm, duty: Duty, slow: bool) -> Result<(), Pwm::Error> {
    let full = input.max_duty_cycle();
    let steps = steps(duty, full);
    input.set_duty_cycle(if slow { full.saturating_sub(steps) } else { steps })
}
