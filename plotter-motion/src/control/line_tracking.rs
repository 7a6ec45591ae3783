//! Published PID line tracking: x leads, y follows the slope.

use super::LineController;
use crate::config::DcConfig;
use crate::{
    Axis, Demand, Direction, Drive, Duty, Machine, StepPoint,
    config::PublishedConfig,
    control::{SumPid, SumPidState, SyncStop},
};
use core::time::Duration;

/// PID line tracking as published (Öcal, sections 4.4 and 4.5, and the thesis' appendix A, which settles the
/// order of things).
///
/// With `dx`, `dy` counted from the start of the line and `m` its slope:
///
/// ```text
///   e_x = x_target - x          e_y = m dx - dy        (on a vertical line e_y = y_target - y)
///   u = Kp e + Ki sum(e) + Kd (e - e_prev)             cut to whole steps of 255, limited
/// ```
///
/// The sign of u is the direction; in the call in which it flips, u is halved. While
/// `|dy - m dx| > 10 |m| + 10`, with the values of the *previous* call, x gets nothing. It runs only when an
/// edge or a target comes: when both motors stand, nothing can change any more, wherever they are. The
/// program keeps `Ki e` of x in a whole number, which is 0 for every error below 100,000 counts, so in effect
/// only y has a sum.
///
/// The allowed deviation is not certain. The program writes `10*abs(m)+10`. In plain C `abs` makes a whole
/// number of its argument: a slope of 1/2 would allow 10 counts. In some compilers for its microcontroller
/// `abs` keeps the type of its argument: the same slope allows 15. The second is built here, with the true
/// `|m|`. The thesis says that the threshold is "based on the slope of the line" (section 4.5, eq. 4.8), and
/// with the first all slopes below 1 would have the same one. On steeper lines the two differ by less than 10
/// counts. The other `abs` of the program are applied to u, which the PWM takes in whole steps: there nothing
/// is left open, and u is cut.
///
/// ```
/// # use plotter_motion::{Axis, Direction, Machine, MachineConfig, StepPoint, control::{LineController, LineTracking}};
/// # use core::time::Duration;
/// let machine = Machine::new(MachineConfig::default())?;
/// let mut controller = LineTracking::new(&machine);
/// let demand = controller.start(Duration::ZERO, StepPoint::new(400, 200));
/// assert_eq!((demand.x.steps(255), demand.y.steps(255)), (20, 0)); // 15 * 400, limited; y is on the line
/// let demand = controller.edge(Duration::ZERO, Axis::X, Direction::Plus);
/// assert_eq!(demand.y.steps(255), 12); // m dx - dy = 1/2: 15/2 + 10/2, cut
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineTracking {
    settings: LineTrackingSettings,
    position: StepPoint,
    start: StepPoint,
    target: StepPoint,
    x: TrackedAxis,
    y: TrackedAxis,
    /// Slope and deviation `dy - m dx` of the previous call.
    slope: f32,
    deviation: f32,
    demand: Demand,
}

/// What [`LineTracking`] must know of a machine: a few numbers that a firmware keeps in its program memory.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct LineTrackingSettings {
    /// Gains and limits.
    pub published: PublishedConfig,
    /// When x waits for y.
    pub sync_stop: SyncStop,
}

impl LineTrackingSettings {
    /// Those of a machine.
    ///
    /// ```
    /// # use plotter_motion::{Machine, MachineConfig, control::LineTrackingSettings};
    /// let machine = Machine::new(MachineConfig::default())?;
    /// assert_eq!(LineTrackingSettings::of(&machine).published.kp, 15.0);
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        let config = DcConfig::of(machine);
        Self { published: config.control.published, sync_stop: SyncStop::new(config.sync_stop) }
    }
}

/// What the controller remembers of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TrackedAxis {
    pid: SumPid,
    state: SumPidState,
    /// Sum gain of an axis whose sum is kept in whole numbers, and that sum.
    whole_ki: f32,
    whole_sum: f32,
    forwards: bool,
}

impl TrackedAxis {
    fn output(&mut self, error: f32) -> f32 {
        self.whole_sum += libm::truncf(error * self.whole_ki);
        self.pid.update(&mut self.state, error) + self.whole_sum
    }

    /// Sets the direction from the sign of `u`, halves `u` if it flipped, and cuts it to whole duty steps.
    fn duty(&mut self, u: f32, limit: f32) -> Duty {
        // The sign is taken of u cut to a whole number, so what is below 1 counts as forwards.
        let forwards = libm::truncf(u) >= 0.0;
        let flipped = forwards != self.forwards;
        self.forwards = forwards;
        let size = libm::truncf(if flipped { u / 2.0 } else { u }.abs()).min(limit);
        Duty::saturating(if forwards { size } else { -size } / FULL_DUTY)
    }
}

