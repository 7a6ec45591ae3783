//! [`Limits`]: a planner's settings in the form that every block needs.

use super::law::{Law, MOST_FORM_SHARE};
use super::ring::narrow;
use super::{AccelLimit, PathMode, PlannerSettings};
use crate::extremes::{greatest, least};
use crate::geom::single;
use crate::root::root;
use core::f32::consts::FRAC_1_SQRT_2;

/// Greatest relative rounding of directions and quotients: about eight last bits of `f32`, for the few
/// operations that each has been through.
const ROUNDING: f32 = 1e-6;
/// Least component of a direction. A smaller one counts as 0, since it is no more than the rounding above and
/// would be divided by.
const LEAST_PART: f32 = 1e-6;

/// Values that are the same for every block, computed once. They are `f32`, which small processors have in
/// hardware. Limits and their squares are rounded down; a speed computed from them may be too high by 2·10⁻⁷
/// of itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    pub(super) settings: PlannerSettings,
    /// Greatest accelerations along the axes of the motors, mm/s²: both that of the vector, where it is what is
    /// limited.
    motors: [f32; 2],
    /// Squares of the speeds with the pen down and up.
    pub(super) speed2: f32,
    pub(super) travel2: f32,
    /// Two of the settings, narrowed once. With `averaged-steps`, which makes the settings longer, they are
    /// narrowed at each corner in their stead, and a planner keeps its size.
    #[cfg(not(feature = "averaged-steps"))]
    narrowed_mm: [f32; 2],
}

fn narrowed_mm(settings: &PlannerSettings) -> [f32; 2] {
    [settings.junction_deviation_mm, settings.resolution_mm].map(narrow)
}

impl Limits {
    pub(super) fn of(settings: &PlannerSettings) -> Self {
        /// The pen's share of a belt's motion along its diagonal: √½, rounded down so that no limit is
        /// exceeded.
        const OF_BELT: f32 = FRAC_1_SQRT_2.next_down();
        let PlannerSettings { speed_mm_s, travel_speed_mm_s, accel_mm_s2, accel_limit, .. } = *settings;
        let motors = match accel_limit {
            AccelLimit::Vector => [narrow(accel_mm_s2); 2],
            AccelLimit::Axes { x_mm_s2, y_mm_s2 } => [narrow(x_mm_s2), narrow(y_mm_s2)],
            AccelLimit::Belts { sum_mm_s2, difference_mm_s2 } => {
                [sum_mm_s2, difference_mm_s2].map(|accel| narrow(accel) * OF_BELT)
            }
        };
        Self {
            settings: *settings,
            motors,
            speed2: narrow(speed_mm_s * speed_mm_s),
            travel2: narrow(travel_speed_mm_s * travel_speed_mm_s),
            #[cfg(not(feature = "averaged-steps"))]
            narrowed_mm: narrowed_mm(settings),
        }
    }

    /// How far a corner may be missed by a machine that rounds it by itself, mm.
    pub(super) fn junction_deviation_mm(&self) -> f32 {
        self.narrowed_mm()[0]
    }

    /// What is shorter is no way of its own, mm.
    pub(super) fn resolution_mm(&self) -> f32 {
        self.narrowed_mm()[1]
    }

    fn narrowed_mm(&self) -> [f32; 2] {
        #[cfg(not(feature = "averaged-steps"))]
        return self.narrowed_mm;
        #[cfg(feature = "averaged-steps")]
        narrowed_mm(&self.settings)
    }

    /// Greatest acceleration that every direction allows, mm/s².
    pub(super) const fn accel(&self) -> f32 {
        // Not by a call: each block asks for it.
        let [one, other] = self.motors;
        if one < other { one } else { other }
    }

    /// Greatest accelerations along the axes of the motors, where each is limited for itself.
    pub(super) const fn each_motor(&self) -> Option<[f32; 2]> {
        if matches!(self.settings.accel_limit, AccelLimit::Vector) { None } else { Some(self.motors) }
    }

    /// Whether the acceleration changes with a limited jerk.
    pub(super) const fn has_jerk(&self) -> bool {
        self.settings.jerk_mm_s3.is_some()
    }

    /// A direction, in the axes of the motors.
    pub(super) fn of_motors(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        if matches!(self.settings.accel_limit, AccelLimit::Belts { .. }) {
            [(x + y) * FRAC_1_SQRT_2, (x - y) * FRAC_1_SQRT_2]
        } else {
            [x, y]
        }
    }

    /// Greatest acceleration in a direction (of length 1), mm/s².
    pub(super) fn along(&self, direction: [f32; 2]) -> f32 {
        let [most_one, most_other] = self.motors;
        if matches!(self.settings.accel_limit, AccelLimit::Vector) {
            return most_one;
        }
        let [one, other] = self.of_motors(direction);
        greatest(self.accel(), (1.0 - ROUNDING) / greatest(one.abs() / most_one, other.abs() / most_other))
    }

