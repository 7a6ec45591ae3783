//! [`Index`]: finds the segments of a drawing near a point, by a grid of squares.

use super::pen_segment::{Bend, PenSegment};
use super::pen_widths::pen_half_px;
use crate::{picture::Pixel, stroke::PxPoint};
use core::ops::Range;

/// Side of the squares in which segments are looked up, px.
pub(super) const CELL_PX: u32 = 32;

/// Greatest distance of an arc from the chords by which it is entered into squares, px: far less than a
/// square.
const CHORD_ERROR_PX: f64 = 1.0;

/// The segments of a drawing, with a list of those in each square of the picture.
#[derive(Debug)]
pub(crate) struct Index {
    pub(super) segments: Vec<PenSegment>,
    /// Half the pen width of most lines, px.
    pub(crate) pen_half_px: f64,
    /// How much smaller a segment's error may be than the distance of its squares, px: half of its width, and
    /// the distance of an arc from its chords.
    reach_px: f64,
    columns: u32,
    rows: u32,
    /// For each square the end of its list in `entries`; it begins where the one before ends.
    ends: Vec<usize>,
    /// Numbers of segments, square by square.
    entries: Vec<u32>,
}

impl Index {
    /// The index of `segments` in a picture of `width` by `height` px.
    pub(crate) fn new(segments: Vec<PenSegment>, width: u32, height: u32) -> Self {
        let columns = width.div_ceil(CELL_PX).max(1);
        let rows = height.div_ceil(CELL_PX).max(1);
        // Entries are counted first and filled in afterwards, so that two vectors are enough.
        let mut ends = vec![0_usize; columns as usize * rows as usize];
        for segment in &segments {
            for_each_square(segment, columns, rows, |square| {
                if let Some(count) = ends.get_mut(square) {
                    *count += 1;
                }
            });
        }
        let mut sum = 0;
        for end in &mut ends {
            let count = *end;
            *end = sum;
            sum += count;
        }
        let mut entries = vec![0_u32; sum];
        for (index, segment) in (0..).zip(&segments) {
            for_each_square(segment, columns, rows, |square| {
                if let Some(end) = ends.get_mut(square) {
                    if let Some(entry) = entries.get_mut(*end) {
                        *entry = index;
                    }
                    *end += 1;
                }
            });
        }
        let widest_px = segments.iter().map(|segment| segment.slack_px).fold(0.0, f64::max);
        let pen_half_px = pen_half_px(segments.iter()).unwrap_or(0.0);
        Self { segments, pen_half_px, reach_px: widest_px + CHORD_ERROR_PX, columns, rows, ends, entries }
    }

    /// Numbers of the segments in a square.
    fn square(&self, column: u32, row: u32) -> &[u32] {
        let index = row as usize * self.columns as usize + column as usize;
        let start = index.checked_sub(1).and_then(|before| self.ends.get(before)).copied().unwrap_or(0);
        self.ends.get(index).and_then(|end| self.entries.get(start..*end)).unwrap_or(&[])
    }

