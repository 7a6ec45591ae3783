//! Pins of one driver that have errors of different types: some of the chip, which cannot fail, and some on a
//! port expander, whose errors have nothing but what `embedded-hal` asks for. What fails is told, and the
//! part is safe.

use core::convert::Infallible;
use embedded_hal::digital::{self, InputPin, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use plotter_hal::a4988::{self, A4988, Chip, MicrostepPinError, MicrostepPins, Timing};
use plotter_hal::h_bridge::{self, Bridge, Decay, Drv8871, InputError, Tb6612, Tb6612PinError};
use plotter_hal::limit_switch::GroupError;
use plotter_hal::{
    DcAxes, HBridge, LimitSwitch, LimitSwitchGroup, Quadrature, StepperAxes, SwitchSettings, axis, quadrature,
};
use plotter_motion::config::Decoding;
use plotter_motion::{
    Axis, Demand, Direction, Drive, Duty, LimitSwitches, SafetyGate, StepPair, safety::Pulse,
};
use std::cell::Cell;
use std::rc::Rc;
use std::time::Duration;

/// The expander did not answer: no `Display`, no `Clone`.
#[derive(Debug, PartialEq)]
struct NoAnswer;

impl digital::Error for NoAnswer {
    fn kind(&self) -> digital::ErrorKind {
        digital::ErrorKind::Other
    }
}

/// A PWM of another make failed.
#[derive(Debug, PartialEq)]
struct NoPulse;

impl pwm::Error for NoPulse {
    fn kind(&self) -> pwm::ErrorKind {
        pwm::ErrorKind::Other
    }
}

/// What a wire shows, and whether its expander answers.
#[derive(Clone, Debug, Default)]
struct Wire {
    level: Rc<Cell<u16>>,
    is_silent: Rc<Cell<bool>>,
}

/// The wire on the chip itself: cannot fail.
struct OnChip(Wire);

/// The wire on an expander.
struct OnExpander(Wire);

impl digital::ErrorType for OnChip {
    type Error = Infallible;
}

impl digital::ErrorType for OnExpander {
    type Error = NoAnswer;
}

impl OutputPin for OnChip {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.level.set(0);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.level.set(1);
        Ok(())
    }
}

impl OutputPin for OnExpander {
    fn set_low(&mut self) -> Result<(), NoAnswer> {
        self.0.answer()?.set(0);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), NoAnswer> {
        self.0.answer()?.set(1);
        Ok(())
    }
}

impl InputPin for OnChip {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(self.0.level.get() > 0)
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(self.0.level.get() == 0)
    }
}

impl InputPin for OnExpander {
    fn is_high(&mut self) -> Result<bool, NoAnswer> {
        Ok(self.0.answer()?.get() > 0)
    }

    fn is_low(&mut self) -> Result<bool, NoAnswer> {
        Ok(self.0.answer()?.get() == 0)
    }
}

impl Wire {
    fn answer(&self) -> Result<&Cell<u16>, NoAnswer> {
        if self.is_silent.get() { Err(NoAnswer) } else { Ok(&self.level) }
    }
}

/// A PWM of the chip, and one that may fail.
impl pwm::ErrorType for OnChip {
    type Error = Infallible;
}

impl SetDutyCycle for OnChip {
    fn max_duty_cycle(&self) -> u16 {
        200
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        self.0.level.set(duty);
        Ok(())
    }
}

impl pwm::ErrorType for OnExpander {
    type Error = NoPulse;
}

impl SetDutyCycle for OnExpander {
    fn max_duty_cycle(&self) -> u16 {
        200
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), NoPulse> {
        self.0.answer().map_err(|_| NoPulse)?.set(duty);
        Ok(())
    }
}

/// A wire, and a pin of the chip on it; the same on an expander.
fn on_chip() -> (Wire, OnChip) {
    let wire = Wire::default();
    (wire.clone(), OnChip(wire))
}

fn on_expander() -> (Wire, OnExpander) {
    let wire = Wire::default();
    (wire.clone(), OnExpander(wire))
}

static GATE: SafetyGate = SafetyGate::new(LimitSwitches::RELEASED, false);
const START: Duration = Duration::ZERO;
const LATER: Duration = Duration::from_millis(10);

fn pulse() -> Pulse<'static> {
    GATE.pass_step(StepPair { x: 1, y: 1 }).unwrap()
}

