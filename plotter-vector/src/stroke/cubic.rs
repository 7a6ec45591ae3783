//! [`Cubic`]: a segment of a cubic curve.

use crate::stroke::curve::{are_handles, unit, whole_chords};
use crate::stroke::{PxPoint, PxVec};

/// Farthest that the chords lie from a curve whose lengths are summed up for its own, px.
const LENGTH_ERROR_PX: f64 = 1e-3;

/// A cubic Bézier curve between two places: it leaves the first towards its first handle and comes to the
/// second from its second handle.
///
/// With a and d the places, b and c the handles, and t from 0 to 1:
///
/// ```text
/// q(t) = (1 − t)³ a + 3 (1 − t)² t b + 3 (1 − t) t² c + t³ d
/// ```
///
/// ```
/// # use plotter_vector::{PxPoint, stroke::Cubic};
/// let at = PxPoint::new;
/// let arch = Cubic::new(at(0.0, 0.0), [at(0.0, 4.0), at(8.0, 4.0)], at(8.0, 0.0)).unwrap();
/// assert_eq!(arch.at(0.5), at(4.0, 3.0)); // three quarters as high as its handles
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cubic {
    /// Where it begins.
    pub from: PxPoint,
    /// Where it is drawn to and from on its way.
    pub handles: [PxPoint; 2],
    /// Where it ends.
    pub to: PxPoint,
}

impl Cubic {
    /// The curve between two places with these handles; `None` where one of the four is no place.
    #[must_use]
    pub fn new(from: PxPoint, handles: [PxPoint; 2], to: PxPoint) -> Option<Self> {
        (are_handles(handles) && from.is_finite() && to.is_finite()).then_some(Self { from, handles, to })
    }

    /// The place at t, 0 to 1.
    #[must_use]
    pub fn at(&self, t: f64) -> PxPoint {
        // From end to end by the same sums.
        if t >= 1.0 {
            return self.to;
        }
        let s = 1.0 - t;
        let [b, c] = self.handles;
        let weights = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
        sum(weights, [self.from, b, c, self.to])
    }

    /// Derivative at t, px per unit of t.
    pub(crate) fn speed(&self, t: f64) -> PxVec {
        let [b, c] = self.handles;
        let s = 1.0 - t;
        let (u, v, w) = (b - self.from, c - b, self.to - c);
        let (i, j, k) = (3.0 * s * s, 6.0 * s * t, 3.0 * t * t);
        PxVec::new(i * u.x + j * v.x + k * w.x, i * u.y + j * v.y + k * w.y)
    }

    /// No less than its speed anywhere: that along the longest side of its polygon, px per unit of t.
    pub(crate) fn greatest_speed(&self) -> f64 {
        let [b, c] = self.handles;
        3.0 * self.from.distance(b).max(b.distance(c)).max(c.distance(self.to))
    }

    /// The handles of its parts up to t and from there on (de Casteljau).
    pub(crate) fn halves(&self, t: f64) -> [[PxPoint; 2]; 2] {
        let [b, c] = self.handles;
        let between = |from: PxPoint, to: PxPoint| from + (to - from) * t;
        let (first, middle, last) = (between(self.from, b), between(b, c), between(c, self.to));
        [[first, between(first, middle)], [between(middle, last), last]]
    }

    /// The change of its speed at t, px per unit of t squared.
    pub(crate) fn bend(&self, t: f64) -> PxVec {
        let (first, second) = self.bends();
        let s = 1.0 - t;
        PxVec::new(6.0 * (s * first.x + t * second.x), 6.0 * (s * first.y + t * second.y))
    }

    /// A sixth of the bend at either end: between them it changes evenly.
    fn bends(&self) -> (PxVec, PxVec) {
        let [b, c] = self.handles;
        let second =
            |p: PxPoint, q: PxPoint, r: PxPoint| PxVec::new(p.x - 2.0 * q.x + r.x, p.y - 2.0 * q.y + r.y);
        (second(self.from, b, c), second(b, c, self.to))
    }

    /// The unit vector in which it goes at t, 0 to 1; (0, 0) where it is a dot.
    pub(crate) fn heading(&self, t: f64) -> PxVec {
        let [b, c] = self.handles;
        let speed = self.speed(t);
        let px_per_t = speed.length();
        if px_per_t > 0.0 && t > 0.0 && t < 1.0 {
            return speed / px_per_t;
        }
        // Handles in the place of an end say nothing about it.
        let ends = if t < 0.5 {
            [(self.from, b), (self.from, c), (self.from, self.to)]
        } else {
            [(c, self.to), (b, self.to), (self.from, self.to)]
        };
        ends.into_iter()
            .map(|(from, to)| unit(from, to))
            .find(|way| *way != PxVec::default())
            .unwrap_or_default()
    }

