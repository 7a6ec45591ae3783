//! [`AveragedSteps`]: timed steps averaged over a time, so that the acceleration never jumps.

use super::{Busy, MotorEvent, TimedEvent};
use crate::StepPair;
use crate::planner::Averaged;

/// Steps of a window that have room in the controller of a stepper plotter, and in all else that averages for
/// a machine by its file: 8 bytes each. Both motors at 300 mm/s and 160 steps/mm make 4000 within the 42 ms
/// that 20,000 mm/s³ take within 0.05 mm.
#[cfg(feature = "averaged-steps")]
pub(crate) const AVERAGED_STEPS: u32 = 4_096;

/// Averages the places of the motors over a window of time, and makes steps of the average.
///
/// ```text
///   acceleration planned     ┌───┐            averaged over T      ╱‾‾╲
///                        ────┘   └────                         ───╱    ╲───
/// ```
///
/// With the window T the acceleration is the mean of the planned one over T, as a vector, so it is never
/// above the planned limit A; it changes by (a(t) − a(t − T)) / T, so the jerk is never above 2 A / T, as a
/// vector; the speed is never above the planned one; and the pen is never farther than A T² / 24 from the
/// planned path, because what is even over the window averages out. [`PlannerSettings::averaged`] chooses A
/// and T.
///
/// All of it is whole numbers: the sum of the places over the window is the number of steps in it times their
/// age. A step leaves half way between two places of the motor, so the last place is the planned one. The pen
/// and all else that is no step waits until the motors have arrived, and so does what comes after a rest
/// ([`rest`](Self::rest)) or a pause ([`arrive`](Self::arrive)): all of it is T later. `N` steps have room,
/// those of T at the greatest rate of both motors; where there are more, the oldest leaves early, and no step
/// is lost. A laser's power would have to follow the average, and a third motor the path: neither is meant
/// here.
///
/// ```
/// # use plotter_motion::{StepPair, stepgen::{AveragedSteps, MotorEvent, TimedEvent}};
/// // A motor that starts at once, 1000 steps a second, and stops at once after ten.
/// let mut averaged = AveragedSteps::<16>::new(8_000); // over 8 ms
/// let mut ticks = Vec::new();
/// for step in 1..=10 {
///     averaged.push(TimedEvent { tick: step * 1000, event: MotorEvent::Step(StepPair { x: 1, y: 0 }) })?;
///     ticks.extend(core::iter::from_fn(|| averaged.next_event()).map(|event| event.tick));
/// }
/// ticks.extend(core::iter::from_fn(|| averaged.rest()).map(|event| event.tick));
/// // It speeds up over 8 ms, and slows down over the 8 ms that follow the last step.
/// assert_eq!(ticks.len(), 10);
/// assert!(ticks[1] - ticks[0] > 1700 && ticks[5] - ticks[4] == 1000);
/// assert!(ticks[9] < 18_000);
/// # Ok::<(), plotter_motion::stepgen::Busy>(())
/// ```
///
/// [`PlannerSettings::averaged`]: crate::PlannerSettings::averaged
#[derive(Clone, Debug, PartialEq)]
pub struct AveragedSteps<const N: usize> {
    window: i64,
    /// How much later than planned all is, because the motors have arrived later at what was no step.
    delay: u64,
    now: u64,
    x: Motor,
    y: Motor,
    /// The steps of the window, oldest first: their ticks' lower halves, and which way they went.
    steps: [(u32, StepPair); N],
    first: usize,
    len: usize,
    /// Steps have come since the last rest.
    moves: bool,
    /// The next event, by the plan's clock.
    waiting: Option<TimedEvent>,
}

/// One motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Motor {
    /// Sum of the planned places over the window less that of the place where the motor is, steps times
    /// ticks.
    ahead: i64,
    /// Steps in the window: how that changes with each tick.
    slope: i64,
}

impl Motor {
    /// Ticks until the average is half way to the next place, and which way that lies.
    fn next_step(&self, window: i64) -> Option<(i64, i8)> {
        let (up, down) = (window - 2 * self.ahead, window + 2 * self.ahead);
        if up <= 0 {
            Some((0, 1))
        } else if down < 0 {
            Some((0, -1))
        } else if self.slope > 0 {
            Some(((up + 2 * self.slope - 1) / (2 * self.slope), 1))
        } else if self.slope < 0 {
            // Beyond the middle, not on it: what steps forwards there does not step back.
            Some((down / (-2 * self.slope) + 1, -1))
        } else {
            None
        }
    }

    fn go_on(&mut self, ticks: i64) {
        self.ahead += self.slope * ticks;
    }

    /// Steps if that is due now.
    fn step(&mut self, window: i64) -> i8 {
        match self.next_step(window) {
            Some((0, way)) => {
                self.ahead -= window * i64::from(way);
                way
            }
            _ => 0,
        }
    }
}

