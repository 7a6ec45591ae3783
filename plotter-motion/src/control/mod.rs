//! Controllers that lead two motors along a straight line.
//!
//! [`LineTracking`] is the published one, [`Contouring`] ours; both are a [`LineController`]. A machine's
//! description chooses between them ([`ChosenController`]); a firmware that has but one names it. [`PointToPoint`] is that of
//! the marking board, whose axes are not its motors; [`Contouring`] leads the motors of a belt as it leads any two.

mod chosen;
mod contouring;
mod drive_ramp;
mod equalizer;
mod line_tracking;
mod point_to_point;
mod shaft_estimator;
mod speed_meter;
pub mod tuning;

pub use chosen::ChosenController;
pub use contouring::{Contouring, ContouringSettings, PositionGains, ShaftSettings};
pub use drive_ramp::DriveRamp;
pub use equalizer::{Equalizer, EqualizerSettings};
pub use line_tracking::{LineTracking, LineTrackingSettings};
pub use point_to_point::{PointToPoint, PointToPointSettings};
pub use shaft_estimator::{ShaftEstimator, ShaftModel};
pub use speed_meter::SpeedMeter;

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
}
