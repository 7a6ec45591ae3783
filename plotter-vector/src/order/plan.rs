//! What the search knows of a drawing ([`Stroke`]), what it answers ([`Trail`]), and [`rebuild`], the only place
//! that makes a drawing of the answer.

use crate::curve::{CHORD_ERROR_PX, Course, unit};
use crate::{Curve, Drawing, PxPoint};

/// Way along a stroke over which the direction of its end is taken, px: enough for one stair of a gentle slope.
const END_REACH_PX: f64 = 4.0;

/// Fewest vertices of a stroke that encloses something or comes back: there, back, and the first one again.
const MIN_CLOSED: usize = 3;

/// A stroke as the search sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stroke<'a> {
    /// Pen that draws it.
    pub(crate) pen: u8,
    /// Letter it belongs to, 0 for none; strokes are joined only within one letter.
    pub(crate) letter: usize,
    /// Places at which it may be entered if it is closed; else the first and the last one count.
    pub(crate) vertices: &'a [PxPoint],
    /// What lies between them.
    pub(crate) course: Course<'a>,
    /// Whether its last vertex is its first one again.
    pub(crate) closed: bool,
    /// Unit vectors in which it would go on beyond its first and its last vertex; (0, 0) for a dot.
    pub(crate) outward: [(f64, f64); 2],
}

impl Stroke<'_> {
    /// Its length, px.
    pub(crate) fn length_px(&self) -> f64 {
        self.course.length_px()
    }

    /// Where it begins (`false`) or ends (`true`).
    pub(crate) fn end(&self, last: bool) -> PxPoint {
        let vertex = if last { self.vertices.last() } else { self.vertices.first() };
        vertex.copied().unwrap_or_default()
    }
}

/// The strokes of a drawing.
pub(crate) fn strokes_of(drawing: &Drawing) -> Vec<Stroke<'_>> {
    drawing
        .strokes()
        .enumerate()
        .map(|(index, vertices)| {
            let places = drawing.stroke_chords(index, CHORD_ERROR_PX);
            Stroke {
                pen: drawing.pen(index),
                letter: 0,
                vertices,
                course: drawing.course(index),
                closed: vertices.len() >= MIN_CLOSED && vertices.first() == vertices.last(),
                outward: [outward(places.iter()), outward(places.iter().rev())],
            }
        })
        .collect()
}

/// The unit vector from a place some way along the stroke to its end; the walk begins at the end.
fn outward<'a>(mut walk: impl Iterator<Item = &'a PxPoint>) -> (f64, f64) {
    let Some(end) = walk.next() else { return (0.0, 0.0) };
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
pub(crate) struct Piece {
    /// Which stroke.
    pub(crate) stroke: usize,
    /// Whether it is drawn from its last vertex to its first one.
    pub(crate) reversed: bool,
    /// Vertex of a closed stroke with which it begins and ends.
    pub(crate) start: usize,
}

/// Strokes of the given drawing that are drawn as one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Trail {
    /// The strokes, each from where the one before ended.
    pub(crate) pieces: Vec<Piece>,
    /// Whether it comes back to where it began.
    pub(crate) closed: bool,
    /// Vertex of the closed trail with which it begins and ends.
    pub(crate) start: usize,
}

impl Trail {
    /// Pen of its strokes.
    pub(crate) fn pen(&self, strokes: &[Stroke<'_>]) -> u8 {
        self.pieces.first().and_then(|piece| strokes.get(piece.stroke)).map_or(0, |stroke| stroke.pen)
    }

    /// Its vertices in drawing order; a closed trail's last vertex is its first one.
    pub(crate) fn vertices(&self, strokes: &[Stroke<'_>]) -> Vec<PxPoint> {
        self.curve(strokes).vertices
    }

    /// Its vertices with its arcs and cubic curves.
    pub(crate) fn curve(&self, strokes: &[Stroke<'_>]) -> Curve {
        let mut joined = Curve::default();
        for piece in &self.pieces {
            let Some(stroke) = strokes.get(piece.stroke) else { continue };
            let mut own = Curve::from(stroke.course);
            if stroke.closed {
                own.begin_at(piece.start);
            }
            if piece.reversed {
                own.reverse();
            }
            // Across a gap the pen stays down.
            joined.append(own);
        }
        if self.closed && joined.vertices.first() != joined.vertices.last() {
            joined.append(joined.vertices.first().copied().into_iter().collect::<Vec<PxPoint>>().into());
        }
        if self.closed {
            joined.begin_at(self.start);
        }
        joined
    }

    /// Its first and its last vertex.
    pub(crate) fn ends(&self, strokes: &[Stroke<'_>]) -> (PxPoint, PxPoint) {
        if self.closed || self.pieces.iter().any(|piece| piece.start > 0) {
            let vertices = self.vertices(strokes);
            return (
                vertices.first().copied().unwrap_or_default(),
                vertices.last().copied().unwrap_or_default(),
            );
        }
        let end = |piece: Option<&Piece>, last: bool| {
            piece
                .and_then(|piece| Some(strokes.get(piece.stroke)?.end(last != piece.reversed)))
                .unwrap_or_default()
        };
        (end(self.pieces.first(), false), end(self.pieces.last(), true))
    }

    /// The same trail from its other end.
    pub(crate) fn reverse(&mut self) {
        self.pieces.reverse();
        for piece in &mut self.pieces {
            piece.reversed = !piece.reversed;
        }
    }
}

/// The drawing that draws the strokes of `drawing` as the trails say.
pub(crate) fn rebuild(drawing: &Drawing, strokes: &[Stroke<'_>], trails: &[Trail]) -> Drawing {
    let mut ordered = Drawing::new(drawing.width_px(), drawing.height_px());
    for trail in trails {
        ordered.push_curve(trail.pen(strokes), trail.curve(strokes));
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
        let mut trail =
            Trail { pieces: vec![Piece { stroke: 0, reversed: false, start: 1 }], ..Trail::default() };
        assert_eq!(trail.vertices(&strokes), [1, 2, 0, 1].map(at));
        trail.reverse();
        assert_eq!(trail.vertices(&strokes), [1, 0, 2, 1].map(at));
    }

    #[test]
    fn joined_strokes_share_their_common_vertex_only() {
        let mut drawing = Drawing::new(9, 9);
        drawing.push([0, 1].map(at));
        drawing.push([3, 1].map(at));
        drawing.push([4, 5].map(at));
        let pieces = [(0, false), (1, true), (2, false)];
        let pieces = pieces.map(|(stroke, reversed)| Piece { stroke, reversed, start: 0 }).to_vec();
        let trail = Trail { pieces, closed: true, start: 2 };
        assert_eq!(trail.vertices(&strokes_of(&drawing)), [3, 4, 5, 0, 1, 3].map(at));
    }
}
