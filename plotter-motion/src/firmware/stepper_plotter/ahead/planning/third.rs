//! What of [`Planning`] is only there for a third motor.

use super::super::super::SecondMotor;
use super::super::makes::Makes;
use super::{Host, Planning};
use crate::planner::Modes;
use crate::safety::{EndSwitches, Pulse};
use crate::{Axis, StepPair};
use core::sync::atomic::Ordering;
use core::time::Duration;

/// What a pulse makes, if it is one of a third motor.
pub(super) fn makes(pulse: Pulse<'_>, second: Option<SecondMotor>) -> Option<Makes> {
    if pulse.z() != 0 {
        return Some(Makes::Z(pulse.z()));
    }
    let (axis, way) = (second?.axis, pulse.apart()?);
    let StepPair { x, y } = pulse.into();
    Some(Makes::Apart(axis, [if axis == Axis::X { x } else { y }, way]))
}

impl<H: Host, M: Modes> Planning<'_, H, M> {
    /// Takes the state of both limit switches of the third axis. Or
    /// [`Stepping::z_switches`](super::Stepping::z_switches) does.
    pub fn z_switches(&mut self, now: Duration, switches: EndSwitches) {
        self.third.z = switches;
        self.tell_third(now);
    }

    /// Takes the state of both limit switches of the second motor of an axis. Or
    /// [`Stepping::second_switches`](super::Stepping::second_switches) does.
    pub fn second_switches(&mut self, now: Duration, switches: EndSwitches) {
        self.third.second = switches;
        self.tell_third(now);
    }

    fn tell_third(&mut self, now: Duration) {
        self.steps.shared.third.store(self.third.bits().into(), Ordering::Release);
        self.look(now);
        self.end_call(now);
    }

    /// Homing has found where the third axis stands, if that is not where its steps have led it to: what the
    /// other half counts is counted from elsewhere then.
    pub(super) fn note_homed_z(&mut self, before: i32, makes: Option<Makes>) {
        let Some(stands_at) = self.plotter.motion.z_steps() else { return };
        let made = if let Some(Makes::Z(way)) = makes { i32::from(way) } else { 0 };
        let off = stands_at.wrapping_sub(before).wrapping_sub(made);
        self.z_from = self.z_from.wrapping_add(off);
    }

    /// See [`StepperPlotter::z_mm`](super::StepperPlotter::z_mm).
    #[must_use]
    pub fn z_mm(&mut self, now: Duration) -> Option<f64> {
        self.look(now);
        self.plotter.z_mm()
    }

    /// See [`StepperPlotter::z_off_steps`](super::StepperPlotter::z_off_steps).
    #[must_use]
    pub fn z_off_steps(&self) -> Option<i32> {
        self.plotter.z_off_steps()
    }

    /// See [`StepperPlotter::skew_steps`](super::StepperPlotter::skew_steps).
    #[must_use]
    pub fn skew_steps(&self) -> Option<i32> {
        self.plotter.skew_steps()
    }
}
