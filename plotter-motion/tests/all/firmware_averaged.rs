//! The controller of a stepper plotter whose jerk is limited as a vector: its steps are averaged.
#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::print_stdout,
    reason = "times below a day and places on a sheet, and what was measured"
)]

use crate::auditor::actions;
use crate::law_cases::cases;
use crate::stepper_bench::{Bench, distance_mm};
use core::time::Duration;
use plotter_motion::firmware::stepper_plotter::{
    Activity, Command, Dialect, Drivers, Link, Motion, Setting, SettingProblem, StepperPlotterSettings,
};
use plotter_motion::kinematics::{Backlash, Cartesian, MotorScale};
use plotter_motion::planner::{Action, ExactOnly, JerkLimit, PlanError};
use plotter_motion::protocol::hosts::{EbbHost, EbbHostSettings};
use plotter_motion::stepgen::{
    AveragedSteps, Estimator, MotorEvent, StepGenSettings, TimedEvent, timed_events,
};
use plotter_motion::toolpath::{chords, from_mm};
use plotter_motion::{
    Axis, Direction, LimitSwitches, Machine, MachineConfig, PathMode, PlannerSettings, PlotOp, Point,
    SafetyGate, StepGen, StepPair, StepPoint, Vec2, config,
};
use proptest::prelude::*;

const JERK_MM_S3: f64 = 20_000.0;
const ACCEL_MM_S2: f64 = 1_000.0;
const TOLERANCE_MM: f64 = 0.1;
/// Twenty times what a motor has, so that places are known well enough to be differentiated thrice; and as
/// fast as there is room for the steps of the 52 ms of the window.
const FINE_STEPS_PER_MM: f64 = 2_000.0;
const FINE_SPEED_MM_S: f64 = 19.0;
/// Places are averaged over this, accelerations are second differences over so many bins, and the jerk is the
/// difference of two over so many: half a step in one place makes 500 mm/s³.
const BIN_US: u64 = 500;
const ACCEL_BINS: usize = 20;
const JERK_BINS: usize = 40;
/// By how much what is measured may exceed a limit, as in the audit of the planner.
const MEASURED: f64 = 1.05;

fn planner() -> PlannerSettings {
    PlannerSettings {
        path: PathMode::Tolerance { path_tolerance_mm: TOLERANCE_MM },
        accel_mm_s2: ACCEL_MM_S2,
        jerk_mm_s3: Some(JERK_MM_S3),
        jerk_limit: JerkLimit::Vector,
        ..PlannerSettings::default()
    }
}

fn settings() -> StepperPlotterSettings {
    StepperPlotterSettings {
        dialect: Dialect::Grbl,
        planner: PlannerSettings { speed_mm_s: 60.0, travel_speed_mm_s: 90.0, ..planner() },
        ..StepperPlotterSettings::default()
    }
}

fn fine() -> StepperPlotterSettings {
    StepperPlotterSettings {
        x_steps_per_mm: FINE_STEPS_PER_MM,
        y_steps_per_mm: FINE_STEPS_PER_MM,
        planner: PlannerSettings {
            speed_mm_s: FINE_SPEED_MM_S,
            travel_speed_mm_s: FINE_SPEED_MM_S,
            resolution_mm: 0.001,
            ..planner()
        },
        ..settings()
    }
}

/// Corners, an arc, dots, pens, pauses.
fn drawing() -> Vec<PlotOp> {
    let draw = |x, y| PlotOp::Draw { to: Point::new(x, y), feed_mm_s: None };
    let travel = |x, y| PlotOp::Travel { to: Point::new(x, y) };
    vec![
        travel(2.0, 1.0),
        draw(12.0, 1.0),
        draw(12.0, 6.0),
        PlotOp::DrawArc {
            centre: Point::new(9.0, 6.0),
            sweep_rad: core::f64::consts::PI,
            to: Point::new(6.0, 6.0),
            feed_mm_s: None,
        },
        draw(5.0, 2.0),
        draw(5.2, 7.0),
        PlotOp::Dwell { duration: Duration::from_millis(150) },
        draw(9.0, 9.0),
        travel(3.0, 8.0),
        draw(3.0, 8.0),
        travel(1.0, 8.0),
        draw(2.0, 3.0),
        draw(1.99, 3.2),
        travel(0.0, 0.0),
    ]
}

/// Which motors a step moves, when, us, and whether the pen is down.
type Made = (u64, StepPair, bool);

