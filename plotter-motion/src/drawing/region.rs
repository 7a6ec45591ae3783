//! [`Region`]: an area, by which lines, arcs and curves are cut.

use super::boxes::BoxTree;
use super::segment::roots;
use super::{Bounds, PathSegment, Shape, Stroke};
use crate::{Point, Segment};
use alloc::vec::Vec;
use core::f64::consts::PI;

/// Distance within which a point counts as on a border of straight lines, mm: a thousand times the rounding
/// of crossings on a sheet of 500 mm.
const BORDER_MM: f64 = 1e-10;
/// The same as a fraction of the greatest coordinate, for drawings beyond 10 m: 45 units in the last place.
const BORDER_SHARE: f64 = 1e-14;
/// Pieces shorter than this are ignored, mm: no pen draws and no motor steps a tenth of a micrometre. It is
/// above 0.00009 mm, the length on which a circle of 1 m that touches an edge lies within the rounding of a
/// crossing, a hundredth of [`BORDER_MM`].
pub(super) const DUST_MM: f64 = 1e-4;
/// The finest tolerance that curves are divided by, mm: a tenth of a micrometre, so that a circle of 10 mm
/// has some 700 lines at most.
const FINEST_MM: f64 = 1e-4;

/// Which side of a region is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Keep {
    /// The inside and the border.
    Inside,
    /// The outside, without the border.
    Outside,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Inside,
    Border,
    Outside,
}

/// An area with straight borders: the points within an odd number of its outlines, and those on an outline.
///
/// ```text
/// ┌──────────────┐
/// │ in  ┌──────┐ │      A ray from a point to the left crosses the outlines an odd number of times from
/// │     │ out  │ │      within, an even number from outside.
/// └─────┴──────┴─┘
/// ```
///
/// ```
/// use plotter_motion::{Point, drawing::{Bounds, Region}};
/// let square = |half: f64| Bounds::between(Point::new(-half, -half), Point::new(half, half));
/// let frame = Region::polygons([square(5.0).corners(), square(3.0).corners()]);
/// assert!(frame.has(Point::new(4.0, 0.0)) && frame.has(Point::new(3.0, 3.0)));
/// assert!(!frame.has(Point::new(2.9, 0.0)) && !frame.has(Point::new(5.1, 0.0)));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Region {
    edges: Vec<Segment>,
    tree: BoxTree,
    /// Distance from an edge within which a point is on the border, mm.
    border_mm: f64,
}

impl Region {
    /// A rectangle; an empty region if the rectangle is empty.
    #[must_use]
    pub fn rectangle(bounds: Bounds) -> Self {
        if bounds.is_empty() { Self::default() } else { Self::polygons([bounds.corners()]) }
    }

    /// The points within an odd number of these polygons. The last corner of each is joined to its first;
    /// corners that are not finite are left out.
    #[must_use]
    pub fn polygons<P: IntoIterator<Item = Point>>(polygons: impl IntoIterator<Item = P>) -> Self {
        Self::with_border(polygons, 0.0)
    }

    /// The inside of a closed stroke; `None` if it is not closed: see [`outline`].
    pub(super) fn of_stroke(stroke: &Stroke, tolerance_mm: f64) -> Option<Self> {
        let is_straight = stroke.segments.iter().all(|segment| segment.shape == Shape::Line);
        let border_mm = if is_straight { 0.0 } else { tolerance(tolerance_mm) };
        outline(stroke, tolerance_mm).map(|places| Self::with_border([places], border_mm))
    }

    fn with_border<P: IntoIterator<Item = Point>>(
        polygons: impl IntoIterator<Item = P>,
        border_mm: f64,
    ) -> Self {
        let mut edges = Vec::new();
        for polygon in polygons {
            let mut corners = polygon.into_iter().filter(|corner| corner.is_finite());
            let Some(first) = corners.next() else { continue };
            let mut from = first;
            for to in corners.chain([first]) {
                if to != from {
                    edges.push(Segment::new(from, to));
                }
                from = to;
            }
        }
        let largest = |at: Point| libm::fmax(libm::fabs(at.x), libm::fabs(at.y));
        let greatest = edges.iter().map(|edge| largest(edge.from)).fold(0.0, libm::fmax);
        let border_mm = libm::fmax(border_mm, libm::fmax(BORDER_MM, BORDER_SHARE * greatest));
        let tree =
            BoxTree::new(edges.iter().map(|edge| Bounds::between(edge.from, edge.to).wider(border_mm)));
        Self { edges, tree, border_mm }
    }

