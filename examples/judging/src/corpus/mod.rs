//! Pictures of which every line is known, to judge a vectorization by: what `draw_corpus` draws.

mod junctions;
mod letters;
mod marks;
mod pictures;
pub(crate) mod random;
mod raster;
mod sheet;
pub(crate) mod strokes;
mod technical;
mod truth;

#[cfg(test)]
pub(crate) use junctions::of as junctions_of;
pub use pictures::all;
pub use sheet::{Sheet, Size};
pub use strokes::Picture;
pub use truth::{TrueLine, Truth, View};
