//! [`coverage`]: how far every pixel of the ink lies from the drawing.

use crate::areas::Opening;
use crate::curve::Piece;
use crate::runs::ink_runs;
use crate::{Arc, Bitmap, Cubic, Drawing, ErrorReport, ErrorTally, Pixel, PxPoint};
use core::ops::Range;

/// Side of the squares in which segments are looked up, px.
const CELL_PX: u32 = 32;

/// Farthest that the chords by which an arc is looked up lie from it, px: far less than a square.
const CHORD_ERROR_PX: f64 = 1.0;

/// Farthest that the chords of a cubic curve, from which distances are measured, lie from it, px.
const CUBIC_ERROR_PX: f64 = 0.005;

/// Part of a square of a distance that is more than all roundings: the root, which is slow, is needed only this near to a
/// border.
const ROUNDING: f64 = 1e-9;

/// Farthest that the ink's edges are looked for across a segment, px.
const MAX_HALF_PX: f64 = 96.0;

/// Errors of all pixels of the ink that a drawing stands for, whatever way it was made; the inside of an area that is
/// outlined counts, too, which [`Vectorized::error`](crate::Vectorized::error) leaves out.
///
/// A pen w px wide that follows the segment covers what lies up to w / 2 from it; the error of a pixel is
/// what the distance of its centre is more than that. On lines one pixel wide it is the distance itself; from
/// there to 1.5 px the pen covers more and more. The width is that of the line: measured on the ink, across
/// the stroke, where the stroke is not two lines that run into one. Arcs are measured as arcs, cubic curves
/// as chords no farther than 0.005 px from them.
///
/// ```
/// # use plotter_vector::{Bitmap, Drawing, PxPoint, coverage};
/// let bar = Bitmap::from_picture("######\n######\n######\n")?;
/// let mut drawing = Drawing::new(6, 3);
/// drawing.push([PxPoint::new(0.5, 1.5), PxPoint::new(2.5, 1.5)]); // three pixels too short
/// let errors = coverage(&bar, &drawing);
/// assert_eq!((errors.pixels, errors.max_px), (18, 10.0_f64.sqrt() - 1.5));
/// # Ok::<(), plotter_vector::SizeError>(())
/// ```
#[must_use]
pub fn coverage(ink: &Bitmap, drawing: &Drawing) -> ErrorReport {
    let mut tally = ErrorTally::default();
    add_coverage(ink, drawing, None, &mut tally);
    tally.report()
}

/// The pieces of a drawing of this ink with the ink's widths, to be looked up by place.
pub(crate) fn with_widths(ink: &Bitmap, drawing: &Drawing, areas: Option<AreaPen<'_>>) -> Index {
    let mut segments = segments(drawing);
    let widths = segments.iter().map(|segment| {
        if segment.has_probes() {
            PROBES.map(|part| segment.width_at(part, ink, 0))
        } else {
            [Across::default(); PROBES.len()]
        }
    });
    let widths: Vec<_> = widths.collect();
    set_widths(&mut segments, &widths, areas);
    Index::new(segments, ink.width(), ink.height())
}

/// The pixel with the greatest error of [`coverage`], the first of several in reading order, and its error, px; none
/// without ink.
///
/// ```
/// # use plotter_vector::{Bitmap, Drawing, Pixel, PxPoint, worst_pixel};
/// let dots = Bitmap::from_picture("#....#\n")?;
/// let mut drawing = Drawing::new(6, 1);
/// drawing.push([PxPoint::new(0.5, 0.5)]);
/// assert_eq!(worst_pixel(&dots, &drawing), Some((Pixel::new(5, 0), 5.0)));
/// # Ok::<(), plotter_vector::SizeError>(())
/// ```
#[must_use]
pub fn worst_pixel(ink: &Bitmap, drawing: &Drawing) -> Option<(Pixel, f64)> {
    let mut tally = ErrorTally::default();
    add_coverage(ink, drawing, None, &mut tally);
    tally.worst()
}

/// What told areas from lines, and the pen that draws their outlines and hatching.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AreaPen<'a> {
    pub(crate) opening: &'a Opening,
    pub(crate) pen_px: f64,
    /// Whether lines one pixel wide are their pixels.
    pub(crate) is_raster: bool,
}

