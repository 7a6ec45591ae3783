//! A protocol of one's own under a golden test: a recording is made and holds, and a changed firmware is
//! found by it.
//!
//! `cargo run --release --example golden_protocol -- protocol.plog`

use plotter_replay::Controller;
use plotter_replay::golden::{self, Mode};
use plotter_replay::log::{Event, Header, Record};
use std::collections::VecDeque;
use std::io::Write;
use std::path::Path;
use std::time::Duration;

/// A firmware that answers each digit with the sum of all until then, as a letter: `2` with C, `3` then with
/// F.
#[derive(Default)]
struct Summing {
    sum: u8,
    answers: VecDeque<u8>,
}

impl Controller for Summing {
    fn receive(&mut self, _now: Duration, byte: u8) {
        self.sum = (self.sum + byte.saturating_sub(b'0')) % 26;
        self.answers.push_back(b'A' + self.sum);
    }

    fn transmit(&mut self) -> Option<u8> {
        self.answers.pop_front()
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let name = std::env::args().nth(1).ok_or("which file for the recording?")?;
    let (path, mut out) = (Path::new(&name), std::io::stdout());

    // What the host sent, a byte each millisecond; and what the firmware answers to it.
    let sent = |(ms, byte)| Record { time: Duration::from_millis(ms), event: Event::Host(vec![byte]) };
    let inputs: Vec<_> = (1..).zip(*b"2357").map(sent).collect();
    golden::record(path, &Header::new().with_number("baud", 115_200), &inputs, Summing::default())?;

    // In a test of the firmware: golden::assert_replays(path, Summing::default).
    golden::check(path, Summing::default, Mode::Compare)?;
    writeln!(out, "it answers as recorded")?;
    let changed = || Summing { sum: 1, ..Summing::default() };
    match golden::check(path, changed, Mode::Compare) {
        Err(difference) => Ok(writeln!(out, "changed: {difference}")?),
        Ok(()) => Err("the change was not found".into()),
    }
}
