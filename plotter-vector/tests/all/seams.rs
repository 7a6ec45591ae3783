//! A closed stroke may begin within one of its pieces. Here it begins at a vertex again, so that what is
//! drawn can be compared piece by piece.

use plotter_motion::Point;
use plotter_motion::drawing::{self, PathSegment, Shape, Stroke};
use plotter_vector::{
    Curve, Drawing, PxPoint,
    stroke::{Arc, Cubic},
};
use std::f64::consts::TAU;

/// How far a place on a piece may be off it, and how much the lengths of its parts may differ from its own.
const ROUNDING_PX: f64 = 1e-6;
const LENGTH_PX: f64 = 1e-9;

/// A piece: its ends, its bulge and its handles.
#[derive(Clone, Copy)]
struct Piece {
    from: PxPoint,
    to: PxPoint,
    bulge: f64,
    handles: Option<[PxPoint; 2]>,
}

impl Piece {
    fn all(curve: &Curve) -> impl Iterator<Item = Self> {
        (1..curve.vertices.len()).map(|next| Self {
            from: curve.vertices[next - 1],
            to: curve.vertices[next],
            bulge: curve.bulges.get(next - 1).copied().unwrap_or(0.0),
            handles: curve.handles.get(next - 1).copied().flatten(),
        })
    }

    fn reversed(self) -> Self {
        let handles = self.handles.map(|[first, second]| [second, first]);
        Self { from: self.to, to: self.from, bulge: -self.bulge, handles }
    }

    fn length_px(self) -> f64 {
        let curve = Curve {
            vertices: vec![self.from, self.to],
            bulges: vec![self.bulge],
            handles: vec![self.handles],
        };
        curve.length_px()
    }

    /// Whether these are its parts.
    fn is_parted(self, before: Self, after: Self) -> bool {
        let at = after.from;
        if let Some(cubic) = self.handles.and_then(|handles| Cubic::new(self.from, handles, self.to)) {
            // Its parts are those of de Casteljau, whose first and last handles tell t.
            let (Some([first, _]), Some([_, last])) = (before.handles, after.handles) else { return false };
            let [b, c] = cubic.handles;
            let (begin, end) = (self.from.distance(b), c.distance(self.to));
            let near = if begin > end {
                self.from.distance(first) / begin
            } else {
                1.0 - last.distance(self.to) / end
            };
            let along = |from: PxPoint, to: PxPoint| {
                PxPoint::new(from.x + near * (to.x - from.x), from.y + near * (to.y - from.y))
            };
            return cubic.at(near).distance(at) < ROUNDING_PX
                && first.distance(along(self.from, b)) < ROUNDING_PX
                && last.distance(along(c, self.to)) < ROUNDING_PX;
        }
        // A straight curve of two handles has parts that lie on a line between its ends, but is not that
        // line.
        if before.handles.is_some() || after.handles.is_some() {
            return false;
        }
        let off = match Arc::new(self.from, self.to, self.bulge) {
            Some(arc) => arc.distance(at),
            None => self.from.distance(at) + at.distance(self.to) - self.from.distance(self.to),
        };
        let sum = before.length_px() + after.length_px();
        off < ROUNDING_PX && (sum - self.length_px()).abs() < LENGTH_PX * (1.0 + sum)
    }
}

/// The piece of `given`, or the bridge, whose parts these two are; `None` where both are pieces themselves,
/// or where there is none.
fn whole_of(before: Piece, after: Piece, given: &[Piece]) -> Option<(Piece, Option<usize>)> {
    let own = || given.iter().flat_map(|piece| [*piece, piece.reversed()]);
    let is_one = |part: Piece| own().any(|piece| (piece.from, piece.to) == (part.from, part.to));
    if is_one(before) && is_one(after) {
        return None;
    }
    let ends = |piece: &Piece| piece.from == before.from && piece.to == after.to;
    let is_vertex = given.iter().any(|piece| piece.from == after.from || piece.to == after.from);
    // At a vertex lines meet: there a side that lies on one with its bridge would pass for one side.
    let is_curve = |piece: &Piece| piece.bulge != 0.0 || piece.handles.is_some();
    let found = own()
        .enumerate()
        .find(|(_, piece)| ends(piece) && (is_curve(piece) || !is_vertex) && piece.is_parted(before, after));
    let bridge = Piece { from: before.from, to: after.to, bulge: 0.0, handles: None };
    let bridged = (!is_vertex && bridge.is_parted(before, after)).then_some((bridge, None));
    found.map(|(index, piece)| (piece, Some(index))).or(bridged)
}

