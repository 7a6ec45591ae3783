//! Two lines that meet at an acute angle: one stroke with a corner where the pen turned, although the ink
//! between them is filled.
//!
//! `cargo test --release -p plotter-vector --test all sharp_points:: -- --nocapture` prints what
//! comes of each angle.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::print_stdout,
    reason = "a failure shows, and grey values are small"
)]

use crate::segment_distance;

use plotter_vector::{Gray, Pixel, PxPoint, Vectorizer};
use segment_distance::segment_distance;

const SIDE: u32 = 300;

/// Each side's length.
const SIDE_PX: f64 = 120.0;

const ANGLES_DEG: [f64; 9] = [8.0, 10.0, 12.0, 14.0, 17.0, 20.0, 25.0, 30.0, 40.0];

/// Directions that a point is tried in.
const TURNS: u32 = 12;

/// The ends of a V and its point between them: at another part of a pixel in each direction.
fn sharp_v(angle_deg: f64, turn: u32) -> [PxPoint; 3] {
    let part = |step: u32| f64::from(turn * step % TURNS) / f64::from(TURNS);
    let angle = f64::from(turn) * core::f64::consts::TAU / f64::from(TURNS) + 0.003 * angle_deg;
    let half = 0.5 * angle_deg.to_radians();
    let middle = 0.5 * f64::from(SIDE);
    let (sine, cosine) = libm::sincos(angle);
    let point =
        PxPoint::new(middle + part(5) + 0.5 * SIDE_PX * cosine, middle + part(7) + 0.5 * SIDE_PX * sine);
    let end = |angle: f64| {
        let (sine, cosine) = libm::sincos(angle);
        PxPoint::new(point.x - SIDE_PX * cosine, point.y - SIDE_PX * sine)
    };
    [end(angle - half), point, end(angle + half)]
}

/// What a pen leaves: pixels whose middles it reaches, or as dark as it covers them.
fn picture([from, point, to]: [PxPoint; 3], width_px: f64, is_grey: bool) -> Gray {
    let levels = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| PxPoint::from(Pixel::new(x, y))));
    let level = |at: PxPoint| {
        let off_px = segment_distance(at, from, point).min(segment_distance(at, point, to));
        let paper = (off_px - 0.5 * width_px + 0.5).clamp(0.0, 1.0);
        let paper = if is_grey { paper } else { (paper - 1e-9).round() };
        (255.0 * paper) as u8
    };
    Gray::new(SIDE, SIDE, levels.map(level).collect()).unwrap()
}

/// Of all directions: how often it came out as one stroke of three vertices, and how far the nearest vertex
/// is from the point, px: the mean and the most.
fn found(angle_deg: f64, width_px: f64, is_grey: bool) -> (u32, f64, f64) {
    let (mut right, mut sum, mut most) = (0, 0.0_f64, 0.0_f64);
    for turn in 0..TURNS {
        let v = sharp_v(angle_deg, turn);
        let drawing = Vectorizer::default().vectorize(&picture(v, width_px, is_grey)).unwrap().drawing;
        let strokes: Vec<&[PxPoint]> = drawing.strokes().collect();
        right += u32::from(strokes.len() == 1 && strokes.concat().len() == 3);
        let off_px = strokes.concat().iter().map(|at| at.distance(v[1])).fold(f64::INFINITY, f64::min);
        (sum, most) = (sum + off_px, most.max(off_px));
    }
    (right, sum / f64::from(TURNS), most)
}

/// Least of [`TURNS`] that are one stroke with one corner, from 10 degrees on: of a pen of 3 px all is as
/// wide as the raster's error.
const RIGHT: u32 = 9;

/// Least share of all, and how far the corners are from the points in the mean, px.
const ALL_RIGHT: f64 = 0.94;
const MEAN_PX: f64 = 0.6;

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn sharp_points_are_corners_of_one_stroke() {
    let mut all_right = 0;
    let pens = [3.0, 5.0, 7.0].into_iter().flat_map(|px| [(px, false), (px, true)]);
    println!("| pen | {} |", ANGLES_DEG.map(|deg| format!("{deg}°")).join(" | "));
    for (width_px, is_grey) in pens {
        let all = ANGLES_DEG.map(|deg| found(deg, width_px, is_grey));
        let cells = all.map(|(right, mean, most)| format!("{right}: {mean:.2}, {most:.2}"));
        println!("| {width_px} px{} | {} |", if is_grey { ", grey" } else { "" }, cells.join(" | "));
        for (deg, (right, mean_px, _)) in ANGLES_DEG.into_iter().zip(all) {
            all_right += right;
            let is_sharp = deg >= 10.0;
            assert!(
                !is_sharp || right >= RIGHT && mean_px <= MEAN_PX,
                "{width_px} px {deg}°: {right}, {mean_px}"
            );
        }
    }
    let share = f64::from(all_right) / f64::from(6 * 9 * TURNS);
    println!("{all_right} in all, {:.1} %", 100.0 * share);
    assert!(share >= ALL_RIGHT);
}
