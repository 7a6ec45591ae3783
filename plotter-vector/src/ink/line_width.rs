//! [`LineWidth`]: how wide the pen was, from the ink alone.

use crate::picture::Bitmap;

/// Widest pen that is told from a filled area, px.
const WIDEST_PX: u32 = 64;

/// Widest pen, px, where areas are most of the ink, so that six times its width, up to which ink is a line,
/// is no wider than they are.
pub(crate) const WIDEST_BESIDE_AREAS_PX: u32 = WIDEST_PX / 6;

/// Runs across the lines of a pen are as long as it is wide, and up to so many hundredths of that, at 45
/// degrees.
const ACROSS_HUNDREDTHS: usize = 141;

/// Fewer of all runs than so many in a hundred tell no pen. Silhouettes of animals have 16 to 25, at any size;
/// drawings of lines, lettering, brushes, pencil and chalk 30 and more, most of them 40 to 80.
const LEAST_ACROSS: u64 = 26;

/// What is narrower, px, is a pen or so small that its width says nothing.
const LEAST_SILHOUETTE_PX: u32 = 6;

/// Finds the width of the pen from the ink of a picture, row by row from the top.
///
/// A straight line of width w that makes the angle θ with the rows is crossed by its columns in runs of w /
/// cos θ, and by its rows in runs of w / sin θ; n·cos θ columns and n·sin θ rows meet a line of n px. Short
/// runs are thus the most, and long ones (along a line, in a filled area) few. A third of all runs,
/// horizontal and vertical, are no longer than w for lines along the axes, 1.03 w for lines in all
/// directions, 1.41 w at worst, when all lie at 45°; and of a sheet with several pens it is the thinner one
/// that counts, as long as it has drawn a third of the whole. Shorter runs come from ragged edges, a tenth or
/// less. Pixels without neighbours are left out, so that salt and pepper does not count; of a sheet of
/// nothing but noise, 1 or 2 px come out.
#[derive(Clone, Debug)]
pub struct LineWidth {
    /// The row above the last one without its lonely pixels.
    settled: Vec<u64>,
    /// The last two rows as they came; of the lower one it is not yet known which pixels have neighbours.
    above: Vec<u64>,
    last: Vec<u64>,
    /// Memory for the next row.
    next: Vec<u64>,
    /// Row in which the run of a column began.
    since: Vec<u32>,
    y: u32,
    runs: Runs,
}

/// Number of runs by length; the last counts all that are longer.
#[derive(Clone, Debug)]
struct Runs([u64; WIDEST_PX as usize + 2]);

impl Runs {
    fn count(&mut self, length: u32) {
        if let Some(n) = self.0.get_mut(length.min(WIDEST_PX + 1) as usize) {
            *n += 1;
        }
    }

    /// Whether there is a width that so many of the runs are as long as a pen's would be that it may be one.
    fn tell_a_pen(&self) -> bool {
        let all: u64 = self.0.iter().sum();
        (1..=WIDEST_PX as usize).any(|width| {
            let across = self.0.get(width..=width * ACROSS_HUNDREDTHS / 100).unwrap_or(&[]);
            100 * across.iter().sum::<u64>() >= LEAST_ACROSS * all
        })
    }

    /// The length that one in `of` of all runs does not exceed, px; that of a longer run than any that is
    /// told is 65.
    fn shortest(&self, of: u64) -> Option<u32> {
        let total: u64 = self.0.iter().sum();
        let mut below = 0;
        let rank = self.0.iter().position(|n| {
            below += n;
            below > 0 && of * below >= total
        })?;
        u32::try_from(rank).ok()
    }

    /// The width of the pen.
    fn shortest_third(&self) -> Option<u32> {
        self.shortest(3)
    }
}

/// What the runs of ink tell of its lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Widths {
    /// Width of the pen, px, as of [`LineWidth::finish_beside_areas`].
    pub(crate) pen_px: Option<u32>,
    /// That of the thinnest lines, unless they are hardly any, px: a tenth of all runs is no longer.
    pub(crate) thinnest_px: Option<u32>,
    /// Whether no pen is likely to have drawn the ink, for hardly any of it is as wide: then it is the
    /// silhouette of something.
    pub(crate) is_silhouette: bool,
}

impl LineWidth {
    /// Before the first row of a picture of `width` px.
    #[must_use]
    pub fn new(width: u32) -> Self {
        let words = width.div_ceil(64) as usize;
        let row = || vec![0; words];
        Self {
            settled: row(),
            above: row(),
            last: row(),
            next: row(),
            since: vec![0; words * 64],
            y: 0,
            runs: Runs([0; WIDEST_PX as usize + 2]),
        }
    }

    /// The next row, in words as of [`Bitmap::row`]; a longer row is cut, a shorter one ends with paper.
    pub fn push(&mut self, row: &[u64]) {
        let given = row.len().min(self.next.len());
        let (words, rest) = self.next.split_at_mut(given);
        words.iter_mut().zip(row).for_each(|(to, from)| *to = *from);
        rest.fill(0);
        self.settle();
        core::mem::swap(&mut self.above, &mut self.last);
        core::mem::swap(&mut self.last, &mut self.next);
    }

