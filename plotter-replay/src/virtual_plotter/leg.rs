//! [`Leg`]: the way to one target, as the encoders saw it.

use super::Reached;
use core::time::Duration;
use plotter_motion::{Pen, StepPoint};

/// Where the pen was, and when.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrackPoint {
    /// When, microseconds since the start of the log.
    pub time_us: u64,
    /// Where, encoder counts as counted.
    pub at: StepPoint,
}

impl TrackPoint {
    /// When.
    #[must_use]
    pub const fn time(self) -> Duration {
        Duration::from_micros(self.time_us)
    }
}

/// The way to one target: from the answer `+` to the target before until the answer to this one.
#[derive(Clone, Debug, PartialEq)]
pub struct Leg {
    /// Whether it is drawn.
    pub pen: Pen,
    /// With which pen, as lines of text select one; 0 where nothing says.
    pub pen_number: u8,
    /// The target before: where the line that this way should follow begins, encoder counts.
    pub from: StepPoint,
    /// The target, encoder counts; `None` if none was sent.
    pub target: Option<StepPoint>,
    /// The way as counted; the first point is where it began.
    pub points: Vec<TrackPoint>,
    /// What is to be added to a counted position for the resynchronized one, which starts at each reached
    /// target.
    pub correction: StepPoint,
    /// How it ended, if the controller said so.
    pub reached: Option<Reached>,
}
