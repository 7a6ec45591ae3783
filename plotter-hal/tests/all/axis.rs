//! Two motors as one: pulses and drives on the pins of both, with faults put in.

use crate::logic_analyser;

use logic_analyser::{Analyser, Broken, Fault, Wire};
use plotter_hal::a4988::{self, A4988, PinError, Timing};
use plotter_hal::axis::Error;
use plotter_hal::h_bridge;
use plotter_hal::{DcAxes, HBridge, StepperAxes};
use plotter_motion::{
    Axis, Bresenham, Demand, Drive, Duty, LimitSwitches, SafetyGate, StepPair, StepPoint,
    safety::{Blocked, Pulse},
};
use std::time::Duration;

type Stepper<'a> = A4988<Wire<'a>, Wire<'a>, Wire<'a>, Wire<'a>>;
type Steppers<'a> = StepperAxes<Stepper<'a>, Stepper<'a>>;
type Bridge<'a> = HBridge<Wire<'a>, Wire<'a>, Wire<'a>>;
type AnyPin = PinError<Broken, Broken, Broken, Broken>;
type StepperError = Error<a4988::Error<AnyPin>>;
type DcError = Error<h_bridge::Error<h_bridge::PinError<Broken, Broken>, Broken>>;

/// The pin of a motor behind a wire.
fn pin_on(wire: &str) -> AnyPin {
    match wire.split_once(' ').unwrap().1 {
        "STEP" => PinError::Step(Broken),
        "DIR" => PinError::Dir(Broken),
        "ENABLE" => PinError::Enable(Broken),
        "SLEEP" => PinError::Sleep(Broken),
        other => panic!("{other} is no pin of a motor"),
    }
}

const TIMING: Timing = Timing::A4988;
/// Long after the wake-up.
const LATER: Duration = Duration::from_millis(5);

/// Nothing is pressed.
static GATE: SafetyGate = SafetyGate::new(LimitSwitches::RELEASED, false);

fn pulse(x: i8, y: i8) -> Pulse<'static> {
    GATE.pass_step(StepPair { x, y }).unwrap()
}

fn steppers(analyser: &Analyser) -> Steppers<'_> {
    let [x_step, x_dir, x_enable, x_sleep] =
        ["X STEP", "X DIR", "X ENABLE", "X SLEEP"].map(|wire| analyser.wire(wire));
    let [y_step, y_dir, y_enable, y_sleep] =
        ["Y STEP", "Y DIR", "Y ENABLE", "Y SLEEP"].map(|wire| analyser.wire(wire));
    StepperAxes::new(
        A4988::new(Axis::X, x_step, x_dir, TIMING).with_enable(x_enable).with_sleep(x_sleep),
        A4988::new(Axis::Y, y_step, y_dir, TIMING).with_enable(y_enable).with_sleep(y_sleep),
    )
}

/// A timer that calls as soon as the driver wants it.
fn run(analyser: &Analyser, motors: &mut Steppers<'_>) -> Result<(), StepperError> {
    while let Some(due) = motors.due() {
        analyser.now.set(analyser.now.get().max(due));
        motors.tick(analyser.now.get())?;
    }
    Ok(())
}

/// Both, one with a turn, the other alone, then off.
fn dance(analyser: &Analyser, motors: &mut Steppers<'_>) -> Result<(), StepperError> {
    motors.start(analyser.now.get())?;
    for (x, y) in [(1, 1), (1, -1), (0, -1)] {
        motors.step(pulse(x, y), analyser.now.get())?;
        run(analyser, motors)?;
    }
    motors.stop()
}

fn is_off(analyser: &Analyser, axis: Axis) -> bool {
    let [enable, sleep] = match axis {
        Axis::X => ["X ENABLE", "X SLEEP"],
        Axis::Y => ["Y ENABLE", "Y SLEEP"],
    };
    analyser.level(enable) == 1
        || analyser.log().iter().any(|access| access.wire == sleep) && analyser.level(sleep) == 0
}

