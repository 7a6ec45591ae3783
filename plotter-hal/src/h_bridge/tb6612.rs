//! A DC motor on one channel of a bridge of the TB6612FNG kind: PWM, two inputs and a standby.
//!
//! ```text
//!  STBY  IN1   IN2   PWM  │ motor
//!  ──────────────────────────────────────────────────
//!  high  high  low   high │ turns to larger coordinates
//!  high  low   high  high │ turns to smaller coordinates
//!  high  one of them low  │ brakes: short-circuited
//!  high  high  high  any  │ brakes
//!  high  low   low   high │ coasts: both ends open
//!  low   any   any   any  │ coasts
//! ```
//!
//! Unlike with an L293D, a motor without duty brakes: the chip does so in each period of the PWM.
//!
//! Source: Toshiba, *TB6612FNG Driver IC for Dual DC motor*, 2014-10-01, page 4, "H-SW Control Function".

use super::{Bridge, Error, steps};
use crate::NoPin;
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use plotter_motion::{Axis, Direction, Drive};

crate::which_pin::which_pin! {
    /// A pin of a [`Tb6612`] failed.
    Tb6612PinError: digital, In1 "IN1: {}", In2 "IN2: {}", Stby "STBY: {}"
}

/// One motor on a channel with PWM, IN1, IN2 and STBY. It turns by nothing but a [`Drive`], which only a
/// safety gate makes.
///
/// The direction is never changed under duty, and both inputs are never high together. STBY belongs to both
/// channels of the chip: [give it](Self::with_standby) to one of two motors, and that one's fault stops both.
///
/// Dropping the driver leaves the pins as they are; [`stop`](Bridge::stop) first.
///
/// ```
/// use embedded_hal_mock::eh1::digital::{Mock as Pin, State::{High, Low}, Transaction as Set};
/// use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as SetDuty};
/// use plotter_hal::h_bridge::{Bridge, Tb6612};
/// use plotter_motion::{Axis, Demand, Duty, LimitSwitches, SafetyGate};
///
/// let pwm = Pwm::new(&[SetDuty::set_duty_cycle(0), SetDuty::max_duty_cycle(200), SetDuty::set_duty_cycle(50)]);
/// let (in1, in2) = (Pin::new(&[Set::set(High)]), Pin::new(&[Set::set(Low)]));
/// let stby = Pin::new(&[Set::set(High)]);
/// let mut motor = Tb6612::new(Axis::X, pwm, in1, in2).with_standby(stby);
/// let quarter = Demand { x: Duty::new(0.25)?, y: Duty::ZERO };
/// let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// motor.drive(gate.pass(quarter))?;
/// # let (mut pwm, mut in1, mut in2, mut stby) = motor.release();
/// # pwm.done();
/// # in1.done();
/// # in2.done();
/// # stby.done();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tb6612<Pwm, In1, In2, Stby> {
    axis: Axis,
    pwm: Pwm,
    in1: In1,
    in2: In2,
    stby: Stby,
    has_stby: bool,
    /// What the inputs say; `None` when that is not known, or no direction.
    direction: Option<Direction>,
}

impl<Pwm, In1, In2> Tb6612<Pwm, In1, In2, NoPin> {
    /// The motor of `axis` on a board that has STBY wired high. Leaves the pins as they are: call
    /// [`start`](Bridge::start) for a known state.
    pub const fn new(axis: Axis, pwm: Pwm, in1: In1, in2: In2) -> Self {
        Self { axis, pwm, in1, in2, stby: NoPin, has_stby: false, direction: None }
    }

    /// With a pin on STBY: the second way to stop the motor, when its PWM or an input fails.
    pub fn with_standby<Stby>(self, stby: Stby) -> Tb6612<Pwm, In1, In2, Stby> {
        let Self { axis, pwm, in1, in2, direction, .. } = self;
        Tb6612 { axis, pwm, in1, in2, stby, has_stby: true, direction }
    }
}

/// What can fail at these pins.
type PinErrorOf<In1, In2, Stby> = Tb6612PinError<
    <In1 as digital::ErrorType>::Error,
    <In2 as digital::ErrorType>::Error,
    <Stby as digital::ErrorType>::Error,
>;

/// What can fail at a bridge on these pins.
type ErrorOf<Pwm, In1, In2, Stby> = Error<PinErrorOf<In1, In2, Stby>, <Pwm as pwm::ErrorType>::Error>;

