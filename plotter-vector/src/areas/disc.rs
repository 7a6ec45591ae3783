//! [`Disc`]: a raster disc, and where it fits into ink.
//!
//! Erosion and dilation work on words of 64 px. A disc is taken column by column: all columns of one height
//! ask for the same run of rows, so the rows are joined once and shifted once a column. Words that a vertical
//! run already rules out, or that lie deep inside black, are not looked at any further.

use crate::picture::Bitmap;
use core::ops::Range;

/// Pixels in a word.
const BITS: usize = u64::BITS as usize;

/// Columns between two looks whether a row is done.
const LOOK_EVERY: usize = 4;

/// A disc of pixels in its box of `side` × `side` pixels.
#[derive(Clone, Debug)]
pub(super) struct Disc {
    side: usize,
    /// Each column's number of empty rows above the disc (below it there are as many) and the column, the
    /// shortest columns first.
    columns: Vec<(usize, usize)>,
}

/// Where a disc fits: the upper left pixel of its box, for every place at which all its pixels are ink.
#[derive(Clone, Debug)]
pub(super) struct Erosion {
    /// Upper left pixels.
    pub(super) corners: Bitmap,
    /// Rows with a place in them.
    rows: Vec<bool>,
}

impl Erosion {
    fn row(&self, y: usize) -> &[u64] {
        if self.rows.get(y) == Some(&true) { self.corners.row(index(y)) } else { &[] }
    }
}

/// A row number as pictures count it.
pub(super) fn index(y: usize) -> u32 {
    u32::try_from(y).unwrap_or(u32::MAX)
}

/// An empty picture of the same size.
pub(super) fn empty_like(ink: &Bitmap) -> Bitmap {
    // The size is one that a picture has, so it is never refused.
    Bitmap::new(ink.width(), ink.height()).unwrap_or_else(|_| Bitmap::empty())
}

impl Disc {
    /// All pixels whose centres lie within `radius_px` of the centre of one pixel.
    pub(super) fn of_radius(radius_px: f64) -> Self {
        let within = |x: usize, y: usize| {
            let (x, y) = (f64::from(index(x)), f64::from(index(y)));
            x * x + y * y <= radius_px * radius_px
        };
        let half = (1..).take_while(|x| within(*x, 0)).count();
        let height_at = |x: usize| (1..=half).take_while(|y| within(x, *y)).count();
        Self::new(2 * half + 1, |column| half - height_at(column.abs_diff(half)))
    }

    /// The smallest disc, `line_px` + 1 px across, that fits into no straight line of up to `line_px` px.
    ///
    /// In no direction are its outermost centres nearer to each other than `line_px`, and the centres of the
    /// pixels of a line that wide never lie farther apart.
    pub(super) fn wider_than_lines(line_px: u32) -> Self {
        // Twice the coordinates from the centre of the box: whole numbers whether or not the side is odd.
        let line = i64::from(line_px);
        let reach_at = |x: i64, square: i64| {
            let tallest = (0..=line).rev().step_by(2).find(|y| x * x + y * y <= square);
            tallest.unwrap_or(line % 2)
        };
        // A larger circle's columns hold a smaller one's, so the least that is wide enough lies between the
        // circle itself and the full box.
        let (mut square, mut enough) = (line * line + line % 2, 2 * line * line);
        while square < enough {
            let middle = square.midpoint(enough);
            if Self::is_as_wide_everywhere(line, |x| reach_at(x, middle)) {
                enough = middle;
            } else {
                square = middle + 1;
            }
        }
        let side = line_px as usize + 1;
        Self::new(side, |column| {
            let x = 2 * i64::from(index(column)) - line;
            usize::try_from((line - reach_at(x, square)) / 2).unwrap_or(0)
        })
    }

    /// Whether the convex hull of the columns holds the circle of radius `line` around the origin. Every edge
    /// must then pass outside of it; the box sees to left and right. Ends, at the latest, with the full box.
    fn is_as_wide_everywhere(line: i64, reach_at: impl Fn(i64) -> i64) -> bool {
        let cross = |a: (i64, i64), b: (i64, i64)| a.0 * b.1 - a.1 * b.0;
        let minus = |a: (i64, i64), b: (i64, i64)| (a.0 - b.0, a.1 - b.1);
        let mut hull: Vec<(i64, i64)> = Vec::new();
        for x in (-line..=line).step_by(2) {
            let next = (x, reach_at(x));
            while let [.., a, b] = hull.as_slice()
                && cross(minus(*b, *a), minus(next, *b)) >= 0
            {
                hull.pop();
            }
            hull.push(next);
        }
        hull.iter().zip(hull.iter().skip(1)).all(|(a, b)| {
            let (x, y) = minus(*b, *a);
            cross(*a, *b) * cross(*a, *b) >= line * line * (x * x + y * y)
        })
    }

