//! [`Mark`]: a stroke as a part of a letter; [`Placed`]: where it lies along a line of lettering.

use crate::order::plan::Stroke;
use crate::stroke::PxPoint;

/// Greatest ratio of the sizes of two strokes that are neighbours in a line.
pub(super) const LIKE_SIZE: f64 = 2.0;

/// Deviation from straight, in parts of a stroke's size, from which on it is bent.
const BENT: f64 = 0.1;

/// A stroke that may be of a letter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mark<'a> {
    pub(super) stroke: usize,
    pub(super) pen: u8,
    vertices: &'a [PxPoint],
    least: PxPoint,
    most: PxPoint,
    pub(super) bent: bool,
}

impl<'a> Mark<'a> {
    pub(super) fn new(index: usize, stroke: &Stroke<'a>) -> Option<Self> {
        let (first, last) = (stroke.vertices().first()?, stroke.vertices().last()?);
        let (mut least, mut most) = (*first, *first);
        // Twice the area of the triangle over the chord, for each vertex.
        let mut deviation: f64 = 0.0;
        for at in stroke.vertices() {
            least = PxPoint::new(least.x.min(at.x), least.y.min(at.y));
            most = PxPoint::new(most.x.max(at.x), most.y.max(at.y));
            let area = (last.x - first.x) * (at.y - first.y) - (last.y - first.y) * (at.x - first.x);
            deviation = deviation.max(area.abs());
        }
        let mark =
            Self { stroke: index, pen: stroke.pen, vertices: stroke.vertices(), least, most, bent: false };
        let chord = first.distance(*last);
        let bent = stroke.closed || deviation > BENT * mark.size() * chord || chord < mark.size() / 2.0;
        mark.size().is_finite().then_some(Self { bent, ..mark })
    }

    pub(super) fn size(&self) -> f64 {
        (self.most.x - self.least.x).max(self.most.y - self.least.y)
    }

    pub(super) fn middle(&self) -> PxPoint {
        PxPoint::new((self.least.x + self.most.x) / 2.0, (self.least.y + self.most.y) / 2.0)
    }

    pub(super) fn is_neighbour(&self, other: &Self, max_gap: f64) -> bool {
        let gap_x = (self.least.x - other.most.x).max(other.least.x - self.most.x).max(0.0);
        let gap_y = (self.least.y - other.most.y).max(other.least.y - self.most.y).max(0.0);
        let (small, large) = (self.size().min(other.size()), self.size().max(other.size()));
        self.stroke != other.stroke
            && self.pen == other.pen
            && large <= LIKE_SIZE * small
            && libm::hypot(gap_x, gap_y) <= max_gap * small
    }
}

/// Where a stroke lies along and across the direction of reading, px; across grows downwards.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed<'a> {
    pub(super) mark: &'a Mark<'a>,
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
}

impl<'a> Placed<'a> {
    pub(super) fn new(mark: &'a Mark<'a>, angle: f64) -> Self {
        let (cos, sin) = (libm::cos(angle), libm::sin(angle));
        let range = |along: &dyn Fn(&PxPoint) -> f64| {
            mark.vertices
                .iter()
                .map(along)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
        };
        let (left, right) = range(&|at| at.x * cos + at.y * sin);
        let (top, bottom) = range(&|at| at.y * cos - at.x * sin);
        Self { mark, left, right, top, bottom }
    }

    /// Space between two along the line; negative where they overlap.
    pub(super) fn gap(&self, other: &Self) -> f64 {
        (self.left - other.right).max(other.left - self.right)
    }
}
