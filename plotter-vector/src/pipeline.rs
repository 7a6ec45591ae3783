//! [`Vectorizer`]: the whole way from grey levels to pen strokes.

use crate::continuity::{Joined, join, link};
use crate::{
    Bitmap, Bounded, Drawing, DynamicThreshold, ErrorReport, ErrorTally, Figures, Gray, OrderedTracking,
    Pixel, PxPoint, Simplify, Split, Threshold, TooManyFigures, order,
};
use core::fmt;

/// Which vectorization.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Algorithm {
    /// Ordered tracking, pre-elimination and [`DynamicThreshold`], drawn in tracking order: as published.
    Published,
    /// Ordered tracking, lines made whole again, [`Bounded`], strokes ordered for little travel.
    #[default]
    Ours,
}

/// Settings of the whole way from a picture to strokes.
///
/// ```
/// use plotter_vector::{Bitmap, PxPoint, Vectorizer};
/// let ink = Bitmap::from_picture("#####\n#...#\n#...#\n#####\n")?;
/// let traced = Vectorizer::default().trace(&ink)?;
/// let corners = [(0.5, 0.5), (4.5, 0.5), (4.5, 3.5), (0.5, 3.5), (0.5, 0.5)];
/// assert_eq!(traced.drawing.stroke(0), corners.map(|(x, y)| PxPoint::new(x, y)));
/// assert_eq!(traced.error.max_px, 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vectorizer {
    /// Which vectorization.
    pub algorithm: Algorithm,
    /// How ink is told from paper.
    pub threshold: Threshold,
    /// How ink becomes figures.
    pub tracking: OrderedTracking,
    /// The published simplification.
    pub published: DynamicThreshold,
    /// Ours: its tolerance is the promise that no pixel lies farther from the segment that replaced it.
    pub ours: Bounded,
}

/// What the vectorization found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Vectorized {
    /// The strokes.
    pub drawing: Drawing,
    /// How far the pixels lie from them.
    pub error: ErrorReport,
    /// How ink was told from paper; `None` for an empty sheet, or for a picture that came as a bitmap.
    pub split: Option<Split>,
}

/// Most ink of a picture that is vectorized: 2²⁵ px, five times the lines of a dense A0 sheet at 300 dots per inch,
/// take 6 s and 0.9 GB.
pub const MAX_INK_PIXELS: u64 = 1 << 25;

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
        }
    }
}

impl core::error::Error for VectorizeError {}

impl Vectorizer {
    /// Vectorizes a picture. An empty sheet (one level, no contrast, no pixels) gives an empty drawing.
    ///
    /// # Errors
    /// [`VectorizeError`].
    pub fn vectorize(&self, gray: &Gray) -> Result<Vectorized, VectorizeError> {
        let (ink, split) = self.threshold.apply(gray);
        Ok(Vectorized { split, ..self.trace(&ink)? })
    }

    /// Vectorizes ink.
    ///
    /// # Errors
    /// [`VectorizeError`].
    pub fn trace(&self, ink: &Bitmap) -> Result<Vectorized, VectorizeError> {
        let tolerance_px = self.ours.tolerance_px;
        if self.algorithm == Algorithm::Ours && !(tolerance_px > 0.0 && tolerance_px.is_finite()) {
            return Err(VectorizeError::Tolerance { tolerance_px });
        }
        let ink_pixels = ink.count();
        if ink_pixels > MAX_INK_PIXELS {
            return Err(VectorizeError::TooMuchInk { ink_pixels });
        }
        let figures = self.tracking.track(ink).map_err(VectorizeError::TooManyFigures)?;
        Ok(match self.algorithm {
            Algorithm::Published => {
                let whole = |_| (false, false);
                simplify(ink, &figures, whole, &self.published)
            }
            Algorithm::Ours => {
                // Of a sheet full of ink each step's figures are large: none outlives its use.
                let linked = link(&figures);
                drop(figures);
                let Joined { figures, borrowed } = join(&linked, ink);
                drop(linked);
                let lent = |index: usize| borrowed.get(index).copied().unwrap_or_default();
                let traced = simplify(ink, &figures, lent, &self.ours);
                Vectorized { drawing: order(&traced.drawing), ..traced }
            }
        })
    }
}

/// A stroke of each figure, and the errors.
fn simplify(
    ink: &Bitmap,
    figures: &Figures,
    borrowed: impl Fn(usize) -> (bool, bool),
    algorithm: &impl Simplify,
) -> Vectorized {
    let mut drawing = Drawing::new(ink.width(), ink.height());
    let mut tally = ErrorTally::default();
    for (index, figure) in figures.iter().enumerate() {
        let kept = algorithm.keep(figure);
        tally.add(figure, &kept, borrowed(index));
        let vertex = |index: &usize| figure.get(*index).copied().map(|pixel: Pixel| PxPoint::from(pixel));
        drawing.push(kept.iter().filter_map(vertex));
    }
    Vectorized { drawing, error: tally.report(), split: None }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(algorithm: Algorithm, tolerance_px: f64) -> Vectorizer {
        Vectorizer { algorithm, ours: Bounded { tolerance_px }, ..Vectorizer::default() }
    }

    #[test]
    fn a_tolerance_that_is_no_distance_is_refused_by_ours_only() {
        let dot = Bitmap::from_picture("#").unwrap();
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = with(Algorithm::Ours, bad).trace(&dot).unwrap_err();
            assert_eq!(
                error.to_string(),
                format!("tolerance: {bad} px is not a positive number; 0.5 is half a pixel")
            );
            assert!(with(Algorithm::Published, bad).trace(&dot).is_ok());
        }
    }

    #[test]
    fn a_large_black_area_is_refused_before_memory_is_taken() {
        let (width, height) = (8192, 4097);
        let mut black = Bitmap::new(width, height).unwrap();
        (0..height).for_each(|y| black.row_mut(y).fill(u64::MAX));
        assert_eq!(
            Vectorizer::default().trace(&black).unwrap_err(),
            VectorizeError::TooMuchInk { ink_pixels: 8192 * 4097 }
        );
    }

    #[test]
    fn a_sheet_without_ink_gives_an_empty_drawing_of_its_size() {
        for (width, height) in [(0, 0), (0, 3), (1, 1), (3, 2)] {
            for level in [0, 255] {
                let levels = vec![level; (width * height) as usize];
                let traced =
                    Vectorizer::default().vectorize(&Gray::new(width, height, levels).unwrap()).unwrap();
                assert_eq!((traced.drawing.width_px(), traced.drawing.height_px()), (width, height));
                assert_eq!((traced.drawing.vertices(), traced.error.pixels, traced.split), (0, 0, None));
            }
        }
    }
}
