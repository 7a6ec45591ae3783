//! [`PlotOps`]: the entities of a drawing on the sheet, as plot operations.

use super::entity::{Block, Colour, Entity, Insert, LineKind, Shape, Vertex, of_index};
use super::frame::{Frame, Vec3};
use super::path::{Bow, draw, of_bulge};
use super::{Drawing, Error, Pens, Problem, ReadOptions};
use crate::drawing::{Affine, PathSegment, Stroke};
use crate::{PlotOp, Point};
use alloc::collections::{BTreeMap, VecDeque};
use alloc::vec::Vec;

/// Deepest that blocks may lie in each other.
const MOST_DEPTH: usize = 32;
/// Most entities of blocks that are drawn, each time that they are: more than drawings have, so that blocks
/// that hold each other many times end some time.
const MOST_ENTITIES: u32 = 1 << 22;

/// The plot operations of a [`Drawing`], as they are asked for; made by [`Drawing::plot_ops`].
#[derive(Clone, Debug)]
pub struct PlotOps<'d> {
    drawing: &'d Drawing,
    options: ReadOptions,
    unit_mm: f64,
    /// What is drawn now: entities of the drawing, and of blocks within them.
    levels: Vec<Level<'d>>,
    ready: VecDeque<PlotOp>,
    said: VecDeque<Error>,
    /// Layers, or colours, by the pens that they have.
    pens: BTreeMap<PenKey, u8>,
    colours: BTreeMap<u8, [u8; 3]>,
    pen: Option<u8>,
    layer: usize,
    entities: u32,
    hidden: BTreeMap<usize, (u32, u32)>,
    missing: BTreeMap<char, (u32, u32)>,
    otherwise: BTreeMap<&'static str, (u32, u32)>,
    no_blocks: BTreeMap<&'d str, ()>,
    has_ended: bool,
    is_paper_drawn: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum PenKey {
    Layer(usize),
    Colour([u8; 3]),
}

/// Entities that are being drawn, and how they lie on the sheet.
#[derive(Clone, Debug)]
struct Level<'d> {
    entities: &'d [Entity],
    next: usize,
    /// From the units of these entities to mm.
    frame: Frame,
    /// What a block gives to its entities: the layer of those on layer 0, colour, line type.
    given: Option<Given>,
    /// The rows and columns that are left of a block.
    rest: Option<Rest<'d>>,
}

#[derive(Clone, Copy, Debug)]
struct Given {
    layer: usize,
    colour: [u8; 3],
    pattern: Option<usize>,
}

#[derive(Clone, Debug)]
struct Rest<'d> {
    insert: &'d Insert,
    block: &'d Block,
    /// The frame of the first one.
    frame: Frame,
    number: u32,
}

impl<'d> PlotOps<'d> {
    pub(super) fn new(drawing: &'d Drawing, options: ReadOptions) -> Self {
        let mut said: VecDeque<Error> = drawing.said.iter().cloned().collect();
        let unit_mm = options.unit_mm.or(drawing.unit_mm()).unwrap_or_else(|| {
            said.push_front(Error { line: 0, problem: Problem::NoUnit });
            1.0
        });
        let scale = Vec3::new(unit_mm, unit_mm, unit_mm);
        let origin = Vec3::new(options.moved_mm.x, options.moved_mm.y, 0.0);
        let frame = Frame { origin, ..Frame::WORLD.scaled(scale) };
        let level = Level { entities: &drawing.entities, next: 0, frame, given: None, rest: None };
        // What a person draws is in the model space; a file that has nothing there is a sheet.
        let is_paper_drawn = drawing.entities.iter().all(|entity| entity.is_on_paper);
        Self {
            drawing,
            options,
            unit_mm,
            levels: alloc::vec![level],
            ready: VecDeque::new(),
            said,
            pens: BTreeMap::new(),
            colours: BTreeMap::new(),
            pen: None,
            layer: 0,
            entities: 0,
            hidden: BTreeMap::new(),
            missing: BTreeMap::new(),
            otherwise: BTreeMap::new(),
            no_blocks: BTreeMap::new(),
            has_ended: false,
            is_paper_drawn,
        }
    }

