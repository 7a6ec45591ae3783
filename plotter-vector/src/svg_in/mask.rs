//! [`Painted`]: what a mask paints, and where it is light.
//!
//! A mask shows where luminance times alpha is at least one half (CSS Masking Level 1, section 6.1,
//! "mask-type"): a pen draws or does not. What is painted is put together place by place, each colour over
//! those before it.

use super::box_tree::Steps;
use super::region::{Region, Shape};
use crate::stroke::{PxPoint, PxVec};
use usvg::tiny_skia_path::Transform;

/// Least luminance times alpha that shows.
const SHOWS: f64 = 0.5;

/// What a mask paints.
#[derive(Clone, Debug)]
pub(super) struct Painted {
    /// From the lowest.
    pub(super) items: Vec<Item>,
    /// Whether only alpha counts.
    pub(super) by_alpha: bool,
}

/// Something that is painted.
#[derive(Clone, Debug)]
pub(super) enum Item {
    /// An outline in a colour.
    Fill(Shape, Colour),
    /// What is within a region, less opaque as a whole.
    Group { items: Vec<Item>, opacity: f64, within: Vec<Region> },
}

/// What an outline is filled with.
#[derive(Clone, Debug)]
pub(super) enum Colour {
    Solid(Rgba),
    Gradient(Box<Gradient>),
}

/// Red, green, blue and alpha, each 0 to 1; the colours times alpha.
pub(super) type Rgba = [f64; 4];

/// A gradient by its stops.
#[derive(Clone, Debug)]
pub(super) struct Gradient {
    /// From the sheet to the gradient's own places.
    to_own: [f64; 6],
    axis: GradientAxis,
    spread: usvg::SpreadMethod,
    /// Offset and colour of each, ascending.
    stops: Vec<(f64, Rgba)>,
    opacity: f64,
}

#[derive(Clone, Copy, Debug)]
enum GradientAxis {
    /// From a place, this far.
    Linear { from: PxPoint, way: PxVec },
    /// From the focus to the circle.
    Radial { focus: PxPoint, centre: PxPoint, radius: f64 },
}

impl Painted {
    /// Whether a place shows.
    pub(super) fn shows(&self, at: PxPoint, steps: &mut Steps) -> bool {
        let [red, green, blue, alpha] = over(&self.items, at, steps);
        // Luminance of colours that are times alpha: luminance times alpha.
        let light = if self.by_alpha { alpha } else { 0.2125 * red + 0.7154 * green + 0.0721 * blue };
        // 8 bits a colour say no more.
        light >= SHOWS - 1e-6
    }

    pub(super) fn shapes<'a>(&'a self, visit: &mut dyn FnMut(&'a Shape)) {
        shapes(&self.items, visit);
    }

    pub(super) fn has_gradients(&self) -> bool {
        has_gradients(&self.items)
    }
}

/// As deep as the mask is nested, which has been checked.
fn shapes<'a>(items: &'a [Item], visit: &mut dyn FnMut(&'a Shape)) {
    for item in items {
        match item {
            Item::Fill(shape, _) => visit(shape),
            Item::Group { items, within, .. } => {
                within.iter().for_each(|region| region.shapes(visit));
                shapes(items, visit);
            }
        }
    }
}

fn has_gradients(items: &[Item]) -> bool {
    items.iter().any(|item| match item {
        Item::Fill(_, colour) => matches!(colour, Colour::Gradient(_)),
        Item::Group { items, .. } => has_gradients(items),
    })
}

/// The colour of a place.
fn over(items: &[Item], at: PxPoint, steps: &mut Steps) -> Rgba {
    let mut below = [0.0; 4];
    for item in items {
        let colour = match item {
            Item::Fill(shape, colour) if shape.contains(at, steps) => colour.at(at),
            Item::Group { items, opacity, within }
                if within.iter().all(|region| region.side(at, 0.0, steps) >= super::region::Side::Edge) =>
            {
                over(items, at, steps).map(|part| part * opacity)
            }
            _ => continue,
        };
        let rest = 1.0 - colour[3];
        for (below, colour) in below.iter_mut().zip(colour) {
            *below = colour + *below * rest;
        }
    }
    below
}

fn times_alpha(colour: usvg::Color, alpha: f64) -> Rgba {
    let part = |byte: u8| f64::from(byte) / 255.0 * alpha;
    [part(colour.red), part(colour.green), part(colour.blue), alpha]
}

