//! [`Chords`]: divides a course into chords that end on whole motor steps.

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

/// End of a chord: the motors' position there, and how far along the course it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Chord {
    pub(super) to: StepPoint,
    /// Distance from the start of the course, mm, fixed point with 32 bits of fraction.
    pub(super) end_mm_q32: i64,
}

/// The chords of a course, made one after the other; at most 65,536.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Chords {
    from: Point,
    count: u32,
    next: u32,
}

impl Chords {
    /// Chords of `course`, which begins at `from`, none of them farther from it than `tolerance_mm`, above 0.
    pub(super) fn new<M: Modes>(course: &Course, from: &Point, tolerance_mm: f32) -> Self {
        let count = match course.shape {
            Shape::Line => 1,
            // Never reached: a planner without all modes makes no parabolas. The compiler drops the code for
            // them.
            Shape::Parabola { .. } if !M::ALL => 1,
            Shape::Arc { centre, sweep_rad } => {
                let radius_mm =
                    greatest(centre.way_to(from).length_near(), centre.way_to(&course.to).length_near());
                chord_count(radius_mm, sweep_rad, tolerance_mm)
            }
            Shape::Parabola { control } => {
                // Over an interval u of its parameter, a parabola with the control points P0, P1, P2 deviates
                // from its chord by at most u²/4 · |P0 − 2 P1 + P2|. So 1/u = sqrt(bend / (4 tolerance)).
                let bend = from.way_to(&control).plus(course.to.way_to(&control));
                let count = root(0.25 * bend.length_near() / tolerance_mm);
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "a cast saturates, and a NaN is 0"
                )]
                let whole = count as u16;
                u32::from(whole) + 1 // rounded up
            }
        };
        Self { from: *from, count, next: 0 }
    }

    /// The next chord of the same course; `None` after the last.
    #[cfg_attr(target_os = "none", inline(never))] // a call takes less flash
    pub(super) fn next<M: Modes>(&mut self, course: &Course, kinematics: &impl Kinematics) -> Option<Chord> {
        if self.next >= self.count {
            return None;
        }
        self.next += 1;
        let (point, along_mm) = if self.next == self.count {
            (course.to, course.length_mm)
        } else {
            self.point_at::<M>(course, fraction(self.next, self.count))
        };
        Some(Chord { to: kinematics.steps_at(point), end_mm_q32: fixed(along_mm, FRACTION_BITS) })
    }

    /// The point at a fraction of the course's `length_mm`, and how far along the course it is, mm.
    ///
    /// That is the same fraction of an arc's angle and of a parabola's parameter: the length of a parabola is
    /// by definition that of both legs of its control polygon, which is proportional to the parameter.
    fn point_at<M: Modes>(&self, course: &Course, fraction: f32) -> (Point, f32) {
        let Course { shape, to, length_mm, .. } = *course;
        match shape {
            Shape::Parabola { .. } if !M::ALL => (to, length_mm),
            // It is one chord.
            Shape::Line => (to, length_mm),
            Shape::Arc { centre, sweep_rad } => {
                // Computed relative to the start, so that rounding errors scale with the distance moved, not
                // with the radius: cos φ − 1 = −2 sin²(φ/2) and sin φ = 2 sin(φ/2) cos(φ/2). The radius grows
                // from a to b by b − a = (b² − a²) / (b + a).
                let (start_radius, end_radius) = (centre.way_to(&self.from), centre.way_to(&to));
                let (begin_mm, end_mm) = (start_radius.length_near(), end_radius.length_near());
                let growth = if begin_mm > 0.0 {
                    self.from.way_to(&to).dot(start_radius.plus(end_radius))
                        / (begin_mm * (begin_mm + end_mm))
                } else {
                    0.0
                };
                let (sin, cos) = sin_cos(0.5 * sweep_rad * fraction);
                let radius_growth = growth * fraction;
                let radial = radius_growth - 2.0 * sin * sin * (1.0 + radius_growth);
                let tangential = 2.0 * sin * cos * (1.0 + radius_growth);
                let moved = start_radius.times(radial).plus(start_radius.perpendicular().times(tangential));
                (self.from.after(moved), length_mm * fraction)
            }
            Shape::Parabola { control } => {
                let (before, after) = (self.from.way_to(&control), control.way_to(&to));
                let moved = before.times(fraction * (2.0 - fraction)).plus(after.times(fraction * fraction));
                (self.from.after(moved), length_mm * fraction)
            }
        }
    }
}

/// The point on a course at a fraction of its `length_mm`, 0 to 1.
pub(crate) fn place_on(course: &Course, from: &Point, fraction: f64) -> Point {
    match course.shape {
        Shape::Line => from.lerp(course.to, fraction),
        _ => Chords { from: *from, count: 1, next: 0 }.point_at::<AllModes>(course, single(fraction)).0,
    }
}

/// `part` / `whole`.
#[expect(clippy::cast_precision_loss, reason = "numbers of 17 bits")]
fn fraction(part: u32, whole: u32) -> f32 {
    part as f32 / whole as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec2;
    use crate::kinematics::{Cartesian, MotorScale};

    #[test]
    fn chords_end_on_an_arc_however_flat_it_is() {
        /// Greatest distance of a chord's end from the arc: a fifth of half a step of 400 steps/mm, mm.
        const OFF_MM: f64 = 0.2 * 1.25e-3;
        // Steps of a nanometre, so that their rounding does not count.
        let motor = MotorScale { steps_per_mm: 1e6, inverted: false };
        let machine = Cartesian::new(motor, motor).unwrap();
        for (radius_mm, way_mm) in [(10.0, 50.0), (1e3, 900.0), (1e5, 900.0), (1e7, 900.0)] {
            let centre = Point::new(200.0, 100.0 - radius_mm);
            let sweep_rad: f64 = way_mm / radius_mm;
            let from = Point::new(200.0, 100.0);
            let at = |fraction: f64| {
                let (sin, half_sin) = ((sweep_rad * fraction).sin(), (0.5 * sweep_rad * fraction).sin());
                // The point at a fraction of the angle in double precision, relative to the start.
                from + Vec2::new(-radius_mm * sin, -2.0 * radius_mm * half_sin * half_sin)
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
                assert!(off_mm < OFF_MM, "radius {radius_mm}: {off_mm} mm");
            }
        }
    }
}
