//! [`SheetErrors`]: how far the ink of a sheet lies from its strokes, band after band.
//!
//! Each pixel's error needs the ink's width all along the nearest segment, which may be as long as the sheet.
//! So one pass measures the widths, the next the errors; both take the dirt out of the ink again, for a sheet
//! without it would have to be kept whole.

use super::step::Step;
use super::{SheetError, for_each_row, row_bytes};
use crate::ink::row_threshold::RowThreshold;
use crate::ink::row_window::RowWindow;
use crate::ink::speckle::despeckle_here;
use crate::parallel::each;
use crate::picture::runs::ink_runs;
use crate::report::coverage::{
    Across, AreaPen, FARTHEST_PX, Index, PROBE_ROWS, PROBES, PenSegment, SpotRun, SpotTally, add_pixel,
    segments, set_widths,
};
use crate::trace::bare_ink::BareInk;
use crate::{
    ink::context_rows,
    picture::{Bitmap, Pixel, RowSource},
    report::{Beyond, ErrorReport, ErrorTally, Spots},
    stroke::{Curve, Drawing},
    trace::Progress,
};
use core::ops::Range;

/// Pixels of a band: where widths are measured, and, fewer, where the error of each may have to be kept; and
/// its fewest rows.
const WIDTH_BAND_PIXELS: u32 = 1 << 23;
const ERROR_BAND_PIXELS: u32 = 1 << 21;
const FEWEST_ROWS: u32 = 16;

/// How far the ink of a sheet lies from its strokes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SheetErrors {
    /// The errors of all pixels.
    pub report: ErrorReport,
    /// The pixel with the greatest error, the first of several in reading order, and its error, px, as
    /// [`worst_pixel`](crate::report::worst_pixel) finds it, of lines one pixel wide from their figures; none
    /// without ink.
    pub worst: Option<(Pixel, f64)>,
    /// What is drawn beside the ink.
    pub beyond: Beyond,
    /// Ink that lies farther from the strokes than the tolerance of ours.
    pub bare: Spots,
    /// Ink inside of areas that no pen draws, because they are outlined or hatched with gaps; the report
    /// has no errors of it.
    pub insides: Spots,
}

impl SheetErrors {
    /// Whether a drawing is its ink within a tolerance: no ink lies farther from the strokes, none inside of
    /// an area is left out, and nothing drawn lies farther from ink than that or the half pixel that a raster
    /// leaves open. What was taken for dirt before is not asked for.
    #[must_use]
    pub fn are_within(&self, tolerance_px: f64) -> bool {
        self.report.max_px <= tolerance_px
            && self.insides.number == 0
            && self.beyond.max_px <= tolerance_px.max(RASTER_PX)
    }
}

/// Part of a pixel that a raster leaves open: the border of ink passes anywhere between the middles of two
/// pixels.
const RASTER_PX: f64 = 0.5;

/// What the errors of a sheet are measured on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measure<'a> {
    pub(super) threshold: &'a RowThreshold,
    /// Smaller marks are dirt, px.
    pub(super) smallest_px: u32,
    /// Most rows of a band.
    pub(super) band_rows: u32,
    pub(super) areas: AreaPen<'a>,
    /// How far ink may lie from the strokes, px.
    pub(super) within_px: f64,
    /// Rows with areas, from the top.
    pub(super) area_rows: &'a [Range<u32>],
}

/// The errors of some rows.
#[derive(Debug, Default)]
struct BandErrors {
    /// Pixels without one.
    exact: u64,
    /// Those of the other pixels, in reading order, px.
    errors: Vec<f64>,
    worst: Option<(Pixel, f64)>,
    beyond: Beyond,
    /// What is bare, in the own rows.
    bare: Vec<SpotRun>,
    insides: Vec<SpotRun>,
}

