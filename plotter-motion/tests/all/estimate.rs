//! The time of drawings without their steps is that of the steps.

use crate::law_cases::cases;
use crate::{auditor, drawings, real_files};
use core::time::Duration;
use plotter_motion::{
    PathMode, Pen, PlannerSettings, PlotOp, Point, gcode, hpgl,
    planner::Action,
    stepgen::{Estimator, PlotTime, StepGenSettings},
};
use proptest::prelude::*;
use std::time::Instant;

const STEPS_PER_MM: f64 = 100.0;

/// What the steps of a drawing take: the tick at which the last action ends, of a microsecond; the ticks in
/// motion; strokes.
fn stepped<const N: usize>(
    settings: PlannerSettings,
    timing: StepGenSettings,
    ops: &[PlotOp],
) -> (u64, u64, u64) {
    let (mut motion, mut strokes, mut pen) = (0, 0, Pen::Up);
    let mut before: Option<(u64, bool)> = None;
    let mut take = |tick: u64, is_phase: bool| {
        if let Some((began, true)) = before.replace((tick, is_phase)) {
            motion += tick - began;
        }
    };
    let end = auditor::run::<N>(
        settings,
        timing,
        STEPS_PER_MM,
        ops,
        |action, tick, _| {
            take(tick, matches!(action, Action::Phase(_)));
            let now = match action {
                Action::Course(course) => course.pen,
                Action::SelectPen(_) | Action::NewPage => Pen::Up,
                _ => pen,
            };
            strokes += u64::from(now == Pen::Down && pen == Pen::Up);
            pen = now;
        },
        |_, _| {},
    );
    take(end, false);
    (end, motion, strokes)
}

fn estimated<const N: usize>(settings: PlannerSettings, timing: StepGenSettings, ops: &[PlotOp]) -> PlotTime {
    let mut estimator = Estimator::<N>::new(settings, timing).unwrap();
    for op in ops {
        estimator.push(*op).unwrap();
    }
    estimator.finish().unwrap()
}

fn check<const N: usize>(what: &str, settings: PlannerSettings, timing: StepGenSettings, ops: &[PlotOp]) {
    let (end, motion, strokes) = stepped::<N>(settings, timing, ops);
    let found = estimated::<N>(settings, timing, ops);
    let micros = |time: Duration| u64::try_from(time.as_micros()).unwrap();
    assert_eq!(
        (micros(found.total), micros(found.motion), found.strokes),
        (end, motion, strokes),
        "{what}: {found:?}"
    );
}

