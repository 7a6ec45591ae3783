//! What the search knows of a drawing ([`Stroke`]), what it answers ([`Trail`]), and [`rebuild`], the only
//! place that makes a drawing of the answer. A drawing of a million lines has a million of each, so they are
//! small.

use super::sites::{NONE, number};
use crate::stroke::curve::{CHORD_ERROR_PX, Course, unit};
use crate::stroke::{Curve, Drawing, PxPoint, PxVec};
use std::borrow::Cow;

/// Way along a stroke over which the direction of its end is taken, px: enough for one stair of a gentle
/// slope.
const END_REACH_PX: f64 = 4.0;

/// Fewest vertices of a closed stroke of lines: there, back, and the first one again. A loop of one curve has
/// two.
const MIN_CLOSED: usize = 3;

/// A stroke as the search sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stroke<'a> {
    drawing: &'a Drawing,
    index: u32,
    /// Number in the given order.
    pub(crate) rank: u32,
    /// Letter it belongs to, 0 for none; strokes are joined only within one letter.
    pub(crate) letter: u32,
    /// Pen that draws it.
    pub(crate) pen: u8,
    /// Whether its last vertex is its first one again.
    pub(crate) closed: bool,
    /// Whether it is one straight line.
    pub(crate) is_line: bool,
}

impl<'a> Stroke<'a> {
    /// Places at which it may be entered if it is closed; else the first and the last one count.
    pub(crate) fn vertices(&self) -> &'a [PxPoint] {
        self.drawing.stroke(self.index as usize)
    }

    /// What lies between its vertices.
    pub(crate) fn course(&self) -> Course<'a> {
        self.drawing.course(self.index as usize)
    }

    /// Length, px.
    pub(crate) fn length_px(&self) -> f64 {
        self.course().length_px()
    }

    /// Where it begins (`false`) or ends (`true`).
    pub(crate) fn end(&self, last: bool) -> PxPoint {
        let vertices = self.vertices();
        let vertex = if last { vertices.last() } else { vertices.first() };
        vertex.copied().unwrap_or_default()
    }

    /// Unit vectors in which it would go on beyond its first and its last vertex; (0, 0) for a dot.
    pub(crate) fn outward(&self) -> [PxVec; 2] {
        let places = self.drawing.stroke_chords(self.index as usize, CHORD_ERROR_PX);
        [outward(places.iter()), outward(places.iter().rev())]
    }

    /// Its vertices, and where it bends places between them.
    pub(crate) fn chords(&self) -> Cow<'a, [PxPoint]> {
        self.drawing.stroke_chords(self.index as usize, CHORD_ERROR_PX)
    }

    /// Numbers of its first and its last vertex among those of the whole drawing.
    pub(crate) fn end_vertices(&self) -> (u32, u32) {
        let vertices = self.drawing.vertices_of(self.index as usize);
        (number(vertices.start), number(vertices.end.saturating_sub(1)))
    }

    /// That of these with which it ends, or of a closed one that begins and ends at its vertex `start` that.
    pub(crate) fn end_vertex(&self, start: u32, last: bool) -> u32 {
        let (from, to) = self.end_vertices();
        match start {
            1.. if self.closed => from + start,
            _ if last => to,
            _ => from,
        }
    }
}

/// The strokes of a drawing.
pub(crate) fn strokes_of(drawing: &Drawing) -> Vec<Stroke<'_>> {
    let stroke = |(vertices, index): (&[PxPoint], u32)| {
        let returns = vertices.first() == vertices.last();
        let is_long = || drawing.stroke_chords(index as usize, CHORD_ERROR_PX).len() >= MIN_CLOSED;
        let encloses = vertices.len() >= MIN_CLOSED || (vertices.len() > 1 && returns && is_long());
        Stroke {
            drawing,
            index,
            rank: index,
            letter: 0,
            pen: drawing.pen(index as usize),
            closed: encloses && returns,
            is_line: vertices.len() == 2 && drawing.course(index as usize).is_straight(),
        }
    };
    drawing.strokes().zip(0..).map(stroke).collect()
}

/// The vertices of the whole drawing of which these are the strokes.
pub(crate) fn all_vertices<'a>(strokes: &'a [Stroke<'a>]) -> &'a [PxPoint] {
    strokes.first().map_or(&[], |stroke| stroke.drawing.all_vertices())
}

/// The unit vector from a place some way along the stroke to its end; the walk begins at the end.
fn outward<'a>(mut walk: impl Iterator<Item = &'a PxPoint>) -> PxVec {
    let Some(end) = walk.next() else { return PxVec::default() };
    let mut inner = *end;
    for vertex in walk {
        inner = *vertex;
        if end.distance(inner) >= END_REACH_PX {
            break;
        }
    }
    unit(inner, *end)
}

