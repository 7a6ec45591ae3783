//! The host of an EBB, with a simulated AxiDraw at the other end.

use crate::driven::{Desk, drawing};
use plotter_motion::kinematics::{BeltSigns, CoreXy, Kinematics};
use plotter_motion::protocol::ebb::EbbMotionSettings;
use plotter_motion::protocol::hosts::{EbbHost, EbbHostSettings, HostState, MachineNotice, NotNow, Request};
use plotter_motion::{Machine, MachineConfig, PlannerSettings, PlotOp, Point, StepPoint, Vec2};
use plotter_replay::live::Spoken;
use plotter_replay::log::Event;
use std::time::Duration;

const LONG: Duration = Duration::from_secs(600);
const STEPS_PER_MM: f64 = 80.0;
const EBB: Spoken = Spoken::Ebb { is_mixed: true };

type Host = EbbHost<CoreXy, std::vec::IntoIter<PlotOp>>;

/// An AxiDraw with a fast line, as USB is.
fn machine() -> Machine {
    let mut config = MachineConfig::stepper_plotter();
    config.serial.baud = 1_000_000;
    let steppers = config.steppers_mut().unwrap();
    for axis in [&mut steppers.x, &mut steppers.y] {
        (axis.steps_per_mm, axis.max_rate_hz) = (STEPS_PER_MM, 25_000.0);
    }
    Machine::new(config).unwrap()
}

fn axidraw() -> CoreXy {
    CoreXy::new(BeltSigns::TrackingEquations, STEPS_PER_MM).unwrap()
}

fn host(ops: Vec<PlotOp>) -> Host {
    let settings = EbbHostSettings {
        planner: PlannerSettings {
            speed_mm_s: 40.0,
            travel_speed_mm_s: 80.0,
            accel_mm_s2: 800.0,
            ..PlannerSettings::default()
        },
        motion: EbbMotionSettings { pen_settle: Duration::from_millis(100), ..EbbMotionSettings::default() },
        servo_rates: [0, 0],
        ..EbbHostSettings::default()
    };
    EbbHost::new(axidraw(), settings, ops.into_iter()).unwrap()
}

fn desk(ops: Vec<PlotOp>) -> Desk {
    let mut desk = Desk::new(Box::new(host(ops)), &machine(), EBB, "");
    assert_eq!(desk.until(&[HostState::Ready], LONG), HostState::Ready);
    desk
}

/// Where the motors are told to have gone.
fn made(desk: &Desk) -> StepPoint {
    desk.steps().iter().fold(StepPoint::default(), |at, &(axis, sign)| match axis {
        plotter_motion::Axis::X => StepPoint::new(at.x + sign, at.y),
        plotter_motion::Axis::Y => StepPoint::new(at.x, at.y + sign),
    })
}

fn end_of(ops: &[PlotOp]) -> StepPoint {
    axidraw().steps_at(ops.iter().rev().find_map(|op| op.target()).unwrap())
}

fn is_whole(notices: &[MachineNotice]) -> bool {
    notices.iter().all(|notice| matches!(notice, MachineNotice::State(_) | MachineNotice::Greeted))
}

/// Places with the pen down that one drawing has and the other has nothing near of.
fn missing(of: &Desk, in_: &Desk, steps: i32) -> usize {
    let there = in_.ink();
    let near = |&(x, y): &(i32, i32)| {
        (-steps..=steps).any(|dx| (-steps..=steps).any(|dy| there.contains(&(x + dx, y + dy))))
    };
    of.ink().iter().filter(|place| !near(place)).count()
}

fn drawn(ops: Vec<PlotOp>) -> Desk {
    let mut desk = desk(ops);
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done);
    desk
}

#[test]
fn a_drawing_ends_exactly_where_it_should() {
    let desk = drawn(drawing());
    assert!(is_whole(&desk.notices), "{:?}", desk.notices);
    assert_eq!(made(&desk), end_of(&drawing()));
    let status = desk.host.status();
    assert_eq!((status.sent, status.done), (drawing().len() as u64, drawing().len() as u64));
    let begins = b"V\rSC,4,12000\rSC,5,16000\rSC,11,0\rSC,12,0\rEM,1,1\rSP,1,100\r";
    assert!(desk.sent.starts_with(begins), "{}", String::from_utf8_lossy(&desk.sent[..80]));
    // The board was asked for its count at each lifting of the pen.
    let asked = desk.sent.split(|&byte| byte == b'\r').filter(|line| line == b"QS").count();
    assert_eq!(asked, 4);
}