    fn new(side: usize, margin_of: impl Fn(usize) -> usize) -> Self {
        let mut columns: Vec<_> = (0..side).map(|column| (margin_of(column), column)).collect();
        columns.sort_unstable_by(|a, b| b.cmp(a));
        Self { side, columns }
    }

    /// From the upper left pixel of the box to its centre (of an odd side), px in x and in y.
    pub(super) fn half(&self) -> u32 {
        index(self.side / 2)
    }

    /// Side of its box, px.
    pub(super) const fn side_px(&self) -> usize {
        self.side
    }

    /// Side of the box of compact ink that it fits into, at most, px.
    pub(super) fn most_px(&self) -> u32 {
        index(5 * self.side / 2)
    }

    /// How far lines are followed away from such ink, px: two widths of the widest line.
    pub(super) fn followed_px(&self) -> u32 {
        index(2 * self.side)
    }

    /// What it covers where it is moved about inside the ink (opening).
    pub(super) fn opened(&self, ink: &Bitmap) -> Bitmap {
        if self.fits(ink) { self.cover(ink, &self.places(ink)) } else { empty_like(ink) }
    }

    /// Rows and columns of the box beyond its first.
    pub(super) fn reach(&self) -> u32 {
        index(self.side.saturating_sub(1))
    }

    /// Words beyond a pixel's own that the box can reach.
    const fn pad(&self) -> usize {
        (self.side - 1) / BITS + 1
    }

    /// Where the disc fits into the ink (erosion). Outside the picture is paper.
    pub(super) fn places(&self, ink: &Bitmap) -> Erosion {
        let height = ink.height() as usize;
        let mut places = Erosion { corners: empty_like(ink), rows: vec![false; height] };
        let words = ink.row(0).len();
        let (mut out, mut scratch) = (vec![0; words], Vec::new());
        vertical_runs(ink, self.side, |y, run| {
            let any = self.fit_row(ink, y, run, &mut out, &mut scratch);
            if any {
                places.corners.row_mut(index(y)).copy_from_slice(&out);
                if let Some(row) = places.rows.get_mut(y) {
                    *row = true;
                }
            }
        });
        places
    }

    /// Whether the disc fits anywhere into the ink: the same as for [`Disc::places`], without a picture of
    /// them.
    pub(super) fn fits(&self, ink: &Bitmap) -> bool {
        let (mut any, mut scratch) = (false, Vec::new());
        let mut out = vec![0; ink.row(0).len()];
        vertical_runs(ink, self.side, |y, run| {
            if !any {
                any = self.fit_row(ink, y, run, &mut out, &mut scratch);
            }
        });
        any
    }

    /// The places in row `y`, given where ink goes on downwards for a whole side.
    fn fit_row(&self, ink: &Bitmap, y: usize, run: &[u64], out: &mut [u64], scratch: &mut Vec<u64>) -> bool {
        // The middle column is as tall as the box, so nothing fits where it does not.
        and_ahead(out, run, self.side / 2, |_, ahead| ahead);
        let inside = |word: usize| {
            let around = run.get(word..=word + self.pad());
            around.is_some_and(|around| around.iter().all(|bits| *bits == u64::MAX))
        };
        let mut done = 0;
        let is_open =
            |word: usize, out: &[u64]| out.get(word).is_some_and(|bits| *bits != 0) && !inside(word);
        while let Some((from, to)) = next_run(done..run.len(), |word| is_open(word, out)) {
            self.fit_words(ink, y, from, out.get_mut(from..to).unwrap_or(&mut []), scratch);
            done = to;
        }
        out.iter().any(|bits| *bits != 0)
    }

