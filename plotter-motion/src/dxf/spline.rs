//! [`Spline`]: a NURBS curve as lines.

use super::frame::Vec3;
use crate::rational::{Weighted, bezier_point};
use alloc::vec;
use alloc::vec::Vec;

/// Highest degree that is read: programs write 2 to 5, and none above 25.
pub(super) const MOST_DEGREE: usize = 25;
/// Deepest that a piece is halved: 65,536 lines.
const MOST_HALVINGS: u32 = 16;

/// A curve of the pieces between its knots.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Spline {
    pub(super) degree: usize,
    pub(super) knots: Vec<f64>,
    pub(super) points: Vec<Vec3>,
    /// As many as there are points, or none.
    pub(super) weights: Vec<f64>,
}

impl Spline {
    /// What is wrong with its numbers, and what would be right.
    pub(super) fn complaint(&self) -> Option<&'static str> {
        let Self { degree, knots, points, weights } = self;
        if *degree == 0 || *degree > MOST_DEGREE {
            return Some("its degree (71) is not from 1 to 25");
        }
        if points.len() <= *degree {
            return Some("it has too few control points (10, 20) for its degree");
        }
        if knots.len() != points.len() + degree + 1 {
            return Some("it has not as many knots (40) as control points and its degree and 1 together");
        }
        if knots.windows(2).any(|pair| matches!(pair, [a, b] if a > b)) {
            return Some("its knots (40) do not rise");
        }
        if !weights.is_empty()
            && (weights.len() != points.len() || weights.iter().any(|weight| *weight <= 0.0))
        {
            return Some("its weights (41) are not above 0, one for each control point");
        }
        None
    }

    /// Its places, so that no line between two of them is farther than `tolerance` from it.
    ///
    /// Each stretch between knots is made a Bézier curve by inserting its ends as knots (W. Boehm, "Inserting
    /// new knots into B-spline curves", 1980), and halved until its points lie near enough to its chord: the
    /// curve is a mean of them.
    pub(super) fn places(&self, tolerance: f64) -> Vec<Vec3> {
        let weight = |index: usize| self.weights.get(index).copied().unwrap_or(1.0);
        let points: Vec<Weighted<Vec3>> = self
            .points
            .iter()
            .enumerate()
            .map(|(index, place)| Weighted::new(*place, weight(index)))
            .collect();
        let mut places = Vec::new();
        let inner = self.degree..self.points.len();
        for span in inner {
            let (Some(from), Some(to)) = (self.knots.get(span), self.knots.get(span + 1)) else { continue };
            if from >= to {
                continue;
            }
            let piece = self.bezier(&points, span);
            if places.is_empty() {
                places.extend(piece.first().map(|point| point.projected()));
            }
            flatten(&piece, tolerance, MOST_HALVINGS, &mut places);
        }
        places
    }

    /// The Bézier points of the stretch between knots `span` and `span + 1`.
    fn bezier(&self, points: &[Weighted<Vec3>], span: usize) -> Vec<Weighted<Vec3>> {
        let first = span - self.degree;
        let knot = |number: usize| self.knots.get(first + number).copied().unwrap_or_default();
        (0..=self.degree)
            .map(|ends| {
                let mut row = points.get(first..=span).map(<[_]>::to_vec).unwrap_or_default();
                bezier_point(&mut row, ends, knot)
            })
            .collect()
    }
}

