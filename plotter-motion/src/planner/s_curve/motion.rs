//! [`State`]: speed and acceleration along the path, and the hardest braking from there.

use crate::extremes::{greatest, least};
use crate::geom::single;
use crate::root::root;

/// A phase no longer than this is rounding, s: a thousandth of a tick of a microsecond.
pub(super) const SHORTEST_PHASE_S: f64 = 1e-9;
/// The acceleration rises to its greatest in no less than this, s, whatever jerk is allowed: a thousand of
/// the phases above.
const SHORTEST_RISE_S: f64 = 1e-6;
/// A lower speed is a standstill, mm/s: four orders below the least limit that is planned with.
pub(super) const STANDSTILL_MM_S: f64 = 1e-7;
/// The limits along the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    pub(super) accel: f64,
    pub(super) jerk: f64,
}

impl Limits {
    pub(super) fn new(accel: f64, jerk: f64) -> Self {
        Self { accel, jerk: jerk.min(accel / SHORTEST_RISE_S) }
    }
}

/// Speed and acceleration along the path, mm/s and mm/s².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct State {
    pub(super) speed: f64,
    pub(super) accel: f64,
}

/// The times of the hardest braking: to the deepest deceleration, with it, and back to none; s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Braking {
    pub(super) in_s: f64,
    pub(super) steady_s: f64,
    pub(super) out_s: f64,
}

impl State {
    /// After a time with constant jerk; and how far it has come, mm.
    pub(super) fn after(self, jerk: f64, time_s: f64) -> (Self, f64) {
        let Self { speed, accel } = self;
        let t = time_s;
        let way_mm = t * (speed + t * (accel / 2.0 + t * jerk / 6.0));
        (Self { speed: speed + t * (accel + t * jerk / 2.0), accel: accel + t * jerk }, way_mm)
    }

    pub(super) fn is_at_standstill(self) -> bool {
        self.speed <= STANDSTILL_MM_S && self.accel.abs() <= STANDSTILL_MM_S
    }

    /// The greatest speed within a time of constant jerk.
    pub(super) fn peak_within(self, jerk: f64, time_s: f64) -> f64 {
        let turn_s = -self.accel / jerk;
        if self.accel > 0.0 && jerk < 0.0 && turn_s < time_s {
            self.speed + 0.5 * self.accel * turn_s
        } else {
            self.speed.max(self.after(jerk, time_s).0.speed)
        }
    }

    /// The speed that it comes to however soon its acceleration ends.
    pub(super) fn peak(self, limits: Limits) -> f64 {
        let Self { speed, accel } = self;
        speed + if accel > 0.0 { 0.5 * accel * accel / limits.jerk } else { 0.0 }
    }

    /// Jerk and time, s, of the next phase of the quickest way to the cruising speed; none if it would go
    /// beyond it.
    pub(super) fn next_to_cruise(self, cruise: f64, limits: Limits) -> Option<(f64, f64)> {
        if self.cruises(cruise, limits) {
            return None;
        }
        let Self { speed, accel } = self;
        let missing = 2.0 * limits.jerk * (cruise - speed);
        // Up to this acceleration and back to none.
        let peak = libm::sqrt((0.5 * (missing + accel * accel)).max(0.0)).min(limits.accel);
        let up_s = (peak - accel) / limits.jerk;
        if up_s > SHORTEST_PHASE_S {
            return Some((limits.jerk, up_s));
        }
        let excess = missing - accel * accel;
        if accel <= 0.0 || excess < -STANDSTILL_MM_S * limits.jerk {
            return None;
        }
        let steady_s = excess / (2.0 * limits.jerk * accel);
        if steady_s > SHORTEST_PHASE_S {
            Some((0.0, steady_s))
        } else {
            Some((-limits.jerk, accel / limits.jerk))
        }
    }

    /// Whether the motion goes on at cruising speed, but for rounding.
    pub(super) fn cruises(self, cruise: f64, limits: Limits) -> bool {
        self.keeps_its_speed(limits) && self.speed >= cruise * (1.0 - 1e-9)
    }

    /// Whether there is no acceleration, but for rounding.
    pub(super) fn keeps_its_speed(self, limits: Limits) -> bool {
        self.accel.abs() <= 1e-9 * limits.accel
    }

