//! What the search knows of a drawing ([`Stroke`]), what it answers ([`Trail`]), and [`rebuild`], the only place
//! that makes a drawing of the answer. A drawing of a million lines has a million of each, so they are small.

use super::sites::number;
use crate::curve::{CHORD_ERROR_PX, Course, unit};
use crate::{Curve, Drawing, PxPoint};

/// Way along a stroke over which the direction of its end is taken, px: enough for one stair of a gentle slope.
const END_REACH_PX: f64 = 4.0;

/// Fewest vertices of a closed stroke of lines: there, back, and the first one again. A loop of one curve has
/// two.
const MIN_CLOSED: usize = 3;

/// A stroke as the search sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stroke<'a> {
    drawing: &'a Drawing,
    index: u32,
    /// Its place in the given order.
    pub(crate) rank: u32,
    /// Letter it belongs to, 0 for none; strokes are joined only within one letter.
    pub(crate) letter: u32,
    /// Pen that draws it.
    pub(crate) pen: u8,
    /// Whether its last vertex is its first one again.
    pub(crate) closed: bool,
    /// Unit vectors in which it would go on beyond its first and its last vertex; (0, 0) for a dot.
    pub(crate) outward: [(f64, f64); 2],
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

    /// Its length, px.
    pub(crate) fn length_px(&self) -> f64 {
        self.course().length_px()
    }

    /// Where it begins (`false`) or ends (`true`).
    pub(crate) fn end(&self, last: bool) -> PxPoint {
        let vertices = self.vertices();
        let vertex = if last { vertices.last() } else { vertices.first() };
        vertex.copied().unwrap_or_default()
    }
}

/// The strokes of a drawing.
pub(crate) fn strokes_of(drawing: &Drawing) -> Vec<Stroke<'_>> {
    let stroke = |(vertices, index): (&[PxPoint], u32)| {
        let places = drawing.stroke_chords(index as usize, CHORD_ERROR_PX);
        let encloses = vertices.len() >= MIN_CLOSED || (vertices.len() > 1 && places.len() >= MIN_CLOSED);
        Stroke {
            drawing,
            index,
            rank: index,
            letter: 0,
            pen: drawing.pen(index as usize),
            closed: encloses && vertices.first() == vertices.last(),
            outward: [outward(places.iter()), outward(places.iter().rev())],
        }
    };
    drawing.strokes().zip(0..).map(stroke).collect()
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
    pub(crate) stroke: u32,
    /// Vertex of a closed stroke with which it begins and ends.
    pub(crate) start: u32,
    /// Whether it is drawn from its last vertex to its first one.
    pub(crate) reversed: bool,
}

/// Pieces that are drawn as one, each from where the one before ended: a range of all pieces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Trail {
    /// The first of its pieces, and one past the last.
    range: (u32, u32),
    /// Vertex of the closed trail with which it begins and ends.
    pub(crate) start: u32,
    /// Share of the piece from that vertex on, in parts of 2³², at which it begins and ends instead; 0 is the
    /// vertex.
    pub(crate) share: u32,
    /// Whether it comes back to where it began.
    pub(crate) closed: bool,
    /// Whether it is drawn from the end of the last piece.
    pub(crate) reversed: bool,
}

/// A share of a piece, 0 to 1, of what [`Trail::share`] says.
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

/// Parts of a piece in which places on it are counted: a metre in steps of less than a nanometre.
const PARTS: f64 = 4_294_967_296.0;

impl Trail {
    /// Its pieces as they are drawn.
    pub(crate) fn pieces(self, all: &[Piece]) -> impl Iterator<Item = Piece> + '_ {
        let own = all.get(self.range.0 as usize..self.range.1 as usize).unwrap_or(&[]);
        let last = own.len().saturating_sub(1);
        (0..own.len()).filter_map(move |k| {
            let piece = own.get(if self.reversed { last - k } else { k })?;
            Some(Piece { reversed: piece.reversed != self.reversed, ..*piece })
        })
    }
}

/// What trails are made of.
#[derive(Debug)]
pub(crate) struct Parts<'a> {
    pub(crate) strokes: &'a [Stroke<'a>],
    pub(crate) pieces: Vec<Piece>,
}

impl<'a> Parts<'a> {
    /// No pieces yet of these strokes.
    pub(crate) fn new(strokes: &'a [Stroke<'a>]) -> Self {
        Self { strokes, pieces: Vec::with_capacity(strokes.len()) }
    }

    /// The pieces as a trail.
    pub(crate) fn push(&mut self, pieces: impl IntoIterator<Item = Piece>, closed: bool) -> Trail {
        let from = number(self.pieces.len());
        self.pieces.extend(pieces);
        Trail { range: (from, number(self.pieces.len())), closed, ..Trail::default() }
    }

    fn of(&self, trail: Trail) -> impl Iterator<Item = (Piece, &Stroke<'a>)> {
        trail.pieces(&self.pieces).filter_map(|piece| Some((piece, self.strokes.get(piece.stroke as usize)?)))
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
        for (piece, stroke) in self.of(trail) {
            let mut own = Curve::from(stroke.course());
            if stroke.closed {
                own.begin_at(piece.start as usize);
            }
            if piece.reversed {
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

    /// Its first and its last vertex.
    pub(crate) fn ends(&self, trail: Trail) -> (PxPoint, PxPoint) {
        if trail.closed || trail.pieces(&self.pieces).any(|piece| piece.start > 0) {
            let vertices = self.vertices(trail);
            return (
                vertices.first().copied().unwrap_or_default(),
                vertices.last().copied().unwrap_or_default(),
            );
        }
        let mut ends = self.of(trail).map(|(piece, stroke)| (stroke, piece.reversed));
        let first = ends.next();
        let last = ends.last().or(first);
        let end = |known: Option<(&Stroke<'_>, bool)>, last| {
            known.map(|(stroke, reversed)| stroke.end(last != reversed)).unwrap_or_default()
        };
        (end(first, false), end(last, true))
    }
}

/// The drawing that draws the strokes of `drawing` as the trails say.
pub(crate) fn rebuild(drawing: &Drawing, parts: &Parts<'_>, trails: &[Trail]) -> Drawing {
    let mut ordered = Drawing::new(drawing.width_px(), drawing.height_px());
    for trail in trails {
        ordered.push_curve(parts.pen(*trail), parts.curve(*trail));
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
        let mut parts = Parts::new(&strokes);
        let mut trail = parts.push([Piece { stroke: 0, reversed: false, start: 1 }], false);
        assert_eq!(parts.vertices(trail), [1, 2, 0, 1].map(at));
        trail.reversed = true;
        assert_eq!(parts.vertices(trail), [1, 0, 2, 1].map(at));
    }

    #[test]
    fn joined_strokes_share_their_common_vertex_only() {
        let mut drawing = Drawing::new(9, 9);
        drawing.push([0, 1].map(at));
        drawing.push([3, 1].map(at));
        drawing.push([4, 5].map(at));
        let pieces = [(0, false), (1, true), (2, false)];
        let pieces = pieces.map(|(stroke, reversed)| Piece { stroke, reversed, start: 0 });
        let strokes = strokes_of(&drawing);
        let mut parts = Parts::new(&strokes);
        let mut trail = parts.push(pieces, true);
        trail.start = 2;
        assert_eq!(parts.vertices(trail), [3, 4, 5, 0, 1, 3].map(at));
    }
}