    /// Takes from `out`, words from word `from` on, the places where a column of the disc meets paper.
    fn fit_words(&self, ink: &Bitmap, y: usize, from: usize, out: &mut [u64], joined: &mut Vec<u64>) {
        let row = |y: usize| ink.row(index(y)).get(from..).unwrap_or(&[]);
        joined.clear();
        joined.resize((out.len() + self.pad()).min(row(y).len()), u64::MAX);
        let (mut low, mut high) = (self.side / 2, self.side / 2);
        for (margin, column) in &self.columns {
            while low > *margin {
                low -= 1;
                joined.iter_mut().zip(row(y + low)).for_each(|(joined, bits)| *joined &= bits);
            }
            while high < self.side - margin {
                joined.iter_mut().zip(row(y + high)).for_each(|(joined, bits)| *joined &= bits);
                high += 1;
            }
            and_ahead(out, joined, *column, |out, ahead| out & ahead);
            if column.is_multiple_of(LOOK_EVERY) && out.iter().all(|bits| *bits == 0) {
                return;
            }
        }
    }

    /// The ink that discs at these places cover (opening: dilation of the erosion).
    pub(super) fn cover(&self, ink: &Bitmap, places: &Erosion) -> Bitmap {
        let mut covered = empty_like(ink);
        let words = ink.row(0).len();
        // For each word how many of the last `side` rows have a place in it.
        let mut near = vec![0_u32; words];
        let mut rows_near = 0_usize;
        let mut scratch = Vec::new();
        for y in 0..ink.height() as usize {
            for (near, bits) in near.iter_mut().zip(places.row(y)) {
                *near += u32::from(*bits != 0);
            }
            rows_near += usize::from(!places.row(y).is_empty());
            let gone = y.checked_sub(self.side).map_or(&[] as &[u64], |gone| places.row(gone));
            for (near, bits) in near.iter_mut().zip(gone) {
                *near -= u32::from(*bits != 0);
            }
            rows_near -= usize::from(!gone.is_empty());
            if rows_near > 0 {
                let out = covered.row_mut(index(y));
                self.cover_row(ink.row(index(y)), places, y, &near, out, &mut scratch);
            }
        }
        covered
    }

    fn cover_row(
        &self,
        ink: &[u64],
        places: &Erosion,
        y: usize,
        near: &[u32],
        out: &mut [u64],
        scratch: &mut Vec<u64>,
    ) {
        // Discs centred on the pixels themselves cover nearly all of an area.
        let middle = self.side / 2;
        if let Some(row) = y.checked_sub(middle).map(|y| places.row(y)) {
            or_behind(out, row, 0, middle);
        }
        let is_open = |word: usize, out: &[u64]| {
            let reach = word.saturating_sub(self.pad())..=word;
            out.get(word) != ink.get(word)
                && near.get(reach).is_some_and(|near| near.iter().any(|rows| *rows > 0))
        };
        let mut done = 0;
        while let Some((from, to)) = next_run(done..ink.len(), |word| is_open(word, out)) {
            let (ink, out) = (ink.get(from..to).unwrap_or(&[]), out.get_mut(from..to).unwrap_or(&mut []));
            self.cover_words(ink, places, y, from, out, scratch);
            done = to;
        }
    }

    /// Adds to `out`, words from word `from` on, what the columns of the discs cover.
    fn cover_words(
        &self,
        ink: &[u64],
        places: &Erosion,
        y: usize,
        from: usize,
        out: &mut [u64],
        joined: &mut Vec<u64>,
    ) {
        let start = from.saturating_sub(self.pad());
        let row = |below: usize| {
            let row = y.checked_sub(below).map_or(&[] as &[u64], |y| places.row(y));
            row.get(start..).unwrap_or(&[])
        };
        joined.clear();
        joined.resize(from - start + out.len(), 0);
        let (mut low, mut high) = (self.side / 2, self.side / 2);
        for (margin, column) in &self.columns {
            while low > *margin {
                low -= 1;
                joined.iter_mut().zip(row(low)).for_each(|(joined, bits)| *joined |= bits);
            }
            while high < self.side - margin {
                joined.iter_mut().zip(row(high)).for_each(|(joined, bits)| *joined |= bits);
                high += 1;
            }
            or_behind(out, joined, from - start, *column);
            if column.is_multiple_of(LOOK_EVERY) && out == ink {
                return;
            }
        }
    }
}

/// Joins each word of `out` with the pixels `ahead_px` to the right of its own in `row`; paper beyond the
/// row's end.
fn and_ahead(out: &mut [u64], row: &[u64], ahead_px: usize, join: impl Fn(u64, u64) -> u64) {
    let shift = ahead_px % BITS;
    let row = row.get(ahead_px / BITS..).unwrap_or(&[]);
    let (inner, last) = out.split_at_mut(row.len().saturating_sub(1).min(out.len()));
    let rest = row.get(inner.len()).map_or(0, |bits| bits >> shift);
    for (out, pair) in inner.iter_mut().zip(row.windows(2)) {
        let &[low, high] = pair else { continue };
        // Shifted in two steps: a shift by all 64 bits at once is not defined.
        *out = join(*out, low >> shift | high << 1 << (BITS - 1 - shift));
    }
    for (out, ahead) in last.iter_mut().zip([rest].into_iter().chain(core::iter::repeat(0))) {
        *out = join(*out, ahead);
    }
}

