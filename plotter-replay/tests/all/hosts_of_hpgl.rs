//! The host of HPGL with a simulated 7475A at the other end.

use crate::driven::{Desk, drawing};
use plotter_motion::protocol::hosts::{
    HostState, Hpgl, HpglFlow, LineHost, LineHostSettings, MachineNotice, Request,
};
use plotter_motion::{Axis, Machine, MachineConfig, PlotOp, Point};
use plotter_replay::live::Spoken;
use plotter_replay::log::Event;
use std::time::Duration;

const LONG: Duration = Duration::from_secs(3_600);

/// 20 steps to the millimetre: a step is two units of HPGL.
pub(crate) fn machine() -> Machine {
    let mut config = MachineConfig::stepper_plotter();
    (config.area.width_mm, config.area.height_mm) = (60.0, 40.0);
    (
        config.steppers_mut().unwrap().homing.known_travel_mm,
        config.steppers_mut().unwrap().homing.max_travel_mm,
    ) = (0.0, 80.0);
    config.steppers_mut().unwrap().pen.settle_ms = 20.0;
    let steppers = config.steppers_mut().unwrap();
    for axis in [&mut steppers.x, &mut steppers.y] {
        axis.steps_per_mm = 20.0;
    }
    Machine::new(config).unwrap()
}

fn desk(ops: Vec<PlotOp>) -> Desk {
    desk_with(HpglFlow::Asked, ops)
}

fn desk_with(flow: HpglFlow, ops: Vec<PlotOp>) -> Desk {
    let host = LineHost::new(Hpgl::new().with_flow(flow), LineHostSettings::default(), ops.into_iter());
    let mut desk = Desk::new(Box::new(host), &machine(), Spoken::Hpgl, "");
    assert_eq!(desk.until(&[HostState::Ready], LONG), HostState::Ready, "{:?}", desk.notices);
    desk
}

fn odd(desk: &Desk) -> Vec<&MachineNotice> {
    desk.notices.iter().filter(|n| !matches!(n, MachineNotice::State(_))).collect()
}

fn end(desk: &Desk) -> (i32, i32) {
    desk.steps().iter().fold(
        (0, 0),
        |(x, y), &(axis, sign)| {
            if axis == Axis::X { (x + sign, y) } else { (x, y + sign) }
        },
    )
}

#[test]
fn a_drawing_is_whole_and_the_buffer_never_overflows() {
    for flow in [HpglFlow::Asked, HpglFlow::XonXoff, HpglFlow::Dtr] {
        whole(flow);
    }
}

fn whole(flow: HpglFlow) {
    // Ten times as much as the buffer holds.
    let ops: Vec<PlotOp> = drawing().into_iter().cycle().take(10 * drawing().len()).collect();
    let mut desk = desk_with(flow, ops.clone());
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done, "{:?}", desk.notices);
    // An overflow would be told at the end, as error 216.
    assert!(odd(&desk).is_empty(), "{:?}", odd(&desk));
    assert_eq!(desk.host.status().sent, ops.len() as u64);
    assert_eq!(end(&desk), (80, 80));
    assert!(desk.sent.len() > 10_000, "{}", desk.sent.len());
    let has = |words: &[u8]| desk.sent.windows(words.len()).filter(|part| *part == words).count();
    let heard = |byte: u8| {
        let said = desk.events();
        said.iter().filter(|e| matches!(&e.1, Event::Controller(bytes) if bytes.contains(&byte))).count()
    };
    match flow {
        HpglFlow::XonXoff => {
            assert!(heard(0x13) > 5, "XOFF came {} times", heard(0x13));
            assert!(heard(0x11) >= heard(0x13), "XON came {} times", heard(0x11));
            assert!(has(b"\x1b.@;0:\x1b.I128;;17:\x1b.N;19:") > 0);
        }
        HpglFlow::Dtr => assert!(has(b"\x1b.@;1:") > 0 && heard(0x13) == 0),
        _ => assert!(has(b"\x1b.B") > 100),
    }
    // Where lines are not answered, room is not asked for but while the place at the end is waited for.
    assert!(flow == HpglFlow::Asked || has(b"\x1b.B") < 400, "{flow:?}: {}", has(b"\x1b.B"));
    let (left, right) = (Point::new(44.0, 10.0), Point::new(56.0, 10.0));
    for at in [left, right, Point::new(16.0, 16.0), Point::new(8.0, 4.0)] {
        #[expect(clippy::cast_possible_truncation, reason = "within the machine")]
        let steps = ((at.x * 20.0) as i32, (at.y * 20.0) as i32);
        assert!(desk.ink().contains(&steps), "{at:?}");
    }
}

/// A line there and back with this pen.
fn there_and_back(pen: u8, at: f64) -> [PlotOp; 4] {
    let draw = |x: f64, y: f64| PlotOp::Draw { to: Point::new(x, y), feed_mm_s: None };
    let select = PlotOp::SelectPen { pen };
    [select, PlotOp::Travel { to: Point::new(at, at) }, draw(at + 2.0, at), draw(at, at)]
}

