//! Laws of planner and step generator over any tool path.

use crate::felt;
use crate::figure::Figure;
use crate::law_cases::cases;
use core::time::Duration;
use plotter_motion::kinematics::{Cartesian, MotorScale};
use plotter_motion::{
    PathMode, Pen, Planner, PlannerSettings, PlotOp, Point, StepGen, StepPair, StepPoint, Vec2,
    planner::{AccelLimit, Action, Course, Phase, PlanError, Shape, junction_speed},
    profile::ProfilePoint,
    stepgen::{MotorEvent, StepGenSettings},
    toolpath::from_mm,
};
use proptest::prelude::*;

static OF_LIMIT: Figure = Figure::of("of the limit");

const STEPS_PER_MM: f64 = 80.0;
/// What rounding may add to a limit.
const ROUNDING: f64 = 1e-6;

/// The least acceleration that a planner takes, of the pen and of a motor.
const LEAST_ACCEL_MM_S2: f64 = 1e-3;
/// What rounding may leave between the end of one phase and the begin of the next, mm, mm/s; and mm/s² where
/// jerk is limited.
const GAP_MM: f64 = 2e-6;
/// The same as a share of the length of a course: places on it are `f32`.
const GAP_SHARE: f64 = f32::EPSILON as f64;
const GAP_MM_S: f64 = 1e-3;
const GAP_MM_S2: f64 = 0.5;
const GAP_S: f64 = 1e-4;
/// What single precision may add to the acceleration, as a share of the limit: the roots and quotients of a
/// dozen numbers.
const FELT: f64 = 1e-3;
/// What half of a turn in `f32` may differ from, rad.
const TURN_RAD: f64 = 2.0 * f32::EPSILON as f64;
/// What the speeds at both ends of a phase are rounded by together, as a share of them: two last bits.
const SPEED_SHARE: f64 = 2.0 * f32::EPSILON as f64;
/// And to a velocity, as a share of the speed: directions of courses that are a micrometre long.
const JUMP_SHARE: f64 = 1e-3;

fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![0.0..100.0, 0.0..1.0, (0..20_i32).prop_map(f64::from)]
}

/// Operations as ways from the place before, long and short.
fn operation() -> impl Strategy<Value = (u8, f64, f64, Option<f64>)> {
    let feed = prop_oneof![3 => Just(None), 1 => (1.0..200.0).prop_map(Some)];
    (0..12_u8, coordinate(), coordinate(), feed)
}

fn path(parts: &[(u8, f64, f64, Option<f64>)]) -> Vec<PlotOp> {
    let mut at = Point::ORIGIN;
    let mut ops = Vec::new();
    for &(kind, a, b, feed_mm_s) in parts {
        let near = Point::new(at.x + (a - 50.0) / 40.0, at.y + (b - 50.0) / 40.0);
        let op = match kind {
            0 => PlotOp::Travel { to: Point::new(a, b) },
            1 => PlotOp::Draw { to: Point::new(a, b), feed_mm_s },
            2 => PlotOp::Draw { to: at, feed_mm_s },
            3 => {
                let (centre, sweep_rad) = (near, (b - 50.0) / 8.0);
                let to = centre + (at - centre).rotated(sweep_rad);
                PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s }
            }
            4 => PlotOp::Dwell { duration: Duration::from_millis(3) },
            5 => PlotOp::LaserPower { share: a / 100.0 },
            6 => PlotOp::SelectPen { pen: 2 },
            _ => PlotOp::Draw { to: near, feed_mm_s },
        };
        at = op.target().unwrap_or(at);
        ops.push(op);
    }
    ops
}