/// Adds the errors of [`coverage`] to others. Where areas are drawn as such, the ink inside
/// of them does not count, only that at their edge, and their outline is as wide as its pen.
pub(crate) fn add_coverage(
    ink: &Bitmap,
    drawing: &Drawing,
    areas: Option<AreaPen<'_>>,
    tally: &mut ErrorTally,
) {
    let index = with_widths(ink, drawing, areas);
    let counted = areas.map(|areas| areas.opening.without_insides(ink.clone()));
    let ink = counted.as_ref().unwrap_or(ink);
    let mut covering = 0;
    for y in 0..ink.height() {
        for run in ink_runs(ink.row(y)) {
            // The first of several worst ones in reading order, if none has an error.
            tally.note_worst(Pixel::new(run.start, y), 0.0);
            let exact = index.run_errors(run, y, &mut covering, |at, error_px| tally.add_pixel(at, error_px));
            tally.add_exact(exact);
        }
    }
}

/// Where along a segment the ink's width is measured: not evenly, for lines that cross it do.
pub(crate) const PROBES: [f64; 8] = [0.055, 0.17, 0.29, 0.42, 0.53, 0.66, 0.79, 0.93];

/// How exactly the width is measured, px, and rows above and below a probe that it may ask for.
const STEP_PX: f64 = 0.25;
pub(crate) const PROBE_ROWS: u32 = 98;

/// The ink across a segment, in steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Across {
    /// From edge to edge.
    width: u16,
    /// From the segment to the nearer edge.
    nearer: u16,
}

/// A straight line, an arc or a chord of a cubic curve, and how far to its side its pen covers the ink, px.
#[derive(Clone, Debug)]
pub(crate) struct Segment {
    from: PxPoint,
    to: PxPoint,
    slack_px: f64,
    bend: Bend,
    /// Whether it is the first of a stroke.
    begins: bool,
}

/// What a segment is.
#[derive(Clone, Debug)]
enum Bend {
    Straight,
    Arc(Box<Arc>),
    /// The first chord of a cubic curve, whose width is measured along the whole of it.
    Cubic(Box<Cubic>),
    /// A further chord of the same curve.
    Chord,
}

/// All pieces of a drawing, as if the ink were one pixel wide.
pub(crate) fn segments(drawing: &Drawing) -> Vec<Segment> {
    let mut segments = Vec::new();
    for index in 0..drawing.strokes().len() {
        let stroke = drawing.stroke(index);
        let dot = stroke.first().filter(|_| stroke.len() == 1).map(|at| Piece::Line(*at, *at));
        let first = segments.len();
        for piece in drawing.course(index).pieces().chain(dot) {
            add_segments(piece, &mut segments);
        }
        if let Some(segment) = segments.get_mut(first) {
            segment.begins = true;
        }
    }
    segments
}

/// What a piece of a stroke is looked up by: itself, or its chords.
fn add_segments(piece: Piece, segments: &mut Vec<Segment>) {
    let mut add = |from, to, bend| segments.push(Segment { from, to, slack_px: 0.0, bend, begins: false });
    match piece {
        Piece::Line(from, to) => add(from, to, Bend::Straight),
        Piece::Arc(arc) => add(arc.from, arc.to, Bend::Arc(Box::new(arc))),
        Piece::Cubic(cubic) => {
            let mut from = cubic.from;
            for (index, to) in piece.chords(CUBIC_ERROR_PX).enumerate() {
                add(from, to, if index == 0 { Bend::Cubic(Box::new(cubic)) } else { Bend::Chord });
                from = to;
            }
        }
    }
}

/// The part of a stroke's length that is no wider than it: of one whose width is not steady, for two lines
/// run into one there.
const NARROW: f64 = 0.15;

/// Between these parts a steady width differs by no more than a share of it and the raster's jumps, px.
const SPREAD: [f64; 2] = [0.2, 0.8];
const STEADY_SHARE: f64 = 0.2;
const RASTER_PX: f64 = 1.25;