    /// The pens that have drawn so far, with their colours: red, green, blue.
    pub fn pens(&self) -> impl Iterator<Item = (u8, [u8; 3])> + '_ {
        self.colours.iter().map(|(pen, colour)| (*pen, *colour))
    }

    /// Number of the layer on which the operation given last lies, from 1: that of [`Drawing::layers`].
    #[must_use]
    pub fn layer(&self) -> u32 {
        u32::try_from(self.layer + 1).unwrap_or(u32::MAX)
    }

    /// Draws the next entity, if there is one.
    fn advance(&mut self) -> bool {
        let Some(level) = self.levels.last_mut() else { return false };
        let Some(entity) = level.entities.get(level.next) else {
            let Some(level) = self.levels.pop() else { return false };
            if let Some(rest) = level.rest {
                self.enter(rest, level.given);
            }
            return true;
        };
        level.next += 1;
        let (frame, given) = (level.frame, level.given);
        self.entities = self.entities.saturating_add(u32::from(given.is_some()));
        if self.entities > MOST_ENTITIES {
            self.said.push_back(Error { line: entity.line, problem: Problem::Many });
            self.levels.clear();
            return true;
        }
        if entity.is_on_paper && given.is_none() && !self.is_paper_drawn {
            self.count_otherwise(
                entity.line,
                "what lies on sheets of the paper space is left out: the model is drawn; save the sheet by itself (EXPORTLAYOUT)",
            );
            return true;
        }
        // What lies on layer 0 of a block lies on the block's layer.
        let layer_place = match given {
            Some(given) if entity.layer == 0 => given.layer,
            _ => entity.layer,
        };
        let Some(layer) = self.drawing.layers.get(layer_place) else { return true };
        let is_insert = matches!(entity.shape, Shape::Insert(_));
        if layer.is_frozen || layer.is_off && !is_insert {
            let (_, count) = self.hidden.entry(layer_place).or_insert((entity.line, 0));
            *count = count.saturating_add(1);
            return true;
        }
        let index = |index| if index == 7 || index == 0 { [0; 3] } else { of_index(index) };
        let of_layer = match layer.colour {
            Colour::Rgb(rgb) => rgb,
            Colour::Index(number) => index(number),
            Colour::OfLayer | Colour::OfBlock => [0; 3],
        };
        let colour = match entity.colour {
            Colour::OfLayer => of_layer,
            Colour::OfBlock => given.map_or([0; 3], |given| given.colour),
            Colour::Index(number) => index(number),
            Colour::Rgb(rgb) => rgb,
        };
        let pattern = match (entity.line_kind, layer.line_kind) {
            (LineKind::Named(kind), _) | (LineKind::OfLayer, LineKind::Named(kind)) => Some(kind),
            (LineKind::OfBlock, _) => given.and_then(|given| given.pattern),
            (LineKind::OfLayer, _) => None,
        };
        let given = Given { layer: layer_place, colour, pattern };
        if let Shape::Insert(insert) = &entity.shape {
            self.insert(entity, insert, &frame, given);
            return true;
        }
        let mut strokes = VecDeque::new();
        self.draw(entity, &frame, pattern, &mut strokes);
        let drawn = |op: &PlotOp| op.target().is_none_or(|to| to.is_finite());
        if !strokes.iter().all(drawn) {
            self.count_otherwise(
                entity.line,
                "an entity that lies beyond all measure is left out: check the scale of its block",
            );
        } else if !strokes.is_empty() {
            self.select(given, entity.line);
            self.ready.append(&mut strokes);
        }
        true
    }

    /// Takes the pen of an entity.
    fn select(&mut self, given: Given, line: u32) {
        self.layer = given.layer;
        let name = self.drawing.layers.get(given.layer).map_or("", |layer| layer.name.as_str());
        let key = match self.options.pens {
            Pens::ByColour => PenKey::Colour(given.colour),
            Pens::ByLayer | Pens::ByLayerNumber => PenKey::Layer(given.layer),
        };
        let numbers_pens = self.options.pens != Pens::ByLayerNumber;
        if numbers_pens && self.pens.len() >= usize::from(u8::MAX) && !self.pens.contains_key(&key) {
            self.count_otherwise(
                line,
                "a layer or a colour beyond the 255th has no pen of its own: pen 255 draws it; put several in one layer",
            );
        }
        let next = u8::try_from(self.pens.len() + 1).unwrap_or(u8::MAX);
        let pen = *self.pens.entry(key).or_insert_with(|| match self.options.pens {
            Pens::ByLayerNumber => number_of(name).unwrap_or(1),
            Pens::ByLayer | Pens::ByColour => next,
        });
        self.colours.entry(pen).or_insert(given.colour);
        if self.pen != Some(pen) {
            self.pen = Some(pen);
            self.ready.push_back(PlotOp::SelectPen { pen });
        }
    }

    fn insert(&mut self, entity: &'d Entity, insert: &'d Insert, frame: &Frame, given: Given) {
        let Some(block) = self.drawing.blocks.get(&insert.block) else {
            if self.no_blocks.insert(&insert.block, ()).is_none() {
                let name = insert.block.clone();
                self.said.push_back(Error { line: entity.line, problem: Problem::NoBlock { name } });
            }
            return;
        };
        if self.levels.len() > MOST_DEPTH {
            if self.no_blocks.insert(&insert.block, ()).is_none() {
                let name = insert.block.clone();
                self.said.push_back(Error { line: entity.line, problem: Problem::Depth { name } });
            }
            return;
        }
        let frame = frame.holding(&Frame::across(entity.normal)).moved(insert.at).turned(insert.turned_rad);
        self.enter(Rest { insert, block, frame, number: 0 }, Some(given));
    }

    /// Begins the next of the rows and columns of a block.
    fn enter(&mut self, rest: Rest<'d>, given: Option<Given>) {
        let Rest { insert, block, frame, number } = rest;
        if number >= insert.columns.saturating_mul(insert.rows) {
            return;
        }
        // An empty block in a million rows is looked at once.
        if block.entities.is_empty() {
            return;
        }
        let (row, column) = (f64::from(number / insert.columns), f64::from(number % insert.columns));
        let by = Vec3::new(column * insert.column_distance, row * insert.row_distance, 0.0);
        let placed = frame.moved(by).scaled(insert.scale).moved(Vec3::ZERO - block.base);
        let rest = Some(Rest { number: number + 1, ..rest });
        self.levels.push(Level { entities: &block.entities, next: 0, frame: placed, given, rest });
    }

    fn draw(
        &mut self,
        entity: &Entity,
        frame: &Frame,
        pattern: Option<usize>,
        strokes: &mut VecDeque<PlotOp>,
    ) {
        let tolerance_mm = self.options.tolerance_mm;
        let scale = self.unit_mm * self.drawing.line_scale * entity.line_scale;
        let pattern: Vec<f64> = pattern
            .and_then(|kind| self.drawing.line_types.get(kind))
            .map(|kind| kind.pattern.iter().map(|part| part * scale).collect())
            .unwrap_or_default();
        let world = frame.seen_place();
        // The plane of the entity at a height of its own.
        let plane = |height: f64| {
            frame.holding(&Frame::across(entity.normal)).moved(Vec3::new(0.0, 0.0, height)).seen()
        };
        let lines = |places: Vec<Point>, pattern: &[f64], strokes: &mut VecDeque<PlotOp>| {
            if let Some(stroke) = Stroke::through(places) {
                draw(stroke, pattern, tolerance_mm, strokes);
            }
        };
        match &entity.shape {
            Shape::Point { at } => lines(alloc::vec![world(*at)], &[], strokes),
            Shape::Lines(all) => {
                for ends in all {
                    lines(ends.map(&world).to_vec(), &pattern, strokes);
                }
            }
            Shape::Polyline { vertices, is_closed } => {
                let height = vertices.first().map_or(0.0, |vertex| vertex.at.z);
                let is_level = vertices.iter().all(|vertex| vertex.at.z == height);
                if is_level {
                    let stroke = polyline(vertices, *is_closed, &plane(height));
                    stroke.into_iter().for_each(|stroke| draw(stroke, &pattern, tolerance_mm, strokes));
                    return;
                }
                // In space, where its corners have heights of their own.
                let place = frame.holding(&Frame::across(entity.normal)).seen_place();
                let first = vertices.first().filter(|_| *is_closed);
                let places = vertices.iter().chain(first).map(|vertex| place(vertex.at)).collect();
                lines(places, &pattern, strokes);
            }
            Shape::Arc { centre, radius, from_rad, sweep_rad } => {
                let bow = Bow::round(centre.flat(), *radius, *from_rad, *sweep_rad);
                draw(bow_alone(bow, &plane(centre.z)), &pattern, tolerance_mm, strokes);
            }
            Shape::Ellipse { centre, major, ratio, from_rad, sweep_rad } => {
                let minor = entity.normal.normalized().unwrap_or(Vec3::UP).cross(*major) * *ratio;
                let seen = Frame { x: *major, y: minor, z: entity.normal, origin: *centre };
                let bow = Bow::round(Point::ORIGIN, 1.0, *from_rad, *sweep_rad);
                draw(bow_alone(bow, &frame.holding(&seen).seen()), &pattern, tolerance_mm, strokes);
            }
            Shape::Spline(spline) => {
                let longest = [frame.x, frame.y, frame.z].map(Vec3::length).into_iter().fold(0.0, libm::fmax);
                let places = spline.places(tolerance_mm / libm::fmax(longest, f64::MIN_POSITIVE));
                lines(places.into_iter().map(world).collect(), &pattern, strokes);
            }
            Shape::Text(text) => {
                let line = entity.line;
                let missing = &mut self.missing;
                let plane = plane(text.at.z);
                let letters = text.strokes(&mut |letter| {
                    let (_, count) = missing.entry(letter).or_insert((line, 0));
                    *count = count.saturating_add(1);
                });
                for stroke in letters {
                    lines(stroke.into_iter().map(|at| plane.apply(at)).collect(), &[], strokes);
                }
            }
            Shape::Hatch(hatch, height) => {
                let plane = plane(*height);
                let otherwise = if hatch.is_solid || hatch.families.is_empty() {
                    "a filled area (HATCH) is drawn as its outline: choose a pattern of lines to fill it"
                } else if let Ok(all) = hatch.lines(&plane, tolerance_mm) {
                    for (from, to) in all {
                        lines(alloc::vec![from, to], &[], strokes);
                    }
                    return;
                } else {
                    "an area (HATCH) with too many lines is drawn as its outline: choose a greater scale of the pattern"
                };
                for outline in hatch.outlines(&plane, tolerance_mm) {
                    draw(outline, &[], tolerance_mm, strokes);
                }
                self.count_otherwise(entity.line, otherwise);
            }
            Shape::Insert(_) => {}
        }
    }

    fn count_otherwise(&mut self, line: u32, what: &'static str) {
        let (_, count) = self.otherwise.entry(what).or_insert((line, 0));
        *count = count.saturating_add(1);
    }

    /// What is told once, when all has been drawn.
    fn end(&mut self) {
        for (layer, (line, count)) in core::mem::take(&mut self.hidden) {
            let layer = self.drawing.layers.get(layer).map(|layer| layer.name.clone()).unwrap_or_default();
            self.said.push_back(Error { line, problem: Problem::Hidden { layer, count } });
        }
        for (letter, (line, count)) in core::mem::take(&mut self.missing) {
            self.said.push_back(Error { line, problem: Problem::NoLetter { letter, count } });
        }
        for (what, (line, count)) in core::mem::take(&mut self.otherwise) {
            self.said.push_back(Error { line, problem: Problem::Otherwise { what, count } });
        }
    }
}

