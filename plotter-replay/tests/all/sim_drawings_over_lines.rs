//! Whole drawings over bad lines, by frames and by digits: which targets the machine goes to.

#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    reason = "a test may panic; its numbers are small"
)]

use crate::line;

use core::time::Duration;
use line::{Connection, End};
use plotter_motion::control::LineController;
use plotter_motion::firmware::{Gantry, GantrySettings, LinkedGantry};
use plotter_motion::protocol::{
    Host, HostEvent, HostNotice, HostSettings, LinkHost, LinkSettings, Order, Resume, digits,
};
use plotter_motion::{Axis, Demand, Direction, Drive, LimitSwitches, Pen, PenMove, SafetyGate, StepPoint};
use plotter_replay::transport::Faults;
use std::vec::IntoIter;

const SECOND: Duration = Duration::from_secs(1);
const BAUD: u32 = 256_000;
const BOOT: u32 = 4711;
const SETTINGS: GantrySettings =
    GantrySettings { resync_gap_us: 100_000, most: StepPoint::new(23_760, 16_800) };

/// Motors without mass: at the target after so many runs of the loop. Remembers where it was sent.
#[derive(Clone, Debug, Default)]
struct Massless {
    targets: Vec<StepPoint>,
    position: StepPoint,
    runs_left: u32,
    runs: u32,
}

impl LineController for Massless {
    fn period(&self) -> Option<Duration> {
        Some(Duration::from_millis(1))
    }

    fn start(&mut self, _now: Duration, target: StepPoint) -> Demand {
        self.targets.push(target);
        self.runs_left = self.runs;
        Demand::NONE
    }

    fn edge(&mut self, _now: Duration, _axis: Axis, _direction: Direction) -> Demand {
        Demand::NONE
    }

    fn tick(&mut self, _now: Duration) -> Demand {
        self.runs_left = self.runs_left.saturating_sub(1);
        if let (0, Some(&target)) = (self.runs_left, self.targets.last()) {
            self.position = target;
        }
        Demand::NONE
    }

    fn applied(&mut self, _drive: Drive) {}

    fn position(&self) -> StepPoint {
        self.position
    }

    fn has_arrived(&self) -> bool {
        self.targets.last().is_none_or(|&target| self.position == target)
    }
}

type Linked = LinkedGantry<4, 64, Massless>;

fn massless(runs: u32) -> Gantry<Massless> {
    Gantry::with_settings(
        SETTINGS,
        Massless { runs, ..Massless::default() },
        SafetyGate::new(LimitSwitches::RELEASED, false),
    )
}

fn linked(runs: u32) -> Linked {
    Linked::new(massless(runs), BOOT, LinkSettings::default())
}

/// A machine, with the targets it was sent to.
struct Machine<M> {
    inner: M,
}

impl End for Machine<Linked> {
    fn receive(&mut self, now: Duration, byte: u8) {
        self.inner.receive(now, byte);
    }

    fn poll(&mut self, now: Duration) {
        self.inner.gantry_mut().tick(now);
        self.inner.poll(now);
    }

    fn transmit(&mut self, now: Duration) -> Option<u8> {
        self.inner.transmit(now)
    }

    fn next_wake(&self) -> Option<Duration> {
        [self.inner.next_wake(), self.inner.gantry().next_tick()].into_iter().flatten().min()
    }
}

impl End for Machine<Gantry<Massless>> {
    fn receive(&mut self, now: Duration, byte: u8) {
        self.inner.receive(now, byte);
    }

    fn poll(&mut self, now: Duration) {
        self.inner.tick(now);
    }

    fn transmit(&mut self, _now: Duration) -> Option<u8> {
        self.inner.transmit()
    }

    fn next_wake(&self) -> Option<Duration> {
        self.inner.next_tick()
    }
}

/// What a host told.
#[derive(Default)]
struct Told {
    begun: Vec<PenMove>,
    reached: Vec<PenMove>,
    notices: Vec<HostNotice>,
}

impl Told {
    fn take(&mut self, event: Option<HostEvent>) -> bool {
        match event {
            Some(HostEvent::Begun(begun)) => self.begun.push(begun),
            Some(HostEvent::Reached(reached)) => self.reached.push(reached),
            Some(HostEvent::Notice(notice)) => self.notices.push(notice),
            None => return false,
        }
        true
    }
}

