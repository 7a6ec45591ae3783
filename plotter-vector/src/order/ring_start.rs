//! [`start_rings_well`]: where closed strokes begin, once their order is found.
//!
//! ```text
//!   before ──────►  ●  ──────► after        ● the place of the ring with the least sum of both ways:
//!                 (   )                       a vertex, or within an arc or a cubic curve
//!                  ‾‾‾
//! ```

use super::plan::{Legs, Trail, parts_of, share_of};
use super::sites::number;
use super::{Ends, Travel};
use crate::stroke::curve::{Segment, whole_chords};
use crate::stroke::{Curve, PxPoint};

/// Travel that counts as equal, px.
const SAME_PX: f64 = 1e-9;

/// Difference of the cosines of two bends that counts as one being sharper.
const SHARPER_COS: f64 = 0.05;

/// Most looks at rings, of all of them: for each, and besides. A start depends on its neighbours': three
/// looks settle nearly all, as only rings next to one that has moved are looked at again, but two circles
/// that nearly touch take hundreds.
const LOOKS_PER_RING: usize = 20;
const LOOKS: usize = 1000;

/// How far a start has to move for its neighbours to be looked at again, px: less gains no tenth of a pixel.
const MOVED_PX: f64 = 0.05;

/// Least travel that a start within a segment saves over one at a vertex, px: a tenth of a millimetre of a
/// sheet, some milliseconds. It costs a vertex, and at a corner the pen's coming and going is not seen.
const LEAST_SAVED_PX: f64 = 1.0;

/// Greatest angle of an arc over which the sum of the distances from two places is taken to have one least
/// value, rad.
const ARC_STEP_RAD: f64 = core::f64::consts::FRAC_PI_8;

/// Stretches of a cubic curve over which it is taken to have one least value.
const CUBIC_STRETCHES: u32 = 16;

/// Steps of the search within a stretch, each to the golden section of what is left: to 0.0005 of it. About
/// its least value a sum of distances is flat: of a stretch of 100 px that is less than a thousandth of a
/// pixel, a pixel away from what the pen comes from.
const SEARCH_STEPS: u32 = 16;

/// The golden section: (√5 − 1) / 2.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// Lets each ring begin at the place that is on the way from the stroke before to the one after; of equally
/// good vertices at the sharpest corner, where the pen's coming and going is not seen. Gives the way between
/// all trails, px; that to the first is not known.
pub(super) fn start_rings_well(legs: &Legs<'_>, trails: &mut [Trail]) -> f64 {
    let mut rings = Rings::new(legs, trails);
    let mut looks_left = LOOKS + LOOKS_PER_RING * rings.0.len();
    while looks_left > 0 {
        let mut settled = true;
        for ring in 0..rings.0.len() {
            if looks_left == 0 {
                break;
            }
            let Some(Ring { index, at, .. }) = rings.take_due(ring) else { continue };
            looks_left -= 1;
            let before =
                index.checked_sub(1).and_then(|before| trails.get(before).map(|trail| (before, *trail)));
            let after = trails.get(index + 1).copied();
            let ways = RingNeighbours {
                before: before.map(|(index, trail)| rings.ends(legs, trail, index).1),
                after: after.map(|trail| rings.ends(legs, trail, index + 1).0),
            };
            let Some(trail) = trails.get_mut(index) else { continue };
            (trail.start, trail.share) = (0, 0);
            let mut curve = legs.curve(*trail);
            curve.vertices.pop();
            let start = ways.best_start(&curve);
            (trail.start, trail.share) = (number(start.vertex), start.parts);
            if at.distance(start.at) > MOVED_PX {
                settled = false;
                rings.make_due_beside(ring);
            }
            rings.begin_at(ring, start.at);
        }
        if settled {
            break;
        }
    }
    let mut way = Travel::default();
    let mut own = rings.0.iter().map(|ring| (ring.at, ring.at));
    for trail in trails.iter() {
        let ends = if trail.closed { own.next() } else { None };
        way.go_on(ends.unwrap_or_else(|| legs.ends(*trail)));
    }
    way.px
}

