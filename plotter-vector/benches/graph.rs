//! Ink to strokes, in pixels of the sheet a second: cleaned, thinned, made a graph of centrelines with their
//! crossings and corners, and simplified; not ordered, and without the errors.
//!
//! `cargo bench -p plotter-vector --bench graph`

mod drawn_sheet;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use drawn_sheet::{SIDES_PX, ink};
use plotter_vector::{Order, Ours, Progress, Vectorizer, order::OrderEffort, picture::BitmapRows};

fn graph(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("graph");
    group.sample_size(10);
    let vectorizer =
        Vectorizer::from(Ours::default().with_order(Order::default().with_effort(OrderEffort::None)));
    for side_px in SIDES_PX {
        let ink = ink(side_px);
        group.throughput(Throughput::Elements(u64::from(side_px) * u64::from(side_px)));
        group.bench_with_input(BenchmarkId::from_parameter(side_px), &ink, |bencher, ink| {
            bencher.iter(|| vectorizer.vectorize_rows(&mut BitmapRows::new(ink), &mut Progress::silent()));
        });
    }
    group.finish();
}

criterion_group!(benches, graph);
criterion_main!(benches);
