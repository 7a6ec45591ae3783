//! [`Ring`]: the blocks that are known ahead, and the speeds between them.

use super::block::Block;
use super::limits::{Limits, Shares};
use super::sum_down::{Sum, sum_down};
use crate::extremes::{greatest, least};
use crate::geom::single;

/// The blocks that are known ahead.
///
/// The machine can always stop at the end of the ring: the speed after the last block is 0. A backward pass
/// keeps the limits of braking, a forward pass those of speeding up. Blocks before `planned` cannot become
/// faster and are not planned again.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ring<const N: usize> {
    blocks: [Block; N],
    head: u16,
    len: u16,
    /// Number of blocks from the head whose entry speed no later block can raise.
    planned: u16,
}

impl<const N: usize> Ring<N> {
    pub(super) fn new() -> Self {
        Self { blocks: [Block::default(); N], head: 0, len: 0, planned: 0 }
    }

    pub(super) const fn len(&self) -> usize {
        self.len as usize
    }

    pub(super) const fn room(&self) -> usize {
        N - self.len()
    }

    const fn slot(&self, index: usize) -> usize {
        let slot = self.head as usize + index;
        if slot >= N { slot - N } else { slot }
    }

    pub(super) fn get(&self, index: usize) -> Option<&Block> {
        if index < self.len() { self.blocks.get(self.slot(index)) } else { None }
    }

    fn get_mut(&mut self, index: usize) -> Option<&mut Block> {
        let slot = self.slot(index);
        if index < self.len() { self.blocks.get_mut(slot) } else { None }
    }

    /// Square of the speed at which the block after the head is entered: 0 after the last.
    pub(super) fn next_entry2(&self) -> f32 {
        self.get(1).map_or(0.0, |block| block.entry2)
    }

    /// Takes a block; there must be room.
    pub(super) fn push(&mut self, block: Block) {
        debug_assert!(self.room() > 0, "the planner has asked for room");
        if self.room() > 0 {
            self.len += 1;
        }
        if let Some(last) = self.get_mut(self.len().saturating_sub(1)) {
            *last = block;
        }
    }

    /// Removes the head. The entry speed of the next block is final from here on.
    pub(super) fn pop(&mut self) {
        if self.len > 0 {
            self.head = number(self.slot(1));
            self.len -= 1;
            self.planned = self.planned.saturating_sub(1);
        }
    }

    pub(super) fn clear(&mut self) {
        (self.len, self.planned) = (0, 0);
    }

    /// Whether the entry speed of the block after the head is final: blocks that were added since it was
    /// planned do not change it.
    pub(super) const fn next_is_settled(&self) -> bool {
        self.planned > 0
    }

    /// Plans again after a change at the end. The head's entry speed stays.
    pub(super) fn plan(&mut self, limits: &Limits) {
        let first = usize::from(self.planned.max(1));
        let mut exit2 = Sum::default();
        let mut index = self.len();
        // The last block, going backwards, that is limited by its corner.
        let mut last_limited = None;
        while index > first {
            index -= 1;
            let Some(block) = self.get_mut(index) else { break };
            exit2 = before(exit2, block, limits);
            block.entry2 = exit2.value();
            if last_limited.is_none() && block.entry2 >= block.max_entry2 {
                last_limited = Some(index);
            }
        }
        let mut most2 = self.get(first - 1).map_or(0.0, |block| after2(block, limits));
        for index in first..self.len() {
            let Some(block) = self.get_mut(index) else { break };
            let slower = most2 < block.entry2;
            if slower {
                block.entry2 = most2;
            }
            let settled = slower || block.entry2 >= block.max_entry2;
            most2 = after2(block, limits);
            if settled {
                self.planned = number(index);
            } else if last_limited.is_none_or(|last| index > last) {
                // From here on the machine brakes for the end: each block is entered no faster than the
                // previous one.
                break;
            }
        }
    }

    /// Other shares of the speeds that were asked for hold. `before2` is the square of the greatest speed on
    /// what comes before the head, `forced2` that with which the head is entered however hard the machine
    /// brakes from now on. Gives the square of the greatest speed on the last block.
    pub(super) fn rescale(&mut self, shares: &Shares, limits: &Limits, before2: f32, forced2: f32) -> f32 {
        let (mut before2, mut forced2) = (before2, forced2);
        for index in 0..self.len() {
            let Some(block) = self.get_mut(index) else { continue };
            if block.is_path() {
                block.cruise2 = block.wish().cruise2(shares, limits);
                let most2 = least(block.corner2, least(before2, block.cruise2));
                // What can no longer be avoided was planned before, however it has been rounded since.
                forced2 = least(forced2, block.entry2);
                block.max_entry2 = greatest(most2, forced2);
                before2 = block.cruise2;
                forced2 = block.forced2(forced2, limits);
            } else {
                forced2 = 0.0;
            }
        }
        self.planned = 0;
        before2
    }

    /// Plans again, with the head entered at exactly this speed, given by its square.
    pub(super) fn enter_with(&mut self, entry2: f32, limits: &Limits) {
        if let Some(head) = self.get_mut(0) {
            head.entry2 = entry2;
        }
        self.planned = 0;
        self.plan(limits);
    }