impl Colour {
    /// That of a paint in a place of this matrix; a pattern is taken for black.
    pub(super) fn new(paint: &usvg::Paint, opacity: f64, matrix: Transform) -> Self {
        let (base, axis) = match paint {
            usvg::Paint::Color(colour) => return Self::Solid(times_alpha(*colour, opacity)),
            usvg::Paint::Pattern(_) => return Self::Solid([0.0, 0.0, 0.0, opacity]),
            usvg::Paint::LinearGradient(gradient) => {
                let [x, y] = [gradient.x1(), gradient.y1()].map(f64::from);
                let way = PxVec::new(f64::from(gradient.x2()) - x, f64::from(gradient.y2()) - y);
                let base: &usvg::BaseGradient = gradient;
                (base, GradientAxis::Linear { from: PxPoint::new(x, y), way })
            }
            usvg::Paint::RadialGradient(gradient) => {
                let place = |x: f32, y: f32| PxPoint::new(f64::from(x), f64::from(y));
                let base: &usvg::BaseGradient = gradient;
                let (focus, centre) =
                    (place(gradient.fx(), gradient.fy()), place(gradient.cx(), gradient.cy()));
                (base, GradientAxis::Radial { focus, centre, radius: f64::from(gradient.r().get()) })
            }
        };
        let stop = |stop: &usvg::Stop| {
            (f64::from(stop.offset().get()), times_alpha(stop.color(), f64::from(stop.opacity().get())))
        };
        let stops: Vec<(f64, Rgba)> = base.stops().iter().map(stop).collect();
        let Some(to_own) = matrix.pre_concat(base.transform()).invert() else {
            return Self::Solid(
                stops.last().map_or([0.0; 4], |(_, colour)| colour.map(|part| part * opacity)),
            );
        };
        let to_own = [to_own.sx, to_own.ky, to_own.kx, to_own.sy, to_own.tx, to_own.ty].map(f64::from);
        Self::Gradient(Box::new(Gradient { to_own, axis, spread: base.spread_method(), stops, opacity }))
    }

    fn at(&self, at: PxPoint) -> Rgba {
        match self {
            Self::Solid(colour) => *colour,
            Self::Gradient(gradient) => gradient.at(at),
        }
    }
}

impl Gradient {
    fn at(&self, at: PxPoint) -> Rgba {
        let [a, b, c, d, e, f] = self.to_own;
        let own = PxPoint::new(a * at.x + c * at.y + e, b * at.x + d * at.y + f);
        let along = match self.axis {
            GradientAxis::Linear { from, way } => (own - from).dot(way) / way.length_squared(),
            GradientAxis::Radial { focus, centre, radius } => {
                // |F + (P − F) / t − C| = r, of which the greatest t; with the focus in the centre |P − C| / r.
                let (out, off) = (own - focus, focus - centre);
                let (square, half) = (out.length_squared(), out.dot(off));
                let inside = radius * radius - off.x * off.x - off.y * off.y;
                if inside <= 0.0 {
                    own.distance(centre) / radius
                } else {
                    square / (libm::sqrt(half * half + square * inside) - half)
                }
            }
        };
        let along = if along.is_nan() { 0.0 } else { along };
        let part = along - libm::floor(along);
        let along = match self.spread {
            usvg::SpreadMethod::Pad => along.clamp(0.0, 1.0),
            usvg::SpreadMethod::Repeat => part,
            usvg::SpreadMethod::Reflect => {
                if libm::floor(along) % 2.0 == 0.0 {
                    part
                } else {
                    1.0 - part
                }
            }
        };
        let after = self.stops.iter().position(|(offset, _)| *offset > along).unwrap_or(self.stops.len());
        let (before, after) =
            (after.checked_sub(1).and_then(|stop| self.stops.get(stop)), self.stops.get(after));
        let colour = match (before, after) {
            (Some((low, from)), Some((high, to))) => {
                let share = (along - low) / (high - low);
                let mut mixed = *from;
                mixed.iter_mut().zip(to).for_each(|(part, to)| *part += (to - *part) * share);
                mixed
            }
            (Some((_, colour)), None) | (None, Some((_, colour))) => *colour,
            (None, None) => [0.0; 4],
        };
        colour.map(|part| part * self.opacity)
    }
}