/// A stroke of the given drawing as part of one to be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Leg {
    /// Which stroke.
    pub(crate) stroke: u32,
    /// Vertex of a closed stroke with which it begins and ends.
    pub(crate) start: u32,
    /// Whether it is drawn from its last vertex to its first one.
    pub(crate) reversed: bool,
}

/// Legs that are drawn as one, each from where the one before ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Trail {
    /// The first of its legs, and one past the last; or one stroke as it is, and [`WHOLE`].
    range: (u32, u32),
    /// Vertex of the closed trail with which it begins and ends.
    pub(crate) start: u32,
    /// Share of the segment from that vertex on, in parts of 2³², at which it begins and ends instead; 0 is
    /// the vertex.
    pub(crate) share: u32,
    /// Whether it comes back to where it began.
    pub(crate) closed: bool,
    /// Whether it is drawn from the end of the last leg.
    pub(crate) reversed: bool,
}

/// That a trail is one stroke: strokes that nothing is joined to need no legs.
const WHOLE: u32 = u32::MAX;

/// A share of a segment, 0 to 1, of what [`Trail::share`] says.
pub(crate) fn share_of(parts: u32) -> f64 {
    f64::from(parts) / PARTS
}

/// [`Trail::share`] of a share below 1.
pub(crate) fn parts_of(share: f64) -> u32 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a cast stays within the range of u32"
    )]
    let parts = (share * PARTS) as u32;
    parts
}

/// Parts of a segment in which places on it are counted: a metre in steps of less than a nanometre.
const PARTS: f64 = 4_294_967_296.0;

impl Trail {
    /// A stroke by itself.
    pub(crate) fn of_stroke(stroke: u32, closed: bool) -> Self {
        Self { range: (stroke, WHOLE), closed, ..Self::default() }
    }

    /// The legs of the trail in drawing order.
    pub(crate) fn legs(self, all: &[Leg]) -> impl Iterator<Item = Leg> + '_ {
        let (from, to) = self.range;
        let whole = (to == WHOLE).then_some(Leg { stroke: from, start: 0, reversed: self.reversed });
        let own = all.get(from as usize..to as usize).filter(|_| to != WHOLE).unwrap_or(&[]);
        let last = own.len().saturating_sub(1);
        let several = (0..own.len()).filter_map(move |k| {
            let leg = own.get(if self.reversed { last - k } else { k })?;
            Some(Leg { reversed: leg.reversed != self.reversed, ..*leg })
        });
        whole.into_iter().chain(several)
    }
}

/// What trails are made of.
#[derive(Debug)]
pub(crate) struct Legs<'a> {
    pub(crate) strokes: &'a [Stroke<'a>],
    pub(crate) all: Vec<Leg>,
}

