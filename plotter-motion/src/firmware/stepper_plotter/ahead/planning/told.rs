//! What a [`Planning`] tells of its machine.

use super::super::super::{Lateness, StartupLines, Status, StepperPlotterSettings, StoredSettings};
use super::super::Underruns;
use super::{Host, Planning};
use crate::StepPoint;
use crate::planner::Modes;
use core::sync::atomic::Ordering;
use core::time::Duration;

impl<H: Host, M: Modes> Planning<'_, H, M> {
    /// See [`StepperPlotter::stored`](super::StepperPlotter::stored).
    #[must_use]
    pub fn stored(&self) -> StoredSettings {
        self.plotter.stored()
    }

    /// See [`StepperPlotter::startup_lines`](super::StepperPlotter::startup_lines).
    #[must_use]
    pub fn startup_lines(&self) -> StartupLines {
        self.plotter.startup_lines()
    }

    /// See [`StepperPlotter::settings`](super::StepperPlotter::settings).
    #[must_use]
    pub fn settings(&self) -> StepperPlotterSettings {
        self.plotter.settings()
    }

    /// What the machine does.
    #[must_use]
    pub fn status(&mut self, now: Duration) -> Status {
        self.look(now);
        self.plotter.status(now)
    }

    /// Where the motors stand: steps really made.
    #[must_use]
    pub fn position(&self) -> StepPoint {
        self.steps.made().0
    }

    /// How late steps have been given since the machine was switched on: whether the interrupt comes in time.
    #[must_use]
    pub fn lateness(&self) -> Lateness {
        let shared = self.steps.shared;
        Lateness::told(shared.late_steps.load(Ordering::Acquire), shared.latest_us.load(Ordering::Acquire))
    }

    /// How often there were too few steps: whether the main loop comes in time, and the memory is large
    /// enough.
    #[must_use]
    pub fn underruns(&self) -> Underruns {
        let shared = self.steps.shared;
        Underruns {
            slowed_steps: shared.slowed_steps.load(Ordering::Acquire),
            stops: shared.stops.load(Ordering::Acquire),
        }
    }
}
