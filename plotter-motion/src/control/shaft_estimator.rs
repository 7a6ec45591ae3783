//! Estimates a shaft between two edges of its encoder: position, speed and disturbance.

use super::shaft_fit::ShaftFit;
use super::shaft_motion::{Fading, ShaftMotion};
use super::watch::{Trouble, Watch};
use crate::{
    Direction,
    config::{AxisConfig, Decoding},
};
use core::f64::consts::TAU;

/// Estimates position and speed of a motor's shaft, and what motor and load are, from the times of its
/// encoder's edges and the voltage on it.
///
/// An edge says exactly where the shaft is at that moment; between edges the motor's equation (Öcal, section
/// 4.6.1, with the armature's quick current left out) says how it goes on. Each edge corrects the three
/// states with the gains of a critically damped fading-memory filter of third order, `1 - z³`,
/// `3/2 (1-z)²(1+z)/T`, `(1-z)³/T²` with `z = exp(-2 pi f T)` for the time `T` since the last edge. The third
/// state is an acceleration beyond the model, of any cause and sign; it is never more than the model may be
/// wrong by, and is forgotten when the shaft stands.
///
/// Source of the gains: E. Brookner, "Tracking and Kalman Filtering Made Easy" (1998), section 1.2.9 and
/// table 1.2-1 (critically damped g-h-k filter).
///
/// The model is the description's at first. While the shaft turns, its constants are found by recursive least
/// squares from the mean speeds between edges: a description that is wrong by a quarter in each constant is
/// right to a hundredth after some tens of edges.
///
/// It also knows what *no* edge says: the shaft is still between the two edges next to it, and was slower
/// than thought. And it resolves the ambiguity of ×1 decoding (see
/// [`QuadratureX1`](crate::encoder::QuadratureX1)): an edge may be that of the next interval, as the decoder
/// thinks, or that of the interval the shaft is in, met a second time. A shaft that was driven one way only
/// since it was last known where it is met the first edge on that way; else it is the one that is nearer to
/// the estimate.
///
/// ```
/// # use plotter_motion::{Direction, config::AxisConfig, control::ShaftEstimator};
/// let mut estimator = ShaftEstimator::new(&AxisConfig::default(), 150.0);
/// estimator.predict(1e-3, 1.0); // a volt for a millisecond: it begins to turn
/// let place = estimator.edge(Direction::Plus);
/// assert_eq!((estimator.count(), place), (1, -0.25)); // at the start of count 1, a quarter before the middle of A's high half
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShaftEstimator {
    model: ShaftModel,
    fit: ShaftFit,
    motion: ShaftMotion,
    watch: Watch,
    disturbance: f32,
    rested: bool,
    voltage_v: f32,
}

