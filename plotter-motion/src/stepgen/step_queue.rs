//! [`StepQueue`]: events between the main loop, which reckons them, and the timer's interrupt, which makes
//! them.

use super::{Busy, MotorEvent, TimedEvent};
use crate::StepPair;

/// An event that waits for its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct QueuedEvent {
    /// Ticks of the clock since the event before.
    pub after_ticks: u32,
    /// The event.
    pub event: MotorEvent,
}

/// The next `N` events, in order; `N` is a power of two. The main loop fills it from a
/// [`StepGen`](super::StepGen), a timer's interrupt empties it.
///
/// What is left to the interrupt is short: take an event, let its step through the
/// [`SafetyGate`](crate::SafetyGate), set the pins, set the timer to the next. While the main loop puts an
/// event in, the interrupt must be held off, as for every variable that both have.
///
/// An interrupt that comes late may find two steps due. Whoever has drivers that can refuse a step takes it
/// out only when they are ready (`StepperAxes::drivers` of `plotter-hal`): what has been taken out is gone,
/// what has not stays the next one.
///
/// ```
/// # use plotter_motion::{StepPair, stepgen::{MotorEvent, StepQueue, TimedEvent}};
/// let mut queue = StepQueue::<16>::new();
/// queue.push(TimedEvent { tick: 1000, event: MotorEvent::Step(StepPair { x: 1, y: 0 }) })?;
/// queue.push(TimedEvent { tick: 1250, event: MotorEvent::Step(StepPair { x: 1, y: 1 }) })?;
/// assert_eq!(queue.next_after_ticks(), Some(1000)); // since the start
/// assert_eq!(queue.pop().map(|queued| queued.event), Some(MotorEvent::Step(StepPair { x: 1, y: 0 })));
/// assert_eq!(queue.next_after_ticks(), Some(250));
/// # Ok::<(), plotter_motion::stepgen::Busy>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct StepQueue<const N: usize> {
    events: [QueuedEvent; N],
    head: usize,
    len: usize,
    /// Tick of the event that was put in last.
    last_tick: u64,
}

impl<const N: usize> StepQueue<N> {
    /// So that a place in the ring is found by leaving out bits.
    const POWER_OF_TWO: () = assert!(N.is_power_of_two(), "a queue has room for a power of two of events");

    /// An empty one; the clock stands at 0.
    #[must_use]
    pub const fn new() -> Self {
        () = Self::POWER_OF_TWO;
        let none = QueuedEvent { after_ticks: 0, event: MotorEvent::Step(StepPair { x: 0, y: 0 }) };
        Self { events: [none; N], head: 0, len: 0, last_tick: 0 }
    }

    /// Whether there is room for another event.
    #[must_use]
    pub const fn has_room(&self) -> bool {
        self.len < N
    }

    /// How many events wait.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Whether none does.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Takes the next event of a step generator. One that is due more than 2^32 ticks after the one before is
    /// due after 2^32 - 1.
    ///
    /// # Errors
    ///
    /// [`Busy`] while there is no room; the event is not taken.
    pub fn push(&mut self, event: TimedEvent) -> Result<(), Busy> {
        if !self.has_room() {
            return Err(Busy);
        }
        let slot = Self::wrapped(self.head.wrapping_add(self.len));
        let Some(place) = self.events.get_mut(slot) else { return Err(Busy) };
        let after_ticks = event.tick.saturating_sub(self.last_tick);
        let after_ticks = u32::try_from(after_ticks).unwrap_or(u32::MAX);
        *place = QueuedEvent { after_ticks, event: event.event };
        self.last_tick = event.tick;
        self.len += 1;
        Ok(())
    }

    /// Takes out the event that is due.
    pub fn pop(&mut self) -> Option<QueuedEvent> {
        if self.len == 0 {
            return None;
        }
        let queued = *self.events.get(Self::wrapped(self.head))?;
        self.head = Self::wrapped(self.head.wrapping_add(1));
        self.len -= 1;
        Some(queued)
    }

    /// How long after the event before the next one is due, ticks.
    #[must_use]
    pub fn next_after_ticks(&self) -> Option<u32> {
        if self.len == 0 {
            None
        } else {
            self.events.get(Self::wrapped(self.head)).map(|queued| queued.after_ticks)
        }
    }

    /// Forgets what waits, after an emergency stop; what comes next counts from `tick`.
    pub const fn clear(&mut self, tick: u64) {
        (self.len, self.last_tick) = (0, tick);
    }

    /// A place in the ring.
    const fn wrapped(slot: usize) -> usize {
        slot & (N - 1)
    }
}

impl<const N: usize> Default for StepQueue<N> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(tick: u64) -> TimedEvent {
        TimedEvent { tick, event: MotorEvent::Step(StepPair { x: 1, y: -1 }) }
    }

    #[test]
    fn events_come_out_as_they_went_in_round_the_end_of_the_ring() {
        let mut queue = StepQueue::<4>::new();
        let (mut pushed, mut popped) = (0_u64, 0_u64);
        let mut tick = 0_u64;
        while popped < 20 {
            while queue.push(step(pushed * pushed)).is_ok() {
                pushed += 1;
            }
            assert!(!queue.has_room());
            for _ in 0..2 {
                let queued = queue.pop().unwrap();
                tick += u64::from(queued.after_ticks);
                assert_eq!(tick, popped * popped);
                popped += 1;
            }
        }
    }

    #[test]
    fn a_cleared_queue_counts_from_where_it_is_told() {
        let mut queue = StepQueue::<4>::new();
        queue.push(step(10)).unwrap();
        queue.clear(1_000);
        assert_eq!((queue.is_empty(), queue.pop()), (true, None));
        queue.push(step(1_007)).unwrap();
        assert_eq!(queue.next_after_ticks(), Some(7));
        queue.push(step(u64::MAX)).unwrap();
        let _ = queue.pop();
        assert_eq!(queue.next_after_ticks(), Some(u32::MAX));
    }
}
