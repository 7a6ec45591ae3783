//! The emergency stop level by level: power-up, chatter, a cut wire, and faults put in at every read.

use crate::faulty;

use core::time::Duration;
use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Read};
use faulty::Levels;
use plotter_hal::estop_input::Error;
use plotter_hal::{EstopChange, EstopInput, SwitchSettings};
use plotter_motion::{Demand, Drive, Duty, LimitSwitches, SafetyGate, StepPair, safety::Beam};
use proptest::prelude::*;
use std::io::ErrorKind;

const FREE_AFTER_MS: u64 = 20;

fn ms(ms: u64) -> Duration {
    Duration::from_millis(ms)
}

/// Whether the gate lets anything through.
fn flows(gate: &SafetyGate) -> bool {
    let demand = Demand { x: Duty::FULL, y: Duty::FULL };
    gate.pass(demand) != Drive::default()
        || gate.pass_step(StepPair { x: 1, y: 0 }).is_ok()
        || gate.pass_laser(u16::MAX) != Beam::OFF
}

/// A firmware with a gate: it resets it by itself when it may, and never else.
struct Firmware {
    button: EstopInput<Levels>,
    gate: SafetyGate,
}

impl Firmware {
    fn new(levels: impl IntoIterator<Item = Option<bool>>) -> Self {
        let button = EstopInput::new(Levels::new(levels), SwitchSettings::default());
        let gate = SafetyGate::new(LimitSwitches::RELEASED, button.is_pressed());
        Self { button, gate }
    }

    fn tick(&mut self, now: Duration) -> Option<EstopChange> {
        let change = self.button.tick(now).ok().flatten();
        self.gate.emergency_stop(self.button.is_pressed());
        if change == Some(EstopChange::FreeSinceStart) {
            assert!(self.gate.reset());
        }
        change
    }
}

#[test]
fn before_anybody_has_looked_nothing_is_let_through() {
    let firmware = Firmware::new([]);
    assert!(firmware.gate.is_stopped() && !flows(&firmware.gate));
}

#[test]
fn switched_on_with_a_free_button_it_starts_after_the_release_time() {
    let mut firmware = Firmware::new([Some(false); 30]);
    for at_ms in 0..30 {
        let change = firmware.tick(ms(at_ms));
        assert_eq!(change == Some(EstopChange::FreeSinceStart), at_ms == FREE_AFTER_MS);
        assert_eq!(flows(&firmware.gate), at_ms >= FREE_AFTER_MS, "{at_ms} ms");
    }
}

#[test]
fn switched_on_with_a_pressed_button_it_never_starts_by_itself() {
    // Pressed for 50 ms, then let go.
    let mut firmware = Firmware::new((0..200).map(|at_ms| Some(at_ms < 50)));
    for at_ms in 0..200 {
        let change = firmware.tick(ms(at_ms));
        assert_eq!(change, (at_ms == 50 + FREE_AFTER_MS).then_some(EstopChange::Released), "{at_ms} ms");
        assert!(!flows(&firmware.gate), "{at_ms} ms");
    }
    assert!(firmware.gate.reset(), "a person may, now");
}

#[test]
fn switched_on_with_a_chattering_button_it_does_not_start_either() {
    let mut firmware = Firmware::new((0..100).map(|at_ms| Some(at_ms == 7)));
    for at_ms in 0..100 {
        assert_ne!(firmware.tick(ms(at_ms)), Some(EstopChange::FreeSinceStart));
        assert!(!flows(&firmware.gate));
    }
}

#[test]
fn a_contact_that_opens_for_one_look_stops_and_stays_stopped() {
    let mut firmware = Firmware::new((0..200).map(|at_ms| Some(at_ms == 100)));
    for at_ms in 0..200 {
        let change = firmware.tick(ms(at_ms));
        assert_eq!(change == Some(EstopChange::Pressed), at_ms == 100);
        assert_eq!(flows(&firmware.gate), (FREE_AFTER_MS..100).contains(&at_ms), "{at_ms} ms");
    }
}

#[test]
fn a_cut_wire_cannot_be_reset() {
    let mut firmware = Firmware::new((0..200).map(|at_ms| Some(at_ms >= 100)));
    for at_ms in 0..200 {
        firmware.tick(ms(at_ms));
    }
    assert!(!firmware.gate.reset());
    assert!(!flows(&firmware.gate));
}

#[test]
fn whichever_read_fails_it_stops() {
    for failing in 0..40 {
        let mut firmware = Firmware::new((0..100).map(|read| (read != failing).then_some(false)));
        for at_ms in 0..100 {
            firmware.tick(ms(at_ms));
            let free = (FREE_AFTER_MS..failing.max(FREE_AFTER_MS)).contains(&at_ms);
            // A fault after the button was known to be free stops; one before it keeps it from starting.
            assert_eq!(
                flows(&firmware.gate),
                free && failing > FREE_AFTER_MS,
                "{at_ms} ms, {failing} failing"
            );
        }
    }
}

#[test]
fn a_failing_pin_is_named_by_its_own_error() {
    let fault = MockError::Io(ErrorKind::NotConnected);
    let pin = Pin::new(&[Read::get(State::Low).with_error(fault.clone())]);
    let mut button = EstopInput::new(pin, SwitchSettings::default());
    let error = button.tick(Duration::ZERO).unwrap_err();
    assert_eq!(error, Error::Pin(fault));
    assert!(error.to_string().ends_with("it counts as pressed"), "{error}");
    assert!(button.is_pressed());
    button.release().done();
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// However it chatters: from the first look at a pressed button on nothing flows.
    #[test]
    fn nothing_flows_after_a_press(
        reads in prop::collection::vec((0..30_u64, prop::option::weighted(0.98, prop::bool::weighted(0.05))), 1..100),
    ) {
        let mut firmware = Firmware::new(reads.iter().map(|(_, level)| *level));
        let (mut now, mut pressed) = (Duration::ZERO, false);
        for (pause_ms, level) in reads {
            now += ms(pause_ms);
            firmware.tick(now);
            pressed |= level != Some(false);
            prop_assert!(!(pressed && flows(&firmware.gate)));
        }
    }
}