fn drive(x: f32) -> Drive<'static> {
    GATE.pass(Demand { x: Duty::saturating(x), y: Duty::saturating(x) })
}

#[test]
fn a_stepper_whose_enable_is_on_an_expander_sleeps_when_that_is_silent() {
    let ((step, step_pin), (_, dir), (enable, enable_pin), (sleep, sleep_pin)) =
        (on_chip(), on_chip(), on_expander(), on_chip());
    let mut motor =
        A4988::new(Axis::X, step_pin, dir, Timing::A4988).with_enable(enable_pin).with_sleep(sleep_pin);
    motor.start(START).unwrap();
    motor.step(pulse(), LATER).unwrap();
    enable.is_silent.set(true);
    let error = motor.stop().unwrap_err();
    assert_eq!(error, a4988::Error::Pin(a4988::PinError::Enable(NoAnswer)));
    assert!(error.to_string().starts_with("pin of the stepper motor: ENABLE: "), "{error}");
    assert_eq!((sleep.level.get(), motor.is_on()), (0, false), "asleep: no current");
    assert_eq!(motor.step(pulse(), LATER), Err(a4988::Error::Off));
    motor.tick(LATER * 2).unwrap();
    assert_eq!(step.level.get(), 0, "the pulse ends, and no other begins");
}

#[test]
fn a_stepper_whose_only_switch_is_on_an_expander_says_that_it_may_hold() {
    let ((_, step), (_, dir), (enable, enable_pin)) = (on_chip(), on_chip(), on_expander());
    let mut motor = A4988::new(Axis::X, step, dir, Timing::A4988).with_enable(enable_pin);
    enable.is_silent.set(true);
    let error = a4988::Error::StillOn(a4988::PinError::Enable(NoAnswer));
    assert_eq!(motor.start(START), Err(error));
    assert!(!motor.is_on());
    enable.is_silent.set(false);
    motor.start(START).unwrap();
    assert!(motor.is_on() && enable.level.get() == 0, "the expander answers again");
}

#[test]
fn a_resolution_on_an_expander_that_is_silent_leaves_the_motor_off() {
    let ((_, step), (_, dir), (enable, enable_pin)) = (on_chip(), on_chip(), on_chip());
    let mut motor = A4988::new(Axis::X, step, dir, Timing::A4988).with_enable(enable_pin);
    motor.start(START).unwrap();
    let ((_, ms1), (ms2, ms2_pin), (_, ms3)) = (on_chip(), on_expander(), on_chip());
    ms2.is_silent.set(true);
    let mut pins = MicrostepPins::new(Chip::A4988, ms1, ms2_pin, ms3);
    let error = motor.set_microsteps(&mut pins, 16, LATER).unwrap_err();
    assert_eq!(error, a4988::Error::Pin(MicrostepPinError::Ms2(NoAnswer)));
    assert_eq!(enable.level.get(), 1, "no current");
}

#[test]
fn two_steppers_of_different_pins_stop_together() {
    let ((x_step, x_step_pin), (_, x_dir), (x_enable, x_enable_pin)) = (on_chip(), on_chip(), on_chip());
    let ((y_step, y_step_pin), (_, y_dir), (y_enable, y_enable_pin)) =
        (on_expander(), on_expander(), on_chip());
    let mut motors = StepperAxes::new(
        A4988::new(Axis::X, x_step_pin, x_dir, Timing::A4988).with_enable(x_enable_pin),
        A4988::new(Axis::Y, y_step_pin, y_dir, Timing::A4988).with_enable(y_enable_pin),
    );
    motors.start(START).unwrap();
    y_step.is_silent.set(true);
    motors.step(pulse(), LATER).unwrap(); // sets DIR of both
    let error = motors.tick(LATER * 2).unwrap_err();
    assert_eq!(error, axis::Error { x: None, y: Some(a4988::Error::Pin(a4988::PinError::Step(NoAnswer))) });
    assert!(error.to_string().starts_with("axis y: pin of the stepper motor: STEP: "), "{error}");
    assert_eq!((x_enable.level.get(), y_enable.level.get()), (1, 1), "neither has current");
    motors.tick(LATER * 3).unwrap();
    assert_eq!(x_step.level.get(), 0);
}