/// Adds to each word of `out` the pixels `behind_px` to the left of its own in `row`, which begins `lead`
/// words earlier; paper before it.
fn or_behind(out: &mut [u64], row: &[u64], lead: usize, behind_px: usize) {
    let (skip, shift) = (behind_px / BITS, behind_px % BITS);
    let join = |low: u64, high: u64| high << shift | low >> 1 >> (BITS - 1 - shift);
    let out = out.get_mut(skip.saturating_sub(lead)..).unwrap_or(&mut []);
    let first = lead.saturating_sub(skip);
    let before = first.checked_sub(1).and_then(|before| row.get(before)).copied().unwrap_or(0);
    let row = row.get(first..).unwrap_or(&[]);
    let Some((out_first, out_rest)) = out.split_first_mut() else { return };
    *out_first |= join(before, row.first().copied().unwrap_or(0));
    for (out, pair) in out_rest.iter_mut().zip(row.windows(2)) {
        let &[low, high] = pair else { continue };
        *out |= join(low, high);
    }
    // The last word's pixels that go over its end.
    if let (Some(last), Some(over)) = (row.last(), out_rest.get_mut(row.len().saturating_sub(1))) {
        *over |= join(*last, 0);
    }
}

/// The first longest range of words for which `wanted` holds.
fn next_run(words: Range<usize>, wanted: impl Fn(usize) -> bool) -> Option<(usize, usize)> {
    let from = words.clone().find(|word| wanted(*word))?;
    Some((from, (from..words.end).find(|word| !wanted(*word)).unwrap_or(words.end)))
}

