//! The output of a planner: [`Action`], [`Course`], [`Phase`].

use super::Modes;
use crate::{Pen, Point};
use core::time::Duration;

/// The form of a stretch of path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// Straight.
    #[default]
    Line,
    /// An arc about a centre. If the ends are not equally far from it, the radius changes linearly.
    Arc {
        /// The centre, mm.
        centre: Point,
        /// The angle swept, rad; positive is counter-clockwise.
        sweep_rad: f32,
    },
    /// A parabola with a control point, the vertex that it rounds: it touches the lines from there to both of
    /// its ends, which are equally far away.
    Parabola {
        /// The control point, mm.
        control: Point,
    },
}

/// A stretch of path, from the end of the previous one.
///
/// Places are `f64`, for sheets of any size. All else is `f32`, which holds a value to 6·10⁻⁸ of itself: a
/// length of 10 m to half a micrometre.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Course {
    /// Line, arc or parabola.
    pub shape: Shape,
    /// Where it ends, mm.
    pub to: Point,
    /// How long it is, mm; 0 for a dot. Of a parabola the length of both its tangents, and its phases are
    /// told by that: s of it is the share s / `length_mm` of its parameter. Speeds are true at its ends, and
    /// between them less than is said, at the apex by the cosine of half of its turn.
    pub length_mm: f32,
    /// The pen on it.
    pub pen: Pen,
    /// Requested speed, mm/s; corners and curves make the machine slower.
    pub feed_mm_s: f32,
    /// Power of the laser at that speed, in 65535ths.
    pub laser_power: u16,
    /// At which height it ends, mm; none of a machine with two axes. Along the course z changes evenly, and
    /// `length_mm` is the length in space; where it rises and the jerk is limited it is that times a number
    /// from 1 on, and so are the ways, speeds, accelerations and jerks of its phases.
    #[cfg(feature = "third-motor")]
    pub to_z_mm: Option<f64>,
}

/// A time along the current course, with constant jerk.
///
/// After t seconds of it the speed is v + a t + j t²/2, and the way v t + a t²/2 + j t³/6.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Phase {
    /// How long it lasts, s.
    pub duration_s: f32,
    /// Where on the course it begins, mm from its start.
    pub from_mm: f32,
    /// Speed at its start, mm/s.
    pub speed_mm_s: f32,
    /// Acceleration at its start, mm/s².
    pub accel_mm_s2: f32,
    /// Jerk, mm/s³.
    pub jerk_mm_s3: f32,
}

impl Phase {
    /// Distance from the start of the course, speed and acceleration after `time_s` of it.
    ///
    /// ```
    /// # use plotter_motion::{planner::Phase, profile::ProfilePoint};
    /// let phase = Phase { duration_s: 2.0, from_mm: 1.0, speed_mm_s: 3.0, accel_mm_s2: 4.0, jerk_mm_s3: 0.0 };
    /// // 1 + 3 * 0.5 + 4 * 0.25 / 2
    /// assert_eq!(phase.at(0.5), ProfilePoint { distance_mm: 3.0, speed_mm_s: 5.0, accel_mm_s2: 4.0 });
    /// ```
    #[must_use]
    pub fn at(&self, time_s: f64) -> crate::profile::ProfilePoint {
        let [from_mm, v, a, j] =
            [self.from_mm, self.speed_mm_s, self.accel_mm_s2, self.jerk_mm_s3].map(f64::from);
        let t = time_s;
        crate::profile::ProfilePoint {
            distance_mm: from_mm + t * (v + t * (a / 2.0 + t * j / 6.0)),
            speed_mm_s: v + t * (a + t * j / 2.0),
            accel_mm_s2: a + t * j,
        }
    }

    /// Distance from the start of the course after `time_s`, mm, for a planner with these modes: without
    /// S-curves there is no jerk.
    pub(crate) fn way_mm<M: Modes>(&self, time_s: f32) -> f32 {
        let Self { speed_mm_s: v, accel_mm_s2: a, jerk_mm_s3: j, .. } = *self;
        let t = time_s;
        t * (v + t * (0.5 * a + if M::ALL { t * j / 6.0 } else { 0.0 }))
    }

    /// The speed then, mm/s.
    pub(crate) fn speed_at<M: Modes>(&self, time_s: f32) -> f32 {
        let Self { speed_mm_s: v, accel_mm_s2: a, jerk_mm_s3: j, .. } = *self;
        v + time_s * (a + if M::ALL { 0.5 * time_s * j } else { 0.0 })
    }
}

/// One action of the motors.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Action {
    /// A course begins. If its pen differs from that of the previous course, the machine stands.
    Course(Course),
    /// The next phase of the current course. Its phases reach its end.
    Phase(Phase),
    /// The machine stands for this long.
    Dwell(Duration),
    /// Another pen; the machine stands.
    SelectPen(u8),
    /// A new sheet; the machine stands.
    NewPage,
}
