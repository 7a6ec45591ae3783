//! [`PlannedLine`]: a reference that moves along the line as planned, and a controller that follows it.

use super::led_axis::{LedAxis, trouble_of};
use super::line_plan::{LinePlan, Wait};
use super::{AxisState, AxisTrouble, ContourController, ContourState, ContouringSettings, LineController};
use crate::config::DcConfig;
use crate::{Axis, Demand, Direction, Drive, Machine, StepPoint};
use core::time::Duration;

/// Makes a [`LineController`] of a [`ContourController`]: everything but the control law.
///
/// ```text
///  targets ──▶ SCurve along the line ──▶ reference ─┐
///                                                   ├─▶ ContourController ──▶ Demand ──▶ whole steps of the duty
///  edges and applied drive ──▶ ShaftEstimator ──────┘
/// ```
///
/// The plan has the limits of the machine's `[control.contouring]`, and the control law runs `loop_hz` times
/// a second. While the pen lags behind, the reference slows down and finally waits, so that one motor waits
/// for another that is held fast. When the plan is over, an axis that stands in the middle of its target's
/// count gets no drive, and one that stands a few counts beside it is pushed there count by count; both
/// having stood there for `settle_ms`, the pen has arrived. What rounding to the steps of the duty took or
/// gave is made up for in the next run. A run that comes late finds the reference where the time has led it.
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
    line: LinePlan,
    /// How far along the plan the loop ran last, s.
    run_plan_s: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct PlannedAxis {
    led: LedAxis,
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
        let config = DcConfig::of(machine);
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
        let axis = |settings| PlannedAxis { led: LedAxis::new(settings), edge_error: None };
        Self {
            settings,
            controller,
            x: axis(settings.x),
            y: axis(settings.y),
            line: LinePlan::at_rest(settings.limits),
            run_plan_s: 0.0,
        }
    }

    /// The control law.
    #[must_use]
    pub const fn controller(&self) -> &C {
        &self.controller
    }

    fn predict(&mut self, now: Duration) {
        self.x.led.predict(now);
        self.y.led.predict(now);
    }

    fn demand(&self) -> Demand {
        Demand { x: self.x.led.duty(), y: self.y.led.duty() }
    }

    /// What the control law is told. Speed and acceleration of the reference are smaller while it waits.
    fn state(&self, rate: f32) -> ContourState {
        let point = self.line.at(self.line.plan_s());
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        let (distance, speed, accel, plan_s) = (
            point.distance_mm,
            point.speed_mm_s as f32 * rate,
            point.accel_mm_s2 as f32 * rate * rate,
            self.line.plan_s() as f32,
        );
        let axis = |axis: &PlannedAxis, start: i32, target: i32, unit: f32| {
            let estimator = &axis.led.estimator;
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_precision_loss,
                reason = "f32 is the precision of the control loop"
            )]
            let (reference, target, count) = (
                (distance * f64::from(unit)) as f32,
                target.saturating_sub(start) as f32,
                estimator.count().saturating_sub(start) as f32,
            );
            AxisState {
                reference,
                reference_speed: speed * unit,
                reference_accel: accel * unit,
                target,
                count,
                position: estimator.distance_from(start),
                speed: estimator.speed_counts_s(),
                disturbance: estimator.disturbance_counts_s2(),
                edge_error: axis.edge_error,
            }
        };
        let (start, target, [ux, uy]) = (self.line.start(), self.line.target(), self.line.direction());
        ContourState {
            x: axis(&self.x, start.x, target.x, ux),
            y: axis(&self.y, start.y, target.y, uy),
            direction: [ux, uy],
            plan_s,
            dt_s: self.settings.period().as_secs_f32(),
        }
    }

    /// One run of the loop.
    fn run(&mut self) {
        if trouble_of(&self.x.led, &self.y.led).is_some_and(|found| found.trouble.stops()) {
            self.x.led.stop();
            self.y.led.stop();
            return;
        }
        let ContouringSettings { tolerance_counts, period_us, .. } = self.settings;
        let wait = Wait { from_counts: self.settings.wait_from_counts, counts: self.settings.wait_counts };
        let (target, [ux, uy]) = (self.line.target(), self.line.direction());
        let state = self.state(1.0);
        let rate = self.line.rate([state.x.error(), state.y.error()], wait);
        let state = if rate < 1.0 { self.state(rate) } else { state };
        let demand = self.controller.update(&state);
        (self.x.edge_error, self.y.edge_error) = (None, None);

        self.run_plan_s = self.line.plan_s();
        self.line.go_on(rate, period_us);
        let (finished, over_us, waits) = (self.line.is_over(), self.line.over_us(), rate < 1.0);
        let (x, y) = (&mut self.x.led, &mut self.y.led);
        let rest_x = x.rests(finished || ux == 0.0, target.x, tolerance_counts, period_us);
        let rest_y = y.rests(finished || uy == 0.0, target.y, tolerance_counts, period_us);
        for (axis, target, rests, duty, unit, state) in
            [(x, target.x, rest_x, demand.x, ux, &state.x), (y, target.y, rest_y, demand.y, uy, &state.y)]
        {
            if rests || axis.coasts(target) || (finished && axis.inches(target, over_us, period_us)) {
                continue;
            }
            let leaning = axis.lean(waits && state.error().abs() >= 1.0, state.error(), period_us);
            let duty = axis.as_described(duty.value(), state.reference_speed) + leaning;
            axis.drive(duty, if unit == 0.0 { state.error() } else { unit });
        }
        self.line.settles(rest_x && rest_y, period_us);
        // Shafts that came to stand far beside the target are led there along a line of their own.
        if let (true, Some(far_x), Some(far_y)) =
            (finished, self.x.led.stands_far(target.x), self.y.led.stands_far(target.y))
            && (far_x || far_y)
        {
            self.line.from(self.position());
            self.begin();
        }
    }

    /// The control law begins with a line that is planned.
    fn begin(&mut self) {
        self.run_plan_s = 0.0;
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        self.controller.start(self.line.duration_s() as f32);
    }
}