fn too_short(analyser: &Analyser) -> Vec<String> {
    let mut complaints = analyser.too_short("X STEP", "X DIR", TIMING);
    complaints.extend(analyser.too_short("Y STEP", "Y DIR", TIMING));
    complaints
}

#[test]
fn both_rise_together_and_the_one_that_need_not_turn_waits() {
    let analyser = Analyser::default();
    dance(&analyser, &mut steppers(&analyser)).unwrap();
    insta::assert_snapshot!(analyser.table(), @r"
          0 ns  X STEP   0
          0 ns  X SLEEP  1
          0 ns  X ENABLE 0
          0 ns  Y STEP   0
          0 ns  Y SLEEP  1
          0 ns  Y ENABLE 0
          0 ns  X DIR    1
          0 ns  Y DIR    1
    1000000 ns  X STEP   1
    1000000 ns  Y STEP   1
    1001000 ns  X STEP   0
    1001000 ns  Y STEP   0
    1001000 ns  Y DIR    0
    1002000 ns  X STEP   1
    1002000 ns  Y STEP   1
    1003000 ns  X STEP   0
    1003000 ns  Y STEP   0
    1004000 ns  Y STEP   1
    1005000 ns  Y STEP   0
    1005000 ns  X ENABLE 1
    1005000 ns  Y ENABLE 1
    ");
    assert_eq!(too_short(&analyser), [""; 0]);
}

#[test]
fn a_pulse_that_one_motor_cannot_take_is_not_taken_by_the_other() {
    let analyser = Analyser::default();
    let mut motors = steppers(&analyser);
    motors.start(Duration::ZERO).unwrap();
    motors.step(pulse(1, 0), LATER).unwrap(); // waits for its setup time
    let until = LATER + TIMING.setup;
    let busy = a4988::Error::Busy { until };
    assert_eq!(motors.step(pulse(1, 1), LATER), Err(Error { x: Some(busy), y: None }));
    analyser.now.set(LATER);
    run(&analyser, &mut motors).unwrap();
    assert_eq!((analyser.rises("X STEP"), analyser.rises("Y STEP")), (1, 0));
    assert!(!is_off(&analyser, Axis::X) && !is_off(&analyser, Axis::Y), "a refusal is not a fault");
}

#[test]
fn a_step_of_one_motor_does_not_wait_for_the_pulse_of_the_other() {
    let analyser = Analyser::default();
    let mut motors = steppers(&analyser);
    motors.start(Duration::ZERO).unwrap();
    motors.step(pulse(1, 0), LATER).unwrap();
    let x_rise = LATER + TIMING.setup;
    motors.tick(x_rise).unwrap();
    motors.step(pulse(0, 1), x_rise).unwrap();
    assert_eq!(motors.due(), Some(x_rise + TIMING.setup));
    motors.tick(x_rise + TIMING.setup).unwrap();
    assert_eq!((analyser.level("X STEP"), analyser.level("Y STEP")), (1, 1));
    assert_eq!(motors.due(), Some(x_rise + TIMING.high));
}

#[test]
fn chips_of_two_kinds_rise_together_too() {
    let analyser = Analyser::default();
    let fast = Timing::TMC2209;
    let mut motors = StepperAxes::new(
        A4988::new(Axis::X, analyser.wire("X STEP"), analyser.wire("X DIR"), fast),
        A4988::new(Axis::Y, analyser.wire("Y STEP"), analyser.wire("Y DIR"), Timing::DRV8825),
    );
    let mut clock = analyser.clock();
    motors.start_blocking(&mut clock).unwrap();
    motors.step(pulse(1, 1), analyser.now.get()).unwrap();
    for _ in 0..20 {
        while let Some(due) = motors.due() {
            analyser.now.set(analyser.now.get().max(due));
            motors.tick(analyser.now.get()).unwrap();
        }
        motors.step(pulse(1, 1), analyser.now.get()).unwrap();
    }
    let rises = |wire| analyser.edges(wire).into_iter().filter(|edge| edge.1 == 1).collect::<Vec<_>>();
    assert_eq!(rises("X STEP").len(), 20);
    assert_eq!(rises("X STEP"), rises("Y STEP"));
    assert_eq!(analyser.too_short("X STEP", "X DIR", fast), [""; 0]);
    assert_eq!(analyser.too_short("Y STEP", "Y DIR", Timing::DRV8825), [""; 0]);
}

#[test]
fn no_step_of_a_line_is_lost_however_late_the_ticks_come() {
    let target = StepPoint { x: -120, y: 77 };
    let line =
        Bresenham::new(StepPoint::default(), target).chain(Bresenham::new(target, StepPoint { x: 5, y: -9 }));
    let analyser = Analyser::default();
    let mut motors = steppers(&analyser);
    motors.start(Duration::ZERO).unwrap();
    analyser.now.set(LATER);
    for (number, step) in line.enumerate() {
        // Steps come every 2 us, faster than the chip takes them now and then; ticks up to 5 us late.
        analyser.now.set(analyser.now.get() + Duration::from_micros(2));
        while motors.is_waiting() {
            let late = Duration::from_nanos(u64::try_from(number).unwrap() * 997 % 5_000);
            analyser.now.set(analyser.now.get().max(motors.due().unwrap()) + late);
            motors.tick(analyser.now.get()).unwrap();
        }
        motors.step(pulse(step.x, step.y), analyser.now.get()).unwrap();
    }
    run(&analyser, &mut motors).unwrap();
    assert_eq!(too_short(&analyser), [""; 0]);

    // Where a chip stands that counts rising edges by DIR.
    let stands = |step: &str, dir: &str| {
        let (mut at, mut high, mut forwards) = (0, 0, 0);
        for access in analyser.log() {
            if access.wire == dir {
                forwards = access.to;
            } else if access.wire == step {
                at += if access.to > high { i32::from(forwards) * 2 - 1 } else { 0 };
                high = access.to;
            }
        }
        at
    };
    assert_eq!([stands("X STEP", "X DIR"), stands("Y STEP", "Y DIR")], [5, -9]);
}

#[test]
fn the_blocking_form_makes_the_same_pulses() {
    let analyser = Analyser::default();
    let (mut motors, mut clock) = (steppers(&analyser), analyser.clock());
    motors.start_blocking(&mut clock).unwrap();
    for (x, y) in [(1, 1), (1, -1), (0, -1)] {
        motors.step_blocking(pulse(x, y), &mut clock).unwrap();
    }
    assert_eq!(motors.due(), None);
    assert_eq!((analyser.rises("X STEP"), analyser.rises("Y STEP")), (2, 3));
    assert_eq!(analyser.edges("X STEP")[..4], analyser.edges("Y STEP")[..4]);
    assert_eq!(too_short(&analyser), [""; 0]);
}

#[test]
fn a_pulse_that_waits_can_be_taken_back() {
    let analyser = Analyser::default();
    let mut motors = steppers(&analyser);
    motors.start(Duration::ZERO).unwrap();
    motors.step(pulse(0, -1), LATER).unwrap();
    assert_eq!(motors.cancel(), Some(StepPair { x: 0, y: -1 }));
    motors.step(pulse(1, -1), LATER).unwrap();
    assert_eq!(motors.cancel(), Some(StepPair { x: 1, y: -1 }));
    assert_eq!((motors.cancel(), motors.due()), (None, None));
}

#[test]
fn a_start_within_a_pulse_is_refused_and_changes_nothing() {
    let analyser = Analyser::default();
    let mut motors = steppers(&analyser);
    motors.start(Duration::ZERO).unwrap();
    motors.step(pulse(1, 0), LATER).unwrap();
    motors.tick(LATER + TIMING.setup).unwrap();
    let busy = a4988::Error::Busy { until: LATER + TIMING.setup + TIMING.high };
    assert_eq!(motors.start(LATER + TIMING.setup), Err(Error { x: Some(busy), y: None }));
    analyser.now.set(LATER);
    motors.step(pulse(0, 1), LATER + TIMING.setup).unwrap();
    run(&analyser, &mut motors).unwrap();
    assert_eq!((analyser.rises("X STEP"), analyser.rises("Y STEP")), (1, 1));
}

#[test]
fn whichever_access_fails_both_motors_end_without_current() {
    let whole = Analyser::default();
    dance(&whole, &mut steppers(&whole)).unwrap();
    for fault in (0..whole.accesses()).flat_map(Fault::at) {
        let analyser = Analyser::failing(fault);
        let mut motors = steppers(&analyser);
        let error = dance(&analyser, &mut motors).unwrap_err();
        let failed = analyser.log().iter().find(|access| access.failed).unwrap().wire;
        if matches!(fault, Fault::All { .. }) {
            let at_it = if failed.starts_with('X') { error.x } else { error.y };
            assert_eq!(at_it, Some(a4988::Error::StillOn(pin_on(failed))), "{fault:?}");
        } else {
            let (x, y) = (failed.starts_with('X'), failed.starts_with('Y'));
            let pin = a4988::Error::Pin(pin_on(failed));
            assert_eq!(error, Error { x: x.then_some(pin), y: y.then_some(pin) }, "{fault:?}");
            assert!(is_off(&analyser, Axis::X) && is_off(&analyser, Axis::Y), "{fault:?}");
        }
        // The pulse of the other motor may still have to end; no new one comes.
        let rises = [analyser.rises("X STEP"), analyser.rises("Y STEP")];
        analyser.set_fault(Fault::None);
        run(&analyser, &mut motors).unwrap();
        assert!(motors.step(pulse(1, 1), analyser.now.get() + LATER).is_err());
        assert_eq!([analyser.rises("X STEP"), analyser.rises("Y STEP")], rises, "{fault:?}");
        // And a new start makes all good.
        analyser.now.set(analyser.now.get() + LATER);
        dance(&analyser, &mut motors).unwrap();
        assert_eq!([analyser.rises("X STEP"), analyser.rises("Y STEP")], [rises[0] + 2, rises[1] + 3]);
        assert_eq!(too_short(&analyser), [""; 0], "{fault:?}");
    }
}

#[test]
fn a_stop_tries_both_motors_whatever_fails() {
    let analyser = Analyser::default();
    let mut motors = steppers(&analyser);
    motors.start(Duration::ZERO).unwrap();
    let from = analyser.accesses();
    analyser.set_fault(Fault::All { at: from });
    let still_on = Some(a4988::Error::StillOn(PinError::Enable(Broken)));
    let error = motors.stop().unwrap_err();
    assert_eq!(error, Error { x: still_on, y: still_on });
    assert!(error.to_string().starts_with("axis x: ") && error.to_string().contains("; axis y: "), "{error}");
    for wire in ["X ENABLE", "X SLEEP", "Y ENABLE", "Y SLEEP"] {
        assert!(analyser.log()[from..].iter().any(|access| access.wire == wire), "{wire} was tried");
    }
}

fn bridges(analyser: &Analyser, dead_time: Duration) -> DcAxes<Bridge<'_>, Bridge<'_>> {
    let [x_enable, x_forward, x_reverse] = ["X EN", "X 1A", "X 2A"].map(|wire| analyser.wire(wire));
    let [y_enable, y_forward, y_reverse] = ["Y EN", "Y 1A", "Y 2A"].map(|wire| analyser.wire(wire));
    DcAxes::new(
        HBridge::new(Axis::X, x_enable, x_forward, x_reverse),
        HBridge::new(Axis::Y, y_enable, y_forward, y_reverse),
        dead_time,
    )
}

fn drive(gate: &SafetyGate, x: f32, y: f32) -> Drive<'_> {
    gate.pass(Demand { x: Duty::saturating(x), y: Duty::saturating(y) })
}

