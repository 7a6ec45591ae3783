//! [`Region`]: the part of the sheet that clip paths and masks leave, and strokes cut along its border.
//!
//! ```text
//!        ┌──────┐         A segment of a stroke is cut wherever it meets an edge. Each piece
//!   ─────┼──────┼─────    between two cuts lies wholly inside or wholly outside, so its middle
//!        └──────┘         decides.
//! ```
//!
//! A piece along the border of a clip path is kept, for half of the stroke's width shows there. A piece along
//! the border of a shape painted later is dropped, for that shape's own ink covers it.
//!
//! Lengths are px of SVG, 1/96 inch. All searches draw on one budget of work, so that no file takes hours.

use super::box_tree::{Bounds, BoxTree, Steps};
use super::curve::{Cubic, distance_to_segment};
use super::mask::Painted;
use super::{MAX_PX, SvgError};
use crate::stroke::curve::Segment;
use crate::stroke::{Arc, Curve, PxPoint};
use core::f64::consts::TAU;
use usvg::tiny_skia_path::{Path, PathSegment, Point, Transform};

/// Tolerance at the ends of an edge or segment, as a fraction of its length: it covers rounding.
const END_TOLERANCE: f64 = 1e-9;
/// Pieces shorter than this fraction of their segment are ignored.
const SHORTEST_PIECE: f64 = 1e-9;
/// Step in which a segment is searched for changes by a gradient, px; 0.13 mm, a third of a fine pen's width.
const GRADIENT_STEP_PX: f64 = 0.5;
/// Most such steps of one segment: enough for 8.7 m. Longer ones have longer steps.
const MAX_GRADIENT_STEPS: f64 = 65_536.0;
/// Halvings of such a step: 0.5 px becomes 10⁻⁴ px.
const HALVINGS: usize = 13;
/// Edges are nearly parallel to a segment below this sine of the angle between them, a 16th of a degree.
/// Rounding makes their crossing uncertain then, so the ends of the edge are cuts as well.
const NEARLY_PARALLEL: f64 = 1e-3;
/// Margin around a segment's box in the search for edges, px: it covers rounding.
const BOX_MARGIN_PX: f64 = 1e-6;

/// Position of a point relative to a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Side {
    Outside,
    /// Within the tolerance of the border.
    Edge,
    Inside,
}

/// A part of the sheet.
#[derive(Clone, Debug)]
pub(super) enum Region {
    /// A filled outline.
    Shape(Shape),
    /// The union.
    Any(Vec<Region>),
    /// The intersection.
    All(Vec<Region>),
    /// Where a mask lets through.
    Painted(Box<Painted>),
}

impl Region {
    /// On which side of the border a point lies; within `edge_px` of an edge it is on the border.
    pub(super) fn side(&self, at: PxPoint, edge_px: f64, budget: &mut Steps) -> Side {
        match self {
            Self::Shape(shape) => shape.side(at, edge_px, budget),
            Self::Any(parts) => {
                let sides = parts.iter().map(|part| part.side(at, edge_px, budget));
                sides.max().unwrap_or(Side::Outside)
            }
            Self::All(parts) => {
                parts.iter().map(|part| part.side(at, edge_px, budget)).min().unwrap_or(Side::Inside)
            }
            Self::Painted(mask) => {
                if mask.shows(at, budget) {
                    return Side::Inside;
                }
                // Away from edges a mask only fades, so its border has no tolerance there.
                let mut has_near_edge = false;
                mask.shapes(&mut |shape| has_near_edge = has_near_edge || shape.is_near(at, edge_px, budget));
                if !has_near_edge {
                    return Side::Outside;
                }
                let around = [(edge_px, 0.0), (-edge_px, 0.0), (0.0, edge_px), (0.0, -edge_px)];
                let shows_beside =
                    around.into_iter().any(|(x, y)| mask.shows(PxPoint::new(at.x + x, at.y + y), budget));
                if shows_beside { Side::Edge } else { Side::Outside }
            }
        }
    }

