//! [`Bounded::arcs`]: lines and circular arcs, few of them, for a promised error.

use super::Bounded;
use super::doubling_search::farthest;
use super::promise::Promise;
use crate::stroke::curve::Arc;
use crate::stroke::{Curve, PxPoint, PxVec};
use core::f64::consts::{PI, TAU};

/// Greatest radius of an arc, px: what bends less is drawn with straight lines.
const MAX_RADIUS_PX: f64 = 1e5;

/// Least radius of an arc, px: what bends more is a corner, or noise.
const MIN_RADIUS_PX: f64 = 1.0;

/// Greatest bulge of an arc: 300 degrees. Nearer to the whole turn its ends fix its circle badly.
const MAX_BULGE: f64 = 3.732;

/// How many times as many sites as a line an arc has to stand for to be taken.
const PAYS: f64 = 1.5;

/// Steps of the fit of an arc between two vertices.
const FIT_STEPS: usize = 3;

/// Times that the vertices are moved over.
const SWEEPS: usize = 3;

/// Sites by which a vertex is moved along the line.
const SHIFTS: [usize; 4] = [8, 4, 2, 1];

/// Parts of the tolerance by which a vertex is moved to any side.
const NUDGES: [f64; 3] = [0.4, 0.15, 0.05];

/// Sites on either side over which the place of a vertex is averaged.
const SMOOTHED: usize = 4;

/// By how much more than the tolerance the mean error has to be so that no circle will do: it is the least
/// one of the equation x² + y² + D x + E y + F = 0, whose errors are 2 r (1 + e / 2 r) times the distances e.
const SURELY: f64 = 1.2;

/// Rounds of the search for the circle with the least greatest error.
const CIRCLE_ROUNDS: usize = 30;

impl Bounded {
    /// Lines and circular arcs, few of them, such that the line through a sequence of sites is kept within
    /// the tolerance.
    ///
    /// The promise is that of [`Bounded::polyline`], for segments that may be arcs: a pen can run along them
    /// and along the sites, never back on either, so that both pens stay within `tolerance_px` of each other.
    /// Open lines begin at the first and end at the last site; a closed line within the tolerance of one
    /// circle *is* that circle, of two arcs. Arcs have radii from 1 to 10⁵ px and at most 300 degrees. They
    /// must pay: where they do not save vertices, the answer is the polyline's.
    ///
    /// From each vertex the farthest line and the farthest arc are looked for by doubling and halving; of all
    /// arcs between two vertices that with the least squared distances is tried, then that in the middle of
    /// those which pass every site on the right side of both ends of its tolerance. Every segment that is
    /// taken has been checked site by site: each site's distance to its place on the arc, those places in
    /// order, and how far the arc rises over the chord between two of them, which together bound the Fréchet
    /// distance. Then the vertices are moved to where the squared distances are less. No segment stands for
    /// more than [`MAX_REACH_PX`](super::MAX_REACH_PX) sites, so the work is bounded by sites × the logarithm
    /// of the reach: 0.3 to 11 µs a site, up to 50 times that of the polyline.
    ///
    /// Sources: R. L. S. Drysdale, G. Rote, A. Sturm, "Approximation of an open polygonal curve with a
    /// minimum number of circular arcs and biarcs" (2008): the arcs between two vertices are a family of one
    /// parameter, each site allows a range of it; the circle of a whole ring with the least greatest error by
    /// C. L. Lawson's weights, "Contributions to the theory of linear least maximum approximation" (1961), on
    /// the equation of I. Kåsa, "A circle fitting procedure and its error analysis" (1976).
    ///
    /// ```
    /// # use plotter_vector::{PxPoint, stroke::Bounded};
    /// // A line of 30 px that goes over into a quarter of a circle of radius 20.
    /// let line = (0..30).map(|x| PxPoint::new(f64::from(x), 0.0));
    /// let angle = |i: u32| f64::from(i).to_radians() * 3.0;
    /// let quarter = (0..=30).map(|i| PxPoint::new(30.0 + 20.0 * angle(i).sin(), 20.0 - 20.0 * angle(i).cos()));
    /// let sites: Vec<PxPoint> = line.chain(quarter).collect();
    /// let curve = Bounded::default().with_tolerance_px(0.2).arcs(&sites, false);
    /// assert_eq!(curve.vertices.len(), 3);
    /// assert!(curve.vertices[1].distance(PxPoint::new(30.0, 0.0)) < 1.0);
    /// assert!(curve.bulges[0] == 0.0 && (curve.bulges[1] - 22.5_f64.to_radians().tan()).abs() < 0.02);
    /// ```
    #[must_use]
    pub fn arcs(&self, sites: &[PxPoint], closed: bool) -> Curve {
        self.bent(sites, closed, |promise, line, _| {
            if closed { ring(promise, line) } else { path(promise, &line) }.into()
        })
    }

