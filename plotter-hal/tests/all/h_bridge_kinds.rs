//! Every kind of bridge by what its motor sees: the voltage that follows from the levels of the pins by the
//! tables of the datasheets, at every access, with faults put in.

use crate::logic_analyser;

use logic_analyser::{Analyser, FULL, Fault, Wire};
use plotter_hal::HBridge;
use plotter_hal::h_bridge::{Bridge, Bts7960, DeadTime, Decay, Drv8833, Drv8871, Error, Tb6612};
use plotter_motion::{Axis, Demand, Drive, Duty, LimitSwitches, SafetyGate};
use std::collections::BTreeMap;
use std::time::Duration;

/// Nothing is pressed.
static GATE: SafetyGate = SafetyGate::new(LimitSwitches::RELEASED, false);

fn drive(x: f32) -> Drive<'static> {
    GATE.pass(Demand { x: Duty::saturating(x), y: Duty::FULL })
}

/// The kinds, each on the wires of its own names.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    L293d,
    Drv8871(Decay),
    /// With nSLEEP.
    Drv8833(Decay),
    /// With both enables.
    Bts7960,
    Tb6612,
}

const KINDS: [Kind; 7] = [
    Kind::L293d,
    Kind::Drv8871(Decay::Fast),
    Kind::Drv8871(Decay::Slow),
    Kind::Drv8833(Decay::Fast),
    Kind::Drv8833(Decay::Slow),
    Kind::Bts7960,
    Kind::Tb6612,
];

/// What an error says of the motor, for any pin type.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Failed {
    Stopped,
    NotStopped,
}

impl<Pin, Pwm> From<Error<Pin, Pwm>> for Failed {
    fn from(error: Error<Pin, Pwm>) -> Self {
        if matches!(error, Error::NotStopped(_)) { Self::NotStopped } else { Self::Stopped }
    }
}

impl Kind {
    /// Voltage across the motor in 200ths of the supply, by the table of the datasheet.
    fn voltage(self, levels: &BTreeMap<&'static str, u16>) -> i32 {
        let level = |wire| i32::from(levels.get(wire).copied().unwrap_or(0));
        match self {
            Self::L293d => (level("1A") - level("2A")) * level("EN"),
            // Never both modulated, so that their difference is the mean voltage.
            Self::Drv8871(_) => level("IN1") - level("IN2"),
            Self::Drv8833(_) => level("SLEEP") * (level("IN1") - level("IN2")),
            Self::Bts7960 => level("R_EN") * level("L_EN") * (level("RPWM") - level("LPWM")),
            Self::Tb6612 => level("STBY") * (level("IN1") - level("IN2")) * level("PWM"),
        }
    }

    /// The voltage now.
    fn now(self, analyser: &Analyser) -> i32 {
        analyser.history().last().map_or(0, |(_, levels)| self.voltage(levels))
    }

    /// Runs `scenario` on a bridge of this kind.
    fn run<T>(self, analyser: &Analyser, scenario: impl Scenario<T>) -> T {
        match self {
            Self::L293d => {
                let [enable, forward, reverse] = ["EN", "1A", "2A"].map(|wire| analyser.wire(wire));
                scenario.on(HBridge::new(Axis::X, enable, forward, reverse))
            }
            Self::Drv8871(decay) => {
                scenario.on(Drv8871::new(Axis::X, analyser.wire("IN1"), analyser.wire("IN2"), decay))
            }
            Self::Drv8833(decay) => {
                let [in1, in2, sleep] = ["IN1", "IN2", "SLEEP"].map(|wire| analyser.wire(wire));
                scenario.on(Drv8833::new(Axis::X, in1, in2, decay).with_sleep(sleep))
            }
            Self::Bts7960 => {
                let [right, left, r_en, l_en] =
                    ["RPWM", "LPWM", "R_EN", "L_EN"].map(|wire| analyser.wire(wire));
                scenario.on(Bts7960::new(Axis::X, right, left, r_en, l_en))
            }
            Self::Tb6612 => {
                let [pwm, in1, in2, stby] = ["PWM", "IN1", "IN2", "STBY"].map(|wire| analyser.wire(wire));
                scenario.on(Tb6612::new(Axis::X, pwm, in1, in2).with_standby(stby))
            }
        }
    }
}

/// What is done with a bridge, of whatever type.
trait Scenario<T> {
    fn on<B: Bridge<Error: Into<Failed>>>(self, bridge: B) -> T;
}