    /// Hands each filled outline in it to `visit`.
    pub(super) fn shapes<'a>(&'a self, visit: &mut dyn FnMut(&'a Shape)) {
        match self {
            Self::Shape(shape) => visit(shape),
            Self::Any(parts) | Self::All(parts) => parts.iter().for_each(|part| part.shapes(visit)),
            Self::Painted(mask) => mask.shapes(visit),
        }
    }

    /// Whether the region may also end away from the edges of its shapes, by a gradient of a mask.
    fn has_gradients(&self) -> bool {
        match self {
            Self::Shape(_) => false,
            Self::Any(parts) | Self::All(parts) => parts.iter().any(Self::has_gradients),
            Self::Painted(mask) => mask.has_gradients(),
        }
    }

    /// Number of edges of its shapes.
    pub(super) fn edge_count(&self) -> usize {
        let mut count = 0_usize;
        self.shapes(&mut |shape| count = count.saturating_add(shape.edge_count()));
        count
    }

    /// A box around the region.
    pub(super) fn bounds(&self) -> Bounds {
        match self {
            // The intersection lies within each of its parts: the first one will do.
            Self::All(parts) => parts.first().map_or(Bounds::NONE, Self::bounds),
            _ => {
                let mut bounds = Bounds::NONE;
                self.shapes(&mut |shape| bounds = bounds.with(shape.tree.bounds()));
                bounds
            }
        }
    }

    /// The pieces of a stroke that are inside, or outside; `None` if the whole stroke is kept.
    ///
    /// # Errors
    /// [`SvgError::TooMuchClipping`].
    pub(super) fn cut(
        &self,
        stroke: &Curve,
        keep: Keep,
        edge_px: f64,
        budget: &mut Steps,
    ) -> Result<Option<Vec<Curve>>, SvgError> {
        let Some(first) = stroke.vertices.first().copied() else { return Ok(None) };
        budget.check()?;
        let has_gradients = self.has_gradients();
        let search_box = bounds_of(stroke).grown(edge_px);
        let mut may_be_cut = has_gradients;
        self.shapes(&mut |shape| may_be_cut = may_be_cut || shape.touches(&search_box, budget));
        if stroke.vertices.len() == 1 || !may_be_cut {
            return Ok(if self.is_kept(first, keep, edge_px, budget) { None } else { Some(Vec::new()) });
        }
        let (mut pieces, mut piece, mut is_whole) = (Vec::new(), Curve::default(), true);
        let mut cuts = Vec::new();
        for segment in stroke.course().segments() {
            budget.check()?;
            cuts.clear();
            cuts.extend([0.0, 1.0]);
            self.shapes(&mut |shape| shape.meet(&segment, &mut cuts, budget));
            if has_gradients {
                gradient_cuts(&segment, &mut cuts, |at| self.is_kept(at, keep, edge_px, budget));
            }
            cuts.sort_unstable_by(f64::total_cmp);
            let mut since = None;
            let mut last = 0.0;
            for cut in cuts.iter().copied() {
                if cut - last <= SHORTEST_PIECE {
                    continue;
                }
                let middle = point_at(&segment, f64::midpoint(last, cut));
                if self.is_kept(middle, keep, edge_px, budget) {
                    since = since.or(Some(last));
                } else {
                    is_whole = false;
                    if let Some(start) = since.take() {
                        append_piece(&mut piece, &segment, start, last);
                    }
                    pieces.extend(take_if_not_empty(&mut piece));
                }
                last = cut;
            }
            if let Some(start) = since {
                append_piece(&mut piece, &segment, start, 1.0);
            }
        }
        if is_whole {
            return Ok(None);
        }
        pieces.extend(take_if_not_empty(&mut piece));
        // A closed stroke that begins inside continues over its beginning.
        let is_closed = stroke.vertices.last() == Some(&first) && pieces.len() > 1;
        let continues = is_closed
            && pieces.first().and_then(|piece| piece.vertices.first()) == Some(&first)
            && pieces.last().and_then(|piece| piece.vertices.last()) == Some(&first);
        if continues {
            let start = pieces.remove(0);
            if let Some(end) = pieces.last_mut() {
                end.append(start);
            }
        }
        Ok(Some(pieces))
    }