#[test]
fn pauses_lose_nothing_and_lift_the_pen_each_time() {
    let whole = drawn(drawing());
    let mut desk = desk(drawing());
    desk.ask(Request::GoOn);
    let mut pauses = 0;
    while desk.until(&[HostState::Done], Duration::from_millis(610)) != HostState::Done {
        desk.ask(Request::Pause);
        let state = desk.until(&[HostState::Paused, HostState::Done], LONG);
        if state == HostState::Done {
            break;
        }
        assert_eq!(desk.host.status().pen, plotter_motion::Pen::Up);
        pauses += 1;
        if pauses % 2 == 0 {
            // by hand elsewhere: it comes back
            desk.ask(Request::Jog { by: Vec2::new(1.0, 2.0), feed_mm_s: 20.0 });
            desk.wait(Duration::from_millis(600));
        }
        desk.ask(Request::GoOn);
    }
    assert!(pauses >= 3, "{pauses}");
    assert_eq!(made(&desk), end_of(&drawing()));
    assert_eq!((missing(&whole, &desk, 3), missing(&desk, &whole, 3)), (0, 0));
}

#[test]
fn after_a_stop_it_goes_on_from_where_the_motors_stand() {
    let whole = drawn(drawing());
    let mut stops = 0;
    for after_ms in [150, 700, 1_340, 2_210, 3_000] {
        let mut desk = desk(drawing());
        desk.ask(Request::GoOn);
        if desk.until(&[HostState::Done], Duration::from_millis(after_ms)) == HostState::Done {
            break;
        }
        let began = desk.now();
        desk.stop();
        desk.wait(Duration::from_millis(400));
        let stopped = desk.now();
        assert_eq!(desk.host.status().state, HostState::Stopped);
        assert_eq!(desk.host.ask(desk.now(), Request::GoOn), Err(NotNow::Locked));
        desk.ask(Request::Unlock);
        assert_eq!(desk.until(&[HostState::Paused], LONG), HostState::Paused);
        desk.ask(Request::GoOn);
        assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done);
        stops += 1;
        // Two moves and what was on the line at most
        let mut events = desk.events().into_iter().rev();
        let last = events.find(|(at, event)| *at < stopped && matches!(event, Event::Edge { .. })).unwrap().0;
        assert!(last <= began + Duration::from_millis(140), "stopped after {:?}", last - began);
        assert_eq!(made(&desk), end_of(&drawing()), "stopped after {after_ms} ms");
        assert_eq!(missing(&whole, &desk, 4), 0, "stopped after {after_ms} ms");
        assert_eq!(missing(&desk, &whole, 4), 0, "stopped after {after_ms} ms");
    }
    assert!(stops >= 3, "{stops}");
}

#[test]
fn another_host_goes_on_where_the_first_was_killed() {
    let whole = drawn(drawing());
    let mut desk = desk(drawing());
    desk.ask(Request::GoOn);
    desk.until(&[HostState::Done], Duration::from_millis(1_700));
    let status = desk.host.status();
    assert_ne!(status.state, HostState::Done);
    let mut desk = desk.with(Box::new(host(drawing()).resuming(status.done, status.sent)));
    assert_eq!(desk.until(&[HostState::Ready], LONG), HostState::Ready);
    assert!(is_whole(&desk.notices), "{:?}", desk.notices);
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done);
    assert_eq!(made(&desk), end_of(&drawing()));
    assert_eq!((missing(&whole, &desk, 4), missing(&desk, &whole, 4)), (0, 0));
}

/// A digit that comes as another one is a move of its own: the board says at the next lifting where it is.
#[test]
fn damaged_bytes_are_found_at_the_next_rest_and_taken_back() {
    for nth in [2, 10, 30, 60] {
        let mut desk = desk(drawing());
        let (mut line, mut moves) = (String::new(), 0);
        desk.damage = Some(Box::new(move |is_host, byte| {
            if !is_host {
                return byte;
            }
            line.push(char::from(byte));
            if byte == b'\r' {
                line.clear();
            }
            // The first digit of the first motor's steps
            let steps =
                line.strip_prefix("LM,").and_then(|rest| rest.split_once(',')).map(|(_, steps)| steps);
            if steps.is_some_and(|steps| steps.len() == 1 && byte.is_ascii_digit()) {
                moves += 1;
                if moves == nth {
                    return if byte == b'9' { b'8' } else { byte + 1 };
                }
            }
            byte
        }));
        desk.ask(Request::GoOn);
        assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done);
        let elsewhere = desk.notices.iter().filter(|n| matches!(n, MachineNotice::Elsewhere { .. })).count();
        assert_eq!(elsewhere, 1, "move {nth}: {:?}", desk.notices);
        assert_eq!(made(&desk), end_of(&drawing()), "move {nth}: {:?}", desk.notices);
    }
}

