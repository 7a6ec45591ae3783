//! What the pen leaves bare of drawings that a pen has made: by code that shares nothing with the library's
//! own measure.
//!
//! `cargo test --release -p plotter-vector --test all bare_ink:: -- --ignored --nocapture` prints the table
//! of docs/results/bare-ink.md.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a failure shows")]

use crate::figure::Figure;
use crate::pen_ink::{Line, ink_of};
use crate::random::Random;
use crate::segment_distance::segment_distance;
use core::f64::consts::TAU;
use plotter_vector::{Bitmap, Drawing, Ours, Pixel, Prefer, PxPoint, Vectorizer};
use std::collections::BTreeSet;

pub(crate) const SIDE_PX: u32 = 200;

/// The tolerance of all of it, px.
pub(crate) const WITHIN_PX: f64 = 0.5;

pub(crate) const PENS_PX: [f64; 8] = [1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0];

/// A drawing of lines, circles, tangents, zigzags and dots.
pub(crate) fn drawing(seed: u64) -> Vec<Line> {
    let mut numbers = Random(0x9e37_79b9_7f4a_7c15 ^ seed.wrapping_mul(0x2545_f491_4f6c_dd1d));
    let mut next = move |least: f64, most: f64| least + (most - least) * numbers.unit();
    let at = PxPoint::new;
    let mut lines: Vec<Line> = Vec::new();
    let circle = |centre: PxPoint, radius_px: f64, lines: &mut Vec<Line>| {
        let place = |part: u32| {
            let (sine, cosine) = libm::sincos(TAU * f64::from(part) / 90.0);
            at(centre.x + radius_px * cosine, centre.y + radius_px * sine)
        };
        lines.extend((0..90).map(|part| [place(part), place(part + 1)]));
    };
    for _ in 0..4 + (seed % 4) {
        let kind = next(0.0, 5.0);
        let (x, y) = (next(30.0, 170.0), next(30.0, 170.0));
        if kind < 1.0 {
            lines.push([at(x, y), at(next(20.0, 180.0), next(20.0, 180.0))]);
        } else if kind < 3.0 {
            let radius_px = next(6.0, 45.0);
            let inside = |v: f64| v.clamp(radius_px + 12.0, 188.0 - radius_px);
            let centre = at(inside(x), inside(y));
            circle(centre, radius_px, &mut lines);
            if kind < 2.0 {
                // A line that touches it, nearly.
                let (sine, cosine) = libm::sincos(next(0.0, TAU));
                let (off, half) = (radius_px + next(-3.0, 3.0), next(20.0, 60.0));
                let foot = at(centre.x + off * cosine, centre.y + off * sine);
                let end = |side: f64| {
                    at((foot.x - side * sine).clamp(12.0, 188.0), (foot.y + side * cosine).clamp(12.0, 188.0))
                };
                lines.push([end(-half), end(half)]);
            }
        } else if kind < 4.0 {
            let mut from = at(x, y);
            for _ in 0..6 {
                let to = at(
                    (from.x + next(-25.0, 25.0)).clamp(20.0, 180.0),
                    (from.y + next(-25.0, 25.0)).clamp(20.0, 180.0),
                );
                lines.push([from, to]);
                from = to;
            }
        } else {
            lines.push([at(x, y), at(x, y)]);
        }
    }
    lines
}

pub(crate) fn distance_px(drawing: &Drawing, at: Pixel) -> f64 {
    let at = PxPoint::from(at);
    let to_stroke = |stroke: &[PxPoint]| {
        let dot = stroke.first().map_or(f64::INFINITY, |first| first.distance(at));
        stroke.windows(2).map(|pair| segment_distance(at, pair[0], pair[1])).fold(dot, f64::min)
    };
    drawing.strokes().map(to_stroke).fold(f64::INFINITY, f64::min)
}

/// The greatest extent of pixels that hang together, px.
fn longest_px(pixels: impl Iterator<Item = Pixel>) -> u32 {
    let mut open: BTreeSet<(u32, u32)> = pixels.map(|at| (at.y, at.x)).collect();
    let mut longest = 0;
    while let Some(first) = open.pop_first() {
        let mut group = vec![first];
        let mut next = 0;
        while let Some((y, x)) = group.get(next).copied() {
            next += 1;
            for beside in
                (y.saturating_sub(1)..=y + 1).flat_map(|y| (x.saturating_sub(1)..=x + 1).map(move |x| (y, x)))
            {
                if open.remove(&beside) {
                    group.push(beside);
                }
            }
        }
        let extent = |of: fn(&(u32, u32)) -> u32| {
            let (least, most) = (group.iter().map(of).min(), group.iter().map(of).max());
            most.unwrap_or(0) + 1 - least.unwrap_or(0)
        };
        longest = longest.max(extent(|at| at.0)).max(extent(|at| at.1));
    }
    longest
}

