//! [`PlannedLine`]: a reference that moves along the line as planned, and a controller that follows it.

use super::last_counts::LastCounts;
use super::rounded_duty::RoundedDuty;
use super::{
    AxisState, ContourController, ContourState, ContouringSettings, LineController, ShaftObserver,
    ShaftSettings,
};
use crate::{Axis, Demand, Direction, Drive, Duty, Machine, SCurve, StepPoint};
use core::time::Duration;

/// Makes a [`LineController`] of a [`ContourController`]: everything but the control law.
///
/// ```text
///  targets ──▶ SCurve along the line ──▶ reference ─┐
///                                                   ├─▶ ContourController ──▶ Demand ──▶ whole steps of the duty
///  edges and applied drive ──▶ ShaftObserver ──────┘
/// ```
///
/// The plan has the limits of the machine's `[control.contouring]`, and the control law runs `loop_hz` times a second. While the
/// pen lags behind, the reference slows down and finally waits, so that one motor waits for another that is held fast. When
/// the plan is over, an axis that stands in the middle of its target's count gets no drive, and one that stands a few counts
/// beside it is pushed there count by count; both having stood there for `settle_ms`, the pen has arrived. What rounding to the steps of the duty took or gave is made up for in the next run.
///
/// ```
/// # use core::time::Duration;
/// # use plotter_motion::control::{LineController, PlannedLine, PlannedPid, TwoAxes};
/// # use plotter_motion::{Machine, MachineConfig, StepPoint};
/// let machine = Machine::new(MachineConfig::default())?;
/// let mut controller = PlannedLine::new(&machine, TwoAxes::<PlannedPid>::of(&machine));
/// let mut demand = controller.start(Duration::ZERO, StepPoint::new(0, -400));
/// for run in 1..=20 {
///     demand = controller.tick(controller.period().unwrap_or_default() * run);
/// }
/// assert!(demand.y.value() < 0.0 && demand.x.value() == 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedLine<C> {
    settings: ContouringSettings,
    controller: C,
    x: PlannedAxis,
    y: PlannedAxis,
    start: StepPoint,
    target: StepPoint,
    direction: [f32; 2],
    plan: SCurve,
    /// Time along the plan, s; it stands still while the reference waits.
    plan_s: f64,
    /// When the loop ran last, how far along the plan it was then, and how fast the reference goes on since.
    run_at: Duration,
    run_plan_s: f64,
    rate: f32,
    estimated_at: Duration,
    /// How long the plan has been over, us.
    over_us: u32,
    /// How long both shafts have rested at the target; `None` while they do not.
    settled_for: Option<Duration>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct PlannedAxis {
    observer: ShaftObserver,
    applied_v: f32,
    duty: RoundedDuty,
    last: LastCounts,
    /// How far it was behind at the last edge since the last run, counts.
    edge_error: Option<f32>,
}

impl<C: ContourController> PlannedLine<C> {
    /// A controller at rest at the origin, with plan, loop and observer of the machine's description.
    #[must_use]
    pub fn new(machine: &Machine, controller: C) -> Self {
        // A pen that is behind by less is led on by its controller; by more, something holds it.
        const WAIT_FROM_MM: f64 = 0.1;
        const WAIT_MM: f64 = 0.5;
        let config = machine.config();
        let counts_per_mm = config.x.counts_per_mm.min(config.y.counts_per_mm);
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        let settings = ContouringSettings {
            wait_from_counts: (WAIT_FROM_MM * counts_per_mm) as f32,
            wait_counts: (WAIT_MM * counts_per_mm) as f32,
            ..ContouringSettings::of(machine)
        };
        Self::with_settings(settings, controller)
    }

    /// The same from settings; the gains among them are not used.
    #[must_use]
    pub fn with_settings(settings: ContouringSettings, controller: C) -> Self {
        let axis = |ShaftSettings { model, decoding, observer_rad_s, pwm_steps }| PlannedAxis {
            observer: ShaftObserver::new(model, decoding, observer_rad_s),
            applied_v: 0.0,
            duty: RoundedDuty::none(pwm_steps),
            last: LastCounts::AT_REST,
            edge_error: None,
        };
        Self {
            settings,
            controller,
            x: axis(settings.x),
            y: axis(settings.y),
            start: StepPoint::default(),
            target: StepPoint::default(),
            direction: [1.0, 0.0],
            plan: SCurve::default(),
            plan_s: 0.0,
            run_at: Duration::ZERO,
            run_plan_s: 0.0,
            rate: 1.0,
            estimated_at: Duration::ZERO,
            over_us: 0,
            settled_for: None,
        }
    }

