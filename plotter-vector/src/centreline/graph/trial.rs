//! [`Trial`]: the lines of a junction drawn again, and held against the ink.
//!
//! The arms of a junction can be taken to go on in several ways. A pen of each line's width that goes these ways must
//! leave the ink that is there.
//!
//! Only pixels on the wrong side of a pen's edge cost anything, and of a good plan there are few. So all pens are drawn
//! first by squares alone. How far a pixel that contradicts them lies off is found for it alone, as long as the plan can
//! still win.

use super::arm::are_of_two_pens;
use super::junction::{ArmOf, Way};
use super::site::{Scan, Site};
use crate::{PxVec, picture::Pixel, stroke::PxPoint};
use core::cell::RefCell;
use std::borrow::Cow;

/// Cost that the raster alone explains, px².
pub(super) const GOOD_PX2: f64 = 0.5;

/// The cost below which ways are better than those of a cost: by more than the raster alone explains.
pub(super) fn better_than(cost: f64) -> f64 {
    (0.8 * cost).max(cost - GOOD_PX2)
}

/// The same for ways that bend in a junction although the course of the lines outside does not. What a camera's blur or a pen's
/// ink fills in the corners of a crossing looks like that, too; so these have to explain half of what is left.
pub(super) fn plainly_better_than(cost: f64) -> f64 {
    (0.5 * cost).min(cost - GOOD_PX2)
}

/// Nothing costs more than a pixel as far as this from where it should be, px.
pub(super) const FARTHEST_PX: f32 = 2.0;

/// Largest junction that is drawn again, px from its middle.
const MOST_PX: f64 = 48.0;

/// Pixels that are drawn at a time.
const LANES: usize = 8;

/// A pen has covered the pixel: the bits of both of the following.
const COVERED: u32 = INK | PAPER;

/// The pixel is ink, a pen should have covered it.
const INK: u32 = 1;

/// The pixel is paper, no pen should have covered it.
const PAPER: u32 = 2;

/// Columns of the largest junction, at the middles of their pixels.
static COLUMNS: [f32; 104] = {
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

/// The ink around a junction. Places are px from the upper left corner of the square around it.
pub(super) struct Trial<'a> {
    arms: &'a [ArmOf],
    /// Where the undisturbed part of each arm begins; of one without such a part its origin.
    roots: Vec<Option<PxPoint>>,
    corner: PxPoint,
    /// Pixels of a row, whole [`LANES`].
    stride: usize,
    /// What each pixel is: [`INK`], [`PAPER`] or, too far away to matter, 0.
    asked: Vec<u32>,
    /// What the undisturbed parts of the arms, which all plans share, make of each pixel.
    drawn: Vec<u32>,
    /// These parts.
    courses: Vec<Bundle>,
    /// What was last drawn: memory for the next.
    cells: RefCell<Vec<u32>>,
}

/// What a pen covers that goes straight on: all within half its width.
#[derive(Clone, Copy)]
pub(super) struct Capsule {
    from: (f32, f32),
    way: (f32, f32),
    /// 1 / length²; 0 for a disc.
    per_square: f32,
    half_px: f32,
}

