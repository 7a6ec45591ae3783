//! [`Site`]: the middle of a line at one of its skeleton's pixels, from both edges of the ink.
//!
//! A line that runs more sideways than up is cut by the pixel's column, else by its row. The run of ink in that
//! cut reaches from one edge of the line to the other: its middle is a point of the centreline, whatever the
//! slope, and its length times the cosine of the slope is the line's width. On a picture with grey rims the edges
//! are known to a fraction of a pixel: a rim pixel is covered as far as its level lies between paper and ink.

use crate::ink::hairlines::Hairlines;
use crate::{
    PxVec,
    picture::{Bitmap, Gray, Pixel},
    stroke::PxPoint,
};

/// Longest run that is measured to either side of the skeleton, px. Beyond it the ink is no line.
const MAX_RUN_PX: u32 = 96;

/// Pixels of the chain to either side that give the direction of a cut.
const DIRECTION_PX: usize = 4;

/// Pixels of the chain to either side among which the line's own width is found.
const CALM_PX: usize = 8;

/// Lines up to this width are the raster's own: nothing of them is rough, and no place of theirs is better known than
/// their pixels.
pub(crate) const THIN_PX: f64 = 1.5;

/// The same where grey levels or the steps of the lines tell that a pen drew them: less is seen of none.
const THIN_PEN_PX: f64 = 0.5;

/// Widest line of which grey rims make the sites exact in its bends too, px: those of a wider one cut corners.
pub(super) const EXACT_PX: f64 = 1.75;

/// Of a pen that is sure to leave no greater disc than this the raster may show none, px.
const THIN_DISC_PX: f64 = 0.25;

/// Share of full ink that a pen leaves, at least, where it was: between the middles of pixels a line one pixel wide has a
/// half, a corner of it a little less.
const LEAST_SHARE: f64 = 0.45;

/// How much wider than elsewhere a line may seem to be where it is undisturbed, px: three quarters of a pixel
/// for the raster at both of its edges, and of a wide one a share for what a pen's pressure does.
pub(super) fn slack_px(width_px: f64) -> f64 {
    (0.15 * width_px).max(0.75)
}

/// Radius of the disc that a pen leaves for sure where it was, px, of one that draws lines so wide, half of
/// it: the raster takes so much of its edge, and the paper a fifth.
pub(super) fn surely_px(half_px: f64, raster_px: f64) -> f64 {
    half_px - (0.2 * half_px).max(raster_px)
}

/// What a site is in its line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Role {
    /// A point of its course.
    #[default]
    Course,
    /// A corner.
    Corner,
    /// Left out: a corner beside it takes its place.
    Left,
}

/// A point of a centreline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Site {
    /// Half way between both edges.
    pub(crate) centre: PxPoint,
    /// From edge to edge, across the line, px.
    pub(crate) width_px: f64,
    /// What it is.
    pub(crate) role: Role,
}

/// What sites are measured on: a band of a picture. Places are those of the whole picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scan<'a> {
    /// The ink.
    pub(crate) ink: &'a Bitmap,
    /// Row of the picture that the ink's first one is.
    pub(crate) first_row: u32,
    /// The grey levels it was told from.
    pub(crate) grey: Option<Rims<'a>>,
    /// What its thin lines are.
    pub(crate) hairlines: Hairlines,
}

/// The grey levels, which tell how far a rim pixel is covered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rims<'a> {
    /// The levels.
    pub(crate) levels: &'a Gray,
    /// Whether the dark side is ink.
    pub(crate) ink_is_dark: bool,
    /// Row of the picture that the first one of the levels is.
    pub(crate) first_row: u32,
}

impl Rims<'_> {
    /// How dark the pixel in column `x` and row `y` of the picture is, whole numbers: what lies beyond the levels is paper.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole numbers within the picture"
    )]
    fn darkness(&self, x: f64, y: f64) -> f64 {
        let row = y - f64::from(self.first_row);
        let level =
            if x >= 0.0 && row >= 0.0 { self.levels.get(Pixel::new(x as u32, row as u32)) } else { None };
        let darkness = |level: u8| f64::from(if self.ink_is_dark { 255 - level } else { level });
        level.map_or(0.0, darkness)
    }
}