/// Appends the places of a Bézier curve, without its first.
fn flatten(piece: &[Weighted<Vec3>], tolerance: f64, halvings: u32, places: &mut Vec<Vec3>) {
    let (Some(first), Some(last)) = (piece.first(), piece.last()) else { return };
    let (from, to) = (first.projected(), last.projected());
    let far = piece.iter().map(|point| distance(point.projected(), from, to)).fold(0.0, libm::fmax);
    let is_flat = far * inner_share(piece) <= tolerance;
    if is_flat || halvings == 0 {
        places.push(to);
        return;
    }
    // De Casteljau: the left edge of the triangle is one half, the right edge the other.
    let mut row = piece.to_vec();
    let (mut left, mut right) = (vec![*first], vec![*last]);
    while row.len() > 1 {
        row = row.windows(2).filter_map(|pair| Some(pair.first()?.mixed(*pair.last()?, 0.5))).collect();
        left.extend(row.first());
        right.extend(row.last());
    }
    right.reverse();
    flatten(&left, tolerance, halvings - 1, places);
    flatten(&right, tolerance, halvings - 1, places);
}

/// Most that the points between the ends count in any place of a Bézier curve: 1 − t^p − (1 − t)^p is at most
/// 1 − 2^(1 − p), and more where their weights are greater.
fn inner_share(piece: &[Weighted<Vec3>]) -> f64 {
    let [first, inner @ .., last] = piece else { return 0.0 };
    let ends = libm::exp2(-f64::from(u8::try_from(inner.len()).unwrap_or(u8::MAX)));
    let inner = inner.iter().map(|point| point.weight).fold(0.0, libm::fmax) * (1.0 - ends);
    inner / (inner + ends * libm::fmin(first.weight, last.weight))
}

/// From a place to a line.
fn distance(place: Vec3, from: Vec3, to: Vec3) -> f64 {
    let (way, out) = (to - from, place - from);
    let dot = |a: Vec3, b: Vec3| a.x * b.x + a.y * b.y + a.z * b.z;
    let square = dot(way, way);
    let share = if square > 0.0 { (dot(out, way) / square).clamp(0.0, 1.0) } else { 0.0 };
    (out - way * share).length()
}