    /// The hardest braking to a speed with no acceleration left; none if that speed is not exceeded in any
    /// case.
    pub(super) fn braking(self, to: f64, limits: Limits) -> Braking {
        let Self { speed, accel } = self;
        let Limits { accel: most, jerk } = limits;
        let excess = speed - to;
        // What the speed changes while the acceleration goes back to none.
        let coming = 0.5 * accel * accel / jerk;
        if accel < 0.0 && excess < coming {
            // It is braking harder than it has to.
            let root = libm::sqrt((accel * accel - 2.0 * jerk * excess).max(0.0));
            let out_s = if excess > 0.0 { (-accel - root) / jerk } else { 0.0 };
            return Braking { out_s, ..Braking::default() };
        }
        let over = jerk * excess + 0.5 * accel * accel;
        if over <= 0.0 || (accel <= 0.0 && excess <= 0.0) {
            return Braking::default();
        }
        let deepest = libm::sqrt(over).min(most);
        let steady_s = ((excess + (0.5 * accel * accel - deepest * deepest) / jerk) / deepest).max(0.0);
        Braking { in_s: ((accel + deepest) / jerk).max(0.0), steady_s, out_s: deepest / jerk }
    }

    /// By how much a braking can be ended before the motion turns back, mm/s.
    pub(super) fn to_let_go(self, limits: Limits) -> f64 {
        let coming = if self.accel < 0.0 { 0.5 * self.accel * self.accel / limits.jerk } else { 0.0 };
        self.speed + STANDSTILL_MM_S - coming
    }

    /// Whether the hardest braking to a speed ends within a distance in any case: by a bound on its length
    /// that takes no difference of numbers. It is at most twice as long as the braking, and so tells of most
    /// places that they do not matter; `f32` is some twenty times as quick on a small processor, and what it
    /// loses is far below the margin.
    pub(super) fn surely_brakes_within(self, to: f64, limits: Limits, distance_mm: f64) -> bool {
        /// What rounding may take from the bound, as a share: hundreds of times what it does take.
        const MARGIN: f32 = 1.001;
        /// Share of a speed that both of two that are nearly the same may have lost by rounding.
        const ROUNDING: f32 = 4.0 * f32::EPSILON;
        let [speed, accel, to] = [self.speed, self.accel, to].map(single);
        let (most, jerk) = (single(limits.accel), single(limits.jerk));
        let rising = greatest(accel, 0.0);
        // As fast as it may come to be, and from there on to the speed.
        let coming = 0.5 * rising * rising / jerk;
        let peak = speed + coming;
        let excess = greatest(peak - to, 0.0) + ROUNDING * greatest(peak, 0.0);
        // To no acceleration; as a triangle or a trapezoid down to the speed.
        let deepest = least(root(jerk * excess), most);
        let down_s = if deepest > 0.0 { deepest / jerk + excess / deepest } else { 0.0 };
        let time_s = accel.abs() / jerk + down_s;
        greatest(peak, 0.0) * time_s * MARGIN < single(distance_mm)
    }

    /// Whether it ends within a distance.
    pub(super) fn brakes_within(self, to: f64, limits: Limits, distance_mm: f64) -> bool {
        self.surely_brakes_within(to, limits, distance_mm) || self.braking_mm(to, limits) <= distance_mm
    }

    /// Length of the hardest braking to a speed, mm.
    pub(super) fn braking_mm(self, to: f64, limits: Limits) -> f64 {
        let Braking { in_s, steady_s, out_s } = self.braking(to, limits);
        let (state, first_mm) = self.after(-limits.jerk, in_s);
        let (state, second_mm) = state.after(0.0, steady_s);
        first_mm + second_mm + state.after(limits.jerk, out_s).1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn what_surely_ends_within_a_distance_does(
            speed in 0.0..1e3_f64,
            share in -1.0..1.0_f64,
            to in prop_oneof![Just(0.0), 0.0..1.0_f64, Just(1.0), 0.999_999..1.000_001],
            accel in 1.0..1e5_f64,
            jerk in 1.0..1e8_f64,
            distance in 0.1..3.0_f64,
        ) {
            let limits = Limits { accel, jerk };
            let (state, to) = (State { speed, accel: share * accel }, to * speed);
            let braking_mm = state.braking_mm(to, limits);
            let distance_mm = distance * braking_mm;
            if state.surely_brakes_within(to, limits, distance_mm) {
                prop_assert!(braking_mm <= distance_mm, "{state:?} to {to}: {braking_mm} mm");
            }
            // It tells where there is twice the room, and some for what rounding may take.
            prop_assert!(
                share < 0.0 || state.surely_brakes_within(to, limits, 2.1 * braking_mm + 0.01 * speed),
                "{state:?} to {to}: {braking_mm} mm"
            );
        }
    }
}