#[test]
fn the_plotter_changes_pens_by_itself() {
    let mut desk = desk([there_and_back(1, 2.0), there_and_back(4, 6.0)].concat());
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&[HostState::Done, HostState::PenWanted(4)], LONG), HostState::Done);
    let sent = String::from_utf8_lossy(&desk.sent).into_owned();
    assert!(sent.contains("SP1;") && sent.contains("PU;SP4;"), "{sent}");
    assert!(odd(&desk).is_empty(), "{:?}", odd(&desk));
}

#[test]
fn a_pause_draws_what_is_buffered_and_the_drawing_goes_on_with_its_pen() {
    let mut ops = vec![PlotOp::SelectPen { pen: 2 }];
    ops.extend(drawing().into_iter().cycle().take(5 * drawing().len()));
    let mut desk = desk(ops);
    desk.ask(Request::GoOn);
    let mut pauses = 0;
    while desk.until(&[HostState::Done], Duration::from_millis(200)) != HostState::Done {
        if desk.host.status().state == HostState::Drawing {
            desk.ask(Request::Pause);
            pauses += 1;
        }
        if desk.until(&[HostState::Paused, HostState::Done], LONG) == HostState::Paused {
            assert_eq!(desk.host.status().pen, plotter_motion::Pen::Up);
            desk.ask(Request::GoOn);
        }
    }
    assert!(pauses > 0);
    assert!(odd(&desk).is_empty(), "{:?}", odd(&desk));
    assert_eq!(end(&desk), (80, 80));
    let sent = String::from_utf8_lossy(&desk.sent).into_owned();
    assert_eq!(sent.matches("IN;SP2;").count(), pauses, "{sent}");
}

#[test]
fn a_pause_before_a_change_of_pens_does_not_change_it() {
    let plain = {
        let mut desk = desk([there_and_back(1, 2.0), there_and_back(4, 6.0)].concat());
        desk.ask(Request::GoOn);
        desk.until(&[HostState::Done], LONG);
        desk.ink()
    };
    // The change waits in the queue when it is paused: nothing of it was sent, and the other pen is in the
    // holder.
    let mut desk = desk([there_and_back(1, 2.0), there_and_back(4, 6.0)].concat());
    desk.ask(Request::GoOn);
    while !desk.sent.windows(4).any(|words| words == b"SP1;") {
        desk.round();
    }
    desk.ask(Request::Pause);
    assert_eq!(desk.until(&[HostState::Paused], LONG), HostState::Paused);
    assert!(!desk.sent.windows(4).any(|words| words == b"SP4;"));
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done);
    let sent = String::from_utf8_lossy(&desk.sent).into_owned();
    let pens: Vec<_> = sent.match_indices("SP").map(|(at, _)| &sent[at..at + 4]).collect();
    assert_eq!(pens.iter().filter(|pen| **pen == "SP4;").count(), 1, "{sent}");
    assert_eq!(pens.last(), Some(&"SP4;"), "{sent}");
    assert!(desk.ink() == plain);
}

#[test]
fn errors_of_the_plotter_are_said_and_a_bad_line_is_not_drawn_as_if_it_were_good() {
    let mut desk = desk(drawing());
    let mut count = 0;
    desk.damage = Some(Box::new(move |is_host, byte| {
        count += usize::from(is_host);
        // An instruction that there is not.
        if is_host && byte == b'P' && count > 400 && count < 500 { b'Q' } else { byte }
    }));
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done, "{:?}", desk.notices);
    assert!(
        desk.notices.iter().any(|n| matches!(n, MachineNotice::Refused { op: None, code: 201 })),
        "{:?}",
        desk.notices
    );
}

#[test]
fn a_stop_drops_what_is_buffered() {
    // Long lines, of which the buffer holds many.
    let far = |n: u32| PlotOp::Draw {
        to: Point::new(if n.is_multiple_of(2) { 1.0 } else { 59.0 }, f64::from(n % 40)),
        feed_mm_s: Some(10.0),
    };
    let mut desk = desk((0..200).map(far).collect());
    desk.ask(Request::GoOn);
    desk.wait(Duration::from_secs(20));
    desk.stop();
    desk.wait(Duration::from_secs(400));
    let last = desk.events().iter().filter(|e| matches!(e.1, Event::Edge { .. })).map(|e| e.0).max().unwrap();
    // What the plotter has planned is drawn: some 30 lines of 6 s, of the 200.
    assert!(last < Duration::from_secs(300), "{last:?}");
    assert_eq!(desk.host.status().state, HostState::Stopped);
}

#[test]
fn an_answer_that_came_wrong_is_asked_for_again() {
    let mut desk = desk(drawing());
    let mut count = 0;
    desk.damage = Some(Box::new(move |is_host, byte| {
        count += usize::from(!is_host);
        if !is_host && count % 23 == 0 { byte ^ 0x40 } else { byte }
    }));
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done, "{:?}", desk.notices);
    assert!(desk.notices.iter().all(|n| matches!(n, MachineNotice::State(_) | MachineNotice::Garbled)));
    assert_eq!(end(&desk), (80, 80));
}
