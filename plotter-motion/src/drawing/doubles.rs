//! [`Drawing::drop_doubles`]: nothing is drawn twice.

use super::ink::{Ink, NO_LENGTH_MM, Rest};
use super::{Drawing, Mark, PathSegment, Shape, Stroke};
use crate::Point;
use alloc::collections::BTreeMap;
use alloc::vec::Vec;

/// What was not drawn again.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Doubles {
    /// Strokes that vanished wholly.
    pub strokes: usize,
    /// Length of all that is not drawn again, mm.
    pub length_mm: f64,
}

impl Drawing {
    /// Leaves out what has been drawn already by the same pen on the same sheet, within `tolerance_mm`; all
    /// of what was drawn is within that of what is left, and nothing new is drawn.
    ///
    /// - Lines on one straight line, whichever way they go: each part of it is drawn once. Two lines that
    ///   cross, or lie within the tolerance at a few places only, are not on one.
    /// - Arcs on one circle, whose centres and radii are the same within the tolerance together: each part of
    ///   it once.
    /// - Curves, if both their ends and handles are the same within the tolerance, either way round.
    /// - Dots on one place. A dot on a line stays, because a pen that rests leaves more than one that passes.
    ///
    /// A stroke that loses its middle becomes two; of a closed one, what is left on both sides of its start
    /// stays one. What is shorter than the tolerance is not cut out of a stroke, for the pen would be lifted
    /// for nothing. With a laser, lines of different powers or speeds are not the same. What happens before a
    /// stroke that vanishes happens before the next one. A stroke that is drawn by the pen that is there
    /// (pen 0) keeps the pen it had.
    ///
    /// What lies farther than 10⁹ mm from the origin stays as it is. A tolerance below 10⁻⁶ mm, or that is no
    /// number, is 10⁻⁶ mm.
    ///
    /// ```
    /// use plotter_motion::{Point, drawing::{Drawing, Stroke}};
    /// // 0 to 10 mm, back from 15 mm to 5 mm, and 2 mm of the first once more.
    /// let lines = [(0.0, 10.0), (15.0, 5.0), (3.0, 5.0)];
    /// let strokes = lines.map(|(a, b)| Stroke::through([Point::new(a, 7.0), Point::new(b, 7.0)]).unwrap());
    /// let mut drawing = Drawing { strokes: strokes.to_vec(), ..Drawing::default() };
    /// let doubles = drawing.drop_doubles(0.01);
    /// assert_eq!((doubles.strokes, doubles.length_mm), (1, 7.0));
    /// assert_eq!((drawing.strokes.len(), drawing.length_mm()), (2, 15.0));
    /// ```
    pub fn drop_doubles(&mut self, tolerance_mm: f64) -> Doubles {
        let mut ink = Ink::new(tolerance_mm);
        let mut tools = Tools::default();
        let mut doubles = Doubles::default();
        // What happens before the next stroke that is left.
        let mut before: Vec<Mark> = Vec::new();
        // The pen that is there in what was drawn, and in what is left.
        let (mut pen, mut pen_left) = (0, 0);
        let mut left = Vec::with_capacity(self.strokes.len());
        for mut stroke in core::mem::take(&mut self.strokes) {
            if stroke.before.contains(&Mark::NewPage) {
                tools.sheet = tools.sheet.saturating_add(1);
            }
            pen = match stroke.pen {
                0 if stroke.before.contains(&Mark::PutPenAway) => 0,
                0 => pen,
                named => named,
            };
            before.append(&mut stroke.before);
            if before.contains(&Mark::PutPenAway) {
                pen_left = 0;
            }
            let (parts, dropped_mm) = parts_left(stroke, pen, &mut tools, &mut ink);
            doubles.length_mm += dropped_mm;
            doubles.strokes += usize::from(parts.is_empty());
            for mut part in parts {
                part.before = core::mem::take(&mut before);
                if part.pen == 0 && pen_left != pen {
                    part.pen = pen;
                }
                pen_left = pen;
                left.push(part);
            }
        }
        self.strokes = left;
        before.append(&mut self.after);
        self.after = before;
        doubles
    }
}

/// What draws the same ink: the sheet, the pen, and of a laser its power and speed.
#[derive(Default)]
struct Tools {
    sheet: u32,
    numbers: BTreeMap<(u32, u8, [Option<u64>; 2]), u32>,
}

impl Tools {
    fn number(&mut self, pen: u8, segment: &PathSegment) -> u32 {
        let bits = |number: Option<f64>| number.map(f64::to_bits);
        let power = bits(segment.power);
        let feed = if power.is_some() { bits(segment.feed_mm_s) } else { None };
        let next = u32::try_from(self.numbers.len()).unwrap_or(u32::MAX);
        *self.numbers.entry((self.sheet, pen, [power, feed])).or_insert(next)
    }
}

