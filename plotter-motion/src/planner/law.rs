//! [`Law`]: how hard the machine may speed up and brake along a stretch of path, at each speed.
//!
//! The acceleration is one vector: along the path it changes the speed, across the path it turns. Let A be
//! the limit, w = v², and W the square of the speed at which turning takes all of A. Then the share u = w / W
//! goes across, and along an arc this is left:
//!
//! ```text
//! a = A √(1 − u²)
//! ```
//!
//! On a parabola that turns by 2h the two are not at right angles. At a share ξ of the way from its apex to
//! its end the turning acceleration leans forwards by λ = ξ sin h, which is negative before the apex, and
//!
//! ```text
//! a² (cos² h + λ²) + 2 a A u λ + A² u² = A²        no less than with        a = A (√(1 − u² (1 − λ²)) − u λ)
//! ```
//!
//! If each motor is limited for itself, with A, it allows b = A / |p′| of its axis along the path, less the
//! share that turning takes: a = b (1 − u) with u of that axis. The lesser of both holds.
//!
//! A change of speed along a stretch is made with one acceleration: the one for the faster of its ends. From
//! w₀ to w₁ = w₀ + 2 a l, with a at w₁, is a quadratic equation in a, so no step forwards or backwards in the
//! look-ahead takes more than a root.

use crate::extremes::{greatest, least};
use crate::root::root;

/// Share of the square of the greatest speed of a form that the machine goes at. At 1 all of the acceleration
/// would go across, nothing were left to begin braking with, and a feed hold would not end. 0.998 leaves a
/// sixteenth, and costs a thousandth of the speed on tight curves.
pub(super) const MOST_FORM_SHARE: f32 = 0.998;
/// Least share of the acceleration that is used. Rounding may put a speed exactly on the limit of its form,
/// where nothing would be left; a sixteenth is left at [`MOST_FORM_SHARE`].
const LEAST_SHARE: f32 = 1e-3;
/// Greatest relative amount by which the roots and quotients below are rounded up: about eight last bits of
/// `f32`.
const ROUNDING: f32 = 1e-6;

/// See the head of this file: how hard the machine may speed up and brake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Law {
    /// A, of a line: the same at every speed, mm/s².
    Line(f32),
    /// Of a curve, for the vector.
    Curve {
        /// A, mm/s².
        accel: f32,
        /// 1 / W, s²/mm².
        per_form2: f32,
        /// λ where it is greatest; 0 on an arc.
        lean: f32,
    },
    /// Of a curve, for both motors: b, mm/s², and 1 / W, s²/mm².
    Motors { along: [f32; 2], per_form2: [f32; 2] },
}

impl Law {
    /// On one of the parts of equal length that a curve is passed in, counted from where the speed is least.
    /// For who brakes that is its end.
    pub(super) fn on_part(self, index: u16, parts: u16) -> Self {
        match self {
            Self::Curve { accel, per_form2, lean } if parts > 1 => {
                // Where it leans backwards it would take from the part along, but less so at a part's slow
                // end.
                let share = 2.0 * (f32::from(index) + 1.0) / f32::from(parts) - 1.0;
                Self::Curve { accel, per_form2, lean: greatest(lean * share, 0.0) }
            }
            _ => self,
        }
    }

    /// The stricter of two laws of the same curve, at every speed.
    pub(super) fn stricter(self, other: Self) -> Self {
        match (self, other) {
            (Self::Curve { lean: one, .. }, Self::Curve { lean, .. }) if one < lean => other,
            _ => self,
        }
    }

    /// The greatest acceleration along the path at a speed, given by its square.
    pub(super) fn accel_at(&self, speed2: f32) -> f32 {
        match *self {
            Self::Line(accel) => accel,
            Self::Curve { accel, per_form2, lean } => {
                let across = least(speed2 * per_form2, 1.0);
                let share = quadratic(across * lean, 1.0, across);
                accel * greatest(share * (1.0 - ROUNDING), LEAST_SHARE)
            }
            Self::Motors { along: [one, other], per_form2: [per_one, per_other] } => {
                let accel = |along: f32, per_form2: f32| {
                    along * greatest((1.0 - speed2 * per_form2) * (1.0 - ROUNDING), LEAST_SHARE)
                };
                least(accel(one, per_one), accel(other, per_other))
            }
        }
    }

