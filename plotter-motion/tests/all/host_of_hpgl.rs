//! The host of HPGL against a buffer that is emptied slowly.

use plotter_motion::protocol::hosts::{
    HostState, Hpgl, LineHost, LineHostSettings, MachineHost as _, MachineNotice, Request,
};
use plotter_motion::{PlotOp, Point, SplitMix64};
use proptest::prelude::*;
use std::collections::VecDeque;
use std::time::Duration;

type Host = LineHost<Hpgl, std::vec::IntoIter<PlotOp>>;

fn host(ops: &[PlotOp]) -> Host {
    LineHost::new(Hpgl::new(), LineHostSettings::default(), Vec::from(ops).into_iter())
}

/// A plotter that keeps so many bytes, and carries one out each few milliseconds.
struct Plotter {
    size: usize,
    escape: Vec<u8>,
    initiator: Option<u8>,
    buffer: VecDeque<u8>,
    drawn: Vec<u8>,
    lost: usize,
    answers: VecDeque<u8>,
}

impl Plotter {
    fn new(size: usize) -> Self {
        let (escape, buffer, drawn) = (Vec::new(), VecDeque::new(), Vec::new());
        Self { size, escape, initiator: None, buffer, drawn, lost: 0, answers: VecDeque::new() }
    }

    fn answer(&mut self, text: &str) {
        self.answers.extend(self.initiator.into_iter().chain(text.bytes()).chain([b'\n']));
    }

    fn byte(&mut self, byte: u8) {
        if self.escape.is_empty() && byte != 0x1b {
            let is_room = self.buffer.len() < self.size;
            self.lost += usize::from(!is_room);
            return if is_room {
                self.buffer.push_back(byte)
            };
        }
        self.escape.push(byte);
        match self.escape.as_slice() {
            [_, b'.', b'B'] => self.answer(&(self.size - self.buffer.len()).to_string()),
            [_, b'.', b'E'] => self.answer(if self.lost > 0 { "16" } else { "0" }),
            [_, b'.', b'M', .., b':'] => self.initiator = self.escape.ends_with(b"69:").then_some(b'E'),
            [_, b'.', .., b':'] | [_, b'.', b'K'] => {}
            _ => return,
        }
        self.escape.clear();
    }

    fn carry_out(&mut self) {
        let Some(byte) = self.buffer.pop_front() else { return };
        self.drawn.push(byte);
        if self.drawn.ends_with(b"OI;") {
            self.answer("7475A");
        } else if self.drawn.ends_with(b"OE;") {
            self.answer("0");
        } else if self.drawn.ends_with(b"OF;") {
            self.answer("40,40");
        } else if self.drawn.ends_with(b"OA;") {
            self.answer("0,0,0");
        }
    }
}

/// Draws with a plotter of this size, whose answers come wrong once in `of` bytes; what it has drawn.
fn draw(ops: &[PlotOp], size: usize, seed: u64, of: usize) -> (Plotter, Vec<MachineNotice>, HostState) {
    let (mut host, mut plotter, mut random) = (host(ops), Plotter::new(size), SplitMix64::new(seed));
    let (mut notices, mut asked) = (Vec::new(), false);
    for ms in 0..400_000_u64 {
        let now = Duration::from_millis(ms);
        notices.extend(std::iter::from_fn(|| host.poll(now)));
        match host.status().state {
            HostState::Ready if !asked => {
                asked = true;
                host.ask(now, Request::GoOn).unwrap();
            }
            HostState::Done => break,
            _ => {}
        }
        for _ in 0..11 {
            let Some(byte) = host.next_byte(now) else { break };
            plotter.byte(byte);
        }
        if ms % 4 == 0 {
            plotter.carry_out();
        }
        while let Some(byte) = plotter.answers.pop_front() {
            let wrong = of > 0 && random.below(of) == 0;
            host.receive(now, if wrong { random.bits().to_le_bytes()[0] } else { byte });
        }
    }
    (plotter, notices, host.status().state)
}

fn lines(count: usize) -> Vec<PlotOp> {
    let draw = |n: usize| PlotOp::Draw { to: Point::new(n as f64, (n % 7) as f64), feed_mm_s: None };
    (1..=count).map(draw).collect()
}

#[test]
fn instructions_go_out_as_they_stand_in_the_manual() {
    let mut ops = vec![PlotOp::SelectPen { pen: 2 }];
    ops.extend(lines(2));
    let (plotter, notices, state) = draw(&ops, 1024, 0, 0);
    assert_eq!(state, HostState::Done, "{notices:?}");
    assert_eq!(
        String::from_utf8(plotter.drawn).unwrap(),
        "IN;SP1;OI;OA;IN;SP1;PU;SP2;PD40,40;PD80,80;PU80,80;PU;OE;OF;OA;"
    );
    assert_eq!(plotter.lost, 0);
}

#[test]
fn a_small_buffer_is_never_filled_beyond_its_size() {
    let (plotter, notices, state) = draw(&lines(300), 255, 0, 0);
    assert_eq!((state, plotter.lost), (HostState::Done, 0), "{notices:?}");
    assert!(plotter.drawn.len() > 3_000);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, ..ProptestConfig::default() })]

    /// However the answers come wrong, what is drawn is the drawing, and no byte is lost.
    #[test]
    fn a_drawing_is_whole_whatever_answers_come_wrong(seed: u64, of in 20_usize..200, count in 1_usize..150) {
        let ops = lines(count);
        let (plotter, notices, state) = draw(&ops, 1024, seed, of);
        let drawn = String::from_utf8(plotter.drawn).unwrap();
        prop_assert_eq!(plotter.lost, 0);
        let all: String = (1..=count).map(|n| format!("PD{},{};", 40 * n, 40 * (n % 7))).collect();
        let made: String =
            drawn.split_inclusive(';').filter(|instruction| instruction.starts_with("PD")).collect();
        if state == HostState::Done {
            prop_assert_eq!(made, all);
        } else {
            // A number may have been read as that of an error: the drawing pauses, and it is said.
            prop_assert_eq!(state, HostState::Paused, "{:?}", notices);
            prop_assert!(all.starts_with(&made), "{}", made);
            let complained = |n: &MachineNotice| matches!(n, MachineNotice::Refused { op: None, .. });
            prop_assert!(notices.iter().any(complained), "{:?}", notices);
        }
    }
}
