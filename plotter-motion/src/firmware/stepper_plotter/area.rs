//! Whether a movement stays within the area.

use crate::extremes::greatest;
use crate::geom::{Vec2Single, single};
use crate::turn::atan2;
use crate::{PlotOp, Point};
use core::f32::consts::FRAC_PI_2;

/// What rounding may put outside, mm, and as a share of the area's side: less than the micrometre in which coordinates are told.
const SLACK_MM: f32 = 5e-4;
const SLACK_SHARE: f32 = 2.5e-7;

/// Whether the way of `op` from `from` stays between (0, 0) and `most`, mm. An arc may go farther than its ends.
pub(super) fn contains(most: Vec2Single, from: &Point, op: &PlotOp) -> bool {
    let inside = |x: f32, y: f32| is_within(x, most.x) && is_within(y, most.y);
    // A pen that stands outside may come back.
    let Some(to) = op.target() else { return true };
    if !inside(single(to.x), single(to.y)) {
        return false;
    }
    let PlotOp::DrawArc { centre, sweep_rad, .. } = *op else { return true };
    let (out, sweep_rad) = (centre.way_to(from), single(sweep_rad));
    let radius_mm = greatest(out.length_near(), centre.way_to(&to).length_near());
    let begin = atan2(out.y, out.x);
    let (low, high) = if sweep_rad < 0.0 { (begin + sweep_rad, begin) } else { (begin, begin + sweep_rad) };
    // A begin of -π to π and a sweep of a turn at most: from -3π to 3π, in quarters.
    let (mut across, mut along) = (-radius_mm, 0.0);
    for quarter in -6_i8..=6 {
        let angle = f32::from(quarter) * FRAC_PI_2;
        if angle >= low && angle <= high && !inside(single(centre.x) + across, single(centre.y) + along) {
            return false;
        }
        (across, along) = (-along, across);
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
}
