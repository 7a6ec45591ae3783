//! [`Spots`]: places where pixels hang together, counted as the pixels come, row by row.

use crate::{disjoint_sets::DisjointSets, picture::Pixel};
use core::ops::Range;

/// Pixels that hang together, with corners that touch.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Spot {
    /// Its leftmost column and its uppermost row.
    pub from: Pixel,
    /// Its rightmost column and its lowest row.
    pub to: Pixel,
    /// Its pixels.
    pub pixels: u64,
    /// The greatest error of one of them, px; 0 where none was measured.
    pub max_px: f64,
}

/// Places where something is wrong with a drawing: how many there are, how large they are together, and the
/// largest of them with their places.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Spots {
    /// How many.
    pub number: u64,
    /// Pixels of all of them.
    pub pixels: u64,
    /// The largest, at most [`Spots::TOLD`], the largest first; of equal ones the upper, then the left one.
    pub largest: Vec<Spot>,
}

impl Spots {
    /// So many are told with their places: as many as a person looks at.
    pub const TOLD: usize = 16;

    /// Both together; what touches in both stays two.
    #[must_use]
    pub fn and(mut self, other: Self) -> Self {
        other.largest.into_iter().for_each(|spot| self.keep(spot));
        self.number = self.number.saturating_add(other.number);
        self.pixels = self.pixels.saturating_add(other.pixels);
        self
    }

    fn add(&mut self, spot: Spot) {
        self.number += 1;
        self.pixels += spot.pixels;
        self.keep(spot);
    }

    /// Keeps a spot if it is among the largest.
    fn keep(&mut self, spot: Spot) {
        let rank = |spot: &Spot| (core::cmp::Reverse(spot.pixels), spot.from.y, spot.from.x);
        let place = self.largest.partition_point(|before| rank(before) <= rank(&spot));
        if place < Self::TOLD {
            self.largest.insert(place, spot);
            self.largest.truncate(Self::TOLD);
        }
    }
}

/// Neighbouring pixels of a row of the picture, and the greatest of their errors, px.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SpotRun {
    pub(crate) y: u32,
    pub(crate) columns: Range<u32>,
    pub(crate) max_px: f64,
}

/// Adds a pixel to runs that come in reading order.
pub(crate) fn add_pixel(runs: &mut Vec<SpotRun>, at: Pixel, error_px: f64) {
    match runs.last_mut() {
        Some(run) if run.y == at.y && run.columns.end == at.x => {
            run.columns.end += 1;
            run.max_px = run.max_px.max(error_px);
        }
        _ => runs.push(SpotRun { y: at.y, columns: at.x..at.x + 1, max_px: error_px }),
    }
}

/// Puts runs together, which come in reading order. Memory: that of the spots of two rows.
#[derive(Clone, Debug, Default)]
pub(crate) struct SpotTally {
    done: Spots,
    /// The row that is being read.
    y: u32,
    /// Runs of the row above it and of itself, and to which of `open` they belong.
    above: Vec<(Range<u32>, usize)>,
    here: Vec<(Range<u32>, usize)>,
    /// Spots that these belong to; the one at a root holds what hangs together.
    open: Vec<Spot>,
    sets: DisjointSets,
    /// Runs above that lie left of all that comes.
    passed: usize,
}

impl SpotTally {
    pub(crate) fn of(runs: impl IntoIterator<Item = SpotRun>) -> Spots {
        let mut tally = Self::default();
        runs.into_iter().for_each(|run| tally.add(&run));
        tally.finish()
    }

    pub(crate) fn add(&mut self, SpotRun { y, columns, max_px }: &SpotRun) {
        if *y != self.y {
            self.end_row();
            if *y != self.y + 1 {
                self.end_row(); // nothing goes on over a row without any
            }
            self.y = *y;
        }
        let own = self.sets.push();
        self.open.push(Spot {
            from: Pixel::new(columns.start, *y),
            to: Pixel::new(columns.end.saturating_sub(1), *y),
            pixels: u64::from(columns.end - columns.start),
            max_px: *max_px,
        });
        // Corners touch, so a run reaches a pixel beyond its ends.
        while self.above.get(self.passed).is_some_and(|(before, _)| before.end < columns.start) {
            self.passed += 1;
        }
        for (before, spot) in self.above.get(self.passed..).unwrap_or(&[]) {
            if before.start > columns.end {
                break;
            }
            self.sets.join(own, *spot);
        }
        self.here.push((columns.clone(), own));
    }

