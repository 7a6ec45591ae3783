//! How fast a machine may be that knows only so many of its steps.
//!
//! A machine with the speed v has v²/2 of energy (for each kilogram), and a way s on which it may brake with
//! a takes a·s of it. So it can stand where the known steps end if v²/2 is no more than the sum of a·s over
//! all of them; when it is more, the times between the steps are stretched so that it is as much. The machine
//! then brakes with exactly a, and where it curves it turns less hard than planned. Where more steps become
//! known it speeds up again with a. Both sides count energies in units of [`Energy`].

use crate::planner::Shape;
use crate::{PlannerSettings, planner::AccelLimit};

/// Energy that is braked away on a step with the greatest acceleration, in the units in which it is counted:
/// they fit twice into a word, and the sum over 65,536 of them into 31 bits.
const PER_STEP: f32 = 16_384.0;
/// Least energy of a machine that moves: a quarter of that of its first step from rest, half as fast.
pub(super) const LEAST_ENERGY: u32 = 4_096;
/// Greatest energy that is told: a machine of which no queue could brake it away.
const MOST_ENERGY: f32 = 1e9;
/// Share of the acceleration with which a machine brakes that runs out of steps. The rest is for the rounding
/// of times to microseconds, and of energies.
const BRAKES: f32 = 0.95;

/// What energies are counted by, of one machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Energy {
    /// The least of the greatest accelerations in any direction, mm/s².
    accel_mm_s2: f32,
    /// Units in 1 mm²/s².
    per_mm2_s2: f32,
}

impl Energy {
    pub(super) fn of(settings: &PlannerSettings, steps_per_mm: f64) -> Self {
        let accel = match settings.accel_limit {
            AccelLimit::Vector => settings.accel_mm_s2,
            AccelLimit::Axes { x_mm_s2, y_mm_s2 } => x_mm_s2.min(y_mm_s2),
            AccelLimit::Belts { sum_mm_s2, difference_mm_s2 } => {
                core::f64::consts::FRAC_1_SQRT_2 * sum_mm_s2.min(difference_mm_s2)
            }
        };
        #[expect(clippy::cast_possible_truncation, reason = "limits are between 1e-6 and 1e12")]
        let (accel_mm_s2, steps_per_mm) = (accel as f32, steps_per_mm as f32);
        Self { accel_mm_s2, per_mm2_s2: PER_STEP * steps_per_mm / accel_mm_s2 }
    }

    /// That of a speed.
    pub(super) fn at_speed(&self, speed_mm_s: f32) -> u32 {
        whole(0.5 * speed_mm_s * speed_mm_s * self.per_mm2_s2, MOST_ENERGY)
    }

    /// How long a machine takes to brake, us: v/a.
    pub(super) fn braking_us(&self, speed_mm_s: f32) -> u64 {
        whole(1e6 * speed_mm_s / (BRAKES * self.accel_mm_s2), MOST_ENERGY).into()
    }

    /// What is braked away on each of some steps along a way.
    pub(super) fn per_step(&self, curve: Curve, speed_mm_s: f32, way_mm: f32, steps: u16) -> u16 {
        let brakes = BRAKES * self.accel_mm_s2 * curve.left(speed_mm_s, self.accel_mm_s2);
        let energy = brakes * way_mm * self.per_mm2_s2 / f32::from(steps.max(1));
        u16::try_from(whole(energy, f32::from(u16::MAX))).unwrap_or(u16::MAX)
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is in range")]
fn whole(value: f32, most: f32) -> u32 {
    // What is no number is none.
    if value > 0.0 { if value < most { value as u32 } else { most as u32 } } else { 0 }
}

/// How the path curves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in super::super) enum Curve {
    #[default]
    Line,
    /// 1 / radius, 1/mm.
    Arc(f32),
    /// It rises or falls, and with that may curve.
    #[cfg(feature = "third-motor")]
    Rising {
        /// Acceleration along it by which z is driven as hard as it may be, mm/s².
        of_z_mm_s2: f32,
        bends: bool,
    },
    /// A corner that is rounded: a length on which nothing is braked.
    Corner,
}

impl Curve {
    pub(in super::super) fn of(shape: &Shape, length_mm: f32) -> Self {
        match shape {
            Shape::Line => Self::Line,
            Shape::Arc { sweep_rad, .. } if length_mm > 0.0 => Self::Arc(sweep_rad.abs() / length_mm),
            Shape::Arc { .. } | Shape::Parabola { .. } => Self::Corner,
        }
    }

    /// Share of the acceleration that turning leaves at a speed.
    fn left(self, speed_mm_s: f32, accel_mm_s2: f32) -> f32 {
        match self {
            Self::Line => 1.0,
            Self::Arc(per_mm) => {
                let across = speed_mm_s * speed_mm_s * per_mm / accel_mm_s2;
                if across < 1.0 { libm::sqrtf(1.0 - across * across) } else { 0.0 }
            }
            #[cfg(feature = "third-motor")]
            Self::Rising { of_z_mm_s2, bends } => {
                let in_plane = if bends { crate::planner::HELIX_SHARE } else { 1.0 };
                crate::extremes::least(in_plane, of_z_mm_s2 / accel_mm_s2)
            }
            Self::Corner => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn on_its_braking_way_a_machine_brakes_its_energy_away() {
        let settings = PlannerSettings::default(); // 1000 mm/s²
        let energy = Energy::of(&settings, 80.0);
        let (speed_mm_s, steps) = (100.0, 400_u16);
        // 5 mm of 80 steps: v² / 2a.
        let each = energy.per_step(Curve::Line, speed_mm_s, 5.0, steps);
        let (all, has) = (f64::from(each) * f64::from(steps), f64::from(energy.at_speed(speed_mm_s)));
        assert!((all / has - f64::from(BRAKES)).abs() < 1e-3, "{all} {has}");
        assert_eq!(energy.at_speed(f32::NAN), 0);
        // On a circle that takes 0.8 of the acceleration, 0.6 is left: a radius of 12.5 mm.
        let on_arc = energy.per_step(Curve::Arc(1.0 / 12.5), speed_mm_s, 5.0, steps);
        assert!((f64::from(on_arc) / f64::from(each) - 0.6).abs() < 1e-3, "{on_arc} {each}");
        assert_eq!(energy.per_step(Curve::Corner, speed_mm_s, 5.0, steps), 0);
    }
}