/// Voltages across both motors, in 200ths of the supply.
fn voltages(analyser: &Analyser) -> [i32; 2] {
    let level = |wire| i32::from(analyser.level(wire));
    [(level("X 1A") - level("X 2A")) * level("X EN"), (level("Y 1A") - level("Y 2A")) * level("Y EN")]
}

#[test]
fn both_dc_motors_take_their_shares_and_what_the_gate_takes_away() {
    let analyser = Analyser::default();
    let mut motors = bridges(&analyser, Duration::ZERO);
    let mut gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    motors.start().unwrap();
    motors.drive(drive(&gate, 0.5, -0.25), Duration::ZERO).unwrap();
    assert_eq!(voltages(&analyser), [100, -50]);
    gate.set_limits(LimitSwitches { x_max: true, ..LimitSwitches::default() });
    motors.drive(drive(&gate, 0.5, -0.25), Duration::ZERO).unwrap();
    assert_eq!(voltages(&analyser), [0, -50]);
    gate.emergency_stop(true);
    motors.drive(drive(&gate, -0.5, -0.25), Duration::ZERO).unwrap();
    assert_eq!(voltages(&analyser), [0, 0]);
}

#[test]
fn each_dc_motor_waits_for_its_own_dead_time() {
    let analyser = Analyser::default();
    let ms = Duration::from_millis;
    let mut motors = bridges(&analyser, ms(2));
    let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    motors.drive(drive(&gate, 0.5, 0.0), ms(0)).unwrap();
    motors.drive(drive(&gate, 0.5, 0.5), ms(1)).unwrap();
    assert_eq!((motors.due(), voltages(&analyser)), (Some(ms(2)), [0, 0]));
    motors.drive(drive(&gate, 0.5, 0.5), ms(2)).unwrap();
    // y has been free since the first drive as well.
    assert_eq!((motors.due(), voltages(&analyser)), (None, [100, 100]));
    motors.drive(drive(&gate, -0.5, 0.5), ms(10)).unwrap();
    assert_eq!((motors.due(), voltages(&analyser)), (Some(ms(12)), [0, 100]));
    motors.drive(drive(&gate, -0.5, -0.5), ms(11)).unwrap();
    motors.drive(drive(&gate, -0.5, -0.5), ms(12)).unwrap();
    assert_eq!((motors.due(), voltages(&analyser)), (Some(ms(13)), [-100, 0]));
    motors.stop().unwrap();
    assert_eq!((motors.due(), voltages(&analyser)), (None, [0, 0]));
}

