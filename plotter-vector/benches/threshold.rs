//! Speed of each stage from grey levels to clean ink, on an A4 sheet at 150, 300 and 600 dots per inch.
//!
//! Criterion counts elements; one element is one pixel, so `Melem/s` are megapixels per second.
//!
//!     cargo bench -p plotter-vector --bench threshold
#![allow(clippy::unwrap_used, reason = "a benchmark may panic, and the picture has width * height levels")]

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use plotter_vector::{
    Gray, Threshold, ThresholdMethod,
    ink::{despeckle, pen_width_px, smallest_mark_px},
    picture::Histogram,
};
use std::hint::black_box;
use std::time::Duration;

/// Least difference between the mean levels of ink and paper that Otsu's method accepts; the sheet has 160.
const LEAST_CONTRAST: u8 = 24;

/// Lines in all directions, 4 px wide, on paper with noise.
fn sheet(width: u32, height: u32) -> Gray {
    let level = |i: u32| {
        let (x, y) = (i % width, i / width);
        // An integer hash of the pixel's number: noise that is the same in each run.
        let mut noise = i.wrapping_mul(0x9e37_79b9);
        noise = (noise ^ noise >> 15).wrapping_mul(0x2c1b_3c6d);
        let paper = 225 + (noise >> 28) as u8;
        // Their distances are primes, so that lines of two directions do not meet in a regular pattern.
        let line = x % 331 < 4 || y % 313 < 4 || (x + y) % 397 < 4 || (3 * x + 1000 * y / 577) % 1201 < 6;
        if line { paper - 160 } else { paper }
    };
    Gray::new(width, height, (0..width * height).map(level).collect()).unwrap()
}

fn stages(criterion: &mut Criterion) {
    for (dpi, width, height) in [(150, 1240, 1754), (300, 2480, 3508), (600, 4961, 7016)] {
        let gray = sheet(width, height);
        let pixels = u64::from(width) * u64::from(height);
        let mut group = criterion.benchmark_group("A4");
        group.throughput(Throughput::Elements(pixels)).sample_size(10);
        group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
        let mut stage = |name: &str, run: &mut dyn FnMut()| {
            group.bench_function(BenchmarkId::new(name, dpi), |bencher| bencher.iter(&mut *run));
        };
        stage("histogram", &mut || {
            let mut histogram = Histogram::default();
            histogram.push(black_box(gray.pixels()));
            black_box(histogram.otsu(LEAST_CONTRAST));
        });
        for method in [ThresholdMethod::Otsu, ThresholdMethod::Adaptive] {
            let threshold = Threshold::default().with_method(method);
            stage(&format!("{method}, whole picture"), &mut || drop(black_box(threshold.apply(&gray))));
        }
        let (ink, _) = Threshold::default().apply(&gray);
        let pen_px = pen_width_px(&ink).unwrap();
        stage("pen width", &mut || {
            black_box(pen_width_px(&ink));
        });
        // It changes its input, so each run has a copy, made outside the time that is measured.
        group.bench_function(BenchmarkId::new("despeckle", dpi), |bencher| {
            let run = |mut ink| despeckle(&mut ink, smallest_mark_px(pen_px));
            bencher.iter_batched(|| ink.clone(), run, BatchSize::LargeInput);
        });
    }
}

criterion_group!(benches, stages);
criterion_main!(benches);