/// A start, then these drives, up to the first error; a drive of `None` is a stop.
struct Drives<'a>(&'a [Option<f32>]);

impl Scenario<Result<(), Failed>> for Drives<'_> {
    fn on<B: Bridge<Error: Into<Failed>>>(self, mut bridge: B) -> Result<(), Failed> {
        bridge.start().map_err(Into::into)?;
        for duty in self.0 {
            match *duty {
                Some(duty) => bridge.drive(drive(duty)),
                None => bridge.stop(),
            }
            .map_err(Into::into)?;
        }
        Ok(())
    }
}

/// Both directions, both reversals, another duty of the same direction, rest by either way.
const EVERYTHING: [Option<f32>; 8] =
    [Some(0.5), Some(0.25), Some(-0.75), Some(0.0), Some(-1.0), Some(1.0), None, Some(-0.5)];

#[test]
fn every_duty_is_the_share_of_the_supply_on_the_motor() {
    for kind in KINDS {
        for duty in [0.5, -0.25, 1.0, -1.0, 0.0, 0.005] {
            let analyser = Analyser::default();
            kind.run(&analyser, Drives(&[Some(0.5), Some(duty)])).unwrap();
            #[expect(clippy::cast_possible_truncation, reason = "at most 200")]
            let wanted = (duty * f32::from(FULL)).round() as i32;
            assert_eq!(kind.now(&analyser), wanted, "{kind:?} {duty}");
        }
    }
}

#[test]
fn a_start_brings_every_pin_into_a_known_state_without_drive() {
    for kind in KINDS {
        let analyser = Analyser::default();
        kind.run(&analyser, Drives(&[])).unwrap();
        let history = analyser.history();
        assert!(history.iter().all(|(_, levels)| kind.voltage(levels) == 0), "{kind:?}");
        let pins = match kind {
            Kind::Drv8871(_) => 2,
            Kind::L293d | Kind::Drv8833(_) => 3,
            Kind::Bts7960 | Kind::Tb6612 => 4,
        };
        assert_eq!(history.last().unwrap().1.len(), pins, "{kind:?}");
    }
}

#[test]
fn after_a_watchdog_bite_under_drive_a_start_takes_the_drive_away() {
    for kind in KINDS {
        for duty in [0.5, -1.0] {
            // The driver before the bite is gone, and its pins are as they were.
            let analyser = Analyser::default();
            kind.run(&analyser, Drives(&[Some(duty)])).unwrap();
            assert_ne!(kind.now(&analyser), 0);
            kind.run(&analyser, Drives(&[])).unwrap();
            assert_eq!(kind.now(&analyser), 0, "{kind:?}");
            kind.run(&analyser, Drives(&[Some(-duty)])).unwrap();
            assert_eq!(kind.now(&analyser).is_positive(), duty < 0.0, "{kind:?}");
        }
    }
}

#[test]
fn no_access_on_the_way_drives_the_motor_elsewhere_than_asked() {
    for kind in KINDS {
        for (number, duty) in EVERYTHING.iter().enumerate() {
            let before = Analyser::default();
            kind.run(&before, Drives(&EVERYTHING[..number])).unwrap();
            let analyser = Analyser::default();
            kind.run(&analyser, Drives(&EVERYTHING[..=number])).unwrap();
            let (old, asked) = (kind.now(&before), kind.now(&analyser));
            // At the first drive after coasting, slow decay passes by the whole supply in the direction
            // asked.
            let is_slow = matches!(kind, Kind::Drv8871(Decay::Slow) | Kind::Drv8833(Decay::Slow));
            let is_first_slow = number == 0 && is_slow;
            let most = if is_first_slow { asked.signum() * i32::from(FULL) } else { asked };
            let on_the_way = analyser.history()[before.accesses()..]
                .iter()
                .map(|(_, levels)| kind.voltage(levels))
                .skip_while(|&voltage| voltage == old)
                .collect::<Vec<_>>();
            assert!(
                on_the_way.iter().all(|voltage| [0, asked, most].contains(voltage)),
                "{kind:?} {duty:?}: {on_the_way:?}"
            );
        }
    }
}

