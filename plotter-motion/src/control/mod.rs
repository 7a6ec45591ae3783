//! Controllers that lead two motors along a straight line.
//!
//! [`LineTracking`] is the published one, [`Contouring`] ours; both are a [`LineController`]. A machine's
//! description chooses between them ([`ChosenController`]); a firmware that has but one names it.
//! [`PointToPoint`] is that of the marking board, whose axes are not its motors; [`Contouring`] leads the
//! motors of a belt as it leads any two.

mod pid;
mod sync_stop;
pub use pid::{Pid, PidState, SumPid, SumPidState};
pub use sync_stop::SyncStop;
mod chosen;
mod coasting_bridge;
mod contour_controller;
mod contouring;
mod cross_coupled;
mod drive_ramp;
mod equalizer;
mod last_counts;
mod learning;
mod led_axis;
#[cfg(feature = "third-motor")]
mod lift;
mod line_plan;
mod line_tracking;
mod per_axis;
mod planned_line;
mod planned_pid;
mod point_to_point;
mod rounded_duty;
mod shaft_estimator;
mod shaft_fit;
mod shaft_motion;
mod speed_meter;
pub mod tuning;
mod watch;

pub use chosen::ChosenController;
pub use coasting_bridge::CoastingBridge;
pub use contour_controller::{AxisController, AxisState, ContourController, ContourState, TwoAxes};
pub use contouring::{Contouring, ContouringSettings, PositionGains, ShaftSettings};
pub use cross_coupled::{CrossCoupled, CrossCoupledSettings};
pub use drive_ramp::DriveRamp;
pub use equalizer::{Equalizer, EqualizerSettings};
pub use learning::{LearnedBin, Learning, LearningSettings};
#[cfg(feature = "third-motor")]
pub use lift::{Lift, LiftFault, LiftSettings, LiftState};
pub use line_tracking::{LineTracking, LineTrackingSettings};
pub use per_axis::PerAxis;
pub use planned_line::PlannedLine;
pub use planned_pid::PlannedPid;
pub use point_to_point::{PointToPoint, PointToPointSettings};
pub use shaft_estimator::{ShaftEstimator, ShaftModel};
pub use speed_meter::SpeedMeter;
pub use watch::{AxisTrouble, Trouble};

use crate::{Axis, Demand, Direction, Drive, StepPoint};
use core::time::Duration;

/// Leads two motors from target to target along straight lines, from what their encoders say.
///
/// All positions are encoder counts. The caller keeps the time: it calls [`tick`](Self::tick) every
/// [`period`](Self::period), if there is one, and hands over every counted edge when it happens.
pub trait LineController {
    /// How often [`tick`](Self::tick) wants to be called; `None` for a controller that only answers to edges.
    fn period(&self) -> Option<Duration>;

    /// Takes the next target; the line to it begins at the last one, if that was reached.
    fn start(&mut self, now: Duration, target: StepPoint) -> Demand;

    /// Takes an edge that an encoder's decoder counted.
    fn edge(&mut self, now: Duration, axis: Axis, direction: Direction) -> Demand;

    /// Takes note that time has passed.
    fn tick(&mut self, now: Duration) -> Demand;

    /// Learns what became of its last demand: less, if a limit switch or an emergency stop was in the way.
    fn applied(&mut self, drive: Drive);

    /// Where the motors stand, encoder counts.
    fn position(&self) -> StepPoint;

    /// Whether the motors stand at the target.
    fn has_arrived(&self) -> bool;

    /// What is wrong with a motor or its encoder, as far as it can tell; `None` also for one that cannot. A
    /// new target is tried all the same.
    fn trouble(&self) -> Option<AxisTrouble> {
        None
    }

    /// Where it wants the motors to be now, encoder counts; `None` for a controller that knows but the
    /// target.
    fn reference(&self) -> Option<[f64; 2]> {
        None
    }
}
