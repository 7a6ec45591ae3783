//! [`NearNodes`]: which of many places lie within a gap of each other.

use crate::stroke::PxPoint;
use core::ops::Range;

/// Places in squares as wide as the gap, row by row of the squares: what is near a place is in its own square
/// and the eight about it, so one sweep over the list finds all pairs. A tree would be asked once for each
/// place, and of a million lines hardly one has an end near another.
pub(crate) struct NearNodes {
    /// Square and number of each place, in rising order.
    cells: Vec<(u64, u32)>,
    /// The square of the gap, with a little more for the rounding of differences.
    reach: f64,
}

/// From a square to the one in the next row.
const ROW: u64 = 1 << 32;

/// Most squares in a row, so that their numbers have room in half a key.
const MOST_SQUARES: f64 = (1_u32 << 31) as f64;

/// Places after a place that it looks at in its own row and in the next, and those within the gap that are
/// taken: limits for drawings that meet in few places.
const LOOKS: usize = 128;
const NEAR: usize = 16;

impl NearNodes {
    /// Of places with their numbers; one may come several times.
    pub(crate) fn new(gap_px: f64, places: impl Iterator<Item = (PxPoint, u32)> + Clone) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (at, _) in places.clone() {
            (low, high) = (low.min(at.x).min(at.y), high.max(at.x).max(at.y));
        }
        let side = (gap_px * (1.0 + 1e-9)).max((high - low) / MOST_SQUARES);
        // 1 is the first, so that 0 is none's left neighbour.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 2^31")]
        let number = |along: f64| u64::from(((along - low) / side) as u32) + 1;
        let mut cells: Vec<(u64, u32)> =
            places.map(|(at, node)| (number(at.y) * ROW + number(at.x), node)).collect();
        cells.sort_unstable();
        cells.dedup();
        Self { cells, reach: gap_px * gap_px * (1.0 + 1e-9) }
    }

    /// How many places there are.
    pub(crate) fn len(&self) -> usize {
        self.cells.len()
    }

    /// Calls `found` with each pair within the gap of which the first is among these in the list; not with all
    /// where there are very many.
    pub(crate) fn pairs(
        &self,
        firsts: Range<usize>,
        place: impl Fn(u32) -> PxPoint,
        mut found: impl FnMut(u32, u32),
    ) {
        let from = |index: usize| self.cells.get(index..).unwrap_or(&[]);
        let first = from(firsts.start).first().map_or(0, |(cell, _)| *cell);
        let mut below = self.cells.partition_point(|(cell, _)| *cell < first + ROW - 1);
        for (index, (cell, node)) in firsts.clone().zip(from(firsts.start)) {
            below += from(below).iter().take_while(|(other, _)| *other < cell + ROW - 1).count();
            let own_row = from(index + 1).iter().take_while(|(other, _)| *other <= cell + 1);
            let next_row = from(below).iter().take_while(|(other, _)| *other <= cell + ROW + 1);
            let is_near = |other: &u32| {
                let apart = place(*node) - place(*other);
                apart.dot(apart) < self.reach
            };
            let looks = own_row.take(LOOKS).chain(next_row.take(LOOKS)).map(|(_, other)| *other);
            looks.filter(is_near).take(NEAR).for_each(|other| found(*node, other));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotter_motion::SplitMix64;

    #[test]
    fn pairs_are_those_within_the_gap() {
        let mut random = SplitMix64::new(7);
        for (gap_px, side_px) in [(0.5, 20.0), (3.0, 40.0), (1e-9, 1e3), (5.0, 1e12)] {
            let mut places: Vec<PxPoint> = (0..300)
                .map(|_| PxPoint::new(random.unit() * side_px - 7.0, random.unit() * side_px))
                .collect();
            // Some a little less and a little more than the gap apart.
            for k in 0..100 {
                let (at, turn) = (places[k], random.unit() * core::f64::consts::TAU);
                let apart = gap_px * if k % 2 == 0 { 0.99 } else { 1.01 };
                places.push(PxPoint::new(at.x + apart * turn.cos(), at.y + apart * turn.sin()));
            }
            let near = NearNodes::new(gap_px, places.iter().copied().zip(0..));
            let mut found = Vec::new();
            let half = near.len() / 2;
            for part in [0..half, half..near.len()] {
                near.pairs(part, |node| places[node as usize], |a, b| found.push((a.min(b), a.max(b))));
            }
            found.sort_unstable();
            let all = (0..400_u32).flat_map(|a| (a + 1..400).map(move |b| (a, b)));
            let within = all.filter(|(a, b)| {
                let apart = places[*a as usize] - places[*b as usize];
                apart.dot(apart) < gap_px * gap_px * (1.0 + 1e-9)
            });
            assert_eq!(found, within.collect::<Vec<_>>(), "{gap_px}");
        }
    }

    #[test]
    fn a_hundred_thousand_places_in_one_square_are_not_all_compared() {
        let count = 100_000_u32;
        let place = |node: u32| PxPoint::new(1e-9 * f64::from(node), 0.0);
        let near = NearNodes::new(1.0, (0..count).map(|node| (place(node), node)));
        let mut pairs = 0;
        near.pairs(0..near.len(), place, |_, _| pairs += 1);
        assert_eq!(pairs, (count as usize) * NEAR - NEAR * (NEAR + 1) / 2);
    }
}
