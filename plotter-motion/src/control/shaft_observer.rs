//! [`ShaftObserver`]: where a shaft is between two edges, from a model that may be far from the truth.

use super::ShaftModel;
use super::shaft_motion::{Fading, ShaftMotion};
use crate::{Decoding, Direction};

/// Estimates position, speed and disturbance of a motor's shaft from the times of its encoder's edges and the voltage on it.
///
/// As [`ShaftEstimator`](super::ShaftEstimator), with another third state: an acceleration of any sign and any cause, where
/// the estimator learns a friction that turns with the motion. The estimator remembers from one line to the next, and is the better one for motors that are
/// nearly as described; this one forgets, and is steady where motors differ by half from their description, since nothing
/// in it can take a wrong mass for a friction below nothing.
///
/// Gains and their source are those of the estimator: a critically damped fading-memory filter of third order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShaftObserver {
    model: ShaftModel,
    motion: ShaftMotion,
    disturbance: f32,
}

impl ShaftObserver {
    /// A shaft at rest in the middle of count 0, by a model of it, the encoder's decoding and the filter's 2 pi f, rad/s.
    #[must_use]
    pub const fn new(model: ShaftModel, decoding: Decoding, observer_rad_s: f32) -> Self {
        Self { model, motion: ShaftMotion::at_rest(decoding, observer_rad_s), disturbance: 0.0 }
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

    /// What moves it beyond what its model says, counts/s^2.
    #[must_use]
    pub const fn disturbance_counts_s2(&self) -> f32 {
        self.disturbance
    }

    /// Forgets the disturbance, for a motion in another direction.
    pub const fn forget(&mut self) {
        self.disturbance = 0.0;
    }

    /// Takes the shaft for one that stands where it is thought to be; where it was thought to be on the way there says nothing of
    /// the edges to come.
    pub const fn stands(&mut self) {
        self.motion.stands();
        self.disturbance = 0.0;
    }

    /// Takes the shaft for one that stands at the resting place of its count, or with an x1 encoder in A's high half at least:
    /// there it was led, and no model is so good that it would know better.
    pub fn rests(&mut self) {
        self.motion.rests();
        self.disturbance = 0.0;
    }

    /// Moves the estimate on by `dt_s` under `voltage_v`; nothing happens unless the time is above 0 and both are
    /// finite.
    pub fn predict(&mut self, dt_s: f32, voltage_v: f32) {
        if dt_s <= 0.0 || !dt_s.is_finite() || !voltage_v.is_finite() {
            return;
        }
        self.motion.wait(dt_s);
        let ShaftModel { accel_per_volt, damping_per_s, dry_friction, .. } = self.model;
        let push = accel_per_volt * voltage_v + self.disturbance;
        let speed = self.motion.speed;
        if speed == 0.0 && push.abs() <= dry_friction {
            return;
        }
        let sense = if speed == 0.0 { push } else { speed };
        let accel = push - libm::copysignf(dry_friction, sense);
        self.motion.turn(dt_s, accel, sense, damping_per_s);
    }

    /// Takes an edge, at the moment that was predicted last, and says where it lies: how far from the resting place of the
    /// [`count`](Self::count) that it leads into, in counts.
    ///
    /// `planned` is the direction of a motion under way, if there is one: an x1 edge in it is the next one, whatever the estimate says.
    pub fn edge(&mut self, direction: Direction, planned: Option<Direction>) -> f32 {
        // What the disturbance may be, as a share of what the supply can push.
        const MOST_OF_SUPPLY: f32 = 0.3;
        if planned == Some(direction) {
            (self.motion.least, self.motion.most) =
                (self.motion.offset.max(0.0), self.motion.offset.min(0.5));
        }
        let place = self.motion.enter(direction);
        let difference = place - self.motion.offset;
        let Fading { fade, t } = self.motion.correct(difference);
        let most = MOST_OF_SUPPLY * self.model.accel_per_volt * self.model.supply_v;
        let disturbance = self.disturbance + difference * fade * fade * fade / (t * t);
        self.disturbance = disturbance.clamp(-most, most);
        self.motion.stands_at(place);
        place - self.motion.decoding.rest_offset_counts()
    }

    /// Takes note that no edge came up to the moment that was predicted last.
    pub fn no_edge(&mut self) {
        if let Some(inside) = self.motion.without_edge() {
            // While a shaft is held fast, the disturbance would only wind up.
            self.motion.correct(inside - self.motion.offset);
            self.motion.offset = inside;
            self.motion.stands_at(inside);
        }
    }
}
