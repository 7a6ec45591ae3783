//! [`PenSegment`]: a segment of a stroke, the ink across it, and how far places lie from what its pen covers.

use crate::stroke::curve::Segment;
use crate::{
    picture::{Bitmap, Pixel},
    stroke::{Arc, Cubic, Drawing, PxPoint, PxVec},
};
use core::ops::Range;

/// Farthest that the chords of a cubic curve, from which distances are measured, lie from it, px.
const CUBIC_ERROR_PX: f64 = 0.005;

/// Part of a square of a distance that is more than all roundings: the root, which is slow, is needed only
/// this near to a border.
pub(super) const ROUNDING: f64 = 1e-9;

/// Farthest that the ink's edges are looked for across a segment, px.
pub(super) const MAX_HALF_PX: f64 = 96.0;

/// Where along a segment the ink's width is measured: not evenly, for lines that cross it do.
pub(crate) const PROBES: [f64; 8] = [0.055, 0.17, 0.29, 0.42, 0.53, 0.66, 0.79, 0.93];

/// How exactly the width is measured, px, and rows above and below a probe that it may ask for.
pub(super) const STEP_PX: f64 = 0.25;
pub(crate) const PROBE_ROWS: u32 = 98;

/// The ink across a segment, in steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Across {
    /// From edge to edge.
    pub(super) width: u16,
    /// From the segment to the nearer edge.
    pub(super) nearer: u16,
}

/// A stroke that is drawn beside the middle of its ink is no wider than twice its distance from the nearer
/// edge and this, px.
const BESIDE_PX: f64 = 1.5;

impl Across {
    /// Whether the segment is drawn down the middle of the ink.
    pub(super) fn is_middle(self) -> bool {
        STEP_PX * f64::from(self.width) <= 2.0 * STEP_PX * f64::from(self.nearer) + BESIDE_PX
    }

    /// Of the line that is drawn there, px.
    pub(super) fn width_px(self) -> f64 {
        let beside_px = 2.0 * STEP_PX * f64::from(self.nearer) + BESIDE_PX;
        (STEP_PX * f64::from(self.width)).min(beside_px)
    }
}

/// A straight line, an arc or a chord of a cubic curve, and how far to its side its pen covers the ink, px.
#[derive(Clone, Debug)]
pub(crate) struct PenSegment {
    pub(super) from: PxPoint,
    pub(super) to: PxPoint,
    pub(super) slack_px: f64,
    /// How far at each probe, px, on a straight line that gets thinner or wider, which no pen has drawn:
    /// `slack_px` is the most of it.
    pub(super) taper: Option<Box<[f64; PROBES.len()]>>,
    pub(super) bend: Bend,
    /// Whether it is the first of a stroke.
    pub(super) begins: bool,
}

/// What a segment is.
#[derive(Clone, Debug)]
pub(super) enum Bend {
    Straight,
    Arc(Box<Arc>),
    /// The first chord of a cubic curve, whose width is measured along the whole of it.
    Cubic(Box<Cubic>),
    /// A further chord of the same curve.
    Chord,
}

/// All segments of a drawing, as if the ink were one pixel wide.
pub(crate) fn segments(drawing: &Drawing) -> Vec<PenSegment> {
    let mut segments = Vec::new();
    for index in 0..drawing.strokes().len() {
        let stroke = drawing.stroke(index);
        let dot = stroke.first().filter(|_| stroke.len() == 1).map(|at| Segment::Line(*at, *at));
        let first = segments.len();
        for segment in drawing.course(index).segments().chain(dot) {
            add_segments(segment, &mut segments);
        }
        if let Some(segment) = segments.get_mut(first) {
            segment.begins = true;
        }
    }
    segments
}

/// What a segment of a stroke is looked up by: itself, or its chords.
fn add_segments(segment: Segment, segments: &mut Vec<PenSegment>) {
    let mut add = |from, to, bend| {
        segments.push(PenSegment { from, to, slack_px: 0.0, taper: None, bend, begins: false })
    };
    match segment {
        Segment::Line(from, to) => add(from, to, Bend::Straight),
        Segment::Arc(arc) => add(arc.from, arc.to, Bend::Arc(Box::new(arc))),
        Segment::Cubic(cubic) => {
            let mut from = cubic.from;
            for (index, to) in segment.chords(CUBIC_ERROR_PX).enumerate() {
                add(from, to, if index == 0 { Bend::Cubic(Box::new(cubic)) } else { Bend::Chord });
                from = to;
            }
        }
    }
}

impl PenSegment {
    pub(super) const fn is_straight(&self) -> bool {
        matches!(self.bend, Bend::Straight)
    }

    /// Whether the ink's width is measured along it; else it is that of the segment before.
    pub(crate) fn has_probes(&self) -> bool {
        !matches!(self.bend, Bend::Chord)
    }

