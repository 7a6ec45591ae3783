//! [`Cubic`]: a Bézier curve as the chords that a pen draws.
//!
//! ```text
//!   B'' is linear in t, so on a piece its length is greatest at one of the ends:
//!
//!   t ├───h───┤            distance of curve and chord ≤ h²/8 · max(|B''(t)|, |B''(t + h)|)
//! ```
//!
//! Each chord spans the longest piece of which this is within the tolerance, so that tight bends get many and
//! long ones few. Source of the bound: D. Filip, R. Magedson, R. Markot, "Surface algorithms using bounds on
//! derivatives", Computer Aided Geometric Design 3 (1986), theorem 1.

use crate::stroke::PxPoint;

/// Halvings that find the end of a piece: finer than any piece of a curve of 2²⁰ px.
const HALVINGS: usize = 40;
/// Shortest piece: no tolerance and no curve that are let in need it.
const SHORTEST: f64 = 1e-7;

/// A cubic Bézier curve by its control points, px.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cubic(pub(super) [PxPoint; 4]);

impl Cubic {
    /// The quadratic curve of these control points, its degree raised.
    pub(super) fn from_quadratic([start, middle, end]: [PxPoint; 3]) -> Self {
        let third = |outer: PxPoint| mix(outer, middle, 2.0 / 3.0);
        Self([start, third(start), third(end), end])
    }

    /// The place at `t` in 0..=1; de Casteljau's rule, which gives the control points at the ends exactly.
    pub(super) fn at(&self, t: f64) -> PxPoint {
        let [p0, p1, p2, p3] = self.0;
        let (a, b, c) = (mix(p0, p1, t), mix(p1, p2, t), mix(p2, p3, t));
        mix(mix(a, b, t), mix(b, c, t), t)
    }

    /// Its two halves, by the same rule.
    pub(super) fn halves(&self) -> [Self; 2] {
        let [p0, p1, p2, p3] = self.0;
        let half = |one, other| mix(one, other, 0.5);
        let (a, b, c) = (half(p0, p1), half(p1, p2), half(p2, p3));
        let (ab, bc) = (half(a, b), half(b, c));
        let middle = half(ab, bc);
        [Self([p0, a, ab, middle]), Self([middle, bc, c, p3])]
    }

    /// The ends of the chords, without the curve's start: every place of the curve is within `tolerance_px`
    /// of its chord, and every place of the chord of the curve.
    pub(super) fn chords(self, tolerance_px: f64) -> impl Iterator<Item = PxPoint> {
        let straight = self.is_straight(tolerance_px);
        let mut t = 0.0;
        core::iter::from_fn(move || {
            if t >= 1.0 {
                return None;
            }
            t = if straight { 1.0 } else { self.piece_end(t, tolerance_px) };
            Some(if t >= 1.0 { self.0[3] } else { self.at(t) })
        })
    }

    /// Whether both handles lie within the tolerance of the chord: then the whole curve does, for it lies in
    /// the hull of its control points, and what is near a segment is convex.
    fn is_straight(&self, tolerance_px: f64) -> bool {
        let [start, p1, p2, end] = self.0;
        [p1, p2].into_iter().all(|handle| distance_to_segment(handle, start, end) <= tolerance_px)
    }

    /// Length of the second derivative at `t`.
    fn bend(&self, t: f64) -> f64 {
        let [p0, p1, p2, p3] = self.0;
        let second =
            |a: PxPoint, b: PxPoint, c: PxPoint| PxPoint::new(a.x - 2.0 * b.x + c.x, a.y - 2.0 * b.y + c.y);
        let bend = mix(second(p0, p1, p2), second(p1, p2, p3), t);
        6.0 * libm::hypot(bend.x, bend.y)
    }

    /// End of the longest piece from `t` on that one chord may stand for.
    fn piece_end(&self, t: f64, tolerance_px: f64) -> f64 {
        let at_start = self.bend(t);
        let fits = |h: f64| h * h * at_start.max(self.bend(t + h)) <= 8.0 * tolerance_px;
        let rest = 1.0 - t;
        if fits(rest) {
            return 1.0;
        }
        // The greater of both bends never falls with h, for the bend is convex in it.
        let (mut short, mut long) = (0.0, rest);
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(short, long);
            if fits(middle) { short = middle } else { long = middle }
        }
        (t + short.max(SHORTEST)).min(1.0)
    }
}

/// The place that is `share` of the way from `from` to `to`.
fn mix(from: PxPoint, to: PxPoint, share: f64) -> PxPoint {
    let rest = 1.0 - share;
    PxPoint::new(rest * from.x + share * to.x, rest * from.y + share * to.y)
}

/// Distance of a place from a segment.
pub(super) fn distance_to_segment(at: PxPoint, start: PxPoint, end: PxPoint) -> f64 {
    let (away, way) = (at - start, end - start);
    let squared = way.length_squared();
    let share = if squared > 0.0 { (away.dot(way) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (away - way * share).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn px(x: f64, y: f64) -> PxPoint {
        PxPoint::new(x, y)
    }

    #[test]
    fn a_parabola_gets_as_many_chords_as_the_bound_says() {
        // |B''| = 2 |P0 - 2 P1 + P2| = 160; sqrt(160 / (8 · 0.2)) = 10 chords.
        let parabola = Cubic::from_quadratic([px(0.0, 0.0), px(50.0, 80.0), px(100.0, 80.0 * 2.0 - 80.0)]);
        assert_eq!(parabola.chords(0.2000001).count(), 10);
        assert_eq!(parabola.chords(0.2000001).last(), Some(px(100.0, 80.0)));
    }

    #[test]
    fn a_curve_that_is_straight_is_one_chord_and_one_that_turns_back_is_not() {
        let line = Cubic([px(0.0, 0.0), px(90.0, 0.0), px(95.0, 0.0), px(100.0, 0.0)]);
        assert_eq!(line.chords(0.01).collect::<Vec<_>>(), [px(100.0, 0.0)]);
        let spike = Cubic([px(0.0, 0.0), px(200.0, 0.0), px(200.0, 0.0), px(0.0, 0.0)]);
        assert!(spike.chords(0.01).any(|at| at.x > 149.0));
    }

    /// Samples of a curve between which nothing of weight happens.
    const SAMPLES: u32 = 2000;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn curve_and_chords_are_within_the_tolerance_of_each_other(
            places in proptest::array::uniform8(-200.0..200.0f64),
            tolerance_px in 0.02..5.0f64,
        ) {
            let [a, b, c, d, e, f, g, h] = places;
            let curve = Cubic([px(a, b), px(c, d), px(e, f), px(g, h)]);
            let chords: Vec<PxPoint> = core::iter::once(curve.0[0]).chain(curve.chords(tolerance_px)).collect();
            prop_assert_eq!(chords.last(), Some(&curve.0[3]));
            let samples: Vec<PxPoint> =
                (0..=SAMPLES).map(|step| curve.at(f64::from(step) / f64::from(SAMPLES))).collect();
            for at in &samples {
                let nearest = chords.windows(2).map(|pair| distance_to_segment(*at, pair[0], pair[1]));
                prop_assert!(nearest.fold(f64::INFINITY, f64::min) <= tolerance_px + 1e-9);
            }
            for pair in chords.windows(2) {
                for share in [0.25, 0.5, 0.75] {
                    let at = mix(pair[0], pair[1], share);
                    let nearest = samples.windows(2).map(|piece| distance_to_segment(at, piece[0], piece[1]));
                    prop_assert!(nearest.fold(f64::INFINITY, f64::min) <= tolerance_px + 0.01);
                }
            }
        }
    }
}
