//! [`Poses`]: places of keyframes that agree with all that windows told of the ways between them.
//!
//! Where no line ends, turns or crosses, the camera's place along the lines comes from the table alone. What that misses shows when the
//! camera comes back to a keyframe of before: then the map, as it was seen on one way, does not fit what was seen on the other, and the
//! tool would be beside the line wherever the two meet. Least squares spread what is missing over the ways that were known badly.
//!
//! Windows do not turn, so that a pose is a place, and the equations are linear.
//!
//! Source: F. Lu, E. Milios, "Globally consistent range scan alignment for environment mapping" (1997); solved by conjugate gradients
//! (M. R. Hestenes, E. Stiefel, "Methods of conjugate gradients for solving linear systems", 1952), each place by its own 2 x 2 block.

use super::prior::Information;
use crate::stroke::{PxPoint, PxVec};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Most ways that are kept: a keyframe has few others around it.
const MOST_WAYS: usize = 1 << 15;

/// The right side is solved to this share.
const SOLVED: f64 = 1e-9;

/// A way from one keyframe to another.
#[derive(Clone, Copy, Debug)]
struct Way {
    ends: [usize; 2],
    px: PxVec,
    told: Information,
}

/// The ways that were seen between keyframes.
#[derive(Clone, Debug, Default)]
pub(super) struct Poses {
    ways: Vec<Way>,
}

fn dot(a: &[PxVec], b: &[PxVec]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}

impl Poses {
    /// Adds a way; one that is known already stays as it was seen first.
    pub(super) fn add(&mut self, ends: [usize; 2], px: PxVec, told: Information) {
        let is_known = |way: &Way| way.ends == ends || way.ends == [ends[1], ends[0]];
        if ends[0] != ends[1] && self.ways.len() < MOST_WAYS && !self.ways.iter().any(is_known) {
            self.ways.push(Way { ends, px, told });
        }
    }

    /// Forgets the first keyframes.
    pub(super) fn forget(&mut self, first: usize) {
        self.ways.retain_mut(|way| {
            let ends = way.ends.map(|end| end.checked_sub(first));
            let [Some(one), Some(other)] = ends else { return false };
            way.ends = [one, other];
            true
        });
    }

    /// Covariances of the places of all `count` keyframes seen from one of them, px²: those that add up on the best known way there; none
    /// where no way leads.
    pub(super) fn doubts(&self, from: usize, count: usize) -> Vec<Option<Information>> {
        let mut ways = vec![Vec::new(); count];
        for way in &self.ways {
            let doubt = way.told.inverse();
            for [one, other] in [way.ends, [way.ends[1], way.ends[0]]] {
                if let Some(ways) = ways.get_mut(one) {
                    ways.push((other, doubt));
                }
            }
        }
        let mut doubts = vec![None; count];
        // Numbers that are not negative are ordered as their bits are.
        let mut next = BinaryHeap::from([Reverse((0_u64, from))]);
        let mut reached = vec![Information::default(); count];
        let mut least = vec![f64::INFINITY; count];
        while let Some(Reverse((_, at))) = next.pop() {
            let Some(doubt @ None) = doubts.get_mut(at) else { continue };
            let here = reached.get(at).copied().unwrap_or_default();
            *doubt = Some(here);
            for (other, way) in ways.get(at).into_iter().flatten() {
                let there = here.plus(*way);
                let sum = there.xx + there.yy;
                if let (Some(least), Some(reached)) = (least.get_mut(*other), reached.get_mut(*other))
                    && sum < *least
                {
                    (*least, *reached) = (sum, there);
                    next.push(Reverse((sum.to_bits(), *other)));
                }
            }
        }
        doubts
    }

    /// How far each place should go, px; the first stays where it is.
    pub(super) fn shifts(&self, places: &[PxPoint]) -> Vec<PxVec> {
        let count = places.len();
        let (mut rest, mut own) = (vec![PxVec::default(); count], vec![Information::default(); count]);
        for way in &self.ways {
            let [Some(from), Some(to)] = way.ends.map(|end| places.get(end).copied()) else { continue };
            let missing = way.told.times(way.px - (to - from));
            for (end, sign) in way.ends.into_iter().zip([-1.0, 1.0]) {
                if let (Some(rest), Some(own)) = (rest.get_mut(end), own.get_mut(end)) {
                    *rest += missing * sign;
                    *own = own.plus(way.told);
                }
            }
        }
        let own: Vec<Information> = own.into_iter().map(Information::inverse).collect();
        let held = |mut all: Vec<PxVec>| {
            if let Some(first) = all.first_mut() {
                *first = PxVec::default();
            }
            all
        };
        let alone =
            |rest: &[PxVec]| held(rest.iter().zip(&own).map(|(rest, own)| own.times(*rest)).collect());
        let mut shifts = vec![PxVec::default(); count];
        let mut ahead = alone(&rest);
        let mut left = dot(&rest, &ahead);
        let enough = SOLVED * SOLVED * left;
        for _ in 0..4 * count {
            let told = held(self.times(&ahead));
            let share = left / dot(&ahead, &told);
            // Not where nothing is left, or nothing is told of what is.
            if left <= enough || !share.is_finite() {
                break;
            }
            for ((shift, rest), (ahead, told)) in
                shifts.iter_mut().zip(&mut rest).zip(ahead.iter().zip(&told))
            {
                *shift += *ahead * share;
                *rest -= *told * share;
            }
            let next = alone(&rest);
            let before = left;
            left = dot(&rest, &next);
            ahead = next.iter().zip(&ahead).map(|(next, ahead)| *next + *ahead * (left / before)).collect();
        }
        shifts
    }

