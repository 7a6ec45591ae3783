//! Motor synchronisation: when one motor stalls, the other waits.

use crate::config::SyncStopConfig;

/// The published rule (Öcal, section 4.5): the master waits while the slave is farther from the line than
/// `slope_counts |m| + offset_counts`, measured along the slave's axis. `|m|` is the size of the slope as it
/// is, never cut to a whole number: see [`LineTracking`](crate::control::LineTracking) for what the published
/// program leaves open.
///
/// ```
/// # use plotter_motion::{config::SyncStopConfig, control::SyncStop};
/// let rule = SyncStop::new(SyncStopConfig { slope_counts: 10.0, offset_counts: 10.0 });
/// assert_eq!(rule.threshold_counts(0.5), 15.0);
/// assert!(rule.must_wait(0.5, -15.5));
/// assert!(!rule.must_wait(0.5, 15.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct SyncStop {
    /// Part of the allowed deviation that grows with the slope, encoder counts.
    pub slope_counts: f32,
    /// Its constant part, encoder counts.
    pub offset_counts: f32,
}

impl SyncStop {
    /// The rule with the machine's two numbers.
    #[must_use]
    pub const fn new(config: SyncStopConfig) -> Self {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a few counts; f32 is the control loop's precision"
        )]
        Self { slope_counts: config.slope_counts as f32, offset_counts: config.offset_counts as f32 }
    }

    /// The deviation that is allowed on a line of slope `m`, encoder counts of the slave axis.
    #[must_use]
    pub fn threshold_counts(&self, m: f32) -> f32 {
        self.slope_counts * m.abs() + self.offset_counts
    }

    /// Whether the master must wait for a slave that is `deviation_counts` from the line.
    #[must_use]
    pub fn must_wait(&self, m: f32, deviation_counts: f32) -> bool {
        deviation_counts.abs() > self.threshold_counts(m)
    }
}
