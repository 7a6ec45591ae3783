//! [`Fit`]: one cubic curve past sites, and the exact check of its distance.

use super::promise::Promise;
use crate::stroke::{Cubic, PxPoint, PxVec};

/// Times that the sites' places on a curve are found anew, and the curve for them.
const ROUNDS: usize = 5;

/// A curve that is so many times as far off as it may be will not come near enough.
const HOPELESS: f64 = 4.0;

/// And after the second round.
const NEARLY: f64 = 1.5;

/// What draws the handles to a third of the way between the ends, in sites: they are nowhere else when sites
/// are few.
const RIDGE: f64 = 1e-3;

/// Least length of a handle whose direction is given, in parts of the way.
const LEAST_HANDLE: f64 = 0.01;

/// Where two segments meet: the place that the pen has reached when it is at a certain site on the other
/// line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Joint {
    pub(super) at: PxPoint,
    /// Index of the site.
    pub(super) site: usize,
    /// The unit vector in which the pen goes there; none where it may turn.
    pub(super) direction: Option<PxVec>,
    /// Handles of the segment to the next joint; none of a straight line.
    pub(super) handles: Option<[PxPoint; 2]>,
}

/// Sites, and what is promised about them.
#[derive(Debug)]
pub(super) struct Fit {
    pub(super) promise: Promise,
    pub(super) sites: Vec<PxPoint>,
}

impl Fit {
    /// The sites between two joints.
    fn between(&self, from: &Joint, to: &Joint) -> &[PxPoint] {
        self.sites.get(from.site + 1..to.site).unwrap_or(&[])
    }

    /// How far a joint is from its site, px.
    fn off(&self, joint: &Joint) -> Option<f64> {
        self.sites.get(joint.site).map(|site| site.distance(joint.at))
    }

    /// Whether a joint is near enough to its site.
    pub(super) fn is_joint(&self, joint: &Joint) -> bool {
        self.off(joint).is_some_and(|off| off <= self.promise.radius_px)
    }

    /// The straight or curved segment between two joints that keeps the promise: its handles and the sum of
    /// the squared distances.
    pub(super) fn segment(
        &self,
        from: &Joint,
        to: &Joint,
        curved: bool,
    ) -> Option<(Option<[PxPoint; 2]>, f64)> {
        if curved {
            self.cubic(from, to).map(|(handles, squares)| (Some(handles), squares))
        } else {
            self.line(from, to).map(|squares| (None, squares))
        }
    }

    /// The sum of the squared distances from the straight line between two joints, if it keeps the promise.
    pub(super) fn line(&self, from: &Joint, to: &Joint) -> Option<f64> {
        self.promise.link(from.at, to.at, self.between(from, to))
    }

    /// The handles of a cubic curve between two joints that keeps the promise, and the sum of the squared
    /// distances.
    pub(super) fn cubic(&self, from: &Joint, to: &Joint) -> Option<([PxPoint; 2], f64)> {
        let sites = self.between(from, to);
        if sites.len() < 2 {
            return None;
        }
        let (mut places, way_px) = by_the_way(from.at, sites, to.at)?;
        for round in 0..ROUNDS {
            let handles = handles(from, to, sites, &places, LEAST_HANDLE * way_px);
            let cubic = Cubic::new(from.at, handles, to.at)?;
            let (kept, squares, farthest) = self.check(from, to, &cubic, &mut places)?;
            if kept {
                return Some((handles, squares));
            }
            if round > 1 && farthest > NEARLY * self.promise.radius_px {
                return None;
            }
            // Once the places are about right the farther sites count for more: the greatest distance is to
            // be less, not the sum of all.
            let weigh = |place: &mut Sited| place.weight *= 0.2 + place.off / farthest;
            places.iter_mut().filter(|_| round > 0).for_each(weigh);
        }
        None
    }

    /// Whether a curve keeps the promise, the sum of the squared distances, and the greatest of them; brings
    /// the sites' places on it, values of t, nearer to the nearest ones. None if it is far off.
    ///
    /// Were qᵢ places on the curve in order, each dᵢ from its site, then between two of them the curve is
    /// everywhere within max(dᵢ, dᵢ₊₁) + h of the way from site to site, where h is how far it is from the
    /// chord qᵢ qᵢ₊₁.
    fn check(
        &self,
        from: &Joint,
        to: &Joint,
        cubic: &Cubic,
        places: &mut [Sited],
    ) -> Option<(bool, f64, f64)> {
        let limit = self.promise.radius_px;
        let mut last = FootPoint { t: 0.0, at: from.at, off: self.off(from)? };
        let (mut kept, mut squares, mut farthest) = (true, 0.0, 0.0_f64);
        for (site, Sited { t, off, .. }) in self.between(from, to).iter().zip(places) {
            *t = nearer(cubic, *site, *t).clamp(last.t, 1.0);
            let at = cubic.at(*t);
            let gap = *site - at;
            let squared = gap.length_squared();
            let next = FootPoint { t: *t, at, off: libm::sqrt(squared) };
            if next.off.is_nan() || next.off > HOPELESS * limit {
                return None;
            }
            kept = kept && within(cubic, &last, &next, limit);
            *off = next.off;
            (squares, farthest) = (squares + squared, farthest.max(next.off));
            last = next;
        }
        let end = FootPoint { t: 1.0, at: to.at, off: self.off(to)? };
        Some((kept && within(cubic, &last, &end, limit), squares, farthest))
    }
}

/// What is known of a site.
#[derive(Clone, Copy, Debug)]
struct Sited {
    /// Its place on the curve.
    t: f64,
    /// Its distance from there, px.
    off: f64,
    /// How much it counts.
    weight: f64,
}

