//! A DC motor on an H-bridge of the L293D kind: an enable pin for the duty, two pins for the direction.
//!
//! ```text
//!              ┌─────────────┐        enable  forward  reverse │ motor
//!  PWM ────────┤ 1,2EN       │        ────────────────────────────────────────────────
//!  forward ────┤ 1A       1Y ├──┐      low     any      any    │ coasts: both ends open
//!              │             │ (M)     high    high     low    │ turns to larger coordinates
//!  reverse ────┤ 2A       2Y ├──┘      high    low      high   │ turns to smaller coordinates
//!              └─────────────┘         high    low      low    │ brakes: its ends short-circuited
//! ```
//!
//! Source: Texas Instruments, *L293x Quadruple Half-H Drivers*, SLRS008D, "Bidirectional DC Motor Control"
//! and its table. The thesis on the semi-virtual gantry wires it so, and runs the PWM at 2.5 kHz (sections
//! 6.3, 6.7).
//!
//! Bridges of other kinds: [`Drv8871`] with a PWM on either input, [`Drv8833`] and [`Bts7960`] with that and
//! a pin that switches them off, [`Tb6612`] with a PWM, two inputs and a standby. What all have in common is
//! a [`Bridge`]; [`DeadTime`] makes any of them wait before it reverses.

mod dead_time;
mod drv8871;
mod switched;
mod tb6612;

pub use dead_time::DeadTime;
pub use drv8871::{Decay, Drv8871, InputError};
pub use switched::{Bts7960, Drv8833, EnablePinError, SleepPinError};
pub use tb6612::{Tb6612, Tb6612PinError};

use core::fmt;
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use plotter_motion::{Axis, Direction, Drive, Duty};

/// A DC motor on a bridge of any kind.
pub trait Bridge {
    /// What can fail.
    type Error;

    /// The axis whose share of a [`Drive`] this motor takes.
    fn axis(&self) -> Axis;

    /// Brings all pins into a known state in which the motor has no drive, whatever was before.
    ///
    /// # Errors
    ///
    /// Those of the bridge, which say what became of the motor.
    fn start(&mut self) -> Result<(), Self::Error>;

    /// Gives the motor its share of a drive.
    ///
    /// # Errors
    ///
    /// Those of the bridge, which say what became of the motor.
    fn drive(&mut self, drive: Drive) -> Result<(), Self::Error>;

    /// Takes the drive away.
    ///
    /// # Errors
    ///
    /// Those of the bridge, which say what became of the motor.
    fn stop(&mut self) -> Result<(), Self::Error>;
}

/// One motor on an H-bridge. It turns by nothing but a [`Drive`], which only a safety gate makes.
///
/// The direction is never changed under duty: first the duty is taken away, then the pin that was high goes
/// low, then the other one goes high, and only then the new duty is set. So the supply is never reversed on a
/// motor that is being driven, and both inputs are never high together. (A timer that buffers its compare
/// value takes the zero over at the end of its period; a PWM that must stop at once has to be set up without
/// that buffer.)
///
/// Between the pulses, and at rest, the motor coasts. A controller must know that: write the PWM's frequency
/// as [`enable_pwm_hz`](plotter_motion::config::MotorConfig::enable_pwm_hz) into the machine's file, and let
/// it be at least that of the control loop. A motor that brakes in between, as the mean of its voltage would
/// turn it, takes a bridge with the PWM on its inputs: [`Drv8871`] with [`Decay::Slow`].
///
/// Whatever pin fails, the motor does not run on: see [`Error`]. Dropping the driver leaves the pins as they
/// are; [`coast`](Self::coast) first.
///
/// ```
/// use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Set};
/// use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as SetDuty};
/// use plotter_hal::HBridge;
/// use plotter_motion::{Axis, Demand, Duty, LimitSwitches, SafetyGate};
///
/// let pwm = Pwm::new(&[SetDuty::set_duty_cycle(0), SetDuty::max_duty_cycle(255), SetDuty::set_duty_cycle(20)]);
/// let forward = Pin::new(&[Set::set(State::High)]);
/// let reverse = Pin::new(&[Set::set(State::Low)]);
/// let mut motor = HBridge::new(Axis::X, pwm, forward, reverse);
///
/// let demand = Demand { x: Duty::saturating(20.0 / 255.0), y: Duty::ZERO };
/// let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// motor.drive(gate.pass(demand))?;
/// # let (mut pwm, mut forward, mut reverse) = motor.release();
/// # pwm.done();
/// # forward.done();
/// # reverse.done();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// A duty alone does not turn a motor:
///
/// ```compile_fail
/// # use embedded_hal_mock::eh1::{digital::Mock as Pin, pwm::Mock as Pwm};
/// # use plotter_hal::HBridge;
/// # use plotter_motion::{Axis, Duty};
/// # let mut motor = HBridge::new(Axis::X, Pwm::new(&[]), Pin::new(&[]), Pin::new(&[]));
/// motor.drive(Duty::FULL);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HBridge<Enable, Forward, Reverse> {
    axis: Axis,
    enable: Enable,
    forward: Forward,
    reverse: Reverse,
    /// What the direction pins say; `None` when that is not known, or no direction.
    direction: Option<Direction>,
}