    /// The control law.
    #[must_use]
    pub const fn controller(&self) -> &C {
        &self.controller
    }

    fn predict(&mut self, now: Duration) {
        let dt_s = now.saturating_sub(self.estimated_at).as_secs_f32();
        self.estimated_at = self.estimated_at.max(now);
        for axis in [&mut self.x, &mut self.y] {
            axis.observer.predict(dt_s, axis.applied_v);
        }
    }

    fn demand(&self) -> Demand {
        Demand { x: self.x.duty.get(), y: self.y.duty.get() }
    }

    /// What the control law is told. Speed and acceleration of the reference are smaller while it waits.
    fn state(&self, rate: f32) -> ContourState {
        let point = self.plan.at(self.plan_s);
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        let (distance, speed, accel, plan_s) = (
            point.distance_mm,
            point.speed_mm_s as f32 * rate,
            point.accel_mm_s2 as f32 * rate * rate,
            self.plan_s as f32,
        );
        let axis = |axis: &PlannedAxis, start: i32, target: i32, unit: f32| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_precision_loss,
                reason = "f32 is the precision of the control loop"
            )]
            let (reference, target, count) = (
                (distance * f64::from(unit)) as f32,
                target.saturating_sub(start) as f32,
                axis.observer.count().saturating_sub(start) as f32,
            );
            AxisState {
                reference,
                reference_speed: speed * unit,
                reference_accel: accel * unit,
                target,
                count,
                position: axis.observer.distance_from(start),
                speed: axis.observer.speed_counts_s(),
                disturbance: axis.observer.disturbance_counts_s2(),
                edge_error: axis.edge_error,
            }
        };
        let [ux, uy] = self.direction;
        ContourState {
            x: axis(&self.x, self.start.x, self.target.x, ux),
            y: axis(&self.y, self.start.y, self.target.y, uy),
            direction: self.direction,
            plan_s,
            dt_s: self.settings.period().as_secs_f32(),
        }
    }

    /// One run of the loop.
    fn run(&mut self) {
        let ContouringSettings { wait_from_counts, wait_counts, tolerance_counts, .. } = self.settings;
        let (period, period_us) = (self.settings.period(), self.settings.period_us);
        let [ux, uy] = self.direction;
        let state = self.state(1.0);
        let (ex, ey) = (state.x.error(), state.y.error());
        // How fast the reference goes on: 1 as planned, 0 waiting for a pen that does not follow.
        let lag = libm::hypotf(ex, ey);
        let rate =
            (1.0 - (lag - wait_from_counts).max(0.0) / (wait_counts - wait_from_counts)).clamp(0.0, 1.0);
        let state = if rate < 1.0 { self.state(rate) } else { state };
        let demand = self.controller.update(&state);
        (self.x.edge_error, self.y.edge_error) = (None, None);

        (self.run_plan_s, self.rate) = (self.plan_s, rate);
        self.plan_s = (self.plan_s + period.as_secs_f64() * f64::from(rate)).min(self.plan.duration_s());
        let finished = self.plan_s >= self.plan.duration_s();
        self.over_us = if finished { self.over_us.saturating_add(period_us) } else { 0 };
        for axis in [&mut self.x, &mut self.y] {
            axis.last.wait(period_us);
        }
        let rest_x = (finished || ux == 0.0) && self.x.rests(self.target.x, tolerance_counts);
        let rest_y = (finished || uy == 0.0) && self.y.rests(self.target.y, tolerance_counts);
        let (target, over_us) = (self.target, self.over_us);
        for (axis, target, rests, duty) in
            [(&mut self.x, target.x, rest_x, demand.x), (&mut self.y, target.y, rest_y, demand.y)]
        {
            let is_near = finished && axis.last.is_near(axis.observer.motion(), target, over_us);
            let duty = if is_near { axis.inch(target, period_us) } else { duty };
            axis.drive((!rests).then_some(duty));
        }
        let settled_for = self.settled_for.unwrap_or_default().saturating_add(period);
        self.settled_for = (finished && rest_x && rest_y).then_some(settled_for);
    }
}

