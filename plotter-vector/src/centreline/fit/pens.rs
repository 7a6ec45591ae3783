//! [`Capsule`]: what a pen covers that goes straight on; many of them are drawn, and asked for distances, at
//! once.

use crate::PxVec;
use crate::stroke::PxPoint;

/// Pixels that are drawn at a time.
pub(super) const LANES: usize = 8;

/// A pen has covered the pixel: the bits of both of the following.
pub(super) const COVERED: u32 = INK | PAPER;

/// The pixel is ink, a pen should have covered it.
pub(super) const INK: u32 = 1;

/// The pixel is paper, no pen should have covered it.
pub(super) const PAPER: u32 = 2;

/// Columns of the largest canvas, at the middles of their pixels.
pub(super) static COLUMNS: [f32; 104] = {
    let mut columns = [0.5; 104];
    let mut rest: &mut [f32] = &mut columns;
    let mut x = 0.5;
    while let [first, tail @ ..] = rest {
        *first = x;
        x += 1.0;
        rest = tail;
    }
    columns
};

/// What a pen covers that goes straight on: all within half its width.
#[derive(Clone, Copy)]
pub(crate) struct Capsule {
    from: (f32, f32),
    way: (f32, f32),
    /// 1 / length²; 0 for a disc.
    per_square: f32,
    half_px: f32,
}

impl Capsule {
    /// From one place to another.
    #[expect(clippy::cast_possible_truncation, reason = "a place in a square of 98 px is as good to 1e-5 px")]
    pub(crate) fn new(from: PxPoint, to: PxPoint, half_px: f64) -> Self {
        let PxVec { x, y } = to - from;
        let square = x * x + y * y;
        let per_square = if square > 0.0 { (1.0 / square) as f32 } else { 0.0 };
        Self {
            from: (from.x as f32, from.y as f32),
            way: (x as f32, y as f32),
            per_square,
            half_px: half_px as f32,
        }
    }

    /// Squared distance of a place from the pen's way, px².
    #[inline]
    pub(super) fn squared(&self, x: f32, y: f32) -> f32 {
        let (x, y) = (x - self.from.0, y - self.from.1);
        let t = (x * self.way.0 + y * self.way.1) * self.per_square;
        let t = if t > 0.0 { t } else { 0.0 };
        let t = if t < 1.0 { t } else { 1.0 };
        let (x, y) = (x - t * self.way.0, y - t * self.way.1);
        x * x + y * y
    }

    /// Notes in `cells`, rows of `stride`, which pixels it covers.
    pub(super) fn draw(&self, cells: &mut [u32], stride: usize) {
        let reach = self.half_px;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a float cast saturates: at 0, and what is beyond the square is not drawn"
        )]
        let range = |from: f32, way: f32| {
            let (low, high) = if way < 0.0 { (from + way, from) } else { (from, from + way) };
            (low - reach) as usize..(high + reach + 1.0) as usize
        };
        let (columns, rows) = (range(self.from.0, self.way.0), range(self.from.1, self.way.1));
        let columns = columns.start / LANES * LANES..columns.end.next_multiple_of(LANES).min(stride);
        let rows = rows.start * stride..(rows.end * stride).min(cells.len());
        let (Some(xs), Some(ys)) = (COLUMNS.get(columns.clone()), COLUMNS.get(rows.start / stride..)) else {
            return;
        };
        let (xs, _) = xs.as_chunks();
        for (line, y) in cells.get_mut(rows).unwrap_or_default().chunks_exact_mut(stride).zip(ys) {
            let (cells, _) = line.get_mut(columns.clone()).unwrap_or_default().as_chunks_mut();
            for (cells, xs) in cells.iter_mut().zip(xs) {
                self.draw_lanes(cells, xs, *y, reach * reach);
            }
        }
    }

    /// The pixels of a row in some columns. A function of its own, so that the lanes become vectors.
    #[inline(never)]
    fn draw_lanes(&self, cells: &mut [u32; LANES], xs: &[f32; LANES], y: f32, covered: f32) {
        for (cell, x) in cells.iter_mut().zip(xs) {
            *cell |= if self.squared(*x, y) <= covered { COVERED } else { 0 };
        }
    }
}

/// Capsules side by side, so that the distances of a place from all of them are found at once.
pub(super) struct Bundle {
    from: ([f32; LANES], [f32; LANES]),
    way: ([f32; LANES], [f32; LANES]),
    per_square: [f32; LANES],
    half_px: [f32; LANES],
}

impl Bundle {
    /// Capsules in their order; the last bundle is filled up with what nothing is near to.
    pub(super) fn of(capsules: &[Capsule]) -> Vec<Self> {
        let bundle = |some: &[Capsule]| {
            let lanes = |of: fn(&Capsule) -> f32, none: f32| {
                core::array::from_fn(|lane| some.get(lane).map_or(none, of))
            };
            Self {
                from: (lanes(|one| one.from.0, 0.0), lanes(|one| one.from.1, 0.0)),
                way: (lanes(|one| one.way.0, 0.0), lanes(|one| one.way.1, 0.0)),
                per_square: lanes(|one| one.per_square, 0.0),
                half_px: lanes(|one| one.half_px, f32::NEG_INFINITY),
            }
        };
        capsules.chunks(LANES).map(bundle).collect()
    }

