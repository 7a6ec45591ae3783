//! [`Bounded::polyline`]: the fewest free vertices for a promised error.

use super::Bounded;
use super::min_link_path::{Search, Vertex};
use super::polish::polish;
use super::promise::Promise;
use super::ray_cone::unit;
use crate::stroke::PxPoint;

/// Times that the vertices are moved over.
const SWEEPS: usize = 4;

/// Starts that are tried on a closed line.
const STARTS: usize = 3;

/// Vertices of a ring up to which all of them are.
const SHORT_RING: usize = 24;

impl Bounded {
    /// The fewest vertices, anywhere, such that the line through a sequence of sites is kept within the
    /// tolerance.
    ///
    /// The sites are places along a line, about one a pixel: centres of pixels, or sub-pixel points with
    /// their noise. What is promised holds on any of them, whether the line crosses itself, turns back or is
    /// nothing but noise:
    ///
    /// - a pen can run along the polyline and along the sites, never back on either, so that both pens stay
    ///   within `tolerance_px` of each other. So every site is near the polyline, in order, and every point
    ///   of the polyline is near the way through the sites (both ways of the Hausdorff distance);
    /// - open: the first and the last vertex are the first and the last site;
    /// - closed: the first vertex is repeated at the end, and lies at a sharp corner if there is one.
    ///
    /// The optimum aimed at is the minimum-link path within the Fréchet distance. The search takes the
    /// farthest link each time, which for a simple corridor is optimal, from a place that it finds by
    /// bisection; the number of links is within a few per cent of the bound from covering the sites with
    /// straight strips. Then the vertices move to where the sum of the squared distances is least, as far as
    /// the promise allows: two straight runs meet where their lines cross.
    ///
    /// Equal sites in sequence count as one, and sites that are not finite are left out. No sites make no
    /// vertices, one makes one. No link stands for more than [`MAX_REACH_PX`](super::MAX_REACH_PX) sites, and
    /// a link is searched at most a fixed number of times, so the work is bounded by sites × reach, and is
    /// linear in the sites as long as a link is not far longer than the part of it that is new.
    ///
    /// Sources: L. J. Guibas, J. E. Hershberger, J. S. B. Mitchell, J. S. Snoeyink, "Approximating polygons
    /// and subdivisions with minimum-link paths" (1993); S. Suri, "A linear time algorithm for minimum link
    /// paths inside a simple polygon" (1986).
    ///
    /// ```
    /// # use plotter_vector::{PxPoint, stroke::Bounded};
    /// // An L with a noise of 0.2 px: two links, and the corner where the arms' lines meet.
    /// let noise = |i: i32| if i % 2 == 0 { 0.2 } else { -0.2 };
    /// let arm = (0..=40).map(|i| PxPoint::new(f64::from(i), noise(i)));
    /// let other = (1..=40).map(|i| PxPoint::new(40.0 + noise(i), f64::from(i)));
    /// let sites: Vec<PxPoint> = arm.chain(other).collect();
    /// let line = Bounded::default().with_tolerance_px(0.5).polyline(&sites, false);
    /// assert_eq!(line.len(), 3);
    /// assert!(line[1].distance(PxPoint::new(40.0, 0.0)) < 0.25); // less than the noise of one site in x and y
    /// ```
    #[must_use]
    pub fn polyline(&self, sites: &[PxPoint], closed: bool) -> Vec<PxPoint> {
        let mut line = Self::cleaned(sites);
        if closed && line.len() > 1 && line.first() == line.last() {
            line.pop();
        }
        let (Some(first), Some(last)) = (line.first().copied(), line.last().copied()) else { return line };
        if line.len() == 1 {
            return line;
        }
        let promise = Promise::new(self.tolerance_px);
        let vertices = if closed { ring(promise, line) } else { path(promise, &line, first, last) };
        vertices.into_iter().map(|vertex| vertex.at).collect()
    }

    /// The sites that count: finite, and no two equal ones in sequence.
    pub(super) fn cleaned(sites: &[PxPoint]) -> Vec<PxPoint> {
        let mut line: Vec<PxPoint> = sites.iter().copied().filter(|site| site.is_finite()).collect();
        line.dedup();
        line
    }
}

/// The polyline from `start` to `end`, both among its vertices, polished.
pub(super) fn path(promise: Promise, sites: &[PxPoint], start: PxPoint, end: PxPoint) -> Vec<Vertex> {
    let mut vertices = whole(Search { promise, start, sites, end });
    polish(promise, sites, &mut vertices, SWEEPS);
    vertices
}

fn whole(search: Search<'_>) -> Vec<Vertex> {
    let mut vertices = vec![Vertex { at: search.start, done: 0 }];
    vertices.extend(search.vertices());
    vertices.push(Vertex { at: search.end, done: search.sites.len() });
    vertices
}

