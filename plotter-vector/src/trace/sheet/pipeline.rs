//! [`SheetPipeline`]: a sheet that is on its way from rows to strokes.

use super::limits::{SheetLimits, ink_of, is_dense};
use super::step::Step;
use super::{SheetError, row_bytes};
use crate::areas::{Islands, Opening};
use crate::centreline::centrelines::{CONTEXT_ROWS, Centring, sort};
use crate::centreline::graph::{Fragment, Joiner, Rims, Scan, Stretch, fragments, pixel_fragments};
use crate::ink::pen::Pen;
use crate::ink::row_threshold::RowThreshold;
use crate::ink::row_window::RowWindow;
use crate::ink::speckle::despeckle_here;
use crate::parallel::each;
use crate::{
    ink::{Despeckled, context_rows},
    picture::{Gray, Row},
    stroke::Curve,
    trace::Ours,
};
use core::ops::Range;

/// Own rows of a band, bytes at 1 bit a pixel, and the fewest rows: less, and the context costs more than the
/// band; more, and the memory grows.
const BAND_BYTES: usize = 1 << 20;
/// The same with grey levels, which take eight times as much.
const GREY_BAND_BYTES: usize = 3 << 18;
const FEWEST_ROWS: u32 = 384;

/// The strokes of a sheet that is on its way.
pub(super) struct SheetPipeline<'a> {
    settings: &'a Ours,
    threshold: &'a RowThreshold,
    centring: Centring,
    smallest_px: u32,
    opening: Opening,
    /// Whether the lines are followed pixel by pixel.
    keeps_pixels: bool,
    width: u32,
    limits: SheetLimits,
    ink: RowWindow<u64>,
    levels: Option<RowWindow<u8>>,
    lines: RowWindow<u64>,
    skeleton: RowWindow<u64>,
    /// Memory of the bands: always the same, so that it does not fall to pieces.
    words: Vec<Vec<u64>>,
    clean: Step,
    thin: Step,
    follow: Step,
    islands: Islands,
    joiner: Joiner,
    strokes: Vec<Curve>,
    outlines: Vec<Curve>,
    /// Rows with areas.
    area_rows: Vec<Range<u32>>,
    /// What was taken for dirt.
    removed: Despeckled,
}

/// A sheet that has been worked on.
pub(super) struct Finished {
    pub(super) strokes: Vec<Curve>,
    /// Rows with areas, from the top.
    pub(super) area_rows: Vec<Range<u32>>,
    /// What was taken for dirt.
    pub(super) removed: Despeckled,
}

impl<'a> SheetPipeline<'a> {
    /// Before the first row; `keeps_pixels` follows the lines pixel by pixel.
    pub(super) fn new(
        settings: &'a Ours,
        (width, height): (u32, u32),
        (pen, keeps_pixels): (Pen, bool),
        threshold: &'a RowThreshold,
    ) -> Self {
        let smallest_px = settings.smallest_mark_px(pen.width_px);
        let centring = settings.centring_of(pen);
        let opening = settings.opening(pen);
        let row_bytes = row_bytes(width);
        let grey = threshold.has_greys();
        let band_bytes = if grey { GREY_BAND_BYTES } else { BAND_BYTES };
        let rows = u32::try_from(band_bytes / row_bytes).unwrap_or(u32::MAX).max(FEWEST_ROWS);
        let band_rows = rows.min(settings.band_rows).max(1);
        let step = |context: u32| Step::new(row_bytes, height, band_rows, context);
        let cleaning = context_rows(smallest_px).saturating_add(opening.rows_of_context());
        let thinning = centring.thinning.rows_of_context();
        let clean = step(cleaning).ahead_of(thinning.saturating_add(CONTEXT_ROWS));
        let (thin, follow) = (step(thinning).ahead_of(CONTEXT_ROWS), step(CONTEXT_ROWS));
        // What is thinned waits to be followed.
        let waiting = thin.most_rows().saturating_add(follow.most_rows()).min(height);
        Self {
            settings,
            threshold,
            smallest_px,
            opening,
            keeps_pixels,
            width,
            limits: SheetLimits::default(),
            ink: RowWindow::of_ink(width).with_room(clean.most_rows()),
            levels: grey.then(|| RowWindow::of_levels(width)),
            lines: RowWindow::of_ink(width).with_room(waiting),
            skeleton: RowWindow::of_ink(width).with_room(waiting),
            words: Vec::new(),
            clean,
            thin,
            follow,
            centring,
            islands: Islands::new(width),
            joiner: Joiner::default(),
            strokes: Vec::new(),
            outlines: Vec::new(),
            area_rows: Vec::new(),
            removed: Despeckled::default(),
        }
    }

