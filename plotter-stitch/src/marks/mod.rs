//! The marks of a frame: where they may lie, so that no line of the drawing is taken for one, and the strokes
//! that draw them.

#[cfg(feature = "alloc")]
mod frame_ops;
#[cfg(feature = "alloc")]
mod pattern;
#[cfg(feature = "alloc")]
mod place;
#[cfg(feature = "alloc")]
mod reference_lines;
#[cfg(feature = "alloc")]
mod strip;

#[cfg(feature = "alloc")]
pub use frame_ops::frame_ops;
#[cfg(feature = "alloc")]
pub(crate) use place::ASTRAY_MM;
#[cfg(feature = "alloc")]
pub use place::{MarkError, MarkPlacer, PlacedMark};
#[cfg(feature = "alloc")]
pub use reference_lines::{LayoutError, MarkGroup, ReferenceLines};
#[cfg(feature = "alloc")]
pub use strip::DrawnStrip;

/// Most crossings of one joint.
pub const MOST_CROSSINGS: usize = 64;
