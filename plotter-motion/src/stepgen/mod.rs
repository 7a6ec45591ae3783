//! From planned motion to timed steps.
//!
//! ```text
//!  Planner ──Action──▶ StepGen ──TimedEvent──▶ STEP and DIR pins, pen servo, laser
//!           mm, s                  ticks
//! ```
//!
//! A course is laid on the grid of the motors, an arc in chords that lie within a quarter of a step of it,
//! and each chord is stepped as Bresenham's line: at each step of the motor that has the longer way, the
//! other one steps or does not. Steps are due half way between the grid's lines, so that the motors are never
//! farther than half a step from the path.
//!
//! [`timed_events`] is both in one call, for a desktop. [`Estimator`] tells the time without the steps: a
//! [`PlotTimer`] adds up the same phases by the same clock.
//!
//! [`AveragedSteps`] behind it limits the jerk as a vector.
//!
//! When a phase or a chord begins, floats are turned into whole numbers. From step to step there are only
//! whole numbers.

mod average;
mod averaged_steps;
mod backlash_steps;
mod chord;
mod estimator;
mod moment;
mod plot_timer;
mod slice;
mod step_gen;
mod step_queue;
mod timed_events;

#[cfg(feature = "averaged-steps")]
pub(crate) use average::Average;
pub(crate) use chord::place_on;

#[cfg(feature = "averaged-steps")]
pub(crate) use averaged_steps::AVERAGED_STEPS;
pub use averaged_steps::AveragedSteps;
pub use backlash_steps::BacklashSteps;
pub use estimator::Estimator;
pub use plot_timer::{PlotTime, PlotTimer};
pub use step_gen::{Busy, MotorEvent, StepGen, StepGenSettings, TimedEvent};
pub use step_queue::{QueuedEvent, StepQueue};
pub use timed_events::timed_events;
