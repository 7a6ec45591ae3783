//! [`Field`]: where on the table the frames lie.

use plotter_motion::{Point, Vec2};

/// Marks lie beside the field, within this distance from it, mm: the source has its Y markers "outside the
/// frame zone", the head's start at about (-50, -50) from the frame.
pub(crate) const MARGIN_MM: f64 = 50.0;

/// The paper reaches at least this far beside the field, mm: beyond the marks, with what they may be drawn
/// askew.
pub(crate) const EDGE_BESIDE_MM: f64 = MARGIN_MM + 5.0;

/// The place of every frame on the table: a rectangle in the machine's coordinates, while the paper lies as
/// it should.
///
/// ```text
///        y ▲  the paper moves down, to the receiving roll
///          │      ┌─────────────────────────────┐ begin_mm + frame_mm
///          │  ══  │ │                         │ │  ══     │ X borders: the field's left and right line
///          │      │ │   frame about to be     │ │         ═ Y markers: beside the field, at its beginning and end
///          │      │ │   drawn                 │ │
///          │  ══  └─┼─────────────────────────┼─┘  ══  begin_mm
///          │        │   frame before          │
///          └────────┼─────────────────────────┼──────────▶ x
///                left_mm            left_mm + width_mm
/// ```
///
/// ```
/// # use plotter_motion::Point;
/// # use plotter_stitch::Field;
/// let field = Field { left_mm: 300.0, width_mm: 900.0, ..Field::default() };
/// assert_eq!(field.joint(), [Point::new(300.0, 20.0), Point::new(1200.0, 20.0)]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct Field {
    /// The machine's x at the left border, mm.
    pub left_mm: f64,
    /// From the left border to the right one, mm.
    pub width_mm: f64,
    /// The machine's y at which each frame begins, mm.
    pub begin_mm: f64,
    /// Length of a frame along the paper, mm: by how much the paper is moved at a time.
    pub frame_mm: f64,
}

impl Default for Field {
    /// The widest field of the documented textile plotter: its table is 2000 x 1000 mm, its head reaches 50
    /// mm farther on all sides, and there must see the paper's edges, 55 mm beside the field. The last 70 mm
    /// of the frame before stay in reach.
    fn default() -> Self {
        Self { left_mm: 10.0, width_mm: 1_980.0, begin_mm: 20.0, frame_mm: 950.0 }
    }
}

impl Field {
    /// From a frame's coordinates to its place on the table, mm.
    #[must_use]
    pub const fn corner(&self) -> Vec2 {
        Vec2::new(self.left_mm, self.begin_mm)
    }

    /// The machine's x at the right border, mm.
    #[must_use]
    pub fn right_mm(&self) -> f64 {
        self.left_mm + self.width_mm
    }

    /// Both ends of the border where frames meet: the frame's beginning from left to right, mm.
    #[must_use]
    pub fn joint(&self) -> [Point; 2] {
        [self.left_mm, self.right_mm()].map(|x_mm| Point::new(x_mm, self.begin_mm))
    }
}
