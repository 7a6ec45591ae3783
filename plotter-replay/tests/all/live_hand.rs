//! Machines of targets led by hand: by digits and over the link, and a board with a belt.

use crate::watched::{
    AS_FAST_AS_IT_GOES, Step, ask_for, during, led, machine, until_it_is, until_it_moves, until_it_rests,
};
use plotter_motion::config::ControllerChoice;
use plotter_motion::{Machine, MachineConfig, Pen, PenMove, Point, StepPoint};
use plotter_replay::live::{
    Command, DrawingStep, LinkChoice, MachineLog, Plan, Recording, Session, SessionSettings,
    SimulatedMachine, Spoken, State, Telemetry,
};
use plotter_replay::log::{Header, LogFile, create, open};
use plotter_replay::resume::ResumeError;
use plotter_replay::{PlotterSettings, ResumePoint, VirtualPlotter};
use std::sync::{Arc, Mutex};
use std::time::Duration;

const AREA: StepPoint = StepPoint::new(23_760, 16_800);

fn settings(link: LinkChoice) -> SessionSettings {
    let plan = Some(Plan { targets: 4, way_mm: 120.0 });
    SessionSettings::default()
        .with_byte_gap(Duration::ZERO)
        .with_plan(plan)
        .with_link(link)
        .with_most(Some(AREA))
}

fn down(x: i32, y: i32) -> DrawingStep {
    PenMove { pen: Pen::Down, target: StepPoint::new(x, y) }.into()
}

fn up(x: i32, y: i32) -> DrawingStep {
    PenMove { pen: Pen::Up, target: StepPoint::new(x, y) }.into()
}

/// A square of 10 mm, drawn from its lower left corner.
fn square() -> Vec<DrawingStep> {
    vec![up(400, 400), down(800, 400), down(800, 800), down(400, 800), down(400, 400)]
}

fn hand(words: &str) -> Step {
    ask_for(Command::from_name(words).unwrap_or_else(|| panic!("{words} is no command")))
}

/// Both protocols, and their numbers.
fn protocols() -> [(LinkChoice, Option<u32>); 2] {
    [(LinkChoice::Digits, None), (LinkChoice::Frames, Some(7))]
}

/// Looks at the session once.
fn look(mut what: impl FnMut(&Session, Telemetry) + Send + 'static) -> Step {
    Box::new(move |session, now| {
        what(session, now);
        true
    })
}

/// The pen stands there, as the machine's counts say.
fn stands_at(x: f64, y: f64) -> Step {
    look(move |session, _| {
        let at = session.by_hand().at;
        assert!(at.distance(Point::new(x, y)) < 0.051, "{at:?} for ({x}, {y}): {:?}", session.messages());
    })
}

fn refused(why: &'static str) -> Step {
    look(move |session, _| {
        let said = session.by_hand().refused;
        assert!(said.as_ref().is_some_and(|said| said.contains(why)), "{said:?} for {why}");
    })
}

/// What was drawn with the pen down, as a log has it: lines of counts.
fn ink(path: &std::path::Path) -> Vec<(StepPoint, StepPoint)> {
    let reader = open(path).unwrap();
    let settings = PlotterSettings::from_header(reader.header()).unwrap();
    let mut plotter = VirtualPlotter::new(settings);
    reader.for_each(|record| plotter.push(&record.unwrap()));
    plotter.finish();
    assert_eq!(plotter.anomaly_count(), 0, "{:?}", plotter.anomalies());
    let legs = plotter.legs().iter().filter(|leg| leg.pen == Pen::Down && leg.points.len() > 1);
    legs.filter_map(|leg| Some((leg.from, leg.target?))).filter(|(from, to)| from != to).collect()
}