/// How far the middle of a pixel that is no ink lies from the nearest pixel of ink, a square, px.
fn from_ink_px(ink: &Bitmap, at: Pixel) -> f64 {
    let off = |one: u32, other: u32| (f64::from(one.abs_diff(other)) - 0.5).max(0.0);
    ink.ink().map(|pixel| off(pixel.x, at.x).hypot(off(pixel.y, at.y))).fold(f64::INFINITY, f64::min)
}

/// How far from ink this pen draws, px.
fn beyond_px(ink: &Bitmap, drawing: &Drawing, pen_px: f64) -> f64 {
    let all = (0..SIDE_PX).flat_map(|y| (0..SIDE_PX).map(move |x| Pixel::new(x, y)));
    let drawn = all.filter(|at| !ink.get(*at) && distance_px(drawing, *at) <= 0.5 * pen_px);
    drawn.map(|at| from_ink_px(ink, at)).fold(0.0, f64::max)
}

/// What is left bare of a drawing: by this pen, px; as the library tells it, px; how far the pen draws beside
/// the ink, px, and as it is told; and how many strokes there are for a line.
struct Bare {
    by_pen_px: f64,
    told_px: f64,
    beyond_px: f64,
    told_beyond_px: f64,
    strokes: usize,
}

impl Bare {
    fn is_kept(&self) -> bool {
        self.told_px <= WITHIN_PX && self.told_beyond_px <= WITHIN_PX
    }
}

