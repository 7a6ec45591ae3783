//! Hosts of machines that answer lines, each with a simulated machine at the other end.

use crate::driven::{Desk, drawing, machine, planned};
use plotter_motion::gcode::{PenControl, WriteOptions};
use plotter_motion::protocol::hosts::{
    Grbl, HostState, Hpgl, Language, LineHost, LineHostSettings, MDraw, MachineHost, MachineNotice, Marlin,
    NotNow, Request,
};
use plotter_motion::{Axis, Pen, PlotOp, Point, Vec2};
use plotter_replay::live::Spoken;
use plotter_replay::log::Event;
use std::time::Duration;

const LONG: Duration = Duration::from_secs(600);

type Ops = std::vec::IntoIter<PlotOp>;

fn grbl(ops: Vec<PlotOp>) -> Box<LineHost<Grbl<'static>, Ops>> {
    let options = WriteOptions { settle: Duration::ZERO, ..WriteOptions::default() };
    Box::new(LineHost::new(Grbl::new(options), LineHostSettings::default(), ops.into_iter()))
}

fn mdraw(ops: Vec<PlotOp>) -> Box<LineHost<MDraw<'static>, Ops>> {
    Box::new(LineHost::new(MDraw::new("M1 160", "M1 90"), LineHostSettings::default(), ops.into_iter()))
}

fn is_whole(notices: &[MachineNotice]) -> bool {
    notices.iter().all(|notice| matches!(notice, MachineNotice::State(_) | MachineNotice::Greeted))
}

#[test]
fn a_drawing_on_a_grbl_machine_is_the_steps_of_the_plan() {
    let machine = machine();
    let mut desk = Desk::new(grbl(drawing()), &machine, Spoken::Grbl, "");
    assert_eq!(desk.until(&[HostState::Ready], LONG), HostState::Ready);
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done);
    assert!(is_whole(&desk.notices), "{:?}", desk.notices);
    let status = desk.host.status();
    assert_eq!((status.sent, status.done), (drawing().len() as u64, drawing().len() as u64));
    assert_eq!(status.limits.steps_per_mm, [Some(87.58), Some(87.58)]);
    let (made, wanted) = (desk.steps(), planned(&machine, &drawing()));
    assert!(made == wanted, "{} steps, {} planned", made.len(), wanted.len());
}

#[test]
fn a_drawing_on_an_mdraw_machine_ends_where_it_should() {
    let machine = machine();
    let mut desk = Desk::new(mdraw(drawing()), &machine, Spoken::MDraw, "");
    assert_eq!(desk.until(&[HostState::Ready], LONG), HostState::Ready);
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done);
    // (an arc is no word of mDraw's: its line is answered as any other)
    let lost: Vec<_> = desk.notices.iter().filter(|n| !matches!(n, MachineNotice::State(_))).collect();
    assert!(lost.is_empty(), "{lost:?}");
    assert_eq!(desk.host.status().at.map(|at| at.distance(Point::new(4.0, 4.0)) < 0.02), Some(true));
}

/// Pauses and goes on at so many places that each part of the drawing is met.
fn assert_pauses_lose_nothing(mut desk: Desk, every: Duration, least_pauses: usize) {
    let machine = machine();
    desk.until(&[HostState::Ready], LONG);
    desk.ask(Request::GoOn);
    let mut pauses = 0;
    loop {
        let state = desk.until(&[HostState::Done], every);
        match state {
            HostState::Done => break,
            HostState::Drawing | HostState::Ending => {
                desk.ask(Request::Pause);
                assert!(matches!(
                    desk.until(&[HostState::Paused, HostState::Done], LONG),
                    HostState::Paused | HostState::Done
                ));
                if desk.host.status().state == HostState::Done {
                    break;
                }
                pauses += 1;
                assert!(pauses < 300, "it comes no further: {:?}", desk.host.status());
                assert_eq!(desk.host.status().pen, Pen::Up);
                if pauses % 3 == 0 {
                    desk.ask(Request::Jog { by: Vec2::new(3.0, 2.0), feed_mm_s: 30.0 });
                    desk.wait(Duration::from_millis(400));
                }
                desk.ask(Request::GoOn);
            }
            other => panic!("{other:?}: {:?}", desk.notices),
        }
    }
    assert!(pauses >= least_pauses, "{pauses} pauses");
    let wrong: Vec<_> = desk
        .notices
        .iter()
        .filter(|n| !matches!(n, MachineNotice::State(_) | MachineNotice::Greeted))
        .collect();
    assert!(wrong.is_empty(), "{wrong:?}");
    // The same ink, within a step: a line that is drawn in two parts has other roundings in it.
    let plain = {
        let mut desk = Desk::new(grbl(drawing()), &machine, Spoken::Grbl, "");
        desk.until(&[HostState::Ready], LONG);
        desk.ask(Request::GoOn);
        desk.until(&[HostState::Done], LONG);
        desk.ink()
    };
    let ink = desk.ink();
    let near = |set: &std::collections::BTreeSet<(i32, i32)>, (x, y): (i32, i32)| {
        (-2..=2).any(|dx| (-2..=2).any(|dy| set.contains(&(x + dx, y + dy))))
    };
    let (extra, lost) = (
        ink.iter().filter(|at| !near(&plain, **at)).count(),
        plain.iter().filter(|at| !near(&ink, **at)).count(),
    );
    assert_eq!((extra, lost), (0, 0), "of {} places", plain.len());
}