#[test]
fn whichever_access_fails_both_dc_motors_end_without_drive() {
    let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    let scenario = |analyser: &Analyser| -> Result<(), DcError> {
        let mut motors = bridges(analyser, Duration::ZERO);
        motors.start()?;
        for (x, y) in [(0.5, -0.25), (-0.5, -0.5), (0.0, 1.0)] {
            motors.drive(drive(&gate, x, y), Duration::ZERO)?;
        }
        motors.stop()
    };
    let whole = Analyser::default();
    scenario(&whole).unwrap();
    for fault in (0..whole.accesses()).flat_map(Fault::at) {
        let analyser = Analyser::failing(fault);
        let error = scenario(&analyser).unwrap_err();
        for (failed, voltage) in [error.x, error.y].into_iter().zip(voltages(&analyser)) {
            let may_run = matches!(failed, Some(h_bridge::Error::NotStopped(_)));
            assert!(voltage == 0 || may_run, "{fault:?}: {error:?}");
            assert!(!may_run || matches!(fault, Fault::All { .. }), "{fault:?}: {error:?}");
        }
    }
}

#[test]
fn with_the_stop_pressed_at_power_up_no_motor_of_a_machine_moves_until_the_reset() {
    let analyser = Analyser::default();
    let (mut dc, mut steppers) = (bridges(&analyser, Duration::ZERO), steppers(&analyser));
    let mut gate = SafetyGate::new(LimitSwitches::RELEASED, true);
    dc.start().unwrap();
    steppers.start(Duration::ZERO).unwrap();
    for pressed in [true, false] {
        gate.emergency_stop(pressed);
        dc.drive(drive(&gate, 1.0, -1.0), LATER).unwrap();
        assert_eq!(gate.pass_step(StepPair { x: 1, y: 1 }), Err(Blocked::Stopped));
        assert_eq!(voltages(&analyser), [0, 0]);
    }
    assert!(gate.reset());
    dc.drive(drive(&gate, 1.0, -1.0), LATER).unwrap();
    assert_eq!(voltages(&analyser), [200, -200]);
}

