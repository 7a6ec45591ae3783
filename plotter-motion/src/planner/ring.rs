//! [`Ring`]: the blocks that are known ahead, and the speeds between them.

use super::block::Block;

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
    pub(super) fn next_entry2(&self) -> f64 {
        self.get(1).map_or(0.0, |block| f64::from(block.entry2))
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

    /// Plans anew after a change at the end. `accel_mm_s2` is the limit along the path; the head's entry speed stands.
    pub(super) fn plan(&mut self, accel_mm_s2: f64) {
        let twice = 2.0 * accel_mm_s2;
        let first = self.planned.max(1);
        let mut exit2 = 0.0_f64;
        let mut index = self.len;
        while index > first {
            index -= 1;
            let Some(block) = self.get_mut(index) else { break };
            let entry2 = f64::from(block.max_entry2).min(exit2 + reach2(block, twice));
            block.entry2 = narrow(entry2);
            exit2 = f64::from(block.entry2);
        }
        let mut before =
            self.get(first - 1).map_or((0.0, 0.0), |block| (f64::from(block.entry2), reach2(block, twice)));
        for index in first..self.len {
            let Some(block) = self.get_mut(index) else { break };
            let most2 = before.0 + before.1;
            if most2 < f64::from(block.entry2) {
                block.entry2 = narrow(most2);
                self.planned = index;
            } else if block.entry2 >= block.max_entry2 {
                self.planned = index;
            }
            before = self.get(index).map_or(before, |block| (f64::from(block.entry2), reach2(block, twice)));
        }
    }

    /// Plans anew with a head that is entered with no more than this square of a speed; gives the one with which it is.
    pub(super) fn enter_at_most(&mut self, most2: f64, accel_mm_s2: f64) -> f64 {
        // What can be braked from within the blocks known, backwards.
        let mut entry2 = 0.0_f64;
        for index in (0..self.len).rev() {
            let Some(block) = self.get(index) else { continue };
            entry2 = f64::from(block.max_entry2).min(entry2 + reach2(block, 2.0 * accel_mm_s2));
        }
        let entry2 = entry2.min(most2);
        if let Some(head) = self.get_mut(0) {
            head.entry2 = narrow(entry2);
        }
        self.planned = 0;
        self.plan(accel_mm_s2);
        self.get(0).map_or(0.0, |head| f64::from(head.entry2))
    }
}

/// How much the square of the speed can change along a block.
fn reach2(block: &Block, twice_accel: f64) -> f64 {
    if block.is_path() { twice_accel * block.length() } else { 0.0 }
}

/// A square of a speed as a block keeps it: rounded down, so that no limit is exceeded by the rounding.
pub(super) fn narrow(value: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "rounded down below")]
    let rounded = value.min(f64::from(f32::MAX)) as f32;
    if f64::from(rounded) > value { rounded.next_down().max(0.0) } else { rounded }
}
