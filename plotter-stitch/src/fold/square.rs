//! [`EmptySquare`]: a place on the diagonal where nothing is drawn.

use super::FoldDirection;
use alloc::vec::Vec;
use plotter_motion::{PlotOp, Point, Segment, Vec2, toolpath::chords};

/// Arcs are looked at as chords that are no farther from them, mm; the square is looked for with this to
/// spare.
const CHORD_MM: f64 = 0.05;

/// Half of the published square's side, mm.
const HALF_MM: f64 = 10.0;

/// Half of the pen's line, mm: what a stroke covers beside its middle.
const HALF_LINE_MM: f64 = 0.25;

/// Looks for a square of 20 x 20 mm in which a frame draws nothing, with its middle on the diagonal along
/// which a fold would lie.
///
/// Each line keeps the middle of the square out of an interval of the diagonal: that is computed exactly, so
/// that a square is found wherever there is one. Only the intervals are kept.
///
/// ```
/// use plotter_motion::{PlotOp, Point};
/// use plotter_stitch::fold::{EmptySquare, FoldDirection};
///
/// // A line right of the middle of the frame: the square beside it touches it with the pen's half width between.
/// let mut search = EmptySquare::new(FoldDirection::Rising, 1000.0, 1000.0);
/// search.push(PlotOp::Travel { to: Point::new(505.0, 0.0) });
/// search.push(PlotOp::Draw { to: Point::new(505.0, 1000.0), feed_mm_s: None });
/// let middle = search.find().unwrap();
/// assert!((middle.x - 494.7).abs() < 1e-9 && (middle.y - 494.7).abs() < 1e-9); // 505 - 10 - 0.25 - 0.05
/// ```
#[derive(Clone, Debug)]
pub struct EmptySquare {
    begin: Point,
    along: Vec2,
    /// From where to where the middle may lie, mm along the diagonal.
    range_mm: (f64, f64),
    /// Where it may not: in order, apart from one another.
    taken: Vec<(f64, f64)>,
    at: Point,
}

impl EmptySquare {
    /// For a frame of that size, both finite and above 0.
    #[must_use]
    pub fn new(direction: FoldDirection, width_mm: f64, length_mm: f64) -> Self {
        let begin = match direction {
            FoldDirection::Rising => Point::ORIGIN,
            FoldDirection::Falling => Point::new(0.0, length_mm),
        };
        let along = direction.along(width_mm, length_mm);
        let diagonal_mm = libm::hypot(width_mm, length_mm);
        // The square lies within the frame on all sides.
        let margin_mm = HALF_MM / libm::fabs(along.x).min(libm::fabs(along.y)).max(f64::MIN_POSITIVE);
        let range_mm = (margin_mm, diagonal_mm - margin_mm);
        Self { begin, along, range_mm, taken: Vec::new(), at: Point::ORIGIN }
    }

    /// Takes the next operation of the frame, in its coordinates.
    pub fn push(&mut self, op: PlotOp) {
        match op {
            PlotOp::Draw { to, .. } => self.line(Segment::new(self.at, to)),
            PlotOp::DrawArc { .. } => {
                let mut from = self.at;
                for to in
                    chords([PlotOp::Travel { to: self.at }, op], CHORD_MM).skip(1).filter_map(PlotOp::target)
                {
                    self.line(Segment::new(from, to));
                    from = to;
                }
            }
            _ => {}
        }
        self.at = op.target().unwrap_or(self.at);
    }

    /// The middle of an empty square, as near to the middle of the diagonal as there is one; `None` if there
    /// is none. That is an answer too: no probe can be drawn on this frame, and somebody has to look.
    #[must_use]
    pub fn find(&self) -> Option<Point> {
        let (first, last) = self.range_mm;
        let middle_mm = 0.5 * (first + last);
        let mut best: Option<f64> = None;
        let mut free_from = first;
        let end = (f64::INFINITY, f64::INFINITY);
        for (from, to) in self.taken.iter().copied().chain([end]) {
            let free_to = from.min(last);
            if free_from < free_to {
                let nearest = middle_mm.clamp(free_from, free_to);
                if best.is_none_or(|best| libm::fabs(nearest - middle_mm) < libm::fabs(best - middle_mm)) {
                    best = Some(nearest);
                }
            }
            free_from = free_from.max(to);
        }
        best.map(|way_mm| self.begin + self.along * way_mm)
    }

