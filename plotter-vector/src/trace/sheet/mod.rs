//! [`Vectorizer::vectorize_rows`]: sheets of any length, in the memory of some bands of them.
//!
//! ```text
//!   rows ──► ink ──► cleaned, lines apart from areas ──► skeleton ──► fragments ──► strokes ──► polylines
//!                                       └──► areas, a stretch at a time ──► outlines, hatching
//! ```
//!
//! Each step takes its rows with as much context as decides about them and hands on the rows themselves; it
//! forgets what no later step needs. Several bands of a step are worked on at a time, one a thread. A stroke
//! is simplified as soon as it is whole, so that what stays is the drawing.

mod errors;
mod limits;
mod pipeline;
mod step;

use crate::ink::mark_sizes::MarkSizes;
use crate::ink::pen::PenSurvey;
use crate::ink::row_threshold::RowThreshold;
use crate::report::coverage::AreaPen;
use crate::stroke::clip_to_picture::within;
use crate::trace::pipeline::Unordered;
use crate::{
    ink::{Despeckled, Look, Split, Survey, Threshold, ThresholdMethod},
    picture::{
        Bitmap, DecodeError, Depth, Gray, GrayRows, MAX_PIXELS, MAX_SHEET_ROWS, MAX_SIDE_PX, Row, RowSource,
        SizeError,
    },
    stroke::Drawing,
    trace::{Cancelled, Doubt, Progress, VectorizeError, Vectorizer, doubt::Dirt},
};
use core::fmt;
use errors::Measure;
pub use errors::SheetErrors;
pub use limits::{MAX_LINE_PIXELS, MAX_SHEET_STROKES};
use pipeline::{Finished, SheetPipeline};

/// What [`Vectorizer::vectorize_rows`] found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TracedSheet {
    /// The strokes, all of them within the sheet.
    pub drawing: Drawing,
    /// How ink was told from paper; `None` for an empty sheet.
    pub split: Option<Split>,
    /// What was found of a picture whose ink no single level tells from its paper.
    pub look: Option<Look>,
    /// Ink of the sheet as it came, px.
    pub ink_pixels: u64,
    /// Width of the pen, px; `None` when there are no lines.
    pub pen_px: Option<u32>,
    /// How far the ink lies from the strokes; `None` unless it was asked for.
    pub errors: Option<SheetErrors>,
    /// What was taken for dirt, and is not drawn: no error is told of it.
    pub removed: Despeckled,
    /// Why it may be no drawing, of ours.
    pub doubt: Option<Doubt>,
}

/// Why a sheet cannot be vectorized.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SheetError {
    /// A row cannot be read.
    Source(DecodeError),
    /// It was stopped.
    Cancelled(Cancelled),
    /// The published algorithm is asked for: it needs the whole sheet at once, and there are too many pixels.
    Size(SizeError),
    /// More than [`MAX_LINE_PIXELS`] px of lines, along their middles, in 256 rows: it is no drawing.
    TooManyLines {
        /// The first and the last of the rows, 0 is the uppermost.
        rows: [u32; 2],
    },
    /// More than [`MAX_SHEET_STROKES`] strokes: it is no drawing.
    TooManyStrokes {
        /// The row down to which there are so many, 0 is the uppermost.
        last_row: u32,
    },
    /// As for a picture in memory.
    Vectorize(VectorizeError),
}

impl fmt::Display for SheetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Source(error) => error.fmt(f),
            Self::Cancelled(error) => error.fmt(f),
            Self::Size(error) => write!(f, "the published algorithm needs the whole sheet: {error}"),
            Self::TooManyLines { rows: [first, last] } => write!(
                f,
                "more than {MAX_LINE_PIXELS} px of lines in rows {first} to {last}: the picture is noise; set the threshold \
                 level by hand, clean the scan, or scan with fewer dots per inch"
            ),
            Self::TooManyStrokes { last_row } => write!(
                f,
                "more than {MAX_SHEET_STROKES} strokes down to row {last_row}: the picture is noise; set the threshold level \
                 by hand, clean the scan, or cut it into sheets"
            ),
            Self::Vectorize(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for SheetError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Source(error) => Some(error),
            Self::Cancelled(error) => Some(error),
            Self::Size(error) => Some(error),
            Self::Vectorize(error) => Some(error),
            _ => None,
        }
    }
}

