//! [`MotorRate`] and [`LowLevelMove`]: the numbers of a motion command.

use core::fmt;

/// Ticks of the board in a second: every 40 µs.
pub const TICK_HZ: u32 = 25_000;
/// The same in a millisecond.
pub const TICKS_PER_MS: u32 = 25;
/// What the accumulator gives for a step: 2³¹.
pub(super) const STEP: u32 = 1 << 31;
/// Moves up to so many ms are timed by the upper 16 bits of the rate alone.
const COARSE_UP_TO_MS: u32 = 30;
/// Greatest number of steps, and of milliseconds, that the board's SM takes: 24 bits.
pub(super) const MOST_SM: u32 = 0xFF_FFFF;

/// Motion of one motor in a command.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct MotorRate {
    /// Added to the accumulator in each tick, 2³¹ for a step: [`TICK_HZ`] steps/s are 2³¹.
    pub rate: u32,
    /// Steps to make; the sign is the direction.
    pub steps: i32,
    /// Added to the rate in each tick.
    pub accel: i32,
}

impl MotorRate {
    /// `steps` in `duration_ms` at a constant speed, as the command SM makes it: as nearly as whole rates
    /// allow, and for up to 30 ms with the upper 16 bits of the rate only, which the firmware computes in
    /// less time (EBB firmware 2.8.1, `process_SM`).
    ///
    /// ```
    /// # use plotter_motion::protocol::ebb::MotorRate;
    /// // 3125 steps in a second are one in 8 ticks: 2^31 / 8
    /// assert_eq!(MotorRate::constant(1_000, 3_125).rate, 1 << 28);
    /// // 3 steps in 10 ms: 3 * 2^15 / 250 = 393.2 of 2^15
    /// assert_eq!(MotorRate::constant(10, 3).rate, 393 << 16);
    /// ```
    #[must_use]
    pub fn constant(duration_ms: u32, steps: i32) -> Self {
        let ticks = u64::from(TICKS_PER_MS) * u64::from(duration_ms.clamp(1, MOST_SM));
        let wanted = u64::from(steps.unsigned_abs().min(MOST_SM)) * u64::from(STEP);
        let exact = wanted.checked_div(ticks).unwrap_or_default();
        let rate = if duration_ms > COARSE_UP_TO_MS { exact } else { (exact >> 16) << 16 };
        let rate = u32::try_from(rate).unwrap_or(u32::MAX).min(STEP - 1);
        // No motor that has steps to make waits for ever.
        let rate = if steps == 0 { 0 } else { rate.max(1 << 16) };
        Self { rate, steps, accel: 0 }
    }

    /// Whether it never makes a step.
    #[must_use]
    pub const fn is_at_rest(&self) -> bool {
        self.steps == 0 || (self.rate == 0 && self.accel == 0)
    }
}

/// The command LM: each motor makes its steps by a rate that changes evenly, and the command is over when
/// both have made them.
///
/// ```
/// # use plotter_motion::protocol::ebb::{LowLevelMove, MotorRate};
/// // 10 steps at 1000 steps/s, 2 steps at 200 steps/s: both take 10 ms
/// let first = MotorRate { rate: 85_899_346, steps: 10, accel: 0 };
/// let second = MotorRate { rate: 17_179_870, steps: -2, accel: 0 };
/// let both = LowLevelMove { motors: [first, second], clear: 3 };
/// assert_eq!(both.to_string(), "LM,85899346,10,0,17179870,-2,0,3");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct LowLevelMove {
    /// Both motors.
    pub motors: [MotorRate; 2],
    /// Accumulators that are cleared before: 1 for the first motor's, 2 for the second's, 3 for both.
    pub clear: u8,
}

impl fmt::Display for LowLevelMove {
    /// As it is sent, without the end of the line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("LM")?;
        for MotorRate { rate, steps, accel } in self.motors {
            write!(f, ",{rate},{steps},{accel}")?;
        }
        if self.clear == 0 { Ok(()) } else { write!(f, ",{}", self.clear) }
    }
}
