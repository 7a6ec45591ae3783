//! The encoder level by level: bounce, a lost phase, missed edges, and faults put in at every read.

use crate::faulty;

use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Read};
use faulty::{Broken, Levels};
use plotter_hal::Quadrature;
use plotter_hal::quadrature::{Error, Phase, PinError};
use plotter_motion::{
    Demand, Direction, Drive, Duty, LimitSwitches, SafetyGate, config::Decoding, encoder::Phases,
};
use proptest::prelude::*;
use std::io::ErrorKind;

const ALL: [Decoding; 3] = [Decoding::X1, Decoding::X2, Decoding::X4];

fn levels(level: impl Fn(Phases) -> bool, quarters: &[i64]) -> Vec<Read> {
    let state = |high| if high { State::High } else { State::Low };
    quarters.iter().map(|&quarter| Read::get(state(level(Phases::of_quarter(quarter))))).collect()
}

/// The count after polling a shaft that stands at each of `quarters` in turn, and the transitions missed.
fn count(decoding: Decoding, quarters: &[i64]) -> (i32, u32) {
    let a = Pin::new(&levels(|phases| phases.a, quarters));
    let b = Pin::new(&levels(|phases| phases.b, quarters));
    let mut encoder = Quadrature::new(a, b, decoding);
    let polled = quarters.iter().filter_map(|_| encoder.poll().ok().flatten());
    let count: i32 = polled.map(Direction::sign).sum();
    assert_eq!(encoder.position(), count);
    let missed = encoder.illegal();
    let (mut a, mut b) = encoder.release();
    a.done();
    b.done();
    (count, missed)
}

#[test]
fn x1_counts_a_period_as_one_x2_as_two_and_x4_as_four() {
    let two_periods = [0, 1, 2, 3, 4, 5, 6, 7, 8];
    assert_eq!(count(Decoding::X1, &two_periods), (2, 0));
    assert_eq!(count(Decoding::X2, &two_periods), (4, 0));
    assert_eq!(count(Decoding::X4, &two_periods), (8, 0));
}

#[test]
fn x4_counts_backwards_too_and_tells_a_poll_that_came_too_late() {
    assert_eq!(count(Decoding::X4, &[3, 2, 1, 0, -1]), (-4, 0));
    assert_eq!(count(Decoding::X4, &[0, 2, 3]), (1, 1));
}

#[test]
fn the_first_poll_only_notes_where_the_shaft_stands() {
    assert_eq!(count(Decoding::X1, &[0]), (0, 0));
    assert_eq!(count(Decoding::X4, &[3]), (0, 0));
}

#[test]
fn a_pin_that_cannot_be_read_changes_nothing() {
    let fault = MockError::Io(ErrorKind::NotConnected);
    let a = Pin::new(&[
        Read::get(State::Low),
        Read::get(State::High).with_error(fault.clone()),
        Read::get(State::High),
        Read::get(State::High),
    ]);
    let b = Pin::new(&[
        Read::get(State::High),
        Read::get(State::High).with_error(fault.clone()),
        Read::get(State::High),
    ]);
    let mut encoder = Quadrature::new(a, b, Decoding::X1);
    assert_eq!(encoder.poll(), Ok(None));
    assert_eq!(encoder.poll(), Err(Error::Pin(PinError::A(fault.clone()))));
    assert_eq!(encoder.poll(), Err(Error::Pin(PinError::B(fault))));
    assert_eq!(encoder.poll(), Ok(Some(Direction::Plus)));
    let (mut a, mut b) = encoder.release();
    a.done();
    b.done();
}

/// An encoder without pins that has been shown these levels.
fn shown(decoding: Decoding, levels: impl IntoIterator<Item = Phases>) -> Quadrature<Levels, Levels> {
    let mut encoder = Quadrature::new(Levels::new([]), Levels::new([]), decoding);
    for phases in levels {
        encoder.update(phases);
    }
    encoder
}

#[test]
fn an_edge_that_bounces_counts_once_with_x2_and_x4_and_drifts_with_x1() {
    // Over ten periods each rising edge of A bounces three times. (Were its falling ones as bad, x1 would
    // count them down.)
    let bouncing = (0..40).flat_map(|quarter: i64| {
        let bounces = if quarter % 4 == 0 { 3 } else { 0 };
        [quarter, quarter - 1].repeat(bounces).into_iter().chain([quarter]).map(Phases::of_quarter)
    });
    let positions = ALL.map(|decoding| shown(decoding, bouncing.clone()).position());
    assert_eq!(positions, [9 + 30, 19, 39]);
}

