//! [`Pens`]: the pen of each colour, or of each layer.

use super::{SvgLayer, SvgPens, SvgWithoutPen};
use crate::ink::{MAX_PENS, PalettePen};
use crate::picture::Rgb;
use std::collections::BTreeSet;

/// Pens that colours and layers have been given.
pub(super) struct Pens {
    by: SvgPens,
    given: Vec<PalettePen>,
    /// The layer that each of them stands for; beside `given`.
    layers: Vec<Option<usize>>,
    /// Numbers that the names of layers take.
    named: BTreeSet<u8>,
    /// Colours and layers that found no pen free.
    without: BTreeSet<Without>,
    /// How many shapes have them.
    shapes: usize,
}

/// What has no pen of its own.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Without {
    Colour([u8; 3]),
    Layer(Option<usize>),
}

impl Pens {
    /// None yet, of a file with these layers.
    pub(super) fn new(by: SvgPens, layers: &[SvgLayer]) -> Self {
        let drawn = layers.iter().filter(|layer| !layer.is_left_out);
        Self {
            by,
            given: Vec::new(),
            layers: Vec::new(),
            named: drawn.filter_map(|layer| layer.number).collect(),
            without: BTreeSet::new(),
            shapes: 0,
        }
    }

    /// The pen of a shape of this colour in this layer, if it is in one; the next free one when that has
    /// none, and when none is free, that of the nearest colour.
    pub(super) fn of(&mut self, colour: Rgb, layer: Option<(usize, &SvgLayer)>) -> u8 {
        let by_layers = matches!(self.by, SvgPens::ByLayer | SvgPens::ByOrder);
        let named = layer.and_then(|(_, layer)| layer.number).filter(|_| self.by == SvgPens::ByLayer);
        let index = layer.map(|(index, _)| index);
        let known = match (self.by, named) {
            (SvgPens::ByColour, _) => self.given.iter().find(|pen| pen.colour == colour),
            (SvgPens::ByLayer | SvgPens::ByOrder, Some(number)) => {
                self.given.iter().find(|pen| pen.number == number)
            }
            (SvgPens::ByLayer | SvgPens::ByOrder, None) => {
                let found = self.layers.iter().position(|known| *known == index);
                found.and_then(|found| self.given.get(found))
            }
            (SvgPens::One, _) => self.given.first(),
        };
        if let Some(pen) = known {
            return pen.number;
        }
        let Some(number) = named.or_else(|| self.free()) else {
            self.without.insert(if by_layers { Without::Layer(index) } else { Without::Colour(colour.0) });
            self.shapes += 1;
            return self.nearest(colour);
        };
        let name = match (self.by, layer) {
            (SvgPens::ByColour, _) => colour.to_string(),
            (SvgPens::ByLayer | SvgPens::ByOrder, Some((_, layer))) => layer.name.clone(),
            _ => String::new(),
        };
        self.given.push(PalettePen { number, name, colour, width_mm: None });
        self.layers.push(index);
        number
    }

    /// The next number that no pen has and no layer's name takes. Colours are a palette, which has an end
    /// before the numbers have.
    fn free(&self) -> Option<u8> {
        if self.by == SvgPens::ByColour && self.given.len() >= MAX_PENS {
            return None;
        }
        let is_named = |number: &u8| self.by == SvgPens::ByLayer && self.named.contains(number);
        let is_given = |number: &u8| self.given.iter().any(|pen| pen.number == *number);
        (1..=u8::MAX).find(|number| !is_named(number) && !is_given(number))
    }

    /// The pen of the nearest colour.
    fn nearest(&self, colour: Rgb) -> u8 {
        let wanted = colour.oklab();
        let distance = |pen: &PalettePen| pen.colour.oklab().distance(wanted);
        let nearest = self.given.iter().min_by(|one, other| distance(one).total_cmp(&distance(other)));
        nearest.map_or(1, |pen| pen.number)
    }

    /// The pens in the order of their numbers, and what has none.
    pub(super) fn finish(mut self) -> (Vec<PalettePen>, SvgWithoutPen) {
        self.given.sort_by_key(|pen| pen.number);
        (self.given, SvgWithoutPen { kinds: self.without.len(), shapes: self.shapes })
    }
}
