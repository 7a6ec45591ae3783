//! A picture in colour to the ink of each pen, in pixels a second: pens found, and three pens.
//!
//! `cargo bench -p plotter-vector --bench layers`

mod drawn_sheet;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use drawn_sheet::{SIDES_PX, colour};
use plotter_vector::ink::Pens;

fn layers(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("layers");
    group.sample_size(10);
    for side_px in SIDES_PX {
        let picture = colour(side_px);
        group.throughput(Throughput::Elements(u64::from(side_px) * u64::from(side_px)));
        for (name, pens) in [("found", Pens::Found), ("three", Pens::Count(3))] {
            group.bench_with_input(BenchmarkId::new(name, side_px), &picture, |bencher, picture| {
                bencher.iter(|| pens.separate(picture));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, layers);
criterion_main!(benches);