    /// Keeps the square off a line.
    fn line(&mut self, line: Segment) {
        let reach_mm = HALF_MM + HALF_LINE_MM + CHORD_MM;
        let (from, to) = (line.from - self.begin, line.to - self.begin);
        // Both ends far on the same side of the diagonal: most lines are.
        let sides = [self.along.cross(from), self.along.cross(to)];
        let far_mm = reach_mm * (libm::fabs(self.along.x) + libm::fabs(self.along.y));
        if sides.iter().all(|side| *side > far_mm) || sides.iter().all(|side| *side < -far_mm) {
            return;
        }
        if let Some(interval) = taken_interval(self.along, from, to, reach_mm, self.range_mm) {
            self.take(interval);
        }
    }

    fn take(&mut self, (mut from, mut to): (f64, f64)) {
        let first = self.taken.partition_point(|taken| taken.1 < from);
        let last = self.taken.partition_point(|taken| taken.0 <= to);
        for taken in self.taken.get(first..last).unwrap_or_default() {
            (from, to) = (from.min(taken.0), to.max(taken.1));
        }
        if first <= last {
            self.taken.splice(first..last, [(from, to)]);
        }
    }
}

/// For which middles `along · s` the square around it, `reach` to each side, meets the line from `a` to `b`:
/// an interval of s, since both are convex.
///
/// In the plane of s and the parameter t of the line that is a polygon: the rectangle of all (s, t), cut by
/// the four sides of the square (I. E. Sutherland and G. W. Hodgman, "Reentrant polygon clipping", 1974).
fn taken_interval(along: Vec2, a: Vec2, b: Vec2, reach_mm: f64, range_mm: (f64, f64)) -> Option<(f64, f64)> {
    let way = b - a;
    let mut polygon = Polygon::rectangle(range_mm);
    // c + cs · s + ct · t >= 0
    for (c, cs, ct) in [
        (reach_mm + a.x, -along.x, way.x),
        (reach_mm - a.x, along.x, -way.x),
        (reach_mm + a.y, -along.y, way.y),
        (reach_mm - a.y, along.y, -way.y),
    ] {
        polygon = polygon.cut(|(s, t)| c + cs * s + ct * t);
    }
    let corners = polygon.corners();
    let least = corners.iter().map(|corner| corner.0).fold(f64::INFINITY, f64::min);
    let most = corners.iter().map(|corner| corner.0).fold(f64::NEG_INFINITY, f64::max);
    (least <= most).then_some((least, most))
}

/// A convex polygon: four corners, and one more for each of four cuts.
#[derive(Clone, Copy, Debug)]
struct Polygon {
    at: [(f64, f64); 12],
    len: usize,
}

impl Polygon {
    const EMPTY: Self = Self { at: [(0.0, 0.0); 12], len: 0 };

    fn rectangle((from, to): (f64, f64)) -> Self {
        let mut rectangle = Self::EMPTY;
        [(from, 0.0), (to, 0.0), (to, 1.0), (from, 1.0)]
            .into_iter()
            .for_each(|corner| rectangle.push(corner));
        rectangle
    }

    fn corners(&self) -> &[(f64, f64)] {
        self.at.get(..self.len).unwrap_or_default()
    }

    fn push(&mut self, corner: (f64, f64)) {
        if let Some(slot) = self.at.get_mut(self.len) {
            *slot = corner;
            self.len += 1;
        }
    }

    /// What is left where `inside` is not negative.
    fn cut(&self, inside: impl Fn((f64, f64)) -> f64) -> Self {
        let mut left = Self::EMPTY;
        let corners = self.corners();
        let Some(mut before) = corners.last().copied() else { return left };
        for &corner in corners {
            let (was, is) = (inside(before), inside(corner));
            if (was < 0.0) != (is < 0.0) {
                let share = was / (was - is);
                left.push((
                    before.0 + (corner.0 - before.0) * share,
                    before.1 + (corner.1 - before.1) * share,
                ));
            }
            if is >= 0.0 {
                left.push(corner);
            }
            before = corner;
        }
        left
    }
}
