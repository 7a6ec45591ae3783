//! [`Average`]: averaged steps, or the steps as they are.

use super::TimedEvent;
use crate::planner::{Action, Averaged};
#[cfg(feature = "averaged-steps")]
use {super::AveragedSteps, super::averaged_steps::AVERAGED_STEPS};

/// Averages steps where the jerk is limited as a vector; else, and without the feature `averaged-steps`, they
/// pass as they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Average {
    #[cfg(feature = "averaged-steps")]
    steps: Option<AveragedSteps<{ AVERAGED_STEPS as usize }>>,
    /// A pause has been begun: the motors stand in it as long as planned.
    #[cfg(feature = "averaged-steps")]
    pauses: bool,
}

#[cfg(not(feature = "averaged-steps"))]
#[allow(
    clippy::unused_self,
    clippy::needless_pass_by_ref_mut,
    clippy::missing_const_for_fn,
    reason = "nothing is averaged"
)]
impl Average {
    pub(crate) fn of(_: &Averaged, _: u32) -> Self {
        Self::default()
    }

    pub(crate) fn next_event(
        &mut self,
        mut planned: impl FnMut() -> Option<TimedEvent>,
    ) -> Option<TimedEvent> {
        planned()
    }

    pub(crate) fn note(&mut self, _: &Action) {}

    pub(crate) fn rest(&mut self) -> Option<TimedEvent> {
        None
    }
}

#[cfg(feature = "averaged-steps")]
impl Average {
    /// Of motors at rest.
    pub(crate) fn of(averaged: &Averaged, clock_hz: u32) -> Self {
        Self { steps: AveragedSteps::of(averaged, clock_hz), pauses: false }
    }

    /// The next event; `None` when all that has been planned is taken, and what does not wait for more.
    pub(crate) fn next_event(
        &mut self,
        mut planned: impl FnMut() -> Option<TimedEvent>,
    ) -> Option<TimedEvent> {
        let Some(steps) = &mut self.steps else { return planned() };
        loop {
            if let Some(event) = steps.next_event() {
                return Some(event);
            }
            let Some(event) = planned() else { break };
            let pushed = steps.push(event);
            debug_assert!(pushed.is_ok(), "all events have been taken");
        }
        if core::mem::take(&mut self.pauses) {
            steps.arrive();
        }
        None
    }

    /// Notes what is done next.
    pub(crate) fn note(&mut self, action: &Action) {
        self.pauses |= matches!(action, Action::Dwell(_));
    }

    /// The next step of motors on their way to where all that was planned ends.
    pub(crate) fn rest(&mut self) -> Option<TimedEvent> {
        self.steps.as_mut()?.rest()
    }

    /// How much later than planned what comes next is, ticks.
    pub(crate) fn delay_ticks(&self) -> u64 {
        self.steps.as_ref().map_or(0, AveragedSteps::delay_ticks)
    }

    /// How fast both motors go, steps a second, if that is known.
    pub(crate) fn rates_hz(&self, clock_hz: u32) -> Option<[f32; 2]> {
        Some(self.steps.as_ref()?.rates_hz(clock_hz))
    }

    /// The motors have been stopped at once, with the plan's clock at `tick`.
    pub(crate) fn clear(&mut self, tick: u64) {
        self.pauses = false;
        if let Some(steps) = &mut self.steps {
            steps.clear(tick);
        }
    }
}
