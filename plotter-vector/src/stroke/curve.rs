//! [`Curve`]: vertices joined by straight lines, circular arcs and cubic curves; [`Arc`]: one such arc.

use crate::stroke::{Cubic, PxPoint, PxVec};
use core::f64::consts::{PI, TAU};

/// Farthest that chords lie from their arc or cubic curve wherever these are taken as chords without a
/// distance being asked for, px: a 25th of the usual tolerance.
pub(crate) const CHORD_ERROR_PX: f64 = 0.02;

/// Most chords of one arc or cubic curve.
const MAX_CHORDS: f64 = 65_536.0;

/// What the centres, the radii and the whole turn of a circle's arcs may be off, in parts of the radius.
const SAME_CIRCLE: f64 = 1e-6;

/// A pen stroke: vertices in order, each joined to the next by a straight line, a circular arc or a cubic
/// curve.
///
/// An arc is given as in DXF by its *bulge*, the tangent of a quarter of the angle that it spans: 0 is a
/// straight line, 1 half a circle. Positive bulges turn from x towards y, which on a picture, with y down, is
/// clockwise. A cubic curve is given by its two *handles*, as in SVG: see [`Cubic`].
///
/// ```
/// # use plotter_vector::{Curve, PxPoint};
/// // Up a quarter of a circle about (0, 0), then straight on.
/// let quarter = 2.0_f64.sqrt() - 1.0; // tan(90° / 4)
/// let vertices = vec![PxPoint::new(-2.0, 0.0), PxPoint::new(0.0, -2.0), PxPoint::new(3.0, -2.0)];
/// let curve = Curve { vertices, bulges: vec![quarter, 0.0, 0.0], ..Curve::default() };
/// assert!((curve.length_px() - (std::f64::consts::PI + 3.0)).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Curve {
    /// The vertices; one is a dot. The first one is repeated at the end of a closed stroke.
    pub vertices: Vec<PxPoint>,
    /// Bulge of the segment that begins at each vertex. What is missing, or is no number, is straight:
    /// without arcs it is empty.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub bulges: Vec<f64>,
    /// Handles of the segment that begins at each vertex, where it is a cubic curve: its bulge then says
    /// nothing. What is missing, or is no place, is none: without cubic curves it is empty.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub handles: Vec<Option<[PxPoint; 2]>>,
}

impl From<Vec<PxPoint>> for Curve {
    /// Straight lines.
    fn from(vertices: Vec<PxPoint>) -> Self {
        Self { vertices, ..Self::default() }
    }
}

impl From<Course<'_>> for Curve {
    fn from(Course { vertices, bulges, handles }: Course<'_>) -> Self {
        Self { vertices: vertices.to_vec(), bulges: bulges.to_vec(), handles: handles.to_vec() }
    }
}

impl Curve {
    /// Whether all of it is straight lines.
    #[must_use]
    pub fn is_straight(&self) -> bool {
        self.course().is_straight()
    }

    /// Whether any segment is an arc.
    #[must_use]
    pub fn has_arcs(&self) -> bool {
        self.course().segments().any(|segment| matches!(segment, Segment::Arc(_)))
    }

    /// Length, px.
    #[must_use]
    pub fn length_px(&self) -> f64 {
        self.course().length_px()
    }

