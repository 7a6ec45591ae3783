//! [`JoinedRuns`]: runs of ink, and which of them hang together.

use super::Bitmap;
use super::runs::ink_runs;
use crate::disjoint_sets::DisjointSets;
use core::ops::Range;

/// A run of ink: its row and columns, and the number of its part.
pub(crate) type PartRun = (u32, Range<u32>, usize);

/// The runs of ink of some rows, joined where they touch, over corners, too.
#[derive(Clone, Debug)]
pub(crate) struct JoinedRuns {
    /// Row and columns of each.
    runs: Vec<(u32, Range<u32>)>,
    sets: DisjointSets,
    /// Those of the last row.
    above: Range<usize>,
    rows: u32,
}

impl JoinedRuns {
    /// Before the first row.
    pub(crate) fn new() -> Self {
        Self { runs: Vec::new(), sets: DisjointSets::new(0), above: 0..0, rows: 0 }
    }

    /// Of a whole picture.
    pub(crate) fn of(ink: &Bitmap) -> Self {
        let mut joined = Self::new();
        (0..ink.height()).for_each(|y| joined.push(ink.row(y)));
        joined
    }

    /// The next row.
    pub(crate) fn push(&mut self, words: &[u64]) {
        let first = self.runs.len();
        let mut from = self.above.start;
        for run in ink_runs(words) {
            let own = self.sets.push();
            // A run that ends where this one begins touches it over a corner.
            while let Some((_, upper)) = self.runs.get(from).filter(|_| from < self.above.end) {
                if upper.start > run.end {
                    break;
                }
                if upper.end >= run.start {
                    self.sets.join_to_lower(from, own);
                }
                if upper.end > run.end {
                    break;
                }
                from += 1;
            }
            self.runs.push((self.rows, run));
        }
        self.above = first..self.runs.len();
        self.rows += 1;
    }

    /// The runs so far.
    pub(crate) fn runs(&self) -> &[(u32, Range<u32>)] {
        &self.runs
    }

    /// Those of the last row.
    pub(crate) fn last_row(&self) -> &[(u32, Range<u32>)] {
        self.runs.get(self.above.clone()).unwrap_or(&[])
    }

    /// Rows so far.
    pub(crate) const fn rows(&self) -> u32 {
        self.rows
    }

    /// The runs with the number of the part that each belongs to, in the order of the parts' first runs, and
    /// how many parts there are.
    pub(crate) fn parts(mut self) -> (Vec<PartRun>, usize) {
        let mut numbers = vec![usize::MAX; self.runs.len()];
        let (mut parts, mut numbered) = (0, Vec::with_capacity(self.runs.len()));
        for (index, (y, run)) in self.runs.into_iter().enumerate() {
            // The lowest of its set, so no later run numbers it first.
            let Some(number) = numbers.get_mut(self.sets.root(index)) else { continue };
            if *number == usize::MAX {
                *number = parts;
                parts += 1;
            }
            numbered.push((y, run, *number));
        }
        (numbered, parts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_that_touch_over_a_side_or_a_corner_are_one_part() {
        let ink = Bitmap::from_picture("#.#..##\n.#...##\n#.#....\n.......\n...#...\n").unwrap();
        let (runs, parts) = JoinedRuns::of(&ink).parts();
        let numbers: Vec<usize> = runs.iter().map(|(.., part)| *part).collect();
        assert_eq!((numbers, parts), (vec![0, 0, 1, 0, 1, 0, 0, 2], 3));
        assert_eq!(runs.last(), Some(&(4, 3..4, 2)));
    }
}