/// A planner, a step generator and averaged steps by hand: each pause waits for the motors.
fn by_hand(settings: &StepperPlotterSettings, ops: &[PlotOp]) -> (Vec<Made>, u64) {
    let of = settings.planner.averaged(JERK_MM_S3).unwrap();
    let motor = |steps_per_mm| MotorScale { steps_per_mm, inverted: false };
    let motors = Cartesian::new(motor(settings.x_steps_per_mm), motor(settings.y_steps_per_mm)).unwrap();
    let timing = StepGenSettings {
        clock_hz: 1_000_000,
        pen_settle: settings.pen_settle,
        ..StepGenSettings::default()
    };
    let mut steps = StepGen::new(motors, timing);
    let mut averaged = Box::new(AveragedSteps::<8192>::new(of.window_ticks(1_000_000)));
    let (mut made, mut pen) = (Vec::new(), false);
    let mut take = |event: TimedEvent| match event.event {
        MotorEvent::Step(step) => made.push((event.tick, step, pen)),
        MotorEvent::Pen(now) => pen = now == plotter_motion::Pen::Down,
        _ => {}
    };
    actions::<16>(of.settings, ops, |action, _| {
        steps.push(action).unwrap();
        while let Some(event) = steps.next_event() {
            averaged.push(event).unwrap();
            while let Some(event) = averaged.next_event() {
                take(event);
            }
        }
        if matches!(action, Action::Dwell(_)) {
            averaged.arrive();
        }
    });
    while let Some(event) = averaged.rest() {
        take(event);
    }
    let end = steps.tick() + averaged.delay_ticks();
    (made, end)
}

/// The same by the motion side of the controller, to which all operations are sent at once.
fn by_the_firmware(settings: &StepperPlotterSettings, ops: &[PlotOp]) -> Vec<Made> {
    let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    let mut motion = Box::new(Motion::new(*settings, gate).unwrap());
    let (mut link, mut now, mut made) = (Link::default(), Duration::ZERO, Vec::new());
    let mut ops = ops.iter().copied().peekable();
    loop {
        while let Some(op) = ops.peek()
            && link.commands.push(Command::Plot(*op)).is_ok()
        {
            ops.next();
        }
        let before = link.commands.len();
        let pen_down_deg = settings.stored.pen_down_deg;
        while let Some(step) =
            motion.poll(now, Drivers::Ready, &mut link).map(|step| (step.at, step.pulse.into()))
        {
            made.push((step.0.as_micros() as u64, step.1, motion.pen_deg() == pen_down_deg));
        }
        if link.commands.len() < before {
            continue;
        }
        let Some(due) = motion.due() else { break };
        now = due;
    }
    assert_eq!(motion.status(now).activity, Activity::Idle);
    made
}

#[test]
fn the_firmware_gives_what_planner_steps_and_average_give_by_hand() {
    let (expected, _) = by_hand(&settings(), &drawing());
    let mut found = by_the_firmware(&settings(), &drawing());
    // It may have waited for its host at the start.
    let later_us = found[0].0 - expected[0].0;
    assert!(later_us <= settings().gather.as_micros() as u64);
    found.iter_mut().for_each(|made| made.0 -= later_us);
    assert!(expected.len() > 5_000);
    for (number, (found, expected)) in found.iter().zip(&expected).enumerate() {
        assert_eq!(found, expected, "step {number}");
    }
    assert_eq!(found.len(), expected.len());
    // Not so without the average.
    let along = PlannerSettings { jerk_limit: JerkLimit::Path, ..settings().planner };
    let along = by_the_firmware(&StepperPlotterSettings { planner: along, ..settings() }, &drawing());
    assert!(along.last().unwrap().0 < found.last().unwrap().0);
}

#[test]
fn the_time_is_estimated_to_the_tick() {
    let timing = StepGenSettings { pen_settle: settings().pen_settle, ..StepGenSettings::default() };
    let mut estimator = Estimator::<16>::new(settings().planner, timing).unwrap();
    drawing().into_iter().for_each(|op| estimator.push(op).unwrap());
    let (_, end) = by_hand(&settings(), &drawing());
    assert_eq!(estimator.finish().unwrap().total, Duration::from_micros(end));
}

