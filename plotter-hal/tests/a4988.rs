//! The stepper driver pin by pin and pulse by pulse, over a simulated clock, with faults put in.

#![allow(clippy::unwrap_used, reason = "these are tests")]

mod logic_analyser;

use logic_analyser::{Analyser, Broken, Wire};
use plotter_hal::a4988::{A4988, Error, Timing};
use plotter_motion::{Axis, Pulse, SafetyGate, StepPair};

type Motor<'a> = A4988<Wire<'a>, Wire<'a>, Wire<'a>, Wire<'a>>;

fn pulse(x: i8) -> Pulse {
    SafetyGate::default().pass_step(StepPair { x, y: 0 }).unwrap()
}

fn motor(analyser: &Analyser, timing: Timing) -> Motor<'_> {
    A4988::new(Axis::X, analyser.wire("STEP"), analyser.wire("DIR"), timing)
        .with_enable(analyser.wire("ENABLE"))
        .with_sleep(analyser.wire("SLEEP"))
}

/// A timer that calls as soon as the driver wants it.
fn run(analyser: &Analyser, motor: &mut Motor<'_>) -> Result<(), Error<Broken>> {
    while let Some(due) = motor.due() {
        analyser.now.set(analyser.now.get().max(due));
        motor.tick(analyser.now.get())?;
    }
    Ok(())
}

/// Start, two steps forwards and one back, each as soon as the chip takes it.
fn there_and_back(analyser: &Analyser, motor: &mut Motor<'_>) -> Result<(), Error<Broken>> {
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