/// What can fail at a bridge on these pins.
type ErrorOf<Enable, Forward, Reverse> = Error<
    PinError<<Forward as digital::ErrorType>::Error, <Reverse as digital::ErrorType>::Error>,
    <Enable as pwm::ErrorType>::Error,
>;

type Outcome<Enable, Forward, Reverse> = Result<(), ErrorOf<Enable, Forward, Reverse>>;

impl<Enable, Forward, Reverse> HBridge<Enable, Forward, Reverse>
where
    Enable: SetDutyCycle,
    Forward: OutputPin,
    Reverse: OutputPin,
{
    /// The motor of `axis`, with the PWM on the bridge's enable pin. Leaves the pins as they are: call
    /// [`start`](Self::start) for a known state.
    pub const fn new(axis: Axis, enable: Enable, forward: Forward, reverse: Reverse) -> Self {
        Self { axis, enable, forward, reverse, direction: None }
    }

    /// The axis whose share of a [`Drive`] this motor takes.
    pub const fn axis(&self) -> Axis {
        self.axis
    }

    /// Brings all pins into a known state, whatever was before: no duty, both direction pins low.
    ///
    /// # Errors
    ///
    /// [`Error`] if a pin or the PWM fails; it says what became of the motor.
    pub fn start(&mut self) -> Outcome<Enable, Forward, Reverse> {
        self.coast()?;
        self.both_low().map_err(|cause| self.after_pin(cause))
    }

    /// Gives the motor its share of `drive`. A duty of 0 lets it coast; every other is rounded to the nearest
    /// step of the PWM.
    ///
    /// # Errors
    ///
    /// [`Error`] if a pin or the PWM fails; it says what became of the motor.
    pub fn drive(&mut self, drive: Drive) -> Outcome<Enable, Forward, Reverse> {
        let duty = drive.axis(self.axis);
        let Some(direction) = duty.direction() else { return self.coast() };
        if self.direction != Some(direction) {
            self.coast()?;
            self.turn_to(direction).map_err(|cause| self.after_pin(cause))?;
        }
        let steps = steps(duty, self.enable.max_duty_cycle());
        self.enable.set_duty_cycle(steps).map_err(|cause| self.after_pwm(cause))
    }

    /// Takes the duty away: both ends of the motor open, it runs out against its own friction.
    ///
    /// # Errors
    ///
    /// [`Error`] if the PWM fails; it says what became of the motor.
    pub fn coast(&mut self) -> Outcome<Enable, Forward, Reverse> {
        self.enable.set_duty_cycle_fully_off().map_err(|cause| self.after_pwm(cause))
    }

    /// Short-circuits the motor, so that its own current stops it: both direction pins low, enable full.
    ///
    /// # Errors
    ///
    /// [`Error`] if a pin or the PWM fails; it says what became of the motor.
    pub fn brake(&mut self) -> Outcome<Enable, Forward, Reverse> {
        self.coast()?;
        self.both_low().map_err(|cause| self.after_pin(cause))?;
        self.enable.set_duty_cycle_fully_on().map_err(|cause| self.after_pwm(cause))
    }

    /// Gives the PWM and both pins back, as they are: [`coast`](Self::coast) first.
    pub fn release(self) -> (Enable, Forward, Reverse) {
        (self.enable, self.forward, self.reverse)
    }

    /// Sets the direction pins; the duty has been taken away.
    fn turn_to(&mut self, direction: Direction) -> Result<(), PinError<Forward::Error, Reverse::Error>> {
        // Between the two pins the direction is neither.
        self.direction = None;
        match direction {
            Direction::Plus => {
                self.reverse.set_low().map_err(PinError::Reverse)?;
                self.forward.set_high().map_err(PinError::Forward)?;
            }
            Direction::Minus => {
                self.forward.set_low().map_err(PinError::Forward)?;
                self.reverse.set_high().map_err(PinError::Reverse)?;
            }
        }
        self.direction = Some(direction);
        Ok(())
    }

    /// Both pins low, and the second one also when the first one fails.
    fn both_low(&mut self) -> Result<(), PinError<Forward::Error, Reverse::Error>> {
        self.direction = None;
        let forward = self.forward.set_low().map_err(PinError::Forward);
        let reverse = self.reverse.set_low().map_err(PinError::Reverse);
        forward.and(reverse)
    }

    /// A direction pin failed: makes sure of the duty.
    fn after_pin(
        &mut self,
        cause: PinError<Forward::Error, Reverse::Error>,
    ) -> ErrorOf<Enable, Forward, Reverse> {
        self.direction = None;
        match self.enable.set_duty_cycle_fully_off() {
            Ok(()) => Error::Pin(cause),
            Err(cause) => self.after_pwm(cause),
        }
    }

    /// The PWM failed: tries it once more, and then takes the direction away, which stops a motor at any
    /// duty.
    fn after_pwm(&mut self, cause: Enable::Error) -> ErrorOf<Enable, Forward, Reverse> {
        self.direction = None;
        if self.enable.set_duty_cycle_fully_off().is_ok() || self.both_low().is_ok() {
            Error::Pwm(cause)
        } else {
            Error::NotStopped(cause)
        }
    }
}

