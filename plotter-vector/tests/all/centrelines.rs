//! Strokes that a round pen draws, found again: junctions where they are, straight lines straight through.
#![allow(clippy::cast_precision_loss, reason = "a count of corners")]

use crate::segment_distance;

use plotter_vector::{
    Bitmap, Drawing, Gray, Ours, Pixel, Progress, PxPoint, Vectorizer, picture::GrayRows, report::coverage,
};
use segment_distance::segment_distance;

/// Distance of what is found from what was drawn that a raster of one bit explains: half a pixel, and half a
/// pixel of tolerance.
const NEAR_PX: f64 = 1.0;

type Stroke = Vec<PxPoint>;

fn distance<'a>(at: PxPoint, strokes: impl IntoIterator<Item = &'a [PxPoint]>) -> f64 {
    let each = |stroke: &'a [PxPoint]| {
        let pairs = stroke.windows(2).map(move |pair| segment_distance(at, pair[0], pair[1]));
        pairs.chain(stroke.iter().map(move |dot| dot.distance(at))).fold(f64::INFINITY, f64::min)
    };
    strokes.into_iter().map(each).fold(f64::INFINITY, f64::min)
}

/// The ink of a pen `pen_px` wide along strokes, on 200 x 200 px.
fn ink(strokes: &[Stroke], pen_px: f64) -> Bitmap {
    let mut ink = Bitmap::new(200, 200).unwrap();
    for y in 0..200 {
        for x in 0..200 {
            let at = Pixel::new(x, y);
            if distance(at.into(), strokes.iter().map(Vec::as_slice)) <= pen_px / 2.0 {
                ink.set(at, true);
            }
        }
    }
    ink
}

fn places(strokes: &[&[PxPoint]]) -> Vec<PxPoint> {
    let dense = |pair: &[PxPoint]| -> Vec<PxPoint> {
        let (a, b) = (pair[0], pair[1]);
        let count = (2.0 * a.distance(b)).ceil().max(1.0);
        let at = |step: f64| PxPoint::new(a.x + (b.x - a.x) * step / count, a.y + (b.y - a.y) * step / count);
        (0..1000_u16).map(f64::from).take_while(|step| *step <= count).map(at).collect()
    };
    strokes.iter().flat_map(|stroke| stroke.windows(2).flat_map(dense)).collect()
}

/// The Hausdorff distance between what was drawn and what was found, px.
fn hausdorff(drawn: &[Stroke], found: &Drawing) -> f64 {
    let drawn: Vec<&[PxPoint]> = drawn.iter().map(Vec::as_slice).collect();
    let found: Vec<&[PxPoint]> = found.strokes().collect();
    let one_way = |from: &[&[PxPoint]], to: &[&[PxPoint]]| {
        places(from).into_iter().map(|at| distance(at, to.iter().copied())).fold(0.0, f64::max)
    };
    one_way(&drawn, &found).max(one_way(&found, &drawn))
}

/// A line of `length_px` either way from the picture's middle, at an angle in degrees.
fn through(angle: f64, length_px: f64) -> Stroke {
    vec![ray(angle + 180.0, length_px)[1], ray(angle, length_px)[1]]
}

fn ray(angle: f64, length_px: f64) -> Stroke {
    let (sin, cos) = libm::sincos(angle.to_radians());
    let middle = PxPoint::new(100.3, 99.7);
    vec![middle, PxPoint::new(middle.x + length_px * cos, middle.y + length_px * sin)]
}