#[test]
fn a_line_that_comes_wrong_is_sent_again_and_a_lost_answer_is_told() {
    let mut desk = desk(drawing());
    let (mut commas, mut answers) = (0, 0);
    desk.damage = Some(Box::new(move |is_host, byte| match (is_host, byte) {
        (true, b',') => {
            commas += 1;
            if commas == 40 { b'~' } else { byte }
        }
        (false, b'K') => {
            answers += 1;
            if answers == 20 { b'?' } else { byte }
        }
        _ => byte,
    }));
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done);
    for notice in [MachineNotice::SentAgain, MachineNotice::Garbled, MachineNotice::AnswerLost] {
        assert!(desk.notices.contains(&notice), "{notice}: {:?}", desk.notices);
    }
    assert_eq!(made(&desk), end_of(&drawing()));
}

#[test]
fn pens_are_asked_for_and_what_has_no_word_is_refused() {
    let to = |x, y| PlotOp::Draw { to: Point::new(x, y), feed_mm_s: None };
    let ops = vec![PlotOp::SelectPen { pen: 1 }, to(5.0, 0.0), PlotOp::SelectPen { pen: 2 }, to(5.0, 5.0)];
    let mut desk = desk(ops.clone());
    assert_eq!(desk.host.ask(Duration::ZERO, Request::Home), Err(NotNow::NoWord));
    assert_eq!(desk.host.ask(Duration::ZERO, Request::Pause), Err(NotNow::Nothing));
    desk.ask(Request::GoOn);
    let wanted = HostState::PenWanted(2);
    assert_eq!(desk.until(&[wanted, HostState::Done], LONG), wanted);
    assert_eq!(desk.host.status().pen, plotter_motion::Pen::Up);
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done);
    assert_eq!(made(&desk), end_of(&ops));
    assert!(is_whole(&desk.notices), "{:?}", desk.notices);
}

#[test]
fn one_operation_at_a_time_is_drawn_when_asked() {
    let to = |x, y| PlotOp::Draw { to: Point::new(x, y), feed_mm_s: None };
    let mut desk = desk(vec![to(5.0, 0.0), to(5.0, 5.0), to(0.0, 5.0)]);
    for at in [Point::new(5.0, 0.0), Point::new(5.0, 5.0)] {
        desk.ask(Request::Next);
        assert_eq!(desk.until(&[HostState::Paused, HostState::Done], LONG), HostState::Paused);
        assert_eq!(desk.host.status().at, Some(at));
    }
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&[HostState::Done], LONG), HostState::Done);
}

/// By hand, as a session asks: again while the board has enough to do.
fn by_hand(desk: &mut Desk, op: PlotOp) {
    for _ in 0..5_000 {
        let now = desk.now();
        match desk.host.ask(now, Request::ByHand(op)) {
            Err(NotNow::Busy) => desk.round(),
            done => return done.unwrap(),
        }
    }
    panic!("{op:?} is never done");
}

#[test]
fn a_line_by_hand_is_drawn_and_the_pen_goes_where_it_is_led() {
    let mut desk = desk(Vec::new());
    let draw = |x: f64, y: f64| PlotOp::Draw { to: Point::new(x, y), feed_mm_s: None };
    by_hand(&mut desk, PlotOp::Travel { to: Point::new(5.0, 5.0) });
    by_hand(&mut desk, draw(8.0, 5.0));
    by_hand(&mut desk, draw(8.0, 9.0));
    by_hand(&mut desk, PlotOp::Travel { to: Point::new(1.0, 2.0) });
    desk.wait(Duration::from_secs(3));
    assert_eq!(made(&desk), axidraw().steps_at(Point::new(1.0, 2.0)));
    assert_eq!(desk.host.status().pen, plotter_motion::Pen::Up);
    let ink = desk.ink();
    for at in [Point::new(5.0, 5.0), Point::new(8.0, 5.0), Point::new(8.0, 9.0)] {
        let StepPoint { x, y } = axidraw().steps_at(at);
        assert!(ink.contains(&(x, y)), "nothing is drawn at {at:?}");
    }
    let StepPoint { x, y } = axidraw().steps_at(Point::new(1.0, 2.0));
    assert!(!ink.contains(&(x, y)));
}

#[test]
fn a_host_that_goes_on_knows_which_pen_is_in_the_holder() {
    let draw = |x: f64, y: f64| PlotOp::Draw { to: Point::new(x, y), feed_mm_s: None };
    let mut ops = vec![PlotOp::SelectPen { pen: 1 }, draw(20.0, 0.0), draw(20.0, 20.0), draw(0.0, 20.0)];
    ops.extend([PlotOp::SelectPen { pen: 2 }, draw(5.0, 25.0)]);
    let mut desk = desk(ops.clone());
    desk.ask(Request::GoOn);
    desk.wait(Duration::from_millis(1_200));
    let status = desk.host.status();
    assert_eq!(status.state, HostState::Drawing);
    let mut desk = desk.with(Box::new(host(ops).resuming(status.done, status.sent)));
    desk.until(&[HostState::Ready], LONG);
    desk.ask(Request::GoOn);
    assert_eq!(desk.until(&[HostState::PenWanted(2), HostState::Done], LONG), HostState::PenWanted(2));
}