/// A side of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Side {
    Left,
    Right,
    Top,
    Bottom,
}

impl Side {
    /// Whether it is one of columns of pixels.
    const fn upright(self) -> bool {
        matches!(self, Self::Left | Self::Right)
    }
}

impl Scan<'_> {
    /// Width up to which lines keep their pixels, px.
    pub(super) fn thin_px(&self) -> f64 {
        if self.grey.is_some() || self.hairlines == Hairlines::Pen { THIN_PEN_PX } else { THIN_PX }
    }

    /// Whether the sites of lines of a width, px, are exact.
    pub(super) fn is_exact(&self, width_px: f64) -> bool {
        self.grey.is_some() && width_px <= EXACT_PX
    }

    /// The sites of a chain of skeleton pixels, one for each.
    pub(crate) fn sites(&self, pixels: &[Pixel], closed: bool) -> Vec<Site> {
        let count = pixels.len();
        let neighbour = |index: usize, ahead: bool| {
            let at = if closed && count > 1 {
                // The last pixel of a loop is the first one again.
                let around = count - 1;
                if ahead {
                    (index + DIRECTION_PX) % around
                } else {
                    (index + around - DIRECTION_PX % around) % around
                }
            } else if ahead {
                (index + DIRECTION_PX).min(count - 1)
            } else {
                index.saturating_sub(DIRECTION_PX)
            };
            pixels.get(at).copied().unwrap_or_default()
        };
        let mut sites: Vec<Site> = (0..)
            .zip(pixels)
            .map(|(index, pixel)| self.site(*pixel, neighbour(index, true) - neighbour(index, false)))
            .collect();
        // Around a corner a cut may run along the line instead of across: there the skeleton itself is nearer.
        let is_wide = |site: &Site, calm_px: f64| site.width_px > 1.6 * calm_px + 1.0;
        let widths: Vec<f64> = sites.iter().map(|site| site.width_px).collect();
        let least_px = widths.iter().copied().fold(f64::INFINITY, f64::min);
        for (index, (site, pixel)) in sites.iter_mut().zip(pixels).enumerate() {
            if !is_wide(site, least_px) {
                continue;
            }
            let calm_px = least_around(count, index, CALM_PX, closed, |at| widths.get(at).copied());
            if is_wide(site, calm_px) {
                site.centre = (*pixel).into();
            }
        }
        sites
    }

    /// The site at a pixel of a line that runs in a direction, in whole px.
    pub(crate) fn site(&self, at: Pixel, PxVec { x: dx, y: dy }: PxVec) -> Site {
        let sideways = dx.abs() >= dy.abs();
        // Of whole numbers the squares are exact.
        let length = libm::sqrt(dx * dx + dy * dy);
        // Across a single pixel there is no direction: its own column will do.
        let cosine = if length > 0.0 { dx.abs().max(dy.abs()) / length } else { 1.0 };
        let (low, high) = self.run(at, sideways);
        let middle = f64::midpoint(low, high);
        let whole = PxPoint::from(at);
        let centre = if sideways { PxPoint::new(whole.x, middle) } else { PxPoint::new(middle, whole.y) };
        Site { centre, width_px: (high - low) * cosine, role: Role::Course }
    }

    /// Where the run of ink through a pixel begins and ends, px from the picture's corner: down its column, or
    /// along its row.
    fn run(&self, at: Pixel, down: bool) -> (f64, f64) {
        let end_row = self.first_row.saturating_add(self.ink.height());
        let (here, first, side) =
            if down { (at.y, self.first_row, end_row) } else { (at.x, 0, self.ink.width()) };
        let pixel = |along: u32| if down { Pixel::new(at.x, along) } else { Pixel::new(along, at.y) };
        let inside = Pixel::new(at.x, at.y.saturating_sub(self.first_row));
        let (before, behind) = if down {
            self.ink.run_upright(inside, MAX_RUN_PX)
        } else {
            self.ink.run_level(inside, MAX_RUN_PX)
        };
        let (low, high) = (here - before, here + behind);
        let (start, end) = (f64::from(low), f64::from(high) + 1.0);
        let Some(Rims { levels, ink_is_dark, first_row }) = self.grey else { return (start, end) };
        let level = |along: Option<u32>| {
            let at = along.map(pixel)?;
            levels.get(Pixel::new(at.x, at.y.checked_sub(first_row)?))
        };
        // Ink is as dark as the darkest of the run, paper as light as what lies beyond the rim on either side.
        let darkness = |level: u8| f64::from(if ink_is_dark { 255 - level } else { level });
        let full = (low..=high).filter_map(|along| level(Some(along))).map(darkness).fold(0.0, f64::max);
        let rim = |inner: u32, out: Option<u32>, beyond: [Option<u32>; 2]| {
            let paper = beyond.into_iter().filter_map(&level).map(darkness).fold(full, f64::min);
            let contrast = full - paper;
            if contrast <= 0.0 {
                return 0.0;
            }
            let cover = |at: Option<u32>| {
                level(at).map_or(0.0, |level| ((darkness(level) - paper) / contrast).clamp(0.0, 1.0))
            };
            // How far the edge lies outside the run's last pixel: out by what covers the next, in by what is missing.
            cover(out) - (1.0 - cover(Some(inner)))
        };
        let before = |count: u32| low.checked_sub(count).filter(|along| *along >= first);
        let after = |count: u32| Some(high + count).filter(|along| *along < side);
        let missing_low = rim(low, before(1), [before(2), before(3)]);
        let missing_high = rim(high, after(1), [after(2), after(3)]);
        let (outer, other) = (start - missing_low, end + missing_high);
        if outer < other { (outer, other) } else { (start, end) }
    }

    /// Radius of the largest disc of ink around a place, px: 0 outside the ink, half the width in the middle of a
    /// line, at most `limit_px`.
    pub(crate) fn radius_px(&self, at: PxPoint, limit_px: f64) -> f64 {
        let limit = limit_px.clamp(1.0, f64::from(MAX_RUN_PX));
        let (left, top) = (libm::floor(at.x), libm::floor(at.y));
        let mut nearest = PxVec::new(limit + 0.5, 0.0);
        let mut far = 0.0;
        // Rows so far up and down have their pixels' centres at least half a pixel less away.
        while far < 0.5 || (far - 0.5) * (far - 0.5) < nearest.length_squared() {
            for row in [top - far, top + far] {
                let (before, behind) = self.level_run(left, row);
                for x in [left - before, left + behind] {
                    let way = PxVec::new(x + 0.5 - at.x, row + 0.5 - at.y);
                    if way.length_squared() < nearest.length_squared() {
                        nearest = way;
                    }
                }
            }
            far += 1.0;
        }
        (nearest.length() - 0.5).max(0.0)
    }

    /// How many columns to the left and to the right the nearest paper in a row is, whole numbers; 0 when the pixel there is
    /// paper.
    fn level_run(&self, x: f64, y: f64) -> (f64, f64) {
        if !self.is_ink(x, y) {
            return (0.0, 0.0);
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole numbers of ink")]
        let at = Pixel::new(x as u32, y as u32 - self.first_row);
        let (before, behind) = self.ink.run_level(at, MAX_RUN_PX);
        (f64::from(before) + 1.0, f64::from(behind) + 1.0)
    }

    /// How far a ray of ink goes on from a place, px, at most `limit_px`: in quarters of a pixel.
    pub(crate) fn reach_px(&self, from: PxPoint, direction: PxVec, limit_px: f64) -> f64 {
        self.reach_along_px(limit_px, |t| from + direction * t)
    }

    /// The same along any way, by the places that it comes to.
    pub(super) fn reach_along_px(&self, limit_px: f64, way: impl Fn(f64) -> PxPoint) -> f64 {
        const STEP_PX: f64 = 0.25;
        let mut reach = 0.0;
        while reach + STEP_PX <= limit_px {
            let next = reach + STEP_PX;
            let at = way(next);
            if !self.is_ink_around(at) {
                break;
            }
            reach = next;
        }
        reach
    }

    /// How many pixels of ink follow the one of a place, at most `limit_px`.
    pub(super) fn pixels_of_ink(&self, from: PxPoint, direction: PxVec, limit_px: f64) -> f64 {
        let mut count = 0.0;
        while count < limit_px && self.is_ink_around(from + direction * (count + 1.0)) {
            count += 1.0;
        }
        count
    }

    /// Whether the pixel that a place lies in is ink.
    pub(super) fn is_ink_around(&self, at: PxPoint) -> bool {
        self.is_ink(libm::floor(at.x), libm::floor(at.y))
    }

    /// How far a place is from the rim of the picture, px; negative beyond it.
    pub(super) fn rim_px(&self, at: PxPoint) -> f64 {
        let [top, bottom] = self.rows().map(f64::from);
        at.x.min(f64::from(self.ink.width()) - at.x).min(at.y - top).min(bottom - at.y)
    }

    /// The first row of the picture, and the one after the last: those that are there.
    fn rows(&self) -> [u32; 2] {
        [self.first_row, self.first_row.saturating_add(self.ink.height())]
    }

    /// How far from a place the rim of the picture is in a direction, px.
    pub(super) fn rim_along_px(&self, from: PxPoint, PxVec { x: dx, y: dy }: PxVec) -> f64 {
        let [top, bottom] = self.rows().map(f64::from);
        let side = |at: f64, d: f64, low: f64, high: f64| {
            if d == 0.0 { f64::INFINITY } else { (if d > 0.0 { high } else { low } - at) / d }
        };
        side(from.x, dx, 0.0, self.ink.width().into()).min(side(from.y, dy, top, bottom)).max(0.0)
    }

    /// Whether the ink along the rim, at a place on it that a line comes to in a direction, is at least so wide across the
    /// line, px.
    pub(super) fn is_cut_at(&self, rim: PxPoint, PxVec { x: dx, y: dy }: PxVec, least_px: f64) -> bool {
        let Some((side, low, high)) = self.rim_run(rim) else { return false };
        (high - low) * if side.upright() { dx.abs() } else { dy.abs() } >= least_px
    }

    /// The side of the picture that is nearest to a place, and where the ink along its rim begins and ends that is next to the
    /// place, px.
    pub(super) fn rim_run(&self, at: PxPoint) -> Option<(Side, f64, f64)> {
        let [top, bottom] = self.rows().map(f64::from);
        let width = f64::from(self.ink.width());
        let sides = [
            (Side::Left, at.x, PxPoint::new(0.5, at.y)),
            (Side::Right, width - at.x, PxPoint::new(width - 0.5, at.y)),
            (Side::Top, at.y - top, PxPoint::new(at.x, top + 0.5)),
            (Side::Bottom, bottom - at.y, PxPoint::new(at.x, bottom - 0.5)),
        ];
        let (side, _, on) = sides.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let (x, y) = (on.x.clamp(0.5, width - 0.5), on.y.clamp(top + 0.5, bottom - 0.5));
        if !self.is_ink(libm::floor(x), libm::floor(y)) {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a pixel of ink")]
        let (low, high) = self.run(Pixel::new(x as u32, y as u32), side.upright());
        Some((side, low, high))
    }

    /// Whether the pixel in column `x` and row `y`, whole numbers, is ink.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole numbers within the picture"
    )]
    fn is_ink(&self, x: f64, y: f64) -> bool {
        let row = y - f64::from(self.first_row);
        let inside =
            x >= 0.0 && row >= 0.0 && x < f64::from(self.ink.width()) && row < f64::from(self.ink.height());
        inside && self.ink.get(Pixel::new(x as u32, row as u32))
    }

    /// Whether a pen that leaves at least a disc of a radius, px, may have been at a place. A thin one leaves no disc that is
    /// sure: where levels are known, it has made the place at least half as dark as its lines, else there is ink within
    /// half a pixel.
    pub(super) fn pen_was_at(&self, at: PxPoint, least_px: f64) -> bool {
        if least_px <= THIN_DISC_PX
            && let Some(share) = self.share_of_ink(at)
        {
            return share >= LEAST_SHARE;
        }
        if least_px > 0.0 {
            return self.radius_px(at, least_px + 1.0) >= least_px;
        }
        let beside = [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)];
        beside.into_iter().any(|(x, y)| self.is_ink(libm::floor(at.x + x), libm::floor(at.y + y)))
    }

    /// How dark a place is, between the lightest (0) and the darkest (1) around it: between the middles of pixels in
    /// proportion. None without grey levels.
    fn share_of_ink(&self, at: PxPoint) -> Option<f64> {
        let rims = self.grey?;
        let (left, top) = (libm::floor(at.x - 0.5), libm::floor(at.y - 0.5));
        let (right, below) = (at.x - 0.5 - left, at.y - 0.5 - top);
        let (mut paper, mut full, mut here) = (f64::INFINITY, 0.0_f64, 0.0);
        for (dy, dx) in (-2..=3_i32).flat_map(|dy| (-2..=3_i32).map(move |dx| (dy, dx))) {
            let darkness = rims.darkness(left + f64::from(dx), top + f64::from(dy));
            (paper, full) = (paper.min(darkness), full.max(darkness));
            let weight = |step: i32, part: f64| match step {
                0 => 1.0 - part,
                1 => part,
                _ => 0.0,
            };
            here += weight(dx, right) * weight(dy, below) * darkness;
        }
        (full > paper).then(|| (here - paper) / (full - paper))
    }

    /// A pixel and the 127 to the right of it, a bit each from the lowest on, set where there is ink.
    pub(crate) fn ink_from(&self, at: Pixel) -> u128 {
        let row = at.y.checked_sub(self.first_row).map_or(&[][..], |row| self.ink.row(row));
        let (first, bit) = ((at.x / u64::BITS) as usize, at.x % u64::BITS);
        let word = |index: usize| row.get(first + index).copied().map_or(0, u128::from);
        let two = (word(0) | word(1) << u64::BITS) >> bit;
        if bit == 0 { two } else { two | word(2) << (u128::BITS - bit) }
    }

    /// Whether a pixel is ink.
    pub(crate) fn is_ink_at(&self, at: Pixel) -> bool {
        at.y.checked_sub(self.first_row).is_some_and(|row| self.ink.get(Pixel::new(at.x, row)))
    }
}