#[test]
fn pauses_on_a_grbl_machine_lift_the_pen_at_once_and_cost_no_ink() {
    let desk = Desk::new(grbl(drawing()), &machine(), Spoken::Grbl, "");
    assert_pauses_lose_nothing(desk, Duration::from_millis(330), 15);
}

#[test]
fn a_pause_is_there_within_the_braking_and_not_behind_the_queue() {
    let far = |n: u32| PlotOp::Draw {
        to: Point::new(if n.is_multiple_of(2) { 1.0 } else { 59.0 }, f64::from(n)),
        feed_mm_s: Some(5.0),
    };
    let mut desk = Desk::new(grbl((0..12).map(far).collect()), &machine(), Spoken::Grbl, "");
    desk.until(&[HostState::Ready], LONG);
    desk.ask(Request::GoOn);
    desk.wait(Duration::from_secs(3));
    let asked = desk.now();
    desk.ask(Request::Pause);
    assert_eq!(desk.until(&[HostState::Paused], LONG), HostState::Paused);
    assert!(desk.now() - asked < Duration::from_millis(600), "{:?}", desk.now() - asked);
    let last = desk
        .events()
        .iter()
        .filter(|(_, event)| matches!(event, plotter_replay::log::Event::Edge { .. }))
        .map(|e| e.0)
        .max();
    assert!(last.unwrap() - asked < Duration::from_millis(100), "{:?}", last.unwrap() - asked);
}

#[test]
fn a_stop_stops_the_motors_and_the_drawing_goes_on_where_it_was() {
    let mut desk = Desk::new(grbl(drawing()), &machine(), Spoken::Grbl, "");
    desk.until(&[HostState::Ready], LONG);
    desk.ask(Request::GoOn);
    desk.wait(Duration::from_millis(1_300));
    assert_eq!(desk.host.status().state, HostState::Drawing);
    desk.stop();
    desk.wait(Duration::from_millis(600));
    assert!(
        matches!(desk.host.status().state, HostState::Stopped | HostState::Locked(_)),
        "{:?}",
        desk.host.status()
    );
    let now = desk.now();
    assert_eq!(desk.host.ask(now, Request::GoOn), Err(NotNow::Locked));
    desk.ask(Request::Unlock);
    assert_eq!(desk.until(&[HostState::Paused], LONG), HostState::Paused);
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done);
    assert_eq!(desk.host.status().at.map(|at| at.distance(Point::new(4.0, 4.0)) < 0.02), Some(true));
}

#[test]
fn another_pen_and_another_sheet_are_waited_for() {
    let square = |at: f64| {
        let draw = |x: f64, y: f64| PlotOp::Draw { to: Point::new(x, y), feed_mm_s: None };
        [
            PlotOp::Travel { to: Point::new(at, at) },
            draw(at + 2.0, at),
            draw(at + 2.0, at + 2.0),
            draw(at, at),
        ]
    };
    let mut ops = vec![PlotOp::SelectPen { pen: 1 }];
    ops.extend(square(2.0));
    ops.push(PlotOp::SelectPen { pen: 3 });
    ops.extend(square(6.0));
    ops.push(PlotOp::NewPage);
    ops.extend(square(10.0));
    for spoken in [Spoken::Grbl, Spoken::MDraw] {
        let host: Box<dyn MachineHost> =
            if spoken == Spoken::Grbl { grbl(ops.clone()) } else { mdraw(ops.clone()) };
        let mut desk = Desk::new(host, &machine(), spoken, "");
        desk.until(&[HostState::Ready], LONG);
        let waits = [HostState::PenWanted(3), HostState::SheetWanted, HostState::Done];
        for wanted in waits {
            desk.ask(Request::GoOn);
            assert_eq!(desk.until(&waits, LONG), wanted, "{spoken:?}");
            desk.wait(Duration::from_millis(100));
            assert_eq!(desk.host.status().state, wanted);
        }
    }
}