#[test]
fn eight_directions_steps_places_and_pulses_without_a_drawing() {
    for (link, boot) in protocols() {
        let line = SimulatedMachine::new(&machine(), boot).unwrap().line(AS_FAST_AS_IT_GOES);
        let mut steps = vec![hand("go 20 20"), until_it_rests(1), stands_at(20.0, 20.0)];
        let (mut x, mut y, mut asked) = (20.0, 20.0, 1);
        for step in [0.1, 1.0, 10.0] {
            for (dx, dy) in [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)] {
                let (by_x, by_y) = (f64::from(dx) * step, f64::from(dy) * step);
                asked += 1;
                (x, y) = (x + by_x, y + by_y);
                steps.extend([
                    hand(&format!("jog {by_x} {by_y} 30")),
                    until_it_rests(asked),
                    stands_at(x, y),
                ]);
            }
        }
        // A count each, there and back.
        for (digit, dx, dy) in [(1, 1, 0), (3, 0, 1), (2, -1, 0), (4, 0, -1)] {
            asked += 1;
            (x, y) = (x + f64::from(dx) * 0.025, y + f64::from(dy) * 0.025);
            let (to_x, to_y) = (x, y);
            steps.extend([
                hand(&format!("pulse {digit}")),
                until_it_rests(asked),
                look(move |session, _| {
                    let at = session.by_hand().at;
                    assert!(at.distance(Point::new(to_x, to_y)) < 0.026, "{at:?} for ({to_x}, {to_y})");
                }),
            ]);
        }
        // What leads outside is refused, and nothing moves.
        steps.extend([
            hand("go 700 10"),
            until_it_rests(asked + 1),
            refused("out of range"),
            stands_at(x, y),
        ]);
        steps.extend([hand("jog -100 0 30"), until_it_rests(asked + 2), refused("out of range")]);
        steps.extend([hand("home"), until_it_rests(asked + 3), refused("no word")]);
        steps.extend([hand("next"), until_it_rests(asked + 4), refused("nothing")]);
        steps.push(look(|session, _| assert_eq!(session.state(), State::Watching)));
        led(line, None, None::<Recording<LogFile>>, settings(link), steps);
    }
}

#[test]
fn shapes_are_drawn_with_the_pen_down_and_what_leads_to_them_with_the_pen_up() {
    for (link, boot) in protocols() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("hand.plog");
        let header = Header::new().with_text("protocol", if boot.is_some() { "link" } else { "digits" });
        let recording = Some(Recording::Line(create(&path, &header).unwrap()));
        let line = SimulatedMachine::new(&machine(), boot).unwrap().line(AS_FAST_AS_IT_GOES);
        let steps = vec![
            hand("line 10 10 20 10 30 0.1"),
            until_it_rests(1),
            hand("rectangle 30 10 10 5 30"),
            until_it_rests(2),
            hand("circle 50 20 10 0 30 0.1"), // as many points as 0.1 mm ask for
            until_it_rests(3),
            // With the pen lowered a step draws.
            hand("pen down"),
            until_it_rests(4),
            hand("jog 10 0 30"),
            until_it_rests(5),
            hand("pen up"),
            until_it_rests(6),
            hand("jog 10 0 30"),
            until_it_rests(7),
            look(|session, _| {
                let said = session.messages();
                assert!(said.iter().all(|(_, words)| !words.contains("are allowed")), "{said:?}");
            }),
        ];
        led(line, None, recording, settings(link), steps);
        let ink = ink(&path);
        let p = StepPoint::new;
        let first = [
            (p(400, 400), p(800, 400)),
            (p(1_200, 400), p(1_200, 600)),
            (p(1_200, 600), p(1_600, 600)),
            (p(1_600, 600), p(1_600, 400)),
            (p(1_600, 400), p(1_200, 400)),
        ];
        assert_eq!(ink[..5], first, "{link:?}");
        let circle = &ink[5..ink.len() - 1];
        assert_eq!(circle.len(), 23);
        for (_, to) in circle {
            let at = Point::new(f64::from(to.x) / 40.0, f64::from(to.y) / 40.0);
            assert!((at.distance(Point::new(60.0, 20.0)) - 10.0).abs() < 0.025, "{at:?}");
        }
        assert_eq!(ink.last(), Some(&(p(2_000, 800), p(2_400, 800))));
    }
}

