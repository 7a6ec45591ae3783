//! The stepper plotter's two sides as two tasks that run at their own times, as on an RTOS.

use core::time::Duration;
use plotter_motion::firmware::stepper_plotter::{
    Dialect, Drivers, Link, Motion, Receive, Signal, Status, StepperPlotterSettings,
};
use plotter_motion::{LimitSwitches, Machine, MachineConfig, SafetyGate, StepPoint};
use std::collections::VecDeque;

/// What the tasks share.
#[derive(Default)]
struct Shared {
    link: Link,
    signals: VecDeque<Signal>,
    status: Status,
}

fn motion_task(now: Duration, motion: &mut Motion, shared: &mut Shared) {
    while let Some(signal) = shared.signals.pop_front() {
        motion.signal(now, signal, &mut shared.link);
    }
    while motion.poll(now, Drivers::Ready, &mut shared.link).is_some() {}
    shared.status = motion.status(now);
}

/// Runs once in a while: takes what has come over the line, and answers.
fn receive_task(wire: &mut VecDeque<u8>, receive: &mut Receive, shared: &mut Shared, answers: &mut Vec<u8>) {
    shared.signals.extend(wire.drain(..).filter_map(|byte| receive.receive(byte)));
    receive.work(&shared.status, &mut shared.link);
    answers.extend(core::iter::from_fn(|| receive.transmit()));
}

/// Sends each line when the one before was answered; gives the answers.
fn talk(dialect: Dialect, lines: &[&str], receive_every_ms: u64) -> (String, StepPoint) {
    let machine = Machine::new(MachineConfig::stepper_plotter()).expect("the preset is a machine");
    let settings = StepperPlotterSettings::of(&machine, dialect);
    let (mut receive, mut motion) = (
        Receive::new(settings),
        Motion::new(settings, SafetyGate::new(LimitSwitches::RELEASED, false)).expect("checked"),
    );
    let (mut shared, mut wire, mut answers) = (Shared::default(), VecDeque::new(), Vec::new());
    let mut lines = lines.iter();
    let mut answered = 0;
    for ms in 0..10_000 {
        motion_task(Duration::from_millis(ms), &mut motion, &mut shared);
        if ms % receive_every_ms == 0 {
            receive_task(&mut wire, &mut receive, &mut shared, &mut answers);
            let text = String::from_utf8_lossy(&answers);
            let count = text.lines().filter(|line| line.eq_ignore_ascii_case("ok")).count();
            if count == answered
                && let Some(line) = lines.next()
            {
                wire.extend(line.bytes());
                answered += 1;
            }
        }
    }
    (String::from_utf8_lossy(&answers).into_owned(), motion.position())
}

#[test]
fn the_answers_are_the_same_however_seldom_the_receive_task_runs() {
    for every_ms in [1, 7, 50] {
        let (answers, at) = talk(Dialect::MDraw, &["M1 90\n", "G1 X3 Y4\n", "P\n", "M10\n"], every_ms);
        assert_eq!(
            answers,
            "OK\r\ndistance=5.00\r\nOK\r\nPOS X3.00 Y4.00\r\nOK\r\nM10 XY 380 310 3.00 4.00 A0 B0 H0 S80 U160 D90\r\nOK\r\n"
        );
        assert_eq!(at, StepPoint::new(263, 350));
        let (answers, at) = talk(Dialect::Grbl, &["G0 X3\n", "G1 Y4 F600\n", "$G\n"], every_ms);
        let modes = "[GC:G1 G54 G17 G21 G90 G94 M5 M9 T0 F600 S0]";
        assert_eq!(answers, format!("\r\nGrbl 1.1h ['$' for help]\r\nok\r\nok\r\n{modes}\r\nok\r\n"));
        assert_eq!(at, StepPoint::new(263, 350));
    }
}
