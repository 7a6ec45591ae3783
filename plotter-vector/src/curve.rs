//! [`Curve`]: vertices joined by straight lines and circular arcs; [`Arc`]: one such arc.

use crate::PxPoint;
use core::f64::consts::{PI, TAU};

/// Farthest that chords lie from their arc wherever arcs are taken as chords without a distance being asked for, px: a
/// 25th of the usual tolerance.
pub(crate) const CHORD_ERROR_PX: f64 = 0.02;

/// Most chords of one arc.
const MAX_CHORDS: f64 = 65_536.0;

/// What the centres, the radii and the whole turn of a circle's arcs may be off, in parts of the radius.
const SAME_CIRCLE: f64 = 1e-6;

/// A pen stroke: vertices in order, each joined to the next by a straight line or a circular arc.
///
/// An arc is given as in DXF by its *bulge*, the tangent of a quarter of the angle that it spans: 0 is a straight line, 1
/// half a circle. Positive bulges turn from x towards y, which on a picture, with y down, is clockwise.
///
/// ```
/// # use plotter_vector::{Curve, PxPoint};
/// // Up a quarter of a circle about (0, 0), then straight on.
/// let quarter = 2.0_f64.sqrt() - 1.0; // tan(90° / 4)
/// let vertices = vec![PxPoint::new(-2.0, 0.0), PxPoint::new(0.0, -2.0), PxPoint::new(3.0, -2.0)];
/// let curve = Curve { vertices, bulges: vec![quarter, 0.0, 0.0] };
/// assert!((curve.length_px() - (std::f64::consts::PI + 3.0)).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Curve {
    /// The vertices; one is a dot. The first one is repeated at the end of a closed stroke.
    pub vertices: Vec<PxPoint>,
    /// Bulge of the piece that begins at each vertex. What is missing, or is no number, is straight: without arcs it is
    /// empty.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub bulges: Vec<f64>,
}

impl From<Vec<PxPoint>> for Curve {
    /// Straight lines.
    fn from(vertices: Vec<PxPoint>) -> Self {
        Self { vertices, bulges: Vec::new() }
    }
}

impl Curve {
    /// Whether any piece is an arc.
    #[must_use]
    pub fn has_arcs(&self) -> bool {
        self.bulges.iter().any(|bulge| is_bulge(*bulge))
    }

    /// Length, px.
    #[must_use]
    pub fn length_px(&self) -> f64 {
        length_px(&self.vertices, &self.bulges)
    }

    /// The circle that it is: closed, all arcs of one circle, once round; its centre and radius, px.
    ///
    /// ```
    /// # use plotter_vector::{Curve, PxPoint};
    /// let (left, right) = (PxPoint::new(0.0, 5.0), PxPoint::new(10.0, 5.0));
    /// let round = Curve { vertices: vec![left, right, left], bulges: vec![1.0, 1.0, 0.0] };
    /// assert_eq!(round.circle(), Some((PxPoint::new(5.0, 5.0), 5.0)));
    /// assert_eq!(Curve { bulges: vec![1.0, -1.0, 0.0], ..round }.circle(), None); // there and back
    /// ```
    #[must_use]
    pub fn circle(&self) -> Option<(PxPoint, f64)> {
        circle(&self.vertices, &self.bulges)
    }

    /// The same way from its other end.
    pub fn reverse(&mut self) {
        self.vertices.reverse();
        if !self.bulges.is_empty() {
            // One for each piece, then they fit again.
            self.bulges.resize(self.vertices.len().saturating_sub(1), 0.0);
            self.bulges.reverse();
            self.bulges.iter_mut().for_each(|bulge| *bulge = -*bulge);
            self.bulges.push(0.0);
        }
    }

    /// The vertices with arcs replaced by chords that lie no farther than `chord_error_px` from them.
    ///
    /// ```
    /// # use plotter_vector::{Curve, PxPoint};
    /// let half = Curve { vertices: vec![PxPoint::new(0.0, 0.0), PxPoint::new(8.0, 0.0)], bulges: vec![1.0, 0.0] };
    /// // A chord of 60 degrees is 4 (1 - cos 30°) = 0.536 px off.
    /// assert_eq!(half.chords(0.54).len(), 4);
    /// ```
    #[must_use]
    pub fn chords(&self, chord_error_px: f64) -> Vec<PxPoint> {
        chords(&self.vertices, &self.bulges, chord_error_px)
    }