/// A motor and its load as the control loop sees them, in encoder counts.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
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
        Self {
            model,
            fit: ShaftFit::new(model),
            motion: ShaftMotion::at_rest(decoding, observer_rad_s),
            watch: Watch::NOTHING,
            disturbance: 0.0,
            rested: true,
            voltage_v: 0.0,
        }
    }

    /// Pulses move the shaft.
    pub(super) const fn in_jerks(&mut self) {
        self.motion.in_jerks();
    }

    pub(super) const fn motion(&self) -> &ShaftMotion {
        &self.motion
    }

    /// The model it reckons with: the described one, as far as it has not found a better one.
    #[must_use]
    pub const fn model(&self) -> &ShaftModel {
        &self.model
    }

    /// The model of the description.
    pub(super) const fn described(&self) -> &ShaftModel {
        self.fit.described()
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

    /// Fault of the motor or its encoder, if one was found.
    #[must_use]
    pub const fn trouble(&self) -> Option<Trouble> {
        self.watch.trouble()
    }

    /// The duty that a shaft which did not move is tried with; `None` for any.
    pub(super) fn most_duty(&self) -> Option<f32> {
        let ShaftModel { accel_per_volt, supply_v, .. } = self.model;
        // Friction may be none: a hundredth of the supply moves such a shaft.
        const LEAST: f32 = 0.01;
        let most = self.watch.most_accel(self.most_friction())?;
        Some((most / (accel_per_volt * supply_v)).max(LEAST))
    }

    /// Friction as described or as found, whichever is more.
    fn most_friction(&self) -> f32 {
        self.model.dry_friction.max(self.fit.described().dry_friction)
    }

    /// Whether it is to be left without drive.
    pub(super) const fn lets_go(&self) -> bool {
        self.watch.lets_go()
    }

    /// Somebody wants it to move again.
    pub(super) const fn start(&mut self) {
        self.watch.start();
    }

    /// Estimated disturbance: acceleration that the model does not explain, counts/s^2.
    #[must_use]
    pub const fn disturbance_counts_s2(&self) -> f32 {
        self.disturbance
    }

    /// Forgets the disturbance, for a motion in another direction.
    pub const fn forget(&mut self) {
        self.disturbance = 0.0;
    }

    /// Takes the shaft for one that stands where it is thought to be.
    pub const fn stands(&mut self) {
        self.motion.stands(self.model.dry_friction);
        self.disturbance = 0.0;
        self.rested = true;
    }

    /// Moves the estimate on by `dt_s` under `voltage_v`; nothing happens unless the time is above 0 and both
    /// are finite.
    pub fn predict(&mut self, dt_s: f32, voltage_v: f32) {
        self.predict_pulses(dt_s, voltage_v, 0.0);
    }

    /// The same for a shaft that pulses push on at `creep` counts/s while their mean does not move it.
    pub(super) fn predict_pulses(&mut self, dt_s: f32, voltage_v: f32, creep: f32) {
        if dt_s <= 0.0 || !dt_s.is_finite() || !voltage_v.is_finite() {
            return;
        }
        self.motion.wait(dt_s);
        self.fit.pass(dt_s, voltage_v, self.motion.surely_turns(self.motion.speed));
        self.voltage_v = voltage_v;
        let ShaftModel { accel_per_volt, damping_per_s, dry_friction, .. } = self.model;
        let drive = accel_per_volt * voltage_v;
        if self.motion.may_turn_under(drive, dry_friction) {
            self.fit.interrupted();
        }
        self.watch.pass(dt_s, drive, self.most_friction());
        let speed = self.motion.speed;
        let terms = drive.abs() + dry_friction + damping_per_s * speed.abs();
        let doubt = self.fit.doubt() * terms;
        // What is not known of a shaft that nothing drives is less than what it is known to do.
        let push = drive + self.disturbance.clamp(-doubt, doubt);
        if speed == 0.0 && push.abs() <= dry_friction {
            self.fit.interrupted();
            self.motion.creeps(creep * dt_s);
            return;
        }
        let sense = if speed == 0.0 { push } else { speed };
        let accel = push - libm::copysignf(dry_friction, sense);
        self.motion.doubts(doubt, dt_s);
        self.motion.turn(dt_s, accel, sense, damping_per_s);
    }

    /// Takes an edge, at the moment that was predicted last, and says where it lies: how far from the resting
    /// place of the [`count`](Self::count) that it leads into, in counts.
    pub fn edge(&mut self, direction: Direction) -> f32 {
        if !self.motion.goes_on(direction) {
            self.fit.interrupted();
        }
        let place = self.motion.enter(direction);
        let difference = place - self.motion.offset;
        let doubt = self.fit.doubt();
        // The first edge after a rest tells of the place of that rest, too, which was known so well.
        const REST_COUNTS2: f32 = 0.02;
        let share = if self.rested { doubt * doubt / (doubt * doubt + REST_COUNTS2) } else { 1.0 };
        self.rested = false;
        let Fading { fade, t } = self.motion.correct(difference, share);
        let ShaftModel { accel_per_volt, damping_per_s, dry_friction, supply_v } = self.model;
        let braking = dry_friction + damping_per_s * self.motion.speed.abs();
        // What stretches between shaft and pen is in no model.
        const LEAST_DOUBT: f32 = 0.15;
        self.watch.edge(direction, accel_per_volt * supply_v, braking, doubt.max(LEAST_DOUBT));
        let most = doubt * (accel_per_volt * self.voltage_v.abs() + braking);
        let disturbance = self.disturbance + share * difference * fade * fade * fade / (t * t);
        self.disturbance = disturbance.clamp(-most, most);
        #[expect(clippy::cast_precision_loss, reason = "1 or -1")]
        let sense = direction.sign() as f32;
        self.fit.edge(sense);
        place - self.motion.decoding.rest_offset_counts()
    }

    /// Takes note that no edge came up to the moment that was predicted last.
    pub fn no_edge(&mut self) {
        self.motion.without_edge(self.model.dry_friction);
        if let Some(model) = self.fit.found() {
            self.model = model;
        }
        if self.fit.has_changed() {
            self.watch.changed();
        }
    }
}