    /// What `bend` makes of a line's sites, beside the vertices of its polyline, where that saves vertices; a
    /// closed line within the tolerance of one circle is that circle.
    pub(super) fn bent<T: Bent>(
        &self,
        sites: &[PxPoint],
        closed: bool,
        bend: impl FnOnce(Promise, Vec<PxPoint>, &[PxPoint]) -> T,
    ) -> T {
        let straight = self.polyline(sites, closed);
        let mut line: Vec<PxPoint> = sites.iter().copied().filter(|site| site.is_finite()).collect();
        line.dedup();
        if closed && line.len() > 1 && line.first() == line.last() {
            line.pop();
        }
        if straight.len() < 3 || line.len() < 3 {
            return Curve::from(straight).into();
        }
        let promise = Promise::new(self.tolerance_px);
        if let Some(circle) = closed.then(|| round(promise, &line)).flatten() {
            return circle.into();
        }
        let bent = bend(promise, line, &straight);
        if bent.vertex_count() < straight.len() { bent } else { Curve::from(straight).into() }
    }
}

/// A curve, or what becomes one with as many vertices.
pub(super) trait Bent: From<Curve> {
    fn vertex_count(&self) -> usize;
}

impl Bent for Curve {
    fn vertex_count(&self) -> usize {
        self.vertices.len()
    }
}

impl From<Vec<Vertex>> for Curve {
    fn from(vertices: Vec<Vertex>) -> Self {
        Self {
            bulges: vertices.iter().map(|vertex| vertex.bulge).collect(),
            vertices: vertices.into_iter().map(|vertex| vertex.at).collect(),
            ..Self::default()
        }
    }
}

/// A vertex: the place that the pen has reached when it is at a certain site on the other line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Vertex {
    at: PxPoint,
    /// Index of the site.
    site: usize,
    /// Bulge of the segment to the next vertex.
    bulge: f64,
}

/// A segment that keeps the promise.
#[derive(Clone, Copy, Debug)]
struct FittedSegment {
    bulge: f64,
    /// Sum of the squared distances of its sites, px².
    squares: f64,
}

/// What a segment is to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Line,
    Arc,
}

/// Fits lines and arcs to sites, with vertices near them.
#[derive(Debug)]
struct ArcFitter {
    promise: Promise,
    sites: Vec<PxPoint>,
    /// The sites, smoothed; the first and the last one as they are.
    smooth: Vec<PxPoint>,
}

/// The segments of an open line.
fn path(promise: Promise, sites: &[PxPoint]) -> Vec<Vertex> {
    let fitter = ArcFitter::new(promise, sites.to_vec(), smoothed(promise, sites, false));
    let mut vertices = fitter.vertices();
    fitter.improve(&mut vertices);
    vertices
}

/// The segments of a closed line.
fn ring(promise: Promise, mut sites: Vec<PxPoint>) -> Vec<Vertex> {
    let count = sites.len();
    let mut smooth = smoothed(promise, &sites, true);
    let lap = |sites: &[PxPoint], smooth: &[PxPoint]| {
        let around = |places: &[PxPoint]| places.iter().chain(places.first()).copied().collect();
        ArcFitter::new(promise, around(sites), around(smooth))
    };
    let mut fitter = lap(&sites, &smooth);
    let mut best = fitter.vertices();
    // The first lap began anywhere: begin again where its first segment ended.
    if let Some(seam) = best.get(1).map(|vertex| vertex.site).filter(|seam| *seam < count) {
        sites.rotate_left(seam);
        smooth.rotate_left(seam);
        let turned = lap(&sites, &smooth);
        let again = turned.vertices();
        if again.len() <= best.len() {
            (fitter, best) = (turned, again);
        } else {
            sites.rotate_right(seam);
            smooth.rotate_right(seam);
        }
    }
    fitter.improve(&mut best);
    // The seam could not move: turn the ring by half and move it too.
    let half = best.len() / 2;
    let Some(seam) = best.get(half).map(|vertex| vertex.site).filter(|_| best.len() > 3) else { return best };
    best.pop();
    best.iter_mut().for_each(|vertex| vertex.site = (vertex.site + count - seam) % count);
    best.rotate_left(half);
    let Some(first) = best.first().copied() else { return best };
    best.push(Vertex { site: count, bulge: 0.0, ..first });
    sites.rotate_left(seam);
    smooth.rotate_left(seam);
    lap(&sites, &smooth).improve(&mut best);
    best
}

