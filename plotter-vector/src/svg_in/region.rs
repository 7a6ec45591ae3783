//! [`Region`]: the part of the sheet that clip paths and masks leave, and strokes cut along its border.
//!
//! ```text
//!        ┌──────┐         a segment of a stroke is cut wherever it meets an edge; each part between two cuts
//!   ─────┼──────┼─────    lies wholly inside or outside, so that its middle tells
//!        └──────┘
//! ```
//!
//! The part on an edge is kept: half of the stroke's width shows there.

use super::box_tree::{Bounds, BoxTree, Steps};
use super::curve::{Cubic, distance_to_segment};
use super::mask::Painted;
use super::{MAX_PX, SvgError};
use crate::stroke::curve::Segment;
use crate::stroke::{Arc, Curve, PxPoint};
use usvg::tiny_skia_path::{Path, PathSegment, Point, Transform};

/// How far beyond its ends an edge or a segment still meets another, in parts of it: what rounding takes.
const BEYOND: f64 = 1e-9;
/// Parts of a segment shorter than this are none, in parts of it.
const SHORTEST: f64 = 1e-9;
/// Step along a segment in which what changes without an edge, a gradient, is looked for, px: 0.13 mm.
const GRADIENT_STEP_PX: f64 = 0.5;
/// Most such steps of one segment.
const MAX_GRADIENT_STEPS: f64 = 65_536.0;
/// Halvings of such a step: to 10⁻⁴ px.
const HALVINGS: usize = 13;

/// Where a place lies.
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
    /// What is in one of them.
    Any(Vec<Region>),
    /// What is in all of them.
    All(Vec<Region>),
    /// What is light in a mask.
    Painted(Box<Painted>),
}

