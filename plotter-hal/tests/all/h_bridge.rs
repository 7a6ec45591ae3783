//! The H-bridge pin by pin, in the order in which the pins change, with faults put in.

use embedded_hal::digital::{self, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Set};
use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as SetDuty};
use plotter_hal::HBridge;
use plotter_hal::h_bridge::{Error, PinError};
use plotter_motion::{Axis, Demand, Drive, Duty, LimitSwitches, SafetyGate};
use proptest::prelude::*;
use std::cell::RefCell;
use std::io::ErrorKind;

/// Steps of the PWM in these tests.
const FULL: u16 = 200;

/// Nothing is pressed.
static GATE: SafetyGate = SafetyGate::new(LimitSwitches::RELEASED, false);

fn drive(x: f32, y: f32) -> Drive<'static> {
    GATE.pass(Demand { x: Duty::saturating(x), y: Duty::saturating(y) })
}

/// What happens on the wires of one bridge, in order, and which accesses fail.
#[derive(Default)]
struct Wires {
    journal: RefCell<Vec<Event>>,
    /// Numbers, from 0, of the accesses that fail without effect.
    failing: Vec<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Event {
    Duty(u16),
    Forward(bool),
    Reverse(bool),
}

/// The access failed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Broken;

impl digital::Error for Broken {
    fn kind(&self) -> digital::ErrorKind {
        digital::ErrorKind::Other
    }
}

impl pwm::Error for Broken {
    fn kind(&self) -> pwm::ErrorKind {
        pwm::ErrorKind::Other
    }
}

/// State of the wires: what the motor sees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Levels {
    duty: u16,
    forward: bool,
    reverse: bool,
}

impl Levels {
    /// Voltage across the motor as a share of the supply: none when both inputs are equal.
    fn voltage(self) -> i32 {
        (i32::from(self.forward) - i32::from(self.reverse)) * i32::from(self.duty)
    }
}

impl Wires {
    fn access(&self, event: Event) -> Result<(), Broken> {
        let mut journal = self.journal.borrow_mut();
        let number = journal.len();
        journal.push(event);
        if self.failing.contains(&number) { Err(Broken) } else { Ok(()) }
    }

    fn bridge(&self) -> HBridge<Wire<'_>, Wire<'_>, Wire<'_>> {
        HBridge::new(
            Axis::X,
            Wire { wires: self, is_forward: false },
            Wire { wires: self, is_forward: true },
            Wire { wires: self, is_forward: false },
        )
    }

    /// The levels after each access that took effect, starting with all low.
    fn history(&self) -> Vec<Levels> {
        let mut levels = Levels::default();
        let mut history = vec![levels];
        for (number, event) in self.journal.borrow().iter().enumerate() {
            if !self.failing.contains(&number) {
                match *event {
                    Event::Duty(duty) => levels.duty = duty,
                    Event::Forward(high) => levels.forward = high,
                    Event::Reverse(high) => levels.reverse = high,
                }
                history.push(levels);
            }
        }
        history
    }

    fn now(&self) -> Levels {
        self.history().last().copied().unwrap_or_default()
    }
}

/// One pin of the bridge; as PWM it is the enable pin.
struct Wire<'a> {
    wires: &'a Wires,
    is_forward: bool,
}

impl digital::ErrorType for Wire<'_> {
    type Error = Broken;
}

impl OutputPin for Wire<'_> {
    fn set_low(&mut self) -> Result<(), Broken> {
        self.wires.access(if self.is_forward { Event::Forward(false) } else { Event::Reverse(false) })
    }

    fn set_high(&mut self) -> Result<(), Broken> {
        self.wires.access(if self.is_forward { Event::Forward(true) } else { Event::Reverse(true) })
    }
}

impl pwm::ErrorType for Wire<'_> {
    type Error = Broken;
}

impl SetDutyCycle for Wire<'_> {
    fn max_duty_cycle(&self) -> u16 {
        FULL
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Broken> {
        self.wires.access(Event::Duty(duty))
    }
}

