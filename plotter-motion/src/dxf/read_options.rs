//! [`ReadOptions`]: what a file does not say itself.

use crate::Vec2;

/// The property of the DXF that chooses the pen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Pens {
    /// Each layer, in the order in which they draw. Beyond the 255th, layers share the last pen.
    #[default]
    ByLayer,
    /// Each layer, by the number that its name begins with; pen 1 where there is none.
    ByLayerNumber,
    /// Each colour, in the order in which they draw.
    ByColour,
}

/// How a drawing is put on the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct ReadOptions {
    /// Farthest that lines may be from the curves that they stand for, mm; above 0.
    pub tolerance_mm: f64,
    /// Size of a unit of the drawing, mm; `None` takes what the file says (`$INSUNITS`), or a millimetre, and
    /// tells so.
    pub unit_mm: Option<f64>,
    /// By how much all is moved, mm.
    pub moved_mm: Vec2,
    /// The property of the DXF that chooses the pen.
    pub pens: Pens,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self { tolerance_mm: 0.01, unit_mm: None, moved_mm: Vec2::new(0.0, 0.0), pens: Pens::ByLayer }
    }
}
