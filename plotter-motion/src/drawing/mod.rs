//! [`Drawing`]: strokes, read from any language or picture, changed, and written to any language.
//!
//! ```text
//! HPGL, G-code, DXF, cutters ──▶ PlotOp ──▶ Drawing ──▶ PlotOp ──▶ planner, writers
//! SVG, traced pictures ───────────────────▶    │
//!                                   placed, cropped, ordered, hatched, …
//! ```
//!
//! A stroke is drawn without lifting the pen: lines, arcs and cubic curves, each with its speed and power. It
//! has a pen, a layer, and operations before it, such as a dwell or a new sheet. Travel is not part of a
//! drawing.
//!
//! [`Drawing::crop`] and [`Drawing::crop_to_rectangle`] cut a drawing to a [`Region`] or a rectangle.
//! [`Drawing::occlude`] removes the parts that later closed strokes hide, and [`Drawing::hatch`] fills closed
//! strokes with lines. Arcs remain arcs, and curves remain curves.
//!
//! ```
//! use plotter_motion::{gcode, hpgl, drawing::{Affine, Drawing}};
//!
//! let mut drawing: Drawing = hpgl::plot_ops(b"IN;SP1;PU0,0;PD400,0,400,400;PU;").filter_map(Result::ok).collect();
//! drawing.map(&Affine::scaled(2.0, 2.0));
//! assert_eq!((drawing.strokes.len(), drawing.length_mm()), (1, 40.0));
//! let mut text = String::new();
//! gcode::write_ops(drawing.ops(0.01), &mut text)?;
//! assert!(text.contains("G1 X20 Y0"));
//! # Ok::<(), gcode::WriteError>(())
//! ```
//!
//! Three methods make a drawing shorter: [`Drawing::drop_doubles`] removes lines drawn twice,
//! [`Drawing::fit_arcs`] makes arcs of lines that lie on a circle, and [`Drawing::simplify`] removes
//! vertices. Called in this order, each finds most.

pub(crate) mod affine;
mod arcs;
mod bounds;
mod boxes;
mod crop;
mod doubles;
#[cfg(any(feature = "kurbo", feature = "mint"))]
mod foreign;
mod hatch;
mod ink;
mod occlude;
mod ops;
mod place;
mod region;
mod remains;
pub(crate) mod scan;
mod segment;
mod simplify;
mod stroke;
mod written;

pub use affine::Affine;
pub use bounds::Bounds;
pub use doubles::Doubles;
pub use hatch::{HatchError, HatchTogether, Hatching};
pub use occlude::Hides;
pub use ops::DrawingBuilder;
pub use place::{Placement, PlacementError};
pub use region::{Keep, Region};
pub use remains::CutCount;
pub use segment::{PathSegment, Shape};
pub use stroke::{Mark, Stroke};
#[cfg(feature = "std")]
pub use written::IoText;

use crate::Point;
use alloc::collections::BTreeSet;
use alloc::string::String;
use alloc::vec::Vec;

/// Strokes in the order in which they are drawn.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "Parts"))]
pub struct Drawing {
    /// The strokes.
    pub strokes: Vec<Stroke>,
    /// Operations after the last stroke.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub after: Vec<Mark>,
    /// Names of the layers; layer 1 is the first of them.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub layers: Vec<String>,
}

impl Drawing {
    /// A drawing without strokes.
    #[must_use]
    pub const fn new() -> Self {
        Self { strokes: Vec::new(), after: Vec::new(), layers: Vec::new() }
    }

    /// Length of all strokes, mm.
    #[must_use]
    pub fn length_mm(&self) -> f64 {
        self.strokes.iter().map(Stroke::length_mm).sum()
    }

    /// Length of travel between strokes, mm, with the way from the origin to the first.
    #[must_use]
    pub fn travel_mm(&self) -> f64 {
        let mut at = Point::ORIGIN;
        let way = |stroke: &Stroke| core::mem::replace(&mut at, stroke.to()).distance(stroke.from);
        self.strokes.iter().map(way).sum()
    }

    /// All segments, each with its stroke and its start.
    pub fn segments(&self) -> impl Iterator<Item = (&Stroke, Point, &PathSegment)> {
        self.strokes
            .iter()
            .flat_map(|stroke| stroke.segments().map(move |(from, segment)| (stroke, from, segment)))
    }