/// A stroke that is shorter than so many halves of its width is no wider line but a dot, or lines of the pen
/// that run into one; it is taken for no wider than so many pens.
const SHORT_HALVES: f64 = 16.0;
const WIDEST_SHORT: f64 = 1.25;

/// A stroke that is drawn beside the middle of its ink is no wider than twice its distance from the nearer
/// edge and this, px.
const BESIDE_PX: f64 = 1.5;

/// Takes how far the pen of each stroke covers from the widths at its segments' probes.
pub(crate) fn set_widths(
    segments: &mut [Segment],
    widths: &[[Across; PROBES.len()]],
    areas: Option<AreaPen<'_>>,
) {
    let mut next = 0;
    let mut strokes = Vec::new();
    while next < segments.len() {
        let rest = segments.get(next + 1..).unwrap_or(&[]);
        let end = next + 1 + rest.iter().take_while(|segment| !segment.begins).count();
        if let (Some(stroke), Some(widths)) = (segments.get_mut(next..end), widths.get(next..end)) {
            set_width(stroke, widths, areas);
            strokes.push(next..end);
        }
        next = end;
    }
    // A dot and a short stroke are made by the pen that has drawn the lines.
    let Some(pen_px) = pen_half_px(segments) else { return };
    for stroke in strokes {
        let Some(stroke) = segments.get_mut(stroke) else { continue };
        let length_px: f64 = stroke.iter().map(Segment::length_px).sum();
        for piece in stroke.iter_mut().filter(|piece| length_px < SHORT_HALVES * piece.slack_px) {
            piece.slack_px = piece.slack_px.min(WIDEST_SHORT * pen_px + STEP_PX);
        }
    }
}

/// How far the pen of most of the lines covers, px; none without lines.
fn pen_half_px(segments: &[Segment]) -> Option<f64> {
    let lines = segments.iter().map(|piece| (piece.slack_px, piece.length_px()));
    let mut lines: Vec<_> = lines.filter(|(_, length_px)| *length_px > 0.0).collect();
    lines.sort_unstable_by(|one, other| one.0.total_cmp(&other.0));
    at_part(&lines, 0.5)
}

/// The value up to which a part of the lengths lies: values in rising order, each with its length.
fn at_part(values: &[(f64, f64)], part: f64) -> Option<f64> {
    let all_px: f64 = values.iter().map(|(_, share_px)| share_px).sum();
    let mut sum_px = 0.0;
    let found = values.iter().find(|(_, share_px)| {
        sum_px += share_px;
        sum_px >= part * all_px
    });
    found.or(values.last()).map(|(value, _)| *value)
}

/// The same of one stroke.
fn set_width(stroke: &mut [Segment], widths: &[[Across; PROBES.len()]], areas: Option<AreaPen<'_>>) {
    // No width greater than that can be measured.
    let widest_line_px =
        areas.map_or(f64::INFINITY, |areas| areas.opening.widest_line_px().min(2.0 * MAX_HALF_PX - 1.0));
    let median_px = |mut at: [Across; PROBES.len()]| {
        at.sort_unstable();
        let [_, _, _, _, median, ..] = at;
        STEP_PX * f64::from(median.width)
    };
    // Where it is the border of an area, its pen is that of the areas.
    let is_raster = areas.is_none_or(|areas| areas.is_raster);
    let area = areas.map(|areas| slack_of(areas.pen_px, true));
    let is_area = |width_px: f64| area.is_some() && width_px > widest_line_px;
    let mut across = Vec::new();
    for (segment, widths) in stroke.iter().zip(widths).filter(|(segment, _)| segment.has_probes()) {
        if is_area(median_px(*widths)) {
            continue;
        }
        let share_px = segment.length_px().max(ROUNDING);
        // Where the stroke goes over paper it tells nothing.
        across.extend(widths.iter().filter(|at| at.width > 0).map(|at| {
            let beside_px = 2.0 * STEP_PX * f64::from(at.nearer) + BESIDE_PX;
            ((STEP_PX * f64::from(at.width)).min(beside_px), share_px)
        }));
    }
    across.sort_unstable_by(|one, other| one.0.total_cmp(&other.0));
    let at = |part: f64| at_part(&across, part).unwrap_or(0.0);
    let [low_px, high_px] = SPREAD.map(at);
    let typical_px = mean_between(&across, [low_px, high_px]);
    let is_steady = high_px - low_px <= STEADY_SHARE * typical_px + RASTER_PX;
    let slack_px = slack_of(
        if is_steady { typical_px } else { typical_px.min(at(NARROW) + 0.5 * RASTER_PX) },
        is_raster,
    );
    let mut slack = slack_px;
    for (segment, widths) in stroke.iter_mut().zip(widths) {
        if segment.has_probes() {
            slack = area.filter(|_| is_area(median_px(*widths))).unwrap_or(slack_px);
        }
        segment.slack_px = slack;
    }
}

