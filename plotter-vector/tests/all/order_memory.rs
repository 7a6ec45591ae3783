//! Time and memory of ordering very many lines: a file of another program may have a million of them.

use crate::own_process::{is_alone, peak_kib};
use plotter_motion::Point;
use plotter_motion::drawing::{Drawing, Stroke};
use plotter_vector::{Order, order::OrderEffort};
use std::time::Instant;

/// Lines of up to a millimetre, one to a stroke, in random order on a sheet with one on every 9 mm².
#[expect(clippy::cast_precision_loss, reason = "numbers of 53 bits")]
fn lines(count: u32) -> Drawing {
    let mut state = 1_u64;
    let mut below = |limit: f64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 * limit
    };
    let side_mm = 3.0 * f64::from(count).sqrt();
    let line = |_| {
        let from = Point::new(below(side_mm), below(side_mm));
        Stroke::through([from, Point::new(from.x + below(2.0) - 1.0, from.y + below(2.0) - 1.0)])
    };
    (0..count).filter_map(line).collect()
}

/// Bytes and seconds that so many lines take, the drawing included.
#[expect(clippy::cast_precision_loss, reason = "fewer than 2^53 bytes")]
fn ordered(count: u32) -> (f64, f64) {
    let before_kib = peak_kib();
    let drawing = lines(count);
    let (strokes, travel_mm) = (drawing.strokes.len(), drawing.travel_mm());
    let start = Instant::now();
    let order = Order::default().with_effort(OrderEffort::Fast).with_merge_gap_px(0.0);
    let ordered = order.apply_to(drawing);
    let seconds = start.elapsed().as_secs_f64();
    assert_eq!(ordered.strokes.len(), strokes);
    assert!(ordered.travel_mm() < 0.1 * travel_mm, "{} of {travel_mm} mm", ordered.travel_mm());
    let bytes = (peak_kib() - before_kib) as f64 * 1024.0 / f64::from(count);
    println!("{count} lines: {bytes:.0} bytes each, {seconds:.2} s");
    (bytes, seconds)
}

/// Most that a line may take here, bytes: a tenth more than it takes, for allocators that keep more.
const MOST_BYTES: f64 = 320.0;

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_line_takes_little_memory() {
    if is_alone("order_memory::a_line_takes_little_memory") {
        let (bytes, _) = ordered(300_000);
        assert!(bytes <= MOST_BYTES, "{bytes}");
    }
}

#[test]
#[ignore = "a million lines: cargo test --release -p plotter-vector --features rayon --test all order_memory:: -- --ignored --nocapture"]
fn a_million_lines_take_seconds() {
    let (bytes, _) = ordered(1_000_000);
    assert!(bytes <= MOST_BYTES, "{bytes}");
}
