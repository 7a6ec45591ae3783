//! [`Pen`]: what the ink of a picture says of the pen that drew it.

use crate::ink::hairlines::{Hairlines, Steps};
use crate::ink::line_width::{LineWidth, WIDEST_BESIDE_AREAS_PX, Widths};
use crate::picture::Bitmap;

/// Lines up to this width, px, are thin. Beside wider ones these say nothing of most of the drawing.
const WIDEST_HAIRLINE_PX: u32 = 2;

/// The pen that drew a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Pen {
    /// Its width, px, where lines tell it.
    pub(crate) found_px: Option<u32>,
    /// The width to reckon with, px.
    pub(crate) width_px: u32,
    /// That of the thinnest lines, px.
    pub(crate) thinnest_px: u32,
    /// What thin lines are.
    pub(crate) hairlines: Hairlines,
    /// Whether the ink has no width that is common: no pen has drawn it.
    pub(crate) is_silhouette: bool,
}

impl Pen {
    /// Of the ink of a picture.
    pub(crate) fn of(ink: &Bitmap) -> Self {
        let mut survey = PenSurvey::new(ink.width());
        (0..ink.height()).for_each(|y| survey.push(ink.row(y)));
        survey.finish().0
    }
}

/// Finds the pen from rows of ink.
pub(crate) struct PenSurvey {
    width: LineWidth,
    steps: Steps,
    ink_pixels: u64,
}

impl PenSurvey {
    /// Before the first row of a picture of `width` px.
    pub(crate) fn new(width: u32) -> Self {
        Self { width: LineWidth::new(width), steps: Steps::new(width), ink_pixels: 0 }
    }

    /// The next row.
    pub(crate) fn push(&mut self, ink: &[u64]) {
        self.ink_pixels += ink.iter().map(|bits| u64::from(bits.count_ones())).sum::<u64>();
        self.width.push(ink);
        self.steps.push(ink);
    }

    /// The pen, and the number of ink pixels.
    pub(crate) fn finish(self) -> (Pen, u64) {
        let Self { width, steps, ink_pixels } = self;
        let (Widths { pen_px: found_px, thinnest_px, is_silhouette }, steps) =
            (width.widths(), steps.finish());
        let (found_px, width_px) = if is_raster_lines(steps.blocks, ink_pixels) {
            (found_px.map(|_| 1), 1)
        } else {
            (found_px, found_px.unwrap_or(WIDEST_BESIDE_AREAS_PX))
        };
        let are_thin = width_px <= WIDEST_HAIRLINE_PX;
        let hairlines = if are_thin { steps.hairlines(ink_pixels) } else { Hairlines::Raster };
        let thinnest_px = thinnest_px.unwrap_or(width_px).min(width_px);
        (Pen { found_px, width_px, thinnest_px, hairlines, is_silhouette }, ink_pixels)
    }
}

/// Whether ink with so many blocks of two by two pixels is lines one pixel wide: a few places where lines
/// touch make no wide line.
fn is_raster_lines(blocks: u64, ink_pixels: u64) -> bool {
    blocks * 20 <= ink_pixels
}
