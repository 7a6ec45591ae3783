//! The speed at a corner.
//!
//! ```text
//!                  vertex
//!                    ∧   ┐ deviation
//!                  ╱─┴─╲ ┘          the circle that touches both segments and
//!                ╱       ╲          passes the vertex at that distance
//!              ╱  angle θ  ╲
//! ```

use super::limits::Limits;
use crate::extremes::least;
use crate::root::root;

/// Greatest speed, mm/s, at which a corner may be taken.
///
/// A machine that does not stop at a vertex rounds it. The rounding is taken for an arc that touches both
/// segments and passes the vertex at `deviation_mm`; on it the centripetal acceleration v² / r must not
/// exceed `accel_mm_s2`. With θ the angle between the segments and s = sin(θ/2) its radius is r = δ s / (1 −
/// s), so that
///
/// ```text
/// v² = a δ s / (1 − s)
/// ```
///
/// `cos_theta` runs from −1 (straight on: the speed is infinite) to 1 (back the same way: 0). Both other
/// arguments must be finite and not negative; the result is then never NaN.
///
/// Source: S. K. Jeon, "Improving Grbl's cornering algorithm" (2011).
///
/// ```
/// # use plotter_motion::planner::junction_speed;
/// // a right angle: s = 0.7071, r = 0.05 * 2.4142 = 0.1207 mm, v = sqrt(1000 * 0.1207)
/// let right_angle = junction_speed(0.0, 1000.0, 0.05);
/// assert!((right_angle - 10.987).abs() < 1e-3);
/// ```
#[must_use]
pub fn junction_speed(cos_theta: f64, accel_mm_s2: f64, deviation_mm: f64) -> f64 {
    libm::sqrt(accel_mm_s2 * Corner::new(cos_theta).radius_mm(deviation_mm))
}

/// A corner between two straight segments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    /// sin(θ/2) and cos(θ/2) of the angle θ between the segments: 1 and 0 straight on.
    sin_half: f64,
    cos_half: f64,
}

impl Corner {
    pub(super) fn new(cos_theta: f64) -> Self {
        let cos_theta = cos_theta.clamp(-1.0, 1.0);
        Self { sin_half: libm::sqrt(0.5 * (1.0 - cos_theta)), cos_half: libm::sqrt(0.5 * (1.0 + cos_theta)) }
    }

    /// Radius of the arc that touches both segments and passes the vertex at this distance, mm; infinite
    /// straight on.
    pub(super) fn radius_mm(self, deviation_mm: f64) -> f64 {
        // 1 − s = c² / (1 + s), without the cancellation.
        let over = deviation_mm * self.sin_half * (1.0 + self.sin_half);
        let under = self.cos_half * self.cos_half;
        if under > 0.0 { over / under } else { f64::INFINITY }
    }
}

/// Least turn, rad. `f32` cannot tell a smaller one from none: it is some last bits of a direction's
/// components.
const LEAST_TURN: f32 = 4e-7;

/// The greatest square of the speed with which a corner between two directions (of length 1) may be taken,
/// mm²/s²: that of [`junction_speed`], and no faster than on an arc that touches the segments no farther than
/// half their length from the vertex, so that a curve of many short segments is taken no faster than the
/// curve that it stands for.
///
/// In `f32`, which small processors reckon with in hardware, and rounded to the safe side. From the sine of
/// the turn, so that a small one is not lost in the difference of its cosine from 1.
///
/// The second rule is that of Klipper (K. O'Connor, its documentation of kinematics, "look-ahead").
pub(super) fn corner_speed2(before: [f32; 2], after: [f32; 2], shorter_mm: f32, limits: &Limits) -> f32 {
    let ([x, y], [u, v]) = (before, after);
    let (cos_turn, sin_turn) = (x * u + y * v, (x * v - y * u).abs());
    if cos_turn > 0.0 && sin_turn <= LEAST_TURN {
        return f32::INFINITY;
    }
    // The angle θ between the segments and the turn make half a turn together.
    let major = root(0.5 * (1.0 + cos_turn.abs()));
    let minor = 0.5 * sin_turn / major;
    let (sin_half, cos_half) = if cos_turn > 0.0 { (major, minor) } else { (minor, major) };
    let (sin_half, cos_half) = (sin_half * (1.0 - LEAST_TURN), cos_half + LEAST_TURN);
    // The part of the acceleration that it takes points from one direction to the other.
    let change =
        if limits.each_motor().is_some() { [u - x, v - y].map(|way| way / (2.0 * cos_half)) } else { after };
    let of_deviation = limits.junction_deviation_mm() * (1.0 + sin_half) / cos_half;
    limits.along(change) * sin_half / cos_half * least(of_deviation, 0.5 * shorter_mm)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PlannerSettings;
    use crate::geom::single;

    #[test]
    fn straight_on_is_unlimited_and_straight_back_is_a_stop() {
        assert_eq!(junction_speed(-1.0, 1000.0, 0.01), f64::INFINITY);
        assert_eq!(junction_speed(1.0, 1000.0, 0.01), 0.0);
        assert_eq!(junction_speed(-1.0, 1000.0, 0.0), f64::INFINITY);
    }

    #[test]
    fn a_right_angle_between_short_segments_is_limited_by_their_length() {
        let settings = PlannerSettings { junction_deviation_mm: 1.0, ..PlannerSettings::default() };
        // tan 45 deg = 1: the arc touches half way along 0.02 mm, radius 0.01 mm, at 1000 mm/s²
        let speed2 = corner_speed2([1.0, 0.0], [0.0, 1.0], 0.02, &Limits::of(&settings));
        assert!((10.0 - 2e-5..=10.0).contains(&speed2), "{speed2}");
    }

    #[test]
    fn single_precision_is_never_faster_and_hardly_slower() {
        let limits = Limits::of(&PlannerSettings::default());
        for turn_rad in [1e-5, 1e-3, 0.1, 1.0, 1.6, 3.0, 3.1] {
            let after = [libm::cos(turn_rad), libm::sin(turn_rad)];
            let exact = junction_speed(-after[0], 1000.0, 0.01);
            let found = corner_speed2([1.0, 0.0], after.map(single), 1e9, &limits);
            let share = libm::sqrt(f64::from(found)) / exact;
            // what is put on the safe side is 4e-7 of a radian
            assert!((1.0 - 4e-6 - 1e-6 / turn_rad..=1.0).contains(&share), "{turn_rad}: {share}");
        }
    }
}