impl From<DecodeError> for SheetError {
    fn from(error: DecodeError) -> Self {
        Self::Source(error)
    }
}

impl From<Cancelled> for SheetError {
    fn from(error: Cancelled) -> Self {
        Self::Cancelled(error)
    }
}

impl From<VectorizeError> for SheetError {
    fn from(error: VectorizeError) -> Self {
        Self::Vectorize(error)
    }
}

impl Vectorizer {
    /// Vectorizes a sheet that comes row by row: of 1 bit or of grey levels.
    ///
    /// The strokes and their order are those of [`Vectorizer::vectorize`] on the whole picture, whatever the
    /// height of the bands and the number of threads; a black bit is level 0 there, a white one 255, so that
    /// on a black sheet the white lines are ink. The sheet is read four times, for the width of the pen, the
    /// strokes, their widths and what they leave bare ([`Prefer`](crate::trace::Prefer)); one of grey levels,
    /// or of white lines on black, once more. How far the ink lies from the strokes is not measured:
    /// [`Vectorizer::vectorize_rows_with_errors`] does.
    ///
    /// Memory is some bands of the sheet (of a large one fewer than there are threads) and the drawing, and
    /// * of strokes that have begun but not ended, 12 bytes a pixel of their length, and of long ones at most
    ///   those of some 8000 rows: where a stroke comes to every 4096th row of the sheet it is cut and
    ///   simplified so far, if 2048 px or more lie between two cuts. A cut on a straight line leaves no
    ///   vertex;
    /// * of areas, the rows from one without any to the next, at most [`MAX_PIXELS`], at 1 bit;
    /// * the published algorithm needs the whole sheet, and so do lines one pixel wide without grey rims as
    ///   long as it is no larger than [`MAX_PIXELS`]. On a larger one they are followed band after band:
    ///   through every pixel with the same promise, but in other strokes than of the whole.
    ///
    /// [`MAX_PIXELS`]: crate::picture::MAX_PIXELS
    ///
    /// A page of noise is refused ([`MAX_LINE_PIXELS`], [`MAX_SHEET_STROKES`]), so that no sheet takes, by
    /// estimate, much more than a gigabyte.
    ///
    /// ```
    /// use plotter_vector::{Bitmap, Progress, Vectorizer, picture::BitmapRows};
    /// let bar = Bitmap::from_picture(&"..###..\n".repeat(40))?;
    /// let sheet = Vectorizer::default().vectorize_rows(&mut BitmapRows::new(&bar), &mut Progress::silent())?;
    /// assert_eq!((sheet.pen_px, sheet.ink_pixels, sheet.drawing.vertices()), (Some(3), 120, 2));
    /// assert_eq!(sheet.drawing, Vectorizer::default().trace(&bar)?.drawing);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SheetError`].
    pub fn vectorize_rows(
        &self,
        source: &mut impl RowSource,
        progress: &mut Progress<'_>,
    ) -> Result<TracedSheet, SheetError> {
        self.traced_rows(source, false, 0, progress)
    }

    /// As [`Vectorizer::vectorize_rows`], and how far the ink lies from the strokes: what
    /// [`Vectorized::error`] and, of drawings without areas, [`worst_pixel`] say of the whole picture, to the
    /// last bit. The sheet is read twice more; the memory, when the bands are done, is 110 bytes a vertex and
    /// 1 bit for each 16 pixels.
    ///
    /// [`worst_pixel`]: crate::report::worst_pixel
    /// [`Vectorized::error`]: crate::trace::Vectorized::error
    ///
    /// ```
    /// use plotter_vector::{Bitmap, Progress, Vectorizer, picture::BitmapRows};
    /// let bar = Bitmap::from_picture(&"..###..\n".repeat(40))?;
    /// let mut rows = BitmapRows::new(&bar);
    /// let sheet = Vectorizer::default().vectorize_rows_with_errors(&mut rows, &mut Progress::silent())?;
    /// let errors = sheet.errors.unwrap_or_default();
    /// assert_eq!(errors.report.pixels, 3 * 40);
    /// assert_eq!(errors.worst.map(|(_, error_px)| error_px), Some(errors.report.max_px));
    /// assert_eq!(errors.report, Vectorizer::default().trace(&bar)?.error);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SheetError`].
    pub fn vectorize_rows_with_errors(
        &self,
        source: &mut impl RowSource,
        progress: &mut Progress<'_>,
    ) -> Result<TracedSheet, SheetError> {
        self.traced_rows(source, true, 0, progress)
    }