impl PlannedAxis {
    /// Takes an edge while the reference is `reference` counts beyond `start`.
    fn edge(&mut self, direction: Direction, start: i32, reference: f64, planned: Option<Direction>) {
        let place = self.observer.edge(direction, planned);
        self.last.edge();
        let counted = self.observer.count().saturating_sub(start);
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        let error = (reference - f64::from(counted)) as f32 - place;
        self.edge_error = Some(error);
    }

    fn rests(&mut self, target: i32, tolerance_counts: f32) -> bool {
        self.last.rests(self.observer.motion(), target, tolerance_counts)
    }

    fn inch(&mut self, target: i32, period_us: u32) -> Duty {
        if self.last.stands() {
            self.observer.stands();
        }
        Duty::saturating(self.last.inch(self.observer.distance_from(target), period_us))
    }

    /// Drives the shaft, or leaves it alone.
    fn drive(&mut self, wanted: Option<Duty>) {
        if let Some(wanted) = wanted {
            self.duty.set(wanted.value());
            return;
        }
        if self.last.stands() {
            self.observer.rests();
        }
        self.duty.stop();
    }
}

impl<C: ContourController> LineController for PlannedLine<C> {
    fn period(&self) -> Option<Duration> {
        Some(self.settings.period())
    }

    fn start(&mut self, now: Duration, target: StepPoint) -> Demand {
        self.predict(now);
        if target == self.target && !self.has_arrived() {
            return self.demand(); // the host said it twice
        }
        // A pen that was called away from a target it had not reached begins where it is.
        let stands = self.has_arrived() || self.position() == self.target;
        self.start = if stands { self.target } else { self.position() };
        self.target = target;
        let dx = f64::from(target.x) - f64::from(self.start.x);
        let dy = f64::from(target.y) - f64::from(self.start.y);
        let length = libm::hypot(dx, dy);
        if length > 0.0 {
            #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
            let direction = [(dx / length) as f32, (dy / length) as f32];
            self.direction = direction;
        }
        self.plan = SCurve::plan(length, self.settings.limits).unwrap_or_default();
        (self.plan_s, self.run_plan_s, self.run_at) = (0.0, 0.0, now);
        self.settled_for = None;
        self.over_us = 0;
        for axis in [&mut self.x, &mut self.y] {
            axis.observer.forget();
            axis.last.start();
        }
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        self.controller.start(self.plan.duration_s() as f32);
        self.demand()
    }

    fn edge(&mut self, now: Duration, axis: Axis, direction: Direction) -> Demand {
        self.predict(now);
        let since_run = now.saturating_sub(self.run_at).min(self.settings.period());
        let plan_s = self.run_plan_s + since_run.as_secs_f64() * f64::from(self.rate);
        let reference = self.plan.at(plan_s).distance_mm;
        let [ux, uy] = self.direction.map(f64::from);
        let is_over = self.plan_s >= self.plan.duration_s();
        let planned = |unit: f64| {
            let sense = if unit > 0.0 { Direction::Plus } else { Direction::Minus };
            (unit != 0.0 && !is_over).then_some(sense)
        };
        match axis {
            Axis::X => self.x.edge(direction, self.start.x, reference * ux, planned(ux)),
            Axis::Y => self.y.edge(direction, self.start.y, reference * uy, planned(uy)),
        }
        self.demand()
    }

    fn tick(&mut self, now: Duration) -> Demand {
        self.predict(now);
        self.x.observer.no_edge();
        self.y.observer.no_edge();
        self.run_at = now;
        self.run();
        self.demand()
    }

    fn applied(&mut self, drive: Drive) {
        for (axis, duty) in [(&mut self.x, drive.x()), (&mut self.y, drive.y())] {
            axis.applied_v = duty.value() * axis.observer.model().supply_v;
        }
    }

    fn position(&self) -> StepPoint {
        StepPoint::new(self.x.observer.count(), self.y.observer.count())
    }

    fn has_arrived(&self) -> bool {
        self.settled_for.is_some_and(|settled_for| {
            settled_for >= Duration::from_micros(u64::from(self.settings.settle_us))
        })
    }

    fn reference(&self) -> Option<[f64; 2]> {
        let [ux, uy] = self.direction.map(f64::from);
        let distance = self.plan.at(self.run_plan_s).distance_mm;
        Some([f64::from(self.start.x) + distance * ux, f64::from(self.start.y) + distance * uy])
    }
}