fn settings() -> impl Strategy<Value = PlannerSettings> {
    let tolerance = prop_oneof![Just(None), (1e-3..1.0).prop_map(Some)];
    let jerk = prop_oneof![Just(None), (1e2..1e6).prop_map(Some)];
    let allowance = prop_oneof![Just(0.0), 1e-4..0.2];
    let resolution = prop_oneof![Just(0.0), Just(0.005)];
    // Kinds of limits, and one motor beside the other: alike, and down to a millionth.
    let motors = (0..4_u8, prop_oneof![3 => Just(1.0), 3 => 1e-3..1.0, 1 => Just(1e-6)]);
    (tolerance, jerk, 1.0..500.0, 10.0..5000.0, (0.0..0.1, resolution, allowance), motors).prop_map(
        |(tolerance, jerk_mm_s3, speed_mm_s, accel_mm_s2, lengths, (kind, share))| {
            let (junction_deviation_mm, resolution_mm, allowance_mm) = lengths;
            let (strong, weak) = (accel_mm_s2, f64::max(share * accel_mm_s2, LEAST_ACCEL_MM_S2));
            let accel_limit = match kind {
                0 => AccelLimit::Axes { x_mm_s2: strong, y_mm_s2: weak },
                1 => AccelLimit::Belts { sum_mm_s2: weak, difference_mm_s2: strong },
                _ => AccelLimit::Vector,
            };
            PlannerSettings {
                path: tolerance
                    .map_or(PathMode::Exact, |path_tolerance_mm| PathMode::Tolerance { path_tolerance_mm }),
                speed_mm_s,
                travel_speed_mm_s: 1.5 * speed_mm_s,
                accel_mm_s2,
                accel_limit,
                jerk_mm_s3,
                junction_deviation_mm,
                resolution_mm,
                allowance_mm,
                #[cfg(feature = "averaged-steps")]
                jerk_limit: plotter_motion::planner::JerkLimit::Path,
            }
        },
    )
}

/// A polyline whose segments are of all lengths, and that turns a little or anyhow.
fn polyline() -> impl Strategy<Value = Vec<Point>> {
    let turn_rad = prop_oneof![4 => -0.1..0.1, 2 => -0.6..0.6, 1 => -3.2..3.2];
    let segment = (-3.0..1.0, turn_rad);
    let scale = -3.0..0.5;
    (prop::collection::vec(segment, 2..60), scale, any::<bool>()).prop_map(|(segments, scale, alike)| {
        let (mut at, mut direction_rad) = (Point::ORIGIN, 0.0);
        let mut places = vec![at];
        for (length, turn_rad) in segments {
            direction_rad += turn_rad;
            let exponent: f64 = if alike { scale + 0.1 * length } else { length };
            at += Vec2::new(10.0_f64.powf(exponent), 0.0).rotated(direction_rad);
            places.push(at);
        }
        places
    })
}

/// What the strongest motors can do in the direction that suits them best, mm/s².
fn most_accel(settings: &PlannerSettings) -> f64 {
    let both = |one: f64, other: f64| libm::hypot(one, other);
    match settings.accel_limit {
        AccelLimit::Vector => settings.accel_mm_s2,
        AccelLimit::Axes { x_mm_s2, y_mm_s2 } => both(x_mm_s2, y_mm_s2),
        AccelLimit::Belts { sum_mm_s2, difference_mm_s2 } => both(sum_mm_s2, difference_mm_s2),
    }
}

/// How far a place is from a course that begins at `from`, mm.
fn away_mm(course: &Course, from: Point, place: Point) -> f64 {
    let ends_mm = from.distance(place).min(course.to.distance(place));
    match course.shape {
        Shape::Arc { centre, sweep_rad } => {
            let sweep_rad = f64::from(sweep_rad);
            let (out, to) = (from - centre, place - centre);
            let angle_rad = libm::atan2(out.cross(to), out.dot(to)) * sweep_rad.signum();
            let angle_rad = angle_rad.rem_euclid(core::f64::consts::TAU);
            if angle_rad > sweep_rad.abs() {
                ends_mm
            } else {
                ends_mm.min((to.length() - out.length()).abs())
            }
        }
        _ => plotter_motion::Segment::new(from, course.to).distance(place),
    }
}

/// What a person at the machine does.
#[derive(Clone, Copy, Debug)]
enum Touch {
    /// A feed hold, which ends when the machine stands.
    Hold,
    /// Shares of the speeds with the pen down and up.
    Shares(f64, f64),
}

/// All actions of a path; `touches` says after how many of them something is done, and `told` hears each
/// action with the shares that held when it was taken.
fn actions_told<const N: usize>(
    settings: PlannerSettings,
    ops: &[PlotOp],
    touches: &[(usize, Touch)],
    told: impl FnMut(Action, (f64, f64)),
) -> Vec<Action> {
    actions_in_parts::<N>(settings, ops, touches, &[0], told)
}