    /// What shifts of all places do to the equations.
    fn times(&self, shifts: &[PxVec]) -> Vec<PxVec> {
        let mut sums = vec![PxVec::default(); shifts.len()];
        for way in &self.ways {
            let [Some(from), Some(to)] = way.ends.map(|end| shifts.get(end).copied()) else { continue };
            let told = way.told.times(to - from);
            for (end, sign) in way.ends.into_iter().zip([-1.0, 1.0]) {
                if let Some(sum) = sums.get_mut(end) {
                    *sum += told * sign;
                }
            }
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_is_spread_over_the_ways_that_are_known_badly() {
        // Round a square: the last way does not lead back to the first place by (4, 2). Two ways are not known along x.
        let places = [(0.0, 0.0), (100.0, 0.0), (200.0, 0.0), (200.0, 50.0), (4.0, 2.0)];
        let places = places.map(|(x, y)| PxPoint::new(x, y));
        let mut poses = Poses::default();
        let good = Information::of_axes([0.1; 2]);
        let along = Information::of_axes([2.0, 0.1]);
        for (i, told) in [along, along, good, good].into_iter().enumerate() {
            let [from, to] = [i, i + 1].map(|i| places[i]);
            poses.add([i, i + 1], to - from, told);
        }
        poses.add([4, 0], PxVec::new(0.0, 0.0), good);
        let shifts = poses.shifts(&places);
        // By the variances on the way: 4, 4, .01, .01 and .01 along x, five of .01 along y.
        let wanted = [(0.0, 0.0), (-1.995, -0.4), (-3.9900, -0.8), (-3.995, -1.2), (-4.0, -1.6)];
        for (PxVec { x, y }, (u, v)) in shifts.iter().zip(wanted) {
            assert!((x - u).abs() < 0.01 && (y - v).abs() < 1e-6, "{shifts:?}");
        }
    }

    #[test]
    fn doubts_add_up_on_the_best_known_way() {
        let mut poses = Poses::default();
        poses.add([0, 1], PxVec::new(45.0, 0.0), Information::of_axes([1.0, 0.1]));
        poses.add([1, 2], PxVec::new(45.0, 0.0), Information::of_axes([2.0, 0.1]));
        poses.add([3, 0], PxVec::new(0.0, 45.0), Information::of_axes([0.1, 0.1]));
        poses.add([3, 2], PxVec::new(90.0, 0.0), Information::of_axes([0.1, 1.5]));
        let doubts = poses.doubts(0, 5);
        let near = |i: usize, xx: f64, yy: f64| {
            let doubt = doubts[i].unwrap();
            (doubt.xx - xx).abs() < 1e-9 && (doubt.yy - yy).abs() < 1e-9
        };
        assert!(
            near(0, 0.0, 0.0) && near(1, 1.0, 0.01) && near(3, 0.01, 0.01) && near(2, 0.02, 2.26),
            "{doubts:?}"
        );
        assert!(doubts[4].is_none());
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn a_long_chain_is_solved() {
        let places: Vec<PxPoint> = (0..2000).map(|i| PxPoint::new(45.0 * f64::from(i), 0.0)).collect();
        let mut poses = Poses::default();
        for i in 1..2000 {
            let sd = if i % 7 == 0 { 1.0 } else { 0.06 };
            poses.add([i - 1, i], PxVec::new(45.0, 0.0), Information::of_axes([sd, 0.06]));
        }
        poses.add([0, 1999], PxVec::new(45.0 * 1999.0 - 20.0, 0.0), Information::of_axes([0.06; 2]));
        let shifts = poses.shifts(&places);
        assert!(
            (shifts[1999].x + 20.0).abs() < 0.01 && (shifts[1000].x + 10.0).abs() < 0.1,
            "{:?}",
            shifts[1999]
        );
    }

    #[test]
    fn places_that_agree_stay() {
        let places: Vec<PxPoint> = (0..5).map(|i| PxPoint::new(f64::from(i), 0.0)).collect();
        let mut poses = Poses::default();
        (1..5).for_each(|i| poses.add([i - 1, i], PxVec::new(1.0, 0.0), Information::of_axes([1.0; 2])));
        assert_eq!(poses.shifts(&places), [PxVec::default(); 5]);
        assert!(Poses::default().shifts(&[]).is_empty());
    }
}
