//! [`Drivers`], [`Lateness`]: a main loop that is slower than the steps.

use crate::stepgen::MotorEvent;
use core::time::Duration;

/// Whether the drivers of both motors can take a step now: what a controller is told before it gives one.
///
/// A driver needs some time for each step, and a main loop that comes late finds more than one due. A step
/// that the drivers would refuse is not given and not counted; it stays due.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Drivers {
    /// Both can take a step. Simulated motors always can.
    Ready,
    /// One of them still has a step to make: ask again when it has.
    Busy,
}

impl Drivers {
    /// Whether this waits for them.
    pub(super) fn keep_back(self, event: MotorEvent) -> bool {
        #[cfg(feature = "third-motor")]
        if matches!(event, MotorEvent::StepZ(_)) {
            return self == Self::Busy;
        }
        self == Self::Busy && matches!(event, MotorEvent::Step(_))
    }
}

/// How late steps have been given since the machine was switched on: whether the main loop is fast enough.
///
/// A step that is given no more than [`Lateness::ALLOWED`] after its time changes nothing: the next one comes
/// at its own time. Where a step is later, all that follows is put off by as much. So the machine slows down
/// or pauses, and never hurries to catch up: two steps are never nearer to each other than planned by more
/// than that. A motor may lose steps all the same when a loop stands still in the middle of a fast line,
/// which stops it without a brake; the machine does not know.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Lateness {
    steps: u32,
    greatest_ns: u32,
}

impl Lateness {
    /// How late a step may be: 100 us.
    ///
    /// It bounds how much nearer than planned two steps may be. The documented machine makes at most 8000
    /// steps/s, 125 us from one to the next: with 100 us there is never more than one step to catch up. With
    /// half of it a loop of 100 us slows the machine down where it need not; with twice as much, steps come
    /// in pairs.
    pub const ALLOWED: Duration = Duration::from_micros(100);

    /// The same, in microseconds.
    #[cfg(feature = "step-ahead")]
    pub(super) const ALLOWED_US: u32 = 100;

    /// A step was late by so much.
    #[cfg(feature = "step-ahead")]
    pub(super) fn count(&mut self, late_us: u32) {
        self.steps = self.steps.saturating_add(1);
        self.greatest_ns = self.greatest_ns.max(late_us.saturating_mul(1000));
    }

    #[cfg(feature = "step-ahead")]
    pub(super) const fn greatest_us(&self) -> u32 {
        self.greatest_ns / 1000
    }

    #[cfg(feature = "step-ahead")]
    pub(super) const fn told(steps: u32, greatest_us: u32) -> Self {
        Self { steps, greatest_ns: greatest_us.saturating_mul(1000) }
    }

    /// Steps that were given later than [`Lateness::ALLOWED`].
    #[must_use]
    pub const fn steps(&self) -> u32 {
        self.steps
    }

    /// How late the latest of them was, 4.29 s at most; 0 while there are none.
    #[must_use]
    pub const fn greatest(&self) -> Duration {
        Duration::new(0, self.greatest_ns)
    }

    /// A step that was due at `at` is given. Whether that is too late: then all that counts from `base` is
    /// put off by as much.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn given(&mut self, at: Duration, now: Duration, base: &mut Duration) -> bool {
        let late = now.saturating_sub(at);
        let late_ns = if late.as_secs() == 0 { late.subsec_nanos() } else { u32::MAX };
        let is_late = late_ns > Self::ALLOWED.subsec_nanos();
        if is_late {
            self.steps = self.steps.saturating_add(1);
            self.greatest_ns = self.greatest_ns.max(late_ns);
            *base = base.saturating_add(late);
        }
        is_late
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_too_late_counts_and_puts_off() {
        let us = Duration::from_micros;
        let (mut lateness, mut base) = (Lateness::default(), us(7));
        assert!(!lateness.given(us(1000), us(1100), &mut base));
        assert_eq!((lateness, base), (Lateness::default(), us(7)));
        assert!(lateness.given(us(1000), us(1250), &mut base));
        assert!(lateness.given(us(2000), us(2101), &mut base));
        assert_eq!((lateness.steps(), lateness.greatest(), base), (2, us(250), us(358)));
    }
}