#[test]
fn the_direction_changes_between_no_duty_and_the_new_duty() {
    let wires = Wires::default();
    let mut bridge = wires.bridge();
    bridge.drive(drive(0.5, 0.0)).unwrap();
    bridge.drive(drive(-0.25, 0.0)).unwrap();
    assert_eq!(
        *wires.journal.borrow(),
        [
            Event::Duty(0),
            Event::Reverse(false),
            Event::Forward(true),
            Event::Duty(100),
            Event::Duty(0),
            Event::Forward(false),
            Event::Reverse(true),
            Event::Duty(50),
        ]
    );
}

#[test]
fn the_same_direction_changes_the_duty_alone() {
    let wires = Wires::default();
    let mut bridge = wires.bridge();
    bridge.drive(drive(0.5, 0.0)).unwrap();
    let before = wires.journal.borrow().len();
    bridge.drive(drive(0.75, 0.0)).unwrap();
    assert_eq!(wires.journal.borrow()[before..], [Event::Duty(150)]);
}

#[test]
fn no_duty_lets_the_motor_coast() {
    let wires = Wires::default();
    let mut bridge = wires.bridge();
    bridge.drive(drive(1.0, 0.0)).unwrap();
    bridge.drive(drive(0.0, 1.0)).unwrap();
    assert_eq!(wires.now().duty, 0);
}

#[test]
fn a_brake_short_circuits_the_motor() {
    let wires = Wires::default();
    let mut bridge = wires.bridge();
    bridge.drive(drive(1.0, 0.0)).unwrap();
    bridge.brake().unwrap();
    assert_eq!(wires.now(), Levels { duty: FULL, forward: false, reverse: false });
    bridge.drive(drive(1.0, 0.0)).unwrap();
    assert_eq!(wires.now().voltage(), i32::from(FULL));
}

#[test]
fn each_bridge_takes_the_share_of_its_own_axis() {
    let pwm = Pwm::new(&[
        SetDuty::set_duty_cycle(0),
        SetDuty::max_duty_cycle(FULL),
        SetDuty::set_duty_cycle(FULL),
        SetDuty::set_duty_cycle(0),
    ]);
    let forward = Pin::new(&[Set::set(State::Low)]);
    let reverse = Pin::new(&[Set::set(State::High)]);
    let mut bridge = HBridge::new(Axis::Y, pwm, forward, reverse);
    bridge.drive(drive(0.5, -1.0)).unwrap();

    let mut gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    gate.set_limits(LimitSwitches { y_min: true, ..LimitSwitches::default() });
    bridge.drive(gate.pass(Demand { x: Duty::FULL, y: Duty::saturating(-1.0) })).unwrap();

    let (mut pwm, mut forward, mut reverse) = bridge.release();
    pwm.done();
    forward.done();
    reverse.done();
}

#[test]
fn a_failing_direction_pin_leaves_the_motor_without_duty() {
    let fault = MockError::Io(ErrorKind::NotConnected);
    let pwm = Pwm::new(&[SetDuty::set_duty_cycle(0), SetDuty::set_duty_cycle(0)]);
    let forward = Pin::new(&[Set::set(State::High).with_error(fault.clone())]);
    let reverse = Pin::new(&[Set::set(State::Low)]);
    let mut bridge = HBridge::new(Axis::X, pwm, forward, reverse);
    let error = bridge.drive(drive(0.5, 0.0)).unwrap_err();
    assert_eq!(error, Error::Pin(PinError::Forward(fault)));
    assert!(error.to_string().ends_with("the duty is taken away"), "{error}");

    let (mut pwm, mut forward, mut reverse) = bridge.release();
    pwm.done();
    forward.done();
    reverse.done();
}

#[test]
fn a_pwm_that_fails_for_good_is_stopped_by_its_direction() {
    let fault = MockError::Io(ErrorKind::NotConnected);
    let pwm = Pwm::new(&[
        SetDuty::set_duty_cycle(0).with_error(fault.clone()),
        SetDuty::set_duty_cycle(0).with_error(fault.clone()),
    ]);
    let forward = Pin::new(&[Set::set(State::Low)]);
    let reverse = Pin::new(&[Set::set(State::Low)]);
    let mut bridge = HBridge::new(Axis::X, pwm, forward, reverse);
    assert_eq!(bridge.coast(), Err(Error::Pwm(fault)));

    let (mut pwm, mut forward, mut reverse) = bridge.release();
    pwm.done();
    forward.done();
    reverse.done();
}

