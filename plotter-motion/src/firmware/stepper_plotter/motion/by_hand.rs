//! What a person does on the way: jogs that are cancelled, other shares of the speeds, other settings.

use super::super::{Dialect, Link, Percents, Report, Setting, StepperPlotterSettings};
#[cfg(feature = "averaged-steps")]
use super::CLOCK_HZ;
use super::{Motion, State, darken, step_gen};
use crate::planner::{Keep as _, Modes};
#[cfg(feature = "averaged-steps")]
use crate::stepgen::Average;
use crate::{Pen, Planner};

impl<M: Modes> Motion<M> {
    /// Whether the machine is being moved by hand, or is about to be.
    pub(super) fn jogs_now(&self, link: &Link) -> bool {
        let waits = !self.unfinished
            && self.planner.is_empty()
            && link.commands.first().is_some_and(|command| command.is_jog());
        self.state == State::Ready && (self.jogs || waits)
    }

    /// Brakes what is moved by hand, and forgets the rest of it.
    pub(super) fn cancel(&mut self, link: &mut Link) {
        (self.jogs, self.cancelling) = (true, true);
        self.start_at = None;
        while link.commands.first().is_some_and(|command| command.is_jog()) {
            link.commands.pop();
        }
        self.planner.hold();
    }

    /// What has been cancelled stands.
    pub(super) fn jogged(&mut self, link: &mut Link) {
        self.halt(link);
        self.state = State::Stopped;
        let _ = link.reports.push(Report::Jogged { at: self.position_mm() });
    }

    pub(super) fn override_speeds(&mut self) {
        let Percents { draw, travel, .. } = self.percents;
        self.planner.override_speeds(f64::from(draw) / 100.0, f64::from(travel) / 100.0);
    }

    pub(super) fn end_overrides(&mut self) {
        self.percents = Percents::default();
        self.override_speeds();
        self.shine();
    }

    /// The machine is another one from here on; its motors stay where they are.
    pub(super) fn set(&mut self, setting: Setting) {
        let Ok(settings) = setting.checked(&self.settings) else {
            debug_assert!(false, "the receive side has looked at {setting:?}");
            return;
        };
        self.hold_to(settings);
    }

    /// The machine is again what it was switched on as.
    pub(super) fn restore(&mut self) {
        if let Some(&built) = self.built.get() {
            self.hold_to(built);
        }
    }

    fn hold_to(&mut self, settings: StepperPlotterSettings) {
        self.settings = settings;
        self.put_pen(Pen::Up);
        debug_assert!(settings.dialect == Dialect::Grbl, "in which the limits are those of the planner");
        let limits = &settings.planner;
        #[cfg(feature = "averaged-steps")]
        let averaged = limits.planned_of_checked();
        #[cfg(feature = "averaged-steps")]
        let limits = &averaged.settings;
        self.planner = Planner::of_checked(limits);
        self.base = self.time_of(self.tick());
        #[cfg(feature = "averaged-steps")]
        if let Some(average) = self.average.get_mut() {
            *average = Average::of(&averaged, CLOCK_HZ);
        }
        self.steps = step_gen(&settings);
        self.steps.clear(self.carriage());
        if let Some(play) = self.play.get_mut() {
            play.begin_anew(&settings);
        }
        self.planner.clear(self.position_mm());
        #[cfg(feature = "third-motor")]
        self.tell_z();
        darken(&mut self.planner);
        self.override_speeds();
    }
}