/// The drawing with every closed stroke that begins within a piece of `given`, or within a bridge, beginning
/// at its next vertex, and that piece whole.
pub(crate) fn unsplit(ordered: &Drawing, given: &Drawing) -> Drawing {
    let curves = (0..given.strokes().len()).map(|index| given.curve(index));
    let given: Vec<Piece> = curves.flat_map(|curve| Piece::all(&curve).collect::<Vec<_>>()).collect();
    let mut whole = Drawing::new(ordered.width_px(), ordered.height_px());
    for index in 0..ordered.strokes().len() {
        let mut curve = ordered.curve(index);
        let mut pieces: Vec<Piece> = Piece::all(&curve).collect();
        if let (Some(after), Some(before)) = (pieces.first().copied(), pieces.last().copied())
            && curve.vertices.len() > 2
            && before.to == after.from
            && let Some((piece, _)) = whole_of(before, after, &given)
        {
            pieces.pop();
            pieces.rotate_left(1);
            *pieces.last_mut().unwrap() = piece;
            curve = Curve {
                vertices: pieces.iter().map(|piece| piece.from).chain([piece.to]).collect(),
                bulges: pieces.iter().map(|piece| piece.bulge).collect(),
                handles: pieces.iter().map(|piece| piece.handles).collect(),
            };
        }
        whole.push_curve(ordered.pen(index), curve);
    }
    whole
}

/// The same on the sheet.
pub(crate) fn unsplit_sheet(ordered: &drawing::Drawing, given: &drawing::Drawing) -> drawing::Drawing {
    let px = |at: Point| PxPoint::new(at.x, at.y);
    let piece = |(from, segment): (Point, &PathSegment)| {
        let (bulge, handles) = match segment.shape {
            Shape::Line => (0.0, None),
            Shape::Arc { sweep_rad, .. } => ((0.25 * sweep_rad).tan(), None),
            Shape::Cubic { handles } => (0.0, Some(handles.map(px))),
        };
        Piece { from: px(from), to: px(segment.to), bulge, handles }
    };
    let whole = |stroke: &Stroke| {
        let (Some(before), Some(after)) = (stroke.segments().next_back(), stroke.segments().next()) else {
            return stroke.clone();
        };
        let style = |segment: &PathSegment| (segment.feed_mm_s, segment.power);
        if !stroke.is_closed() || stroke.segments.len() < 2 || style(before.1) != style(after.1) {
            return stroke.clone();
        }
        // The last segment goes, and the first one is another.
        let begun = |from: Point, segment: PathSegment| {
            let mut begun = Stroke { from, ..stroke.clone() };
            begun.segments.pop();
            begun.segments[0] = segment;
            begun
        };
        let turns = |about: Point| {
            let is_turn = |(from, segment): (Point, &PathSegment)| {
                segment.to == from && matches!(segment.shape, Shape::Arc { centre, .. } if centre == about)
            };
            given.strokes.iter().flat_map(Stroke::segments).any(is_turn)
        };
        if let (Shape::Arc { centre, sweep_rad: first }, Shape::Arc { centre: own, sweep_rad: last }) =
            (after.1.shape, before.1.shape)
            && (centre == own
                && after.1.to == before.0
                && ((first + last).abs() - TAU).abs() < ROUNDING_PX
                && turns(centre))
        {
            // A whole turn.
            let shape = Shape::Arc { centre, sweep_rad: first + last };
            return begun(before.0, PathSegment { shape, ..*after.1 });
        }
        // The other way round at odd places.
        let own =
            || given.strokes.iter().flat_map(Stroke::segments).filter(|own| style(own.1) == style(before.1));
        let known: Vec<Piece> = own().map(piece).collect();
        if let Some((_, index)) = whole_of(piece(before), piece(after), &known) {
            let (from, segment) = match index.and_then(|index| Some((index, own().nth(index / 2)?))) {
                Some((index, (from, segment))) if index % 2 == 0 => (from, *segment),
                Some((_, (from, segment))) => (segment.to, segment.reversed(from)),
                None => (before.0, PathSegment { to: after.1.to, ..*before.1 }),
            };
            return begun(from, segment);
        }
        stroke.clone()
    };
    drawing::Drawing { strokes: ordered.strokes.iter().map(whole).collect(), ..ordered.clone() }
}