/// In a pause the pen is led elsewhere; then it goes on where it was, with the pen lifted on the way, and
/// every line of the drawing is there once.
#[test]
fn a_pause_lifts_the_pen_and_what_is_done_in_it_by_hand_leaves_the_drawing_whole() {
    for (link, boot) in protocols() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("hand.plog");
        let header = Header::new().with_text("protocol", if boot.is_some() { "link" } else { "digits" });
        let recording = Some(Recording::Line(create(&path, &header).unwrap()));
        let line = SimulatedMachine::new(&machine(), boot).unwrap().line(AS_FAST_AS_IT_GOES);
        let lowered = Arc::new(Mutex::new(false));
        let lowers = Arc::clone(&lowered);
        let steps = vec![
            ask_for(Command::Start),
            Box::new(move |session: &Session, now: Telemetry| {
                *lowers.lock().unwrap() |= now.pen == Some(Pen::Down);
                session.reached() == 2
            }) as Step,
            until_it_moves(),
            ask_for(Command::Pause),
            until_it_is(State::Paused),
            during(Duration::from_secs(2), |_, _| ()),
            look(move |session, now| {
                assert_eq!(session.reached(), 3, "{:?}", session.messages());
                assert_eq!(now.pen, boot.map(|_| Pen::Up), "lifted where the machine is told");
            }),
            hand("go 100 100"),
            until_it_rests(1),
            stands_at(100.0, 100.0),
            ask_for(Command::Resume),
        ];
        let session = led(line, Some(square()), recording, settings(link), steps);
        assert_eq!((session.reached(), session.state()), (5, State::Done));
        if boot.is_some() {
            // Another host would know which of the machine's targets were none of the drawing's.
            let point = ResumePoint::read(&path).unwrap();
            assert_eq!((point.resume.boot, point.resume.before), (7, 2)); // there, and back
            let text = std::fs::read_to_string(&path).unwrap();
            let (cut, _) = text.split_once("move by hand 2 reached").unwrap();
            let cut_path = directory.path().join("cut.plog");
            std::fs::write(&cut_path, cut.rsplit_once('\n').unwrap().0.to_owned() + "\n").unwrap();
            assert_eq!(ResumePoint::read(&cut_path), Err(ResumeError::LedByHand));
        }
        assert_eq!(*lowered.lock().unwrap(), boot.is_some());
        let p = StepPoint::new;
        let lines = [
            (p(400, 400), p(800, 400)),
            (p(800, 400), p(800, 800)),
            (p(800, 800), p(400, 800)),
            (p(400, 800), p(400, 400)),
        ];
        assert_eq!(ink(&path), lines, "{link:?}");
    }
}

#[test]
fn a_pen_and_a_sheet_are_waited_for_and_named() {
    for (link, boot) in protocols() {
        let line = SimulatedMachine::new(&machine(), boot).unwrap().line(AS_FAST_AS_IT_GOES);
        let drawing = vec![
            DrawingStep::Pen(1),
            up(400, 400),
            down(800, 400),
            DrawingStep::Pen(2),
            down(800, 800),
            DrawingStep::Sheet,
            down(400, 800),
        ];
        let settings = settings(link).with_pens(vec![(2, String::from("red"))]);
        let wants = |words: &'static str, reached| {
            look(move |session, now| {
                assert_eq!(session.wants(), words);
                assert_eq!((session.reached(), now.duty), (reached, [0, 0]));
            })
        };
        let steps = vec![
            ask_for(Command::Start),
            until_it_is(State::Paused),
            during(Duration::from_secs(1), |_, _| ()),
            wants("pen 2 is wanted (red): put it in, then go on", 2),
            ask_for(Command::Resume),
            until_it_is(State::Running),
            until_it_is(State::Paused),
            during(Duration::from_secs(1), |_, _| ()),
            wants("a new sheet is wanted: put it in, then go on", 3),
            ask_for(Command::Resume),
        ];
        assert_eq!(led(line, Some(drawing), None::<Recording<LogFile>>, settings, steps).reached(), 4);
    }
}

#[test]
fn the_next_target_only_then_the_rest() {
    for (link, boot) in protocols() {
        let line = SimulatedMachine::new(&machine(), boot).unwrap().line(AS_FAST_AS_IT_GOES);
        let mut steps: Vec<Step> = Vec::new();
        for reached in 1..=2 {
            steps.extend([
                hand("next"),
                until_it_is(State::Running),
                until_it_is(State::Paused),
                during(Duration::from_secs(1), move |session, _| assert_eq!(session.reached(), reached)),
            ]);
        }
        steps.push(ask_for(Command::Resume));
        assert_eq!(led(line, Some(square()), None::<Recording<LogFile>>, settings(link), steps).reached(), 5);
    }
}

#[test]
fn the_origin_is_set_where_the_pen_is_and_a_drawing_that_leads_outside_from_there_is_not_begun() {
    for (link, boot) in protocols() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("hand.plog");
        let header = Header::new().with_text("protocol", if boot.is_some() { "link" } else { "digits" });
        let recording = Some(Recording::Line(create(&path, &header).unwrap()));
        let line = SimulatedMachine::new(&machine(), boot).unwrap().line(AS_FAST_AS_IT_GOES);
        let bounds = Some((StepPoint::default(), StepPoint::new(800, 800)));
        let settings = settings(link).with_bounds(bounds);
        let steps = vec![
            hand("go 580 100"),
            until_it_rests(1),
            hand("origin 0 0"),
            until_it_rests(2),
            stands_at(0.0, 0.0),
            ask_for(Command::Start),
            during(Duration::from_secs(1), |session, now| {
                assert_eq!((session.state(), now.duty), (State::Ready, [0, 0]));
            }),
            look(|session, _| {
                let said = session.messages();
                assert!(said.iter().any(|(_, words)| words.contains("leads outside")), "{said:?}");
            }),
            hand("p1 4000 200"), // in counts: 100 mm and 5 mm
            until_it_rests(3),
            stands_at(480.0, 95.0),
            ask_for(Command::Start),
        ];
        assert_eq!(led(line, Some(square()), recording, settings, steps).reached(), 5);
        assert_eq!(ink(&path).first(), Some(&(StepPoint::new(4_400, 600), StepPoint::new(4_800, 600))));
    }
}

