//! Whether a movement stays within the area.

use crate::extremes::greater;
use crate::turn::atan2;
use crate::{PlotOp, Point};
use core::f64::consts::FRAC_PI_2;

/// What rounding may put outside, mm.
const SLACK_MM: f64 = 1e-6;

/// Whether the way of `op` from `from` stays between (0, 0) and `most`, mm. An arc may go farther than its ends.
pub(super) fn contains(most: Point, from: Point, op: PlotOp) -> bool {
    let inside = |place: Point| is_within(place.x, most.x) && is_within(place.y, most.y);
    // A pen that stands outside may come back.
    let Some(to) = op.target() else { return true };
    if !inside(to) {
        return false;
    }
    let PlotOp::DrawArc { centre, sweep_rad, .. } = op else { return true };
    let out = from - centre;
    let radius_mm = greater(out.length_near(), (to - centre).length_near());
    let begin = atan2(out.y, out.x);
    let (low, high) = if sweep_rad < 0.0 { (begin + sweep_rad, begin) } else { (begin, begin + sweep_rad) };
    // A begin of -π to π and a sweep of a turn at most: from -3π to 3π, in quarters.
    let (mut across, mut along) = (-radius_mm, 0.0);
    for quarter in -6_i8..=6 {
        let angle = f64::from(quarter) * FRAC_PI_2;
        if angle >= low && angle <= high && !inside(Point::new(centre.x + across, centre.y + along)) {
            return false;
        }
        (across, along) = (-along, across);
    }
    true
}

#[cfg_attr(target_os = "none", inline(never))]
fn is_within(value_mm: f64, most_mm: f64) -> bool {
    value_mm >= -SLACK_MM && value_mm <= most_mm + SLACK_MM
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arc_is_looked_at_as_a_whole() {
        let most = Point::new(100.0, 100.0);
        // Half a circle about (50, 95) over the top, or below.
        let (from, to, centre) = (Point::new(60.0, 95.0), Point::new(40.0, 95.0), Point::new(50.0, 95.0));
        let half = |sweep_rad| PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s: None };
        assert!(!contains(most, from, half(core::f64::consts::PI)));
        assert!(contains(most, from, half(-core::f64::consts::PI)));
    }
}
