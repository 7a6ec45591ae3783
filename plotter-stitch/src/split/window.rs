//! [`Window`]: the lines around a border, and where each is cut.

use super::FrameLayout;
use super::pieces::{Key, Pieces, Tool};
use super::span::Span;
use alloc::vec::Vec;
use plotter_motion::{Point, Segment};
use rstar::{AABB, RTree, RTreeObject};

/// A vertex that turns the path by more than this is a corner, rad: 20 degrees.
const CORNER_RAD: f64 = 0.35; // 20 degrees

/// What a cut costs in a corner, on another line, and along the border; between these it falls in proportion.
const CORNER_COST: f64 = 1.0;
const CROSSING_COST: f64 = 1.0;
const SHALLOW_COST: f64 = 1.0;
/// What a cut costs at the end of the window: little, so that it only decides between cuts that do equal
/// harm.
const FAR_COST: f64 = 0.1;

/// Places that are tried in each half of a window, for a line straight across.
const STEPS: f64 = 8.0;
/// Most places that are tried on one operation. It bounds the time for lines along the border.
const MOST_STEPS: f64 = 64.0;
/// Most chords of an arc in the search for crossings. It bounds the time; the cost of a cut needs no exact
/// crossing.
const MOST_CHORDS: f64 = 16.0;
/// Most neighbours that are checked around a place. It bounds the time where lines are dense.
const MOST_NEIGHBOURS: usize = 64;

/// From which frame a line comes into the window, or to which it leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Before,
    After,
}

/// A part of an operation in the window.
#[derive(Clone, Copy, Debug)]
pub(super) struct WindowPart {
    pub(super) span: Span,
    pub(super) t0: f64,
    pub(super) t1: f64,
    pub(super) order: u64,
    pub(super) tool: Tool,
}

/// Parts that follow on one another.
#[derive(Clone, Copy, Debug)]
struct Run {
    first: usize,
    count: usize,
    /// `None` where the stroke begins within the window.
    entry: Option<Side>,
    /// `None` where it ends there.
    exit: Option<Side>,
}

/// The lines around the border between two frames.
#[derive(Clone, Debug, Default)]
pub(super) struct Window {
    parts: Vec<WindowPart>,
    runs: Vec<Run>,
}

/// A stretch of a run for the search for crossings.
#[derive(Clone, Copy, Debug)]
struct Strand {
    segment: Segment,
    run: usize,
    /// From where to where on the run, mm.
    begin_mm: f64,
    end_mm: f64,
}

impl RTreeObject for Strand {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        let Segment { from, to } = self.segment;
        AABB::from_corners([from.x, from.y], [to.x, to.y])
    }
}

/// A place at which a run may be cut.
#[derive(Clone, Copy, Debug)]
struct Cut {
    part: usize,
    t: f64,
    cost: f64,
}

impl Window {
    /// Begins a run with a part; `entry` says whence the stroke comes.
    pub(super) fn begin_run(&mut self, part: WindowPart, entry: Option<Side>) {
        self.runs.push(Run { first: self.parts.len(), count: 1, entry, exit: None });
        self.parts.push(part);
    }

    /// Goes on with the run begun last.
    pub(super) fn go_on(&mut self, part: WindowPart) {
        if let Some(run) = self.runs.last_mut() {
            run.count += 1;
            self.parts.push(part);
        }
    }

    /// The stroke of the run begun last leaves the window.
    pub(super) fn leave(&mut self, exit: Side) {
        if let Some(run) = self.runs.last_mut() {
            run.exit = Some(exit);
        }
    }

    /// Divides everything between the frames on both sides of the border at `border_mm`.
    ///
    /// A line that comes from one frame and goes to the other is cut once, where that does least harm; one
    /// that begins or ends in the window, or comes back, is not cut at all.
    pub(super) fn divide(
        self,
        layout: &FrameLayout,
        border_mm: f64,
        before: &mut Pieces,
        after: &mut Pieces,
    ) {
        let needs_cut = |run: &Run| matches!((run.entry, run.exit), (Some(a), Some(b)) if a != b);
        let neighbours = if self.runs.iter().any(needs_cut) && layout.clear_mm > 0.0 {
            RTree::bulk_load(self.strands())
        } else {
            RTree::new()
        };
        for (index, run) in self.runs.iter().enumerate() {
            let parts = self.parts.get(run.first..run.first + run.count).unwrap_or_default();
            let Some(first) = parts.first() else { continue };
            let begins_before = match (run.entry, run.exit) {
                (Some(side), _) | (None, Some(side)) => side == Side::Before,
                (None, None) => first.span.at(first.t0).y < border_mm,
            };
            let cut =
                if needs_cut(run) { best_cut(layout, border_mm, parts, index, &neighbours) } else { None };
            let (one, other) =
                if begins_before { (&mut *before, &mut *after) } else { (&mut *after, &mut *before) };
            for (number, part) in parts.iter().enumerate() {
                match cut {
                    Some(Cut { part: at, t, .. }) if number == at => {
                        push(one, part, part.t0, t);
                        push(other, part, t, part.t1);
                        let place = part.span.at(t);
                        before.break_at_end(place);
                        after.break_at_begin(place);
                        // The borrow of both sides ends with the cut; what follows belongs to the other one.
                        let rest = parts.get(number + 1..).unwrap_or_default();
                        let other = if begins_before { &mut *after } else { &mut *before };
                        rest.iter().for_each(|part| push(other, part, part.t0, part.t1));
                        break;
                    }
                    _ => push(one, part, part.t0, part.t1),
                }
            }
        }
    }

