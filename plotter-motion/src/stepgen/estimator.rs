//! [`Estimator`]: the time of a drawing, without its steps.

use super::{PlotTime, PlotTimer, StepGenSettings};
use crate::planner::{AllModes, Modes};
use crate::{Planner, PlannerSettings, PlotOp, planner::PlanError};

/// How long a drawing takes, told as it comes in: a [`Planner`] with `N` blocks of look-ahead, and a
/// [`PlotTimer`].
///
/// With as many blocks as the machine has, it is the time in which a [`StepGen`](super::StepGen) plays the
/// drawing, to the tick: the same plan, the same phases, the same clock, and only the steps are left out. So
/// it takes a hundredth of the work, and as little memory for a drawing of any size.
///
/// Where the jerk is limited as a vector (feature `averaged-steps`), each rest takes the window more over
/// which the motion is averaged.
///
/// Where a machine has other motors or other kinematics makes no difference to its time, but by
/// [`PlannerSettings::resolution_mm`].
///
/// ```
/// # use plotter_motion::{PlannerSettings, PlotOp, Point, stepgen::{Estimator, StepGenSettings}};
/// # use std::time::Duration;
/// let mut estimator = Estimator::<16>::new(PlannerSettings::default(), StepGenSettings::default())?;
/// // 100 mm at 100 mm/s and 1000 mm/s²: 1 s, and 0.1 s for the ramps; 200 ms for the pen down and up
/// estimator.push(PlotOp::Draw { to: Point::new(100.0, 0.0), feed_mm_s: None })?;
/// let time = estimator.finish()?;
/// assert!(time.total.abs_diff(Duration::from_millis(1500)) < Duration::from_micros(2));
/// # Ok::<(), plotter_motion::planner::PlanError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Estimator<const N: usize, M: Modes = AllModes> {
    planner: Planner<N, M>,
    timer: PlotTimer,
}

impl<const N: usize> Estimator<N> {
    /// Of a machine that stands at the origin with its pen up.
    ///
    /// # Errors
    ///
    /// [`PlanError::Setting`] for a limit that no motion can be planned with; [`PlanError::Averaging`] for a
    /// laser where the jerk is limited as a vector.
    pub fn new(settings: PlannerSettings, timing: StepGenSettings) -> Result<Self, PlanError> {
        Self::with_modes(settings, timing)
    }
}

impl<const N: usize, M: Modes> Estimator<N, M> {
    /// As [`Estimator::new`], of a machine with the modes of its type.
    ///
    /// # Errors
    ///
    /// [`PlanError::Mode`] for a mode that is not among them, and as [`Estimator::new`].
    pub fn with_modes(settings: PlannerSettings, timing: StepGenSettings) -> Result<Self, PlanError> {
        settings.check::<M>()?;
        let averaged = settings.planned_of_checked();
        if averaged.window_s > 0.0 && timing.laser {
            return Err(PlanError::Averaging { quantity: "a laser" });
        }
        let timer = PlotTimer::with_modes::<M>(timing).averaged(&averaged);
        Ok(Self { planner: Planner::with_modes(averaged.settings)?, timer })
    }

    /// Takes the next operation.
    ///
    /// # Errors
    ///
    /// What is wrong with the operation, which is left out.
    pub fn push(&mut self, op: PlotOp) -> Result<(), PlanError> {
        self.make_room();
        self.planner.push(op)
    }

    /// No operation comes for now: the time up to where the machine stands. More may be pushed afterwards.
    ///
    /// # Errors
    ///
    /// None: there is room for what has been put off.
    pub fn finish(&mut self) -> Result<PlotTime, PlanError> {
        self.finish_with(|_| {})
    }

    /// As [`finish`](Self::finish), and tells the time up to the end of each piece of motion that is left.
    ///
    /// # Errors
    ///
    /// As [`finish`](Self::finish).
    pub fn finish_with(&mut self, mut each: impl FnMut(PlotTime)) -> Result<PlotTime, PlanError> {
        self.make_room();
        self.planner.finish()?;
        while self.advance() {
            each(self.time());
        }
        Ok(self.time())
    }

    /// The time of what can be told so far: all but the blocks that are still looked ahead at.
    #[must_use]
    pub fn time(&self) -> PlotTime {
        self.timer.time()
    }

    fn make_room(&mut self) {
        while !self.planner.has_room() && self.advance() {}
    }

    /// Takes what the planner gives next; whether there was something.
    fn advance(&mut self) -> bool {
        let Some((action, count)) = self.planner.next_ramp() else { return false };
        self.timer.push_many(&action, count);
        true
    }
}
