//! [`Beyond`]: how far what the pens draw lies beside the ink.

use super::pen_segment::{Bend, PenSegment};
use super::segment_index::CELL_PX;
use super::{Index, SpotRun, with_widths};
use crate::{
    picture::{Bitmap, Pixel, runs::ink_runs},
    stroke::{Drawing, PxPoint, PxVec},
};
use core::ops::Range;

/// Ink is looked for no farther, px: strokes are made of ink, and what a pen draws this far from any is as
/// wrong as what lies farther.
pub(crate) const FARTHEST_PX: u32 = 16;

/// Half of the thinnest pen, px. Lines one pixel wide are measured without one, but drawn they are as wide as
/// their pixels.
const THINNEST_HALF_PX: f64 = 0.5;

/// Farthest that chords lie from an arc, and that steps of a pen that gets wider lie from it, px: a fifth of
/// what the raster leaves open.
const CHORD_PX: f64 = 0.1;

/// What the pens of a drawing draw where there is no ink, by the pixels whose middle they cover.
///
/// The distance of a pixel is that of its middle from the nearest pixel of ink, a square: a pixel beside ink
/// is half a one off, and what lies only beside a corner of ink 0.71. So half a pixel is what the raster
/// leaves open on any slope. No more than 16 px are told.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Beyond {
    /// Pixels that are drawn, each counted once, and are no ink.
    pub pixels: u64,
    /// Greatest distance of one of them from ink, px; 0 without.
    pub max_px: f64,
    /// Where that is, the first of several in reading order.
    pub worst: Option<Pixel>,
}

impl Beyond {
    /// Both together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let pixels = self.pixels.saturating_add(other.pixels);
        let place = |of: &Self| of.worst.map(|at| (at.y, at.x));
        let is_first = place(&other).is_none() || place(&self).is_some_and(|at| Some(at) <= place(&other));
        let mine = self.max_px > other.max_px || self.max_px >= other.max_px && is_first;
        Self { pixels, ..if mine { self } else { other } }
    }
}

/// What the pens of a drawing draw beside its ink. The pens are those of
/// [`coverage`](crate::report::coverage()).
///
/// ```
/// # use plotter_vector::{Bitmap, Drawing, Pixel, PxPoint, report::beyond_ink};
/// let bar = Bitmap::from_picture("###.....\n###.....\n###.....\n")?;
/// let mut drawing = Drawing::new(8, 3);
/// drawing.push([PxPoint::new(0.5, 1.5), PxPoint::new(6.5, 1.5)]); // four pixels too long
/// let beyond = beyond_ink(&bar, &drawing);
/// // The pen of 3 px covers the middles of the last column, at 7.5; the ink ends at 3.
/// assert_eq!((beyond.max_px, beyond.worst), (4.5, Some(Pixel::new(7, 0))));
/// # Ok::<(), plotter_vector::picture::SizeError>(())
/// ```
#[must_use]
pub fn beyond_ink(ink: &Bitmap, drawing: &Drawing) -> Beyond {
    with_widths(ink, drawing, None).beyond(ink, 0, &(0..ink.height()))
}

impl Index {
    /// What is drawn beside the ink in some rows of the picture. The first row of `ink` is row `first_row` of
    /// it; it has [`FARTHEST_PX`] rows more, above and below, where the picture has.
    pub(crate) fn beyond(&self, ink: &Bitmap, first_row: u32, rows: &Range<u32>) -> Beyond {
        let mut beyond = Beyond::default();
        let mut top = rows.start;
        while top < rows.end {
            let end = (top / CELL_PX + 1).saturating_mul(CELL_PX).min(rows.end);
            beyond = beyond.and(self.beyond_in(ink, first_row, top..end));
            top = end;
        }
        beyond
    }

    /// The same in one row of squares: so many runs of pixels are held at a time.
    fn beyond_in(&self, ink: &Bitmap, first_row: u32, rows: Range<u32>) -> Beyond {
        let drawn = self.drawn(ink.width(), rows, 0.0);
        let mut beyond = Beyond::default();
        let (mut row, mut past) = (u32::MAX, 0);
        for (y, from, to) in drawn {
            if y != row {
                (row, past) = (y, 0);
            }
            for x in from.max(past)..to {
                if ink.get(Pixel::new(x, y - first_row)) {
                    continue;
                }
                beyond.pixels += 1;
                let away_px = from_ink_px(ink, Pixel::new(x, y - first_row));
                if away_px > beyond.max_px {
                    (beyond.max_px, beyond.worst) = (away_px, Some(Pixel::new(x, y)));
                }
            }
            past = past.max(to);
        }
        beyond
    }