    fn traced_rows(
        &self,
        source: &mut impl RowSource,
        with_errors: bool,
        left_out: usize,
        progress: &mut Progress<'_>,
    ) -> Result<TracedSheet, SheetError> {
        if let Some(ours) = self.ours() {
            ours.check()?;
        }
        let (width, height) = (source.width(), source.height());
        if width > MAX_SIDE_PX || height > MAX_SHEET_ROWS {
            return Err(DecodeError::TooLong { width, height }.into());
        }
        let errors = with_errors.then(SheetErrors::default);
        let empty = TracedSheet { drawing: Drawing::new(width, height), errors, ..TracedSheet::default() };
        let (survey, survey_of_black) = survey(self, source, &mut progress.part(0.1))?;
        if survey.is_uneven() {
            let gray = whole_of(source, &mut progress.part(0.2))?;
            let Some((evened, settings)) = self.evened(&gray) else {
                let mut rows = GrayRows::new(gray);
                return self.by_level().traced_rows(&mut rows, with_errors, 0, &mut progress.part(1.0));
            };
            drop(gray);
            let (look, mut rows) = (evened.look, GrayRows::new(evened.gray));
            let found =
                settings.traced_rows(&mut rows, with_errors, look.left_out, &mut progress.part(1.0))?;
            let split = look.split(found.split);
            let doubt = if split.is_none() { Doubt::of_empty(&look) } else { found.doubt };
            return Ok(TracedSheet { look: Some(look), split, doubt, ..found });
        }
        if survey.needs_more_than_a_level() {
            let threshold = Threshold { method: ThresholdMethod::Adaptive, ..self.threshold };
            return Self { threshold, ..*self }.traced_rows(source, with_errors, 0, &mut progress.part(1.0));
        }
        let Some(threshold) = survey.finish() else { return Ok(empty) };
        // Of 1 bit a pixel black is nearly always the ink: then all is known already.
        let (pen, ink_pixels) = match source.depth() {
            Depth::Bits1 if threshold.black_is_ink() => survey_of_black.finish(),
            _ => pen_of_ink(source, &threshold, &mut progress.part(0.2))?.finish(),
        };
        let found = TracedSheet {
            split: Some(threshold.split(ink_pixels)),
            ink_pixels,
            pen_px: pen.found_px,
            ..empty
        };
        if ink_pixels == 0 {
            return Ok(found);
        }
        let mut strokes_part = progress.part(if with_errors { 0.5 } else { 0.7 });
        let fits = u64::from(width) * u64::from(height) <= MAX_PIXELS;
        let keeps_pixels =
            self.ours().is_none_or(|ours| ours.keeps_pixels(pen, || threshold.has_rims(ink_pixels)));
        let by_bands = self.ours().filter(|_| !(keeps_pixels && fits));
        let Some(ours) = by_bands else {
            let mut ink = Bitmap::new(width, height).map_err(SheetError::Size)?;
            let mut rows = ink.rows_mut();
            for_each_row(source, &mut strokes_part, |y, row| {
                if let Some(ink) = rows.next() {
                    threshold.ink_of(y, row, width, ink);
                }
                Ok(())
            })?;
            drop(rows);
            let (drawing, errors, removed, doubt) = self.traced_whole(ink, with_errors, left_out)?;
            progress.part(1.0).at(1, 1)?;
            return Ok(TracedSheet { drawing, errors, removed, doubt, ..found });
        };
        let mut sheet = SheetPipeline::new(ours, (width, height), (pen, keeps_pixels), &threshold);
        for_each_row(source, &mut strokes_part, |_, row| sheet.push(row))?;
        let Finished { strokes, area_rows, removed } = sheet.finish()?;
        let mut drawing = found.drawing;
        strokes.into_iter().for_each(|stroke| drawing.push_curve(1, within(stroke, width, height)));
        let smallest_px = ours.smallest_mark_px(pen.width_px);
        let opening = ours.opening(pen);
        let measure = Measure {
            threshold: &threshold,
            smallest_px,
            band_rows: ours.band_rows,
            areas: AreaPen { is_raster: keeps_pixels, ..ours.area_pen(&opening) },
            within_px: ours.tolerance_px,
            area_rows: &area_rows,
        };
        if ours.adds_strokes() {
            let mut bare_part = progress.part(if with_errors { 0.5 } else { 1.0 });
            for stroke in measure.bare(source, &drawing, |drawn| ours.bare_ink(drawn), &mut bare_part)? {
                drawing.push_curve(1, within(stroke, width, height));
            }
        }
        let (drawing, _) = self.in_order(drawing, None, if keeps_pixels { 1 } else { pen.thinnest_px });
        let dirt = Dirt { least_px: smallest_px, removed, left_out };
        let doubt = Doubt::of(&drawing, pen.width_px, dirt, || {
            let mut sizes = MarkSizes::new(width);
            let mut ink = vec![0; width.div_ceil(u64::BITS) as usize];
            for_each_row(source, &mut progress.part(if with_errors { 0.55 } else { 1.0 }), |y, row| {
                threshold.ink_of(y, row, width, &mut ink);
                sizes.push(&ink);
                Ok(())
            })?;
            Ok::<_, SheetError>(sizes)
        })?;
        let errors =
            if with_errors { Some(measure.errors(source, &drawing, &mut progress.part(1.0))?) } else { None };
        Ok(TracedSheet { drawing, errors, removed, doubt, ..found })
    }