    /// Whether a point of a stroke remains. The border of a clip path is kept, that of a later shape is not:
    /// see the module.
    fn is_kept(&self, at: PxPoint, keep: Keep, edge_px: f64, budget: &mut Steps) -> bool {
        match (keep, self.side(at, edge_px, budget)) {
            (Keep::Inside, side) => side != Side::Outside,
            (Keep::Outside, side) => side == Side::Outside,
        }
    }
}

/// Adds where a gradient begins or ends to keep a segment, as fractions of the segment: it is searched in
/// steps, and each step with a change is halved.
fn gradient_cuts(segment: &Segment, cuts: &mut Vec<f64>, mut is_kept: impl FnMut(PxPoint) -> bool) {
    let count = libm::ceil(length_px(segment) / GRADIENT_STEP_PX).clamp(1.0, MAX_GRADIENT_STEPS);
    let mut before = (0.0, is_kept(point_at(segment, 0.0)));
    let mut step = 1.0;
    while step <= count {
        let after = (step / count, is_kept(point_at(segment, step / count)));
        if before.1 != after.1 {
            let (mut low, mut high) = (before.0, after.0);
            for _ in 0..HALVINGS {
                let middle = f64::midpoint(low, high);
                if is_kept(point_at(segment, middle)) == before.1 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            cuts.push(high);
        }
        before = after;
        step += 1.0;
    }
}

/// Which pieces of a stroke remain: those inside the region or those outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keep {
    Inside,
    Outside,
}

/// A filled outline.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    edges: Vec<[PxPoint; 2]>,
    /// Boxes around the edges, by their numbers.
    tree: BoxTree,
    is_even_odd: bool,
}

impl Shape {
    /// The outline of `path`, moved by `matrix`. Curves become chords within `tolerance_px`; `limit` is the
    /// greatest number of edges.
    ///
    /// As SVG fills, it closes open subpaths by an edge.
    ///
    /// # Errors
    /// [`SvgError::TooManyVertices`].
    pub(super) fn new(
        path: &Path,
        matrix: Transform,
        is_even_odd: bool,
        tolerance_px: f64,
        limit: usize,
    ) -> Result<Self, SvgError> {
        let [a, b, c, d, e, f] =
            [matrix.sx, matrix.ky, matrix.kx, matrix.sy, matrix.tx, matrix.ty].map(f64::from);
        let on_sheet = |at: Point| {
            let (x, y) = (f64::from(at.x), f64::from(at.y));
            // Coordinates beyond four times the greatest of a stroke may be cut off: no stroke comes there.
            let bound = |at: f64| if at.is_nan() { 0.0 } else { at.clamp(-4.0 * MAX_PX, 4.0 * MAX_PX) };
            PxPoint::new(bound(a * x + c * y + e), bound(b * x + d * y + f))
        };
        let mut edges: Vec<[PxPoint; 2]> = Vec::new();
        let (mut start, mut last) = (PxPoint::new(0.0, 0.0), PxPoint::new(0.0, 0.0));
        for segment in path.segments() {
            match segment {
                PathSegment::MoveTo(to) => {
                    edges.push([last, start]);
                    (start, last) = (on_sheet(to), on_sheet(to));
                }
                PathSegment::LineTo(to) => {
                    edges.push([last, on_sheet(to)]);
                    last = on_sheet(to);
                }
                PathSegment::QuadTo(..) | PathSegment::CubicTo(..) => {
                    let curve = match segment {
                        PathSegment::CubicTo(one, two, to) => {
                            Cubic([last, on_sheet(one), on_sheet(two), on_sheet(to)])
                        }
                        PathSegment::QuadTo(one, to) => {
                            Cubic::from_quadratic([last, on_sheet(one), on_sheet(to)])
                        }
                        _ => continue,
                    };
                    for to in curve.chords(tolerance_px) {
                        edges.push([last, to]);
                        last = to;
                        if edges.len() > limit {
                            return Err(SvgError::TooManyVertices { limit });
                        }
                    }
                }
                PathSegment::Close => {
                    edges.push([last, start]);
                    last = start;
                }
            }
            if edges.len() > limit {
                return Err(SvgError::TooManyVertices { limit });
            }
        }
        edges.push([last, start]);
        edges.retain(|[from, to]| from != to);
        let tree = BoxTree::new(edges.iter().map(|edge| Bounds::of(*edge)).collect());
        Ok(Self { edges, tree, is_even_odd })
    }

