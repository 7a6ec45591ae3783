//! Drawings as people have them: faint, ruled, enlarged, broken, photographed on a table; found without being
//! told.
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "levels are made to fit")]

use plotter_vector::{
    Gray, PxPoint, Vectorizer,
    picture::GrayRows,
    trace::{Progress, Vectorized},
};

const WIDTH: u32 = 420;
const HEIGHT: u32 = 360;

/// Two straight lines, a bend and a circle, as segments of polylines.
fn lines() -> Vec<Vec<PxPoint>> {
    let at = |x: f64, y: f64| PxPoint::new(x, y);
    let circle = (0..=72).map(|i| {
        let (sin, cos) = (f64::from(i) * 5.0).to_radians().sin_cos();
        at(290.0 + 60.0 * cos, 230.0 + 60.0 * sin)
    });
    vec![
        vec![at(60.0, 70.0), at(370.0, 82.0)],
        vec![at(70.0, 130.0), at(150.0, 300.0)],
        vec![at(180.0, 120.0), at(330.0, 120.0), at(330.0, 150.0)],
        circle.collect(),
    ]
}

fn far_from(at: PxPoint, stroke: &[PxPoint]) -> f64 {
    let to = |pair: &[PxPoint]| {
        let (away, way) = (at - pair[0], pair[1] - pair[0]);
        let share = (away.dot(way) / way.dot(way).max(1e-9)).clamp(0.0, 1.0);
        (away - way * share).length()
    };
    stroke.windows(2).map(to).fold(f64::INFINITY, f64::min)
}

fn far(at: PxPoint, strokes: &[Vec<PxPoint>]) -> f64 {
    strokes.iter().map(|stroke| far_from(at, stroke)).fold(f64::INFINITY, f64::min)
}

/// How much of a place a pen of so many px covers.
fn covered(x: f64, y: f64, pen_px: f64) -> f64 {
    (pen_px / 2.0 + 0.5 - far(PxPoint::new(x + 0.5, y + 0.5), &lines())).clamp(0.0, 1.0)
}

/// A hash of a place: even in 0 to 1.
fn hash(x: u32, y: u32, seed: u32) -> f64 {
    let mut n =
        x.wrapping_mul(7919).wrapping_add(y.wrapping_mul(104_729)).wrapping_add(seed.wrapping_mul(31_337));
    n = (n ^ n >> 15).wrapping_mul(0x2c1b_3c6d);
    n = (n ^ n >> 12).wrapping_mul(0x297a_2d39);
    f64::from(n ^ n >> 15) / f64::from(u32::MAX)
}

/// Noise of about a standard deviation of 1.
fn noise(x: u32, y: u32) -> f64 {
    (0..4).map(|seed| hash(x, y, seed)).sum::<f64>() * 1.73 - 3.46
}

fn picture(level: impl Fn(u32, u32) -> f64) -> Gray {
    let places = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
    Gray::new(WIDTH, HEIGHT, places.map(|(x, y)| level(x, y).round().clamp(0.0, 255.0) as u8).collect())
        .unwrap()
}

/// How much of some strokes lies near others.
fn share_near(of: &[Vec<PxPoint>], near: &[Vec<PxPoint>]) -> f64 {
    let steps = |stroke: &Vec<PxPoint>| -> Vec<PxPoint> {
        let along = |pair: &[PxPoint]| {
            let (from, way) = (pair[0], pair[1] - pair[0]);
            (0..=way.length() as u32)
                .map(move |step| from + way * (f64::from(step) / way.length().max(1.0)))
                .collect::<Vec<_>>()
        };
        stroke.windows(2).flat_map(along).collect()
    };
    // Places of pixels have their middle at .5 on both sides.
    let places: Vec<PxPoint> = of.iter().flat_map(steps).collect();
    let close = places.iter().filter(|at| far(**at, near) <= 1.5).count();
    close as f64 / places.len().max(1) as f64
}

fn strokes_of(found: &Vectorized) -> Vec<Vec<PxPoint>> {
    found.drawing.strokes().map(<[PxPoint]>::to_vec).collect()
}

