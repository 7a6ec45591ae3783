//! Pictures: pixels, levels and colours, whole and row by row, and the files they come in.
//!
//! Everything else is told what a picture is here: a [`Bitmap`] of ink and paper, a [`Gray`] of levels, rows
//! of either ([`BitmapRows`], [`GrayRows`]), and, with the feature `image`, a [`FileRows`] read from a file.

pub(crate) mod bitmap;
mod colour;
#[cfg(feature = "image")]
pub(crate) mod decode;
mod decode_error;
mod figures;
#[cfg(feature = "image")]
mod file_notes;
#[cfg(feature = "image")]
pub(crate) mod file_rows;
mod gray;
#[cfg(feature = "image")]
mod ground;
pub(crate) mod histogram;
pub(crate) mod joined_runs;
pub(crate) mod oklab;
#[cfg(feature = "image")]
mod orientation;
mod paper;
mod px_point;
#[cfg(feature = "image")]
mod resolution;
mod rows;
pub(crate) mod runs;

pub use bitmap::{Bitmap, MAX_PIXELS, MAX_SIDE_PX, Pixel, SizeError};
pub use colour::{Colour, ColourError, colour_on_white};
#[cfg(feature = "image")]
pub use decode::{decode, decode_colour, decode_page_in_colour};
pub use decode_error::{DecodeError, OtherFile};
pub use figures::Figures;
#[cfg(feature = "image")]
pub use file_notes::{FileFormat, FileNotes};
#[cfg(feature = "image")]
pub use file_rows::FileRows;
pub use gray::{Gray, GrayError, gray_on_white};
#[cfg(feature = "image")]
pub use ground::Ground;
pub use histogram::Histogram;
pub use oklab::{Oklab, Rgb, RgbError};
#[cfg(feature = "image")]
pub use orientation::Orientation;
pub use paper::{Homography, NoSheetQuad, SheetQuad, StraightSheet};
pub use px_point::{PxPoint, PxVec};
#[cfg(feature = "image")]
pub use resolution::{Resolution, ResolutionDoubt, ResolutionSource};
pub use rows::{BitmapRows, Depth, GrayRows, MAX_SHEET_ROWS, Row, RowSource};
