//! Contouring control: a planned speed along the line, and the errors along and across it led to zero.

use super::last_counts::LastCounts;
use super::rounded_duty::RoundedDuty;
use super::{LineController, ShaftEstimator, ShaftModel};
use crate::{Axis, AxisConfig, Decoding, Demand, Direction, Drive, Machine, MotionLimits, SCurve, StepPoint};
use core::f64::consts::TAU;
use core::time::Duration;

/// Ours: leads both motors along a line at a planned speed, whatever its direction.
///
/// ```text
///            target                 reference: a point that moves along the line as planned (SCurve)
///         r ╱                       along-track error:  how far the pen is behind it
///     e ╱ ╱   e = along + across    cross-track error:  how far beside the line
///      ●╱
///    ╱ pen                          demand = planned voltage + gains * (along, across) - estimated load
/// start
/// ```
///
/// There is no slope in it, so vertical and steep lines are like any other. Position and speed between the
/// encoder's edges come from a [`ShaftEstimator`] for each axis; the voltage that the plan needs comes from
/// the motor's equation, solved for it (spec 1.8). When the pen lags behind the reference, the reference slows
/// down and finally waits: if one motor stalls, the other waits, and both go on when it is freed.
///
/// The pen arrives when both shafts have stood within the arrival tolerance of the middle of the target's
/// counts for the settling time; resting there, no trembling can reach an edge.
///
/// Every line ends, on motors far from their description too. A shaft that stands while the reference waits for it is pushed harder and
/// harder until it moves; and with the plan over, one that has not come to rest goes the last counts one by one. Only a shaft that
/// the whole supply does not move is waited for, for as long as something holds it.
///
/// Source of the split into along and across: Y. Koren, "Cross-Coupled Biaxial Computer Control for
/// Manufacturing Systems" (1980).
///
/// ```
/// # use plotter_motion::{Machine, MachineConfig, StepPoint, control::{LineController, Contouring}};
/// # use core::time::Duration;
/// let machine = Machine::new(MachineConfig::default())?;
/// let mut controller = Contouring::new(&machine);
/// let mut demand = controller.start(Duration::ZERO, StepPoint::new(0, 400)); // straight up
/// for run in 1..=10 {
///     demand = controller.tick(controller.period().unwrap_or_default() * run);
/// }
/// assert!(demand.y.value() > 0.0 && demand.x.value() == 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contouring {
    settings: ContouringSettings,
    x: ContouredAxis,
    y: ContouredAxis,
    start: StepPoint,
    target: StepPoint,
    /// Unit vector of the line in counts.
    direction: [f32; 2],
    plan: SCurve,
    /// Time along the plan, s; it stands still while the reference waits.
    plan_s: f64,
    estimated_at: Duration,
    /// How long the plan has been over, us.
    over_us: u32,
    /// How long both shafts have rested at the target; `None` while they do not.
    settled_for: Option<Duration>,
}

/// What [`Contouring`] must know of a machine: numbers that a firmware keeps in its program memory. A plan is made
/// in `f64`, so its limits are; what the loop reckons with is `f32`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContouringSettings {
    /// Limits of the plan, in encoder counts of the coarser axis where the names say mm, so that no axis exceeds them.
    pub limits: MotionLimits,
    /// How often the controller runs, us.
    pub period_us: u32,
    /// Gains along the line, and the stiffer ones across it.
    pub along: PositionGains,
    /// Across the line.
    pub across: PositionGains,
    /// How near a shaft must stand to its target to rest, encoder counts.
    pub tolerance_counts: f32,
    /// How long both must stand there, us.
    pub settle_us: u32,
    /// Lag from which on the reference slows down, encoder counts.
    pub wait_from_counts: f32,
    /// Lag at which it waits, encoder counts; above `wait_from_counts`.
    pub wait_counts: f32,
    /// The shaft of the x axis.
    pub x: ShaftSettings,
    /// The shaft of the y axis.
    pub y: ShaftSettings,
}

/// What [`Contouring`] must know of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShaftSettings {
    /// Motor and load.
    pub model: ShaftModel,
    /// How the encoder is counted.
    pub decoding: Decoding,
    /// Natural frequency of the estimator, rad/s.
    pub observer_rad_s: f32,
    /// Steps of the duty from 0 to full.
    pub pwm_steps: u16,
}

/// Gains of a critically damped position loop: `w^2` and `2 w` for its natural frequency `w`, rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionGains {
    /// Acceleration by a position error, 1/s^2.
    pub position: f32,
    /// Acceleration by a speed error, 1/s.
    pub speed: f32,
}

impl PositionGains {
    fn new(natural_hz: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        let w = (natural_hz * TAU) as f32;
        Self { position: w * w, speed: 2.0 * w }
    }
}