/// The circle that a closed line is within the tolerance, as two half circles.
fn round(promise: Promise, sites: &[PxPoint]) -> Option<Curve> {
    let area: f64 = sites
        .iter()
        .zip(sites.iter().cycle().skip(1))
        .filter_map(|(from, to)| sites.first().map(|origin| (*from - *origin).cross(*to - *origin)))
        .sum();
    let turn = if area > 0.0 { 1.0 } else { -1.0 };
    let fitter = ArcFitter::new(promise, sites.iter().chain(sites.first()).copied().collect(), Vec::new());
    let mut weights = vec![1.0; sites.len()];
    for _ in 0..CIRCLE_ROUNDS {
        let (centre, radius_px) = weighted_circle(sites, &weights)?;
        let off = |at: &PxPoint| (at.distance(centre) - radius_px).abs();
        let add = |(greatest, squares): (f64, f64), (at, weight): (&PxPoint, &f64)| {
            (f64::max(greatest, off(at)), squares + weight * off(at) * off(at))
        };
        let (greatest, squares) = sites.iter().zip(&weights).fold((0.0, 0.0), add);
        let mean = libm::sqrt(squares / weights.iter().sum::<f64>());
        if greatest <= promise.radius_px
            && let Some(circle) = halves(&fitter, centre, radius_px, turn)
        {
            return Some(circle.into());
        }
        // The mean of the squares is the least of all circles, so no circle's greatest error is less than its
        // root.
        if mean > SURELY * promise.radius_px || greatest.is_nan() || greatest == 0.0 {
            return None;
        }
        weights.iter_mut().zip(sites).for_each(|(weight, at)| *weight *= off(at) / greatest);
    }
    None
}

/// A circle as two arcs from beside the first site, if it keeps the promise.
fn halves(fitter: &ArcFitter, centre: PxPoint, radius_px: f64, turn: f64) -> Option<Vec<Vertex>> {
    if !(MIN_RADIUS_PX..=MAX_RADIUS_PX).contains(&radius_px) {
        return None;
    }
    let last = fitter.sites.len().checked_sub(1)?;
    let first = fitter.sites.first()?;
    let on_circle = |site: &PxPoint| {
        let away = site.distance(centre);
        (away > 0.0).then(|| centre + (*site - centre) / away * radius_px)
    };
    let at = on_circle(first)?;
    let opposite = PxPoint::new(2.0 * centre.x - at.x, 2.0 * centre.y - at.y);
    let nearest = |(_, one): &(usize, &PxPoint), (_, other): &(usize, &PxPoint)| {
        one.distance(opposite).total_cmp(&other.distance(opposite))
    };
    let (middle, nearest) = fitter.sites.iter().enumerate().min_by(nearest)?;
    let opposite = on_circle(nearest)?;
    let (one, other) = (at - centre, opposite - centre);
    let angle = libm::atan2(turn * one.cross(other), one.dot(other));
    let angle = if angle < 0.0 { angle + TAU } else { angle };
    let bulges = [angle, TAU - angle].map(|angle| turn * libm::tan(angle / 4.0));
    let vertex = |at, site, bulge| Vertex { at, site, bulge };
    let [there, back] = bulges;
    let circle = vec![vertex(at, 0, there), vertex(opposite, middle, back), vertex(at, last, 0.0)];
    let kept = circle.windows(2).all(|ends| match ends {
        [from, to] => fitter.is_vertex(from) && fitter.check(from, to, from.bulge).is_some(),
        _ => false,
    });
    kept.then_some(circle)
}

