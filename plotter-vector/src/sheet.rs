//! [`Vectorizer::vectorize_rows`]: sheets of any length, in the memory of some bands of them.
//!
//! ```text
//!   rows ──► ink ──► cleaned, lines apart from areas ──► skeleton ──► fragments ──► strokes ──► polylines
//!                                       └──► areas, a stretch at a time ──► outlines, hatching
//! ```
//!
//! Each step takes its rows with as much context as decides about them and hands on the rows themselves; it forgets what
//! no later step needs. Several bands of a step are worked on at a time, one a thread. A stroke is simplified as soon as
//! it is whole, so that what stays is the drawing.

use crate::areas::Islands;
use crate::areas::split::split;
use crate::bitmap::blocks_between;
use crate::centrelines::{CONTEXT_ROWS, Centring, each, sort, threads};
use crate::graph::{Joiner, Rims, Scan, Stretch, fragments};
use crate::pipeline::is_raster_lines;
use crate::rolling::Rolling;
use crate::row_threshold::RowThreshold;
use crate::speckle::despeckle_here;
use crate::{
    Algorithm, Bitmap, Cancelled, Curve, DecodeError, Depth, Drawing, Gray, LineWidth, Mode, Progress, Row,
    RowSource, SizeError, Split, Survey, VectorizeError, Vectorizer, context_rows, rows_of_width_context,
    smallest_mark_px,
};
use core::fmt;
use core::ops::Range;

/// Own rows of a band, bytes at 1 bit a pixel, and the fewest rows: less, and the context costs more than the band; more,
/// and the memory grows.
const BAND_BYTES: usize = 3 << 18;
const FEWEST_ROWS: u32 = 384;

/// Rows of all bands that are worked on at a time, bytes at 1 bit a pixel: of a large sheet they are fewer than the threads.
const BANDS_BYTES: usize = 5 << 20;

/// What [`Vectorizer::vectorize_rows`] found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TracedSheet {
    /// The strokes.
    pub drawing: Drawing,
    /// How ink was told from paper; `None` for an empty sheet, and for one that came at 1 bit a pixel.
    pub split: Option<Split>,
    /// Ink of the sheet as it came, px.
    pub ink_pixels: u64,
    /// Width of the pen, px; `None` when there are no lines.
    pub pen_px: Option<u32>,
}

/// Why a sheet cannot be vectorized.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SheetError {
    /// A row cannot be read.
    Source(DecodeError),
    /// It was stopped.
    Cancelled(Cancelled),
    /// The sheet has lines one pixel wide, or the published algorithm is asked for: that needs the whole sheet at once, and
    /// there are too many pixels.
    Size(SizeError),
    /// As for a picture in memory.
    Vectorize(VectorizeError),
}

