//! [`bulge`]: whether a cubic curve stands for an arc of a circle.

use super::curve::Cubic;
use crate::stroke::{PxPoint, PxVec};
use core::f64::consts::FRAC_PI_2;

/// How far a cubic that stands for a quarter of a circle is from it, as a share of the radius, and a little
/// more. One that stands for less is nearer by the sixth power of the share.
///
/// Source: T. Dokken et al., "Good approximation of circles by curvature-continuous Bezier curves", Computer
/// Aided Geometric Design 7 (1990).
const QUARTER_SHARE: f64 = 3e-4;
/// An arc begins and ends alike: how much the lengths of its handles may differ as a share, and its turns,
/// rad.
const UNLIKE_SHARE: f64 = 0.02;
const UNLIKE_RAD: f64 = 0.01;
/// Least and greatest half of an arc's angle, rad: what turns less is a line, and nobody writes more than
/// half a circle as one curve.
const HALVES_RAD: core::ops::RangeInclusive<f64> = 0.01..=1.6;
/// Where the curve is compared with the circle.
const SAMPLES: [f64; 7] = [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875];

/// The bulge of the arc that a curve stands for; `None` where there is no arc within the tolerance of it, or,
/// since curves are what arcs are parsed into, within what such a curve is off.
pub(super) fn bulge(curve: Cubic, tolerance_px: f64) -> Option<f64> {
    let Cubic([from, first, second, to]) = curve;
    let (chord, into, out) = (to - from, first - from, to - second);
    let (chord_px, into_px) = (chord.length(), into.length());
    if !(chord_px > 0.0 && into_px > 0.0) || (out.length() - into_px).abs() > UNLIKE_SHARE * into_px {
        return None;
    }
    let (begins, ends) = (turn(into, chord), turn(chord, out));
    if (begins - ends).abs() > UNLIKE_RAD || !HALVES_RAD.contains(&begins.abs()) {
        return None;
    }
    let half_rad = 0.5 * (begins + ends);
    let radius_px = 0.5 * chord_px / libm::sin(half_rad).abs();
    let beside = 0.5 / libm::tan(half_rad);
    let centre = PxPoint::new(
        f64::midpoint(from.x, to.x) - chord.y * beside,
        f64::midpoint(from.y, to.y) + chord.x * beside,
    );
    let share = (half_rad.abs() / (0.5 * FRAC_PI_2)).min(1.0);
    let near_px = tolerance_px.max(QUARTER_SHARE * libm::pow(share, 6.0) * radius_px);
    let fits = SAMPLES.iter().all(|&t| (curve.at(t).distance(centre) - radius_px).abs() <= near_px);
    fits.then(|| libm::tan(0.5 * half_rad))
}

/// Angle from one direction to the other, rad; above 0 from x towards y.
fn turn(from: PxVec, to: PxVec) -> f64 {
    libm::atan2(from.cross(to), from.dot(to))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quarter of a circle about (0, 0) with the usual handles, from (r, 0) to (0, r).
    fn quarter(radius_px: f64, height: f64) -> Cubic {
        let handle = 0.552_285 * radius_px;
        let at = |x, y| PxPoint::new(x, height * y);
        Cubic([at(radius_px, 0.0), at(radius_px, handle), at(handle, radius_px), at(0.0, radius_px)])
    }

    #[test]
    fn a_quarter_of_a_circle_is_an_arc_of_90_degrees() {
        // tan(90° / 4)
        let expected = 2.0_f64.sqrt() - 1.0;
        assert!((bulge(quarter(100.0, 1.0), 0.01).unwrap() - expected).abs() < 1e-9);
        assert!((bulge(quarter(100.0, -1.0), 0.01).unwrap() + expected).abs() < 1e-9);
    }

    #[test]
    fn an_ellipse_a_line_and_a_wave_are_none() {
        assert_eq!(bulge(quarter(100.0, 0.5), 0.01), None);
        let at = PxPoint::new;
        assert_eq!(bulge(Cubic([at(0.0, 0.0), at(1.0, 0.0), at(2.0, 0.0), at(3.0, 0.0)]), 0.01), None);
        assert_eq!(bulge(Cubic([at(0.0, 0.0), at(1.0, 1.0), at(2.0, -1.0), at(3.0, 0.0)]), 0.01), None);
        assert_eq!(bulge(Cubic([at(0.0, 0.0); 4]), 0.01), None);
    }

    #[test]
    fn a_flat_curve_is_no_arc_because_its_radius_would_be_large() {
        let at = PxPoint::new;
        // Its greatest height is 3/4 of 40 px; the circle through it has a radius of 4182 px, of which 3e-4
        // would be 1.25 px.
        let flat = Cubic([at(0.0, 0.0), at(100.0, 40.0), at(900.0, 40.0), at(1000.0, 0.0)]);
        assert_eq!(bulge(flat, 0.01), None);
    }
}