/// The same by a planner that works ahead: `parts` says how often before each action.
fn actions_in_parts<const N: usize>(
    settings: PlannerSettings,
    ops: &[PlotOp],
    touches: &[(usize, Touch)],
    parts: &[u8],
    mut told: impl FnMut(Action, (f64, f64)),
) -> Vec<Action> {
    let mut turns = 0;
    let mut parts = parts.iter().cycle();
    let mut touches = touches.to_vec();
    let mut shares = (1.0, 1.0);
    let mut planner = Planner::<N>::new(settings).unwrap();
    let (mut actions, mut waiting, mut finished) = (Vec::new(), ops.iter().copied().peekable(), false);
    loop {
        // Before there is more to plan, before it is touched, and before the action is asked for.
        let mut work =
            |planner: &mut Planner<N>| (0..*parts.next().unwrap()).for_each(|_| _ = planner.prepare());
        work(&mut planner);
        while let Some(&op) = waiting.peek() {
            match planner.push(op) {
                Ok(()) => waiting.next(),
                Err(PlanError::Full) => break,
                Err(error) => panic!("{error} for {op:?}"),
            };
        }
        if !finished && waiting.peek().is_none() {
            finished = planner.finish().is_ok();
        }
        work(&mut planner);
        for &(_, touch) in touches.iter().filter(|(at, _)| *at == actions.len()) {
            match touch {
                Touch::Hold => planner.hold(),
                Touch::Shares(draw, travel) => {
                    planner.override_speeds(draw, travel);
                    shares = (draw, travel);
                }
            }
        }
        touches.retain(|(at, _)| *at != actions.len());
        work(&mut planner);
        match planner.next_action() {
            Some(action) => {
                told(action, shares);
                actions.push(action);
            }
            None if planner.is_held() => planner.resume(),
            None => {
                assert!(finished && planner.is_empty());
                return actions;
            }
        }
        turns += 1;
        assert!(turns < 1_000_000, "it comes to an end: {settings:?}, {} actions", actions.len());
    }
}

fn actions(settings: PlannerSettings, ops: &[PlotOp]) -> Vec<Action> {
    actions_told::<16>(settings, ops, &[], |_, _| {})
}

fn end_of(phase: Phase) -> ProfilePoint {
    phase.at(phase.duration_s.into())
}

