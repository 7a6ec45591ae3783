//! [`Work`]: a sheet that is on its way from rows to strokes.

use super::step::Step;
use super::{SheetError, row_bytes};
use crate::areas::{Islands, Opening};
use crate::centrelines::{CONTEXT_ROWS, Centring, each, sort};
use crate::graph::{Joiner, Rims, Scan, Stretch, fragments};
use crate::rolling::Rolling;
use crate::row_threshold::RowThreshold;
use crate::speckle::despeckle_here;
use crate::{Curve, Gray, Row, Vectorizer, context_rows};
use core::ops::Range;

/// Own rows of a band, bytes at 1 bit a pixel, and the fewest rows: less, and the context costs more than the band; more,
/// and the memory grows.
const BAND_BYTES: usize = 1 << 20;
/// The same with grey levels, which take eight times as much.
const GREY_BAND_BYTES: usize = 3 << 18;
const FEWEST_ROWS: u32 = 384;

/// The strokes of a sheet that is on its way.
pub(super) struct Work<'a> {
    settings: &'a Vectorizer,
    threshold: &'a RowThreshold,
    centring: Centring,
    smallest_px: u32,
    opening: Opening,
    width: u32,
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
    /// Rows with areas.
    area_rows: Vec<Range<u32>>,
}

impl<'a> Work<'a> {
    /// Before the first row.
    pub(super) fn new(
        settings: &'a Vectorizer,
        (width, height): (u32, u32),
        pen_px: u32,
        threshold: &'a RowThreshold,
    ) -> Self {
        let smallest_px = settings.smallest_mark_px(pen_px);
        let centring = Centring { redraw: true, ..settings.centring(settings.max_line_px(pen_px)) };
        let opening = settings.opening(pen_px);
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
            width,
            ink: Rolling::of_ink(width).with_room(clean.most_rows()),
            levels: grey.then(|| Rolling::of_levels(width)),
            lines: Rolling::of_ink(width).with_room(waiting),
            skeleton: Rolling::of_ink(width).with_room(waiting),
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
            self.thin(bands);
        }
        while let Some(bands) = self.follow.ready(self.skeleton.end().min(self.lines.end())) {
            self.follow(bands);
        }
        Ok(())
    }

    /// All strokes, after the last row, and the rows with areas, from the top.
    pub(super) fn finish(mut self) -> Result<(Vec<Curve>, Vec<Range<u32>>), SheetError> {
        if let Some((first, areas)) = self.islands.finish() {
            self.outlines.extend(self.settings.area_strokes(first, &areas)?);
        }
        let open = core::mem::take(&mut self.joiner).finish().collect();
        self.strokes.extend(self.centring.simplified(open));
        sort(&mut self.strokes);
        self.strokes.append(&mut self.outlines);
        Ok((self.strokes, self.area_rows))
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
            despeckle_here(&mut band, smallest_px);
            let (lines, areas) = opening.split(band);
            (own.start - rows.start..own.end - rows.start, lines, areas)
        });
        for (own, lines, areas) in cleaned {
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
                    self.outlines.extend(self.settings.area_strokes(first, &areas)?);
                }
            }
            self.words.push(lines.into_words());
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
            let own = own.start - rows.start..own.end - rows.start;
            // Lines that are wider than expected stay so in places: their middle is found all the same.
            let _ = thinning.thin_rows(&mut band, own.clone());
            (own, band)
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
        let ink_is_dark = self.threshold.ink_is_dark();
        let marks = self.centring.marks();
        let follow = |levels: Option<(&Gray, u32)>| {
            let grey = levels.map(|(levels, first_row)| Rims { levels, ink_is_dark, first_row });
            lines.lend(|ink, first_row| {
                let scan = Scan { ink, first_row, grey };
                skeleton.lend(|picture, first_row| {
                    each(bands, |(own, mut words)| {
                        let rows = step.around(&own);
                        let rows = rows.start - first_row..rows.end - first_row;
                        let stretch = Stretch { picture, rows };
                        (fragments(scan, &stretch, first_row, &own, marks, &mut words), words)
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
