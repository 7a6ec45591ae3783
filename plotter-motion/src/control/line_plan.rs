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
    /// When the loop ran last, ns of the second, and how fast the reference goes on since: 0 until the line's
    /// first run.
    run_at_ns: i32,
    rate: f32,
    /// How long the plan has been over, us.
    over_us: u32,
    /// How long both shafts have rested at the target, us; `None` while they do not.
    settled_us: Option<u32>,
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
            run_at_ns: 0,
            rate: 0.0,
            over_us: 0,
            settled_us: None,
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
        (self.plan_s, self.rate, self.over_us, self.settled_us) = (0.0, 0.0, 0, None);
    }

    /// How fast the reference goes on for a pen that is off it by `ex`, `ey` counts: 1 as planned, 0 waiting.
    /// It waits for a shaft that is behind, not for one that is ahead: that one waits itself.
    pub(super) fn rate(&self, [ex, ey]: [f32; 2], wait: Wait) -> f32 {
        let [ux, uy] = self.direction;
        let behind = |error: f32, unit: f32| if error * unit < 0.0 { 0.0 } else { error };
        let lag = libm::hypotf(behind(ex, ux), behind(ey, uy));
        (1.0 - (lag - wait.from_counts).max(0.0) / (wait.counts - wait.from_counts)).clamp(0.0, 1.0)
    }

    /// A run of the loop begins, a period after the last one or later: the shafts went on meanwhile as they
    /// were driven, and the reference with them. If it did not, they would be ahead of it, and braked.
    pub(super) fn catch_up(&mut self, now: Duration, period_us: u32) {
        let since_ns = self.since_run_ns(now);
        self.run_at_ns = now.subsec_nanos().cast_signed();
        // A clock that stands tells nothing.
        if since_ns > 0 {
            #[expect(clippy::cast_precision_loss, reason = "f32 is the precision of the control loop")]
            let late_s = since_ns.saturating_sub_unsigned(period_us.saturating_mul(1000)) as f32 * 1e-9;
            self.plan_s += f64::from(late_s * self.rate);
        }
    }

    /// How far along the plan the reference is between two runs, for one that began the last at `run_plan_s`.
    pub(super) fn plan_s_at(&self, now: Duration, run_plan_s: f64) -> f64 {
        run_plan_s + f64::from(self.since_run_ns(now)) / 1e9 * f64::from(self.rate)
    }

    /// Time since the last run, ns. Whole seconds are left out: a loop that is later has lost its line anyway.
    fn since_run_ns(&self, now: Duration) -> i32 {
        let since_ns = now.subsec_nanos().cast_signed() - self.run_at_ns;
        if since_ns < 0 { since_ns + 1_000_000_000 } else { since_ns }
    }

    /// A run of the loop passes.
    pub(super) fn go_on(&mut self, rate: f32, period_us: u32) {
        self.rate = rate;
        let period_s = f64::from(period_us) / 1e6;
        self.plan_s = (self.plan_s + period_s * f64::from(rate)).min(self.plan.duration_s());
        self.over_us = if self.is_over() { self.over_us.saturating_add(period_us) } else { 0 };
    }

    /// Takes note whether both shafts rest at the target, after another run of the loop.
    pub(super) fn settles(&mut self, both_rest: bool, period_us: u32) {
        let settled_us = self.settled_us.unwrap_or_default().saturating_add(period_us);
        self.settled_us = (both_rest && self.is_over()).then_some(settled_us);
    }

    /// Whether both have rested for so long.
    pub(super) fn has_settled(&self, settle_us: u32) -> bool {
        self.settled_us.is_some_and(|settled_us| settled_us >= settle_us)
    }

    /// Where the pen is to be at a time along the plan.
    pub(super) fn reference(&self, plan_s: f64) -> [f64; 2] {
        let [ux, uy] = self.direction.map(f64::from);
        let distance = self.plan.at(plan_s).distance_mm;
        [f64::from(self.start.x) + distance * ux, f64::from(self.start.y) + distance * uy]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_US: u32 = 400;

    /// How far along the plan the reference is after the runs at these multiples of a tenth of the period.
    fn led_s(tenths: &[u64]) -> f64 {
        let limits = MotionLimits { speed_mm_s: 6000.0, accel_mm_s2: 120_000.0, jerk_mm_s3: 8e7 };
        let mut line = LinePlan::at_rest(limits);
        line.to(StepPoint::new(4000, 0), StepPoint::default(), true);
        for tenth in tenths {
            line.catch_up(Duration::from_micros(999_000 + 40 * tenth), PERIOD_US);
            line.go_on(1.0, PERIOD_US);
        }
        line.plan_s()
    }

    #[test]
    fn a_reference_is_where_time_has_led_it_whenever_the_loop_runs() {
        // Four periods and one to come, over the end of a second.
        let punctual_s = led_s(&[0, 10, 20, 30, 40]);
        assert!((punctual_s - 5.0 * 400e-6).abs() < 1e-15);
        for late in [&[0, 14, 20, 39, 40][..], &[0, 10, 40], &[0, 40], &[0, 1, 2, 40]] {
            assert!((led_s(late) - punctual_s).abs() < 1e-9, "{late:?}");
        }
        // A run that comes twice, or before the last one, is a run.
        assert!((led_s(&[0, 0, 0]) - 3.0 * 400e-6).abs() < 1e-15);
    }

    #[test]
    fn a_late_first_run_begins_with_the_line() {
        assert_eq!(led_s(&[70]).to_bits(), led_s(&[0]).to_bits());
    }
}
