//! Clip paths and masks of the parser's tree as [`Region`]s, and fills as what hides the lines below.

use super::SvgError;
use super::box_tree::Steps;
use super::mask::{Colour, Item, Painted};
use super::region::{Region, Shape};
use usvg::tiny_skia_path::{Path, PathBuilder, PathStroker, Transform};

/// Steps for each edge of a region: to sort it in.
const STEPS_PER_EDGE: usize = 32;

/// Makes regions, within bounds.
#[derive(Debug)]
pub(super) struct Regions {
    pub(super) tolerance_px: f64,
    /// Most edges of all regions together.
    pub(super) max_edges: usize,
    /// How many they have.
    edges: usize,
    pub(super) steps: Steps,
}

impl Regions {
    pub(super) fn new(tolerance_px: f64, max_edges: usize) -> Self {
        Self { tolerance_px, max_edges, edges: 0, steps: Steps::default() }
    }

    /// A filled outline.
    pub(super) fn shape(
        &mut self,
        path: &Path,
        matrix: Transform,
        is_even_odd: bool,
    ) -> Result<Shape, SvgError> {
        let shape = Shape::new(path, matrix, is_even_odd, self.tolerance_px, self.max_edges)?;
        self.count(shape.edge_count())?;
        Ok(shape)
    }

    /// Whether so many edges more are still within the limits.
    pub(super) fn count(&mut self, edges: usize) -> Result<(), SvgError> {
        self.edges = self.edges.saturating_add(edges);
        self.steps.add(edges.saturating_mul(STEPS_PER_EDGE));
        if self.edges > self.max_edges { Err(SvgError::TooMuchClipping) } else { self.steps.check() }
    }

    /// What a clip path leaves of what is drawn by this matrix. As deep as the file is nested.
    pub(super) fn clip(&mut self, clip: &usvg::ClipPath, matrix: Transform) -> Result<Region, SvgError> {
        let shown = self.filled(clip.root(), matrix.pre_concat(clip.transform()))?;
        match clip.clip_path() {
            Some(other) => Ok(Region::All(vec![shown, self.clip(other, matrix)?])),
            None => Ok(shown),
        }
    }

    /// All that is filled in a group, whatever the paint.
    fn filled(&mut self, group: &usvg::Group, matrix: Transform) -> Result<Region, SvgError> {
        let mut parts = Vec::new();
        for child in group.children() {
            match child {
                usvg::Node::Group(inner) => {
                    let shown = self.filled(inner, matrix)?;
                    parts.push(match inner.clip_path() {
                        Some(clip) => {
                            let clip = self.clip(clip, matrix.pre_concat(inner.abs_transform()))?;
                            Region::All(vec![shown, clip])
                        }
                        None => shown,
                    });
                }
                usvg::Node::Path(path) => {
                    if let Some(fill) = path.fill().filter(|_| path.is_visible()) {
                        let matrix = matrix.pre_concat(path.abs_transform());
                        parts.push(Region::Shape(self.shape(path.data(), matrix, is_even_odd(fill))?));
                    }
                }
                // Letters are known where their fonts are.
                usvg::Node::Text(text) => {
                    let text_matrix = matrix.pre_concat(text.abs_transform());
                    for part in text.flattened().children() {
                        if let usvg::Node::Path(path) = part
                            && let Some(fill) = path.fill()
                        {
                            parts.push(Region::Shape(self.shape(
                                path.data(),
                                text_matrix,
                                is_even_odd(fill),
                            )?));
                        }
                    }
                }
                usvg::Node::Image(_) => {}
            }
        }
        Ok(Region::Any(parts))
    }

    /// What a mask leaves of what is drawn by this matrix.
    pub(super) fn mask(&mut self, mask: &usvg::Mask, matrix: Transform) -> Result<Region, SvgError> {
        let within = PathBuilder::from_rect(mask.rect().to_rect());
        let within = Region::Shape(self.shape(&within, matrix, false)?);
        let items = self.painted(mask.root(), matrix)?;
        let by_alpha = mask.kind() == usvg::MaskType::Alpha;
        let mut parts = vec![within, Region::Painted(Box::new(Painted { items, by_alpha }))];
        if let Some(other) = mask.mask() {
            parts.push(self.mask(other, matrix)?);
        }
        Ok(Region::All(parts))
    }

    fn painted(&mut self, group: &usvg::Group, matrix: Transform) -> Result<Vec<Item>, SvgError> {
        let mut items = Vec::new();
        for child in group.children() {
            match child {
                usvg::Node::Group(inner) => {
                    let own = matrix.pre_concat(inner.abs_transform());
                    let mut within = Vec::new();
                    if let Some(clip) = inner.clip_path() {
                        within.push(self.clip(clip, own)?);
                    }
                    if let Some(mask) = inner.mask() {
                        within.push(self.mask(mask, own)?);
                    }
                    let opacity = f64::from(inner.opacity().get());
                    items.push(Item::Group { items: self.painted(inner, matrix)?, opacity, within });
                }
                usvg::Node::Path(path) if path.is_visible() => {
                    self.paint(path, matrix.pre_concat(path.abs_transform()), &mut items)?;
                }
                usvg::Node::Text(text) => {
                    let matrix = matrix.pre_concat(text.abs_transform());
                    for part in text.flattened().children() {
                        if let usvg::Node::Path(path) = part {
                            self.paint(path, matrix, &mut items)?;
                        }
                    }
                }
                _ => {}
            }
        }
        Ok(items)
    }

    /// Fill and stroke of a path, in their order.
    fn paint(&mut self, path: &usvg::Path, matrix: Transform, items: &mut Vec<Item>) -> Result<(), SvgError> {
        let start = items.len();
        if let Some(fill) = path.fill() {
            let colour = Colour::new(fill.paint(), f64::from(fill.opacity().get()), matrix);
            items.push(Item::Fill(self.shape(path.data(), matrix, is_even_odd(fill))?, colour));
        }
        if let Some(stroke) = path.stroke() {
            let scale = PathStroker::compute_resolution_scale(&matrix);
            let how = stroke.to_tiny_skia();
            let dashed = how.dash.as_ref().and_then(|dash| path.data().dash(dash, scale));
            if let Some(outline) = dashed.as_ref().unwrap_or(path.data()).stroke(&how, scale) {
                let colour = Colour::new(stroke.paint(), f64::from(stroke.opacity().get()), matrix);
                items.push(Item::Fill(self.shape(&outline, matrix, false)?, colour));
                if path.paint_order() == usvg::PaintOrder::StrokeAndFill && items.len() > start + 1 {
                    items.swap(start, start + 1);
                }
            }
        }
        Ok(())
    }
}

pub(super) fn is_even_odd(fill: &usvg::Fill) -> bool {
    fill.rule() == usvg::FillRule::EvenOdd
}