    pub(crate) fn course(&self) -> Course<'_> {
        Course { vertices: &self.vertices, bulges: &self.bulges, handles: &self.handles }
    }

    /// The circle that it is: closed, all arcs of one circle, once round; its centre and radius, px.
    ///
    /// ```
    /// # use plotter_vector::{Curve, PxPoint};
    /// let (left, right) = (PxPoint::new(0.0, 5.0), PxPoint::new(10.0, 5.0));
    /// let round = Curve { vertices: vec![left, right, left], bulges: vec![1.0, 1.0, 0.0], ..Curve::default() };
    /// assert_eq!(round.circle(), Some((PxPoint::new(5.0, 5.0), 5.0)));
    /// assert_eq!(Curve { bulges: vec![1.0, -1.0, 0.0], ..round }.circle(), None); // there and back
    /// ```
    #[must_use]
    pub fn circle(&self) -> Option<(PxPoint, f64)> {
        self.course().circle()
    }

    /// The same way from its other end.
    pub fn reverse(&mut self) {
        // One for each segment, then they fit again.
        let segments = self.vertices.len().saturating_sub(1);
        self.vertices.reverse();
        turned(&mut self.bulges, segments, |bulge| *bulge = -*bulge);
        turned(&mut self.handles, segments, |handles| {
            if let Some([first, second]) = handles {
                core::mem::swap(first, second);
            }
        });
    }

    /// The vertices with arcs and cubic curves replaced by chords that lie no farther than `chord_error_px`
    /// from them.
    ///
    /// ```
    /// # use plotter_vector::{Curve, PxPoint};
    /// let vertices = vec![PxPoint::new(0.0, 0.0), PxPoint::new(8.0, 0.0)];
    /// let half = Curve { vertices, bulges: vec![1.0, 0.0], ..Curve::default() };
    /// // A chord of 60 degrees is 4 (1 - cos 30°) = 0.536 px off.
    /// assert_eq!(half.chords(0.54).len(), 4);
    /// ```
    #[must_use]
    pub fn chords(&self, chord_error_px: f64) -> Vec<PxPoint> {
        self.course().chords(chord_error_px)
    }

    /// Moves all of it down.
    pub(crate) fn move_down(&mut self, by_px: f64) {
        let handles = self.handles.iter_mut().flatten().flatten();
        self.vertices.iter_mut().chain(handles).for_each(|at| at.y += by_px);
    }

    /// Goes on with another one, from where this one ends; straight over a gap.
    pub(crate) fn append(&mut self, next: Self) {
        let Some(first) = next.vertices.first() else { return };
        // Ends in one place are one vertex.
        let shared = usize::from(self.vertices.last() == Some(first));
        let start = self.vertices.len() - shared;
        self.vertices.extend(next.vertices.into_iter().skip(shared));
        let count = self.vertices.len();
        appended(&mut self.bulges, start, next.bulges, count);
        appended(&mut self.handles, start, next.handles, count);
    }

    /// Lets a closed one begin and end at another vertex.
    pub(crate) fn begin_at(&mut self, start: usize) {
        let Some((last, ring)) = self.vertices.split_last_mut().filter(|(_, ring)| start < ring.len()) else {
            return;
        };
        ring.rotate_left(start);
        *last = ring.first().copied().unwrap_or(*last);
        let segments = ring.len();
        rotated(&mut self.bulges, segments, start);
        rotated(&mut self.handles, segments, start);
    }

    /// Lets a closed one begin and end within its first segment, a share of it on: the segment becomes two,
    /// the first and the last.
    pub(crate) fn begin_within(&mut self, share: f64) {
        let Some(whole) = self.course().segment(0).filter(|_| share > 0.0 && share < 1.0) else { return };
        let (at, segments) = (whole.at(share), self.vertices.len().saturating_sub(1));
        if let Some(first) = self.vertices.first_mut() {
            let was = core::mem::replace(first, at);
            if let Some(last) = self.vertices.last_mut() {
                *last = was;
            }
            self.vertices.push(at);
        }
        let [(first_bulge, first_handles), (last_bulge, last_handles)] = whole.halves(share);
        within(&mut self.bulges, segments, first_bulge, last_bulge);
        within(&mut self.handles, segments, first_handles, last_handles);
    }
}

/// What belongs to the segments, from their other end; `turn` makes one of them the other way round.
fn turned<T: Clone + Default>(of_pieces: &mut Vec<T>, segments: usize, turn: impl Fn(&mut T)) {
    if !of_pieces.is_empty() {
        of_pieces.resize(segments, T::default());
        of_pieces.reverse();
        of_pieces.iter_mut().for_each(turn);
        of_pieces.push(T::default());
    }
}