fn check(settings: PlannerSettings, ops: &[PlotOp], touches: &[(usize, Touch)]) -> Result<(), TestCaseError> {
    let motor = MotorScale { steps_per_mm: STEPS_PER_MM, inverted: false };
    let step_settings =
        StepGenSettings { pen_settle: Duration::from_millis(1), ..StepGenSettings::default() };
    let mut steps = StepGen::new(Cartesian::new(motor, motor).unwrap(), step_settings);
    let mut at = Point::ORIGIN;
    let (mut motors, mut tick) = (StepPoint::default(), 0);
    let mut last: Option<Phase> = None;
    let mut done_mm = 0.0;
    let mut length_mm = 0.0;
    let mut cruise = 0.0;
    // What the speed is to become at the shares in force, and the direction before, of exact lines.
    let mut wanted = 0.0;
    let mut before_course: Option<(Course, Point)> = None;
    let mut velocity = Vec2::default();
    let mut all_shares = Vec::new();
    let actions = actions_told::<16>(settings, ops, touches, |_, shares| all_shares.push(shares));
    let overridden = touches.iter().any(|(_, touch)| matches!(touch, Touch::Shares(..)));
    for (action, shares) in actions.into_iter().zip(all_shares) {
        match action {
            Action::Course(course) => {
                let (course_mm, feed_mm_s) = (f64::from(course.length_mm), f64::from(course.feed_mm_s));
                prop_assert!(
                    length_mm - done_mm < 10.0 * GAP_MM + GAP_SHARE * length_mm,
                    "{done_mm} of {length_mm} mm"
                );
                let straight = at.distance(course.to);
                prop_assert!(straight <= course_mm * (1.0 + 1e-5) + GAP_MM, "{course:?} from {at:?}");
                if course.shape == Shape::Line {
                    prop_assert!((straight - course_mm).abs() <= 1e-5 * straight + GAP_MM);
                }
                let speed = last.map_or(0.0, |last| end_of(last).speed_mm_s);
                if let Some((before, from)) = before_course.filter(|(before, _)| {
                    settings.path == PathMode::Exact
                        && before.shape == Shape::Line
                        && course.shape == Shape::Line
                }) && straight > 0.0
                    && from.distance(before.to) > 0.0
                {
                    let (into, out) = (before.to - from, course.to - before.to);
                    let cos_theta = -into.dot(out) / (into.length() * out.length());
                    let most =
                        junction_speed(cos_theta, most_accel(&settings), settings.junction_deviation_mm);
                    prop_assert!(speed <= most * (1.0 + 1e-3) + 1e-2, "{speed} of {most} mm/s at {at:?}");
                }
                before_course = Some((course, at));
                at = course.to;
                (done_mm, length_mm, cruise) = (0.0, course_mm, feed_mm_s);
                let (share, most) = match course.pen {
                    Pen::Down => (shares.0, settings.speed_mm_s),
                    Pen::Up => (shares.1, settings.travel_speed_mm_s),
                };
                wanted = (cruise * share).min(most);
                if overridden {
                    cruise = most;
                }
            }
            Action::Phase(phase) => {
                // A feed hold waits for no more than a phase.
                prop_assert!(phase.duration_s > 0.0 && phase.duration_s <= 0.05, "{phase:?}");
                let (duration_s, begin) = (f64::from(phase.duration_s), phase.at(0.0));
                // A curve is passed in parts, whose ways are differences of such places.
                let is_line = before_course.is_some_and(|(course, _)| course.shape == Shape::Line);
                let parts = if is_line { 1.0 } else { 3.0 };
                prop_assert!(
                    (begin.distance_mm - done_mm).abs() < parts * (10.0 * GAP_MM + GAP_SHARE * length_mm),
                    "{phase:?} after {done_mm}"
                );
                let end = phase.at(duration_s);
                done_mm = end.distance_mm;
                if let Some((course, _)) = before_course {
                    let (share, most) = match course.pen {
                        Pen::Down => (shares.0, settings.speed_mm_s),
                        Pen::Up => (shares.1, settings.travel_speed_mm_s),
                    };
                    wanted = (f64::from(course.feed_mm_s) * share).min(most);
                }
                // Faster than is wanted is only a machine that brakes as hard as it may.
                if settings.jerk_mm_s3.is_none() && end.speed_mm_s > wanted * (1.0 + 1e-4) + GAP_MM_S {
                    // On a line that is all that the limit allows; in a curve what the turning leaves.
                    let least = before_course.filter(|_| is_line).map_or(0.1, |(course, from)| {
                        let (along, _) = felt::derivatives(&course, from, 0.0);
                        -(1.0 - 1e-2) / felt::share(along, &settings) + 0.1
                    });
                    let is_short = duration_s < GAP_S;
                    prop_assert!(is_short || begin.accel_mm_s2 <= least, "{phase:?}, {wanted} mm/s wanted");
                }
                for place in [phase.at(0.0), phase.at(0.5 * duration_s), end] {
                    let speed = place.speed_mm_s;
                    prop_assert!(
                        (-GAP_MM_S..=cruise * (1.0 + ROUNDING) + GAP_MM_S).contains(&speed),
                        "{phase:?}"
                    );
                    if let Some((course, from)) = before_course {
                        let (along, bend) = felt::derivatives(&course, from, place.distance_mm);
                        let accel = along * place.accel_mm_s2 + bend * (speed * speed);
                        let share = felt::share(accel, &settings);
                        // The speeds at its ends are rounded too.
                        let rounding_mm_s2 = SPEED_SHARE * speed / duration_s;
                        let rounding = felt::share(along * rounding_mm_s2, &settings);
                        OF_LIMIT.note((share - rounding).max(0.0));
                        prop_assert!(
                            share <= 1.0 + FELT + rounding,
                            "{share} of the limit: {phase:?} on {course:?} from {from:?}"
                        );
                    }
                }
                if let Some((course, from)) = before_course {
                    let velocity_at = |place: ProfilePoint| {
                        felt::derivatives(&course, from, place.distance_mm).0 * place.speed_mm_s
                    };
                    // Within a tolerance no velocity jumps.
                    let jump_mm_s = (velocity_at(begin) - velocity).length();
                    let is_smooth = settings.path != PathMode::Exact;
                    // A way straight back is one by the last bits of a direction.
                    let back_mm_s =
                        libm::sqrt(TURN_RAD * settings.accel_mm_s2 * settings.junction_deviation_mm);
                    let most_mm_s = GAP_MM_S + JUMP_SHARE * begin.speed_mm_s + 2.0 * back_mm_s;
                    prop_assert!(
                        !is_smooth || jump_mm_s <= most_mm_s,
                        "{jump_mm_s} mm/s at {from:?}: {course:?}"
                    );
                    velocity = velocity_at(end);
                }
                prop_assert!(
                    f64::from(phase.jerk_mm_s3).abs()
                        <= settings.jerk_mm_s3.unwrap_or(0.0) * (1.0 + ROUNDING)
                );
                let before = last.map_or((0.0, 0.0), |last| {
                    let end = end_of(last);
                    (end.speed_mm_s, end.accel_mm_s2)
                });
                prop_assert!((before.0 - begin.speed_mm_s).abs() < GAP_MM_S, "{before:?} then {phase:?}");
                if let Some(jerk_mm_s3) = settings.jerk_mm_s3 {
                    let gap = (before.1 - begin.accel_mm_s2).abs();
                    let most = GAP_MM_S2 + 1e-3 * settings.accel_mm_s2 + GAP_S * jerk_mm_s3;
                    prop_assert!(gap < most, "{before:?} then {phase:?}");
                }
                last = Some(phase);
            }
            _ => {
                let rest = last.map_or(0.0, |last| end_of(last).speed_mm_s);
                prop_assert!(rest < GAP_MM_S, "stands at {rest} mm/s for {action:?}");
            }
        }
        steps.push(action).unwrap();
        while let Some(event) = steps.next_event() {
            prop_assert!(event.tick >= tick, "time goes on");
            tick = event.tick;
            if let MotorEvent::Step(StepPair { x, y }) = event.event {
                motors = StepPoint::new(motors.x + i32::from(x), motors.y + i32::from(y));
            }
        }
        prop_assert_eq!(motors, steps.steps());
    }
    let rest = last.map_or(0.0, |last| end_of(last).speed_mm_s);
    prop_assert!(rest < GAP_MM_S, "ends at {} mm/s", rest);
    let end = ops.iter().rev().find_map(|op| op.target()).unwrap_or_default();
    prop_assert_eq!(motors, StepPoint::new(from_mm(end.x, STEPS_PER_MM), from_mm(end.y, STEPS_PER_MM)));
    Ok(())
}

