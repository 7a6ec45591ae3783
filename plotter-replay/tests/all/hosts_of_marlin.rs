//! The host of Marlin's language with a simulated machine at the other end, over a good line and a bad one.

use crate::driven::{Desk, drawing, machine, planned};
use plotter_motion::gcode::{PenControl, WriteOptions};
use plotter_motion::protocol::hosts::{
    HostState, LineHost, LineHostSettings, MachineHost, MachineNotice, Marlin, Request,
};
use plotter_motion::{Axis, PlotOp, Point, SplitMix64};
use plotter_replay::live::Spoken;
use std::collections::BTreeSet;
use std::time::Duration;

const LONG: Duration = Duration::from_secs(3_600);

type Ops = std::vec::IntoIter<PlotOp>;
type Host = LineHost<Marlin<'static>, Ops>;

fn marlin(ops: Vec<PlotOp>) -> Host {
    let pen = PenControl::Commands { up: "G4 P0\nM280 P0 S160", down: "G4 P0\nM280 P0 S90" };
    let options = WriteOptions { pen, settle: Duration::ZERO, ..WriteOptions::default() };
    LineHost::new(Marlin::new(options), LineHostSettings::default(), ops.into_iter())
}

fn boxed(ops: Vec<PlotOp>) -> Box<dyn MachineHost> {
    Box::new(marlin(ops))
}

/// Where the pen was put down and drew, in the order of the drawing.
fn ends(steps: &[(Axis, i32)]) -> (i32, i32) {
    steps
        .iter()
        .fold((0, 0), |(x, y), &(axis, sign)| if axis == Axis::X { (x + sign, y) } else { (x, y + sign) })
}

fn drawn(desk: &mut Desk) -> HostState {
    assert_eq!(desk.until(&[HostState::Ready], LONG), HostState::Ready, "{:?}", desk.notices);
    desk.ask(Request::GoOn);
    desk.until(&[HostState::Done, HostState::Stopped, HostState::Paused, HostState::Locked(112)], LONG)
}

#[test]
fn a_drawing_is_the_steps_of_the_plan() {
    let machine = machine();
    let mut desk = Desk::new(boxed(drawing()), &machine, Spoken::Marlin, "");
    assert_eq!(drawn(&mut desk), HostState::Done);
    let odd = desk.notices.iter().filter(|n| !matches!(n, MachineNotice::State(_) | MachineNotice::Greeted));
    assert_eq!(odd.count(), 0, "{:?}", desk.notices);
    assert_eq!(desk.host.status().sent, drawing().len() as u64);
    let (made, wanted) = (desk.steps(), planned(&machine, &drawing()));
    assert!(made == wanted, "{} steps, {} planned", made.len(), wanted.len());
}

/// A drawing over a line that damages one byte of each line of the host, and one byte in `of_answers` of the
/// machine's: it is whole all the same.
fn is_whole_in_spite_of_damage(seed: u64, of_answers: usize) {
    let machine = machine();
    let ops: Vec<PlotOp> = drawing().into_iter().skip(81).collect();
    let plain = {
        let mut desk = Desk::new(boxed(ops.clone()), &machine, Spoken::Marlin, "");
        assert_eq!(drawn(&mut desk), HostState::Done);
        desk
    };
    let mut desk = Desk::new(boxed(ops), &machine, Spoken::Marlin, "");
    let mut random = SplitMix64::new(seed);
    // A line goes out damaged once: when it comes again, it comes whole.
    let (mut line, mut seen, mut at) = (Vec::new(), Vec::new(), None);
    let mut below = move |limit: usize| random.below(limit);
    assert_eq!(desk.until(&[HostState::Ready], LONG), HostState::Ready);
    desk.wait(Duration::from_secs(1));
    desk.damage = Some(Box::new(move |is_host, byte| {
        if !is_host {
            return if of_answers > 0 && below(of_answers) == 0 { byte ^ (1 << below(7)) } else { byte };
        }
        if line.is_empty() {
            at = Some(below(20));
        }
        let hit = at == Some(line.len()) && !seen.contains(&line);
        if hit {
            seen.push(line.clone());
        }
        line.push(byte);
        if byte == b'\n' {
            line.clear();
        }
        if hit { byte ^ (1 << below(7)) } else { byte }
    }));
    assert_eq!(drawn(&mut desk), HostState::Done, "seed {seed}: {:?}", desk.notices);
    let again = desk.notices.iter().filter(|n| matches!(n, MachineNotice::SentAgain)).count();
    assert!(again > 5, "seed {seed}: only {again} lines came wrong");
    assert_eq!(ends(&desk.steps()), ends(&plain.steps()), "seed {seed}");
    let (ink, wanted) = (desk.ink(), plain.ink());
    let odd = ink.symmetric_difference(&wanted).collect::<Vec<_>>();
    assert!(odd.is_empty(), "seed {seed}: {} places, {:?} to {:?}", odd.len(), odd.first(), odd.last());
}

#[test]
fn a_drawing_is_whole_though_a_byte_of_each_line_comes_wrong() {
    (0..20).for_each(|seed| is_whole_in_spite_of_damage(seed, 0));
}

