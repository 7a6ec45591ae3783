//! Whether a movement stays within the area.

use crate::extremes::greatest;
use crate::geom::{Vec2Single, single};
use crate::turn::atan2;
use crate::{PlotOp, Point};
use core::f32::consts::FRAC_PI_2;

/// What rounding may put outside, mm, and as a share of the area's side: together the micrometre in which
/// coordinates are told at two metres, and 17 of them at 65 m, the longest side.
pub(super) const SLACK_MM: f32 = 5e-4;
const SLACK_SHARE: f32 = 2.5e-7;

/// Whether the way of `op` from `from` stays between (0, 0) and `most`, mm. An arc may go farther than its
/// ends.
pub(super) fn contains(most: Vec2Single, from: &Point, op: &PlotOp) -> bool {
    let inside = |place: &Point| is_within(single(place.x), most.x) && is_within(single(place.y), most.y);
    // A pen that stands outside may come back.
    let Some(to) = op.target() else { return true };
    if !inside(&to) {
        return false;
    }
    let PlotOp::DrawArc { centre, sweep_rad, .. } = *op else { return true };
    let (out, end, sweep_rad) = (centre.way_to(from), centre.way_to(&to), single(sweep_rad));
    let begin_mm = out.length_near();
    // How much greater the other radius is: b − a = (b² − a²) / (b + a).
    let wider_mm = from.way_to(&to).dot(out.plus(end)) / (begin_mm + end.length_near());
    let begin = atan2(out.y, out.x);
    let (low, high) = if sweep_rad < 0.0 { (begin + sweep_rad, begin) } else { (begin, begin + sweep_rad) };
    // A begin of -π to π and a sweep of a turn at most: from -3π to 3π, in quarters.
    let mut outwards = Vec2Single { x: -1.0, y: 0.0 };
    for quarter in -6_i8..=6 {
        let angle = f32::from(quarter) * FRAC_PI_2;
        if angle >= low && angle <= high {
            // From where it begins, so that what rounding leaves is small against the way, not against the
            // radius: r − a = b² / (r + a), where r² = a² + b².
            let (along, across) = (out.dot(outwards), out.cross(outwards));
            let rise_mm = if along > 0.0 { across * across / (begin_mm + along) } else { begin_mm - along };
            let way = outwards.times(rise_mm + greatest(wider_mm, 0.0));
            if !inside(&from.after(way.plus(outwards.perpendicular().times(across)))) {
                return false;
            }
        }
        outwards = outwards.perpendicular();
    }
    true
}

#[cfg_attr(target_os = "none", inline(never))]
fn is_within(value_mm: f32, most_mm: f32) -> bool {
    let slack_mm = SLACK_MM + SLACK_SHARE * most_mm;
    value_mm >= -slack_mm && value_mm <= most_mm + slack_mm
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arc_is_looked_at_as_a_whole() {
        let most = Vec2Single { x: 100.0, y: 100.0 };
        // Half a circle about (50, 95) over the top, or below.
        let (from, to, centre) = (Point::new(60.0, 95.0), Point::new(40.0, 95.0), Point::new(50.0, 95.0));
        let half = |sweep_rad| PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s: None };
        assert!(!contains(most, &from, &half(core::f64::consts::PI)));
        assert!(contains(most, &from, &half(-core::f64::consts::PI)));
    }

    #[test]
    fn an_arc_is_looked_at_from_wherever_it_begins() {
        // A circle about (50, 50) that touches all four sides, or is a hundredth too wide for one of them.
        for (radius_mm, fits) in [(50.0, true), (50.01, false)] {
            for (x, y) in
                [(1.0, 0.0), (0.6, 0.8), (0.0, 1.0), (-0.8, 0.6), (-1.0, 0.0), (0.0, -1.0), (0.8, -0.6)]
            {
                let (wide, high) = (100.0, 100.0);
                let centre = Point::new(50.0, 50.0);
                // Where it begins lies within: all of the circle is drawn that is left.
                let from = Point::new(50.0 + radius_mm * x, 50.0 + radius_mm * y);
                let to = from;
                let most = Vec2Single { x: wide, y: high };
                for sweep_rad in [core::f64::consts::TAU, -core::f64::consts::TAU] {
                    let circle = PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s: None };
                    assert_eq!(contains(most, &from, &circle), fits, "{radius_mm} mm from {from:?}");
                }
            }
        }
    }

    #[test]
    fn a_flat_arc_is_looked_at_to_the_micrometre() {
        /// Nearer to the edge than that is left open here.
        const OPEN_MM: f64 = 1.5e-3;
        let most = Vec2Single { x: 300.0, y: 200.0 };
        for radius_mm in [1e3, 1e4, 1e5, 1e6, 1e7] {
            for half_mm in [1.0, 40.0, 148.197] {
                let rise_mm =
                    half_mm * half_mm / (radius_mm + libm::sqrt(radius_mm * radius_mm - half_mm * half_mm));
                for off_mm in [-0.1, -OPEN_MM, OPEN_MM, 0.1] {
                    let y = 200.0 - rise_mm + off_mm;
                    let (from, to) = (Point::new(150.0 - half_mm, y), Point::new(150.0 + half_mm, y));
                    let centre = Point::new(150.0, 200.0 + off_mm - radius_mm);
                    let sweep_rad = -2.0 * libm::asin(half_mm / radius_mm);
                    let arc = PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s: None };
                    assert_eq!(contains(most, &from, &arc), off_mm < 0.0, "{radius_mm}, {half_mm}, {off_mm}");
                }
            }
        }
    }
}