/// Calls `found` with each row in which a pixel has ink below it for `side` rows, itself among them, and with
/// the words of these pixels. Three operations a word, whatever the side.
///
/// Source: M. van Herk, "A fast algorithm for local minimum and maximum filters on rectangular and octagonal
/// kernels" (1992): a run of `side` rows is the end of one block of `side` rows and the beginning of the
/// next.
fn vertical_runs(ink: &Bitmap, side: usize, mut found: impl FnMut(usize, &[u64])) {
    let height = ink.height() as usize;
    let words = ink.row(0).len();
    let mut to_block_end = vec![0_u64; words * side];
    let mut from_block_start = vec![0_u64; words];
    let mut run = vec![0_u64; words];
    if words == 0 {
        return;
    }
    for block in (0..height).step_by(side).take_while(|block| block + side <= height) {
        // From the block's last row upwards, until nothing goes on.
        let mut below: &mut [u64] = &mut [];
        let mut first = side;
        for (row, joined) in to_block_end.chunks_exact_mut(words).enumerate().rev() {
            let ink = ink.row(index(block + row));
            let any = if row + 1 == side {
                joined.copy_from_slice(ink);
                joined.iter().fold(0, |any, bits| any | bits)
            } else {
                let rows = joined.iter_mut().zip(ink.iter().zip(below.iter()));
                rows.fold(0, |any, (joined, (ink, below))| {
                    *joined = ink & below;
                    any | *joined
                })
            };
            if any == 0 {
                break;
            }
            first = row;
            below = joined;
        }
        from_block_start.fill(u64::MAX);
        let next_block = block + side;
        for (row, joined) in to_block_end.chunks_exact(words).enumerate() {
            // A run from this row ends with row `row - 1` of the next block.
            if let Some(last) = row.checked_sub(1) {
                if next_block + last >= height {
                    break;
                }
                let rows = from_block_start.iter_mut().zip(ink.row(index(next_block + last)));
                let any = rows.fold(0, |any, (joined, ink)| {
                    *joined &= ink;
                    any | *joined
                });
                if any == 0 {
                    break;
                }
            }
            if row < first {
                continue;
            }
            let rows = run.iter_mut().zip(joined.iter().zip(&from_block_start));
            let any = rows.fold(0, |any, (run, (end, start))| {
                *run = end & start;
                any | *run
            });
            if any != 0 {
                found(block + row, &run);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Pixel;

    fn picture(disc: &Disc) -> String {
        let mut picture = Bitmap::new(index(disc.side), index(disc.side)).unwrap();
        for (margin, column) in &disc.columns {
            for y in *margin..disc.side - margin {
                picture.set(Pixel::new(index(*column), index(y)), true);
            }
        }
        picture.to_string()
    }

    #[test]
    fn a_disc_holds_the_pixels_within_its_radius() {
        assert_eq!(picture(&Disc::of_radius(0.9)), "#\n");
        assert_eq!(picture(&Disc::of_radius(1.0)), ".#.\n###\n.#.\n");
        assert_eq!(picture(&Disc::of_radius(2.3)), ".###.\n#####\n#####\n#####\n.###.\n");
    }

    #[test]
    fn a_disc_wider_than_lines_has_no_narrow_direction() {
        assert_eq!(picture(&Disc::wider_than_lines(0)), "#\n");
        assert_eq!(picture(&Disc::wider_than_lines(1)), "##\n##\n");
        // Without its corners the square of 3 px would slip through a diagonal line of √2 px.
        assert_eq!(picture(&Disc::wider_than_lines(2)), "###\n###\n###\n");
        assert_eq!(picture(&Disc::wider_than_lines(4)), ".###.\n#####\n#####\n#####\n.###.\n");
        for line_px in 0..80 {
            let disc = Disc::wider_than_lines(line_px);
            let width = |angle: f64| {
                let (sin, cos) = (libm::sin(angle), libm::cos(angle));
                let side = f64::from(index(disc.side));
                let ends = disc.columns.iter().map(|(margin, column)| {
                    let (x, y) = (f64::from(index(*column)), f64::from(index(*margin)));
                    (x * cos + y * sin).max(x * cos + (side - 1.0 - y) * sin)
                });
                2.0 * (ends.fold(f64::MIN, f64::max) - (side - 1.0) / 2.0 * (cos + sin))
            };
            let narrowest = (0..400).map(|step| width(f64::from(step) * core::f64::consts::PI / 800.0));
            let narrowest = narrowest.fold(f64::MAX, f64::min);
            assert!(narrowest >= f64::from(line_px) - 1e-9, "{line_px}: {narrowest}");
            // What sticks out most are corners on a diagonal.
            let widest = (0..400).map(|step| width(f64::from(step) * core::f64::consts::PI / 800.0));
            assert!(widest.fold(f64::MIN, f64::max) <= f64::from(line_px) + 1.42, "{line_px}");
        }
    }

    /// Erosion and opening by the definition, pixel by pixel.
    fn slow(disc: &Disc, ink: &Bitmap) -> (Bitmap, Bitmap) {
        let (mut corners, mut covered) = (empty_like(ink), empty_like(ink));
        let pixels =
            || disc.columns.iter().flat_map(|(m, x)| (*m..disc.side - m).map(|y| (index(*x), index(y))));
        for y in 0..ink.height() {
            for x in 0..ink.width() {
                if pixels().all(|(dx, dy)| ink.get(Pixel::new(x + dx, y + dy))) {
                    corners.set(Pixel::new(x, y), true);
                    pixels().for_each(|(dx, dy)| covered.set(Pixel::new(x + dx, y + dy), true));
                }
            }
        }
        (corners, covered)
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn words_give_the_same_as_single_pixels() {
        let mut state = 1_u64;
        let mut random = |below: u32| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            u32::try_from((state >> 33) % u64::from(below)).unwrap()
        };
        for (width, height) in [(200, 90), (64, 64), (130, 40), (1, 50), (50, 1)] {
            for disc in
                [0, 1, 2, 3, 6, 9].map(Disc::wider_than_lines).into_iter().chain([Disc::of_radius(34.5)])
            {
                // Black with a few holes: discs fit between them.
                let mut ink = Bitmap::new(width, height).unwrap();
                (0..height).for_each(|y| (0..width).for_each(|x| ink.set(Pixel::new(x, y), true)));
                for _ in 0..(2500 / (disc.side * disc.side)).min(60) {
                    let at = Pixel::new(random(width), random(height));
                    ink.set(at, false);
                }
                let places = disc.places(&ink);
                let (corners, covered) = slow(&disc, &ink);
                assert_eq!(places.corners, corners, "side {}", disc.side);
                assert_eq!(disc.fits(&ink), corners.count() > 0);
                assert_eq!(disc.cover(&ink, &places), covered, "side {}", disc.side);
            }
        }
    }
}