    /// Number of edges.
    pub(super) fn edge_count(&self) -> usize {
        self.edges.len()
    }

    fn side(&self, at: PxPoint, edge_px: f64, budget: &mut Steps) -> Side {
        if edge_px > 0.0 && self.is_near(at, edge_px, budget) {
            return Side::Edge;
        }
        if self.contains(at, budget) { Side::Inside } else { Side::Outside }
    }

    fn is_near(&self, at: PxPoint, edge_px: f64, budget: &mut Steps) -> bool {
        let mut near = false;
        let around = Bounds { least: at, most: at }.grown(edge_px);
        self.tree.find(&around, budget, |number| {
            let edge = self.edges.get(number);
            near = edge.is_some_and(|[from, to]| distance_to_segment(at, *from, *to) <= edge_px);
            !near
        });
        near
    }

    /// Whether a point is filled, by the edges that a ray from it to the right crosses.
    pub(super) fn contains(&self, at: PxPoint, budget: &mut Steps) -> bool {
        let ray = Bounds { least: at, most: PxPoint::new(f64::INFINITY, at.y) };
        let (mut winding, mut crossed) = (0_i64, 0_u64);
        self.tree.find(&ray, budget, |number| {
            if let Some([from, to]) = self.edges.get(number) {
                let (down, up) = (from.y <= at.y && to.y > at.y, to.y <= at.y && from.y > at.y);
                let cross = (*to - *from).cross(at - *from);
                if (down && cross > 0.0) || (up && cross < 0.0) {
                    winding += if down { 1 } else { -1 };
                    crossed += 1;
                }
            }
            true
        });
        if self.is_even_odd { crossed % 2 == 1 } else { winding != 0 }
    }

    fn touches(&self, area: &Bounds, budget: &mut Steps) -> bool {
        let mut touches = false;
        self.tree.find(area, budget, |_| {
            touches = true;
            false
        });
        touches
    }

    /// Adds where a segment meets the edges, as fractions of the segment.
    fn meet(&self, segment: &Segment, cuts: &mut Vec<f64>, budget: &mut Steps) {
        let area = segment_bounds(segment);
        self.tree.find(&area, budget, |number| {
            if let Some(edge) = self.edges.get(number) {
                match segment {
                    Segment::Arc(arc) => meet_arc(arc, *edge, cuts),
                    segment => meet_line([point_at(segment, 0.0), point_at(segment, 1.0)], *edge, cuts),
                }
            }
            true
        });
    }
}

/// Adds where the line from `from` to `to` meets the edge from `start` to `end`, as fractions of the line.
fn meet_line([from, to]: [PxPoint; 2], [start, end]: [PxPoint; 2], cuts: &mut Vec<f64>) {
    let (way, edge, between) = (to - from, end - start, start - from);
    let cross = way.cross(edge);
    // Of parallel lines the quotients are infinite or NaN, which are not within the ends.
    let (along, on_edge) = (between.cross(edge) / cross, between.cross(way) / cross);
    let within = |fraction: f64| (-END_TOLERANCE..=1.0 + END_TOLERANCE).contains(&fraction);
    if within(along) && within(on_edge) {
        cuts.push(along.clamp(0.0, 1.0));
    }
    let length_squared = way.length_squared();
    if length_squared > 0.0
        && cross.abs() <= NEARLY_PARALLEL * libm::sqrt(length_squared * edge.length_squared())
    {
        let ends = [start, end].map(|end| (end - from).dot(way) / length_squared);
        cuts.extend(ends.into_iter().filter(|end| (0.0..=1.0).contains(end)));
    }
}

