//! [`Strip`]: the straight lines that pass near enough to some middles of a line's columns.
//!
//! Source: L. Dorst, A. W. M. Smeulders, "Discrete representation of straight lines" (1984): the domain of a digital
//! straight segment, a polygon in the plane of slope and offset; here with the middles between both edges of the ink in
//! place of pixels.

use crate::stroke::{PxPoint, PxVec};

/// How far a straight line passes from the middle of each column, px: less than half a pixel, by more than rounding.
const HALF_PX: f64 = 0.4999;

/// Rounding of a corner of the polygon, px: it is cut no finer.
const ROUNDING_PX: f64 = 1e-7;

/// Steepest slope against the axis that the lines mostly follow.
const STEEPEST: f64 = 1.25;

/// How far from its origin a line may pass, px.
const FAR_PX: f64 = 4.0;

/// Most corners of the polygon: of the raster of a straight line it has four.
const MOST_CORNERS: usize = 16;

/// A straight line: a place on it, and its direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    origin: PxPoint,
    direction: PxVec,
}

impl Line {
    /// How far along it the place is that is nearest to another, px.
    pub(super) fn along_px(&self, at: PxPoint) -> f64 {
        (at - self.origin).dot(self.direction)
    }

    /// The place so far along it.
    pub(super) fn at(&self, along_px: f64) -> PxPoint {
        self.origin + self.direction * along_px
    }

    /// The place on it that is nearest to another.
    pub(super) fn foot(&self, at: PxPoint) -> PxPoint {
        self.at(self.along_px(at))
    }

    /// How far across a line along an axis places lie in the mean, px; none for other lines, and without places.
    pub(super) fn level_off_px(&self, places: &[PxPoint]) -> Option<f64> {
        let PxVec { x: u, y: v } = self.direction;
        let is_level = u == 0.0 || v == 0.0;
        #[expect(clippy::cast_precision_loss, reason = "two ends")]
        let count = places.len() as f64;
        let across = |at: &PxPoint| {
            let PxVec { x, y } = *at - self.origin;
            y * u - x * v
        };
        (is_level && count > 0.0).then(|| places.iter().map(across).sum::<f64>() / count)
    }

    /// The same so far to the side.
    pub(super) fn shifted(&self, across_px: f64) -> Self {
        Self { origin: self.origin + self.direction.perpendicular() * across_px, ..*self }
    }

    /// How far a place lies beside it, px.
    pub(super) fn off_px(&self, at: PxPoint) -> f64 {
        self.foot(at).distance(at)
    }

    /// Where two lines cross that do not run nearly the same way.
    pub(super) fn crossing(&self, other: &Self) -> Option<PxPoint> {
        const LEAST_SINE: f64 = 0.05;
        let sine = self.direction.cross(other.direction);
        let between = other.origin - self.origin;
        (sine.abs() > LEAST_SINE)
            .then(|| self.origin + self.direction * (between.cross(other.direction) / sine))
    }
}

/// Slopes and offsets of straight lines: the corners of a convex polygon.
#[derive(Clone, Copy, Debug)]
struct Polygon {
    corners: [(f64, f64); MOST_CORNERS],
    count: usize,
}

impl Polygon {
    const EMPTY: Self = Self { corners: [(0.0, 0.0); MOST_CORNERS], count: 0 };

    fn corners(&self) -> &[(f64, f64)] {
        self.corners.get(..self.count).unwrap_or(&[])
    }

    fn add(&mut self, corner: (f64, f64)) {
        if let Some(slot) = self.corners.get_mut(self.count) {
            *slot = corner;
        }
        self.count += 1;
    }

    /// Makes `cut` the part where a linear function is not negative; `false` when there is none.
    fn cut(&self, inside: impl Fn(&(f64, f64)) -> f64, cut: &mut Self) -> bool {
        cut.count = 0;
        let Some(mut before) = self.corners().last().copied() else { return false };
        let mut before_by = inside(&before);
        for corner in self.corners() {
            let by = inside(corner);
            // A corner on the line of the cut is where its side begins or ends.
            let crosses = |one: f64, other: f64| one < -ROUNDING_PX && other > ROUNDING_PX;
            if crosses(by, before_by) || crosses(before_by, by) {
                let t = before_by / (before_by - by);
                cut.add((before.0 + (corner.0 - before.0) * t, before.1 + (corner.1 - before.1) * t));
            }
            if is_inside(by) {
                cut.add(*corner);
            }
            (before, before_by) = (*corner, by);
        }
        (1..=MOST_CORNERS).contains(&cut.count)
    }
}