/// The circle with the least weighted sum of squares of x² + y² + D x + E y + F over the sites.
fn weighted_circle(sites: &[PxPoint], weights: &[f64]) -> Option<(PxPoint, f64)> {
    let weight: f64 = weights.iter().sum();
    let mean = |of: &dyn Fn(&PxPoint) -> f64| {
        sites.iter().zip(weights).map(|(at, weight)| weight * of(at)).sum::<f64>() / weight
    };
    let middle = PxPoint::new(mean(&|at| at.x), mean(&|at| at.y));
    let (mut xx, mut xy, mut yy, mut xz, mut yz, mut z) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    for (at, weight) in sites.iter().zip(weights) {
        let PxVec { x, y } = *at - middle;
        let square = x * x + y * y;
        xx += weight * x * x;
        xy += weight * x * y;
        yy += weight * y * y;
        xz += weight * x * square;
        yz += weight * y * square;
        z += weight * square;
    }
    // Σ w x = Σ w y = 0: two equations for twice the centre, and the radius from the mean square.
    let determinant = 2.0 * (xx * yy - xy * xy);
    let (x, y) = ((xz * yy - yz * xy) / determinant, (yz * xx - xz * xy) / determinant);
    let radius_px = libm::sqrt(x * x + y * y + z / weight);
    let centre = PxPoint::new(middle.x + x, middle.y + y);
    (centre.is_finite() && radius_px.is_finite()).then_some((centre, radius_px))
}

/// The sites, each the middle of the parabola through its neighbours: free of the raster's noise, and of its
/// corners.
///
/// A. Savitzky, M. J. E. Golay, "Smoothing and differentiation of data by simplified least squares
/// procedures" (1964).
pub(super) fn smoothed(promise: Promise, sites: &[PxPoint], closed: bool) -> Vec<PxPoint> {
    let count = sites.len();
    let smooth = |(index, site): (usize, &PxPoint)| {
        let most = if closed { (count - 1) / 2 } else { index.min(count - 1 - index) };
        let reach = SMOOTHED.min(most);
        let m = number(reach);
        let (mut x, mut y, mut sum) = (0.0, 0.0, 0.0);
        for step in 0..=2 * reach {
            let offset = number(step) - m;
            let weight = 3.0 * m * (m + 1.0) - 1.0 - 5.0 * offset * offset;
            let Some(at) = sites.get((index + count + step - reach) % count) else { continue };
            (x, y, sum) = (x + weight * at.x, y + weight * at.y, sum + weight);
        }
        let moved = if reach > 1 { PxPoint::new(x / sum, y / sum) } else { *site };
        let off = moved.distance(*site);
        let most_px = 0.9 * promise.radius_px;
        if off <= most_px { moved } else { *site + (moved - *site) * (most_px / off) }
    };
    sites.iter().enumerate().map(smooth).collect()
}

#[expect(clippy::cast_precision_loss, reason = "a small count")]
pub(super) fn number(count: usize) -> f64 {
    count as f64
}

impl ArcFitter {
    fn new(promise: Promise, sites: Vec<PxPoint>, smooth: Vec<PxPoint>) -> Self {
        Self { promise, sites, smooth }
    }

    fn last(&self) -> usize {
        self.sites.len().saturating_sub(1)
    }

    /// The sites between two vertices.
    fn between(&self, from: &Vertex, to: &Vertex) -> &[PxPoint] {
        self.sites.get(from.site + 1..to.site).unwrap_or(&[])
    }

    /// Whether a vertex is near enough to its site.
    fn is_vertex(&self, vertex: &Vertex) -> bool {
        self.sites.get(vertex.site).is_some_and(|site| site.distance(vertex.at) <= self.promise.radius_px)
    }

    /// From each vertex the segment that goes farthest.
    fn vertices(&self) -> Vec<Vertex> {
        let ends = (self.smooth.first().copied(), self.smooth.last().copied());
        let (Some(first), Some(_)) = ends else { return Vec::new() };
        let mut vertices = vec![Vertex { at: first, site: 0, bulge: 0.0 }];
        while let Some(from) = vertices.last().copied().filter(|from| from.site < self.last()) {
            let line = self.farthest(&from, Kind::Line);
            let arc = if line.0.site < self.last() { self.farthest(&from, Kind::Arc) } else { line };
            let reach = |segment: &(Vertex, f64)| number(segment.0.site - from.site);
            let (to, bulge) = if reach(&arc) > PAYS * reach(&line) { arc } else { line };
            if let Some(from) = vertices.last_mut() {
                from.bulge = bulge;
            }
            // One site farther at least.
            vertices.push(to);
        }
        vertices
    }