impl Region {
    /// Where a place lies; within `edge_px` of an edge is on it.
    pub(super) fn side(&self, at: PxPoint, edge_px: f64, steps: &mut Steps) -> Side {
        match self {
            Self::Shape(shape) => shape.side(at, edge_px, steps),
            Self::Any(parts) => {
                let sides = parts.iter().map(|part| part.side(at, edge_px, steps));
                sides.max().unwrap_or(Side::Outside)
            }
            Self::All(parts) => {
                parts.iter().map(|part| part.side(at, edge_px, steps)).min().unwrap_or(Side::Inside)
            }
            Self::Painted(mask) => {
                if mask.shows(at, steps) {
                    return Side::Inside;
                }
                // Where no edge is near, it changes little by little.
                let mut near = false;
                mask.shapes(&mut |shape| near = near || shape.is_near(at, edge_px, steps));
                if !near {
                    return Side::Outside;
                }
                let beside = [(edge_px, 0.0), (-edge_px, 0.0), (0.0, edge_px), (0.0, -edge_px)];
                let near =
                    beside.into_iter().any(|(x, y)| mask.shows(PxPoint::new(at.x + x, at.y + y), steps));
                if near { Side::Edge } else { Side::Outside }
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

    /// Whether it changes elsewhere than at the edges of its shapes.
    fn has_gradients(&self) -> bool {
        match self {
            Self::Shape(_) => false,
            Self::Any(parts) | Self::All(parts) => parts.iter().any(Self::has_gradients),
            Self::Painted(mask) => mask.has_gradients(),
        }
    }

    /// How many edges its shapes have.
    pub(super) fn edges(&self) -> usize {
        let mut edges = 0_usize;
        self.shapes(&mut |shape| edges = edges.saturating_add(shape.edges()));
        edges
    }

    /// A box around it.
    pub(super) fn bounds(&self) -> Bounds {
        match self {
            // Within the first of them, whatever the others.
            Self::All(parts) => parts.first().map_or(Bounds::NONE, Self::bounds),
            _ => {
                let mut bounds = Bounds::NONE;
                self.shapes(&mut |shape| bounds = bounds.with(shape.edges.bounds()));
                bounds
            }
        }
    }

    /// The parts of a stroke that are inside, or outside; `None` where that is all of it.
    ///
    /// # Errors
    /// [`SvgError::TooMuchClipping`].
    pub(super) fn cut(
        &self,
        stroke: &Curve,
        keep: Keep,
        edge_px: f64,
        steps: &mut Steps,
    ) -> Result<Option<Vec<Curve>>, SvgError> {
        let is_kept = |at: PxPoint, steps: &mut Steps| match (keep, self.side(at, edge_px, steps)) {
            // What a clip path leaves has its border, and what lies on the border of a later shape is hidden
            // by its ink.
            (Keep::Inside, side) => side != Side::Outside,
            (Keep::Outside, side) => side == Side::Outside,
        };
        let Some(first) = stroke.vertices.first().copied() else { return Ok(None) };
        steps.check()?;
        let gradients = self.has_gradients();
        let near = bounds_of(stroke).grown(edge_px);
        let mut is_crossed = gradients;
        self.shapes(&mut |shape| is_crossed = is_crossed || shape.touches(&near, steps));
        if stroke.vertices.len() == 1 || !is_crossed {
            return Ok(if is_kept(first, steps) { None } else { Some(Vec::new()) });
        }
        let (mut parts, mut part, mut whole) = (Vec::new(), Curve::default(), true);
        let mut cuts = Vec::new();
        for segment in stroke.course().segments() {
            steps.check()?;
            cuts.clear();
            cuts.extend([0.0, 1.0]);
            self.shapes(&mut |shape| shape.meet(&segment, &mut cuts, steps));
            if gradients {
                let length = chord_length(&segment);
                let count = libm::ceil(length / GRADIENT_STEP_PX).clamp(1.0, MAX_GRADIENT_STEPS);
                let mut before = (0.0, is_kept(at(&segment, 0.0), steps));
                let mut step = 1.0;
                while step <= count {
                    let after = (step / count, is_kept(at(&segment, step / count), steps));
                    if before.1 != after.1 {
                        let (mut low, mut high) = (before.0, after.0);
                        for _ in 0..HALVINGS {
                            let middle = f64::midpoint(low, high);
                            if is_kept(at(&segment, middle), steps) == before.1 {
                                low = middle
                            } else {
                                high = middle
                            }
                        }
                        cuts.push(high);
                    }
                    before = after;
                    step += 1.0;
                }
            }
            cuts.sort_unstable_by(f64::total_cmp);
            let mut since = None;
            let mut last = 0.0;
            for cut in cuts.iter().copied() {
                if cut - last <= SHORTEST {
                    continue;
                }
                if is_kept(at(&segment, f64::midpoint(last, cut)), steps) {
                    since = since.or(Some(last));
                } else {
                    whole = false;
                    if let Some(start) = since.take() {
                        add(&mut part, &segment, start, last);
                    }
                    parts.extend(taken(&mut part));
                }
                last = cut;
            }
            if let Some(start) = since {
                add(&mut part, &segment, start, 1.0);
            }
        }
        if whole {
            return Ok(None);
        }
        parts.extend(taken(&mut part));
        // A closed stroke that begins inside goes on over its beginning.
        let closed = stroke.vertices.last() == Some(&first) && parts.len() > 1;
        let joined = closed
            && parts.first().and_then(|part| part.vertices.first()) == Some(&first)
            && parts.last().and_then(|part| part.vertices.last()) == Some(&first);
        if joined {
            let start = parts.remove(0);
            if let Some(end) = parts.last_mut() {
                end.append(start);
            }
        }
        Ok(Some(parts))
    }
}

/// Which parts of a stroke remain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keep {
    Inside,
    Outside,
}

/// A filled outline.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    lines: Vec<[PxPoint; 2]>,
    edges: BoxTree,
    is_even_odd: bool,
}

impl Shape {
    /// That of a path, its curves in chords within the tolerance.
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
        let place = |at: Point| {
            let (x, y) = (f64::from(at.x), f64::from(at.y));
            // What lies farther out is beyond any stroke, too.
            let bound = |at: f64| if at.is_nan() { 0.0 } else { at.clamp(-4.0 * MAX_PX, 4.0 * MAX_PX) };
            PxPoint::new(bound(a * x + c * y + e), bound(b * x + d * y + f))
        };
        let mut lines: Vec<[PxPoint; 2]> = Vec::new();
        let (mut start, mut last) = (PxPoint::new(0.0, 0.0), PxPoint::new(0.0, 0.0));
        for segment in path.segments() {
            match segment {
                PathSegment::MoveTo(to) => {
                    lines.push([last, start]);
                    (start, last) = (place(to), place(to));
                }
                PathSegment::LineTo(to) => {
                    lines.push([last, place(to)]);
                    last = place(to);
                }
                PathSegment::QuadTo(..) | PathSegment::CubicTo(..) => {
                    let curve = match segment {
                        PathSegment::CubicTo(one, two, to) => {
                            Cubic([last, place(one), place(two), place(to)])
                        }
                        PathSegment::QuadTo(one, to) => Cubic::from_quadratic([last, place(one), place(to)]),
                        _ => continue,
                    };
                    for to in curve.chords(tolerance_px) {
                        lines.push([last, to]);
                        last = to;
                        if lines.len() > limit {
                            return Err(SvgError::TooManyVertices { limit });
                        }
                    }
                }
                PathSegment::Close => {
                    lines.push([last, start]);
                    last = start;
                }
            }
            if lines.len() > limit {
                return Err(SvgError::TooManyVertices { limit });
            }
        }
        lines.push([last, start]);
        lines.retain(|[from, to]| from != to);
        let edges = BoxTree::new(lines.iter().map(|line| Bounds::of(*line)).collect());
        Ok(Self { lines, edges, is_even_odd })
    }