impl PlannedAxis {
    /// Takes an edge while the reference is `reference` counts beyond `start`.
    fn edge(&mut self, now: Duration, direction: Direction, start: i32, reference: f64) {
        let place = self.led.edge(now, direction);
        let counted = self.led.estimator.count().saturating_sub(start);
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        let error = (reference - f64::from(counted)) as f32 - place;
        self.edge_error = Some(error);
    }
}

impl<C: ContourController> LineController for PlannedLine<C> {
    fn period(&self) -> Option<Duration> {
        Some(self.settings.period())
    }

    fn start(&mut self, now: Duration, target: StepPoint) -> Demand {
        self.predict(now);
        if target == self.line.target() && !self.has_arrived() {
            return self.demand(); // the host said it twice
        }
        let (position, has_arrived) = (self.position(), self.has_arrived());
        self.line.to(target, position, has_arrived);
        for axis in [&mut self.x.led, &mut self.y.led] {
            axis.estimator.forget();
            axis.start();
        }
        self.begin();
        self.demand()
    }

    fn edge(&mut self, now: Duration, axis: Axis, direction: Direction) -> Demand {
        let reference = self.line.at(self.line.plan_s_at(now, self.run_plan_s)).distance_mm;
        let (start, [ux, uy]) = (self.line.start(), self.line.direction().map(f64::from));
        match axis {
            Axis::X => self.x.edge(now, direction, start.x, reference * ux),
            Axis::Y => self.y.edge(now, direction, start.y, reference * uy),
        }
        self.demand()
    }

    fn tick(&mut self, now: Duration) -> Demand {
        self.predict(now);
        self.x.led.estimator.no_edge();
        self.y.led.estimator.no_edge();
        self.line.catch_up(now, self.settings.period_us);
        self.run();
        self.demand()
    }

    fn applied(&mut self, drive: Drive) {
        self.x.led.applied(drive.x());
        self.y.led.applied(drive.y());
    }

    fn position(&self) -> StepPoint {
        StepPoint::new(self.x.led.estimator.count(), self.y.led.estimator.count())
    }

    fn has_arrived(&self) -> bool {
        self.line.has_settled(self.settings.settle_us)
    }

    fn trouble(&self) -> Option<AxisTrouble> {
        trouble_of(&self.x.led, &self.y.led)
    }

    fn reference(&self) -> Option<[f64; 2]> {
        Some(self.line.reference(self.run_plan_s))
    }
}
