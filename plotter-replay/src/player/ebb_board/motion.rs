//! [`Motion`]: what the board does in each of its ticks, and the one command that may wait behind it.

use super::servo::Servo;
use plotter_motion::StepPair;
use plotter_motion::protocol::ebb::{Accumulators, LowLevelMove, TICKS_PER_MS};

/// A command that waits for longer does not wait at all: 65,536 ms.
const MOST_DELAY_TICKS: u32 = TICKS_PER_MS * 0x1_0000;

/// What a command of the motion queue does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Work {
    /// Nothing: it only takes its time.
    #[default]
    Wait,
    /// The motors make steps.
    Steps(LowLevelMove),
    /// The motors step for so many ticks.
    TimedSteps(u32, LowLevelMove),
    /// The pen's servo goes somewhere, in units of the pulse and of its rate.
    Servo { position: u16, rate: u16 },
    /// Another servo.
    OtherServo,
    /// The motors are switched on or off, and their step mode chosen.
    Enable([u8; 2]),
}

/// A command of the motion queue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Queued {
    pub(super) work: Work,
    /// Until when the next command waits at least.
    pub(super) delay_ticks: u32,
}

impl Queued {
    pub(super) fn after_ms(work: Work, delay_ms: u32) -> Self {
        Self { work, delay_ticks: TICKS_PER_MS.saturating_mul(delay_ms) }
    }

    fn is_of_motors(&self) -> bool {
        matches!(self.work, Work::Steps(_) | Work::TimedSteps(..))
    }
}

/// What was interrupted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Interrupted {
    pub(super) any: bool,
    pub(super) waiting: [u32; 2],
    pub(super) left: [u32; 2],
}

/// The motion part of the board.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Motion {
    accumulators: Accumulators,
    running: Option<Queued>,
    delay_ticks: u32,
    waiting: Option<Queued>,
    /// Steps of both motors since they were counted from 0.
    pub(super) counted: [i32; 2],
    pub(super) enabled: [bool; 2],
    /// 1 for sixteenths of a step to 5 for full steps.
    pub(super) step_mode: u8,
    pub(super) servo: Servo,
}

impl Motion {
    pub(super) fn switched_on() -> Self {
        Self { step_mode: 1, ..Self::default() }
    }

    /// Whether a command finds room.
    pub(super) fn has_room(&self) -> bool {
        self.waiting.is_none()
    }

    pub(super) fn push(&mut self, command: Queued) {
        // A move of either motor switches both on, as soon as it is taken.
        if command.is_of_motors() {
            self.enabled = [true; 2];
        }
        self.waiting = Some(command);
    }

    /// Whether a command runs, the first and the second motor move, and a command waits.
    pub(super) fn status(&self) -> [bool; 4] {
        let runs = self.running.is_some() || self.waiting.is_some();
        let [first, second] = self.accumulators.left();
        let timed = matches!(self.running, Some(Queued { work: Work::TimedSteps(..), .. }));
        [runs, first != 0, second != 0 || (timed && first != 0), self.waiting.is_some()]
    }

    pub(super) fn is_idle(&self) -> bool {
        self.running.is_none() && self.waiting.is_none()
    }

    pub(super) fn stop(&mut self) -> Interrupted {
        let waiting = self.waiting.take_if(|command| command.is_of_motors());
        let running = self.running.take_if(|command| command.is_of_motors());
        let steps = match waiting.map(|command| command.work) {
            Some(Work::Steps(of)) => of.motors.map(|motor| motor.steps.unsigned_abs()),
            _ => [0; 2],
        };
        let left = self.accumulators.stop();
        Interrupted { any: waiting.is_some() || running.is_some(), waiting: steps, left }
    }

    pub(super) fn count_from_zero(&mut self) {
        self.counted = [0; 2];
        self.accumulators.clear();
    }

    /// The next tick: the steps in it, of the motors as they are switched.
    pub(super) fn tick(&mut self) -> StepPair {
        self.delay_ticks = self.delay_ticks.saturating_sub(1);
        let steps = match self.running.map(|command| command.work) {
            Some(Work::Steps(_) | Work::TimedSteps(..)) => self.accumulators.tick(),
            Some(Work::Servo { position, rate }) => {
                self.servo.go(position, rate);
                StepPair::default()
            }
            Some(Work::Enable(modes)) => {
                self.enable(modes);
                StepPair::default()
            }
            Some(Work::Wait | Work::OtherServo) | None => StepPair::default(),
        };
        for (counted, step) in self.counted.iter_mut().zip([steps.x, steps.y]) {
            *counted = counted.wrapping_add(step.into());
        }
        if self.delay_ticks == 0 && !self.accumulators.is_running() {
            self.running = self.waiting.take();
            self.begin();
        }
        steps
    }

    fn begin(&mut self) {
        let Some(Queued { work, delay_ticks }) = self.running else { return };
        self.delay_ticks = if delay_ticks > MOST_DELAY_TICKS { 0 } else { delay_ticks };
        match work {
            Work::Steps(of) => self.accumulators.start(of),
            Work::TimedSteps(ticks, of) => self.accumulators.start_timed(ticks, of),
            _ => {}
        }
    }

    fn enable(&mut self, [first, second]: [u8; 2]) {
        self.enabled = [first > 0, second > 0];
        if (1..=5).contains(&first) {
            self.step_mode = first;
        }
        self.count_from_zero();
    }
}
