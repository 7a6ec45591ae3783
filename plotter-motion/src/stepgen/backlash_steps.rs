//! [`BacklashSteps`]: the extra steps of axes with play, between the steps of a path.

use super::{MotorEvent, TimedEvent};
use crate::config::SteppersConfig;
use crate::kinematics::Backlash;
use crate::{Machine, StepPair};

/// Inserts the steps that take up the play of an axis where it turns round.
///
/// The path goes on meanwhile: an axis that turns round in the middle of a circle must not stop the other
/// one. The extra steps come one by one in their own interval, so that a motor is never asked for more than
/// its start rate on top of what the path asks.
///
/// ```
/// # use plotter_motion::kinematics::Backlash;
/// # use plotter_motion::{StepPair, stepgen::{BacklashSteps, MotorEvent, TimedEvent}};
/// let mut play = BacklashSteps::new(Backlash { x_steps: 2, y_steps: 0 }, 500);
/// let mut given = Vec::new();
/// // forwards, as both axes are taken to have been driven backwards before; then two more steps
/// for tick in [1000, 2000, 3000] {
///     play.push(TimedEvent { tick, event: MotorEvent::Step(StepPair { x: 1, y: 0 }) })?;
///     while let Some(event) = play.next_event() {
///         given.push(event.tick);
///     }
/// }
/// assert_eq!(given, [1000, 1500, 2000, 2000, 3000]); // the step, two extra ones, two steps
/// # Ok::<(), plotter_motion::stepgen::Busy>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BacklashSteps {
    play: Backlash,
    interval_ticks: u64,
    /// How much of the play each axis has taken up when all that is owed has been made, seen from where it is
    /// driven backwards.
    taken_up: (i32, i32),
    /// Extra steps to come, with sign.
    owed: (i32, i32),
    /// When the next of them may come.
    next_tick: u64,
    waiting: Option<TimedEvent>,
}

impl BacklashSteps {
    /// Axes that have been driven backwards last, as homing leaves them. Extra steps of an axis come
    /// `interval_ticks` apart.
    #[must_use]
    pub const fn new(play: Backlash, interval_ticks: u64) -> Self {
        Self { play, interval_ticks, taken_up: (0, 0), owed: (0, 0), next_tick: 0, waiting: None }
    }

    /// The play of a machine with stepper motors; extra steps come at the slower start rate of its axes, by a
    /// clock of `clock_hz`.
    #[must_use]
    pub fn of(machine: &Machine, clock_hz: f64) -> Self {
        let SteppersConfig { x, y, .. } = SteppersConfig::of(machine);
        let steps =
            |mm: f64, per_mm: f64| u16::try_from(crate::toolpath::from_mm(mm, per_mm)).unwrap_or(u16::MAX);
        let play = Backlash {
            x_steps: steps(x.backlash_mm, x.steps_per_mm),
            y_steps: steps(y.backlash_mm, y.steps_per_mm),
        };
        let interval = libm::ceil(clock_hz / x.start_rate_hz.min(y.start_rate_hz));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast saturates")]
        let interval_ticks = interval as u64;
        Self::new(play, interval_ticks)
    }

    /// Takes the next event of the path.
    ///
    /// # Errors
    ///
    /// [`Busy`](super::Busy) while events are left to be taken; the event is not taken.
    pub fn push(&mut self, event: TimedEvent) -> Result<(), super::Busy> {
        if self.waiting.is_some() {
            return Err(super::Busy);
        }
        self.waiting = Some(event);
        Ok(())
    }

    /// The next event: extra steps that are due before the one of the path, then that; `None` when the next
    /// one is wanted.
    pub fn next_event(&mut self) -> Option<TimedEvent> {
        let waiting = self.waiting?;
        if self.owed != (0, 0) && self.next_tick <= waiting.tick {
            return self.rest();
        }
        self.waiting = None;
        if let MotorEvent::Step(StepPair { x, y }) = waiting.event {
            let before = self.owed;
            self.owed.0 += turn(&mut self.taken_up.0, x, self.play.x_steps);
            self.owed.1 += turn(&mut self.taken_up.1, y, self.play.y_steps);
            if before != self.owed {
                self.next_tick = self.next_tick.max(waiting.tick.saturating_add(self.interval_ticks));
            }
        }
        Some(waiting)
    }

    /// The motors have been stopped at once: nothing is owed any more, and of its play each axis has taken up
    /// so many steps, seen from where it is driven backwards.
    pub fn clear(&mut self, x_taken_up: u16, y_taken_up: u16) {
        self.taken_up = (x_taken_up.into(), y_taken_up.into());
        (self.owed, self.waiting) = ((0, 0), None);
    }

    /// An extra step that is still to come when the path has ended.
    pub fn rest(&mut self) -> Option<TimedEvent> {
        if self.owed == (0, 0) {
            return None;
        }
        let step = |owed: &mut i32| {
            let sign = owed.signum();
            *owed -= sign;
            i8::try_from(sign).unwrap_or(0)
        };
        let event = MotorEvent::Step(StepPair { x: step(&mut self.owed.0), y: step(&mut self.owed.1) });
        let tick = self.next_tick;
        self.next_tick = tick.saturating_add(self.interval_ticks);
        Some(TimedEvent { tick, event })
    }
}

/// The extra steps of an axis that makes a step.
fn turn(taken_up: &mut i32, step: i8, play: u16) -> i32 {
    let wanted = match step.signum() {
        1 => play.into(),
        -1 => 0,
        _ => return 0,
    };
    wanted - core::mem::replace(taken_up, wanted)
}
