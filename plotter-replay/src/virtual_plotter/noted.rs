//! [`Noted`]: what a virtual plotter gives away to be forgotten.

use super::{Anomaly, Leg};
use core::time::Duration;
use plotter_motion::StepPoint;

/// Notes of a plotter since the last call of [`crate::VirtualPlotter::take_noted`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Noted {
    /// The ways; a way that was under way is cut, and its rest comes with the next.
    pub legs: Vec<Leg>,
    /// Targets that the host sent, encoder counts, with the time of their last digit.
    pub targets: Vec<(Duration, StepPoint)>,
    /// Anomalies.
    pub anomalies: Vec<Anomaly>,
}