fn modes() -> [(&'static str, PlannerSettings); 4] {
    let exact = PlannerSettings::default();
    let tolerance = PlannerSettings { path: PathMode::Tolerance { path_tolerance_mm: 0.05 }, ..exact };
    let curved = |settings| PlannerSettings { jerk_mm_s3: Some(20_000.0), ..settings };
    [
        ("exact", exact),
        ("tolerance", tolerance),
        ("exact s-curve", curved(exact)),
        ("tolerance s-curve", curved(tolerance)),
    ]
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn drawings_take_what_their_steps_take_to_the_tick() {
    let built = [drawings::spiral(2), drawings::hatch(6), drawings::zigzag(100), drawings::circle()];
    for drawing in built.into_iter().chain([drawings::arcs()]) {
        for (mode, settings) in modes() {
            let what = format!("{} {mode}", drawing.name);
            check::<16>(&what, settings, StepGenSettings::default(), &drawing.ops);
            check::<64>(&what, settings, StepGenSettings::default(), &drawing.ops);
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn files_take_what_their_steps_take_to_the_tick() {
    for kind in ["hpgl", "gcode"] {
        for file in real_files::all(kind) {
            let text = std::fs::read(&file).unwrap();
            let ops: Vec<PlotOp> = if kind == "hpgl" {
                hpgl::plot_ops(&text).flatten().collect()
            } else {
                gcode::plot_ops(&text).flatten().collect()
            };
            for (mode, settings) in modes() {
                let what = format!("{} {mode}", file.display());
                check::<64>(&what, settings, StepGenSettings::default(), &ops);
            }
        }
    }
}

/// A drawing of everything there is.
fn ops() -> impl Strategy<Value = Vec<PlotOp>> {
    let place = || (0.0..60.0, 0.0..60.0).prop_map(|(x, y)| Point::new(x, y));
    let feed = || prop_oneof![3 => Just(None), 1 => (0.5..200.0).prop_map(Some)];
    let near = || (-0.3..0.3, -0.3..0.3);
    // A line, as far as any or much shorter, from where the pen is: see below.
    let op = prop_oneof![
        3 => place().prop_map(|to| PlotOp::Travel { to }),
        6 => (place(), feed()).prop_map(|(to, feed_mm_s)| PlotOp::Draw { to, feed_mm_s }),
        6 => (near(), feed()).prop_map(|((x, y), feed_mm_s)| {
            // Told apart by a sweep of 0, which is replaced below.
            PlotOp::DrawArc { centre: Point::new(x, y), sweep_rad: 0.0, to: Point::ORIGIN, feed_mm_s }
        }),
        3 => (place(), -6.25..6.25).prop_map(|(centre, sweep_rad)| {
            PlotOp::DrawArc { centre, sweep_rad, to: Point::ORIGIN, feed_mm_s: None }
        }),
        1 => (0_u64..900_000_000).prop_map(|nanos| PlotOp::Dwell { duration: Duration::from_nanos(nanos) }),
        1 => (0_u8..4).prop_map(|pen| PlotOp::SelectPen { pen }),
        1 => Just(PlotOp::NewPage),
        1 => (0.0..=1.0).prop_map(|share| PlotOp::LaserPower { share }),
    ];
    prop::collection::vec(op, 1..80).prop_map(|mut ops| {
        let mut at = Point::ORIGIN;
        for op in &mut ops {
            if let PlotOp::DrawArc { centre, sweep_rad, feed_mm_s, .. } = *op {
                *op = if sweep_rad == 0.0 {
                    PlotOp::Draw { to: Point::new(at.x + centre.x, at.y + centre.y), feed_mm_s }
                } else {
                    let to = centre + (at - centre).rotated(sweep_rad);
                    PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s }
                };
            }
            at = op.target().unwrap_or(at);
        }
        ops
    })
}

proptest! {
    #![proptest_config(cases(48))]

    #[test]
    fn any_drawing_takes_what_its_steps_take(ops in ops(), laser: bool, settle_us in 0_u64..300_000) {
        let timing = StepGenSettings {
            pen_settle: Duration::from_micros(settle_us),
            laser,
            ..StepGenSettings::default()
        };
        for (mode, settings) in modes() {
            check::<16>(mode, settings, timing, &ops);
            check::<64>(mode, settings, timing, &ops);
        }
    }
}

#[test]
fn a_line_of_centuries_is_told_at_once() {
    // 10 m at a millionth of a mm/s: 10^10 s, which nobody could count in phases of 47 ms.
    let ops = [PlotOp::Draw { to: Point::new(10_000.0, 0.0), feed_mm_s: Some(1e-6) }];
    let found = estimated::<16>(PlannerSettings::default(), StepGenSettings::default(), &ops);
    // Single precision says each of its numbers to 6e-8 of itself.
    assert!((found.motion.as_secs_f64() / 1e10 - 1.0).abs() < 2e-7, "{found:?}");
}

#[test]
fn an_estimator_has_all_its_memory_in_itself() {
    // 64 blocks of 64 bytes, and what holds at its ends.
    assert!(size_of::<Estimator<64>>() < 5 * 1024, "{}", size_of::<Estimator<64>>());
}

#[test]
fn what_cannot_be_planned_is_told_and_the_rest_counts() {
    let mut estimator = Estimator::<16>::new(PlannerSettings::default(), StepGenSettings::default()).unwrap();
    let draw = |x| PlotOp::Draw { to: Point::new(x, 0.0), feed_mm_s: None };
    estimator.push(draw(10.0)).unwrap();
    let refused = estimator.push(draw(f64::NAN)).unwrap_err();
    assert!(refused.to_string().contains("coordinates must be finite"), "{refused}");
    let found = estimator.finish().unwrap();
    assert_eq!((found.courses, found.draw_mm), (1, 10.0));
    // More may come.
    estimator.push(draw(0.0)).unwrap();
    assert_eq!(estimator.finish().unwrap().draw_mm, 20.0);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn it_is_ten_times_as_fast_as_the_steps() {
    let ops = drawings::spiral(20).ops;
    let (settings, timing) = (PlannerSettings::default(), StepGenSettings::default());
    let time = |run: &dyn Fn()| {
        let begun = Instant::now();
        run();
        begun.elapsed()
    };
    // By turns, and the least of many: other tests run beside this one.
    let (mut by_steps, mut by_plan) = (Duration::MAX, Duration::MAX);
    for _ in 0..20 {
        by_steps = by_steps.min(time(&|| {
            stepped::<64>(settings, timing, &ops);
        }));
        by_plan = by_plan.min(time(&|| {
            estimated::<64>(settings, timing, &ops);
        }));
    }
    let ratio = by_steps.as_secs_f64() / by_plan.as_secs_f64();
    println!("{by_steps:?} with steps, {by_plan:?} without: {ratio:.0} times");
    assert!(ratio >= 10.0, "{by_steps:?} with steps, {by_plan:?} without");
}

/// Averaged by hand, each pause waiting for the motors.
#[cfg(feature = "averaged-steps")]
fn averaged_end(settings: PlannerSettings, timing: StepGenSettings, ops: &[PlotOp]) -> u64 {
    use plotter_motion::stepgen::{AveragedSteps, TimedEvent};
    use std::cell::RefCell;
    let of = settings.planned().unwrap();
    let averaged = RefCell::new(AveragedSteps::<2048>::of(&of, timing.clock_hz).unwrap());
    let is_pause = std::cell::Cell::new(false);
    let arrive = || {
        if is_pause.replace(false) {
            averaged.borrow_mut().arrive();
        }
    };
    let end = auditor::run::<16>(
        of.settings,
        timing,
        STEPS_PER_MM,
        ops,
        |action, _, _| {
            arrive();
            is_pause.set(matches!(action, Action::Dwell(_)));
        },
        |tick, event| {
            let averaged: &mut AveragedSteps<2048> = &mut averaged.borrow_mut();
            averaged.push(TimedEvent { tick, event }).unwrap();
            while averaged.next_event().is_some() {}
        },
    );
    arrive();
    let mut averaged = averaged.into_inner();
    while averaged.rest().is_some() {}
    end + averaged.delay_ticks()
}

#[cfg(feature = "averaged-steps")]
proptest! {
    #![proptest_config(cases(48))]

    #[test]
    fn any_averaged_drawing_takes_what_its_steps_take(ops in ops(), settle_us in 0_u64..300_000) {
        let timing =
            StepGenSettings { pen_settle: Duration::from_micros(settle_us), ..StepGenSettings::default() };
        let settings = PlannerSettings {
            jerk_limit: plotter_motion::planner::JerkLimit::Vector,
            ..modes()[3].1
        };
        let (end, found) = (averaged_end(settings, timing, &ops), estimated::<16>(settings, timing, &ops));
        prop_assert_eq!(found.total.as_micros(), u128::from(end));
    }
}