fn touch() -> impl Strategy<Value = Touch> {
    prop_oneof![
        1 => Just(Touch::Hold),
        3 => (0.1..2.0, 0.25..1.0).prop_map(|(draw, travel)| Touch::Shares(draw, travel)),
    ]
}

#[test]
fn a_way_nearly_straight_back_is_a_stop_within_a_tolerance() {
    // The second line goes back 3e-5 rad beside the first one: by junction deviation it began with 0.0024
    // mm/s.
    let draw = |x: f64, y: f64| PlotOp::Draw { to: Point::new(x, y), feed_mm_s: None };
    let ops = [draw(-1.243_405_506, 0.843_971_4), draw(-0.279_678_093, 0.189_825_512)];
    let settings = PlannerSettings {
        path: PathMode::Tolerance { path_tolerance_mm: 0.001 },
        speed_mm_s: 1.0,
        travel_speed_mm_s: 1.5,
        accel_mm_s2: 10.0,
        accel_limit: AccelLimit::Axes { x_mm_s2: 10.0, y_mm_s2: 10.0 },
        jerk_mm_s3: Some(100.0),
        junction_deviation_mm: 0.039_348_899,
        resolution_mm: 0.0,
        allowance_mm: 0.0,
        #[cfg(feature = "averaged-steps")]
        jerk_limit: plotter_motion::planner::JerkLimit::Path,
    };
    check(settings, &ops, &[]).unwrap();
}

