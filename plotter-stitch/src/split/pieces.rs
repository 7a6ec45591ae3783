//! [`Pieces`]: what of a drawing belongs to one frame, gathered in any order; and [`Frame`], what becomes of
//! it.

use alloc::vec::Vec;
use core::cmp::Ordering;
use plotter_motion::{PlotOp, Point, Vec2};

/// A place in the order of the drawing: the number of an operation, and how far through it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Key {
    pub(super) order: u64,
    pub(super) t: f64,
}

impl Key {
    /// The end of an operation is the beginning of the next one.
    pub(super) fn new(order: u64, t: f64) -> Self {
        if t >= 1.0 { Self { order: order + 1, t: 0.0 } } else { Self { order, t } }
    }

    fn compare(&self, other: &Self) -> Ordering {
        self.order.cmp(&other.order).then(self.t.total_cmp(&other.t))
    }
}

/// What is drawn with: chosen once in the drawing, and again in each frame that needs it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Tool {
    pub(super) pen: Option<u8>,
    pub(super) power_share: Option<f64>,
}

/// Operations that follow on one another, from a place on.
#[derive(Clone, Copy, Debug)]
struct Chunk {
    begin: Key,
    end: Key,
    from: Point,
    tool: Tool,
    first: usize,
    count: usize,
}

/// What of a drawing belongs to one frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Pieces {
    ops: Vec<PlotOp>,
    chunks: Vec<Chunk>,
    begin_breaks: Vec<Point>,
    end_breaks: Vec<Point>,
}

impl Pieces {
    /// Adds an operation that begins at `from` with the pen there.
    pub(super) fn push(&mut self, (begin, end): (Key, Key), from: Point, tool: Tool, op: PlotOp) {
        match self.chunks.last_mut() {
            Some(chunk) if chunk.end == begin && chunk.tool == tool => {
                chunk.end = end;
                // In the middle of an operation: its parts become one again.
                if let Some(before) = self.ops.last_mut().filter(|_| begin.t > 0.0) {
                    *before = joined(*before, op);
                    return;
                }
                chunk.count += 1;
            }
            _ => self.chunks.push(Chunk { begin, end, from, tool, first: self.ops.len(), count: 1 }),
        }
        self.ops.push(op);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.ops.is_empty()
    }

    /// Notes that a line comes over the frame's beginning at a place of the sheet.
    pub(super) fn break_at_begin(&mut self, place: Point) {
        self.begin_breaks.push(place);
    }

    /// Notes that a line goes over the frame's end.
    pub(super) fn break_at_end(&mut self, place: Point) {
        self.end_breaks.push(place);
    }

    /// The frame, in the order of the drawing.
    pub(super) fn finish(mut self, index: u32, begin_mm: f64) -> Frame {
        self.chunks.sort_by(|a, b| a.begin.compare(&b.begin));
        Frame { index, begin_mm, pieces: self }
    }
}

/// What is drawn in one frame.
///
/// Its operations are in *the frame's coordinates*: x from the left of its field, y from its beginning. They
/// can be taken to the machine by a [`FrameTransform`](crate::FrameTransform). Pens, powers and speeds are
/// those of the drawing, chosen again in each frame; strokes are in the order of the drawing.
#[derive(Clone, Debug)]
pub struct Frame {
    index: u32,
    begin_mm: f64,
    pieces: Pieces,
}

impl Frame {
    /// Which frame it is, from 0.
    #[must_use]
    pub const fn index(&self) -> u32 {
        self.index
    }

    /// Where its beginning lies on the sheet, mm along the paper.
    #[must_use]
    pub const fn begin_mm(&self) -> f64 {
        self.begin_mm
    }

    /// Whether nothing is drawn in it.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.pieces.ops.is_empty()
    }

    /// Where lines come from the frame before, in places of the sheet; each is also one of that frame's
    /// [`end_breaks`](Self::end_breaks), to the last bit.
    #[must_use]
    pub fn begin_breaks(&self) -> &[Point] {
        &self.pieces.begin_breaks
    }

    /// Where lines go on in the frame after, in places of the sheet.
    #[must_use]
    pub fn end_breaks(&self) -> &[Point] {
        &self.pieces.end_breaks
    }

    /// The operations, in the frame's coordinates, from the pen lifted at the frame's origin.
    pub fn ops(&self) -> impl Iterator<Item = PlotOp> + '_ {
        let by = Vec2::new(0.0, -self.begin_mm);
        self.sheet_ops().map(move |op| moved(op, by))
    }

    /// The operations, in places of the sheet.
    pub fn sheet_ops(&self) -> impl Iterator<Item = PlotOp> + '_ {
        SheetOps {
            pieces: &self.pieces,
            chunk: 0,
            stage: Stage::Pen,
            tool: Tool::default(),
            end: None,
            held: None,
        }
    }
}

