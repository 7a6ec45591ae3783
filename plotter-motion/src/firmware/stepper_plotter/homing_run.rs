//! [`HomingRun`]: homing with the times of its steps.

use super::StepperPlotterSettings;
use crate::{
    LimitSwitches, StepPair,
    homing::{Homed, HomingError, HomingProgress, HomingStatus},
};
use core::time::Duration;

/// Homing in progress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HomingRun {
    homing: HomingProgress,
    /// The step before, or when it may begin.
    last: Duration,
}

impl HomingRun {
    pub(super) const fn new(start: Duration) -> Self {
        Self { homing: HomingProgress::START, last: start }
    }

    /// The next step with its time; or what came of it all.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn next(
        &mut self,
        settings: &StepperPlotterSettings,
        limits: LimitSwitches,
    ) -> Result<(Duration, StepPair), Result<Homed, HomingError>> {
        match self.homing.update([&settings.home_x, &settings.home_y], limits) {
            HomingStatus::Done(homed) => Err(Ok(homed)),
            HomingStatus::Failed(error) => Err(Err(error)),
            HomingStatus::Step(step) => {
                let interval = Duration::from_secs(1) / step.rate_hz.max(1);
                Ok((self.last.saturating_add(interval), step.into()))
            }
        }
    }

    /// When a step may come that is this often in a second.
    #[cfg(feature = "third-motor")]
    pub(super) fn after(&self, rate_hz: u32) -> Duration {
        self.last.saturating_add(Duration::from_secs(1) / rate_hz.max(1))
    }

    /// A step of the third axis has been made.
    #[cfg(feature = "third-motor")]
    pub(super) const fn made_other(&mut self, at: Duration) {
        self.last = at;
    }

    /// The step has been made.
    pub(super) fn made(&mut self, at: Duration) {
        self.homing.made();
        self.last = at;
    }
}
