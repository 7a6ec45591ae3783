//! [`HomingRun`]: homing with the times of its steps.

use super::StepperPlotterSettings;
use crate::{Axis, Homed, Homing, HomingError, HomingStatus, LimitSwitches, StepPair};
use core::time::Duration;

/// Homing in progress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HomingRun {
    homing: Homing,
    /// The step before, or when it may begin.
    last: Duration,
}

impl HomingRun {
    pub(super) fn new(settings: &StepperPlotterSettings, start: Duration) -> Self {
        Self { homing: Homing::new(settings.home_x, settings.home_y), last: start }
    }

    /// The next step with its time; or what came of it all.
    pub(super) fn next(
        &mut self,
        limits: LimitSwitches,
    ) -> Result<(Duration, StepPair), Result<Homed, HomingError>> {
        match self.homing.update(limits) {
            HomingStatus::Done(homed) => Err(Ok(homed)),
            HomingStatus::Failed(error) => Err(Err(error)),
            HomingStatus::Step(step) => {
                let sign = if step.direction.sign() > 0 { 1 } else { -1 };
                let pair = match step.axis {
                    Axis::X => StepPair { x: sign, y: 0 },
                    Axis::Y => StepPair { x: 0, y: sign },
                };
                let interval = Duration::from_secs(1) / step.rate_hz.max(1);
                Ok((self.last.saturating_add(interval), pair))
            }
        }
    }

    /// The step has been made.
    pub(super) fn made(&mut self, at: Duration) {
        self.homing.made();
        self.last = at;
    }
}