    /// How hard the machine may speed up and brake along an arc. It turns in every direction, so the vector
    /// is held to what every direction allows, also where each motor is limited for itself.
    /// [`Block`](super::block::Block) documents the argument.
    pub(super) fn arc(&self, per_form2: f32) -> Law {
        Law::Curve { accel: self.accel(), per_form2, lean: 0.0 }
    }

    /// The same along a parabola of this length.
    pub(super) fn parabola(&self, per_form2: f32, lean: f32, inwards: f32, length_mm: f32) -> Law {
        let Some(motors) = self.each_motor() else {
            return Law::Curve { accel: self.accel(), per_form2, lean };
        };
        // Its directions are cos h along the middle, less or more sin h inwards; it bends by sin h / L
        // inwards.
        let one = inwards.abs();
        let inwards = [one, root(greatest(1.0 - one * one, 0.0))];
        let (cos, bend) = (root(greatest(1.0 - lean * lean, 0.0)), 2.0 * lean / length_mm);
        let [most_one, most_other] = motors;
        let along = |most: f32, inwards: f32, level: f32| {
            (1.0 - ROUNDING) * most / greatest(cos * level + lean * inwards, LEAST_PART)
        };
        Law::Motors {
            along: [along(most_one, inwards[0], inwards[1]), along(most_other, inwards[1], inwards[0])],
            per_form2: [inwards[0] * bend / most_one, inwards[1] * bend / most_other],
        }
    }

    /// Greatest acceleration along the path where the jerk is limited, mm/s².
    pub(super) fn along_with_jerk(&self) -> f32 {
        self.along_share() * self.accel()
    }

    /// Greatest acceleration that turns the path towards the inside of a curve, mm/s². See [`Law`] for what
    /// leans.
    pub(super) fn turning(&self, inwards: [f32; 2], lean: f32) -> f32 {
        self.along(inwards) * if self.has_jerk() { self.across_share(lean) / MOST_FORM_SHARE } else { 1.0 }
    }

    /// The same on an arc, which turns in every direction.
    pub(super) fn turning_round(&self) -> f32 {
        self.accel() * if self.has_jerk() { self.across_share(0.0) / MOST_FORM_SHARE } else { 1.0 }
    }

    /// Share of the acceleration that motion with a limited jerk uses along the path. The rest, for turning,
    /// is the same at every speed, since such a motion looks ahead with one limit. In tolerance mode most of
    /// a path is curves, in exact mode lines.
    const fn along_share(&self) -> f32 {
        match self.settings.path {
            PathMode::Exact => 0.9,
            PathMode::Tolerance { .. } => 0.7,
        }
    }

    /// Acceleration that is left for turning if the one along the path is [`Limits::along_share`] of the
    /// limit.
    fn across_share(&self, lean: f32) -> f32 {
        let along = self.along_share();
        if self.each_motor().is_some() {
            1.0 - along
        } else {
            root(1.0 - along * along * (1.0 - lean * lean)) - along * lean
        }
    }

    /// Square of a requested speed, at most `most2`. None if the speed is not finite, or so low that its
    /// square, or an override of it, would lose bits.
    pub(super) fn speed2(speed_mm_s: f64, most2: f32) -> Option<f32> {
        /// Least speed, mm/s. Its square, 1e-32, times the square of the least override, 1e-4, still has all
        /// bits of an `f32`.
        const LEAST_MM_S: f32 = 1e-16;
        let speed = single(speed_mm_s);
        (LEAST_MM_S..f32::INFINITY).contains(&speed).then(|| least(speed * speed, most2))
    }
}

/// Squares of the overrides that a person at the machine sets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shares {
    pub(super) draw2: f32,
    pub(super) travel2: f32,
}

impl Default for Shares {
    fn default() -> Self {
        Self { draw2: 1.0, travel2: 1.0 }
    }
}

/// Which override applies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Share {
    Draw,
    #[default]
    Travel,
    /// None: the requested speed holds.
    Jog,
}

impl Shares {
    /// The square of a requested speed with the override, at most the machine's.
    pub(super) fn of(&self, share: Share, feed2: f32, limits: &Limits) -> f32 {
        match share {
            Share::Draw => least(feed2 * self.draw2, limits.speed2),
            Share::Travel => least(feed2 * self.travel2, limits.travel2),
            Share::Jog => least(feed2, limits.travel2),
        }
    }
}

/// The values that the greatest speed on a block follows from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Wish {
    pub(super) feed_mm_s: f32,
    /// Square of the greatest speed that its form allows.
    pub(super) form2: f32,
    pub(super) share: Share,
}

impl Wish {
    /// Square of the greatest speed with these overrides.
    pub(super) fn cruise2(&self, shares: &Shares, limits: &Limits) -> f32 {
        least(shares.of(self.share, self.feed_mm_s * self.feed_mm_s, limits), self.form2)
    }
}