impl<const N: usize> AveragedSteps<N> {
    /// Of motors at rest, over a window of so many ticks: at least 2, at most 2³¹ − 1.
    #[must_use]
    pub fn new(window_ticks: u32) -> Self {
        Self {
            window: i64::from(window_ticks.clamp(2, u32::MAX >> 1)),
            delay: 0,
            now: 0,
            x: Motor::default(),
            y: Motor::default(),
            steps: [(0, StepPair { x: 0, y: 0 }); N],
            first: 0,
            len: 0,
            moves: false,
            waiting: None,
        }
    }

    /// Of motors at rest, by a clock of `clock_hz`; none for motion that is not averaged.
    #[must_use]
    pub fn of(averaged: &Averaged, clock_hz: u32) -> Option<Self> {
        (averaged.window_s > 0.0).then(|| Self::new(averaged.window_ticks(clock_hz)))
    }

    /// How much later than planned what comes next will be, ticks.
    #[must_use]
    pub const fn delay_ticks(&self) -> u64 {
        self.delay
    }

    /// How fast both motors go, mean rates over the window, steps a second of a clock of `clock_hz`.
    #[must_use]
    pub fn rates_hz(&self, clock_hz: u32) -> [f32; 2] {
        #[expect(clippy::cast_precision_loss, reason = "to 2^-23 of it")]
        [self.x, self.y].map(|motor| motor.slope as f32 * clock_hz as f32 / self.window as f32)
    }

    /// Takes the next event of the plan.
    ///
    /// # Errors
    ///
    /// [`Busy`] while events are left to be taken; the event is not taken.
    pub fn push(&mut self, event: TimedEvent) -> Result<(), Busy> {
        if self.waiting.is_some() {
            return Err(Busy);
        }
        self.waiting = Some(event);
        Ok(())
    }

    /// The next event; `None` when the next one of the plan is wanted.
    pub fn next_event(&mut self) -> Option<TimedEvent> {
        let waiting = self.waiting?;
        let MotorEvent::Step(pair) = waiting.event else {
            if let Some(step) = self.rest() {
                return Some(step);
            }
            self.waiting = None;
            self.now = self.now.max(waiting.tick.saturating_add(self.delay));
            return Some(TimedEvent { tick: self.now, event: waiting.event });
        };
        if let Some(step) = self.step_until(waiting.tick.saturating_add(self.delay)) {
            return Some(step);
        }
        self.waiting = None;
        self.enter(pair);
        None
    }

    /// The plan rests here, for a pause or because nothing follows for now: what comes next waits until the
    /// motors have arrived, so it is a window later. Without steps since the last rest nothing changes.
    pub fn arrive(&mut self) {
        if core::mem::take(&mut self.moves) {
            self.delay = self.delay.saturating_add(self.window.unsigned_abs());
        }
    }

    /// The next step of motors that are on their way to where the plan has come to rest; `None` when they are
    /// there. An event that waits is left waiting.
    pub fn rest(&mut self) -> Option<TimedEvent> {
        self.arrive();
        let newest = self.len.checked_sub(1).and_then(|before| self.leaves_after(before));
        let whole = newest.map(|ticks| self.now.saturating_add(ticks.unsigned_abs()));
        whole.and_then(|whole| self.step_until(whole)).or_else(|| self.due(self.now))
    }

    /// The motors have been stopped at once, when the plan's clock stood at `tick`: they stay where they are,
    /// and nothing is on its way any more. The clock goes on from the last event.
    pub fn clear(&mut self, tick: u64) {
        self.delay = self.now.saturating_sub(tick);
        self.now = tick.saturating_add(self.delay);
        (self.x, self.y) = (Motor::default(), Motor::default());
        (self.first, self.len, self.moves, self.waiting) = (0, 0, false, None);
    }

    /// The next step up to a tick; without one, all is reckoned up to there.
    fn step_until(&mut self, until: u64) -> Option<TimedEvent> {
        loop {
            let leaves = self.leaves_after(0);
            let left = i64::try_from(until.saturating_sub(self.now)).unwrap_or(i64::MAX);
            let span = leaves.map_or(left, |leaves| leaves.min(left));
            let steps = [self.x, self.y].map(|motor| motor.next_step(self.window));
            if let Some(ticks) =
                steps.into_iter().flatten().map(|(ticks, _)| ticks).min().filter(|ticks| *ticks <= span)
            {
                self.go_on(ticks);
                return self.due(self.now);
            }
            self.go_on(span);
            if leaves == Some(span) {
                self.leave();
            } else {
                return None;
            }
        }
    }

    /// The steps that are due at this tick.
    fn due(&mut self, tick: u64) -> Option<TimedEvent> {
        let (x, y) = (self.x.step(self.window), self.y.step(self.window));
        ((x, y) != (0, 0)).then_some(TimedEvent { tick, event: MotorEvent::Step(StepPair { x, y }) })
    }

    /// Ticks until a step leaves the window, by its number from the oldest one.
    fn leaves_after(&self, number: usize) -> Option<i64> {
        let (tick, _) = self.steps.get((self.first + number) % N.max(1)).filter(|_| number < self.len)?;
        #[expect(clippy::cast_possible_truncation, reason = "the lower half, as that of the step")]
        let age = (self.now as u32).wrapping_sub(*tick);
        Some((self.window - i64::from(age)).max(0))
    }

