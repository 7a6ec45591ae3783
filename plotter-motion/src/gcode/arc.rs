//! The circle of a `G2` or `G3`.

use super::error::Complaint;
use super::{Position, Problem};
use crate::Point;
use crate::extremes::{greatest, least};
use crate::geom::single;
use crate::root::root;
use crate::turn::atan2;

/// How much farther from the centre one end may be than the other, mm: always, and where it is a thousandth
/// of the radius.
const LEAST_MM: f32 = 0.005;
const MOST_MM: f32 = 0.5;
const MOST_SHARE: f32 = 0.001;

/// A smaller sweep is a whole turn, rad: it is the last bit of 2π in `f32`.
const NO_SWEEP_RAD: f32 = 5e-7;

/// What a chord may be longer than the diameter and still be taken for it, mm: both are rounded to
/// thousandths.
const ROUNDED_MM: f32 = 0.005;

/// How far round an arc goes, rad, above 0 to the `left`; right to 5·10⁻⁷ of itself. One that ends where it
/// begins is a whole circle, exactly.
///
/// The limits are GRBL's (`gcode.c`, version 1.1).
pub(super) fn sweep_rad<C: Complaint>(
    from: Point,
    to: Point,
    centre: Point,
    left: bool,
    at: Position,
) -> Result<f64, C> {
    let (out, end, chord) = (centre.way_to(&from), centre.way_to(&to), from.way_to(&to));
    let (start_mm, end_mm) = (out.length_near(), end.length_near());
    // The difference of both, however great they are: b² − a² = (b − a)(b + a).
    let off_mm = chord.dot(out.plus(end)).abs() / (start_mm + end_mm);
    if off_mm > MOST_MM || (off_mm > LEAST_MM && off_mm > MOST_SHARE * start_mm) || start_mm == 0.0 {
        return Err(Problem::ArcRadii { start_mm: start_mm.into(), end_mm: end_mm.into() }.at(at));
    }
    // With the chord instead of the other radius a small angle is as right as a great one.
    let angle = atan2(out.cross(chord), start_mm * start_mm + out.dot(chord));
    let (mut quarters, mut rest) = quarters(angle);
    if left && angle <= NO_SWEEP_RAD {
        (quarters, rest) = (quarters + 4, if quarters == 0 { least(rest, 0.0) } else { rest });
    } else if !left && angle >= -NO_SWEEP_RAD {
        (quarters, rest) = (quarters - 4, if quarters == 0 { greatest(rest, 0.0) } else { rest });
    }
    Ok(f64::from(quarters) * core::f64::consts::FRAC_PI_2 + f64::from(rest))
}

/// An angle of half a turn at most as quarters of a turn and the rest, rad.
fn quarters(angle: f32) -> (i8, f32) {
    use core::f32::consts::FRAC_PI_2;
    let quarters = if angle.abs() < 0.5 * FRAC_PI_2 {
        0
    } else if angle.abs() < 1.5 * FRAC_PI_2 {
        1
    } else {
        2
    };
    let quarters = if angle < 0.0 { -quarters } else { quarters };
    (quarters, angle - f32::from(quarters) * FRAC_PI_2)
}

