//! The player's rules of time and order, on a controller small enough to follow by hand.

use plotter_motion::{Axis, Direction};
use plotter_replay::log::{Event, Record, SwitchName};
use plotter_replay::{
    Controller, Outcome, Player, PlayerSettings,
    player::{Answer, Compared, Difference, Stuck},
};
use std::collections::VecDeque;
use std::time::Duration;

/// Answers `+` to every tenth byte and a pulse to every edge, says `.` at each tick, drives with the count of
/// bytes so far, and is silent while the emergency stop is pressed.
#[derive(Default)]
struct Counter {
    bytes: i32,
    out: VecDeque<u8>,
    tick_every: Option<Duration>,
    next_tick: Option<Duration>,
    stopped: bool,
}

impl Counter {
    fn ticking(every: Duration) -> Self {
        Self { tick_every: Some(every), next_tick: Some(every), ..Self::default() }
    }
}

impl Controller for Counter {
    fn receive(&mut self, _: Duration, _: u8) {
        self.bytes += 1;
        if self.bytes % 10 == 0 && !self.stopped {
            self.out.push_back(b'+');
        }
    }
    fn edge(&mut self, _: Duration, axis: Axis, sign: Direction) {
        let byte = match (axis, sign) {
            (Axis::X, Direction::Plus) => b'1',
            (Axis::X, Direction::Minus) => b'2',
            (Axis::Y, Direction::Plus) => b'3',
            (Axis::Y, Direction::Minus) => b'4',
        };
        self.out.push_back(byte);
    }
    fn switch(&mut self, _: Duration, _: &SwitchName, pressed: bool) {
        if pressed {
            self.out.push_back(b'C');
        }
    }
    fn emergency_stop(&mut self, _: Duration, pressed: bool) {
        self.stopped = pressed;
    }
    fn next_tick(&self) -> Option<Duration> {
        self.next_tick
    }
    fn tick(&mut self, now: Duration) {
        self.out.push_back(b'.');
        self.next_tick = self.tick_every.map(|every| now + every);
    }
    fn transmit(&mut self) -> Option<u8> {
        self.out.pop_front()
    }
    fn duty(&self, _: Axis) -> i32 {
        self.bytes
    }
}

fn us(us: u64) -> Duration {
    Duration::from_micros(us)
}

fn host(time: u64, count: usize) -> Record {
    Record::at_us(time, Event::Host(vec![0; count]))
}

fn said(time: u64, bytes: &[u8]) -> Record {
    Record::at_us(time, Event::Controller(bytes.to_vec()))
}

fn edge(time: u64) -> Record {
    Record::at_us(time, Event::Edge { axis: Axis::X, sign: Direction::Plus })
}

fn check(records: &[Record], controller: Counter) -> Outcome {
    Player::default().check(records.to_vec(), controller)
}

fn difference(outcome: Outcome) -> Difference {
    match outcome {
        Outcome::FirstDifference(difference) => *difference,
        Outcome::Equal(compared) => panic!("equal: {compared}"),
    }
}

#[test]
fn a_byte_takes_ten_bit_times_and_waits_for_the_one_before() {
    // 39.0625 us a byte at 256000 baud: 100 + 39.06 and then + 39.06, each rounded up
    let records = [edge(100), edge(100), said(140, b"1"), said(179, b"1")];
    let equal = Outcome::Equal(Compared { records: 4, bytes: 2, ..Compared::default() });
    assert_eq!(check(&records, Counter::default()), equal);
    let late = difference(check(&[edge(100), said(141, b"1")], Counter::default()));
    assert_eq!(late.expected, Answer::Byte { time: us(141), byte: b'1' });
    assert_eq!(late.got, Answer::Byte { time: us(140), byte: b'1' });
    let slow = Player::new(PlayerSettings::default().with_baud(9_600));
    assert!(slow.check([edge(100), said(1_142, b"1")], Counter::default()).is_equal()); // 1041.667 us
}

#[test]
fn ticks_come_before_records_of_the_same_time() {
    let records = [edge(1_000), said(1_040, b"."), said(1_079, b"1"), said(2_040, b".")];
    assert!(check(&records, Counter::ticking(us(1_000))).is_equal());
}

