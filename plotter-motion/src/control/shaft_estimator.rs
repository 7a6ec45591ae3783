//! Where a shaft is between two edges of its encoder, how fast it turns, and what holds it back.

use super::shaft_motion::{Fading, ShaftMotion};
use crate::{AxisConfig, Decoding, Direction};
use core::f64::consts::TAU;

/// Estimates position, speed and friction of a motor's shaft from the times of its encoder's edges and the
/// voltage on it.
///
/// An edge says exactly where the shaft is at that moment; between edges the motor's equation (spec 1.8, with
/// the armature's quick current left out) says how it goes on. Each edge corrects the three states with the
/// gains of a critically damped fading-memory filter of third order, `1 - z³`, `3/2 (1-z)²(1+z)/T`,
/// `(1-z)³/T²` with `z = exp(-2 pi f T)` for the time `T` since the last correction. The third state is a drag
/// against the motion, beyond the dry friction of the machine's description: it changes its sign with the
/// motion, so what one line taught is right for the next, and for the way back.
///
/// Source of the gains: E. Brookner, "Tracking and Kalman Filtering Made Easy" (1998), section 1.2.9 and table
/// 1.2-1 (critically damped g-h-k filter).
///
/// It also knows what *no* edge says: the shaft is still between the two edges next to it. And it resolves the
/// ambiguity of ×1 decoding (see [`QuadratureX1`](crate::QuadratureX1)): an edge may be that of the next interval,
/// as the decoder thinks, or that of the interval the shaft is in, met a second time. It is the second if the
/// estimate has been beyond that edge since the last one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShaftEstimator {
    model: ShaftModel,
    drag_limit: f32,
    motion: ShaftMotion,
    drag: f32,
}

/// A motor and its load as the control loop sees them, in encoder counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShaftModel {
    /// Acceleration by voltage, counts/s^2 per V.
    pub accel_per_volt: f32,
    /// Loss of speed by back EMF and viscous friction, 1/s.
    pub damping_per_s: f32,
    /// Loss of speed by dry friction, counts/s^2.
    pub dry_friction: f32,
    /// Greatest voltage, V.
    pub supply_v: f32,
}

impl ShaftModel {
    /// The model of an axis: `K = Kt/(R J)`, `damping = (Ke Kt/R + b)/J`, `friction = Tc/J`, times counts a
    /// radian.
    #[must_use]
    pub fn new(config: &AxisConfig) -> Self {
        let motor = &config.motor;
        let counts_per_rad = config.counts_per_turn() / TAU;
        // a carriage on a belt is moved as if it were on the shaft
        let m_per_rad = config.mm_per_rad() / 1e3;
        let carriage = config.transmission.carriage_kg * m_per_rad * m_per_rad;
        let inertia = motor.inertia_kg_m2 + config.load.inertia_kg_m2 + carriage;
        let friction = config.load.coulomb_n_m + config.transmission.rail_friction_n * m_per_rad;
        let torque_per_volt = motor.torque_n_m_per_a / motor.resistance_ohm;
        let damping = (torque_per_volt * motor.back_emf_v_s + config.load.viscous_n_m_s) / inertia;
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        Self {
            accel_per_volt: (torque_per_volt / inertia * counts_per_rad) as f32,
            damping_per_s: damping as f32,
            dry_friction: (friction / inertia * counts_per_rad) as f32,
            supply_v: motor.supply_v as f32,
        }
    }
}

impl ShaftEstimator {
    /// A shaft at rest in the middle of count 0.
    #[must_use]
    pub fn new(config: &AxisConfig, observer_hz: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        let observer_rad_s = (observer_hz * TAU) as f32;
        Self::with_model(ShaftModel::new(config), config.encoder.decoding, observer_rad_s)
    }

    /// The same from a model of the shaft, the encoder's decoding and the filter's 2 pi f, rad/s.
    #[must_use]
    pub fn with_model(model: ShaftModel, decoding: Decoding, observer_rad_s: f32) -> Self {
        // What a drag may be, as a share of what the supply can push: more would only wind up while a shaft
        // is held fast.
        const DRAG_SHARE: f32 = 0.1;
        Self {
            model,
            drag_limit: DRAG_SHARE * model.accel_per_volt * model.supply_v,
            motion: ShaftMotion::at_rest(decoding, observer_rad_s),
            drag: 0.0,
        }
    }

    pub(super) const fn motion(&self) -> &ShaftMotion {
        &self.motion
    }

    /// The model it reckons with.
    #[must_use]
    pub const fn model(&self) -> &ShaftModel {
        &self.model
    }

    /// The count of the interval that the shaft is in.
    #[must_use]
    pub const fn count(&self) -> i32 {
        self.motion.count
    }