proptest! {
    #![proptest_config(cases(256))]
    #[test]
    fn any_path_is_walked_to_its_end_within_the_limits(
        parts in prop::collection::vec(operation(), 1..60),
        settings in settings(),
    ) {
        check(settings, &path(&parts), &[])?;
    }

    #[test]
    fn an_allowance_is_kept_both_ways(places in polyline(), allowance_mm in 1e-3..0.1) {
        /// What `f32` leaves of places as far from each other as these, mm.
        const SINGLE_MM: f64 = 2e-5;
        /// Between vertices an arc is compared with its chord, which may be a little longer than the
        /// drawing's.
        const SLANTED: f64 = 1.02;
        let most_mm = allowance_mm + SINGLE_MM;
        let settings = PlannerSettings { allowance_mm, resolution_mm: 0.0, ..PlannerSettings::default() };
        let ops: Vec<PlotOp> =
            places.iter().skip(1).map(|&to| PlotOp::Draw { to, feed_mm_s: None }).collect();
        let mut courses = Vec::new();
        let mut at = Point::ORIGIN;
        for action in actions(settings, &ops) {
            if let Action::Course(course) = action {
                courses.push((at, course));
                at = course.to;
            }
        }
        let last = places.last().copied().unwrap_or_default();
        prop_assert!(at.distance(last) < SINGLE_MM, "ends at {at:?} for {last:?}");
        for &place in &places {
            let away = courses.iter().map(|(from, course)| away_mm(course, *from, place)).fold(f64::INFINITY, f64::min);
            prop_assert!(away <= most_mm, "{away} of {allowance_mm} mm: {place:?} by {courses:?}");
        }
        let drawing: Vec<_> =
            places.windows(2).map(|ends| plotter_motion::Segment::new(ends[0], ends[1])).collect();
        for (from, course) in &courses {
            for place in felt::places(course, *from, 20) {
                let away = drawing.iter().map(|line| line.distance(place)).fold(f64::INFINITY, f64::min);
                prop_assert!(away <= SLANTED * most_mm, "{away} of {allowance_mm} mm: {course:?} from {from:?}");
            }
        }
    }

    #[test]
    fn a_tolerance_is_kept_both_ways(
        places in polyline(),
        path_tolerance_mm in 1e-3..0.2,
        speed_mm_s in 1.0..300.0,
        jerk_mm_s3 in prop_oneof![3 => Just(None), 1 => Just(Some(20_000.0))],
    ) {
        /// What `f32` leaves of places as far from each other as these, mm.
        const SINGLE_MM: f64 = 2e-5;
        let path = PathMode::Tolerance { path_tolerance_mm };
        let settings =
            PlannerSettings { path, speed_mm_s, jerk_mm_s3, resolution_mm: 0.0, ..PlannerSettings::default() };
        let most_mm = path_tolerance_mm * (1.0 + ROUNDING) + SINGLE_MM;
        let ops: Vec<PlotOp> =
            places.iter().skip(1).map(|&to| PlotOp::Draw { to, feed_mm_s: None }).collect();
        let (mut at, mut pen) = (Point::ORIGIN, Vec::new());
        for action in actions(settings, &ops) {
            if let Action::Course(course) = action {
                pen.extend(felt::places(&course, at, 24));
                at = course.to;
            }
        }
        let nearest = |lines: &[Point], place: Point| {
            let line = |ends: &[Point]| plotter_motion::Segment::new(ends[0], ends[1]).distance(place);
            lines.windows(2).map(line).fold(f64::INFINITY, f64::min)
        };
        for &place in &places {
            let away = nearest(&pen, place);
            prop_assert!(away <= most_mm, "{place:?} is {away} mm from the pen, {path_tolerance_mm} mm are allowed");
        }
        for &place in &pen {
            let away = nearest(&places, place);
            prop_assert!(away <= most_mm, "the pen is {away} mm off at {place:?}, {path_tolerance_mm} mm are allowed");
        }
    }

    #[test]
    fn a_held_path_goes_on_where_it_stopped(
        parts in prop::collection::vec(operation(), 1..40),
        settings in settings(),
        hold in prop::collection::vec(0..200_usize, 1..6),
    ) {
        let touches: Vec<_> = hold.into_iter().map(|at| (at, Touch::Hold)).collect();
        check(settings, &path(&parts), &touches)?;
    }

    #[test]
    fn speeds_are_overridden_within_the_limits(
        parts in prop::collection::vec(operation(), 1..40),
        settings in settings(),
        touches in prop::collection::vec((0..200_usize, touch()), 1..12),
    ) {
        check(settings, &path(&parts), &touches)?;
    }

    #[test]
    fn work_that_is_done_ahead_in_parts_changes_no_action(
        ops in prop::collection::vec(operation(), 1..20),
        settings in settings(),
        jerk_mm_s3 in 1e2..1e6,
        touches in prop::collection::vec((0..200_usize, touch()), 0..6),
        parts in prop::collection::vec(prop_oneof![0..6_u8, Just(100)], 1..30),
    ) {
        let settings = PlannerSettings { jerk_mm_s3: Some(jerk_mm_s3), ..settings };
        let ops = path(&ops);
        let at_once = actions_told::<16>(settings, &ops, &touches, |_, _| {});
        let in_parts = actions_in_parts::<16>(settings, &ops, &touches, &parts, |_, _| {});
        prop_assert_eq!(at_once, in_parts);
    }

    #[test]
    fn a_longer_look_ahead_is_never_slower(
        parts in prop::collection::vec(operation(), 1..80),
        settings in settings(),
    ) {
        let settings = PlannerSettings { jerk_mm_s3: None, ..settings };
        let time_s = |actions: Vec<Action>| -> f64 {
            actions.iter().map(|action| if let Action::Phase(phase) = action { f64::from(phase.duration_s) } else { 0.0 }).sum()
        };
        let long = time_s(actions_told::<512>(settings, &path(&parts), &[], |_, _| {}));
        let short = time_s(actions(settings, &path(&parts)));
        prop_assert!(long <= short * (1.0 + ROUNDING), "{long} s against {short} s");
    }
}

