//! [`MappingSettings`] and [`FollowReport`]: what ours is told, and what it tells.

use super::Correction;
use crate::stroke::PxPoint;

/// What the follower is told; everything else it finds out.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct MappingSettings {
    /// What the machine can reach, as commanded places: the upper left and the lower right corner. Without it, it follows anywhere,
    /// and looks only where lines lead.
    pub area: Option<[PxPoint; 2]>,
    /// Whether all of the area is looked at, for lines that no other one leads to.
    pub search: bool,
    /// The way between two pictures while a line is followed, px: the table's error on it is what the tool is off.
    pub step_px: f64,
    /// What is wider is an area, and left out, px.
    pub max_line_px: u32,
    /// How many pictures in a row may show no line where one should be.
    pub max_tries: u32,
    /// How many windows may be seen in all.
    pub max_windows: u64,
    /// The correction of the lens.
    pub correction: Option<Correction>,
}

impl MappingSettings {
    /// The same with another [`MappingSettings::area`].
    #[must_use]
    pub fn with_area(self, area: Option<[PxPoint; 2]>) -> Self {
        Self { area, ..self }
    }

    /// The same with another [`MappingSettings::search`].
    #[must_use]
    pub fn with_search(self, search: bool) -> Self {
        Self { search, ..self }
    }

    /// The same with another [`MappingSettings::step_px`].
    #[must_use]
    pub fn with_step_px(self, step_px: f64) -> Self {
        Self { step_px, ..self }
    }

    /// The same with another [`MappingSettings::max_line_px`].
    #[must_use]
    pub fn with_max_line_px(self, max_line_px: u32) -> Self {
        Self { max_line_px, ..self }
    }

    /// The same with another [`MappingSettings::max_tries`].
    #[must_use]
    pub fn with_max_tries(self, max_tries: u32) -> Self {
        Self { max_tries, ..self }
    }

    /// The same with another [`MappingSettings::max_windows`].
    #[must_use]
    pub fn with_max_windows(self, max_windows: u64) -> Self {
        Self { max_windows, ..self }
    }

    /// The same with another [`MappingSettings::correction`].
    #[must_use]
    pub fn with_correction(self, correction: Option<Correction>) -> Self {
        Self { correction, ..self }
    }
}

impl Default for MappingSettings {
    /// Anywhere, pictures 2 px apart (a web camera's 30 a second are then 60 px/s), lines up to 40 px wide, 8 tries, 2 million
    /// windows, a lens without distortion.
    fn default() -> Self {
        Self {
            area: None,
            search: true,
            step_px: 1.5,
            max_line_px: 40,
            max_tries: 8,
            max_windows: 2_000_000,
            correction: None,
        }
    }
}

/// What was seen and followed.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FollowReport {
    /// Windows looked at.
    pub windows: u64,
    /// Moves asked for.
    pub moves: u64,
    /// How often the tool was lifted between two lines.
    pub lifts: u64,
    /// Length of the lines seen, px.
    pub seen_px: f64,
    /// Length of the lines followed, px.
    pub followed_px: f64,
    /// Length of the lines that could not be followed, px: lost, or given up.
    pub given_up_px: f64,
    /// Length of the lines seen outside of the area, px.
    pub outside_px: f64,
    /// Where lines leave the area.
    pub leaves: Vec<PxPoint>,
    /// Where there are areas of ink, which are not followed.
    pub areas: Vec<PxPoint>,
    /// Width of the lines, px.
    pub line_width_px: f64,
    /// Play that was found in x and y, px.
    pub play_px: [f64; 2],
}
