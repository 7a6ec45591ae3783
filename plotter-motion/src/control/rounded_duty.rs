//! [`RoundedDuty`]: any duty as a timer can make it, in the mean exactly.

use crate::Duty;

/// A duty in whole steps of a timer. What rounding took or gave is made up for the next time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RoundedDuty {
    pwm_steps: u16,
    /// What rounding left over, as a duty.
    left_over: f32,
    duty: Duty,
}

impl RoundedDuty {
    /// None, by a timer with so many steps from 0 to full.
    pub(super) const fn none(pwm_steps: u16) -> Self {
        Self { pwm_steps, left_over: 0.0, duty: Duty::ZERO }
    }

    pub(super) const fn get(&self) -> Duty {
        self.duty
    }

    /// Leaves the shaft alone, with its motor short-circuited.
    pub(super) const fn stop(&mut self) {
        (self.left_over, self.duty) = (0.0, Duty::ZERO);
    }

    /// As near to `wanted` as the steps allow; more than the supply is the supply.
    pub(super) fn set(&mut self, wanted: f32) {
        let steps = f32::from(self.pwm_steps);
        let owed = wanted + self.left_over;
        self.duty = Duty::saturating(libm::roundf(Duty::saturating(owed).value() * steps) / steps);
        self.left_over = (owed - self.duty.value()).clamp(-1.0 / steps, 1.0 / steps);
    }
}