/// An operation elsewhere.
fn moved(op: PlotOp, by: Vec2) -> PlotOp {
    match op {
        PlotOp::Travel { to } => PlotOp::Travel { to: to + by },
        PlotOp::Draw { to, feed_mm_s } => PlotOp::Draw { to: to + by, feed_mm_s },
        PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s } => {
            PlotOp::DrawArc { centre: centre + by, sweep_rad, to: to + by, feed_mm_s }
        }
        other => other,
    }
}

/// What of a chunk comes next.
#[derive(Clone, Copy, Debug)]
enum Stage {
    Pen,
    Power,
    Travel,
    Op(usize),
}

#[derive(Debug)]
struct SheetOps<'a> {
    pieces: &'a Pieces,
    chunk: usize,
    stage: Stage,
    tool: Tool,
    /// Where the chunk before ended, in the order of the drawing.
    end: Option<Key>,
    /// The first part of an operation that goes on in the next chunk.
    held: Option<PlotOp>,
}

impl SheetOps<'_> {
    /// Whether a chunk goes on in the middle of the operation with which the one before ended.
    fn goes_on(&self, chunk: &Chunk, next: usize) -> bool {
        let after = self.pieces.chunks.get(next);
        chunk.end.t > 0.0 && after.is_some_and(|after| after.begin == chunk.end && after.tool == chunk.tool)
    }
}

impl Iterator for SheetOps<'_> {
    type Item = PlotOp;

    fn next(&mut self) -> Option<PlotOp> {
        loop {
            let chunk = self.pieces.chunks.get(self.chunk)?;
            match self.stage {
                Stage::Pen => {
                    self.stage = Stage::Power;
                    if let Some(pen) = chunk.tool.pen.filter(|pen| self.tool.pen != Some(*pen)) {
                        self.tool.pen = Some(pen);
                        // The pen was away meanwhile.
                        self.end = None;
                        return Some(PlotOp::SelectPen { pen });
                    }
                }
                Stage::Power => {
                    self.stage = Stage::Travel;
                    let share = chunk.tool.power_share;
                    if let Some(share) = share.filter(|share| self.tool.power_share != Some(*share)) {
                        self.tool.power_share = Some(share);
                        return Some(PlotOp::LaserPower { share });
                    }
                }
                Stage::Travel => {
                    self.stage = Stage::Op(0);
                    if self.end != Some(chunk.begin) && self.is_drawn(chunk) {
                        return Some(PlotOp::Travel { to: chunk.from });
                    }
                }
                Stage::Op(index) if index < chunk.count => {
                    self.stage = Stage::Op(index + 1);
                    let op = *self.pieces.ops.get(chunk.first + index)?;
                    let op = self.held.take().map_or(op, |before| joined(before, op));
                    if index + 1 == chunk.count && self.goes_on(chunk, self.chunk + 1) {
                        self.held = Some(op);
                    } else {
                        return Some(op);
                    }
                }
                Stage::Op(_) => {
                    // After a pause alone the pen is where it was.
                    let is_there = self.end == Some(chunk.begin) || self.is_drawn(chunk);
                    self.end = is_there.then_some(chunk.end);
                    self.chunk += 1;
                    self.stage = Stage::Pen;
                }
            }
        }
    }
}

impl SheetOps<'_> {
    /// Whether a chunk draws anything: a pause alone moves no pen.
    fn is_drawn(&self, chunk: &Chunk) -> bool {
        let ops = self.pieces.ops.get(chunk.first..chunk.first + chunk.count).unwrap_or_default();
        ops.iter().any(|op| op.target().is_some())
    }
}

/// Two parts of one operation that meet, as one.
fn joined(first: PlotOp, second: PlotOp) -> PlotOp {
    match (first, second) {
        (PlotOp::DrawArc { sweep_rad: first, .. }, PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s }) => {
            PlotOp::DrawArc { centre, sweep_rad: first + sweep_rad, to, feed_mm_s }
        }
        (_, second) => second,
    }
}
