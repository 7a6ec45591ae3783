//! Laws of a drawing as commands of an EBB, by the board's own arithmetic.

use crate::law_cases::cases;
use plotter_motion::kinematics::{BeltSigns, CoreXy, Kinematics};
use plotter_motion::planner::{Action, PathMode};
use plotter_motion::protocol::ebb::{
    Accumulators, EbbCommand, EbbDialect, EbbEvent, EbbMotion, EbbMotionSettings, LowLevelMove, MotorRate,
    TICKS_PER_MS,
};
use plotter_motion::{Pen, Planner, PlannerSettings, PlotOp, Point, Segment, StepPoint, toolpath::circle};
use proptest::prelude::*;
use std::time::Duration;

/// Sixteenths of a step to the millimetre of an AxiDraw.
const STEPS_PER_MM: f64 = 80.0;

pub(crate) fn axidraw() -> CoreXy {
    CoreXy::new(BeltSigns::TrackingEquations, STEPS_PER_MM).unwrap()
}

/// What became of a drawing.
pub(crate) struct Made {
    pub(crate) commands: Vec<EbbCommand>,
    /// Steps of both motors before each tick.
    pub(crate) places: Vec<StepPoint>,
    pens: Vec<Pen>,
    /// How long the planner's motion takes, s, and how often it begins from rest.
    pub(crate) planned_s: f64,
    most_off: f64,
    pub(crate) end: StepPoint,
}

pub(crate) fn make(ops: &[PlotOp], planner: PlannerSettings, settings: EbbMotionSettings) -> Made {
    let mut planner = Planner::<64>::new(planner).unwrap();
    let mut motion = EbbMotion::new(axidraw(), settings);
    let mut commands = Vec::new();
    let mut planned_s = 0.0;
    let mut ops = ops.iter();
    let mut is_over = false;
    loop {
        while let Some(event) = motion.next_event() {
            if let EbbEvent::Command(command) = event {
                commands.push(command);
            }
        }
        while planner.has_room() && !is_over {
            match ops.next() {
                Some(&op) => planner.push(op).unwrap(),
                None => {
                    planner.finish().unwrap();
                    is_over = true;
                }
            }
        }
        match planner.next_action() {
            Some(action) => {
                match action {
                    Action::Phase(phase) => planned_s += f64::from(phase.duration_s),
                    Action::Dwell(time) => planned_s += time.as_secs_f64(),
                    _ => {}
                }
                motion.push(action).unwrap();
            }
            None => break,
        }
    }
    motion.rest();
    while let Some(event) = motion.next_event() {
        if let EbbEvent::Command(command) = event {
            commands.push(command);
        }
    }
    let (places, pens) = carry_out(&commands);
    Made { commands, places, pens, planned_s, most_off: motion.most_off(), end: motion.made() }
}

/// What the board does: where its motors are before each tick, and the pen.
fn carry_out(commands: &[EbbCommand]) -> (Vec<StepPoint>, Vec<Pen>) {
    let mut board = Accumulators::default();
    let (mut places, mut pens) = (Vec::new(), Vec::new());
    let (mut at, mut pen) = (StepPoint::default(), Pen::Up);
    for &command in commands {
        let mut wait = 0;
        match command {
            EbbCommand::LowLevel(of) => board.start(of),
            EbbCommand::Constant { duration_ms, steps: [0, 0] } => wait = duration_ms * TICKS_PER_MS,
            EbbCommand::Constant { duration_ms, steps } => {
                let motors = steps.map(|steps| MotorRate::constant(duration_ms, steps));
                board.start(LowLevelMove { motors, clear: 0 });
            }
            EbbCommand::Pen { pen: to, duration_ms } => {
                pen = to;
                wait = u32::from(duration_ms) * TICKS_PER_MS;
            }
            other => panic!("{other:?}"),
        }
        while board.is_running() || wait > 0 {
            places.push(at);
            pens.push(pen);
            let step = board.tick();
            at = StepPoint::new(at.x + i32::from(step.x), at.y + i32::from(step.y));
            wait = wait.saturating_sub(1);
        }
    }
    places.push(at);
    pens.push(pen);
    (places, pens)
}

/// How far the pen was at most from the path, mm.
fn beside(made: &Made, ops: &[PlotOp]) -> f64 {
    let mut at = Point::ORIGIN;
    let segments: Vec<Segment> = ops
        .iter()
        .filter_map(|op| op.target())
        .map(|to| {
            let segment = Segment::new(at, to);
            at = to;
            segment
        })
        .collect();
    let mut first = 0;
    let mut most: f64 = 0.0;
    let mut last = None;
    for &place in &made.places {
        if last == Some(place) {
            continue;
        }
        last = Some(place);
        let pen = axidraw().point_at(place.into());
        // The path is followed in its order: the next segment has begun near its corner, where it is as near.
        while let [this, next, ..] = segments[first..]
            && pen.distance(this.to) <= 0.1
            && next.distance(pen) <= this.distance(pen) + 0.02
        {
            first += 1;
        }
        let near = &segments[first.saturating_sub(4)..=first];
        let distance = near.iter().map(|segment| segment.distance(pen)).fold(f64::INFINITY, f64::min);
        most = most.max(distance);
    }
    most
}

