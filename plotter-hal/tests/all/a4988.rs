//! The stepper driver pin by pin and pulse by pulse, over a simulated clock, with faults put in.

use crate::logic_analyser;

use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::delay::{CheckedDelay, Transaction as Wait};
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Set};
use logic_analyser::{Analyser, Broken, Fault, Wire};
use plotter_hal::NoPin;
use plotter_hal::a4988::{A4988, Chip, Error, MicrostepPinError, MicrostepPins, PinError, Timing};
use plotter_motion::{
    Axis, Direction, LimitSwitches, SafetyGate, StepPair,
    safety::{Blocked, Pulse},
};
use std::io::ErrorKind;
use std::time::Duration;

const CHIPS: [Timing; 3] = [Timing::A4988, Timing::DRV8825, Timing::TMC2209];
/// Long after the wake-up.
const LATER: Duration = Duration::from_millis(5);

type Motor<'a> = A4988<Wire<'a>, Wire<'a>, Wire<'a>, Wire<'a>>;
type AnyPin = PinError<Broken, Broken, Broken, Broken>;

/// The pin whose access failed first.
fn first_failed(analyser: &Analyser) -> AnyPin {
    match analyser.log().iter().find(|access| access.failed).unwrap().wire {
        "STEP" => PinError::Step(Broken),
        "DIR" => PinError::Dir(Broken),
        "ENABLE" => PinError::Enable(Broken),
        "SLEEP" => PinError::Sleep(Broken),
        other => panic!("{other} is none of its pins"),
    }
}

/// Nothing is pressed.
static GATE: SafetyGate = SafetyGate::new(LimitSwitches::RELEASED, false);

fn pulse(x: i8) -> Pulse<'static> {
    GATE.pass_step(StepPair { x, y: 0 }).unwrap()
}

fn motor(analyser: &Analyser, timing: Timing) -> Motor<'_> {
    A4988::new(Axis::X, analyser.wire("STEP"), analyser.wire("DIR"), timing)
        .with_enable(analyser.wire("ENABLE"))
        .with_sleep(analyser.wire("SLEEP"))
}

/// A timer that calls as soon as the driver wants it.
fn run(analyser: &Analyser, motor: &mut Motor<'_>) -> Result<(), Error<AnyPin>> {
    while let Some(due) = motor.due() {
        analyser.now.set(analyser.now.get().max(due));
        motor.tick(analyser.now.get())?;
    }
    Ok(())
}

/// Start, two steps forwards and one back, each as soon as the chip takes it.
fn there_and_back(analyser: &Analyser, motor: &mut Motor<'_>) -> Result<(), Error<AnyPin>> {
    motor.start(analyser.now.get())?;
    for x in [1, 1, -1] {
        motor.step(pulse(x), analyser.now.get())?;
        run(analyser, motor)?;
    }
    motor.stop()
}

fn train(timing: Timing) -> String {
    let analyser = Analyser::default();
    there_and_back(&analyser, &mut motor(&analyser, timing)).unwrap();
    analyser.table()
}