/// What the way between all trails cannot be less than, px, wherever the closed ones begin: no place of a ring
/// is farther than half its length from another one.
pub(super) fn least_way_px(legs: &Legs<'_>, trails: &[Trail]) -> f64 {
    let mut way_px = 0.0;
    let mut last: Option<(PxPoint, f64)> = None;
    for trail in trails {
        let ((from, to), reach_px) = if trail.closed {
            let ring = legs.curve(*trail);
            let from = ring.vertices.first().copied().unwrap_or_default();
            let sides = 0..ring.vertices.len().saturating_sub(1);
            let length_px: f64 = sides.map(|side| ring.course().longest_px(side)).sum();
            ((from, from), 0.5 * length_px)
        } else {
            (legs.ends(*trail), 0.0)
        };
        if let Some((last, last_px)) = last {
            way_px += (last.distance(from) - last_px - reach_px).max(0.0);
        }
        last = Some((to, reach_px));
    }
    way_px
}

/// A closed trail.
#[derive(Clone, Copy, Debug)]
struct Ring {
    /// Which of the trails.
    index: usize,
    /// Where it begins.
    at: PxPoint,
    /// Whether it is to be looked at again.
    is_due: bool,
}

/// The closed trails in order.
struct Rings(Vec<Ring>);

impl Rings {
    fn new(legs: &Legs<'_>, trails: &[Trail]) -> Self {
        let closed = trails.iter().enumerate().filter(|(_, trail)| trail.closed);
        Self(closed.map(|(index, trail)| Ring { index, at: legs.ends(*trail).0, is_due: true }).collect())
    }

    fn take_due(&mut self, ring: usize) -> Option<Ring> {
        let ring = self.0.get_mut(ring)?;
        std::mem::take(&mut ring.is_due).then_some(*ring)
    }

    /// Where a trail with this index begins and ends.
    fn ends(&self, legs: &Legs<'_>, trail: Trail, index: usize) -> Ends {
        let known = || {
            let ring = self.0.binary_search_by_key(&index, |ring| ring.index).ok()?;
            self.0.get(ring).map(|ring| (ring.at, ring.at))
        };
        if trail.closed { known().unwrap_or_default() } else { legs.ends(trail) }
    }

    fn begin_at(&mut self, ring: usize, at: PxPoint) {
        if let Some(ring) = self.0.get_mut(ring) {
            ring.at = at;
        }
    }

    /// Lets the rings before and after one be looked at again.
    fn make_due_beside(&mut self, ring: usize) {
        let index = self.0.get(ring).map_or(0, |ring| ring.index);
        let beside = [ring.checked_sub(1), Some(ring + 1)].into_iter().flatten();
        for ring in beside {
            if let Some(ring) = self.0.get_mut(ring).filter(|ring| ring.index.abs_diff(index) == 1) {
                ring.is_due = true;
            }
        }
    }
}

/// Where a ring begins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Start {
    /// Vertex with which the segment begins.
    vertex: usize,
    /// Share of that segment: see [`Trail::share`].
    parts: u32,
    at: PxPoint,
}

/// What the pen draws before a ring ends here, and what it draws after it begins there.
#[derive(Clone, Copy, Debug)]
struct RingNeighbours {
    before: Option<PxPoint>,
    after: Option<PxPoint>,
}

impl RingNeighbours {
    /// Travel to and from a place, px.
    fn travel(&self, at: PxPoint) -> f64 {
        // No coordinate is so large that its square is none, and a root is had in a third of the time.
        let way = |end: Option<PxPoint>| {
            end.map_or(0.0, |end| {
                libm::sqrt((end.x - at.x) * (end.x - at.x) + (end.y - at.y) * (end.y - at.y))
            })
        };
        way(self.before) + way(self.after)
    }

    /// By how much the travel changes at most for each pixel that the place moves.
    fn slope(&self) -> f64 {
        let way = |end: Option<PxPoint>| if end.is_some() { 1.0 } else { 0.0 };
        way(self.before) + way(self.after)
    }

