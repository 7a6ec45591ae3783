//! Contouring control: a planned speed along the line, and the errors along and across it led to zero.

use super::coasting_bridge::CoastingBridge;
use super::led_axis::{LedAxis, trouble_of};
use super::line_plan::{LinePlan, Wait};
use super::{AxisTrouble, LineController, ShaftModel};
use crate::config::DcConfig;
use crate::{
    Axis, Demand, Direction, Drive, Machine, MotionLimits, StepPoint,
    config::{AxisConfig, Decoding},
};
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
/// encoder's edges come from a [`ShaftEstimator`](super::ShaftEstimator) for each axis; the voltage that the
/// plan needs comes from the motor's equation, solved for it (Öcal, section 4.6.1). When the pen lags behind
/// the reference, the reference slows down and finally waits: if one motor stalls, the other waits, and both
/// go on when it is freed.
///
/// The pen arrives when both shafts have stood within the arrival tolerance of the middle of the target's
/// counts for the settling time; resting there, no trembling can reach an edge.
///
/// It is told what its motors are, and finds out how they differ ([`ShaftEstimator`](super::ShaftEstimator)).
/// A shaft is braked only while it surely turns, so that it does not turn round on its way: where it does, no
/// x1 encoder tells a new edge from the last one met again. What no shaft does, crossed wires or a lost
/// phase, it notices and tells ([`LineController::trouble`]).
///
/// Every line ends, on motors far from their description too. A shaft that stands while the reference waits
/// for it is pushed harder and harder until it moves; and with the plan over, one that has not come to rest
/// goes the last counts one by one. Only a shaft that the whole supply does not move is waited for, for as
/// long as something holds it.
///
/// Source of the split into along and across: Y. Koren, "Cross-Coupled Biaxial Computer Control for
/// Manufacturing Systems" (1980).
///
/// ```
/// # use plotter_motion::{Machine, MachineConfig, StepPoint, control::{Contouring, LineController}};
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
    law: Law,
    x: LedAxis,
    y: LedAxis,
    line: LinePlan,
}

/// What its runs need of the settings: the rest goes to plan and axes when they are made.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Law {
    period_us: u32,
    along: PositionGains,
    across: PositionGains,
    tolerance_counts: f32,
    settle_us: u32,
    wait: Wait,
}

/// What [`Contouring`] must know of a machine: numbers that a firmware keeps in its program memory. A plan is
/// made in `f64`, so its limits are; what the loop reckons with is `f32`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ContouringSettings {
    /// Limits of the plan, in encoder counts of the coarser axis where the names say mm, so that no axis
    /// exceeds them.
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

/// Settings of an axis for [`Contouring`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ShaftSettings {
    /// Motor and load.
    pub model: ShaftModel,
    /// How the encoder is counted.
    pub decoding: Decoding,
    /// Natural frequency of the estimator, rad/s.
    pub observer_rad_s: f32,
    /// Steps of the duty from 0 to full.
    pub pwm_steps: u16,
    /// The bridge, if the motor coasts between its pulses.
    pub coasting: Option<CoastingBridge>,
    /// Whether play or a belt lies between shaft and pen: the shaft may then be pulled on by what it moves.
    pub is_loose: bool,
}

/// Gains of a critically damped position loop: `w^2` and `2 w` for its natural frequency `w`, rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
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

