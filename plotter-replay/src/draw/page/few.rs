//! [`Few`]: every so-manyth of a long list, and [`Longest`]: the greatest of it.

use core::cmp::Reverse;
use std::collections::BinaryHeap;

/// The entries 0, n, 2n, … of a list, with n doubled whenever there would be too many.
#[derive(Clone, Debug)]
pub(super) struct Few<T> {
    most: usize,
    every: u64,
    count: u64,
    kept: Vec<T>,
}

impl<T> Few<T> {
    pub(super) fn new(most: usize) -> Self {
        Self { most: most.max(2), every: 1, count: 0, kept: Vec::new() }
    }

    pub(super) fn push(&mut self, entry: T) {
        if self.count.is_multiple_of(self.every) {
            if self.kept.len() >= self.most {
                let mut keep = [true, false].into_iter().cycle();
                self.kept.retain(|_| keep.next().unwrap_or(true));
                self.every = self.every.saturating_mul(2);
            }
            if self.count.is_multiple_of(self.every) {
                self.kept.push(entry);
            }
        }
        self.count = self.count.saturating_add(1);
    }

    pub(super) fn kept(&self) -> &[T] {
        &self.kept
    }

    /// Which are kept: every so-manyth.
    pub(super) fn every(&self) -> u64 {
        self.every
    }
}

/// The greatest entries of a list.
#[derive(Clone, Debug)]
pub(super) struct Longest<T> {
    most: usize,
    kept: BinaryHeap<Reverse<T>>,
    count: u64,
}

impl<T: Ord> Longest<T> {
    pub(super) fn new(most: usize) -> Self {
        Self { most, kept: BinaryHeap::new(), count: 0 }
    }

    pub(super) fn push(&mut self, entry: T) {
        self.count = self.count.saturating_add(1);
        self.kept.push(Reverse(entry));
        if self.kept.len() > self.most {
            self.kept.pop();
        }
    }

    pub(super) fn count(&self) -> u64 {
        self.count
    }

    pub(super) fn into_vec(self) -> Vec<T> {
        self.kept.into_iter().map(|Reverse(entry)| entry).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_so_manyth_is_kept() {
        let mut few = Few::new(8);
        (0..100_u32).for_each(|n| few.push(n));
        assert_eq!((few.every(), few.kept()), (16, &[0, 16, 32, 48, 64, 80, 96][..]));
    }

    #[test]
    fn the_greatest_are_kept() {
        let mut longest = Longest::new(3);
        (0..100_u32).for_each(|n| longest.push(n * 7 % 100));
        let mut kept = longest.into_vec();
        kept.sort_unstable();
        assert_eq!(kept, [97, 98, 99]);
    }
}