impl Capsule {
    /// From one place to another.
    #[expect(clippy::cast_possible_truncation, reason = "a place in a square of 98 px is as good to 1e-5 px")]
    pub(super) fn new(from: PxPoint, to: PxPoint, half_px: f64) -> Self {
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
    fn draw(&self, cells: &mut [u32], stride: usize) {
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
struct Bundle {
    from: ([f32; LANES], [f32; LANES]),
    way: ([f32; LANES], [f32; LANES]),
    per_square: [f32; LANES],
    half_px: [f32; LANES],
}

impl Bundle {
    /// Capsules in their order; the last bundle is filled up with what nothing is near to.
    fn of(capsules: &[Capsule]) -> Vec<Self> {
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

    /// The squared distances of a place as of [`Capsule::squared`], px². A function of its own, so that the lanes become vectors.
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
    fn outside_px(&self, x: f32, y: f32, mut least: f32) -> f32 {
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

/// A place as seen from a corner.
fn from_corner(at: PxPoint, corner: PxPoint) -> PxPoint {
    let PxVec { x, y } = at - corner;
    PxPoint::new(x, y)
}

/// The straight parts of a pen's way through some places.
fn capsules(mut places: impl Iterator<Item = (PxPoint, f64)>, found: &mut Vec<Capsule>) {
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

impl<'a> Trial<'a> {
    /// For a junction, with the sites of each arm from the junction out; none when it is too large to be drawn again.
    pub(super) fn new(
        scan: Scan<'_>,
        centre: PxPoint,
        arms: &'a [ArmOf],
        sites: &[Cow<'_, [Site]>],
    ) -> Option<Self> {
        let far = |(one, sites): (&ArmOf, &Cow<'_, [Site]>)| {
            let first = sites.get(one.arm.skip).or(sites.last())?;
            Some(first.centre.distance(centre) + 0.5 * one.arm.width_px + 2.0)
        };
        let radius_px = arms.iter().zip(sites).filter_map(far).fold(0.0, f64::max);
        if radius_px > MOST_PX {
            return None;
        }
        let corner = |v: f64| libm::floor(v - radius_px).max(0.0);
        let corner = PxPoint::new(corner(centre.x), corner(centre.y));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 98")]
        let side = libm::ceil(2.0 * radius_px + 1.0) as usize;
        let stride = side.next_multiple_of(LANES);
        let mut courses = Vec::new();
        let mut trial = Self {
            arms,
            roots: Vec::new(),
            corner,
            stride,
            asked: asked(scan, centre, radius_px, (corner, side, stride)),
            drawn: vec![0; side * stride],
            courses: Vec::new(),
            cells: RefCell::default(),
        };
        for (one, sites) in arms.iter().zip(sites) {
            // The sites of the undisturbed part that lie around the junction, from the inside out.
            let half_px = 0.5 * one.arm.width_px;
            let reach_px = radius_px + half_px + 1.0;
            let places = sites.get(one.arm.skip..).unwrap_or(&[]).iter().map(|site| site.centre);
            let mut course = places.take_while(|at| at.distance(centre) <= reach_px).peekable();
            let all_disturbed = one.arm.skip >= sites.len();
            trial.roots.push(course.peek().copied().or(all_disturbed.then_some(one.arm.origin)));
            capsules(course.map(|at| (from_corner(at, corner), half_px)), &mut courses);
        }
        courses.iter().for_each(|capsule| capsule.draw(&mut trial.drawn, stride));
        trial.courses = Bundle::of(&courses);
        Some(trial)
    }

    /// How much the ink around the junction differs from what pens draw that go these ways, when that is less than
    /// `limit`: the squared distances of all pixels whose centres are on the wrong side of the
    /// lines' edges, px².
    pub(super) fn cost(&self, ways: &[Way], limit: f64) -> Option<f64> {
        let mut pens: Vec<Capsule> = Vec::new();
        for Way { one, other, points } in ways {
            let width_px = one.arm.width_px;
            let theirs = other.map_or(width_px, |other| other.arm.width_px);
            let count = points.len().max(1);
            // Lines of two pens that meet in a point come to it as wide as they are.
            let meet = count == 1 && are_of_two_pens(width_px, theirs);
            let inner = points.iter().enumerate().flat_map(|(index, at)| {
                // Else from one line's width to the other's.
                #[expect(clippy::cast_precision_loss, reason = "a few points")]
                let t = (index as f64 + 0.5) / count as f64;
                let one_px = if meet { width_px } else { width_px + (theirs - width_px) * t };
                [Some((*at, one_px)), meet.then_some((*at, theirs))].into_iter().flatten()
            });
            let from = self.root(one).map(|at| (at, width_px));
            let to = other.and_then(|other| self.root(&other)).map(|at| (at, theirs));
            let way = from.into_iter().chain(inner).chain(to);
            capsules(way.map(|(at, width_px)| (from_corner(at, self.corner), 0.5 * width_px)), &mut pens);
        }
        let bundles = Bundle::of(&pens);
        let outside_px = |x: f32, y: f32| {
            let all = bundles.iter().chain(&self.courses);
            all.fold(FARTHEST_PX, |least, bundle| bundle.outside_px(x, y, least))
        };
        let mut cells = self.cells.borrow_mut();
        cells.clone_from(&self.drawn);
        pens.iter().for_each(|pen| pen.draw(&mut cells, self.stride));
        let mut cost = 0.0;
        let rows = cells.chunks_exact(self.stride).zip(self.asked.chunks_exact(self.stride)).zip(&COLUMNS);
        for ((cells, asked), y) in rows {
            let wrong = |(cell, asked): (&u32, &u32)| (cell ^ INK) & asked;
            if cells.iter().zip(asked).map(wrong).fold(0, |any, wrong| any | wrong) == 0 {
                continue;
            }
            for (pixel, x) in cells.iter().zip(asked).zip(&COLUMNS) {
                let off_px = match wrong(pixel) {
                    0 => continue,
                    INK => outside_px(*x, *y),
                    _ => -outside_px(*x, *y),
                };
                let off_px = f64::from(off_px).max(0.0);
                cost += off_px * off_px;
            }
            if cost >= limit {
                return None;
            }
        }
        (cost < limit).then_some(cost)
    }

    /// Where an arm's undisturbed part begins.
    fn root(&self, one: &ArmOf) -> Option<PxPoint> {
        let index = self.arms.iter().position(|arm| arm.end == one.end)?;
        self.roots.get(index).copied().flatten()
    }

    /// The ways with their few places moved to where they cost least: a pattern search, from `cost` down.
    pub(super) fn settle(&self, mut ways: Vec<Way>, mut cost: f64) -> Vec<Way> {
        /// Ways with more places are curves.
        const MOST_PLACES: usize = 2;
        const MOST_LOOKS: usize = 96;
        const STEPS_PX: [f64; 3] = [0.8, 0.4, 0.2];
        /// Of thinner lines the edges are too near each other to tell where within them the middle is.
        const WIDE_PX: f64 = 2.0;
        if self.arms.iter().any(|one| one.arm.width_px < WIDE_PX) {
            return ways;
        }
        let mut looks = 0;
        for step_px in STEPS_PX {
            for (way, place) in places(&ways, MOST_PLACES) {
                let mut direction = 0;
                // Round by round until no direction is better.
                while direction < PxVec::AXES.len() && cost > GOOD_PX2 && looks < MOST_LOOKS {
                    let Some(at) = ways.get(way).and_then(|way| way.points.get(place)).copied() else {
                        break;
                    };
                    let step = PxVec::AXES.get(direction).copied().unwrap_or_default();
                    let moved = at + step * step_px;
                    let mut other = ways.clone();
                    // Ways that share the place move with it.
                    for point in other
                        .iter_mut()
                        .filter(|way| way.points.len() <= MOST_PLACES)
                        .flat_map(|way| &mut way.points)
                    {
                        if *point == at {
                            *point = moved;
                        }
                    }
                    looks += 1;
                    if let Some(less) = self.cost(&other, 0.8 * cost) {
                        (ways, cost, direction) = (other, less, 0);
                    } else {
                        direction += 1;
                    }
                }
            }
        }
        ways
    }
}

/// What the pixels of a square are that lie around a junction: [`INK`] or [`PAPER`]; 0 for the others.
fn asked(
    scan: Scan<'_>,
    centre: PxPoint,
    radius_px: f64,
    (corner, side, stride): (PxPoint, usize, usize),
) -> Vec<u32> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the picture")]
    let (left, top) = (corner.x as u32, corner.y as u32);
    let PxVec { x, y } = centre - corner;
    let mut asked = vec![0; side * stride];
    for ((row, line), at_y) in (top..).zip(asked.chunks_exact_mut(stride)).zip(&COLUMNS) {
        let dy = f64::from(*at_y) - y;
        let mut ink = scan.ink_from(Pixel::new(left, row));
        for (ask, at_x) in line.iter_mut().zip(&COLUMNS).take(side) {
            let dx = f64::from(*at_x) - x;
            if dx * dx + dy * dy <= radius_px * radius_px {
                *ask = if ink & 1 == 1 { INK } else { PAPER };
            }
            ink >>= 1;
        }
    }
    asked
}

/// The places of ways that have few of them, each once: indices of way and place.
fn places(ways: &[Way], most: usize) -> Vec<(usize, usize)> {
    let mut seen: Vec<PxPoint> = Vec::new();
    let mut found = Vec::new();
    for (index, way) in ways.iter().enumerate().filter(|(_, way)| way.points.len() <= most) {
        for (place, at) in way.points.iter().enumerate() {
            if !seen.contains(at) {
                seen.push(*at);
                found.push((index, place));
            }
        }
    }
    found
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
