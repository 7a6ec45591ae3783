//! [`LinePlan`]: the reference of a line, which waits for a pen that does not follow.

use crate::{
    MotionLimits, StepPoint,
    profile::{ProfilePoint, SCurve},
};
use core::time::Duration;

/// A line under way, in encoder counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LinePlan {
    limits: MotionLimits,
    start: StepPoint,
    target: StepPoint,
    direction: [f32; 2],
    plan: SCurve,
    /// Time along the plan, s; it stands still while the reference waits.
    plan_s: f64,
    /// How long the plan has been over, us.
    over_us: u32,
    /// How long both shafts have rested at the target; `None` while they do not.
    settled_for: Option<Duration>,
}

/// From which lag on the reference slows down, and at which it waits, counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wait {
    pub(super) from_counts: f32,
    pub(super) counts: f32,
}

impl LinePlan {
    /// At rest at the origin.
    pub(super) fn at_rest(limits: MotionLimits) -> Self {
        Self {
            limits,
            start: StepPoint::default(),
            target: StepPoint::default(),
            direction: [1.0, 0.0],
            plan: SCurve::default(),
            plan_s: 0.0,
            over_us: 0,
            settled_for: None,
        }
    }

    pub(super) const fn start(&self) -> StepPoint {
        self.start
    }

    pub(super) const fn target(&self) -> StepPoint {
        self.target
    }

    /// Unit vector of the line.
    pub(super) const fn direction(&self) -> [f32; 2] {
        self.direction
    }

    pub(super) const fn plan_s(&self) -> f64 {
        self.plan_s
    }

    pub(super) fn duration_s(&self) -> f64 {
        self.plan.duration_s()
    }

    /// How long the plan has been over, us.
    pub(super) const fn over_us(&self) -> u32 {
        self.over_us
    }

    pub(super) fn is_over(&self) -> bool {
        self.plan_s >= self.plan.duration_s()
    }

    /// The reference at a time along the plan.
    pub(super) fn at(&self, plan_s: f64) -> ProfilePoint {
        self.plan.at(plan_s)
    }

    /// Takes the next target, for a pen at `position` that `has_arrived` at the last one or was called away.
    pub(super) fn to(&mut self, target: StepPoint, position: StepPoint, has_arrived: bool) {
        let before = self.target;
        self.target = target;
        self.from(if has_arrived || position == before { before } else { position });
    }

    /// Plans the line to the target from where the pen is.
    pub(super) fn from(&mut self, start: StepPoint) {
        let dx = f64::from(self.target.x) - f64::from(start.x);
        let dy = f64::from(self.target.y) - f64::from(start.y);
        let length = libm::hypot(dx, dy);
        if length > 0.0 {
            #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
            let direction = [(dx / length) as f32, (dy / length) as f32];
            self.direction = direction;
        }
        self.start = start;
        self.plan = SCurve::plan(length, self.limits).unwrap_or_default();
        (self.plan_s, self.over_us, self.settled_for) = (0.0, 0, None);
    }

    /// How fast the reference goes on for a pen that is off it by `ex`, `ey` counts: 1 as planned, 0 waiting.
    /// It waits for a shaft that is behind, not for one that is ahead: that one waits itself.
    pub(super) fn rate(&self, [ex, ey]: [f32; 2], wait: Wait) -> f32 {
        let [ux, uy] = self.direction;
        let behind = |error: f32, unit: f32| if error * unit < 0.0 { 0.0 } else { error };
        let lag = libm::hypotf(behind(ex, ux), behind(ey, uy));
        (1.0 - (lag - wait.from_counts).max(0.0) / (wait.counts - wait.from_counts)).clamp(0.0, 1.0)
    }

    /// A run of the loop passes.
    pub(super) fn go_on(&mut self, rate: f32, period: Duration) {
        self.plan_s = (self.plan_s + period.as_secs_f64() * f64::from(rate)).min(self.plan.duration_s());
        let period_us = u32::try_from(period.as_micros()).unwrap_or(u32::MAX);
        self.over_us = if self.is_over() { self.over_us.saturating_add(period_us) } else { 0 };
    }

    /// Takes note whether both shafts rest at the target, after another run of the loop.
    pub(super) fn settles(&mut self, both_rest: bool, period: Duration) {
        let settled_for = self.settled_for.unwrap_or_default().saturating_add(period);
        self.settled_for = (both_rest && self.is_over()).then_some(settled_for);
    }

    /// Whether both have rested for so long.
    pub(super) fn has_settled(&self, settle_us: u32) -> bool {
        self.settled_for.is_some_and(|settled| settled >= Duration::from_micros(u64::from(settle_us)))
    }

    /// Where the pen is to be at a time along the plan.
    pub(super) fn reference(&self, plan_s: f64) -> [f64; 2] {
        let [ux, uy] = self.direction.map(f64::from);
        let distance = self.plan.at(plan_s).distance_mm;
        [f64::from(self.start.x) + distance * ux, f64::from(self.start.y) + distance * uy]
    }
}
