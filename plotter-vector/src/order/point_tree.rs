//! [`PointTree`]: points that are found by nearness, and can be taken out.

use super::sites::number;
use crate::parallel::each;
use crate::stroke::PxPoint;
use core::cmp::Ordering;

/// Points in a balanced k-d tree: the node of a range is its middle element, the halves are its subtrees,
/// split by x and y in turn (J. L. Bentley, "Multidimensional binary search trees", 1975).
///
/// The tree knows the points by number only, four bytes each; where they lie is asked of `place`, which has
/// to say the same at every call. The order of equal coordinates is that of the numbers, so the tree is the
/// same on every machine.
#[derive(Debug)]
pub(crate) struct PointTree {
    /// The points' numbers.
    ids: Vec<u32>,
    /// `GONE` and `EMPTY` of each node; nothing as long as no point was taken out.
    states: Vec<u8>,
}

/// Most points of a range that is split by one core: less than a millisecond of work.
const ALONE: usize = 10_000;

/// The point of the node was taken out; and so were all others of its subtree.
const GONE: u8 = 1;
const EMPTY: u8 = 2;

/// Most levels of the tree: of 2³² points it has 33.
const MOST_LEVELS: usize = 33;

impl PointTree {
    /// The tree of so many points, up to `u32::MAX`.
    pub(crate) fn new(count: usize, place: &(impl Fn(u32) -> PxPoint + Sync)) -> Self {
        Self::of((0..number(count)).collect(), place)
    }

    /// The tree of points with these numbers.
    pub(crate) fn of(mut ids: Vec<u32>, place: &(impl Fn(u32) -> PxPoint + Sync)) -> Self {
        split_all(&mut ids, false, place);
        Self { ids, states: Vec::new() }
    }

    fn state(&self, node: usize) -> u8 {
        self.states.get(node).copied().unwrap_or(0)
    }

    fn is_empty(&self, low: usize, high: usize) -> bool {
        low >= high || self.state(middle_of(low, high)) & EMPTY != 0
    }

    /// Takes a point out.
    pub(crate) fn remove(&mut self, id: u32, place: &impl Fn(u32) -> PxPoint) {
        self.states.resize(self.ids.len(), 0);
        let own = (place(id), id);
        let mut ranges = [(0, 0); MOST_LEVELS];
        let (mut low, mut high, mut by_y, mut level) = (0, self.ids.len(), false, 0);
        while low < high {
            let Some(range) = ranges.get_mut(level) else { return };
            *range = (low, high);
            level += 1;
            let middle = middle_of(low, high);
            let Some(other) = self.ids.get(middle) else { return };
            match compared(own, (place(*other), *other), by_y) {
                Ordering::Less => high = middle,
                Ordering::Equal => {
                    self.leave(ranges.get(..level).unwrap_or(&[]));
                    return;
                }
                Ordering::Greater => low = middle + 1,
            }
            by_y = !by_y;
        }
    }

    /// Marks the node of the last of these ranges, each a half of the one before.
    fn leave(&mut self, ranges: &[(usize, usize)]) {
        let mut state = GONE;
        for (low, high) in ranges.iter().rev().copied() {
            let middle = middle_of(low, high);
            state |= self.state(middle);
            let is_empty = state & GONE != 0 && self.is_empty(low, middle) && self.is_empty(middle + 1, high);
            if let Some(slot) = self.states.get_mut(middle) {
                *slot = state | if is_empty { EMPTY } else { 0 };
            }
            if !is_empty {
                return;
            }
            state = 0;
        }
    }

    /// The nearest point that is left.
    pub(crate) fn nearest(&self, at: PxPoint, place: &impl Fn(u32) -> PxPoint) -> Option<u32> {
        let mut best = None;
        self.visit(at, f64::INFINITY, place, &mut |id, squared| {
            best = Some(id);
            squared
        });
        best
    }

    /// Calls `found` with points nearer than the square root of `squared`, and with the square of their
    /// distance; it returns the square below which it still wants points.
    pub(crate) fn visit(
        &self,
        at: PxPoint,
        squared: f64,
        place: &impl Fn(u32) -> PxPoint,
        found: &mut impl FnMut(u32, f64) -> f64,
    ) {
        let mut squared = squared;
        self.search(at, PxPoint::new(0.0, 0.0), (0, self.ids.len()), false, &mut squared, place, found);
    }

