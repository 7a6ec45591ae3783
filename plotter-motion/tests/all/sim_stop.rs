//! The emergency stop that comes over the line: from its last byte on nothing drives the motors, until it is
//! taken back.

#![cfg(feature = "alloc")]

use core::time::Duration;
use plotter_motion::firmware::{Gantry, LinkedGantry};
use plotter_motion::plant::{Bench, BenchController, BenchEvent, BenchSettings};
use plotter_motion::protocol::digits::{self, Reply};
use plotter_motion::protocol::{
    HostEvent, HostNotice, HostSettings, LinkHost, LinkSettings, LinkState, Order, Wire,
};
use plotter_motion::{
    Axis, Direction, LimitSwitches, Machine, MachineConfig, Pen, PenMove, SafetyGate, StepPoint,
    config::ControllerChoice,
};
use proptest::prelude::*;

fn machine() -> Machine {
    Machine::new(MachineConfig::default()).unwrap()
}

/// With the published controller, which counts each edge as it comes; ours knows better where an encoder was
/// met twice.
fn published() -> Machine {
    let mut config = MachineConfig::default();
    config.dc_mut().unwrap().control.controller = ControllerChoice::Published;
    Machine::new(config).unwrap()
}

fn is_off<C: BenchController>(controller: &C) -> bool {
    Axis::BOTH.into_iter().all(|axis| controller.drive().axis(axis).value() == 0.0)
}

/// What a gantry says until it has nothing more to say.
fn said(gantry: &mut Gantry) -> Vec<u8> {
    std::iter::from_fn(|| gantry.transmit()).collect()
}

/// A gantry of digits on its way, with the motors driven.
fn under_way(machine: &Machine, target: StepPoint) -> (Gantry, Duration) {
    let mut gantry = Gantry::new(machine, SafetyGate::new(LimitSwitches::RELEASED, false));
    digits::encode(target).unwrap().into_iter().for_each(|byte| gantry.receive(Duration::ZERO, byte));
    let mut now = Duration::ZERO;
    while is_off(&gantry) {
        now = gantry.next_tick().unwrap();
        gantry.tick(now);
    }
    (gantry, now)
}

proptest! {
    /// Whatever happens at a stopped machine, its motors get nothing, and what is counted is kept.
    #[test]
    fn nothing_drives_a_stopped_gantry(
        x in 0..20_000_i32,
        y in 200..16_000_i32,
        is_published in any::<bool>(),
        inputs in prop::collection::vec((0_u8..6, any::<u8>(), 0_u64..3_000), 0..200),
    ) {
        let machine = if is_published { published() } else { machine() };
        let (mut gantry, mut now) = under_way(&machine, StepPoint::new(x, y));
        gantry.receive(now, Order::Stop.byte());
        prop_assert!(is_off(&gantry) && gantry.is_stopped());
        let mut counted = gantry.position();
        for (what, byte, us) in inputs {
            now += Duration::from_micros(us);
            match what {
                0 => while gantry.next_tick().is_some_and(|at| at <= now) { gantry.tick(now) },
                1 => {
                    let axis = if byte & 1 == 0 { Axis::X } else { Axis::Y };
                    let sign = if byte & 2 == 0 { Direction::Plus } else { Direction::Minus };
                    gantry.edge(now, axis, sign);
                    match axis {
                        Axis::X => counted.x += sign.sign(),
                        Axis::Y => counted.y += sign.sign(),
                    }
                }
                2 => gantry.receive(now, byte % 10),
                3 => gantry.receive(now, if byte == Order::GoOn.byte() { 0 } else { byte }),
                // What is done at the machine does not take the host's stop back.
                4 => gantry.emergency_stop(now, byte & 1 == 0),
                _ => { gantry.reset_emergency_stop(now); }
            }
            prop_assert!(is_off(&gantry) && gantry.is_stopped());
        }
        prop_assert!(!is_published || gantry.position() == counted);
        let answers: Vec<u8> = said(&mut gantry).into_iter().filter(|&byte| byte == b'!' || byte == b'~').collect();
        prop_assert_eq!(answers, b"!");
    }
}

