//! The laser duty by duty, with faults put in at every access.

use crate::faulty;

use core::time::Duration;
use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as SetDuty};
use faulty::{Broken, Output};
use plotter_hal::Laser;
use plotter_hal::laser::Error;
use plotter_motion::firmware::stepper_plotter::{Dialect, Drivers, StepperPlotter, StepperPlotterSettings};
use plotter_motion::{LimitSwitches, SafetyGate, safety::Beam};
use proptest::prelude::*;
use std::io::ErrorKind;

/// Steps of the PWM in these tests: the documented machine's.
const FULL: u16 = 999;
const TIMEOUT: Duration = Duration::from_millis(20);

fn ms(ms: u64) -> Duration {
    Duration::from_millis(ms)
}

/// Nothing is pressed.
static GATE: SafetyGate = SafetyGate::new(LimitSwitches::RELEASED, false);

fn beam(power: u16) -> Beam<'static> {
    GATE.pass_laser(power)
}

#[test]
fn it_is_lit_in_motion_only_and_follows_the_beam() {
    let output = Output::default();
    let mut laser = Laser::new(output.pwm(FULL), TIMEOUT);
    laser.shine(ms(0), beam(65_535)).unwrap();
    assert!(!laser.is_lit(), "it stands");
    laser.moved(ms(5)).unwrap();
    laser.shine(ms(10), beam(32_768)).unwrap();
    laser.moved(ms(15)).unwrap();
    laser.shine(ms(16), Beam::OFF).unwrap();
    assert_eq!(output.duties(), [0, 999, 499, 0]);
}

#[test]
fn a_pause_darkens_it_and_the_next_movement_does_not_light_it_by_itself() {
    let output = Output::default();
    let mut laser = Laser::new(output.pwm(FULL), TIMEOUT);
    laser.moved(ms(0)).unwrap();
    laser.shine(ms(0), beam(65_535)).unwrap();
    assert_eq!(laser.due(), Some(ms(20)));
    laser.tick(ms(19)).unwrap();
    assert!(laser.is_lit());
    laser.tick(ms(20)).unwrap();
    assert!(!laser.is_lit());
    assert_eq!(laser.due(), None);
    laser.moved(ms(30)).unwrap();
    assert!(!laser.is_lit(), "the beam before the pause is forgotten");
    laser.shine(ms(31), beam(65_535)).unwrap();
    assert!(laser.is_lit());
}

#[test]
fn a_tick_that_comes_late_is_made_up_for_by_whatever_call_comes_first() {
    for late in [
        |laser: &mut Laser<faulty::Pwm<'_>>| laser.tick(ms(500)),
        |laser: &mut Laser<faulty::Pwm<'_>>| laser.moved(ms(500)),
        |laser: &mut Laser<faulty::Pwm<'_>>| laser.shine(ms(500), beam(1000)),
    ] {
        let output = Output::default();
        let mut laser = Laser::new(output.pwm(FULL), TIMEOUT);
        laser.moved(ms(0)).unwrap();
        laser.shine(ms(0), beam(65_535)).unwrap();
        late(&mut laser).unwrap();
        assert_eq!(output.duty(), 0);
    }
}

#[test]
fn a_beam_that_waited_too_long_for_motion_is_forgotten() {
    let output = Output::default();
    let mut laser = Laser::new(output.pwm(FULL), TIMEOUT);
    laser.shine(ms(0), beam(65_535)).unwrap();
    laser.moved(ms(20)).unwrap();
    assert_eq!(output.duties(), [0]);
}

#[test]
fn dropped_or_given_back_in_the_middle_of_a_line_it_is_dark() {
    let output = Output::default();
    {
        let mut laser = Laser::new(output.pwm(FULL), TIMEOUT);
        laser.moved(ms(0)).unwrap();
        laser.shine(ms(0), beam(65_535)).unwrap();
        assert_eq!(output.duty(), FULL);
    }
    assert_eq!(output.duty(), 0);

    let pwm = Pwm::new(&[
        SetDuty::set_duty_cycle(0),
        SetDuty::max_duty_cycle(FULL),
        SetDuty::set_duty_cycle(FULL),
        SetDuty::set_duty_cycle(0),
    ]);
    let mut laser = Laser::new(pwm, TIMEOUT);
    laser.moved(ms(0)).unwrap();
    laser.shine(ms(0), beam(65_535)).unwrap();
    let (pwm, dark) = laser.release();
    dark.unwrap();
    pwm.unwrap().done();
}

