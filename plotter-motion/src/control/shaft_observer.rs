//! [`ShaftObserver`]: where a shaft is between two edges, from a model that may be far from the truth.

use super::ShaftModel;
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
    decoding: Decoding,
    observer_rad_s: f32,
    /// Count of the interval the shaft is in.
    count: i32,
    /// Place relative to `count`, in counts.
    offset: f32,
    speed: f32,
    disturbance: f32,
    /// Least and greatest `offset` since the last edge.
    least: f32,
    most: f32,
    since_correction_s: f32,
}

impl ShaftObserver {
    /// A shaft at rest in the middle of count 0, by a model of it, the encoder's decoding and the filter's 2 pi f, rad/s.
    #[must_use]
    pub const fn new(model: ShaftModel, decoding: Decoding, observer_rad_s: f32) -> Self {
        let offset = decoding.rest_offset_counts();
        Self {
            model,
            decoding,
            observer_rad_s,
            count: 0,
            offset,
            speed: 0.0,
            disturbance: 0.0,
            least: offset,
            most: offset,
            since_correction_s: 0.0,
        }
    }

    /// The model it reckons with.
    #[must_use]
    pub const fn model(&self) -> &ShaftModel {
        &self.model
    }

    /// The count of the interval that the shaft is in.
    #[must_use]
    pub const fn count(&self) -> i32 {
        self.count
    }

    /// How far the shaft is from the resting place of `count`, in counts.
    #[must_use]
    pub fn distance_from(&self, count: i32) -> f32 {
        #[expect(clippy::cast_precision_loss, reason = "a checked machine has at most 99999 counts")]
        let whole = self.count.saturating_sub(count) as f32;
        whole + (self.offset - self.decoding.rest_offset_counts())
    }

    /// Speed, counts/s.
    #[must_use]
    pub const fn speed_counts_s(&self) -> f32 {
        self.speed
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
        (self.speed, self.disturbance) = (0.0, 0.0);
        (self.least, self.most) = (self.offset, self.offset);
    }

    /// Takes the shaft for one that stands at the resting place of its count, or with an x1 encoder in A's high half at least:
    /// there it was led, and no model is so good that it would know better.
    pub fn rests(&mut self) {
        if self.decoding == Decoding::X1 {
            self.offset = self.offset.clamp(0.0, 0.5);
        }
        self.stands();
    }

    /// Moves the estimate on by `dt_s` under `voltage_v`; nothing happens unless the time is above 0 and both are
    /// finite.
    pub fn predict(&mut self, dt_s: f32, voltage_v: f32) {
        if dt_s <= 0.0 || !dt_s.is_finite() || !voltage_v.is_finite() {
            return;
        }
        self.since_correction_s += dt_s;
        let ShaftModel { accel_per_volt, damping_per_s, dry_friction, .. } = self.model;
        let push = accel_per_volt * voltage_v + self.disturbance;
        if self.speed == 0.0 && push.abs() <= dry_friction {
            return;
        }
        let sense = if self.speed == 0.0 { push } else { self.speed };
        let accel = push - libm::copysignf(dry_friction, sense);
        // exact for a constant push: the speed tends to accel / damping with the time constant 1 / damping
        let decay = libm::expf(-damping_per_s * dt_s);
        let last = accel / damping_per_s;
        let next = last + (self.speed - last) * decay;
        if next * sense < 0.0 && self.speed != 0.0 {
            // friction stops the shaft on the way: it covers half of what it would at this speed until then
            self.offset += self.speed * self.speed / (self.speed - next) * dt_s / 2.0;
            self.speed = 0.0;
        } else {
            self.offset += last * dt_s + (self.speed - last) * ((1.0 - decay) / damping_per_s);
            self.speed = next;
        }
        self.least = self.least.min(self.offset);
        self.most = self.most.max(self.offset);
    }

    /// Takes an edge, at the moment that was predicted last, and says where it lies: how far from the resting place of the
    /// [`count`](Self::count) that it leads into, in counts.
    ///
    /// `planned` is the direction of a motion under way, if there is one: an x1 edge in it is the next one, whatever the estimate says.
    pub fn edge(&mut self, direction: Direction, planned: Option<Direction>) -> f32 {
        if planned == Some(direction) {
            (self.least, self.most) = (self.offset.max(0.0), self.offset.min(0.5));
        }
        let (count, place) = self.edge_place(direction);
        #[expect(clippy::cast_precision_loss, reason = "0, 1 or -1")]
        let moved = count.saturating_sub(self.count) as f32;
        self.count = count;
        self.offset -= moved;
        self.correct(place - self.offset, true);
        (self.least, self.most) = (place, place);
        place - self.decoding.rest_offset_counts()
    }

    /// Takes note that no edge came up to the moment that was predicted last.
    pub fn no_edge(&mut self) {
        let (least, most) = match self.decoding {
            Decoding::X1 => (-0.5, 1.0),
            Decoding::X2 | Decoding::X4 => (0.0, 1.0),
        };
        let inside = self.offset.clamp(least, most);
        if inside != self.offset {
            self.correct(inside - self.offset, false);
            self.offset = inside;
            (self.least, self.most) = (inside, inside);
        }
    }

    /// The count after an edge, and the edge's place relative to it.
    fn edge_place(&self, direction: Direction) -> (i32, f32) {
        // How far beyond an edge the estimate must have been for it to be met a second time.
        const BEYOND_COUNTS: f32 = 0.1;
        let next = self.count.saturating_add(direction.sign());
        match (self.decoding, direction) {
            (Decoding::X2 | Decoding::X4, Direction::Plus) => (next, 0.0),
            (Decoding::X2 | Decoding::X4, Direction::Minus) => (next, 1.0),
            // Forwards the counted edge is the start of A's high half, backwards its end.
            (Decoding::X1, Direction::Plus) => {
                let again = self.least < -BEYOND_COUNTS && self.offset < 0.5;
                (if again { self.count } else { next }, 0.0)
            }
            (Decoding::X1, Direction::Minus) => {
                let again = self.most > 0.5 + BEYOND_COUNTS && self.offset > 0.0;
                (if again { self.count } else { next }, 0.5)
            }
        }
    }

    /// Takes a measured difference into position and speed, and into the disturbance if it may be blamed: while a
    /// shaft is held fast that would only wind up.
    fn correct(&mut self, difference: f32, blame: bool) {
        const SHORTEST_S: f32 = 2e-5; // below a few timer ticks a difference says nothing of the speed
        const MOST_OF_SUPPLY: f32 = 0.3;
        let t = self.since_correction_s.max(SHORTEST_S);
        let z = libm::expf(-self.observer_rad_s * t);
        let fade = 1.0 - z;
        self.offset += difference * (1.0 - z * z * z);
        self.speed += difference * 1.5 * fade * fade * (1.0 + z) / t;
        if blame {
            let most = MOST_OF_SUPPLY * self.model.accel_per_volt * self.model.supply_v;
            let disturbance = self.disturbance + difference * fade * fade * fade / (t * t);
            self.disturbance = disturbance.clamp(-most, most);
        }
        self.since_correction_s = 0.0;
    }
}
