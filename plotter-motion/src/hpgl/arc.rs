//! [`ArcUnits`]: an arc on the grid of plotter units, with the error that the rounding makes.

use super::UNITS_PER_MM;
use crate::{Point, StepPoint, Vec2, toolpath::from_mm};

/// Farthest that an arc as written may be from the one meant, plotter units; and farthest that the plotter's
/// chords may be from the arc as written.
pub(super) const GREATEST_UNITS: f64 = 1.0;
const CHORD_UNITS: f64 = 0.5;

/// An arc that rises less than this over its chord is a line, plotter units.
pub(super) const FLAT_UNITS: f64 = 0.25;

/// The chord angle that a plotter takes when none is given, degrees.
const USUAL_CHORD_DEG: f64 = 5.0;

/// The finest chord angle that is asked for, degrees: that of HP-GL/2.
const LEAST_CHORD_DEG: f64 = 0.5;

/// An arc as `AA` says it: from where the pen stands, about a centre in whole units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ArcUnits {
    pub(super) centre: StepPoint,
    /// Positive counter-clockwise, in ten-thousandths of a degree.
    pub(super) sweep_e4_deg: i32,
    /// Farthest that it is from what was meant at its middle, or its end from `to`, units.
    pub(super) error_units: f64,
}

impl ArcUnits {
    /// The arc from one place to another on the grid that is nearest to one meant: `centre` in mm, `middle`
    /// the place half way along. It spans less than half a circle, counter-clockwise if `left`.
    pub(super) fn nearest(
        from: StepPoint,
        to: StepPoint,
        centre: Point,
        middle: Point,
        left: bool,
    ) -> Option<Self> {
        let rounded = StepPoint::new(from_mm(centre.x, UNITS_PER_MM), from_mm(centre.y, UNITS_PER_MM));
        let around = (-1..=1).flat_map(|x| (-1..=1).map(move |y| (x, y)));
        let candidates = around.filter_map(|(x, y)| {
            let centre = StepPoint::new(rounded.x.checked_add(x)?, rounded.y.checked_add(y)?);
            Self::about(centre, from, to, middle, left)
        });
        candidates.min_by(|one, other| one.error_units.total_cmp(&other.error_units))
    }

    fn about(centre: StepPoint, from: StepPoint, to: StepPoint, middle: Point, left: bool) -> Option<Self> {
        let (out, end) = (from_to(centre, from), from_to(centre, to));
        let sweep_rad = libm::atan2(out.x * end.y - out.y * end.x, out.x * end.x + out.y * end.y);
        if (sweep_rad > 0.0) != left || sweep_rad == 0.0 {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, reason = "at most 1.8 million")]
        let sweep_e4_deg = libm::round(sweep_rad.to_degrees() * 1e4) as i32;
        let sweep_rad = (f64::from(sweep_e4_deg) / 1e4).to_radians();
        let meant = Vec2::new(
            middle.x * UNITS_PER_MM - f64::from(centre.x),
            middle.y * UNITS_PER_MM - f64::from(centre.y),
        );
        let off = |angle_rad: f64, meant: Vec2| (out.rotated(angle_rad) - meant).length();
        let error_units = off(0.5 * sweep_rad, meant).max(off(sweep_rad, end));
        Some(Self { centre, sweep_e4_deg, error_units })
    }
}

/// The chord angle with which a circle of this radius is drawn near enough, whole degrees where it can be;
/// `None` where the plotter's own does. A chord of the angle a is r (1 − cos(a / 2)) from its arc.
pub(super) fn chord_angle_deg(radius_units: f64) -> Option<f64> {
    let finest_deg = 2.0 * libm::acos(1.0 - (CHORD_UNITS / radius_units).min(1.0)).to_degrees();
    if finest_deg >= USUAL_CHORD_DEG {
        None
    } else if finest_deg >= 1.0 {
        Some(libm::floor(finest_deg))
    } else {
        Some(LEAST_CHORD_DEG)
    }
}

/// Into how many chords an arc has to be divided so that they are near enough.
pub(super) fn chords(radius_units: f64, sweep_rad: f64) -> u32 {
    let finest_rad = 2.0 * libm::acos(1.0 - (CHORD_UNITS / radius_units).min(1.0));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number, clamped")]
    let count = libm::ceil(libm::fabs(sweep_rad) / finest_rad).clamp(1.0, 65_536.0) as u32;
    count
}

fn from_to(from: StepPoint, to: StepPoint) -> Vec2 {
    Vec2::new(f64::from(to.x) - f64::from(from.x), f64::from(to.y) - f64::from(from.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chords_are_as_fine_as_the_radius_asks() {
        // r (1 - cos(a/2)) = 0.5: 5.006 degrees at 524 units, 1 degree at 13131.
        assert_eq!(chord_angle_deg(500.0), None);
        assert_eq!(chord_angle_deg(530.0), Some(4.0));
        assert_eq!(chord_angle_deg(4000.0), Some(1.0));
        assert_eq!(chord_angle_deg(14_000.0), Some(0.5));
        assert_eq!(chords(4000.0, core::f64::consts::PI), 100); // 180 / 1.812 = 99.3
    }

    #[test]
    fn a_quarter_on_the_grid_is_exact() {
        let centre = Point::new(10.0, 10.0);
        let middle = centre + Vec2::new(5.0, 0.0).rotated(core::f64::consts::FRAC_PI_4);
        let arc = ArcUnits::nearest(StepPoint::new(600, 400), StepPoint::new(400, 600), centre, middle, true)
            .unwrap();
        assert_eq!((arc.centre, arc.sweep_e4_deg), (StepPoint::new(400, 400), 900_000));
        assert!(arc.error_units < 1e-9);
    }
}