fn machine(change: impl FnOnce(&mut MachineConfig)) -> Machine {
    let mut config = MachineConfig::stepper_plotter();
    (config.steppers_mut().unwrap().planner.mode, config.steppers_mut().unwrap().planner.s_curve) =
        (config::PathChoice::Tolerance, true);
    change(&mut config);
    Machine::new(config).unwrap()
}

#[test]
fn the_events_of_a_machine_of_a_file_are_averaged_too_and_take_the_time_that_is_estimated() {
    let machine = machine(|_| {});
    let events = |machine| -> Vec<TimedEvent> {
        timed_events(machine, drawing()).unwrap().collect::<Result<_, _>>().unwrap()
    };
    let found = events(&machine);
    let timing = StepGenSettings::of(&machine);
    let mut estimator = Estimator::<64>::new(PlannerSettings::of(&machine), timing).unwrap();
    drawing().into_iter().for_each(|op| estimator.push(op).unwrap());
    let total = estimator.finish().unwrap().total;
    let last = found.iter().rfind(|event| matches!(event.event, MotorEvent::Step(_))).unwrap();
    // The last thing is a travel, whose last step comes before its end.
    let left = total.saturating_sub(Duration::from_micros(last.tick));
    assert!(left > Duration::ZERO && left < Duration::from_millis(60), "{total:?} {last:?}");
    let other = self::machine(|config| {
        config.steppers_mut().unwrap().planner.jerk_limit = Some(config::JerkChoice::Path)
    });
    assert!(events(&other) != found);
}

/// The greatest acceleration and jerk of steps as vectors, mm/s² and mm/s³, with places and speeds from the
/// steps alone; 0.2 s of rest are added.
fn audited(settings: &StepperPlotterSettings, made: &[(u64, StepPair)]) -> (f64, f64) {
    let end = made.last().map_or(0, |made| made.0) + 200_000;
    let (mut means, mut now, mut filled) = (Vec::<Vec2>::new(), 0_u64, 0_u64);
    let (mut at, mut sum) = ([0_i64; 2], [0.0_f64; 2]);
    let [x, y] = [settings.x_steps_per_mm, settings.y_steps_per_mm];
    for (tick, step) in made.iter().copied().chain([(end, StepPair { x: 0, y: 0 })]) {
        while now < tick {
            let part = (tick - now).min(BIN_US - filled);
            (0..2).for_each(|axis| sum[axis] += at[axis] as f64 * part as f64);
            (now, filled) = (now + part, filled + part);
            if filled == BIN_US {
                means.push(Vec2::new(sum[0] / (x * BIN_US as f64), sum[1] / (y * BIN_US as f64)));
                (sum, filled) = ([0.0; 2], 0);
            }
        }
        (at[0], at[1]) = (at[0] + i64::from(step.x), at[1] + i64::from(step.y));
    }
    let over_s = ACCEL_BINS as f64 * BIN_US as f64 * 1e-6;
    let accel =
        |bins: &[Vec2]| (bins[0] - bins[ACCEL_BINS] * 2.0 + bins[2 * ACCEL_BINS]) * (1.0 / (over_s * over_s));
    let accels: Vec<Vec2> = means.windows(2 * ACCEL_BINS + 1).map(accel).collect();
    let jerk_s = JERK_BINS as f64 * BIN_US as f64 * 1e-6;
    let jerk = |pair: &[Vec2]| (pair[JERK_BINS] - pair[0]).length() / jerk_s;
    (
        accels.iter().map(|accel| accel.length()).fold(0.0, f64::max),
        accels.windows(JERK_BINS + 1).map(jerk).fold(0.0, f64::max),
    )
}

