//! [`Promise`]: the exact check of one link of a polyline against the sites it stands for.

use crate::stroke::{PxPoint, PxVec};

/// Added to the tolerance so that a site exactly on it passes in spite of rounding, px.
const ROUNDING_PX: f64 = 1e-9;

/// Decides whether a link keeps the tolerance: it meets the discs about its sites **in order**.
///
/// Were p₁, p₂, … points on the link, none before the one before it, each within the radius of its site, then
/// the way from pᵢ to pᵢ₊₁ is everywhere within the radius of the way from site i to site i + 1, for the
/// distance between two points that move evenly is convex in time. So the check of the sites bounds the error
/// both ways; it is the ordered stabbing of Guibas, Hershberger, Mitchell and Snoeyink, "Approximating
/// polygons and subdivisions with minimum-link paths" (1993), sections 2 and 4 (Fréchet distance).
#[derive(Clone, Copy, Debug)]
pub(super) struct Promise {
    /// Radius of the discs, px.
    pub(super) radius_px: f64,
}

impl Promise {
    pub(super) fn new(tolerance_px: f64) -> Self {
        Self { radius_px: tolerance_px.max(0.0) + ROUNDING_PX }
    }

    /// Sum of the squared distances of the sites from the link's line, px²; `None` when the link does not
    /// keep the promise (or a number overflows).
    pub(super) fn link(self, from: PxPoint, to: PxPoint, sites: &[PxPoint]) -> Option<f64> {
        let way = to - from;
        let length = way.length_near();
        let unit = if length > 0.0 { way / length } else { PxVec::new(1.0, 0.0) };
        let mut walk = RayWalk::new(self, from, unit);
        for site in sites {
            if !walk.pass(*site) || walk.earliest > length {
                return None;
            }
        }
        Some(walk.squares)
    }

    /// Whether a vertex between two consecutive sites is near enough to the way between them.
    pub(super) fn vertex(self, vertex: PxPoint, before: PxPoint, after: PxPoint) -> bool {
        distance_to_segment_squared(vertex, before, after) <= self.radius_px * self.radius_px
    }
}

/// A walk along a ray past sites, in order.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayWalk {
    radius_squared: f64,
    from: PxPoint,
    unit: PxVec,
    /// The walker is at least so far along the ray: where it entered the last of the discs, px.
    pub(super) earliest: f64,
    squares: f64,
}

impl RayWalk {
    pub(super) fn new(promise: Promise, from: PxPoint, unit: PxVec) -> Self {
        Self {
            radius_squared: promise.radius_px * promise.radius_px,
            from,
            unit,
            earliest: 0.0,
            squares: 0.0,
        }
    }

    /// Whether the next site's disc can be met after all those before. Not so for a number that is none.
    #[inline]
    pub(super) fn pass(&mut self, site: PxPoint) -> bool {
        let away = site - self.from;
        let (along, across) = (self.unit.dot(away), self.unit.cross(away));
        let half_squared = self.radius_squared - across * across;
        if !(half_squared >= 0.0 && along.is_finite()) {
            return false;
        }
        let half = libm::sqrt(half_squared);
        self.squares += across * across;
        self.earliest = self.earliest.max(along - half);
        self.earliest <= along + half
    }
}

/// Squared distance of a point from a segment, px².
pub(super) fn distance_to_segment_squared(point: PxPoint, from: PxPoint, to: PxPoint) -> f64 {
    let (way, away) = (to - from, point - from);
    let length_squared = way.length_squared();
    let at = if length_squared > 0.0 { (way.dot(away) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    let off = point - (from + way * at);
    off.length_squared()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(places: &[(f64, f64)]) -> Vec<PxPoint> {
        places.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect()
    }

    #[test]
    fn a_link_stands_for_sites_as_far_as_the_tolerance() {
        let (from, to) = (PxPoint::new(0.0, 0.0), PxPoint::new(10.0, 0.0));
        let promise = Promise::new(0.5);
        assert_eq!(promise.link(from, to, &points(&[(2.0, 0.5), (8.0, -0.5), (10.5, 0.0)])), Some(0.5));
        assert_eq!(promise.link(from, to, &points(&[(2.0, 0.501)])), None);
        assert_eq!(promise.link(from, to, &points(&[(10.6, 0.0)])), None);
        assert_eq!(promise.link(from, to, &points(&[(-0.6, 0.0)])), None);
        assert_eq!(promise.link(from, to, &points(&[(f64::NAN, 0.0)])), None);
    }

    #[test]
    fn sites_must_come_in_order_up_to_the_tolerance_of_each() {
        // Both sites on the link: the discs of radius 0.5 meet it within 0.5 px before and after, so a way
        // back of 1 px is as much as two of them allow.
        let (from, to) = (PxPoint::new(0.0, 0.0), PxPoint::new(10.0, 0.0));
        let promise = Promise::new(0.5);
        assert!(promise.link(from, to, &points(&[(5.0, 0.0), (4.0, 0.0)])).is_some());
        assert!(promise.link(from, to, &points(&[(5.0, 0.0), (3.9, 0.0)])).is_none());
        // 0.3 px aside the half chord is 0.4 px.
        assert!(promise.link(from, to, &points(&[(5.0, 0.3), (4.2, 0.3)])).is_some());
        assert!(promise.link(from, to, &points(&[(5.0, 0.3), (4.19, 0.3)])).is_none());
    }
}