#[test]
fn a_killed_host_s_drawing_goes_on_at_the_place_where_the_machine_rests() {
    for seconds in [0.4, 0.9, 1.7, 2.6] {
        let mut desk = Desk::new(grbl(drawing()), &machine(), Spoken::Grbl, "");
        desk.until(&[HostState::Ready], LONG);
        desk.ask(Request::GoOn);
        desk.wait(Duration::from_secs_f64(seconds));
        let status = desk.host.status();
        // It is killed; what is on the line is drawn.
        let mut desk = desk.with(Box::new(grbl(drawing()).resuming(status.done, status.sent + 8)));
        assert_eq!(desk.until(&[HostState::Paused], LONG), HostState::Paused);
        desk.ask(Request::GoOn);
        assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done, "{:?}", desk.notices);
        let wrong = desk
            .notices
            .iter()
            .filter(|n| matches!(n, MachineNotice::NotResumed { .. } | MachineNotice::Elsewhere { .. }));
        assert_eq!(wrong.count(), 0, "{:?}", desk.notices);
    }
}

#[test]
fn a_machine_that_restarts_or_alarms_is_said_and_nothing_moves_until_asked() {
    // switched off and on
    let mut desk = Desk::new(grbl(drawing()), &machine(), Spoken::Grbl, "2.0 restart");
    desk.until(&[HostState::Ready], LONG);
    desk.ask(Request::GoOn);
    desk.wait(Duration::from_secs(4));
    assert!(desk.notices.iter().any(|n| matches!(n, MachineNotice::Restarted { .. })), "{:?}", desk.notices);
    assert!(matches!(desk.host.status().state, HostState::Stopped | HostState::Locked(_)));
    let last = desk
        .events()
        .iter()
        .filter(|(_, e)| matches!(e, plotter_replay::log::Event::Edge { .. }))
        .map(|e| e.0)
        .max();
    assert!(last.unwrap() <= Duration::from_millis(2_001), "{last:?}");
}

#[test]
fn a_machine_that_says_nothing_is_said_to_be_silent_and_is_asked_no_more_than_that() {
    let mut host = grbl(drawing());
    let mut bytes = 0;
    let mut notices = Vec::new();
    for ms in 0..20_000_u64 {
        let now = Duration::from_millis(ms);
        notices.extend(core::iter::from_fn(|| host.poll(now)));
        while let Some(byte) = host.next_byte(now) {
            assert_eq!(byte, b'?');
            bytes += 1;
        }
    }
    assert_eq!(notices, [MachineNotice::Silent]);
    assert!((80..=95).contains(&bytes), "{bytes}"); // five a second behind the first two
    assert_eq!(host.ask(Duration::from_secs(20), Request::GoOn), Err(NotNow::Unheard));
}

#[test]
fn a_jog_by_hand_moves_and_a_pen_is_lifted_and_lowered() {
    let mut desk = Desk::new(grbl(Vec::new()), &machine(), Spoken::Grbl, "");
    desk.until(&[HostState::Ready], LONG);
    desk.ask(Request::Jog { by: Vec2::new(10.0, 5.0), feed_mm_s: 30.0 });
    desk.wait(Duration::from_secs(1));
    assert_eq!(desk.host.status().at.map(|at| at.distance(Point::new(10.0, 5.0)) < 0.01), Some(true));
    desk.ask(Request::Jog { by: Vec2::new(40.0, 0.0), feed_mm_s: 10.0 });
    desk.wait(Duration::from_millis(500));
    desk.ask(Request::EndJog);
    desk.wait(Duration::from_millis(600));
    let at = desk.host.status().at.unwrap();
    assert!(at.x > 12.0 && at.x < 20.0, "{at:?}");
    desk.ask(Request::StandsAt(Point::new(1.0, 2.0)));
    desk.wait(Duration::from_millis(500));
    assert_eq!(desk.host.status().at.map(|at| at.distance(Point::new(1.0, 2.0)) < 1e-9), Some(true));
    let (x, y) = desk.steps().iter().fold((0, 0), |(x, y), &(axis, sign)| match axis {
        Axis::X => (x + sign, y),
        Axis::Y => (x, y + sign),
    });
    assert!(x > 1_000 && y > 400, "{x} {y}");
}

