//! The encoder level by level, with faults put in.

use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Read};
use plotter_hal::Quadrature;
use plotter_hal::quadrature::Error;
use plotter_motion::{Decoding, Direction, Phases};
use std::io::ErrorKind;

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
    let count = polled.map(Direction::sign).sum();
    let missed = encoder.missed();
    let (mut a, mut b) = encoder.release();
    a.done();
    b.done();
    (count, missed)
}

#[test]
fn x1_counts_a_period_as_one_and_x4_as_four() {
    let two_periods = [0, 1, 2, 3, 4, 5, 6, 7, 8];
    assert_eq!(count(Decoding::X1, &two_periods), (2, 0));
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
    assert_eq!(encoder.poll(), Err(Error::Pin(fault.clone())));
    assert_eq!(encoder.poll(), Err(Error::Pin(fault)));
    assert_eq!(encoder.poll(), Ok(Some(Direction::Plus)));
    let (mut a, mut b) = encoder.release();
    a.done();
    b.done();
}