    /// The box around the region, its border included.
    pub(super) fn bounds(&self) -> Bounds {
        self.tree.bounds()
    }

    /// Whether a point lies in the region or on its border.
    #[must_use]
    pub fn has(&self, place: Point) -> bool {
        self.side(place) != Side::Outside
    }

    /// Whether all lines from point to point lie inside, without touching the border.
    pub(super) fn holds(&self, places: &[Point]) -> bool {
        let is_inside = |place: Point| self.side(place) == Side::Inside;
        places.iter().all(|place| is_inside(*place))
            && places.windows(2).all(|pair| {
                let &[from, to] = pair else { return true };
                let line = PathSegment::line(to);
                // A line can leave the region or touch its border only at these crossings.
                let cuts = self.crossings(from, &line, &Bounds::between(from, to));
                cuts.into_iter().all(|share| is_inside(line.at(from, share)))
            })
    }

    fn side(&self, place: Point) -> Side {
        let (mut is_border, mut is_inside) = (false, false);
        let is_left = |bounds: &Bounds| {
            bounds.least.x <= place.x && (bounds.least.y..=bounds.most.y).contains(&place.y)
        };
        self.tree.each(is_left, |edge| {
            let Some(edge) = self.edges.get(edge) else { return };
            is_border |= edge.distance(place) <= self.border_mm;
            // Half open, so that a corner counts once.
            if (edge.from.y > place.y) != (edge.to.y > place.y) {
                let turn = (edge.to - edge.from).cross(place - edge.from);
                is_inside ^= (turn < 0.0) == (edge.to.y > edge.from.y);
            }
        });
        match (is_border, is_inside) {
            (true, _) => Side::Border,
            (false, true) => Side::Inside,
            (false, false) => Side::Outside,
        }
    }

    /// The side on which a part of a segment lies that does not cross the border; `begin` and `end` are
    /// fractions of the segment.
    fn side_of(&self, from: Point, segment: &PathSegment, (begin, end): (f64, f64)) -> Side {
        // The middle decides, unless the segment touches the border there; then other points do. If all are
        // on the border, the segment runs along it. The fractions are irrational, so that they do not all
        // meet the teeth of one comb.
        const PLACES: [f64; 4] = [0.5, 0.309_016_994, 0.786_151_378, 0.135_335_283];
        let sides = PLACES.iter().map(|share| self.side(segment.at(from, begin + (end - begin) * share)));
        sides.into_iter().find(|side| *side != Side::Border).unwrap_or(Side::Border)
    }

    /// Reduces `shares`, the parts of a segment as pairs of fractions in rising order, to those on the side
    /// to keep. `bounds` is the box around the segment.
    pub(super) fn keep(
        &self,
        keep: Keep,
        from: Point,
        segment: &PathSegment,
        bounds: &Bounds,
        shares: &mut Vec<(f64, f64)>,
    ) {
        if !bounds.meets(&self.bounds()) {
            if keep == Keep::Inside {
                shares.clear();
            }
            return;
        }
        let mut cuts = self.crossings(from, segment, bounds);
        cuts.sort_unstable_by(f64::total_cmp);
        let length_mm = bounds.size_mm().0 + bounds.size_mm().1;
        let mut kept: Vec<(f64, f64)> = Vec::with_capacity(shares.len());
        for &(begin, end) in &*shares {
            let first = cuts.partition_point(|cut| *cut <= begin);
            let within = cuts.get(first..).unwrap_or_default().iter().copied().take_while(|cut| *cut < end);
            let mut at = begin;
            for next in within.chain([end]) {
                let part = (core::mem::replace(&mut at, next), next);
                let is_kept = match (self.side_of(from, segment, part), keep) {
                    (Side::Inside, Keep::Inside) | (Side::Border, Keep::Inside) => true,
                    (Side::Outside, Keep::Outside) => true,
                    // A corner that only touches the border does not lift the pen.
                    (Side::Border, Keep::Outside) => {
                        (part.1 - part.0) * length_mm <= DUST_MM && length_mm > 0.0
                    }
                    _ => false,
                };
                match kept.last_mut() {
                    Some(last) if is_kept && last.1 == part.0 => last.1 = part.1,
                    _ if is_kept => kept.push(part),
                    _ => {}
                }
            }
        }
        *shares = kept;
    }