#[test]
fn a_motor_that_cannot_be_stopped_is_told_apart() {
    // Access 0 takes the duty away, 1 and 2 set the direction, 3 the duty. From 4 on everything fails.
    let wires = Wires { failing: (4..20).collect(), ..Wires::default() };
    let mut bridge = wires.bridge();
    bridge.drive(drive(0.5, 0.0)).unwrap();
    let error = bridge.coast().unwrap_err();
    assert_eq!(error, Error::NotStopped(Broken));
    assert!(error.to_string().ends_with("cut its supply"), "{error}");
}

#[test]
fn after_a_fault_the_direction_is_set_anew() {
    // The second change of direction fails at its first pin (access 5).
    let wires = Wires { failing: vec![5], ..Wires::default() };
    let mut bridge = wires.bridge();
    bridge.drive(drive(0.5, 0.0)).unwrap();
    assert_eq!(bridge.drive(drive(-0.5, 0.0)), Err(Error::Pin(PinError::Forward(Broken))));
    bridge.drive(drive(-0.5, 0.0)).unwrap();
    assert_eq!(wires.now(), Levels { duty: 100, forward: false, reverse: true });
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever is driven and whichever accesses fail: the inputs are never both high, the direction never
    /// changes under duty, and after an error the motor has no voltage unless the error says that it may.
    #[test]
    fn no_fault_drives_a_motor(
        duties in prop::collection::vec(-1.0_f32..=1.0, 1..12),
        failing in prop::collection::vec(0..60_usize, 0..8),
    ) {
        let wires = Wires { failing, ..Wires::default() };
        let mut bridge = wires.bridge();
        for duty in duties {
            let before = wires.history().len() - 1;
            let outcome = bridge.drive(drive(duty, 1.0));
            match outcome {
                Ok(()) => {
                    #[expect(clippy::cast_possible_truncation, reason = "at most 200")]
                    let wanted = (f64::from(duty) * f64::from(FULL)).round() as i32;
                    prop_assert_eq!(wires.now().voltage(), wanted);
                }
                Err(Error::Pin(_)) => prop_assert_eq!(wires.now().duty, 0),
                Err(Error::Pwm(_)) => prop_assert_eq!(wires.now().voltage(), 0),
                Err(_) => {}
            }
            for step in wires.history()[before..].windows(2) {
                let (old, new) = (step[0], step[1]);
                prop_assert!(!(new.forward && new.reverse), "both inputs high: {:?}", new);
                let direction_changed = (old.forward, old.reverse) != (new.forward, new.reverse);
                // The one change of direction under duty is the one that stops a motor whose PWM failed.
                let only_lowered = new.forward <= old.forward && new.reverse <= old.reverse;
                prop_assert!(!direction_changed || old.duty == 0 || (only_lowered && outcome.is_err()));
            }
        }
    }
}

/// A lift's motor is on a bridge as any other; it gets what the gate lets a third motor have.
#[cfg(feature = "third-motor")]
#[test]
fn a_lift_takes_its_own_share_and_none_of_the_others() {
    use plotter_motion::safety::EndSwitches;
    let wires = Wires::default();
    let mut lift = wires.bridge();
    let mut gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    let [up, down] = [Duty::saturating(0.5), Duty::saturating(-0.25)];
    lift.start().unwrap();
    lift.drive(gate.pass(Demand { x: Duty::FULL, y: Duty::FULL }).of_z(Axis::X)).unwrap();
    assert_eq!(wires.now().voltage(), 0);
    lift.drive(gate.pass_z(up).of_z(Axis::X)).unwrap();
    assert_eq!(wires.now().voltage(), 100);
    gate.set_z_limits(EndSwitches { upper: true, lower: false });
    lift.drive(gate.pass_z(up).of_z(Axis::X)).unwrap();
    assert_eq!(wires.now().voltage(), 0);
    lift.drive(gate.pass_z(down).of_z(Axis::X)).unwrap();
    assert_eq!(wires.now().voltage(), -50);
    gate.emergency_stop(true);
    lift.drive(gate.pass_z(down).of_z(Axis::X)).unwrap();
    assert_eq!(wires.now().voltage(), 0);
}
