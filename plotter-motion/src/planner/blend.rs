//! [`Blend`]: how a corner is rounded within a tolerance.
//!
//! ```text
//!              vertex
//!                ∧  ┐
//!              ╱ ─ ╲┘ deviation: the apex lies that far from the vertex
//!            ╱ ╱   ╲ ╲
//!          ╱ │       │ ╲        from one tangent point to the other the curve leaves the segments
//! ```
//!
//! Of all motions that turn one velocity into another of the same size, the quickest has one acceleration, of
//! the greatest size, from the difference of both velocities: its path is a parabola, whose control point is
//! the vertex. With the tangent points the way L from the vertex, a turn by φ and h = φ/2, and with d and d′
//! the directions before and after it,
//!
//! ```text
//! p(s) = p₀ + d s + (d′ − d) s² / 4L        s from 0 to 2L
//! deviation = L sin h / 2                   |p″| = sin h / L
//! ```
//!
//! At an even ṡ = v the acceleration is v² sin h / L towards the inside, everywhere; so the greatest v² is A
//! L / sin h, with the deviation δ 2 A δ / sin² h. An arc with the same deviation is passed at a half to two
//! thirds of that. The least time of any motion that stays within the tolerance on the inner side of the
//! corner is less by at most a fiftieth of the time that the corner takes (found by a convex program for
//! turns of 20 to 170 degrees).
//!
//! [`Course::length_mm`](super::Course::length_mm) of a parabola is 2L, and its speeds are ṡ: they are true
//! at its ends, and between them somewhat more than the true ones.

use super::law::MOST_FORM_SHARE;
use crate::Vec2;

/// The curve in place of a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Blend {
    /// From the vertex to the tangent points, mm.
    pub(super) tangent_mm: f64,
    /// Square of the speed at which all of the acceleration turns it, mm²/s².
    pub(super) form2: f64,
}

/// What a corner has room for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Room {
    /// Greatest distance of the apex from the vertex, mm.
    pub(super) deviation_mm: f64,
    /// Greatest distance of the tangent points from the vertex, mm.
    pub(super) tangent_mm: f64,
    /// Square of the greatest speed, mm²/s².
    pub(super) cruise2: f64,
    /// Greatest acceleration towards the inside of the corner, mm/s².
    pub(super) accel_mm_s2: f64,
}

impl Blend {
    /// The widest parabola that there is room for, but none that is wider than the greatest speed needs.
    pub(super) fn new(lean: f64, room: Room) -> Self {
        let Room { deviation_mm, tangent_mm, cruise2, accel_mm_s2 } = room;
        let of_speed_mm = cruise2 * lean / (accel_mm_s2 * f64::from(MOST_FORM_SHARE));
        let tangent_mm = (2.0 * deviation_mm / lean).min(tangent_mm).min(of_speed_mm);
        Self { tangent_mm, form2: accel_mm_s2 * tangent_mm / lean }
    }

    /// From the vertex to the apex, mm.
    pub(super) fn deviation_mm(self, lean: f64) -> f64 {
        0.5 * lean * self.tangent_mm
    }
}

/// An arc in place of a corner, where the jerk is limited along the path: all along it its speed is the true
/// one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BlendArc {
    /// As of a [`Blend`].
    pub(super) tangent_mm: f64,
    pub(super) form2: f64,
    pub(super) radius_mm: f64,
    pub(super) turn_rad: f64,
}

impl BlendArc {
    /// The widest that there is room for: of radius r it touches the lines at r tan h, and its apex is r
    /// (1/cos h − 1) from the vertex.
    pub(super) fn new(lean: f64, room: Room) -> Self {
        let Room { deviation_mm, tangent_mm, cruise2, accel_mm_s2 } = room;
        let half_rad = libm::asin(lean.min(1.0));
        let (tan, cos) = (libm::tan(half_rad), libm::sqrt((1.0 - lean * lean).max(0.0)));
        // 1 − cos h = sin² h / (1 + cos h), without the cancellation.
        let of_deviation_mm = deviation_mm * cos * (1.0 + cos) / (lean * lean);
        let of_speed_mm = cruise2 / (accel_mm_s2 * f64::from(MOST_FORM_SHARE));
        let radius_mm = of_deviation_mm.min(tangent_mm / tan).min(of_speed_mm);
        Self {
            tangent_mm: radius_mm * tan,
            form2: accel_mm_s2 * radius_mm,
            radius_mm,
            turn_rad: 2.0 * half_rad,
        }
    }

    pub(super) fn length_mm(self) -> f64 {
        self.radius_mm * self.turn_rad
    }
}

/// Sine of half of the turn between two directions of length 1, and the direction towards the inside.
pub(super) fn half_turn(along: Vec2, after: Vec2) -> (f64, Vec2) {
    let change = after - along;
    let length = change.length();
    (0.5 * length, if length > 0.0 { change * (1.0 / length) } else { along.perpendicular() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_right_angle_within_a_twentieth_of_a_millimetre() {
        let (lean, inwards) = half_turn(Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0));
        assert!((lean - 0.5_f64.sqrt()).abs() < 1e-12 && (inwards.x + 0.5_f64.sqrt()).abs() < 1e-12);
        let room = Room { deviation_mm: 0.05, tangent_mm: 1.0, cruise2: 1e4, accel_mm_s2: 1000.0 };
        // L = 2 · 0.05 / 0.7071 = 0.1414 mm, v² = 1000 · 0.1414 / 0.7071 = 200 mm²/s²
        let blend = Blend::new(lean, room);
        assert!((blend.tangent_mm - 0.141_421).abs() < 1e-6 && (blend.form2 - 200.0).abs() < 1e-9);
        // At 10 mm/s half of that is enough: 100 · 0.7071 / 998.
        let slow = Blend::new(lean, Room { cruise2: 100.0, ..room });
        assert!((slow.tangent_mm - 0.070_852).abs() < 1e-6, "{slow:?}");
    }
}