    /// The squared distances of a place as of [`Capsule::squared`], px². A function of its own, so that the
    /// lanes become vectors.
    #[inline(never)]
    fn squared(&self, x: f32, y: f32, squared: &mut [f32; LANES]) {
        for (lane, squared) in squared.iter_mut().enumerate() {
            let from = (self.from.0[lane], self.from.1[lane]);
            let way = (self.way.0[lane], self.way.1[lane]);
            let (per_square, half_px) = (self.per_square[lane], self.half_px[lane]);
            *squared = Capsule { from, way, per_square, half_px }.squared(x, y);
        }
    }

    /// How far a place lies outside, px, where that is less than `least`.
    pub(super) fn outside_px(&self, x: f32, y: f32, mut least: f32) -> f32 {
        let mut squared = [0.0; LANES];
        self.squared(x, y, &mut squared);
        let is_nearer = |squared: f32, half_px: f32, least: f32| {
            let within = least + half_px;
            within > 0.0 && squared < within * within
        };
        // Mostly none is, which all at once show sooner.
        let mut any = false;
        for (lane, squared) in squared.iter().enumerate() {
            any |= is_nearer(*squared, self.half_px[lane], least);
        }
        if any {
            for (squared, half_px) in squared.iter().zip(&self.half_px) {
                if is_nearer(*squared, *half_px, least) {
                    least = libm::sqrtf(*squared) - half_px;
                }
            }
        }
        least
    }
}

/// The straight parts of a pen's way through some places.
pub(super) fn capsules(mut places: impl Iterator<Item = (PxPoint, f64)>, found: &mut Vec<Capsule>) {
    let Some((mut from, mut half_px)) = places.next() else { return };
    let (mut to, mut many) = (from, false);
    for (next, next_half_px) in places {
        let (PxVec { x, y }, PxVec { x: u, y: v }) = (to - from, next - to);
        let goes_on = half_px.to_bits() == next_half_px.to_bits() && x * v == y * u && x * u + y * v >= 0.0;
        if !goes_on && many {
            found.push(Capsule::new(from, to, half_px));
            from = to;
        }
        (to, half_px, many) = (next, next_half_px, true);
    }
    found.push(Capsule::new(from, to, half_px));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn capsule(from: (f64, f64), to: (f64, f64), half_px: f64) -> Capsule {
        Capsule::new(PxPoint::new(from.0, from.1), PxPoint::new(to.0, to.1), half_px)
    }

    #[test]
    fn the_distance_is_that_from_the_nearest_place_of_the_way() {
        let bar = capsule((2.0, 2.0), (6.0, 2.0), 1.0);
        // Beside it, behind its end (3² + 4²), before its start.
        assert_eq!([bar.squared(4.0, 5.0), bar.squared(9.0, 6.0), bar.squared(0.0, 2.0)], [9.0, 25.0, 4.0]);
        let disc = capsule((2.0, 2.0), (2.0, 2.0), 1.0);
        assert_eq!(disc.squared(5.0, 6.0), 25.0);
    }

    #[test]
    fn places_on_a_straight_line_are_one_capsule() {
        let count = |places: &[(f64, f64, f64)]| {
            let mut found = Vec::new();
            capsules(places.iter().map(|(x, y, half_px)| (PxPoint::new(*x, *y), *half_px)), &mut found);
            found.len()
        };
        assert_eq!(count(&[]), 0);
        assert_eq!(count(&[(1.0, 1.0, 2.0)]), 1);
        assert_eq!(count(&[(1.0, 1.0, 2.0), (2.0, 1.5, 2.0), (3.0, 2.0, 2.0)]), 1);
        assert_eq!(count(&[(1.0, 1.0, 2.0), (2.0, 1.0, 2.0), (2.0, 3.0, 2.0)]), 2);
        // There and back, and with another pen.
        assert_eq!(count(&[(1.0, 1.0, 2.0), (5.0, 1.0, 2.0), (3.0, 1.0, 2.0)]), 2);
        assert_eq!(count(&[(1.0, 1.0, 2.0), (3.0, 1.0, 2.0), (5.0, 1.0, 3.0)]), 2);
    }

    #[test]
    fn each_pixel_is_noted_that_a_pen_covers() {
        const STRIDE: usize = 32;
        for (from, to, half_px) in [
            ((10.3, 9.1), (17.9, 13.4), 3.2),
            ((20.5, 4.0), (8.25, 18.75), 1.1),
            ((15.0, 12.0), (15.0, 12.0), 4.0),
            ((-6.0, -3.0), (5.0, 4.0), 2.5),
            ((28.0, 20.0), (50.0, 40.0), 3.0),
            ((70.0, 70.0), (90.0, 60.0), 3.0),
            ((-30.0, 5.0), (-20.0, 5.0), 3.0),
            ((4.0, 6.0), (9.0, 6.0), 0.3),
        ] {
            let pen = capsule(from, to, half_px);
            let mut cells = vec![0; STRIDE * 24];
            pen.draw(&mut cells, STRIDE);
            for (y, line) in cells.chunks_exact(STRIDE).enumerate() {
                for (x, cell) in line.iter().enumerate() {
                    let distance = libm::sqrtf(pen.squared(x as f32 + 0.5, y as f32 + 0.5));
                    let covered = if distance <= pen.half_px { COVERED } else { 0 };
                    assert_eq!(*cell, covered, "{x} {y} of {from:?} {to:?}");
                }
            }
        }
    }
}