impl Iterator for PlotOps<'_> {
    type Item = Result<PlotOp, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(error) = self.said.pop_front() {
                return Some(Err(error));
            }
            if let Some(op) = self.ready.pop_front() {
                return Some(Ok(op));
            }
            if !self.advance() {
                if core::mem::replace(&mut self.has_ended, true) {
                    return None;
                }
                self.end();
            }
        }
    }
}

/// An arc that is a stroke of its own; a whole turn ends exactly where it begins.
fn bow_alone(bow: Bow, plane: &Affine) -> Stroke {
    let from = bow.from(plane);
    let mut stroke = Stroke { from, ..Stroke::default() };
    let is_whole = libm::fabs(bow.sweep_rad) >= core::f64::consts::TAU;
    bow.draw(plane, is_whole.then_some(from), &mut stroke);
    stroke
}

/// A polyline in its plane.
fn polyline(vertices: &[Vertex], is_closed: bool, plane: &Affine) -> Option<Stroke> {
    let first = vertices.first()?;
    let mut stroke = Stroke { from: plane.apply(first.at.flat()), ..Stroke::default() };
    let ends = vertices.iter().skip(1).chain(if is_closed { Some(first) } else { None });
    for (vertex, next) in vertices.iter().zip(ends) {
        let (from, to) = (vertex.at.flat(), next.at.flat());
        let end = plane.apply(to);
        match of_bulge(from, to, vertex.bulge) {
            Some(bow) => bow.draw(plane, Some(end), &mut stroke),
            None => stroke.segments.push(PathSegment::line(end)),
        }
    }
    Some(stroke)
}

/// The number that a layer's name begins with, 1 to 255.
fn number_of(name: &str) -> Option<u8> {
    let end = name.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(name.len());
    name.get(..end)?.parse().ok().filter(|number| *number > 0)
}
