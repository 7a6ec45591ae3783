//! Lines that cross, or end on one another, in a picture whose rim cuts them all: what a camera sees of a
//! larger drawing, and a scan of a part of it.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "places on pictures of 340 px, and parts of 1"
)]

use crate::off_lines;
use crate::random;

use off_lines::off_px;
use plotter_vector::follow::{CameraSettings, Paper, SimulatedCamera};
use plotter_vector::{Bitmap, Gray, Pixel, PxPoint, Vectorizer};
use random::Random;

const SIDE: f64 = 300.0;

/// Junctions lie at least as far within the picture, and the rim cuts lines at least as far from its corners
/// and from each other, px.
const INSIDE_PX: f64 = 20.0;
const APART_PX: f64 = 30.0;

/// Lines differ in direction by more, and meet the rim at more, rad.
const LEAST_ANGLE: f64 = 0.45;

type Line = [PxPoint; 2];

/// The way from one place to another.
fn way(from: PxPoint, to: PxPoint) -> (f64, f64) {
    (to.x - from.x, to.y - from.y)
}

fn along(from: PxPoint, way: (f64, f64), part: f64) -> PxPoint {
    PxPoint::new(from.x + part * way.0, from.y + part * way.1)
}

/// How far within the picture a place is, px.
fn inside_px(at: PxPoint) -> f64 {
    at.x.min(at.y).min(SIDE - at.x).min(SIDE - at.y)
}

/// The part of a line within the picture.
fn cut([from, to]: Line) -> Option<Line> {
    let off = way(from, to);
    let mut parts = (0.0_f64, 1.0_f64);
    for (at, d) in [(from.x, off.0), (from.y, off.1)] {
        let (low, high) = ((0.0 - at) / d, (SIDE - at) / d);
        parts = (parts.0.max(low.min(high)), parts.1.min(low.max(high)));
    }
    (parts.1 > parts.0).then(|| [parts.0, parts.1].map(|part| along(from, off, part)))
}

fn angle([a, b]: Line) -> f64 {
    libm::atan2(b.y - a.y, b.x - a.x)
}

/// The least angle between two lines, whichever way they go.
fn between(one: f64, other: f64) -> f64 {
    let off = libm::fabs(one - other) % core::f64::consts::PI;
    off.min(core::f64::consts::PI - off)
}

/// Where two lines meet.
fn meet([a, b]: Line, [c, d]: Line) -> Option<PxPoint> {
    let ((ux, uy), (vx, vy)) = (way(a, b), way(c, d));
    let (x, y) = way(a, c);
    let cross = ux * vy - uy * vx;
    let (s, t) = ((x * vy - y * vx) / cross, (x * uy - y * ux) / cross);
    let on = |part: f64| (-1e-9..=1.0 + 1e-9).contains(&part);
    (on(s) && on(t)).then(|| along(a, (ux, uy), s))
}

