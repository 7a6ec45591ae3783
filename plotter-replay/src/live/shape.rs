//! [`Shape`]: what a person has drawn by numbers.

use plotter_motion::toolpath::{circle, rectangle};
use plotter_motion::{PlotOp, Point, Vec2};

/// Points of a circle at least, and at most.
const POINTS: core::ops::RangeInclusive<f64> = 3.0..=10_000.0;

/// A shape by its numbers, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// From one place to another.
    Line(Point, Point),
    /// Its lower left corner, width and height.
    Rectangle(Point, Vec2),
    /// Its leftmost point, radius and number of points.
    Circle(Point, f64, u16),
}

impl Shape {
    /// How many points a circle needs whose lines are to be no farther from it than `allowed_mm`: a line over
    /// an angle a lies r (1 − cos(a/2)) from it at the farthest. 3 to 10,000.
    ///
    /// ```
    /// # use plotter_replay::live::Shape;
    /// assert_eq!(Shape::points(10.0, 0.1), 23); // 180° / arccos(0.99) = 22.2
    /// assert_eq!(Shape::points(10.0, 50.0), 3);
    /// ```
    #[must_use]
    pub fn points(radius_mm: f64, allowed_mm: f64) -> u16 {
        let share = (allowed_mm / radius_mm.abs()).clamp(0.0, 1.0);
        let points = core::f64::consts::PI / libm::acos(1.0 - share);
        let points = libm::ceil(if points.is_finite() { points } else { *POINTS.end() });
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "3 to 10,000, as it is bounded"
        )]
        let points = points.clamp(*POINTS.start(), *POINTS.end()) as u16;
        points
    }

    /// Its operations, at this speed, mm/s, if that is above 0.
    pub(super) fn ops(self, speed_mm_s: f64) -> Vec<PlotOp> {
        let feed_mm_s = (speed_mm_s > 0.0).then_some(speed_mm_s);
        let with_speed = |op| match op {
            PlotOp::Draw { to, .. } => PlotOp::Draw { to, feed_mm_s },
            other => other,
        };
        match self {
            Self::Line(from, to) => {
                vec![PlotOp::Travel { to: from }, PlotOp::Draw { to, feed_mm_s }]
            }
            Self::Rectangle(at, size) => rectangle(at, size.x, size.y).map(with_speed).collect(),
            Self::Circle(at, radius_mm, points) => {
                circle(at, radius_mm, points.into()).map(with_speed).collect()
            }
        }
    }
}