#[test]
fn a_stop_leaves_nothing_of_what_was_asked_by_hand() {
    for (link, boot) in protocols() {
        let line = SimulatedMachine::new(&machine(), boot).unwrap().line(AS_FAST_AS_IT_GOES);
        let at = Arc::new(Mutex::new(Point::ORIGIN));
        let noted = Arc::clone(&at);
        let steps = vec![
            hand("circle 50 50 20 72 30"),
            until_it_moves(),
            during(Duration::from_secs(2), |_, _| ()),
            ask_for(Command::Stop),
            until_it_is(State::Stopped),
            during(Duration::from_millis(300), |_, _| ()),
            during(Duration::from_secs(1), |_, now| assert_eq!(now.duty, [0, 0])),
            hand("go 10 10"),
            until_it_is(State::Stopped),
            during(Duration::from_secs(1), |_, now| assert_eq!(now.duty, [0, 0])),
            refused("unlock"),
            ask_for(Command::Resume),
            until_it_is(State::Watching),
            // The line under way is finished, and no other begun.
            during(Duration::from_secs(2), |_, _| ()),
            look(move |session, _| *noted.lock().unwrap() = session.by_hand().at),
            during(Duration::from_secs(2), |_, now| assert_eq!(now.duty, [0, 0])),
        ];
        led(line, None, None::<Recording<LogFile>>, settings(link), steps);
        let at = *at.lock().unwrap();
        assert!((at.distance(Point::new(70.0, 50.0)) - 20.0).abs() < 0.1, "{at:?} lies on the circle");
        assert!(at.distance(Point::new(50.0, 50.0)) > 1.0, "{at:?}");
    }
}

fn board(controller: ControllerChoice) -> Machine {
    let mut config = MachineConfig::marking_board();
    config.serial.byte_gap_ms = 0.0;
    config.dc_mut().unwrap().control.controller = controller;
    // The ramp of the report's panel: a step every 100 ms.
    config.belt_mut().unwrap().point_to_point.drive_start = 0.15;
    config.belt_mut().unwrap().point_to_point.drive_step = 0.05;
    config.belt_mut().unwrap().point_to_point.drive_step_ms = 100.0;
    Machine::new(config).unwrap()
}

fn board_settings(tolerance_counts: u32) -> SessionSettings {
    let plotter = PlotterSettings::default()
        .with_x_mm_per_pulse(1.0 / 46.3)
        .with_y_mm_per_pulse(1.0 / 46.3)
        .with_begins_at(Some(Point::new(150.0, 100.0)))
        .with_reached_tolerance_counts(tolerance_counts);
    let settings = settings(LinkChoice::Digits);
    let host = plotter_motion::protocol::HostSettings { tolerance_counts, ..settings.host };
    settings
        .with_stands_at(plotter.to_counts(Point::new(150.0, 100.0)))
        .with_host(host)
        .with_most(Some(StepPoint::new(13_890, 9_260)))
        .with_pwm_steps([SimulatedMachine::BELT_PWM_STEPS; 2])
        .with_ramps(true)
        .with_plotter(plotter)
}