    /// The next row.
    pub(super) fn push(&mut self, row: Row<'_>) -> Result<(), SheetError> {
        let y = self.ink.end();
        self.threshold.ink_of(y, row, self.width, self.ink.next_row());
        if let (Some(levels), Row::Grey(row)) = (&mut self.levels, row) {
            levels.push(row);
        }
        while let Some(bands) = self.clean.ready(self.ink.end()) {
            self.clean(bands)?;
        }
        while let Some(bands) = self.thin.ready(self.lines.end()) {
            self.thin(bands)?;
        }
        while let Some(bands) = self.follow.ready(self.skeleton.end().min(self.lines.end())) {
            self.follow(bands)?;
        }
        Ok(())
    }

    /// What there is after the last row.
    pub(super) fn finish(self) -> Result<Finished, SheetError> {
        let Self {
            settings,
            centring,
            mut limits,
            mut islands,
            joiner,
            mut strokes,
            mut outlines,
            area_rows,
            removed,
            ..
        } = self;
        // The bands' memory is free now.
        if let Some((first, areas)) = islands.finish() {
            let found = settings.area_strokes(first, &areas)?;
            limits.add(&found);
            outlines.extend(found);
        }
        let found = centring.simplified(joiner.finish().collect());
        limits.add(&found);
        limits.check(u32::MAX)?;
        strokes.extend(found);
        sort(&mut strokes);
        strokes.append(&mut outlines);
        Ok(Finished { strokes, area_rows, removed })
    }

    /// Bands with memory for each.
    fn with_words(&mut self, bands: Vec<Range<u32>>) -> Vec<(Range<u32>, Vec<u64>)> {
        bands.into_iter().map(|own| (own, self.words.pop().unwrap_or_default())).collect()
    }

    /// Removes speckles, and tells lines from areas.
    fn clean(&mut self, bands: Vec<Range<u32>>) -> Result<(), SheetError> {
        let bands = self.with_words(bands);
        let (step, ink, opening) = (self.clean, &self.ink, &self.opening);
        let smallest_px = self.smallest_px;
        let cleaned = each(bands, |(own, words)| {
            let rows = step.around(&own);
            let mut band = ink.band(&rows, words);
            let own = own.start - rows.start..own.end - rows.start;
            let removed = despeckle_here(&mut band, smallest_px, own.clone());
            let (lines, areas) = opening.split(band);
            (own, lines, areas, removed)
        });
        for (own, lines, areas, removed) in cleaned {
            self.removed = self.removed.and(removed);
            for y in own {
                let row = self.lines.end();
                self.lines.push(lines.row(y));
                let areas = areas.as_ref().map_or(&[][..], |areas| areas.row(y));
                if areas.iter().any(|bits| *bits != 0) {
                    match self.area_rows.last_mut().filter(|last| last.end == row) {
                        Some(last) => last.end += 1,
                        None => self.area_rows.push(row..row + 1),
                    }
                }
                if let Some((first, areas)) = self.islands.push(areas) {
                    let found = self.settings.area_strokes(first, &areas)?;
                    self.limits.add(&found);
                    self.outlines.extend(found);
                }
            }
            self.words.push(lines.into_words());
        }
        self.ink.forget_before(self.clean.needs());
        Ok(())
    }

    /// Thins the lines, but those that are followed pixel by pixel.
    fn thin(&mut self, bands: Vec<Range<u32>>) -> Result<(), SheetError> {
        let bands = self.with_words(bands);
        let (step, lines, thinning) = (self.thin, &self.lines, self.centring.thinning);
        let keeps_pixels = self.keeps_pixels;
        let thinned = each(bands, |(own, words)| {
            let rows = step.around(&own);
            let mut band = lines.band(&rows, words);
            let own = own.start - rows.start..own.end - rows.start;
            if !keeps_pixels {
                // Lines that are wider than expected stay so in places: their middle is found all the same.
                let _ = thinning.thin_rows(&mut band, own.clone());
            }
            (own, band)
        });
        for (own, band) in thinned {
            for y in own {
                self.limits.push(self.skeleton.end(), band.row(y))?;
                self.skeleton.push(band.row(y));
            }
            self.words.push(band.into_words());
        }
        self.lines.forget_before(self.follow.needs().min(self.thin.needs()));
        Ok(())
    }

    /// Follows the skeleton, and simplifies the strokes that are whole now: bands with many lines one after
    /// the other.
    fn follow(&mut self, bands: Vec<Range<u32>>) -> Result<(), SheetError> {
        let end = bands.last().map_or(0, |own| own.end);
        let pixels: u64 = bands.iter().map(|own| ink_of(self.skeleton.rows(&self.follow.around(own)))).sum();
        let together = if is_dense(pixels) { 1 } else { bands.len().max(1) };
        for some in bands.chunks(together) {
            let mut whole = Vec::new();
            for (fragments, words) in self.fragments(some.to_vec()) {
                self.words.push(words);
                whole.extend(fragments.into_iter().filter_map(|fragment| self.joiner.push(fragment)));
            }
            let found = self.centring.simplified(whole);
            self.limits.add(&found);
            self.strokes.extend(found);
            self.joiner.cut(self.centring.cuts(), self.centring.bounded);
        }
        self.limits.check(end)?;
        let needs = self.follow.needs();
        self.lines.forget_before(needs.min(self.thin.needs()));
        self.skeleton.forget_before(needs);
        if let Some(levels) = &mut self.levels {
            levels.forget_before(needs);
        }
        Ok(())
    }

