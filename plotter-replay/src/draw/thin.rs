//! Fewer points for a picture, none farther than a tolerance from what is drawn.

use plotter_motion::{Point, Vec2};

/// Leaves out points of a path as long as every one stays within `tolerance_mm` of the lines that are left;
/// the first and the last point always stay. One pass, constant memory.
///
/// From the last kept point each further one is seen under a cone of directions that pass it within the
/// tolerance; while the cones have a direction in common and the way leads on, one line does for all of them.
///
/// Source: C. M. Williams, "An efficient algorithm for the piecewise linear approximation of planar curves",
/// Computer Graphics and Image Processing 8 (1978).
///
/// ```
/// # use plotter_motion::Point;
/// # use plotter_replay::draw::thin;
/// let nearly_straight = [(0.0, 0.0), (1.0, 0.04), (2.0, 0.0), (2.0, 1.0)].map(|(x, y)| Point::new(x, y));
/// assert_eq!(thin(nearly_straight, 0.05).len(), 3); // the corner stays
/// ```
#[must_use]
pub fn thin(points: impl IntoIterator<Item = Point>, tolerance_mm: f64) -> Vec<Point> {
    let mut points = points.into_iter().filter(|point| point.is_finite());
    let Some(first) = points.next() else {
        return Vec::new();
    };
    let mut kept = vec![first];
    let mut view = View::from(first);
    let mut last = first;
    for point in points {
        if !view.take(point, tolerance_mm) {
            kept.push(last);
            view = View::from(last);
            view.take(point, tolerance_mm);
        }
        last = point;
    }
    if last != first || kept.len() > 1 {
        kept.push(last);
    }
    kept
}

/// What is seen from the last kept point.
struct View {
    from: Point,
    reach_mm: f64,
    /// Rightmost and leftmost direction that pass all points within the tolerance.
    cone: Option<(Vec2, Vec2)>,
}

impl View {
    fn from(from: Point) -> Self {
        Self { from, reach_mm: 0.0, cone: None }
    }

    /// Whether a line from here to `point` does for all points so far.
    fn take(&mut self, point: Point, tolerance_mm: f64) -> bool {
        let way = point - self.from;
        let far_mm = way.length();
        if far_mm < self.reach_mm {
            return false;
        }
        let seen = self.cone.is_none_or(|(right, left)| right.cross(way) >= 0.0 && way.cross(left) >= 0.0);
        if !seen {
            return false;
        }
        self.reach_mm = far_mm;
        if far_mm > tolerance_mm {
            let sin = tolerance_mm / far_mm;
            let cos = libm::sqrt(1.0 - sin * sin);
            let mut right = way * cos - way.perpendicular() * sin;
            let mut left = way * cos + way.perpendicular() * sin;
            if let Some((old_right, old_left)) = self.cone {
                right = if right.cross(old_right) > 0.0 { old_right } else { right };
                left = if old_left.cross(left) > 0.0 { old_left } else { left };
            }
            self.cone = Some((right, left));
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotter_motion::Segment;
    use proptest::prelude::*;

    /// Rounding of sums and products of coordinates up to 1000 mm, mm.
    const ROUNDING_MM: f64 = 1e-9;

    #[test]
    fn a_staircase_of_pulses_becomes_one_line() {
        let stairs = (0..2_000).map(|n| Point::new(f64::from((n + 1) / 2) * 0.025, f64::from(n / 2) * 0.025));
        assert_eq!(thin(stairs, 0.02), [Point::ORIGIN, Point::new(25.0, 24.975)]);
    }

    #[test]
    fn a_way_there_and_back_keeps_its_end() {
        let way = [0.0, 1.0, 5.0, 1.0, 0.0].map(|x| Point::new(x, 0.0));
        assert_eq!(thin(way, 0.02), [0.0, 5.0, 0.0].map(|x| Point::new(x, 0.0)));
        assert_eq!(thin([Point::ORIGIN; 3], 0.02), [Point::ORIGIN]);
        assert_eq!(thin([], 0.02), []);
    }

    proptest! {
        #[test]
        fn no_point_is_farther_than_the_tolerance(
            steps in prop::collection::vec((-5.0..5.0_f64, -5.0..5.0_f64), 1..60),
            tolerance_mm in 0.01..4.0_f64,
        ) {
            let mut at = Point::ORIGIN;
            let points: Vec<_> = steps.iter().map(|&(x, y)| { at += Vec2::new(x, y); at }).collect();
            let kept = thin(points.iter().copied(), tolerance_mm);
            prop_assert_eq!(kept.first(), points.first());
            prop_assert_eq!(kept.last(), points.last());
            for &point in &points {
                let nearest = kept
                    .windows(2)
                    .map(|pair| Segment::new(pair[0], pair[1]).distance(point))
                    .fold(point.distance(kept[0]), f64::min);
                prop_assert!(nearest <= tolerance_mm + ROUNDING_MM, "{nearest}");
            }
        }
    }
}
