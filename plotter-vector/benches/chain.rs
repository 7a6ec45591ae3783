//! The whole way, in pixels a second: from the levels of a scan to ordered strokes and their errors; held
//! whole and by rows, and from a scan in colour to the strokes of three pens.
//!
//! `cargo bench -p plotter-vector --bench chain`

mod drawn_sheet;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use drawn_sheet::{SIDES_PX, colour, gray};
use plotter_vector::{
    Progress, Vectorizer,
    ink::Pens,
    picture::{GrayRows, RowSource as _},
};

fn chain(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("chain");
    group.sample_size(10);
    let vectorizer = Vectorizer::default();
    for side_px in SIDES_PX {
        let (gray, colour) = (gray(side_px), colour(side_px));
        group.throughput(Throughput::Elements(u64::from(side_px) * u64::from(side_px)));
        group.bench_function(BenchmarkId::new("whole", side_px), |bencher| {
            bencher.iter(|| vectorizer.vectorize(&gray));
        });
        group.bench_function(BenchmarkId::new("by rows", side_px), |bencher| {
            let mut rows = GrayRows::new(gray.clone());
            bencher.iter(|| {
                rows.rewind().ok()?;
                vectorizer.vectorize_rows_with_errors(&mut rows, &mut Progress::silent()).ok()
            });
        });
        group.bench_function(BenchmarkId::new("three pens", side_px), |bencher| {
            bencher.iter(|| vectorizer.vectorize_colour(&colour, &Pens::Count(3)));
        });
    }
    group.finish();
}

criterion_group!(benches, chain);
criterion_main!(benches);
