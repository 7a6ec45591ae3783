//! Speed of planning and stepping tool paths: segments and step events per second, on one core.
//!
//! ```text
//! cargo bench -p plotter-motion --bench planner
//! ```
#![allow(clippy::unwrap_used, clippy::panic, reason = "shared with tests, which fail by a panic")]

#[path = "../tests/all/drawings/mod.rs"]
mod drawings;
#[path = "../tests/all/real_files/mod.rs"]
mod real_files;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use drawings::Drawing;
use plotter_motion::kinematics::{Cartesian, MotorScale};
use plotter_motion::{
    PathMode, Planner, PlannerSettings, PlotOp, StepGen,
    planner::{AccelLimit, Action},
    stepgen::StepGenSettings,
};
use std::hint::black_box;

fn modes() -> [(&'static str, PlannerSettings); 3] {
    let exact = PlannerSettings::default();
    let tolerance = PlannerSettings { path: PathMode::Tolerance { path_tolerance_mm: 0.05 }, ..exact };
    let curved = PlannerSettings { jerk_mm_s3: Some(20_000.0), ..exact };
    [("exact", exact), ("tolerance", tolerance), ("exact s-curve", curved)]
}

/// Those of every kind of limit and of path.
fn planned_modes() -> [(&'static str, PlannerSettings); 8] {
    let [exact, tolerance, curved] = modes();
    let with = |settings, accel_limit| PlannerSettings { accel_limit, ..settings };
    let axes = AccelLimit::Axes { x_mm_s2: 1000.0, y_mm_s2: 800.0 };
    let belts = AccelLimit::Belts { sum_mm_s2: 1000.0, difference_mm_s2: 900.0 };
    [
        exact,
        tolerance,
        curved,
        ("exact, allowance of 0.01 mm", PlannerSettings { allowance_mm: 0.01, ..exact.1 }),
        ("exact, axes", with(exact.1, axes)),
        ("tolerance, axes", with(tolerance.1, axes)),
        ("exact, belts", with(exact.1, belts)),
        ("tolerance, belts", with(tolerance.1, belts)),
    ]
}

/// Every action of a drawing, with 16 blocks of look-ahead.
fn plan(settings: PlannerSettings, ops: &[PlotOp], mut each: impl FnMut(Action)) {
    let Ok(mut planner) = Planner::<16>::new(settings) else { return };
    let mut finished = false;
    let mut ops = ops.iter().copied();
    loop {
        while !finished && planner.has_room() {
            finished = match ops.next() {
                Some(op) => planner.push(op).is_err(),
                None => planner.finish().is_ok(),
            };
        }
        match planner.next_action() {
            Some(action) => each(action),
            None => return,
        }
    }
}

fn planned_segments(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("planned segments");
    for Drawing { name, ops } in drawings::built().into_iter().chain(drawings::real()) {
        group.throughput(Throughput::Elements(ops.len() as u64));
        for (mode, settings) in planned_modes() {
            group.bench_with_input(BenchmarkId::new(mode, name), &ops, |bench, ops| {
                bench.iter(|| {
                    plan(settings, ops, |action| {
                        black_box(action);
                    })
                });
            });
        }
    }
    group.finish();
}

fn step_events(criterion: &mut Criterion) {
    let motor = MotorScale { steps_per_mm: 100.0, inverted: false };
    let Ok(kinematics) = Cartesian::new(motor, motor) else { return };
    let mut group = criterion.benchmark_group("step events");
    for Drawing { name, ops } in [drawings::spiral(20), drawings::hatch(60)] {
        for (mode, settings) in modes() {
            let mut actions = Vec::new();
            plan(settings, &ops, |action| actions.push(action));
            let all = |actions: &[Action]| {
                let mut steps = StepGen::new(kinematics, StepGenSettings::default());
                let mut count = 0_u64;
                for &action in actions {
                    if steps.push(action).is_err() {
                        break;
                    }
                    while let Some(event) = steps.next_event() {
                        black_box(event);
                        count += 1;
                    }
                }
                count
            };
            group.throughput(Throughput::Elements(all(&actions)));
            group.bench_with_input(BenchmarkId::new(mode, name), &actions, |bench, actions| {
                bench.iter(|| all(actions));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, planned_segments, step_events);
criterion_main!(benches);
