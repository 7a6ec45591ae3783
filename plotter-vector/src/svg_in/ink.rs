//! [`Ink`]: the parser's tree as strokes, each with its pen.

use super::arc::bulge;
use super::curve::Cubic;
use super::dash::Dashes;
use super::survey::without_spaces;
use super::{MAX_PX, MM_PER_PX, SvgError, SvgLeftOut, SvgOptions, SvgPens};
use crate::{Curve, Drawing, MAX_PENS, PalettePen, PxPoint, Rgb};
use usvg::tiny_skia_path::{PathSegment, Point, Transform};

/// A drawing in the making.
pub(super) struct Ink<'a> {
    pub(super) drawing: Drawing,
    pub(super) pens: Vec<PalettePen>,
    pub(super) left_out: SvgLeftOut,
    /// The letters of the first text that is left out, without spaces.
    pub(super) text: Option<String>,
    options: SvgOptions,
    /// Id and name of each group at the top of the file.
    layers: &'a [(String, String)],
    /// The layer's id that each pen stands for; beside `pens`.
    pen_layers: Vec<String>,
    /// Tells the texts of which all outlines are there.
    draw_whole: Option<&'a dyn Fn(&usvg::Text) -> bool>,
}

/// What the pen follows on a shape.
#[derive(Clone, Copy)]
enum Way<'a> {
    /// Its stroke.
    Line(&'a usvg::Stroke),
    /// The border of its fill.
    Border,
}

impl<'a> Ink<'a> {
    pub(super) fn new(
        drawing: Drawing,
        options: SvgOptions,
        layers: &'a [(String, String)],
        draw_whole: Option<&'a dyn Fn(&usvg::Text) -> bool>,
    ) -> Self {
        let (pens, pen_layers, left_out) = (Vec::new(), Vec::new(), SvgLeftOut::default());
        Self { drawing, pens, left_out, text: None, options, layers, pen_layers, draw_whole }
    }

    /// Draws a group and all that is in it. As deep as the file is nested, which has been checked.
    pub(super) fn group(&mut self, group: &usvg::Group, layer: &str) -> Result<(), SvgError> {
        if group.opacity().get() <= 0.0 {
            return Ok(());
        }
        let left_out = &mut self.left_out;
        left_out.clip_paths += usize::from(group.clip_path().is_some());
        left_out.masks += usize::from(group.mask().is_some());
        left_out.filters += usize::from(!group.filters().is_empty());
        let top = layer.is_empty() && self.layers.iter().any(|(id, _)| id == group.id());
        let layer = if top { group.id() } else { layer };
        for child in group.children() {
            match child {
                usvg::Node::Group(inner) => self.group(inner, layer)?,
                usvg::Node::Path(path) => self.path(path, path.abs_transform(), layer)?,
                usvg::Node::Text(text) => self.text(text, layer)?,
                // None is made: `SvgLeftOut` counts them in the file.
                usvg::Node::Image(_) => {}
            }
        }
        Ok(())
    }