/// Whether a corner is so far inside a cut that it stays, px.
fn is_inside(by: f64) -> bool {
    by >= -ROUNDING_PX
}

/// The straight lines that pass all places so far near enough.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strip {
    origin: PxPoint,
    /// Whether the lines mostly run up and down.
    upright: bool,
    /// The lines, and memory for what is cut of them: by turns, so that nothing is copied.
    polygons: [Polygon; 3],
    /// Which of them the lines are.
    now: usize,
    /// Of the places taken: their number, and the sums of u, v, u² and u·v, u along and v across.
    sums: [f64; 5],
}

impl Strip {
    /// All lines that pass a place somewhere near, and mostly run up and down or sideways.
    pub(super) fn new(origin: PxPoint, upright: bool) -> Self {
        let all = [(-STEEPEST, -FAR_PX), (STEEPEST, -FAR_PX), (STEEPEST, FAR_PX), (-STEEPEST, FAR_PX)];
        let mut polygons = [Polygon::EMPTY; 3];
        all.into_iter().for_each(|corner| polygons[0].add(corner));
        Self { origin, upright, polygons, now: 0, sums: [0.0; 5] }
    }

    fn corners(&self) -> &[(f64, f64)] {
        self.polygons.get(self.now).map_or(&[], Polygon::corners)
    }

    /// Which polygon is the part of one of them where a linear function is not negative.
    fn cut(&mut self, from: usize, inside: impl Fn(&(f64, f64)) -> f64) -> Option<usize> {
        let to = (from + 1) % self.polygons.len();
        let [polygon, cut] = self.polygons.get_disjoint_mut([from, to]).ok()?;
        // Most cuts leave it as it is.
        if polygon.corners().iter().all(|corner| is_inside(inside(corner))) {
            return Some(from);
        }
        polygon.cut(inside, cut).then_some(to)
    }

    /// How far along the axis from the origin a place lies, and how far across, px.
    pub(super) fn along_across(&self, at: PxPoint) -> (f64, f64) {
        let PxVec { x, y } = at - self.origin;
        if self.upright { (y, x) } else { (x, y) }
    }

    /// Keeps the lines that pass a place near enough; `false`, and no change, when there are none.
    pub(super) fn take(&mut self, (along, across): (f64, f64)) -> bool {
        let off = |(slope, offset): &(f64, f64)| slope * along + offset - across;
        if !self.corners().iter().all(|corner| off(corner).abs() <= HALF_PX + ROUNDING_PX) {
            let below = self.cut(self.now, |corner| HALF_PX - off(corner));
            let Some(cut) = below.and_then(|below| self.cut(below, |corner| off(corner) + HALF_PX)) else {
                return false;
            };
            self.now = cut;
        }
        let add = [1.0, along, across, along * along, along * across];
        self.sums.iter_mut().zip(add).for_each(|(sum, add)| *sum += add);
        true
    }

    /// Whether all lines pass a place farther off than so much, px.
    pub(super) fn is_beyond(&self, (along, across): (f64, f64), px: f64) -> bool {
        let off = |(slope, offset): &(f64, f64)| slope * along + offset - across;
        self.corners().iter().all(|corner| off(corner) > px)
            || self.corners().iter().all(|corner| off(corner) < -px)
    }

    /// The line of the least squared distances across from all places that were taken, or the nearest to it that passes them
    /// near enough, on the way from the middle of all that do.
    pub(super) fn best(&self) -> Line {
        let [n, u, v, uu, uv] = self.sums;
        let determinant = n * uu - u * u;
        let middle = self.middle();
        let (slope, offset) = if determinant > 0.0 {
            self.nearest(middle, ((n * uv - u * v) / determinant, (v * uu - u * uv) / determinant))
        } else {
            middle
        };
        let (slope, offset) = (rounded(slope), rounded(offset));
        let length = libm::sqrt(1.0 + slope * slope);
        let turn = |along: f64, across: f64| {
            if self.upright { PxVec::new(across, along) } else { PxVec::new(along, across) }
        };
        Line { origin: self.origin + turn(0.0, offset), direction: turn(1.0 / length, slope / length) }
    }