#[test]
fn a_stop_is_answered_and_each_side_takes_back_its_own() {
    let (mut gantry, now) = under_way(&machine(), StepPoint::new(4_000, 3_000));
    let _ = said(&mut gantry);
    gantry.receive(now, b'!');
    assert_eq!(said(&mut gantry), [Reply::Stopped.byte()]);
    gantry.emergency_stop(now, true);
    gantry.receive(now, b'~');
    assert!(is_off(&gantry));
    assert_eq!(said(&mut gantry), b"!"); // the button is still pressed
    gantry.emergency_stop(now, false);
    assert!(gantry.reset_emergency_stop(now) && !is_off(&gantry));
    gantry.emergency_stop(now, true);
    gantry.emergency_stop(now, false);
    gantry.receive(now, b'~');
    assert!(is_off(&gantry)); // what was stopped at the machine goes on at the machine
    assert_eq!(said(&mut gantry), b"!");
    gantry.reset_emergency_stop(now);
    gantry.receive(now, b'~');
    assert!(!is_off(&gantry));
    assert_eq!(said(&mut gantry), b"~");
}

#[test]
fn a_stop_between_the_digits_of_a_target_costs_none_of_them() {
    let mut gantry = Gantry::new(&machine(), SafetyGate::new(LimitSwitches::RELEASED, false));
    let bytes = digits::encode(StepPoint::new(400, 0)).unwrap();
    for (place, byte) in bytes.into_iter().enumerate() {
        if place == 4 {
            gantry.receive(Duration::ZERO, b'!');
            gantry.receive(Duration::ZERO, b'~');
        }
        gantry.receive(Duration::ZERO, byte);
    }
    gantry.tick(gantry.next_tick().unwrap());
    assert!(!is_off(&gantry) && gantry.take_notice().is_none());
}

type Linked = LinkedGantry<4, 64>;

/// A host and a simulated linked machine, with motors that have mass.
struct Line {
    host: LinkHost<std::vec::IntoIter<PenMove>, 4, 64>,
    bench: Bench<std::iter::Empty<PenMove>, Linked>,
    wire: Wire,
    free: Duration,
    notices: Vec<HostNotice>,
    reached: Vec<StepPoint>,
    /// When the last byte of an order came to the machine, and the drive changes after it.
    changes: Vec<(Duration, Axis, i32)>,
}

impl Line {
    fn new(moves: &[PenMove]) -> Self {
        let machine = machine();
        let controller = Linked::new(
            Gantry::new(&machine, SafetyGate::new(LimitSwitches::RELEASED, false)),
            7,
            LinkSettings::default(),
        );
        let settings = BenchSettings::default();
        Self {
            host: LinkHost::new(
                1,
                LinkSettings::default(),
                Duration::ZERO,
                HostSettings::default(),
                Vec::from(moves).into_iter(),
            ),
            bench: Bench::with_controller(&machine, settings, controller, std::iter::empty()),
            wire: Wire::new(256_000),
            free: Duration::ZERO,
            notices: Vec::new(),
            reached: Vec::new(),
            changes: Vec::new(),
        }
    }

    fn step(&mut self) {
        let now = self.bench.now();
        while let Some(event) = self.host.poll(now) {
            match event {
                HostEvent::Notice(notice) => self.notices.push(notice),
                HostEvent::Reached(reached) => self.reached.push(reached.target),
                HostEvent::Begun(_) => {}
            }
        }
        if now >= self.free
            && let Some(byte) = self.host.next_byte(now)
        {
            self.free = self.wire.send(now);
            self.bench.disturb(byte);
        }
        let mut came = Vec::new();
        let changes = &mut self.changes;
        self.bench.step(|at, event| match event {
            BenchEvent::ControllerByte(byte) => came.push((at, byte)),
            BenchEvent::Drive(axis, duty) => changes.push((at, axis, duty)),
            _ => {}
        });
        came.into_iter().for_each(|(at, byte)| self.host.receive(at, byte));
    }

    fn until(&mut self, what: &str, is_so: impl Fn(&Self) -> bool) {
        let end = self.bench.now() + Duration::from_secs(20);
        while !is_so(self) {
            assert!(self.bench.now() < end, "{what}: {:?} {:?}", self.notices, self.reached);
            self.step();
        }
    }
}