    /// Length, px: that of chords which lie no farther than 0.001 px from it.
    ///
    /// ```
    /// # use plotter_vector::{PxPoint, stroke::Cubic};
    /// // A quarter of a circle of radius 100, but for 0.03 %.
    /// let (at, k) = (PxPoint::new, 100.0 * 0.5523);
    /// let quarter = Cubic::new(at(100.0, 0.0), [at(100.0, k), at(k, 100.0)], at(0.0, 100.0)).unwrap();
    /// assert!((quarter.length_px() - 157.08).abs() < 0.03); // 50 π
    /// ```
    #[must_use]
    pub fn length_px(&self) -> f64 {
        let count = self.chords(LENGTH_ERROR_PX);
        let place = |chord: u32| self.at(f64::from(chord) / f64::from(count));
        (0..count).map(|chord| place(chord).distance(place(chord + 1))).sum()
    }

    /// Into how many chords of equal steps of t it has to be divided so that they lie no farther than this
    /// from it, or 65536: a chord over a step h is at most h² / 8 of the greatest bend off.
    pub(crate) fn chords(&self, chord_error_px: f64) -> u32 {
        let (first, second) = self.bends();
        let most = first.length().max(second.length());
        let count = libm::ceil(libm::sqrt(0.75 * most / chord_error_px.max(0.0)) - 1e-9);
        whole_chords(count)
    }
}

fn sum(weights: [f64; 4], places: [PxPoint; 4]) -> PxPoint {
    let add = |at: PxPoint, (weight, place): (f64, PxPoint)| at + PxVec::new(place.x, place.y) * weight;
    weights.into_iter().zip(places).fold(PxPoint::default(), add)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64) -> PxPoint {
        PxPoint::new(x, y)
    }

    fn wave() -> Cubic {
        Cubic::new(at(10.0, 10.0), [at(40.0, -30.0), at(20.0, 70.0)], at(60.0, 20.0)).unwrap()
    }

    #[test]
    fn its_chords_stay_as_near_as_asked_and_are_hardly_more_than_needed() {
        for error_px in [1.0, 0.1, 0.005] {
            let count = wave().chords(error_px);
            let off = |count: u32| {
                let middle = |chord: u32| {
                    let t = |half: u32| f64::from(2 * chord + half) / f64::from(2 * count);
                    let (a, b) = (wave().at(t(0)), wave().at(t(2)));
                    wave().at(t(1)).distance(at(f64::midpoint(a.x, b.x), f64::midpoint(a.y, b.y)))
                };
                (0..count).map(middle).fold(0.0, f64::max)
            };
            assert!(off(count) <= error_px, "{error_px}");
            assert!(off(count / 2) > error_px, "twice as many as needed for {error_px}");
        }
    }

    #[test]
    fn its_speed_and_its_bend_are_the_slopes_of_its_way() {
        const STEP: f64 = 1e-4;
        for t in [0.0, 0.3, 0.9] {
            let (a, b, c) = (wave().at(t), wave().at(t + STEP), wave().at(t + 2.0 * STEP));
            let speed = wave().speed(t + STEP);
            assert!((speed.x - (c.x - a.x) / (2.0 * STEP)).abs() < 1e-3);
            let bend = wave().bend(t + STEP);
            assert!((bend.y - (a.y - 2.0 * b.y + c.y) / (STEP * STEP)).abs() < 1e-1);
        }
    }

    #[test]
    fn handles_in_the_place_of_an_end_leave_it_its_direction() {
        let (a, b) = (at(0.0, 0.0), at(4.0, 3.0));
        let straight = Cubic::new(a, [a, b], b).unwrap();
        assert_eq!([straight.heading(0.0), straight.heading(1.0)], [PxVec::new(0.8, 0.6); 2]);
        assert_eq!(Cubic::new(a, [a, a], a).unwrap().heading(0.5), PxVec::new(0.0, 0.0));
        assert!((straight.length_px() - 5.0).abs() < 1e-9);
    }

    #[test]
    fn numbers_that_are_none_or_too_large_make_no_endless_chords() {
        let far = Cubic::new(at(-1e300, 0.0), [at(1e300, 1e300), at(0.0, -1e300)], at(1e300, 0.0)).unwrap();
        assert_eq!(far.chords(1e-9), 65_536);
        assert_eq!(wave().chords(f64::NAN), 65_536);
        assert_eq!(Cubic::new(at(0.0, f64::NAN), wave().handles, wave().to), None);
    }
}