/// The curve through places that has no corner and no bend at its ends: a natural cubic spline by lengths of
/// chords.
///
/// Source: C. de Boor, *A Practical Guide to Splines* (1978), chapter IV; as cubic Bézier curves.
pub(super) fn through(places: &[Vec3], is_closed: bool) -> Option<Spline> {
    let mut places = places.to_vec();
    if is_closed && let Some(first) = places.first().copied() {
        places.push(first);
    }
    places.dedup();
    let lengths: Vec<f64> =
        places.windows(2).filter_map(|pair| Some((*pair.last()? - *pair.first()?).length())).collect();
    let count = places.len();
    if count < 2 {
        return None;
    }
    // The tridiagonal system of the slopes, with ends that do not bend.
    let mut slopes = vec![Vec3::ZERO; count];
    let mut upper = vec![0.0; count];
    let length = |index: usize| lengths.get(index).copied().unwrap_or(1.0);
    let rise = |index: usize| {
        let (Some(a), Some(b)) = (places.get(index), places.get(index + 1)) else { return Vec3::ZERO };
        (*b - *a) * (1.0 / length(index))
    };
    for index in 0..count {
        let (below, on, above, right) = if index == 0 {
            (0.0, 2.0, 1.0, rise(0) * 3.0)
        } else if index == count - 1 {
            (1.0, 2.0, 0.0, rise(index - 1) * 3.0)
        } else {
            let (before, after) = (1.0 / length(index - 1), 1.0 / length(index));
            (before, 2.0 * (before + after), after, (rise(index - 1) * before + rise(index) * after) * 3.0)
        };
        let last = index.checked_sub(1);
        let (last_upper, last_slope) =
            last.and_then(|last| Some((*upper.get(last)?, *slopes.get(last)?))).unwrap_or((0.0, Vec3::ZERO));
        let pivot = on - below * last_upper;
        if let (Some(upper), Some(slope)) = (upper.get_mut(index), slopes.get_mut(index)) {
            *upper = above / pivot;
            *slope = (right - last_slope * below) * (1.0 / pivot);
        }
    }
    for index in (0..count - 1).rev() {
        let next = slopes.get(index + 1).copied().unwrap_or_default();
        let factor = upper.get(index).copied().unwrap_or(0.0);
        if let Some(slope) = slopes.get_mut(index) {
            *slope = *slope - next * factor;
        }
    }
    let mut points = vec![*places.first()?];
    let mut knots = vec![0.0; 4];
    let mut at = 0.0;
    for index in 0..count - 1 {
        let (from, to) = (*places.get(index)?, *places.get(index + 1)?);
        let third = length(index) / 3.0;
        points.extend([from + *slopes.get(index)? * third, to - *slopes.get(index + 1)? * third, to]);
        at += length(index);
        knots.extend([at; 3]);
    }
    knots.push(at);
    Some(Spline { degree: 3, knots, points, weights: Vec::new() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(x: f64, y: f64) -> Vec3 {
        Vec3::new(x, y, 0.0)
    }

    #[test]
    fn a_quarter_circle_by_weights() {
        let spline = Spline {
            degree: 2,
            knots: vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
            points: vec![flat(1.0, 0.0), flat(1.0, 1.0), flat(0.0, 1.0)],
            weights: vec![1.0, core::f64::consts::FRAC_1_SQRT_2, 1.0],
        };
        assert_eq!(spline.complaint(), None);
        let places = spline.places(1e-4);
        assert_eq!((places[0], places[places.len() - 1]), (flat(1.0, 0.0), flat(0.0, 1.0)));
        for pair in places.windows(2) {
            assert!((pair[0].length() - 1.0).abs() < 1e-12);
            assert!(1.0 - ((pair[0] + pair[1]) * 0.5).length() < 1e-4);
        }
        assert!((10..=65).contains(&places.len()), "{}", places.len());
    }

    #[test]
    fn pieces_of_a_cubic_meet_and_keep_its_values() {
        // Uniform knots that are not clamped: at the knot 4 the curve is (p1 + 4 p2 + p3) / 6.
        let points = vec![flat(0.0, 0.0), flat(1.0, 2.0), flat(3.0, 2.0), flat(4.0, 0.0), flat(6.0, 1.0)];
        let knots: Vec<f64> = (0..9).map(f64::from).collect();
        let spline = Spline { degree: 3, knots, points: points.clone(), weights: vec![] };
        assert_eq!(spline.complaint(), None);
        let places = spline.places(1e-3);
        let knot = (points[1] + points[2] * 4.0 + points[3]) * (1.0 / 6.0);
        assert!(places.iter().any(|place| (*place - knot).length() < 1e-12), "{places:?}");
        let start = (points[0] + points[1] * 4.0 + points[2]) * (1.0 / 6.0);
        assert!((places[0] - start).length() < 1e-12);
    }

    #[test]
    fn a_curve_through_places_passes_them_and_a_line_stays_one() {
        let places = [flat(0.0, 0.0), flat(1.0, 1.0), flat(2.0, 0.0), flat(5.0, 1.0)];
        let spline = through(&places, false).unwrap();
        assert_eq!(spline.complaint(), None);
        let drawn = spline.places(1e-3);
        for place in places {
            assert!(drawn.iter().any(|at| (*at - place).length() < 1e-9), "{place:?}");
        }
        let line = through(&[flat(0.0, 0.0), flat(1.0, 1.0), flat(4.0, 4.0)], false).unwrap();
        assert!(line.places(1e-6).iter().all(|at| (at.x - at.y).abs() < 1e-9));
        assert_eq!(through(&[flat(1.0, 1.0)], true), None);
    }

    #[test]
    fn wrong_numbers_are_told() {
        let spline = Spline { degree: 3, knots: vec![0.0; 5], points: vec![Vec3::ZERO; 4], weights: vec![] };
        assert!(spline.complaint().is_some_and(|said| said.contains("knots")));
        let spline = Spline { degree: 0, ..spline };
        assert!(spline.complaint().is_some_and(|said| said.contains("degree")));
    }
}
