//! What the two tasks tell each other: [`Command`], [`Signal`] and [`Report`].

use super::{Activity, Setting};
use crate::decimal_text::Plain;
use crate::{
    Axis, Direction, PlotOp, Point,
    homing::{Homed, HomingError},
};
use core::fmt;

/// What the receive side asks of the motion side, one after the other: through the queue.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u32)] // a tag of the width of a float costs small processors a second comparison everywhere
pub enum Command {
    /// Plans and does this. What follows closely is planned together with it.
    Plot(PlotOp),
    /// A travel by hand, at this speed in mm/s whatever the share of travels is; [`Signal::JogCancel`] ends
    /// it.
    Jog {
        /// Where to, mm.
        to: Point,
        /// How fast, above 0; no faster than travels are.
        speed_mm_s: f64,
    },
    /// The next [`Command::Plot`] that goes somewhere ends at this height of a third axis, mm, and z changes
    /// evenly on its way.
    #[cfg(feature = "third-motor")]
    ToZ(f64),
    /// As [`Command::Jog`], to another height of a third axis.
    #[cfg(feature = "third-motor")]
    JogZ {
        /// Where to, mm.
        to: Point,
        /// To which height, mm.
        to_z_mm: f64,
        /// How fast in space, above 0.
        speed_mm_s: f64,
    },
    /// From here on this holds of the machine; it changes at a standstill. [`Report::Set`] follows.
    Set(Setting),
    /// As [`Command::Set`], but all of it becomes what the machine was switched on with.
    Restore,
    /// Waits until all before is done, then turns the pen's servo there, degrees. What follows waits until
    /// the pen has settled.
    Servo(u8),
    /// From here on these are the servo's degrees with the pen up and down.
    PenAngles {
        /// Up.
        up_deg: u8,
        /// Down.
        down_deg: u8,
    },
    /// Waits until all before is done, lifts the pen and homes; [`Report::Homed`] follows.
    Home,
    /// Waits until all before is done, then until [`Signal::Resume`].
    Pause,
    /// [`Report::Done`] follows when all before is done and the machine stands.
    Finish,
    /// As [`Command::Finish`] at the end of a program: speeds and the laser's power are no longer overridden.
    End,
    /// The receive side has learned of a stop: what comes from here on was meant for the machine as it stands
    /// now. After a stop all before this is left out.
    GoOn,
    /// As [`Command::GoOn`], and ends an emergency stop if the button has been released.
    Unlock,
}

impl Command {
    /// Whether it moves by hand.
    #[inline(always)] // so that nothing but the kind is looked at
    pub(super) const fn is_jog(&self) -> bool {
        #[cfg(feature = "third-motor")]
        if let Self::JogZ { .. } = self {
            return true;
        }
        matches!(self, Self::Jog { .. })
    }
}

/// What the receive side asks at once, past the queue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Signal {
    /// Feed hold: brakes along the path and stands.
    Hold,
    /// Goes on after a hold or a pause.
    Resume,
    /// Stops at once and forgets all commands; [`Report::Stopped`] follows.
    Reset,
    /// What is moved by hand brakes along its path and is forgotten; [`Report::Jogged`] follows. Nothing else
    /// is touched.
    JogCancel,
    /// From here on speeds are this many percent of what they are asked to be.
    Speeds {
        /// With the pen down.
        draw_percent: u8,
        /// With the pen up.
        travel_percent: u8,
    },
    /// From here on the laser has this many percent of the power it is asked to have.
    LaserPercent(u8),
    /// The laser stays off in what has been commanded up to now.
    LaserOff,
}

/// Why the machine has been stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Stop {
    /// The emergency stop button.
    Emergency,
    /// A limit switch came on the way to it.
    Limit {
        /// Of which axis.
        axis: Axis,
        /// At which of its ends.
        end: Direction,
    },
    /// A limit switch of the third axis came on the way to it.
    #[cfg(feature = "third-motor")]
    LimitZ {
        /// At which of its ends.
        end: Direction,
    },
    /// [`Signal::Reset`].
    Reset {
        /// What the machine did then.
        during: Activity,
    },
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Emergency => f.write_str("emergency stop: release the button, then reset"),
            Self::Limit { axis, end } => {
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

/// What the motion side tells the receive side.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Report {
    /// All before [`Command::Finish`] or [`Command::End`] is done.
    Done,
    /// What came of [`Command::Home`].
    Homed {
        /// Where the pen is now, mm.
        at: Point,
        /// How long the axes are, or why it gave up.
        result: Result<Homed, HomingError>,
    },
    /// Homing gave up at the third axis; the others have not moved.
    #[cfg(feature = "third-motor")]
    NotHomedZ {
        /// Where the pen is now, mm.
        at: Point,
        /// Why.
        error: super::ZHomingError,
    },
    /// Homing gave up where two motors are made square.
    #[cfg(feature = "third-motor")]
    NotSquared {
        /// Where the pen is now, mm.
        at: Point,
        /// Why.
        error: super::SquaringError,
    },
    /// A jog has been cancelled: the machine stands, and leaves out what was commanded until
    /// [`Command::GoOn`].
    Jogged {
        /// Where the pen is now, mm.
        at: Point,
    },
    /// What came of [`Command::Set`] or [`Command::Restore`].
    Set {
        /// Where the pen is now, mm.
        at: Point,
    },
    /// The machine has been stopped, and has left out what was commanded.
    Stopped {
        /// Where the pen is now, mm.
        at: Point,
        /// Why.
        why: Stop,
    },
}
