//! [`Timetable`]: when a machine will have done which part of a drawing, by its own limits.

use super::Plan;
use core::time::Duration;
use plotter_motion::planner::PlanError;
use plotter_motion::stepgen::{Estimator, StepGenSettings};
use plotter_motion::{Machine, PlannerSettings, PlotOp, Point};

/// Entries that are kept of a table; where there would be more, every other one goes. With 4096 of them none
/// stands for more than a 2048th of the drawing, 0.05 %.
const MOST_ENTRIES: usize = 4_096;

/// So long after it an operation is known to be done, s: a host asks five times a second, and a
/// place near a corner is not past it.
const TOLD_LATE_S: f64 = 0.35;

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
/// let rest = table.rest(2, total / 2);
/// assert!((rest.as_secs_f64() - 2.3).abs() < 0.2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Timetable {
    estimator: Estimator<16>,
    /// Operations and how far the pen has gone behind them, mm.
    ways: Table,
    /// How far it has gone, mm, and when, s. It is told later than it is asked for: the planner looks ahead.
    times: Table,
    ops: u64,
    at: Point,
    way_mm: f64,
    total: Duration,
}

/// Pairs of numbers that grow together, as many as are kept.
#[derive(Clone, Debug)]
struct Table {
    entries: Vec<(f64, f64)>,
    /// Every so many are kept.
    every: u64,
    taken: u64,
}

impl Table {
    const fn new() -> Self {
        Self { entries: Vec::new(), every: 1, taken: 0 }
    }

    fn push(&mut self, from: f64, to: f64) {
        // What is told of one place last is what holds behind it.
        if let Some(last) = self.entries.last_mut().filter(|last| last.0 == from) {
            last.1 = to;
            return;
        }
        self.taken = self.taken.saturating_add(1);
        if !self.taken.is_multiple_of(self.every) {
            return;
        }
        self.entries.push((from, to));
        if self.entries.len() > MOST_ENTRIES {
            self.every = self.every.saturating_mul(2);
            let mut is_kept = false;
            self.entries.retain(|_| {
                is_kept = !is_kept;
                !is_kept
            });
        }
    }

    /// What belongs to a number: evenly between what is kept, from (0, 0) on.
    fn at(&self, from: f64) -> f64 {
        let place = self.entries.partition_point(|&(entry, _)| entry < from);
        let before =
            place.checked_sub(1).and_then(|place| self.entries.get(place)).copied().unwrap_or_default();
        let Some(&(next, to)) = self.entries.get(place) else { return before.1 };
        let span = next - before.0;
        if span > 0.0 { before.1 + (from - before.0) / span * (to - before.1) } else { to }
    }
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
            ways: Table::new(),
            times: Table::new(),
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
            self.way_mm += match op {
                PlotOp::DrawArc { centre, sweep_rad, .. } => (to - centre).length() * sweep_rad.abs(),
                _ => self.at.distance(to),
            };
            self.at = to;
        }
        self.ops = self.ops.saturating_add(1);
        #[expect(clippy::cast_precision_loss, reason = "operations below 2^53")]
        self.ways.push(self.ops as f64, self.way_mm);
        let time = self.estimator.time();
        self.times.push(time.draw_mm + time.travel_mm, time.total.as_secs_f64());
    }

    /// No more operations come: how long all of them take. That somebody changes pens is not in it.
    pub fn finish(&mut self) -> Duration {
        let Self { estimator, times, .. } = self;
        let told =
            estimator.finish_with(|time| times.push(time.draw_mm + time.travel_mm, time.total.as_secs_f64()));
        let time = told.unwrap_or_else(|_| estimator.time());
        times.entries.push((time.draw_mm + time.travel_mm, time.total.as_secs_f64()));
        #[expect(clippy::cast_precision_loss, reason = "operations below 2^53")]
        self.ways.entries.push((self.ops as f64, self.way_mm));
        self.total = time.total;
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
        // What is under way is partly done, too, and may be done by now.
        let next_s = (self.time_s(done.saturating_add(1)) + TOLD_LATE_S).max(at_s);
        let drawn_s = drawn.as_secs_f64();
        if at_s <= 0.05 * total_s {
            // Too little to tell how fast it is.
            return self
                .total
                .saturating_sub(drawn.max(Duration::try_from_secs_f64(at_s).unwrap_or_default()));
        }
        let share = if (at_s..=next_s).contains(&drawn_s) {
            1.0
        } else if drawn_s < at_s {
            drawn_s / at_s
        } else {
            drawn_s / next_s
        };
        let now_s = if share > 0.0 { (drawn_s / share).clamp(at_s, next_s) } else { at_s };
        Duration::try_from_secs_f64(((total_s - now_s) * share).max(0.0)).unwrap_or_default()
    }

    /// How far the pen has gone when so many operations are done, mm.
    pub(super) fn way_mm(&self, done: u64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "operations below 2^53")]
        self.ways.at(done as f64)
    }

    /// When so many operations are done, s.
    fn time_s(&self, done: u64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "operations below 2^53")]
        self.times.at(self.ways.at(done as f64))
    }
}