/// What belongs to the segments of a stroke, with that of one which begins at its vertex `start`; for `count`
/// vertices then.
fn appended<T: Clone + Default>(of_pieces: &mut Vec<T>, start: usize, next: Vec<T>, count: usize) {
    if !next.is_empty() || !of_pieces.is_empty() {
        of_pieces.resize(start, T::default());
        of_pieces.extend(next);
        of_pieces.resize(count, T::default());
    }
}

/// What belongs to the segments of a ring, from another vertex on.
fn rotated<T: Clone + Default>(of_pieces: &mut Vec<T>, segments: usize, start: usize) {
    if !of_pieces.is_empty() {
        of_pieces.resize(segments, T::default());
        of_pieces.rotate_left(start);
        of_pieces.push(T::default());
    }
}

/// What belongs to the segments of a ring, the first of which becomes the first and the last one.
fn within<T: Clone + Default>(of_pieces: &mut Vec<T>, segments: usize, first: T, last: T) {
    if let Some(slot) = of_pieces.first_mut() {
        *slot = first;
        of_pieces.resize(segments, T::default());
        of_pieces.extend([last, T::default()]);
    }
}

/// Whether a number makes an arc.
pub(crate) fn is_bulge(bulge: f64) -> bool {
    bulge != 0.0 && bulge.is_finite()
}

/// Whether two places are handles.
pub(crate) fn are_handles(handles: [PxPoint; 2]) -> bool {
    handles.iter().all(|at| at.is_finite())
}

/// A stroke in someone else's keeping: see [`Curve`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Course<'a> {
    pub(crate) vertices: &'a [PxPoint],
    pub(crate) bulges: &'a [f64],
    pub(crate) handles: &'a [Option<[PxPoint; 2]>],
}

/// What joins a vertex to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Segment {
    Line(PxPoint, PxPoint),
    Arc(Arc),
    Cubic(Cubic),
}

impl Course<'_> {
    pub(crate) fn is_straight(&self) -> bool {
        !self.bulges.iter().any(|bulge| is_bulge(*bulge))
            && !self.handles.iter().flatten().any(|handles| are_handles(*handles))
    }

    /// The segment that begins at a vertex; that which begins at the last one of a ring ends at its first
    /// one.
    pub(crate) fn segment(&self, index: usize) -> Option<Segment> {
        let from = *self.vertices.get(index)?;
        let to = *self.vertices.get(index + 1).or(self.vertices.first())?;
        let cubic =
            self.handles.get(index).copied().flatten().and_then(|handles| Cubic::new(from, handles, to));
        let arc = || self.bulges.get(index).and_then(|bulge| Arc::new(from, to, *bulge));
        Some(cubic.map(Segment::Cubic).or_else(|| arc().map(Segment::Arc)).unwrap_or(Segment::Line(from, to)))
    }

    /// No shorter than the segment that begins at a vertex, px, in fewer sums than its length: of a cubic
    /// curve the sides of its polygon; of an arc with the chord c and the bulge b its length is c (1 + b²)
    /// atan(b) / b.
    pub(crate) fn longest_px(&self, index: usize) -> f64 {
        let Some(from) = self.vertices.get(index) else { return 0.0 };
        let Some(to) = self.vertices.get(index + 1).or(self.vertices.first()) else { return 0.0 };
        if let Some([first, second]) = self.handles.get(index).copied().flatten() {
            return from.distance(first) + first.distance(second) + second.distance(*to);
        }
        let bulge = self.bulges.get(index).copied().filter(|bulge| is_bulge(*bulge)).unwrap_or(0.0);
        from.distance(*to) * (1.0 + bulge * bulge)
    }

    pub(crate) fn segments(self) -> impl Iterator<Item = Segment> {
        (1..self.vertices.len()).filter_map(move |next| self.segment(next - 1))
    }

    pub(crate) fn length_px(self) -> f64 {
        self.segments().map(|segment| segment.length_px()).sum()
    }

    pub(crate) fn chords(self, chord_error_px: f64) -> Vec<PxPoint> {
        let mut places: Vec<PxPoint> = self.vertices.first().copied().into_iter().collect();
        self.segments().for_each(|segment| places.extend(segment.chords(chord_error_px)));
        places
    }

    pub(crate) fn circle(self) -> Option<(PxPoint, f64)> {
        if self.vertices.len() < 3 || self.vertices.first() != self.vertices.last() {
            return None;
        }
        let Some(Segment::Arc(first)) = self.segment(0) else { return None };
        let off = SAME_CIRCLE * first.radius_px;
        let mut turn = 0.0;
        for segment in self.segments() {
            let Segment::Arc(arc) = segment else { return None };
            let same =
                arc.centre.distance(first.centre) <= off && (arc.radius_px - first.radius_px).abs() <= off;
            if !same || (arc.sweep_rad > 0.0) != (first.sweep_rad > 0.0) {
                return None;
            }
            turn += arc.sweep_rad.abs();
        }
        ((turn - TAU).abs() <= SAME_CIRCLE).then_some((first.centre, first.radius_px))
    }
}