    /// Draws the outlines of a text, or counts it.
    fn text(&mut self, text: &usvg::Text, layer: &str) -> Result<(), SvgError> {
        let Some(draw_whole) = self.draw_whole else { return Ok(()) };
        if draw_whole(text) {
            for part in text.flattened().children() {
                if let usvg::Node::Path(path) = part {
                    // That of the text: lines below and through letters have none of their own.
                    self.path(path, text.abs_transform(), layer)?;
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

    fn path(&mut self, path: &usvg::Path, matrix: Transform, layer: &str) -> Result<(), SvgError> {
        if !path.is_visible() {
            return Ok(());
        }
        let line = path
            .stroke()
            .and_then(|stroke| Some((Way::Line(stroke), colour_of(stroke.paint(), stroke.opacity().get())?)));
        let border =
            path.fill().and_then(|fill| Some((Way::Border, colour_of(fill.paint(), fill.opacity().get())?)));
        let seen = |(_, colour): &(Way<'_>, Rgb)| Some(*colour) != self.options.paper;
        let inked = line.filter(seen).or_else(|| border.filter(seen));
        match inked {
            Some((way, colour)) => self.trace(path, matrix, way, colour, layer),
            None => {
                self.left_out.paper += usize::from(line.is_some() || border.is_some());
                Ok(())
            }
        }
    }

    /// Draws the stroke of a shape, or the border of its fill.
    fn trace(
        &mut self,
        path: &usvg::Path,
        matrix: Transform,
        way: Way<'_>,
        colour: Rgb,
        layer: &str,
    ) -> Result<(), SvgError> {
        let [a, b, c, d] = [matrix.sx, matrix.ky, matrix.kx, matrix.sy].map(f64::from);
        let [e, f] = [matrix.tx, matrix.ty].map(f64::from);
        let place = |at: Point| -> Result<PxPoint, SvgError> {
            let (x, y) = (f64::from(at.x), f64::from(at.y));
            let at = PxPoint::new(a * x + c * y + e, b * x + d * y + f);
            if at.x.abs() <= MAX_PX && at.y.abs() <= MAX_PX {
                Ok(at)
            } else {
                Err(SvgError::TooFar { x_mm: at.x * MM_PER_PX, y_mm: at.y * MM_PER_PX })
            }
        };
        let determinant = a * d - b * c;
        let own_length =
            |dx: f64, dy: f64| libm::hypot((d * dx - c * dy) / determinant, (a * dy - b * dx) / determinant);
        let dashes = match way {
            Way::Line(line) if determinant != 0.0 => {
                line.dasharray().and_then(|lengths| Dashes::new(lengths, line.dashoffset()))
            }
            _ => None,
        };
        let tolerance_px = self.options.tolerance_mm / MM_PER_PX;
        // Dashes are cut out of chords.
        let arcs = self.options.arcs && dashes.is_none();
        let mut stroke = Curve::default();
        let mut pen = None;
        let mut draw = |ink: &mut Self, stroke: &mut Curve, closed: bool| -> Result<(), SvgError> {
            let mut stroke = core::mem::take(stroke);
            ready(&mut stroke, way, closed);
            if !stroke.vertices.is_empty() {
                // Only what is drawn takes a pen.
                let pen = *pen.get_or_insert_with(|| ink.pen(colour, layer));
                match &dashes {
                    Some(dashes) => dashes
                        .draw(&stroke.vertices, own_length, |dash| ink.push(pen, dash.to_vec().into()))?,
                    None => ink.push(pen, stroke)?,
                }
            }
            Ok(())
        };
        for segment in path.data().segments() {
            let last = stroke.vertices.last().copied();
            match (segment, last) {
                (PathSegment::MoveTo(to), _) => {
                    draw(self, &mut stroke, false)?;
                    stroke.vertices.push(place(to)?);
                }
                (PathSegment::LineTo(to), _) => stroke.vertices.push(place(to)?),
                (PathSegment::QuadTo(handle, to), Some(from)) => {
                    let curve = Cubic::from_quadratic([from, place(handle)?, place(to)?]);
                    self.curve(&mut stroke, curve, tolerance_px, arcs)?;
                }
                (PathSegment::CubicTo(first, second, to), Some(from)) => {
                    let curve = Cubic([from, place(first)?, place(second)?, place(to)?]);
                    self.curve(&mut stroke, curve, tolerance_px, arcs)?;
                }
                (PathSegment::Close, _) => draw(self, &mut stroke, true)?,
                (PathSegment::QuadTo(_, to) | PathSegment::CubicTo(_, _, to), None) => {
                    stroke.vertices.push(place(to)?);
                }
            }
            self.check_vertices(stroke.vertices.len())?;
        }
        draw(self, &mut stroke, false)
    }

    fn curve(&self, stroke: &mut Curve, curve: Cubic, tolerance_px: f64, arcs: bool) -> Result<(), SvgError> {
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

    fn push(&mut self, pen: u8, stroke: Curve) -> Result<(), SvgError> {
        self.check_vertices(stroke.vertices.len())?;
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

    /// The pen of a colour or a layer; the next free one when it has none.
    fn pen(&mut self, colour: Rgb, layer: &str) -> u8 {
        let known = match self.options.pens {
            SvgPens::ByColour => self.pens.iter().find(|pen| pen.colour == colour),
            SvgPens::ByLayer => {
                let found = self.pen_layers.iter().position(|id| id == layer);
                found.and_then(|index| self.pens.get(index))
            }
            SvgPens::One => self.pens.first(),
        };
        if let Some(pen) = known {
            return pen.number;
        }
        if self.pens.len() >= MAX_PENS {
            return self.nearest(colour);
        }
        let name = match self.options.pens {
            SvgPens::ByColour => colour.to_string(),
            SvgPens::ByLayer => {
                let named = self.layers.iter().find(|(id, _)| id == layer);
                named.map_or_else(String::new, |(_, name)| fitting(name))
            }
            SvgPens::One => String::new(),
        };
        let number = self.pens.last().map_or(1, |pen| pen.number.saturating_add(1));
        self.pens.push(PalettePen { number, name, colour, width_mm: None });
        self.pen_layers.push(layer.to_owned());
        number
    }

    /// When no pen is free: that of the nearest colour.
    fn nearest(&self, colour: Rgb) -> u8 {
        let wanted = colour.oklab();
        let distance = |pen: &PalettePen| pen.colour.oklab().distance(wanted);
        let nearest = self.pens.iter().min_by(|one, other| distance(one).total_cmp(&distance(other)));
        nearest.map_or(1, |pen| pen.number)
    }
}

/// Brings the places of a part of a shape into the form in which they are drawn; none when nothing is.
fn ready(stroke: &mut Curve, way: Way<'_>, closed: bool) {
    let is_straight = stroke.bulges.is_empty();
    let stroke = &mut stroke.vertices;
    let Some(first) = stroke.first().copied() else { return };
    let dot = stroke.iter().all(|at| *at == first);
    match way {
        // A line that goes nowhere shows its caps, and flat ones are none.
        Way::Line(line) if dot => {
            stroke
                .truncate(usize::from((stroke.len() > 1 || closed) && line.linecap() != usvg::LineCap::Butt));
        }
        // Fewer than three places have nothing between them.
        Way::Border if stroke.len() < 3 && is_straight => stroke.clear(),
        _ if (closed || matches!(way, Way::Border)) && stroke.last() != Some(&first) => stroke.push(first),
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

/// A name that a pen may have: at most 64 bytes.
fn fitting(name: &str) -> String {
    const MAX_NAME_BYTES: usize = 64;
    let mut fitting = String::new();
    for letter in name.chars().filter(|letter| !letter.is_control()) {
        if fitting.len() + letter.len_utf8() > MAX_NAME_BYTES {
            break;
        }
        fitting.push(letter);
    }
    fitting
}