impl<Pwm, In1, In2, Stby> Tb6612<Pwm, In1, In2, Stby>
where
    Pwm: SetDutyCycle,
    In1: OutputPin,
    In2: OutputPin,
    Stby: OutputPin,
{
    /// Lets the motor coast: no duty, both inputs low, and the PWM high, which without a direction drives
    /// nothing.
    ///
    /// # Errors
    ///
    /// [`Error`] if a pin or the PWM fails; it says what became of the motor.
    pub fn coast(&mut self) -> Result<(), ErrorOf<Pwm, In1, In2, Stby>> {
        self.stop()?;
        self.both_low().map_err(|cause| self.after_pin(cause))?;
        self.pwm.set_duty_cycle_fully_on().map_err(|cause| self.after_pwm(cause))
    }

    /// Gives the PWM, both inputs and STBY back, as they are: [`stop`](Bridge::stop) first.
    pub fn release(self) -> (Pwm, In1, In2, Stby) {
        (self.pwm, self.in1, self.in2, self.stby)
    }

    /// Sets the inputs; the duty has been taken away.
    fn turn_to(&mut self, direction: Direction) -> Result<(), PinErrorOf<In1, In2, Stby>> {
        // A fault may have left the chip in standby.
        if self.direction.take().is_none() {
            self.stby.set_high().map_err(Tb6612PinError::Stby)?;
        }
        match direction {
            Direction::Plus => {
                self.in2.set_low().map_err(Tb6612PinError::In2)?;
                self.in1.set_high().map_err(Tb6612PinError::In1)?;
            }
            Direction::Minus => {
                self.in1.set_low().map_err(Tb6612PinError::In1)?;
                self.in2.set_high().map_err(Tb6612PinError::In2)?;
            }
        }
        self.direction = Some(direction);
        Ok(())
    }

    /// Both inputs low, and the second one also when the first one fails.
    fn both_low(&mut self) -> Result<(), PinErrorOf<In1, In2, Stby>> {
        self.direction = None;
        let in1 = self.in1.set_low().map_err(Tb6612PinError::In1);
        let in2 = self.in2.set_low().map_err(Tb6612PinError::In2);
        in1.and(in2)
    }

    /// An input failed: makes sure of the duty.
    fn after_pin(&mut self, cause: PinErrorOf<In1, In2, Stby>) -> ErrorOf<Pwm, In1, In2, Stby> {
        self.direction = None;
        match self.pwm.set_duty_cycle_fully_off() {
            Ok(()) => Error::Pin(cause),
            Err(cause) => self.after_pwm(cause),
        }
    }

    /// The PWM failed: tries it once more, then takes the direction away, then the chip's power.
    fn after_pwm(&mut self, cause: Pwm::Error) -> ErrorOf<Pwm, In1, In2, Stby> {
        self.direction = None;
        if self.pwm.set_duty_cycle_fully_off().is_ok() || self.both_low().is_ok() || self.stand_by() {
            Error::Pwm(cause)
        } else {
            Error::NotStopped(cause)
        }
    }

    fn stand_by(&mut self) -> bool {
        self.has_stby && self.stby.set_low().is_ok()
    }
}

impl<Pwm, In1, In2, Stby> Bridge for Tb6612<Pwm, In1, In2, Stby>
where
    Pwm: SetDutyCycle,
    In1: OutputPin,
    In2: OutputPin,
    Stby: OutputPin,
{
    type Error = ErrorOf<Pwm, In1, In2, Stby>;

    fn axis(&self) -> Axis {
        self.axis
    }

    /// No duty, both inputs low, out of standby.
    fn start(&mut self) -> Result<(), Self::Error> {
        self.stop()?;
        self.both_low().map_err(|cause| self.after_pin(cause))?;
        self.stby.set_high().map_err(|cause| self.after_pin(Tb6612PinError::Stby(cause)))
    }

    /// A duty of 0 brakes; every other is rounded to the nearest step of the PWM.
    fn drive(&mut self, drive: Drive) -> Result<(), Self::Error> {
        let duty = drive.axis(self.axis);
        let Some(direction) = duty.direction() else { return self.stop() };
        if self.direction != Some(direction) {
            self.stop()?;
            self.turn_to(direction).map_err(|cause| self.after_pin(cause))?;
        }
        let steps = steps(duty, self.pwm.max_duty_cycle());
        self.pwm.set_duty_cycle(steps).map_err(|cause| self.after_pwm(cause))
    }

    /// Takes the duty away: the motor brakes.
    fn stop(&mut self) -> Result<(), Self::Error> {
        self.pwm.set_duty_cycle_fully_off().map_err(|cause| self.after_pwm(cause))
    }
}