/// Arcs smaller than a step and as large as the farthest place, tolerances far below a step and far above the
/// drawing, limits of the least and the greatest size.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn odd_arcs_tolerances_and_limits_are_planned_within_the_limits() {
    let arc = |radius_mm: f64, sweep_rad: f64| {
        let from = Point::new(1.0, 1.0);
        let centre = from + Vec2::new(radius_mm, 0.0);
        let to = centre + (from - centre).rotated(sweep_rad);
        let draw = |to| PlotOp::Draw { to, feed_mm_s: None };
        [PlotOp::Travel { to: from }, PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s: None }, draw(from)]
    };
    for (radius_mm, sweep_rad) in
        [(1e-9, 6.0), (1e-4, 6.2), (0.004, -3.0), (0.02, 1e-6), (5e3, 1e-3), (9.9e6, 1e-6), (9.9e6, -1e-9)]
    {
        for path in [1e-6, 1e-3, 100.0]
            .map(|path_tolerance_mm| PathMode::Tolerance { path_tolerance_mm })
            .into_iter()
            .chain([PathMode::Exact])
        {
            for (accel_mm_s2, share) in [(LEAST_ACCEL_MM_S2, 1.0), (1e3, 1e-6), (1e7, 1.0)] {
                for accel_limit in [
                    AccelLimit::Vector,
                    AccelLimit::Axes {
                        x_mm_s2: accel_mm_s2,
                        y_mm_s2: (share * accel_mm_s2).max(LEAST_ACCEL_MM_S2),
                    },
                ] {
                    let settings =
                        PlannerSettings { path, accel_mm_s2, accel_limit, ..PlannerSettings::default() };
                    let told = check(settings, &arc(radius_mm, sweep_rad), &[]);
                    assert!(told.is_ok(), "radius {radius_mm} mm, {sweep_rad} rad, {settings:?}: {told:?}");
                }
            }
        }
    }
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let limit = AccelLimit::Axes { x_mm_s2: 100.0, y_mm_s2: wrong };
        let refused =
            Planner::<16>::new(PlannerSettings { accel_limit: limit, ..PlannerSettings::default() });
        let said = refused.err().map(|error| error.to_string()).unwrap_or_default();
        assert!(said.contains("accel_limit"), "{wrong}: {said}");
    }
}
