//! [`PlotTimer`]: the time of planned actions, without their steps.

use super::StepGenSettings;
use super::moment::Moment;
use crate::planner::{AllModes, Averaged, Modes};
use crate::{Pen, planner::Action};
use core::time::Duration;

/// How long a plot takes, and what on.
///
/// [`PlotTime::total`] is what [`PlotTime::motion`], [`PlotTime::pen`] and [`PlotTime::dwell`] make together,
/// but for a tick for each change between them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PlotTime {
    /// From the start to where the machine stands again.
    pub total: Duration,
    /// The part of it in which the pen moves over the sheet, up or down.
    pub motion: Duration,
    /// The part in which the machine stands for its pen to be lifted or lowered.
    pub pen: Duration,
    /// The pauses that the drawing asks for.
    pub dwell: Duration,
    /// Length of the planned path with the pen down, mm; a rounded corner counts as long as both its
    /// tangents: more than the curve by 1 % at a turn of 20 degrees, 7 % at 50, 23 % at a right angle. What
    /// rises counts as [`Course::length_mm`](crate::planner::Course::length_mm) tells it.
    pub draw_mm: f64,
    /// With the pen up, mm.
    pub travel_mm: f64,
    /// Lines, arcs and parabolas that were planned, and dots.
    pub courses: u64,
    /// Times that the pen was lowered.
    pub strokes: u64,
    /// Times that it was lifted.
    pub pen_lifts: u64,
    /// Times that a pen was taken or put away. A machine that does this by itself takes its own time for it,
    /// which is not counted.
    pub pens: u64,
    /// New sheets. That somebody puts them in is not counted either.
    pub pages: u64,
}

/// Adds up the time of a [`Planner`](crate::Planner)'s actions.
///
/// The clock is that of the [`StepGen`](super::StepGen): the time is the one at which its last action ends,
/// to the tick. For who has a planner already; [`Estimator`](super::Estimator) has one of its own.
///
/// ```
/// # use plotter_motion::{Planner, PlannerSettings, PlotOp, Point, stepgen::{PlotTimer, StepGenSettings}};
/// # use std::time::Duration;
/// // 10 mm at 1000 mm/s²: 0.1 s up to 100 mm/s and 0.1 s down; 200 ms for the pen down and up
/// let mut planner = Planner::<16>::new(PlannerSettings::default())?;
/// planner.push(PlotOp::Draw { to: Point::new(10.0, 0.0), feed_mm_s: None })?;
/// planner.finish()?;
/// let mut timer = PlotTimer::new(StepGenSettings::default());
/// while let Some(action) = planner.next_action() {
///     timer.push(&action);
/// }
/// assert_eq!(timer.time().total, Duration::from_millis(600));
/// assert_eq!((timer.time().motion, timer.time().strokes), (Duration::from_millis(200), 1));
/// # Ok::<(), plotter_motion::planner::PlanError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlotTimer {
    settings: StepGenSettings,
    now: Moment,
    pen: Pen,
    motion_ticks: u64,
    pen_ticks: u64,
    /// Over which the motion is averaged, if it is.
    window_ticks: u64,
    /// The motors have moved since the last rest.
    moves: bool,
    /// All but the times.
    counts: PlotTime,
}

impl PlotTimer {
    /// A machine that stands with its pen up. The clock runs at 1000 to 10⁹ ticks a second, as that of a
    /// [`StepGen`](super::StepGen).
    #[must_use]
    pub fn new(settings: StepGenSettings) -> Self {
        Self {
            settings: settings.checked::<AllModes>(),
            now: Moment::default(),
            pen: Pen::Up,
            motion_ticks: 0,
            pen_ticks: 0,
            window_ticks: 0,
            moves: false,
            counts: PlotTime::default(),
        }
    }

    /// The same of motion that is averaged: each rest takes the window more, until the motors have arrived.
    ///
    /// ```
    /// # use plotter_motion::{PathMode, PlannerSettings, stepgen::{PlotTimer, StepGenSettings}};
    /// # use plotter_motion::planner::{Action, Phase};
    /// # use std::time::Duration;
    /// let path = PathMode::Tolerance { path_tolerance_mm: 0.05 };
    /// let averaged = PlannerSettings { path, ..PlannerSettings::default() }.averaged(20_000.0)?; // 41.6 ms
    /// let mut timer = PlotTimer::new(StepGenSettings::default()).averaged(&averaged);
    /// timer.push(&Action::Phase(Phase { duration_s: 0.5, ..Phase::default() }));
    /// assert_eq!(timer.time().total, Duration::from_micros(541_602));
    /// # Ok::<(), plotter_motion::planner::PlanError>(())
    /// ```
    #[must_use]
    pub fn averaged(self, of: &Averaged) -> Self {
        Self { window_ticks: of.window_ticks(self.settings.clock_hz).into(), ..self }
    }

    /// Of a machine with these modes.
    pub(super) fn with_modes<M: Modes>(settings: StepGenSettings) -> Self {
        Self::new(settings.checked::<M>())
    }