    /// Searches a range whose rectangle begins so far `beside` the place, along x and along y; the recursion is
    /// as deep as the tree, the logarithm of the number of points.
    #[expect(clippy::too_many_arguments, reason = "a recursion's own")]
    fn search(
        &self,
        at: PxPoint,
        beside: PxPoint,
        (low, high): (usize, usize),
        by_y: bool,
        squared: &mut f64,
        place: &impl Fn(u32) -> PxPoint,
        found: &mut impl FnMut(u32, f64) -> f64,
    ) {
        let middle = middle_of(low, high);
        let state = self.state(middle);
        let Some(id) = self.ids.get(middle).filter(|_| low < high && state & EMPTY == 0) else { return };
        let point = place(*id);
        let (dx, dy) = (at.x - point.x, at.y - point.y);
        let distance = dx * dx + dy * dy;
        if distance < *squared && state & GONE == 0 {
            *squared = found(*id, distance);
        }
        let beyond = if by_y { dy } else { dx };
        let (below, above) = ((low, middle), (middle + 1, high));
        let (near, far) = if beyond < 0.0 { (below, above) } else { (above, below) };
        self.search(at, beside, near, !by_y, squared, place, found);
        // Both coordinates count, and not `<=`: of many points in one place a search must not look at all.
        let beside = if by_y { PxPoint::new(beside.x, dy) } else { PxPoint::new(dx, beside.y) };
        if beside.x * beside.x + beside.y * beside.y < *squared {
            self.search(at, beside, far, !by_y, squared, place, found);
        }
    }
}

/// The node of a range.
fn middle_of(low: usize, high: usize) -> usize {
    low + high.saturating_sub(low) / 2
}

/// Which of two points comes first in a range that is split by y, or by x.
fn compared(a: (PxPoint, u32), b: (PxPoint, u32), by_y: bool) -> Ordering {
    let (a_at, b_at) = if by_y { (a.0.y, b.0.y) } else { (a.0.x, b.0.x) };
    a_at.total_cmp(&b_at).then(a.1.cmp(&b.1))
}

/// Splits a range of points whose places are asked for, until they are few enough to have them side by side.
fn split_all(ids: &mut [u32], by_y: bool, place: &(impl Fn(u32) -> PxPoint + Sync)) {
    if ids.len() <= ALONE {
        let mut points: Vec<(PxPoint, u32)> = ids.iter().map(|id| (place(*id), *id)).collect();
        split(&mut points, by_y);
        ids.iter_mut().zip(points).for_each(|(slot, (_, id))| *slot = id);
        return;
    }
    let middle = ids.len() / 2;
    ids.select_nth_unstable_by(middle, |a, b| compared((place(*a), *a), (place(*b), *b), by_y));
    let (below, rest) = ids.split_at_mut(middle);
    if let Some((_, above)) = rest.split_first_mut() {
        each(vec![below, above], |half| split_all(half, !by_y, place));
    }
}

fn split(points: &mut [(PxPoint, u32)], by_y: bool) {
    if points.len() < 2 {
        return;
    }
    let middle = points.len() / 2;
    points.select_nth_unstable_by(middle, |a, b| compared(*a, *b, by_y));
    let (below, rest) = points.split_at_mut(middle);
    split(below, !by_y);
    if let Some((_, above)) = rest.split_first_mut() {
        split(above, !by_y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_is_the_nearest_one_left() {
        let places: Vec<PxPoint> =
            (0..50_u32).map(|k| PxPoint::new(f64::from(k * 37 % 50), f64::from(k * 11 % 50))).collect();
        let place = |id: u32| places[id as usize];
        let mut tree = PointTree::new(places.len(), &place);
        let mut left: Vec<u32> = (0..50).collect();
        let at = PxPoint::new(20.3, 19.9);
        while let Some(id) = tree.nearest(at, &place) {
            let far = |id: u32| at.distance(places[id as usize]);
            let plain = left.iter().map(|id| far(*id)).fold(f64::INFINITY, f64::min);
            assert_eq!(far(id), plain);
            tree.remove(id, &place);
            tree.remove(id, &place);
            left.retain(|other| *other != id);
        }
        assert!(left.is_empty());
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn equal_points_are_taken_out_one_by_one() {
        let place = |_: u32| PxPoint::new(3.0, 4.0);
        let mut tree = PointTree::new(30_000, &place);
        for left in (0..30_000).rev() {
            let id = tree.nearest(PxPoint::new(0.0, 0.0), &place).unwrap();
            tree.remove(id, &place);
            assert_eq!(tree.nearest(PxPoint::new(0.0, 0.0), &place).is_some(), left > 0);
        }
    }
}
