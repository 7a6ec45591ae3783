//! Line following: a camera sees a small window of a drawing, and a machine takes it along every line.
//!
//! A camera and a tool on one carriage stand over a drawing larger than what the camera sees. A [`LineFollower`] gets one window
//! after the other, and says how to move; it owns no camera, motor or clock. The camera blurs, distorts and is lit
//! unevenly, and the table never stands quite where it was sent.
//!
//! ```text
//!   drawing                     window             the follower's answer
//!   ┌──────────────────┐        ┌────────┐
//!   │   ╭─────╮ ┌────┐ │        │   ╱    │         Step::Move { path, tool }   go there, take a picture
//!   │   │     │ │ ╱  │ │  ──►   │  ╱     │  ──►    Step::LineLost { .. }       take another picture
//!   │   ╰─────┼─┼╱   │ │        │ +      │         Step::Done { .. }           the end, and why
//!   │         │ └────┘ │        │  ╲     │
//!   └─────────╯────────┘        └────────┘
//! ```
//!
//! Two followers stand side by side. [`PublishedFollower`] is that of C. Ekholm's thesis (Kajaani, 2005): circles around
//! the current place, and always the same hand. [`MappingFollower`] is ours: it keeps a map of the lines that it saw, knows from it
//! where it truly is, and follows each line once.
//!
//! Places are in pixels of the camera on the paper, x to the right, y **down**. The simulators of the camera
//! ([`SimulatedCamera`]) and of the table ([`SimulatedTable`]) belong to it, and [`judge`] says how well a line was followed.

mod align;
mod axes;
mod bends;
mod calibration;
mod camera;
mod centred;
mod circle;
mod corners;
mod crowd;
mod ends;
mod exits;
mod explored;
mod flat;
mod follower_config;
mod ink_map;
mod judge;
mod keyframe;
mod lag;
mod lens;
mod line_map;
mod lines;
mod loops;
mod mapping;
mod mapping_settings;
mod paper;
mod play;
mod poses;
mod prior;
mod profile;
mod published;
mod random;
mod registration;
mod ribbons;
mod search;
mod seated;
mod stiff;
mod table;
mod tips;
mod trail;
mod whole;

pub use calibration::{CalibrationError, Correction};
pub use camera::{CameraSettings, SimulatedCamera};
pub use exits::connected_exits;
pub use follower_config::FollowerConfig;
pub use judge::{Judged, Route, judge};
pub use lens::Lens;
pub use mapping::MappingFollower;
pub use mapping_settings::{FollowReport, MappingSettings};
pub use paper::Paper;
pub use published::{Hand, PixelScale, PublishedFollower, PublishedSettings, merged};
pub use table::{ERROR_WAY_PX, SimulatedTable, TableError};

use crate::{picture::Gray, stroke::PxPoint};
use core::fmt;

/// Whether the tool (pen, torch) works or is lifted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Tool {
    /// Lifted: nothing is drawn or cut.
    #[default]
    Up,
    /// At work.
    Down,
}

/// What to do next.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Move straight from place to place (as the machine commands them), then take a picture.
    Move {
        /// The places; an empty path asks for a picture from here.
        path: Vec<PxPoint>,
        /// Whether the tool works on the way.
        tool: Tool,
    },
    /// There is no line where one should be: take another picture from here.
    LineLost {
        /// Where the machine believes to be.
        at: PxPoint,
        /// How many pictures in a row showed none.
        tries: u32,
        /// What the picture shows instead.
        why: Lost,
    },
    /// Nothing more to do. Asked again, the answer stays the same.
    Done(End),
}

/// Why no line is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Lost {
    /// The window has one colour: white paper, a covered lens, no light; or what is on it is hardly darker than the paper.
    OneColour,
    /// There is something, but no line: an area, or a line thicker than the window shows.
    TooThick,
    /// There are lines, but not those that should be here: paper or table were moved.
    Elsewhere,
    /// The window is not of the size that it was at first, or too small a side: of [`MappingFollower::LEAST_WINDOW_PX`] for ours, of
    /// 16 px for the published follower.
    WindowSize,
}

/// Why it ended.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum End {
    /// All lines that were seen, and can be reached, were followed.
    Complete,
    /// No line came into view in as many pictures as were allowed.
    NoLine {
        /// Where the machine believes to be.
        at: PxPoint,
        /// What the last picture showed.
        why: Lost,
    },
    /// As many windows as were allowed have been seen.
    WindowLimit {
        /// Where the machine believes to be.
        at: PxPoint,
    },
}

impl fmt::Display for Lost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::OneColour => "the window has one colour, or lines that are hardly darker than the paper: is there light, and is the lens free?",
            Self::TooThick => "what is seen is no line but an area, or a line too thick for the window",
            Self::Elsewhere => "the lines seen are not those that should be here: the place was lost, or the paper was moved",
            Self::WindowSize => "the window has another size than before, or too few px a side: the camera has to see more of the paper",
        })
    }
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Complete => f.write_str("every line that can be reached was followed"),
            Self::NoLine { at, why } => write!(f, "no line in view at ({:.1}, {:.1}) px: {why}", at.x, at.y),
            Self::WindowLimit { at } => {
                write!(f, "as many windows as allowed were seen; stopped at ({:.1}, {:.1}) px", at.x, at.y)
            }
        }
    }
}

/// Follows lines, window by window.
pub trait LineFollower {
    /// Takes the window that the camera saw with its middle where the machine believes to be (`pose`), after
    /// the moves that were asked for last.
    fn observe(&mut self, window: &Gray, pose: PxPoint) -> Step;
}