    pub(crate) fn finish(mut self) -> Spots {
        self.end_row();
        self.end_row();
        self.done
    }

    /// The row that was read is the one above now; spots that do not touch it are whole.
    fn end_row(&mut self) {
        let mut whole: Vec<Option<Spot>> = vec![None; self.open.len()];
        for (index, part) in self.open.iter().enumerate() {
            if let Some(spot) = whole.get_mut(self.sets.root(index)) {
                *spot = Some(spot.map_or(*part, |spot| together(spot, *part)));
            }
        }
        let (mut open, mut place) = (Vec::new(), vec![None; whole.len()]);
        for (run, own) in &mut self.here {
            let root = self.sets.root(*own);
            if let Some(slot) = place.get_mut(root) {
                *own = *slot.get_or_insert_with(|| {
                    open.extend(whole.get_mut(root).and_then(Option::take));
                    open.len().saturating_sub(1)
                });
            }
            debug_assert!(run.start < run.end, "a run has pixels");
        }
        whole.into_iter().flatten().for_each(|spot| self.done.add(spot));
        self.sets.begin_again(open.len());
        (self.open, self.passed) = (open, 0);
        self.above = core::mem::take(&mut self.here);
    }
}

/// Two parts of a spot as one.
fn together(a: Spot, b: Spot) -> Spot {
    Spot {
        from: Pixel::new(a.from.x.min(b.from.x), a.from.y.min(b.from.y)),
        to: Pixel::new(a.to.x.max(b.to.x), a.to.y.max(b.to.y)),
        pixels: a.pixels + b.pixels,
        max_px: a.max_px.max(b.max_px),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{Bitmap, runs::ink_runs};

    fn spots(picture: &str) -> Spots {
        let ink = Bitmap::from_picture(picture).unwrap();
        let rows = (0..ink.height()).flat_map(|y| ink_runs(ink.row(y)).map(move |columns| (y, columns)));
        SpotTally::of(rows.map(|(y, columns)| SpotRun { y, columns, max_px: 0.5 * f64::from(y) }))
    }

    #[test]
    fn what_hangs_together_by_a_corner_is_one_spot() {
        let found = spots("##....#\n..#..#.\n...##..\n.......\n#......\n");
        let whole = Spot { from: Pixel::new(0, 0), to: Pixel::new(6, 2), pixels: 7, max_px: 1.0 };
        let dot = Spot { from: Pixel::new(0, 4), to: Pixel::new(0, 4), pixels: 1, max_px: 2.0 };
        assert_eq!(found, Spots { number: 2, pixels: 8, largest: vec![whole, dot] });
    }

    #[test]
    fn a_comb_and_its_teeth_become_one_where_they_meet_and_rows_without_any_part() {
        assert_eq!(spots("#.#.#\n#.#.#\n#####\n").number, 1);
        assert_eq!(spots("#####\n#.#.#\n#.#.#\n").number, 1);
        assert_eq!(spots("#####\n.....\n#####\n").number, 2);
        assert_eq!(spots("#...#\n#...#\n").number, 2);
        assert_eq!(spots("...\n...\n"), Spots::default());
    }

    #[test]
    fn the_largest_are_told_and_all_are_counted() {
        let row: String = (1..=20).map(|size| "#".repeat(size) + ".").collect();
        let found = spots(&(row + "\n"));
        assert_eq!((found.number, found.pixels, found.largest.len()), (20, 210, Spots::TOLD));
        let sizes: Vec<u64> = found.largest.iter().map(|spot| spot.pixels).collect();
        assert_eq!(sizes, (5..=20).rev().collect::<Vec<_>>());
        // In two parts as in one.
        let half = |sizes: core::ops::RangeInclusive<usize>| {
            spots(&(sizes.map(|size| "#".repeat(size) + ".").collect::<String>() + "\n"))
        };
        let both = half(1..=9).and(half(10..=20));
        assert_eq!((both.number, both.pixels), (20, 210));
        assert_eq!(both.largest.iter().map(|spot| spot.pixels).collect::<Vec<_>>(), sizes);
    }

    #[test]
    fn pixels_become_runs() {
        let mut runs = Vec::new();
        for (x, y) in [(3, 0), (4, 0), (6, 0), (7, 1)] {
            add_pixel(&mut runs, Pixel::new(x, y), f64::from(x));
        }
        let run = |y, columns, max_px| SpotRun { y, columns, max_px };
        assert_eq!(runs, [run(0, 3..5, 4.0), run(0, 6..7, 6.0), run(1, 7..8, 7.0)]);
    }
}
