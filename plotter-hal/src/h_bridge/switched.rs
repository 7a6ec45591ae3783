//! Bridges with two PWM inputs as those of a [`Drv8871`], and pins that switch them off: [`Drv8833`],
//! [`Bts7960`].
//!
//! ```text
//!                  │ DRV8833: IN1, IN2, nSLEEP     BTS7960: RPWM, LPWM, R_EN, L_EN
//!  inputs          │ switch high      low          switches high     one low
//!  ────────────────┼──────────────────────────────────────────────────────────
//!  low   low       │ coasts           coasts       brakes            coasts
//!  d     low       │ turns to larger  coasts       turns to larger   coasts
//!  low   d         │ turns to smaller coasts       turns to smaller  coasts
//!  high  high      │ brakes           coasts       (never used)
//! ```
//!
//! The switch is the second way to stop a motor whose PWM has failed.
//!
//! Sources: Texas Instruments, *DRV8833 Dual H-Bridge Motor Driver*, SLVSAR1E, section 7.3.2 "Bridge Control
//! and Decay Modes", Tables 1 and 2, and 6.5, `t_WAKE`; Infineon, *BTS 7960 High Current PN Half Bridge*,
//! Data Sheet Rev. 1.1, section 4.3 "Inputs", truth table: INH low switches both transistors of a half bridge
//! off.

use super::{Bridge, Decay, Drv8871, Error, InputError};
use crate::NoPin;
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use plotter_motion::{Axis, Drive};

crate::which_pin::which_pin! {
    /// The pin of a DRV8833's sleep failed.
    SleepPinError: digital, Sleep "nSLEEP: {}"
}

crate::which_pin::which_pin! {
    /// An enable pin of a BTS7960 module failed.
    EnablePinError: digital, Right "R_EN: {}", Left "L_EN: {}"
}

type InputErrorOf<In1, In2> = InputError<<In1 as pwm::ErrorType>::Error, <In2 as pwm::ErrorType>::Error>;

/// What can fail at a DRV8833 on these pins.
type ErrorOf8833<In1, In2, Sleep> =
    Error<SleepPinError<<Sleep as digital::ErrorType>::Error>, InputErrorOf<In1, In2>>;

/// What can fail at a BTS7960 module on these pins.
type ErrorOf7960<RPwm, LPwm, REn, LEn> = Error<
    EnablePinError<<REn as digital::ErrorType>::Error, <LEn as digital::ErrorType>::Error>,
    InputErrorOf<RPwm, LPwm>,
>;

/// What became of a motor whose inputs failed, and that `is_off` by its switch if they could not stop it.
fn after_inputs<Pin, Pwm>(
    error: Error<core::convert::Infallible, Pwm>,
    is_off: impl FnOnce() -> bool,
) -> Error<Pin, Pwm> {
    match error {
        Error::Pin(never) => match never {},
        Error::Pwm(cause) => Error::Pwm(cause),
        Error::NotStopped(cause) if is_off() => Error::Pwm(cause),
        Error::NotStopped(cause) => Error::NotStopped(cause),
    }
}

/// One motor on a channel of a DRV8833. It turns by nothing but a [`Drive`], which only a safety gate makes.
///
/// nSLEEP belongs to both channels of the chip: [give it](Self::with_sleep) to one of two motors, and that
/// one's fault stops both. The chip takes a millisecond to wake up (`t_WAKE`): the first drive is to come
/// later than that after [`start`](Bridge::start). Dropping the driver leaves the pins as they are;
/// [`stop`](Bridge::stop) first.
///
/// ```
/// use embedded_hal_mock::eh1::digital::{Mock as Pin, State::High, Transaction as Set};
/// use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as SetDuty};
/// use plotter_hal::h_bridge::{Bridge, Decay, Drv8833};
/// use plotter_motion::{Axis, Demand, Duty, LimitSwitches, SafetyGate};
///
/// let in1 = Pwm::new(&[SetDuty::set_duty_cycle(0), SetDuty::max_duty_cycle(200), SetDuty::set_duty_cycle(50)]);
/// let in2 = Pwm::new(&[SetDuty::set_duty_cycle(0), SetDuty::set_duty_cycle(0)]);
/// let sleep = Pin::new(&[Set::set(High)]);
/// let mut motor = Drv8833::new(Axis::X, in1, in2, Decay::Fast).with_sleep(sleep);
/// motor.start()?;
/// let quarter = Demand { x: Duty::new(0.25)?, y: Duty::ZERO };
/// let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// motor.drive(gate.pass(quarter))?;
/// # let (mut in1, mut in2, mut sleep) = motor.release();
/// # in1.done();
/// # in2.done();
/// # sleep.done();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Drv8833<In1, In2, Sleep> {
    inputs: Drv8871<In1, In2>,
    sleep: Sleep,
    has_sleep: bool,
    /// A fault has put the chip to sleep.
    is_off: bool,
}