#[test]
fn interrupts_at_the_edges_of_a_are_enough_for_x1_and_x2() {
    let edges_of_a = (0..9).map(|half| Phases::of_quarter(2 * half));
    let positions =
        [Decoding::X1, Decoding::X2].map(|decoding| shown(decoding, edges_of_a.clone()).position());
    assert_eq!(positions, [4, 8]);
}

#[test]
fn a_lost_phase_is_named_and_can_stop_the_machine() {
    let forwards = (0..100).map(Phases::of_quarter);
    for decoding in ALL {
        for stuck in [false, true] {
            let without_b = shown(decoding, forwards.clone().map(|phases| Phases { b: stuck, ..phases }));
            assert_eq!(without_b.lost_phase(8), Some(Phase::B), "{decoding:?}");
            let without_a = shown(decoding, forwards.clone().map(|phases| Phases { a: stuck, ..phases }));
            assert_eq!(without_a.lost_phase(8), Some(Phase::A), "{decoding:?}");
            assert_eq!(shown(decoding, forwards.clone()).lost_phase(2), None, "{decoding:?}");

            let gate = SafetyGate::new(LimitSwitches::RELEASED, without_b.lost_phase(8).is_some());
            assert_eq!(gate.pass(Demand { x: Duty::FULL, y: Duty::FULL }), Drive::default());
        }
    }
}

#[test]
fn a_shaft_that_trembles_is_no_lost_phase_once_the_other_phase_has_changed() {
    // About the edge before a quarter, six levels; it is an edge of A for even quarters.
    let trembles = |quarter: i64| [quarter, quarter - 1].repeat(3);
    let seen = |quarters: &[Vec<i64>]| {
        let encoder = shown(Decoding::X4, quarters.concat().into_iter().map(Phases::of_quarter));
        (encoder.lost_phase(7), encoder.illegal())
    };
    assert_eq!(seen(&[trembles(0), vec![0, -1, 0]]), (Some(Phase::B), 0));
    assert_eq!(seen(&[trembles(0), vec![0, 1], trembles(2)]), (None, 0));
    assert_eq!(seen(&[trembles(0), vec![1], trembles(2)]), (None, 1)); // B's edge was missed
}

#[test]
fn a_lost_phase_does_not_run_away_with_x2_and_x4() {
    let without_b = (0..100).map(|quarter| Phases { b: true, ..Phases::of_quarter(quarter) });
    let [x1, x2, x4] = ALL.map(|decoding| shown(decoding, without_b.clone()).position());
    assert_eq!(x1, 24); // on and on, whichever way it turns
    assert!(x2.abs() <= 1 && x4.abs() <= 1, "{x2} {x4}");
}

#[test]
fn whichever_read_fails_the_position_is_right_again_at_the_next_one() {
    // Every level is polled twice, and of 2 x 40 reads of each pin one fails.
    let polled: Vec<i64> = (0..40).flat_map(|quarter| [quarter, quarter]).collect();
    for decoding in ALL {
        for failing in 0..80 {
            for a_fails in [true, false] {
                let level = |is_a: bool, read: usize, phases: Phases| {
                    let fails = is_a == a_fails && read == failing;
                    (!fails).then_some(if is_a { phases.a } else { phases.b })
                };
                let of = |is_a: bool| {
                    let all = polled.iter().enumerate();
                    // b is not read when a has failed
                    let read = all.filter(move |&(read, _)| is_a || !a_fails || read != failing);
                    Levels::new(read.map(|(read, &quarter)| level(is_a, read, Phases::of_quarter(quarter))))
                };
                let mut encoder = Quadrature::new(of(true), of(false), decoding);
                let failed = if a_fails { PinError::A(Broken) } else { PinError::B(Broken) };
                let errors = polled.iter().filter(|_| encoder.poll() == Err(Error::Pin(failed))).count();
                let expected = [9, 19, 39][ALL.iter().position(|&other| other == decoding).unwrap()];
                assert_eq!((errors, encoder.position()), (1, expected), "{decoding:?}, {failing} failing");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// A shaft that goes where it likes, by a quarter at most between two looks: x4 is right to the count,
    /// and x2 to its half period; nothing is illegal.
    #[test]
    fn x2_and_x4_follow_any_shaft(turns in prop::collection::vec(-1..=1_i64, 0..500)) {
        let mut quarters = vec![1_i64];
        for turn in turns {
            quarters.push(quarters[quarters.len() - 1] + turn);
        }
        let end = quarters[quarters.len() - 1];
        let levels = quarters.into_iter().map(Phases::of_quarter);
        let x4 = shown(Decoding::X4, levels.clone());
        prop_assert_eq!(i64::from(x4.position()), end - 1);
        prop_assert_eq!(x4.illegal(), 0);
        let x2 = shown(Decoding::X2, levels);
        prop_assert_eq!(i64::from(x2.position()), end.div_euclid(2));
    }
}
