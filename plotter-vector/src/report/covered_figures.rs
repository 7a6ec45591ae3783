//! [`Covered`]: short figures that others draw anyway.
//!
//! ```text
//!   a a b b . . .        where lines cross at an acute angle pixels are left over between them (b), or a line went on
//!   . . a a a a .        over them: strokes of other figures come within the promise of each, so that no stroke of
//!   . . . . . a a        their own is needed
//! ```

use crate::picture::{Bitmap, Figures, Pixel};
use crate::stroke::PxVec;
use crate::stroke::simplify::segment_distance_squared;
use std::collections::HashMap;

/// Most pixels of a figure that may go: what is longer is a line.
const MOST_PX: usize = 40;

/// What may be lost to rounding, px.
const ROUNDING_PX: f64 = 1e-9;

/// Which figures go.
pub(crate) struct Covered {
    /// Of each figure whether it does.
    gone: Vec<bool>,
    /// Of each pixel of these how far it is from the nearest stroke that stays, px.
    off_px: HashMap<Pixel, f64>,
}

impl Covered {
    /// Of figures and the indices of their pixels that are vertices: all pixels stay within the tolerance of
    /// a stroke. Linear in the length of the figures, and n·log n in the number of the short ones.
    pub(crate) fn of(figures: &Figures, kept: &[Vec<usize>], ink: &Bitmap, tolerance_px: f64) -> Self {
        let vertices = |index: usize| -> Vec<Pixel> {
            let (figure, kept) = (figures.get(index), kept.get(index).map_or(&[][..], Vec::as_slice));
            kept.iter().filter_map(|at| figure.get(*at).copied()).collect()
        };
        let near_px = tolerance_px + ROUNDING_PX;
        let mut short: Vec<usize> =
            (0..figures.len()).filter(|index| figures.get(*index).len() <= MOST_PX).collect();
        short.sort_by_key(|index| figures.get(*index).len());
        // How many strokes come near each pixel of the short ones.
        let mut strokes_near: HashMap<Pixel, u32> = HashMap::new();
        let mut marked = Bitmap::new(ink.width(), ink.height()).unwrap_or(Bitmap::empty());
        short.iter().flat_map(|index| figures.get(*index)).for_each(|at| marked.set(*at, true));
        for stroke in (0..figures.len()).map(vertices) {
            each_near(&stroke, &marked, near_px, |at, _| *strokes_near.entry(at).or_default() += 1);
        }
        let mut gone = vec![false; figures.len()];
        let mut bare = Bitmap::new(ink.width(), ink.height()).unwrap_or(Bitmap::empty());
        for index in short {
            let mut near = Vec::new();
            each_near(&vertices(index), &marked, near_px, |at, _| near.push(at));
            if near.iter().any(|at| strokes_near.get(at).is_none_or(|count| *count < 2)) {
                continue;
            }
            for at in near {
                strokes_near.entry(at).and_modify(|count| *count -= 1);
            }
            if let Some(gone) = gone.get_mut(index) {
                *gone = true;
            }
            figures.get(index).iter().for_each(|at| bare.set(*at, true));
        }
        let mut off_px = HashMap::new();
        for (index, _) in gone.iter().enumerate().filter(|(_, gone)| !**gone) {
            each_near(&vertices(index), &bare, near_px, |at, away_px| {
                let least = off_px.entry(at).or_insert(away_px);
                *least = away_px.min(*least);
            });
        }
        Self { gone, off_px }
    }

    /// Whether a figure goes.
    pub(crate) fn has(&self, index: usize) -> bool {
        self.gone.get(index).copied().unwrap_or(false)
    }

    /// How far a pixel of a figure that goes is from the nearest stroke that stays, px.
    pub(crate) fn off_px(&self, at: Pixel) -> Option<f64> {
        self.off_px.get(&at).copied()
    }
}

/// The marked pixels that a stroke comes near, each once, and how near it does, px.
fn each_near(stroke: &[Pixel], marked: &Bitmap, near_px: f64, mut found: impl FnMut(Pixel, f64)) {
    let mut near: Vec<(Pixel, f64)> = Vec::new();
    let pieces = stroke.windows(2).map(|pair| (pair.first(), pair.last()));
    let dot = (stroke.len() == 1).then(|| (stroke.first(), stroke.first()));
    for (from, to) in pieces.chain(dot).filter_map(|(from, to)| from.copied().zip(to.copied())) {
        each_pixel_along(from, to, near_px, |at| {
            if marked.get(at) {
                let off_px = libm::sqrt(segment_distance_squared(at, from, to));
                if off_px <= near_px {
                    near.push((at, off_px));
                }
            }
        });
    }
    near.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    near.dedup_by_key(|(at, _)| *at);
    near.into_iter().for_each(|(at, off_px)| found(at, off_px));
}

