//! [`ExperimentSettings`]: what both experiments may do to an axis.

use crate::{Axis, Demand, Duty, config::AxisConfig};

/// On which axis an experiment runs, and its bounds.
///
/// The axis begins somewhere in the middle, at rest, and does not leave `travel_counts` to either side unless something pushes
/// it, or it goes so far in a tick or two; then the experiment ends. The demands go through the [`SafetyGate`](crate::SafetyGate) like every other: a limit switch or the emergency stop ends
/// the experiment as a motor that stands.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ExperimentSettings {
    /// The motor to drive; the other one gets nothing.
    pub axis: Axis,
    /// Time between two calls, s: that of the loop the gains are for.
    pub tick_s: f64,
    /// How far the axis may go from its start, to either side, counts; 200 or more are worth a try.
    pub travel_counts: i32,
    /// Greatest duty, 0 to 1.
    pub most_duty: f64,
    /// Steps of the duty from 0 to full: all duties are whole steps.
    pub pwm_steps: u16,
    /// Longest time of an experiment, s.
    pub most_s: f64,
}

impl ExperimentSettings {
    /// For an axis of a checked machine with `loop_hz` runs a second: `travel_mm` to either side, up to 60 % of the duty, at
    /// most 60 s.
    ///
    /// ```
    /// # use plotter_motion::{Axis, config::AxisConfig, control::tuning::ExperimentSettings};
    /// let settings = ExperimentSettings::of(&AxisConfig::default(), Axis::X, 2500.0, 30.0);
    /// assert_eq!(settings.travel_counts, 1200); // 30 mm at 40 counts/mm
    /// ```
    #[must_use]
    pub fn of(config: &AxisConfig, axis: Axis, loop_hz: f64, travel_mm: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
        let travel_counts = (travel_mm * config.counts_per_mm) as i32;
        Self {
            axis,
            tick_s: 1.0 / loop_hz,
            travel_counts,
            most_duty: 0.6,
            pwm_steps: u16::try_from(config.motor.pwm_steps).unwrap_or(u16::MAX),
            most_s: 60.0,
        }
    }

    /// A duty as the timer makes it, and at most the greatest.
    pub(super) fn whole(&self, duty: f64) -> f64 {
        let steps = f64::from(self.pwm_steps.max(1));
        // A limit that is no number is none at all.
        let allowed = if self.most_duty.is_nan() { 0.0 } else { self.most_duty.clamp(0.0, 1.0) };
        let most = libm::floor(allowed * steps);
        libm::round(duty * steps).clamp(-most, most) / steps
    }

    pub(super) fn demand(&self, duty: f64) -> Demand {
        #[expect(clippy::cast_possible_truncation, reason = "a share of the supply")]
        let duty = Duty::saturating(duty as f32);
        match self.axis {
            Axis::X => Demand { x: duty, y: Duty::ZERO },
            Axis::Y => Demand { x: Duty::ZERO, y: duty },
        }
    }

    /// A time in ticks, one at least.
    pub(super) fn ticks(&self, time_s: f64) -> u32 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
        let ticks = libm::ceil(time_s / self.tick_s) as u32;
        ticks.max(1)
    }

    pub(super) fn seconds(&self, ticks: u32) -> f64 {
        f64::from(ticks) * self.tick_s
    }
}
