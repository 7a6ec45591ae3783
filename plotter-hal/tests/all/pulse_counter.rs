//! The encoder that only counts up, level by level, with faults put in at every read.

use crate::faulty;

use faulty::{Broken, Levels};
use plotter_hal::pulse_counter::Error;
use plotter_hal::{CounterDelta, PulseInput, TimerCount};
use plotter_motion::{Axis, Demand, Drive, Duty, LimitSwitches, SafetyGate, encoder::PulseCounter};
use proptest::prelude::*;

fn drive(gate: &SafetyGate, y: f32) -> Drive<'_> {
    gate.pass(Demand { x: Duty::saturating(-y), y: Duty::saturating(y) })
}

#[test]
fn run_down_after_an_emergency_stop_is_counted_the_way_it_was_driven() {
    let pulses = [false, true].repeat(30).into_iter().map(Some);
    let mut encoder = PulseInput::new(Axis::Y, Levels::new(pulses));
    let mut gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    let mut positions = Vec::new();
    for (duty, stop) in [(0.5, false), (0.5, true), (-1.0, true)] {
        gate.emergency_stop(stop);
        // What the motor gets counts, not what was asked for: the third drive is none.
        encoder.driven(drive(&gate, duty));
        for _ in 0..20 {
            encoder.poll().unwrap();
        }
        positions.push(encoder.counter().position());
    }
    assert_eq!(positions, [10, 20, 30]);
}

#[test]
fn whichever_read_fails_no_pulse_is_made_up_and_none_is_lost_that_lasts_for_two() {
    // Every level is polled twice.
    let levels = [false, false, true, true].repeat(10);
    for failing in 0..levels.len() {
        let read = levels.iter().enumerate().map(|(read, &level)| (read != failing).then_some(level));
        let mut encoder = PulseInput::new(Axis::X, Levels::new(read));
        encoder.driven(drive(&SafetyGate::new(LimitSwitches::RELEASED, false), -1.0));
        let errors = levels.iter().filter(|_| encoder.poll() == Err(Error::Pin(Broken))).count();
        assert_eq!((errors, encoder.counter().position()), (1, 10), "{failing} failing");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// However often it is read and wherever it wraps, a hardware counter's pulses are all counted, once.
    #[test]
    fn a_counter_that_wraps_loses_nothing(
        start in any::<u16>(),
        steps in prop::collection::vec((any::<u16>(), any::<bool>()), 0..50),
    ) {
        let (mut shown, mut expected) = (start, 0_i64);
        let mut delta = CounterDelta::new(start);
        let mut counter = PulseCounter::default();
        for (pulses, forwards) in steps {
            counter.driven(Duty::saturating(if forwards { 0.1 } else { -0.1 }));
            shown = shown.wrapping_add(pulses);
            counter.pulses(delta.since_last(shown));
            expected += i64::from(pulses) * if forwards { 1 } else { -1 };
        }
        prop_assert_eq!(i64::from(counter.position()), expected);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// A timer of 16 bits that is read in time knows the shaft's place, however often it has wrapped.
    #[test]
    fn a_timer_that_wraps_knows_the_place(start in any::<u16>(), moves in prop::collection::vec(any::<i16>(), 0..200)) {
        let (mut encoder, mut shaft) = (TimerCount::new(start), 0_i32);
        for moved in moves {
            shaft += i32::from(moved);
            let shown = start.wrapping_add(u16::try_from(shaft.rem_euclid(1 << 16)).unwrap());
            prop_assert_eq!(encoder.update(shown), moved);
        }
        prop_assert_eq!(encoder.position(), shaft);
    }
}