/// The published duty runs from 0 to 255.
const FULL_DUTY: f32 = 255.0;

impl LineTracking {
    /// A controller at rest at the origin, with the machine's gains and limits.
    #[must_use]
    pub fn new(machine: &Machine) -> Self {
        Self::with_settings(LineTrackingSettings::of(machine))
    }

    /// The same from settings.
    #[must_use]
    pub fn with_settings(settings: LineTrackingSettings) -> Self {
        let published = settings.published;
        let axis = |ki, whole_ki, kd| TrackedAxis {
            pid: SumPid { kp: published.kp, ki, kd },
            state: SumPidState::default(),
            whole_ki,
            whole_sum: 0.0,
            forwards: true,
        };
        Self {
            settings,
            position: StepPoint::default(),
            start: StepPoint::default(),
            target: StepPoint::default(),
            x: axis(0.0, published.ki, published.kd_x),
            y: axis(published.ki, 0.0, published.kd_y),
            slope: 0.0,
            deviation: 0.0,
            demand: Demand::NONE,
        }
    }

    fn run(&mut self) -> Demand {
        let LineTrackingSettings { published, sync_stop } = self.settings;
        let to_target = difference(self.target, self.position);
        let line = difference(self.target, self.start);
        let done = difference(self.position, self.start);

        let u_x = self.x.output(to_target.0);
        self.demand.x = if sync_stop.must_wait(self.slope, self.deviation) {
            Duty::ZERO
        } else {
            self.x.duty(u_x, published.duty_limit_x)
        };

        let (error, limit) = if line.0 == 0.0 {
            (to_target.1, published.duty_limit_y_vertical)
        } else {
            self.slope = line.1 / line.0;
            self.deviation = done.1 - self.slope * done.0;
            (-self.deviation, published.duty_limit_y)
        };
        let u_y = self.y.output(error);
        self.demand.y = self.y.duty(u_y, limit);
        if self.has_arrived() {
            // From here on the line has no length, so what follows runs as on a vertical line.
            self.start = self.target;
        }
        self.demand
    }
}

/// `a - b`, exact as long as the counts have at most 24 bits, which a checked machine's have.
fn difference(a: StepPoint, b: StepPoint) -> (f32, f32) {
    #[expect(clippy::cast_precision_loss, reason = "a checked machine has at most 99999 counts")]
    let difference = (a.x.saturating_sub(b.x) as f32, a.y.saturating_sub(b.y) as f32);
    difference
}

impl LineController for LineTracking {
    fn period(&self) -> Option<Duration> {
        None
    }

    fn start(&mut self, _now: Duration, target: StepPoint) -> Demand {
        self.target = target;
        self.run()
    }

    fn edge(&mut self, _now: Duration, axis: Axis, direction: Direction) -> Demand {
        match axis {
            Axis::X => self.position.x = self.position.x.saturating_add(direction.sign()),
            Axis::Y => self.position.y = self.position.y.saturating_add(direction.sign()),
        }
        self.run()
    }

    fn tick(&mut self, _now: Duration) -> Demand {
        self.demand
    }

    fn applied(&mut self, _drive: Drive) {}

    fn position(&self) -> StepPoint {
        self.position
    }

    fn has_arrived(&self) -> bool {
        self.position == self.target
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MachineConfig;

    /// Whether x still runs on a line of slope 1/2 when y is so many counts above it.
    fn x_runs_at(deviation_counts: u32) -> bool {
        let Ok(machine) = Machine::new(MachineConfig::default()) else { panic!("the preset is a machine") };
        let mut tracking = LineTracking::new(&machine);
        tracking.start(Duration::ZERO, StepPoint::new(400, 200));
        for _ in 0..deviation_counts {
            tracking.edge(Duration::ZERO, Axis::Y, Direction::Plus);
        }
        // The rule looks at the values of the call before: this one changes nothing more than that.
        tracking.start(Duration::ZERO, StepPoint::new(400, 200)).x != Duty::ZERO
    }

    #[test]
    fn a_slope_of_a_half_allows_fifteen_counts_not_the_ten_of_a_slope_that_is_cut() {
        assert!(x_runs_at(10) && x_runs_at(11) && x_runs_at(15));
        assert!(!x_runs_at(16));
    }
}