#[test]
fn a_laser_that_was_lit_when_the_chip_was_reset_is_darkened_first() {
    // The watchdog bit in the middle of a line, and the timer went on.
    let output = Output { journal: vec![(700, true)].into(), failing: vec![] };
    let laser = Laser::new(output.pwm(FULL), TIMEOUT);
    assert!(!laser.is_lit());
    assert_eq!(output.duty(), 0);
}

/// What the calls of one movement say, in order.
fn line(laser: &mut Laser<Pwm>) -> Vec<Result<(), Error<MockError>>> {
    vec![
        laser.shine(ms(0), beam(65_535)),
        laser.moved(ms(1)),
        laser.shine(ms(2), beam(32_768)),
        laser.tick(ms(30)),
        laser.off(),
    ]
}

#[test]
fn whichever_access_fails_it_ends_dark_and_says_so() {
    let fault = MockError::Io(ErrorKind::NotConnected);
    let set = SetDuty::set_duty_cycle;
    let max = || SetDuty::max_duty_cycle(FULL);
    let failed = |duty| SetDuty::set_duty_cycle(duty).with_error(fault.clone());
    let cases: [(Vec<SetDuty>, Option<usize>); 6] = [
        // None: new, lit, weaker, out, off, dropped.
        (vec![set(0), max(), set(999), max(), set(499), set(0), set(0), set(0)], None),
        // In `new`: darkened at the second attempt, and a failure that is over is none.
        (vec![failed(0), set(0), max(), set(999), max(), set(499), set(0), set(0), set(0)], None),
        // Lit: darkened. What follows in the same movement stays dark until it is asked for again.
        (vec![set(0), max(), failed(999), set(0), max(), set(499), set(0), set(0), set(0)], Some(1)),
        (vec![set(0), max(), set(999), max(), failed(499), set(0), set(0), set(0)], Some(2)),
        // Out.
        (vec![set(0), max(), set(999), max(), set(499), failed(0), set(0), set(0), set(0)], Some(3)),
        // Off.
        (vec![set(0), max(), set(999), max(), set(499), set(0), failed(0), set(0), set(0)], Some(4)),
    ];
    for (transactions, failing) in cases {
        let mut check = Pwm::new(&transactions);
        let mut laser = Laser::new(check.clone(), TIMEOUT);
        for (number, result) in line(&mut laser).into_iter().enumerate() {
            let expected = if failing == Some(number) { Err(Error::Pwm(fault.clone())) } else { Ok(()) };
            assert_eq!(result, expected, "call {number}, {failing:?} failing");
        }
        drop(laser);
        check.done();
    }
}

#[test]
fn one_that_cannot_be_darkened_says_so_again_and_again() {
    for first in 0..6 {
        let output = Output::failing_at(first..100);
        let mut laser = Laser::new(output.pwm(FULL), TIMEOUT);
        for (at, power) in [(0, 20_000), (1, 40_000), (2, 20_000), (3, 40_000)] {
            let result = laser.moved(ms(at));
            assert_eq!(result == Err(Error::NotOff(Broken)), output.accesses() > first, "{first}");
            let result = laser.shine(ms(at), beam(power));
            assert_eq!(result == Err(Error::NotOff(Broken)), output.accesses() > first, "{first}");
        }
        assert!(laser.is_lit());
        assert!(laser.due().is_some_and(|due| due <= ms(23)), "it must be tried again");
        let error = laser.tick(ms(100)).unwrap_err();
        assert!(error.to_string().ends_with("cut its supply"), "{error}");
    }
}

#[test]
fn after_a_fault_it_stays_dark_until_it_is_asked_for_again() {
    let output = Output::failing_at([1]);
    let mut laser = Laser::new(output.pwm(FULL), TIMEOUT);
    laser.moved(ms(0)).unwrap();
    assert_eq!(laser.shine(ms(0), beam(65_535)), Err(Error::Pwm(Broken)));
    for at in 1..10 {
        laser.moved(ms(at)).unwrap();
        laser.tick(ms(at)).unwrap();
    }
    assert_eq!(output.duties(), [0, 0]);
    laser.shine(ms(10), beam(65_535)).unwrap();
    assert_eq!(output.duty(), FULL);
}