    fn go_on(&mut self, ticks: i64) {
        self.x.go_on(ticks);
        self.y.go_on(ticks);
        self.now = self.now.saturating_add(ticks.unsigned_abs());
    }

    /// A step of the plan enters the window.
    fn enter(&mut self, pair: StepPair) {
        if self.len == N {
            self.leave();
        }
        let Some(slot) = self.steps.get_mut((self.first + self.len) % N.max(1)) else { return };
        #[expect(clippy::cast_possible_truncation, reason = "the lower half tells an age within a window")]
        let tick = self.now as u32;
        *slot = (tick, pair);
        self.len += 1;
        self.moves = true;
        self.x.slope += i64::from(pair.x);
        self.y.slope += i64::from(pair.y);
    }

    /// The oldest step leaves the window: from here on it counts whole.
    fn leave(&mut self) {
        let rest = self.leaves_after(0).unwrap_or(0);
        let Some((_, pair)) = self.steps.get(self.first).copied() else { return };
        self.first = (self.first + 1) % N.max(1);
        self.len = self.len.saturating_sub(1);
        for (motor, way) in [(&mut self.x, pair.x), (&mut self.y, pair.y)] {
            motor.slope -= i64::from(way);
            motor.ahead += rest * i64::from(way);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pen;
    use std::vec::Vec;

    fn step(tick: u64, x: i8, y: i8) -> TimedEvent {
        TimedEvent { tick, event: MotorEvent::Step(StepPair { x, y }) }
    }

    fn averaged<const N: usize>(window: u32, events: &[TimedEvent]) -> Vec<TimedEvent> {
        let mut averaged = AveragedSteps::<N>::new(window);
        let mut given = Vec::new();
        for event in events {
            averaged.push(*event).unwrap();
            given.extend(core::iter::from_fn(|| averaged.next_event()));
        }
        given.extend(core::iter::from_fn(|| averaged.rest()));
        given
    }

    #[test]
    fn a_step_by_itself_comes_half_a_window_later() {
        assert_eq!(averaged::<4>(1000, &[step(5000, 1, -1)]), [step(5500, 1, 0), step(5501, 0, -1)]);
    }

    #[test]
    fn the_pen_waits_until_the_motors_are_there_and_all_after_it_is_as_late() {
        let lift = |tick| TimedEvent { tick, event: MotorEvent::Pen(Pen::Up) };
        let given = averaged::<4>(1000, &[step(1000, 1, 0), lift(1100), step(9000, 1, 0), lift(20_000)]);
        // Each rest takes a window more: at 1100 the plan was at its end.
        assert_eq!(given, [step(1500, 1, 0), lift(2100), step(10_500, 1, 0), lift(22_000)]);
    }

    #[test]
    fn a_pause_is_as_long_as_planned_and_what_is_stopped_makes_no_step() {
        let mut averaged = AveragedSteps::<4>::new(1000);
        let mut given = Vec::new();
        for event in [step(1000, 1, 0), step(6000, 1, 0)] {
            averaged.push(event).unwrap();
            given.extend(core::iter::from_fn(|| averaged.next_event()));
            // The motors are there at 2000, and wait to 6000 or more as the plan does from 1000 to 5000.
            averaged.arrive();
            averaged.arrive();
        }
        given.extend(core::iter::from_fn(|| averaged.rest()));
        assert_eq!((given, averaged.delay_ticks()), ([step(1500, 1, 0), step(7500, 1, 0)].to_vec(), 2000));

        averaged.push(step(8000, 1, 1)).unwrap();
        assert_eq!(averaged.next_event(), None);
        assert_eq!(averaged.rates_hz(1_000_000), [1000.0; 2]);
        averaged.clear(8000);
        assert_eq!((averaged.rest(), averaged.delay_ticks()), (None, 2000));
        averaged.push(step(9000, 1, 0)).unwrap();
        assert_eq!(averaged.next_event(), None);
        assert_eq!(averaged.rest(), Some(step(11_500, 1, 0)));
    }

    #[test]
    fn without_room_the_oldest_step_leaves_early_and_none_is_lost() {
        let events: Vec<TimedEvent> = (1..=100).map(|at| step(at * 100, 1, 0)).collect();
        let (wide, narrow) = (averaged::<64>(3000, &events), averaged::<8>(3000, &events));
        assert_eq!((wide.len(), narrow.len()), (100, 100));
        assert!(narrow.is_sorted_by_key(|event| event.tick));
        assert!(narrow.last().unwrap().tick <= wide.last().unwrap().tick);
    }

    #[test]
    fn an_event_more_is_not_taken_and_a_window_without_time_is_passed() {
        let mut averaged = AveragedSteps::<4>::new(0);
        averaged.push(step(10, 1, 0)).unwrap();
        assert_eq!(averaged.push(step(11, 1, 0)), Err(Busy));
        assert_eq!(averaged.next_event(), None);
        assert_eq!(averaged.rest(), Some(step(11, 1, 0)));
        assert_eq!(averaged.rest(), None);
    }
}
