//! [`VectorizeError`]: why a picture cannot be vectorized.

use crate::areas::AreaError;
use crate::ink::PensError;
use crate::raster::TooManyFigures;
use crate::trace::{Cancelled, MAX_INK_PIXELS};
use core::fmt;

/// Why a picture cannot be vectorized.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum VectorizeError {
    /// The promised error is no distance.
    Tolerance {
        /// What was asked, px.
        tolerance_px: f64,
    },
    /// The picture has more ink than [`MAX_INK_PIXELS`]: it is no line drawing.
    TooMuchInk {
        /// Ink of the picture, px.
        ink_pixels: u64,
    },
    /// The picture is noise.
    TooManyFigures(TooManyFigures),
    /// The style of the areas cannot be drawn.
    Areas(AreaError),
    /// There are no such pens.
    Pens(PensError),
    /// The one who asked for it stopped it.
    Cancelled(Cancelled),
}

impl fmt::Display for VectorizeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tolerance { tolerance_px } => {
                write!(f, "tolerance: {tolerance_px} px is not a positive number; 0.5 is half a pixel")
            }
            Self::TooMuchInk { ink_pixels } => write!(
                f,
                "{ink_pixels} px of ink where a line drawing has at most {MAX_INK_PIXELS}: set the threshold level by \
                 hand, scan with fewer dots per inch, or cut the picture into sheets"
            ),
            Self::TooManyFigures(error) => error.fmt(f),
            Self::Areas(error) => error.fmt(f),
            Self::Pens(error) => error.fmt(f),
            Self::Cancelled(error) => error.fmt(f),
        }
    }
}

impl From<Cancelled> for VectorizeError {
    fn from(error: Cancelled) -> Self {
        Self::Cancelled(error)
    }
}

impl core::error::Error for VectorizeError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::TooManyFigures(error) => Some(error),
            Self::Areas(error) => Some(error),
            Self::Pens(error) => Some(error),
            Self::Cancelled(error) => Some(error),
            _ => None,
        }
    }
}
