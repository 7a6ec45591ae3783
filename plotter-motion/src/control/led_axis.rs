//! [`LedAxis`]: a shaft that is led along a plan, whatever the control law.

use super::coasting_bridge::CoastingBridge;
use super::last_counts::LastCounts;
use super::rounded_duty::RoundedDuty;
use super::{AxisTrouble, ShaftEstimator, ShaftModel, ShaftSettings};
use crate::{Axis, Direction, Duty, config::Decoding};
use core::time::Duration;

/// One axis of a controller that leads: its estimate, the drive on it, and how it comes to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LedAxis {
    pub(super) estimator: ShaftEstimator,
    applied: Duty,
    coasting: Option<CoastingBridge>,
    estimated_at: Duration,
    duty: RoundedDuty,
    last: LastCounts,
    /// Whether it is let go in its target's count: what it moves may pull it on, and out of A's high half.
    may_coast: bool,
}

impl LedAxis {
    /// A shaft at rest in the middle of count 0.
    pub(super) fn new(settings: ShaftSettings) -> Self {
        let ShaftSettings { model, decoding, observer_rad_s, pwm_steps, coasting, is_loose } = settings;
        let mut estimator = ShaftEstimator::with_model(model, decoding, observer_rad_s);
        if coasting.is_some() {
            estimator.in_jerks();
        }
        Self {
            estimator,
            applied: Duty::ZERO,
            coasting,
            estimated_at: Duration::ZERO,
            duty: RoundedDuty::none(pwm_steps),
            last: LastCounts::AT_REST,
            may_coast: (is_loose || coasting.is_some()) && decoding == Decoding::X1,
        }
    }

    pub(super) const fn duty(&self) -> Duty {
        self.duty.get()
    }

    /// What became of its duty.
    pub(super) const fn applied(&mut self, duty: Duty) {
        self.applied = duty;
    }

    /// A line begins.
    pub(super) const fn start(&mut self) {
        self.estimator.start();
        self.last.start();
    }

    /// Brings the estimate up to `now`.
    pub(super) fn predict(&mut self, now: Duration) {
        let dt_s = now.saturating_sub(self.estimated_at).as_secs_f32();
        self.estimated_at = self.estimated_at.max(now);
        let ShaftModel { accel_per_volt, supply_v, dry_friction, .. } = *self.estimator.model();
        let speed = self.estimator.speed_counts_s();
        let share = match &self.coasting {
            Some(bridge) => bridge.voltage(self.applied, speed),
            None => self.applied.value(),
        };
        let creep = match &self.coasting {
            Some(bridge) if speed == 0.0 => {
                bridge.creep(self.applied, dry_friction, accel_per_volt * supply_v)
            }
            _ => 0.0,
        };
        self.estimator.predict_pulses(dt_s, share * supply_v, creep);
    }

    /// Takes an edge; how far from the resting place of the count that it leads into it lies, counts.
    pub(super) fn edge(&mut self, now: Duration, direction: Direction) -> f32 {
        self.predict(now);
        self.last.edge();
        self.estimator.edge(direction)
    }

    /// Whether the shaft is left alone where it stands, with its motor short-circuited. Called once a run of
    /// the loop.
    pub(super) fn rests(
        &mut self,
        may_rest: bool,
        target: i32,
        tolerance_counts: f32,
        period_us: u32,
    ) -> bool {
        self.last.wait(period_us);
        let rests = may_rest && self.last.rests(self.estimator.motion(), target, tolerance_counts);
        if rests {
            self.duty.stop();
            if self.last.stands() {
                self.estimator.stands();
            }
        }
        rests
    }

    /// Whether it has come to stand: `Some(true)` far beside its target.
    pub(super) const fn stands_far(&self, target: i32) -> Option<bool> {
        if self.last.stands() { Some(self.last.is_far(self.estimator.motion(), target)) } else { None }
    }

    /// Goes towards the target count by count, if with the plan over for so long it is near enough; says
    /// whether it does.
    pub(super) fn inches(&mut self, target: i32, over_us: u32, period_us: u32) -> bool {
        let inches = self.last.is_near(self.estimator.motion(), target, over_us);
        if inches {
            if self.last.stands() {
                self.estimator.stands();
            }
            let duty = self.last.inch(self.estimator.distance_from(target), period_us);
            self.give(duty);
        }
        inches
    }

    /// Lets a shaft go whose friction now brings it to rest in its target's count; says whether it does.
    pub(super) fn coasts(&mut self, target: i32) -> bool {
        // So near to the middle of A's high half, which is a quarter of a count to either side.
        const NEAR_COUNTS: f32 = 0.2;
        let motion = self.estimator.motion();
        let way = motion.speed * motion.speed.abs() / (2.0 * self.estimator.model().dry_friction);
        let coasts = self.may_coast
            && motion.count == target
            && (motion.distance_from(target) + way).abs() <= NEAR_COUNTS;
        if coasts {
            self.duty.stop();
        }
        coasts
    }

    /// The duty beyond what the control law asks for, while something `is_stuck` that should go `towards` a
    /// side.
    pub(super) fn lean(&mut self, is_stuck: bool, towards: f32, period_us: u32) -> f32 {
        self.last.lean(is_stuck, towards, period_us)
    }

    /// Drives a shaft that is on its way `towards` a side. It is braked only while it surely turns that way:
    /// braked for longer it would turn round, and an edge that it meets then may be a new one or the last one
    /// again, which no x1 encoder tells.
    pub(super) fn drive(&mut self, duty: f32, towards: f32) {
        if duty * towards < 0.0 && !self.estimator.motion().surely_turns(towards) {
            self.duty.stop();
        } else {
            self.give(duty);
        }
    }

    /// A shaft that is held is let go for a while.
    fn give(&mut self, duty: f32) {
        if self.estimator.lets_go() {
            self.duty.stop();
            self.last.let_go();
        } else {
            // a try is as hard as it is, whatever the control law asks for
            let tried = self.estimator.most_duty().filter(|_| duty != 0.0);
            let duty = tried.map_or(duty, |most| libm::copysignf(most, duty));
            self.duty.set(match &self.coasting {
                Some(bridge) => bridge.duty(duty, self.estimator.speed_counts_s()),
                None => duty,
            });
        }
    }

    /// Leaves it without drive, with its motor short-circuited.
    pub(super) const fn stop(&mut self) {
        self.duty.stop();
    }

    /// The duty by which the motor as it is found to be does what one as described would do under `duty` at
    /// this speed, counts/s.
    pub(super) fn as_described(&self, duty: f32, speed: f32) -> f32 {
        let (told, found) = (self.estimator.described(), self.estimator.model());
        let sense = if speed == 0.0 { 0.0 } else { libm::copysignf(1.0, speed) };
        let accel = told.accel_per_volt * told.supply_v * duty
            + (found.damping_per_s - told.damping_per_s) * speed
            + (found.dry_friction - told.dry_friction) * sense;
        accel / (found.accel_per_volt * found.supply_v)
    }
}

/// What is wrong with either axis; what stops the motors comes first.
pub(super) fn trouble_of(x: &LedAxis, y: &LedAxis) -> Option<AxisTrouble> {
    let of = |axis: Axis, led: &LedAxis| led.estimator.trouble().map(|trouble| AxisTrouble { axis, trouble });
    match (of(Axis::X, x), of(Axis::Y, y)) {
        (Some(x), Some(y)) if y.trouble.stops() && !x.trouble.stops() => Some(y),
        (x, y) => x.or(y),
    }
}