fn bare(seed: u64, pen_px: f64, prefer: Prefer) -> Bare {
    let lines = drawing(seed);
    let ink: Bitmap = ink_of(SIDE_PX, &lines, pen_px);
    let traced = Vectorizer::from(Ours::default().with_prefer(prefer)).trace(&ink).unwrap();
    // What was taken for dirt is told, and is not asked for here.
    let dirt = traced.removed.removed_marks > 0;
    let far: Vec<(Pixel, f64)> = ink.ink().map(|at| (at, distance_px(&traced.drawing, at))).collect();
    let lost = far.iter().filter(|(_, away_px)| *away_px > pen_px.max(2.0)).map(|(at, _)| *at);
    let lost_px = longest_px(lost);
    assert!(
        dirt || f64::from(lost_px) <= 3.0 * pen_px.max(2.0),
        "seed {seed}, {pen_px} px: {lost_px} px are lost"
    );
    let farthest_px = far.iter().map(|(_, away_px)| away_px - 0.5 * pen_px).fold(0.0, f64::max);
    Bare {
        by_pen_px: if dirt { 0.0 } else { farthest_px },
        told_px: traced.error.max_px,
        beyond_px: beyond_px(&ink, &traced.drawing, pen_px),
        told_beyond_px: traced.beyond.max_px,
        strokes: traced.drawing.strokes().len(),
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn no_line_of_a_pen_is_lost_and_hardly_any_ink_is_bare() {
    for (seed, pen_px) in (1..).zip(PENS_PX) {
        let Bare { by_pen_px, told_px, beyond_px, told_beyond_px, .. } = bare(seed, pen_px, Prefer::Both);
        assert!(by_pen_px <= 1.0 + 0.4 * pen_px, "{pen_px} px: {by_pen_px} px bare, {told_px} told");
        // The pen that is found is up to half a pixel wider or thinner than the true one.
        println!(
            "{pen_px} px: {by_pen_px:.2} px bare, {told_px:.2} told; {beyond_px:.2} px beyond, {told_beyond_px:.2} told"
        );
        assert!(
            beyond_px <= 1.5 && (told_beyond_px - beyond_px).abs() <= 1.0,
            "{pen_px} px: {beyond_px} px beyond, {told_beyond_px} told"
        );
    }
}

static LOST: Figure = Figure::of("px in a row");

#[test]
fn a_double_line_beside_a_circle_is_drawn() {
    // Two lines that touch a circle so nearly that all three run into one for half a hundred pixels.
    let place = |part: u32| {
        let (sine, cosine) = libm::sincos(TAU * f64::from(part) / 240.0);
        PxPoint::new(100.0 + 80.0 * cosine, 100.0 + 80.0 * sine)
    };
    let mut lines: Vec<Line> = (0..240).map(|part| [place(part), place(part + 1)]).collect();
    for off in [78.2, 80.4] {
        lines.push([PxPoint::new(40.0, 100.0 - off), PxPoint::new(160.0, 101.0 - off)]);
    }
    for pen_px in [1.1, 1.5, 2.0] {
        let ink = ink_of(SIDE_PX, &lines, pen_px);
        let traced = Vectorizer::default().trace(&ink).unwrap();
        let lost = ink.ink().filter(|at| distance_px(&traced.drawing, *at) > pen_px.max(2.0));
        let longest_px = longest_px(lost);
        LOST.note(f64::from(longest_px));
        assert!(longest_px <= 2, "{pen_px} px");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_needle_gets_a_stroke_at_its_blunt_end_at_most() {
    const NEEDLES: usize = 100;
    let mut random = Random(0x5851_f42d_4c95_7f2d);
    let mut next = move |least: f64, most: f64| least + (most - least) * random.unit();
    let more = (0..NEEDLES).filter(|_| {
        let (width_px, length_px) = (next(4.0, 16.0), next(60.0, 180.0));
        let (sine, cosine) = libm::sincos(next(0.0, TAU));
        let middle = PxPoint::new(next(99.0, 101.0), next(99.0, 101.0));
        let is_ink = |x: u32, y: u32| {
            let (x, y) = (f64::from(x) + 0.5 - middle.x, f64::from(y) + 0.5 - middle.y);
            let (along, across) = (x * cosine + y * sine + 0.5 * length_px, y * cosine - x * sine);
            (0.0..=length_px).contains(&along) && across.abs() <= 0.5 * width_px * (1.0 - along / length_px)
        };
        let mut ink = Bitmap::new(SIDE_PX, SIDE_PX).unwrap();
        for (x, y) in (0..SIDE_PX).flat_map(|y| (0..SIDE_PX).map(move |x| (x, y))) {
            ink.set(Pixel::new(x, y), is_ink(x, y));
        }
        let strokes = |prefer| {
            Vectorizer::from(Ours::default().with_prefer(prefer)).trace(&ink).unwrap().drawing.strokes().len()
        };
        strokes(Prefer::Both) > strokes(Prefer::Strokes) + 1
    });
    let more = more.count();
    println!("{more} of {NEEDLES} needles get more strokes");
    // Thin ones whose middle is found in pieces: the tip tells a pen of a pixel then, which draws the rest.
    assert!(more <= 5, "{more} of {NEEDLES}");
}

#[test]
fn two_lines_that_leave_the_picture_as_one_are_both_drawn() {
    // 3 px a pen; at the right rim they are 2 px apart, at the left one 14 px.
    for pen_px in [3.0, 5.0] {
        let line = |side: f64| {
            [PxPoint::new(20.0, 100.0 + 7.0 * side), PxPoint::new(240.0, 100.0 + 0.55 * pen_px * side)]
        };
        let ink = ink_of(SIDE_PX, &[line(-1.0), line(1.0)], pen_px);
        let traced = Vectorizer::default().trace(&ink).unwrap();
        let farthest_px =
            ink.ink().map(|at| distance_px(&traced.drawing, at) - 0.5 * pen_px).fold(0.0, f64::max);
        assert!(farthest_px <= 1.0 + 0.4 * pen_px, "{pen_px} px: {farthest_px} px bare");
    }
}

#[test]
#[ignore = "minutes, the table of docs/results/bare-ink.md: cargo test --release -p plotter-vector --test all bare_ink::table -- --ignored --nocapture"]
fn table_of_random_drawings() {
    println!(
        "| pen, px | kept | told / tolerance: median | 90 % | greatest | bare by the pen, px: median | 90 % | greatest | beyond ink, px: median | 90 % | greatest | strokes | `Prefer::Ink`: kept | strokes |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for pen_px in PENS_PX {
        let found: Vec<Bare> = (10_000..10_125).map(|seed| bare(seed, pen_px, Prefer::Both)).collect();
        let with_ink: Vec<Bare> = (10_000..10_125).map(|seed| bare(seed, pen_px, Prefer::Ink)).collect();
        let parts = |of: fn(&Bare) -> f64| {
            let mut all: Vec<f64> = found.iter().map(of).collect();
            all.sort_by(f64::total_cmp);
            [all[all.len() / 2], all[all.len() * 9 / 10], all[all.len() - 1]]
        };
        let kept = |of: &[Bare]| of.iter().filter(|bare| bare.is_kept()).count();
        let strokes = |of: &[Bare]| of.iter().map(|bare| bare.strokes).sum::<usize>();
        let [told, told_most, told_worst] = parts(|bare| bare.told_px / WITHIN_PX);
        let [by_pen, most, worst] = parts(|bare| bare.by_pen_px);
        let [beyond, beyond_most, beyond_worst] = parts(|bare| bare.beyond_px);
        println!(
            "| {pen_px} | {} of {} | {told:.2} | {told_most:.2} | {told_worst:.2} | {by_pen:.2} | {most:.2} | {worst:.2} | {beyond:.2} | {beyond_most:.2} | {beyond_worst:.2} | {} | {} | {} |",
            kept(&found),
            found.len(),
            strokes(&found),
            kept(&with_ink),
            strokes(&with_ink)
        );
    }
}
