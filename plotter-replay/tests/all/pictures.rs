//! Pictures that a person has looked at.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::cast_possible_truncation,
    reason = "a test that fails says so by a panic"
)]

use plotter_motion::Point;
use plotter_replay::{
    Canvas, CanvasStyle, Chart,
    draw::{Curve, Layer, Panel, Role, Run, Visibility},
};
use std::time::Duration;

/// A flag: 40 x 20 mm meant, drawn a little too low.
fn flag() -> Canvas {
    let line = |points: &[(f64, f64)]| points.iter().map(|&(x, y)| Point::new(x, y)).collect::<Vec<_>>();
    let mut canvas = Canvas::new();
    canvas.add(Layer::Desired, line(&[(0.0, 0.0), (40.0, 0.0), (40.0, 20.0), (0.0, 20.0), (0.0, 0.0)]));
    canvas.add(Layer::Ink, line(&[(0.0, 0.0), (40.0, -0.5), (40.0, 20.0), (0.0, 19.5), (0.0, 0.0)]));
    canvas.add(Layer::Travel, line(&[(0.0, 0.0), (20.0, 10.0)]));
    canvas.add(Layer::Ink, line(&[(20.0, 10.0)]));
    canvas
}

fn style() -> CanvasStyle {
    CanvasStyle { travel: Visibility::Shown, ..CanvasStyle::default() }
}

#[test]
fn a_canvas_is_written_as_reviewed() {
    insta::assert_snapshot!(flag().to_svg(&style()));
}

#[test]
fn a_chart_is_written_as_reviewed() {
    let ms = |ms| Duration::from_millis(ms);
    let span = (ms(0), ms(1_000));
    let rise = (0..=20_u32).map(|n| (Duration::from_millis(50) * n, 9.0 * f64::from(n) / 20.0));
    let chart = Chart {
        title: String::from("a <line> & its error"),
        panels: vec![
            Panel {
                label: String::from("X (mm)"),
                curves: vec![
                    Curve::new(
                        "target",
                        Role::Setpoint,
                        Run::Steps,
                        span,
                        [(ms(0), 0.0), (ms(100), 9.0), (ms(1_000), 9.0)],
                    ),
                    Curve::new("actual", Role::Actual, Run::Straight, span, rise),
                ],
            },
            Panel { label: String::from("nothing"), curves: vec![] },
        ],
    };
    insta::assert_snapshot!(chart.to_svg());
}

#[test]
fn a_curve_of_a_million_samples_is_a_small_picture() {
    let us = |us| Duration::from_micros(us);
    let samples = (0..1_000_000_u32).map(|n| (us(u64::from(n)), f64::from(n % 1_000 * 7_919 % 1_000)));
    let curve = Curve::new("noise", Role::Error, Run::Straight, (us(0), us(1_000_000)), samples);
    assert!(curve.samples().len() <= Curve::MOST_SAMPLES);
    let chart =
        Chart { title: String::new(), panels: vec![Panel { label: String::new(), curves: vec![curve] }] };
    assert!(chart.to_svg().len() < 80_000);
}

#[cfg(feature = "image")]
#[test]
fn a_png_has_ink_where_the_line_is_and_paper_beside_it() {
    // 10 pixels a millimetre: 40 mm and two margins of 8.
    let style = CanvasStyle { longest_px: 560, ..style() };
    let png = flag().to_png(&style).unwrap();
    let picture = tiny_skia::Pixmap::decode_png(&png).unwrap();
    assert_eq!(picture.width(), 560);
    let shade = |x_mm: f64, y_mm: f64| {
        // Upper left corner at (-8, 28) mm.
        let px = |mm: f64| u32::try_from((mm * 10.0).round() as i64).unwrap();
        let pixel = picture.pixel(px(x_mm + 8.0), px(28.0 - y_mm)).unwrap();
        (u32::from(pixel.red()) + u32::from(pixel.green()) + u32::from(pixel.blue())) / 3
    };
    assert!(shade(40.0, 10.0) < 60, "ink on the right edge: {}", shade(40.0, 10.0));
    assert!(shade(20.0, 10.0) < 60, "a dot: {}", shade(20.0, 10.0));
    assert!((150..240).contains(&shade(39.0, 0.3)), "the desired line beside the ink: {}", shade(39.0, 0.3));
    assert_eq!(shade(20.0, 15.0), 255, "paper");
}

#[cfg(feature = "image")]
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn pictures_stay_within_their_size_whatever_is_drawn() {
    let mut canvas = Canvas::new();
    canvas.add(Layer::Ink, [Point::new(-1e300, 0.0), Point::new(1e300, 1e-300)]);
    canvas.add(Layer::Travel, [Point::new(0.0, 0.0), Point::new(1e9, 1e9)]);
    for longest_px in [0, 100] {
        let style = CanvasStyle { longest_px, margin_mm: f64::NAN, ink_width_mm: f64::INFINITY, ..style() };
        let picture = tiny_skia::Pixmap::decode_png(&canvas.to_png(&style).unwrap()).unwrap();
        assert!(picture.width() <= 100 && picture.height() <= 100);
    }
    let mut flat = Canvas::new();
    flat.add(Layer::Ink, [Point::new(0.0, 0.0), Point::new(1_000.0, 0.0)]);
    let style = CanvasStyle { longest_px: u32::MAX, margin_mm: 0.0, ..CanvasStyle::default() };
    let picture = tiny_skia::Pixmap::decode_png(&flat.to_png(&style).unwrap()).unwrap();
    assert_eq!(picture.width(), 8_192);
}