impl fmt::Display for SheetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Source(error) => error.fmt(f),
            Self::Cancelled(error) => error.fmt(f),
            Self::Size(error) => write!(f, "lines one pixel wide are tracked on the whole sheet: {error}"),
            Self::Vectorize(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for SheetError {}

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
    /// Vectorizes a sheet that comes row by row: of 1 bit, where black is ink, or of grey levels.
    ///
    /// The strokes and their order are those of [`Vectorizer::trace`] and [`Vectorizer::vectorize`] on the whole
    /// picture, whatever the height of the bands and the number of threads. The sheet is read twice, one of grey levels
    /// three times: for the threshold, for the width of the pen, for the strokes. How far the pixels lie from the strokes
    /// is not measured.
    ///
    /// Memory is some bands of the sheet (of a large one fewer than there are threads) and the drawing, and
    /// * of strokes that have begun but not ended, 12 bytes a pixel of their length, and of long ones at most those of some
    ///   8000 rows: where a stroke comes to every 4096th row of the sheet it is cut and simplified so far, if 2048 px or
    ///   more lie between two cuts. A cut on a straight line leaves no vertex;
    /// * of areas, the rows from one without any to the next, at most [`MAX_PIXELS`](crate::MAX_PIXELS), at 1 bit;
    /// * lines one pixel wide and the published algorithm need the whole sheet.
    ///
    /// ```
    /// use plotter_vector::{Bitmap, BitmapRows, Progress, Vectorizer};
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
        if self.algorithm == Algorithm::Ours {
            self.check()?;
        }
        let (width, height) = (source.width(), source.height());
        let threshold = match source.depth() {
            Depth::Bits1 => None,
            Depth::Grey8 => Some(survey(self, source, &mut progress.part(0.1))?),
        };
        let empty = TracedSheet { drawing: Drawing::new(width, height), ..TracedSheet::default() };
        let threshold = match threshold {
            Some(None) => return Ok(empty),
            Some(threshold) => threshold,
            None => None,
        };
        let (pen_px, ink_pixels) = pen_width(source, threshold.as_ref(), &mut progress.part(0.2))?;
        let split = threshold.as_ref().map(|threshold| Split {
            level: threshold.level(),
            ink_is_dark: threshold.ink_is_dark(),
            ink_pixels,
        });
        let found = TracedSheet { split, ink_pixels, pen_px, ..empty };
        let progress = &mut progress.part(1.0);
        let tracked = pen_px.unwrap_or(1) <= 1 && self.mode != Mode::Outline;
        if tracked || self.algorithm == Algorithm::Published {
            let mut ink = Bitmap::new(width, height).map_err(SheetError::Size)?;
            let mut rows = ink.rows_mut();
            for_each_row(source, progress, |y, row| {
                if let Some(ink) = rows.next() {
                    ink_of(row, y, threshold.as_ref(), ink);
                }
                Ok(())
            })?;
            drop(rows);
            return Ok(TracedSheet { drawing: self.trace(&ink)?.drawing, ..found });
        }
        let mut sheet = Work::new(self, width, height, pen_px.unwrap_or(1), threshold);
        for_each_row(source, progress, |_, row| sheet.push(row))?;
        let strokes = sheet.finish()?;
        let mut drawing = found.drawing;
        strokes.into_iter().for_each(|stroke| drawing.push_curve(1, stroke));
        Ok(TracedSheet { drawing: self.order.apply(&drawing), ..found })
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

/// The first pass over grey levels.
fn survey(
    settings: &Vectorizer,
    source: &mut impl RowSource,
    progress: &mut Progress<'_>,
) -> Result<Option<RowThreshold>, SheetError> {
    let new = Survey::new(settings.threshold, source.width(), source.height());
    let mut survey = new.map_err(SheetError::Size)?;
    for_each_row(source, progress, |_, row| {
        if let Row::Grey(levels) = row {
            survey.push(levels);
        }
        Ok(())
    })?;
    Ok(survey.finish())
}

/// The width of the pen and the number of ink pixels.
fn pen_width(
    source: &mut impl RowSource,
    threshold: Option<&RowThreshold>,
    progress: &mut Progress<'_>,
) -> Result<(Option<u32>, u64), SheetError> {
    let width = source.width();
    let (mut pen, mut ink_pixels, mut blocks) = (LineWidth::new(width), 0, 0);
    let mut ink = vec![0; width.div_ceil(u64::BITS) as usize];
    let mut above = ink.clone();
    for_each_row(source, progress, |y, row| {
        ink_of(row, y, threshold, &mut ink);
        ink_pixels += ink.iter().map(|bits| u64::from(bits.count_ones())).sum::<u64>();
        blocks += blocks_between(&above, &ink);
        pen.push(&ink);
        core::mem::swap(&mut above, &mut ink);
        Ok(())
    })?;
    let found = pen.finish().map(|pen_px| if is_raster_lines(blocks, ink_pixels) { 1 } else { pen_px });
    Ok((found, ink_pixels))
}

fn ink_of(row: Row<'_>, y: u32, threshold: Option<&RowThreshold>, ink: &mut [u64]) {
    match (row, threshold) {
        (Row::Bits(words), _) => ink.iter_mut().zip(words).for_each(|(to, from)| *to = *from),
        (Row::Grey(levels), Some(threshold)) => threshold.row(y, levels, ink),
        (Row::Grey(_), None) => ink.fill(0),
    }
}

/// A step of the work: which rows it takes next.
#[derive(Clone, Copy, Debug)]
struct Step {
    next: u32,
    /// Own rows of a band, and rows more that it needs above and below.
    band_rows: u32,
    context: u32,
    /// Bands that are worked on at a time.
    bands: u32,
    height: u32,
}

impl Step {
    /// The bands that can be worked on when the rows before `end` are there: as many as are worked on at a time, or those
    /// that are left at the end of the sheet.
    fn ready(&mut self, end: u32) -> Option<Vec<Range<u32>>> {
        let bands = self.bands;
        let own = self.next..self.next.saturating_add(bands.saturating_mul(self.band_rows)).min(self.height);
        if own.is_empty() || end < own.end.saturating_add(self.context).min(self.height) {
            return None;
        }
        self.next = own.end;
        let band = |start: u32| start..start.saturating_add(self.band_rows).min(own.end);
        Some(own.clone().step_by(self.band_rows as usize).map(band).collect())
    }

    /// The rows of a band with its context.
    fn around(&self, own: &Range<u32>) -> Range<u32> {
        own.start.saturating_sub(self.context)..own.end.saturating_add(self.context).min(self.height)
    }

    /// First row that this step still needs.
    fn needs(&self) -> u32 {
        self.next.saturating_sub(self.context)
    }
}

/// The strokes of a sheet that is on its way.
struct Work<'a> {
    settings: &'a Vectorizer,
    threshold: Option<RowThreshold>,
    centring: Centring,
    smallest_px: u32,
    /// Widest line, px; none when all ink is outlined.
    max_line_px: Option<u32>,
    ink: Rolling<u64>,
    levels: Option<Rolling<u8>>,
    lines: Rolling<u64>,
    skeleton: Rolling<u64>,
    /// Memory of the bands: always the same, so that it does not fall to pieces.
    words: Vec<Vec<u64>>,
    clean: Step,
    thin: Step,
    follow: Step,
    islands: Islands,
    joiner: Joiner,
    strokes: Vec<Curve>,
    outlines: Vec<Curve>,
}

