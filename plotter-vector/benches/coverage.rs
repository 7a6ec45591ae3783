//! The errors of all pixels of the ink against its strokes, in pixels of the sheet a second.
//!
//! `cargo bench -p plotter-vector --bench coverage`

mod drawn_sheet;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use drawn_sheet::{SIDES_PX, gray};
use plotter_vector::{Vectorizer, report::coverage};

#[expect(clippy::expect_used, reason = "a benchmark without its strokes measures nothing")]
fn errors(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("coverage");
    group.sample_size(10);
    let vectorizer = Vectorizer::default();
    for side_px in SIDES_PX {
        let gray = gray(side_px);
        let ink = vectorizer.ink(&gray);
        let drawing = vectorizer.vectorize(&gray).expect("a drawing of lines").drawing;
        group.throughput(Throughput::Elements(u64::from(side_px) * u64::from(side_px)));
        group.bench_function(BenchmarkId::from_parameter(side_px), |bencher| {
            bencher.iter(|| coverage(&ink, &drawing));
        });
    }
    group.finish();
}

criterion_group!(benches, errors);
criterion_main!(benches);
