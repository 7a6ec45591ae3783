//! The reliable link over bad lines: what is written is read, once and in order.

#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    reason = "a test may panic; its numbers are small"
)]

use crate::line;

use core::time::Duration;
use line::{Connection, End};
use plotter_motion::protocol::{Link, LinkSettings, LinkState};
use plotter_replay::transport::Faults;

const SECOND: Duration = Duration::from_secs(1);
const BAUD: u32 = 256_000;

/// Writes a row of numbers as fast as it can, and reads what comes.
struct Stream<const W: usize, const P: usize> {
    link: Link<W, P>,
    written: u32,
    most: u32,
    heard: Vec<u8>,
    /// Reads only so much each time it is polled.
    reads: usize,
}

/// The bytes of the row, which no shift maps on itself.
fn byte_of(n: u32) -> u8 {
    (n.wrapping_mul(2_654_435_761) >> 24) as u8
}

impl<const W: usize, const P: usize> Stream<W, P> {
    fn new(link: Link<W, P>, most: u32) -> Self {
        Self { link, written: 0, most, heard: Vec::new(), reads: usize::MAX }
    }

    fn is_right(&self) -> bool {
        self.heard.iter().enumerate().all(|(n, &byte)| byte == byte_of(n as u32))
    }
}

impl<const W: usize, const P: usize> End for Stream<W, P> {
    fn receive(&mut self, now: Duration, byte: u8) {
        self.link.receive(now, byte);
    }

    fn poll(&mut self, _now: Duration) {
        while self.written < self.most && self.link.write(&[byte_of(self.written)]) == 1 {
            self.written += 1;
        }
        let mut byte = [0];
        for _ in 0..self.reads {
            if self.link.read(&mut byte) == 0 {
                break;
            }
            self.heard.extend(byte);
        }
    }

    fn transmit(&mut self, now: Duration) -> Option<u8> {
        self.link.transmit(now)
    }

    fn next_wake(&self) -> Option<Duration> {
        self.link.next_wake()
    }
}

type Both<const W: usize, const P: usize> = Connection<Stream<W, P>, Stream<W, P>>;

fn both<const W: usize, const P: usize>(faults: &Faults, seed: u64, down: u32, up: u32) -> Both<W, P> {
    let settings = LinkSettings::default();
    let host = Stream::new(Link::host(7, settings), down);
    Connection::new(BAUD, faults, seed, host, Stream::new(Link::machine(settings), up))
}

fn all_heard<const W: usize, const P: usize>(host: &Stream<W, P>, machine: &Stream<W, P>) -> bool {
    machine.heard.len() as u32 >= host.most && host.heard.len() as u32 >= machine.most
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_good_line_is_used_to_nine_tenths_in_both_directions() {
    const BYTES: u32 = 256_000;
    let mut line = both::<8, 128>(&Faults::default(), 1, BYTES, BYTES);
    let done = line.run(60 * SECOND, all_heard);
    assert!(done, "{} {} {:?}", line.host.heard.len(), line.machine.heard.len(), line.host.link.counts());
    assert!(line.host.is_right() && line.machine.is_right());
    let share = f64::from(BYTES) / line.now.as_secs_f64() / f64::from(BAUD / 10);
    println!("{:.1} % of the line's bytes are payload, both ways at once, with the greeting", share * 100.0);
    assert!(share >= 0.9, "{share}");
    assert_eq!(line.host.link.counts().sent_again, 0);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn on_a_bad_line_all_comes_in_order_and_once() {
    for seed in 0..20 {
        let mut line = both::<4, 64>(&Faults::mixed(0.01), seed, 5_000, 5_000);
        assert!(
            line.run(600 * SECOND, all_heard),
            "seed {seed}: {:?} {:?}",
            line.host.link.counts(),
            line.machine.link.counts()
        );
        assert!(line.host.is_right() && line.machine.is_right(), "seed {seed}");
        assert!(line.host.heard.len() == 5_000 && line.machine.heard.len() == 5_000);
    }
}

#[test]
fn a_reader_that_is_slow_holds_the_writer_back() {
    let mut line = both::<4, 32>(&Faults::default(), 1, 2_000, 0);
    line.machine.reads = 0;
    assert!(!line.run(10 * SECOND, all_heard));
    assert!(line.host.written <= 2 * 4 * 32, "{}", line.host.written); // a window there and one here
    assert_eq!(line.host.link.counts().sent_again, 0);
    line.machine.reads = 1;
    assert!(line.run(600 * SECOND, all_heard) && line.machine.is_right());
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_cable_that_was_out_for_ten_seconds_costs_time_only() {
    let cut = vec![SECOND / 2..SECOND * 21 / 2];
    let mut line = both::<4, 64>(&Faults { cut, ..Faults::default() }, 1, 40_000, 10_000);
    assert!(!line.run(10 * SECOND, all_heard));
    assert_eq!(line.host.link.state(), LinkState::Interrupted);
    assert!(line.run(60 * SECOND, all_heard) && line.host.is_right() && line.machine.is_right());
    assert_eq!(line.host.link.state(), LinkState::Open);
    // a sixteenth of a second for each 1600 bytes, half a second until the next frame goes out again
    assert!(line.now < SECOND * 13, "{:?}", line.now);
}

#[test]
fn a_machine_of_digits_is_known_by_its_silence_and_stands_still() {
    struct Deaf(Vec<u8>);
    impl End for Deaf {
        fn receive(&mut self, _now: Duration, byte: u8) {
            self.0.push(byte);
        }
        fn poll(&mut self, _now: Duration) {}
        fn transmit(&mut self, _now: Duration) -> Option<u8> {
            None
        }
        fn next_wake(&self) -> Option<Duration> {
            None
        }
    }
    let host = Stream::<4, 64>::new(Link::host(7, LinkSettings::default()), 100);
    let mut line = Connection::new(BAUD, &Faults::default(), 1, host, Deaf(Vec::new()));
    assert!(line.run(SECOND * 1001 / 1000, |host, _| host.link.state() == LinkState::DigitsOnly));
    // whole targets (0, 0), and nothing else
    assert!(line.machine.0.len() % 10 == 0 && line.machine.0.iter().all(|&byte| byte == 0));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_host_started_anew_opens_a_session_of_its_own() {
    let mut line = both::<4, 64>(&Faults::mixed(0.01), 3, 2_000, 2_000);
    line.run(SECOND / 20, |_, _| false);
    line.host = Stream::new(Link::host(8, LinkSettings::default()), 2_000);
    (line.machine.written, line.machine.heard) = (0, Vec::new());
    assert!(line.run(60 * SECOND, |host, _| host.link.state() == LinkState::Open));
    assert_eq!(line.host.link.session(), line.machine.link.session());
    (line.machine.written, line.machine.heard) = (line.machine.written, Vec::new());
    assert!(line.run(60 * SECOND, |_, machine| machine.heard.len() >= 2_000));
    assert!(line.machine.is_right());
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_machine_switched_off_and_on_is_noticed() {
    let mut line = both::<4, 64>(&Faults::default(), 3, 200_000, 0);
    line.run(SECOND, |_, _| false);
    line.machine = Stream::new(Link::machine(LinkSettings::default()), 0);
    assert!(line.run(5 * SECOND, |host, _| host.link.state() == LinkState::Restarted));
}

#[test]
fn an_end_takes_a_kilobyte_and_a_quarter() {
    let bytes = size_of::<Link<4, 64>>();
    println!("a link with a window of 4 and payloads of 64: {bytes} bytes");
    assert!(bytes <= 1500);
}
