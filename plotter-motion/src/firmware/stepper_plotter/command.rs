//! Messages between the two tasks of a stepper plotter: [`Command`], [`Signal`] and [`Report`].
//!
//! The receive side ([`Receive`](super::Receive)) talks to the host; the motion side
//! ([`Motion`](super::Motion)) plans and steps.

use super::{Activity, Setting};
use crate::decimal_text::Plain;
use crate::{
    Axis, Direction, PlotOp, Point,
    homing::{Homed, HomingError},
};
use core::fmt;

/// A command of the receive side to the motion side; the queue keeps their order.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u32)] // a tag of the width of a float costs small processors a second comparison everywhere
pub enum Command {
    /// Plans and executes an operation, together with those that follow closely.
    Plot(PlotOp),
    /// A travel by hand. The override of travels does not apply to it; [`Signal::JogCancel`] ends it.
    Jog {
        /// Target, mm.
        to: Point,
        /// Speed, mm/s, above 0; it is limited to the machine's travel speed.
        speed_mm_s: f64,
    },
    /// Height of the third axis, mm, at the end of the next [`Command::Plot`] that moves. z changes linearly
    /// along its path.
    #[cfg(feature = "third-motor")]
    ToZ(f64),
    /// As [`Command::Jog`], to another height of a third axis.
    #[cfg(feature = "third-motor")]
    JogZ {
        /// Target, mm.
        to: Point,
        /// Target of the third axis, mm.
        to_z_mm: f64,
        /// Speed in space, mm/s, above 0.
        speed_mm_s: f64,
    },
    /// Changes a setting of the machine, at standstill; [`Report::Set`] follows.
    Set(Setting),
    /// As [`Command::Set`], but restores all settings that the machine had at power-on.
    Restore,
    /// Waits until everything before it is done, then turns the pen's servo to this angle, 0 to 180 degrees.
    /// What follows waits until the pen has settled.
    Servo(u8),
    /// Changes the servo's angles of the lifted and the lowered pen, 0 to 180 degrees.
    PenAngles {
        /// With the pen up, degrees.
        up_deg: u8,
        /// With the pen down, degrees.
        down_deg: u8,
    },
    /// Waits until everything before it is done, lifts the pen and homes; [`Report::Homed`] follows.
    Home,
    /// Waits until everything before it is done, then until [`Signal::Resume`].
    Pause,
    /// [`Report::Done`] follows when everything before it is done and the machine stands.
    Finish,
    /// As [`Command::Finish`], at the end of a program: it also ends the overrides of speeds and laser power.
    End,
    /// Acknowledges a stop. After a stop the motion side leaves out all commands before this one, for they
    /// were sent before the receive side knew of it.
    GoOn,
    /// As [`Command::GoOn`], and ends an emergency stop if the button has been released.
    Unlock,
}

impl Command {
    /// Whether it is a move by hand.
    #[inline(always)] // so that the caller loads the tag alone
    pub(super) const fn is_jog(&self) -> bool {
        #[cfg(feature = "third-motor")]
        if let Self::JogZ { .. } = self {
            return true;
        }
        matches!(self, Self::Jog { .. })
    }
}

/// A request of the receive side that bypasses the queue and is obeyed at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Signal {
    /// Feed hold: brakes along the path and stands.
    Hold,
    /// Continues after a hold or a pause.
    Resume,
    /// Stops at once and forgets all commands; [`Report::Stopped`] follows.
    Reset,
    /// Cancels moves by hand: the machine brakes along its path, then [`Report::Jogged`] follows. Other
    /// commands are not affected.
    JogCancel,
    /// Speed overrides, percent of the commanded speeds; 10 to 200 in Grbl's language.
    Speeds {
        /// With the pen down.
        draw_percent: u8,
        /// With the pen up.
        travel_percent: u8,
    },
    /// Laser power override, percent of the commanded power; 10 to 200 in Grbl's language.
    LaserPercent(u8),
    /// The laser stays off during everything commanded so far.
    LaserOff,
}

/// Why the machine has been stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Stop {
    /// The emergency stop button.
    Emergency,
    /// A limit switch closed while the machine moved towards it.
    Limit {
        /// Axis of the switch.
        axis: Axis,
        /// End of that axis.
        end: Direction,
    },
    /// A limit switch of the third axis closed while that axis moved towards it.
    #[cfg(feature = "third-motor")]
    LimitZ {
        /// End of the axis.
        end: Direction,
    },
    /// [`Signal::Reset`].
    Reset {
        /// What the machine was doing.
        during: Activity,
    },
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Emergency => f.write_str("emergency stop: release the button, then reset"),
            Self::Limit { axis, end } => {
                // Plain writes a bare text without `str`'s code for width and padding: less flash.
                let axis = Plain(if *axis == Axis::X { "x" } else { "y" });
                let end = Plain(if *end == Direction::Minus { "lower" } else { "upper" });
                write!(f, "axis {axis}: stopped by its {end} limit switch; home the machine")
            }
            #[cfg(feature = "third-motor")]
            Self::LimitZ { end } => {
                let end = Plain(if *end == Direction::Minus { "lower" } else { "upper" });
                write!(f, "axis z: stopped by its {end} limit switch; home the machine")
            }
            Self::Reset { .. } => f.write_str("stopped by a reset"),
        }
    }
}

/// A message of the motion side to the receive side.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Report {
    /// Everything before [`Command::Finish`] or [`Command::End`] is done.
    Done,
    /// Outcome of [`Command::Home`].
    Homed {
        /// Position of the pen, mm.
        at: Point,
        /// Lengths of the axes, or why homing gave up.
        result: Result<Homed, HomingError>,
    },
    /// Homing gave up at the third axis; the others have not moved.
    #[cfg(feature = "third-motor")]
    NotHomedZ {
        /// Position of the pen, mm.
        at: Point,
        /// The reason.
        error: super::ZHomingError,
    },
    /// Homing gave up while it squared the two motors of one axis.
    #[cfg(feature = "third-motor")]
    NotSquared {
        /// Position of the pen, mm.
        at: Point,
        /// The reason.
        error: super::SquaringError,
    },
    /// A jog has been cancelled by [`Signal::JogCancel`]: the machine stands, and leaves out commands until
    /// [`Command::GoOn`]. A jog that ends by itself gives no report.
    Jogged {
        /// Position of the pen, mm.
        at: Point,
    },
    /// [`Command::Set`] or [`Command::Restore`] has been executed.
    Set {
        /// Position of the pen, mm.
        at: Point,
    },
    /// The machine has been stopped, and has dropped all commands.
    Stopped {
        /// Position of the pen, mm.
        at: Point,
        /// The reason.
        why: Stop,
    },
}
