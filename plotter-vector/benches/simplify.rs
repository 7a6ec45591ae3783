//! Time of the simplification a site: straight lines, curves and noise, over three lengths.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use plotter_vector::{PxPoint, stroke::Bounded};
use std::hint::black_box;

/// Seeded noise between −1 and 1.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        #[expect(clippy::cast_precision_loss, reason = "53 bits")]
        let part = (self.0 >> 11) as f64 / (1_u64 << 53) as f64;
        2.0 * part - 1.0
    }
}

/// An arc of `sites` places about 1 px apart, with a noise of 0.2 px.
fn arc(radius_px: f64, sites: u32, noise: &mut Noise) -> Vec<PxPoint> {
    (0..sites)
        .map(|i| {
            let (sin, cos) = libm::sincos(f64::from(i) / radius_px);
            PxPoint::new(radius_px * cos + 0.2 * noise.next(), radius_px * sin + 0.2 * noise.next())
        })
        .collect()
}

fn lines(sites: u32) -> [(&'static str, Vec<PxPoint>); 4] {
    let mut noise = Noise(7);
    let straight = (0..sites)
        .map(|i| PxPoint::new(f64::from(i) + 0.2 * noise.next(), 0.1 * f64::from(i) + 0.2 * noise.next()));
    let straight = straight.collect();
    let mut at = PxPoint::default();
    let walk = (0..sites).map(|_| {
        at = PxPoint::new(at.x + noise.next(), at.y + noise.next());
        at
    });
    let walk = walk.collect();
    [
        ("straight", straight),
        ("radius 200", arc(200.0, sites, &mut noise)),
        ("radius 20", arc(20.0, sites, &mut noise)),
        ("random walk", walk),
    ]
}

fn polyline(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("polyline");
    for sites in [100, 1_000, 10_000] {
        for (name, line) in lines(sites) {
            group.throughput(Throughput::Elements(u64::from(sites)));
            group.bench_with_input(BenchmarkId::new(name, sites), &line, |bench, line| {
                bench.iter(|| Bounded::default().polyline(black_box(line), false));
            });
        }
    }
    group.finish();
}

/// Lines, arcs and cubic curves on the same line.
fn bent(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("bent");
    const SITES: u32 = 2_000;
    for (name, line) in lines(SITES) {
        group.throughput(Throughput::Elements(u64::from(SITES)));
        group.bench_with_input(BenchmarkId::new("arcs", name), &line, |bench, line| {
            bench.iter(|| Bounded::default().arcs(black_box(line), false));
        });
        group.bench_with_input(BenchmarkId::new("cubics", name), &line, |bench, line| {
            bench.iter(|| Bounded::default().cubics(black_box(line), false));
        });
    }
    group.finish();
}

criterion_group!(benches, polyline, bent);
criterion_main!(benches);