/// The closed polyline past all sites, the first vertex repeated.
fn ring(promise: Promise, mut sites: Vec<PxPoint>) -> Vec<Vertex> {
    let Some(first) = sites.first().copied() else { return Vec::new() };
    let mut best = whole(Search { promise, start: first, sites: &sites, end: first });
    let first_lap = best.clone();
    let mut seam = 0;
    let tries = if best.len() <= SHORT_RING { STARTS } else { 1 };
    for start in starts(&first_lap).into_iter().take(tries) {
        let mut turned = sites.clone();
        turned.rotate_left(start.done.min(sites.len()));
        let lap = whole(Search { promise, start: start.at, sites: &turned, end: start.at });
        // The first lap began at a site, which is no good corner.
        if lap.len() < best.len() || (seam == 0 && lap.len() == best.len()) {
            (best, seam) = (lap, start.done);
        }
    }
    let all = sites.len();
    sites.rotate_left(seam.min(all));
    polish(promise, &sites, &mut best, SWEEPS - 1);
    // The seam could not move: turn the ring by half and polish again.
    let half = best.len() / 2;
    let Some(seam) = best.get(half).copied().filter(|_| best.len() > 3) else { return best };
    best.pop();
    for (index, vertex) in best.iter_mut().enumerate() {
        let before_the_seam = if index < half { all } else { 0 };
        vertex.done = (vertex.done + before_the_seam).saturating_sub(seam.done);
    }
    best.rotate_left(half);
    sites.rotate_left(seam.done.min(all));
    best.push(Vertex { at: seam.at, done: all });
    polish(promise, &sites, &mut best, SWEEPS - 1);
    best
}

/// Vertices of a first lap from which a second one may start: the sharpest first.
fn starts(lap: &[Vertex]) -> Vec<Vertex> {
    let turn = |corner: &[Vertex]| -> f64 {
        let [a, b, c] = corner else { return -1.0 };
        let (to, fro) = (unit(b.at - a.at), unit(c.at - b.at));
        to.zip(fro).map_or(-1.0, |(to, fro)| -to.dot(fro))
    };
    let mut corners: Vec<(f64, Vertex)> =
        lap.windows(3).filter_map(|corner| Some((turn(corner), *corner.get(1)?))).collect();
    corners.sort_by(|a, b| b.0.total_cmp(&a.0));
    corners.truncate(STARTS);
    corners.into_iter().map(|(_, vertex)| vertex).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(radius_px: f64, sites: u32) -> Vec<PxPoint> {
        let angle = |i: u32| core::f64::consts::TAU * f64::from(i) / f64::from(sites);
        (0..sites)
            .map(|i| {
                let (sin, cos) = libm::sincos(angle(i));
                PxPoint::new(300.0 + radius_px * cos, 300.0 + radius_px * sin)
            })
            .collect()
    }

    #[test]
    fn a_circle_takes_hardly_more_than_the_polygon_between_two_circles() {
        // An n-gon between the circles of radius r - t and r + t has cos(pi / n) = (r - t) / (r + t): n =
        // 6.5, 10.02, 17.3, 24.4, 31.5 for these; the site next to a corner may lie a little beside it.
        let count = |(radius, sites): (f64, u32)| {
            let sites = circle(radius, sites);
            Bounded { tolerance_px: 0.5 }.polyline(&sites, true).len() - 1
        };
        assert_eq!(
            [(8.3, 52), (20.0, 125), (60.4, 379), (120.0, 753), (200.7, 1261)].map(count),
            [7, 11, 18, 25, 32]
        );
    }

    #[test]
    fn a_square_has_its_corners_where_its_sides_meet() {
        let side = |i: u32| {
            let (k, f) = (i / 50, f64::from(i % 50));
            match k {
                0 => PxPoint::new(f, 0.0),
                1 => PxPoint::new(50.0, f),
                2 => PxPoint::new(50.0 - f, 50.0),
                _ => PxPoint::new(0.0, 50.0 - f),
            }
        };
        // Starts in the middle of a side.
        let sites: Vec<PxPoint> = (25..225).map(|i| side(i % 200)).collect();
        let ring = Bounded { tolerance_px: 0.5 }.polyline(&sites, true);
        assert_eq!(ring.len(), 5);
        assert_eq!(ring.first(), ring.last());
        for vertex in ring {
            let off = |a: f64| a.abs().min((a - 50.0).abs());
            assert!(off(vertex.x) < 0.1 && off(vertex.y) < 0.1, "{vertex:?}");
        }
    }

    #[test]
    fn few_and_bad_sites_are_what_they_are() {
        let bounded = Bounded::default();
        let (a, b) = (PxPoint::new(1.0, 2.0), PxPoint::new(7.0, 2.0));
        let bad = PxPoint::new(f64::NAN, 0.0);
        for closed in [false, true] {
            assert_eq!(bounded.polyline(&[], closed), []);
            assert_eq!(bounded.polyline(&[bad], closed), []);
            assert_eq!(bounded.polyline(&[a, bad, a], closed), [a]);
        }
        assert_eq!(bounded.polyline(&[a, bad, b], false), [a, b]);
        assert_eq!(bounded.polyline(&[a, b], true), [b, a, b]);
    }

    #[test]
    fn a_step_back_on_a_long_line_costs_a_few_vertices_only() {
        let mut sites: Vec<PxPoint> = (0..400).map(|x| PxPoint::new(f64::from(x), 0.2)).collect();
        for back in 0..6 {
            sites.insert(370 + back as usize, PxPoint::new(369.0 - f64::from(back), 0.0));
        }
        let line = Bounded { tolerance_px: 0.4 }.polyline(&sites, false);
        assert!(line.len() <= 10, "{line:?}");
    }

    #[test]
    fn a_line_there_and_back_turns_at_its_end() {
        let way = (0..=100).chain((20..100).rev());
        let sites: Vec<PxPoint> = way.map(|x| PxPoint::new(f64::from(x), 0.0)).collect();
        let line = Bounded { tolerance_px: 0.5 }.polyline(&sites, false);
        assert_eq!(line.len(), 3);
        assert!(line[1].distance(PxPoint::new(100.0, 0.0)) <= 0.5 + 1e-9, "{line:?}");
    }
}