    /// How many edges it has.
    pub(super) fn edges(&self) -> usize {
        self.lines.len()
    }

    fn side(&self, at: PxPoint, edge_px: f64, steps: &mut Steps) -> Side {
        if edge_px > 0.0 && self.is_near(at, edge_px, steps) {
            return Side::Edge;
        }
        if self.holds(at, steps) { Side::Inside } else { Side::Outside }
    }

    fn is_near(&self, at: PxPoint, edge_px: f64, steps: &mut Steps) -> bool {
        let mut near = false;
        let around = Bounds { least: at, most: at }.grown(edge_px);
        self.edges.find(&around, steps, |edge| {
            let line = self.lines.get(edge);
            near = line.is_some_and(|[from, to]| distance_to_segment(at, *from, *to) <= edge_px);
            !near
        });
        near
    }

    /// Whether a place is filled: by the edges that a ray to the right crosses.
    pub(super) fn holds(&self, at: PxPoint, steps: &mut Steps) -> bool {
        let ray = Bounds { least: at, most: PxPoint::new(f64::INFINITY, at.y) };
        let (mut winding, mut crossed) = (0_i64, 0_u64);
        self.edges.find(&ray, steps, |edge| {
            if let Some([from, to]) = self.lines.get(edge) {
                let (down, up) = (from.y <= at.y && to.y > at.y, to.y <= at.y && from.y > at.y);
                let turn = (*to - *from).cross(at - *from);
                if (down && turn > 0.0) || (up && turn < 0.0) {
                    winding += if down { 1 } else { -1 };
                    crossed += 1;
                }
            }
            true
        });
        if self.is_even_odd { crossed % 2 == 1 } else { winding != 0 }
    }

    fn touches(&self, area: &Bounds, steps: &mut Steps) -> bool {
        let mut touches = false;
        self.edges.find(area, steps, |_| {
            touches = true;
            false
        });
        touches
    }

    /// Adds where a segment meets the edges, in parts of the segment.
    fn meet(&self, segment: &Segment, cuts: &mut Vec<f64>, steps: &mut Steps) {
        let area = segment_bounds(segment);
        self.edges.find(&area, steps, |edge| {
            if let Some(line) = self.lines.get(edge) {
                match segment {
                    Segment::Arc(arc) => meet_arc(arc, *line, cuts),
                    segment => meet_line([at(segment, 0.0), at(segment, 1.0)], *line, cuts),
                }
            }
            true
        });
    }
}