/// The mean of the widths between two, each with its share of the length, px: of a raster line that jumps
/// from width to width.
fn mean_between(across: &[(f64, f64)], [low_px, high_px]: [f64; 2]) -> f64 {
    let some = across.iter().filter(|(width_px, _)| (low_px..=high_px).contains(width_px));
    let (sum, all_px) = some.fold((0.0, 0.0), |(sum, all_px), (width_px, share_px)| {
        (sum + width_px * share_px, all_px + share_px)
    });
    if all_px > 0.0 { sum / all_px } else { 0.0 }
}

/// How far to its side a pen covers, px: half its width; but of a raster line one pixel wide only the middles
/// of its pixels.
fn slack_of(width_px: f64, is_raster: bool) -> f64 {
    /// A raster line one pixel wide is in the mean no wider, px, and from 1.5 px on it is that of a pen.
    const ONE_PX: f64 = 1.2;
    const SLOPE: f64 = 2.5;
    let half_px = 0.5 * width_px;
    if is_raster { half_px.min(SLOPE * (width_px - ONE_PX)).max(0.0) } else { half_px }
}

impl Segment {
    /// Whether the ink's width is measured along it; else it is that of the segment before.
    pub(crate) fn has_probes(&self) -> bool {
        !matches!(self.bend, Bend::Chord)
    }

    /// The place of the probe at a part of its length, 0 to 1, and its direction there.
    fn place(&self, part: f64) -> (PxPoint, (f64, f64)) {
        match &self.bend {
            Bend::Straight | Bend::Chord => {}
            Bend::Arc(arc) => {
                let at = arc.at(part);
                let (x, y) = at.minus(arc.centre);
                return (at, (-y / arc.radius_px, x / arc.radius_px));
            }
            Bend::Cubic(cubic) => return (cubic.at(part), cubic.heading(part)),
        }
        let (from, to) = (self.from, self.to);
        let length = from.distance(to);
        let direction =
            if length > 0.0 { ((to.x - from.x) / length, (to.y - from.y) / length) } else { (1.0, 0.0) };
        (PxPoint::new(from.x + (to.x - from.x) * part, from.y + (to.y - from.y) * part), direction)
    }

    /// The row of a picture `height` px high in which the probe at this part lies; the nearest for one outside.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
    pub(crate) fn probe_row(&self, part: f64, height: u32) -> u32 {
        (self.place(part).0.y as u32).min(height.saturating_sub(1))
    }

    /// Whether its probes lie above or below these rows of a picture altogether; outside it the first and the last row reach on.
    pub(crate) fn misses(&self, rows: &Range<u32>, height: u32) -> bool {
        let (from, to) = (self.from.y, self.to.y);
        let (top, bottom) = match &self.bend {
            Bend::Straight | Bend::Chord => (from.min(to), from.max(to)),
            Bend::Arc(arc) => (arc.centre.y - arc.radius_px, arc.centre.y + arc.radius_px),
            Bend::Cubic(cubic) => {
                // A cubic curve lies within the polygon of its ends and handles.
                let [a, b] = cubic.handles.map(|handle| handle.y);
                let (from, to) = (cubic.from.y, cubic.to.y);
                (from.min(to).min(a).min(b), from.max(to).max(a).max(b))
            }
        };
        // A rounding of an arc's place is far less than the row more.
        bottom + 1.0 < f64::from(rows.start) && rows.start > 0
            || top - 1.0 > f64::from(rows.end) && rows.end < height
    }