#[test]
fn the_fastest_train_of_an_a4988() {
    insta::assert_snapshot!(train(Timing::A4988), @r"
            0 ns  STEP     0
            0 ns  SLEEP    1
            0 ns  ENABLE   0
            0 ns  DIR      1
      1000000 ns  STEP     1
      1001000 ns  STEP     0
      1002000 ns  STEP     1
      1003000 ns  STEP     0
      1003000 ns  DIR      0
      1004000 ns  STEP     1
      1005000 ns  STEP     0
      1005000 ns  ENABLE   1
    ");
}

#[test]
fn the_fastest_train_of_a_drv8825() {
    insta::assert_snapshot!(train(Timing::DRV8825), @r"
            0 ns  STEP     0
            0 ns  SLEEP    1
            0 ns  ENABLE   0
            0 ns  DIR      1
      1700000 ns  STEP     1
      1701900 ns  STEP     0
      1704000 ns  STEP     1
      1705900 ns  STEP     0
      1705900 ns  DIR      0
      1708000 ns  STEP     1
      1709900 ns  STEP     0
      1709900 ns  ENABLE   1
    ");
}

#[test]
fn the_fastest_train_of_a_tmc2209() {
    insta::assert_snapshot!(train(Timing::TMC2209), @r"
            0 ns  STEP     0
            0 ns  SLEEP    1
            0 ns  ENABLE   0
            0 ns  DIR      1
          110 ns  STEP     1
          220 ns  STEP     0
          330 ns  STEP     1
          440 ns  STEP     0
          440 ns  DIR      0
          550 ns  STEP     1
          660 ns  STEP     0
          660 ns  ENABLE   1
    ");
}

#[test]
fn the_blocking_form_makes_the_same_train() {
    for timing in CHIPS {
        let analyser = Analyser::default();
        let (mut motor, mut clock) = (motor(&analyser, timing), analyser.clock());
        motor.start_blocking(&mut clock).unwrap();
        for x in [1, 1, -1] {
            motor.step_blocking(pulse(x), &mut clock).unwrap();
        }
        assert_eq!(analyser.rises("STEP"), 3);
        assert_eq!(analyser.too_short("STEP", "DIR", timing), [""; 0]);
        assert_eq!(motor.due(), None);
        // It is ready at once for the form that does not wait, which takes the time from anywhere.
        motor.step(pulse(-1), analyser.now.get()).unwrap();
        run(&analyser, &mut motor).unwrap();
        // And that leaves nothing that a blocking step could cut short.
        motor.step_blocking(pulse(1), &mut clock).unwrap();
        assert_eq!(analyser.rises("STEP"), 5);
        assert_eq!(analyser.too_short("STEP", "DIR", timing), [""; 0]);
    }
}

#[test]
fn the_blocking_form_waits_for_these_times_and_no_others() {
    let step = Pin::new(&[Set::set(State::Low), Set::set(State::High), Set::set(State::Low)]);
    let dir = Pin::new(&[Set::set(State::High)]);
    let mut delay = CheckedDelay::new(&[
        Wait::delay_ns(1_000_000), // the charge pump
        Wait::delay_ns(200),       // DIR, setup
        Wait::delay_ns(1_000),     // STEP high
        Wait::delay_ns(1_000),     // STEP low
    ]);
    let mut motor = A4988::new(Axis::X, step, dir, Timing::A4988);
    motor.start_blocking(&mut delay).unwrap();
    motor.step_blocking(pulse(1), &mut delay).unwrap();
    let (mut step, mut dir, _, _) = motor.release();
    step.done();
    dir.done();
    delay.done();
}

#[test]
fn a_step_that_comes_too_early_is_put_off_and_a_second_one_refused() {
    let analyser = Analyser::default();
    let mut motor = motor(&analyser, Timing::A4988);
    motor.start(Duration::ZERO).unwrap();
    let awake = Duration::from_millis(1);
    assert_eq!(motor.step(pulse(1), Duration::ZERO), Ok(()));
    assert_eq!(motor.due(), Some(awake));
    assert_eq!(motor.step(pulse(1), Duration::ZERO), Err(Error::Busy { until: awake }));
    assert_eq!(motor.step(pulse(0), Duration::ZERO), Ok(())); // no step of this motor
    assert_eq!(analyser.rises("STEP"), 0);
    run(&analyser, &mut motor).unwrap();
    // One step was taken, and one is made.
    assert_eq!(analyser.edges("STEP"), [(awake, 1), (awake + Timing::A4988.high, 0)]);
}

#[test]
fn a_step_within_a_pulse_waits_for_its_end_and_for_the_low_time() {
    let analyser = Analyser::default();
    let timing = Timing::DRV8825;
    let mut motor = motor(&analyser, timing);
    motor.start(Duration::ZERO).unwrap();
    analyser.now.set(LATER);
    motor.step(pulse(1), LATER).unwrap();
    analyser.now.set(LATER + timing.setup);
    motor.tick(LATER + timing.setup).unwrap();
    assert_eq!(analyser.level("STEP"), 1);
    motor.step(pulse(-1), LATER + timing.setup).unwrap();
    assert_eq!(analyser.level("DIR"), 1, "DIR holds within the pulse");
    run(&analyser, &mut motor).unwrap();
    assert_eq!(analyser.rises("STEP"), 2);
    assert_eq!(analyser.too_short("STEP", "DIR", timing), [""; 0]);
}

#[test]
fn a_pulse_lasts_as_long_as_dir_must_hold() {
    let timing = Timing { hold: Duration::from_micros(5), ..Timing::A4988 };
    let analyser = Analyser::default();
    there_and_back(&analyser, &mut motor(&analyser, timing)).unwrap();
    assert_eq!(analyser.rises("STEP"), 3);
    assert_eq!(analyser.too_short("STEP", "DIR", timing), [""; 0]);
}

#[test]
fn late_ticks_make_times_longer_only() {
    let analyser = Analyser::default();
    let timing = Timing::A4988;
    let mut motor = motor(&analyser, timing);
    let late = Duration::from_micros(7);
    motor.start(Duration::ZERO).unwrap();
    for x in [1, -1, -1, 1] {
        motor.step(pulse(x), analyser.now.get()).unwrap();
        while let Some(due) = motor.due() {
            analyser.now.set(due.max(analyser.now.get()) + late);
            motor.tick(analyser.now.get()).unwrap();
        }
    }
    assert_eq!(analyser.rises("STEP"), 4);
    assert!(analyser.edges("STEP").windows(2).all(|edges| edges[1].0 - edges[0].0 >= timing.high + late));
    assert_eq!(analyser.too_short("STEP", "DIR", timing), [""; 0]);
}

#[test]
fn a_clock_of_whole_microseconds_does_not_cut_a_pulse() {
    let tick = Duration::from_micros(1);
    for (timing, is_enough) in [(Timing::A4988, false), (Timing::A4988.on_clock(tick), true)] {
        let analyser = Analyser::default();
        let mut motor = motor(&analyser, timing);
        let reading = || Duration::from_micros(u64::try_from(analyser.now.get().as_micros()).unwrap());
        analyser.now.set(Duration::from_nanos(900));
        motor.start(reading()).unwrap();
        for x in [1, 1, -1] {
            motor.step(pulse(x), reading()).unwrap();
            while let Some(due) = motor.due() {
                // An interrupt comes late, or in time; the reading is the same for a whole microsecond.
                let late = if analyser.level("STEP") == 0 { 900 } else { 0 };
                analyser.now.set(analyser.now.get().max(due) + Duration::from_nanos(late));
                motor.tick(reading()).unwrap();
            }
        }
        assert_eq!(analyser.too_short("STEP", "DIR", Timing::A4988).is_empty(), is_enough);
    }
}

#[test]
fn an_inverted_motor_turns_the_other_way() {
    let dir_after = |x, inverted| {
        let analyser = Analyser::default();
        let motor = motor(&analyser, Timing::A4988);
        let mut motor = if inverted { motor.with_inverted_direction() } else { motor };
        motor.start(Duration::ZERO).unwrap();
        motor.step(pulse(x), LATER).unwrap();
        analyser.level("DIR")
    };
    assert_eq!(
        [dir_after(1, false), dir_after(-1, false), dir_after(1, true), dir_after(-1, true)],
        [1, 0, 0, 1]
    );
}

#[test]
fn each_motor_takes_the_share_of_its_own_axis() {
    let analyser = Analyser::default();
    let mut y = A4988::new(Axis::Y, analyser.wire("STEP"), analyser.wire("DIR"), Timing::A4988);
    y.start(Duration::ZERO).unwrap();
    let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    y.step(gate.pass_step(StepPair { x: 1, y: 0 }).unwrap(), LATER).unwrap();
    assert_eq!(y.due(), None);
    y.step(gate.pass_step(StepPair { x: 1, y: -1 }).unwrap(), LATER).unwrap();
    assert_eq!(y.cancel(), Some(Direction::Minus));
}

#[test]
fn a_motor_that_is_off_takes_no_step() {
    let analyser = Analyser::default();
    let mut motor = motor(&analyser, Timing::A4988);
    assert_eq!(motor.step(pulse(1), LATER), Err(Error::Off));
    motor.start(Duration::ZERO).unwrap();
    motor.stop().unwrap();
    assert_eq!(motor.step(pulse(1), LATER), Err(Error::Off));
    assert_eq!(analyser.rises("STEP"), 0);
}

#[test]
fn a_stop_takes_the_current_at_once_and_does_not_cut_the_pulse() {
    let analyser = Analyser::default();
    let timing = Timing::A4988;
    let mut motor = motor(&analyser, timing);
    motor.start(Duration::ZERO).unwrap();
    motor.step(pulse(1), LATER).unwrap();
    let rise = LATER + timing.setup;
    analyser.now.set(rise);
    motor.tick(rise).unwrap();
    motor.step(pulse(1), rise).unwrap(); // put off
    motor.stop().unwrap();
    assert_eq!((analyser.level("ENABLE"), analyser.level("STEP")), (1, 1));
    assert_eq!(motor.start(rise), Err(Error::Busy { until: rise + timing.high }));
    run(&analyser, &mut motor).unwrap();
    assert_eq!(analyser.edges("STEP"), [(rise, 1), (rise + timing.high, 0)]);
    motor.start(analyser.now.get()).unwrap();
    assert_eq!(motor.due(), None, "the step that was put off is gone");
}

#[test]
fn a_step_that_waits_can_be_taken_back_and_the_motor_still_holds() {
    let analyser = Analyser::default();
    let mut motor = motor(&analyser, Timing::A4988);
    motor.start(Duration::ZERO).unwrap();
    motor.step(pulse(-1), LATER).unwrap();
    assert_eq!(motor.cancel(), Some(Direction::Minus));
    assert_eq!((motor.cancel(), motor.due()), (None, None));
    assert_eq!((analyser.rises("STEP"), analyser.level("ENABLE")), (0, 0));
    assert!(motor.is_on());
}

#[test]
fn sleep_switches_off_and_a_start_wakes() {
    let analyser = Analyser::default();
    let mut motor = motor(&analyser, Timing::DRV8825);
    motor.start(Duration::ZERO).unwrap();
    motor.sleep().unwrap();
    assert_eq!((analyser.level("ENABLE"), analyser.level("SLEEP")), (1, 0));
    motor.start(LATER).unwrap();
    motor.step(pulse(1), LATER).unwrap();
    assert_eq!(motor.due(), Some(LATER + Timing::DRV8825.wake));
}

#[test]
fn resolutions_of_the_chips() {
    let mut table = String::new();
    for chip in [Chip::A4988, Chip::Drv8825, Chip::Tmc2209] {
        for microsteps in 0..=256 {
            if let Some(levels) = chip.levels(microsteps) {
                let levels: String = levels.map(|high| if high { 'H' } else { 'L' }).iter().collect();
                table += &format!("{chip:?} {microsteps:>2} {levels}\n");
            }
        }
    }
    insta::assert_snapshot!(table, @r"
    A4988  1 LLL
    A4988  2 HLL
    A4988  4 LHL
    A4988  8 HHL
    A4988 16 HHH
    Drv8825  1 LLL
    Drv8825  2 HLL
    Drv8825  4 LHL
    Drv8825  8 HHL
    Drv8825 16 LLH
    Drv8825 32 HHH
    Tmc2209  8 LLL
    Tmc2209 16 HHL
    Tmc2209 32 HLL
    Tmc2209 64 LHL
    ");
}

#[test]
fn the_resolution_is_set_between_pulses_and_before_the_setup_time() {
    let analyser = Analyser::default();
    let timing = Timing::DRV8825;
    let mut motor = motor(&analyser, timing);
    let mut pins = MicrostepPins::new(
        Chip::Drv8825,
        analyser.wire("MODE0"),
        analyser.wire("MODE1"),
        analyser.wire("MODE2"),
    );
    motor.start(Duration::ZERO).unwrap();
    motor.step(pulse(1), LATER).unwrap();
    let busy = Err(Error::Busy { until: LATER + timing.setup });
    assert_eq!(motor.set_microsteps(&mut pins, 32, LATER), busy);
    analyser.now.set(LATER);
    run(&analyser, &mut motor).unwrap();

    let now = analyser.now.get() + LATER;
    assert_eq!(motor.set_microsteps(&mut pins, 3, now), Err(Error::Microsteps(3)));
    motor.set_microsteps(&mut pins, 32, now).unwrap();
    assert_eq!(["MODE0", "MODE1", "MODE2"].map(|wire| analyser.level(wire)), [1, 1, 1]);
    motor.step(pulse(1), now).unwrap(); // the same direction: DIR needs no time
    assert_eq!(motor.due(), Some(now + timing.setup));
}

#[test]
fn a_resolution_pin_that_fails_switches_the_motor_off() {
    for chip_pin in 0..3 {
        let analyser = Analyser::default();
        let mut motor = motor(&analyser, Timing::A4988);
        motor.start(Duration::ZERO).unwrap();
        let [ms1, ms2, ms3] = ["MS1", "MS2", "MS3"].map(|wire| analyser.wire(wire));
        let mut pins = MicrostepPins::new(Chip::A4988, ms1, ms2, ms3);
        analyser.set_fault(Fault::Once { at: analyser.accesses() + chip_pin, takes_effect: false });
        let failed =
            [MicrostepPinError::Ms1(Broken), MicrostepPinError::Ms2(Broken), MicrostepPinError::Ms3(Broken)];
        assert_eq!(motor.set_microsteps(&mut pins, 16, LATER), Err(Error::Pin(failed[chip_pin])));
        assert_eq!(analyser.level("ENABLE"), 1);
    }
}

/// Whether the fault is one after which ENABLE or SLEEP can still switch the motor off.
fn can_be_switched_off(fault: Fault) -> bool {
    !matches!(fault, Fault::All { .. })
}

#[test]
fn whichever_access_fails_the_motor_ends_without_current_and_says_so() {
    let whole = Analyser::default();
    there_and_back(&whole, &mut motor(&whole, Timing::A4988)).unwrap();
    for fault in (0..whole.accesses()).flat_map(Fault::at) {
        let analyser = Analyser::failing(fault);
        let mut motor = motor(&analyser, Timing::A4988);
        let outcome = there_and_back(&analyser, &mut motor);
        let rises = analyser.rises("STEP");
        if can_be_switched_off(fault) {
            assert_eq!(outcome, Err(Error::Pin(first_failed(&analyser))), "{fault:?}");
            assert!(analyser.level("ENABLE") == 1 || analyser.level("SLEEP") == 0, "{fault:?}");
        } else {
            assert_eq!(outcome, Err(Error::StillOn(first_failed(&analyser))), "{fault:?}");
        }

        // No tick makes a step any more, and none is taken.
        analyser.set_fault(Fault::None);
        assert_eq!((motor.is_on(), motor.due()), (false, None), "{fault:?}");
        motor.tick(analyser.now.get() + LATER).unwrap();
        assert_eq!(motor.step(pulse(1), analyser.now.get() + LATER), Err(Error::Off));
        assert_eq!(analyser.rises("STEP"), rises, "{fault:?}");

        // A new start makes all good again, and no pulse was short.
        analyser.now.set(analyser.now.get() + LATER);
        there_and_back(&analyser, &mut motor).unwrap();
        assert_eq!(analyser.rises("STEP"), rises + 3, "{fault:?}");
        assert_eq!(analyser.too_short("STEP", "DIR", Timing::A4988), [""; 0], "{fault:?}");
    }
}

#[test]
fn whichever_access_of_the_blocking_form_fails_the_motor_ends_without_current() {
    let scenario = |analyser: &Analyser| {
        let (mut motor, mut clock) = (motor(analyser, Timing::DRV8825), analyser.clock());
        motor.start_blocking(&mut clock)?;
        motor.step_blocking(pulse(1), &mut clock)?;
        motor.step_blocking(pulse(-1), &mut clock)?;
        motor.sleep()
    };
    let whole = Analyser::default();
    scenario(&whole).unwrap();
    assert_eq!(whole.rises("STEP"), 2);
    for fault in (0..whole.accesses()).flat_map(Fault::at) {
        let analyser = Analyser::failing(fault);
        let outcome = scenario(&analyser);
        if can_be_switched_off(fault) {
            assert_eq!(outcome, Err(Error::Pin(first_failed(&analyser))), "{fault:?}");
            assert!(analyser.level("ENABLE") == 1 || analyser.level("SLEEP") == 0, "{fault:?}");
        } else {
            assert_eq!(outcome, Err(Error::StillOn(first_failed(&analyser))), "{fault:?}");
        }
        assert_eq!(analyser.too_short("STEP", "DIR", Timing::DRV8825), [""; 0], "{fault:?}");
    }
}

#[test]
fn an_enable_that_fails_for_good_is_replaced_by_sleep() {
    let fault = MockError::Io(ErrorKind::NotConnected);
    let off = || Set::set(State::High).with_error(fault.clone());
    let step = Pin::new(&[Set::set(State::Low)]);
    let enable = Pin::new(&[Set::set(State::Low), off(), off(), off()]);
    let sleep = Pin::new(&[Set::set(State::High), Set::set(State::Low)]);
    let mut motor =
        A4988::new(Axis::X, step, Pin::new(&[]), Timing::A4988).with_enable(enable).with_sleep(sleep);
    motor.start(Duration::ZERO).unwrap();
    let error = motor.stop().unwrap_err();
    assert_eq!(error, Error::Pin(PinError::Enable(fault.clone())));
    assert!(error.to_string().ends_with("it has no current"), "{error}");
    let (mut step, mut dir, mut enable, mut sleep) = motor.release();
    step.done();
    dir.done();
    enable.done();
    sleep.done();
}

#[test]
fn a_motor_without_enable_and_sleep_may_hold_after_a_fault() {
    let analyser = Analyser::default();
    let mut motor = A4988::new(Axis::X, analyser.wire("STEP"), analyser.wire("DIR"), Timing::A4988);
    motor.start(Duration::ZERO).unwrap();
    analyser.set_fault(Fault::Once { at: analyser.accesses(), takes_effect: false });
    let error = motor.step(pulse(1), LATER).unwrap_err();
    assert_eq!(error, Error::StillOn(PinError::Dir(Broken)));
    assert!(error.to_string().contains("gets no steps"), "{error}");
    assert_eq!(motor.stop(), Ok(()));
    let (_, _, NoPin, NoPin) = motor.release();
}

#[test]
fn after_a_watchdog_bite_within_a_pulse_a_start_makes_no_step() {
    // What was before the bite: STEP high, the outputs on.
    let analyser = Analyser::default();
    {
        let mut before = motor(&analyser, Timing::A4988);
        before.start(Duration::ZERO).unwrap();
        before.step(pulse(-1), LATER).unwrap();
        before.tick(LATER * 2).unwrap();
    }
    assert_eq!((analyser.level("STEP"), analyser.level("ENABLE")), (1, 0));

    analyser.now.set(Duration::from_secs(1));
    let mut motor = motor(&analyser, Timing::A4988);
    assert_eq!(motor.step(pulse(1), Duration::ZERO), Err(Error::Off));
    motor.start(Duration::ZERO).unwrap(); // the clock began anew too
    assert_eq!(["STEP", "ENABLE", "SLEEP"].map(|wire| analyser.level(wire)), [0, 0, 1]);
    assert_eq!(analyser.rises("STEP"), 1, "the one before");
    assert_eq!(motor.due(), None);
}

#[test]
fn with_the_stop_pressed_at_power_up_nothing_moves_until_the_reset() {
    let analyser = Analyser::default();
    let mut motor = motor(&analyser, Timing::A4988);
    let mut gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    gate.emergency_stop(true);
    motor.start(Duration::ZERO).unwrap();
    let mut try_step = |gate: &SafetyGate, now| {
        gate.pass_step(StepPair { x: 1, y: 0 }).map(|pulse| motor.step(pulse, now).unwrap())
    };
    assert_eq!(try_step(&gate, LATER), Err(Blocked::Stopped));
    gate.emergency_stop(false);
    assert_eq!(try_step(&gate, LATER), Err(Blocked::Stopped));
    assert!(gate.reset());
    assert_eq!(try_step(&gate, LATER), Ok(()));
    analyser.now.set(LATER);
    assert_eq!(analyser.rises("STEP"), 0);
    run(&analyser, &mut motor).unwrap();
    assert_eq!(analyser.rises("STEP"), 1);
}