impl<'a> Legs<'a> {
    /// No legs yet of these strokes.
    pub(crate) fn new(strokes: &'a [Stroke<'a>]) -> Self {
        Self { strokes, all: Vec::new() }
    }

    /// The legs as a trail.
    pub(crate) fn push(&mut self, legs: impl IntoIterator<Item = Leg>, closed: bool) -> Trail {
        let from = self.all.len();
        self.all.extend(legs);
        if let Some([Leg { stroke, start: 0, reversed: false }]) = self.all.get(from..) {
            let whole = Trail::of_stroke(*stroke, closed);
            self.all.truncate(from);
            return whole;
        }
        Trail { range: (number(from), number(self.all.len())), closed, ..Trail::default() }
    }

    /// The legs, and the trails, in the numbers that the strokes had in the given order.
    pub(crate) fn in_given_numbers(self, trails: &mut [Trail]) -> Vec<Leg> {
        let Self { strokes, mut all } = self;
        let given = |stroke: &mut u32| {
            *stroke = strokes.get(*stroke as usize).map_or(NONE, |stroke| stroke.rank);
        };
        all.iter_mut().for_each(|leg| given(&mut leg.stroke));
        trails.iter_mut().filter(|trail| trail.range.1 == WHOLE).for_each(|trail| given(&mut trail.range.0));
        all
    }

    fn of(&self, trail: Trail) -> impl Iterator<Item = (Leg, &Stroke<'a>)> {
        trail.legs(&self.all).filter_map(|leg| Some((leg, self.strokes.get(leg.stroke as usize)?)))
    }

    /// The first of its strokes.
    pub(crate) fn first(&self, trail: Trail) -> Option<&Stroke<'a>> {
        self.of(trail).next().map(|(_, stroke)| stroke)
    }

    /// Pen of its strokes.
    pub(crate) fn pen(&self, trail: Trail) -> u8 {
        self.first(trail).map_or(0, |stroke| stroke.pen)
    }

    /// Whether it is one place.
    pub(crate) fn is_dot(&self, trail: Trail) -> bool {
        self.of(trail).map(|(_, stroke)| stroke.vertices().len()).sum::<usize>() < 2
    }

    /// Its vertices in drawing order; a closed trail's last vertex is its first one.
    pub(crate) fn vertices(&self, trail: Trail) -> Vec<PxPoint> {
        self.curve(trail).vertices
    }

    /// Its vertices with its arcs and cubic curves.
    pub(crate) fn curve(&self, trail: Trail) -> Curve {
        let mut joined = Curve::default();
        for (leg, stroke) in self.of(trail) {
            let mut own = Curve::from(stroke.course());
            if stroke.closed {
                own.begin_at(leg.start as usize);
            }
            if leg.reversed {
                own.reverse();
            }
            // Across a gap the pen stays down.
            joined.append(own);
        }
        if trail.closed && joined.vertices.first() != joined.vertices.last() {
            joined.append(joined.vertices.first().copied().into_iter().collect::<Vec<PxPoint>>().into());
        }
        if trail.closed {
            joined.begin_at(trail.start as usize);
            joined.begin_within(share_of(trail.share));
        }
        joined
    }

    /// Where it begins and where it ends.
    pub(crate) fn ends(&self, trail: Trail) -> (PxPoint, PxPoint) {
        if trail.closed {
            let vertices = self.vertices(trail);
            return (
                vertices.first().copied().unwrap_or_default(),
                vertices.last().copied().unwrap_or_default(),
            );
        }
        let vertices = all_vertices(self.strokes);
        let (from, to) = self.end_vertices(trail);
        let place = |vertex: u32| vertices.get(vertex as usize).copied().unwrap_or_default();
        (place(from), place(to))
    }

    /// The vertices of the drawing with which a trail that is not closed begins and ends.
    pub(crate) fn end_vertices(&self, trail: Trail) -> (u32, u32) {
        if let (stroke, WHOLE) = trail.range {
            let Some(stroke) = self.strokes.get(stroke as usize) else { return (NONE, NONE) };
            let (from, to) = stroke.end_vertices();
            return if trail.reversed { (to, from) } else { (from, to) };
        }
        let mut ends = self.of(trail);
        let first = ends.next();
        let last = ends.last().or(first);
        let end = |known: Option<(Leg, &Stroke<'_>)>, last| {
            known.map_or(NONE, |(leg, stroke)| stroke.end_vertex(leg.start, last != leg.reversed))
        };
        (end(first, false), end(last, true))
    }
}

/// The drawing that draws the strokes of `drawing` as the trails say.
pub(crate) fn rebuild(drawing: &Drawing, legs: &Legs<'_>, trails: &[Trail]) -> Drawing {
    let mut ordered = Drawing::new(drawing.width_px(), drawing.height_px());
    for trail in trails {
        ordered.push_curve(legs.pen(*trail), legs.curve(*trail));
    }
    ordered
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: u32) -> PxPoint {
        PxPoint::new(f64::from(x), 0.0)
    }

    #[test]
    fn a_closed_stroke_begins_where_it_is_told_and_reversal_comes_after() {
        let mut drawing = Drawing::new(9, 9);
        drawing.push([0, 1, 2, 0].map(at));
        let strokes = strokes_of(&drawing);
        let mut legs = Legs::new(&strokes);
        let mut trail = legs.push([Leg { stroke: 0, reversed: false, start: 1 }], false);
        assert_eq!(legs.vertices(trail), [1, 2, 0, 1].map(at));
        trail.reversed = true;
        assert_eq!(legs.vertices(trail), [1, 0, 2, 1].map(at));
    }

    #[test]
    fn joined_strokes_share_their_common_vertex_only() {
        let mut drawing = Drawing::new(9, 9);
        drawing.push([0, 1].map(at));
        drawing.push([3, 1].map(at));
        drawing.push([4, 5].map(at));
        let order = [(0, false), (1, true), (2, false)];
        let own = order.map(|(stroke, reversed)| Leg { stroke, reversed, start: 0 });
        let strokes = strokes_of(&drawing);
        let mut legs = Legs::new(&strokes);
        let mut trail = legs.push(own, true);
        trail.start = 2;
        assert_eq!(legs.vertices(trail), [3, 4, 5, 0, 1, 3].map(at));
    }
}