    /// The box around all strokes.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        let mut bounds = Bounds::default();
        self.strokes.iter().for_each(|stroke| bounds.join(&stroke.bounds()));
        bounds
    }

    /// Moves, turns, scales or mirrors the drawing.
    pub fn map(&mut self, map: &Affine) {
        for stroke in &mut self.strokes {
            *stroke = stroke.mapped(map);
        }
    }

    /// Reverses the order and the direction of all strokes. Operations before a stroke stay before it.
    pub fn reverse(&mut self) {
        self.strokes.reverse();
        self.strokes.iter_mut().for_each(Stroke::reverse);
    }

    /// The pens that draw something, in rising order.
    #[must_use]
    pub fn pens(&self) -> BTreeSet<u8> {
        self.strokes.iter().map(|stroke| stroke.pen).collect()
    }

    /// The strokes of one pen.
    #[must_use]
    pub fn of_pen(&self, pen: u8) -> Self {
        self.only(|stroke| stroke.pen == pen)
    }

    /// The strokes of one layer, by its number.
    #[must_use]
    pub fn of_layer(&self, layer: u32) -> Self {
        self.only(|stroke| stroke.layer == layer)
    }

    /// Leaves out the strokes before the first one of a layer, to go on with a drawing from there; says how
    /// many. `None`, and nothing is left out, if nothing is on that layer. Each stroke that remains has its
    /// own pen and power. From an operation on,
    /// [`ModalState`](crate::toolpath::ModalState) tells what holds there.
    ///
    /// ```
    /// use plotter_motion::{Point, drawing::{Drawing, Stroke}};
    /// let on = |layer: u32| {
    ///     let y = f64::from(layer);
    ///     Stroke { layer, ..Stroke::through([Point::new(0.0, y), Point::new(9.0, y)]).unwrap() }
    /// };
    /// let mut drawing: Drawing = [on(1), on(1), on(2), on(1)].into_iter().collect();
    /// assert_eq!((drawing.begin_at_layer(3), drawing.begin_at_layer(2)), (None, Some(2)));
    /// assert_eq!(drawing.strokes, [on(2), on(1)]);
    /// ```
    pub fn begin_at_layer(&mut self, layer: u32) -> Option<usize> {
        let first = self.strokes.iter().position(|stroke| stroke.layer == layer)?;
        self.strokes.drain(..first);
        Some(first)
    }

    /// The strokes that `wanted` selects.
    #[must_use]
    pub fn only(&self, mut wanted: impl FnMut(&Stroke) -> bool) -> Self {
        let strokes = self.strokes.iter().filter(|stroke| wanted(stroke)).cloned().collect();
        Self { strokes, after: self.after.clone(), layers: self.layers.clone() }
    }

    /// Checks that each stroke has a segment, finite numbers, no arc of more than a turn, and a layer with a
    /// name.
    ///
    /// # Errors
    ///
    /// The first stroke that is not sound.
    pub fn check(&self) -> Result<(), UnsoundDrawing> {
        let is_known = |layer: u32| usize::try_from(layer).is_ok_and(|layer| layer <= self.layers.len());
        let wrong = self.strokes.iter().position(|stroke| !stroke.is_sound() || !is_known(stroke.layer));
        wrong.map_or(Ok(()), |stroke| Err(UnsoundDrawing { stroke }))
    }
}

impl FromIterator<Stroke> for Drawing {
    fn from_iter<I: IntoIterator<Item = Stroke>>(strokes: I) -> Self {
        Self { strokes: strokes.into_iter().collect(), ..Self::new() }
    }
}

/// A stroke that cannot be drawn: see [`Drawing::check`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnsoundDrawing {
    /// Number of the stroke, from 0.
    pub stroke: usize,
}

impl core::fmt::Display for UnsoundDrawing {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "stroke {} has no segment, a number that is none, an arc of more than a turn, or a layer without a name",
            self.stroke
        )
    }
}

impl core::error::Error for UnsoundDrawing {}

/// A drawing as it is deserialized, before it is checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct Parts {
    strokes: Vec<Stroke>,
    #[serde(default)]
    after: Vec<Mark>,
    #[serde(default)]
    layers: Vec<String>,
}

#[cfg(feature = "serde")]
impl TryFrom<Parts> for Drawing {
    type Error = UnsoundDrawing;

    fn try_from(Parts { strokes, after, layers }: Parts) -> Result<Self, UnsoundDrawing> {
        let drawing = Self { strokes, after, layers };
        drawing.check().map(|()| drawing)
    }
}
