//! Where a shaft is between two edges of its encoder, how fast it turns, and what holds it back.

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
    decoding: Decoding,
    observer_rad_s: f32,
    drag_limit: f32,
    /// Count of the interval the shaft is in.
    count: i32,
    /// Place relative to `count`, in counts.
    offset: f32,
    speed: f32,
    drag: f32,
    /// Least and greatest `offset` since the last edge.
    least: f32,
    most: f32,
    since_correction_s: f32,
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
        let mut estimator = Self {
            model,
            decoding,
            observer_rad_s,
            drag_limit: DRAG_SHARE * model.accel_per_volt * model.supply_v,
            count: 0,
            offset: 0.0,
            speed: 0.0,
            drag: 0.0,
            least: 0.0,
            most: 0.0,
            since_correction_s: 0.0,
        };
        estimator.offset = estimator.decoding.rest_offset_counts();
        (estimator.least, estimator.most) = (estimator.offset, estimator.offset);
        estimator
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

    /// What holds the shaft back, counts/s^2: the dry friction of the machine's description and the drag found
    /// beyond it (less than nothing if the machine runs more easily than described).
    #[must_use]
    pub fn friction_counts_s2(&self) -> f32 {
        self.model.dry_friction + self.drag
    }

    /// Moves the estimate on by `dt_s` under `voltage_v`; nothing happens unless the time is above 0 and both are
    /// finite.
    pub fn predict(&mut self, dt_s: f32, voltage_v: f32) {
        if dt_s <= 0.0 || !dt_s.is_finite() || !voltage_v.is_finite() {
            return;
        }
        self.since_correction_s += dt_s;
        let ShaftModel { accel_per_volt, damping_per_s, .. } = self.model;
        let push = accel_per_volt * voltage_v;
        let friction = self.friction_counts_s2();
        if self.speed == 0.0 && push.abs() <= friction.max(0.0) {
            return;
        }
        let sense = if self.speed == 0.0 { push } else { self.speed };
        let accel = push - libm::copysignf(1.0, sense) * friction;
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

    /// Takes an edge, at the moment that was predicted last.
    pub fn edge(&mut self, direction: Direction) {
        let (count, place) = self.edge_place(direction);
        #[expect(clippy::cast_precision_loss, reason = "0, 1 or -1")]
        let moved = count.saturating_sub(self.count) as f32;
        self.count = count;
        self.offset -= moved;
        self.correct(place - self.offset, true);
        (self.least, self.most) = (place, place);
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
            // Something holds the shaft that the model does not know, so where it was thought to be says
            // nothing of the edges it has met.
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

    /// Takes a measured difference into position and speed, and into the drag if it may be blamed: while a
    /// shaft is held fast the drag would only wind up.
    fn correct(&mut self, difference: f32, blame_drag: bool) {
        const SHORTEST_S: f32 = 2e-5; // below a few timer ticks a difference says nothing of the speed
        let t = self.since_correction_s.max(SHORTEST_S);
        let z = libm::expf(-self.observer_rad_s * t);
        let fade = 1.0 - z;
        self.offset += difference * (1.0 - z * z * z);
        self.speed += difference * 1.5 * fade * fade * (1.0 + z) / t;
        if blame_drag && self.speed != 0.0 {
            let drag =
                self.drag - libm::copysignf(1.0, self.speed) * difference * fade * fade * fade / (t * t);
            self.drag = drag.clamp(-self.drag_limit, self.drag_limit);
        }
        self.since_correction_s = 0.0;
    }
}
