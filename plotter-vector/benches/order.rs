//! Time of ordering random short strokes, by effort, over three sizes.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use plotter_vector::{
    Drawing, Order, PxPoint,
    order::{Lettering, OrderEffort},
};

const SIDE_PX: f64 = 2000.0;

/// Strokes of a few px, evenly spread, always the same.
fn strokes(count: u32) -> Drawing {
    let mut state = 1_u32;
    let mut below = |limit: f64| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1_u32 << 24) * limit
    };
    let mut drawing = Drawing::new(2000, 2000);
    for _ in 0..count {
        let (x, y) = (below(SIDE_PX), below(SIDE_PX));
        drawing.push([
            PxPoint::new(x, y),
            PxPoint::new(x + below(5.0), y + below(5.0)),
            PxPoint::new(x + below(9.0), y),
        ]);
    }
    drawing
}

fn order(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("order");
    group.sample_size(10);
    for count in [1_000, 10_000, 100_000] {
        let drawing = strokes(count);
        group.throughput(Throughput::Elements(u64::from(count)));
        for effort in [OrderEffort::Fast, OrderEffort::Best] {
            let name = format!("{effort:?}");
            group.bench_with_input(BenchmarkId::new(name, count), &drawing, |bencher, drawing| {
                bencher.iter(|| Order::default().with_effort(effort).apply(drawing));
            });
        }
        group.bench_with_input(BenchmarkId::new("Lettering", count), &drawing, |bencher, drawing| {
            bencher.iter(|| Lettering::default().find(drawing));
        });
    }
    group.finish();
}

criterion_group!(benches, order);
criterion_main!(benches);
