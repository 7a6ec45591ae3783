//! [`HandlingTimes`]: how long a controller's processor works on what comes.

use core::time::Duration;

/// How long the processor works on a thing, from when it begins until the motors are driven by the outcome.
///
/// What comes while it works waits, edges before a run of the loop, as in a firmware whose interrupts put
/// edges into a queue with their times; a run of the loop is told the time at which it begins.
///
/// ```
/// use plotter_motion::testbed::HandlingTimes;
/// use core::time::Duration;
/// // A processor of 100 MHz that takes a cycle for each instruction, 900 for an edge and 10,300 for a run.
/// let counted = HandlingTimes::of_instructions(900, 10_300, 100_000_000);
/// assert_eq!(counted.edge, Duration::from_micros(9));
/// assert_eq!(counted.run, Duration::from_micros(103));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct HandlingTimes {
    /// On an edge of an encoder.
    pub edge: Duration,
    /// On a run of the loop.
    pub run: Duration,
}

impl HandlingTimes {
    /// Of so many instructions, at so many a second; no time at none a second.
    #[must_use]
    pub fn of_instructions(edge: u32, run: u32, per_s: u32) -> Self {
        let time = |instructions: u32| {
            let ns = u64::from(instructions) * 1_000_000_000;
            Duration::from_nanos(ns.checked_div(u64::from(per_s)).unwrap_or(0))
        };
        Self { edge: time(edge), run: time(run) }
    }
}
