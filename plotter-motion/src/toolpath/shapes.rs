//! Shapes as plot operations: the rectangle and the circle of a marking board.

use crate::{PlotOp, Point, Vec2};
use core::f64::consts::TAU;

/// The way from the centre of a circle of radius 1 to its point `i` of `n`, counter-clockwise from the right.
///
/// Sine and cosine are taken within the first eighth of a turn only, so that quarters come out exact and the
/// points lie symmetrically. An `n` of 0 gives the rightmost point.
pub(crate) fn unit_circle(i: u32, n: u32) -> Vec2 {
    let Some(i) = i.checked_rem(n) else { return Vec2::new(1.0, 0.0) };
    let (eighths, n) = (8 * u64::from(i), u64::from(n));
    let (octant, rest) = (eighths / n, eighths % n);
    // In every second octant the angle is measured back from the axis at its end.
    let from_axis = if octant % 2 == 0 { rest } else { n - rest };
    #[expect(clippy::cast_precision_loss, reason = "both are below 2^35, where every integer is an f64")]
    let angle_rad = TAU * (from_axis as f64 / (8 * n) as f64);
    let (cos, sin) = (libm::cos(angle_rad), libm::sin(angle_rad));
    match octant {
        0 => Vec2::new(cos, sin),
        1 => Vec2::new(sin, cos),
        2 => Vec2::new(-sin, cos),
        3 => Vec2::new(-cos, sin),
        4 => Vec2::new(-cos, -sin),
        5 => Vec2::new(-sin, -cos),
        6 => Vec2::new(sin, -cos),
        _ => Vec2::new(cos, -sin),
    }
}

fn draw(to: Point) -> PlotOp {
    PlotOp::Draw { to, feed_mm_s: None }
}

/// A rectangle from its corner `from`, drawn along the height first:
///
/// ```text
/// (x, y+h) ──2──▶ (x+w, y+h)
///    ▲               │
///    1               3
///    │               ▼
///  (x, y) ◀──4── (x+w, y)
/// ```
///
/// Five operations: the travel to `from`, and four lines of which the last ends exactly there. A negative
/// width or height lies to the left or below. Lines carry no speed.
///
/// Source: "2D Controlled Marking Board" (2017), section 0.5.1, on the rectangle.
///
/// ```
/// # use plotter_motion::{PlotOp, Point, toolpath::rectangle};
/// let corners: Vec<Point> = rectangle(Point::new(10.0, 20.0), 30.0, 5.0).filter_map(PlotOp::target).collect();
/// let expected = [(10.0, 20.0), (10.0, 25.0), (40.0, 25.0), (40.0, 20.0), (10.0, 20.0)];
/// assert_eq!(corners, expected.map(|(x, y)| Point::new(x, y)));
/// ```
pub fn rectangle(from: Point, width_mm: f64, height_mm: f64) -> impl Iterator<Item = PlotOp> + Clone {
    let (right, up) = (Vec2::new(width_mm, 0.0), Vec2::new(0.0, height_mm));
    [PlotOp::Travel { to: from }, draw(from + up), draw(from + up + right), draw(from + right), draw(from)]
        .into_iter()
}

/// A circle from its leftmost point `start`, drawn clockwise (up first) with `points` straight lines.
///
/// The centre is `start + (radius_mm, 0)`. After the travel to `start` come `points` lines of equal length to
/// the points of the circle; the last ends exactly on `start`. With 1 point it is a dot, with 0 only the
/// travel; a negative radius gives the circle to the left. Lines carry no speed.
///
/// Source: "2D Controlled Marking Board" (2017), section 0.5.2, on the circle.
///
/// ```
/// # use plotter_motion::{PlotOp, Point, toolpath::circle};
/// let points: Vec<Point> = circle(Point::new(10.0, 5.0), 3.0, 4).filter_map(PlotOp::target).collect();
/// let expected = [(10.0, 5.0), (13.0, 8.0), (16.0, 5.0), (13.0, 2.0), (10.0, 5.0)];
/// assert_eq!(points, expected.map(|(x, y)| Point::new(x, y)));
/// ```
pub fn circle(start: Point, radius_mm: f64, points: u32) -> impl Iterator<Item = PlotOp> + Clone {
    (0..=points).map(move |i| {
        if i == 0 {
            PlotOp::Travel { to: start }
        } else if i == points {
            draw(start)
        } else {
            let along = unit_circle(i, points);
            draw(start + Vec2::new(radius_mm * (1.0 - along.x), radius_mm * along.y))
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// Two roundings of numbers near 100.
    const ROUNDING_MM: f64 = 3e-14;

    #[test]
    fn every_point_of_a_circle_lies_on_it() {
        let (start, radius_mm) = (Point::new(20.0, 70.0), 50.0);
        let centre = Point::new(70.0, 70.0);
        let targets: Vec<Point> = circle(start, radius_mm, 300).filter_map(PlotOp::target).collect();
        assert_eq!(targets.len(), 301);
        for to in &targets {
            assert!((centre.distance(*to) - radius_mm).abs() < ROUNDING_MM, "{to:?}");
        }
        assert_eq!(targets.first(), targets.last());
    }

    #[test]
    fn a_circle_is_as_wide_as_it_is_high() {
        let targets: Vec<Point> = circle(Point::ORIGIN, 50.0, 300).filter_map(PlotOp::target).collect();
        let max = |of: fn(&Point) -> f64| targets.iter().map(of).fold(f64::MIN, f64::max);
        assert_eq!((max(|p| p.x), max(|p| p.y), max(|p| -p.y)), (100.0, 50.0, 50.0));
    }

    /// Angles up to 2π carry a rounding of 4e-16, which the sine passes on; both sides round again.
    const ANGLE_ROUNDING: f64 = 2e-15;

    #[test]
    fn the_unit_circle_agrees_with_sine_and_cosine() {
        for i in 0..720 {
            let angle_rad = TAU * f64::from(i) / 720.0;
            let difference = unit_circle(i, 720) - Vec2::new(libm::cos(angle_rad), libm::sin(angle_rad));
            assert!(difference.length() < ANGLE_ROUNDING, "{i}: {difference:?}");
        }
        assert_eq!(unit_circle(5, 0), Vec2::new(1.0, 0.0));
        assert_eq!(unit_circle(u32::MAX, u32::MAX), Vec2::new(1.0, 0.0));
    }

    #[test]
    fn few_points_are_no_surprise() {
        let travel = PlotOp::Travel { to: Point::ORIGIN };
        assert_eq!(circle(Point::ORIGIN, 9.0, 0).collect::<Vec<_>>(), [travel]);
        assert_eq!(circle(Point::ORIGIN, 9.0, 1).collect::<Vec<_>>(), [travel, draw(Point::ORIGIN)]);
        let there_and_back: Vec<_> = circle(Point::ORIGIN, 9.0, 2).collect();
        assert_eq!(there_and_back, [travel, draw(Point::new(18.0, 0.0)), draw(Point::ORIGIN)]);
    }
}