struct ByLink {
    host: LinkHost<IntoIter<PenMove>, 4, 64>,
    told: Told,
}

impl End for ByLink {
    fn receive(&mut self, now: Duration, byte: u8) {
        self.host.receive(now, byte);
        while self.told.take(self.host.poll(now)) {}
    }

    fn poll(&mut self, now: Duration) {
        while self.told.take(self.host.poll(now)) {}
    }

    fn transmit(&mut self, now: Duration) -> Option<u8> {
        self.host.next_byte(now)
    }

    fn next_wake(&self) -> Option<Duration> {
        self.host.next_wake()
    }
}

struct ByDigits {
    host: Host<IntoIter<PenMove>>,
    told: Told,
}

impl End for ByDigits {
    fn receive(&mut self, now: Duration, byte: u8) {
        let event = self.host.receive(now, byte);
        self.told.take(event);
    }

    fn poll(&mut self, now: Duration) {
        while self.told.take(self.host.poll(now)) {}
    }

    fn transmit(&mut self, now: Duration) -> Option<u8> {
        self.host.next_byte(now)
    }

    fn next_wake(&self) -> Option<Duration> {
        self.host.next_wake()
    }
}

/// A drawing of some strokes: another for each number.
fn drawing(number: u64, targets: usize) -> Vec<PenMove> {
    let mut state = number.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut random = |below: i32| {
        // Marsaglia's xorshift
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 33) as i32 % below
    };
    let (mut x, mut y) = (random(23_000), random(16_000));
    (0..targets)
        .map(|_| {
            let pen = if random(6) == 0 { Pen::Up } else { Pen::Down };
            x = (x + random(401) - 200).clamp(0, SETTINGS.most.x);
            y = (y + random(401) - 200).clamp(0, SETTINGS.most.y);
            PenMove { pen, target: StepPoint::new(x, y) }
        })
        .collect()
}

fn targets_of(moves: &[PenMove]) -> Vec<StepPoint> {
    moves.iter().map(|step| step.target).collect()
}

fn link_host(nonce: u16, moves: &[PenMove]) -> ByLink {
    let moves = Vec::from(moves).into_iter();
    let gap = Duration::ZERO;
    let host = LinkHost::new(nonce, LinkSettings::default(), gap, HostSettings::default(), moves);
    ByLink { host, told: Told::default() }
}

fn linked_line(
    faults: &Faults,
    seed: u64,
    moves: &[PenMove],
    runs: u32,
) -> Connection<ByLink, Machine<Linked>> {
    Connection::new(BAUD, faults, seed, link_host(7, moves), Machine { inner: linked(runs) })
}

/// Where the machine was sent. A call torn in two by a held-up byte is one or two targets (0, 0) to it, where
/// it stands.
fn drawn(line: &Connection<ByLink, Machine<Linked>>) -> Vec<StepPoint> {
    let targets = &line.machine.inner.gantry().controller().targets;
    targets.iter().copied().skip_while(|&target| target == StepPoint::default()).collect()
}

/// Asserts that a drawing was drawn whole, in order, and each target once.
fn assert_drawn(line: &Connection<ByLink, Machine<Linked>>, moves: &[PenMove], what: &str) {
    assert_eq!(drawn(line), targets_of(moves), "{what}");
    assert_eq!(line.host.told.begun, moves, "{what}");
    assert_eq!(line.host.told.reached, moves, "{what}");
    assert_eq!(
        line.host.host.position(),
        moves.last().map_or(StepPoint::default(), |last| last.target),
        "{what}"
    );
}

/// As noisy as [`Faults::mixed`] with a hundredth, and bursts of up to a frame's length beside.
fn bursts(burst_bytes: u32) -> Faults {
    Faults { burst: 0.02 / f64::from(burst_bytes), burst_bytes, ..Faults::mixed(0.01) }
}