#[test]
fn among_equal_times_the_order_of_the_records_decides() {
    let duty = |duty| Record::at_us(50, Event::Drive { axis: Axis::Y, duty });
    let records = [host(50, 1), duty(1), host(50, 1), duty(2)];
    assert_eq!(
        check(&records, Counter::default()),
        Outcome::Equal(Compared { records: 4, duties: 2, ..Compared::default() })
    );
    let wrong = difference(check(&[host(50, 1), host(50, 1), duty(1)], Counter::default()));
    assert_eq!(wrong.got, Answer::Duty { axis: Axis::Y, duty: 2 });
    assert_eq!(wrong.index, 2);
}

#[test]
fn an_answer_that_is_missing_or_too_much_is_the_difference() {
    let missing = difference(check(&[host(0, 9), said(100, b"+"), edge(500)], Counter::default()));
    assert_eq!((missing.index, missing.got), (1, Answer::Byte { time: us(540), byte: b'1' }));
    let silent = difference(check(&[host(0, 8), said(100, b"+"), host(500, 1)], Counter::default()));
    assert_eq!((silent.index, silent.got), (1, Answer::Nothing));
    let last = difference(check(&[host(0, 9), said(100, b"+")], Counter::default()));
    assert_eq!((last.time, last.got), (us(100), Answer::Nothing));
    let extra = difference(check(&[host(0, 10), host(500, 1)], Counter::default()));
    assert_eq!((extra.time, extra.expected), (us(40), Answer::Nothing));
    // The recorder may have been stopped before the byte was through.
    assert!(check(&[host(0, 10)], Counter::default()).is_equal());
}

#[test]
fn a_tolerance_lets_grouped_bytes_pass() {
    let records = [edge(100), edge(150), said(300, b"11"), host(2_000, 1)];
    assert!(!check(&records, Counter::default()).is_equal());
    let real = Player::new(PlayerSettings::default().with_tolerance(us(1_000)));
    assert!(real.check(records, Counter::default()).is_equal());
    assert!(!real.check([edge(100), said(1_141, b"1")], Counter::default()).is_equal());
}

#[test]
fn switches_and_the_emergency_stop_are_inputs() {
    let estop = Record::at_us(10, Event::Estop(true));
    let switch = Record::at_us(20, Event::Switch { name: SwitchName::new("x-min").unwrap(), pressed: true });
    assert!(
        check(&[estop, switch, said(60, b"C"), host(70, 10), host(500, 1)], Counter::default()).is_equal()
    );
}

#[test]
fn the_difference_shows_what_was_around_it() {
    let records: Vec<_> =
        (1..20).flat_map(|n| [edge(n * 100), said(n * 100 + if n == 10 { 41 } else { 40 }, b"1")]).collect();
    insta::assert_snapshot!(check(&records, Counter::default()).to_string(), @r"
    first difference at 1041 us, record 19
      recorded: byte 0x31 '1' at 1041 us
      now:      byte 0x31 '1' at 1040 us
      equal until then: 9 answered bytes and 0 duty cycles in 19 records
             9  540 < 31
            10  600 @ edge x+
            11  640 < 31
            12  700 @ edge x+
            13  740 < 31
            14  800 @ edge x+
            15  840 < 31
            16  900 @ edge x+
            17  940 < 31
            18  1000 @ edge x+
      >     19  1041 < 31
            20  1100 @ edge x+
            21  1140 < 31
            22  1200 @ edge x+
            23  1240 < 31
            24  1300 @ edge x+
            25  1340 < 31
            26  1400 @ edge x+
            27  1440 < 31
            28  1500 @ edge x+
            29  1540 < 31
    ");
}

#[test]
fn a_controller_that_never_rests_is_stopped() {
    let stuck = |controller| difference(check(&[host(1_000, 1)], controller)).got;
    let ticks = stuck(Counter::ticking(Duration::ZERO));
    assert_eq!(ticks, Answer::Stuck(Stuck::TicksWithoutEnd { time: us(0) }));

    struct Babbler;
    impl Controller for Babbler {
        fn receive(&mut self, _: Duration, _: u8) {}
        fn transmit(&mut self) -> Option<u8> {
            Some(b'1')
        }
    }
    let babble = difference(Player::default().check([host(5, 1)], Babbler)).got;
    assert_eq!(babble, Answer::Stuck(Stuck::BytesWithoutEnd { time: us(5) }));

    let silence = difference(check(&[host(u64::MAX, 1)], Counter::ticking(us(1)))).got;
    assert_eq!(silence, Answer::Stuck(Stuck::LongSilence { silence: us(u64::MAX) }));
}