impl ContouringSettings {
    /// Those of a machine.
    ///
    /// ```
    /// # use plotter_motion::{Machine, MachineConfig, control::ContouringSettings};
    /// let machine = Machine::new(MachineConfig::default())?;
    /// let settings = ContouringSettings::of(&machine);
    /// assert_eq!(settings.period_us, 400); // 2500 Hz
    /// assert_eq!(settings.limits.speed_mm_s, 6000.0); // 150 mm/s at 40 counts/mm
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        // An error across the line is seen on the paper, one along it is not: the loop across is the stiffer one.
        const ACROSS_SHARE: f64 = 1.6;
        let config = &machine.led_motors();
        let contouring = &config.control.contouring;
        // The plan is made in counts, the limits in those of the coarser axis, so that no axis exceeds them.
        let counts_per_mm = config.x.counts_per_mm.min(config.y.counts_per_mm);
        let period_us = 1e6 / contouring.loop_hz;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "f32 loop; checked ranges"
        )]
        Self {
            limits: MotionLimits {
                speed_mm_s: contouring.feed_mm_s * counts_per_mm,
                accel_mm_s2: contouring.accel_mm_s2 * counts_per_mm,
                jerk_mm_s3: contouring.jerk_mm_s3 * counts_per_mm,
            },
            period_us: libm::round(period_us).max(1.0) as u32,
            along: PositionGains::new(contouring.bandwidth_hz),
            across: PositionGains::new(ACROSS_SHARE * contouring.bandwidth_hz),
            tolerance_counts: contouring.arrival_tolerance_counts as f32,
            settle_us: (contouring.settle_ms * 1e3) as u32,
            // The reference slows down from a tenth of the allowed deviation on, and waits at half of it.
            wait_from_counts: 0.1 * config.sync_stop.offset_counts as f32,
            wait_counts: 0.5 * config.sync_stop.offset_counts as f32,
            x: ShaftSettings::new(&config.x, contouring.observer_hz),
            y: ShaftSettings::new(&config.y, contouring.observer_hz),
        }
    }

    pub(super) const fn period(&self) -> Duration {
        Duration::from_micros(self.period_us as u64)
    }
}