#[test]
fn the_time_that_is_left_is_right_within_two_hundredths_behind_a_twentieth() {
    use plotter_replay::live::Timetable;
    let machine = machine();
    let mut table = Timetable::new(&machine).unwrap();
    drawing().into_iter().for_each(|op| table.push(op));
    let total = table.finish();
    let mut desk = Desk::new(grbl(drawing()), &machine, Spoken::Grbl, "");
    desk.until(&[HostState::Ready], LONG);
    desk.ask(Request::GoOn);
    let began = desk.now();
    let mut told = Vec::new();
    while desk.host.status().state != HostState::Done {
        desk.round();
        let drawn = desk.now() - began;
        told.push((drawn, table.rest(desk.host.status().done, drawn)));
    }
    let whole = desk.now() - began;
    let behind = told.iter().filter(|(drawn, _)| drawn.as_secs_f64() > 0.05 * whole.as_secs_f64());
    let off = behind.map(|(drawn, rest)| (whole.as_secs_f64() - (*drawn + *rest).as_secs_f64()).abs());
    let worst = off.fold(0.0, f64::max);
    println!("{total:?} planned, {whole:?} drawn, the time left off by {worst:.3} s at most");
    assert!(worst < 0.02 * whole.as_secs_f64(), "{worst} of {whole:?}, planned {total:?}");
}

#[test]
fn a_movement_by_hand_that_is_ended_at_once_goes_nowhere_and_one_under_way_stops() {
    let mut desk = Desk::new(grbl(Vec::new()), &machine(), Spoken::Grbl, "");
    desk.until(&[HostState::Ready], LONG);
    let jog = Request::Jog { by: Vec2::new(50.0, 0.0), feed_mm_s: 20.0 };
    desk.ask(jog);
    desk.ask(Request::EndJog); // before a byte of it is out
    desk.wait(Duration::from_secs(1));
    assert_eq!(desk.host.status().at, Some(Point::ORIGIN));
    desk.ask(jog);
    desk.round(); // on the line, and not read yet: GRBL takes no notice of the word that would end it
    desk.ask(Request::EndJog);
    desk.wait(Duration::from_secs(2));
    let at = desk.host.status().at.unwrap();
    assert!(at.x < 10.0, "{at:?}");
    desk.ask(Request::ByHand(PlotOp::Travel { to: Point::new(1.0, 1.0) }));
    desk.wait(Duration::from_secs(1));
    assert_eq!(desk.host.status().at.map(|at| at.distance(Point::new(1.0, 1.0)) < 0.02), Some(true));
}

#[test]
fn a_slow_pen_is_no_lost_answer() {
    let machine = machine();
    let options = WriteOptions { settle: Duration::from_millis(2_500), ..WriteOptions::default() };
    let mut ops = drawing();
    ops.insert(40, PlotOp::Dwell { duration: Duration::from_secs(4) });
    let host = LineHost::new(Grbl::new(options), LineHostSettings::default(), ops.clone().into_iter());
    let mut desk = Desk::new(Box::new(host), &machine, Spoken::Grbl, "");
    desk.until(&[HostState::Ready], LONG);
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done);
    assert!(is_whole(&desk.notices), "{:?}", desk.notices);
}

/// A line to and fro over the table, slowly.
fn slow_lines() -> Vec<PlotOp> {
    let to = |n: u32| Point::new(if n.is_multiple_of(2) { 1.0 } else { 31.0 }, f64::from(n));
    (0..12).map(|n| PlotOp::Draw { to: to(n), feed_mm_s: Some(20.0) }).collect()
}

