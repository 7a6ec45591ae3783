//! [`Bezier`]: a cubic curve as lines, for all languages and drawings.

use crate::Vec2;

/// Most lines of one curve.
const MOST_LINES: f64 = 4096.0;

/// A cubic Bézier curve that is being divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bezier {
    points: [Vec2; 4],
    lines: u32,
    next: u32,
}

impl Bezier {
    /// The curve from the first point to the last, drawn towards the ones between, as so many lines of equal
    /// parameter that none is farther than `tolerance_units` from it, at most 4096.
    ///
    /// A cubic divided into n parts lies within M · 6/8 / n² of its chords, with M the greatest second
    /// difference of its points.
    ///
    /// Source: G. Wang, "The subdivision method for finding the intersection between two Bézier curves or
    /// surfaces" (1984).
    pub(crate) fn new(points: [Vec2; 4], tolerance_units: f64) -> Self {
        let [a, b, c, d] = points;
        let bend = libm::fmax(((a - b) + (c - b)).length(), ((b - c) + (d - c)).length());
        let lines = libm::ceil(libm::sqrt(0.75 * bend / tolerance_units));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number, clamped"
        )]
        let lines = if lines.is_nan() { 1 } else { lines.clamp(1.0, MOST_LINES) as u32 };
        Self { points, lines, next: 1 }
    }

    /// How many lines it becomes.
    #[cfg(feature = "alloc")]
    pub(crate) fn lines(&self) -> u32 {
        self.lines
    }

    /// The end of the next line.
    pub(crate) fn next(&mut self) -> Option<Vec2> {
        let [a, b, c, d] = self.points;
        let index = self.next;
        self.next += 1;
        if index >= self.lines {
            return (index == self.lines).then_some(d);
        }
        let t = f64::from(index) / f64::from(self.lines);
        let s = 1.0 - t;
        Some(a * (s * s * s) + b * (3.0 * s * s * t) + c * (3.0 * s * t * t) + d * (t * t * t))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn as_many_lines_as_the_tolerance_asks_for() {
        let place = |x, y| Vec2::new(x, y);
        // Second differences of 100: n = sqrt(0.75 * 100 / 0.75) = 10.
        let mut curve = Bezier::new(
            [place(0.0, 0.0), place(0.0, 100.0), place(100.0, 100.0), place(100.0, 0.0)],
            0.75 * 2.0_f64.sqrt(),
        );
        let ends: Vec<Vec2> = core::iter::from_fn(|| curve.next()).collect();
        assert_eq!(ends.len(), 10);
        assert_eq!(ends[4], place(50.0, 75.0)); // half way: three quarters of the height
        assert_eq!(ends[9], place(100.0, 0.0));
    }

    #[test]
    fn a_straight_curve_is_one_line() {
        let place = |x| Vec2::new(x, 0.0);
        let mut curve = Bezier::new([place(0.0), place(1.0), place(2.0), place(3.0)], 0.4);
        assert_eq!((curve.next(), curve.next()), (Some(place(3.0)), None));
    }
}
