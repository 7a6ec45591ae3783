//! Acceleration of a motion as a vector, against the limit.
#![allow(dead_code, reason = "each test takes what it needs")]

use plotter_motion::{
    PlannerSettings, Point, Vec2,
    planner::{AccelLimit, Course, Shape},
};

/// An acceleration as a share of what is allowed.
pub(crate) fn share(accel: Vec2, settings: &PlannerSettings) -> f64 {
    match settings.accel_limit {
        AccelLimit::Vector => accel.length() / settings.accel_mm_s2,
        AccelLimit::Axes { x_mm_s2, y_mm_s2 } => (accel.x.abs() / x_mm_s2).max(accel.y.abs() / y_mm_s2),
        AccelLimit::Belts { sum_mm_s2, difference_mm_s2 } => {
            ((accel.x + accel.y).abs() / sum_mm_s2).max((accel.x - accel.y).abs() / difference_mm_s2)
        }
    }
}

/// The first and the second derivative of the place along a course that begins at `from`, by the length that
/// its phases are told by.
pub(crate) fn derivatives(course: &Course, from: Point, along_mm: f64) -> (Vec2, Vec2) {
    let length_mm = f64::from(course.length_mm);
    match course.shape {
        Shape::Line => ((course.to - from) * (1.0 / course.to.distance(from).max(1e-300)), Vec2::default()),
        Shape::Arc { centre, sweep_rad } => {
            let per_mm = f64::from(sweep_rad) / length_mm;
            let out = (from - centre).rotated(per_mm * along_mm);
            (out.perpendicular() * per_mm, -out * (per_mm * per_mm))
        }
        Shape::Parabola { control } => {
            let (begin, end) =
                ((control - from) * (2.0 / length_mm), (course.to - control) * (2.0 / length_mm));
            let bend = (end - begin) * (1.0 / length_mm);
            (begin + bend * along_mm, bend)
        }
        shape => panic!("{shape:?} is not felt"),
    }
}

/// Places along a course that begins at `from`, with both ends.
pub(crate) fn places(course: &Course, from: Point, parts: u32) -> Vec<Point> {
    let place = |share: f64| match course.shape {
        Shape::Line => from.lerp(course.to, share),
        Shape::Arc { centre, sweep_rad } => centre + (from - centre).rotated(share * f64::from(sweep_rad)),
        Shape::Parabola { control } => from.lerp(control, share).lerp(control.lerp(course.to, share), share),
        shape => panic!("{shape:?} is not felt"),
    };
    (0..=parts).map(|part| place(f64::from(part) / f64::from(parts))).collect()
}
