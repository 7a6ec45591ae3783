//! Lines of 1 to 2 px at 1 bit a pixel: what a threshold leaves of a thin pen, columns of one pixel and of
//! two in turn.
//!
//! `cargo test --release -p plotter-vector --test all hairline_widths:: -- --nocapture` prints what comes of
//! each figure at each width.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::print_stdout,
    reason = "a failure shows, and places are small"
)]

use crate::pen_ink;
use crate::random;
use crate::segment_distance;

use pen_ink::{Line, ink_of};
use plotter_vector::{Drawing, Ours, Progress, PxPoint, Vectorized, Vectorizer, picture::BitmapRows};
use random::Random;
use segment_distance::segment_distance;

const SIDE_PX: u32 = 300;

const WIDTHS_PX: [f64; 8] = [1.0, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 2.0];

/// Ten lines across ten, turned.
fn grid(turn_rad: f64) -> Vec<Line> {
    let (sine, cosine) = libm::sincos(turn_rad);
    let at = |x: f64, y: f64| PxPoint::new(150.0 + x * cosine - y * sine, 150.0 + x * sine + y * cosine);
    let pair = |step: u32| {
        let across = 20.0 * f64::from(step) - 90.0;
        [[at(across, -100.0), at(across, 100.0)], [at(-100.0, across), at(100.0, across)]]
    };
    (0..10).flat_map(pair).collect()
}

/// Forty straight lines of 100 px and more.
fn random_lines() -> Vec<Line> {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let side = f64::from(SIDE_PX) - 16.0;
    let mut place = || PxPoint::new(8.0 + side * random.unit(), 8.0 + side * random.unit());
    let line = std::iter::repeat_with(|| [place(), place()]);
    line.filter(|[from, to]| from.distance(*to) >= 100.0).take(40).collect()
}

/// A line through places, whose number is a step's greatest one.
fn curve(steps: u32, at: impl Fn(f64) -> PxPoint) -> Vec<Line> {
    (0..steps).map(|step| [at(f64::from(step)), at(f64::from(step + 1))]).collect()
}

/// The pieces of what was found.
fn pieces(drawing: &Drawing) -> Vec<Line> {
    drawing.strokes().flat_map(|stroke| stroke.windows(2)).map(|pair| [pair[0], pair[1]]).collect()
}

/// Mean and greatest distance of places along some lines from others, px.
fn off_px(lines: &[Line], others: &[Line]) -> (f64, f64) {
    let (mut sum, mut count, mut greatest) = (0.0, 0.0, 0.0_f64);
    for [from, to] in lines {
        let steps = from.distance(*to).ceil().max(1.0);
        for step in 0..=steps as u32 {
            let part = f64::from(step) / steps;
            let at = PxPoint::new(from.x + (to.x - from.x) * part, from.y + (to.y - from.y) * part);
            let off = others.iter().map(|[a, b]| segment_distance(at, *a, *b)).fold(f64::INFINITY, f64::min);
            (sum, count, greatest) = (sum + off, count + 1.0, greatest.max(off));
        }
    }
    (sum / count, greatest)
}

/// Where lines cross that make an angle of 20 degrees and more.
fn crossings(lines: &[Line]) -> Vec<PxPoint> {
    let mut all = Vec::new();
    for (index, one) in lines.iter().enumerate() {
        all.extend(lines[index + 1..].iter().filter_map(|other| crossing(*one, *other)));
    }
    all
}

fn crossing([a, b]: Line, [c, d]: Line) -> Option<PxPoint> {
    let way = |from: PxPoint, to: PxPoint| (to.x - from.x, to.y - from.y);
    let ((ux, uy), (vx, vy), (x, y)) = (way(a, b), way(c, d), way(a, c));
    let cross = ux * vy - uy * vx;
    if cross.abs() < 0.34 * ux.hypot(uy) * vx.hypot(vy) {
        return None;
    }
    let (s, t) = ((x * vy - y * vx) / cross, (x * uy - y * ux) / cross);
    let on = |part: f64| (-1e-9..=1.0 + 1e-9).contains(&part);
    (on(s) && on(t)).then(|| PxPoint::new(a.x + s * ux, a.y + s * uy))
}