    /// The farthest vertex that one segment of a kind reaches, as found by doubling and halving, and its
    /// bulge. The next site is always reached by a straight line.
    fn farthest(&self, from: &Vertex, kind: Kind) -> (Vertex, f64) {
        let next = |site: usize| self.smooth.get(site).copied().unwrap_or(from.at);
        let best = (Vertex { at: next(from.site + 1), site: from.site + 1, bulge: 0.0 }, 0.0);
        farthest(best, self.last() - from.site, |reach| self.reaches(from, from.site + reach, kind))
    }

    /// A segment that ends at a site, or where the sites are without their noise.
    fn reaches(&self, from: &Vertex, site: usize, kind: Kind) -> Option<(Vertex, f64)> {
        let places = [self.smooth.get(site), self.sites.get(site).filter(|_| site < self.last())];
        places.into_iter().flatten().find_map(|at| {
            let to = Vertex { at: *at, site, bulge: 0.0 };
            self.segment(from, &to, kind, 0.0).map(|segment| (to, segment.bulge))
        })
    }

    /// The best segment of a kind between two vertices that keeps the promise. An arc is looked for from the
    /// bulge on.
    fn segment(&self, from: &Vertex, to: &Vertex, kind: Kind, bulge: f64) -> Option<FittedSegment> {
        match kind {
            Kind::Line => {
                let squares = self.promise.link(from.at, to.at, self.between(from, to))?;
                Some(FittedSegment { bulge: 0.0, squares })
            }
            Kind::Arc => self.arc(from, to, bulge),
        }
    }

    fn arc(&self, from: &Vertex, to: &Vertex, bulge: f64) -> Option<FittedSegment> {
        let sites = self.between(from, to);
        let fit = Fit::new(from.at, to.at)?;
        let sagitta = fit.least_squares(sites, -0.5 * bulge * fit.chord_px);
        let found = self.check(from, to, fit.bulge(sagitta));
        if found.is_some() || bulge != 0.0 {
            return found;
        }
        let (low, high) = fit.range(sites, sagitta, self.promise.radius_px)?;
        self.check(from, to, fit.bulge(f64::midpoint(low, high)))
    }

    /// The arc of this bulge, if it keeps the promise.
    ///
    /// Were qᵢ places on the arc in order, each dᵢ from its site, then between two of them the arc is
    /// everywhere within max(dᵢ, dᵢ₊₁) + h of the way from site to site, where h is how far it rises over the
    /// chord qᵢ qᵢ₊₁.
    fn check(&self, from: &Vertex, to: &Vertex, bulge: f64) -> Option<FittedSegment> {
        let arc = Arc::new(from.at, to.at, bulge)?;
        let radius = arc.radius_px;
        if bulge.abs() > MAX_BULGE || !(MIN_RADIUS_PX..=MAX_RADIUS_PX).contains(&radius) {
            return None;
        }
        let off = |at: PxPoint, site: usize| self.sites.get(site).map(|site| site.distance(at));
        let mut last = (from.at - arc.centre, off(from.at, from.site)?);
        let end = (to.at - arc.centre, off(to.at, to.site)?);
        let (turn, sweep) = (if bulge > 0.0 { 1.0 } else { -1.0 }, arc.sweep_rad.abs());
        let rises = |a: PxVec, b: PxVec| {
            let half_squared = 0.25 * (a - b).length_squared();
            half_squared / (radius + libm::sqrt((radius * radius - half_squared).max(0.0)))
        };
        let limit = self.promise.radius_px;
        let (mut done, mut squares) = (0.0, 0.0);
        for site in self.between(from, to) {
            let out = *site - arc.centre;
            let away = out.length_near();
            let mut at = out * radius / away;
            let step = libm::atan2(turn * last.0.cross(at), last.0.dot(at));
            if step > 0.0 && done + step < sweep {
                done += step;
            } else if step > 0.0 {
                (at, done) = (end.0, sweep);
            } else {
                at = last.0;
            }
            let squared = (out - at).length_squared();
            let far = libm::sqrt(squared);
            if far.is_nan() || far.max(last.1) + rises(last.0, at) > limit {
                return None;
            }
            squares += squared;
            last = (at, far);
        }
        // What is left must be less than half a turn, or its rise is not the one over its chord.
        let whole = sweep - done < PI && end.1.max(last.1) + rises(last.0, end.0) <= limit;
        whole.then_some(FittedSegment { bulge, squares })
    }

