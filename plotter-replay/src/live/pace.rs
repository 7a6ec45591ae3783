//! [`Pace`]: how the time of a simulated machine follows the clock.

use core::time::Duration;
use std::time::Instant;

/// Time of ours that is made up at most: a machine that is farther behind, on a computer too slow or asleep,
/// stays so.
const MOST_BEHIND: Duration = Duration::from_millis(50);

/// Tells how long to wait until a time of the machine may come.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// Seconds of the machine in one of ours.
    speed: f64,
    /// A time of ours, and the machine's then.
    from: Option<(Instant, Duration)>,
}

impl Pace {
    /// So many seconds of the machine in one of ours; as fast as it goes where that is more than this
    /// computer can.
    pub(super) const fn new(speed: f64) -> Self {
        Self { speed, from: None }
    }

    /// How long after `now` the machine's time `at` comes; zero if it may come at once.
    pub(super) fn wait(&mut self, now: Instant, at: Duration) -> Duration {
        let (began, from) = *self.from.get_or_insert((now, at));
        let after = Duration::try_from_secs_f64(at.saturating_sub(from).as_secs_f64() / self.speed);
        let due = after.ok().and_then(|after| began.checked_add(after)).unwrap_or(now);
        if now.saturating_duration_since(due) > MOST_BEHIND {
            self.from = Some((now, at));
        }
        due.saturating_duration_since(now)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    #[test]
    fn a_machine_of_twice_the_speed_is_waited_for_half_as_long() {
        let (mut pace, began) = (Pace::new(2.0), Instant::now());
        assert_eq!(pace.wait(began, Duration::ZERO), Duration::ZERO);
        assert_eq!(pace.wait(began, 10 * MS), 5 * MS);
        assert_eq!(pace.wait(began + 3 * MS, 10 * MS), 2 * MS);
        assert_eq!(pace.wait(began + 9 * MS, 10 * MS), Duration::ZERO);
    }

    #[test]
    fn a_little_is_made_up_and_more_is_not() {
        let (mut pace, began) = (Pace::new(1.0), Instant::now());
        pace.wait(began, Duration::ZERO);
        assert_eq!(pace.wait(began + 40 * MS, 10 * MS), Duration::ZERO);
        assert_eq!(pace.wait(began + 40 * MS, 45 * MS), 5 * MS);
        // a second asleep
        assert_eq!(pace.wait(began + 1_000 * MS, 50 * MS), Duration::ZERO);
        assert_eq!(pace.wait(began + 1_000 * MS, 60 * MS), 10 * MS);
    }

    #[test]
    fn no_speed_makes_it_wait_for_ever_or_panic() {
        for speed in [f64::NAN, 0.0, -1.0, 1e300, f64::INFINITY] {
            let (mut pace, began) = (Pace::new(speed), Instant::now());
            pace.wait(began, Duration::ZERO);
            assert_eq!(pace.wait(began, MS), Duration::ZERO, "{speed}");
        }
    }
}