#[test]
fn whichever_access_fails_the_motor_has_no_voltage_or_the_error_says_so() {
    for kind in KINDS {
        let whole = Analyser::default();
        kind.run(&whole, Drives(&EVERYTHING)).unwrap();
        for fault in (0..whole.accesses()).flat_map(Fault::at) {
            let analyser = Analyser::failing(fault);
            let failed = kind.run(&analyser, Drives(&EVERYTHING)).unwrap_err();
            if failed == Failed::Stopped {
                assert_eq!(kind.now(&analyser), 0, "{kind:?} {fault:?}");
            }
            // A fault that passes never leaves the motor driven; nor does one pin, where there is another
            // way.
            let has_another_way = !matches!(kind, Kind::Drv8871(_));
            match fault {
                Fault::Once { .. } => assert_eq!(failed, Failed::Stopped, "{kind:?} {fault:?}"),
                Fault::Wire { .. } if has_another_way => {
                    assert_eq!(failed, Failed::Stopped, "{kind:?} {fault:?}");
                }
                _ => {}
            }
            if fault == (Fault::All { at: 0 }) {
                assert_eq!(failed, Failed::NotStopped, "{kind:?}");
            }
        }
    }
}

#[test]
fn two_faults_in_a_row_do_not_leave_a_motor_driven_either() {
    for kind in KINDS {
        let whole = Analyser::default();
        kind.run(&whole, Drives(&EVERYTHING)).unwrap();
        for at in 0..whole.accesses() {
            for later in 1..=3 {
                let fault = Fault::Two { at, later };
                let analyser = Analyser::failing(fault);
                let failed = kind.run(&analyser, Drives(&EVERYTHING)).unwrap_err();
                assert_eq!((failed, kind.now(&analyser)), (Failed::Stopped, 0), "{kind:?} {fault:?}");
            }
        }
    }
}

/// A fault in the middle, then all is well again.
struct Recovery<'a>(&'a Analyser, Fault);

impl Scenario<()> for Recovery<'_> {
    fn on<B: Bridge<Error: Into<Failed>>>(self, mut bridge: B) {
        let Self(analyser, fault) = self;
        let _ = bridge.start();
        analyser.set_fault(fault);
        let failed =
            EVERYTHING.iter().filter(|duty| bridge.drive(drive(duty.unwrap_or(0.0))).is_err()).count();
        assert!(failed > 0, "{fault:?}");
        analyser.set_fault(Fault::None);
        assert!(bridge.drive(drive(-0.5)).is_ok());
    }
}

#[test]
fn after_a_fault_the_next_drive_is_the_one_asked() {
    for kind in KINDS {
        let started = Analyser::default();
        kind.run(&started, Drives(&[])).unwrap();
        let whole = Analyser::default();
        kind.run(&whole, Drives(&EVERYTHING)).unwrap();
        for fault in (started.accesses()..whole.accesses()).flat_map(Fault::at) {
            let analyser = Analyser::default();
            kind.run(&analyser, Recovery(&analyser, fault));
            assert_eq!(kind.now(&analyser), -100, "{kind:?} {fault:?}");
        }
    }
}