    /// Moves the inner vertices to where the sum of the squared distances is less, each by itself, some times
    /// over.
    fn improve(&self, vertices: &mut [Vertex]) {
        let mut moved = vec![true; vertices.len()];
        for sweep in 0..SWEEPS {
            let mut any = false;
            for step in 1..vertices.len().saturating_sub(1) {
                let index = if sweep % 2 == 0 { step } else { vertices.len() - 1 - step };
                let stirred = moved.get(index - 1..index + 2).unwrap_or(&[]).contains(&true);
                let better = match vertices.get(index - 1..index + 2) {
                    Some([before, vertex, after]) if stirred => self.better(*before, *vertex, *after),
                    _ => None,
                };
                any |= better.is_some();
                moved.get_mut(index).into_iter().for_each(|slot| *slot = better.is_some());
                if let (Some((bulge, better)), Some([before, vertex])) =
                    (better, vertices.get_mut(index - 1..=index))
                {
                    (before.bulge, *vertex) = (bulge, better);
                }
            }
            if !any {
                break;
            }
        }
    }

    /// A better place for a vertex between two: the bulge of the segment before, and the vertex with that of
    /// the segment after.
    fn better(&self, before: Vertex, vertex: Vertex, after: Vertex) -> Option<(f64, Vertex)> {
        let kind = |bulge: f64| if bulge == 0.0 { Kind::Line } else { Kind::Arc };
        let kinds = (kind(before.bulge), kind(vertex.bulge));
        let judge = |place: &Vertex, bulges: (f64, f64)| -> Option<(f64, (f64, f64))> {
            let one = self.segment(&before, place, kinds.0, bulges.0)?;
            let other = self.segment(place, &after, kinds.1, bulges.1)?;
            // The site of the vertex is in neither segment.
            let own = *self.sites.get(place.site)? - place.at;
            Some((one.squares + other.squares + own.length_squared(), (one.bulge, other.bulge)))
        };
        let mut best = (vertex, (before.bulge, vertex.bulge));
        // An arc from the middle of its range is not the one that fits best: anything that does is better.
        let mut least = judge(&vertex, best.1).map_or(f64::INFINITY, |judged| judged.0);
        let start = least;
        let mut attempt = |place: Vertex, best: &mut (Vertex, (f64, f64))| {
            if !self.is_vertex(&place) {
                return;
            }
            if let Some((squares, bulges)) = judge(&place, best.1).filter(|(squares, _)| *squares < least) {
                least = squares;
                *best = (place, bulges);
            }
        };
        for shift in SHIFTS {
            for forward in [false, true] {
                let from = best.0.site;
                let site = if forward { from + shift } else { from.saturating_sub(shift) };
                if site > before.site && site < after.site {
                    let at = self.smooth.get(site).copied().unwrap_or(best.0.at);
                    attempt(Vertex { at, site, ..best.0 }, &mut best);
                }
            }
        }
        for nudge in NUDGES {
            let [right, down, left, up] = PxVec::AXES;
            for side in [right, left, down, up] {
                let at = best.0.at + side * (nudge * self.promise.radius_px);
                attempt(Vertex { at, ..best.0 }, &mut best);
            }
        }
        let (place, bulges) = best;
        // Less by a hundredth at least: it is to end.
        (least < 0.99 * start && least.is_finite()).then_some((bulges.0, Vertex { bulge: bulges.1, ..place }))
    }
}

/// The arcs between two places, by their sagitta: how far they rise over the chord's middle to its left, px.
/// With c the chord, a circle through both ends has its centre (s² − c²/4) / 2s over the chord.
#[derive(Clone, Copy, Debug)]
struct Fit {
    middle: PxPoint,
    unit: PxVec,
    chord_px: f64,
}