impl<In1: SetDutyCycle, In2: SetDutyCycle> Drv8833<In1, In2, NoPin> {
    /// The motor of `axis` on a board that has nSLEEP wired high. Leaves the pins as they are: call
    /// [`start`](Bridge::start) for a known state.
    pub const fn new(axis: Axis, in1: In1, in2: In2, decay: Decay) -> Self {
        Self { inputs: Drv8871::new(axis, in1, in2, decay), sleep: NoPin, has_sleep: false, is_off: false }
    }

    /// With a pin on nSLEEP: low switches the outputs off.
    pub fn with_sleep<Sleep>(self, sleep: Sleep) -> Drv8833<In1, In2, Sleep> {
        Drv8833 { inputs: self.inputs, sleep, has_sleep: true, is_off: false }
    }
}

impl<In1: SetDutyCycle, In2: SetDutyCycle, Sleep: OutputPin> Drv8833<In1, In2, Sleep> {
    /// Gives both PWMs and nSLEEP back, as they are: [`stop`](Bridge::stop) first.
    pub fn release(self) -> (In1, In2, Sleep) {
        let (in1, in2) = self.inputs.release();
        (in1, in2, self.sleep)
    }

    fn after(
        &mut self,
        outcome: Result<(), Error<core::convert::Infallible, InputErrorOf<In1, In2>>>,
    ) -> Result<(), ErrorOf8833<In1, In2, Sleep>> {
        outcome.map_err(|error| {
            after_inputs(error, || {
                let sleeps = self.has_sleep && (self.sleep.set_low().is_ok() || self.sleep.set_low().is_ok());
                self.is_off |= sleeps;
                sleeps
            })
        })
    }
}

impl<In1: SetDutyCycle, In2: SetDutyCycle, Sleep: OutputPin> Bridge for Drv8833<In1, In2, Sleep> {
    type Error = ErrorOf8833<In1, In2, Sleep>;

    fn axis(&self) -> Axis {
        self.inputs.axis()
    }

    /// As [`Drv8871`], and awake.
    fn start(&mut self) -> Result<(), Self::Error> {
        let started = self.inputs.start();
        self.after(started)?;
        // Its inputs are at rest: a chip that does not wake turns no motor.
        self.sleep.set_high().map_err(|cause| Error::Pin(SleepPinError::Sleep(cause)))?;
        self.is_off = false;
        Ok(())
    }

    /// A chip that a fault has put to sleep is started first.
    fn drive(&mut self, drive: Drive) -> Result<(), Self::Error> {
        if self.is_off {
            self.start()?;
        }
        let driven = self.inputs.drive(drive);
        self.after(driven)
    }

    /// Lets the motor coast with fast decay, brakes it with slow.
    fn stop(&mut self) -> Result<(), Self::Error> {
        let stopped = self.inputs.stop();
        self.after(stopped)
    }
}

/// One motor on a module of two BTS7960 half bridges (IBT-2). It turns by nothing but a [`Drive`], which only
/// a safety gate makes.
///
/// Between the pulses, and at rest, the motor brakes: both half bridges hold it to ground. `R_EN` is a pin,
/// and low it stops the motor whatever the PWMs do. Where `R_EN` and `L_EN` are joined, `L_EN` is a
/// [`NoPin`]. The module's PWM goes up to 25 kHz. Dropping the driver leaves the pins as they are;
/// [`stop`](Bridge::stop) first.
///
/// ```
/// use embedded_hal_mock::eh1::digital::{Mock as Pin, State::High, Transaction as Set};
/// use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as SetDuty};
/// use plotter_hal::NoPin;
/// use plotter_hal::h_bridge::{Bridge, Bts7960};
/// use plotter_motion::{Axis, Demand, Duty, LimitSwitches, SafetyGate};
///
/// let right = Pwm::new(&[SetDuty::set_duty_cycle(0), SetDuty::set_duty_cycle(0)]);
/// let left = Pwm::new(&[SetDuty::set_duty_cycle(0), SetDuty::max_duty_cycle(200), SetDuty::set_duty_cycle(50)]);
/// let enable = Pin::new(&[Set::set(High)]);
/// let mut motor = Bts7960::new(Axis::X, right, left, enable, NoPin);
/// motor.start()?;
/// let back = Demand { x: Duty::new(-0.25)?, y: Duty::ZERO };
/// let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// motor.drive(gate.pass(back))?;
/// # let (mut right, mut left, mut enable, _) = motor.release();
/// # right.done();
/// # left.done();
/// # enable.done();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bts7960<RPwm, LPwm, REn, LEn> {
    inputs: Drv8871<RPwm, LPwm>,
    right: REn,
    left: LEn,
    /// The half bridges have been switched off.
    is_off: bool,
}