    /// Fractions at which a segment may cross the border, in no order. Some are not crossings: the caller
    /// tests the parts between them.
    fn crossings(&self, from: Point, segment: &PathSegment, bounds: &Bounds) -> Vec<f64> {
        let mut cuts = Vec::new();
        self.tree.each(
            |edge| edge.meets(bounds) && is_near(edge, from, segment),
            |edge| {
                if let Some(edge) = self.edges.get(edge) {
                    crossings(from, segment, *edge, self.border_mm, &mut cuts);
                }
            },
        );
        cuts
    }
}

/// Whether a segment can reach into a box that its own box meets. A line cannot if the whole box lies on one
/// side of it.
pub(super) fn is_near(bounds: &Bounds, from: Point, segment: &PathSegment) -> bool {
    if segment.shape != Shape::Line {
        return true;
    }
    let (way, (width_mm, height_mm)) = (segment.to - from, bounds.size_mm());
    let reach = 0.5 * (libm::fabs(way.x) * height_mm + libm::fabs(way.y) * width_mm);
    libm::fabs(way.cross(bounds.centre() - from)) <= reach
}

/// Adds the fractions at which a segment crosses an edge or passes its ends.
fn crossings(from: Point, segment: &PathSegment, edge: Segment, border_mm: f64, cuts: &mut Vec<f64>) {
    let along = edge.to - edge.from;
    let Some(way) = along.normalized() else { return };
    // A crossing beside the end of an edge is one of the next edge too; rounding must not hide it from both.
    let (first, last) = (-border_mm, along.length() + border_mm);
    let mut cut = |share: f64| {
        let place = way.dot(segment.at(from, share) - edge.from);
        if (0.0..=1.0).contains(&share) && (first..=last).contains(&place) {
            cuts.push(share);
        }
    };
    let height = |place: Point| way.cross(place - edge.from);
    if segment.shape == Shape::Line {
        // Heights are linear along a line; without a difference it runs beside the edge, and the edges next
        // to this one cut it.
        let (begin, end) = (height(from), height(segment.to));
        if begin != end {
            cut(begin / (begin - end));
        }
        return;
    }
    // Between its turning points the height of a curve rises or falls, and is 0 once at most.
    let (mut turns, count) = turning_points(from, segment, &height);
    let Some(turns) = turns.get_mut(..count) else { return };
    turns.sort_unstable_by(f64::total_cmp);
    let mut begin = (0.0, height(from));
    for share in turns.iter().copied().chain([1.0]) {
        let end = (share, height(segment.at(from, share)));
        if (begin.1 < 0.0) != (end.1 < 0.0) {
            cut(zero(begin, end, |share| height(segment.at(from, share))));
        }
        begin = end;
    }
}

/// Most turning points of the height of a curve over a line: an arc of a whole turn has two, one that grows
/// as a spiral a third.
const MOST_TURNS: usize = 4;

