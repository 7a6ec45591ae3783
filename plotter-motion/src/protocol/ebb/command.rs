//! [`EbbCommand`] and [`EbbEvent`]: a drawing as the board takes it.

use super::LowLevelMove;
use crate::Pen;
use core::fmt;

/// A command of the board's motion queue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EbbCommand {
    /// LM: both motors at constant acceleration.
    LowLevel(LowLevelMove),
    /// SM: both motors at constant speed; without steps the machine waits.
    Constant {
        /// How long it takes, ms.
        duration_ms: u32,
        /// Steps of both motors.
        steps: [i32; 2],
    },
    /// SP: the pen goes up or down, and the next command waits.
    Pen {
        /// Where to.
        pen: Pen,
        /// How long the next command waits, ms.
        duration_ms: u16,
    },
    /// EM: both motors are switched on in this step mode, and their steps counted from 0.
    Enable {
        /// 1 for sixteenths of a step to 5 for full steps.
        mode: u8,
    },
}

impl fmt::Display for EbbCommand {
    /// As it is sent, without the end of the line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LowLevel(of) => of.fmt(f),
            Self::Constant { duration_ms, steps: [first, second] } => {
                write!(f, "SM,{duration_ms},{first},{second}")
            }
            Self::Pen { pen, duration_ms } => write!(f, "SP,{},{duration_ms}", u8::from(*pen == Pen::Up)),
            Self::Enable { mode } => write!(f, "EM,{mode},{mode}"),
        }
    }
}

/// Elements of a drawing for the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EbbEvent {
    /// This is sent.
    Command(EbbCommand),
    /// A person puts in this pen; the machine stands with its pen lifted.
    SelectPen(u8),
    /// A person puts in a new sheet; the machine stands with its pen lifted.
    NewPage,
}