impl<RPwm, LPwm, REn, LEn> Bts7960<RPwm, LPwm, REn, LEn>
where
    RPwm: SetDutyCycle,
    LPwm: SetDutyCycle,
    REn: OutputPin,
    LEn: OutputPin,
{
    /// The motor of `axis` on RPWM, LPWM, `R_EN` and `L_EN`. Leaves the pins as they are: call
    /// [`start`](Bridge::start) for a known state.
    pub const fn new(axis: Axis, r_pwm: RPwm, l_pwm: LPwm, r_en: REn, l_en: LEn) -> Self {
        // Both inputs low at rest, one of them modulated: between the pulses this bridge brakes by itself.
        Self { inputs: Drv8871::new(axis, r_pwm, l_pwm, Decay::Fast), right: r_en, left: l_en, is_off: false }
    }

    /// Switches both half bridges off: the motor coasts until the next drive or [`start`](Bridge::start).
    ///
    /// # Errors
    ///
    /// [`Error::Pin`] names the enable that failed; the inputs are at rest then.
    pub fn coast(&mut self) -> Result<(), ErrorOf7960<RPwm, LPwm, REn, LEn>> {
        self.stop()?;
        self.is_off = true;
        let right = self.right.set_low().map_err(|cause| Error::Pin(EnablePinError::Right(cause)));
        let left = self.left.set_low().map_err(|cause| Error::Pin(EnablePinError::Left(cause)));
        right.and(left)
    }

    /// Gives both PWMs and both enables back, as they are: [`stop`](Bridge::stop) first.
    pub fn release(self) -> (RPwm, LPwm, REn, LEn) {
        let (r_pwm, l_pwm) = self.inputs.release();
        (r_pwm, l_pwm, self.right, self.left)
    }

    fn after(
        &mut self,
        outcome: Result<(), Error<core::convert::Infallible, InputErrorOf<RPwm, LPwm>>>,
    ) -> Result<(), ErrorOf7960<RPwm, LPwm, REn, LEn>> {
        outcome.map_err(|error| {
            after_inputs(error, || {
                // One half bridge that is open leaves the motor no way for its current.
                let _ = self.left.set_low();
                self.is_off = true;
                self.right.set_low().is_ok() || self.right.set_low().is_ok()
            })
        })
    }
}

impl<RPwm, LPwm, REn, LEn> Bridge for Bts7960<RPwm, LPwm, REn, LEn>
where
    RPwm: SetDutyCycle,
    LPwm: SetDutyCycle,
    REn: OutputPin,
    LEn: OutputPin,
{
    type Error = ErrorOf7960<RPwm, LPwm, REn, LEn>;

    fn axis(&self) -> Axis {
        self.inputs.axis()
    }

    /// Both inputs low, both half bridges on.
    fn start(&mut self) -> Result<(), Self::Error> {
        let started = self.inputs.start();
        self.after(started)?;
        self.right.set_high().map_err(|cause| Error::Pin(EnablePinError::Right(cause)))?;
        self.left.set_high().map_err(|cause| Error::Pin(EnablePinError::Left(cause)))?;
        self.is_off = false;
        Ok(())
    }

    /// Half bridges that are off are started first.
    fn drive(&mut self, drive: Drive) -> Result<(), Self::Error> {
        if self.is_off {
            self.start()?;
        }
        let driven = self.inputs.drive(drive);
        self.after(driven)
    }

    /// Takes the duty away: the motor brakes.
    fn stop(&mut self) -> Result<(), Self::Error> {
        let stopped = self.inputs.stop();
        self.after(stopped)
    }
}