    /// Goes on with another one, from where this one ends; straight over a gap.
    pub(crate) fn append(&mut self, next: Self) {
        let Some(first) = next.vertices.first() else { return };
        // Ends in one place are one vertex.
        let shared = usize::from(self.vertices.last() == Some(first));
        if !next.bulges.is_empty() || !self.bulges.is_empty() {
            self.bulges.resize(self.vertices.len() - shared, 0.0);
            self.bulges.extend(next.bulges);
        }
        self.vertices.extend(next.vertices.into_iter().skip(shared));
        if !self.bulges.is_empty() {
            self.bulges.resize(self.vertices.len(), 0.0);
        }
    }

    /// Lets a closed one begin and end at another vertex.
    pub(crate) fn begin_at(&mut self, start: usize) {
        let Some((last, ring)) = self.vertices.split_last_mut().filter(|(_, ring)| start < ring.len()) else {
            return;
        };
        ring.rotate_left(start);
        *last = ring.first().copied().unwrap_or(*last);
        let pieces = ring.len();
        if !self.bulges.is_empty() {
            self.bulges.resize(pieces, 0.0);
            self.bulges.rotate_left(start);
            self.bulges.push(0.0);
        }
    }
}

/// Whether a number makes an arc.
pub(crate) fn is_bulge(bulge: f64) -> bool {
    bulge != 0.0 && bulge.is_finite()
}

/// The pieces of a stroke: from, to, and the arc between where it is one.
pub(crate) fn pieces<'a>(
    vertices: &'a [PxPoint],
    bulges: &'a [f64],
) -> impl Iterator<Item = (PxPoint, PxPoint, Option<Arc>)> + 'a {
    vertices.iter().zip(vertices.iter().skip(1)).enumerate().map(|(index, (from, to))| {
        let arc = bulges.get(index).and_then(|bulge| Arc::new(*from, *to, *bulge));
        (*from, *to, arc)
    })
}

pub(crate) fn length_px(vertices: &[PxPoint], bulges: &[f64]) -> f64 {
    pieces(vertices, bulges).map(|(from, to, arc)| arc.map_or(from.distance(to), |arc| arc.length_px())).sum()
}

pub(crate) fn chords(vertices: &[PxPoint], bulges: &[f64], chord_error_px: f64) -> Vec<PxPoint> {
    let mut places: Vec<PxPoint> = vertices.first().copied().into_iter().collect();
    for (_, to, arc) in pieces(vertices, bulges) {
        if let Some(arc) = arc {
            let count = arc.chords(chord_error_px);
            places.extend((1..count).map(|chord| arc.at(f64::from(chord) / f64::from(count))));
        }
        places.push(to);
    }
    places
}

pub(crate) fn circle(vertices: &[PxPoint], bulges: &[f64]) -> Option<(PxPoint, f64)> {
    if vertices.len() < 3 || vertices.first() != vertices.last() {
        return None;
    }
    let first = Arc::new(*vertices.first()?, *vertices.get(1)?, *bulges.first()?)?;
    let off = SAME_CIRCLE * first.radius_px;
    let mut turn = 0.0;
    for (_, _, arc) in pieces(vertices, bulges) {
        let arc = arc?;
        let same = arc.centre.distance(first.centre) <= off && (arc.radius_px - first.radius_px).abs() <= off;
        if !same || (arc.sweep_rad > 0.0) != (first.sweep_rad > 0.0) {
            return None;
        }
        turn += arc.sweep_rad.abs();
    }
    ((turn - TAU).abs() <= SAME_CIRCLE).then_some((first.centre, first.radius_px))
}