/// Ticks until a motor has made its steps.
fn ticks_of(motor: MotorRate) -> u32 {
    let mut board = Accumulators::default();
    board.start(LowLevelMove { motors: [motor, MotorRate::default()], clear: 3 });
    let mut ticks = 0;
    while board.is_running() && motor.steps != 0 {
        board.tick();
        ticks += 1;
    }
    ticks
}

fn settings(accel_mm_s2: f64, speed_mm_s: f64, path: PathMode) -> PlannerSettings {
    PlannerSettings {
        path,
        speed_mm_s,
        travel_speed_mm_s: 2.0 * speed_mm_s,
        accel_mm_s2,
        ..PlannerSettings::default()
    }
}

fn motion(dialect: EbbDialect) -> EbbMotionSettings {
    EbbMotionSettings { dialect, pen_settle: Duration::from_millis(20), ..EbbMotionSettings::default() }
}

fn strokes() -> impl Strategy<Value = Vec<PlotOp>> {
    let place = (0..3_000_u32, 0..3_000_u32)
        .prop_map(|(x, y)| Point::new(f64::from(x) / 100.0, f64::from(y) / 100.0));
    proptest::collection::vec((place, 0..4_u8), 1..24).prop_map(|places| {
        let mut ops: Vec<PlotOp> = places
            .into_iter()
            .map(|(to, kind)| match kind {
                0 => PlotOp::Travel { to },
                _ => PlotOp::Draw { to, feed_mm_s: None },
            })
            .collect();
        // Of travels one after the other the planner makes one.
        ops.dedup_by(|next, before| {
            let both = matches!((&next, &before), (PlotOp::Travel { .. }, PlotOp::Travel { .. }));
            if both {
                *before = *next;
            }
            both
        });
        ops
    })
}

/// The end of a drawing in steps.
fn end_of(ops: &[PlotOp]) -> StepPoint {
    axidraw().steps_at(ops.iter().rev().find_map(|op| op.target()).unwrap_or_default())
}

proptest! {
    #![proptest_config(cases(100))]

    #[test]
    fn the_end_is_exact_and_the_pen_stays_on_its_path(
        ops in strokes(),
        accel_mm_s2 in 100.0..5_000.0_f64,
        speed_mm_s in 5.0..100.0_f64,
        is_low_level in any::<bool>(),
    ) {
        let dialect = if is_low_level { EbbDialect::LowLevel } else { EbbDialect::Constant };
        let made = make(&ops, settings(accel_mm_s2, speed_mm_s, PathMode::Exact), motion(dialect));
        prop_assert_eq!(made.end, end_of(&ops));
        prop_assert_eq!(*made.places.last().unwrap(), end_of(&ops));
        prop_assert_eq!(*made.pens.last().unwrap(), Pen::Up);
        // A quarter more than a step of both motors, and a corner that is passed within a millisecond. At
        // constant speeds they are not as near where they speed up within 4 ms.
        let near_mm = if is_low_level { 1.25 } else { 2.5 } / STEPS_PER_MM + 0.01;
        let beside_mm = beside(&made, &ops);
        prop_assert!(beside_mm <= near_mm, "{beside_mm} mm, of its time {} steps", made.most_off);
    }

    #[test]
    fn it_takes_as_long_as_planned(ops in strokes(), accel_mm_s2 in 100.0..5_000.0_f64) {
        let made = make(&ops, settings(accel_mm_s2, 50.0, PathMode::Exact), motion(EbbDialect::LowLevel));
        let lasts = made.places.len() as f64 / 25_000.0;
        let pens = made.commands.iter().filter(|command| matches!(command, EbbCommand::Pen { .. })).count();
        let moving = lasts - 0.02 * pens as f64;
        // Each stroke and each travel takes up to 4 ms more; each command up to a few ticks less.
        let runs = pens as f64 + 1.0 + ops.len() as f64 / 4.0; // a corner up to one
        let less = made.commands.len() as f64 * 40e-6 * 4.0;
        prop_assert!(moving <= made.planned_s + 0.0041 * runs, "{moving} s for {} s", made.planned_s);
        prop_assert!(moving >= made.planned_s - less - 1e-3, "{moving} s for {} s", made.planned_s);
    }

    #[test]
    fn no_motor_is_asked_for_more_than_planned(
        ops in strokes(),
        accel_mm_s2 in 300.0..5_000.0_f64,
        speed_mm_s in 5.0..100.0_f64,
    ) {
        let planner = settings(accel_mm_s2, speed_mm_s, PathMode::Exact);
        // From rest to rest: a corner is a jump of the speed.
        let lift = |op: &PlotOp| [*op, PlotOp::Travel { to: op.target().unwrap() }];
        let ops: Vec<PlotOp> = ops.iter().flat_map(lift).collect();
        let made = make(&ops, planner, motion(EbbDialect::LowLevel));
        // A motor moves x + y: √2 of what the pen does along a diagonal.
        let planned = |on_path: f64| 2_f64.sqrt() * on_path * STEPS_PER_MM;
        let (most_speed, most_accel) = (planned(planner.travel_speed_mm_s), planned(accel_mm_s2));
        for command in &made.commands {
            let EbbCommand::LowLevel(of) = command else { continue };
            let ticks = of.motors.map(ticks_of);
            let ms = ticks[0].max(ticks[1]).div_ceil(TICKS_PER_MS);
            for (motor, ticks) in of.motors.iter().zip(ticks) {
                let rate = |rate: f64| rate / 2_f64.powi(31) * 25_000.0;
                let accel = rate(f64::from(motor.accel)) * 25_000.0;
                let beyond = Beyond::new(ms, made.most_off, accel.abs() + most_accel);
                prop_assert!(accel.abs() <= most_accel + beyond.accel, "{accel} of {most_accel} steps/s²: {command}");
                let begins = rate(f64::from(motor.rate));
                let ends = begins + accel * f64::from(ticks) / 25_000.0;
                // The rate of the first tick and of the last one are half a tick's change off the ends'.
                let most = most_speed + beyond.speed + accel.abs() / 25_000.0;
                prop_assert!(begins <= most && ends <= most, "{begins} to {ends} of {most} steps/s: {command}");
            }
        }
    }
}

