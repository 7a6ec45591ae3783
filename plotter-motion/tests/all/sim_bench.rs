//! The whole gantry on the bench: host, serial line, controller and motors.

#![cfg(feature = "alloc")]

use core::time::Duration;
use plotter_motion::firmware::Notice;
use plotter_motion::plant::{Bench, BenchEvent, BenchSettings};
use plotter_motion::protocol::digits::Dropped;
use plotter_motion::protocol::{HostEvent, HostNotice};
use plotter_motion::{
    Axis, Direction, Machine, MachineConfig, Pen, PenMove, StepPoint, config::ControllerChoice,
};

/// A square of 10 mm with one diagonal.
fn square() -> Vec<PenMove> {
    let down = [(400, 0), (400, 400), (0, 400), (0, 0), (400, 400)];
    down.map(|(x, y)| PenMove { pen: Pen::Down, target: StepPoint::new(x + 100, y + 100) }).to_vec()
}

#[expect(clippy::unwrap_used, reason = "a test may panic")]
fn machine(choice: ControllerChoice) -> Machine {
    let mut config = MachineConfig::default();
    config.dc_mut().unwrap().control.controller = choice;
    Machine::new(config).unwrap()
}

type TestBench = Bench<std::vec::IntoIter<PenMove>>;

fn bench(choice: ControllerChoice) -> TestBench {
    Bench::new(&machine(choice), BenchSettings::default(), square().into_iter())
}

/// Runs until the host is done or `limit` has passed; gives all events.
fn run(
    bench: &mut TestBench,
    limit: Duration,
    mut disturb: impl FnMut(&mut TestBench),
) -> Vec<(Duration, BenchEvent)> {
    let mut events = Vec::new();
    while !bench.host().is_done() && bench.now() < limit {
        disturb(bench);
        bench.step(|at, event| events.push((at, event)));
    }
    events
}

const LIMIT: Duration = Duration::from_secs(60);

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn both_controllers_draw_the_square() {
    for choice in [ControllerChoice::Published, ControllerChoice::Contouring] {
        let mut bench = bench(choice);
        run(&mut bench, LIMIT, |_| ());
        assert_eq!(bench.host().progress(), (5, 5), "{choice:?}");
        assert_eq!(bench.host().position(), StepPoint::new(500, 500), "{choice:?}");
    }
}

