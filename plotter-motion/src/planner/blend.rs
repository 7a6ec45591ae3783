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
//! A machine whose acceleration along the path and across it are limited each by a, and that wants to leave a corner as soon as it
//! can, speeds up with a from the apex on: v² = v₀² + 2 a s. What turns as sharply as the limit across allows at every place has
//! there the radius v²/a = r₀ + 2 s. A curve whose radius grows evenly along it is a logarithmic spiral; one that grows by
//! 2 for each unit of its length has the radius r₀ e^(2ψ) where it has turned by ψ. Two of them, mirrored, make the corner.
//!
//! On short segments whose neighbours leave no room for that, a circular arc at an even speed is quicker.

use super::junction::Corner;
use crate::Vec2;

/// By how much the radius of the spirals grows for each unit of their length.
pub(super) const GROWTH: f64 = 2.0;

/// The curve in place of a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Blend {
    /// An arc of this radius.
    Arc { radius_mm: f64 },
    /// A spiral that narrows to this radius at the apex, and its mirror image.
    Spirals {
        radius_mm: f64,
        /// From the vertex to the apex.
        deviation_mm: f64,
    },
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
    pub(super) accel_mm_s2: f64,
}

/// The spirals about an apex of radius 1 that turn by half the corner each.
#[derive(Clone, Copy, Debug, PartialEq)]
struct UnitSpirals {
    /// From the tangent point to the vertex, and from there to the apex.
    tangent: f64,
    deviation: f64,
    /// Length of one.
    length: f64,
}

impl UnitSpirals {
    /// With the apex at the origin and the tangent there along x, a place of the spiral is the integral of e^(2ψ) (cos ψ, sin ψ):
    /// e^(2ψ) (2 cos ψ + sin ψ, 2 sin ψ − cos ψ) / 5, less its value at 0.
    fn new(half_turn_rad: f64) -> Self {
        let (sin, cos) = (libm::sin(half_turn_rad), libm::cos(half_turn_rad));
        let grown = libm::exp(GROWTH * half_turn_rad);
        let x = (grown * (2.0 * cos + sin) - 2.0) / 5.0;
        let y = (grown * (2.0 * sin - cos) + 1.0) / 5.0;
        let tangent = x / cos;
        Self { tangent, deviation: tangent * sin - y, length: (grown - 1.0) / GROWTH }
    }
}

impl Blend {
    /// The quickest curve that there is room for.
    pub(super) fn choose(corner: Corner, turn_rad: f64, room: Room) -> Self {
        let widest_mm = room.cruise2 / room.accel_mm_s2; // wider ones are no quicker
        let arc_mm = corner
            .radius_mm(room.deviation_mm)
            .min(corner.radius_of_tangent_mm(room.tangent_mm))
            .min(widest_mm);
        let arc = Self::Arc { radius_mm: arc_mm };
        let half_rad = 0.5 * turn_rad;
        let unit = UnitSpirals::new(half_rad);
        if arc_mm >= widest_mm || !(unit.tangent > 0.0 && unit.deviation > 0.0 && unit.tangent.is_finite()) {
            return arc;
        }
        let spiral_mm =
            (room.deviation_mm / unit.deviation).min(room.tangent_mm / unit.tangent).min(widest_mm);
        let spirals = Self::Spirals { radius_mm: spiral_mm, deviation_mm: spiral_mm * unit.deviation };
        // From the apex to the far end of the room.
        let beyond_arc_mm = room.tangent_mm - corner.tangent_mm(arc_mm);
        let arc2 = room.accel_mm_s2 * arc_mm;
        let by_arc_s = arc_mm * half_rad / libm::sqrt(arc2) + room.time_s(arc2, beyond_arc_mm);
        let by_spiral_mm = room.tangent_mm + spiral_mm * (unit.length - unit.tangent);
        let by_spiral_s = room.time_s(room.accel_mm_s2 * spiral_mm, by_spiral_mm);
        if by_spiral_s < by_arc_s { spirals } else { arc }
    }

    /// From the vertex to the tangent points, mm.
    pub(super) fn tangent_mm(self, corner: Corner, turn_rad: f64) -> f64 {
        match self {
            Self::Arc { radius_mm } => corner.tangent_mm(radius_mm),
            Self::Spirals { radius_mm, .. } => radius_mm * UnitSpirals::new(0.5 * turn_rad).tangent,
        }
    }

    /// Its length, mm.
    pub(super) fn length_mm(self, turn_rad: f64) -> f64 {
        match self {
            Self::Arc { radius_mm } => radius_mm * turn_rad,
            Self::Spirals { radius_mm, .. } => 2.0 * radius_mm * UnitSpirals::new(0.5 * turn_rad).length,
        }
    }
}

impl Room {
    /// Time for a way that begins with this square of a speed, speeding up, s.
    fn time_s(&self, from2: f64, way_mm: f64) -> f64 {
        let (from2, way_mm) = (from2.min(self.cruise2), way_mm.max(0.0));
        let (from, cruise) = (libm::sqrt(from2), libm::sqrt(self.cruise2));
        let up_mm = (self.cruise2 - from2) / (2.0 * self.accel_mm_s2);
        if up_mm >= way_mm {
            (libm::sqrt(from2 + 2.0 * self.accel_mm_s2 * way_mm) - from) / self.accel_mm_s2
        } else {
            (cruise - from) / self.accel_mm_s2 + (way_mm - up_mm) / cruise
        }
    }
}

/// From a place on a spiral of growth ±2 to its pole: `along` is the direction of travel there, `inwards` the normal towards the side
/// that it turns to, `radius_mm` the radius of curvature.
///
/// The radius vector r e^(kθ) makes the angle with the tangent whose cotangent is k, and is 1/√(1 + k²) of the radius of curvature.
pub(super) fn to_pole(along: Vec2, inwards: Vec2, radius_mm: f64, growth: f64) -> Vec2 {
    (inwards - along * growth) * (radius_mm / (1.0 + growth * growth))
}