#[test]
fn slow_decay_goes_through_the_brake() {
    let analyser = Analyser::default();
    Kind::Drv8871(Decay::Slow).run(&analyser, Drives(&[Some(0.25), Some(-0.25), None])).unwrap();
    insta::assert_snapshot!(analyser.table(), @r"
    0 ns  IN1      0
    0 ns  IN2      0
    0 ns  IN1      200
    0 ns  IN2      150
    0 ns  IN2      200
    0 ns  IN1      150
    0 ns  IN1      200
    0 ns  IN2      200
    ");
}

#[test]
fn fast_decay_goes_through_coasting() {
    let analyser = Analyser::default();
    Kind::Drv8871(Decay::Fast).run(&analyser, Drives(&[Some(0.25), Some(-0.25), None])).unwrap();
    insta::assert_snapshot!(analyser.table(), @r"
    0 ns  IN1      0
    0 ns  IN2      0
    0 ns  IN2      0
    0 ns  IN1      50
    0 ns  IN1      0
    0 ns  IN2      50
    0 ns  IN1      0
    0 ns  IN2      0
    ");
}

#[test]
fn a_tb6612_brakes_without_duty_and_changes_direction_there() {
    let analyser = Analyser::default();
    Kind::Tb6612.run(&analyser, Drives(&[Some(0.25), Some(-0.25), None])).unwrap();
    insta::assert_snapshot!(analyser.table(), @r"
    0 ns  PWM      0
    0 ns  IN1      0
    0 ns  IN2      0
    0 ns  STBY     1
    0 ns  PWM      0
    0 ns  STBY     1
    0 ns  IN2      0
    0 ns  IN1      1
    0 ns  PWM      50
    0 ns  PWM      0
    0 ns  IN1      0
    0 ns  IN2      1
    0 ns  PWM      50
    0 ns  PWM      0
    ");
}

#[test]
fn a_tb6612_coasts_with_both_inputs_low_and_the_pwm_high() {
    let analyser = Analyser::default();
    let [pwm, in1, in2] = ["PWM", "IN1", "IN2"].map(|wire| analyser.wire(wire));
    let mut motor = Tb6612::new(Axis::X, pwm, in1, in2);
    motor.start().unwrap();
    motor.drive(drive(0.5)).unwrap();
    motor.coast().unwrap();
    assert_eq!(["PWM", "IN1", "IN2"].map(|wire| analyser.level(wire)), [FULL, 0, 0]);
    let accesses = analyser.accesses();
    motor.drive(drive(0.5)).unwrap();
    assert_eq!(analyser.log()[accesses].wire, "PWM", "the duty goes first");
    assert_eq!(["PWM", "IN1", "IN2"].map(|wire| analyser.level(wire)), [100, 1, 0]);

    // Any of its accesses may fail.
    for fault in (0..4).flat_map(Fault::at) {
        let analyser = Analyser::default();
        let [pwm, in1, in2] = ["PWM", "IN1", "IN2"].map(|wire| analyser.wire(wire));
        let mut motor = Tb6612::new(Axis::X, pwm, in1, in2);
        motor.drive(drive(0.5)).unwrap();
        let from = analyser.accesses();
        let fault = match fault {
            Fault::Once { at, takes_effect } => Fault::Once { at: at + from, takes_effect },
            Fault::Wire { at } => Fault::Wire { at: at + from },
            _ => Fault::All { at: from },
        };
        analyser.set_fault(fault);
        match motor.coast().unwrap_err() {
            Error::NotStopped(_) => assert_eq!(fault, Fault::All { at: from }),
            _ => {
                let level = |wire| i32::from(analyser.level(wire));
                assert_eq!((level("IN1") - level("IN2")) * level("PWM"), 0, "{fault:?}");
            }
        }
    }
}

fn with_dead_time(analyser: &Analyser) -> DeadTime<HBridge<Wire<'_>, Wire<'_>, Wire<'_>>> {
    let [enable, forward, reverse] = ["EN", "1A", "2A"].map(|wire| analyser.wire(wire));
    DeadTime::new(HBridge::new(Axis::X, enable, forward, reverse), Duration::from_millis(2))
}

const fn ms(ms: u64) -> Duration {
    Duration::from_millis(ms)
}

#[test]
fn a_reversal_waits_for_the_dead_time() {
    let analyser = Analyser::default();
    let mut motor = with_dead_time(&analyser);
    motor.start().unwrap();
    let mut after = |now, duty| {
        analyser.now.set(ms(now));
        motor.drive(drive(duty), ms(now)).unwrap();
        motor.due()
    };
    assert_eq!(after(1, 0.5), Some(ms(3))); // what was before is not known
    assert_eq!(after(2, 0.5), Some(ms(3)));
    assert_eq!(after(3, 0.5), None);
    assert_eq!(after(10, -0.25), Some(ms(12)));
    assert_eq!(after(11, -1.0), Some(ms(12))); // another duty: the same wait
    assert_eq!(after(13, -1.0), None); // late
    insta::assert_snapshot!(analyser.table(), @r"
           0 ns  EN       0
           0 ns  1A       0
           0 ns  2A       0
     1000000 ns  EN       0
     3000000 ns  EN       0
     3000000 ns  2A       0
     3000000 ns  1A       1
     3000000 ns  EN       100
    10000000 ns  EN       0
    13000000 ns  EN       0
    13000000 ns  1A       0
    13000000 ns  2A       1
    13000000 ns  EN       200
    ");
}

#[test]
fn the_same_direction_does_not_wait() {
    let analyser = Analyser::default();
    let mut motor = with_dead_time(&analyser);
    motor.drive(drive(0.5), ms(0)).unwrap();
    motor.drive(drive(0.5), ms(2)).unwrap();
    for (now, duty) in [(3, 1.0), (4, 0.0), (5, 0.25)] {
        motor.drive(drive(duty), ms(now)).unwrap();
        assert_eq!(motor.due(), None);
    }
    assert_eq!(Kind::L293d.now(&analyser), 50);
    // Asked to reverse and back again before the time is over.
    motor.drive(drive(-0.5), ms(6)).unwrap();
    motor.drive(drive(0.5), ms(7)).unwrap();
    assert_eq!((motor.due(), Kind::L293d.now(&analyser)), (None, 100));
}

#[test]
fn a_motor_that_has_been_free_long_enough_does_not_wait() {
    let analyser = Analyser::default();
    let mut motor = with_dead_time(&analyser);
    motor.drive(drive(0.5), ms(0)).unwrap();
    motor.drive(drive(0.5), ms(2)).unwrap();
    motor.drive(drive(0.0), ms(10)).unwrap();
    motor.drive(drive(0.0), ms(11)).unwrap();
    motor.drive(drive(-0.5), ms(12)).unwrap();
    assert_eq!((motor.due(), Kind::L293d.now(&analyser)), (None, -100));
}

#[test]
fn a_motor_waits_no_more_after_no_drive_and_after_a_stop() {
    for by_a_stop in [false, true] {
        let analyser = Analyser::default();
        let mut motor = with_dead_time(&analyser);
        motor.drive(drive(0.5), ms(0)).unwrap();
        motor.drive(drive(0.5), ms(2)).unwrap();
        motor.drive(drive(-0.5), ms(10)).unwrap();
        if by_a_stop { motor.stop() } else { motor.drive(drive(0.0), ms(11)) }.unwrap();
        assert_eq!((motor.due(), Kind::L293d.now(&analyser)), (None, 0));
    }
}

#[test]
fn what_the_gate_takes_while_a_motor_waits_it_does_not_get_afterwards() {
    let analyser = Analyser::default();
    let mut gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    let mut motor = with_dead_time(&analyser);
    let right = Demand { x: Duty::FULL, y: Duty::ZERO };
    motor.drive(gate.pass(right), ms(0)).unwrap();
    assert_eq!(motor.due(), Some(ms(2)));
    gate.emergency_stop(true);
    motor.drive(gate.pass(right), ms(2)).unwrap();
    assert_eq!((motor.due(), Kind::L293d.now(&analyser)), (None, 0));
}

#[test]
fn the_blocking_form_waits_once_for_a_reversal() {
    let analyser = Analyser::default();
    let mut motor = with_dead_time(&analyser);
    let mut clock = analyser.clock();
    for (duty, wait) in [(0.5, 2), (1.0, 0), (-0.5, 2), (-0.25, 0), (0.0, 0)] {
        let before = analyser.now.get();
        motor.drive_blocking(drive(duty), &mut clock).unwrap();
        assert_eq!(analyser.now.get() - before, ms(wait), "{duty}");
    }
    assert_eq!(Kind::L293d.now(&analyser), 0);
}

#[test]
fn with_a_dead_time_too_no_fault_drives_a_motor() {
    let scenario = |analyser: &Analyser| {
        let mut motor = with_dead_time(analyser);
        motor.start()?;
        for (number, duty) in (0..).zip([0.5, -0.5, 0.25]) {
            motor.drive(drive(duty), ms(10 * number))?;
            motor.drive(drive(duty), ms(10 * number + 5))?;
        }
        motor.stop()
    };
    let whole = Analyser::default();
    scenario(&whole).unwrap();
    for fault in (0..whole.accesses()).flat_map(Fault::at) {
        let analyser = Analyser::failing(fault);
        match scenario(&analyser).unwrap_err() {
            Error::NotStopped(_) => assert!(matches!(fault, Fault::All { .. })),
            _ => assert_eq!(Kind::L293d.now(&analyser), 0, "{fault:?}"),
        }
    }
    // What failed is not known any more: the next drive waits, even in the same direction.
    let analyser = Analyser::default();
    let mut motor = with_dead_time(&analyser);
    motor.drive(drive(0.5), ms(0)).unwrap();
    motor.drive(drive(0.5), ms(2)).unwrap();
    analyser.set_fault(Fault::Once { at: analyser.accesses(), takes_effect: false });
    motor.drive(drive(1.0), ms(3)).unwrap_err();
    assert_eq!((motor.due(), Kind::L293d.now(&analyser)), (None, 0));
    motor.drive(drive(1.0), ms(4)).unwrap();
    assert_eq!(motor.due(), Some(ms(6)));
}