/// A lift and a second motor of y beside the other two: each pulse goes to those that it is for.
#[cfg(feature = "third-motor")]
#[test]
fn a_third_motor_takes_its_own_share() {
    let analyser = Analyser::default();
    let wires = |names: [&'static str; 2]| names.map(|name| analyser.wire(name));
    let [x_step, x_dir] = wires(["X STEP", "X DIR"]);
    let [y_step, y_dir] = wires(["Y STEP", "Y DIR"]);
    let [z_step, z_dir] = wires(["Z STEP", "Z DIR"]);
    let [second_step, second_dir] = wires(["Y2 STEP", "Y2 DIR"]);
    let mut motors = StepperAxes::new(
        A4988::new(Axis::X, x_step, x_dir, TIMING),
        A4988::new(Axis::Y, y_step, y_dir, TIMING),
    );
    let mut lift = A4988::new(Axis::X, z_step, z_dir, TIMING).of_z();
    let mut second = A4988::new(Axis::Y, second_step, second_dir, TIMING).as_second();
    motors.start(Duration::ZERO).unwrap();
    lift.start(Duration::ZERO).unwrap();
    second.start(Duration::ZERO).unwrap();
    let pulses = [
        pulse(1, -1),
        GATE.pass_z_step(1).unwrap(),
        GATE.pass_apart(Axis::Y, [0, 1]).unwrap(),
        GATE.pass_apart(Axis::Y, [-1, 0]).unwrap(),
    ];
    for (pulse, at) in pulses.into_iter().zip(1..) {
        let at = LATER * at;
        analyser.now.set(at);
        motors.step(pulse, at).unwrap();
        lift.step(pulse, at).unwrap();
        second.step(pulse, at).unwrap();
        while let Some(due) = [motors.due(), lift.due(), second.due()].into_iter().flatten().min() {
            analyser.now.set(due);
            motors.tick(due).unwrap();
            lift.tick(due).unwrap();
            second.tick(due).unwrap();
        }
    }
    insta::assert_snapshot!(analyser.table(), @r"
           0 ns  X STEP   0
           0 ns  Y STEP   0
           0 ns  Z STEP   0
           0 ns  Y2 STEP  0
     5000000 ns  X DIR    1
     5000000 ns  Y DIR    0
     5000000 ns  Y2 DIR   0
     5000200 ns  X STEP   1
     5000200 ns  Y STEP   1
     5000200 ns  Y2 STEP  1
     5001200 ns  X STEP   0
     5001200 ns  Y STEP   0
     5001200 ns  Y2 STEP  0
    10000000 ns  Z DIR    1
    10000200 ns  Z STEP   1
    10001200 ns  Z STEP   0
    15000000 ns  Y2 DIR   1
    15000200 ns  Y2 STEP  1
    15001200 ns  Y2 STEP  0
    20000000 ns  Y STEP   1
    20001000 ns  Y STEP   0
    ");
}
