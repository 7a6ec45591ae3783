//! Straight lines of a pen at 1 bit a pixel, turned a little against the raster: a segment each, that ends
//! where the pen did.
//!
//! `cargo test --release -p plotter-vector --test all straight_lines:: -- --nocapture` prints what
//! comes of each width.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::print_stdout,
    reason = "a failure shows, and places are small"
)]

use crate::pen_ink;
use crate::segment_distance;

use pen_ink::{Line, ink_of};
use plotter_vector::{Drawing, PxPoint, Vectorizer};
use segment_distance::segment_distance;

const SIDE_PX: u32 = 400;

const WIDTHS_PX: [f64; 6] = [2.0, 2.5, 3.0, 4.0, 5.0, 9.0];

/// From steps of 330 px to those of a pixel.
const ANGLES_RAD: [f64; 9] = [0.003, 0.01, 0.02, 0.05, 0.1, 0.2, 0.35, 0.6, core::f64::consts::FRAC_PI_4];

/// What a raster of one bit leaves open: half a pixel to each side of a line that rises by less than one, and
/// along it where a round end stops.
const BESIDE_PX: f64 = 0.75;
const END_PX: f64 = 1.25;

/// A corner of 20 degrees is three times as far from where it seems to be as its sides are beside theirs.
const CORNER_PX: f64 = 3.0 * BESIDE_PX;

/// A place, turned about the middle of the picture.
fn turned(angle_rad: f64, x: f64, y: f64) -> PxPoint {
    let (sine, cosine) = libm::sincos(angle_rad);
    PxPoint::new(200.13 + x * cosine - y * sine, 200.37 + x * sine + y * cosine)
}

/// Seven ruled lines that end at different parts of a pixel.
fn ruled(angle_rad: f64) -> Vec<Line> {
    let line = |step: u32| {
        let (y, part) = (30.0 * f64::from(step) - 90.0, 3.3 * f64::from(step));
        [turned(angle_rad, part - 120.0, y), turned(angle_rad, 120.0 - 1.7 * part, y)]
    };
    (0..7).map(line).collect()
}

/// Five lines across five.
fn grid(angle_rad: f64) -> Vec<Line> {
    let pair = |step: u32| {
        let across = 40.0 * f64::from(step) - 80.0;
        [
            [turned(angle_rad, across, -100.0), turned(angle_rad, across, 100.0)],
            [turned(angle_rad, -100.0, across), turned(angle_rad, 100.0, across)],
        ]
    };
    (0..5).flat_map(pair).collect()
}

fn traced(lines: &[Line], width_px: f64) -> Drawing {
    Vectorizer::default().trace(&ink_of(SIDE_PX, lines, width_px)).unwrap().drawing
}

/// How far a drawing's vertices lie beside the lines, and the lines' ends from its vertices, px.
fn off_px(drawing: &Drawing, lines: &[Line]) -> (f64, f64) {
    let vertices: Vec<PxPoint> = drawing.strokes().flatten().copied().collect();
    let beside = |at: &PxPoint| {
        // Lines as long as they like: an end is measured by itself.
        lines.iter().map(|[a, b]| beyond(*a, *b, *at)).fold(f64::INFINITY, f64::min)
    };
    let from_end = |end: &PxPoint| vertices.iter().map(|at| at.distance(*end)).fold(f64::INFINITY, f64::min);
    (
        vertices.iter().map(beside).fold(0.0, f64::max),
        lines.iter().flatten().map(from_end).fold(0.0, f64::max),
    )
}