impl ShaftSettings {
    fn new(axis: &AxisConfig, observer_hz: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        let observer_rad_s = (observer_hz * TAU) as f32;
        Self {
            model: ShaftModel::new(axis),
            decoding: axis.encoder.decoding,
            observer_rad_s,
            pwm_steps: u16::try_from(axis.motor.pwm_steps).unwrap_or(u16::MAX),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct ContouredAxis {
    estimator: ShaftEstimator,
    applied_v: f32,
    duty: RoundedDuty,
    last: LastCounts,
}

impl Contouring {
    /// A controller at rest at the origin.
    #[must_use]
    pub fn new(machine: &Machine) -> Self {
        Self::with_settings(ContouringSettings::of(machine))
    }

    /// The same from settings.
    #[must_use]
    pub fn with_settings(settings: ContouringSettings) -> Self {
        let axis = |ShaftSettings { model, decoding, observer_rad_s, pwm_steps }| ContouredAxis {
            estimator: ShaftEstimator::with_model(model, decoding, observer_rad_s),
            applied_v: 0.0,
            duty: RoundedDuty::none(pwm_steps),
            last: LastCounts::AT_REST,
        };
        Self {
            settings,
            x: axis(settings.x),
            y: axis(settings.y),
            start: StepPoint::default(),
            target: StepPoint::default(),
            direction: [1.0, 0.0],
            plan: SCurve::default(),
            plan_s: 0.0,
            estimated_at: Duration::ZERO,
            over_us: 0,
            settled_for: None,
        }
    }

    /// Brings both estimates up to `now`.
    fn predict(&mut self, now: Duration) {
        let dt_s = now.saturating_sub(self.estimated_at).as_secs_f32();
        self.estimated_at = self.estimated_at.max(now);
        for axis in [&mut self.x, &mut self.y] {
            axis.estimator.predict(dt_s, axis.applied_v);
        }
    }

    fn demand(&self) -> Demand {
        Demand { x: self.x.duty.get(), y: self.y.duty.get() }
    }

    /// One run of the control law.
    fn control(&mut self) {
        let ContouringSettings { along, across, wait_from_counts, wait_counts, .. } = self.settings;
        let (period, period_us) = (self.settings.period(), self.settings.period_us);
        let [ux, uy] = self.direction;
        let point = self.plan.at(self.plan_s);

        // Errors against the reference, in counts; the distance along the line is kept in f64 until here.
        let reference = |axis: &ContouredAxis, start: i32, unit: f32| {
            let distance = point.distance_mm * f64::from(unit);
            let whole = libm::round(distance);
            #[expect(clippy::cast_possible_truncation, reason = "a checked machine has at most 99999 counts")]
            let (count, rest) = (start.saturating_add(whole as i32), (distance - whole) as f32);
            rest - axis.estimator.distance_from(count)
        };
        let (ex, ey) = (reference(&self.x, self.start.x, ux), reference(&self.y, self.start.y, uy));
        let (vx, vy) = (self.x.estimator.speed_counts_s(), self.y.estimator.speed_counts_s());
        let (e_along, e_across) = (ex * ux + ey * uy, ey * ux - ex * uy);
        let (v_along, v_across) = (vx * ux + vy * uy, vy * ux - vx * uy);

        // How fast the reference goes on: 1 as planned, 0 waiting for a pen that does not follow.
        let lag = libm::hypotf(ex, ey);
        let rate =
            (1.0 - (lag - wait_from_counts).max(0.0) / (wait_counts - wait_from_counts)).clamp(0.0, 1.0);

        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        let (speed, accel) = (point.speed_mm_s as f32 * rate, point.accel_mm_s2 as f32 * rate * rate);
        let a_along = accel + along.position * e_along + along.speed * (speed - v_along);
        let a_across = across.position * e_across - across.speed * v_across;

        self.plan_s = (self.plan_s + period.as_secs_f64() * f64::from(rate)).min(self.plan.duration_s());
        let finished = self.plan_s >= self.plan.duration_s();
        self.over_us = if finished { self.over_us.saturating_add(period_us) } else { 0 };
        let tolerance = self.settings.tolerance_counts;
        let (rest_x, rest_y) = (
            self.x.rests(finished || ux == 0.0, self.target.x, tolerance, period_us),
            self.y.rests(finished || uy == 0.0, self.target.y, tolerance, period_us),
        );
        let (target, over_us, waits) = (self.target, self.over_us, rate < 1.0);
        for (axis, target, rests, accel, speed, error) in [
            (&mut self.x, target.x, rest_x, a_along * ux - a_across * uy, speed * ux, ex),
            (&mut self.y, target.y, rest_y, a_along * uy + a_across * ux, speed * uy, ey),
        ] {
            if rests {
                continue;
            }
            if finished && axis.last.is_near(axis.estimator.motion(), target, over_us) {
                axis.inch(target, period_us);
            } else {
                // A whole count behind while the reference waits for it: it is stuck.
                let leaning = axis.last.lean(waits && error.abs() >= 1.0, error, period_us);
                axis.drive(accel, speed, error, leaning);
            }
        }
        let settled_for = self.settled_for.unwrap_or_default().saturating_add(period);
        self.settled_for = (finished && rest_x && rest_y).then_some(settled_for);
    }
}

impl ContouredAxis {
    fn edge(&mut self, direction: Direction) {
        if self.last.is_leaning() {
            self.estimator.broke_loose(self.applied_v);
        }
        self.estimator.edge(direction);
        self.last.edge();
    }

    /// Whether the shaft is left alone where it stands, with its motor short-circuited.
    fn rests(&mut self, may_rest: bool, target: i32, tolerance_counts: f32, period_us: u32) -> bool {
        self.last.wait(period_us);
        let rests = may_rest && self.last.rests(self.estimator.motion(), target, tolerance_counts);
        if rests {
            self.duty.stop();
        }
        rests
    }

    /// Goes towards the target count by count.
    fn inch(&mut self, target: i32, period_us: u32) {
        if self.last.stands() {
            self.estimator.stands();
        }
        self.duty.set(self.last.inch(self.estimator.distance_from(target), period_us));
    }

    /// Chooses the duty that gives the acceleration `accel` at the planned `speed`, and `leaning` beyond it.
    fn drive(&mut self, accel: f32, speed: f32, error: f32, leaning: f32) {
        let model = self.estimator.model();
        let sense = if speed != 0.0 { speed } else { error };
        let friction = libm::copysignf(self.estimator.friction_counts_s2().max(0.0), sense);
        let push = accel + model.damping_per_s * speed + friction;
        self.duty.set(push / (model.accel_per_volt * model.supply_v) + leaning);
    }
}

impl LineController for Contouring {
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
        self.plan_s = 0.0;
        self.over_us = 0;
        self.settled_for = None;
        for axis in [&mut self.x, &mut self.y] {
            axis.last.start();
        }
        self.demand()
    }

    fn edge(&mut self, now: Duration, axis: Axis, direction: Direction) -> Demand {
        self.predict(now);
        match axis {
            Axis::X => self.x.edge(direction),
            Axis::Y => self.y.edge(direction),
        }
        self.demand()
    }

    fn tick(&mut self, now: Duration) -> Demand {
        self.predict(now);
        self.x.estimator.no_edge();
        self.y.estimator.no_edge();
        self.control();
        self.demand()
    }

    fn applied(&mut self, drive: Drive) {
        for (axis, duty) in [(&mut self.x, drive.x()), (&mut self.y, drive.y())] {
            axis.applied_v = duty.value() * axis.estimator.model().supply_v;
        }
    }

    fn position(&self) -> StepPoint {
        StepPoint::new(self.x.estimator.count(), self.y.estimator.count())
    }

    fn has_arrived(&self) -> bool {
        self.settled_for.is_some_and(|settled_for| {
            settled_for >= Duration::from_micros(u64::from(self.settings.settle_us))
        })
    }

    fn reference(&self) -> Option<[f64; 2]> {
        let [ux, uy] = self.direction.map(f64::from);
        let distance = self.plan.at(self.plan_s).distance_mm;
        Some([f64::from(self.start.x) + distance * ux, f64::from(self.start.y) + distance * uy])
    }
}
