//! Limit switches level by level: chatter, broken wires, and faults put in at every read.

use crate::faulty;

use core::time::Duration;
use embedded_hal::digital::PinState;
use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Read};
use faulty::{Broken, Levels};
use plotter_hal::limit_switch::{Error, GroupError};
use plotter_hal::{LimitSwitch, LimitSwitchGroup, SwitchSettings};
use plotter_motion::{Axis, Demand, Direction, Duty, LimitSwitches, SafetyGate};
use proptest::prelude::*;
use std::io::ErrorKind;

/// A switch that is read every millisecond, and whether it counted as pressed each time.
fn watched(settings: SwitchSettings, levels: impl IntoIterator<Item = Option<bool>>) -> Vec<bool> {
    let levels: Vec<_> = levels.into_iter().collect();
    let mut switch = LimitSwitch::new(Levels::new(levels.clone()), settings);
    (0..)
        .zip(levels)
        .map(|(at_ms, level)| {
            let result = switch.tick(Duration::from_millis(at_ms));
            assert_eq!(result.is_err(), level.is_none());
            assert_eq!(result.unwrap_or(true), switch.is_pressed());
            switch.is_pressed()
        })
        .collect()
}

/// High is pressed, as with a normally closed switch.
fn levels(text: &str) -> impl Iterator<Item = Option<bool>> + '_ {
    text.chars().map(|level| match level {
        '^' => Some(true),
        '_' => Some(false),
        _ => None,
    })
}

fn shown(pressed: &[bool]) -> String {
    pressed.iter().map(|&pressed| if pressed { '^' } else { '_' }).collect()
}

fn quick() -> SwitchSettings {
    SwitchSettings::default().with_release_after(Duration::from_millis(4))
}

#[test]
fn a_switch_that_chatters_is_pressed_once_and_released_once() {
    let pin = "_____^_^^_^^^^^^^_^__^____________";
    let was = shown(&watched(quick(), levels(pin)));
    assert_eq!(was, "^^^^_^^^^^^^^^^^^^^^^^^^^^________"); // free four after the last chatter
}

#[test]
fn a_broken_wire_is_a_pressed_switch_and_stays_one() {
    let was = shown(&watched(quick(), levels("______^^^^^^^^^^^^^^^^^^^^")));
    assert_eq!(was, "^^^^__^^^^^^^^^^^^^^^^^^^^");
}

#[test]
fn a_normally_open_switch_shows_a_press_at_low() {
    let settings = quick().with_pressed_at(PinState::Low);
    let was = shown(&watched(settings, levels("^^^^^^__^^^^^^")));
    assert_eq!(was, "^^^^__^^^^^^__");
}

#[test]
fn a_spike_is_a_press_unless_it_is_asked_for_more() {
    let spike = "______^_______";
    assert_eq!(shown(&watched(quick(), levels(spike))), "^^^^__^^^^^___");
    let patient = quick().with_press_after(Duration::from_millis(2));
    assert_eq!(shown(&watched(patient, levels(spike))), "^^^^__________");
    assert_eq!(shown(&watched(patient, levels("______^^^^____"))), "^^^^____^^^^^^");
}

#[test]
fn whichever_read_fails_it_counts_as_pressed_until_it_has_been_free_again() {
    for failing in 0..12 {
        let pin: String = (0..12).map(|read| if read == failing { '!' } else { '_' }).collect();
        let was = watched(quick(), levels(&pin));
        for (read, pressed) in was.into_iter().enumerate() {
            let free_since_start = read >= 4 && read < failing;
            let free_since_fault = read >= failing + 5 || (failing > read && read >= 4);
            assert_eq!(pressed, !(free_since_start || free_since_fault), "read {read}, {failing} failing");
        }
    }
}

