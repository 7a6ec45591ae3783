//! [`Bounded::loose`]: a polyline whose ends are as free as its other vertices.

use super::Bounded;
use super::min_link_path::Vertex;
use super::polyline::path;
use super::promise::Promise;
use super::ray_cone::unit;
use crate::stroke::{PxPoint, PxVec};

impl Bounded {
    /// As [`polyline`](Self::polyline) of an open line, but its start, its end or both may lie anywhere
    /// within the tolerance of the first or the last site where that saves a vertex.
    ///
    /// Where a pen stopped is known to half a pixel. A last site that lies beside its line would otherwise
    /// need a vertex before it; here the link before goes on to the foot of the last site on it.
    pub(crate) fn loose(&self, sites: &[PxPoint], [start, end]: [bool; 2]) -> Vec<PxPoint> {
        let line = Self::cleaned(sites);
        let (Some(first), Some(last)) = (line.first().copied(), line.last().copied()) else { return line };
        if line.len() == 1 {
            return line;
        }
        let promise = Promise::new(self.tolerance_px);
        let mut vertices = path(promise, &line, first, last);
        if let (true, [_, _, _], Some(ends)) = (start && end, vertices.as_slice(), straight(promise, &line)) {
            return ends.to_vec();
        }
        if start {
            drop_second(promise, &line, &mut vertices);
        }
        if end {
            turn(&mut vertices, line.len());
            let back: Vec<PxPoint> = line.iter().rev().copied().collect();
            drop_second(promise, &back, &mut vertices);
            vertices.reverse();
        }
        vertices.into_iter().map(|vertex| vertex.at).collect()
    }
}

/// Takes the second vertex out of a polyline if it may begin at the foot of the first site on its second
/// link.
fn drop_second(promise: Promise, sites: &[PxPoint], vertices: &mut Vec<Vertex>) {
    let [_, second, third, ..] = vertices.as_slice() else { return };
    let (Some(site), Some(passed)) = (sites.first(), sites.get(..third.done)) else { return };
    let Some(back) = unit(second.at - third.at) else { return };
    let along = back.dot(*site - third.at);
    let at = third.at + back * along;
    if along > 0.0 && promise.link(at, third.at, passed).is_some() {
        vertices.splice(..2, [Vertex { at, done: 0 }]);
    }
}

/// The same polyline from its other end.
fn turn(vertices: &mut [Vertex], sites: usize) {
    vertices.reverse();
    for vertex in vertices {
        vertex.done = sites.saturating_sub(vertex.done);
    }
}

/// The one link that stands for all sites, along their main axis.
fn straight(promise: Promise, sites: &[PxPoint]) -> Option<[PxPoint; 2]> {
    #[expect(clippy::cast_precision_loss, reason = "a count of sites, far below 2^53")]
    let count = sites.len() as f64;
    let (first, last) = (sites.first()?, sites.last()?);
    let sum = |value: &dyn Fn(&PxPoint) -> f64| sites.iter().map(value).sum::<f64>() / count;
    let middle = PxPoint::new(sum(&|at| at.x), sum(&|at| at.y));
    let xx = sum(&|at| (at.x - middle.x) * (at.x - middle.x));
    let xy = sum(&|at| (at.x - middle.x) * (at.y - middle.y));
    let yy = sum(&|at| (at.y - middle.y) * (at.y - middle.y));
    let (sin, cos) = libm::sincos(0.5 * libm::atan2(2.0 * xy, xx - yy));
    let axis = PxVec::new(cos, sin);
    let along = if axis.dot(*last - *first) < 0.0 { -axis } else { axis };
    let ends = [first, last].map(|at| middle + along * (along.dot(*at - middle)));
    promise.link(ends[0], ends[1], sites).map(|_| ends)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(places: &[(f64, f64)]) -> Vec<PxPoint> {
        places.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect()
    }

    /// A line of 20 px with an end that lies 0.7 px beside it.
    fn hooked() -> Vec<PxPoint> {
        let line = (0..20).map(|x| PxPoint::new(f64::from(x), 0.0));
        line.chain([PxPoint::new(20.0, 0.7)]).collect()
    }

    #[test]
    fn an_end_beside_its_line_costs_no_vertex() {
        let bounded = Bounded { tolerance_px: 0.75 };
        let hooked = hooked();
        assert_eq!(bounded.loose(&hooked, [true; 2]).len(), 2);
        let tight = Bounded { tolerance_px: 0.3 };
        assert_eq!(tight.loose(&hooked, [true; 2]), tight.polyline(&hooked, false));
        assert_eq!(tight.loose(&hooked, [true; 2]).len(), 3);
    }

    #[test]
    fn both_ends_of_a_bent_line_are_free() {
        // Down, then right, each end 0.5 px beside its arm.
        let mut sites = points(&[(0.5, 0.0)]);
        sites.extend((1..=20).map(|y| PxPoint::new(0.0, f64::from(y))));
        sites.extend((1..20).map(|x| PxPoint::new(f64::from(x), 20.0)));
        sites.extend(points(&[(20.0, 20.5)]));
        let bounded = Bounded { tolerance_px: 0.51 };
        let (loose, tied) = (bounded.loose(&sites, [true; 2]), bounded.polyline(&sites, false));
        assert!(loose.len() == 3 && tied.len() >= 3, "{loose:?} {tied:?}");
        let mut back = sites.clone();
        back.reverse();
        assert_eq!(bounded.loose(&back, [true; 2]).len(), 3);
    }

    #[test]
    fn few_and_bad_sites_are_what_they_are() {
        let bounded = Bounded::default();
        let (a, b) = (PxPoint::new(1.0, 2.0), PxPoint::new(7.0, 2.0));
        let bad = PxPoint::new(f64::NAN, 0.0);
        assert_eq!(bounded.loose(&[], [true; 2]), []);
        assert_eq!(bounded.loose(&[bad], [true; 2]), []);
        assert_eq!(bounded.loose(&[a, bad, a], [true; 2]), [a]);
        assert_eq!(bounded.loose(&[a, bad, b], [true; 2]), [a, b]);
    }
}