#[test]
fn without_a_word_for_a_hold_a_pause_comes_behind_the_line_under_way_and_so_does_a_stop() {
    let machine = machine();
    let plain = {
        let mut desk = Desk::new(mdraw(slow_lines()), &machine, Spoken::MDraw, "");
        desk.until(&[HostState::Ready], LONG);
        desk.ask(Request::GoOn);
        desk.until(&[HostState::Done], LONG);
        (desk.steps(), desk.ink())
    };
    let mut desk = Desk::new(mdraw(slow_lines()), &machine, Spoken::MDraw, "");
    desk.until(&[HostState::Ready], LONG);
    desk.ask(Request::GoOn);
    for ask in [Request::Pause, Request::Stop, Request::Pause] {
        desk.wait(Duration::from_millis(2_300));
        let asked = desk.now();
        desk.ask(ask);
        if ask == Request::Stop {
            // What it draws is drawn to its end: a line in the middle of it would end it (the firmware's
            // trap).
            assert_eq!(desk.host.status().state, HostState::Stopped);
            desk.ask(Request::Unlock);
        }
        assert_eq!(desk.until(&[HostState::Paused], LONG), HostState::Paused);
        assert!(desk.now() - asked < Duration::from_secs(3), "{:?} after {ask:?}", desk.now() - asked);
        desk.ask(Request::GoOn);
    }
    assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done);
    let odd = desk.notices.iter().filter(|n| !matches!(n, MachineNotice::State(_)));
    assert_eq!(odd.count(), 0, "{:?}", desk.notices);
    assert!((desk.steps(), desk.ink()) == plain);
}

#[test]
fn a_pause_whose_greeting_comes_wrong_is_a_pause() {
    let mut desk = Desk::new(grbl(drawing()), &machine(), Spoken::Grbl, "");
    desk.until(&[HostState::Ready], LONG);
    desk.ask(Request::GoOn);
    desk.wait(Duration::from_millis(900));
    desk.damage = Some(Box::new(|is_host, byte| if !is_host && byte == b'G' { b'g' } else { byte }));
    desk.ask(Request::Pause);
    assert_eq!(desk.until(&[HostState::Paused], Duration::from_secs(5)), HostState::Paused);
    desk.damage = None;
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done);
    assert!(!desk.notices.iter().any(|n| matches!(n, MachineNotice::Elsewhere { .. })), "{:?}", desk.notices);
}

#[test]
fn a_killed_host_s_change_of_pens_is_asked_for_again_and_no_other() {
    let stroke = |at: f64| {
        let draw = |x: f64, y: f64| PlotOp::Draw { to: Point::new(x, y), feed_mm_s: Some(20.0) };
        [PlotOp::Travel { to: Point::new(at, at) }, draw(at + 9.0, at), draw(at + 9.0, at + 5.0)]
    };
    let mut ops = vec![PlotOp::SelectPen { pen: 1 }];
    ops.extend(stroke(2.0));
    ops.push(PlotOp::SelectPen { pen: 3 });
    ops.extend(stroke(12.0));
    ops.push(PlotOp::SelectPen { pen: 4 });
    ops.extend(stroke(22.0));
    let begin = || {
        let mut desk = Desk::new(grbl(ops.clone()), &machine(), Spoken::Grbl, "");
        desk.until(&[HostState::Ready], LONG);
        desk.ask(Request::GoOn);
        desk
    };
    let wants = [HostState::PenWanted(3), HostState::PenWanted(4), HostState::Done];
    let again = |desk: Desk| {
        let status = desk.host.status();
        let host = grbl(ops.clone()).resuming(status.done, status.sent + 64);
        let mut desk = desk.with(Box::new(host));
        assert_eq!(desk.until(&[HostState::Paused], LONG), HostState::Paused);
        desk.ask(Request::GoOn);
        desk
    };
    // Before the change, at it, and behind it.
    let mut desk = begin();
    desk.wait(Duration::from_millis(600));
    let mut desk = again(desk);
    assert_eq!(desk.until(&wants, LONG), wants[0], "{:?}", desk.notices);
    let mut desk = again(desk);
    assert_eq!(desk.until(&wants, LONG), wants[0], "{:?}", desk.notices);
    desk.ask(Request::GoOn);
    desk.wait(Duration::from_millis(800));
    let mut desk = again(desk);
    assert_eq!(desk.until(&wants, LONG), wants[1], "{:?}", desk.notices);
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&wants, LONG), wants[2], "{:?}", desk.notices);
    let plain = {
        let mut desk = begin();
        for _ in 0..3 {
            desk.until(&wants, LONG);
            if desk.host.status().state != HostState::Done {
                desk.ask(Request::GoOn);
            }
        }
        assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done);
        desk.ink()
    };
    assert!(desk.ink() == plain, "{} places, {} as planned", desk.ink().len(), plain.len());
}