#[test]
fn a_drawing_is_whole_though_answers_come_wrong_too() {
    (100..120).for_each(|seed| is_whole_in_spite_of_damage(seed, 40));
}

#[test]
#[ignore = "a thousand drawings, minutes: cargo test --release -p plotter-replay --features cli,live --test all hosts_of_marlin:: -- --ignored"]
fn a_thousand_drawings_are_whole_though_bytes_come_wrong_both_ways() {
    (1_000..2_000).for_each(|seed| is_whole_in_spite_of_damage(seed, if seed % 2 == 0 { 0 } else { 40 }));
}

#[test]
fn a_pause_comes_behind_what_was_sent_and_lifts_the_pen() {
    let mut desk = Desk::new(boxed(drawing()), &machine(), Spoken::Marlin, "");
    desk.until(&[HostState::Ready], LONG);
    desk.ask(Request::GoOn);
    let mut pauses = 0;
    while desk.until(&[HostState::Done], Duration::from_millis(250)) != HostState::Done {
        if desk.host.status().state == HostState::Drawing {
            desk.ask(Request::Pause);
            pauses += 1;
        }
        let state = desk.until(&[HostState::Paused, HostState::Done], LONG);
        if state == HostState::Paused {
            assert_eq!(desk.host.status().pen, plotter_motion::Pen::Up);
            desk.ask(Request::GoOn);
        }
    }
    assert!(pauses > 2, "{pauses}");
    let odd = desk.notices.iter().filter(|n| !matches!(n, MachineNotice::State(_) | MachineNotice::Greeted));
    assert_eq!(odd.count(), 0, "{:?}", desk.notices);
    let plain = {
        let mut desk = Desk::new(boxed(drawing()), &machine(), Spoken::Marlin, "");
        assert_eq!(drawn(&mut desk), HostState::Done);
        desk.ink()
    };
    // Within a step: which of two motors makes its step first along a slanted line is another one from rest.
    let ink = desk.ink();
    let far = |of: &BTreeSet<(i32, i32)>, from: &BTreeSet<(i32, i32)>| {
        let near =
            |&(x, y): &(i32, i32)| (-1..=1).any(|dx| (-1..=1).any(|dy| from.contains(&(x + dx, y + dy))));
        of.iter().filter(|at| !near(at)).count()
    };
    assert_eq!((far(&ink, &plain), far(&plain, &ink)), (0, 0), "of {} places", plain.len());
}

#[test]
fn a_machine_that_restarts_is_said_and_goes_nowhere_until_its_place_is_known() {
    let mut desk = Desk::new(boxed(drawing()), &machine(), Spoken::Marlin, "4.0 restart");
    desk.until(&[HostState::Ready], LONG);
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&[HostState::Stopped], LONG), HostState::Stopped, "{:?}", desk.notices);
    assert!(desk.notices.iter().any(|n| matches!(n, MachineNotice::Restarted { .. })), "{:?}", desk.notices);
    let before = ends(&desk.steps());
    desk.ask(Request::Unlock);
    assert_eq!(desk.until(&[HostState::Paused], LONG), HostState::Paused);
    assert_eq!(ends(&desk.steps()), before);
    let now = desk.now();
    assert!(desk.host.ask(now, Request::GoOn).is_err());
    // A person looks where it stands.
    let at = Point::new(f64::from(before.0) / 87.58, f64::from(before.1) / 87.58);
    desk.ask(Request::StandsAt(at));
    desk.wait(Duration::from_millis(200));
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done, "{:?}", desk.notices);
    let off = desk.host.status().at.unwrap().distance(Point::new(4.0, 4.0));
    assert!(off < 0.02, "{off}");
}

#[test]
fn a_stop_halts_the_machine_and_the_host_says_so() {
    let mut desk = Desk::new(boxed(drawing()), &machine(), Spoken::Marlin, "");
    desk.until(&[HostState::Ready], LONG);
    desk.ask(Request::GoOn);
    desk.wait(Duration::from_secs(3));
    let stopped = desk.now();
    desk.stop();
    desk.wait(Duration::from_secs(2));
    assert_eq!(desk.host.status().state, HostState::Stopped, "{:?}", desk.notices);
    let last = desk
        .events()
        .iter()
        .filter(|(_, event)| matches!(event, plotter_replay::log::Event::Edge { .. }))
        .map(|event| event.0)
        .max();
    assert!(last.unwrap() < stopped + Duration::from_millis(10), "{last:?} {stopped:?}");
}

#[test]
fn a_machine_that_is_switched_on_late_is_found() {
    let mut host = marlin(drawing());
    let mut sent = Vec::new();
    let mut notices = Vec::new();
    for ms in 0..30_000_u64 {
        let now = Duration::from_millis(ms);
        notices.extend(core::iter::from_fn(|| host.poll(now)));
        sent.extend(core::iter::from_fn(|| host.next_byte(now)));
    }
    assert_eq!(notices.iter().filter(|n| **n == MachineNotice::Silent).count(), 1);
    // Behind the first two seconds, and each five.
    assert_eq!(String::from_utf8(sent).unwrap(), "N0 M110*35\n".repeat(6));
}