    /// Width of the pen, px; `None` without ink, or when most of it is wider than 64 px.
    #[must_use]
    pub fn finish(mut self) -> Option<u32> {
        self.end();
        self.runs.shortest_third().filter(|width| *width <= WIDEST_PX)
    }

    /// Width of the pen, px, and where most of the ink is wider than 64 px that of what is not, at most 10
    /// px; `None` without any of that.
    #[must_use]
    pub fn finish_beside_areas(self) -> Option<u32> {
        self.widths().pen_px
    }

    /// The same, and what else the runs tell.
    pub(crate) fn widths(mut self) -> Widths {
        self.end();
        let width = self.runs.shortest_third().filter(|width| *width <= WIDEST_PX);
        let is_silhouette =
            width.is_some_and(|width| width >= LEAST_SILHOUETTE_PX && !self.runs.tell_a_pen());
        if width.is_none()
            && let Some(longer) = self.runs.0.last_mut()
        {
            *longer = 0;
        }
        let beside = || self.runs.shortest_third().map(|width| width.min(WIDEST_BESIDE_AREAS_PX));
        let pen_px = width.or_else(beside);
        Widths { pen_px, thinnest_px: self.runs.shortest(10).min(pen_px), is_silhouette }
    }

    /// One row of paper settles the last row, another ends its runs.
    fn end(&mut self) {
        self.push(&[]);
        self.push(&[]);
    }

    /// Takes the lonely pixels out of the last row; counts its runs, and those of columns that ended above
    /// it.
    fn settle(&mut self) {
        let Self { settled, above, last, next, since, y, runs } = self;
        let at = |row: &[u64], index: usize| row.get(index).copied().unwrap_or(0);
        // The word to the left: of the last row and those beside it, and what is kept of it.
        let (mut left, mut left_kept) = (0, 0);
        let mut run_from = 0;
        for ((index, before), columns) in (0..).zip(settled.iter_mut()).zip(since.chunks_mut(64)) {
            let (here, beside) = (at(last, index), at(above, index) | at(next, index));
            let all = here | beside;
            // Most of a sheet is paper.
            if here | *before | left_kept == 0 {
                left = all;
                continue;
            }
            let right = at(above, index + 1) | at(last, index + 1) | at(next, index + 1);
            let kept = here & (beside | all << 1 | left >> 63 | all >> 1 | right << 63);
            let first = u32::try_from(index * 64).unwrap_or(u32::MAX);
            let mut ends = kept ^ (kept << 1 | left_kept >> 63);
            while ends != 0 {
                let bit = ends.trailing_zeros();
                ends &= ends - 1;
                if kept >> bit & 1 == 1 {
                    run_from = first + bit;
                } else {
                    runs.count(first + bit - run_from);
                }
            }
            let mut changed = kept ^ *before;
            while changed != 0 {
                let bit = changed.trailing_zeros();
                changed &= changed - 1;
                if let Some(since) = columns.get_mut(bit as usize) {
                    if kept >> bit & 1 == 1 {
                        *since = *y;
                    } else {
                        runs.count(*y - *since);
                    }
                }
            }
            (*before, left, left_kept) = (kept, all, kept);
        }
        if left_kept >> 63 == 1 {
            runs.count(u32::try_from(settled.len() * 64).unwrap_or(u32::MAX) - run_from);
        }
        *y += 1;
    }
}

/// Width of the pen that drew a picture, px: [`LineWidth`] of all its rows.
///
/// ```
/// # use plotter_vector::{Bitmap, ink::pen_width_px};
/// let cross = Bitmap::from_picture("...##...\n...##...\n########\n########\n...##...\n#..##...\n")?;
/// assert_eq!(pen_width_px(&cross), Some(2));
/// # Ok::<(), plotter_vector::picture::SizeError>(())
/// ```
#[must_use]
pub fn pen_width_px(ink: &Bitmap) -> Option<u32> {
    line_width(ink).finish()
}

