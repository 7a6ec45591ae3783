//! [`chords`]: the arcs of a tool path as straight lines, for machines that know no others.

use crate::extremes::{greater, smaller};
use crate::turn::atan;
use crate::{PlotOp, Point, Vec2};

/// Most chords of one arc.
const MOST_CHORDS: f64 = 65_536.0;

/// An arc that is being divided.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Arc {
    centre: Point,
    /// From the centre to where it begins.
    out: Vec2,
    sweep_rad: f64,
    /// How much farther from the centre it ends than it begins, as a share of the radius.
    growth: f64,
    to: Point,
    feed_mm_s: Option<f64>,
    chords: u32,
    next: u32,
}

impl Arc {
    fn place(&self, index: u32) -> Point {
        if index >= self.chords {
            return self.to;
        }
        let share = f64::from(index) / f64::from(self.chords);
        self.centre + self.out.rotated(self.sweep_rad * share) * (1.0 + self.growth * share)
    }
}

/// The same tool path with every arc as chords that are no farther than `tolerance_mm` from it, at most 65,536 of them.
///
/// The chord over an angle a of a circle of radius r lies r (1 − cos(a/2)) from it at the farthest.
///
/// ```
/// # use plotter_motion::{PlotOp, Point, chords};
/// # use std::f64::consts::PI;
/// let half = PlotOp::DrawArc { centre: Point::new(10.0, 0.0), sweep_rad: PI, to: Point::new(0.0, 0.0), feed_mm_s: None };
/// let path = [PlotOp::Travel { to: Point::new(20.0, 0.0) }, half];
/// // 10 (1 - cos(a/2)) = 0.1 for a = 16.2 degrees: twelve chords of 15 degrees
/// let places: Vec<Point> = chords(path, 0.1).filter_map(PlotOp::target).collect();
/// assert_eq!(places.len(), 1 + 12);
/// assert!(places[6].distance(Point::new(10.0, 10.0)) < 1e-12); // the sixth chord ends half way round
/// assert_eq!(places[12], Point::new(0.0, 0.0));
/// ```
pub fn chords<I: IntoIterator<Item = PlotOp>>(
    ops: I,
    tolerance_mm: f64,
) -> impl Iterator<Item = PlotOp> + use<I> {
    let mut ops = ops.into_iter();
    let mut position = Point::ORIGIN;
    let mut arc: Option<Arc> = None;
    core::iter::from_fn(move || {
        if let Some(mut current) = arc.take() {
            current.next += 1;
            let to = current.place(current.next);
            if current.next < current.chords {
                arc = Some(current);
            }
            return Some(PlotOp::Draw { to, feed_mm_s: current.feed_mm_s });
        }
        let op = ops.next()?;
        let from = position;
        position = op.target().unwrap_or(position);
        let PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s } = op else {
            return Some(op);
        };
        let out = from - centre;
        let radius_mm = out.length();
        let growth = if radius_mm > 0.0 { (to - centre).length() / radius_mm - 1.0 } else { 0.0 };
        let count = chord_count(radius_mm, sweep_rad, tolerance_mm);
        let divided = Arc { centre, out, sweep_rad, growth, to, feed_mm_s, chords: count, next: 1 };
        if count > 1 {
            arc = Some(divided);
        }
        Some(PlotOp::Draw { to: divided.place(1), feed_mm_s })
    })
}

/// Into how many chords an arc is divided so that none is farther than `tolerance_mm` from it: 1 to 65,536; 1 for what is no
/// arc.
pub(crate) fn chord_count(radius_mm: f64, sweep_rad: f64, tolerance_mm: f64) -> u32 {
    let flattest = tolerance_mm / radius_mm;
    if flattest.is_nan() {
        return 1;
    }
    let flattest = greater(smaller(flattest, 1.0), 0.0);
    // The tangent of a quarter of the angle, whose square is (1 − cos) / (1 + cos) of its half.
    let finest_rad = 4.0 * atan(libm::sqrt(flattest / (2.0 - flattest)));
    let count = libm::ceil(libm::fabs(sweep_rad) / finest_rad);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number, clamped")]
    let count = if count.is_nan() { 1 } else { greater(smaller(count, MOST_CHORDS), 1.0) as u32 };
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn odd_arcs_become_a_line() {
        let to = Point::new(1.0, 1.0);
        for (centre, sweep_rad) in
            [(Point::ORIGIN, 1.0), (Point::new(1.0, 0.0), 0.0), (Point::new(f64::NAN, 0.0), 1.0)]
        {
            let arc = PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s: None };
            let ops: Vec<_> = chords([arc], 0.1).collect();
            assert_eq!(ops, [PlotOp::Draw { to, feed_mm_s: None }]);
        }
    }
}
