//! [`Ink`]: the parser's tree as strokes, each with its pen.

use super::arc::bulge;
use super::box_tree::BoxTree;
use super::clip::{Regions, is_even_odd};
use super::curve::Cubic;
use super::cut_far;
use super::dash::Dashes;
use super::one_line;
use super::pens::Pens;
use super::region::{Keep, Region, bounds_of};
use super::survey::without_spaces;
use super::{DrawWhole, SvgError, SvgLayer, SvgLeftOut, SvgOptions};
use crate::{
    picture::Rgb,
    stroke::{Curve, Drawing, PxPoint},
};
use plotter_motion::drawing::Stroke;
use std::collections::BTreeMap;
use usvg::tiny_skia_path::{Path, PathSegment, Point, Transform};

/// Least opacity with which a fill hides what lies below it.
const HIDES: f32 = 0.5;

/// A drawing in the making.
pub(super) struct Ink<'a> {
    pub(super) drawing: Drawing,
    pub(super) pens: Pens,
    pub(super) left_out: SvgLeftOut,
    /// The letters of the first text that is left out, without spaces.
    pub(super) text: Option<String>,
    pub(super) layers: Vec<SvgLayer>,
    options: SvgOptions,
    /// The layer of each group that is one, by its id.
    layer_of: BTreeMap<String, usize>,
    /// Tells the texts of which all outlines are there.
    draw_whole: Option<&'a DrawWhole<'a>>,
    regions: Regions,
    /// What the clip paths and masks of the groups around leave, and whether it has cut anything.
    cuts: Vec<(Region, bool)>,
    /// Opacity of the groups around.
    opacity: f32,
    /// Fills that hide what lies below, each with the number of strokes below it.
    covers: Vec<(Region, usize)>,
    /// Closed shapes that have been filled with lines.
    pub(super) hatched: usize,
}

