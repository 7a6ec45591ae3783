//! [`PointToPoint`]: the marking board's controller, which knows eight directions.

use super::{DriveRamp, Equalizer, EqualizerSettings, LineController};
use crate::config::OneBeltConfig;
use crate::kinematics::BeltSigns;
use crate::{Axis, Demand, Direction, Drive, Duty, Machine, StepPoint};
use core::time::Duration;

/// The published way from point to point (Khan and McGinn, section 0.2.4): each axis is driven towards its
/// target until it is within the allowed error, then it gets no drive.
///
/// ```text
///   error in x beyond the allowed one?  ──▶ left, none, right ─┐
///                                                              ├─▶ one of eight directions ─▶ both motors fully, or one
///   error in y beyond the allowed one?  ──▶ down, none, up ────┘
/// ```
///
/// Targets, positions and demands are those of the two motors of a belt ([`BeltSigns`]). A line that is not
/// along one of the eight directions is not straight: it is a diagonal and then a line along an axis. Motors
/// that differ make a line along an axis drift; against that there is the published factor for each motor,
/// found by hand, and ours, an [`Equalizer`], which trims both drives while both motors run.
///
/// ```
/// # use plotter_motion::control::{LineController, PointToPoint, PointToPointSettings};
/// # use plotter_motion::StepPoint;
/// # use core::time::Duration;
/// let mut controller = PointToPoint::new(PointToPointSettings::default());
/// controller.start(Duration::ZERO, StepPoint::new(463, 463)); // 10 mm to the right
/// let demand = controller.tick(Duration::from_millis(5));
/// assert_eq!(demand.x, demand.y); // both motors alike
/// assert!(demand.x.value() > 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointToPoint {
    settings: PointToPointSettings,
    equalizer: Option<Equalizer>,
    position: StepPoint,
    target: StepPoint,
    started: Duration,
    /// Time and position of the last run.
    last_run: Duration,
    last_position: StepPoint,
    /// Directions of the last run, to begin a stretch of equal speeds anew when they change.
    last_signs: (i8, i8),
    arrived: bool,
    demand: Demand,
}

/// What [`PointToPoint`] must know.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct PointToPointSettings {
    /// Directions of the motors.
    pub signs: BeltSigns,
    /// Error of an axis at which it gets no drive, counts.
    pub allowed_counts: f32,
    /// Drive since the start of a move.
    pub ramp: DriveRamp,
    /// Within so many counts of where an axis gets no drive any more, the drive falls back to that at the
    /// start, so that unequal motors run down for less; 0 as published.
    pub slow_counts: f32,
    /// Factors for the drives of both motors, 0 to 1: found by hand as published, or both 1.
    pub factors: [f32; 2],
    /// Trims both drives by what the motors did.
    pub equalizer: Option<EqualizerSettings>,
    /// How often it runs.
    pub period: Duration,
}

impl Default for PointToPointSettings {
    /// As published: 0.45 mm at 46.3 counts/mm, one level of drive (0.45 of the supply, some 30 mm/s on the
    /// simulated board) from the start, no equalizer; 200 runs a second.
    fn default() -> Self {
        let most = 0.45;
        Self {
            signs: BeltSigns::DirectionTable,
            allowed_counts: 0.45 * 46.3,
            ramp: DriveRamp { start: most, step: 0.0, most, period: Duration::ZERO },
            slow_counts: 0.0,
            factors: [1.0, 1.0],
            equalizer: None,
            period: Duration::from_millis(5),
        }
    }
}