#[test]
fn a_bridge_whose_direction_is_on_an_expander_loses_its_duty_when_that_is_silent() {
    let ((duty, pwm), (_, forward), (reverse, reverse_pin)) = (on_chip(), on_chip(), on_expander());
    let mut motor = HBridge::new(Axis::X, pwm, forward, reverse_pin);
    motor.drive(drive(0.5)).unwrap();
    assert_eq!(duty.level.get(), 100);
    reverse.is_silent.set(true);
    let error = motor.drive(drive(-0.5)).unwrap_err();
    assert_eq!(error, h_bridge::Error::Pin(h_bridge::PinError::Reverse(NoAnswer)));
    assert!(error.to_string().starts_with("direction pin of the h-bridge: reverse: "), "{error}");
    assert_eq!(duty.level.get(), 0);
}

#[test]
fn a_standby_on_an_expander_is_named() {
    let ((duty, pwm), (_, in1), (_, in2), (stby, stby_pin)) =
        (on_chip(), on_chip(), on_chip(), on_expander());
    let mut motor = Tb6612::new(Axis::X, pwm, in1, in2).with_standby(stby_pin);
    stby.is_silent.set(true);
    assert_eq!(motor.drive(drive(0.5)), Err(h_bridge::Error::Pin(Tb6612PinError::Stby(NoAnswer))));
    assert_eq!(duty.level.get(), 0);
}

#[test]
fn two_dc_motors_on_bridges_of_different_kinds_stop_together() {
    let ((in1, in1_pwm), (in2, in2_pwm)) = (on_chip(), on_expander());
    let ((duty, pwm), (_, forward), (_, reverse)) = (on_chip(), on_chip(), on_expander());
    let mut motors = DcAxes::new(
        Drv8871::new(Axis::X, in1_pwm, in2_pwm, Decay::Fast),
        HBridge::new(Axis::Y, pwm, forward, reverse),
        Duration::ZERO,
    );
    motors.start().unwrap();
    motors.drive(drive(0.5), START).unwrap();
    assert_eq!((in1.level.get(), duty.level.get()), (100, 100));
    in2.is_silent.set(true);
    let error = motors.drive(drive(-0.5), LATER).unwrap_err();
    // The input cannot be looked after any more: nobody knows what it does.
    assert_eq!(
        error,
        axis::Error { x: Some(h_bridge::Error::NotStopped(InputError::In2(NoPulse))), y: None }
    );
    assert_eq!((in1.level.get(), duty.level.get()), (0, 0), "whatever could be stopped is");
}

#[test]
fn a_phase_on_an_expander_is_named_and_the_position_stays() {
    let ((a, a_pin), (b, b_pin)) = (on_chip(), on_expander());
    let mut encoder = Quadrature::new(a_pin, b_pin, Decoding::X4);
    encoder.poll().unwrap();
    b.level.set(1);
    b.is_silent.set(true);
    let error = encoder.poll().unwrap_err();
    assert_eq!(error, quadrature::Error::Pin(quadrature::PinError::B(NoAnswer)));
    assert!(error.to_string().starts_with("pin of the encoder: phase B: "), "{error}");
    b.is_silent.set(false);
    assert!(encoder.poll().unwrap().is_some());
    assert_eq!((encoder.position().abs(), a.level.get()), (1, 0));
}

#[test]
fn a_limit_switch_on_an_expander_that_is_silent_is_pressed() {
    let settings = SwitchSettings::default().with_release_after(Duration::ZERO);
    let ((_, x_min), (_, x_max), (y_min, y_min_pin), (_, y_max)) =
        (on_chip(), on_chip(), on_expander(), on_chip());
    let mut limits = LimitSwitchGroup {
        x_min: LimitSwitch::new(x_min, settings),
        x_max: LimitSwitch::new(x_max, settings),
        y_min: LimitSwitch::new(y_min_pin, settings),
        y_max: LimitSwitch::new(y_max, settings),
    };
    assert_eq!(limits.tick(START), Ok(LimitSwitches::RELEASED));
    y_min.is_silent.set(true);
    let error = limits.tick(LATER).unwrap_err();
    assert_eq!(error, GroupError::YMin(NoAnswer));
    assert_eq!((error.axis(), error.end()), (Axis::Y, Direction::Minus));
    let gate = SafetyGate::new(limits.limits(), false);
    assert_eq!(gate.pass(Demand { x: Duty::FULL, y: Duty::saturating(-1.0) }).y(), Duty::ZERO);
}