/// Languages without a question that is answered in the middle of anything are asked behind the last line.
#[test]
fn a_way_by_hand_ends_with_the_place_that_the_machine_says() {
    for (spoken, host) in of_each_language() {
        let mut desk = Desk::new(host, &machine(), spoken, "");
        desk.until(&[HostState::Ready], LONG);
        desk.wait(Duration::from_secs(3)); // with all that it asks at first
        for to in [Point::new(20.0, 10.0), Point::new(30.0, 20.0)] {
            desk.ask(Request::ByHand(PlotOp::Travel { to }));
            let is_there = |desk: &Desk| desk.host.status().at.is_some_and(|at| at.distance(to) < 0.03);
            desk.round();
            assert!(!is_there(&desk), "{spoken:?}: before it moves");
            desk.wait(Duration::from_secs(5));
            assert!(is_there(&desk), "{spoken:?}: {:?} for {to:?}", desk.host.status());
        }
        // With the pen lowered it stays so.
        desk.ask(Request::ByHand(PlotOp::Draw { to: Point::new(30.0, 25.0), feed_mm_s: Some(20.0) }));
        desk.wait(Duration::from_secs(5));
        let mut said = desk.events().into_iter().filter_map(|(_, event)| match event {
            Event::Pen(pen) => Some(pen),
            _ => None,
        });
        assert_eq!(said.next_back(), Some(Pen::Down), "{spoken:?}");
    }
}

/// A circle has more lines than a host has room for: each goes out when there is room, once.
#[test]
fn a_shape_by_hand_is_whole_however_many_lines_it_has() {
    let place = |n: u32| {
        let (sin, cos) = (f64::from(n) * core::f64::consts::TAU / 90.0).sin_cos();
        Point::new((3000.0 + 1200.0 * cos).round() / 100.0, (2000.0 + 1200.0 * sin).round() / 100.0)
    };
    let draw = |n| PlotOp::Draw { to: place(n), feed_mm_s: Some(30.0) };
    let ops: Vec<PlotOp> =
        core::iter::once(PlotOp::Travel { to: place(0) }).chain((1..=90).map(draw)).collect();
    for (spoken, host) in of_each_language() {
        let mut desk = Desk::new(host, &machine(), spoken, "");
        desk.until(&[HostState::Ready], LONG);
        desk.wait(Duration::from_secs(3));
        for op in &ops {
            let end = desk.now() + LONG;
            loop {
                let now = desk.now();
                match desk.host.ask(now, Request::ByHand(*op)) {
                    Ok(()) => break,
                    Err(why) => assert!(why == NotNow::Busy && now < end, "{spoken:?}: {op:?}: {why}"),
                }
                desk.round();
            }
        }
        // It counts as under way until the place behind it is told.
        assert!(desk.host.status().is_led, "{spoken:?}");
        let end = desk.now() + LONG;
        while desk.host.status().is_led && desk.now() < end {
            desk.round();
        }
        desk.wait(Duration::from_secs(10)); // Grbl's lines are answered when they are taken
        let mm = |steps: i32| f64::from(steps) / 87.58;
        let ink: Vec<Point> = desk.ink().into_iter().map(|(x, y)| Point::new(mm(x), mm(y))).collect();
        for op in &ops {
            let to = op.target().unwrap();
            let off_mm = ink.iter().map(|at| at.distance(to)).fold(f64::INFINITY, f64::min);
            assert!(off_mm < 0.03, "{spoken:?}: {to:?} is {off_mm} mm from what is drawn");
        }
        assert!(desk.host.status().at.is_some_and(|at| at.distance(place(90)) < 0.03), "{spoken:?}");
    }
}

/// A host without a drawing of each language of lines.
fn of_each_language() -> [(Spoken, Box<dyn MachineHost>); 4] {
    let pen = PenControl::Commands { up: "G4 P0\nM280 P0 S160", down: "G4 P0\nM280 P0 S90" };
    let options = WriteOptions { pen, settle: Duration::ZERO, ..WriteOptions::default() };
    [
        (Spoken::Grbl, grbl(Vec::new())),
        (Spoken::Marlin, boxed(Marlin::new(options))),
        (Spoken::MDraw, boxed(MDraw::new("M1 160", "M1 90"))),
        (Spoken::Hpgl, boxed(Hpgl::new())),
    ]
}

fn boxed<L: Language + 'static>(language: L) -> Box<dyn MachineHost> {
    Box::new(LineHost::new(language, LineHostSettings::default(), core::iter::empty()))
}