impl PointToPointSettings {
    /// Those of a machine with a belt.
    ///
    /// ```
    /// # use plotter_motion::{Machine, MachineConfig, control::PointToPointSettings};
    /// let settings = PointToPointSettings::of(&Machine::new(MachineConfig::marking_board())?);
    /// assert_eq!(settings.allowed_counts, 20.835); // 0.45 mm at 46.3 counts/mm
    /// assert!(settings.equalizer.is_none());
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        let OneBeltConfig { dc, signs, point_to_point: from, .. } = OneBeltConfig::of(machine);
        let counts_per_mm = dc.x.counts_per_mm;
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        let single = |value: f64| value as f32;
        let equalizer = EqualizerSettings {
            time_constant_s: single(from.equalizer_time_constant_ms * 1e-3),
            pole_rad_s: single(from.equalizer_pole_rad_s),
            full_speed_counts_s: single(from.equalizer_full_speed_mm_s * counts_per_mm),
            most_trim: single(from.equalizer_most_trim),
        };
        Self {
            signs,
            allowed_counts: single(from.allowed_error_mm * counts_per_mm),
            ramp: DriveRamp {
                start: single(from.drive_start),
                step: single(from.drive_step),
                most: single(from.drive_most),
                period: Duration::from_secs_f64(from.drive_step_ms * 1e-3),
            },
            slow_counts: single(from.slow_mm * counts_per_mm),
            factors: [single(from.factor_x), single(from.factor_y)],
            equalizer: from.equalize.then_some(equalizer),
            period: Duration::from_secs_f64(from.period_ms * 1e-3),
        }
    }
}

impl PointToPoint {
    /// A controller at rest at the origin.
    #[must_use]
    pub fn new(settings: PointToPointSettings) -> Self {
        Self {
            settings,
            equalizer: settings.equalizer.map(Equalizer::new),
            position: StepPoint::default(),
            target: StepPoint::default(),
            started: Duration::ZERO,
            last_run: Duration::ZERO,
            last_position: StepPoint::default(),
            last_signs: (0, 0),
            arrived: true,
            demand: Demand::NONE,
        }
    }

    /// Where the target is from here, counts along both axes.
    fn error(&self) -> [f32; 2] {
        let ahead = |is: i32, target: i32| i64::from(target) - i64::from(is);
        let (x2, y2) = self
            .settings
            .signs
            .twice_axes(ahead(self.position.x, self.target.x), ahead(self.position.y, self.target.y));
        #[expect(clippy::cast_precision_loss, reason = "only small ones are compared closely")]
        let error = [x2 as f32 / 2.0, y2 as f32 / 2.0];
        error
    }

    /// The size of the drive with so far to go on the axis that is farther from its target.
    fn level(&self, now: Duration, error: [f32; 2]) -> f32 {
        let PointToPointSettings { ramp, slow_counts, allowed_counts, .. } = self.settings;
        let level = ramp.after(now.saturating_sub(self.started));
        let to_go = error.map(f32::abs).into_iter().fold(0.0, f32::max) - allowed_counts;
        if to_go < slow_counts {
            level.min(ramp.start + (ramp.most - ramp.start) * to_go.max(0.0) / slow_counts)
        } else {
            level
        }
    }
}

impl LineController for PointToPoint {
    fn period(&self) -> Option<Duration> {
        Some(self.settings.period)
    }

    fn start(&mut self, now: Duration, target: StepPoint) -> Demand {
        self.target = target;
        self.started = now;
        self.arrived = false;
        self.demand
    }

    fn edge(&mut self, _now: Duration, axis: Axis, direction: Direction) -> Demand {
        match axis {
            Axis::X => self.position.x = self.position.x.saturating_add(direction.sign()),
            Axis::Y => self.position.y = self.position.y.saturating_add(direction.sign()),
        }
        self.demand
    }

    fn tick(&mut self, now: Duration) -> Demand {
        let dt_s = now.saturating_sub(self.last_run).as_secs_f32();
        let made = [
            self.position.x.saturating_sub(self.last_position.x),
            self.position.y.saturating_sub(self.last_position.y),
        ];
        (self.last_run, self.last_position) = (now, self.position);
        let error = self.error();
        let allowed = self.settings.allowed_counts;
        let direction = |error: f32| i8::from(error > allowed) - i8::from(error < -allowed);
        let [x, y] = if self.arrived { [0, 0] } else { error.map(direction) };
        self.arrived |= [x, y] == [0, 0];
        let (first, second) = self.settings.signs.motors(x, y);
        let signs = (first.signum(), second.signum());
        let level = self.level(now, error);
        let [factor_1, factor_2] = self.settings.factors;
        let wanted = [f32::from(signs.0) * level, f32::from(signs.1) * level];
        let mut trims = (1.0, 1.0);
        if let Some(equalizer) = &mut self.equalizer {
            if signs == self.last_signs {
                trims = equalizer.update(made, wanted, dt_s);
            } else {
                equalizer.restart();
            }
        }
        self.last_signs = signs;
        let [first, second] = wanted;
        self.demand = Demand {
            x: Duty::saturating(first * factor_1 * trims.0),
            y: Duty::saturating(second * factor_2 * trims.1),
        };
        self.demand
    }