fn drawings_by_frames(count: u64, faults: &Faults) {
    let (mut bytes, mut damaged, mut time) = (0, 0, Duration::ZERO);
    for number in 0..count {
        let moves = drawing(number, 60);
        let mut line = linked_line(faults, number, &moves, 3);
        assert!(
            line.run(120 * SECOND, |host, _| host.host.is_done()),
            "drawing {number}: {:?}",
            line.host.told.notices
        );
        assert_drawn(&line, &moves, &format!("drawing {number}"));
        for counts in [line.to_machine.counts(), line.to_host.counts()] {
            bytes += counts.bytes;
            damaged += counts.damaged();
        }
        time += line.now;
    }
    println!(
        "{count} drawings of 60 targets by frames: all drawn whole, each target once; {damaged} of {bytes} bytes were \
         damaged, {:.2} s a drawing",
        time.as_secs_f64() / count as f64
    );
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn drawings_by_frames_come_whole_over_a_bad_line() {
    drawings_by_frames(50, &Faults::mixed(0.01));
}

/// Damage that comes in bursts: two bytes of a hundred, from a few at a time to more than a frame has. Noise
/// of so many bytes may be a stop by itself, three bytes, once in some hundred drawings; none of these is.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn drawings_by_frames_come_whole_through_bursts() {
    for burst_bytes in [3, 10, 40, 150] {
        drawings_by_frames(10, &bursts(burst_bytes));
    }
}

#[test]
#[ignore = "a thousand drawings, half a minute in a release build: .ci/run"]
fn a_thousand_drawings_by_frames_come_whole_over_a_bad_line() {
    drawings_by_frames(1000, &Faults::mixed(0.01));
}

/// The published controller, which takes ten bytes for a target whatever they are, at once.
#[derive(Default)]
struct PublishedMachine {
    digits: Vec<u8>,
    targets: Vec<StepPoint>,
    told: StepPoint,
    plus: bool,
}

impl End for PublishedMachine {
    fn receive(&mut self, _now: Duration, byte: u8) {
        self.digits.push(byte);
        if self.digits.len() == 10 {
            let number =
                |digits: &[u8]| digits.iter().rev().fold(0, |sum, &digit| 10 * sum + i32::from(digit));
            let (x, y) = self.digits.split_at(5);
            self.targets.push(StepPoint::new(number(x), number(y)));
            self.digits.clear();
            self.plus = true;
        }
    }

    fn poll(&mut self, _now: Duration) {}

    fn transmit(&mut self, _now: Duration) -> Option<u8> {
        let target = *self.targets.last()?;
        let (x, y) = ((target.x - self.told.x).signum(), (target.y - self.told.y).signum());
        if x != 0 {
            self.told.x += x;
            return Some(if x > 0 { b'1' } else { b'2' });
        }
        if y != 0 {
            self.told.y += y;
            return Some(if y > 0 { b'3' } else { b'4' });
        }
        std::mem::take(&mut self.plus).then_some(b'+')
    }

    fn next_wake(&self) -> Option<Duration> {
        None
    }
}

/// The published host, which sends the next target at each `+`, whatever was counted.
struct PublishedHost {
    left: IntoIter<PenMove>,
    bytes: Vec<u8>,
    done: bool,
}

impl PublishedHost {
    fn next(&mut self) {
        match self.left.next() {
            Some(next) => {
                self.bytes = digits::encode(next.target).unwrap().to_vec();
                self.bytes.reverse();
            }
            None => self.done = true,
        }
    }
}

impl End for PublishedHost {
    fn receive(&mut self, _now: Duration, byte: u8) {
        if byte == b'+' {
            self.next();
        }
    }

    fn poll(&mut self, _now: Duration) {}

    fn transmit(&mut self, _now: Duration) -> Option<u8> {
        self.bytes.pop()
    }

    fn next_wake(&self) -> Option<Duration> {
        None
    }
}

/// Targets, without those that were sent again where the motors stood.
fn without_repeats(targets: &[StepPoint]) -> Vec<StepPoint> {
    let mut targets = targets.to_vec();
    targets.dedup();
    targets
}

/// Whether a drawing by digits, as published, is drawn as sent.
fn published_is_right(number: u64) -> bool {
    let moves = drawing(number, 60);
    let mut host = PublishedHost { left: moves.clone().into_iter(), bytes: Vec::new(), done: false };
    host.next();
    let mut line = Connection::new(BAUD, &Faults::mixed(0.01), number, host, PublishedMachine::default());
    line.run(60 * SECOND, |host, _| host.done) && line.machine.targets == targets_of(&moves)
}

