//! The host of Marlin's language against a small machine that takes numbered lines as Marlin does.

use crate::law_cases::cases;
use plotter_motion::gcode::{PenControl, WriteOptions};
use plotter_motion::protocol::hosts::{
    HostState, LineHost, LineHostSettings, MachineHost as _, MachineNotice, Marlin, Request,
};
use plotter_motion::{PlotOp, Point, SplitMix64};
use proptest::prelude::*;
use std::time::Duration;

type Host = LineHost<Marlin<'static>, std::vec::IntoIter<PlotOp>>;

fn host(ops: &[PlotOp]) -> Host {
    let pen = PenControl::Commands { up: "G4 P0\nM280 P0 S160", down: "G4 P0\nM280 P0 S90" };
    let options = WriteOptions { pen, settle: Duration::ZERO, ..WriteOptions::default() };
    LineHost::new(Marlin::new(options), LineHostSettings::default(), Vec::from(ops).into_iter())
}

/// Takes the lines of a host that come whole and next, and notes their commands.
#[derive(Default)]
struct Machine {
    line: Vec<u8>,
    last: i64,
    taken: Vec<String>,
    answers: Vec<u8>,
}

impl Machine {
    fn say(&mut self, text: &str) {
        self.answers.extend(text.bytes().chain([b'\n']));
    }

    fn byte(&mut self, byte: u8) {
        if byte != b'\n' {
            self.line.push(byte);
            return;
        }
        let line = std::mem::take(&mut self.line);
        if line.is_empty() {
            return;
        }
        let Some(rest) = line.strip_prefix(b"N") else {
            let text = String::from_utf8_lossy(&line).into_owned();
            self.say(&format!("echo:Unknown command: \"{text}\""));
            return self.say("ok");
        };
        let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
        let number = std::str::from_utf8(&rest[..digits]).unwrap().parse().unwrap_or(-1_i64);
        let star = line.iter().rposition(|&byte| byte == b'*');
        let text = String::from_utf8_lossy(&line[..star.unwrap_or(line.len())]).into_owned();
        let begins = text.contains("M110");
        let checksum = star.map(|star| line[..star].iter().fold(0_u8, |sum, byte| sum ^ byte).to_string());
        let told = star.map(|star| String::from_utf8_lossy(&line[star + 1..]).into_owned());
        let why = match (number == self.last + 1 || begins, checksum) {
            (false, _) => Some("Line Number is not Last Line Number+1"),
            (_, None) => Some("No Checksum with line number"),
            (_, checksum) if checksum != told => Some("checksum mismatch"),
            _ => None,
        };
        if let Some(why) = why {
            self.say(&format!("Error:{why}, Last Line: {}", self.last));
            self.say(&format!("Resend: {}", self.last + 1));
            return self.say("ok");
        }
        self.last = number;
        // As Marlin's parser does, which ends a command at the first asterisk.
        let command = text.split('*').next().and_then(|text| text.split_once(' '));
        let command = command.map_or("", |(_, command)| command).to_owned();
        if command == "M114" {
            self.say("X:0.00 Y:0.00 Z:0.00 E:0.00 Count X:0 Y:0 Z:0");
        }
        self.taken.push(command);
        self.say("ok");
    }
}

/// A host and a machine, with a line between that damages bytes of both.
struct Desk<D> {
    host: Host,
    machine: Machine,
    now: Duration,
    notices: Vec<MachineNotice>,
    damage: D,
}

impl<D: FnMut(bool, u8) -> u8> Desk<D> {
    fn new(ops: &[PlotOp], damage: D) -> Self {
        let (host, machine) = (host(ops), Machine::default());
        let mut desk = Self { host, machine, now: Duration::ZERO, notices: Vec::new(), damage };
        desk.machine.say("start");
        desk
    }

    /// A millisecond, in which a few bytes go each way.
    fn round(&mut self) {
        self.now += Duration::from_millis(1);
        self.notices.extend(std::iter::from_fn(|| self.host.poll(self.now)));
        for _ in 0..11 {
            let Some(byte) = self.host.next_byte(self.now) else { break };
            self.machine.byte((self.damage)(true, byte));
        }
        let count = self.machine.answers.len().min(11);
        for byte in self.machine.answers.drain(..count) {
            self.host.receive(self.now, (self.damage)(false, byte));
        }
    }

    fn until(&mut self, is: impl Fn(HostState) -> bool) -> HostState {
        let end = self.now + Duration::from_secs(1_000);
        while self.now < end && !is(self.host.status().state) {
            self.round();
        }
        self.round(); // what it notices of it
        self.host.status().state
    }

    /// Draws to the end, or to where the host stops.
    fn draw(&mut self) -> HostState {
        self.until(|state| state == HostState::Ready);
        self.host.ask(self.now, Request::GoOn).unwrap();
        self.until(|state| matches!(state, HostState::Done | HostState::Stopped | HostState::Locked(_)))
    }
}

fn lines(count: usize) -> Vec<PlotOp> {
    let draw = |n: usize| PlotOp::Draw { to: Point::new(n as f64, (n % 7) as f64), feed_mm_s: Some(20.0) };
    (1..=count).map(draw).collect()
}