    fn strands(&self) -> Vec<Strand> {
        let mut strands = Vec::with_capacity(self.parts.len());
        for (index, run) in self.runs.iter().enumerate() {
            let mut begin_mm = 0.0;
            for part in self.parts.get(run.first..run.first + run.count).unwrap_or_default() {
                let length_mm = part.span.length_mm(part.t0, part.t1);
                // A chord for each eighth of a turn and more.
                let turn = part.span.sweep_rad() * (part.t1 - part.t0);
                let chords = libm::ceil(turn * 8.0).clamp(1.0, MOST_CHORDS);
                let step = (part.t1 - part.t0) / chords;
                let mut from = part.span.at(part.t0);
                let mut number = 1.0;
                while number <= chords {
                    let to = part.span.at(part.t0 + step * number);
                    let end_mm = begin_mm + length_mm / chords;
                    strands.push(Strand { segment: Segment::new(from, to), run: index, begin_mm, end_mm });
                    (from, begin_mm) = (to, end_mm);
                    number += 1.0;
                }
            }
        }
        strands
    }
}

fn push(pieces: &mut Pieces, part: &WindowPart, t0: f64, t1: f64) {
    // A part without length is none, unless the whole operation is a dot.
    if t1 > t0 {
        let keys = (Key::new(part.order, t0), Key::new(part.order, t1));
        pieces.push(keys, part.span.at(t0), part.tool, part.span.part(t0, t1));
    }
}

/// Where a run that must be cut is cut with the least harm.
fn best_cut(
    layout: &FrameLayout,
    border_mm: f64,
    parts: &[WindowPart],
    run: usize,
    neighbours: &RTree<Strand>,
) -> Option<Cut> {
    let corners = corners(parts);
    let mut best: Option<Cut> = None;
    let mut begin_mm = 0.0;
    for (index, part) in parts.iter().enumerate() {
        let length_mm = part.span.length_mm(part.t0, part.t1);
        let mut consider = |t: f64| {
            let way_mm = begin_mm + part.span.length_mm(part.t0, t);
            let place = part.span.at(t);
            let far = libm::fabs(place.y - border_mm) / layout.window_mm;
            let across = part.span.heading(t).map_or(1.0, |heading| libm::fabs(heading.y));
            let mut cost = FAR_COST * far + SHALLOW_COST * (1.0 - across);
            let is_worse = |cost: f64| best.is_some_and(|best| cost >= best.cost);
            if is_worse(cost) {
                return;
            }
            if layout.clear_mm > 0.0 {
                cost += CORNER_COST * nearness(nearest_corner(&corners, way_mm), layout.clear_mm);
                if is_worse(cost) {
                    return;
                }
                let distance_mm = nearest_line(neighbours, place, run, way_mm, layout.clear_mm);
                cost += CROSSING_COST * nearness(distance_mm, layout.clear_mm);
            }
            if !is_worse(cost) {
                best = Some(Cut { part: index, t, cost });
            }
        };
        let steps = libm::ceil(length_mm / layout.window_mm * STEPS).clamp(1.0, MOST_STEPS);
        let step = (part.t1 - part.t0) / steps;
        let mut t = part.t0;
        let mut number = 0.0;
        while number <= steps {
            let next = if number + 1.0 < steps { part.t0 + step * (number + 1.0) } else { part.t1 };
            consider(t);
            let (y, next_y) = (part.span.at(t).y, part.span.at(next).y);
            if (y < border_mm) != (next_y < border_mm) {
                consider(part.span.crossing(t, next, border_mm));
            }
            t = next;
            number += 1.0;
        }
        begin_mm += length_mm;
    }
    best
}

/// 1 at a distance of 0, 0 from `clear_mm` on.
fn nearness(distance_mm: f64, clear_mm: f64) -> f64 {
    (1.0 - distance_mm / clear_mm).max(0.0)
}

/// How far along a run its corners are, mm.
fn corners(parts: &[WindowPart]) -> Vec<f64> {
    let mut corners = Vec::new();
    let mut way_mm = 0.0;
    let mut heading = None;
    for part in parts {
        let begin = part.span.heading(part.t0);
        if let (Some(before), Some(after)) = (heading, begin) {
            let (before, after): (plotter_motion::Vec2, plotter_motion::Vec2) = (before, after);
            if libm::fabs(libm::atan2(before.cross(after), before.dot(after))) > CORNER_RAD {
                corners.push(way_mm);
            }
        }
        way_mm += part.span.length_mm(part.t0, part.t1);
        heading = part.span.heading(part.t1).or(heading);
    }
    corners
}

fn nearest_corner(corners: &[f64], way_mm: f64) -> f64 {
    let after = corners.partition_point(|corner| *corner < way_mm);
    let behind = after.checked_sub(1).and_then(|before| corners.get(before));
    let [behind, ahead] =
        [behind, corners.get(after)].map(|at| at.map_or(f64::INFINITY, |at| libm::fabs(way_mm - at)));
    behind.min(ahead)
}

/// Distance from a place of a run to the nearest other line, or to another part of its own; infinite beyond
/// `reach_mm`.
fn nearest_line(neighbours: &RTree<Strand>, place: Point, run: usize, way_mm: f64, reach_mm: f64) -> f64 {
    let Point { x, y } = place;
    let around = AABB::from_corners([x - reach_mm, y - reach_mm], [x + reach_mm, y + reach_mm]);
    let mut nearest_mm = f64::INFINITY;
    for strand in neighbours.locate_in_envelope_intersecting(around).take(MOST_NEIGHBOURS) {
        let is_itself = strand.run == run
            && strand.begin_mm - 2.0 * reach_mm < way_mm
            && way_mm < strand.end_mm + 2.0 * reach_mm;
        if !is_itself {
            nearest_mm = nearest_mm.min(strand.segment.distance(place));
        }
    }
    nearest_mm
}
