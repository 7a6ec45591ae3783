//! [`Chords`]: a course as chords on the grid of the motors.

use super::slice::{FRACTION_BITS, fixed};
use crate::chords::chord_count;
use crate::extremes::greater;
use crate::kinematics::Kinematics;
use crate::planner::Modes;
use crate::turn::sin_cos;
use crate::{Course, Point, Shape, StepPoint, Vec2};

/// A straight way between two whole steps, and where along the course it ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Chord {
    pub(super) to: StepPoint,
    /// Distance of its end from the start of the course, mm with 32 bits of fraction.
    pub(super) end: i64,
}

/// A course divided into chords that no motor can tell from it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Chords {
    from: Point,
    count: u32,
    next: u32,
}

impl Chords {
    /// `tolerance_mm`: how far a chord may be from the course.
    pub(super) fn new<M: Modes>(course: &Course, from: Point, tolerance_mm: f64) -> Self {
        let count = match course.shape {
            Shape::Line => 1,
            // A planner with such modes gives none.
            Shape::Spiral { .. } if !M::ALL => 1,
            Shape::Arc { centre, sweep_rad } => {
                let radius_mm = greater((from - centre).length_near(), (course.to - centre).length_near());
                chord_count(radius_mm, sweep_rad, tolerance_mm)
            }
            Shape::Spiral { pole, sweep_rad, growth } => {
                // Its radius of curvature is greater than the distance from the pole.
                let farther_mm = (from - pole).length().max((course.to - pole).length());
                chord_count(farther_mm * libm::sqrt(1.0 + growth * growth), sweep_rad, tolerance_mm)
            }
        };
        Self { from, count, next: 0 }
    }

    /// The next chord of the same course.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn next<M: Modes>(&mut self, course: &Course, kinematics: &impl Kinematics) -> Option<Chord> {
        if self.next >= self.count {
            return None;
        }
        self.next += 1;
        let (place, way_mm) = if self.next == self.count {
            (course.to, course.length_mm)
        } else {
            self.place::<M>(course, f64::from(self.next) / f64::from(self.count))
        };
        Some(Chord { to: kinematics.steps_at(place), end: fixed(way_mm, FRACTION_BITS) })
    }

    /// The place at a share of the angle, and how far along it is.
    fn place<M: Modes>(&self, course: &Course, share: f64) -> (Point, f64) {
        let Course { shape, to, length_mm, .. } = *course;
        match shape {
            Shape::Spiral { .. } if !M::ALL => (to, length_mm),
            Shape::Line => (self.from.lerp(to, share), length_mm * share),
            Shape::Arc { centre, sweep_rad } => {
                let out = self.from - centre;
                let (begin_mm, end_mm) = (out.length_near(), (to - centre).length_near());
                let growth = if begin_mm > 0.0 { end_mm / begin_mm - 1.0 } else { 0.0 };
                let radius = 1.0 + growth * share;
                let (sin, cos) = sin_cos(sweep_rad * share);
                let turned = Vec2::new(out.x * cos - out.y * sin, out.x * sin + out.y * cos);
                (centre + turned * radius, length_mm * share)
            }
            Shape::Spiral { pole, sweep_rad, growth } => {
                let out: Vec2 = self.from - pole;
                let angle_rad = sweep_rad * share;
                let grown = libm::exp(growth * angle_rad.abs());
                let all = libm::exp(growth * sweep_rad.abs());
                (pole + out.rotated(angle_rad) * grown, length_mm * (grown - 1.0) / (all - 1.0))
            }
        }
    }
}
