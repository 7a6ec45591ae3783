//! From a tool path to a motion in time: look-ahead planning.
//!
//! ```text
//!  speed   ____        ______
//!         /    \      /      \        each segment is a block; at its corners the speed is at most what the
//!        /      \    /        \       corner allows, and never so much that the machine could not stop at
//!       /        \__/          \      the end of what is known
//!      | block 1 |2 |   3   | 4 |
//! ```
//!
//! [`Planner`] takes [`PlotOp`](crate::PlotOp)s and gives [`Action`]s: stretches of path, and the time law
//! along them.

mod averaged;
mod blend;
mod block;
mod error;
mod fit;
mod front;
mod junction;
mod law;
mod limits;
mod look_ahead;
mod merge;
mod modes;
mod phase;
mod ramps;
mod ring;
#[cfg(feature = "third-motor")]
mod rise;
mod rounding;
mod s_curve;
mod settings;
mod stretch;
mod sum_down;
mod time_law;

pub use averaged::Averaged;
pub use error::PlanError;
pub use junction::junction_speed;
pub use look_ahead::Planner;
pub(crate) use modes::Keep;
#[cfg(feature = "third-motor")]
pub use modes::ThreeAxes;
pub use modes::{AllModes, ExactOnly, ExactPen, Modes};
pub(crate) use modes::{Here, Nowhere, Part};
pub use phase::{Action, Course, Phase, Shape};
#[cfg(all(feature = "step-ahead", feature = "third-motor"))]
pub(crate) use rise::HELIX_SHARE;
#[cfg(feature = "third-motor")]
pub use rise::ZLimits;
#[cfg(feature = "averaged-steps")]
pub use settings::JerkLimit;
pub use settings::{AccelLimit, PathMode, PlannerSettings};