    /// The place of a ring, whose first vertex is not repeated, from which it is drawn.
    fn best_start(&self, ring: &Curve) -> Start {
        let (mut start, least_px) = self.best_vertex(ring);
        let mut most_px = least_px - LEAST_SAVED_PX;
        let ends = ring.vertices.iter().zip(ring.vertices.iter().cycle().skip(1));
        let slope = self.slope();
        for (vertex, (from, to)) in ends.enumerate() {
            // Nowhere on it is there less than this: the other segments are not asked for.
            let least_px =
                0.5 * (self.travel(*from) + self.travel(*to) - slope * ring.course().longest_px(vertex));
            if least_px >= most_px {
                continue;
            }
            // Within a straight side the pen would stop where it otherwise goes on, and a polygon would have
            // a vertex more.
            let Some(segment @ (Segment::Arc(_) | Segment::Cubic(_))) = ring.course().segment(vertex) else {
                continue;
            };
            if let Some((share, px)) = self.best_share(&segment, most_px) {
                let parts = parts_of(share);
                (start, most_px) = (Start { vertex, parts, at: segment.at(share_of(parts)) }, px);
            }
        }
        start
    }

    /// The vertex of a ring from which it is drawn, and the travel there.
    fn best_vertex(&self, ring: &Curve) -> (Start, f64) {
        let mut best = (f64::INFINITY, f64::INFINITY, Start::default());
        for (vertex, at) in ring.vertices.iter().enumerate() {
            let far = self.travel(*at);
            if far > best.0 + SAME_PX {
                continue;
            }
            let count = ring.vertices.len();
            let segment = |index: usize| ring.course().segment(index).unwrap_or(Segment::Line(*at, *at));
            // Of what is not straight the directions at the vertex count.
            let from = match segment(vertex.checked_sub(1).unwrap_or(count - 1)) {
                Segment::Line(previous, _) => previous,
                bent => *at - bent.heading(true),
            };
            let to = match segment(vertex) {
                Segment::Line(_, next) => next,
                bent => *at + bent.heading(false),
            };
            let bend = bend_cos(from, *at, to);
            if far < best.0 - SAME_PX || bend < best.1 - SHARPER_COS {
                best = (far, bend, Start { vertex, parts: 0, at: *at });
            }
        }
        (best.2, best.0)
    }

    /// The share of a segment at which the travel is least, and how much it is there, if that is less than
    /// `most_px`.
    fn best_share(&self, segment: &Segment, most_px: f64) -> Option<(f64, f64)> {
        let stretches = match segment {
            // The sum of two distances is convex along a line.
            Segment::Line(..) => 1,
            Segment::Arc(arc) => whole_chords(libm::ceil(arc.sweep_rad.abs() / ARC_STEP_RAD)),
            Segment::Cubic(_) => CUBIC_STRETCHES,
        };
        let share = |stretch: u32| f64::from(stretch) / f64::from(stretches);
        let travel = |share: f64| self.travel(segment.at(share));
        let steep_px = self.slope() * segment.longest_part_px(share(1));
        let mut best: Option<(f64, f64)> = None;
        let mut begins_px = travel(0.0);
        for stretch in 0..stretches {
            let ends_px = travel(share(stretch + 1));
            let least_px = best.map_or(most_px, |(_, px)| px);
            // Nowhere on it is there less than this.
            if 0.5 * (begins_px + ends_px - steep_px) < least_px {
                let (at, px) = least(share(stretch), share(stretch + 1), travel);
                if px < least_px {
                    best = Some((at, px));
                }
            }
            begins_px = ends_px;
        }
        best
    }
}