    /// Square of the greatest speed after a distance, mm, with one acceleration all along it. Seen backwards,
    /// it is that of the greatest speed before a braking.
    pub(super) fn reach2(&self, from2: f32, way_mm: f32) -> f32 {
        match *self {
            Self::Line(accel) => from2 + 2.0 * accel * way_mm,
            Self::Curve { accel, per_form2, lean } => {
                let across = from2 * per_form2;
                if across >= 1.0 {
                    return from2;
                }
                let most2 = twice(accel) * way_mm;
                let more = most2 * per_form2;
                let share = quadratic(across * (lean + more), 1.0 + more * (2.0 * lean + more), across);
                from2 + most2 * share * (1.0 - ROUNDING)
            }
            Self::Motors { along: [one, other], per_form2: [per_one, per_other] } => {
                let reach2 = |along: f32, per_form2: f32| {
                    let most2 = twice(along) * way_mm;
                    let share = (1.0 - from2 * per_form2) / (1.0 + most2 * per_form2);
                    from2 + most2 * greatest(share, 0.0) * (1.0 - ROUNDING)
                };
                least(reach2(one, per_one), reach2(other, per_other))
            }
        }
    }
}

/// 2 A, reduced so far that no product with a length is rounded above the true one.
pub(super) fn twice(accel: f32) -> f32 {
    2.0 * accel * (1.0 - f32::EPSILON)
}

/// Solves a x² + 2 b x = 1 − u² for x, without a difference of nearly equal numbers.
fn quadratic(b: f32, a: f32, u: f32) -> f32 {
    let over = (1.0 - u) * (1.0 + u);
    let root = root(b * b + a * over);
    if b > 0.0 { over / (b + root) } else { (root - b) / a }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The greatest vector on a parabola or an arc, as a share of A, by the definition: at both ends and
    /// between them.
    fn felt((accel, form2, lean): (f32, f32, f32), speed2: f32, along: f32) -> f64 {
        let (across, along) = (f64::from(speed2 / form2), f64::from(along / accel));
        let most_lean = f64::from(lean);
        let mut most = 0.0_f64;
        for part in -8..=8 {
            let lean = most_lean * f64::from(part) / 8.0;
            let flat = libm::sqrt(1.0 - most_lean * most_lean);
            most = most.max(libm::hypot(along * flat, along * lean + across));
        }
        most
    }

    proptest! {
        #[test]
        fn what_is_felt_is_within_the_limit_and_uses_it(
            accel in 1.0_f32..1e5, form2 in 1e-3_f32..1e6, lean in 0.0_f32..1.0, from in 0.0_f32..0.999, way_mm in 1e-4_f32..1e3,
        ) {
            let (law, curve) = (Law::Curve { accel, per_form2: 1.0 / form2, lean }, (accel, form2, lean));
            let from2 = from * form2;
            let to2 = law.reach2(from2, way_mm);
            prop_assert!(to2 >= from2 && to2 <= form2 * (1.0 + 1e-6), "{to2} of {form2}");
            let along = (to2 - from2) / (2.0 * way_mm);
            prop_assert!(felt(curve, to2, along) <= 1.0 + 1e-4, "felt {}", felt(curve, to2, along));
            // Nothing is given away, but for what a difference of like numbers says.
            let rounding = 3e-7 * to2 / (2.0 * way_mm * accel);
            prop_assert!(along >= law.accel_at(to2) * (1.0 - 1e-4) - rounding * accel - 2e-3 * accel);
            prop_assert!(felt(curve, to2, law.accel_at(to2)) <= 1.0 + 2e-3);
        }

        #[test]
        fn who_is_faster_stays_faster(form2 in 1.0_f32..1e4, lean in 0.0_f32..1.0, one in 0.0_f32..0.99, other in 0.0_f32..0.99, way_mm in 1e-3_f32..10.0) {
            let per_form2 = 1.0 / form2;
            let motors = Law::Motors { along: [1000.0, 3000.0 * (1.0 - lean)], per_form2: [per_form2, per_form2 * lean] };
            for law in [Law::Curve { accel: 1000.0, per_form2, lean }, motors] {
                let (slow, fast) = (one.min(other) * form2, one.max(other) * form2);
                prop_assert!(law.reach2(slow, way_mm) <= law.reach2(fast, way_mm) * (1.0 + 1e-5));
            }
        }
    }

    #[test]
    fn an_arc_from_rest() {
        // Radius 10 mm, 1000 mm/s²: W = 10,000 mm²/s². After 1 mm a = w / 2 and a² + (w / 10)² = 1000², so
        // 0.26 w² = 1000².
        let law = Law::Curve { accel: 1000.0, per_form2: 1e-4, lean: 0.0 };
        assert!((law.reach2(0.0, 1.0) - 1e4 / libm::sqrtf(26.0)).abs() < 0.1);
        // Half of the limit across leaves √¾ along.
        assert!((law.accel_at(5000.0) - 866.025).abs() < 0.01);
        // A line keeps all of it.
        assert_eq!(Law::Line(1000.0).accel_at(5000.0), 1000.0);
        // A motor that does half of the turning has half left, and one that does not turn all.
        let motors = Law::Motors { along: [1000.0, 800.0], per_form2: [1e-4, 0.0] };
        assert!(
            (motors.accel_at(5000.0) - 500.0).abs() < 0.01 && (motors.accel_at(0.0) - 800.0).abs() < 0.01
        );
    }
}
