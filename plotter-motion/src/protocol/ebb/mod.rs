//! The EBB (EiBotBoard) of the AxiDraw and of the EggBot: what its motion commands do, and a drawing as such
//! commands.
//!
//! The board makes steps at the ticks of a clock of 25 kHz. In each tick it adds a rate to an accumulator of
//! 31 bits for each motor, and where that overflows the motor makes a step. It looks no command ahead, so
//! that whoever sends the commands has to brake before a corner.
//!
//! ```text
//!  Planner ──Action──▶ EbbMotion ──EbbCommand──▶ board, or Accumulators
//!           mm, s                  steps, ticks
//! ```
//!
//! Source: *EBB (EiBotBoard) Command Set*, evil-mad.github.io/EggBot/ebb2.html (firmware 1.8.0 to 2.8.1),
//! command by command.

mod accumulators;
mod command;
mod motion;
mod piece;
mod rates;

pub use accumulators::Accumulators;
pub use command::{EbbCommand, EbbEvent};
pub use motion::{EbbDialect, EbbMotion, EbbMotionSettings};
pub use rates::{LowLevelMove, MotorRate, TICK_HZ, TICKS_PER_MS};