    fn length_px(&self) -> f64 {
        match &self.bend {
            Bend::Straight | Bend::Chord => self.from.distance(self.to),
            Bend::Arc(arc) => arc.length_px(),
            Bend::Cubic(cubic) => cubic.from.distance(cubic.to),
        }
    }

    /// The ink across it at a part of its length; the ink's first row is row `first_row` of the picture.
    pub(crate) fn width_at(&self, part: f64, ink: &Bitmap, first_row: u32) -> Across {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
        let is_ink = |x: f64, y: f64| {
            let row = || (y as u32).checked_sub(first_row);
            x >= 0.0 && y >= 0.0 && row().is_some_and(|row| ink.get(Pixel::new(x as u32, row)))
        };
        let (PxPoint { x, y }, (dx, dy)) = self.place(part);
        let steps = |side: f64| {
            let (mut steps, mut reach) = (0, 0.0);
            // In the middle of the next step: the border between two pixels belongs to one side only.
            let probe = |reach: f64| side * (reach + 0.5 * STEP_PX);
            while reach < MAX_HALF_PX && is_ink(x - dy * probe(reach), y + dx * probe(reach)) {
                reach += STEP_PX;
                steps += 1;
            }
            steps
        };
        let (left, right): (u16, u16) = (steps(1.0), steps(-1.0));
        Across { width: left + right, nearer: left.min(right) }
    }

    /// The place of a straight segment that is nearest to another.
    fn nearest(&self, at: PxPoint) -> PxPoint {
        let (x, y) = (self.to.x - self.from.x, self.to.y - self.from.y);
        let length_squared = x * x + y * y;
        let along = (at.x - self.from.x) * x + (at.y - self.from.y) * y;
        let t = if length_squared > 0.0 { (along / length_squared).clamp(0.0, 1.0) } else { 0.0 };
        PxPoint::new(self.from.x + x * t, self.from.y + y * t)
    }

    /// Whether a place lies in its ink by more than is rounded; never on an arc.
    fn covers(&self, at: PxPoint) -> bool {
        let nearest = self.nearest(at);
        let (x, y) = (at.x - nearest.x, at.y - nearest.y);
        let inner = self.slack_px * self.slack_px * (1.0 - ROUNDING);
        !matches!(self.bend, Bend::Arc(_)) && x * x + y * y < inner
    }

    /// How far a place lies outside of its ink, px; as much as `least` where that is not less.
    fn error_px(&self, at: PxPoint, least: f64) -> f64 {
        if let Bend::Arc(arc) = &self.bend {
            return (arc.distance(at) - self.slack_px).max(0.0).min(least);
        }
        let nearest = self.nearest(at);
        let (x, y) = (at.x - nearest.x, at.y - nearest.y);
        let (squared, far_px) = (x * x + y * y, self.slack_px + least);
        if squared < self.slack_px * self.slack_px * (1.0 - ROUNDING) {
            0.0
        } else if squared > far_px * far_px * (1.0 + ROUNDING) {
            least
        } else {
            (at.distance(nearest) - self.slack_px).max(0.0).min(least)
        }
    }
}

/// The segments of a drawing by squares of the picture.
#[derive(Debug)]
pub(crate) struct Index {
    segments: Vec<Segment>,
    /// How far the pen of most of the lines covers, px.
    pub(crate) pen_half_px: f64,
    /// How much nearer than its squares a segment's error may be: its half width, and that an arc lies beside its chords.
    reach_px: f64,
    columns: u32,
    rows: u32,
    /// One past the last entry of each square.
    ends: Vec<usize>,
    /// Indices of segments, square by square.
    entries: Vec<u32>,
}

impl Index {
    /// Of a picture of this size.
    pub(crate) fn new(segments: Vec<Segment>, width: u32, height: u32) -> Self {
        let columns = width.div_ceil(CELL_PX).max(1);
        let rows = height.div_ceil(CELL_PX).max(1);
        // Counted first, then filled: two vectors, whatever the drawing.
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
        let pen_half_px = pen_half_px(&segments).unwrap_or(0.0);
        Self { segments, pen_half_px, reach_px: widest_px + CHORD_ERROR_PX, columns, rows, ends, entries }
    }