/// What comes of lines.
struct Outcome {
    strokes: usize,
    mean_px: f64,
    /// The crossing that is farthest from any of the drawing's.
    crossing_px: f64,
}

fn outcome(name: &str, lines: &[Line], width_px: f64) -> Outcome {
    let Vectorized { drawing, error, .. } =
        Vectorizer::default().trace(&ink_of(SIDE_PX, lines, width_px)).unwrap();
    let found = pieces(&drawing);
    let ((drawn_px, greatest_px), (missed_px, _)) = (off_px(&found, lines), off_px(lines, &found));
    let mean_px = drawn_px.max(missed_px);
    let places = crossings(&found);
    let away_px = |at: PxPoint| places.iter().map(|place| place.distance(at)).fold(f64::INFINITY, f64::min);
    let crossing_px = crossings(lines).into_iter().map(away_px).fold(0.0, f64::max);
    let (strokes, vertices) = (drawing.strokes().len(), drawing.vertices());
    println!(
        "{name}, {width_px:.1} px: {strokes} strokes, {vertices} vertices, mean {mean_px:.2}, greatest \
         {greatest_px:.2}, crossings {crossing_px:.2}, pixels {:.2}",
        error.max_px
    );
    Outcome { strokes, mean_px, crossing_px }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_line_of_a_turned_grid_is_a_stroke_at_any_width() {
    for turn_rad in [0.05, 0.2, 0.45, core::f64::consts::FRAC_PI_4] {
        for width_px in WIDTHS_PX {
            let Outcome { strokes, mean_px, crossing_px } =
                outcome(&format!("grid at {turn_rad:.2} rad"), &grid(turn_rad), width_px);
            // Of a pen of one pixel each pixel is kept, and the strokes weave between them.
            let (most, most_crossing_px) = if width_px > 1.0 { (20, 0.5) } else { (21, 1.0) };
            assert!((20..=most).contains(&strokes), "{strokes} strokes");
            assert!(mean_px <= 0.2, "{mean_px}");
            assert!(crossing_px <= most_crossing_px, "{crossing_px}");
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_circle_and_a_wave_are_a_stroke_at_any_width() {
    let circle = curve(400, |step| {
        let (sine, cosine) = libm::sincos(step * core::f64::consts::TAU / 400.0);
        PxPoint::new(150.2 + 110.3 * cosine, 149.7 + 110.3 * sine)
    });
    let wave = curve(559, |step| {
        PxPoint::new(10.0 + 0.5 * step, 150.3 + 60.0 * libm::sin((10.0 + 0.5 * step) / 17.0))
    });
    for (name, lines) in [("circle", circle), ("wave", wave)] {
        for width_px in WIDTHS_PX {
            let Outcome { strokes, mean_px, .. } = outcome(name, &lines, width_px);
            assert_eq!(strokes, 1);
            assert!(mean_px <= 0.3, "{mean_px}");
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn lines_that_cross_at_random_are_few_strokes_at_any_width() {
    for width_px in WIDTHS_PX {
        let Outcome { strokes, mean_px, .. } = outcome("forty lines", &random_lines(), width_px);
        assert!(strokes <= if width_px > 1.0 { 72 } else { 107 }, "{strokes}");
        assert!(mean_px <= 0.2, "{mean_px}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn thin_lines_are_the_same_strokes_by_rows() {
    for lines in [grid(0.2), random_lines()] {
        let ink = ink_of(SIDE_PX, &lines, 1.4);
        let whole = Vectorizer::default().trace(&ink).unwrap().drawing;
        for band_rows in [40, 130] {
            let vectorizer = Vectorizer::from(Ours::default().with_band_rows(band_rows));
            let sheet =
                vectorizer.vectorize_rows(&mut BitmapRows::new(&ink), &mut Progress::silent()).unwrap();
            assert_eq!(sheet.drawing, whole, "{band_rows}");
        }
    }
}