impl Measure<'_> {
    /// The errors of a sheet, to the last bit those of [`coverage`](crate::report::coverage()) on the whole
    /// picture.
    pub(super) fn errors(
        self,
        source: &mut impl RowSource,
        drawing: &Drawing,
        progress: &mut Progress<'_>,
    ) -> Result<SheetErrors, SheetError> {
        let index = self.widths(source, drawing, &mut progress.part(0.5))?;
        let (mut tally, mut beyond) = (ErrorTally::default(), Beyond::default());
        let (mut bare, mut insides) = (SpotTally::default(), SpotTally::default());
        self.for_each_band(
            source,
            (ERROR_BAND_PIXELS, self.area_context().max(FARTHEST_PX)),
            &mut progress.part(1.0),
            |ink, first_row, own| {
                let counted = self.counted(ink, own);
                let band = self.band_errors(&index, counted.as_ref().unwrap_or(ink), first_row, own);
                let insides = counted.map(|counted| {
                    index.bare_runs(&ink.clone().without(&counted), first_row, own, self.within_px)
                });
                let insides = insides.unwrap_or_default();
                BandErrors { beyond: index.beyond(ink, first_row, own), insides, ..band }
            },
            |band| {
                beyond = beyond.and(band.beyond);
                band.bare.iter().for_each(|run| bare.add(run));
                band.insides.iter().for_each(|run| insides.add(run));
                tally.add_exact(band.exact);
                band.errors.iter().for_each(|error_px| tally.add_error(*error_px));
                if let Some((at, error_px)) = band.worst {
                    tally.note_worst(at, error_px);
                }
            },
        )?;
        let (bare, insides) = (bare.finish(), insides.finish());
        Ok(SheetErrors { report: tally.report(), worst: tally.worst(), beyond, bare, insides })
    }

    /// Strokes for the ink that a drawing leaves bare.
    pub(super) fn bare<'a>(
        self,
        source: &mut impl RowSource,
        drawing: &Drawing,
        of: impl Fn(&Index) -> BareInk<'_>,
        progress: &mut Progress<'a>,
    ) -> Result<Vec<Curve>, SheetError> {
        let index = self.widths(source, drawing, &mut progress.part(0.5))?;
        let bare = of(&index);
        let mut strokes = Vec::new();
        self.for_each_band(
            source,
            (WIDTH_BAND_PIXELS, BareInk::CONTEXT_ROWS.saturating_add(self.area_context())),
            &mut progress.part(1.0),
            |ink, first_row, own| {
                // A square that begins in these rows ends below.
                let rows = own.start..own.end.saturating_add(BareInk::CONTEXT_ROWS);
                let lines = self.has_areas(&rows).then(|| self.areas.opening.split_of(ink).thin);
                bare.strokes(ink, lines.as_ref().unwrap_or(ink), first_row, own)
            },
            |found| strokes.extend(found),
        )?;
        Ok(strokes)
    }

    /// The ink whose errors count, if that is not all in these rows.
    fn counted(&self, ink: &Bitmap, rows: &Range<u32>) -> Option<Bitmap> {
        self.has_areas(rows).then(|| self.areas.opening.without_insides(ink.clone()))
    }

    fn band_errors(self, index: &Index, ink: &Bitmap, first_row: u32, own: &Range<u32>) -> BandErrors {
        let mut band = BandErrors::default();
        let mut covering = 0;
        for y in own.clone() {
            for run in ink_runs(ink.row(y - first_row)) {
                let BandErrors { exact, errors, worst, bare, .. } = &mut band;
                // The first of several in reading order, if none has an error.
                worst.get_or_insert((Pixel::new(run.start, y), 0.0));
                *exact += index.run_errors(run, y, &mut covering, |at, error_px| {
                    errors.push(error_px);
                    if worst.is_none_or(|(_, most_px)| error_px > most_px) {
                        *worst = Some((at, error_px));
                    }
                    if error_px > self.within_px {
                        add_pixel(bare, at, error_px);
                    }
                });
            }
        }
        band
    }

    fn area_context(&self) -> u32 {
        if self.area_rows.is_empty() { 0 } else { self.areas.opening.rows_of_context() }
    }

    /// The segments of a drawing with the ink's widths.
    fn widths(
        self,
        source: &mut impl RowSource,
        drawing: &Drawing,
        progress: &mut Progress<'_>,
    ) -> Result<Index, SheetError> {
        let (width, height) = (source.width(), source.height());
        let mut segments = segments(drawing);
        let mut widths = vec![[Across::default(); PROBES.len()]; segments.len()];
        self.for_each_band(
            source,
            (WIDTH_BAND_PIXELS, PROBE_ROWS),
            progress,
            |ink, first_row, own| probes(&segments, height, ink, first_row, own),
            |found| {
                for (index, probe, steps) in found {
                    if let Some(width) = widths.get_mut(index).and_then(|widths| widths.get_mut(probe)) {
                        *width = steps;
                    }
                }
            },
        )?;
        set_widths(&mut segments, &widths, Some(self.areas));
        Ok(Index::new(segments, width, height))
    }

    /// Whether there are areas in some rows.
    fn has_areas(&self, rows: &Range<u32>) -> bool {
        let next = self.area_rows.partition_point(|areas| areas.end <= rows.start);
        self.area_rows.get(next).is_some_and(|areas| areas.start < rows.end)
    }

    /// Bands of so many pixels of the sheet's ink without its dirt, with `more_context` rows above and below
    /// their own: what `work` makes of them (the ink, which row of the sheet its first one is, the own rows)
    /// is taken in their order.
    fn for_each_band<T: Send>(
        self,
        source: &mut impl RowSource,
        (band_pixels, more_context): (u32, u32),
        progress: &mut Progress<'_>,
        work: impl Fn(&Bitmap, u32, &Range<u32>) -> T + Sync,
        mut take: impl FnMut(T),
    ) -> Result<(), SheetError> {
        let (width, height) = (source.width(), source.height());
        let rows = (band_pixels / width.max(1)).max(FEWEST_ROWS).min(self.band_rows).max(1);
        let context = context_rows(self.smallest_px).saturating_add(more_context);
        let mut step = Step::new(row_bytes(width), height, rows, context);
        let mut ink = RowWindow::of_ink(width);
        for_each_row(source, progress, |y, row| {
            self.threshold.ink_of(y, row, width, ink.next_row());
            while let Some(bands) = step.ready(ink.end()) {
                let done = each(bands, |own| {
                    let rows = step.around(&own);
                    let mut band = ink.band(&rows, Vec::new());
                    let _ = despeckle_here(&mut band, self.smallest_px, 0..0);
                    work(&band, rows.start, &own)
                });
                done.into_iter().for_each(&mut take);
                ink.forget_before(step.needs());
            }
            Ok(())
        })
    }
}

/// The widths of the ink at the probes in the own rows: which segment, which probe, how wide in steps.
fn probes(
    segments: &[PenSegment],
    height: u32,
    ink: &Bitmap,
    first_row: u32,
    own: &Range<u32>,
) -> Vec<(usize, usize, Across)> {
    let near = segments
        .iter()
        .enumerate()
        .filter(|(_, segment)| segment.has_probes() && !segment.misses(own, height));
    let of_segment = |(index, segment): (usize, &PenSegment)| {
        let here = PROBES.iter().enumerate();
        let here = here.filter(|(_, part)| own.contains(&segment.probe_row(**part, height)));
        here.map(|(probe, part)| (index, probe, segment.width_at(*part, ink, first_row))).collect::<Vec<_>>()
    };
    near.flat_map(of_segment).collect()
}
