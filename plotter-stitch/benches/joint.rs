//! Time to compute how a sheet lies: from 16 crossings, and by the published method.
//!
//! ```text
//! cargo bench -p plotter-stitch --bench joint
//! ```

use criterion::{Criterion, criterion_group, criterion_main};
use plotter_motion::Vec2;
use plotter_stitch::{
    Crossing, FrameReadings, FrameTransform, Mark, MarkSearch, Optics, Reading, ReferenceLines, RigidFit,
    marks::MOST_CROSSINGS,
    sense::{Found, SearchSettings},
    sheet::{SensedJoint, SensorNoise},
};
use std::hint::black_box;

/// What a simulated search finds.
fn found(crossings: &[Crossing], noise: SensorNoise) -> Vec<Found> {
    let sheet = FrameTransform::new(0.0015, Vec2::new(-3.0, 4.0)).unwrap_or(FrameTransform::IDENTITY);
    let mut sensed = SensedJoint::new(crossings, &sheet, Optics::default(), noise, 7);
    let mut search = MarkSearch::new(crossings, SearchSettings::default());
    let ran = sensed.run(&mut search);
    let found = search.found().map(<[Found]>::to_vec).unwrap_or_default();
    assert!(ran.is_ok() && !found.is_empty() && found.len() <= MOST_CROSSINGS);
    found
}

fn joints(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("joint");
    let fit = RigidFit::default();
    for (name, lines) in [("ours, 16", ReferenceLines::strip16()), ("ours, 32", ReferenceLines::strip32())] {
        let crossings: Vec<Crossing> = lines.crossings().collect();
        let clean = found(&crossings, SensorNoise::default());
        group.bench_function(format!("{name} crossings"), |bench| {
            bench.iter(|| fit.estimate(black_box(&crossings), black_box(&clean)));
        });
        // A stroke beside every mark, each of them another pose that explains as much, or nearly.
        for missed in [0, 5] {
            let strokes = clean.iter().map(|mark| Found { at_mm: mark.at_mm + 3.0, ..*mark });
            let among: Vec<Found> = clean.iter().skip(missed).copied().chain(strokes).collect();
            group.bench_function(format!("{name} crossings, strokes beside all, {missed} missed"), |bench| {
                bench.iter(|| fit.estimate(black_box(&crossings), black_box(&among)));
            });
        }
        let mut dusty = clean;
        for index in [1, 6, 13] {
            dusty[index].at_mm += 2.0;
        }
        group.bench_function(format!("{name} crossings, three of them dust"), |bench| {
            bench.iter(|| fit.estimate(black_box(&crossings), black_box(&dusty)));
        });
    }
    let marks: Vec<Crossing> = ReferenceLines::published().crossings().collect();
    let readings = Mark::ALL.map(|mark| {
        let Crossing { mark_mm, scan_at_mm, .. } = marks[mark as usize];
        Reading { expected_mm: mark_mm, found_mm: mark_mm + 1.0, scan_at_mm }
    });
    let [x_border1, x_border2, y_left, y_right] = readings;
    let readings = FrameReadings { x_border1, x_border2, y_left, y_right };
    group.bench_function("published", |bench| {
        bench.iter(|| FrameTransform::from_readings(black_box(&readings)));
    });
    group.finish();
}

criterion_group!(benches, joints);
criterion_main!(benches);
