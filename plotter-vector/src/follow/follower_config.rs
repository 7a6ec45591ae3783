//! [`FollowerConfig`]: what a machine's file says of a camera beside its tool.

use plotter_motion::config::{Key, Section};

/// A camera beside the tool, and the tool's width: the table `[follower]` of a machine's file.
///
/// The defaults are a camera above the tool, which takes nothing away. With the feature `toml`,
/// `plotter_motion::Machine::from_toml_with` reads it beside the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
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

impl FollowerConfig {
    /// The same with another [`FollowerConfig::camera_x_mm`].
    #[must_use]
    pub const fn with_camera_x_mm(self, camera_x_mm: f64) -> Self {
        Self { camera_x_mm, ..self }
    }

    /// The same with another [`FollowerConfig::camera_y_mm`].
    #[must_use]
    pub const fn with_camera_y_mm(self, camera_y_mm: f64) -> Self {
        Self { camera_y_mm, ..self }
    }

    /// The same with another [`FollowerConfig::camera_turn_deg`].
    #[must_use]
    pub const fn with_camera_turn_deg(self, camera_turn_deg: f64) -> Self {
        Self { camera_turn_deg, ..self }
    }

    /// The same with another [`FollowerConfig::kerf_mm`].
    #[must_use]
    pub const fn with_kerf_mm(self, kerf_mm: f64) -> Self {
        Self { kerf_mm, ..self }
    }
}

/// Keys of the table.
static KEYS: [Key<FollowerConfig>; 4] = [
    Key::number(
        "follower.camera_x_mm",
        |c| c.camera_x_mm,
        (-1000.0, 1000.0),
        "mm",
        "0 if the camera looks at the tool's place",
    ),
    Key::number(
        "follower.camera_y_mm",
        |c| c.camera_y_mm,
        (-1000.0, 1000.0),
        "mm",
        "0 if the camera looks at the tool's place",
    ),
    Key::number(
        "follower.camera_turn_deg",
        |c| c.camera_turn_deg,
        (-180.0, 180.0),
        "deg",
        "0 if what lies to the right in its picture lies along x",
    ),
    Key::number(
        "follower.kerf_mm",
        |c| c.kerf_mm,
        (0.0, 50.0),
        "mm",
        "0 for a pen; a plasma torch takes 1 to 3",
    ),
];

impl Section for FollowerConfig {
    const NAME: &'static str = "follower";

    fn keys() -> &'static [Key<Self>] {
        &KEYS
    }
}