    /// The mean of the polygon's corners.
    fn middle(&self) -> (f64, f64) {
        #[expect(clippy::cast_precision_loss, reason = "a few corners")]
        let count = self.corners().len().max(1) as f64;
        let sum = |(a, b): (f64, f64), (slope, offset): &(f64, f64)| (a + slope, b + offset);
        let (slope, offset) = self.corners().iter().fold((0.0, 0.0), sum);
        (slope / count, offset / count)
    }

    /// The last place in the polygon on the way from its middle to another.
    fn nearest(&self, middle: (f64, f64), (slope, offset): (f64, f64)) -> (f64, f64) {
        let way = (slope - middle.0, offset - middle.1);
        let next = self.corners().iter().skip(1).chain(self.corners().first());
        let mut part = 1.0_f64;
        for (from, to) in self.corners().iter().zip(next) {
            let side = (to.0 - from.0, to.1 - from.1);
            let here = side.0 * (middle.1 - from.1) - side.1 * (middle.0 - from.0);
            let by = side.0 * way.1 - side.1 * way.0;
            if by < 0.0 {
                part = part.min((-here / by).max(0.0));
            }
        }
        (middle.0 + way.0 * part, middle.1 + way.1 * part)
    }
}

/// A slope or an offset without the last bits, which rounding has made: a level line is level.
fn rounded(number: f64) -> f64 {
    /// 2 to the power of 36: a line of 10⁵ px is as good to 10⁻⁶ px.
    const STEPS: f64 = 68_719_476_736.0;
    libm::round(number * STEPS) / STEPS
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The middles of the columns of a line, rounded to whole pixels.
    fn stairs(slope: f64, offset: f64, columns: u32) -> impl Iterator<Item = PxPoint> {
        (0..columns).map(f64::from).map(move |x| PxPoint::new(x, libm::floor(slope * x + offset + 0.5)))
    }

    fn takes(strip: &mut Strip, at: PxPoint) -> bool {
        strip.take(strip.along_across(at))
    }

    #[test]
    fn the_raster_of_a_straight_line_is_near_one_and_the_middle_of_all_is_that() {
        for (slope, offset) in
            [(0.0, 0.1), (0.01, 0.3), (-0.01, 0.0), (0.05, -0.2), (0.377, 0.4), (0.983, 0.2)]
        {
            let mut strip = Strip::new(PxPoint::default(), false);
            assert!(stairs(slope, offset, 400).all(|at| takes(&mut strip, at)), "{slope}");
            let line = strip.best();
            // Of a level line nothing is known but its row.
            let within_px = if slope == 0.0 { 0.5 } else { 0.05 };
            for x in [0.0, 200.0, 399.0] {
                let off_px = line.off_px(PxPoint::new(x, slope * x + offset));
                assert!(off_px <= within_px, "{slope}: {off_px} px at {x}");
            }
        }
    }

    #[test]
    fn a_level_line_is_level_to_the_last_bit() {
        let mut strip = Strip::new(PxPoint::new(7.5, 3.5), false);
        assert!((0..900).all(|x| takes(&mut strip, PxPoint::new(f64::from(x), 3.5))));
        assert_eq!(strip.best().foot(PxPoint::new(100.0, 4.0)), PxPoint::new(100.0, 3.5));
    }

    #[test]
    fn the_raster_of_an_arc_is_near_none_after_its_first_stairs() {
        let radius_px = 200.0;
        let mut strip = Strip::new(PxPoint::default(), false);
        let arc = (0..200).map(f64::from).map(|x| PxPoint::new(x, libm::round(x * x / (2.0 * radius_px))));
        let taken = arc.take_while(|at| takes(&mut strip, *at)).count();
        assert!((20..=40).contains(&taken), "{taken}");
        // What is not near any line changes nothing.
        let before = strip.best().foot(PxPoint::new(10.0, 0.0));
        assert!(!takes(&mut strip, PxPoint::new(60.0, 9.0)));
        assert_eq!(strip.best().foot(PxPoint::new(10.0, 0.0)), before);
    }
}
