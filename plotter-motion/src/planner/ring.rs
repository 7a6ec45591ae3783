//! [`Ring`]: the blocks that are known ahead, and the speeds between them.

use super::block::Block;
use super::limits::{Limits, Shares};
use crate::extremes::{greatest, least};
use crate::geom::single;

/// The blocks that are known ahead.
///
/// Whatever it holds, the machine can stop at its end: the speed after the last block is 0. A backward pass keeps the
/// braking, a forward pass the speeding up. Blocks before `planned` are as fast as they will ever be and are not looked at
/// again.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ring<const N: usize> {
    blocks: [Block; N],
    head: usize,
    len: usize,
    /// How many blocks from the head have an entry speed that nothing to come can raise.
    planned: usize,
}

impl<const N: usize> Ring<N> {
    pub(super) fn new() -> Self {
        Self { blocks: [Block::default(); N], head: 0, len: 0, planned: 0 }
    }

    pub(super) const fn len(&self) -> usize {
        self.len
    }

    pub(super) const fn room(&self) -> usize {
        N - self.len
    }

    fn slot(&self, index: usize) -> usize {
        let slot = self.head + index;
        if slot >= N { slot - N } else { slot }
    }

    pub(super) fn get(&self, index: usize) -> Option<&Block> {
        if index < self.len { self.blocks.get(self.slot(index)) } else { None }
    }

    fn get_mut(&mut self, index: usize) -> Option<&mut Block> {
        let slot = self.slot(index);
        if index < self.len { self.blocks.get_mut(slot) } else { None }
    }

    /// Square of the speed at which the block after the head is entered: 0 after the last.
    pub(super) fn next_entry2(&self) -> f32 {
        self.get(1).map_or(0.0, |block| block.entry2)
    }

    /// Takes a block; there must be room.
    pub(super) fn push(&mut self, block: Block) {
        debug_assert!(self.len < N, "the planner has asked for room");
        self.len = (self.len + 1).min(N);
        if let Some(last) = self.get_mut(self.len.saturating_sub(1)) {
            *last = block;
        }
    }

    /// Takes the head away: the next one's entry speed stands from here on.
    pub(super) fn pop(&mut self) {
        if self.len > 0 {
            self.head = self.slot(1);
            self.len -= 1;
            self.planned = self.planned.saturating_sub(1);
        }
    }

    pub(super) fn clear(&mut self) {
        (self.len, self.planned) = (0, 0);
    }

    /// Plans anew after a change at the end. `twice_accel` is twice the limit along the path; the head's entry speed stands.
    pub(super) fn plan(&mut self, twice_accel: f32) {
        let first = self.planned.max(1);
        let mut exit2 = 0.0_f32;
        let mut index = self.len;
        while index > first {
            index -= 1;
            let Some(block) = self.get_mut(index) else { break };
            exit2 = least(block.max_entry2, sum_down(exit2, reach2(block, twice_accel)));
            block.entry2 = exit2;
        }
        let mut most2 =
            self.get(first - 1).map_or(0.0, |block| sum_down(block.entry2, reach2(block, twice_accel)));
        for index in first..self.len {
            let Some(block) = self.get_mut(index) else { break };
            let slower = most2 < block.entry2;
            if slower {
                block.entry2 = most2;
            }
            let settled = slower || block.entry2 >= block.max_entry2;
            most2 = sum_down(block.entry2, reach2(block, twice_accel));
            if settled {
                self.planned = index;
            }
        }
    }

    /// Other shares of the speeds that were asked for hold. `before2` is the square of the greatest speed on what comes before
    /// the head, `forced2` that with which the head is entered however hard the machine brakes from now on. Gives the
    /// square of the greatest speed on the last block.
    pub(super) fn rescale(&mut self, shares: &Shares, limits: &Limits, before2: f32, forced2: f32) -> f32 {
        let (mut before2, mut forced2) = (before2, forced2);
        for index in 0..self.len {
            let Some(block) = self.get_mut(index) else { continue };
            if block.is_path() {
                block.cruise2 = block.wish(limits).cruise2(shares, limits);
                let most2 = least(block.corner2, least(before2, block.cruise2));
                // What can no longer be avoided was planned before, however it has been rounded since.
                forced2 = least(forced2, block.entry2);
                block.max_entry2 = greatest(most2, forced2);
                before2 = block.cruise2;
                forced2 = greatest(forced2 - 2.0 * limits.accel * block.length(), 0.0);
            } else {
                forced2 = 0.0;
            }
        }
        self.planned = 0;
        before2
    }

    /// Plans anew with a head that is entered with exactly this square of a speed.
    pub(super) fn enter_with(&mut self, entry2: f32, twice_accel: f32) {
        if let Some(head) = self.get_mut(0) {
            head.entry2 = entry2;
        }
        self.planned = 0;
        self.plan(twice_accel);
    }

    /// Plans anew with a head that is entered with no more than this square of a speed; gives the one with which it is.
    pub(super) fn enter_at_most(&mut self, most2: f32, twice_accel: f32) -> f32 {
        // What can be braked from within the blocks known, backwards.
        let mut entry2 = 0.0_f32;
        for index in (0..self.len).rev() {
            let Some(block) = self.get(index) else { continue };
            entry2 = least(block.max_entry2, sum_down(entry2, reach2(block, twice_accel)));
        }
        let entry2 = least(entry2, most2);
        if let Some(head) = self.get_mut(0) {
            head.entry2 = entry2;
        }
        self.planned = 0;
        self.plan(twice_accel);
        self.get(0).map_or(0.0, |head| head.entry2)
    }
}

/// How much the square of the speed can change along a block.
fn reach2(block: &Block, twice_accel: f32) -> f32 {
    if block.is_path() { twice_accel * block.length() } else { 0.0 }
}

/// The sum of two squares of speeds, rounded down: what the rounding added is found without error.
///
/// Source: D. E. Knuth, "The Art of Computer Programming", volume 2, section 4.2.2, theorem B.
fn sum_down(a: f32, b: f32) -> f32 {
    let sum = a + b;
    let of_b = sum - a;
    let error = (a - (sum - of_b)) + (b - of_b);
    if error < 0.0 { sum.next_down() } else { sum }
}

/// A limit as the look-ahead keeps it: rounded down, so that no limit is exceeded by the rounding.
pub(super) fn narrow(value: f64) -> f32 {
    let rounded = single(value);
    if f64::from(rounded) > value { greatest(rounded.next_down(), 0.0) } else { rounded }
}