fn square() -> Vec<PenMove> {
    let corners = [(2_000, 0), (2_000, 2_000), (0, 2_000), (0, 0)];
    corners.map(|(x, y)| PenMove { pen: Pen::Down, target: StepPoint::new(x, y) }).to_vec()
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_stop_over_frames_passes_the_window_by() {
    let mut line = Line::new(&square());
    line.until("on its way", |line| line.bench.controller().gantry().position().x > 500);
    line.host.order(Order::Stop);
    let ordered = line.bench.now();
    line.until("stopped", |line| is_off(line.bench.controller()));
    let took = line.bench.now() - ordered;
    // 00 21 00, after what is left of the byte on the line: not the frames before it, nor those in the
    // window.
    assert!(took <= Duration::from_micros(200), "{took:?}");
    line.until("told", |line| line.host.state() == Order::Stop);
    let stopped_at = line.bench.controller().gantry().position();
    let before = line.changes.len();
    for _ in 0..50_000 {
        line.step(); // half a second
    }
    assert!(line.changes[before..].iter().all(|&(.., duty)| duty == 0));
    let stands = line.bench.controller().gantry().position();
    assert!(stands.x.abs_diff(stopped_at.x) < 400, "{stopped_at:?} {stands:?}"); // run-down
    assert_eq!(line.host.position(), stands);
    line.host.order(Order::GoOn);
    line.until("drawn", |line| line.host.is_done());
    let corners: Vec<_> = square().iter().map(|one| one.target).collect();
    assert_eq!(line.reached, corners);
    assert_eq!(line.notices, [HostNotice::Stopped, HostNotice::GoesOn]);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_hold_lets_the_target_be_finished_and_begins_no_other() {
    let mut line = Line::new(&square());
    line.until("on its way", |line| line.bench.controller().gantry().position().x > 500);
    line.host.order(Order::Hold);
    line.until("the first corner", |line| line.reached.len() == 1);
    for _ in 0..50_000 {
        line.step();
    }
    assert_eq!(line.reached, [StepPoint::new(2_000, 0)]);
    assert_eq!(line.bench.controller().state(), Order::Hold);
    line.host.order(Order::GoOn);
    line.until("drawn", |line| line.host.is_done());
    assert_eq!(line.notices, [HostNotice::Held, HostNotice::GoesOn]);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_button_at_a_linked_machine_is_told_and_another_host_learns_of_it() {
    let mut line = Line::new(&square());
    line.until("on its way", |line| line.bench.controller().gantry().position().x > 500);
    let now = line.bench.now();
    line.bench.controller_mut().gantry_mut().emergency_stop(now, true);
    line.until("told", |line| line.host.state() == Order::Stop);
    line.host.order(Order::GoOn); // from afar nothing is taken back that was stopped here
    for _ in 0..20_000 {
        line.step();
    }
    assert!(is_off(line.bench.controller()));
    assert_eq!(line.host.state(), Order::Stop);
    let resume = line.host.progress().resume.unwrap();
    let fresh = Line::new(&square()).host;
    line.host = fresh.resuming(resume);
    line.notices.clear();
    line.until("the new host knows", |line| line.host.state() == Order::Stop);
    assert_eq!(line.notices, [HostNotice::Stopped]);
    let now = line.bench.now();
    line.bench.controller_mut().gantry_mut().emergency_stop(now, false);
    line.bench.controller_mut().gantry_mut().reset_emergency_stop(now);
    line.until("drawn", |line| line.host.is_done());
    assert_eq!(line.host.progress().reached, 4);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_machine_stops_by_three_bytes_in_any_session_or_none() {
    let mut linked = Linked::new(
        Gantry::new(&machine(), SafetyGate::new(LimitSwitches::RELEASED, false)),
        7,
        LinkSettings::default(),
    );
    assert_eq!(linked.link().state(), LinkState::Idle);
    linked.receive(Duration::ZERO, b'!');
    assert!(linked.gantry().is_stopped());
    linked.receive(Duration::ZERO, b'~');
    assert!(!linked.gantry().is_stopped());
    let mut line = Line::new(&square());
    line.until("on its way", |line| line.bench.controller().gantry().position().x > 500);
    let now = line.bench.now();
    // A program that knows nothing of the session.
    for byte in [0x44, 0, b'!', 0] {
        assert!(!is_off(line.bench.controller()));
        BenchController::receive(line.bench.controller_mut(), now, byte);
    }
    assert!(is_off(line.bench.controller()));
    line.until("told", |line| line.notices == [HostNotice::Stopped]);
    line.host.order(Order::GoOn);
    line.until("drawn", |line| line.host.is_done());
}
