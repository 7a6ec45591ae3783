//! The speed at a corner.
//!
//! ```text
//!                  vertex
//!                    ∧   ┐ deviation
//!                  ╱─┴─╲ ┘          the circle that touches both segments and
//!                ╱       ╲          passes the vertex at that distance
//!              ╱  angle θ  ╲
//! ```

/// Greatest speed, mm/s, at which a corner may be taken.
///
/// A machine that does not stop at a vertex rounds it. The rounding is taken for an arc that touches both segments and passes
/// the vertex at `deviation_mm`; on it the centripetal acceleration v² / r must not exceed `accel_mm_s2`. With θ the angle
/// between the segments and s = sin(θ/2) its radius is r = δ s / (1 − s), so that
///
/// ```text
/// v² = a δ s / (1 − s)
/// ```
///
/// `cos_theta` runs from −1 (straight on: the speed is infinite) to 1 (back the same way: 0). Both other arguments must be
/// finite and not negative; the result is then never NaN.
///
/// Source: S. K. Jeon, "Improving Grbl's cornering algorithm" (2011).
///
/// ```
/// # use plotter_motion::junction_speed;
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

    /// Radius of the arc that touches both segments and passes the vertex at this distance, mm; infinite straight on.
    pub(super) fn radius_mm(self, deviation_mm: f64) -> f64 {
        // 1 − s = c² / (1 + s), without the cancellation.
        let over = deviation_mm * self.sin_half * (1.0 + self.sin_half);
        let under = self.cos_half * self.cos_half;
        if under > 0.0 { over / under } else { f64::INFINITY }
    }

    /// Radius of the arc that touches the segments at this distance from the vertex, mm; infinite straight on.
    pub(super) fn radius_of_tangent_mm(self, tangent_mm: f64) -> f64 {
        if self.cos_half > 0.0 { tangent_mm * self.sin_half / self.cos_half } else { f64::INFINITY }
    }

    /// How far from the vertex an arc of this radius touches the segments, mm; infinite for a way straight back.
    pub(super) fn tangent_mm(self, radius_mm: f64) -> f64 {
        if self.sin_half > 0.0 { radius_mm * self.cos_half / self.sin_half } else { f64::INFINITY }
    }

    /// The greatest square of the speed with which the corner may be taken, mm²/s²: that of [`junction_speed`], and no faster
    /// than on an arc that touches the segments no farther than half their length from the vertex, so that a curve of many
    /// short segments is taken no faster than the curve that it stands for.
    ///
    /// The second rule is that of Klipper (K. O'Connor, its documentation of kinematics, "look-ahead").
    pub(super) fn speed2(self, accel_mm_s2: f64, deviation_mm: f64, shorter_mm: f64) -> f64 {
        let radius_mm = self.radius_mm(deviation_mm).min(self.radius_of_tangent_mm(0.5 * shorter_mm));
        // Straight on both are infinite.
        accel_mm_s2 * radius_mm
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_on_is_unlimited_and_straight_back_is_a_stop() {
        assert_eq!(junction_speed(-1.0, 1000.0, 0.01), f64::INFINITY);
        assert_eq!(junction_speed(1.0, 1000.0, 0.01), 0.0);
        assert_eq!(junction_speed(-1.0, 1000.0, 0.0), f64::INFINITY);
    }

    #[test]
    fn a_right_angle_between_short_segments_is_limited_by_their_length() {
        // tan 45 deg = 1: the arc touches half way along 0.02 mm, radius 0.01 mm
        let speed2 = Corner::new(0.0).speed2(1000.0, 1.0, 0.02);
        assert!((speed2 - 10.0).abs() < 1e-9, "{speed2}");
    }
}