/// Traces it, whole and by rows, which must be the same, and asks for all of the lines, for nothing else, and
/// for about as many strokes as were drawn.
fn assert_found(name: &str, gray: Gray) -> Vectorized {
    let found = Vectorizer::default().vectorize(&gray).unwrap();
    let by_rows =
        Vectorizer::default().vectorize_rows(&mut GrayRows::new(gray), &mut Progress::silent()).unwrap();
    assert_eq!((&by_rows.drawing, by_rows.look), (&found.drawing, found.look), "{name}");
    let strokes = strokes_of(&found);
    let (recall, precision) = (share_near(&lines(), &strokes), share_near(&strokes, &lines()));
    assert!(recall >= 0.98 && precision >= 0.97, "{name}: recall {recall:.3}, precision {precision:.3}");
    assert!((3..=6).contains(&strokes.len()), "{name}: {} strokes", strokes.len());
    found
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_clean_drawing_needs_one_level_and_no_look() {
    let found = assert_found("clean", picture(|x, y| 250.0 - 220.0 * covered(x.into(), y.into(), 4.0)));
    assert_eq!(found.look, None);
    assert!(found.split.is_some());
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn faint_lines_are_found_and_an_empty_sheet_with_the_same_noise_stays_empty() {
    let paper = |x, y| 228.0 + 3.0 * noise(x, y);
    let found = assert_found("faint", picture(|x, y| paper(x, y) - 20.0 * covered(x.into(), y.into(), 4.0)));
    assert!(found.look.is_some_and(|look| (10.0..30.0).contains(&look.ink_levels)), "{:?}", found.look);
    let nothing = Vectorizer::default().vectorize(&picture(paper)).unwrap();
    assert_eq!((nothing.drawing.strokes().len(), nothing.split), (0, None));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn close_hatching_of_faint_lines_is_not_taken_for_noise() {
    let steps = |first: u32, end: u32| (first..end).step_by(13).map(f64::from);
    let at = |x: f64, y: f64| PxPoint::new(x, y);
    let across = steps(30, 330).map(|y| vec![at(60.0, y), at(390.0, y)]);
    let down = steps(60, 391).map(|x| vec![at(x, 30.0), at(x, 329.0)]);
    let hatching: Vec<Vec<PxPoint>> = across.chain(down).collect();
    let level = |x: u32, y: u32| {
        let far = far(at(f64::from(x) + 0.5, f64::from(y) + 0.5), &hatching);
        228.0 - 18.0 * (2.0 - far).clamp(0.0, 1.0) + 2.5 * noise(x, y)
    };
    // Beside it is as much paper without lines.
    let places = (0..360).flat_map(|y| (0..900).map(move |x| (x, y)));
    let levels = places.map(|(x, y)| level(x, y).round().clamp(0.0, 255.0) as u8).collect();
    let found = Vectorizer::default().vectorize(&Gray::new(900, 360, levels).unwrap()).unwrap();
    let (recall, precision) =
        (share_near(&hatching, &strokes_of(&found)), share_near(&strokes_of(&found), &hatching));
    assert!(recall >= 0.98 && precision >= 0.97, "recall {recall:.3}, precision {precision:.3}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_edge_of_a_shadow_across_the_drawing_is_no_edge_of_the_sheet() {
    // A hand's, over a third of the paper; its edge is as soft as a lamp is wide.
    let light = |x: u32, y: u32| {
        let into = (f64::from(x) + 0.4 * f64::from(y) - 340.0) / 5.0;
        1.0 - 0.45 / (1.0 + (-into).exp())
    };
    let level =
        |x: u32, y: u32| light(x, y) * (230.0 - 180.0 * covered(x.into(), y.into(), 4.0)) + 2.0 * noise(x, y);
    let found = assert_found("shadow", picture(level));
    assert_eq!(found.look.map(|look| look.sheet), Some(None));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_photograph_with_shade_and_a_reflection_is_found() {
    let light = |x: u32, y: u32| {
        let (x, y) = (f64::from(x) / f64::from(WIDTH), f64::from(y) / f64::from(HEIGHT));
        let patch = 1.0 / (1.0 + (((x - 0.3) / 0.12).powi(4) + ((y - 0.6) / 0.2).powi(4)));
        0.55 + 0.35 * x + 0.2 * patch
    };
    let level =
        |x, y| light(x, y) * (210.0 - 150.0 * covered(f64::from(x), f64::from(y), 4.0)) + 4.0 * noise(x, y);
    assert_found("photograph", picture(level));
    let negative = picture(|x, y| 255.0 - level(x, y));
    let found = Vectorizer::default().vectorize(&negative).unwrap();
    assert!(found.look.is_none_or(|look| look.light_ink), "{:?}", found.look);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn ruled_paper_is_told_from_the_drawing_and_kept_where_that_is_asked() {
    let ruled = |x: u32, y: u32| if x % 30 < 2 || y % 30 < 2 { 40.0 } else { 0.0 };
    let level = |x: u32, y: u32| {
        let ink = covered(x.into(), y.into(), 5.0);
        225.0 - ruled(x, y) * (1.0 - ink) - 190.0 * ink + 2.0 * noise(x, y) - f64::from(x) / 8.0
    };
    let found = assert_found("ruled", picture(level));
    assert!(found.look.is_some_and(|look| look.pale_levels.is_some()), "{:?}", found.look);
    let mut keeps = Vectorizer::default();
    keeps.threshold.keep_pale = true;
    let with_ruling = keeps.vectorize(&picture(level)).unwrap();
    assert!(with_ruling.drawing.pen_down_px() > 4.0 * found.drawing.pen_down_px());
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn enlarged_pixels_become_smooth_lines() {
    for k in [3, 4] {
        let own = |x: u32, y: u32| {
            let middle = |at: u32| f64::from(at / k * k) + f64::from(k) / 2.0 - 0.5;
            // A pixel of the small picture is covered by as much as a larger pen covers its middle.
            let far = far(PxPoint::new(middle(x) + 0.5, middle(y) + 0.5), &lines());
            ((2.0 + f64::from(k) / 2.0 - far) / f64::from(k)).clamp(0.0, 1.0)
        };
        assert_found(&format!("enlarged {k} times"), picture(|x, y| 250.0 - 220.0 * own(x, y)));
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_pencil_line_beside_a_pen_is_found_too() {
    // The circle and the bend are of pencil.
    let pale = |x: u32, y: u32| y > 95 && x > 160;
    let level =
        |x: u32, y: u32| 255.0 - if pale(x, y) { 95.0 } else { 229.0 } * covered(x.into(), y.into(), 3.0);
    assert_found("pencil and pen", picture(level));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn strokes_with_gaps_of_grain_are_whole() {
    // Grain of two by two pixels: a third of them is bare.
    let level = |x: u32, y: u32| {
        let grain = if hash(x / 2, y / 2, 9) < 0.33 { 0.15 } else { 1.0 };
        240.0 - 120.0 * grain * covered(x.into(), y.into(), 5.0) + 2.0 * noise(x, y)
    };
    let found = assert_found("pencil", picture(level));
    assert!(found.look.is_some(), "grain was taken for even");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn what_lies_beside_the_sheet_is_no_ink() {
    let on_sheet = |x: u32, y: u32| (20..400).contains(&x) && (25..335).contains(&y);
    let wood =
        |x: u32, y: u32| 90.0 + 18.0 * (f64::from(y) / 3.0 + f64::from(x) / 40.0).sin() + 5.0 * noise(x, y);
    let level = |x: u32, y: u32| {
        if on_sheet(x, y) {
            225.0 - 190.0 * covered(x.into(), y.into(), 4.0) + 2.0 * noise(x, y)
        } else {
            wood(x, y)
        }
    };
    let found = assert_found("on a table", picture(level));
    // What is beside it has no say in what paper and lines are.
    assert!(found.look.is_some_and(|look| !look.broken && look.noise_levels < 3.0), "{:?}", found.look);
    let corners = found.look.and_then(|look| look.sheet).unwrap();
    let expected = [(20.0, 25.0), (400.0, 25.0), (400.0, 335.0), (20.0, 335.0)];
    for ((x, y), (true_x, true_y)) in corners.into_iter().zip(expected) {
        assert!((x - true_x as f32).abs() < 8.0 && (y - true_y as f32).abs() < 8.0, "({x}, {y})");
    }
}
