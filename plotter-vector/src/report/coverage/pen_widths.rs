//! [`set_widths`]: the pens that strokes were drawn with, from the ink across them.
//!
//! A line is as wide as the pen that drew it, but the ink across its stroke is wider where lines cross it or
//! run into it.

use super::AreaPen;
use super::pen_segment::{Across, MAX_HALF_PX, PROBES, PenSegment, ROUNDING, STEP_PX};
use core::ops::Range;

/// The part of a stroke's length that is no wider than its pen, of one whose width is not steady, for two
/// lines run into one there.
const NARROW: f64 = 0.15;

/// Between these parts a steady width differs by no more than a share of it and the raster's jumps.
const SPREAD: [f64; 2] = [0.2, 0.8];
const STEADY_SHARE: f64 = 0.2;

/// By so much the width of a line jumps on the raster, px: each of its edges lies up to half a pixel off, and
/// what is measured across a slope goes in steps of a quarter.
pub(crate) const JUMP_PX: f64 = 1.25;

/// A stroke that is shorter than so many halves of its width is no wider line but a dot, or lines of the pen
/// that run into one; it is taken for no wider than so many pens.
const SHORT_HALVES: f64 = 16.0;
const WIDEST_SHORT: f64 = 1.2;

/// Two lines that run into one are no wider than so many pens, px a px: twice one, and half of one more where
/// the paper between them has run full. What is wider is a line of another pen, or a wedge.
const TWO_PENS: f64 = 2.5;

/// A piece of a line of another pen is at least so many of its widths long: where three lines meet, their ink
/// is no longer than that.
const LINE_WIDTHS: f64 = 3.0;

/// Takes how far the pen of each stroke covers from the widths at its segments' probes.
pub(crate) fn set_widths(
    segments: &mut [PenSegment],
    widths: &[[Across; PROBES.len()]],
    areas: Option<AreaPen<'_>>,
) {
    let mut next = 0;
    let mut strokes = Vec::new();
    while next < segments.len() {
        let rest = segments.get(next + 1..).unwrap_or(&[]);
        let end = next + 1 + rest.iter().take_while(|segment| !segment.begins).count();
        if let (Some(stroke), Some(widths)) = (segments.get_mut(next..end), widths.get(next..end)) {
            let width = Width::of(stroke, widths, areas);
            width.set(stroke, widths, areas);
            strokes.push((next..end, width));
        }
        next = end;
    }
    // What the strokes that tell their pen were drawn with.
    let of_pen = |(stroke, width): &(Range<usize>, Width)| {
        width.pen_px.and(segments.get(stroke.clone())).unwrap_or(&[])
    };
    let Some(pen_px) = pen_half_px(strokes.iter().flat_map(of_pen)) else { return };
    for (stroke, width) in strokes {
        let (Some(stroke), Some(widths)) = (segments.get_mut(stroke.clone()), widths.get(stroke)) else {
            continue;
        };
        // A wedge is thinner somewhere than what the pen draws.
        let is_wedge = width.narrow_px < 2.0 * pen_px && !is_steady(width.narrow_px, 2.0 * pen_px);
        if width.pen_px.is_none() && !is_wedge {
            Width { pen_px: Some(2.0 * pen_px), ..width }.set(stroke, widths, areas);
        }
        // A dot and a short stroke are made by that pen, but for one down the middle of a line of another.
        let length_px: f64 = stroke.iter().map(PenSegment::length_px).sum();
        let is_line = |own_px: f64| own_px > TWO_PENS * 2.0 * pen_px && length_px >= LINE_WIDTHS * own_px;
        if width.pen_px.is_some_and(is_line) && is_down_the_middle(widths) {
            continue;
        }
        for piece in stroke.iter_mut().filter(|piece| length_px < SHORT_HALVES * piece.slack_px) {
            piece.limit(WIDEST_SHORT * pen_px + STEP_PX);
        }
    }
}

/// Whether most probes of a stroke are as far from the one edge of the ink as from the other.
fn is_down_the_middle(widths: &[[Across; PROBES.len()]]) -> bool {
    let (mut all, mut middle) = (0, 0);
    for at in widths.iter().flatten().filter(|at| at.width > 0) {
        all += 1;
        middle += usize::from(at.is_middle());
    }
    10 * middle >= 8 * all
}

/// Whether two widths of a line are one, but for the raster's jumps.
fn is_steady(one_px: f64, other_px: f64) -> bool {
    (one_px - other_px).abs() <= STEADY_SHARE * one_px.min(other_px) + JUMP_PX
}