    /// A sheet that has to be traced as a whole.
    fn traced_whole(
        &self,
        mut ink: Bitmap,
        with_errors: bool,
        left_out: usize,
    ) -> Result<(Drawing, Option<SheetErrors>, Despeckled, Option<Doubt>), SheetError> {
        let Unordered { drawing, errors, areas, thinnest_px, removed } = self.unordered(&mut ink, None)?;
        let (drawing, errors) = self.completed(drawing, errors, &ink, areas.as_ref());
        let (drawing, errors) = self.in_order(drawing, errors, thinnest_px);
        let errors = with_errors.then(|| self.known_or_measured(errors, &ink, &drawing, areas.as_ref()));
        let doubt = self.doubt(&drawing, &ink, removed, left_out)?;
        Ok((drawing, errors, removed, doubt))
    }
}

/// All rows of a sheet in turn.
fn for_each_row(
    source: &mut impl RowSource,
    progress: &mut Progress<'_>,
    mut take: impl FnMut(u32, Row<'_>) -> Result<(), SheetError>,
) -> Result<(), SheetError> {
    let height = u64::from(source.height());
    source.rewind()?;
    let mut y = 0;
    while let Some(row) = source.next_row()? {
        take(y, row)?;
        y += 1;
        progress.at(y.into(), height)?;
    }
    Ok(())
}

/// All rows at once, of grey levels.
fn whole_of(source: &mut impl RowSource, progress: &mut Progress<'_>) -> Result<Gray, SheetError> {
    let (width, height) = (source.width(), source.height());
    let mut levels = Vec::new();
    for_each_row(source, progress, |_, row| {
        if let Row::Grey(row) = row {
            levels.extend_from_slice(row);
        }
        Ok(())
    })?;
    levels.resize(width as usize * height as usize, u8::MAX);
    Ok(Gray::of_checked_size(width, height, levels))
}

/// The first pass: what is ink, and of 1 bit a pixel the pen, were the ink black.
fn survey(
    settings: &Vectorizer,
    source: &mut impl RowSource,
    progress: &mut Progress<'_>,
) -> Result<(Survey, PenSurvey), SheetError> {
    let (width, height) = (source.width(), source.height());
    let mut survey = Survey::checked(settings.threshold, width, height);
    let mut pen = PenSurvey::new(width);
    for_each_row(source, progress, |_, row| {
        survey.push_row(row);
        if let Row::Bits(words) = row {
            pen.push(words);
        }
        Ok(())
    })?;
    Ok((survey, pen))
}

fn pen_of_ink(
    source: &mut impl RowSource,
    threshold: &RowThreshold,
    progress: &mut Progress<'_>,
) -> Result<PenSurvey, SheetError> {
    let width = source.width();
    let mut pen = PenSurvey::new(width);
    let mut ink = vec![0; width.div_ceil(u64::BITS) as usize];
    for_each_row(source, progress, |y, row| {
        threshold.ink_of(y, row, width, &mut ink);
        pen.push(&ink);
        Ok(())
    })?;
    Ok(pen)
}

/// Bytes of a row at 1 bit a pixel.
fn row_bytes(width: u32) -> usize {
    (width.div_ceil(u64::BITS) as usize * 8).max(1)
}
