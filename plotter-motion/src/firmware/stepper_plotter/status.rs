//! [`Status`]: what the receive side may know of the motion side at any time.

use crate::{LimitSwitches, Point};

/// What the machine does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Activity {
    /// It stands, and nothing is to be done.
    #[default]
    Idle,
    /// It draws or travels, or is about to.
    Run,
    /// It is being moved by hand, or ends that.
    Jog,
    /// It is being held: brakes, or stands.
    Hold {
        /// Whether it stands.
        stands: bool,
    },
    /// It homes.
    Home,
    /// It has been stopped, and leaves commands out until [`Command::GoOn`](super::Command::GoOn).
    Stopped,
}

/// Percent of what is asked for: 100 of each while nobody says otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Percents {
    /// Of speeds with the pen down.
    pub draw: u8,
    /// Of speeds with the pen up.
    pub travel: u8,
    /// Of the laser's power.
    pub laser: u8,
}

impl Default for Percents {
    fn default() -> Self {
        Self { draw: 100, travel: 100, laser: 100 }
    }
}

/// A view of the motion side. Two tasks share it under a lock.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Status {
    /// What it does.
    pub activity: Activity,
    /// Blocks of the look-ahead that are planned and not over, the one in progress among them.
    pub planned: u8,
    /// Where the pen is by the steps really made, mm.
    pub at: Point,
    /// The height of a third axis by the steps really made, mm, if there is one.
    #[cfg(feature = "third-motor")]
    pub z_mm: Option<f64>,
    /// Which limit switches of it are pressed.
    #[cfg(feature = "third-motor")]
    pub z_switches: crate::safety::EndSwitches,
    /// Which limit switches of the second motor of an axis are pressed.
    #[cfg(feature = "third-motor")]
    pub second_switches: crate::safety::EndSwitches,
    /// How many steps farther than the first the second motor of an axis went when both were made square
    /// last.
    #[cfg(feature = "third-motor")]
    pub skew_steps: Option<i32>,
    /// How fast it moves, mm/s.
    pub speed_mm_s: f32,
    /// Power of the laser, in 65535ths.
    pub laser: u16,
    /// The overrides in force.
    pub percents: Percents,
    /// Which limit switches are pressed.
    pub limits: LimitSwitches,
    /// Whether the emergency stop is latched.
    pub emergency_stop: bool,
    /// Whether its button is pressed.
    pub emergency_button: bool,
    /// Whether [`Command::Restore`](super::Command::Restore) is there: not with
    /// [`ExactOnly`](crate::planner::ExactOnly).
    pub restores: bool,
}