impl Segment {
    pub(crate) fn to(&self) -> PxPoint {
        match self {
            Self::Line(_, to) => *to,
            Self::Arc(arc) => arc.to,
            Self::Cubic(cubic) => cubic.to,
        }
    }

    /// The place a share of the way along, 0 to 1: of a cubic curve, at that t.
    pub(crate) fn at(&self, share: f64) -> PxPoint {
        match self {
            Self::Line(from, to) => *from + (*to - *from) * share,
            Self::Arc(arc) => arc.at(share),
            Self::Cubic(cubic) => cubic.at(share),
        }
    }

    /// Bulge and handles of what comes after a share of it, and of what comes before.
    fn halves(&self, share: f64) -> [(f64, Option<[PxPoint; 2]>); 2] {
        match self {
            Self::Line(..) => [(0.0, None); 2],
            Self::Arc(arc) => [1.0 - share, share].map(|part| (libm::tan(0.25 * arc.sweep_rad * part), None)),
            Self::Cubic(cubic) => {
                let [before, after] = cubic.halves(share);
                [(0.0, Some(after)), (0.0, Some(before))]
            }
        }
    }

    /// No shorter than its part over so great a share of it, px.
    pub(crate) fn longest_part_px(&self, share: f64) -> f64 {
        share
            * match self {
                Self::Line(from, to) => from.distance(*to),
                Self::Arc(arc) => arc.length_px(),
                Self::Cubic(cubic) => cubic.greatest_speed(),
            }
    }

    fn length_px(&self) -> f64 {
        match self {
            Self::Line(from, to) => from.distance(*to),
            Self::Arc(arc) => arc.length_px(),
            Self::Cubic(cubic) => cubic.length_px(),
        }
    }

    /// The ends of its chords, which lie no farther than this from it; the last is its own.
    pub(crate) fn chords(self, chord_error_px: f64) -> impl Iterator<Item = PxPoint> {
        let count = match self {
            Self::Line(..) => 1,
            Self::Arc(arc) => arc.chords(chord_error_px),
            Self::Cubic(cubic) => cubic.chords(chord_error_px),
        };
        let inner = (1..count).map(move |chord| {
            let part = f64::from(chord) / f64::from(count);
            match self {
                Self::Line(from, _) => from,
                Self::Arc(arc) => arc.at(part),
                Self::Cubic(cubic) => cubic.at(part),
            }
        });
        inner.chain([self.to()])
    }

    /// The unit vector in which it begins (`false`) or ends (`true`); (0, 0) where it goes nowhere.
    pub(crate) fn heading(&self, end: bool) -> PxVec {
        match self {
            Self::Line(from, to) => unit(*from, *to),
            Self::Arc(arc) => {
                let across = unit(arc.centre, if end { arc.to } else { arc.from }).perpendicular();
                if arc.sweep_rad > 0.0 { across } else { -across }
            }
            Self::Cubic(cubic) => cubic.heading(if end { 1.0 } else { 0.0 }),
        }
    }
}

/// The unit vector from one place to another; (0, 0) where they are one.
pub(crate) fn unit(from: PxPoint, to: PxPoint) -> PxVec {
    let length = from.distance(to);
    if length > 0.0 { (to - from) / length } else { PxVec::default() }
}