    /// Plans anew with a head that is entered with no more than this square of a speed; gives the one with
    /// which it is.
    pub(super) fn enter_at_most(&mut self, most2: f32, limits: &Limits) -> f32 {
        // What can be braked from within the blocks known, backwards.
        let mut entry2 = Sum::default();
        for index in (0..self.len()).rev() {
            let Some(block) = self.get(index) else { continue };
            entry2 = before(entry2, block, limits);
        }
        let entry2 = least(entry2.value(), most2);
        if let Some(head) = self.get_mut(0) {
            head.entry2 = entry2;
        }
        self.planned = 0;
        self.plan(limits);
        self.get(0).map_or(0.0, |head| head.entry2)
    }
}

/// Square of the greatest speed at which a block may be entered if it is left at the given one.
fn before(exit2: Sum, block: &Block, limits: &Limits) -> Sum {
    let entry2 = match block.even_reach2() {
        Some(reach2) => exit2.plus(reach2),
        None => Sum::of(block.reach2(exit2.value(), block.max_entry2, limits)),
    };
    entry2.at_most(block.max_entry2)
}

/// Square of the greatest speed at which a block can be left.
fn after2(block: &Block, limits: &Limits) -> f32 {
    match block.even_reach2() {
        Some(reach2) => sum_down(block.entry2, reach2),
        // It is faster than its cruise only if it was slowed down meanwhile.
        None if block.entry2 >= block.cruise2 => block.reach2(block.entry2, f32::INFINITY, limits),
        None => block.reach2(block.entry2, block.cruise2, limits),
    }
}

/// A number of blocks, of which a planner has fewer than 65,536.
#[expect(clippy::cast_possible_truncation, reason = "the planner asserts it")]
const fn number(blocks: usize) -> u16 {
    blocks as u16
}

/// A limit as the look-ahead keeps it: rounded down, so that no limit is exceeded by the rounding.
pub(super) fn narrow(value: f64) -> f32 {
    let rounded = single(value);
    if f64::from(rounded) > value { greatest(rounded.next_down(), 0.0) } else { rounded }
}

#[cfg(test)]
mod tests {
    use super::super::block::Bend;
    use super::super::{PlannerSettings, Shape};
    use super::*;
    use crate::{Pen, Point};
    use proptest::prelude::*;
    use std::vec;
    use std::vec::Vec;

    fn limits() -> Limits {
        Limits::of(&PlannerSettings::default())
    }

    fn block(length_mm: f32, max_entry2: f32) -> Block {
        let line = Bend::Line { accel: limits().accel() };
        let mut block = Block::path(Shape::Line, Point::ORIGIN, length_mm, (Pen::Down, 0), 1e4, line);
        block.max_entry2 = max_entry2;
        block
    }

    /// The squares of the speeds between all blocks from the head on, as one reckons them by hand.
    fn by_hand<const N: usize>(ring: &Ring<N>) -> Vec<f32> {
        let blocks: Vec<Block> = (0..ring.len()).filter_map(|index| ring.get(index).copied()).collect();
        let mut speeds = vec![0.0; blocks.len() + 1];
        for index in (1..blocks.len()).rev() {
            let braked = sum_down(speeds[index + 1], blocks[index].even_reach2().unwrap());
            speeds[index] = least(blocks[index].max_entry2, braked);
        }
        speeds[0] = blocks.first().map_or(0.0, |head| head.entry2);
        for index in 1..blocks.len() {
            let reached = sum_down(speeds[index - 1], blocks[index - 1].even_reach2().unwrap());
            speeds[index] = least(reached, speeds[index]);
        }
        speeds
    }

    proptest! {
        /// However many blocks have come since it was planned, and whether it is planned for each of them or
        /// only when it must be.
        #[test]
        fn the_next_speed_is_the_one_of_all_that_is_known(
            rows in prop::collection::vec((0.001_f32..5.0, prop_oneof![1 => Just(0.0), 3 => 0.0_f32..1e4, 3 => Just(1e4_f32)], 0_usize..3), 1..200),
            fine in prop_oneof![Just(1.0_f32), Just(0.01)],
        ) {
            let mut ring = Ring::<16>::new();
            let mut stale = false;
            let pop = |ring: &mut Ring<16>, stale: &mut bool| {
                let expected = by_hand(ring)[1];
                if *stale && !ring.next_is_settled() {
                    ring.plan(&limits());
                    *stale = false;
                }
                let found = ring.next_entry2();
                ring.pop();
                (expected, found)
            };
            for (length_mm, max_entry2, pops) in rows {
                if ring.room() == 0 {
                    let (expected, found) = pop(&mut ring, &mut stale);
                    prop_assert_eq!(found, expected);
                }
                ring.push(block(fine * length_mm, max_entry2));
                stale = true;
                for _ in 0..pops.saturating_sub(1).min(ring.len()) {
                    let (expected, found) = pop(&mut ring, &mut stale);
                    prop_assert_eq!(found, expected);
                }
            }
        }
    }

    #[test]
    fn what_is_settled_is_not_looked_at_again() {
        let mut ring = Ring::<16>::new();
        // 1 mm each at 1000 mm/s²: the fifth from the end is the first that may be entered with 100 mm/s.
        for _ in 0..16 {
            ring.push(block(1.0, 1e4));
        }
        ring.plan(&limits());
        let mut unplanned = 0;
        while ring.next_is_settled() {
            ring.pop();
            unplanned += 1;
        }
        assert!(unplanned >= 7, "{unplanned}");
    }
}
