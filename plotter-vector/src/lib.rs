#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![cfg_attr(docsrs, feature(doc_cfg))]

mod disjoint_sets;
mod parallel;

pub mod areas;
mod centreline;
pub mod follow;
pub mod ink;
pub mod order;
pub mod picture;
pub mod raster;
pub mod report;
pub mod stroke;
#[cfg(feature = "svg-in")]
pub mod svg_in;
pub mod trace;
pub mod write;

pub use ink::{Palette, Threshold, ThresholdMethod};
pub use order::{Order, order};
pub use picture::{Bitmap, Colour, DecodeError, Gray, Pixel, PxPoint, PxVec, Rgb};
#[cfg(feature = "image")]
pub use picture::{FileRows, decode, decode_colour};
pub use plotter_motion;
pub use report::ErrorReport;
pub use stroke::{Curve, Drawing, Scale};
#[cfg(feature = "svg-in")]
pub use svg_in::{SvgOptions, read_svg};
pub use trace::{Mode, Ours, Prefer, Progress, TracedSheet, VectorizeError, Vectorized, Vectorizer};
pub use write::{gcode, hpgl, svg};