/// The least of the values at most `reach` before and after the one at `index`, of `count`; of a closed line, whose last
/// site is its first one again, around its end.
pub(super) fn least_around(
    count: usize,
    index: usize,
    reach: usize,
    closed: bool,
    value: impl Fn(usize) -> Option<f64>,
) -> f64 {
    let around = count.saturating_sub(1);
    let at = |step: usize| {
        let ahead = index + step;
        if closed && around > 0 {
            Some((ahead + around - reach % around) % around)
        } else {
            ahead.checked_sub(reach)
        }
    };
    let least = |least: f64, value: f64| if value < least { value } else { least };
    match index.checked_sub(reach) {
        Some(first) if !closed || index + reach < around => {
            (first..count.min(index + reach + 1)).filter_map(value).fold(f64::INFINITY, least)
        }
        _ => (0..=2 * reach).filter_map(at).filter_map(value).fold(f64::INFINITY, least),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_radius_is_that_to_the_nearest_paper() {
        // A slanted bar with a hole in it, seen as rows 1000 and after.
        let mut ink = Bitmap::new(90, 60).unwrap();
        for (x, y) in (0..90).flat_map(|x| (0..60).map(move |y| (x, y))) {
            let off = i64::from(y) - i64::from(x) / 3 - 18;
            ink.set(Pixel::new(x, y), off.abs() < 11 && (x, y) != (40, 31));
        }
        let scan = Scan { ink: &ink, first_row: 1000, grey: None, hairlines: Hairlines::Raster };
        let is_paper = |x: i32, y: i32| {
            let inside = u32::try_from(x).ok().zip(u32::try_from(y - 1000).ok());
            inside.is_none_or(|(x, y)| !ink.get(Pixel::new(x, y)))
        };
        for step in 0..400_i32 {
            let at = PxPoint::new(
                f64::from(step * 37 % 951) / 10.0 - 2.0,
                998.0 + f64::from(step * 53 % 640) / 10.0,
            );
            let around = (-30..120).flat_map(|x| (970..1090).map(move |y| (x, y)));
            let nearest = around
                .filter(|(x, y)| is_paper(*x, *y))
                .map(|(x, y)| libm::hypot(f64::from(x) + 0.5 - at.x, f64::from(y) + 0.5 - at.y))
                .fold(f64::INFINITY, f64::min);
            let limited = |limit: f64| (nearest.min(limit + 0.5) - 0.5).max(0.0);
            assert!((scan.radius_px(at, f64::MAX) - limited(96.0)).abs() < 1e-12, "{at:?}");
            assert!((scan.radius_px(at, 4.0) - limited(4.0)).abs() < 1e-12, "{at:?}");
        }
    }

    #[test]
    fn the_ink_to_the_right_is_that_of_its_pixels() {
        let mut ink = Bitmap::new(300, 3).unwrap();
        (0..300).filter(|x| x * x % 7 < 3).for_each(|x| ink.set(Pixel::new(x, 1), true));
        let scan = Scan { ink: &ink, first_row: 1000, grey: None, hairlines: Hairlines::Raster };
        for at in (999..1004).flat_map(|y| [0, 1, 63, 64, 100, 180, 250, 299, 400].map(|x| Pixel::new(x, y)))
        {
            let bits = scan.ink_from(at);
            assert!(
                (0..128).all(|x| (bits >> x & 1 == 1) == scan.is_ink_at(Pixel::new(at.x + x, at.y))),
                "{at:?}"
            );
        }
    }

    #[test]
    fn a_thin_pen_was_where_it_left_ink_and_not_beside() {
        // A pen 1 px wide went level at 10.3, whose ink is as dark as it covers the pixels.
        let middle = 10.3;
        let mut ink = Bitmap::new(40, 20).unwrap();
        let covered = |y: u32| (1.0 - (f64::from(y) + 0.5 - middle).abs()).clamp(0.0, 1.0);
        let level = |at: u32| libm::round(255.0 * (1.0 - covered(at / 40)));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a level")]
        let levels = Gray::new(40, 20, (0..40 * 20).map(|at| level(at) as u8).collect()).unwrap();
        (0..40).for_each(|x| ink.set(Pixel::new(x, 10), true));
        let grey = Some(Rims { levels: &levels, ink_is_dark: true, first_row: 1000 });
        let scan = Scan { ink: &ink, first_row: 1000, grey, hairlines: Hairlines::Raster };
        for step in 0..40 {
            let x = 15.0 + f64::from(step) / 8.0;
            let at = |off_px: f64| scan.pen_was_at(PxPoint::new(x, 1000.0 + middle + off_px), 0.05);
            assert_eq!([-0.9, 0.0, 0.9].map(at), [false, true, false], "{x}");
        }
        // At the corner of four pixels of paper there is room for a disc, but no ink.
        let black_and_white = Scan { grey: None, ..scan };
        assert!(black_and_white.pen_was_at(PxPoint::new(15.0, 1009.0), 0.05));
        assert!(!scan.pen_was_at(PxPoint::new(15.0, 1009.0), 0.05));
    }
}