/// [`LineWidth`] of all rows of a picture.
fn line_width(ink: &Bitmap) -> LineWidth {
    let mut width = LineWidth::new(ink.width());
    (0..ink.height()).for_each(|y| width.push(ink.row(y)));
    width
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Pixel;

    /// A picture of 200 × 200 px, ink where the function says so.
    fn picture(is_ink: impl Fn(i32, i32) -> bool) -> Bitmap {
        let mut ink = Bitmap::new(200, 200).unwrap();
        for (x, y) in (0..200).flat_map(|y| (0..200).map(move |x| (x, y))) {
            ink.set(Pixel::new(x as u32, y as u32), is_ink(x, y));
        }
        ink
    }

    /// A hash of a place, 0 to 999.
    fn noise(x: i32, y: i32) -> i32 {
        let mut n = (x * 7919 + y * 104_729) as u32;
        n = (n ^ n >> 15).wrapping_mul(0x2c1b_3c6d);
        n = (n ^ n >> 12).wrapping_mul(0x297a_2d39);
        i32::try_from((n ^ n >> 15) % 1000).unwrap()
    }

    #[test]
    fn a_ring_is_as_wide_as_its_pen() {
        for width in 1..=9 {
            let ring = |x: i32, y: i32| {
                let (x, y) = (f64::from(x) - 100.4, f64::from(y) - 100.3);
                let radius = (x * x + y * y).sqrt();
                (radius - 70.0).abs() <= f64::from(width) / 2.0
            };
            // 1.03 times the width, and on a raster a whole number.
            let found = pen_width_px(&picture(ring)).unwrap();
            assert!((width as u32..=width as u32 + width as u32 / 7).contains(&found), "{width}: {found}");
        }
    }

    #[test]
    fn salt_and_pepper_leaves_the_width_alone() {
        // 40 % of the ink is salt.
        let lines = |x: i32, y: i32| ((y % 90 < 3 && x % 90 < 60) || noise(x, y) < 10) && noise(y, x) >= 5;
        assert_eq!(pen_width_px(&picture(lines)), Some(3));
    }

    #[test]
    fn a_filled_area_is_not_the_pen() {
        let area = |x: i32, y: i32| (x < 90 && y < 190) || (x % 30 < 4 && y < 150);
        assert_eq!(pen_width_px(&picture(area)), Some(4));
        assert_eq!(pen_width_px(&picture(|x, y| x < 90 && y < 190)), None);
    }

    #[test]
    fn of_ink_that_is_mostly_areas_the_lines_beside_them_tell_the_pen() {
        let beside = |is_ink: &dyn Fn(i32, i32) -> bool| line_width(&picture(is_ink)).finish_beside_areas();
        assert_eq!(beside(&|x, y| (y < 100) || (x == 20 && y < 190) || (x == 21 && y < 190)), Some(2));
        assert_eq!(beside(&|x, y| x < 90 && y < 190), None);
        // The rim of a disc is no pen.
        let disc = |x: i32, y: i32| (x - 100) * (x - 100) + (y - 100) * (y - 100) < 80 * 80;
        assert_eq!(beside(&disc), Some(WIDEST_BESIDE_AREAS_PX));
        assert_eq!(beside(&|x, y| x % 30 < 4 && y < 150), Some(4));
    }

    #[test]
    fn without_lines_there_is_no_width() {
        assert_eq!(pen_width_px(&picture(|_, _| false)), None);
        assert_eq!(pen_width_px(&picture(|x, y| x % 5 == 0 && y % 5 == 0)), None);
        assert_eq!(pen_width_px(&Bitmap::new(0, 5).unwrap()), None);
    }

    /// The runs of 8-connected ink of two pixels and more, one by one.
    fn plain_runs(ink: &Bitmap) -> [u64; WIDEST_PX as usize + 2] {
        let kept = |x: u32, y: u32| {
            let at = Pixel::new(x, y);
            ink.get(at) && crate::raster::continuity::neighbours(at).into_iter().any(|beside| ink.get(beside))
        };
        let mut runs = [0; WIDEST_PX as usize + 2];
        let mut along = |pixels: Vec<bool>| {
            for run in pixels.split(|kept| !kept).filter(|run| !run.is_empty()) {
                runs[run.len().min(WIDEST_PX as usize + 1)] += 1;
            }
        };
        (0..ink.height()).for_each(|y| along((0..ink.width()).map(|x| kept(x, y)).collect()));
        (0..ink.width()).for_each(|x| along((0..ink.height()).map(|y| kept(x, y)).collect()));
        runs
    }

    #[test]
    fn every_run_is_counted_once() {
        // Noise between words of ink and words of paper, and a run that ends with its row.
        for (percent, width) in [(3, 200), (25, 192), (50, 191), (80, 129), (97, 65)] {
            let mut ink = Bitmap::new(width, 90).unwrap();
            for (x, y) in (0..90).flat_map(|y| (0..width).map(move |x| (x, y))) {
                let calm = (x / 40 + y / 30) % 3;
                let noisy = noise(x.cast_signed(), y.cast_signed()) < 10 * percent;
                ink.set(Pixel::new(x, y), calm == 1 || calm == 2 && noisy);
            }
            let mut found = LineWidth::new(width);
            (0..90).for_each(|y| found.push(ink.row(y)));
            found.push(&[]);
            found.push(&[]);
            assert_eq!(found.runs.0, plain_runs(&ink), "{percent}");
        }
    }

    #[test]
    fn neighbours_are_seen_across_words() {
        for (x, y) in [(63, 5), (64, 5)] {
            let mut pair = Bitmap::new(130, 9).unwrap();
            pair.set(Pixel::new(x, y), true);
            assert_eq!(pen_width_px(&pair), None);
            pair.set(Pixel::new(127 - x, y + 1), true);
            assert_eq!(pen_width_px(&pair), Some(1));
        }
    }
}
