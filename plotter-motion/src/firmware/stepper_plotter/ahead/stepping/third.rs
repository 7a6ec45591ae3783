//! What of [`Stepping`] is only there for a third motor.

use super::super::shared::Third;
use super::Stepping;
use crate::Axis;
use crate::safety::EndSwitches;
use core::sync::atomic::Ordering;

impl Stepping<'_> {
    /// A machine of which an axis has two motors.
    pub(in super::super) const fn with_second(self, second: Option<Axis>) -> Self {
        Self { second, ..self }
    }

    /// A step of the third motor of a stream that was not made: see [`not_made`](Self::not_made).
    pub fn z_not_made(&mut self, step: i8) {
        self.count_z(step.saturating_neg());
    }

    pub(super) fn count_z(&mut self, step: i8) {
        self.z = self.z.wrapping_add(step.into());
        self.out.shared.z.store(self.z, Ordering::Relaxed);
    }

    /// As [`limit_switch`](Self::limit_switch), of both limit switches of the third axis.
    pub fn z_switches(&mut self, switches: EndSwitches) {
        self.found.third.z = switches;
        self.read_switches();
        self.tell();
    }

    /// As [`limit_switch`](Self::limit_switch), of both limit switches of the second motor of an axis.
    pub fn second_switches(&mut self, switches: EndSwitches) {
        self.found.third.second = switches;
        self.read_switches();
        self.tell();
    }

    /// Tells the gate of its switches, by whomever they were seen.
    pub(super) fn read_third(&mut self) {
        self.third = self.out.shared.third.load(Ordering::Acquire);
        let [told, ..] = self.third.to_le_bytes();
        let Third { z, second } = Third::of_bits(told).or(self.found.third);
        self.gate.set_z_limits(z);
        if let Some(axis) = self.second {
            self.gate.set_second_limits(axis, second);
        }
    }
}