#[test]
fn times_never_go_back_and_each_target_takes_ten_bytes() {
    let events = run(&mut bench(ControllerChoice::Contouring), LIMIT, |_| ());
    assert!(events.is_sorted_by_key(|&(at, _)| at));
    let bytes = events.iter().filter(|(_, event)| matches!(event, BenchEvent::HostByte(_))).count();
    assert_eq!(bytes, 50);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_lost_byte_costs_time_but_no_line() {
    let mut bench = bench(ControllerChoice::Contouring);
    let mut lost = None;
    let events = run(&mut bench, LIMIT, |bench| {
        if lost.is_none() && bench.now() > Duration::from_millis(35) {
            lost = bench.lose_byte();
        }
    });
    assert!(lost.is_some());
    assert!(
        events.iter().any(|(_, event)| matches!(
            event,
            BenchEvent::Host(HostEvent::Notice(HostNotice::Silent { .. }))
        ))
    );
    assert_eq!(bench.host().progress(), (5, 5));
    assert_eq!(bench.host().position(), StepPoint::new(500, 500));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn an_extra_byte_sends_one_target_astray_and_the_host_mends_it() {
    for extra in [3, b'x'] {
        let mut bench = bench(ControllerChoice::Contouring);
        let mut sent = false;
        let events = run(&mut bench, LIMIT, |bench| {
            if !sent && bench.now() > Duration::from_millis(35) {
                bench.disturb(extra);
                sent = true;
            }
        });
        assert!(events.iter().any(|(_, event)| matches!(event, BenchEvent::Controller(_))), "{extra}");
        assert_eq!(bench.host().progress(), (5, 5), "{extra}");
        assert_eq!(bench.host().position(), StepPoint::new(500, 500), "{extra}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_emergency_stop_stops_at_once_and_the_drawing_goes_on_after_a_reset() {
    let pressed = Duration::from_millis(150);
    let reset = Duration::from_millis(1150);
    let mut bench = bench(ControllerChoice::Contouring);
    let mut stopped_at = None;
    run(&mut bench, LIMIT, |bench| {
        let now = bench.now();
        if now == pressed {
            bench.controller_mut().emergency_stop(now, true);
            bench.controller_mut().emergency_stop(now, false);
        }
        if (pressed..reset).contains(&now) {
            assert_eq!(bench.controller().drive(), plotter_motion::Drive::default());
            if now == Duration::from_millis(250) {
                stopped_at = Some(bench.position_mm());
            }
        }
        if now == reset {
            assert_eq!(Some(bench.position_mm()), stopped_at);
            assert!(bench.controller_mut().reset_emergency_stop(now));
        }
    });
    assert!(stopped_at.is_some());
    assert_eq!(bench.host().progress(), (5, 5));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_pressed_limit_switch_blocks_its_direction_only() {
    let mut bench = bench(ControllerChoice::Contouring);
    bench.controller_mut().limit_switch(Duration::ZERO, Axis::X, Direction::Plus, true);
    run(&mut bench, Duration::from_secs(2), |bench| {
        assert!(bench.controller().drive().x().value() <= 0.0);
    });
    assert!(bench.position_mm().x < 0.1);
    bench.controller_mut().limit_switch(Duration::ZERO, Axis::X, Direction::Plus, false);
    run(&mut bench, LIMIT, |_| ());
    assert_eq!(bench.host().progress(), (5, 5));
}

#[test]
fn a_target_that_was_reached_already_is_answered_at_once() {
    let here = PenMove { pen: Pen::Down, target: StepPoint::new(0, 0) };
    for choice in [ControllerChoice::Published, ControllerChoice::Contouring] {
        let mut bench = Bench::new(&machine(choice), BenchSettings::default(), vec![here, here].into_iter());
        run(&mut bench, LIMIT, |_| ());
        assert_eq!(bench.host().progress(), (2, 2), "{choice:?}");
        assert!(bench.now() < Duration::from_millis(500), "{choice:?}: {:?}", bench.now());
    }
}

/// Noise while the motors are on their way is dropped when they arrive, and it is told.
#[test]
fn digits_that_come_before_the_target_is_reached_are_dropped_and_told() {
    let mut bench = bench(ControllerChoice::Contouring);
    let mut moving = 0;
    let events = run(&mut bench, LIMIT, |bench| {
        moving += u32::from(bench.position_mm().x > 1.0);
        if moving == 1 {
            bench.disturb(3);
            moving += 1;
        }
    });
    let told = |event: &BenchEvent| {
        matches!(event, BenchEvent::Controller(Notice::Dropped(Dropped::Early { digits: 1 })))
    };
    assert_eq!(events.iter().filter(|(_, event)| told(event)).count(), 1);
    assert_eq!(bench.host().progress(), (5, 5));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_host_pauses_as_the_machines_file_says() {
    let mut config = MachineConfig::default();
    config.serial.byte_gap_ms = 25.0;
    let machine = Machine::new(config).unwrap();
    let mut bench = Bench::new(&machine, BenchSettings::default(), square().into_iter());
    let events = run(&mut bench, LIMIT, |_| ());
    let bytes = events.iter().filter(|(_, event)| matches!(event, BenchEvent::HostByte(_)));
    let times: Vec<_> = bytes.map(|&(at, _)| at).take(10).collect();
    assert_eq!(times[9] - times[0], Duration::from_millis(9 * 25));
    assert_eq!(bench.host().progress(), (5, 5));
}