impl<'a> Work<'a> {
    fn new(
        settings: &'a Vectorizer,
        width: u32,
        height: u32,
        pen_px: u32,
        threshold: Option<RowThreshold>,
    ) -> Self {
        let smallest_px = settings.smallest_mark_px.unwrap_or(smallest_mark_px(pen_px));
        let max_line_px = settings.max_line_px(pen_px);
        let centring = settings.centring(max_line_px);
        let max_line_px = (settings.mode != Mode::Outline).then_some(max_line_px);
        let row_bytes = (width.div_ceil(u64::BITS) as usize * 8).max(1);
        let rows = u32::try_from(BAND_BYTES / row_bytes).unwrap_or(u32::MAX).max(FEWEST_ROWS);
        let band_rows = rows.min(settings.band_rows).max(1);
        let step = |context: u32| {
            let rows = context.saturating_mul(2).saturating_add(band_rows).min(height);
            let bands = threads().min(BANDS_BYTES / (row_bytes * rows as usize).max(1)).max(1);
            Step { next: 0, band_rows, context, bands: u32::try_from(bands).unwrap_or(1), height }
        };
        let grey = threshold.is_some() && max_line_px.is_some();
        Self {
            settings,
            threshold,
            smallest_px,
            max_line_px,
            ink: Rolling::of_ink(width),
            levels: grey.then(|| Rolling::of_levels(width)),
            lines: Rolling::of_ink(width),
            skeleton: Rolling::of_ink(width),
            words: Vec::new(),
            clean: step(
                context_rows(smallest_px).saturating_add(max_line_px.map_or(0, rows_of_width_context)),
            ),
            thin: step(centring.thinning.rows_of_context()),
            follow: step(CONTEXT_ROWS),
            centring,
            islands: Islands::new(width),
            joiner: Joiner::default(),
            strokes: Vec::new(),
            outlines: Vec::new(),
        }
    }

    /// The next row.
    fn push(&mut self, row: Row<'_>) -> Result<(), SheetError> {
        let y = self.ink.end();
        ink_of(row, y, self.threshold.as_ref(), self.ink.next_row());
        if let (Some(levels), Row::Grey(row)) = (&mut self.levels, row) {
            levels.push(row);
        }
        while let Some(bands) = self.clean.ready(self.ink.end()) {
            self.clean(bands)?;
        }
        if self.max_line_px.is_some() {
            while let Some(bands) = self.thin.ready(self.lines.end()) {
                self.thin(bands);
            }
            while let Some(bands) = self.follow.ready(self.skeleton.end().min(self.lines.end())) {
                self.follow(bands);
            }
        }
        Ok(())
    }