/// The place on a curve that is nearest to a site.
#[derive(Clone, Copy, Debug)]
struct FootPoint {
    t: f64,
    at: PxPoint,
    /// Its distance from the site, px.
    off: f64,
}

/// Whether a curve is within a distance of the way between two sites, from the place of one to that of the
/// other.
///
/// With the second derivative no more than m over a step of Δt, a curve is at most m Δt² / 8 off its chord at
/// the same part of the way. Where it never goes back along the chord, only what is across the chord counts:
/// its foot runs along it.
fn within(cubic: &Cubic, last: &FootPoint, next: &FootPoint, limit: f64) -> bool {
    let off = last.off.max(next.off);
    let step = next.t - last.t;
    // It changes evenly: the greatest is at an end.
    let (one, other) = (cubic.bend(last.t), cubic.bend(next.t));
    let most_squared = one.length_squared().max(other.length_squared());
    let part = 0.125 * step * step;
    let room = limit - off;
    if room >= 0.0 && part * part * most_squared <= room * room {
        return true;
    }
    let chord = next.at - last.at;
    let length = chord.length_near();
    let (first, third) = (cubic.speed(last.t), cubic.speed(next.t));
    // The speed is a parabola: it stays between its three control values.
    let second = first + one * (0.5 * step);
    let forward = [first, second, third].iter().all(|speed| speed.dot(chord) >= 0.0);
    let across = chord.cross(one).abs().max(chord.cross(other).abs());
    forward && length > 0.0 && part * across <= room * length
}

/// The values of t of sites by the way that leads past them, and its length, px; none if that is no number.
fn by_the_way(from: PxPoint, sites: &[PxPoint], to: PxPoint) -> Option<(Vec<Sited>, f64)> {
    let mut way = 0.0;
    let mut last = from;
    let mut step = |at: PxPoint| {
        let gap = at - last;
        way += gap.length_near();
        last = at;
        way
    };
    let sited = |t: f64| Sited { t, off: 0.0, weight: 1.0 };
    let mut places: Vec<Sited> = sites.iter().map(|site| sited(step(*site))).collect();
    let way_px = step(to);
    places.iter_mut().for_each(|place| place.t /= way_px);
    (way_px > 0.0 && way_px.is_finite()).then_some((places, way_px))
}

/// One of Newton's steps to the place on a curve that is nearest to a site.
fn nearer(cubic: &Cubic, site: PxPoint, t: f64) -> f64 {
    let (gap, speed, bend) = (cubic.at(t) - site, cubic.speed(t), cubic.bend(t));
    let slope = speed.length_squared() + gap.dot(bend);
    if slope > 0.0 { t - gap.dot(speed) / slope } else { t }
}

/// The handles of the curve with the least squared distances from the sites to their places on it. A handle
/// whose direction is given is no shorter than `least_px`.
///
/// With B₁ = 3 (1 − t)² t and B₂ = 3 (1 − t) t², u from the first end to its handle, v from the second one to
/// its own, and r from the place that the ends alone would give: the least Σ w (r − B₁ u − B₂ v)² with the
/// weights w.
fn handles(from: &Joint, to: &Joint, sites: &[PxPoint], places: &[Sited], least_px: f64) -> [PxPoint; 2] {
    let third = (to.at - from.at) / 3.0;
    let (mut s11, mut s12, mut s22) = (RIDGE, 0.0, RIDGE);
    let mut r1 = third * RIDGE;
    let mut r2 = -r1;
    for (site, Sited { t, weight, .. }) in sites.iter().zip(places) {
        let s = 1.0 - t;
        let (b1, b2) = (3.0 * s * s * t, 3.0 * s * t * t);
        let (of_from, of_to) = (s * s * s + b1, t * t * t + b2);
        let r = PxVec::new(
            site.x - of_from * from.at.x - of_to * to.at.x,
            site.y - of_from * from.at.y - of_to * to.at.y,
        );
        let (w1, w2) = (weight * b1, weight * b2);
        (s11, s12, s22) = (s11 + w1 * b1, s12 + w1 * b2, s22 + w2 * b2);
        r1 += r * w1;
        r2 += r * w2;
    }
    // What is left when one is known.
    let second = |u: PxVec| (r2 - u * s12) / s22;
    let first = |v: PxVec| (r1 - v * s12) / s11;
    let determinant = s11 * s22 - s12 * s12;
    let (u, v) = match (from.direction, to.direction.map(|way| -way)) {
        (None, None) => {
            let u = (r1 * s22 - r2 * s12) * (1.0 / determinant);
            (u, second(u))
        }
        (Some(way), None) => {
            let length = (s22 * way.dot(r1) - s12 * way.dot(r2)) / determinant;
            let u = way * length.max(least_px);
            (u, second(u))
        }
        (None, Some(way)) => {
            let length = (s11 * way.dot(r2) - s12 * way.dot(r1)) / determinant;
            let v = way * length.max(least_px);
            (first(v), v)
        }
        (Some(one), Some(other)) => {
            let both = s12 * one.dot(other);
            let (pull_one, pull_other) = (one.dot(r1), other.dot(r2));
            let length = (s22 * pull_one - both * pull_other) / (s11 * s22 - both * both);
            let length = length.max(least_px);
            let back = ((pull_other - both * length) / s22).max(least_px);
            // If the second one was too short, the first one is another.
            let length = ((pull_one - both * back) / s11).max(least_px);
            (one * length, other * back)
        }
    };
    [from.at + u, to.at + v]
}