#[test]
fn the_group_reads_all_switches_whichever_fails_and_names_it() {
    let settings = SwitchSettings::default().with_release_after(Duration::ZERO);
    let fault = MockError::Io(ErrorKind::NotConnected);
    let ends = [
        (Axis::X, Direction::Minus, "axis x: pin of its lower limit switch"),
        (Axis::X, Direction::Plus, "axis x: pin of its upper limit switch"),
        (Axis::Y, Direction::Minus, "axis y: pin of its lower limit switch"),
        (Axis::Y, Direction::Plus, "axis y: pin of its upper limit switch"),
    ];
    let errors: [GroupError<_, _, _, _>; 4] = [
        GroupError::XMin(fault.clone()),
        GroupError::XMax(fault.clone()),
        GroupError::YMin(fault.clone()),
        GroupError::YMax(fault.clone()),
    ];
    for (failing, (axis, end, text)) in ends.into_iter().enumerate() {
        let switch = |number: usize| {
            let read = Read::get(State::Low);
            let faulty =
                if number == failing { read.clone().with_error(fault.clone()) } else { read.clone() };
            LimitSwitch::new(Pin::new(&[faulty, read]), settings)
        };
        let mut group =
            LimitSwitchGroup { x_min: switch(0), x_max: switch(1), y_min: switch(2), y_max: switch(3) };
        assert!(group.limits().blocks(axis, end), "nobody has looked");

        let error = group.tick(Duration::ZERO).unwrap_err();
        assert_eq!((error.axis(), error.end(), &error), (axis, end, &errors[failing]));
        assert!(error.to_string().starts_with(text), "{error}");
        let mut expected = LimitSwitches::default();
        expected.set(axis, end, true);
        assert_eq!(group.limits(), expected);

        let sign = if end == Direction::Plus { 1.0 } else { -1.0 };
        let towards = Demand { x: Duty::saturating(sign), y: Duty::saturating(sign) };
        let gate = SafetyGate::new(group.limits(), false);
        assert_eq!(
            gate.pass(towards).axis(axis),
            Duty::ZERO,
            "no drive towards a switch that cannot be read"
        );

        assert_eq!(group.tick(Duration::from_millis(1)), Ok(LimitSwitches::default()));
        for switch in [group.x_min, group.x_max, group.y_min, group.y_max] {
            switch.release().done();
        }
    }
}

#[test]
fn between_two_edges_it_only_has_to_be_looked_at_when_it_says() {
    let mut switch = LimitSwitch::new(Levels::new(levels("_^___")), quick());
    let ms = Duration::from_millis;
    assert_eq!(switch.due(), None);
    switch.tick(ms(0)).unwrap(); // an edge
    assert_eq!(switch.due(), Some(ms(4)));
    switch.tick(ms(2)).unwrap(); // an edge
    assert_eq!(switch.due(), None);
    switch.tick(ms(3)).unwrap(); // an edge
    assert_eq!(switch.due(), Some(ms(7)));
    assert!(switch.tick(ms(6)).unwrap()); // too early: nothing changes
    assert_eq!(switch.tick(ms(7)), Ok(false));
    assert_eq!(switch.due(), None);
}

#[test]
fn one_error_is_told_from_the_other() {
    let mut switch = LimitSwitch::new(Levels::new([None]), quick());
    let error = switch.tick(Duration::ZERO).unwrap_err();
    assert_eq!(error, Error::Pin(Broken));
    assert!(error.to_string().ends_with("it counts as pressed"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever the pin shows and however it is read: a press and a fault count in the same call, and it is
    /// free only after it has been seen free for the whole time.
    #[test]
    fn it_is_free_only_after_it_has_shown_so(
        reads in prop::collection::vec((0..10_u64, prop::option::weighted(0.95, any::<bool>())), 1..200),
    ) {
        let levels = Levels::new(reads.iter().map(|(_, level)| *level));
        let mut switch = LimitSwitch::new(levels, quick());
        let (mut now, mut free_since) = (Duration::ZERO, None);
        for (pause_ms, level) in reads {
            now += Duration::from_millis(pause_ms);
            let result = switch.tick(now);
            prop_assert_eq!(result.is_err(), level.is_none());
            free_since = if level == Some(false) { free_since.or(Some(now)) } else { None };
            let is_free = free_since.is_some_and(|since| now - since >= quick().release_after);
            prop_assert_eq!(switch.is_pressed(), !is_free);
        }
    }
}