    /// All strokes, after the last row.
    fn finish(mut self) -> Result<Vec<Curve>, SheetError> {
        if let Some((first, areas)) = self.islands.finish() {
            self.outlines.extend(self.settings.area_strokes(first, &areas)?);
        }
        let open = core::mem::take(&mut self.joiner).finish().collect();
        self.strokes.extend(self.centring.simplified(open));
        sort(&mut self.strokes);
        self.strokes.append(&mut self.outlines);
        Ok(self.strokes)
    }

    /// Bands with memory for each.
    fn with_words(&mut self, bands: Vec<Range<u32>>) -> Vec<(Range<u32>, Vec<u64>)> {
        bands.into_iter().map(|own| (own, self.words.pop().unwrap_or_default())).collect()
    }

    /// Removes speckles, and tells lines from areas.
    fn clean(&mut self, bands: Vec<Range<u32>>) -> Result<(), SheetError> {
        let bands = self.with_words(bands);
        let (step, ink, max_line_px) = (self.clean, &self.ink, self.max_line_px);
        let smallest_px = self.smallest_px;
        let cleaned = each(bands, |(own, words)| {
            let rows = step.around(&own);
            let mut band = ink.band(&rows, words);
            despeckle_here(&mut band, smallest_px);
            let (lines, areas) = match max_line_px {
                Some(max_line_px) => {
                    let (lines, areas) = split(band, max_line_px);
                    (Some(lines), areas)
                }
                None => (None, Some(band)),
            };
            (own.start - rows.start..own.end - rows.start, lines, areas)
        });
        for (own, lines, areas) in cleaned {
            for y in own {
                if let Some(lines) = &lines {
                    self.lines.push(lines.row(y));
                }
                let areas = areas.as_ref().map_or(&[][..], |areas| areas.row(y));
                if let Some((first, areas)) = self.islands.push(areas) {
                    self.outlines.extend(self.settings.area_strokes(first, &areas)?);
                }
            }
            self.words.extend(lines.or(areas).map(Bitmap::into_words));
        }
        self.ink.forget_before(self.clean.needs());
        Ok(())
    }

    /// Thins the lines.
    fn thin(&mut self, bands: Vec<Range<u32>>) {
        let bands = self.with_words(bands);
        let (step, lines, thinning) = (self.thin, &self.lines, self.centring.thinning);
        let thinned = each(bands, |(own, words)| {
            let rows = step.around(&own);
            let mut band = lines.band(&rows, words);
            // Lines that are wider than expected stay so in places: their middle is found all the same.
            let _ = thinning.thin_in_place(&mut band);
            (own.start - rows.start..own.end - rows.start, band)
        });
        for (own, band) in thinned {
            own.for_each(|y| self.skeleton.push(band.row(y)));
            self.words.push(band.into_words());
        }
        self.lines.forget_before(self.follow.needs().min(self.thin.needs()));
    }

    /// Follows the skeleton, and simplifies the strokes that are whole now.
    fn follow(&mut self, bands: Vec<Range<u32>>) {
        let bands = self.with_words(bands);
        let (step, lines, skeleton) = (self.follow, &mut self.lines, &mut self.skeleton);
        let ink_is_dark = self.threshold.as_ref().is_some_and(RowThreshold::ink_is_dark);
        let follow = |levels: Option<(&Gray, u32)>| {
            let grey = levels.map(|(levels, first_row)| Rims { levels, ink_is_dark, first_row });
            lines.lend(|ink, first_row| {
                let scan = Scan { ink, first_row, grey };
                skeleton.lend(|picture, first_row| {
                    each(bands, |(own, mut words)| {
                        let rows = step.around(&own);
                        let rows = rows.start - first_row..rows.end - first_row;
                        let stretch = Stretch { picture, rows };
                        (fragments(scan, &stretch, first_row, &own, &mut words), words)
                    })
                })
            })
        };
        let found = match &mut self.levels {
            Some(levels) => levels.lend(|levels, first_row| follow(Some((levels, first_row)))),
            None => follow(None),
        };
        let mut whole = Vec::new();
        for (fragments, words) in found {
            self.words.push(words);
            whole.extend(fragments.into_iter().filter_map(|fragment| self.joiner.push(fragment)));
        }
        self.strokes.extend(self.centring.simplified(whole));
        self.joiner.cut(self.centring.cuts(), self.centring.bounded);
        let needs = self.follow.needs();
        self.lines.forget_before(needs.min(self.thin.needs()));
        self.skeleton.forget_before(needs);
        if let Some(levels) = &mut self.levels {
            levels.forget_before(needs);
        }
    }
}