/// How far the pen of most of the lines covers, px; none without lines.
pub(super) fn pen_half_px<'a>(segments: impl Iterator<Item = &'a PenSegment>) -> Option<f64> {
    // Wide ink that is filled has as many more strokes as it is wider: each counts the less.
    // A line one pixel wide covers only the middles of its pixels.
    let weight = |piece: &PenSegment| piece.length_px() / piece.slack_px.max(0.5);
    let lines = segments.map(|piece| (piece.slack_px, weight(piece)));
    let mut lines: Vec<_> = lines.filter(|(_, weight)| *weight > 0.0).collect();
    lines.sort_unstable_by(|one, other| one.0.total_cmp(&other.0));
    at_part(&lines, 0.5)
}

/// The value up to which a part of the weights lies, between those of two values where it lies between their
/// middles: values in rising order, each with its weight.
fn at_part(values: &[(f64, f64)], part: f64) -> Option<f64> {
    let wanted = part * values.iter().map(|(_, weight)| weight).sum::<f64>();
    let (mut sum, mut before) = (0.0, None);
    for (value, weight) in values {
        let middle = sum + 0.5 * weight;
        if middle >= wanted {
            let Some((low, from)) = before else { return Some(*value) };
            return Some(low + (value - low) * (wanted - from) / (middle - from));
        }
        (sum, before) = (sum + weight, Some((*value, middle)));
    }
    before.map(|(value, _)| value)
}

/// How wide a stroke is.
#[derive(Clone, Copy, Debug)]
struct Width {
    /// Its pen, if it tells one, px.
    pen_px: Option<f64>,
    /// Of its narrower parts, px.
    narrow_px: f64,
}

impl Width {
    fn of(stroke: &[PenSegment], widths: &[[Across; PROBES.len()]], areas: Option<AreaPen<'_>>) -> Self {
        let mut across = Vec::new();
        for (segment, widths) in stroke.iter().zip(widths).filter(|(segment, _)| segment.has_probes()) {
            if area_of(*widths, areas).is_some() {
                continue;
            }
            let share_px = segment.length_px().max(ROUNDING);
            // Where the stroke goes over paper it tells nothing.
            across.extend(widths.iter().filter(|at| at.width > 0).map(|at| (at.width_px(), share_px)));
        }
        across.sort_unstable_by(|one, other| one.0.total_cmp(&other.0));
        let at = |part: f64| at_part(&across, part).unwrap_or(0.0);
        let ([low_px, high_px], narrow_px) = (SPREAD.map(at), at(NARROW));
        let typical_px = mean_between(&across, [low_px, high_px]);
        let pen_px = if is_steady(low_px, high_px) {
            Some(typical_px)
        } else {
            (high_px <= TWO_PENS * narrow_px).then(|| typical_px.min(narrow_px + 0.5 * JUMP_PX))
        };
        Self { pen_px, narrow_px }
    }

    /// Takes how far the pen covers; where it is a line of another pen as far as the ink, and of a stroke
    /// without a pen as far as that in each place.
    fn set(self, stroke: &mut [PenSegment], widths: &[[Across; PROBES.len()]], areas: Option<AreaPen<'_>>) {
        let is_raster = areas.is_none_or(|areas| areas.is_raster);
        let mut slack_px = 0.0;
        for (segment, widths) in stroke.iter_mut().zip(widths) {
            if segment.has_probes() {
                segment.taper = None;
                slack_px = match (area_of(*widths, areas), self.pen_px) {
                    (Some(pen_px), _) => slack_of(pen_px, true),
                    (None, Some(pen_px)) if !is_line(segment, *widths, pen_px) => slack_of(pen_px, is_raster),
                    (None, None) if segment.is_straight() => {
                        let taper = widths.map(|at| slack_of(at.width_px(), is_raster));
                        segment.taper = Some(Box::new(taper));
                        taper.into_iter().fold(0.0, f64::max)
                    }
                    (None, _) => slack_of(median_px(*widths), is_raster),
                };
            }
            segment.slack_px = slack_px;
        }
    }
}

/// Whether a segment is a line by itself, of one width, and wider than two lines of a pen that run into one.
fn is_line(segment: &PenSegment, mut at: [Across; PROBES.len()], pen_px: f64) -> bool {
    at.sort_unstable();
    let [_, low, .., high, _] = at.map(Across::width_px);
    is_steady(low, high) && segment.length_px() >= LINE_WIDTHS * high && low > TWO_PENS * pen_px
}

/// The width of the ink across a segment, px.
fn median_px(mut at: [Across; PROBES.len()]) -> f64 {
    at.sort_unstable();
    let [_, _, _, _, median, ..] = at;
    median.width_px()
}

/// The pen of the areas, px, where a segment is the border of one.
fn area_of(widths: [Across; PROBES.len()], areas: Option<AreaPen<'_>>) -> Option<f64> {
    let areas = areas?;
    // No width greater than that can be measured.
    let widest_line_px = areas.opening.widest_line_px().min(2.0 * MAX_HALF_PX - 1.0);
    (median_px(widths) > widest_line_px).then_some(areas.pen_px)
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