    /// Runs of ink in some rows of the picture that no pen comes nearer to than this, in reading order. The
    /// first row of `ink` is row `first_row` of it.
    pub(crate) fn bare_runs(
        &self,
        ink: &Bitmap,
        first_row: u32,
        rows: &Range<u32>,
        within_px: f64,
    ) -> Vec<SpotRun> {
        let mut bare = Vec::new();
        let mut top = rows.start;
        while top < rows.end {
            let end = (top / CELL_PX + 1).saturating_mul(CELL_PX).min(rows.end);
            let has_ink = |y: u32| ink.row(y - first_row).iter().any(|word| *word != 0);
            if (top..end).any(has_ink) {
                self.bare_in(ink, first_row, top..end, within_px, &mut bare);
            }
            top = end;
        }
        bare
    }

    /// The same in one row of squares.
    fn bare_in(
        &self,
        ink: &Bitmap,
        first_row: u32,
        rows: Range<u32>,
        within_px: f64,
        bare: &mut Vec<SpotRun>,
    ) {
        let drawn = self.drawn(ink.width(), rows.clone(), within_px);
        let mut next = 0;
        for y in rows {
            next += drawn.get(next..).map_or(0, |left| left.partition_point(|(row, ..)| *row < y));
            for run in ink_runs(ink.row(y - first_row)) {
                let mut at = run.start;
                let mut add = |columns: Range<u32>| {
                    if columns.start < columns.end {
                        bare.push(SpotRun { y, columns, max_px: 0.0 });
                    }
                };
                for (_, from, to) in drawn.get(next..).unwrap_or(&[]).iter().take_while(|(row, ..)| *row == y)
                {
                    add(at..(*from).min(run.end));
                    at = at.max(*to);
                }
                add(at..run.end);
            }
        }
    }

    /// What pens draw in some rows that lie within one row of squares, were each of them wider by this to
    /// either side: runs, sorted, which overlap.
    fn drawn(&self, width: u32, rows: Range<u32>, wider_px: f64) -> Vec<(u32, u32, u32)> {
        let mut drawn = Drawn { width, rows, wider_px, runs: Vec::new() };
        self.near(&drawn.rows).into_iter().for_each(|segment| drawn.segment(segment));
        drawn.runs.sort_unstable();
        drawn.runs
    }
}

/// Distance of a pixel's middle from the nearest pixel of ink, px.
fn from_ink_px(ink: &Bitmap, at: Pixel) -> f64 {
    let off = |steps: u32| (f64::from(steps) - 0.5).max(0.0);
    let mut least_px = f64::from(FARTHEST_PX);
    for down in 0..=FARTHEST_PX {
        if off(down) >= least_px {
            break;
        }
        let rows = [at.y.checked_sub(down), Some(at.y + down).filter(|y| *y < ink.height())];
        for y in rows.into_iter().flatten() {
            for aside in 0..=FARTHEST_PX {
                let away_px = libm::hypot(off(aside), off(down));
                if away_px >= least_px {
                    break;
                }
                let is_ink = |x: Option<u32>| {
                    x.filter(|x| *x < ink.width()).is_some_and(|x| ink.get(Pixel::new(x, y)))
                };
                if is_ink(at.x.checked_sub(aside)) || is_ink(at.x.checked_add(aside)) {
                    least_px = away_px;
                    break;
                }
            }
        }
    }
    least_px
}

/// Runs of pixels that are drawn: row, first pixel, one past the last.
struct Drawn {
    width: u32,
    rows: Range<u32>,
    /// How much farther than its pen a line reaches, px.
    wider_px: f64,
    runs: Vec<(u32, u32, u32)>,
}

