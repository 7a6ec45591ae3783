//! Scans of one drawing in uneven light: a gradient, a vignette and a shadow, with the noise of a sensor.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    reason = "a failure shows, and levels are made to fit"
)]

use plotter_vector::{
    Bitmap, Gray, Pixel, Threshold, ThresholdMethod,
    ink::{Polarity, despeckle, pen_width_px, smallest_mark_px},
};

const WIDTH: u32 = 480;
const HEIGHT: u32 = 360;

/// Share of a pixel that a pen 3 px wide covers: a frame, its diagonals, a circle and a dot.
fn coverage(x: u32, y: u32) -> f64 {
    let (x, y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
    let segment = |(ax, ay): (f64, f64), (bx, by): (f64, f64)| {
        let (dx, dy) = (bx - ax, by - ay);
        let along = (((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
        let (dx, dy) = (x - ax - along * dx, y - ay - along * dy);
        (dx * dx + dy * dy).sqrt()
    };
    let corners = [(30.3, 25.7), (450.2, 31.4), (441.9, 330.6), (36.1, 322.8)];
    let [a, b, c, d] = corners;
    let (rx, ry) = (x - 240.0, y - 180.0);
    let circle = ((rx * rx + ry * ry).sqrt() - 90.4).abs();
    let lines = [segment(a, b), segment(b, c), segment(c, d), segment(d, a), segment(a, c), segment(b, d)];
    let nearest = lines.into_iter().fold(circle, f64::min).min(segment((240.0, 60.0), (240.5, 60.0)));
    (2.0 - nearest).clamp(0.0, 1.0)
}

/// Light in a place, 1 where it is best: a lamp on the right, a lens, and the shadow of a hand at the upper
/// left.
fn light(x: u32, y: u32) -> f64 {
    let (x, y) = (f64::from(x) / f64::from(WIDTH), f64::from(y) / f64::from(HEIGHT));
    let gradient = 0.55 + 0.45 * x;
    let vignette = 1.0 - 0.5 * ((x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5));
    let shadow = 1.0 - 0.4 * ((0.45 - x - 0.5 * y) * 8.0 + 0.5).clamp(0.0, 1.0);
    gradient * vignette * shadow
}

/// A hash of a place: even in −1 to 1.
fn noise(x: u32, y: u32) -> f64 {
    let mut n = x.wrapping_mul(7919).wrapping_add(y.wrapping_mul(104_729));
    n = (n ^ n >> 15).wrapping_mul(0x2c1b_3c6d);
    n = (n ^ n >> 12).wrapping_mul(0x297a_2d39);
    f64::from(n ^ n >> 15) / f64::from(u32::MAX) * 2.0 - 1.0
}

fn scan(level: impl Fn(u32, u32) -> f64) -> Gray {
    let places = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
    let levels = places.map(|(x, y)| level(x, y).round().clamp(0.0, 255.0) as u8).collect();
    Gray::new(WIDTH, HEIGHT, levels).unwrap()
}

/// A scan with ink that reflects `share` of what the paper reflects.
fn uneven(share: f64) -> Gray {
    scan(|x, y| 240.0 * light(x, y) * (1.0 - (1.0 - share) * coverage(x, y)) + 6.0 * noise(x, y))
}

fn negative(gray: &Gray) -> Gray {
    let levels = gray.pixels().iter().map(|level| 255 - level).collect();
    Gray::new(gray.width(), gray.height(), levels).unwrap()
}

fn adaptive() -> Threshold {
    Threshold::default()
        .with_polarity(Polarity::Minority)
        .with_method(ThresholdMethod::Adaptive)
        .with_window_px(32)
        .with_min_contrast(24)
        .with_keep_pale(false)
}

fn otsu() -> Threshold {
    adaptive().with_method(ThresholdMethod::Otsu)
}

fn auto() -> Threshold {
    adaptive().with_method(ThresholdMethod::Auto)
}

/// Pixels of the strokes that are missing, and pixels of paper that are ink, in units of the strokes' pixels.
/// A pixel that is more than a quarter and less than three quarters covered may be either.
fn wrong(ink: &Bitmap) -> (f64, f64) {
    let (mut strokes, mut missing, mut extra) = (0, 0, 0);
    for (x, y) in (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y))) {
        let (covered, is_ink) = (coverage(x, y), ink.get(Pixel::new(x, y)));
        strokes += u32::from(covered >= 0.75);
        missing += u32::from(covered >= 0.75 && !is_ink);
        extra += u32::from(covered <= 0.25 && is_ink);
    }
    (f64::from(missing) / f64::from(strokes), f64::from(extra) / f64::from(strokes))
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn adaptive_and_auto_find_the_strokes_where_otsu_takes_the_shadow_for_ink() {
    for share in [0.2, 0.3, 0.5] {
        let scan = uneven(share);
        let (_, extra) = wrong(&otsu().apply(&scan).0);
        assert!(extra > 0.5, "ink {share}: Otsu's extra ink is only {extra}");
        let (missing, extra) = wrong(&auto().apply(&scan).0);
        assert!(
            missing <= 0.005 && extra <= 0.005,
            "ink {share}: by itself missing {missing}, extra {extra}"
        );
        let (missing, extra) = wrong(&adaptive().apply(&scan).0);
        assert!(missing <= 0.001 && extra <= 0.001, "ink {share}: missing {missing}, extra {extra}");
    }
}

#[test]
fn light_lines_on_an_uneven_dark_ground_are_found_as_well() {
    let scan = uneven(0.3);
    let (ink, split) = adaptive().apply(&scan);
    let (of_negative, split_of_negative) = adaptive().apply(&negative(&scan));
    assert_eq!((split.unwrap().ink_is_dark, split_of_negative.unwrap().ink_is_dark), (true, false));
    assert_eq!(ink, of_negative);
    // A blueprint: light multiplies here too, but little of it comes from the ground.
    let blueprint = scan_of_a_blueprint();
    let (ink, split) = adaptive().apply(&blueprint);
    assert!(!split.unwrap().ink_is_dark);
    let (missing, extra) = wrong(&ink);
    assert!(missing <= 0.001 && extra <= 0.001, "missing {missing}, extra {extra}");
}

fn scan_of_a_blueprint() -> Gray {
    let light = |x: u32| 0.6 + 0.4 * f64::from(x) / f64::from(WIDTH);
    scan(|x, y| 240.0 * light(x) * (0.15 + 0.75 * coverage(x, y)) + 6.0 * noise(x, y))
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn paper_alone_is_an_empty_sheet() {
    for method in [ThresholdMethod::Auto, ThresholdMethod::Otsu, ThresholdMethod::Adaptive] {
        let threshold = Threshold::default().with_method(method);
        for level in [0.0, 128.0, 255.0] {
            assert_eq!(threshold.apply(&scan(|_, _| level)), (Bitmap::new(WIDTH, HEIGHT).unwrap(), None));
        }
        for level in [90.0, 230.0] {
            assert_eq!(threshold.apply(&scan(|x, y| level + 8.0 * noise(x, y))).0.count(), 0);
        }
    }
    // Otsu's level splits the light; in tiles there is nothing to split.
    for threshold in [adaptive(), auto()] {
        let (ink, split) = threshold.apply(&scan(|x, y| 240.0 * light(x, y) + 6.0 * noise(x, y)));
        assert_eq!((ink.count(), split), (0, None), "{}", threshold.method);
    }
}

#[test]
fn any_shape_of_picture_is_thresholded() {
    for (width, height) in [(0, 0), (0, 5), (5, 0), (1, 1), (1, 300), (300, 1), (2, 2), (33, 47)] {
        let levels = (0..width * height).map(|i| if i % 7 == 3 { 20 } else { 230 }).collect();
        let gray = Gray::new(width, height, levels).unwrap();
        let level = ThresholdMethod::Level(99);
        for method in [ThresholdMethod::Auto, ThresholdMethod::Otsu, ThresholdMethod::Adaptive, level] {
            let (ink, _) = Threshold::default().with_method(method).apply(&gray);
            let expected = (0..u64::from(width * height)).filter(|i| i % 7 == 3).count() as u64;
            assert_eq!((ink.count(), ink.width()), (expected, width), "{width} x {height}, {method}");
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn of_salt_and_pepper_only_what_touches_the_strokes_is_left() {
    let speckled = scan(|x, y| match (noise(x + 9, y) + 1.0) / 2.0 {
        chance if chance < 0.0025 => 0.0,
        chance if chance > 0.9975 => 255.0,
        _ => 240.0 * light(x, y) * (1.0 - 0.7 * coverage(x, y)) + 6.0 * noise(x, y),
    });
    let (mut ink, _) = adaptive().apply(&speckled);
    let pen_px = pen_width_px(&ink);
    assert_eq!(pen_px, Some(3));
    let changed = despeckle(&mut ink, smallest_mark_px(pen_px.unwrap_or(0)));
    assert!(changed.removed_px > 200 && changed.filled_px > 5, "{changed:?}");
    // Far from the strokes nothing is left, inside them nothing is open, and the dot is still there.
    for (x, y) in (2..HEIGHT - 2).flat_map(|y| (2..WIDTH - 2).map(move |x| (x, y))) {
        let near = (0..5).flat_map(|dy| (0..5).map(move |dx| coverage(x + dx - 2, y + dy - 2)));
        let (least, most) = near.fold((1.0_f64, 0.0_f64), |(a, b), c| (a.min(c), b.max(c)));
        assert!(most > 0.0 || !ink.get(Pixel::new(x, y)), "a speck at {x}, {y}");
        assert!(least < 1.0 || ink.get(Pixel::new(x, y)), "a hole at {x}, {y}");
    }
    assert!(ink.get(Pixel::new(240, 60)));
    let (missing, extra) = wrong(&ink);
    assert!(missing <= 0.005 && extra <= 0.005, "missing {missing}, extra {extra}");
}

#[test]
fn the_tiles_say_how_large_an_area_may_be() {
    // A black square of 100 px: more than two tiles of 32 px, less than two of 64.
    let square = scan(|x, y| if (190..290).contains(&x) && (130..230).contains(&y) { 30.0 } else { 220.0 });
    let middle = |window_px| {
        adaptive()
            .with_window_px(window_px)
            .with_polarity(Polarity::DarkInk)
            .apply(&square)
            .0
            .get(Pixel::new(240, 180))
    };
    assert_eq!((middle(32), middle(64)), (false, true));
}