fn meet_line([from, to]: [PxPoint; 2], [start, end]: [PxPoint; 2], cuts: &mut Vec<f64>) {
    let (way, edge, between) = (to - from, end - start, start - from);
    let turn = way.cross(edge);
    let (along, on_edge) = (between.cross(edge) / turn, between.cross(way) / turn);
    let within = |part: f64| (-BEYOND..=1.0 + BEYOND).contains(&part);
    if within(along) && within(on_edge) {
        cuts.push(along.clamp(0.0, 1.0));
    }
    // Beside each other, or nearly: the ends of the edge are cuts.
    let length = way.length_squared();
    if length > 0.0 && turn.abs() <= 1e-3 * libm::sqrt(length * edge.length_squared()) {
        let ends = [start, end].map(|end| (end - from).dot(way) / length);
        cuts.extend(ends.into_iter().filter(|end| (0.0..=1.0).contains(end)));
    }
}

/// Of the circle |C + R| = r and the edge S + u E: |S − C + u E|² = r².
fn meet_arc(arc: &Arc, [start, end]: [PxPoint; 2], cuts: &mut Vec<f64>) {
    let (edge, out) = (end - start, start - arc.centre);
    let (square, half) = (edge.length_squared(), edge.dot(out));
    let root = half * half - square * (out.length_squared() - arc.radius_px * arc.radius_px);
    if square == 0.0 || root < 0.0 {
        return;
    }
    let from = arc.from - arc.centre;
    for sign in [-1.0, 1.0] {
        let on_edge = (-half + sign * libm::sqrt(root)) / square;
        if !(-BEYOND..=1.0 + BEYOND).contains(&on_edge) {
            continue;
        }
        let place = out + edge * on_edge;
        let turned = libm::atan2(from.cross(place), from.dot(place));
        let turn = core::f64::consts::TAU;
        for angle in [turned - turn, turned, turned + turn] {
            let along = angle / arc.sweep_rad;
            if (0.0..=1.0).contains(&along) {
                cuts.push(along);
            }
        }
    }
}

/// A place of a segment, a part of the way along it. No cubic curves are made here.
fn at(segment: &Segment, part: f64) -> PxPoint {
    match segment {
        Segment::Arc(arc) if part > 0.0 && part < 1.0 => arc.at(part),
        Segment::Arc(arc) => {
            if part <= 0.0 {
                arc.from
            } else {
                arc.to
            }
        }
        Segment::Line(from, to) => {
            let rest = 1.0 - part;
            PxPoint::new(rest * from.x + part * to.x, rest * from.y + part * to.y)
        }
        Segment::Cubic(cubic) => {
            if part <= 0.5 {
                cubic.from
            } else {
                cubic.to
            }
        }
    }
}

fn chord_length(segment: &Segment) -> f64 {
    match segment {
        Segment::Arc(arc) => arc.length_px(),
        segment => at(segment, 0.0).distance(at(segment, 1.0)),
    }
}

fn segment_bounds(segment: &Segment) -> Bounds {
    match segment {
        Segment::Arc(arc) => {
            let circle = Bounds { least: arc.centre, most: arc.centre };
            circle.grown(arc.radius_px)
        }
        segment => Bounds::of([at(segment, 0.0), at(segment, 1.0)]),
    }
    .grown(1e-6)
}

pub(super) fn bounds_of(stroke: &Curve) -> Bounds {
    let vertices = Bounds::of(stroke.vertices.iter().copied());
    if stroke.bulges.is_empty() {
        return vertices;
    }
    stroke.course().segments().fold(vertices, |bounds, segment| bounds.with(segment_bounds(&segment)))
}

/// Goes on with a part of a segment.
fn add(part: &mut Curve, segment: &Segment, start: f64, end: f64) {
    if part.vertices.is_empty() {
        part.vertices.push(at(segment, start));
    }
    if let Segment::Arc(arc) = segment {
        part.bulges.resize(part.vertices.len() - 1, 0.0);
        part.bulges.push(libm::tan(0.25 * arc.sweep_rad * (end - start)));
    }
    part.vertices.push(at(segment, end));
}

fn taken(part: &mut Curve) -> Option<Curve> {
    (part.vertices.len() > 1).then(|| core::mem::take(part))
}
