//! [`Chords`]: a course as chords on the grid of the motors.

use super::slice::{FRACTION_BITS, fixed};
use crate::extremes::greatest;
use crate::geom::single;
use crate::kinematics::Kinematics;
use crate::planner::{AllModes, Modes};
use crate::root::root;
use crate::toolpath::chords::chord_count;
use crate::turn::sin_cos;
use crate::{
    Point, StepPoint,
    planner::{Course, Shape},
};

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
    pub(super) fn new<M: Modes>(course: &Course, from: &Point, tolerance_mm: f32) -> Self {
        let count = match course.shape {
            Shape::Line => 1,
            // A planner with such modes gives none.
            Shape::Parabola { .. } if !M::ALL => 1,
            Shape::Arc { centre, sweep_rad } => {
                let radius_mm =
                    greatest(centre.way_to(from).length_near(), centre.way_to(&course.to).length_near());
                chord_count(radius_mm, sweep_rad, tolerance_mm)
            }
            Shape::Parabola { control } => {
                // Between two places a share u of the parameter apart it is at most u² / 4 of both tangents'
                // difference from its chord.
                let bend = from.way_to(&control).plus(course.to.way_to(&control));
                let parts = root(0.25 * bend.length_near() / tolerance_mm);
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "a cast saturates, and a NaN is 0"
                )]
                let whole = parts as u16;
                u32::from(whole) + 1
            }
        };
        Self { from: *from, count, next: 0 }
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
            self.place::<M>(course, share(self.next, self.count))
        };
        Some(Chord { to: kinematics.steps_at(place), end: fixed(way_mm, FRACTION_BITS) })
    }

    /// The place at a share of the angle, and how far along it is.
    fn place<M: Modes>(&self, course: &Course, share: f32) -> (Point, f32) {
        let Course { shape, to, length_mm, .. } = *course;
        match shape {
            Shape::Parabola { .. } if !M::ALL => (to, length_mm),
            // It is one chord.
            Shape::Line => (to, length_mm),
            Shape::Arc { centre, sweep_rad } => {
                // All from where it begins, so that what rounding leaves is small against the way, not
                // against the radius: cos φ − 1 = −2 sin²(φ/2), sin φ = 2 sin(φ/2) cos(φ/2); and of two radii
                // b − a = (b² − a²) / (b + a).
                let (out, end) = (centre.way_to(&self.from), centre.way_to(&to));
                let (begin_mm, end_mm) = (out.length_near(), end.length_near());
                let growth = if begin_mm > 0.0 {
                    self.from.way_to(&to).dot(out.plus(end)) / (begin_mm * (begin_mm + end_mm))
                } else {
                    0.0
                };
                let (sin, cos) = sin_cos(0.5 * sweep_rad * share);
                let wider = growth * share;
                let (along, across) =
                    (wider - 2.0 * sin * sin * (1.0 + wider), 2.0 * sin * cos * (1.0 + wider));
                let way = out.times(along).plus(out.perpendicular().times(across));
                (self.from.after(way), length_mm * share)
            }
            Shape::Parabola { control } => {
                let (before, after) = (self.from.way_to(&control), control.way_to(&to));
                let way = before.times(share * (2.0 - share)).plus(after.times(share * share));
                (self.from.after(way), length_mm * share)
            }
        }
    }
}

/// The place on a course behind this share of its length, 0 to 1.
pub(crate) fn place_on(course: &Course, from: &Point, share: f64) -> Point {
    match course.shape {
        Shape::Line => from.lerp(course.to, share),
        _ => Chords { from: *from, count: 1, next: 0 }.place::<AllModes>(course, single(share)).0,
    }
}

/// So many of so many, as a share.
#[expect(clippy::cast_precision_loss, reason = "numbers of 17 bits")]
fn share(part: u32, whole: u32) -> f32 {
    part as f32 / whole as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec2;
    use crate::kinematics::{Cartesian, MotorScale};

    #[test]
    fn chords_are_as_near_to_a_flat_arc_as_to_a_round_one() {
        /// Half of a step of 400 steps/mm.
        const NEAR_MM: f64 = 1.25e-3;
        let motor = MotorScale { steps_per_mm: 1e6, inverted: false };
        let machine = Cartesian::new(motor, motor).unwrap();
        for (radius_mm, way_mm) in [(10.0, 50.0), (1e3, 900.0), (1e5, 900.0), (1e7, 900.0)] {
            let centre = Point::new(200.0, 100.0 - radius_mm);
            let sweep_rad: f64 = way_mm / radius_mm;
            let from = Point::new(200.0, 100.0);
            let at = |share: f64| {
                let (sin, cos) = ((sweep_rad * share).sin(), (0.5 * sweep_rad * share).sin());
                // As above, but for the last bits.
                from + Vec2::new(-radius_mm * sin, -2.0 * radius_mm * cos * cos)
            };
            let to = at(1.0);
            let shape = Shape::Arc { centre, sweep_rad: single(sweep_rad) };
            let course = Course { shape, to, length_mm: single(way_mm), ..Course::default() };
            let mut chords = Chords::new::<AllModes>(&course, &from, 1e-3);
            let count = f64::from(chords.count);
            for index in 1..=chords.count {
                let chord = chords.next::<AllModes>(&course, &machine).unwrap();
                let place = Point::new(f64::from(chord.to.x) / 1e6, f64::from(chord.to.y) / 1e6);
                let off_mm = place.distance(at(f64::from(index) / count));
                assert!(off_mm < 0.2 * NEAR_MM, "radius {radius_mm}: {off_mm} mm");
            }
        }
    }
}
