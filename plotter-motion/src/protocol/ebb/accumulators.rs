//! [`Accumulators`]: the board's arithmetic, tick by tick.

use super::rates::{LowLevelMove, MotorRate, STEP};
use crate::StepPair;

/// One motor of a move that runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Motor {
    accumulator: u32,
    rate: u32,
    accel: i32,
    left: u32,
    sign: i8,
}

impl Motor {
    fn start(&mut self, motor: MotorRate, clear: bool) {
        let MotorRate { rate, steps, accel } = motor;
        // Half of the acceleration is taken off before, rounded towards zero: the middle of the first tick.
        self.rate = rate.min(STEP - 1).wrapping_sub((accel / 2).cast_unsigned());
        self.accel = accel;
        self.left = steps.unsigned_abs();
        self.sign = if steps < 0 { -1 } else { 1 };
        if clear {
            self.accumulator = 0;
        }
    }

    fn add(&mut self) -> i8 {
        // Both are numbers of 31 bits: below 0 a rate begins again at the greatest.
        self.rate = self.rate.wrapping_add(self.accel.cast_unsigned()) & (STEP - 1);
        self.accumulator = self.accumulator.wrapping_add(self.rate);
        let is_over = self.accumulator & STEP != 0;
        self.accumulator &= STEP - 1;
        if is_over { self.sign } else { 0 }
    }

    fn tick(&mut self) -> i8 {
        if self.left == 0 {
            return 0;
        }
        let step = self.add();
        if step != 0 {
            self.left -= 1;
        }
        step
    }
}

/// The accumulators of both motors, and the move that they run: what the board does in each of its ticks, as
/// the section "LM" of its documentation has it.
///
/// ```
/// # use plotter_motion::protocol::ebb::{Accumulators, LowLevelMove, MotorRate};
/// // The documentation's third example: 10 steps and 2 steps in 10 ms, 250 ticks.
/// let first = MotorRate { rate: 85_899_346, steps: 10, accel: 0 };
/// let second = MotorRate { rate: 17_180_814, steps: 2, accel: 0 };
/// let mut board = Accumulators::default();
/// board.start(LowLevelMove { motors: [first, second], clear: 3 });
/// let mut ticks = 0;
/// while board.is_running() {
///     board.tick();
///     ticks += 1;
/// }
/// assert_eq!(ticks, 250);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Accumulators {
    motors: [Motor; 2],
    /// Ticks that are left of a move that is limited by its time.
    timed: Option<u32>,
}

impl Accumulators {
    /// Begins a move that is over after its steps. What was left of another one is not made.
    pub fn start(&mut self, of: LowLevelMove) {
        for (index, (motor, rate)) in (0_u8..).zip(self.motors.iter_mut().zip(of.motors)) {
            motor.start(rate, of.clear & (1 << index) != 0);
        }
        self.timed = None;
    }

    /// Begins a move that is over after so many ticks, whatever steps it makes: the command LT. The steps of
    /// `of` tell the directions only.
    pub fn start_timed(&mut self, ticks: u32, of: LowLevelMove) {
        self.start(of);
        self.timed = Some(ticks);
    }

    /// Sets both accumulators to 0, as the command EM does.
    pub fn clear(&mut self) {
        self.motors.iter_mut().for_each(|motor| motor.accumulator = 0);
    }

    /// Ends the move; the steps that were left of it.
    pub fn stop(&mut self) -> [u32; 2] {
        let left = self.left();
        self.motors.iter_mut().for_each(|motor| motor.left = 0);
        self.timed = None;
        left
    }

    /// Steps that are left of the move; of one that is limited by its time its ticks, and 0.
    #[must_use]
    pub fn left(&self) -> [u32; 2] {
        let [first, second] = &self.motors;
        self.timed.map_or([first.left, second.left], |ticks| [ticks, 0])
    }

    /// Whether the move is not over.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.left() != [0, 0]
    }

    /// The next tick: the steps in it.
    pub fn tick(&mut self) -> StepPair {
        let [first, second] = &mut self.motors;
        match &mut self.timed {
            None => StepPair { x: first.tick(), y: second.tick() },
            Some(0) => StepPair::default(),
            Some(ticks) => {
                *ticks -= 1;
                StepPair { x: first.add(), y: second.add() }
            }
        }
    }
}
