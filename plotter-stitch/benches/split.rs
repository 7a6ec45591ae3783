//! Speed of dividing drawings into frames: segments per second, on one core.
//!
//! ```text
//! cargo bench -p plotter-stitch --bench split
//! ```

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use plotter_motion::{PlotOp, Point};
use plotter_stitch::{FrameLayout, Frames, split::FramePasses};
use std::f64::consts::TAU;
use std::hint::black_box;

/// Waves along the sheet, one above the other, in strokes of 900 mm: `count` segments.
fn waves(count: u32, strokes: u32) -> impl Iterator<Item = PlotOp> + Clone {
    const ROWS: u32 = 50;
    const STROKE_MM: f64 = 900.0;
    let each = count / strokes / ROWS;
    (0..strokes * ROWS).flat_map(move |stroke| {
        let (begin_mm, row) = (f64::from(stroke / ROWS) * STROKE_MM, f64::from(stroke % ROWS));
        (0..=each).map(move |number| {
            let way_mm = STROKE_MM * f64::from(number) / f64::from(each);
            let to = Point::new(10.0 + 19.0 * row + 8.0 * libm::sin(TAU * way_mm / 60.0), begin_mm + way_mm);
            if number == 0 { PlotOp::Travel { to } } else { PlotOp::Draw { to, feed_mm_s: None } }
        })
    })
}

fn segments(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("split");
    group.sample_size(10);
    let layout = FrameLayout::default();
    for (count, strokes) in [(10_000, 4), (100_000, 34), (1_000_000, 34)] {
        let ops: Vec<_> = waves(count, strokes).collect();
        group.throughput(Throughput::Elements(ops.len() as u64));
        group.bench_with_input(BenchmarkId::new("one pass", count), &ops, |bench, ops| {
            bench.iter(|| {
                Frames::new(ops.iter().copied(), layout).filter_map(Result::ok).for_each(|frame| {
                    frame.ops().for_each(|op| {
                        black_box(op);
                    })
                });
            });
        });
        group.bench_with_input(BenchmarkId::new("a pass for each frame", count), &ops, |bench, ops| {
            bench.iter(|| {
                FramePasses::new(|| ops.iter().copied(), layout).filter_map(Result::ok).for_each(|frame| {
                    frame.ops().for_each(|op| {
                        black_box(op);
                    })
                });
            });
        });
    }
    group.finish();
}

criterion_group!(benches, segments);
criterion_main!(benches);