/// Two or three lines across the picture and one that ends on the first one, if they can be told apart.
fn drawing(random: &mut Random) -> Option<Vec<Line>> {
    let turn = |random: &mut Random| core::f64::consts::TAU * random.unit();
    let across = |random: &mut Random| {
        let middle = PxPoint::new(SIDE * random.unit(), SIDE * random.unit());
        let (y, x) = libm::sincos(turn(random));
        [-400.0, 400.0].map(|part| along(middle, (x, y), part))
    };
    let mut lines: Vec<Line> = (0..if random.unit() < 0.5 { 2 } else { 3 }).map(|_| across(random)).collect();
    let first = cut(lines[0])?;
    let foot = along(first[0], way(first[0], first[1]), 0.2 + 0.6 * random.unit());
    let (y, x) = libm::sincos(turn(random));
    lines.push([foot, along(foot, (x, y), 400.0)]);
    let mut ends: Vec<PxPoint> =
        [(0.0, 0.0), (0.0, SIDE), (SIDE, 0.0), (SIDE, SIDE)].map(|(x, y)| PxPoint::new(x, y)).to_vec();
    let mut met: Vec<PxPoint> = Vec::new();
    for (i, line) in lines.iter().enumerate() {
        let [from, to] = cut(*line)?;
        let course = angle(*line);
        for end in [from, to].into_iter().filter(|end| inside_px(*end) < 1.0) {
            let is_level = end.y.min(SIDE - end.y) < 1.0;
            let steep = between(course, if is_level { 0.0 } else { core::f64::consts::FRAC_PI_2 });
            if steep < LEAST_ANGLE || ends.iter().any(|other| other.distance(end) < APART_PX) {
                return None;
            }
            ends.push(end);
        }
        for other in &lines[..i] {
            if between(course, angle(*other)) < LEAST_ANGLE {
                return None;
            }
            if let Some(at) = meet(*line, *other).filter(|at| inside_px(*at) > -INSIDE_PX) {
                if inside_px(at) < INSIDE_PX || met.iter().any(|known| known.distance(at) < APART_PX) {
                    return None;
                }
                met.push(at);
            }
        }
    }
    lines.into_iter().map(cut).collect()
}

fn bits(gray: &Gray) -> Bitmap {
    let mut ink = Bitmap::new(gray.width(), gray.height()).unwrap();
    for (y, row) in (0..).zip(gray.rows()) {
        (0..).zip(row).for_each(|(x, level)| ink.set(Pixel::new(x, y), *level < 128));
    }
    ink
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn lines_go_straight_through_up_to_the_rim_that_cuts_them() {
    const PICTURES: u64 = 40;
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut drawings = Vec::new();
    while drawings.len() < PICTURES as usize {
        let pen_px = 3.0 + 5.0 * random.unit();
        drawings.extend(drawing(&mut random).map(|lines| (pen_px, lines)));
    }
    let (mut split, mut off) = (Vec::new(), Vec::new());
    for (seed, (pen_px, lines)) in (0..).zip(&drawings) {
        // The paper is larger than the picture.
        const MARGIN: f64 = 20.0;
        let shifted = |at: PxPoint| PxPoint::new(at.x + MARGIN, at.y + MARGIN);
        let beyond = |line: &Line| {
            let part = MARGIN * 2.0 / line[0].distance(line[1]);
            let off = way(line[0], line[1]);
            let out =
                |end: PxPoint, part: f64| if inside_px(end) < 1.0 { along(end, off, part) } else { end };
            vec![shifted(out(line[0], -part)), shifted(out(line[1], part))]
        };
        let strokes: Vec<_> = lines.iter().map(|line| (beyond(line), *pen_px)).collect();
        let side = (SIDE + 2.0 * MARGIN) as u32;
        let paper = Paper::drawn(side, side, &strokes).unwrap();
        let window = |blur_px: f64, noise_levels: f64| {
            let settings = CameraSettings::default()
                .with_blur_px(blur_px)
                .with_noise_levels(noise_levels)
                .with_rim_light(1.0)
                .with_seed(seed);
            SimulatedCamera::new(&paper, settings)
                .window(PxPoint::new(f64::from(side) / 2.0, f64::from(side) / 2.0))
        };
        let seen = Vectorizer::default().vectorize(&window(1.5, 4.0)).unwrap().drawing;
        let scanned = Vectorizer::default().trace(&bits(&window(0.0, 0.0))).unwrap().drawing;
        for (kind, found) in [("seen", &seen), ("scanned", &scanned)] {
            let (strokes, off_px) = (found.strokes().len(), off_px(lines, found));
            if strokes != lines.len() {
                split.push(format!("{kind} {seed}: {strokes} strokes of {} lines {lines:?}", lines.len()));
            }
            if off_px > 1.5 {
                off.push(format!("{kind} {seed}: {off_px:.2} px {lines:?}"));
            }
        }
    }
    assert!(split.is_empty(), "{} split: {split:#?}", split.len());
    assert!(off.is_empty(), "{} off: {off:#?}", off.len());
}