/// A circular arc between two places.
///
/// With c the chord, b the bulge: the radius is c (1 + b²) / 4 |b|, and the centre lies c (1 − b²) / 4 b beside the
/// chord's middle, to the side to which a positive arc turns.
///
/// ```
/// # use plotter_vector::{Arc, PxPoint};
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
    /// The arc between two places with this bulge; `None` for a straight line or a dot, or where a number overflows.
    #[must_use]
    pub fn new(from: PxPoint, to: PxPoint, bulge: f64) -> Option<Self> {
        let chord = from.distance(to);
        if !is_bulge(bulge) || chord == 0.0 {
            return None;
        }
        let radius_px = chord * (1.0 + bulge * bulge) / (4.0 * bulge.abs());
        let beside = (1.0 - bulge * bulge) / (4.0 * bulge);
        let (x, y) = to.minus(from);
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
        let (x, y) = self.from.minus(self.centre);
        let (sin, cos) = libm::sincos(self.sweep_rad * part);
        PxPoint::new(self.centre.x + x * cos - y * sin, self.centre.y + x * sin + y * cos)
    }

    /// Distance of a place from it, px.
    ///
    /// ```
    /// # use plotter_vector::{Arc, PxPoint};
    /// let half = Arc::new(PxPoint::new(0.0, 0.0), PxPoint::new(6.0, 0.0), 1.0).unwrap(); // over the top
    /// let distance = |x, y| half.distance(PxPoint::new(x, y));
    /// assert_eq!([distance(3.0, -1.0), distance(3.0, 4.0), distance(6.0, 2.0)], [2.0, 5.0, 2.0]);
    /// ```
    #[must_use]
    pub fn distance(&self, at: PxPoint) -> f64 {
        let (from, to, out) =
            (self.from.minus(self.centre), self.to.minus(self.centre), at.minus(self.centre));
        let turn = if self.sweep_rad > 0.0 { 1.0 } else { -1.0 };
        let after_from = turn * (from.0 * out.1 - from.1 * out.0) >= 0.0;
        let before_to = turn * (out.0 * to.1 - out.1 * to.0) >= 0.0;
        let beside =
            if self.sweep_rad.abs() <= PI { after_from && before_to } else { after_from || before_to };
        if beside {
            (at.distance(self.centre) - self.radius_px).abs()
        } else {
            at.distance(self.from).min(at.distance(self.to))
        }
    }

    /// Into how many equal chords it has to be divided so that they lie no farther than this from it. A chord of the
    /// angle a is r (1 − cos(a / 2)) off.
    pub(crate) fn chords(&self, chord_error_px: f64) -> u32 {
        // Never more than a quarter turn: an arc is no chord.
        let half = libm::acos(1.0 - (chord_error_px / self.radius_px).max(0.0)).min(PI / 4.0);
        let count = libm::ceil(self.sweep_rad.abs() / (2.0 * half) - 1e-9);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number from 1 to 65536; NaN, of an error that is none, is 0"
        )]
        let count = count.clamp(1.0, MAX_CHORDS) as u32;
        count.max(1)
    }
}

/// A unit vector at the vertex turned by so many times half the angle that an arc spans: from the direction of the chord
/// to that of the arc at its end (`1.0`) or its beginning (`-1.0`).
pub(crate) fn tangent(chord: (f64, f64), bulge: f64, end: f64) -> (f64, f64) {
    if !is_bulge(bulge) {
        return chord;
    }
    // Of twice the angle whose tangent is the bulge.
    let squared = bulge * bulge;
    let (cos, sin) = ((1.0 - squared) / (1.0 + squared), 2.0 * bulge * end / (1.0 + squared));
    (chord.0 * cos - chord.1 * sin, chord.0 * sin + chord.1 * cos)
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
    fn a_closed_one_begins_anywhere_with_its_bulges() {
        let mut ring = Curve {
            vertices: [0.0, 1.0, 2.0, 0.0].map(|x| at(x, x * x)).to_vec(),
            bulges: vec![0.1, 0.2, 0.3],
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
        assert_eq!(Curve { vertices: vec![a, b], bulges: vec![f64::NAN] }.chords(0.1), [a, b]);
    }

    #[test]
    fn the_tangents_of_half_a_circle_are_across_its_chord() {
        assert_eq!(tangent((1.0, 0.0), 1.0, -1.0), (0.0, -1.0));
        assert_eq!(tangent((1.0, 0.0), 1.0, 1.0), (0.0, 1.0));
    }
}