/// What the pen follows on a shape.
#[derive(Clone, Copy)]
enum PenPath<'a> {
    /// Its stroke.
    Line(&'a usvg::Stroke),
    /// The border of its fill.
    Border,
    /// The lines of letters, in dashes where their stroke is.
    Letters(Option<&'a usvg::Stroke>),
}

impl<'a> Ink<'a> {
    pub(super) fn new(
        drawing: Drawing,
        options: SvgOptions,
        layers: Vec<(String, SvgLayer)>,
        draw_whole: Option<&'a DrawWhole<'a>>,
    ) -> Self {
        let (ids, layers): (Vec<String>, Vec<SvgLayer>) = layers.into_iter().unzip();
        Self {
            drawing,
            pens: Pens::new(options.pens, &layers),
            left_out: SvgLeftOut::default(),
            text: None,
            options,
            layer_of: ids.into_iter().zip(0..).collect(),
            layers,
            draw_whole,
            regions: Regions::new(options.tolerance_mm / options.mm_per_px(), options.max_vertices),
            cuts: Vec::new(),
            opacity: 1.0,
            covers: Vec::new(),
            hatched: 0,
        }
    }

    /// Draws a group and all that is in it, which is of this layer. As deep as the file is nested, which has
    /// been checked.
    pub(super) fn group(&mut self, group: &usvg::Group, layer: Option<usize>) -> Result<(), SvgError> {
        if group.opacity().get() <= 0.0 {
            return Ok(());
        }
        let layer = layer.or_else(|| self.layer_of.get(group.id()).copied());
        if layer.and_then(|layer| self.layers.get(layer)).is_some_and(|layer| layer.is_left_out) {
            return Ok(());
        }
        let (around, opacity) = (self.cuts.len(), self.opacity);
        self.opacity *= group.opacity().get();
        if !self.options.keeps_clipped {
            if let Some(clip) = group.clip_path() {
                let region = self.regions.clip(clip, group.abs_transform())?;
                self.cuts.push((region, false));
            }
            if let Some(mask) = group.mask() {
                let region = self.regions.mask(mask, group.abs_transform())?;
                self.cuts.push((region, false));
            }
        }
        for child in group.children() {
            match child {
                usvg::Node::Group(inner) => self.group(inner, layer)?,
                usvg::Node::Path(path) => self.path(path, path.data(), path.abs_transform(), layer)?,
                usvg::Node::Text(text) => self.text(text, layer)?,
                // None is made: `SvgLeftOut` counts them in the file.
                usvg::Node::Image(_) => {}
            }
        }
        self.opacity = opacity;
        let mut has_cut = self.cuts.drain(around..).map(|(_, has_cut)| has_cut);
        if !self.options.keeps_clipped {
            if group.clip_path().is_some() {
                self.left_out.clip_paths += usize::from(has_cut.next() == Some(true));
            }
            self.left_out.masks += usize::from(group.mask().is_some() && has_cut.next() == Some(true));
        }
        Ok(())
    }

    /// Draws the outlines of a text, or counts it.
    fn text(&mut self, text: &usvg::Text, layer: Option<usize>) -> Result<(), SvgError> {
        let Some(draw_whole) = self.draw_whole else { return Ok(()) };
        if let Some(slack) = draw_whole(text) {
            for part in text.flattened().children() {
                if let usvg::Node::Path(path) = part {
                    // That of the text: lines below and through letters have none of their own.
                    self.letters(path, slack, text.abs_transform(), layer)?;
                }
            }
            return Ok(());
        }
        let mut spans = text.chunks().iter().flat_map(usvg::TextChunk::spans);
        let has_ink =
            spans.any(|span| span.is_visible() && (span.fill().is_some() || span.stroke().is_some()));
        let letters = without_spaces(text.chunks().iter().map(usvg::TextChunk::text));
        if has_ink && !letters.is_empty() {
            self.left_out.texts += 1;
            self.text.get_or_insert(letters);
        }
        Ok(())
    }

    /// Draws letters of one look: along their outlines, and once along what is a line.
    fn letters(
        &mut self,
        path: &usvg::Path,
        slack: f32,
        matrix: Transform,
        layer: Option<usize>,
    ) -> Result<(), SvgError> {
        let Some((outlines, lines)) = one_line::parted(path.data(), slack) else {
            return self.path(path, path.data(), matrix, layer);
        };
        if let Some(outlines) = outlines {
            self.path(path, &outlines, matrix, layer)?;
        }
        match self.inked(path) {
            Some((_, colour)) => self.trace(&lines, matrix, PenPath::Letters(path.stroke()), colour, layer),
            None => Ok(()),
        }
    }

    /// Draws an outline as it is looked at.
    fn path(
        &mut self,
        looks: &usvg::Path,
        outline: &Path,
        matrix: Transform,
        layer: Option<usize>,
    ) -> Result<(), SvgError> {
        if let Some(fill) = looks.fill().filter(|_| self.options.occludes && looks.is_visible()) {
            self.cover(outline, matrix, fill)?;
        }
        match self.inked(looks) {
            Some((pen_path, colour)) => self.trace(outline, matrix, pen_path, colour, layer),
            None => Ok(()),
        }
    }

    /// What leaves ink of a shape, its stroke or else its fill, and in which colour; what is in that of the
    /// paper is counted.
    fn inked<'p>(&mut self, path: &'p usvg::Path) -> Option<(PenPath<'p>, Rgb)> {
        if !path.is_visible() {
            return None;
        }
        let line = path.stroke().and_then(|stroke| {
            Some((PenPath::Line(stroke), colour_of(stroke.paint(), stroke.opacity().get())?))
        });
        let border = path
            .fill()
            .and_then(|fill| Some((PenPath::Border, colour_of(fill.paint(), fill.opacity().get())?)));
        let seen = |(_, colour): &(PenPath<'_>, Rgb)| Some(*colour) != self.options.paper;
        let inked = line.filter(seen).or_else(|| border.filter(seen));
        self.left_out.paper += usize::from(inked.is_none() && (line.is_some() || border.is_some()));
        inked
    }

    /// Notes a fill that hides what has been drawn before. What lies in none of the clip paths around is not
    /// filled.
    fn cover(&mut self, outline: &Path, matrix: Transform, fill: &usvg::Fill) -> Result<(), SvgError> {
        let below = self.drawing.strokes().len();
        if fill.opacity().get() * self.opacity < HIDES || below == 0 {
            return Ok(());
        }
        let shape = Region::Shape(self.regions.shape(outline, matrix, is_even_odd(fill))?);
        let region = if self.cuts.is_empty() {
            shape
        } else {
            let around = self.cuts.iter().map(|(region, _)| region.clone());
            let edges = self.cuts.iter().map(|(region, _)| region.edge_count()).sum();
            self.regions.count(edges)?;
            Region::All(core::iter::once(shape).chain(around).collect())
        };
        self.covers.push((region, below));
        Ok(())
    }

    /// Cuts out of the strokes what the fills that were drawn later hide.
    pub(super) fn hide(&mut self) -> Result<(), SvgError> {
        if self.covers.is_empty() {
            return Ok(());
        }
        let covers = core::mem::take(&mut self.covers);
        let index = BoxTree::new(covers.iter().map(|(region, _)| region.bounds()).collect());
        let edge_px = self.edge_px();
        let mut seen = Drawing::new(self.drawing.width_px(), self.drawing.height_px());
        let mut first_strokes: Vec<usize> = Vec::new();
        for number in 0..self.drawing.strokes().len() {
            first_strokes.push(seen.strokes().len());
            let (pen, stroke) = (self.drawing.pen(number), self.drawing.curve(number));
            let mut over = Vec::new();
            let steps = &mut self.regions.steps;
            index.find(&bounds_of(&stroke).grown(edge_px), steps, |cover| {
                if covers.get(cover).is_some_and(|(_, below)| *below > number) {
                    over.push(cover);
                }
                true
            });
            over.sort_unstable();
            let (mut parts, mut is_cut) = (vec![stroke], false);
            for (region, _) in over.into_iter().filter_map(|cover| covers.get(cover)) {
                let mut left = Vec::new();
                for part in parts {
                    match region.cut(&part, Keep::Outside, edge_px, steps)? {
                        Some(cut) => {
                            is_cut = true;
                            left.extend(cut);
                        }
                        None => left.push(part),
                    }
                }
                parts = left;
            }
            self.left_out.occluded += usize::from(is_cut);
            for part in parts {
                if seen.vertices().saturating_add(part.vertices.len()) > self.options.max_vertices {
                    return Err(SvgError::TooManyVertices { limit: self.options.max_vertices });
                }
                seen.push_curve(pen, part);
            }
        }
        let count = seen.strokes().len();
        let mut starts: Vec<usize> = self.layers.iter().filter_map(|layer| layer.first_stroke).collect();
        starts.sort_unstable();
        for layer in &mut self.layers {
            let Some(start) = layer.first_stroke else { continue };
            let end = starts.get(starts.partition_point(|other| *other <= start)).copied();
            let place = |start: usize| first_strokes.get(start).copied().unwrap_or(count);
            let end = end.map_or(count, place);
            layer.first_stroke = Some(place(start)).filter(|start| *start < end);
        }
        self.drawing = seen;
        Ok(())
    }

    /// How far from an edge a stroke may lie that is on it: both are chords within the tolerance, px.
    fn edge_px(&self) -> f64 {
        2.0 * self.regions.tolerance_px + 1e-3
    }

    /// Draws the stroke of a shape, or the border of its fill.
    fn trace(
        &mut self,
        path: &Path,
        matrix: Transform,
        pen_path: PenPath<'_>,
        colour: Rgb,
        layer: Option<usize>,
    ) -> Result<(), SvgError> {
        let [a, b, c, d] = [matrix.sx, matrix.ky, matrix.kx, matrix.sy].map(f64::from);
        let [e, f] = [matrix.tx, matrix.ty].map(f64::from);
        let mm_per_px = self.options.mm_per_px();
        let place = |at: Point| {
            let (x, y) = (f64::from(at.x), f64::from(at.y));
            cut_far::held(PxPoint::new(a * x + c * y + e, b * x + d * y + f))
        };
        let determinant = a * d - b * c;
        let own_length =
            |dx: f64, dy: f64| libm::hypot((d * dx - c * dy) / determinant, (a * dy - b * dx) / determinant);
        let dashes = match pen_path {
            PenPath::Line(line) | PenPath::Letters(Some(line)) if determinant != 0.0 => {
                line.dasharray().and_then(|lengths| Dashes::new(lengths, line.dashoffset()))
            }
            _ => None,
        };
        let tolerance_px = self.options.tolerance_mm / mm_per_px;
        // Dashes are cut out of chords.
        let arcs = self.options.arcs && dashes.is_none();
        let hatches = self.options.hatch.is_some() && dashes.is_none();
        let mut outlines = Vec::new();
        let mut stroke = Curve::default();
        let (mut pen, mut goes_far) = (None, false);
        let mut draw = |ink: &mut Self, stroke: &mut Curve, closed: bool| -> Result<(), SvgError> {
            let mut stroke = core::mem::take(stroke);
            ready(&mut stroke, pen_path, closed);
            let parts = cut_far::near_parts(&stroke);
            goes_far |= parts.is_some();
            if hatches
                && parts.is_none()
                && stroke.vertices.len() > 2
                && stroke.vertices.first() == stroke.vertices.last()
            {
                outlines.push(stroke.chords(tolerance_px));
            }
            if !stroke.vertices.is_empty() {
                let mut push = |stroke: Curve| -> Result<(), SvgError> {
                    for part in ink.left(stroke)? {
                        // Only what is drawn takes a pen.
                        let pen = *pen.get_or_insert_with(|| ink.pen(colour, layer));
                        ink.push(pen, part, layer)?;
                    }
                    Ok(())
                };
                for part in parts.unwrap_or_else(|| vec![stroke]) {
                    match &dashes {
                        Some(dashes) => {
                            dashes.draw(&part.vertices, own_length, |dash| push(dash.to_vec().into()))?;
                        }
                        None => push(part)?,
                    }
                }
            }
            Ok(())
        };
        for segment in path.segments() {
            let last = stroke.vertices.last().copied();
            match (segment, last) {
                (PathSegment::MoveTo(to), _) => {
                    draw(self, &mut stroke, false)?;
                    stroke.vertices.push(place(to));
                }
                (PathSegment::LineTo(to), _) => stroke.vertices.push(place(to)),
                (PathSegment::QuadTo(handle, to), Some(from)) => {
                    let curve = Cubic::from_quadratic([from, place(handle), place(to)]);
                    self.curve(&mut stroke, curve, tolerance_px, arcs)?;
                }
                (PathSegment::CubicTo(first, second, to), Some(from)) => {
                    let curve = Cubic([from, place(first), place(second), place(to)]);
                    self.curve(&mut stroke, curve, tolerance_px, arcs)?;
                }
                (PathSegment::Close, _) => draw(self, &mut stroke, true)?,
                (PathSegment::QuadTo(_, to) | PathSegment::CubicTo(_, _, to), None) => {
                    stroke.vertices.push(place(to));
                }
            }
            self.check_vertices(stroke.vertices.len())?;
        }
        draw(self, &mut stroke, false)?;
        self.left_out.far += usize::from(goes_far);
        self.hatch(outlines, |ink| pen.unwrap_or_else(|| ink.pen(colour, layer)), layer)
    }

    /// Fills what lies within an odd number of outlines.
    fn hatch(
        &mut self,
        outlines: Vec<Vec<PxPoint>>,
        pen: impl FnOnce(&mut Self) -> u8,
        layer: Option<usize>,
    ) -> Result<(), SvgError> {
        let Some(hatching) = self.options.hatch.filter(|_| !outlines.is_empty()) else { return Ok(()) };
        // The sheet's y is up.
        let mm_per_px = self.options.mm_per_px();
        let sheet = |at: PxPoint| plotter_motion::Point::new(at.x * mm_per_px, -at.y * mm_per_px);
        let px = |at: plotter_motion::Point| PxPoint::new(at.x / mm_per_px, -at.y / mm_per_px);
        let strokes =
            outlines.into_iter().filter_map(|outline| Stroke::through(outline.into_iter().map(sheet)));
        let mut shape = sheet_drawing(strokes.collect());
        let outlines = shape.strokes.len();
        if shape.hatch(&hatching, |_| true).map_err(SvgError::Hatch)? == 0 {
            return Ok(());
        }
        self.hatched += 1;
        let pen = pen(self);
        for line in shape.strokes.into_iter().skip(outlines) {
            for part in self.left(Curve::from(vec![px(line.from), px(line.to())]))? {
                self.push(pen, part, layer)?;
            }
        }
        Ok(())
    }

    fn curve(&self, stroke: &mut Curve, curve: Cubic, tolerance_px: f64, arcs: bool) -> Result<(), SvgError> {
        if curve.0.iter().any(|at| cut_far::is_far(*at)) {
            return cut_far::chords(&curve, tolerance_px, &mut |at| {
                stroke.vertices.push(at);
                self.check_vertices(stroke.vertices.len())
            });
        }
        if let Some(bulge) = arcs.then(|| bulge(curve, tolerance_px)).flatten() {
            // That of the piece which begins at the last vertex.
            stroke.bulges.resize(stroke.vertices.len().saturating_sub(1), 0.0);
            stroke.bulges.push(bulge);
            stroke.vertices.push(curve.0[3]);
            return Ok(());
        }
        for at in curve.chords(tolerance_px) {
            stroke.vertices.push(at);
            self.check_vertices(stroke.vertices.len())?;
        }
        Ok(())
    }

    /// What the clip paths and masks around leave of a stroke.
    fn left(&mut self, stroke: Curve) -> Result<Vec<Curve>, SvgError> {
        let edge_px = self.edge_px();
        let mut parts = vec![stroke];
        for (region, has_cut) in &mut self.cuts {
            let mut left = Vec::new();
            for part in parts {
                match region.cut(&part, Keep::Inside, edge_px, &mut self.regions.steps)? {
                    Some(cut) => {
                        *has_cut = true;
                        left.extend(cut);
                    }
                    None => left.push(part),
                }
            }
            parts = left;
        }
        Ok(parts)
    }

    fn push(&mut self, pen: u8, stroke: Curve, layer: Option<usize>) -> Result<(), SvgError> {
        self.check_vertices(stroke.vertices.len())?;
        let next = self.drawing.strokes().len();
        if let Some(layer) = layer.and_then(|layer| self.layers.get_mut(layer)) {
            layer.first_stroke.get_or_insert(next);
        }
        self.drawing.push_curve(pen, stroke);
        Ok(())
    }

    /// Whether so many vertices more are still within the limit.
    fn check_vertices(&self, more: usize) -> Result<(), SvgError> {
        let limit = self.options.max_vertices;
        if self.drawing.vertices().saturating_add(more) > limit {
            return Err(SvgError::TooManyVertices { limit });
        }
        Ok(())
    }

    /// The pen of a colour or a layer.
    fn pen(&mut self, colour: Rgb, layer: Option<usize>) -> u8 {
        self.pens.of(colour, layer.and_then(|index| Some((index, self.layers.get(index)?))))
    }
}

fn sheet_drawing(strokes: Vec<Stroke>) -> plotter_motion::drawing::Drawing {
    plotter_motion::drawing::Drawing { strokes, ..plotter_motion::drawing::Drawing::default() }
}

/// Brings the places of a part of a shape into the form in which they are drawn; none when nothing is.
fn ready(stroke: &mut Curve, pen_path: PenPath<'_>, closed: bool) {
    let is_straight = stroke.bulges.is_empty();
    let stroke = &mut stroke.vertices;
    let Some(first) = stroke.first().copied() else { return };
    let dot = stroke.iter().all(|at| *at == first);
    match pen_path {
        // A line that goes nowhere shows its caps, and flat ones are none.
        PenPath::Line(line) if dot => {
            stroke
                .truncate(usize::from((stroke.len() > 1 || closed) && line.linecap() != usvg::LineCap::Butt));
        }
        PenPath::Letters(_) => stroke.truncate(if dot { 1 } else { stroke.len() }),
        // Fewer than three places have nothing between them.
        PenPath::Border if stroke.len() < 3 && is_straight => stroke.clear(),
        _ if (closed || matches!(pen_path, PenPath::Border)) && stroke.last() != Some(&first) => {
            stroke.push(first)
        }
        _ => {}
    }
}

/// The colour of a paint; that of the first stop that is seen of a gradient, black for a pattern.
fn colour_of(paint: &usvg::Paint, opacity: f32) -> Option<Rgb> {
    let stops =
        |stops: &[usvg::Stop]| stops.iter().find(|stop| stop.opacity().get() > 0.0).map(|stop| stop.color());
    let colour = match paint {
        usvg::Paint::Color(colour) => *colour,
        usvg::Paint::LinearGradient(gradient) => stops(gradient.stops())?,
        usvg::Paint::RadialGradient(gradient) => stops(gradient.stops())?,
        usvg::Paint::Pattern(_) => usvg::Color::black(),
    };
    (opacity > 0.0).then_some(Rgb([colour.red, colour.green, colour.blue]))
}
