//! Lines one pixel wide: thinned from wider ones, followed from pixel to pixel, and joined where they pass
//! on.
//!
//! This is how the published vectorizer sees a drawing.

pub(crate) mod continuity;
pub(crate) mod cut_at_turns;
pub(crate) mod raster_corner;
pub(crate) mod straight_on;
mod thinning;
mod tracking;

pub use continuity::is_closed;
pub use thinning::{Thinned, Thinning, ThinningMethod, ThinningProgress};
pub use tracking::{OrderedTracking, TooManyFigures};

#[cfg(test)]
mod prop_tests;