/// How far a place is from a line that goes on for 3 px at both ends.
fn beyond(from: PxPoint, to: PxPoint, at: PxPoint) -> f64 {
    let length_px = from.distance(to);
    let (u, v) = (3.0 * (to.x - from.x) / length_px, 3.0 * (to.y - from.y) / length_px);
    segment_distance(at, PxPoint::new(from.x - u, from.y - v), PxPoint::new(to.x + u, to.y + v))
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_straight_line_is_a_segment_at_any_width_and_angle() {
    for (name, lines_at) in [("ruled", ruled as fn(f64) -> Vec<Line>), ("grid", grid)] {
        // Crossings of wider lines so near each other may be found farther aside than a stretch goes over.
        for width_px in WIDTHS_PX.into_iter().filter(|width_px| name == "ruled" || *width_px <= 5.0) {
            let (mut lines, mut vertices, mut strokes) = (0, 0, 0);
            let mut greatest = (0.0_f64, 0.0_f64);
            for angle_rad in ANGLES_RAD {
                let all = lines_at(angle_rad);
                let drawing = traced(&all, width_px);
                let off = off_px(&drawing, &all);
                greatest = (greatest.0.max(off.0), greatest.1.max(off.1));
                lines += all.len();
                vertices += drawing.vertices();
                strokes += drawing.strokes().len();
            }
            println!(
                "{name}, {width_px} px: {lines} lines, {strokes} strokes, {vertices} vertices, beside {:.2} px, ends {:.2} px",
                greatest.0, greatest.1
            );
            assert_eq!(strokes, lines, "{name}, {width_px} px");
            // A line in a hundred has an end that is found too late.
            assert!(vertices <= 2 * lines + lines / 50, "{name}, {width_px} px: {vertices} of {lines}");
            assert!(greatest.0 <= BESIDE_PX && greatest.1 <= END_PX, "{name}, {width_px} px: {greatest:?}");
        }
    }
}

#[test]
fn a_polygon_of_straight_sides_has_its_corners_where_the_sides_meet() {
    // Sides of 70 px, each turned by 20 degrees: too little for a corner, and no arc's.
    for width_px in WIDTHS_PX {
        let mut places = vec![PxPoint::new(60.3, 320.2)];
        for side in 0..5 {
            let (sine, cosine) = libm::sincos(0.1 - 0.35 * f64::from(side));
            let from = places.last().copied().unwrap();
            places.push(PxPoint::new(from.x + 70.0 * cosine, from.y + 70.0 * sine));
        }
        let lines: Vec<Line> = places.windows(2).map(|pair| [pair[0], pair[1]]).collect();
        let drawing = traced(&lines, width_px);
        println!("polygon, {width_px} px: {:?}", drawing.stroke(0));
        assert_eq!((drawing.strokes().len(), drawing.vertices()), (1, places.len()), "{width_px} px");
        let (beside_px, corner_px) = off_px(&drawing, &lines);
        assert!(beside_px <= BESIDE_PX && corner_px <= CORNER_PX, "{width_px} px: {beside_px} {corner_px}");
    }
}

#[test]
fn an_arc_stays_as_round_as_it_was() {
    // A chord whose ends lie t outside a circle and whose middle lies t inside is 4 √(t r) long: at 0.425 px
    // 21 to 42 on a circle. Straight stretches of its raster would give it more, and move it off the circle.
    for (radius_px, most) in [(50.3, 21), (110.3, 27), (170.3, 34)] {
        let steps = 720;
        let place = |step: u32| {
            let (sine, cosine) = libm::sincos(core::f64::consts::TAU * f64::from(step) / f64::from(steps));
            PxPoint::new(200.2 + radius_px * cosine, 199.7 + radius_px * sine)
        };
        let lines: Vec<Line> = (0..steps).map(|step| [place(step), place(step + 1)]).collect();
        let drawing = traced(&lines, 3.0);
        let off_px = drawing
            .stroke(0)
            .iter()
            .map(|at| (at.distance(PxPoint::new(200.2, 199.7)) - radius_px).abs())
            .fold(0.0, f64::max);
        println!("circle of {radius_px} px: {} vertices, {off_px:.2} px off", drawing.vertices());
        assert_eq!(drawing.strokes().len(), 1);
        assert!(drawing.vertices() <= most && off_px <= 0.75, "{radius_px}: {drawing:?} {off_px}");
    }
}