impl Law {
    const fn period(&self) -> Duration {
        Duration::from_micros(self.period_us as u64)
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
        // An error across the line is seen on the paper, one along it is not: the loop across is the stiffer
        // one.
        const ACROSS_SHARE: f64 = 1.6;
        let config = machine.led_motors();
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
                accel_mm_s2: contouring.accel_mm_s2.min(most_accel_mm_s2(&config)) * counts_per_mm,
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

/// The greatest deceleration at which a carriage on a belt follows its motor, mm/s^2: what its rail's
/// friction brakes it with. Braked harder it runs ahead, through the play and against the other side of its
/// belt, swings there, and pulls on a shaft that is to stand.
fn most_accel_mm_s2(config: &DcConfig) -> f64 {
    // Friction may be less than described, and mass more, by a tenth each.
    const SHARE: f64 = 0.8;
    let of = |axis: &AxisConfig| {
        let belt = &axis.transmission;
        let is_driven = belt.carriage_kg > 0.0 && belt.rail_friction_n > 0.0;
        if is_driven { SHARE * belt.rail_friction_n / belt.carriage_kg * 1e3 } else { f64::INFINITY }
    };
    of(&config.x).min(of(&config.y))
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
            coasting: CoastingBridge::of(axis),
            is_loose: axis.transmission.backlash_mm > 0.0 || axis.transmission.stiffness_n_per_mm > 0.0,
        }
    }
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
        let ContouringSettings { limits, period_us, along, across, tolerance_counts, settle_us, .. } =
            settings;
        let wait = Wait { from_counts: settings.wait_from_counts, counts: settings.wait_counts };
        Self {
            law: Law { period_us, along, across, tolerance_counts, settle_us, wait },
            x: LedAxis::new(settings.x),
            y: LedAxis::new(settings.y),
            line: LinePlan::at_rest(limits),
        }
    }

    /// Brings both estimates up to `now`.
    fn predict(&mut self, now: Duration) {
        self.x.predict(now);
        self.y.predict(now);
    }

    fn demand(&self) -> Demand {
        Demand { x: self.x.duty(), y: self.y.duty() }
    }

    /// One run of the control law.
    fn control(&mut self) {
        if trouble_of(&self.x, &self.y).is_some_and(|found| found.trouble.stops()) {
            self.x.stop();
            self.y.stop();
            return;
        }
        let Law { along, across, tolerance_counts, period_us, wait, .. } = self.law;
        let (start, target, [ux, uy]) = (self.line.start(), self.line.target(), self.line.direction());
        let point = self.line.at(self.line.plan_s());

        // Errors against the reference, in counts; the distance along the line is kept in f64 until here.
        let error = |axis: &LedAxis, start: i32, unit: f32| {
            let distance = point.distance_mm * f64::from(unit);
            let whole = libm::round(distance);
            #[expect(clippy::cast_possible_truncation, reason = "a checked machine has at most 99999 counts")]
            let (count, rest) = (start.saturating_add(whole as i32), (distance - whole) as f32);
            rest - axis.estimator.distance_from(count)
        };
        let (ex, ey) = (error(&self.x, start.x, ux), error(&self.y, start.y, uy));
        let rate = self.line.rate([ex, ey], wait);

        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        let (speed, accel) = (point.speed_mm_s as f32 * rate, point.accel_mm_s2 as f32 * rate * rate);
        let (dx, dy) =
            (speed * ux - self.x.estimator.speed_counts_s(), speed * uy - self.y.estimator.speed_counts_s());
        let a_along = accel + along.position * (ex * ux + ey * uy) + along.speed * (dx * ux + dy * uy);
        let a_across = across.position * (ey * ux - ex * uy) + across.speed * (dy * ux - dx * uy);

        self.line.go_on(rate, period_us);
        let (finished, over_us, waits) = (self.line.is_over(), self.line.over_us(), rate < 1.0);
        let rest_x = self.x.rests(finished || ux == 0.0, target.x, tolerance_counts, period_us);
        let rest_y = self.y.rests(finished || uy == 0.0, target.y, tolerance_counts, period_us);
        for (axis, target, rests, accel, unit, error) in [
            (&mut self.x, target.x, rest_x, a_along * ux - a_across * uy, ux, ex),
            (&mut self.y, target.y, rest_y, a_along * uy + a_across * ux, uy, ey),
        ] {
            if rests || axis.coasts(target) || (finished && axis.inches(target, over_us, period_us)) {
                continue;
            }
            // A whole count behind while the reference waits for it: it is stuck.
            let leaning = axis.lean(waits && error.abs() >= 1.0, error, period_us);
            let model = axis.estimator.model();
            let speed = speed * unit;
            let friction = libm::copysignf(model.dry_friction, if speed == 0.0 { error } else { speed });
            let push =
                accel + model.damping_per_s * speed + friction - axis.estimator.disturbance_counts_s2();
            let duty = push / (model.accel_per_volt * model.supply_v) + leaning;
            axis.drive(duty, if unit == 0.0 { error } else { unit });
        }
        self.line.settles(rest_x && rest_y, period_us);
        // Shafts that came to stand far beside the target are led there along a line of their own.
        if let (true, Some(far_x), Some(far_y)) =
            (finished, self.x.stands_far(target.x), self.y.stands_far(target.y))
            && (far_x || far_y)
        {
            self.line.from(self.position());
        }
    }
}

impl LineController for Contouring {
    fn period(&self) -> Option<Duration> {
        Some(self.law.period())
    }

    fn start(&mut self, now: Duration, target: StepPoint) -> Demand {
        self.predict(now);
        if target == self.line.target() && !self.has_arrived() {
            return self.demand(); // the host said it twice
        }
        let (position, has_arrived) = (self.position(), self.has_arrived());
        self.line.to(target, position, has_arrived);
        self.x.start();
        self.y.start();
        self.demand()
    }

    fn edge(&mut self, now: Duration, axis: Axis, direction: Direction) -> Demand {
        match axis {
            Axis::X => self.x.edge(now, direction),
            Axis::Y => self.y.edge(now, direction),
        };
        self.demand()
    }

    fn tick(&mut self, now: Duration) -> Demand {
        self.predict(now);
        self.x.estimator.no_edge();
        self.y.estimator.no_edge();
        self.line.catch_up(now, self.law.period_us);
        self.control();
        self.demand()
    }

    fn applied(&mut self, drive: Drive) {
        self.x.applied(drive.x());
        self.y.applied(drive.y());
    }

    fn position(&self) -> StepPoint {
        StepPoint::new(self.x.estimator.count(), self.y.estimator.count())
    }

    fn has_arrived(&self) -> bool {
        self.line.has_settled(self.law.settle_us)
    }

    fn trouble(&self) -> Option<AxisTrouble> {
        trouble_of(&self.x, &self.y)
    }

    fn reference(&self) -> Option<[f64; 2]> {
        Some(self.line.reference(self.line.plan_s()))
    }
}