/// A circular arc between two places.
///
/// With c the chord, b the bulge: the radius is c (1 + b²) / 4 |b|, and the centre lies c (1 − b²) / 4 b
/// beside the chord's middle, to the side to which a positive arc turns.
///
/// ```
/// # use plotter_vector::{PxPoint, stroke::Arc};
/// let half = Arc::new(PxPoint::new(0.0, 0.0), PxPoint::new(6.0, 0.0), 1.0).unwrap();
/// assert_eq!((half.centre, half.radius_px), (PxPoint::new(3.0, 0.0), 3.0));
/// let top = half.at(0.5); // clockwise as seen: over the top, where y is less
/// assert!(top.distance(PxPoint::new(3.0, -3.0)) < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Where it begins.
    pub from: PxPoint,
    /// Where it ends.
    pub to: PxPoint,
    /// Centre of its circle.
    pub centre: PxPoint,
    /// Radius of its circle, px.
    pub radius_px: f64,
    /// The angle that it spans, rad, between −2π and 2π: positive from x towards y, on a picture clockwise.
    pub sweep_rad: f64,
}

impl Arc {
    /// The arc between two places with this bulge; `None` for a straight line or a dot, or where a number
    /// overflows.
    #[must_use]
    pub fn new(from: PxPoint, to: PxPoint, bulge: f64) -> Option<Self> {
        let chord = from.distance(to);
        if !is_bulge(bulge) || chord == 0.0 {
            return None;
        }
        let radius_px = chord * (1.0 + bulge * bulge) / (4.0 * bulge.abs());
        let beside = (1.0 - bulge * bulge) / (4.0 * bulge);
        let PxVec { x, y } = to - from;
        let centre =
            PxPoint::new(f64::midpoint(from.x, to.x) - y * beside, f64::midpoint(from.y, to.y) + x * beside);
        let arc = Self { from, to, centre, radius_px, sweep_rad: 4.0 * libm::atan(bulge) };
        (radius_px.is_finite() && centre.is_finite()).then_some(arc)
    }

    /// Length, px.
    #[must_use]
    pub fn length_px(&self) -> f64 {
        self.radius_px * self.sweep_rad.abs()
    }

    /// The place a part of the way along, 0 to 1.
    #[must_use]
    pub fn at(&self, part: f64) -> PxPoint {
        let PxVec { x, y } = self.from - self.centre;
        let (sin, cos) = libm::sincos(self.sweep_rad * part);
        PxPoint::new(self.centre.x + x * cos - y * sin, self.centre.y + x * sin + y * cos)
    }

    /// Distance of a place from it, px.
    ///
    /// ```
    /// # use plotter_vector::{PxPoint, stroke::Arc};
    /// let half = Arc::new(PxPoint::new(0.0, 0.0), PxPoint::new(6.0, 0.0), 1.0).unwrap(); // over the top
    /// let distance = |x, y| half.distance(PxPoint::new(x, y));
    /// assert_eq!([distance(3.0, -1.0), distance(3.0, 4.0), distance(6.0, 2.0)], [2.0, 5.0, 2.0]);
    /// ```
    #[must_use]
    pub fn distance(&self, at: PxPoint) -> f64 {
        let (from, to, out) = (self.from - self.centre, self.to - self.centre, at - self.centre);
        let turn = if self.sweep_rad > 0.0 { 1.0 } else { -1.0 };
        let after_from = turn * from.cross(out) >= 0.0;
        let before_to = turn * out.cross(to) >= 0.0;
        let beside =
            if self.sweep_rad.abs() <= PI { after_from && before_to } else { after_from || before_to };
        if beside {
            (at.distance(self.centre) - self.radius_px).abs()
        } else {
            at.distance(self.from).min(at.distance(self.to))
        }
    }

