//! [`ErrorReport`]: how far the pixels lie from the segments that replaced them.

use crate::picture::Pixel;
use crate::stroke::simplify::segment_distance_squared;

/// Width of the histogram's bins to begin with, px; the publication's graph has the same.
const BIN_PX: f64 = 0.125;

/// Most bins: when an error lies beyond, neighbouring bins are merged.
const MAX_BINS: usize = 64;

/// One bar of the distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Bin {
    /// Errors from here on, px.
    pub from_px: f64,
    /// Errors below this, px.
    pub to_px: f64,
    /// Number of pixels.
    pub pixels: u64,
    /// Share of all pixels, percent.
    pub percent: f64,
}

/// The distance of every pixel from the segment that replaced it, px.
///
/// Only the pixels of the figures count, each once; a pixel that became a vertex has the error 0. The
/// distance is that to the *segment*: |A·x + B·y + C| / √(A² + B²) beside it, and the distance to its end
/// beyond.
///
/// Source: Öcal's thesis on a two-axis gantry, section 3.4, eq. 3.5.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ErrorReport {
    /// Number of pixels.
    pub pixels: u64,
    /// Mean error, px; 0 without pixels.
    pub mean_px: f64,
    /// Greatest error, px.
    pub max_px: f64,
    /// Standard deviation of the error (of all pixels, not of a sample), px.
    pub sd_px: f64,
    /// Distribution, from 0 up to the greatest error; bins of equal width without a gap.
    pub histogram: Vec<Bin>,
}

/// One line, as *of 120 pixels: mean 0.121, at most 0.482, standard deviation 0.098 px*.
impl core::fmt::Display for ErrorReport {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { pixels, mean_px, max_px, sd_px, .. } = self;
        write!(
            f,
            "of {pixels} pixels: mean {mean_px:.3}, at most {max_px:.3}, standard deviation {sd_px:.3} px"
        )
    }
}

/// Adds up errors, figure by figure; memory does not grow with the drawing.
///
/// ```
/// # use plotter_vector::{Pixel, report::ErrorTally};
/// let hat = [Pixel::new(0, 0), Pixel::new(1, 1), Pixel::new(2, 0)];
/// let mut tally = ErrorTally::default();
/// tally.add(&hat, &[0, 2], (false, false)); // drawn as one level line
/// let report = tally.report();
/// assert_eq!((report.pixels, report.max_px), (3, 1.0));
/// assert_eq!(report.mean_px, 1.0 / 3.0);
/// assert_eq!(report.to_string(), "of 3 pixels: mean 0.333, at most 1.000, standard deviation 0.471 px");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorTally {
    pixels: u64,
    sum: f64,
    squares: f64,
    max: f64,
    bin_px: f64,
    bins: Vec<u64>,
    worst: Option<(Pixel, f64)>,
}

impl Default for ErrorTally {
    fn default() -> Self {
        Self { pixels: 0, sum: 0.0, squares: 0.0, max: 0.0, bin_px: BIN_PX, bins: Vec::new(), worst: None }
    }
}

impl ErrorTally {
    /// Adds a figure and the indices of the pixels that became vertices, rising; `borrowed` says whether the
    /// first and the last pixel belong to another line and do not count.
    pub fn add(&mut self, figure: &[Pixel], kept: &[usize], borrowed: (bool, bool)) {
        self.add_those(figure, kept, borrowed, |_| true);
    }

    /// The same of those pixels that count.
    pub(crate) fn add_those(
        &mut self,
        figure: &[Pixel],
        kept: &[usize],
        borrowed: (bool, bool),
        mut counts: impl FnMut(Pixel) -> bool,
    ) {
        let own = usize::from(borrowed.0)..figure.len() - usize::from(borrowed.1).min(figure.len());
        for vertex in kept.iter().filter(|index| own.contains(index)) {
            if let Some(pixel) = figure.get(*vertex)
                && counts(*pixel)
            {
                self.add_pixel(*pixel, 0.0);
            }
        }
        for pair in kept.windows(2) {
            let [start, end] = pair else { continue };
            let (Some(from), Some(to)) = (figure.get(*start), figure.get(*end)) else { continue };
            for pixel in figure.get(start + 1..*end).unwrap_or(&[]) {
                if counts(*pixel) {
                    self.add_pixel(*pixel, libm::sqrt(segment_distance_squared(*pixel, *from, *to)));
                }
            }
        }
    }

    pub(crate) fn add_pixel(&mut self, at: Pixel, error_px: f64) {
        self.add_error(error_px);
        self.note_worst(at, error_px);
    }

    /// A pixel whose error was added by itself may be the worst one.
    pub(crate) fn note_worst(&mut self, at: Pixel, error_px: f64) {
        let is_worse = |(most, most_px): (Pixel, f64)| {
            error_px > most_px || error_px >= most_px && (at.y, at.x) < (most.y, most.x)
        };
        if self.worst.is_none_or(is_worse) {
            self.worst = Some((at, error_px));
        }
    }