    /// The segments whose pens may reach into these rows of the picture, which lie in one row of squares.
    pub(super) fn near(&self, rows: &Range<u32>) -> Vec<&PenSegment> {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "of half widths of at most 96 px"
        )]
        let reach = (self.reach_px / f64::from(CELL_PX)) as u32 + 1;
        let (first, last) = (rows.start / CELL_PX, rows.end.saturating_sub(1) / CELL_PX);
        let squares = first.saturating_sub(reach)..=last.saturating_add(reach).min(self.rows - 1);
        let entries =
            squares.flat_map(|row| (0..self.columns).flat_map(move |column| self.square(column, row)));
        let mut near: Vec<u32> = entries.copied().collect();
        near.sort_unstable();
        near.dedup();
        near.into_iter().filter_map(|index| self.segments.get(index as usize)).collect()
    }

    /// Half width at `at` of the segment that covers this point best, px.
    pub(crate) fn slack_px(&self, at: PxPoint) -> f64 {
        let mut nearest = 0;
        self.error_px(at, &mut nearest);
        self.segments.get(nearest).map_or(0.0, |segment| segment.slack_at(at))
    }

    /// Hands the pixels of a run of ink in row `y` that have an error to `add`, from the left, and returns
    /// the number of those without. `covering` is as in [`Self::error_px`].
    pub(crate) fn run_errors(
        &self,
        run: Range<u32>,
        y: u32,
        covering: &mut usize,
        mut add: impl FnMut(Pixel, f64),
    ) -> u64 {
        let mut exact = 0;
        let mut x = run.start;
        while x < run.end {
            let at = Pixel::new(x, y);
            let error_px = self.error_px(at.into(), covering);
            if error_px > 0.0 {
                add(at, error_px);
                x += 1;
                continue;
            }
            let past = self.covered_to(x..run.end, y, *covering);
            exact += u64::from(past - x);
            x = past;
        }
        exact
    }

    /// The end of those pixels of a run that a segment covers; the first one has no error. A straight segment
    /// covers a convex area, so all pixels between two covered ones are covered: the end is found by halving.
    fn covered_to(&self, run: Range<u32>, y: u32, segment: usize) -> u32 {
        let (mut covered, mut open) = (run.start, run.end);
        let Some(segment) = self.segments.get(segment) else { return covered + 1 };
        let covers = |x: u32| segment.covers(Pixel::new(x, y).into());
        if !covers(covered) {
            return covered + 1;
        }
        if covers(open - 1) {
            return open;
        }
        while open - covered > 1 {
            let middle = covered + (open - covered) / 2;
            if covers(middle) {
                covered = middle;
            } else {
                open = middle;
            }
        }
        open
    }

    /// The least error of a point over all segments, px.
    ///
    /// `covering` is the segment that covered the point before. It is tried first, for it mostly covers this
    /// one too, and becomes the segment that covers this point best.
    pub(crate) fn error_px(&self, at: PxPoint, covering: &mut usize) -> f64 {
        if self.segments.is_empty() {
            return at.distance(PxPoint::default());
        }
        if self.segments.get(*covering).is_some_and(|segment| segment.error_px(at, f64::MIN_POSITIVE) == 0.0)
        {
            return 0.0;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
        let (column, row) = ((at.x / f64::from(CELL_PX)) as u32, (at.y / f64::from(CELL_PX)) as u32);
        let mut least = f64::INFINITY;
        let mut ring = 0;
        // Distance of a coordinate from a row or column of squares.
        let away = |square: u32, v: f64| {
            let low = f64::from(square) * f64::from(CELL_PX);
            (low - v).max(v - low - f64::from(CELL_PX))
        };
        // Squares of ring k are at least k - 1 squares away.
        while ring <= self.columns.max(self.rows) {
            if ring > 0 && least + self.reach_px <= f64::from((ring - 1) * CELL_PX) {
                break;
            }
            for y in row.saturating_sub(ring)..=(row + ring).min(self.rows - 1) {
                let on_rim = y.abs_diff(row) == ring;
                let step = if on_rim || ring == 0 { 1 } else { 2 * ring };
                let mut x = i64::from(column) - i64::from(ring);
                while x <= i64::from(column) + i64::from(ring) {
                    if let Some(x) = u32::try_from(x).ok().filter(|x| *x < self.columns) {
                        let nearest_px = away(x, at.x).max(away(y, at.y));
                        let near = if nearest_px < least + self.reach_px { self.square(x, y) } else { &[] };
                        for index in near {
                            let Some(segment) = self.segments.get(*index as usize) else { continue };
                            let error_px = segment.error_px(at, least);
                            if error_px < least {
                                (least, *covering) = (error_px, *index as usize);
                            }
                            if least == 0.0 {
                                return 0.0;
                            }
                        }
                    }
                    x += i64::from(step);
                }
            }
            ring += 1;
        }
        if least.is_finite() { least } else { at.distance(PxPoint::default()) }
    }
}

/// Visits the squares into which a segment is entered; for an arc those of its chords, whose distance from
/// the arc the search allows for (`reach_px`).
fn for_each_square(segment: &PenSegment, columns: u32, rows: u32, mut visit: impl FnMut(usize)) {
    let Bend::Arc(arc) = &segment.bend else {
        for_each_touched((segment.from, segment.to), columns, rows, &mut visit);
        return;
    };
    let count = arc.chords(CHORD_ERROR_PX);
    let mut from = arc.from;
    for chord in 1..=count {
        let to = arc.at(f64::from(chord) / f64::from(count));
        for_each_touched((from, to), columns, rows, &mut visit);
        from = to;
    }
}

/// Visits the squares that a line touches, row by row, so that a long slope has few.
fn for_each_touched((from, to): (PxPoint, PxPoint), columns: u32, rows: u32, visit: &mut impl FnMut(usize)) {
    let side = f64::from(CELL_PX);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
    let cell = |v: f64, most: u32| ((v / side).max(0.0) as u32).min(most - 1);
    let (top, bottom) = (from.y.min(to.y), from.y.max(to.y));
    let (x, y) = (to.x - from.x, to.y - from.y);
    for row in cell(top, rows)..=cell(bottom, rows) {
        // Where the segment enters and leaves this row of squares.
        let (upper, lower) = (f64::from(row) * side, f64::from(row + 1) * side);
        let at = |level: f64| {
            let t = if y == 0.0 { 0.0 } else { ((level - from.y) / y).clamp(0.0, 1.0) };
            from.x + x * t
        };
        let (a, b) = if y == 0.0 { (from.x, to.x) } else { (at(upper), at(lower)) };
        for column in cell(a.min(b), columns)..=cell(a.max(b), columns) {
            visit(row as usize * columns as usize + column as usize);
        }
    }
}