    /// The place of the probe at a part of its length, 0 to 1, and its direction there.
    fn place(&self, part: f64) -> (PxPoint, PxVec) {
        match &self.bend {
            Bend::Straight | Bend::Chord => {}
            Bend::Arc(arc) => {
                let at = arc.at(part);
                return (at, (at - arc.centre).perpendicular() / arc.radius_px);
            }
            Bend::Cubic(cubic) => return (cubic.at(part), cubic.heading(part)),
        }
        let (from, to) = (self.from, self.to);
        let length = from.distance(to);
        let direction = if length > 0.0 { (to - from) / length } else { PxVec::new(1.0, 0.0) };
        (from + (to - from) * part, direction)
    }

    /// The row of a picture `height` px high in which the probe at this part lies; the nearest for one
    /// outside.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
    pub(crate) fn probe_row(&self, part: f64, height: u32) -> u32 {
        (self.place(part).0.y as u32).min(height.saturating_sub(1))
    }

    /// Whether its probes lie above or below these rows of a picture altogether; outside it the first and the
    /// last row reach on.
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

    pub(super) fn length_px(&self) -> f64 {
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
        let (PxPoint { x, y }, PxVec { x: dx, y: dy }) = self.place(part);
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

    /// The place of a straight segment that is nearest to another, and how far its pen covers there.
    fn nearest(&self, at: PxPoint) -> (PxPoint, f64) {
        let (x, y) = (self.to.x - self.from.x, self.to.y - self.from.y);
        let length_squared = x * x + y * y;
        let along = (at.x - self.from.x) * x + (at.y - self.from.y) * y;
        let t = if length_squared > 0.0 { (along / length_squared).clamp(0.0, 1.0) } else { 0.0 };
        let slack_px = self.taper.as_deref().map_or(self.slack_px, |taper| between(taper, t));
        (PxPoint::new(self.from.x + x * t, self.from.y + y * t), slack_px)
    }

    /// How far its pen covers where a place is nearest, px.
    pub(super) fn slack_at(&self, at: PxPoint) -> f64 {
        if matches!(self.bend, Bend::Arc(_)) { self.slack_px } else { self.nearest(at).1 }
    }

    /// Parts of its length between which its pen gets thinner or wider evenly, and how far it covers there,
    /// px; none where it is the same all along.
    pub(super) fn knots(&self) -> Option<[(f64, f64); PROBES.len() + 2]> {
        let taper = self.taper.as_deref()?;
        let mut knots = [(0.0, taper[0]); PROBES.len() + 2];
        for (knot, probe) in knots.iter_mut().skip(1).zip(PROBES.into_iter().zip(*taper)) {
            *knot = probe;
        }
        knots[PROBES.len() + 1] = (1.0, taper[PROBES.len() - 1]);
        Some(knots)
    }

    /// Lets its pen cover no farther than so far, px.
    pub(super) fn limit(&mut self, most_px: f64) {
        let taper = self.taper.iter_mut().flat_map(|taper| taper.iter_mut());
        taper.chain([&mut self.slack_px]).for_each(|slack_px| *slack_px = slack_px.min(most_px));
    }

    /// Whether a place lies in its ink by more than is rounded; never on an arc, nor where what it covers
    /// need not be convex.
    pub(super) fn covers(&self, at: PxPoint) -> bool {
        if self.taper.is_some() || matches!(self.bend, Bend::Arc(_)) {
            return false;
        }
        let (nearest, slack_px) = self.nearest(at);
        let (x, y) = (at.x - nearest.x, at.y - nearest.y);
        x * x + y * y < slack_px * slack_px * (1.0 - ROUNDING)
    }

    /// How far a place lies outside of its ink, px; as much as `least` where that is not less.
    pub(super) fn error_px(&self, at: PxPoint, least: f64) -> f64 {
        if let Bend::Arc(arc) = &self.bend {
            return (arc.distance(at) - self.slack_px).max(0.0).min(least);
        }
        let (nearest, slack_px) = self.nearest(at);
        let (x, y) = (at.x - nearest.x, at.y - nearest.y);
        let (squared, far_px) = (x * x + y * y, slack_px + least);
        if squared < slack_px * slack_px * (1.0 - ROUNDING) {
            0.0
        } else if squared > far_px * far_px * (1.0 + ROUNDING) {
            least
        } else {
            (at.distance(nearest) - slack_px).max(0.0).min(least)
        }
    }
}

/// What lies between the values at the probes, at a part of the length.
fn between(values: &[f64; PROBES.len()], part: f64) -> f64 {
    let mut before = (0.0, values[0]);
    for probe in PROBES.into_iter().zip(*values) {
        if part <= probe.0 {
            let share = if probe.0 > before.0 { (part - before.0) / (probe.0 - before.0) } else { 0.0 };
            return before.1 + share * (probe.1 - before.1);
        }
        before = probe;
    }
    before.1
}
