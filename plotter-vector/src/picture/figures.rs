//! [`Figures`]: chains of pixels in the order in which they were followed.

use crate::picture::Pixel;

/// Chains of pixels, one after another in one piece of memory: a page of a million dots costs no more than
/// its pixels.
///
/// ```
/// # use plotter_vector::{Pixel, picture::Figures};
/// let mut figures = Figures::default();
/// figures.push([Pixel::new(0, 0), Pixel::new(1, 0)]);
/// figures.push([Pixel::new(5, 5)]);
/// assert_eq!(figures.len(), 2);
/// assert_eq!(figures.get(1), [Pixel::new(5, 5)]);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Figures {
    pixels: Vec<Pixel>,
    /// One past the last pixel of each figure.
    ends: Vec<usize>,
}

impl Figures {
    /// Adds a figure; one without pixels is left out.
    pub fn push(&mut self, pixels: impl IntoIterator<Item = Pixel>) {
        let before = self.pixels.len();
        self.pixels.extend(pixels);
        if self.pixels.len() > before {
            self.ends.push(self.pixels.len());
        }
    }

    /// Adds pixels to the last figure, or starts the first one.
    pub(crate) fn extend_last(&mut self, pixels: &[Pixel]) {
        self.ends.pop();
        self.pixels.extend_from_slice(pixels);
        self.ends.push(self.pixels.len());
    }

    /// The last pixel of the last figure.
    pub(crate) fn last_pixel(&self) -> Option<Pixel> {
        self.pixels.last().copied()
    }

    /// Number of figures.
    #[must_use]
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there is no figure.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Number of pixels of all figures.
    #[must_use]
    pub fn pixel_count(&self) -> usize {
        self.pixels.len()
    }

    /// The pixels of one figure, in order; empty when there is no such figure.
    #[must_use]
    pub fn get(&self, index: usize) -> &[Pixel] {
        let start = index.checked_sub(1).map_or(Some(0), |before| self.ends.get(before).copied());
        let end = self.ends.get(index).copied();
        start.zip(end).and_then(|(start, end)| self.pixels.get(start..end)).unwrap_or(&[])
    }

    /// The figures in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[Pixel]> + DoubleEndedIterator {
        (0..self.len()).map(|index| self.get(index))
    }
}
