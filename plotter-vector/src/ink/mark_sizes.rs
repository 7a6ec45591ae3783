//! [`MarkSizes`]: how large the small marks of ink are, and whether its pixels lie as if thrown at random.

use crate::picture::Bitmap;
use crate::picture::joined_runs::JoinedRuns;

/// Runs that are looked at, from the top: 44 bytes each are kept. So many are 200,000 marks at least, which
/// tell as much as all.
const MOST_RUNS: usize = 1 << 20;

/// Fewest pairs of neighbours that chance would make, for their number to tell anything: it is then within a
/// fifth of what was expected, in nearly all cases.
const LEAST_PAIRS: f64 = 30.0;

/// How far the number of pairs may be from that of chance, as a part of it. Of the thinnest line half of the
/// pixels or more have a neighbour, where pixels that cover a tenth of a sheet at random make a tenth of
/// that.
const LIKE_CHANCE: core::ops::RangeInclusive<f64> = 0.75..=1.3;

/// Counts the marks of ink, row by row.
#[derive(Clone, Debug)]
pub(crate) struct MarkSizes {
    width: u32,
    runs: JoinedRuns,
    words_above: Vec<u64>,
    ink_pixels: u64,
    /// Neighbours in rows, and in columns.
    pairs: [u64; 2],
}

/// What small marks are like.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SmallMarks {
    pub(crate) marks: usize,
    /// Standard deviation of the logarithm of their pixels: 0 where all are alike, .3 of dots that a hand
    /// makes with one pen.
    pub(crate) spread: f64,
    /// Part of them that have one pixel or two.
    pub(crate) least_part: f64,
    /// Whether neighbours are as many as pixels have that are thrown at random.
    pub(crate) as_thrown: bool,
}

impl MarkSizes {
    pub(crate) fn new(width: u32) -> Self {
        Self { width, runs: JoinedRuns::new(), words_above: Vec::new(), ink_pixels: 0, pairs: [0; 2] }
    }

    pub(crate) fn of(ink: &Bitmap) -> Self {
        let mut sizes = Self::new(ink.width());
        (0..ink.height()).for_each(|y| sizes.push(ink.row(y)));
        sizes
    }

    /// The next row.
    pub(crate) fn push(&mut self, words: &[u64]) {
        if self.runs.runs().len() >= MOST_RUNS {
            return;
        }
        self.runs.push(words);
        for (_, run) in self.runs.last_row() {
            let pixels = u64::from(run.end - run.start);
            self.ink_pixels += pixels;
            self.pairs[0] += pixels - 1;
        }
        let below =
            words.iter().zip(&self.words_above).map(|(one, other)| u64::from((one & other).count_ones()));
        self.pairs[1] += below.sum::<u64>();
        self.words_above.clear();
        self.words_above.extend_from_slice(words);
    }

    /// Those whose box is smaller than `within_px` both ways, and which have `least_px` pixels or more.
    #[expect(clippy::cast_precision_loss, reason = "a picture's pixels")]
    pub(crate) fn finish(self, within_px: u32, least_px: u32) -> SmallMarks {
        /// Pixels, and the box: left, right, top, bottom.
        type Mark = (u64, [u32; 4]);
        let rows = self.runs.rows();
        let (runs, parts) = self.runs.parts();
        let mut marks: Vec<Mark> = vec![(0, [u32::MAX, 0, u32::MAX, 0]); parts];
        for (y, run, part) in &runs {
            let Some((pixels, [left, right, top, bottom])) = marks.get_mut(*part) else { continue };
            *pixels += u64::from(run.end - run.start);
            (*left, *right) = ((*left).min(run.start), (*right).max(run.end));
            (*top, *bottom) = ((*top).min(*y), (*bottom).max(*y + 1));
        }
        let is_small = |(pixels, [left, right, top, bottom]): &&Mark| {
            *pixels >= u64::from(least_px.max(1)) && right - left < within_px && bottom - top < within_px
        };
        let (mut number, mut least, mut sum, mut squares) = (0_usize, 0_usize, 0.0, 0.0);
        for (pixels, _) in marks.iter().filter(is_small) {
            let size = libm::log(*pixels as f64);
            number += 1;
            least += usize::from(*pixels <= 2);
            (sum, squares) = (sum + size, squares + size * size);
        }
        let of = number.max(1) as f64;
        let variance = (squares / of - (sum / of) * (sum / of)).max(0.0);
        let ink = self.ink_pixels as f64;
        let by_chance = ink * ink / (f64::from(self.width) * f64::from(rows)).max(1.0);
        let as_thrown = by_chance >= LEAST_PAIRS
            && self.pairs.iter().all(|pairs| LIKE_CHANCE.contains(&(*pairs as f64 / by_chance)));
        SmallMarks { marks: number, spread: libm::sqrt(variance), least_part: least as f64 / of, as_thrown }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Pixel;
    use plotter_motion::SplitMix64;

    #[test]
    fn marks_hang_together_over_corners_and_across_rows() {
        let ink = Bitmap::from_picture("#.#..##\n.#...##\n#.#....\n.......\n...#...\n").unwrap();
        let found = MarkSizes::of(&ink).finish(4, 0);
        assert_eq!(found.marks, 3);
        assert!((found.least_part - 1.0 / 3.0).abs() < 1e-12, "{found:?}");
        assert_eq!(MarkSizes::of(&ink).finish(3, 0).marks, 2, "the cross is three px wide");
        assert_eq!(MarkSizes::of(&ink).finish(4, 2).marks, 2);
    }

    #[test]
    fn dots_are_alike_and_pixels_thrown_at_random_are_seen() {
        let (mut dots, mut thrown) = (Bitmap::new(300, 300).unwrap(), Bitmap::new(300, 300).unwrap());
        let mut random = SplitMix64::new(7);
        for (x, y) in (0..300).flat_map(|y| (0..300).map(move |x| (x, y))) {
            dots.set(Pixel::new(x, y), x % 10 < 2 && y % 10 < 2);
            thrown.set(Pixel::new(x, y), random.unit() < 0.1);
        }
        let found = MarkSizes::of(&dots).finish(5, 0);
        assert_eq!((found.marks, found.as_thrown), (900, false));
        assert!(found.spread < 1e-6, "{found:?}");
        let found = MarkSizes::of(&thrown).finish(5, 0);
        assert!(found.as_thrown && found.spread > 0.3, "{found:?}");
    }
}
