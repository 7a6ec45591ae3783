//! [`Step`]: a step of the work on a sheet, band after band.

use crate::parallel::threads;
use core::ops::Range;

/// Rows of all bands that are worked on at a time, bytes at 1 bit a pixel: of a large sheet they are fewer
/// than the threads.
const BANDS_BYTES: usize = 5 << 20;

/// A step of the work: which rows it takes next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    next: u32,
    /// Own rows of a band, and rows more that it needs above and below.
    band_rows: u32,
    context: u32,
    /// Rows that a first band takes by itself: so many that the rows which are there are ever after just
    /// those that the next step waits for, and no more of them lie about.
    lead: u32,
    /// Bands that are worked on at a time.
    bands: u32,
    height: u32,
}

impl Step {
    /// Bands of `band_rows` rows and a context, of a sheet of `height` rows of so many bytes.
    pub(super) fn new(row_bytes: usize, height: u32, band_rows: u32, context: u32) -> Self {
        let rows = context.saturating_mul(2).saturating_add(band_rows).min(height);
        let bands = threads().min(BANDS_BYTES / (row_bytes * rows as usize).max(1)).max(1);
        Self { next: 0, band_rows, context, lead: 0, bands: u32::try_from(bands).unwrap_or(1), height }
    }

    /// The same with so many rows in a first band of its own: the context of the steps after it.
    pub(super) fn ahead_of(self, context: u32) -> Self {
        Self { lead: context, ..self }
    }

    /// Most rows that it waits for at a time, with those around them.
    pub(super) fn most_rows(&self) -> u32 {
        let own = self.bands.saturating_mul(self.band_rows).max(self.lead);
        own.saturating_add(self.context.saturating_mul(2)).min(self.height)
    }

    /// The bands that can be worked on when the rows before `end` are there: as many as are worked on at a
    /// time, or those that are left at the end of the sheet.
    pub(super) fn ready(&mut self, end: u32) -> Option<Vec<Range<u32>>> {
        let rows = if self.lead > 0 { self.lead } else { self.bands.saturating_mul(self.band_rows) };
        let own = self.next..self.next.saturating_add(rows).min(self.height);
        if own.is_empty() || end < own.end.saturating_add(self.context).min(self.height) {
            return None;
        }
        (self.next, self.lead) = (own.end, 0);
        // Of about the same height, so that no thread waits long for another.
        let count = (own.end - own.start).div_ceil(self.band_rows);
        let rows = (own.end - own.start).div_ceil(count);
        let band = |start: u32| start..start.saturating_add(rows).min(own.end);
        Some(own.clone().step_by(rows as usize).map(band).collect())
    }

    /// The rows of a band with its context.
    pub(super) fn around(&self, own: &Range<u32>) -> Range<u32> {
        own.start.saturating_sub(self.context)..own.end.saturating_add(self.context).min(self.height)
    }

    /// First row that this step still needs.
    pub(super) fn needs(&self) -> u32 {
        self.next.saturating_sub(self.context)
    }
}