    /// Into how many equal chords it has to be divided so that they lie no farther than this from it. A chord
    /// of the angle a is r (1 − cos(a / 2)) off.
    pub(crate) fn chords(&self, chord_error_px: f64) -> u32 {
        // Never more than a quarter turn: an arc is no chord.
        let half = libm::acos(1.0 - (chord_error_px / self.radius_px).max(0.0)).min(PI / 4.0);
        let count = libm::ceil(self.sweep_rad.abs() / (2.0 * half) - 1e-9);
        whole_chords(count)
    }
}

/// A number of chords, 1 to [`MAX_CHORDS`]; of what is no number, for an error that is none, 1.
pub(crate) fn whole_chords(count: f64) -> u32 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 1 to 65536; NaN is 0")]
    let count = count.clamp(1.0, MAX_CHORDS) as u32;
    count.max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64) -> PxPoint {
        PxPoint::new(x, y)
    }

    /// A stroke with an arc, a line and an arc.
    fn stroke() -> Curve {
        Curve {
            vertices: vec![at(0.0, 0.0), at(4.0, 0.0), at(9.0, 1.0), at(9.0, 7.0)],
            bulges: vec![0.5, 0.0, -0.3, 0.0],
            ..Curve::default()
        }
    }

    /// A stroke with a cubic curve and an arc.
    fn bent() -> Curve {
        Curve {
            vertices: vec![at(0.0, 0.0), at(4.0, 0.0), at(9.0, 1.0)],
            bulges: vec![0.0, 0.5],
            handles: vec![Some([at(1.0, 2.0), at(4.0, -3.0)])],
        }
    }

    #[test]
    fn backwards_it_is_the_same_way() {
        let mut back = stroke();
        back.reverse();
        assert_eq!(back.bulges, [0.3, -0.0, -0.5, 0.0]);
        let (one, mut other) = (stroke().chords(0.01), back.chords(0.01));
        other.reverse();
        assert_eq!(one.len(), other.len());
        assert!(one.iter().zip(&other).all(|(a, b)| a.distance(*b) < 1e-12));
        back.reverse();
        assert_eq!(back, stroke());
    }

    #[test]
    fn no_segment_is_longer_than_its_bound() {
        for curve in [stroke(), bent(), Curve { bulges: vec![7.0, -0.1, 1.0], ..stroke() }] {
            let course = curve.course();
            for (index, segment) in course.segments().enumerate() {
                let (px, most_px) = (segment.length_px(), course.longest_px(index));
                assert!(px <= most_px + 1e-9 && most_px < 60.0 * px, "{segment:?}: {px} px of {most_px} px");
            }
        }
    }

    #[test]
    fn cubic_curves_go_along_with_their_vertices() {
        let mut back = bent();
        back.reverse();
        assert_eq!(back.handles, [None, Some([at(4.0, -3.0), at(1.0, 2.0)]), None]);
        let (one, mut other) = (bent().chords(0.01), back.chords(0.01));
        other.reverse();
        assert!(one.len() == other.len() && one.iter().zip(&other).all(|(a, b)| a.distance(*b) < 1e-12));
        let mut line = Curve::from(vec![at(-5.0, 0.0), at(0.0, 0.0)]);
        line.append(bent());
        assert_eq!(line.handles, [None, bent().handles[0], None, None]);
        assert!((line.length_px() - 5.0 - bent().length_px()).abs() < 1e-9);
        let mut ring = bent();
        ring.vertices.push(at(0.0, 0.0));
        ring.begin_at(2);
        assert_eq!(ring.handles, [None, bent().handles[0], None, None]);
        ring.move_down(2.0);
        assert_eq!(ring.handles[1], Some([at(1.0, 4.0), at(4.0, -1.0)]));
    }

    #[test]
    fn handles_that_are_no_places_make_no_curve() {
        let bad = Curve { handles: vec![Some([at(f64::NAN, 0.0), at(1.0, 1.0)])], ..bent() };
        assert!(!bad.is_straight() && bad.has_arcs());
        assert_eq!(bad.course().segment(0), Some(Segment::Line(at(0.0, 0.0), at(4.0, 0.0))));
        assert!(Curve { bulges: Vec::new(), ..bad }.is_straight());
    }

    #[test]
    fn a_closed_one_begins_anywhere_with_its_bulges() {
        let mut ring = Curve {
            vertices: [0.0, 1.0, 2.0, 0.0].map(|x| at(x, x * x)).to_vec(),
            bulges: vec![0.1, 0.2, 0.3],
            ..Curve::default()
        };
        ring.begin_at(1);
        assert_eq!(ring.vertices, [1.0, 2.0, 0.0, 1.0].map(|x| at(x, x * x)));
        assert_eq!(ring.bulges, [0.2, 0.3, 0.1, 0.0]);
    }

    #[test]
    fn what_is_appended_keeps_its_bulges() {
        let mut line = Curve::from(vec![at(-5.0, 0.0), at(0.0, 0.0)]);
        line.append(stroke());
        assert_eq!((line.vertices.len(), line.bulges.as_slice()), (5, &[0.0, 0.5, 0.0, -0.3, 0.0][..]));
        line.append(Curve::from(vec![at(20.0, 0.0)])); // across a gap
        assert_eq!(line.bulges, [0.0, 0.5, 0.0, -0.3, 0.0, 0.0]);
        let mut straight = Curve::from(vec![at(0.0, 0.0)]);
        straight.append(Curve::from(vec![at(0.0, 0.0), at(1.0, 0.0)]));
        assert_eq!(straight, Curve::from(vec![at(0.0, 0.0), at(1.0, 0.0)]));
    }

    #[test]
    fn chords_stay_as_near_as_asked() {
        for bulge in [0.01, 0.4, 1.0, 2.4, -3.0] {
            let arc = Arc::new(at(3.0, 4.0), at(50.0, 20.0), bulge).unwrap();
            assert!((arc.at(1.0).distance(arc.to)) < 1e-9 * arc.radius_px);
            for error in [0.5, 0.02] {
                let count = arc.chords(error);
                let sagitta =
                    |count: u32| arc.radius_px * (1.0 - libm::cos(arc.sweep_rad / f64::from(2 * count)));
                assert!(sagitta(count) <= error + 1e-9);
                assert!(count == 1 || sagitta(count - 1) > error, "one chord too many");
            }
        }
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn the_distance_is_that_of_the_nearest_place_of_many() {
        for bulge in [0.1, 0.6, 1.0, 2.0, -0.3, -3.5] {
            let arc = Arc::new(at(3.0, 4.0), at(20.0, 9.0), bulge).unwrap();
            for place in
                (0..40).flat_map(|x| (0..40).map(move |y| at(f64::from(x) - 8.0, f64::from(y) - 12.0)))
            {
                let sampled = (0..=4000).map(|i| arc.at(f64::from(i) / 4000.0).distance(place));
                let nearest = sampled.fold(f64::INFINITY, f64::min);
                assert!((arc.distance(place) - nearest).abs() < 0.02, "{bulge} {place:?}");
            }
        }
    }

    #[test]
    fn what_is_no_arc_is_a_line() {
        let (a, b) = (at(0.0, 0.0), at(1.0, 0.0));
        for bulge in [0.0, f64::NAN, f64::INFINITY, 1e300] {
            assert_eq!(Arc::new(a, b, bulge), None);
        }
        assert_eq!(Arc::new(a, a, 1.0), None);
        assert_eq!(
            Curve { vertices: vec![a, b], bulges: vec![f64::NAN], ..Curve::default() }.chords(0.1),
            [a, b]
        );
    }

    #[test]
    fn half_a_circle_begins_and_ends_across_its_chord() {
        let half = Segment::Arc(Arc::new(at(0.0, 0.0), at(2.0, 0.0), 1.0).unwrap());
        assert_eq!([half.heading(false), half.heading(true)], [PxVec::new(0.0, -1.0), PxVec::new(0.0, 1.0)]);
        let other = Segment::Arc(Arc::new(at(0.0, 0.0), at(2.0, 0.0), -1.0).unwrap());
        assert_eq!(
            [other.heading(false), other.heading(true)],
            [PxVec::new(0.0, 1.0), PxVec::new(0.0, -1.0)]
        );
    }
}
