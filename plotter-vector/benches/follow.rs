//! Windows a second of the line followers: a web camera gives 30.

use criterion::{BatchSize, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use plotter_vector::PxPoint;
use plotter_vector::follow::{
    CameraSettings, LineFollower, MappingFollower, MappingSettings, Paper, PublishedFollower,
    PublishedSettings, SimulatedCamera, Step,
};
use std::time::{Duration, Instant};

/// A window full of lines: two that cross, a ring, and hatching.
fn paper() -> Paper {
    let line = |places: &[(f64, f64)]| -> Vec<PxPoint> {
        places.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect()
    };
    let ring = (0..=90).map(|i| f64::from(i) * std::f64::consts::TAU / 90.0);
    let mut strokes = vec![
        (line(&[(0.0, 130.0), (600.0, 330.0)]), 5.0),
        (line(&[(120.0, 600.0), (330.0, 0.0)]), 5.0),
        (ring.map(|a| PxPoint::new(300.0 + 90.0 * a.cos(), 300.0 + 90.0 * a.sin())).collect(), 4.0),
    ];
    for i in 0..8 {
        let x = 190.0 + 12.0 * f64::from(i);
        strokes.push((line(&[(x, 400.0), (x + 90.0, 580.0)]), 4.0));
    }
    Paper::drawn(600, 600, &strokes).unwrap_or_else(|_| unreachable!("600 px are a picture"))
}

fn windows(criterion: &mut Criterion) {
    let mut camera = SimulatedCamera::new(&paper(), CameraSettings::default());
    let at = PxPoint::new(300.0, 300.0);
    let window = camera.window(at);
    let mut group = criterion.benchmark_group("window of 300 x 300 px");
    group.throughput(Throughput::Elements(1));
    group.bench_function("ours, whole: light, lines, map", |bencher| {
        let fresh = || MappingFollower::new(MappingSettings::default());
        bencher.iter_batched(fresh, |mut follower| follower.observe(&window, at), BatchSize::SmallInput);
    });
    // On a line, between two whole looks.
    let mut follower = MappingFollower::new(MappingSettings::default());
    let mut pose = at;
    for _ in 0..120 {
        if let Step::Move { path, .. } = follower.observe(&camera.window(pose), pose)
            && let Some(to) = path.last()
        {
            pose = *to;
        }
    }
    let next = camera.window(pose);
    group.bench_function("ours, on a line", |bencher| {
        bencher.iter_batched(
            || follower.clone(),
            |mut follower| follower.observe(&next, pose),
            BatchSize::SmallInput,
        );
    });
    group.bench_function("published", |bencher| {
        let fresh = || PublishedFollower::new(PublishedSettings::default());
        bencher.iter_batched(fresh, |mut follower| follower.observe(&window, at), BatchSize::SmallInput);
    });
    group.bench_function("simulated camera", |bencher| bencher.iter(|| camera.window(at)));
    group.finish();
}

/// Follows the whole paper with a table that goes where it is sent: how many windows that takes, and how long
/// the follower itself.
fn followed() -> (u64, Duration) {
    let mut camera = SimulatedCamera::new(&paper(), CameraSettings::default());
    let mut follower = MappingFollower::new(MappingSettings::default());
    let (mut windows, mut spent, mut pose) = (0, Duration::ZERO, PxPoint::new(300.0, 300.0));
    loop {
        let window = camera.window(pose);
        let begun = Instant::now();
        let step = follower.observe(&window, pose);
        spent += begun.elapsed();
        windows += 1;
        match step {
            Step::Move { path, .. } => pose = path.last().copied().unwrap_or(pose),
            Step::LineLost { .. } => {}
            Step::Done(_) => return (windows, spent),
        }
    }
}

fn drawing(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("a drawing of 600 x 600 px");
    group.throughput(Throughput::Elements(followed().0)).sampling_mode(SamplingMode::Flat).sample_size(10);
    group.bench_function("ours, camera and table left out", |bencher| {
        bencher.iter_custom(|times| (0..times).map(|_| followed().1).sum());
    });
    group.finish();
}

criterion_group!(benches, windows, drawing);
criterion_main!(benches);
