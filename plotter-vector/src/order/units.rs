//! [`units`]: what is drawn in one go: a trail, or a block of lettering with its trails in reading order.

use super::plan::{Stroke, Trail};
use super::sites::RING_PLACES;
use crate::PxPoint;
use crate::lettering::TextBlock;

/// Marks the strokes of each letter with its number: 1 for the first one read, and so on.
pub(crate) fn mark_letters(strokes: &mut [Stroke<'_>], blocks: &[TextBlock]) {
    for (letter, own) in blocks.iter().flat_map(TextBlock::letters).enumerate() {
        for stroke in own {
            if let Some(stroke) = strokes.get_mut(*stroke) {
                stroke.letter = letter + 1;
            }
        }
    }
}

/// The trails by unit; those of a block in reading order, each from the end that makes the block's travel least.
pub(crate) fn units(strokes: &[Stroke<'_>], trails: Vec<Trail>, blocks: &[TextBlock]) -> Vec<Vec<Trail>> {
    // Of each letter its block; of each stroke its place in the letter.
    let mut block_of = vec![None];
    let mut rank = vec![0; strokes.len()];
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
    let letter = |trail: &Trail| {
        let first = trail.pieces.first().and_then(|piece| strokes.get(piece.stroke));
        first.map_or(0, |stroke| stroke.letter)
    };
    let place = |trail: &Trail| {
        let places = trail.pieces.iter().filter_map(|piece| rank.get(piece.stroke));
        (letter(trail), places.min().copied().unwrap_or(0))
    };
    let mut units: Vec<Vec<Trail>> = Vec::with_capacity(trails.len());
    let mut of_block: Vec<Option<usize>> = vec![None; blocks.len()];
    for trail in trails {
        let block = block_of.get(letter(&trail)).copied().flatten().and_then(|block| of_block.get_mut(block));
        match block {
            Some(Some(unit)) => units.get_mut(*unit).into_iter().for_each(|unit| unit.push(trail.clone())),
            Some(slot) => {
                *slot = Some(units.len());
                units.push(vec![trail]);
            }
            None => units.push(vec![trail]),
        }
    }
    for unit in units.iter_mut().filter(|unit| unit.len() > 1) {
        unit.sort_by_key(place);
        turn_well(strokes, unit);
    }
    units
}

/// A way to draw a trail: where it begins and ends, and its first vertex if it is closed, else whether it is reversed.
#[derive(Clone, Copy)]
struct Way {
    from: PxPoint,
    to: PxPoint,
    start: usize,
    reversed: bool,
    /// Least travel up to here, and the way of the trail before that has it.
    travel: f64,
    before: usize,
}

/// Turns the trails of a fixed order so that the travel between them is least: the shortest path through the ways to
/// draw them, trail by trail (R. Bellman, "Dynamic programming", 1957).
fn turn_well(strokes: &[Stroke<'_>], trails: &mut [Trail]) {
    let mut layers: Vec<Vec<Way>> = Vec::with_capacity(trails.len());
    for trail in trails.iter() {
        let mut ways = ways(strokes, trail);
        if let Some(last) = layers.last() {
            for way in &mut ways {
                let travel = |before: &Way| before.travel + before.to.distance(way.from);
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
        if way.reversed {
            trail.reverse();
        }
        chosen = way.before;
    }
}

fn ways(strokes: &[Stroke<'_>], trail: &Trail) -> Vec<Way> {
    let way = |from, to, start, reversed| Way { from, to, start, reversed, travel: 0.0, before: 0 };
    if !trail.closed {
        let (from, to) = trail.ends(strokes);
        return vec![way(from, to, 0, false), way(to, from, 0, true)];
    }
    let vertices = Trail { start: 0, ..trail.clone() }.vertices(strokes);
    let ring = vertices.len().saturating_sub(1);
    let places = ring.min(RING_PLACES);
    let starts = (0..places).map(|k| k * ring / places.max(1));
    starts.filter_map(|start| vertices.get(start).map(|at| way(*at, *at, start, false))).collect()
}

#[cfg(test)]
mod tests {
    use crate::{Drawing, Lettering, Order, PxPoint};

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