fn traced(strokes: &[Stroke], pen_px: f64) -> Drawing {
    Vectorizer::default().trace(&ink(strokes, pen_px)).unwrap().drawing
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn two_lines_that_cross_go_straight_through() {
    for pen_px in [3.0, 5.0, 8.0] {
        for (first, between) in [(0.0, 90.0), (10.0, 90.0), (33.0, 60.0), (71.0, 45.0), (120.0, 75.0)] {
            let cross = [through(first, 80.0), through(first + between, 80.0)];
            let found = traced(&cross, pen_px);
            let off_px = hausdorff(&cross, &found);
            assert_eq!(found.strokes().len(), 2, "{pen_px} px, {first} and {between} degrees");
            assert!(off_px <= NEAR_PX, "{pen_px} px, {first} and {between} degrees: {off_px} px");
        }
    }
}

#[test]
fn lines_that_cross_at_an_acute_angle_are_two() {
    for (first, between) in [(5.0, 12.0), (40.0, 20.0), (95.0, 25.0), (150.0, 16.0)] {
        let cross = [through(first, 90.0), through(first + between, 90.0)];
        let found = traced(&cross, 5.0);
        let off_px = hausdorff(&cross, &found);
        assert_eq!(found.strokes().len(), 2, "{first} and {between} degrees");
        assert!(off_px <= 1.5 * NEAR_PX, "{first} and {between} degrees: {off_px} px");
    }
}

#[test]
fn a_branch_meets_the_line_where_it_leaves_it() {
    for angle in [0.0, 25.0, 60.0, 90.0] {
        let tee = [through(angle, 80.0), ray(angle + 90.0, 70.0)];
        let off_px = hausdorff(&tee, &traced(&tee, 4.0));
        assert!(off_px <= NEAR_PX, "T at {angle} degrees: {off_px} px");
        let star = [ray(angle, 80.0), ray(angle + 120.0, 80.0), ray(angle + 240.0, 80.0)];
        let off_px = hausdorff(&star, &traced(&star, 4.0));
        assert!(off_px <= NEAR_PX, "Y at {angle} degrees: {off_px} px");
    }
}

#[test]
fn an_arrow_head_comes_to_one_point() {
    // The strokes of the head leave the tip at 17 degrees: at a pen of 2.5 px they are apart on half of their
    // length.
    for angle in [0.0, 20.0, 45.0, 75.0, 90.0] {
        let head = [-17.0, 17.0].map(|side| ray(angle + side, 15.7));
        let lines = [through(angle + 90.0, 12.0), ray(angle, 80.0)];
        let drawn: Vec<Stroke> = lines.into_iter().chain(head).collect();
        let found = traced(&drawn, 2.5);
        let off_px = hausdorff(&drawn, &found);
        assert!(off_px <= NEAR_PX, "at {angle} degrees: {off_px} px {found:?}");
        assert!(found.strokes().len() <= drawn.len(), "at {angle} degrees: {found:?}");
    }
}

#[test]
fn what_sticks_out_of_a_wide_pens_end_is_no_stroke() {
    // The round end of the wide line shows between the narrow ones that begin in it.
    for (first, second, third) in [(20.0, 288.0, 163.0), (345.0, 198.0, 83.0), (230.0, 85.0, 43.0)] {
        let (wide, narrow) = ([ray(first, 80.0)], [ray(second, 80.0), ray(third, 80.0)]);
        let mut both = ink(&narrow, 3.0);
        let thick = ink(&wide, 10.0);
        for at in (0..200).flat_map(|y| (0..200).map(move |x| Pixel::new(x, y))) {
            both.set(at, both.get(at) || thick.get(at));
        }
        let found = Vectorizer::default().trace(&both).unwrap().drawing;
        let off_px = hausdorff(&[&wide[..], &narrow[..]].concat(), &found);
        assert_eq!(found.strokes().len(), 2, "{first}, {second} and {third} degrees");
        assert!(off_px <= 1.5 * NEAR_PX, "{first}, {second} and {third} degrees: {off_px} px");
    }
}

/// What is found of lines that a pen `pen_px` wide drew, on 200 x 200 px with a level for each sixteenth of a
/// pixel that it covers: the same by rows as of the whole picture.
fn traced_of_levels(lines: &[Stroke], pen_px: f64) -> Drawing {
    let covered = |x: u32, y: u32| {
        let inside = |step: u32| {
            let part = |v: u32, of: u32| f64::from(v) + (f64::from(of) + 0.5) / 4.0;
            let at = PxPoint::new(part(x, step % 4), part(y, step / 4));
            distance(at, lines.iter().map(Vec::as_slice)) <= 0.5 * pen_px
        };
        (0..16).filter(|step| inside(*step)).count()
    };
    let level = |at: u32| u8::try_from(255 - 15 * covered(at % 200, at / 200)).unwrap();
    let gray = Gray::new(200, 200, (0..200 * 200).map(level).collect()).unwrap();
    let found = Vectorizer::default().vectorize(&gray).unwrap().drawing;
    let by_rows = Vectorizer::from(Ours::default().with_band_rows(37))
        .vectorize_rows(&mut GrayRows::new(gray), &mut Progress::silent());
    assert_eq!(by_rows.unwrap().drawing, found);
    found
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_line_of_one_pixel_with_grey_rims_is_one_stroke() {
    // Where a line passes between two rows, both are ink.
    let lines = [through(33.0, 80.0), through(93.0, 80.0), through(160.0, 80.0)];
    let found = traced_of_levels(&lines, 1.0);
    let off_px = hausdorff(&lines, &found);
    assert!(off_px <= NEAR_PX, "{off_px} px");
    assert!(found.strokes().len() == 3 && found.vertices() <= 8, "{found:?}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn lines_of_one_pixel_with_grey_rims_cross_straight() {
    for (first, between) in [(10.0, 90.0), (33.0, 60.0), (50.0, 80.0), (120.0, 75.0)] {
        let cross = [through(first, 80.0), through(first + between, 80.0)];
        let found = traced_of_levels(&cross, 1.0);
        let off_px = hausdorff(&cross, &found);
        assert!(
            found.strokes().len() == 2 && found.vertices() <= 6,
            "{first} and {between} degrees: {found:?}"
        );
        assert!(off_px <= NEAR_PX, "{first} and {between} degrees: {off_px} px");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_corner_of_one_pixel_with_grey_rims_is_sharp() {
    for (angle, turn) in [(7.0, 90.0), (20.0, 90.0), (47.0, 60.0), (80.0, 120.0)] {
        let corner: Stroke =
            ray(angle, 70.0).into_iter().rev().chain(ray(angle + turn, 70.0).into_iter().skip(1)).collect();
        let found = traced_of_levels(std::slice::from_ref(&corner), 1.0);
        let nearest =
            found.strokes().flatten().map(|at| at.distance(corner[1])).fold(f64::INFINITY, f64::min);
        assert_eq!(
            (found.strokes().len(), found.vertices()),
            (1, 3),
            "{angle} and {turn} degrees: {found:?}"
        );
        assert!(nearest <= 0.3, "{angle} and {turn} degrees: {nearest} px");
    }
}

#[test]
#[ignore = "long: .ci/run has it in release"]
fn a_small_circle_of_one_pixel_with_grey_rims_has_no_corners() {
    // The promised error twice, for the chords go from one side to the other.
    const MOST_PX: f64 = 0.8;
    for radius_px in [6.7, 8.3, 10.0, 11.7, 15.0, 20.0] {
        let around = |step: u16| ray(f64::from(step) * 3.0, radius_px)[1];
        let circle: Stroke = (0..=120).map(around).collect();
        let found = traced_of_levels(std::slice::from_ref(&circle), 1.0);
        let off_px = hausdorff(&[circle], &found);
        assert!(off_px <= MOST_PX, "{radius_px} px in radius: {off_px} px");
    }
}

#[test]
#[ignore = "long: .ci/run has it in release"]
fn the_corners_of_a_narrow_meander_with_grey_rims_are_kept() {
    /// Share of the corners that are found within a pixel, and their mean distance, px.
    const SHARE: f64 = 0.93;
    const MEAN_PX: f64 = 0.45;
    let mut off_px = Vec::new();
    for (step_px, high_px) in [(5.3, 9.4), (7.1, 8.3), (6.2, 18.2), (9.4, 12.1)] {
        for (pen_px, x_px) in [(1.0, 10.2), (1.5, 10.7), (1.5, 10.4)] {
            let (mut x, mut meander) = (x_px, Stroke::new());
            while x < 180.0 {
                meander.extend([(x, 90.3), (x, 90.3 + high_px)].map(|(x, y)| PxPoint::new(x, y)));
                x += step_px;
                meander.extend([(x, 90.3 + high_px), (x, 90.3)].map(|(x, y)| PxPoint::new(x, y)));
                x += step_px;
            }
            let found = traced_of_levels(std::slice::from_ref(&meander), pen_px);
            let corners = &meander[1..meander.len() - 1];
            let nearest = |corner: &PxPoint| {
                found.strokes().flatten().map(|at| at.distance(*corner)).fold(f64::INFINITY, f64::min)
            };
            off_px.extend(corners.iter().map(nearest));
        }
    }
    let count = off_px.len() as f64;
    let share = off_px.iter().filter(|off_px| **off_px <= NEAR_PX).count() as f64 / count;
    let mean_px = off_px.iter().sum::<f64>() / count;
    assert!(share >= SHARE && mean_px <= MEAN_PX, "{share} of the corners, {mean_px} px");
}

#[test]
fn lines_of_one_pixel_in_black_and_white_are_followed_whatever_their_levels() {
    // Two other levels, a little noise and a stain tell no more of where a line is.
    let stairs = |level: &dyn Fn(u32, bool) -> u8| {
        let at = |at: u32| level(at, at % 60 / 7 == at / 60);
        Gray::new(60, 60, (0..60 * 60).map(at).collect()).unwrap()
    };
    let noise = |at: u32| u8::try_from(at * 37 % 7).unwrap();
    let traced = |gray: &Gray| {
        let by_rows = Vectorizer::default()
            .vectorize_rows(&mut GrayRows::new(gray.clone()), &mut Progress::silent())
            .unwrap();
        let whole = Vectorizer::default().vectorize(gray).unwrap();
        assert_eq!(by_rows.drawing, whole.drawing);
        whole
    };
    let expected = traced(&stairs(&|_, is_ink| if is_ink { 0 } else { 255 }));
    let two = traced(&stairs(&|_, is_ink| if is_ink { 20 } else { 240 }));
    let noisy = traced(&stairs(&|at, is_ink| noise(at) + if is_ink { 20 } else { 240 }));
    let stained = traced(&stairs(&|at, is_ink| if at == 3500 { 190 } else { 255 * u8::from(!is_ink) }));
    assert_eq!([&two, &noisy, &stained].map(|traced| traced.split.unwrap().has_greys), [false, true, true]);
    for found in [two, noisy, stained] {
        assert_eq!((&found.drawing, &found.error), (&expected.drawing, &expected.error));
    }
}

#[test]
fn a_corner_is_sharp_and_one_vertex() {
    for (angle, turn) in [(0.0, 90.0), (20.0, 90.0), (47.0, 60.0), (80.0, 120.0)] {
        let corner: Stroke =
            ray(angle, 70.0).into_iter().rev().chain(ray(angle + turn, 70.0).into_iter().skip(1)).collect();
        let found = traced(std::slice::from_ref(&corner), 5.0);
        let off_px = hausdorff(std::slice::from_ref(&corner), &found);
        assert_eq!((found.strokes().len(), found.vertices()), (1, 3), "{angle} and {turn} degrees");
        assert!(off_px <= NEAR_PX, "{angle} and {turn} degrees: {off_px} px");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_circle_closes_and_keeps_its_radius() {
    for radius_px in [8.3, 20.0, 60.4, 90.0] {
        let at = |step: u32| {
            let (sin, cos) = libm::sincos(f64::from(step) / 400.0 * core::f64::consts::TAU);
            PxPoint::new(100.3 + radius_px * cos, 99.7 + radius_px * sin)
        };
        let circle: Vec<Stroke> = vec![(0..=400).map(at).collect()];
        let found = traced(&circle, 3.0);
        assert_eq!(found.strokes().len(), 1);
        assert_eq!(found.stroke(0).first(), found.stroke(0).last());
        let off_px = hausdorff(&circle, &found);
        assert!(off_px <= 0.75, "radius {radius_px} px: {off_px} px");
    }
}

#[test]
fn a_pen_of_the_lines_width_covers_all_of_the_ink() {
    let drawn = [through(12.0, 80.0), through(97.0, 80.0)];
    let ink = ink(&drawn, 5.0);
    assert!(coverage(&ink, &traced(&drawn, 5.0)).max_px <= NEAR_PX);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_dot_is_one_place_wherever_the_raster_puts_it() {
    // At all eighths of a pixel.
    let at = |i: u32| 20.0 * f64::from(i + 1) + f64::from(i) / 8.0;
    let dots: Vec<Stroke> = (0..64).map(|i| vec![PxPoint::new(at(i % 8), at(i / 8))]).collect();
    let found = Vectorizer::default().trace(&ink(&dots, 3.0)).unwrap().drawing;
    assert_eq!(found.strokes().count(), dots.len());
    for dot in dots {
        let near = |stroke: &[PxPoint]| stroke.len() == 1 && stroke[0].distance(dot[0]) < 0.6;
        assert!(found.strokes().any(near), "{dot:?}");
    }
}

#[test]
fn dots_stay_dots() {
    let dots: Vec<Stroke> =
        [(20.5, 20.5), (60.5, 20.5), (100.5, 60.5)].map(|(x, y)| vec![PxPoint::new(x, y)]).to_vec();
    let line = vec![vec![PxPoint::new(10.5, 150.5), PxPoint::new(190.5, 150.5)]];
    let all: Vec<Stroke> = dots.iter().cloned().chain(line).collect();
    let found = traced(&all, 4.0);
    for dot in dots {
        assert!(
            found.strokes().any(|stroke| stroke.len() == 1 && stroke[0].distance(dot[0]) < 0.75),
            "{dot:?}"
        );
    }
}