/// A part of a segment of a stroke.
struct Part {
    segment: usize,
    /// Shares of the segment.
    begin: f64,
    end: f64,
    length_mm: f64,
    is_left: bool,
}

/// What of a stroke has not been drawn yet, and the length of what has been, mm.
fn parts_left(stroke: Stroke, pen: u8, tools: &mut Tools, ink: &mut Ink) -> (Vec<Stroke>, f64) {
    // What has no length is a dot, of however many segments.
    if stroke.segments().all(|(from, segment)| length_at_most_mm(from, segment) <= NO_LENGTH_MM) {
        let tool = stroke.segments.last().map_or(0, |dot| tools.number(pen, dot));
        return (if ink.draw_dot(tool, stroke.from) { alloc::vec![stroke] } else { Vec::new() }, 0.0);
    }
    let mut parts = Vec::with_capacity(stroke.segments.len());
    let mut is_any_drawn = false;
    for (index, (from, segment)) in stroke.segments().enumerate() {
        let part = |begin, end, length_mm, is_left| Part { segment: index, begin, end, length_mm, is_left };
        match ink.draw(tools.number(pen, segment), from, segment) {
            Rest::All => parts.push(part(0.0, 1.0, length_at_most_mm(from, segment), true)),
            Rest::None => {
                parts.push(part(0.0, 1.0, segment.length_mm(from), false));
                is_any_drawn = true;
            }
            Rest::Parts { length_mm, left } => {
                let mut at = 0.0;
                for (begin, end) in left.into_iter().chain([(length_mm, length_mm)]) {
                    for (begin, end, is_left) in [(at, begin, false), (begin, end, true)] {
                        if begin < end {
                            parts.push(part(begin / length_mm, end / length_mm, end - begin, is_left));
                        }
                    }
                    at = end;
                }
                is_any_drawn = true;
            }
        }
    }
    if !is_any_drawn {
        return (alloc::vec![stroke], 0.0);
    }
    // What is shorter than the tolerance is not cut out, unless nothing would be left.
    if parts.iter().any(|part| part.is_left && part.length_mm > NO_LENGTH_MM) {
        for run in parts.chunk_by_mut(|a, b| a.is_left == b.is_left) {
            if run.iter().map(|part| part.length_mm).sum::<f64>() < ink.tolerance_mm() {
                run.iter_mut().for_each(|part| part.is_left = true);
            }
        }
        // A segment that stays is not taken apart.
        parts.dedup_by(|next, part| {
            let is_one = next.segment == part.segment && next.is_left && part.is_left;
            if is_one {
                (part.end, part.length_mm) = (next.end, part.length_mm + next.length_mm);
            }
            is_one
        });
    }
    let dropped_mm = parts.iter().filter(|part| !part.is_left).map(|part| part.length_mm).sum();
    (join(&stroke, &parts), dropped_mm)
}

/// Length of a line and an arc; of a curve that of its handles, which takes less time.
fn length_at_most_mm(from: Point, segment: &PathSegment) -> f64 {
    match segment.shape {
        Shape::Cubic { handles: [a, b] } => from.distance(a) + a.distance(b) + b.distance(segment.to),
        _ => segment.length_mm(from),
    }
}

/// The strokes of what is left of one.
fn join(stroke: &Stroke, parts: &[Part]) -> Vec<Stroke> {
    let segments: Vec<(Point, &PathSegment)> = stroke.segments().collect();
    let mut strokes: Vec<Stroke> = Vec::new();
    let mut is_down = false;
    for part in parts {
        let Some((from, segment)) = segments.get(part.segment).filter(|_| part.is_left) else {
            is_down = false;
            continue;
        };
        let is_whole = part.begin <= 0.0 && part.end >= 1.0;
        // Where the pen rests on the way, it is no dot of its own.
        if part.length_mm <= NO_LENGTH_MM && !is_down {
            continue;
        }
        let drawn = if is_whole { **segment } else { segment.part(*from, part.begin, part.end) };
        match strokes.last_mut().filter(|_| is_down) {
            Some(last) => last.segments.push(drawn),
            None => strokes.push(stroke.like(segment.at(*from, part.begin), alloc::vec![drawn])),
        }
        is_down = true;
    }
    // What is left on both sides of a closed stroke's start is one.
    let joins = |first: &Stroke, last: &Stroke| first.from == stroke.from && last.to() == stroke.from;
    let do_join = stroke.is_closed()
        && strokes.len() > 1
        && strokes.first().zip(strokes.last()).is_some_and(|(first, last)| joins(first, last));
    if do_join {
        let last = strokes.pop();
        if let (Some(first), Some(mut last)) = (strokes.first_mut(), last) {
            last.segments.append(&mut first.segments);
            *first = last;
        }
    }
    strokes
}
