//! [`PointTree`]: points that are found by nearness, and can be taken out.

use crate::PxPoint;
use crate::centrelines::each;

/// Points in a balanced k-d tree: the node of a range is its middle element, the halves are its subtrees, split by x
/// and y in turn (J. L. Bentley, "Multidimensional binary search trees", 1975).
///
/// The order of equal coordinates is that of the points' numbers, so the tree is the same on every machine.
#[derive(Debug)]
pub(crate) struct PointTree {
    /// Each with its number; `GONE` when it was taken out.
    points: Vec<(PxPoint, u32)>,
    /// Points left in the subtree of each node.
    left: Vec<u32>,
    /// Node of each point.
    nodes: Vec<u32>,
}

/// Most points of a range that is split by one core: less than a millisecond of work.
const ALONE: usize = 10_000;

/// No point.
const GONE: u32 = u32::MAX;

impl PointTree {
    /// The tree of the points; they are numbered as they come, up to `u32::MAX` of them.
    pub(crate) fn new(points: impl Iterator<Item = PxPoint>) -> Self {
        let mut points: Vec<(PxPoint, u32)> = points.zip(0..).collect();
        let mut left = vec![0; points.len()];
        split(&mut points, &mut left, false);
        let mut nodes = vec![0; points.len()];
        for ((_, id), node) in points.iter().zip(0..) {
            if let Some(slot) = nodes.get_mut(*id as usize) {
                *slot = node;
            }
        }
        Self { points, left, nodes }
    }

    /// Takes a point out.
    pub(crate) fn remove(&mut self, id: u32) {
        let Some(node) = self.nodes.get(id as usize).map(|node| *node as usize) else { return };
        let Some(point) = self.points.get_mut(node).filter(|point| point.1 != GONE) else { return };
        point.1 = GONE;
        let (mut low, mut high) = (0, self.points.len());
        while low < high {
            let middle = low + (high - low) / 2;
            if let Some(count) = self.left.get_mut(middle) {
                *count = count.saturating_sub(1);
            }
            match node.cmp(&middle) {
                core::cmp::Ordering::Less => high = middle,
                core::cmp::Ordering::Equal => return,
                core::cmp::Ordering::Greater => low = middle + 1,
            }
        }
    }

    /// The nearest point that is left.
    pub(crate) fn nearest(&self, at: PxPoint) -> Option<u32> {
        let mut best = None;
        self.visit(at, f64::INFINITY, &mut |id, squared| {
            best = Some(id);
            squared
        });
        best
    }

    /// Calls `found` with points nearer than the square root of `squared`, and with the square of their distance;
    /// it returns the square below which it still wants points.
    pub(crate) fn visit(&self, at: PxPoint, squared: f64, found: &mut impl FnMut(u32, f64) -> f64) {
        let mut squared = squared;
        self.search(at, (0, self.points.len()), false, &mut squared, found);
    }

    /// Searches a range; the recursion is as deep as the tree, the logarithm of the number of points.
    fn search(
        &self,
        at: PxPoint,
        (low, high): (usize, usize),
        by_y: bool,
        squared: &mut f64,
        found: &mut impl FnMut(u32, f64) -> f64,
    ) {
        let middle = low + (high - low) / 2;
        let Some((point, id)) =
            self.points.get(middle).filter(|_| low < high && self.left.get(middle) != Some(&0))
        else {
            return;
        };
        let (dx, dy) = (at.x - point.x, at.y - point.y);
        let distance = dx * dx + dy * dy;
        if distance < *squared && *id != GONE {
            *squared = found(*id, distance);
        }
        let beyond = if by_y { dy } else { dx };
        let (below, above) = ((low, middle), (middle + 1, high));
        let (near, far) = if beyond < 0.0 { (below, above) } else { (above, below) };
        self.search(at, near, !by_y, squared, found);
        // Not `<=`: of many points in one place a search must not look at all.
        if beyond * beyond < *squared {
            self.search(at, far, !by_y, squared, found);
        }
    }
}

fn split(points: &mut [(PxPoint, u32)], left: &mut [u32], by_y: bool) {
    let count = points.len();
    if count == 0 || left.len() != count {
        return;
    }
    let middle = count / 2;
    points.select_nth_unstable_by(middle, |a, b| {
        let (a_at, b_at) = if by_y { (a.0.y, b.0.y) } else { (a.0.x, b.0.x) };
        a_at.total_cmp(&b_at).then(a.1.cmp(&b.1))
    });
    let (low_points, high_points) = points.split_at_mut(middle);
    let (low_left, high_left) = left.split_at_mut(middle);
    if let (Some((_, high_points)), Some((own, high_left))) =
        (high_points.split_first_mut(), high_left.split_first_mut())
    {
        *own = u32::try_from(count).unwrap_or(u32::MAX);
        let halves = [(low_points, low_left), (high_points, high_left)];
        if count > ALONE {
            each(halves.into(), |(points, left)| split(points, left, !by_y));
        } else {
            halves.into_iter().for_each(|(points, left)| split(points, left, !by_y));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_is_the_nearest_one_left() {
        let places: Vec<PxPoint> =
            (0..50_u32).map(|k| PxPoint::new(f64::from(k * 37 % 50), f64::from(k * 11 % 50))).collect();
        let mut tree = PointTree::new(places.iter().copied());
        let mut left: Vec<u32> = (0..50).collect();
        let at = PxPoint::new(20.3, 19.9);
        while let Some(id) = tree.nearest(at) {
            let far = |id: u32| at.distance(places[id as usize]);
            let plain = left.iter().map(|id| far(*id)).fold(f64::INFINITY, f64::min);
            assert_eq!(far(id), plain);
            tree.remove(id);
            left.retain(|other| *other != id);
        }
        assert!(left.is_empty());
    }
}
