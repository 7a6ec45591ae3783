//! [`chords`]: the arcs of a tool path as straight lines, for machines that know no others.

use crate::geom::single;
use crate::root::root;
use crate::turn::atan;
use crate::{PlotOp, Point, Vec2};
use core::num::NonZeroU16;

/// Most chords of one arc.
const MOST_CHORDS: u32 = 65_535;

/// An arc that is being divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DividedArc {
    centre: Point,
    /// From the centre to where it begins.
    out: Vec2,
    sweep_rad: f64,
    /// How much farther from the centre it ends than it begins, as a share of the radius.
    growth: f64,
    pub(crate) to: Point,
    /// Square of the greatest speed that is asked for along it, mm²/s²; 0 where none is.
    pub(crate) cruise2: f32,
    chords: NonZeroU16,
    next: u16,
}

impl DividedArc {
    /// From a place about a centre, in chords no farther than this from it, but at most [`MOST_CHORDS`].
    pub(crate) fn new(from: Point, centre: Point, sweep_rad: f64, to: Point, tolerance_mm: f64) -> Self {
        let out = from - centre;
        let radius_mm = out.length();
        let growth = if radius_mm > 0.0 { (to - centre).length() / radius_mm - 1.0 } else { 0.0 };
        let chords = chord_count(single(radius_mm), single(sweep_rad), single(tolerance_mm));
        let chords = u16::try_from(chords).ok().and_then(NonZeroU16::new).unwrap_or(NonZeroU16::MAX);
        Self { centre, out, sweep_rad, growth, to, cruise2: 0.0, chords, next: 0 }
    }

    /// Where the next chord ends.
    pub(crate) fn next_place(&mut self) -> Option<Point> {
        if self.is_over() {
            return None;
        }
        self.next += 1;
        if self.is_over() {
            return Some(self.to);
        }
        let share = f64::from(self.next) / f64::from(self.chords.get());
        Some(self.centre + self.out.rotated(self.sweep_rad * share) * (1.0 + self.growth * share))
    }

    /// Whether it has no more.
    pub(crate) const fn is_over(&self) -> bool {
        self.next >= self.chords.get()
    }
}

/// The same tool path with every arc as chords that are no farther than `tolerance_mm` from it, at most
/// 65,535 of them.
///
/// The chord over an angle a of a circle of radius r lies r (1 − cos(a/2)) from it at the farthest.
///
/// ```
/// # use plotter_motion::{PlotOp, Point, toolpath::chords};
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
    let mut arc: Option<(DividedArc, Option<f64>)> = None;
    core::iter::from_fn(move || {
        if let Some((divided, feed_mm_s)) = &mut arc
            && let Some(to) = divided.next_place()
        {
            return Some(PlotOp::Draw { to, feed_mm_s: *feed_mm_s });
        }
        let op = ops.next()?;
        let from = position;
        position = op.target().unwrap_or(position);
        let PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s } = op else {
            return Some(op);
        };
        let mut divided = DividedArc::new(from, centre, sweep_rad, to, tolerance_mm);
        let to = divided.next_place()?;
        arc = Some((divided, feed_mm_s));
        Some(PlotOp::Draw { to, feed_mm_s })
    })
}

/// Into how many chords an arc is divided so that none is farther than `tolerance_mm` from it: 1 to 65,535; 1
/// for what is no arc.
pub(crate) fn chord_count(radius_mm: f32, sweep_rad: f32, tolerance_mm: f32) -> u32 {
    let share = tolerance_mm / radius_mm;
    if share.is_nan() {
        return 1;
    }
    let flattest = if share < 1.0 { share } else { 1.0 };
    let flattest = if flattest > 0.0 { flattest } else { 0.0 };
    // The tangent of a quarter of the angle, whose square is (1 − cos) / (1 + cos) of its half.
    let finest_rad = 4.0 * atan(root(flattest / (2.0 - flattest)));
    let count = sweep_rad.abs() / finest_rad;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a cast saturates, and a NaN is 0"
    )]
    let whole = (count as u32).min(MOST_CHORDS);
    #[expect(clippy::cast_precision_loss, reason = "17 bits")]
    let is_more = count > whole as f32;
    (whole + u32::from(is_more)).clamp(1, MOST_CHORDS)
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