impl Drawn {
    fn segment(&mut self, segment: &PenSegment) {
        if let Bend::Arc(arc) = &segment.bend {
            let count = arc.chords(CHORD_PX);
            let mut from = arc.from;
            for chord in 1..=count {
                let to = arc.at(f64::from(chord) / f64::from(count));
                self.line(from, to, segment.slack_px);
                from = to;
            }
            return;
        }
        let (from, to) = (segment.from, segment.to);
        let Some(knots) = segment.knots() else { return self.line(from, to, segment.slack_px) };
        let at = |part: f64| from + (to - from) * part;
        for pair in knots.windows(2) {
            let [(start, slack_px), (end, next_px)] = pair else { continue };
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "of half widths of at most 96 px"
            )]
            let pieces = (((next_px - slack_px).abs() / CHORD_PX) as u32).saturating_add(1);
            let share = |piece: u32| f64::from(piece) / f64::from(pieces);
            for piece in 0..pieces {
                let part = |piece: u32| start + (end - start) * share(piece);
                let middle = 0.5 * (share(piece) + share(piece + 1));
                let half_px = slack_px + (next_px - slack_px) * middle;
                self.line(at(part(piece)), at(part(piece + 1)), half_px);
            }
        }
    }

    /// What a round pen covers on a straight line.
    fn line(&mut self, from: PxPoint, to: PxPoint, half_px: f64) {
        let half_px = half_px.max(THINNEST_HALF_PX) + self.wider_px;
        let way = to - from;
        let length = way.length();
        // To its left; upwards for a dot, whose sides are one point.
        let aside =
            if length > 0.0 { way.perpendicular() * half_px / length } else { PxVec::new(0.0, half_px) };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
        let first_past = |v: f64| libm::ceil(v - 0.5).max(0.0) as u32;
        let (top, bottom) = (from.y.min(to.y) - half_px, from.y.max(to.y) + half_px);
        for row in first_past(top).max(self.rows.start)..first_past(bottom).min(self.rows.end) {
            let level = f64::from(row) + 0.5;
            let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
            let mut reach = |x: f64| (least, most) = (least.min(x), most.max(x));
            for end in [from, to] {
                let off = level - end.y;
                if off.abs() <= half_px {
                    let wide = libm::sqrt(half_px * half_px - off * off);
                    reach(end.x - wide);
                    reach(end.x + wide);
                }
            }
            for side in [1.0, -1.0] {
                let (a, b) = (from + aside * side, way);
                let part = if b.y == 0.0 { f64::NAN } else { (level - a.y) / b.y };
                if (0.0..=1.0).contains(&part) {
                    reach(a.x + b.x * part);
                }
            }
            let run = (row, first_past(least), first_past(most).min(self.width));
            if least < most && run.1 < run.2 {
                self.runs.push(run);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::coverage;
    use crate::report::coverage::segments;

    fn disc_line(drawing: &Drawing, half_px: f64, at: Pixel) -> bool {
        let place = PxPoint::from(at);
        drawing.strokes().any(|stroke| {
            stroke.windows(2).any(|ends| {
                let (away, way) = (place - ends[0], ends[1] - ends[0]);
                let part = (away.dot(way) / way.length_squared()).clamp(0.0, 1.0);
                (away - way * part).length() <= half_px
            })
        })
    }

    /// A zigzag of a pen of 5 px, drawn by its own line: every pixel whose middle lies in the pen is its ink.
    #[test]
    fn the_pen_on_its_own_ink_draws_no_more_than_that() {
        let mut drawing = Drawing::new(160, 120);
        drawing.push(
            [(20.3, 20.9), (130.2, 40.4), (31.7, 70.1), (30.9, 100.6), (140.0, 100.6)]
                .map(|(x, y)| PxPoint::new(x, y)),
        );
        let mut ink = Bitmap::new(160, 120).unwrap();
        for (x, y) in (0..120).flat_map(|y| (0..160).map(move |x| (x, y))) {
            ink.set(Pixel::new(x, y), disc_line(&drawing, 2.5, Pixel::new(x, y)));
        }
        let mut index = Index::new(segments(&drawing), 160, 120);
        index.segments.iter_mut().for_each(|segment| segment.slack_px = 2.5);
        assert_eq!(index.beyond(&ink, 0, &(0..120)), Beyond::default());
        // And all of it: without the ink, just as many pixels are drawn.
        let empty = Bitmap::new(160, 120).unwrap();
        let all = index.beyond(&empty, 0, &(0..120));
        assert_eq!((all.pixels, all.max_px), (ink.count(), f64::from(FARTHEST_PX)));
        // Row by row the same.
        let rows = (0..120).map(|y| index.beyond(&empty, 0, &(y..y + 1)));
        assert_eq!(rows.fold(Beyond::default(), Beyond::and), all);
    }

    #[test]
    fn a_stroke_over_a_gap_is_seen_in_its_middle() {
        // Two lines of 5 px with 7 px between them, and a third stroke in the gap.
        let mut ink = Bitmap::new(200, 40).unwrap();
        for (x, y) in (0..40).flat_map(|y| (10..190).map(move |x| (x, y))) {
            ink.set(Pixel::new(x, y), (10..15).contains(&y) || (22..27).contains(&y));
        }
        let line = |y: f64| [PxPoint::new(12.5, y), PxPoint::new(187.5, y)];
        let mut drawing = Drawing::new(200, 40);
        drawing.push(line(12.5));
        drawing.push(line(24.5));
        assert!(beyond_ink(&ink, &drawing).max_px <= 0.71, "{:?}", beyond_ink(&ink, &drawing));
        drawing.push(line(18.5));
        // Its pen is half a pixel to either side: rows 18 only, 3.5 px from both.
        let beyond = beyond_ink(&ink, &drawing);
        assert_eq!((beyond.max_px, beyond.worst.map(|at| at.y)), (3.5, Some(18)));
        assert!(coverage(&ink, &drawing).max_px < 1.0);
    }
}