impl Fit {
    fn new(from: PxPoint, to: PxPoint) -> Option<Self> {
        let chord_px = from.distance(to);
        let fitter = to - from;
        let middle = PxPoint::new(f64::midpoint(from.x, to.x), f64::midpoint(from.y, to.y));
        (chord_px > 1e-3).then_some(Self { middle, unit: fitter / chord_px, chord_px })
    }

    /// A place along the chord from its middle, and over it.
    fn local(&self, at: PxPoint) -> (f64, f64) {
        let away = at - self.middle;
        (self.unit.dot(away), self.unit.cross(away))
    }

    fn bulge(&self, sagitta: f64) -> f64 {
        -2.0 * sagitta / self.chord_px
    }

    /// The sagitta with the least squared distances, from a guess, or from that of the parabola.
    fn least_squares(&self, sites: &[PxPoint], guess: f64) -> f64 {
        let quarter = 0.25 * self.chord_px * self.chord_px;
        let mut sagitta = guess;
        if guess == 0.0 {
            let (mut pull, mut weight) = (0.0, 0.0);
            for site in sites {
                let (along, over) = self.local(*site);
                let rise = (1.0 - along * along / quarter).max(0.0);
                pull += over * rise;
                weight += rise * rise;
            }
            sagitta = if weight > 0.0 { pull / weight } else { 0.0 };
        }
        let most = 0.5 * MAX_BULGE * self.chord_px;
        // A flat arc is a parabola: the first guess is as good as any.
        for _ in 0..FIT_STEPS {
            if sagitta.is_nan() || sagitta.abs() <= 0.03 * self.chord_px {
                break;
            }
            let centre = (sagitta * sagitta - quarter) / (2.0 * sagitta);
            let (radius, side) = ((sagitta - centre).abs(), if sagitta > 0.0 { 1.0 } else { -1.0 });
            let bend = quarter / (2.0 * sagitta * sagitta);
            let (centre_slope, radius_slope) = (0.5 + bend, side * (0.5 - bend));
            let (mut pull, mut weight) = (0.0, 0.0);
            for site in sites {
                let (along, over) = self.local(*site);
                let up = over - centre;
                let away = libm::sqrt(along * along + up * up);
                let slope = -up / away * centre_slope - radius_slope;
                pull += (away - radius) * slope;
                weight += slope * slope;
            }
            let step = if weight > 0.0 { pull / weight } else { 0.0 };
            // Never over to the other side, nor to the whole circle.
            let next = (sagitta - step).clamp(-most, most);
            sagitta = if next * side > 0.0 { next } else { 0.5 * sagitta };
            if step.is_nan() || step.abs() <= 1e-3 {
                break;
            }
        }
        sagitta
    }

    /// The sagittas of the arcs that pass every site within a distance; `None` when there are none. Sites
    /// near the ends say nothing.
    fn range(&self, sites: &[PxPoint], near: f64, radius_px: f64) -> Option<(f64, f64)> {
        let half = 0.5 * self.chord_px;
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let centre = (near * near - half * half) / (2.0 * near);
        for site in sites {
            let (along, over) = self.local(*site);
            let ends = libm::hypot(along.abs() - half, over);
            if ends < 2.0 * radius_px {
                continue;
            }
            // Away from the centre, or across the chord where that is far.
            let (x, y) = (along, over - centre);
            let away = libm::hypot(x, y);
            let (x, y) = if away.is_finite() && away > 0.0 { (x / away, y / away) } else { (0.0, 1.0) };
            let side = if y > 0.0 { radius_px } else { -radius_px };
            let least = through(along - side * x, over - side * y, half);
            let most = through(along + side * x, over + side * y, half);
            low = low.max(least.min(most));
            high = high.min(most.max(least));
            if low > high {
                return None;
            }
        }
        (low.is_finite() && high.is_finite()).then_some((low, high))
    }
}

/// The sagitta of the arc through a place, and both ends half a chord to either side of the origin.
fn through(along: f64, over: f64, half: f64) -> f64 {
    if over == 0.0 {
        return 0.0;
    }
    let centre = (along * along + over * over - half * half) / (2.0 * over);
    let radius = libm::hypot(centre, half);
    let side = if over > 0.0 { 1.0 } else { -1.0 };
    // Of the two ways to write it the one that does not cancel.
    if centre * side >= 0.0 { centre + side * radius } else { side * half * half / (radius - side * centre) }
}