fn keeps_its_limits(
    settings: &StepperPlotterSettings,
    made: &[(u64, StepPair)],
) -> Result<(), TestCaseError> {
    let (accel_mm_s2, jerk_mm_s3) = audited(settings, made);
    println!("{accel_mm_s2:.0} mm/s², {jerk_mm_s3:.0} mm/s³, {} steps", made.len());
    prop_assert!(accel_mm_s2 <= MEASURED * ACCEL_MM_S2, "{} mm/s²", accel_mm_s2);
    prop_assert!(jerk_mm_s3 <= MEASURED * JERK_MM_S3, "{} mm/s³", jerk_mm_s3);
    Ok(())
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn an_auditor_finds_the_limits_kept_and_the_pen_within_the_tolerance() {
    let made = by_the_firmware(&fine(), &drawing());
    let steps: Vec<_> = made.iter().map(|made| (made.0, made.1)).collect();
    keeps_its_limits(&fine(), &steps).unwrap();
    // The same plan with the jerk along the path: the audit sees what is not averaged.
    let along = StepperPlotterSettings {
        planner: PlannerSettings { jerk_limit: JerkLimit::Path, ..fine().planner },
        ..fine()
    };
    let other: Vec<_> = by_the_firmware(&along, &drawing()).iter().map(|made| (made.0, made.1)).collect();
    assert!(audited(&along, &other).1 > 1.3 * JERK_MM_S3);

    // Every place of the pen is near the drawing, and the drawing near the pen.
    let (mut asked, mut at, mut was_down) = (Vec::<Vec<Point>>::new(), Point::ORIGIN, false);
    for op in chords(drawing(), 1e-4) {
        let is_down = matches!(op, PlotOp::Draw { .. });
        if is_down && !was_down {
            asked.push(vec![at]);
        }
        at = op.target().unwrap_or(at);
        if is_down && let Some(stroke) = asked.last_mut() {
            stroke.push(at);
        }
        was_down = is_down || (was_down && op.target().is_none());
    }
    let most_mm = TOLERANCE_MM + 0.001 + 2.0 / FINE_STEPS_PER_MM;
    let (mut place, mut drawn) = (StepPoint::default(), Vec::new());
    for (number, (_, step, is_down)) in made.iter().enumerate() {
        place = StepPoint::new(place.x + i32::from(step.x), place.y + i32::from(step.y));
        let at = Point::new(f64::from(place.x), f64::from(place.y));
        let at = Point::new(at.x / FINE_STEPS_PER_MM, at.y / FINE_STEPS_PER_MM);
        if *is_down {
            drawn.push(at);
            if number % 20 == 0 {
                let off_mm = asked.iter().map(|stroke| distance_mm(at, stroke)).fold(f64::INFINITY, f64::min);
                assert!(off_mm <= most_mm, "{off_mm} mm at {at:?}");
            }
        }
    }
    for at in asked.iter().filter(|stroke| stroke.len() > 2).flatten() {
        let off_mm = drawn.iter().map(|drawn| drawn.distance(*at)).fold(f64::INFINITY, f64::min);
        assert!(off_mm <= most_mm, "{off_mm} mm from {at:?}");
    }
}

/// What a person does while the machine draws.
#[derive(Clone, Copy, Debug)]
enum Hand {
    Byte(u8),
    Wait(u32),
}

fn hand() -> impl Strategy<Value = Hand> {
    let bytes = b"!~!~\x90\x91\x91\x92\x92\x93\x94\x95\x96\x97?".to_vec();
    prop_oneof![
        prop::sample::select(bytes).prop_map(Hand::Byte),
        // (within a window, and beyond it)
        (0_u32..60).prop_map(Hand::Wait),
        (0_u32..700).prop_map(Hand::Wait),
    ]
}

const TEXT: &str = "M3\nG1 X3 F1140\nG1 Y2\nG3 X1 Y2 I-1\nM5\nG0 X4 Y4\nM3\nG1 X4.5 Y1 F600\nG1 X4 Y3\nG4 P0.1\nG2 X4 Y3 J-1\nM5\n\
                    G0 X1 Y1\n";
const END_MM: [f64; 2] = [1.0, 1.0];

/// The steps of a bench with their times, us.
fn made(bench: &Bench) -> Vec<(u64, StepPair)> {
    let mut before = StepPoint::default();
    let steps = bench.made.iter().map(|made| {
        let way = |now: i32, before: i32| i8::try_from(now - before).unwrap();
        let step = StepPair { x: way(made.position.x, before.x), y: way(made.position.y, before.y) };
        before = made.position;
        (made.at.as_micros() as u64, step)
    });
    steps.collect()
}

fn bench(settings: StepperPlotterSettings) -> Bench {
    let mut bench = Bench::new(settings);
    bench.switches = false;
    bench.ask("");
    bench
}

fn stands_at(bench: &Bench, settings: &StepperPlotterSettings, [x, y]: [f64; 2]) -> bool {
    bench.plotter.position()
        == StepPoint::new(from_mm(x, settings.x_steps_per_mm), from_mm(y, settings.y_steps_per_mm))
}

proptest! {
    // Each case is a minute of the machine's time.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(64) })]

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn holds_and_overrides_keep_the_jerk_and_lose_no_step(
        hands in prop::collection::vec(hand(), 1..40),
    ) {
        let settings = fine();
        let mut bench = bench(settings);
        bench.send(TEXT);
        for hand in hands {
            match hand {
                Hand::Byte(byte) => bench.send_bytes(&[byte]),
                Hand::Wait(ms) => bench.run_for(Duration::from_millis(ms.into())),
            }
        }
        bench.send("~~");
        bench.run_out();
        prop_assert!(bench.is_idle());
        prop_assert!(stands_at(&bench, &settings, END_MM), "{:?}", bench.plotter.position());
        keeps_its_limits(&settings, &made(&bench))?;
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn jogs_that_are_cancelled_keep_the_jerk_and_the_place(
        jogs in prop::collection::vec((-4_i32..=4, -4_i32..=4, 100_u32..1200, 0_u32..700, prop::bool::ANY), 1..10),
    ) {
        let settings = fine();
        let mut bench = bench(settings);
        bench.ask("G0 X20 Y20\n");
        for (x, y, feed, wait_ms, cancels) in jogs {
            bench.send(&format!("$J=G91 X{x} Y{y} F{feed}\n"));
            bench.run_for(Duration::from_millis(wait_ms.into()));
            if cancels {
                bench.send_bytes(&[0x85]);
                bench.run_for(Duration::from_millis((wait_ms / 3).into()));
            }
        }
        bench.run_out();
        let told = bench.plotter.position_mm();
        let steps = bench.plotter.position();
        prop_assert!((told.x - f64::from(steps.x) / FINE_STEPS_PER_MM).abs() < 1e-9);
        prop_assert!((told.y - f64::from(steps.y) / FINE_STEPS_PER_MM).abs() < 1e-9);
        let answers = bench.ask("G90\nG1 X1 Y1 F1000\n");
        prop_assert!(answers.ends_with("ok\r\nok\r\n"), "{}", answers);
        prop_assert!(stands_at(&bench, &settings, END_MM), "{:?}", bench.plotter.position());
        keeps_its_limits(&settings, &made(&bench))?;
    }

    #[test]
    fn after_a_stop_nothing_moves_and_the_place_is_that_of_the_steps(
        before_ms in 0_u32..2_500,
        how in 0_u8..3,
        play in 0_u16..5,
    ) {
        let mut settings = settings();
        settings.backlash = Backlash { x_steps: play, y_steps: play };
        let mut bench = bench(settings);
        bench.send(TEXT);
        bench.run_for(Duration::from_millis(before_ms.into()));
        let moved = bench.made.len();
        match how {
            0 => bench.send("\u{18}"),
            1 => bench.stop_button(true),
            // The first step that way is not made, and stops the machine.
            _ => for axis in Axis::BOTH {
                for end in [Direction::Minus, Direction::Plus] {
                    let now = bench.now;
                    bench.plotter.limit_switch(now, axis, end, true);
                }
            },
        }
        bench.run_for(Duration::from_secs(20));
        prop_assert_eq!(bench.made.len(), moved);
        let carriage = [bench.carriage[0] - 500, bench.carriage[1] - 500];
        prop_assert_eq!(bench.plotter.position(), StepPoint::new(carriage[0], carriage[1]));
        prop_assert_eq!(bench.plotter.status(bench.now).speed_mm_s, 0.0);
        if how == 1 {
            bench.stop_button(false);
        }
        for axis in Axis::BOTH {
            for end in [Direction::Minus, Direction::Plus] {
                let now = bench.now;
                bench.plotter.limit_switch(now, axis, end, false);
            }
        }
        bench.run_for(Duration::from_millis(10));
        bench.take_answers();
        // A limit switch that was met by no step stops nothing.
        let answers = bench.ask("\u{18}$X\nG90\nG1 X1 Y1 F1000\n");
        prop_assert!(answers.ends_with("ok\r\nok\r\nok\r\n"), "{}", answers);
        // The carriages, from the motors' steps alone.
        let mut gap = [0_i32; 2];
        let (mut motors, mut at) = (StepPoint::default(), [0; 2]);
        for made in &bench.made {
            let ways = [made.position.x - motors.x, made.position.y - motors.y];
            for (gap, way) in gap.iter_mut().zip(ways) {
                *gap = (*gap + way).clamp(0, play.into());
            }
            motors = made.position;
            at = [motors.x - gap[0], motors.y - gap[1]];
        }
        prop_assert_eq!(at, [from_mm(1.0, 87.58), from_mm(1.0, 87.58)]);
    }
}

#[test]
fn nothing_is_told_as_done_before_the_motors_are_there() {
    let mut bench = bench(settings());
    bench.send("G1 X10 F3600\nG4 P0.2\n");
    while !String::from_utf8_lossy(&bench.answers).ends_with("ok\r\nok\r\n") {
        let due = bench.plotter.due().unwrap();
        bench.run_to(due);
    }
    let last = bench.made.last().unwrap().at;
    assert!(stands_at(&bench, &settings(), [10.0, 0.0]));
    assert!(bench.now >= last + Duration::from_millis(200), "{:?} {last:?}", bench.now);

    // A hold: the pen goes up once the motors stand, and it is told until then that they do not.
    bench.ask("M3\n");
    bench.send("G1 X60 F3600\n");
    bench.run_for(Duration::from_millis(600));
    bench.send("!");
    let down_deg = settings().stored.pen_down_deg;
    while bench.plotter.status(bench.now).activity != (Activity::Hold { stands: true }) {
        let steps = bench.made.len();
        let pen_deg = bench.plotter.pen_deg();
        bench.run_for(Duration::from_millis(1));
        assert!(bench.made.len() == steps || pen_deg == down_deg);
    }
    let stands = bench.made.len();
    assert_eq!(bench.plotter.pen_deg(), settings().stored.pen_up_deg);
    bench.run_for(Duration::from_secs(5));
    assert_eq!(bench.made.len(), stands);
    bench.send("~");
    bench.run_out();
    assert!(stands_at(&bench, &settings(), [60.0, 0.0]) && bench.is_idle());
}

#[test]
fn the_speed_that_is_told_is_that_of_the_motors() {
    let mut bench = bench(settings());
    bench.send("M3\nG1 X60 Y30 F3000\n");
    bench.run_for(Duration::from_millis(900));
    let told = f64::from(bench.plotter.status(bench.now).speed_mm_s);
    assert!((told - 50.0).abs() < 1.0, "{told}");
    bench.run_out();
    assert_eq!(bench.plotter.status(bench.now).speed_mm_s, 0.0);
}

#[test]
fn settings_that_cannot_be_averaged_are_refused_in_words() {
    let refused = |settings: StepperPlotterSettings| {
        settings.checked::<plotter_motion::planner::AllModes>().unwrap_err().to_string()
    };
    insta::assert_snapshot!(refused(StepperPlotterSettings { laser: true, ..settings() }), @r#"the jerk is limited as a vector by averaging the steps, which does not go with a laser: limit it along the path, in a machine's file by planner.jerk_limit = "path""#);
    let exact = PlannerSettings { path: PathMode::Exact, ..settings().planner };
    insta::assert_snapshot!(refused(StepperPlotterSettings { planner: exact, ..settings() }), @"the jerk as a vector can be limited within a tolerance only: a corner that is passed through its vertex is a jump of the velocity");
    let little = PlannerSettings { jerk_mm_s3: Some(100.0), ..settings().planner };
    insta::assert_snapshot!(refused(StepperPlotterSettings { planner: little, ..settings() }), @"a jerk of 100 mm/s³ as a vector: at these speeds it must be at least 164, or more steps are averaged than there is room for; allow more jerk or less speed, or limit it along the path");
    insta::assert_snapshot!(settings().checked::<ExactOnly>().unwrap_err(), @"path asks for what is not built in: build with AllModes, or leave the path exact, the jerk without a limit, the axes without play and the laser away");
    insta::assert_snapshot!(plotter_motion::Planner::<16>::new(settings().planner).unwrap_err(), @r#"the jerk is limited as a vector by averaging the steps, which does not go with a planner by itself: limit it along the path, in a machine's file by planner.jerk_limit = "path""#);
    let motor = MotorScale { steps_per_mm: 80.0, inverted: false };
    let motors = Cartesian::new(motor, motor).unwrap();
    let ebb = EbbHostSettings { planner: settings().planner, ..EbbHostSettings::default() };
    let of_the_board = EbbHost::new(motors, ebb, drawing().into_iter()).err().unwrap();
    assert!(
        matches!(of_the_board, PlanError::Averaging { quantity: "the moves of an EBB" }),
        "{of_the_board}"
    );
    let laser = StepGenSettings { laser: true, ..StepGenSettings::default() };
    let estimated = Estimator::<16>::new(settings().planner, laser).unwrap_err();
    assert!(matches!(estimated, PlanError::Averaging { quantity: "a laser" }), "{estimated}");

    // What the host sets is looked at alike: 600 steps/mm of both motors at 90 mm/s for 52 ms.
    let finer = |value| Setting { number: 100, value }.checked(&settings());
    assert_eq!(finer(900.0), Err(SettingProblem::StepRate));
    assert_eq!(finer(600.0).unwrap().x_steps_per_mm, 600.0);
}

#[cfg(all(feature = "step-ahead", feature = "third-motor"))]
#[test]
fn a_third_axis_is_refused_and_two_halves_are() {
    use plotter_motion::firmware::StepperPlotter;
    use plotter_motion::firmware::stepper_plotter::{StepsAhead, ZAxis};
    let z = StepperPlotterSettings { z: Some(ZAxis::default()), ..settings() };
    insta::assert_snapshot!(z.checked::<plotter_motion::planner::ThreeAxes>().unwrap_err(), @r#"the jerk is limited as a vector by averaging the steps, which does not go with a third axis: limit it along the path, in a machine's file by planner.jerk_limit = "path""#);
    let plotter = StepperPlotter::new(settings(), SafetyGate::new(LimitSwitches::RELEASED, false)).unwrap();
    let mut memory = StepsAhead::<64>::new();
    insta::assert_snapshot!(plotter.split(&mut memory).err().unwrap(), @r#"the jerk is limited as a vector by averaging the steps, which does not go with two halves: limit it along the path, in a machine's file by planner.jerk_limit = "path""#);
}

#[test]
fn a_host_that_changes_the_limits_gets_them() {
    let mut bench = bench(settings());
    let slow = {
        bench.ask("G1 X30 F3600\n");
        bench.made.last().unwrap().at
    };
    let began = bench.now;
    bench.ask("$120=5000\n$121=5000\n");
    bench.ask("G1 X0 F3600\n");
    let fast = bench.made.last().unwrap().at - began;
    // The window is that of the tolerance either way, so the acceleration is the same.
    assert!(stands_at(&bench, &settings(), [0.0, 0.0]));
    assert!(fast.abs_diff(slow) < Duration::from_millis(5), "{fast:?} {slow:?}");
    let began = bench.now;
    bench.ask("$120=100\n$121=100\n");
    bench.ask("G1 X30 F3600\n");
    assert!(bench.made.last().unwrap().at - began > slow + Duration::from_millis(100));
    assert!(stands_at(&bench, &settings(), [30.0, 0.0]));
}

/// Homing steps by itself, at its own rates; what comes after it begins from rest.
#[test]
fn after_homing_the_same_lines_take_the_same_steps() {
    let settings = StepperPlotterSettings { homing: true, ..settings() };
    let lines = "M3\nG1 X8 Y3 F3000\nG1 X2 Y4\nM5\n";
    let steps = |bench: &mut Bench| {
        let before = bench.made.len();
        let from = bench.plotter.position();
        bench.ask(lines);
        let made = &bench.made[before..];
        let began = made[0].at;
        let way = |at: StepPoint| (at.x - from.x, at.y - from.y);
        made.iter().map(|made| (made.at - began, way(made.position))).collect::<Vec<_>>()
    };
    let mut bench = Bench::new(settings);
    bench.ask("");
    bench.ask("$X\n");
    let first = steps(&mut bench);
    bench.ask("G1 X20 Y20 F3000\n");
    let homed = bench.ask("$H\n");
    assert!(homed.contains("ok"), "{homed}");
    assert_eq!(bench.plotter.position(), StepPoint::default());
    let again = steps(&mut bench);
    // The same places, each within the rounding of its time to a microsecond.
    let when = |steps: &[(Duration, (i32, i32))], x: i32| steps.iter().find(|step| step.1.0 == x).unwrap().0;
    for x in [1, 50, 300, 600] {
        let apart = when(&first, x).abs_diff(when(&again, x));
        assert!(apart <= Duration::from_micros(3), "{apart:?} at {x}");
    }
    let (first, again) = (first.last().unwrap(), again.last().unwrap());
    assert!(first.0.abs_diff(again.0) <= Duration::from_micros(3), "{first:?} {again:?}");
    assert_eq!(first.1, again.1);
}