/// By how much a motor may be faster, and change its speed by more, than what it follows, since it is within
/// a distance of it: E. Landau, "Einige Ungleichungen für zweimal differentiirbare Funktionen" (1913).
///
/// A move leads from whole step to whole step: its ends are up to a step off each. Besides that even part the
/// motor is `most_off` less a step off at the samples, one a millisecond, and not at all at both ends: call
/// this r, |r| ≤ R.
struct Beyond {
    /// Steps/s.
    speed: f64,
    /// Steps/s².
    accel: f64,
}

impl Beyond {
    /// In a move of so many milliseconds in which |r″| is at most `bend` steps/s².
    fn new(ms: u32, most_off: f64, bend: f64) -> Self {
        let rest = most_off - 1.0;
        let seconds = |ms: u32| f64::from(ms) / 1_000.0;
        // The second divided difference of r over both ends and the sample in the middle is half of a mean
        // of r″. An acceleration is sent in whole numbers, less than one a tick² off.
        let middle = (ms / 2).max(1);
        let accel = 2.0 * rest / (seconds(middle) * seconds((ms - middle).max(1)))
            + 25_000.0_f64.powi(2) / 2_f64.powi(31);
        // r(h) = r′(0) h + r″ h²/2 at each sample, and the same from the other end.
        let bent = |ms: u32| rest / seconds(ms) + 0.5 * bend * seconds(ms);
        let speed = 2.0 / seconds(ms) + (1..=ms).map(bent).fold(f64::INFINITY, f64::min);
        Self { speed, accel }
    }
}

#[test]
fn a_circle_of_short_chords_is_as_few_commands_as_the_machine_needs() {
    let mut ops = circle(Point::new(30.0, 30.0), 10.0, 2_000).collect::<Vec<_>>();
    ops.push(PlotOp::Travel { to: Point::ORIGIN });
    for (path, most_commands) in
        [(PathMode::Exact, 110), (PathMode::Tolerance { path_tolerance_mm: 0.02 }, 110)]
    {
        let made = make(&ops, settings(2_000.0, 50.0, path), motion(EbbDialect::LowLevel));
        assert_eq!(*made.places.last().unwrap(), StepPoint::default());
        let beside_mm = beside(&made, &ops);
        println!("{path:?}: {} commands, {beside_mm:.4} mm, {:.2} steps", made.commands.len(), made.most_off);
        assert!(made.most_off <= 1.26, "{path:?}: {} steps", made.most_off);
        assert!(beside_mm <= 0.03 + 1.25 / STEPS_PER_MM, "{path:?}: {beside_mm} mm");
        assert!(made.commands.len() <= most_commands, "{path:?}: {}", made.commands.len());
    }
}