    /// The fragments of strokes in bands, each with the memory it worked in.
    fn fragments(&mut self, bands: Vec<Range<u32>>) -> Vec<(Vec<Fragment>, Vec<u64>)> {
        let bands = self.with_words(bands);
        let (step, lines, skeleton) = (self.follow, &mut self.lines, &mut self.skeleton);
        let (ink_is_dark, keeps_pixels) = (self.threshold.ink_is_dark(), self.keeps_pixels);
        let (marks, hairlines) = (self.centring.marks(), self.centring.hairlines);
        let follow = |levels: Option<(&Gray, u32)>| {
            let grey = levels.map(|(levels, first_row)| Rims { levels, ink_is_dark, first_row });
            lines.lend(|ink, first_row| {
                let scan = Scan { ink, first_row, grey, hairlines };
                skeleton.lend(|picture, first_row| {
                    each(bands, |(own, mut words)| {
                        let rows = step.around(&own);
                        let rows = rows.start - first_row..rows.end - first_row;
                        let stretch = Stretch { picture, rows };
                        let found = if keeps_pixels {
                            pixel_fragments(&stretch, first_row, &own, &mut words)
                        } else {
                            fragments(scan, &stretch, first_row, &own, marks, &mut words)
                        };
                        (found, words)
                    })
                })
            })
        };
        match &mut self.levels {
            Some(levels) => levels.lend(|levels, first_row| follow(Some((levels, first_row)))),
            None => follow(None),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        ink::{Survey, Threshold},
        picture::{Bitmap, Pixel},
        stroke::PxPoint,
    };

    /// Rounding of what is promised exactly, px.
    const ROUNDING_PX: f64 = 1e-6;

    /// Lines one pixel wide in all directions, stairs, crossings, places where pixels lie two by two, dots.
    fn hairlines(seed: u64) -> Bitmap {
        let (width, height) = (150, 1300);
        let mut ink = Bitmap::new(width, height).unwrap();
        let mut random = seed;
        let mut next = |most: u32| {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            u32::try_from((random >> 11) % u64::from(most)).unwrap()
        };
        for _ in 0..40 {
            let (x, y) = (f64::from(next(width)), f64::from(next(height)));
            let angle = f64::from(next(628)) / 100.0;
            let turn = f64::from(next(3)) * 0.01;
            for step in 0..next(300) {
                let step = f64::from(step);
                let (sin, cos) = libm::sincos(angle + turn * step / 2.0);
                let (x, y) = (x + step * cos, y + step * sin);
                if x >= 0.0 && y >= 0.0 {
                    #[expect(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "near the picture"
                    )]
                    ink.set(Pixel::new(x as u32, y as u32), true);
                }
            }
        }
        for _ in 0..30 {
            ink.set(Pixel::new(next(width), next(height)), true);
        }
        ink
    }

    fn strokes(ink: &Bitmap, settings: &Ours) -> Vec<Curve> {
        let mut survey = Survey::checked(Threshold::default(), ink.width(), ink.height());
        (0..ink.height()).for_each(|y| survey.push_row(Row::Bits(ink.row(y))));
        let threshold = survey.finish().unwrap();
        let mut work =
            SheetPipeline::new(settings, (ink.width(), ink.height()), (Pen::of(ink), true), &threshold);
        (0..ink.height()).for_each(|y| work.push(Row::Bits(ink.row(y))).unwrap());
        work.finish().unwrap().strokes
    }

    fn distance_px(at: PxPoint, stroke: &[PxPoint]) -> f64 {
        let to_link = |pair: &[PxPoint]| {
            let (away, way) = (at - pair[0], pair[1] - pair[0]);
            let part = (away.dot(way) / way.length_squared().max(1e-9)).clamp(0.0, 1.0);
            (away - way * part).length()
        };
        let dot = stroke.first().map_or(f64::INFINITY, |first| first.distance(at));
        stroke.windows(2).map(to_link).fold(dot, f64::min)
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn every_pixel_of_a_hairline_lies_within_the_tolerance_whatever_the_bands() {
        for (seed, tolerance_px) in (1..).zip([0.5, 0.75, 1.0, 2.0, 0.5]) {
            let ink = hairlines(seed * 0x9e37_79b9);
            let settings = Ours::default().with_tolerance_px(tolerance_px);
            let found = strokes(&ink, &settings);
            let far = |at: Pixel| {
                let to_stroke = |stroke: &Curve| distance_px(at.into(), &stroke.vertices);
                found.iter().map(to_stroke).fold(f64::INFINITY, f64::min)
            };
            let worst_px = ink.ink().map(far).fold(0.0, f64::max);
            assert!(worst_px <= tolerance_px + ROUNDING_PX, "{tolerance_px}: {worst_px}");
            for band_rows in [16, 130] {
                assert!(strokes(&ink, &settings.with_band_rows(band_rows)) == found, "{band_rows}");
            }
        }
    }
}