/// Fractions between 0 and 1 at which the height of a curve has a maximum or minimum, and their number.
fn turning_points(
    from: Point,
    segment: &PathSegment,
    height: &impl Fn(Point) -> f64,
) -> ([f64; MOST_TURNS], usize) {
    let (mut turns, mut count) = ([0.0; MOST_TURNS], 0);
    let mut put = |share: f64| {
        if share > 0.0
            && share < 1.0
            && let Some(turn) = turns.get_mut(count)
        {
            *turn = share;
            count += 1;
        }
    };
    match segment.shape {
        Shape::Line => {}
        // At the radius r₀ (1 + g t) and the angle a = a₀ + s t from the upright, the height r cos a turns
        // where tan a = g / (s (1 + g t)); for a circle, g = 0, at each half turn. The right side changes
        // little with t, so it is inserted repeatedly until t stays (fixed-point iteration).
        Shape::Arc { centre, sweep_rad } if sweep_rad != 0.0 => {
            let (zero, out) = (height(centre), from - centre);
            let upright = height(centre + out) - zero;
            let sideways = height(centre + out.perpendicular()) - zero;
            let begin = libm::atan2(-sideways, upright);
            let radius_mm = out.length();
            let growth = if radius_mm > 0.0 { segment.to.distance(centre) / radius_mm - 1.0 } else { 0.0 };
            let (low, high) = (libm::fmin(begin, begin + sweep_rad), libm::fmax(begin, begin + sweep_rad));
            // The arc tangent is at most a quarter of a turn.
            let mut half_turns = libm::ceil(low / PI - 0.5);
            // A whole turn has three half turns in it at most, its ends included; an arc that is none must
            // end too.
            for _ in 0..4 {
                if half_turns > high / PI + 0.5 {
                    break;
                }
                let mut share = 0.0;
                for _ in 0..64 {
                    let angle = half_turns * PI + libm::atan(growth / (sweep_rad * (1.0 + growth * share)));
                    let next = ((angle - begin) / sweep_rad).clamp(0.0, 1.0);
                    if next == share {
                        break;
                    }
                    share = next;
                }
                put(share);
                half_turns += 1.0;
            }
        }
        Shape::Arc { .. } => {}
        // The derivative of a cubic is a quadratic.
        Shape::Cubic { handles: [a, b] } => {
            let [p, q, r, s] = [from, a, b, segment.to].map(height);
            let (u, v, w) = (q - p, r - q, s - r);
            roots(u - 2.0 * v + w, 2.0 * (v - u), u).for_each(put);
        }
    }
    (turns, count)
}

/// The zero of a monotonic function between two points at which it has different signs.
///
/// The chord between the two is followed to 0; an end that stays twice counts half (M. Dowell and P. Jarratt,
/// "A modified regula falsi method for computing the root of an equation", 1971, the Illinois method).
fn zero(mut begin: (f64, f64), mut end: (f64, f64), value: impl Fn(f64) -> f64) -> f64 {
    /// Most steps. A step usually gains at least one bit, and a share has 53.
    const MOST_STEPS: u32 = 64;
    /// The search ends within this distance, mm: a hundredth of the width of the border.
    const EXACT_MM: f64 = 0.01 * BORDER_MM;
    for _ in 0..MOST_STEPS {
        let chord = (begin.0 * end.1 - end.0 * begin.1) / (end.1 - begin.1);
        let (low, high) = (libm::fmin(begin.0, end.0), libm::fmax(begin.0, end.0));
        let share = if chord > low && chord < high { chord } else { 0.5 * (low + high) };
        let at = value(share);
        if share <= low || share >= high || libm::fabs(at) <= EXACT_MM {
            return share;
        }
        if (at < 0.0) == (end.1 < 0.0) {
            begin.1 *= 0.5;
        } else {
            begin = end;
        }
        end = (share, at);
    }
    end.0
}

/// A tolerance that curves can be divided by, mm.
fn tolerance(tolerance_mm: f64) -> f64 {
    libm::fmax(tolerance_mm, FINEST_MM)
}

/// The corners of a stroke whose ends are at most `tolerance_mm` apart; arcs and curves become lines within
/// that tolerance. `None` for an open stroke, one that is not finite, and one without an area.
pub(super) fn outline(stroke: &Stroke, tolerance_mm: f64) -> Option<Vec<Point>> {
    let tolerance_mm = tolerance(tolerance_mm);
    if !(stroke.from.distance(stroke.to()) <= tolerance_mm && stroke.is_sound()) {
        return None;
    }
    let places: Vec<Point> = stroke.places(tolerance_mm).collect();
    (places.len() > 2).then_some(places)
}