/// Adds where an arc meets the edge from `start` to `end`, as fractions of the arc's angle.
///
/// The points S + u E of the edge on the circle of radius r around C satisfy |S − C + u E|² = r², which is
/// quadratic in u.
fn meet_arc(arc: &Arc, [start, end]: [PxPoint; 2], cuts: &mut Vec<f64>) {
    let (edge, from_centre) = (end - start, start - arc.centre);
    let (a, half_b) = (edge.length_squared(), edge.dot(from_centre));
    let discriminant = half_b * half_b - a * (from_centre.length_squared() - arc.radius_px * arc.radius_px);
    if a == 0.0 || discriminant < 0.0 {
        return;
    }
    let from = arc.from - arc.centre;
    for sign in [-1.0, 1.0] {
        let on_edge = (-half_b + sign * libm::sqrt(discriminant)) / a;
        if !(-END_TOLERANCE..=1.0 + END_TOLERANCE).contains(&on_edge) {
            continue;
        }
        let radius = from_centre + edge * on_edge;
        let angle_rad = libm::atan2(from.cross(radius), from.dot(radius));
        for angle in [angle_rad - TAU, angle_rad, angle_rad + TAU] {
            let along = angle / arc.sweep_rad;
            if (0.0..=1.0).contains(&along) {
                cuts.push(along);
            }
        }
    }
}

/// The point of a segment at a fraction of its length, 0 to 1. Strokes from SVG have lines and arcs only: the
/// reader has made chords or arcs of cubics before.
fn point_at(segment: &Segment, t: f64) -> PxPoint {
    match segment {
        Segment::Arc(arc) if t > 0.0 && t < 1.0 => arc.at(t),
        Segment::Arc(arc) => {
            if t <= 0.0 {
                arc.from
            } else {
                arc.to
            }
        }
        Segment::Line(from, to) => {
            let rest = 1.0 - t;
            PxPoint::new(rest * from.x + t * to.x, rest * from.y + t * to.y)
        }
        Segment::Cubic(cubic) => {
            debug_assert!(false, "strokes from SVG have lines and arcs only");
            if t <= 0.5 { cubic.from } else { cubic.to }
        }
    }
}

fn length_px(segment: &Segment) -> f64 {
    match segment {
        Segment::Arc(arc) => arc.length_px(),
        segment => point_at(segment, 0.0).distance(point_at(segment, 1.0)),
    }
}

fn segment_bounds(segment: &Segment) -> Bounds {
    match segment {
        Segment::Arc(arc) => {
            let circle = Bounds { least: arc.centre, most: arc.centre };
            circle.grown(arc.radius_px)
        }
        segment => Bounds::of([point_at(segment, 0.0), point_at(segment, 1.0)]),
    }
    .grown(BOX_MARGIN_PX)
}

/// A box around a stroke.
pub(super) fn bounds_of(stroke: &Curve) -> Bounds {
    let vertices = Bounds::of(stroke.vertices.iter().copied());
    if stroke.bulges.is_empty() {
        return vertices;
    }
    stroke.course().segments().fold(vertices, |bounds, segment| bounds.with(segment_bounds(&segment)))
}

/// Appends the part of a segment between two fractions of it.
fn append_piece(piece: &mut Curve, segment: &Segment, start: f64, end: f64) {
    if piece.vertices.is_empty() {
        piece.vertices.push(point_at(segment, start));
    }
    if let Segment::Arc(arc) = segment {
        piece.bulges.resize(piece.vertices.len() - 1, 0.0);
        piece.bulges.push(libm::tan(0.25 * arc.sweep_rad * (end - start)));
    }
    piece.vertices.push(point_at(segment, end));
}

fn take_if_not_empty(piece: &mut Curve) -> Option<Curve> {
    (piece.vertices.len() > 1).then(|| core::mem::take(piece))
}