    /// The motors arrive before anything else happens.
    fn arrive(&mut self) {
        if core::mem::take(&mut self.moves) {
            self.motion_ticks += self.window_ticks;
            self.now.tick = self.now.tick.saturating_add(self.window_ticks);
        }
    }

    /// Takes the next action.
    pub fn push(&mut self, action: &Action) {
        self.push_many(action, 1);
    }

    /// Takes an action, and if it is a phase, so many like it.
    pub(super) fn push_many(&mut self, action: &Action, count: u32) {
        match action {
            Action::Course(course) => {
                // A lift where the pen stands is neither line nor arc.
                self.counts.courses += u64::from(course.pen == Pen::Down || course.length_mm > 0.0);
                let way_mm = match course.pen {
                    Pen::Up => &mut self.counts.travel_mm,
                    Pen::Down => &mut self.counts.draw_mm,
                };
                *way_mm += f64::from(course.length_mm);
                self.put(course.pen);
            }
            Action::Phase(phase) => {
                self.moves = true;
                let after = self.now.after_phases(phase.duration_s, count, self.settings.clock_hz);
                self.motion_ticks += after.tick - self.now.tick;
                self.now = after;
            }
            Action::Dwell(duration) => {
                self.arrive();
                self.counts.dwell = self.counts.dwell.saturating_add(*duration);
                self.now = self.now.after(*duration, self.settings.clock_hz);
            }
            Action::SelectPen(_) => {
                self.arrive();
                self.counts.pens += 1;
                self.put(Pen::Up);
            }
            Action::NewPage => {
                self.arrive();
                self.counts.pages += 1;
                self.put(Pen::Up);
            }
        }
    }

    fn put(&mut self, pen: Pen) {
        if self.pen == pen {
            return;
        }
        self.arrive();
        match pen {
            Pen::Down => self.counts.strokes += 1,
            Pen::Up => self.counts.pen_lifts += 1,
        }
        if let Some(time) = self.settings.pen_time::<AllModes>(self.pen, pen) {
            let after = self.now.after(time, self.settings.clock_hz);
            self.pen_ticks += after.tick - self.now.tick;
            self.now = after;
        }
        self.pen = pen;
    }

    /// The time of what has been taken, up to where the motors have arrived.
    #[must_use]
    pub fn time(&self) -> PlotTime {
        let mut rests = *self;
        rests.arrive();
        rests.told()
    }

    fn told(&self) -> PlotTime {
        let seconds = |ticks| duration(ticks, self.settings.clock_hz);
        PlotTime {
            total: seconds(self.now.tick),
            motion: seconds(self.motion_ticks),
            pen: seconds(self.pen_ticks),
            ..self.counts
        }
    }
}

/// So many ticks, to the nanosecond below.
fn duration(ticks: u64, clock_hz: u32) -> Duration {
    let clock_hz = u64::from(clock_hz);
    let nanos = ticks % clock_hz * 1_000_000_000 / clock_hz;
    Duration::new(ticks / clock_hz, u32::try_from(nanos).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Planner, PlannerSettings, PlotOp, Point};

    fn time(settings: StepGenSettings, ops: &[PlotOp]) -> PlotTime {
        let mut planner = Planner::<16>::new(PlannerSettings::default()).unwrap();
        let mut timer = PlotTimer::new(settings);
        for op in ops {
            planner.push(*op).unwrap();
        }
        planner.finish().unwrap();
        while let Some(action) = planner.next_action() {
            timer.push(&action);
        }
        timer.time()
    }

    #[test]
    fn a_pen_takes_its_time_and_a_laser_does_not() {
        let draw = |x| PlotOp::Draw { to: Point::new(x, 0.0), feed_mm_s: None };
        let pause = PlotOp::Dwell { duration: Duration::from_millis(250) };
        let ops = [draw(10.0), PlotOp::SelectPen { pen: 2 }, pause, draw(20.0), PlotOp::NewPage];
        let found = time(StepGenSettings::default(), &ops);
        // 0.2 s for each line, as long for the pen down, up, down, up
        let times = [found.total, found.motion, found.pen, found.dwell].map(|time| time.as_millis());
        assert_eq!(times, [1450, 400, 800, 250]);
        assert_eq!((found.strokes, found.pen_lifts, found.pens, found.pages, found.courses), (2, 2, 1, 1, 2));
        assert_eq!((found.draw_mm, found.travel_mm), (20.0, 0.0));
        let laser = time(StepGenSettings { laser: true, ..StepGenSettings::default() }, &ops);
        assert_eq!((laser.total.as_millis(), laser.pen), (650, Duration::ZERO));
    }

    #[test]
    fn ticks_are_seconds_whatever_their_number() {
        assert_eq!(duration(2_500_000, 1_000_000), Duration::from_millis(2500));
        assert_eq!(duration(u64::MAX, 1_000_000_000), Duration::from_nanos(u64::MAX));
        assert_eq!(duration(u64::MAX, 1000).subsec_millis(), 615);
    }
}
