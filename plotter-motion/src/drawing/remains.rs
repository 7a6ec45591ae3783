//! [`Remains`]: what is left of strokes of which parts go away.

use super::region::DUST_MM;
use super::{Drawing, Mark, PathSegment, Stroke};
use crate::Point;
use alloc::vec::Vec;

/// How many strokes were cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CutCount {
    /// Strokes of which nothing is left.
    pub removed: usize,
    /// Strokes of which a part is left, or several.
    pub shortened: usize,
}

/// A part of a stroke: of a segment, by its number, the piece from one share to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Part {
    pub(super) segment: usize,
    pub(super) begin: f64,
    pub(super) end: f64,
}

/// A part of a stroke without gaps.
struct Run {
    from: Point,
    segments: Vec<PathSegment>,
}

/// What is left, stroke by stroke.
#[derive(Default)]
pub(super) struct Remains {
    strokes: Vec<Stroke>,
    /// What happened before strokes that are gone, and happens before the next one.
    marks: Vec<Mark>,
    count: CutCount,
}

impl Remains {
    /// Takes those parts of a stroke that stay, in the order in which they are drawn.
    ///
    /// A closed stroke that is cut elsewhere goes on through the place where it began.
    pub(super) fn take(&mut self, mut stroke: Stroke, parts: &[Part]) {
        self.marks.append(&mut stroke.before);
        let is_whole = |part: &Part| part.begin <= 0.0 && part.end >= 1.0;
        if parts.len() == stroke.segments.len() && parts.iter().all(is_whole) {
            stroke.before = core::mem::take(&mut self.marks);
            self.strokes.push(stroke);
            return;
        }
        let mut left = false;
        for run in runs(&stroke, parts) {
            let mut piece = stroke.like(run.from, run.segments);
            let (width_mm, height_mm) = piece.bounds().size_mm();
            if width_mm + height_mm > DUST_MM {
                piece.before = core::mem::take(&mut self.marks);
                self.strokes.push(piece);
                left = true;
            }
        }
        *if left { &mut self.count.shortened } else { &mut self.count.removed } += 1;
    }

    /// Puts what is left into the drawing.
    pub(super) fn into_drawing(mut self, drawing: &mut Drawing) -> CutCount {
        drawing.strokes = self.strokes;
        self.marks.append(&mut drawing.after);
        drawing.after = self.marks;
        self.count
    }
}

/// The parts, joined where one begins at the end of another.
fn runs(stroke: &Stroke, parts: &[Part]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    let mut parts = parts.iter().copied().peekable();
    let mut before: Option<Part> = None;
    let begins = parts.peek().is_some_and(|part| part.segment == 0 && part.begin <= 0.0);
    for (number, (from, segment)) in stroke.segments().enumerate() {
        while let Some(part) = parts.next_if(|part| part.segment == number) {
            let piece = if part.begin <= 0.0 && part.end >= 1.0 {
                *segment
            } else {
                segment.part(from, part.begin, part.end)
            };
            let joins = part.begin <= 0.0
                && before.is_some_and(|before| before.end >= 1.0 && before.segment + 1 == part.segment);
            match runs.last_mut() {
                Some(run) if joins => run.segments.push(piece),
                _ => {
                    runs.push(Run { from: segment.at(from, part.begin), segments: alloc::vec![piece] });
                }
            }
            before = Some(part);
        }
    }
    let ends = before.is_some_and(|last| last.end >= 1.0 && last.segment + 1 == stroke.segments.len());
    if begins
        && ends
        && stroke.to() == stroke.from
        && runs.len() > 1
        && let Some(mut last) = runs.pop()
        && let Some(first) = runs.first_mut()
    {
        last.segments.append(&mut first.segments);
        *first = last;
    }
    runs
}