/// The centre of an arc with this radius, mm: the one of less than half a turn, or with a negative radius of
/// more.
pub(super) fn centre<C: Complaint>(
    from: Point,
    to: Point,
    radius_mm: f64,
    left: bool,
    at: Position,
) -> Result<Point, C> {
    let chord = from.way_to(&to);
    let length_mm = chord.length_near();
    if length_mm == 0.0 {
        return Err(Problem::ArcWithoutEnd.at(at));
    }
    let (half_mm, signed_mm) = (0.5 * length_mm, single(radius_mm));
    let radius = signed_mm.abs();
    if radius + ROUNDED_MM < half_mm || radius == 0.0 {
        return Err(Problem::ArcRadius { radius_mm, least_mm: half_mm.into() }.at(at));
    }
    // (r - h)(r + h) loses no digits where the arc is nearly a half circle.
    let height_mm = root(greatest((radius - half_mm) * (radius + half_mm), 0.0));
    let height_mm = if left == (signed_mm > 0.0) { height_mm } else { -height_mm };
    Ok(from.after(chord.times(0.5).plus(chord.perpendicular().times(height_mm / length_mm))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gcode::Error;
    use core::f64::consts::{PI, TAU};

    /// What the last digits of `f32` near 10 mm are worth, mm or rad.
    const EXACT: f64 = 1e-6;

    fn sweep_rad(from: Point, to: Point, centre: Point, left: bool) -> Result<f64, Problem> {
        super::sweep_rad(from, to, centre, left, Position::START).map_err(|error: Error| error.problem)
    }

    fn centre(from: Point, to: Point, radius_mm: f64, left: bool) -> Result<Point, Problem> {
        super::centre(from, to, radius_mm, left, Position::START).map_err(|error: Error| error.problem)
    }

    #[test]
    fn a_quarter_a_half_and_three_quarters() {
        let (from, to) = (Point::new(10.0, 0.0), Point::new(0.0, 10.0));
        assert!((sweep_rad(from, to, Point::ORIGIN, true).unwrap() - 0.5 * PI).abs() < EXACT);
        assert!((sweep_rad(from, to, Point::ORIGIN, false).unwrap() + 1.5 * PI).abs() < EXACT);
        let across = Point::new(-10.0, 0.0);
        assert!((sweep_rad(from, across, Point::ORIGIN, true).unwrap() - PI).abs() < EXACT);
        assert!((sweep_rad(from, across, Point::ORIGIN, false).unwrap() + PI).abs() < EXACT);
        assert_eq!(sweep_rad(from, from, Point::ORIGIN, true), Ok(TAU));
        assert_eq!(sweep_rad(from, from, Point::ORIGIN, false), Ok(-TAU));
    }

    #[test]
    fn sweeps_are_right_to_half_a_millionth_of_themselves() {
        const SHARE: f64 = 5e-7;
        let mut radius_mm = 0.718;
        while radius_mm < 1e4 {
            for thousandth in 1..=400 {
                // Up to a turn; of a small one as much as of a great one.
                let begin_rad = 0.618 * f64::from(thousandth);
                let asked_rad =
                    TAU * (f64::from(thousandth) / 401.0) * if thousandth % 2 == 0 { 1.0 } else { 0.1 };
                let centre = Point::new(123.456, -65.4);
                let at = |angle_rad: f64| centre + crate::Vec2::new(radius_mm, 0.0).rotated(angle_rad);
                let (from, to) = (at(begin_rad), at(begin_rad + asked_rad));
                let sweep = sweep_rad(from, to, centre, true).unwrap();
                assert!((sweep / asked_rad - 1.0).abs() <= SHARE, "{radius_mm} mm, {asked_rad}: {sweep}");
                let back = sweep_rad(to, from, centre, false).unwrap();
                assert!((back / asked_rad + 1.0).abs() <= SHARE, "{radius_mm} mm, {asked_rad}: {back}");
                assert_eq!(sweep_rad(from, from, centre, true), Ok(TAU));
                assert_eq!(sweep_rad(from, from, centre, false), Ok(-TAU));
            }
            radius_mm *= 1.37;
        }
    }

    #[test]
    fn the_radius_says_the_centre() {
        let (from, to) = (Point::new(10.0, 0.0), Point::new(0.0, 10.0));
        // Counter-clockwise by a quarter about the origin; by three quarters about (10, 10); clockwise the
        // other way.
        for (radius, left, x) in
            [(10.0, true, 0.0), (-10.0, true, 10.0), (10.0, false, 10.0), (-10.0, false, 0.0)]
        {
            assert!(centre(from, to, radius, left).unwrap().distance(Point::new(x, x)) < EXACT);
        }
        // 14.142 mm apart.
        assert_eq!(centre(from, to, 7.07, true), Ok(Point::new(5.0, 5.0)));
        let refused = centre(from, to, -7.0, true).unwrap_err();
        assert!(matches!(refused, Problem::ArcRadius { least_mm, .. } if (least_mm - 7.071).abs() < 1e-3));
        assert_eq!(centre(from, from, 7.0, true), Err(Problem::ArcWithoutEnd));
    }

    #[test]
    fn ends_may_be_unequally_far_by_what_grbl_allows() {
        let ends = |radius: f64, off: f64| {
            sweep_rad(Point::new(radius, 0.0), Point::new(0.0, radius + off), Point::ORIGIN, true).is_ok()
        };
        assert!(ends(1.0, 0.004) && !ends(1.0, 0.006));
        assert!(ends(100.0, 0.099) && !ends(100.0, 0.101));
        assert!(ends(1000.0, 0.499) && !ends(1000.0, 0.501));
    }
}