    fn square(&self, column: u32, row: u32) -> &[u32] {
        let index = row as usize * self.columns as usize + column as usize;
        let start = index.checked_sub(1).and_then(|before| self.ends.get(before)).copied().unwrap_or(0);
        self.ends.get(index).and_then(|end| self.entries.get(start..*end)).unwrap_or(&[])
    }

    /// How far to its side the segment that covers a place best covers the ink, px.
    pub(crate) fn slack_px(&self, at: PxPoint) -> f64 {
        let mut nearest = 0;
        self.error_px(at, &mut nearest);
        self.segments.get(nearest).map_or(0.0, |segment| segment.slack_px)
    }

    /// Tells the pixels of a run of ink in row `y` of the picture that have an error, from the left, and counts those that have
    /// none. `covering` is as with [`Self::error_px`].
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

    /// One past the last pixel of a run whose first one has no error that a segment covers, too. What a straight segment covers is
    /// convex: all pixels between two that lie inside by more than is rounded.
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

    /// The least error of a place over all segments. `covering` is one that covered another place, mostly this one too:
    /// nothing lies nearer than that; it becomes the one that covers this place best.
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
        // How far a place is from a row or column of squares.
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

/// The squares in which a segment is looked up; those of an arc's chords, which lie less beside it than squares that hold
/// nothing make the search go on.
fn for_each_square(segment: &Segment, columns: u32, rows: u32, mut visit: impl FnMut(usize)) {
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

/// The squares that a segment's bounding boxes touch, piece by piece so that a long slope takes few.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_a_wide_line_has_no_error() {
        let mut ink = Bitmap::new(200, 9).unwrap();
        (2..7).for_each(|y| (0..200).for_each(|x| ink.set(Pixel::new(x, y), true)));
        let mut drawing = Drawing::new(200, 9);
        drawing.push([PxPoint::new(0.5, 4.5), PxPoint::new(199.5, 4.5)]);
        assert_eq!(coverage(&ink, &drawing).max_px, 0.0);
        let mut high = Drawing::new(200, 9);
        high.push([PxPoint::new(0.5, 3.5), PxPoint::new(199.5, 3.5)]);
        // Its pen ends 1.5 px above, and 0.75 px of what it can be wider: 3 px to the lowest row, less half
        // of 4.5 px.
        assert_eq!(coverage(&ink, &high).max_px, 0.75);
    }

    #[test]
    fn a_line_one_pixel_wide_is_measured_by_distance() {
        let ink = Bitmap::from_picture("#..\n.#.\n..#\n").unwrap();
        let mut drawing = Drawing::new(3, 3);
        drawing.push([PxPoint::new(0.5, 1.5), PxPoint::new(2.5, 1.5)]);
        let errors = coverage(&ink, &drawing);
        assert_eq!((errors.pixels, errors.max_px), (3, 1.0));
    }

    #[test]
    fn an_arc_is_measured_as_one() {
        // A ring of radius 60 and 5 px, drawn by its middle: chords of a degree would already show.
        let mut ink = Bitmap::new(140, 140).unwrap();
        for (x, y) in (0..140).flat_map(|y| (0..140).map(move |x| (x, y))) {
            let away = libm::hypot(f64::from(x) - 69.5, f64::from(y) - 69.5);
            ink.set(Pixel::new(x, y), (away - 60.0).abs() <= 2.5);
        }
        let (left, right) = (PxPoint::new(10.0, 70.0), PxPoint::new(130.0, 70.0));
        let mut drawing = Drawing::new(140, 140);
        let (vertices, bulges) = (vec![left, right, left], vec![1.0, 1.0]);
        drawing.push_curve(1, crate::Curve { vertices, bulges, ..crate::Curve::default() });
        // Across the slope of a raster edge: half a pixel at most.
        let errors = coverage(&ink, &drawing);
        assert!(errors.max_px <= 0.5, "{}", errors.max_px);
        let mut half = Drawing::new(140, 140);
        let (vertices, bulges) = (vec![left, right], vec![1.0]);
        half.push_curve(1, crate::Curve { vertices, bulges, ..crate::Curve::default() });
        let (at, error_px) = worst_pixel(&ink, &half).unwrap();
        // The lowest pixel is as far from both ends, less half the width of the ring.
        assert_eq!(at.y, 131);
        assert!((error_px - (libm::hypot(59.5, 61.5) - 2.5)).abs() < 0.3, "{error_px}");
    }

