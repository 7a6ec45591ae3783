//! [`Search`]: the fewest links from one point to another past all sites.

use super::promise::{Promise, RayWalk};
use super::ray_cone::{Borders, RayCone, unit};
use super::{MAX_REACH_PX, PxPoint};
use crate::stroke::PxVec;

/// Places on a window that are tried as the next vertex.
const WINDOW_PLACES: usize = 8;

/// Part of the tolerance to which the place on a window is searched.
const LEAST_WINDOW: f64 = 0.05;

/// Places at which the way to the end is tried to be joined before a link more is taken.
const JOIN_PLACES: usize = 4;

/// A vertex with its place in the order of the sites.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Vertex {
    pub(super) at: PxPoint,
    /// Sites that the links before it stand for.
    pub(super) done: usize,
}

/// Greedy search for a minimum-link path from `start` to `end` that keeps the promise for the sites between.
///
/// ```text
///   start o---___                      one link as far as any reaches; it touches discs on both sides,
///       ( ) ( ) (‾)---___ window       and behind the last touch it is a window: whatever lies farther
///                   ( ) ( )‾‾‾o...     can only be reached with one link more, through the window
/// ```
///
/// Source: the window method for link distance in a simple polygon: S. Suri, "A linear time algorithm for
/// minimum link paths inside a simple polygon" (1986); for ordered discs Guibas et al. (1993), section 4.
/// Here each window is sampled at [`WINDOW_PLACES`] places instead of cut exactly.
#[derive(Clone, Copy, Debug)]
pub(super) struct Search<'a> {
    pub(super) promise: Promise,
    pub(super) start: PxPoint,
    pub(super) sites: &'a [PxPoint],
    pub(super) end: PxPoint,
}

/// How far one link from a place goes.
#[derive(Clone, Copy, Debug)]
struct Reach {
    from: Vertex,
    /// Sites that it and the links before stand for.
    done: usize,
    /// Part of the way from there to the next site, 0 to 1.
    part: f64,
    /// Direction of the link that goes farthest.
    ray: PxVec,
    /// Index of the site whose disc that ray touches last: from there on it is a window.
    touch: usize,
    /// Whether the next site lies left of the ray.
    to_left: bool,
}

/// The part of a farthest link from which the next one may start.
#[derive(Clone, Debug, Default)]
struct Window {
    from: Vertex,
    ray: PxVec,
    low_px: f64,
    high_px: f64,
    /// Sites that are done at the first of the feet.
    first: usize,
    /// From where on the ray each further site is done, px, rising.
    feet: Vec<f64>,
    /// Where to look first.
    places: Vec<Vertex>,
}

impl Window {
    /// The place so far along the ray, if it is near enough to the sites there.
    fn at(&self, along_px: f64, search: &Search<'_>) -> Option<Vertex> {
        let index = self.feet.partition_point(|foot| *foot <= along_px);
        let at = self.from.at + self.ray * along_px;
        let place = Vertex { at, done: self.first + index.checked_sub(1)? };
        search.vertex(place).then_some(place)
    }
}