/// "Acceleration is implemented in the manual control panel": the drive grows by a step every 100 ms for as
/// long as the key is held, and when it is let go, or nobody says so any more, the board comes to rest.
#[test]
fn while_a_key_is_held_the_drive_of_a_board_grows_every_100_ms() {
    for is_let_go in [true, false] {
        let machine = board(ControllerChoice::Published);
        let line = SimulatedMachine::speaking(&machine, Spoken::Digits).unwrap().line(AS_FAST_AS_IT_GOES);
        let drives = Arc::new(Mutex::new(Vec::<(Duration, i32)>::new()));
        let noted = Arc::clone(&drives);
        let mut said = None::<Duration>;
        let steps = vec![
            Box::new(move |session: &Session, now: Telemetry| {
                if said.is_none_or(|at| now.time >= at + Duration::from_millis(100)) {
                    said = Some(now.time);
                    session.command(Command::from_name("hold 1 0").unwrap());
                }
                let mut drives = noted.lock().unwrap();
                if now.duty[0] != 0 && drives.last().is_none_or(|&(_, duty)| duty != now.duty[0]) {
                    drives.push((now.time, now.duty[0]));
                }
                drives.len() >= 5 || now.time > Duration::from_secs(10)
            }) as Step,
            if is_let_go { hand("end-jog") } else { look(|_, _| ()) },
            during(Duration::from_secs(2), |_, _| ()),
            during(Duration::from_secs(2), |session, now| {
                assert_eq!(now.duty, [0, 0], "{:?}", session.messages());
            }),
            look(|session, _| {
                let hand = session.by_hand();
                assert!(hand.rests && hand.at.x > 152.0 && hand.at.x < 200.0, "{hand:?}");
                assert!((hand.at.y - 100.0).abs() < 1.5, "{hand:?}");
            }),
        ];
        led(line, None, None::<Recording<LogFile>>, board_settings(42), steps);
        let drives = drives.lock().unwrap();
        let steps = SimulatedMachine::BELT_PWM_STEPS;
        assert_eq!(drives.len(), 5, "{drives:?}");
        for (n, pair) in drives.windows(2).enumerate() {
            let grown = f64::from(pair[1].1 - pair[0].1) / f64::from(steps);
            assert!((grown - 0.05).abs() < 0.005, "step {n}: {drives:?}");
            let took = pair[1].0 - pair[0].0;
            assert!((95..=105).contains(&took.as_millis()), "step {n}: {drives:?}");
        }
        assert!((f64::from(drives[0].1) / f64::from(steps) - 0.15).abs() < 0.01, "{drives:?}");
    }
}

/// A drawing on the board, with a pause in it and something by hand, and what its log shows.
#[test]
fn a_board_with_a_belt_draws_and_is_led_by_hand() {
    for (controller, tolerance, off_mm) in
        [(ControllerChoice::Contouring, 1, 0.1), (ControllerChoice::Published, 42, 1.5)]
    {
        let machine = board(controller);
        let kept = tempfile::tempdir().unwrap();
        let path = kept.path().join("board.plog");
        let header = Header::new()
            .with_text("protocol", "counts")
            .with_text("belt_signs", "direction-table")
            .with_decimal("x_mm_per_pulse", 1.0 / 46.3)
            .with_decimal("p1_x_mm", 150.0)
            .with_decimal("p1_y_mm", 100.0)
            .with_decimal("reached_tolerance_counts", 42.0);
        let log = MachineLog::new(create(&path, &header).unwrap());
        let simulated = SimulatedMachine::speaking(&machine, Spoken::Digits).unwrap().logged(log.clone());
        let line = simulated.line(AS_FAST_AS_IT_GOES);
        let at = |x: f64, y: f64| {
            let counts = |mm: f64| plotter_motion::toolpath::from_mm(mm, 46.3);
            (counts(x), counts(y))
        };
        let (left, low) = at(160.0, 110.0);
        let (right, high) = at(180.0, 120.0);
        let drawing =
            vec![up(left, low), down(right, low), down(right, high), down(left, high), down(left, low)];
        let reads = Arc::new(Mutex::new(Vec::<Point>::new()));
        let noted = Arc::clone(&reads);
        let steps = vec![
            ask_for(Command::Start),
            Box::new(|session: &Session, _: Telemetry| session.reached() == 1) as Step,
            until_it_moves(),
            ask_for(Command::Pause),
            Box::new(move |session, now| {
                noted.lock().unwrap().push(session.by_hand().at); // it tells its way
                session.reached() == 2 && now.duty == [0, 0]
            }),
            hand("jog 0 10 30"),
            until_it_rests(1),
            look(move |session, _| {
                let at = session.by_hand().at;
                assert!(at.distance(Point::new(180.0, 120.0)) < off_mm, "{at:?}");
            }),
            ask_for(Command::Resume),
        ];
        let session =
            led(line, Some(drawing), Some(Recording::Machine(log)), board_settings(tolerance), steps);
        assert_eq!((session.reached(), session.state()), (5, State::Done), "{:?}", session.messages());
        let reads = reads.lock().unwrap();
        let along = reads.iter().filter(|at| at.x > 165.0 && at.x < 175.0).count();
        assert!(along > 10, "{along} places told on the way");
        let reader = open(&path).unwrap();
        let mut plotter = VirtualPlotter::new(PlotterSettings::from_header(reader.header()).unwrap());
        reader.for_each(|record| plotter.push(&record.unwrap()));
        plotter.finish();
        assert_eq!(plotter.reached_count(), 7); // five of the drawing, one by hand, one back
        assert!(plotter.position().distance(Point::new(160.0, 110.0)) < off_mm, "{:?}", plotter.position());
    }
}