    #[test]
    fn a_cubic_curve_is_measured_on_its_way() {
        // From (2, 10) over the top, a parabola with its top at (10, 4): as wide as one pixel, drawn by its pixels.
        let at = PxPoint::new;
        let handles = vec![Some([at(22.0 / 3.0, 2.0), at(38.0 / 3.0, 2.0)])];
        let mut drawing = Drawing::new(20, 12);
        drawing.push_curve(
            1,
            crate::Curve {
                vertices: vec![at(2.0, 10.0), at(18.0, 10.0)],
                handles,
                ..crate::Curve::default()
            },
        );
        let mut ink = Bitmap::new(20, 12).unwrap();
        ink.set(Pixel::new(9, 3), true); // its centre 0.5 px left and above the top
        let errors = coverage(&ink, &drawing);
        assert!((errors.max_px - 0.5).abs() < 0.03, "{}", errors.max_px);
    }

    #[test]
    fn far_ink_is_measured_across_the_whole_picture() {
        let mut ink = Bitmap::new(1000, 1000).unwrap();
        ink.set(Pixel::new(999, 999), true);
        let mut drawing = Drawing::new(1000, 1000);
        drawing.push([PxPoint::new(0.5, 0.5), PxPoint::new(0.5, 30.5)]);
        let (at, error_px) = worst_pixel(&ink, &drawing).unwrap();
        assert_eq!(at, Pixel::new(999, 999));
        assert!((error_px - libm::hypot(999.0, 969.0)).abs() < 1e-9);
    }

    #[test]
    fn runs_have_the_errors_of_their_pixels() {
        // A slope, level lines and half a ring with ink along its diameter, 1 to 7 px wide, and ink that nothing draws.
        let mut ink = Bitmap::new(200, 60).unwrap();
        for (x, y) in (0..60).flat_map(|y| (0..200).map(move |x| (x, y))) {
            let slope = 5 * y > x + 20 && 5 * y < x + 55;
            let level = (40..45).contains(&y) || y == 50;
            let ring = (libm::hypot(f64::from(x) - 150.0, f64::from(y) - 20.0) - 15.0).abs() < 2.0;
            let diameter = y == 20 && (135..165).contains(&x);
            ink.set(Pixel::new(x, y), slope || level || ring || diameter || (x * 7 + y * 13) % 97 == 0);
        }
        let at = PxPoint::new;
        let mut drawing = Drawing::new(200, 60);
        drawing.push([at(0.5, 7.4), at(198.0, 47.1)]);
        drawing.push([at(3.0, 42.5), at(90.0, 42.0), at(197.0, 43.1)]);
        drawing.push([at(0.5, 50.5), at(199.5, 50.5)]);
        let (vertices, bulges) = (vec![at(135.5, 20.5), at(165.5, 20.5)], vec![1.0]);
        drawing.push_curve(1, crate::Curve { vertices, bulges, ..crate::Curve::default() });
        let index = with_widths(&ink, &drawing, None);
        let mut tally = ErrorTally::default();
        ink.ink().for_each(|at| tally.add_pixel(at, index.error_px(at.into(), &mut 0)));
        assert_eq!(coverage(&ink, &drawing), tally.report());
        assert_eq!(worst_pixel(&ink, &drawing), tally.worst());
        let exact = tally.report().histogram.first().map(|bin| bin.pixels);
        assert!(tally.report().max_px > 1.0 && exact > Some(1000), "{:?}", tally.report());
    }

    #[test]
    fn no_ink_has_no_error_and_no_drawing_is_far() {
        let drawing = Drawing::new(4, 4);
        assert_eq!(coverage(&Bitmap::new(4, 4).unwrap(), &drawing), ErrorReport::default());
        let dot = Bitmap::from_picture("....\n...#\n").unwrap();
        assert!(coverage(&dot, &drawing).max_px > 3.0);
    }
}