impl<Enable, Forward, Reverse> Bridge for HBridge<Enable, Forward, Reverse>
where
    Enable: SetDutyCycle,
    Forward: OutputPin,
    Reverse: OutputPin,
{
    type Error = ErrorOf<Enable, Forward, Reverse>;

    fn axis(&self) -> Axis {
        self.axis
    }

    fn start(&mut self) -> Result<(), Self::Error> {
        self.start()
    }

    fn drive(&mut self, drive: Drive) -> Result<(), Self::Error> {
        self.drive(drive)
    }

    fn stop(&mut self) -> Result<(), Self::Error> {
        self.coast()
    }
}

/// The nearest of the PWM's steps from 0 to `full`, without sign.
fn steps(duty: Duty, full: u16) -> u16 {
    u16::try_from(duty.steps(full).unsigned_abs()).map_or(full, |steps| steps.min(full))
}

crate::which_pin::which_pin! {
    /// A direction pin of an [`HBridge`] failed.
    PinError: digital, Forward "forward: {}", Reverse "reverse: {}"
}

/// A pin or the PWM of an H-bridge failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Error<Pin, Pwm> {
    /// A direction pin failed; the duty was taken away, the motor has no supply across it.
    Pin(Pin),
    /// The PWM failed; the duty was taken away at a second attempt, or the supply by other pins.
    Pwm(Pwm),
    /// The PWM failed and the motor may not have been stopped: cut its supply.
    NotStopped(Pwm),
}

impl<Pin: fmt::Display, Pwm: pwm::Error> fmt::Display for Error<Pin, Pwm> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pin(cause) => {
                write!(f, "direction pin of the h-bridge: {cause}; the duty is taken away")
            }
            Self::Pwm(cause) => write!(f, "pwm of the h-bridge: {}; the motor is stopped", cause.kind()),
            Self::NotStopped(cause) => {
                write!(
                    f,
                    "pwm of the h-bridge: {}; the motor could not be stopped: cut its supply",
                    cause.kind()
                )
            }
        }
    }
}

impl<Pin: fmt::Debug + fmt::Display, Pwm: pwm::Error> core::error::Error for Error<Pin, Pwm> {}

crate::which_pin::formats_as_shown!(<Pin: fmt::Display, Pwm: pwm::Error> Error<Pin, Pwm>);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_duty_is_rounded_to_the_nearest_step_and_never_beyond_full() {
        assert_eq!(steps(Duty::saturating(20.0 / 255.0), 255), 20);
        assert_eq!(steps(Duty::saturating(-0.5), 255), 128); // 127.5, away from zero
        assert_eq!(steps(Duty::FULL, u16::MAX), u16::MAX);
        assert_eq!(steps(Duty::FULL, 0), 0);
    }
}
