//! Thinning of a line drawing with 5 % of ink, lines 4 to 10 px wide, in megapixels a second.
//!
//! The largest picture has the width of an A1 sheet at 600 dots per inch, and a quarter of its height.

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use plotter_vector::{
    Bitmap, Pixel,
    raster::{Thinning, ThinningMethod},
};

/// Straight lines at all angles until a twentieth of the sheet is ink.
#[expect(clippy::expect_used, reason = "a benchmark without its picture measures nothing")]
fn sheet(width: u32, height: u32) -> Bitmap {
    let mut ink = Bitmap::new(width, height).expect("the sizes below are small enough");
    let mut state = 1_u64;
    let mut draw = move |below: u32| {
        // Knuth's multiplier and increment of MMIX; the upper half is the better one.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        u32::try_from(((state >> 32) * u64::from(below)) >> 32).unwrap_or(0)
    };
    let wanted = u64::from(width) * u64::from(height) / 20;
    let mut drawn = 0;
    while drawn < wanted {
        let half = f64::from(20 + draw(31)) / 10.0;
        let length = f64::from(100 + draw(900));
        let angle = f64::from(draw(3600)) * core::f64::consts::PI / 1800.0;
        let (dx, dy) = (libm::cos(angle), libm::sin(angle));
        let (x, y) = (f64::from(draw(width)), f64::from(draw(height)));
        let reach = |d: f64| (d * length).min(0.0) - half..=(d * length).max(0.0) + half;
        let range = |from: f64, d: f64, side: u32| {
            let (low, high) = (from + reach(d).start(), from + reach(d).end());
            (0..side).skip_while(move |i| f64::from(*i) < low).take_while(move |i| f64::from(*i) <= high)
        };
        for v in range(y, dy, height) {
            for u in range(x, dx, width) {
                let (px, py) = (f64::from(u) + 0.5 - x, f64::from(v) + 0.5 - y);
                let (along, across) = (px * dx + py * dy, px * dy - py * dx);
                let at = Pixel::new(u, v);
                if across.abs() <= half && (0.0..=length).contains(&along) && !ink.get(at) {
                    ink.set(at, true);
                    drawn += 1;
                }
            }
        }
    }
    ink
}

fn thinning(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("thinning");
    group.sample_size(10);
    for (width, height) in [(1000, 1000), (3500, 2500), (14_043, 4966)] {
        let ink = sheet(width, height);
        group.throughput(Throughput::Elements(u64::from(width) * u64::from(height)));
        for method in [ThinningMethod::GuoHall, ThinningMethod::ZhangSuen] {
            let thinning = Thinning::default().with_method(method);
            let name = BenchmarkId::new(format!("{method:?}"), format!("{width}x{height}"));
            group.bench_with_input(name, &ink, |bencher, ink| {
                bencher.iter_batched_ref(
                    || ink.clone(),
                    |ink| thinning.thin_in_place(ink),
                    BatchSize::LargeInput,
                )
            });
        }
    }
    group.finish();
}

criterion_group!(benches, thinning);
criterion_main!(benches);
