//! [`Units`]: what is drawn in one go: a trail, or a block of lettering with its trails in reading order.

use super::plan::{Legs, Stroke, Trail};
use super::sites::{RING_PLACES, number};
use crate::order::lettering::TextBlock;
use crate::stroke::PxPoint;

/// Marks the strokes of each letter with its number: 1 for the first one read, and so on.
pub(crate) fn mark_letters(strokes: &mut [Stroke<'_>], blocks: &[TextBlock]) {
    for (own, letter) in blocks.iter().flat_map(TextBlock::letters).zip(1..) {
        for stroke in own {
            if let Some(stroke) = strokes.get_mut(*stroke) {
                stroke.letter = letter;
            }
        }
    }
}

/// Trails, those of a unit one after the other.
#[derive(Debug)]
pub(crate) struct Units {
    trails: Vec<Trail>,
    /// One past the last trail of each unit; nothing as long as each trail is one.
    ends: Vec<u32>,
}

impl Units {
    /// The trails by unit, in the order in which units come first; those of a block in reading order, each
    /// from the end that makes the block's travel least.
    pub(crate) fn new(legs: &Legs<'_>, trails: Vec<Trail>, blocks: &[TextBlock]) -> Self {
        let mut units = Self { ends: Vec::new(), trails };
        if !blocks.is_empty() {
            units.gather(legs, blocks);
        }
        units
    }

    pub(crate) fn len(&self) -> usize {
        if self.ends.is_empty() { self.trails.len() } else { self.ends.len() }
    }

    /// Number of all trails.
    pub(crate) fn trails(&self) -> usize {
        self.trails.len()
    }

    /// The trails of a unit.
    pub(crate) fn of(&self, unit: u32) -> &[Trail] {
        let each = |unit: usize| if self.ends.is_empty() { unit + 1 } else { 0 };
        let end = |unit: usize| self.ends.get(unit).map_or_else(|| each(unit), |end| *end as usize);
        let from = (unit as usize).checked_sub(1).map_or(0, end);
        self.trails.get(from..end(unit as usize)).unwrap_or(&[])
    }

    /// Makes a unit of the trails of each block.
    fn gather(&mut self, legs: &Legs<'_>, blocks: &[TextBlock]) {
        // Of each letter its block; of each stroke its place in the letter.
        let mut block_of = vec![None];
        let mut rank = vec![0; legs.strokes.len()];
        for (index, block) in blocks.iter().enumerate() {
            for letter in block.letters() {
                block_of.push(Some(index));
                for (place, stroke) in letter.iter().enumerate() {
                    if let Some(slot) = rank.get_mut(*stroke) {
                        *slot = place;
                    }
                }
            }
        }
        let letter = |trail: Trail| legs.first(trail).map_or(0, |stroke| stroke.letter);
        let place = |trail: &Trail| {
            let places = trail.legs(&legs.all).filter_map(|leg| rank.get(leg.stroke as usize));
            (letter(*trail), places.min().copied().unwrap_or(0))
        };
        let mut of_block: Vec<Option<u32>> = vec![None; blocks.len()];
        let mut all = 0;
        let unit = |trail: Trail| {
            let block = block_of.get(letter(trail) as usize).copied().flatten();
            let known = block.and_then(|block| of_block.get_mut(block));
            let unit = known.as_ref().and_then(|known| **known).unwrap_or(all);
            known.into_iter().for_each(|known| *known = Some(unit));
            all = all.max(unit + 1);
            (unit, trail)
        };
        let mut by_unit: Vec<(u32, Trail)> = self.trails.drain(..).map(unit).collect();
        by_unit.sort_by_key(|(unit, _)| *unit);
        self.ends.clear();
        for same in by_unit.chunk_by(|a, b| a.0 == b.0) {
            let from = self.trails.len();
            self.trails.extend(same.iter().map(|(_, trail)| *trail));
            self.ends.push(number(self.trails.len()));
            if let Some(unit @ [_, _, ..]) = self.trails.get_mut(from..) {
                unit.sort_by_key(place);
                turn_well(legs, unit);
            }
        }
    }
}

/// A traversal of a trail: where it begins and ends, and its first vertex if it is closed, else whether it is
/// reversed.
#[derive(Clone, Copy)]
struct Traversal {
    from: PxPoint,
    to: PxPoint,
    start: u32,
    reversed: bool,
    /// Least travel up to here, and the way of the trail before that has it.
    travel: f64,
    before: usize,
}

/// Turns the trails of a fixed order so that the travel between them is least: the shortest path through the
/// ways to draw them, trail by trail (R. Bellman, "Dynamic programming", 1957).
fn turn_well(legs: &Legs<'_>, trails: &mut [Trail]) {
    let mut layers: Vec<Vec<Traversal>> = Vec::with_capacity(trails.len());
    for trail in trails.iter() {
        let mut ways = ways(legs, *trail);
        if let Some(last) = layers.last() {
            for way in &mut ways {
                let travel = |before: &Traversal| before.travel + before.to.distance(way.from);
                let best = (0..last.len()).zip(last.iter().map(travel)).min_by(|a, b| a.1.total_cmp(&b.1));
                (way.before, way.travel) = best.unwrap_or((0, 0.0));
            }
        }
        layers.push(ways);
    }
    let last = layers.last().map_or(&[][..], Vec::as_slice);
    let mut chosen =
        (0..last.len()).zip(last).min_by(|a, b| a.1.travel.total_cmp(&b.1.travel)).map_or(0, |best| best.0);
    for (trail, ways) in trails.iter_mut().zip(&layers).rev() {
        let Some(way) = ways.get(chosen) else { return };
        trail.start = way.start;
        trail.reversed = way.reversed;
        chosen = way.before;
    }
}

fn ways(legs: &Legs<'_>, trail: Trail) -> Vec<Traversal> {
    let way = |from, to, start, reversed| Traversal { from, to, start, reversed, travel: 0.0, before: 0 };
    if !trail.closed {
        let (from, to) = legs.ends(trail);
        return vec![way(from, to, 0, false), way(to, from, 0, true)];
    }
    let mut from_first = trail;
    from_first.start = 0;
    let vertices = legs.vertices(from_first);
    let ring = vertices.len().saturating_sub(1);
    let places = ring.min(RING_PLACES);
    let starts = (0..places).map(|k| k * ring / places.max(1));
    starts.filter_map(|start| vertices.get(start).map(|at| way(*at, *at, number(start), false))).collect()
}

#[cfg(test)]
mod tests {
    use crate::{
        order::{Lettering, Order},
        stroke::{Drawing, PxPoint},
    };

    #[test]
    fn each_letter_is_drawn_from_the_end_that_makes_the_travel_of_its_block_least() {
        // Five L, 12 px high and 11 px apart, each drawn from the right end of its foot.
        let mut drawing = Drawing::new(100, 50);
        for x in [10.0, 21.0, 32.0, 43.0, 54.0] {
            drawing.push([(x + 8.0, 32.0), (x, 32.0), (x, 20.0)].map(|(x, y)| PxPoint::new(x, y)));
        }
        let order = Order { lettering: Some(Lettering::default()), ..Order::default() };
        let ordered = order.apply(&drawing);
        // From top to top, and from foot to foot, in turn.
        assert_eq!((ordered.strokes().len(), ordered.pen_up_px()), (5, 4.0 * 11.0));
    }
}
