//! [`FollowerConfig`]: what a machine has that follows lines with a camera beside its tool.

use super::rules::{Rule, number};

/// A camera beside the tool, and the tool's width: the table `[follower]` of a machine's file.
///
/// The defaults are a camera above the tool, which takes nothing away.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct FollowerConfig {
    /// How far right of the tool the camera looks, mm.
    pub camera_x_mm: f64,
    /// How far above the tool on the sheet it looks, mm.
    pub camera_y_mm: f64,
    /// By how much the camera is turned against the machine, degrees, counterclockwise as seen from above:
    /// what lies to the right in its picture lies so far round from x on the sheet.
    pub camera_turn_deg: f64,
    /// Width of what the tool cuts away, mm: it goes half of it beside the line, on the right of its way.
    pub kerf_mm: f64,
}

/// Keys of the table.
pub(super) static RULES: [Rule; 4] = [
    number(
        "follower.camera_x_mm",
        |c| c.follower.camera_x_mm,
        (-1000.0, 1000.0),
        "mm",
        "0 if the camera looks at the tool's place",
    ),
    number(
        "follower.camera_y_mm",
        |c| c.follower.camera_y_mm,
        (-1000.0, 1000.0),
        "mm",
        "0 if the camera looks at the tool's place",
    ),
    number(
        "follower.camera_turn_deg",
        |c| c.follower.camera_turn_deg,
        (-180.0, 180.0),
        "deg",
        "0 if what lies to the right in its picture lies along x",
    ),
    number(
        "follower.kerf_mm",
        |c| c.follower.kerf_mm,
        (0.0, 50.0),
        "mm",
        "0 for a pen; a plasma torch takes 1 to 3",
    ),
];