    /// The pixel with the greatest error, the first of several in reading order, and its error, px; none
    /// without pixels.
    ///
    /// ```
    /// # use plotter_vector::{Pixel, report::ErrorTally};
    /// let roof = [Pixel::new(0, 3), Pixel::new(1, 2), Pixel::new(2, 1), Pixel::new(3, 2), Pixel::new(4, 3)];
    /// let mut tally = ErrorTally::default();
    /// tally.add(&roof, &[0, 4], (false, false)); // drawn as one level line
    /// assert_eq!(tally.worst(), Some((Pixel::new(2, 1), 2.0)));
    /// ```
    #[must_use]
    pub fn worst(&self) -> Option<(Pixel, f64)> {
        self.worst
    }

    pub(crate) fn add_error(&mut self, error_px: f64) {
        self.pixels += 1;
        self.sum += error_px;
        self.squares += error_px * error_px;
        self.max = self.max.max(error_px);
        let mut bin = self.bin_of(error_px);
        while bin >= MAX_BINS {
            self.bin_px *= 2.0;
            self.bins = self.bins.chunks(2).map(|pair| pair.iter().sum()).collect();
            bin = self.bin_of(error_px);
        }
        if bin >= self.bins.len() {
            self.bins.resize(bin + 1, 0);
        }
        if let Some(count) = self.bins.get_mut(bin) {
            *count += 1;
        }
    }

    /// Adds so many pixels without an error.
    pub(crate) fn add_exact(&mut self, pixels: u64) {
        let Some(others) = pixels.checked_sub(1) else { return };
        self.add_error(0.0);
        self.pixels += others;
        if let Some(first) = self.bins.first_mut() {
            *first += others;
        }
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a float cast saturates; not negative"
    )]
    fn bin_of(&self, error_px: f64) -> usize {
        libm::floor(error_px / self.bin_px) as usize
    }

    /// The figures so far.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "counts of pixels, far below 2^53")]
    pub fn report(&self) -> ErrorReport {
        let count = (self.pixels as f64).max(1.0);
        let mean_px = self.sum / count;
        let sd_px = libm::sqrt((self.squares / count - mean_px * mean_px).max(0.0));
        let bar = |(index, pixels): (usize, &u64)| Bin {
            from_px: index as f64 * self.bin_px,
            to_px: (index + 1) as f64 * self.bin_px,
            pixels: *pixels,
            percent: 100.0 * *pixels as f64 / count,
        };
        let histogram = self.bins.iter().enumerate().map(bar).collect();
        ErrorReport { pixels: self.pixels, mean_px, max_px: self.max, sd_px, histogram }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One rounding of the sums below.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn nothing_has_no_error() {
        let report = ErrorTally::default().report();
        assert_eq!(report, ErrorReport::default());
    }

    #[test]
    fn mean_and_deviation_are_those_of_the_book() {
        // Errors 0, 2, 4, 2, 0 over a level base: mean 1.6, sd sqrt(24/5 - 2.56).
        let hat: Vec<Pixel> = (0..).zip([0, 2, 4, 2, 0]).map(|(x, y)| Pixel::new(x, y)).collect();
        let mut tally = ErrorTally::default();
        tally.add(&hat, &[0, 4], (false, false));
        let report = tally.report();
        assert!((report.mean_px - 1.6).abs() < ROUNDING);
        assert!((report.sd_px - libm::sqrt(2.24)).abs() < ROUNDING);
        assert_eq!(report.max_px, 4.0);
        let filled: Vec<_> = report
            .histogram
            .iter()
            .filter(|bin| bin.pixels > 0)
            .map(|bin| (bin.from_px, bin.percent))
            .collect();
        assert_eq!(filled, [(0.0, 40.0), (2.0, 40.0), (4.0, 20.0)]);
    }

    #[test]
    fn a_pixel_beyond_the_end_is_measured_from_the_end() {
        let beyond = [Pixel::new(0, 0), Pixel::new(8, 4), Pixel::new(5, 0)];
        let mut tally = ErrorTally::default();
        tally.add(&beyond, &[0, 2], (false, false));
        assert_eq!(tally.report().max_px, 5.0);
    }

    #[test]
    fn borrowed_pixels_do_not_count() {
        let line: Vec<Pixel> = (0..5).map(|x| Pixel::new(x, 0)).collect();
        let mut tally = ErrorTally::default();
        tally.add(&line, &[0, 4], (true, true));
        assert_eq!(tally.report().pixels, 3);
    }

    #[test]
    fn far_errors_widen_the_bins_instead_of_adding_more() {
        let far = [Pixel::new(0, 0), Pixel::new(3000, 4000), Pixel::new(0, 0)];
        let mut tally = ErrorTally::default();
        tally.add(&far, &[0, 2], (false, false));
        let report = tally.report();
        assert!(report.histogram.len() <= MAX_BINS);
        assert_eq!(report.histogram.iter().map(|bin| bin.pixels).sum::<u64>(), 3);
        let last = report.histogram.last().unwrap();
        assert!(last.from_px <= 5000.0 && 5000.0 < last.to_px);
    }
}