#[test]
fn lines_go_out_one_at_a_time_with_number_and_checksum() {
    let mut desk = Desk::new(&lines(2), |_, byte| byte);
    assert_eq!(desk.draw(), HostState::Done);
    assert_eq!(
        desk.machine.taken,
        [
            "M110",
            "M115",
            "M114",
            "G21",
            "G90",
            "G4 P0",
            "M280 P0 S160",
            "G0 X0 Y0",
            "G4 P0",
            "M280 P0 S90",
            "G1 X1 Y1 F1200",
            "G1 X2 Y2",
            "G4 P0",
            "M280 P0 S160",
            "G4 P0",
            "M114"
        ]
    );
    // The machine of this test stands where it was: the host says so at the end.
    let elsewhere = |n: &MachineNotice| matches!(n, MachineNotice::Elsewhere { .. });
    assert_eq!(desk.notices.iter().filter(|n| elsewhere(n)).count(), 1);
}

#[test]
fn a_line_is_sent_again_byte_by_byte() {
    let mut host = host(&[]);
    let now = Duration::ZERO;
    let say_at = |host: &mut Host, now, text: &str| text.bytes().for_each(|byte| host.receive(now, byte));
    let say = |host: &mut Host, text: &str| say_at(host, now, text);
    let sent = |host: &mut Host, now| {
        let bytes = std::iter::from_fn(|| host.next_byte(now)).collect();
        String::from_utf8(bytes).unwrap()
    };
    say(&mut host, "start\n");
    assert_eq!(sent(&mut host, now), "N0 M110*35\n");
    assert_eq!(sent(&mut host, now), "");
    say(&mut host, "ok\n");
    assert_eq!(sent(&mut host, now), "N1 M115*39\n");
    say(&mut host, "Error:checksum mismatch, Last Line: 0\nResend: 1\nok\n");
    assert_eq!(sent(&mut host, now), ""); // until it has heard all
    let later = now + Duration::from_millis(25);
    assert_eq!(sent(&mut host, later), "N1 M115*39\n");
    // In the middle of the next: that line ends, and comes again.
    say_at(&mut host, later, "ok N1 P15 B3\n");
    assert_eq!(host.next_byte(later), Some(b'N'));
    say_at(&mut host, later, "Resend: 1\n");
    assert_eq!(sent(&mut host, later), "\n");
    assert_eq!(sent(&mut host, later + Duration::from_millis(25)), "N1 M115*39\n");
}

#[test]
fn a_command_that_the_machine_does_not_know_is_refused_and_one_that_came_wrong_is_sent_again() {
    let now = Duration::ZERO;
    let mut host = host(&[]);
    let say = |host: &mut Host, text: &str| text.bytes().for_each(|byte| host.receive(now, byte));
    say(&mut host, "start\n");
    while host.next_byte(now).is_some() {}
    say(&mut host, "ok\n");
    while host.next_byte(now).is_some() {}
    say(&mut host, "echo:Unknown command: \"O1 M115\"\nok\n");
    say(&mut host, "echo:busy: processing\n");
    let later = Duration::from_millis(30);
    let again: Vec<u8> = std::iter::from_fn(|| host.next_byte(later)).collect();
    assert_eq!(again, b"N1 M115*39\n");
    say(&mut host, "echo:Unknown command: \"M115\"\nok\n");
    let notices: Vec<_> = std::iter::from_fn(|| host.poll(later)).collect();
    assert!(notices.contains(&MachineNotice::Refused { op: None, code: 1 }), "{notices:?}");
}

#[test]
fn a_machine_that_forgot_its_count_without_a_word_is_found_out() {
    let mut desk = Desk::new(&lines(40), |_, byte| byte);
    desk.until(|state| state == HostState::Ready);
    desk.host.ask(desk.now, Request::GoOn).unwrap();
    while desk.machine.last < 20 {
        desk.round();
    }
    desk.machine.last = 0; // switched off and on, and its greeting lost
    assert_eq!(desk.until(|state| state == HostState::Stopped), HostState::Stopped, "{:?}", desk.notices);
    let restarted = |n: &MachineNotice| matches!(n, MachineNotice::Restarted { .. });
    assert!(desk.notices.iter().any(restarted), "{:?}", desk.notices);
}

proptest! {
    #![proptest_config(cases(64))]

    /// Whatever bytes come wrong on either way, one in each line of the host, the machine takes each line
    /// once and in its order, or the host stops and says so.
    #[test]
    fn lines_arrive_once_and_in_order_over_a_bad_line(seed: u64, of in 20_usize..400, count in 1_usize..40) {
        let ops = lines(count);
        let mut plain = Desk::new(&ops, |_, byte| byte);
        prop_assert_eq!(plain.draw(), HostState::Done);
        let mut random = SplitMix64::new(seed);
        let mut desk = Desk::new(&ops, |_, byte: u8| byte);
        desk.until(|state| state == HostState::Ready);
        let Desk { host, machine, now, notices, .. } = desk;
        // One byte of a line of the host: of two the checksum may know nothing.
        let mut is_hit = false;
        let damage = |is_host: bool, byte: u8| {
            let hits = !(is_host && is_hit) && random.below(of) == 0;
            is_hit = if is_host { (is_hit || hits) && byte != b'\n' } else { is_hit };
            if hits { random.bits().to_le_bytes()[0] } else { byte }
        };
        let mut desk = Desk { host, machine, now, notices, damage };
        let state = desk.draw();
        let wanted = |taken: &[String]| -> Vec<String> {
            taken.iter().filter(|line| line.starts_with('G') && line.as_str() != "G4 P0").cloned().collect()
        };
        let (made, all) = (wanted(&desk.machine.taken), wanted(&plain.machine.taken));
        if state == HostState::Done {
            prop_assert_eq!(made, all);
        } else {
            prop_assert!(matches!(state, HostState::Stopped | HostState::Locked(_)), "{:?}", state);
            prop_assert!(all.starts_with(&made), "{:?}", made);
        }
    }
}
