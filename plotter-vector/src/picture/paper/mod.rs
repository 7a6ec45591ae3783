//! A sheet of paper in a photograph: its four sides ([`SheetQuad`]), and the sheet as if it were looked at from
//! straight above ([`StraightSheet`]).
//!
//! ```text
//!     levels ─▶ coarse, lines closed ─▶ edges, light inside ─▶ straight lines (Hough) ─▶ four of them that
//!                                                                                        hold a light sheet
//!     picture's levels along the four sides ─▶ lines to parts of a pixel ─▶ corners ─▶ proportion, map
//! ```

mod coarse;
mod edge_lines;
mod homography;
mod proportion;
mod quad;
mod side_fit;
mod straight;

pub use homography::Homography;
pub use quad::{NoSheetQuad, SheetQuad};
pub use straight::StraightSheet;