    fn applied(&mut self, _drive: Drive) {}

    fn position(&self) -> StepPoint {
        self.position
    }

    fn has_arrived(&self) -> bool {
        self.arrived
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Which motors are driven, and which way, for a target (x, y) in counts.
    fn signs(x: i32, y: i32) -> (Option<Direction>, Option<Direction>) {
        let mut controller = PointToPoint::new(PointToPointSettings::default());
        let (first, second) = BeltSigns::DirectionTable.motors(x, y);
        controller.start(Duration::ZERO, StepPoint::new(first, second));
        let demand = controller.tick(Duration::from_millis(5));
        (demand.x.direction(), demand.y.direction())
    }

    #[test]
    fn eight_directions_as_in_the_table() {
        use Direction::{Minus, Plus};
        assert_eq!(signs(-100, 0), (Some(Minus), Some(Minus)));
        assert_eq!(signs(100, 0), (Some(Plus), Some(Plus)));
        assert_eq!(signs(0, 100), (Some(Minus), Some(Plus)));
        assert_eq!(signs(0, -100), (Some(Plus), Some(Minus)));
        assert_eq!(signs(-100, 100), (Some(Minus), None));
        assert_eq!(signs(-100, -100), (None, Some(Minus)));
        assert_eq!(signs(100, 100), (None, Some(Plus)));
        assert_eq!(signs(100, -100), (Some(Plus), None));
    }

    #[test]
    fn an_axis_within_the_allowed_error_gets_no_drive() {
        // 0.45 mm are 20.8 counts: 20 are near enough, 21 are not
        assert_eq!(signs(20, -20), (None, None));
        assert_eq!(signs(21, 20), signs(100, 0));
    }

    #[test]
    fn a_target_once_reached_is_left_alone() {
        let mut controller = PointToPoint::new(PointToPointSettings::default());
        controller.start(Duration::ZERO, StepPoint::new(10, 10));
        assert!(!controller.has_arrived());
        controller.tick(Duration::from_millis(5));
        assert!(controller.has_arrived());
        for _ in 0..100 {
            controller.edge(Duration::from_millis(6), Axis::X, Direction::Minus);
        }
        assert_eq!(controller.tick(Duration::from_millis(10)), Demand::NONE);
    }

    #[test]
    fn the_drive_grows_by_steps_and_falls_near_the_target() {
        let ramp = DriveRamp { start: 0.1, step: 0.1, most: 0.3, period: Duration::from_millis(100) };
        let settings = PointToPointSettings {
            ramp,
            slow_counts: 100.0,
            allowed_counts: 10.0,
            factors: [1.0, 0.5],
            ..PointToPointSettings::default()
        };
        let mut controller = PointToPoint::new(settings);
        controller.start(Duration::ZERO, StepPoint::new(1000, 1000)); // to the right
        let mut at = |ms| {
            let Demand { x, y } = controller.tick(Duration::from_millis(ms));
            assert!((y.value() - 0.5 * x.value()).abs() < 1e-6, "the factor found by hand");
            x.value()
        };
        assert_eq!((at(5), at(105), at(1000)), (0.1, 0.2, 0.3));
        for _ in 0..940 {
            controller.edge(Duration::from_millis(1001), Axis::X, Direction::Plus);
            controller.edge(Duration::from_millis(1001), Axis::Y, Direction::Plus);
        }
        // 60 to go, of which the last 10 need no drive: half way between 0.3 and 0.1
        let slow = controller.tick(Duration::from_millis(1005)).x.value();
        assert!((slow - 0.2).abs() < 1e-6, "{slow}");
    }
}
