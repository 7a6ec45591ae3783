#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod bitmap;
mod continuity;
#[cfg(feature = "image")]
mod decode;
mod drawing;
mod error_chart;
mod error_report;
mod figures;
mod gray;
mod hpgl;
mod order;
mod pipeline;
mod pre_elimination;
mod simplify;
mod svg;
mod threshold;
mod tracking;

pub use bitmap::{Bitmap, MAX_PIXELS, MAX_SIDE_PX, Pixel, SizeError};
pub use continuity::{Joined, is_closed, join, link};
#[cfg(feature = "image")]
pub use decode::{DecodeError, decode};
pub use drawing::{Drawing, PxPoint, Scale, ScaleError};
pub use error_chart::error_chart;
pub use error_report::{Bin, ErrorReport, ErrorTally};
pub use figures::Figures;
pub use gray::{Gray, GrayError, gray_on_white};
pub use hpgl::hpgl;
pub use order::order;
pub use pipeline::{Algorithm, MAX_INK_PIXELS, VectorizeError, Vectorized, Vectorizer};
pub use pre_elimination::PreElimination;
pub use simplify::{Bounded, DynamicThreshold, MAX_REACH_PX, Simplify};
pub use svg::svg;
pub use threshold::{Polarity, Split, Threshold};
pub use tracking::{HISTORY, OrderedTracking, TooManyFigures};