/// Where a function with one least value between two places has it, and how much it is (J. Kiefer,
/// "Sequential minimax search for a maximum", 1953).
fn least(mut low: f64, mut high: f64, value: impl Fn(f64) -> f64) -> (f64, f64) {
    let sections = |low: f64, high: f64| (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
    let (one, other) = sections(low, high);
    let (mut one, mut other) = ((one, value(one)), (other, value(other)));
    for _ in 0..SEARCH_STEPS {
        if one.1 <= other.1 {
            (high, other) = (other.0, one);
            let at = sections(low, high).0;
            one = (at, value(at));
        } else {
            (low, one) = (one.0, other);
            let at = sections(low, high).1;
            other = (at, value(at));
        }
    }
    if one.1 <= other.1 { one } else { other }
}

/// Cosine of the change of direction at a vertex: 1 straight on, −1 back.
fn bend_cos(from: PxPoint, at: PxPoint, to: PxPoint) -> f64 {
    let lengths = from.distance(at) * at.distance(to);
    let dot = (at.x - from.x) * (to.x - at.x) + (at.y - from.y) * (to.y - at.y);
    if lengths > 0.0 { dot / lengths } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::super::as_given;
    use super::super::plan::strokes_of;
    use super::*;
    use crate::stroke::Drawing;

    fn at(x: f64, y: f64) -> PxPoint {
        PxPoint::new(x, y)
    }

    #[test]
    fn of_equally_near_vertices_a_ring_begins_at_the_sharpest() {
        let ring = [(0.0, 0.0), (2.0, 0.0), (4.0, 0.0), (2.0, 9.0)].map(|(x, y)| at(x, y));
        let ring = Curve::from(ring.to_vec());
        let start = |before| RingNeighbours { before, after: None }.best_start(&ring).vertex;
        assert_eq!(start(None), 3);
        assert_eq!(start(Some(at(2.0, -1.0))), 1);
    }

    #[test]
    fn a_ring_begins_at_a_vertex_or_within_an_arc_or_a_curve_where_both_ways_are_least() {
        // A square whose left side is an arc that bulges to the left, and whose right one is a curve.
        let ring = Curve {
            vertices: [(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)]
                .map(|(x, y)| at(x, y))
                .to_vec(),
            bulges: vec![0.0, 0.0, 0.0, 1.0],
            handles: vec![None, Some([at(180.0, 10.0), at(140.0, 90.0)]), None, None],
        };
        let ends =
            [(30.0, -50.0), (60.0, -20.0), (-200.0, 30.0), (300.0, 200.0), (210.0, -20.0), (20.0, 500.0)];
        let ends = ends.map(|(x, y)| at(x, y));
        for (before, after) in ends.iter().flat_map(|one| ends.map(|other| (*one, other))) {
            let ways = RingNeighbours { before: Some(before), after: Some(after) };
            let start = ways.best_start(&ring);
            let segments: Vec<Segment> = (0..4).filter_map(|vertex| ring.course().segment(vertex)).collect();
            let parts = |segment: &Segment| if matches!(segment, Segment::Line(..)) { 1 } else { 2000 };
            let places = segments
                .iter()
                .flat_map(|segment| (0..parts(segment)).map(|k| segment.at(f64::from(k) / 2000.0)));
            let least = places.map(|at| ways.travel(at)).fold(f64::INFINITY, f64::min);
            let px = ways.travel(start.at);
            // A vertex stands where it costs no more than a pixel.
            let most = least + if start.parts == 0 { LEAST_SAVED_PX } else { 1e-3 };
            assert!(px <= most, "{before:?} {after:?}: {start:?}, {px} px of {least}");
        }
    }

    #[test]
    fn no_start_makes_the_way_shorter_than_it_is_said_to_be_at_least() {
        let mut random = plotter_motion::SplitMix64::new(1);
        for _ in 0..200 {
            let mut drawing = Drawing::new(0, 0);
            for _ in 0..6 {
                let mut place = || at(300.0 * random.unit(), 300.0 * random.unit());
                let (from, to) = (place(), place());
                let ring = Curve {
                    vertices: vec![from, to, from],
                    bulges: vec![0.9, 0.0],
                    handles: vec![None, Some([place(), place()])],
                };
                drawing.push_curve(0, if random.unit() < 0.7 { ring } else { vec![from, to].into() });
            }
            let strokes = strokes_of(&drawing);
            let (legs, mut trails) = as_given(&strokes, &[], true);
            let least_px = least_way_px(&legs, &trails);
            assert!(trails.iter().any(|trail| trail.closed) || least_px > 0.0);
            let way_px = start_rings_well(&legs, &mut trails);
            assert!(least_px <= way_px + 1e-9, "{least_px} px, {way_px} px");
        }
    }
}
