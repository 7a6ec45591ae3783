//! [`DriveDelay`]: what a controller asks for now, a motor gets later.

use crate::config::DcConfig;
use crate::{Drive, Duty, Machine};
use core::time::Duration;

/// Changes of the drive that are on their way; of more within one delay the last takes the place of the one
/// before it.
const MOST: usize = 32;

/// The latency of a controller: computing time, a serial bus to the drivers, a timer that takes a new duty
/// with its next period.
///
/// ```
/// # use plotter_motion::plant::DriveDelay;
/// # use plotter_motion::{Demand, Duty, LimitSwitches, SafetyGate};
/// # use core::time::Duration;
/// let ms = Duration::from_millis;
/// let mut delay = DriveDelay::new(ms(2));
/// let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// let full = gate.pass(Demand { x: Duty::FULL, y: Duty::ZERO });
/// assert_eq!(delay.pass(ms(0), full), [Duty::ZERO; 2]);
/// assert_eq!(delay.pass(ms(1), full), [Duty::ZERO; 2]);
/// assert_eq!(delay.pass(ms(2), full), [Duty::FULL, Duty::ZERO]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveDelay {
    delay: Duration,
    on_the_way: [(Duration, [Duty; 2]); MOST],
    waiting: usize,
    last: [Duty; 2],
    acting: [Duty; 2],
}

impl DriveDelay {
    /// A delay by a time; 0 for none.
    #[must_use]
    pub fn new(delay: Duration) -> Self {
        let none = [Duty::ZERO; 2];
        Self { delay, on_the_way: [(Duration::ZERO, none); MOST], waiting: 0, last: none, acting: none }
    }

    /// The delay of a machine: `control.latency_periods` periods of its control loop.
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        let control = DcConfig::of(machine).control;
        let period = Duration::from_secs_f64(1.0 / control.contouring.loop_hz);
        Self::new(period * control.latency_periods)
    }

    /// The duties of both motors that act at the time `now`, from which on `asked` is asked for. Times do not
    /// go back. They are no
    /// [`Drive`]: what acts late may have been stopped since, and is nothing for a driver of a real motor.
    pub fn pass(&mut self, now: Duration, asked: Drive) -> [Duty; 2] {
        let asked = asked.duties();
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
        if let Some((_, duties)) = due.checked_sub(1).and_then(|last| self.on_the_way.get(last)) {
            self.acting = *duties;
            self.on_the_way.rotate_left(due);
            self.waiting -= due;
        }
        self.acting
    }
}
