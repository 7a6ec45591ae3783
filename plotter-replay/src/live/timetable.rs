//! [`Timetable`]: when a machine will have done which part of a drawing, by its own limits.

use super::Plan;
use core::time::Duration;
use plotter_motion::planner::PlanError;
use plotter_motion::stepgen::{Estimator, StepGenSettings};
use plotter_motion::{Machine, PlannerSettings, PlotOp, Point};

/// Entries that are kept of a table; where there would be more, every other one goes. With 4096 of them none
/// stands for more than a 2048th of the drawing, 0.05 %.
const MOST_ENTRIES: usize = 4_096;

/// When a machine will have done which operation, from the limits of its description, in bounded memory.
///
/// ```
/// # use plotter_motion::{Machine, MachineConfig, PlotOp, Point};
/// # use plotter_replay::live::Timetable;
/// let machine = Machine::new(MachineConfig::stepper_plotter())?;
/// let mut table = Timetable::new(&machine)?;
/// for x in [45.0, 90.0, 135.0, 180.0] {
///     table.push(PlotOp::Draw { to: Point::new(x, 0.0), feed_mm_s: None }); // at 45 mm/s
/// }
/// let total = table.finish();
/// // 4 s, 0.18 s for the ramps and 0.4 s for the pen down and up
/// assert!((total.as_secs_f64() - 4.58).abs() < 0.01);
/// let rest = table.rest(2, total);
/// assert!((rest.as_secs_f64() - 2.3).abs() < 0.2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Timetable {
    estimator: Estimator<16>,
    /// Operations and when they are done at the earliest, s.
    entries: Vec<(u64, f64)>,
    /// Every so many operations are kept.
    every: u64,
    ops: u64,
    at: Point,
    way_mm: f64,
    total: Duration,
}

impl Timetable {
    /// Of a machine, at its origin with the pen up.
    ///
    /// # Errors
    ///
    /// [`PlanError`] for limits that nothing can be planned with.
    pub fn new(machine: &Machine) -> Result<Self, PlanError> {
        let estimator = Estimator::new(PlannerSettings::of(machine), StepGenSettings::of(machine))?;
        Ok(Self {
            estimator,
            entries: Vec::new(),
            every: 1,
            ops: 0,
            at: Point::ORIGIN,
            way_mm: 0.0,
            total: Duration::ZERO,
        })
    }

    /// Takes the next operation; one that cannot be planned takes no time.
    pub fn push(&mut self, op: PlotOp) {
        let _ = self.estimator.push(op); // (its host says that it is left out)
        if let Some(to) = op.target() {
            self.way_mm += self.at.distance(to);
            self.at = to;
        }
        self.ops = self.ops.saturating_add(1);
        if self.ops.is_multiple_of(self.every) {
            self.entries.push((self.ops, self.estimator.time().total.as_secs_f64()));
        }
        if self.entries.len() > MOST_ENTRIES {
            self.every = self.every.saturating_mul(2);
            let every = self.every;
            self.entries.retain(|(op, _)| op.is_multiple_of(every));
        }
    }

    /// No more operations come: how long all of them take. That somebody changes pens is not in it.
    pub fn finish(&mut self) -> Duration {
        self.total = self.estimator.finish().unwrap_or_else(|_| self.estimator.time()).total;
        self.entries.push((self.ops, self.total.as_secs_f64()));
        self.total
    }

    /// How much it is.
    #[must_use]
    pub fn plan(&self) -> Plan {
        Plan { targets: self.ops, way_mm: self.way_mm }
    }

    /// How long the rest takes when so many operations are done and the machine has drawn for `drawn`. Where
    /// the machine is slower or faster than its description, the rest is so, too, once a twentieth is drawn.
    #[must_use]
    pub fn rest(&self, done: u64, drawn: Duration) -> Duration {
        let total_s = self.total.as_secs_f64();
        let at_s = self.time_s(done);
        let next_s = self.time_s(done.saturating_add(1));
        let drawn_s = drawn.as_secs_f64();
        let share = if at_s > 0.05 * total_s && drawn_s > 0.0 {
            // What is under way is partly done, too: the pace is right for both ends, or for what lies between.
            if drawn_s < at_s {
                drawn_s / at_s
            } else if drawn_s > next_s {
                drawn_s / next_s
            } else {
                1.0
            }
        } else {
            1.0
        };
        let now_s = (drawn_s / share).clamp(at_s, next_s.max(at_s));
        Duration::try_from_secs_f64(((total_s - now_s) * share).max(0.0)).unwrap_or_default()
    }

    /// When so many operations are done, s.
    fn time_s(&self, done: u64) -> f64 {
        let place = self.entries.partition_point(|&(op, _)| op < done);
        let (op, time_s) = self.entries.get(place).or(self.entries.last()).copied().unwrap_or_default();
        let before =
            place.checked_sub(1).and_then(|place| self.entries.get(place)).copied().unwrap_or_default();
        if op <= before.0 || done >= op {
            return time_s;
        }
        #[expect(clippy::cast_precision_loss, reason = "a share")]
        let share = done.saturating_sub(before.0) as f64 / (op - before.0) as f64;
        before.1 + share * (time_s - before.1)
    }
}