impl Search<'_> {
    /// The vertices between `start` and `end`.
    pub(super) fn vertices(&self) -> Vec<Vertex> {
        let back = self.cones_to_the_end();
        let mut vertices = Vec::new();
        let mut window = Window { places: vec![Vertex { at: self.start, done: 0 }], ..Window::default() };
        loop {
            let Some(exit) = window.places.last().copied() else { return vertices };
            let Some((best, joined)) = self.through(&mut window, &back) else { return vertices };
            if best.from.done > 0 {
                vertices.push(best.from);
            }
            if let Some(last) = joined {
                vertices.extend(last);
                return vertices;
            }
            self.look_through(best, &mut window);
            if window.places.last().is_none_or(|place| place.done <= exit.done) {
                // The way turns back somewhere under the farthest link, which no pen can follow. Straight to
                // a site before that; to the next one is always allowed, so every link gains one.
                let next = self.farthest_site(exit, best.done);
                let Some(site) = self.sites.get(next) else { return vertices };
                if best.from.done > 0 {
                    vertices.pop();
                    vertices.push(exit);
                }
                window.places.clear();
                window.places.push(Vertex { at: *site, done: next + 1 });
                // Only that site: the feet belong to the link that was no good.
                window.feet.clear();
                (window.low_px, window.high_px) = (0.0, 0.0);
            }
        }
    }

    /// The link through a window that reaches farthest; or one from which the end is reached, with the vertex
    /// between if there is one.
    ///
    /// The places from which a line meets all discs up to a certain one are an interval of the window. A link
    /// that fails does so for two discs that it would have to pass on different sides, and where the line
    /// that just does so meets the window, the interval is cut.
    fn through(&self, window: &mut Window, back: &[RayCone]) -> Option<(Reach, Option<Option<Vertex>>)> {
        let mut best: Option<Reach> = None;
        let mut place = window.places.last().copied()?;
        let (mut low, mut high) = (window.low_px, window.high_px);
        let mut at_low = false;
        let most = WINDOW_PLACES.min(2 + window.feet.len());
        for _ in 0..most {
            let reach = self.reach(place);
            if reach.done == self.sites.len() && self.link(reach.from, self.end, reach.done) {
                return Some((reach, Some(None)));
            }
            if reach.done + back.len() > self.sites.len()
                && let Some(vertex) = self.join(reach, back)
            {
                return Some((reach, Some(Some(vertex))));
            }
            if best.is_none_or(|best| (reach.done, reach.part) > (best.done, best.part)) {
                best = Some(reach);
            }
            let Some(cut) = self.cut(&reach, window) else { break };
            if cut > window.ray.dot(place.at - window.from.at) {
                low = low.max(cut);
            } else {
                high = high.min(cut);
            }
            let mut along = f64::midpoint(low, high);
            if high - low <= LEAST_WINDOW * self.promise.radius_px {
                // Rounding may have cut off the place where the ray touches a disc, the best one at a corner.
                if at_low {
                    break;
                }
                at_low = true;
                along = window.low_px;
            }
            let Some(next) = window.at(along, self) else { break };
            place = next;
        }
        best.map(|best| (best, None))
    }

    /// Where on the window the line starts that just passes both discs between which the farthest link
    /// failed.
    fn cut(&self, reach: &Reach, window: &Window) -> Option<f64> {
        let (touched, failed) = (self.sites.get(reach.touch)?, self.sites.get(reach.done)?);
        let way = *failed - *touched;
        let squared = way.length_squared();
        let sine = 2.0 * self.promise.radius_px;
        let cosine = libm::sqrt(squared - sine * sine);
        let sine = if reach.to_left { sine } else { -sine };
        // `way` turned by the angle at which it crosses the line, over its length.
        let line = PxVec::new(way.x * cosine + way.y * sine, way.y * cosine - way.x * sine) / squared;
        let foot = *touched + line.perpendicular() * (sine / 2.0);
        let slope = line.cross(window.ray);
        let cut = line.cross(foot - window.from.at) / slope;
        (slope.abs() > 1e-9 && cut.is_finite()).then_some(cut)
    }

    /// A site before `end` to which a straight link keeps the promise, the farthest of those whose distances
    /// are halves of each other.
    fn farthest_site(&self, from: Vertex, end: usize) -> usize {
        let mut ahead = end.saturating_sub(from.done + 1);
        while ahead > 0 {
            let site = from.done + ahead;
            if self.sites.get(site).is_some_and(|at| self.link(from, *at, site)) {
                return site;
            }
            ahead /= 2;
        }
        from.done
    }

    fn link(&self, from: Vertex, to: PxPoint, done: usize) -> bool {
        self.promise.link(from.at, to, self.sites.get(from.done..done).unwrap_or(&[])).is_some()
    }

    fn cone(&self, apex: PxPoint) -> RayCone {
        // A hair less than the promise, so that what the cone lets pass keeps it in spite of rounding.
        RayCone::new(apex, self.promise.radius_px - 5e-10)
    }

    /// The cones of directions in which rays from the end, backwards, meet all sites but the first n: for n
    /// from all of them downwards, as far as there are any.
    fn cones_to_the_end(&self) -> Vec<RayCone> {
        let mut cone = self.cone(self.end);
        let mut cones = vec![cone];
        for (index, site) in self.sites.iter().enumerate().rev().take(MAX_REACH_PX) {
            if !cone.narrow(*site, index) {
                break;
            }
            cones.push(cone);
        }
        cones
    }

    /// The farthest link from a place.
    fn reach(&self, from: Vertex) -> Reach {
        let mut cone = self.cone(from.at);
        let mut done = from.done;
        let ahead = self.sites.get(from.done..).unwrap_or(&[]);
        for site in ahead.iter().take(MAX_REACH_PX) {
            if !cone.narrow(*site, done) {
                break;
            }
            done += 1;
        }
        let Some(Borders { right, left, touches }) = cone.borders else {
            let ray = unit(self.end - from.at).unwrap_or(PxVec::new(1.0, 0.0));
            return Reach { from, done, part: 0.0, ray, touch: done, to_left: false };
        };
        let last = done.checked_sub(1).and_then(|last| self.sites.get(last)).copied().unwrap_or(from.at);
        let Some(failed) = self.sites.get(done) else {
            let ray = Borders { right, left, touches }.middle();
            return Reach { from, done, part: 0.0, ray, touch: touches.0.max(touches.1), to_left: false };
        };
        let to_left = right.cross(*failed - from.at).abs() > left.cross(*failed - from.at).abs();
        let (ray, touch) = if to_left { (left, touches.1) } else { (right, touches.0) };
        // Where the ray leaves the way from the last site to the one that failed.
        let (near, far) = (ray.cross(last - from.at), ray.cross(*failed - from.at));
        let radius = if far > 0.0 { self.promise.radius_px } else { -self.promise.radius_px };
        let part =
            if (far - near).abs() > 1e-9 { ((radius - near) / (far - near)).clamp(0.0, 1.0) } else { 0.0 };
        Reach { from, done, part: part * 0.999_999, ray, touch, to_left }
    }

    /// The window on the farthest link: from where it leaves the discs back to where it touched one last.
    fn look_through(&self, reach: Reach, window: &mut Window) {
        let mut walk = RayWalk::new(self.promise, reach.from.at, reach.ray);
        window.first = reach.touch.max(reach.from.done) + 1;
        window.from = reach.from;
        window.ray = reach.ray;
        window.feet.clear();
        window.places.clear();
        let mut end = 0.0_f64;
        let ahead = self.sites.get(reach.from.done..reach.done).unwrap_or(&[]);
        for (done, site) in (reach.from.done + 1..).zip(ahead) {
            if !walk.pass(*site) {
                break;
            }
            if done >= window.first {
                let foot = reach.ray.dot(*site - reach.from.at);
                end = if done == reach.done {
                    let after = self.sites.get(done).copied().unwrap_or(*site);
                    reach.ray.dot((*site + (after - *site) * reach.part) - reach.from.at)
                } else {
                    foot
                };
                let earliest = window.feet.last().map_or(0.0, |before: &f64| *before).max(walk.earliest);
                window.feet.push(foot.max(earliest));
            }
        }
        let Some(low) = window.feet.first() else { return };
        window.low_px = *low;
        window.high_px = end.max(window.feet.last().copied().unwrap_or(end));
        if let Some(place) = window.at(window.high_px, self).or_else(|| window.at(window.low_px, self)) {
            window.places.push(place);
        }
    }

    /// A vertex that is seen both from where `reach` starts and from the end.
    fn join(&self, reach: Reach, back: &[RayCone]) -> Option<Vertex> {
        let mut cone = self.cone(reach.from.at);
        let mut widest: [Option<(f64, Vertex)>; JOIN_PLACES] = [None; JOIN_PLACES];
        let ahead = self.sites.get(reach.from.done..reach.done).unwrap_or(&[]);
        for (done, site) in (reach.from.done + 1..self.sites.len()).zip(ahead) {
            if !cone.narrow(*site, done) {
                break;
            }
            let Some(onward) = back.get(self.sites.len() - done) else { continue };
            let Some(after) = self.sites.get(done) else { break };
            let half = *site + (*after - *site) * 0.5;
            let ray = |cone: &RayCone| cone.borders.map(Borders::middle).or_else(|| unit(half - cone.apex));
            let (to, fro) =
                (ray(&cone).unwrap_or(PxVec::new(1.0, 0.0)), ray(onward).unwrap_or(PxVec::new(-1.0, 0.0)));
            let normal = unit(to - fro).unwrap_or(to).perpendicular();
            let (Some((a, b)), Some((c, d))) = (cone.interval(half, normal), onward.interval(half, normal))
            else {
                continue;
            };
            let (low, high) = (a.max(c), b.min(d));
            let mut candidate = Some((high - low, Vertex { at: half + normal * ((low + high) / 2.0), done }));
            if low > high {
                continue;
            }
            for place in &mut widest {
                let width = |place: &Option<(f64, Vertex)>| place.map_or(-1.0, |(width, _)| width);
                if width(&candidate) > width(place) {
                    core::mem::swap(place, &mut candidate);
                }
            }
        }
        let good = |vertex: &Vertex| {
            self.link(reach.from, vertex.at, vertex.done)
                && self.link(*vertex, self.end, self.sites.len())
                && self.vertex(*vertex)
        };
        widest.into_iter().flatten().map(|(_, vertex)| vertex).find(good)
    }

    fn vertex(&self, vertex: Vertex) -> bool {
        let before = vertex.done.checked_sub(1).and_then(|before| self.sites.get(before));
        let after = self.sites.get(vertex.done);
        match (before.or(after), after.or(before)) {
            (Some(before), Some(after)) => self.promise.vertex(vertex.at, *before, *after),
            _ => false,
        }
    }
}
