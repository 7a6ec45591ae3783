//! [`DriveDelay`]: what a controller asks for now, a motor gets later.

use crate::{Drive, Machine};
use core::time::Duration;

/// Changes of the drive that are on their way; of more within one delay the last takes the place of the one before it.
const MOST: usize = 32;

/// The latency of a controller: computing time, a serial bus to the drivers, a timer that takes a new duty with its next period.
///
/// ```
/// # use plotter_motion::plant::DriveDelay;
/// # use plotter_motion::{Demand, Drive, Duty, SafetyGate};
/// # use core::time::Duration;
/// let ms = Duration::from_millis;
/// let mut delay = DriveDelay::new(ms(2));
/// let full = SafetyGate::default().pass(Demand { x: Duty::FULL, y: Duty::ZERO });
/// assert_eq!(delay.pass(ms(0), full), Drive::default());
/// assert_eq!(delay.pass(ms(1), full), Drive::default());
/// assert_eq!(delay.pass(ms(2), full), full);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveDelay {
    delay: Duration,
    on_the_way: [(Duration, Drive); MOST],
    waiting: usize,
    last: Drive,
    acting: Drive,
}

impl DriveDelay {
    /// A delay by a time; 0 for none.
    #[must_use]
    pub fn new(delay: Duration) -> Self {
        let none = Drive::default();
        Self { delay, on_the_way: [(Duration::ZERO, none); MOST], waiting: 0, last: none, acting: none }
    }

    /// That of a machine: `control.latency_periods` of its loop.
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        let control = &machine.config().control;
        let period = Duration::from_secs_f64(1.0 / control.contouring.loop_hz);
        Self::new(period * control.latency_periods)
    }

    /// What acts at the time `now`, from which on `asked` is asked for. Times do not go back.
    pub fn pass(&mut self, now: Duration, asked: Drive) -> Drive {
        if self.delay.is_zero() {
            return asked;
        }
        if asked != self.last {
            self.last = asked;
            let place = self.waiting.min(MOST - 1);
            if let Some(slot) = self.on_the_way.get_mut(place) {
                *slot = (now.saturating_add(self.delay), asked);
            }
            self.waiting = place + 1;
        }
        let due = self.on_the_way.iter().take(self.waiting).take_while(|(at, _)| *at <= now).count();
        if let Some((_, drive)) = due.checked_sub(1).and_then(|last| self.on_the_way.get(last)) {
            self.acting = *drive;
            self.on_the_way.rotate_left(due);
            self.waiting -= due;
        }
        self.acting
    }
}