/// Pixels that may lie within a distance of a straight piece, in columns or, of a steep one, in rows.
fn each_pixel_along(from: Pixel, to: Pixel, near_px: f64, mut found: impl FnMut(Pixel)) {
    let PxVec { x: dx, y: dy } = to - from;
    let is_steep = dy.abs() > dx.abs();
    let (along, across, u, v) = if is_steep { (dy, dx, from.y, from.x) } else { (dx, dy, from.x, from.y) };
    // Across a piece at 45 degrees a column is √2 times as long.
    #[expect(clippy::cast_possible_truncation, reason = "a tolerance of some px, and sides below 2^28")]
    let (reach, wide) = (libm::ceil(near_px) as i64, libm::ceil(1.5 * near_px) as i64 + 1);
    #[expect(clippy::cast_possible_truncation, reason = "whole numbers below 2^28")]
    let (length, back) = (along.abs() as i64, along < 0.0);
    let slope = if along == 0.0 { 0.0 } else { across / along.abs() };
    for step in -reach..=length + reach {
        #[expect(clippy::cast_precision_loss, reason = "below 2^29")]
        let part = step.clamp(0, length) as f64;
        #[expect(clippy::cast_possible_truncation, reason = "below 2^28")]
        let middle = i64::from(v) + libm::round(slope * part) as i64;
        let u = i64::from(u) + if back { -step } else { step };
        for v in middle - wide..=middle + wide {
            let (x, y) = if is_steep { (v, u) } else { (u, v) };
            if let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) {
                found(Pixel::new(x, y));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Which of some lines go; each with its two ends as vertices.
    fn covered(lines: &[Vec<Pixel>], tolerance_px: f64) -> Covered {
        let mut ink = Bitmap::new(90, 20).unwrap();
        let mut figures = Figures::default();
        for line in lines {
            line.iter().for_each(|at| ink.set(*at, true));
            figures.push(line.iter().copied());
        }
        let kept: Vec<Vec<usize>> = lines.iter().map(|line| vec![0, line.len() - 1]).collect();
        Covered::of(&figures, &kept, &ink, tolerance_px)
    }

    fn row(y: u32, columns: core::ops::Range<u32>) -> Vec<Pixel> {
        columns.map(|x| Pixel::new(x, y)).collect()
    }

    #[test]
    fn a_short_figure_that_another_stroke_covers_goes() {
        let found = covered(&[row(5, 0..80), row(5, 20..40)], 0.5);
        assert_eq!([0, 1].map(|index| found.has(index)), [false, true]);
        assert_eq!(found.off_px(Pixel::new(30, 5)), Some(0.0));
        // Beside it, as far as the tolerance allows.
        let beside = [row(5, 0..80), row(6, 20..40)];
        assert!(!covered(&beside, 0.5).has(1));
        assert_eq!(covered(&beside, 1.0).off_px(Pixel::new(30, 6)), Some(1.0));
    }

    #[test]
    fn one_pixel_that_no_other_stroke_covers_is_enough_to_stay() {
        assert!(!covered(&[row(5, 0..80), row(5, 70..82)], 0.5).has(1));
        assert!(covered(&[row(5, 0..80), row(5, 70..82)], 2.0).has(1));
    }

    #[test]
    fn of_two_that_cover_each_other_one_stays() {
        let found = covered(&[row(5, 20..40), row(5, 20..40), row(5, 20..40)], 0.5);
        assert_eq!([0, 1, 2].map(|index| found.has(index)), [true, true, false]);
    }

    #[test]
    fn long_lines_stay() {
        assert!(!covered(&[row(5, 0..80), row(5, 0..80)], 0.5).has(0));
    }

    #[test]
    fn a_piece_is_met_from_everywhere_within_the_distance() {
        let all = {
            let mut all = Bitmap::new(60, 60).unwrap();
            (0..60).flat_map(|y| (0..60).map(move |x| Pixel::new(x, y))).for_each(|at| all.set(at, true));
            all
        };
        for (to_x, to_y) in
            [(50, 30), (45, 45), (30, 52), (12, 47), (10, 30), (17, 9), (30, 8), (49, 22), (30, 30)]
        {
            let stroke = [Pixel::new(30, 30), Pixel::new(to_x, to_y)];
            for near_px in [0.5, 0.75, 1.0, 2.0] {
                let mut found = Vec::new();
                each_near(&stroke, &all, near_px, |at, _| found.push(at));
                let off_px = |at: Pixel| libm::sqrt(segment_distance_squared(at, stroke[0], stroke[1]));
                let mut expected: Vec<Pixel> = all.ink().filter(|at| off_px(*at) <= near_px).collect();
                expected.sort_unstable();
                assert_eq!(found, expected, "to {to_x}, {to_y} within {near_px}");
            }
        }
    }
}