    /// How far the shaft is from the resting place of `count`, in counts.
    #[must_use]
    pub fn distance_from(&self, count: i32) -> f32 {
        self.motion.distance_from(count)
    }

    /// Speed, counts/s.
    #[must_use]
    pub const fn speed_counts_s(&self) -> f32 {
        self.motion.speed
    }

    /// What holds the shaft back, counts/s^2: the dry friction of the machine's description and the drag found
    /// beyond it (less than nothing if the machine runs more easily than described).
    #[must_use]
    pub fn friction_counts_s2(&self) -> f32 {
        self.model.dry_friction + self.drag
    }

    /// Takes the shaft for one that stands where it is thought to be; where it was thought to be on the way there says nothing of
    /// the edges to come.
    pub const fn stands(&mut self) {
        self.motion.stands();
    }

    /// Takes note that it took `voltage_v` to break the shaft loose: that is friction, unless it is more than friction can be.
    pub fn broke_loose(&mut self, voltage_v: f32) {
        let beyond = self.model.accel_per_volt * voltage_v.abs() - self.model.dry_friction;
        if beyond <= self.drag_limit {
            self.drag = self.drag.max(beyond);
        }
    }

    /// Moves the estimate on by `dt_s` under `voltage_v`; nothing happens unless the time is above 0 and both are
    /// finite.
    pub fn predict(&mut self, dt_s: f32, voltage_v: f32) {
        if dt_s <= 0.0 || !dt_s.is_finite() || !voltage_v.is_finite() {
            return;
        }
        self.motion.wait(dt_s);
        let ShaftModel { accel_per_volt, damping_per_s, .. } = self.model;
        let push = accel_per_volt * voltage_v;
        // A motor that runs more easily than described moves more under the same push; without a push it does not.
        let friction = self.friction_counts_s2().max(-push.abs());
        let speed = self.motion.speed;
        if speed == 0.0 && push.abs() <= friction.max(0.0) {
            return;
        }
        let sense = if speed == 0.0 { push } else { speed };
        let accel = push - libm::copysignf(1.0, sense) * friction;
        self.motion.turn(dt_s, accel, sense, damping_per_s);
    }

    /// Takes an edge, at the moment that was predicted last.
    pub fn edge(&mut self, direction: Direction) {
        let place = self.motion.enter(direction);
        let difference = place - self.motion.offset;
        let Fading { fade, t } = self.motion.correct(difference);
        // While a shaft is held fast, the drag would only wind up.
        let speed = self.motion.speed;
        if speed != 0.0 {
            let drag = self.drag - libm::copysignf(1.0, speed) * difference * fade * fade * fade / (t * t);
            self.drag = drag.clamp(-self.drag_limit, self.drag_limit);
        }
        self.motion.stands_at(place);
    }

    /// Takes note that no edge came up to the moment that was predicted last.
    pub fn no_edge(&mut self) {
        if let Some(inside) = self.motion.without_edge() {
            // Something holds the shaft that the model does not know: that is no drag, and where it was thought to be says
            // nothing of the edges it has met.
            self.motion.correct(inside - self.motion.offset);
            self.motion.offset = inside;
            self.motion.stands_at(inside);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT_S: f32 = 1e-4;

    /// An estimator that was taught, by a shaft that goes on under full braking, that friction is less than nothing.
    fn taught_less_than_nothing() -> ShaftEstimator {
        let mut estimator = ShaftEstimator::new(&AxisConfig::default(), 150.0);
        for _ in 0..200 {
            for _ in 0..4 {
                estimator.predict(DT_S, -1.0);
                estimator.no_edge();
            }
            estimator.edge(Direction::Plus);
        }
        assert!(estimator.friction_counts_s2() < 0.0);
        estimator
    }

    #[test]
    fn no_friction_however_learned_moves_a_shaft_by_itself() {
        let mut estimator = taught_less_than_nothing();
        let mut speed = estimator.speed_counts_s().abs();
        for _ in 0..1000 {
            estimator.predict(DT_S, 0.0);
            assert!(estimator.speed_counts_s().abs() <= speed);
            speed = estimator.speed_counts_s().abs();
        }
    }

    #[test]
    fn what_it_takes_to_break_loose_is_friction_unless_it_is_far_too_much() {
        let mut estimator = ShaftEstimator::new(&AxisConfig::default(), 150.0);
        let (described, accel_per_volt) = (estimator.friction_counts_s2(), estimator.model().accel_per_volt);
        estimator.broke_loose(-1.0); // of 12 V
        assert!((estimator.friction_counts_s2() / accel_per_volt - 1.0).abs() < 1e-3);
        estimator.broke_loose(6.0); // a hand
        assert!((estimator.friction_counts_s2() / accel_per_volt - 1.0).abs() < 1e-3);
        assert!(described < estimator.friction_counts_s2());
    }
}