/// Whether a drawing by digits with our host and controller is drawn as sent, and whether the host noticed
/// anything.
fn checked_is_right(number: u64) -> (bool, bool) {
    let moves = drawing(number, 60);
    let settings = HostSettings { most_given_up: u8::MAX, ..HostSettings::default() };
    let host = Host::new(Duration::ZERO, settings, moves.clone().into_iter());
    let host = ByDigits { host, told: Told::default() };
    let mut line = Connection::new(BAUD, &Faults::mixed(0.01), number, host, Machine { inner: massless(3) });
    line.run(3600 * SECOND, |host, _| host.host.is_done());
    let drawn = without_repeats(&line.machine.inner.controller().targets);
    (drawn == without_repeats(&targets_of(&moves)), !line.host.told.notices.is_empty())
}

fn drawings_by_digits(count: u64) {
    let published = (0..count).filter(|&number| !published_is_right(number)).count();
    let ruined: Vec<_> = (0..count).map(checked_is_right).filter(|&(right, _)| !right).collect();
    let noticed = ruined.iter().filter(|&&(_, noticed)| noticed).count();
    println!(
        "{count} drawings of 60 targets by digits: {published} not drawn as sent as published; {} with our host and \
         controller, {noticed} of which the host noticed",
        ruined.len()
    );
    assert!(published as u64 > count * 9 / 10 && !ruined.is_empty() && noticed == ruined.len());
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn drawings_by_digits_are_ruined_and_our_host_notices_all() {
    drawings_by_digits(20);
}

#[test]
#[ignore = "a thousand drawings, most of them with long silences: .ci/run"]
fn of_a_thousand_drawings_by_digits_our_host_notices_all_that_are_ruined() {
    drawings_by_digits(1000);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_cable_out_for_ten_seconds_costs_ten_seconds() {
    let moves = drawing(1, 300);
    let mut whole = linked_line(&Faults::default(), 1, &moves, 10);
    assert!(whole.run(60 * SECOND, |host, _| host.host.is_done()));
    let cut = vec![SECOND..SECOND * 11];
    let mut line = linked_line(&Faults { cut, ..Faults::mixed(0.01) }, 1, &moves, 10);
    assert!(line.run(60 * SECOND, |host, _| host.host.is_done()));
    assert_drawn(&line, &moves, "with a cut");
    let notices = &line.host.told.notices;
    assert!(
        notices.contains(&HostNotice::Interrupted) && notices.contains(&HostNotice::Resumed),
        "{notices:?}"
    );
    println!(
        "{:.2} s, and with the cable out for 10 s {:.2} s",
        whole.now.as_secs_f64(),
        line.now.as_secs_f64()
    );
    assert!(line.now < whole.now + 11 * SECOND);
}

#[test]
#[ignore = "long: .ci/run has it in release"]
fn a_stop_over_a_bad_line_is_obeyed_and_costs_no_target() {
    let mut slowest = Duration::ZERO;
    for number in 0..20 {
        let moves = drawing(number, 120);
        let mut line = linked_line(&Faults::mixed(0.01), number, &moves, 20);
        line.run(Duration::from_millis(300 + 7 * number), |_, _| false);
        for order in [Order::Stop, Order::GoOn, Order::Hold, Order::GoOn] {
            let began = line.now;
            line.host.host.order(order);
            let until = began + 5 * SECOND;
            assert!(line.run(until, |_, machine| machine.inner.state() == order), "{number}: {order:?}");
            if order == Order::Stop {
                slowest = slowest.max(line.now - began);
            }
            assert!(line.run(until, |host, _| host.host.state() == order), "{number}: {order:?} is not told");
            let stands = drawn(&line).len();
            line.run(line.now + SECOND / 10, |_, _| false);
            assert!(order == Order::GoOn || drawn(&line).len() == stands, "{number}: {order:?}");
        }
        assert!(line.run(line.now + 60 * SECOND, |host, _| host.host.is_done()), "{number}");
        assert_drawn(&line, &moves, &format!("drawing {number}"));
    }
    println!("the slowest of 20 stops came {:.2} ms after the order", slowest.as_secs_f64() * 1e3);
    // Three bytes and a hold-up of 20 ms, or the repetition after 30 ms.
    assert!(slowest < SECOND / 10, "{slowest:?}");
}

#[test]
#[ignore = "long: .ci/run has it in release"]
fn a_host_killed_and_started_anew_goes_on_at_the_right_target() {
    for number in 0..20 {
        let moves = drawing(number, 100);
        let mut line = linked_line(&Faults::mixed(0.01), number, &moves, 10);
        // somewhere in the middle
        line.run(Duration::from_millis(600 + 15 * number), |_, _| false);
        let progress = line.host.host.progress();
        assert!(progress.reached > 0 && !line.host.host.is_done());
        let before = line.host.told.reached.clone();
        let mut host = link_host(1000 + number as u16, &moves);
        host.host = host.host.resuming(progress.resume.unwrap());
        line.host = host;
        assert!(line.run(120 * SECOND, |host, _| host.host.is_done()), "{number}");
        assert_eq!(drawn(&line), targets_of(&moves), "{number}");
        assert_eq!(line.host.host.progress().reached, 100);
        assert!(line.host.told.reached.len() + before.len() <= 100);
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_machine_switched_off_in_the_middle_ends_the_drawing_with_a_word() {
    let moves = drawing(1, 100);
    let mut line = linked_line(&Faults::default(), 1, &moves, 10);
    line.run(SECOND, |_, _| false);
    line.machine = Machine { inner: Linked::new(massless(10), BOOT + 1, LinkSettings::default()) };
    assert!(line.run(20 * SECOND, |host, _| host.host.is_done()));
    assert_eq!(line.host.told.notices.last(), Some(&HostNotice::MachineRestarted));
    assert!(line.machine.inner.gantry().controller().targets.is_empty());
}

#[test]
fn a_target_outside_the_area_is_left_out_and_told() {
    let mut moves = drawing(1, 20);
    moves[10].target = StepPoint::new(-5, 100_000);
    let mut line = linked_line(&Faults::default(), 1, &moves, 2);
    assert!(line.run(20 * SECOND, |host, _| host.host.is_done()));
    assert_eq!(line.host.told.notices, [HostNotice::OutOfArea(moves[10].target)]);
    moves.remove(10);
    assert_eq!(line.host.told.reached, moves);
}

#[test]
fn either_side_that_knows_digits_only_is_understood() {
    let moves = drawing(1, 20);
    // a new host and an old machine
    let host = link_host(7, &moves);
    let mut line = Connection::new(BAUD, &Faults::default(), 1, host, Machine { inner: massless(2) });
    assert!(line.run(60 * SECOND, |host, _| host.host.is_done()));
    assert_eq!(line.host.told.notices, [HostNotice::DigitsOnly]);
    assert_eq!(line.host.told.reached, moves);
    // an old host and a new machine
    let host = Host::new(Duration::from_millis(1), HostSettings::default(), moves.clone().into_iter());
    let host = ByDigits { host, told: Told::default() };
    let mut line = Connection::new(BAUD, &Faults::default(), 1, host, Machine { inner: linked(2) });
    assert!(line.run(60 * SECOND, |host, _| host.host.is_done()));
    assert_eq!((line.host.told.reached.clone(), line.host.told.notices.len()), (moves.clone(), 0));
    assert_eq!(line.machine.inner.gantry().controller().targets, targets_of(&moves));
}

#[test]
fn a_drawing_after_a_drawing_begins_at_its_first_target() {
    let (first, second) = (drawing(1, 20), drawing(2, 20));
    let mut line = linked_line(&Faults::default(), 1, &first, 2);
    assert!(line.run(20 * SECOND, |host, _| host.host.is_done()));
    assert_eq!(line.host.host.progress().resume, Some(Resume { boot: BOOT, before: 0 }));
    line.host = link_host(8, &second);
    assert!(line.run(40 * SECOND, |host, _| host.host.is_done()));
    assert_eq!(line.host.host.progress().resume, Some(Resume { boot: BOOT, before: 20 }));
    assert_eq!(line.host.told.reached, second);
}