#[test]
fn an_emergency_stop_in_the_middle_of_a_line_darkens_it_in_the_same_call() {
    let settings =
        StepperPlotterSettings { dialect: Dialect::Grbl, laser: true, ..StepperPlotterSettings::default() };
    let mut plotter = StepperPlotter::new(settings, SafetyGate::new(LimitSwitches::RELEASED, false)).unwrap();
    let output = Output::default();
    let mut laser = Laser::new(output.pwm(FULL), TIMEOUT);
    for byte in "M3 S1000\nG1 X20 Y10 F1200\n".bytes() {
        plotter.receive(ms(0), byte);
    }
    let (mut now, mut brightest, mut steps_after) = (ms(0), 0, 0);
    loop {
        while let Some(step) = plotter.poll(now, Drivers::Ready) {
            laser.moved(step.at).unwrap();
            steps_after += u32::from(plotter.status(now).emergency_stop);
        }
        while plotter.transmit(now).is_some() {}
        if now > ms(600) && !plotter.status(now).emergency_stop {
            plotter.emergency_stop(now, true);
            laser.shine(now, plotter.beam()).unwrap();
            assert_eq!(output.duty(), 0, "dark as soon as the controller is");
        }
        laser.shine(now, plotter.beam()).unwrap();
        brightest = brightest.max(output.duty());
        let Some(due) = plotter.due() else { break };
        now = due;
    }
    assert!(brightest > 900, "{brightest}: it was lit before");
    assert_eq!((output.duty(), steps_after), (0, 0));
}

#[derive(Clone, Copy, Debug)]
enum Call {
    Shine(u16),
    Moved,
    Tick,
    Off,
}

fn call() -> impl Strategy<Value = Call> {
    prop_oneof![
        3 => prop_oneof![Just(0), any::<u16>()].prop_map(Call::Shine),
        4 => Just(Call::Moved),
        2 => Just(Call::Tick),
        1 => Just(Call::Off),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever is called and whichever accesses fail: there is light only as asked for and within `TIMEOUT`
    /// of a motion, and an error that does not say otherwise leaves it dark.
    #[test]
    fn it_is_never_lit_without_motion(
        calls in prop::collection::vec((0..40_u64, call(), prop::bool::weighted(0.1)), 1..60),
        failing in prop::collection::vec(0..80_usize, 0..8),
    ) {
        let output = Output::failing_at(failing);
        let mut laser = Laser::new(output.pwm(FULL), TIMEOUT);
        let (mut now, mut gate) = (ms(0), SafetyGate::new(LimitSwitches::RELEASED, false));
        let (mut asked, mut moved) = (0, None);
        for (pause_ms, call, stop) in calls {
            now += ms(pause_ms);
            gate.emergency_stop(stop);
            let result = match call {
                Call::Shine(power) => {
                    asked = gate.pass_laser(power).power();
                    laser.shine(now, gate.pass_laser(power))
                }
                Call::Moved => {
                    moved = Some(now);
                    laser.moved(now)
                }
                Call::Tick => laser.tick(now),
                Call::Off => {
                    asked = 0;
                    laser.off()
                }
            };
            match result {
                Ok(()) => {
                    let moves = moved.is_some_and(|at| now - at < TIMEOUT);
                    let most = if moves { u32::from(asked) * u32::from(FULL) / 65_535 } else { 0 };
                    // Dark instead after a pause or a fault.
                    prop_assert!(u32::from(output.duty()) == most || output.duty() == 0);
                    prop_assert!(laser.is_lit() || output.duty() == 0);
                }
                Err(Error::Pwm(Broken)) => prop_assert_eq!(output.duty(), 0),
                Err(_) => prop_assert!(laser.is_lit()),
            }
        }
        let before = output.accesses();
        drop(laser);
        let failed = output.journal.borrow()[before..].iter().all(|(_, worked)| !worked);
        prop_assert!(failed || output.duty() == 0);
    }
}
