//! [`Bitmap`]: a picture of 1 bit a pixel, and [`Pixel`], a place in it.

use core::fmt;

/// Longest side of a picture, px: 2¹⁷, or 2.7 m at 1200 dots per inch. Coordinates up to here keep every sum
/// of the simplifiers exact in `f64`.
pub const MAX_SIDE_PX: u32 = 1 << 17;

/// Most pixels of a picture: 2²⁸, that is 16 384 × 16 384, or 32 MiB as a [`Bitmap`].
pub const MAX_PIXELS: u64 = 1 << 28;

const BITS: u32 = u64::BITS;

/// Column and row of a pixel: x to the right, y **down**, (0, 0) at the upper left.
///
/// The pixel covers the square from (x, y) to (x + 1, y + 1); its centre is at (x + 0.5, y + 0.5).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Pixel {
    /// Column, from the left.
    pub x: u32,
    /// Row, from the top.
    pub y: u32,
}

impl Pixel {
    /// The pixel in column `x`, row `y`.
    #[must_use]
    pub const fn new(x: u32, y: u32) -> Self {
        Self { x, y }
    }

    /// Whether `other` is one of the eight neighbours of this pixel, or the pixel itself.
    ///
    /// ```
    /// # use plotter_vector::Pixel;
    /// assert!(Pixel::new(3, 3).touches(Pixel::new(4, 2)));
    /// assert!(!Pixel::new(3, 3).touches(Pixel::new(5, 3)));
    /// ```
    #[must_use]
    pub fn touches(self, other: Self) -> bool {
        self.x.abs_diff(other.x) <= 1 && self.y.abs_diff(other.y) <= 1
    }
}

/// A picture that would be too large to hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SizeError {
    /// Asked width, px.
    pub width: u32,
    /// Asked height, px.
    pub height: u32,
}

impl SizeError {
    /// The size itself when a picture may have it.
    pub(crate) fn check(width: u32, height: u32) -> Result<(), Self> {
        let too_long = width > MAX_SIDE_PX || height > MAX_SIDE_PX;
        if too_long || u64::from(width) * u64::from(height) > MAX_PIXELS {
            return Err(Self { width, height });
        }
        Ok(())
    }
}

impl fmt::Display for SizeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "a picture of {} x {} px is too large: at most {MAX_SIDE_PX} px a side and {MAX_PIXELS} px in all; \
             scan with fewer dots per inch or cut it into sheets",
            self.width, self.height
        )
    }
}

impl core::error::Error for SizeError {}

/// A picture of 1 bit a pixel, 64 to a word; a set bit is ink. Each row starts a new word.
///
/// Reading outside the picture gives `false` and writing there does nothing, so neighbours can be asked for
/// without a border check.
///
/// ```
/// # use plotter_vector::{Bitmap, Pixel};
/// let corner = Bitmap::from_picture("###\n#..\n")?;
/// assert!(corner.get(Pixel::new(0, 1)));
/// assert_eq!(corner.count(), 4);
/// assert_eq!(corner.to_string(), "###\n#..\n");
/// # Ok::<(), plotter_vector::picture::SizeError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Bitmap {
    width: u32,
    height: u32,
    words_per_row: usize,
    words: Vec<u64>,
}

/// Word of the row, and the bit's mask in it.
fn place(x: u32) -> (usize, u64) {
    ((x / BITS) as usize, 1 << (x % BITS))
}

impl Bitmap {
    /// An empty picture.
    ///
    /// # Errors
    /// [`SizeError`] above [`MAX_SIDE_PX`] or [`MAX_PIXELS`]; a picture without pixels is allowed.
    pub fn new(width: u32, height: u32) -> Result<Self, SizeError> {
        SizeError::check(width, height)?;
        let words_per_row = width.div_ceil(BITS) as usize;
        Ok(Self { width, height, words_per_row, words: vec![0; words_per_row * height as usize] })
    }

    /// A picture without pixels.
    #[must_use]
    pub(crate) const fn empty() -> Self {
        Self { width: 0, height: 0, words_per_row: 0, words: Vec::new() }
    }

    /// Reads a picture drawn in text: a line a row, `#` is ink, anything else is paper; short rows are filled
    /// with paper on the right.
    ///
    /// # Errors
    /// [`SizeError`] as for [`Bitmap::new`].
    pub fn from_picture(text: &str) -> Result<Self, SizeError> {
        let longest = text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
        let width = u32::try_from(longest).unwrap_or(u32::MAX);
        let height = u32::try_from(text.lines().count()).unwrap_or(u32::MAX);
        let mut bitmap = Self::new(width, height)?;
        for (y, line) in (0..).zip(text.lines()) {
            for (x, _) in (0..).zip(line.chars()).filter(|(_, mark)| *mark == '#') {
                bitmap.set(Pixel::new(x, y), true);
            }
        }
        Ok(bitmap)
    }

    /// Number of columns.
    #[must_use]
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Number of rows.
    #[must_use]
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// Whether the pixel is ink; `false` outside the picture.
    #[must_use]
    pub fn get(&self, at: Pixel) -> bool {
        let (word, mask) = place(at.x);
        self.inside(at) && self.row(at.y).get(word).is_some_and(|bits| bits & mask != 0)
    }

    /// Makes the pixel ink or paper; without effect outside the picture.
    pub fn set(&mut self, at: Pixel, ink: bool) {
        let (word, mask) = place(at.x);
        if !self.inside(at) {
            return;
        }
        if let Some(bits) = self.row_mut(at.y).get_mut(word) {
            *bits = if ink { *bits | mask } else { *bits & !mask };
        }
    }

    /// Number of ink pixels.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.words.iter().map(|bits| u64::from(bits.count_ones())).sum()
    }

    /// The ink pixels, row by row from the top, in each row from the left. Empty words cost one comparison.
    pub fn ink(&self) -> impl Iterator<Item = Pixel> + '_ {
        (0..self.height).flat_map(move |y| {
            (0..).step_by(BITS as usize).zip(self.row(y)).flat_map(move |(x, bits)| {
                let rest = core::iter::successors(Some(*bits), |bits| Some(bits & (bits.wrapping_sub(1))));
                rest.take_while(|bits| *bits != 0).map(move |bits| Pixel::new(x + bits.trailing_zeros(), y))
            })
        })
    }

    /// The words of row `y`, the leftmost pixel in the lowest bit; empty outside the picture. Bits right of
    /// the picture are never set.
    #[must_use]
    pub fn row(&self, y: u32) -> &[u64] {
        let start = y as usize * self.words_per_row;
        self.words.get(start..start + self.words_per_row).unwrap_or(&[])
    }

    /// As [`Bitmap::row`], to write; the caller keeps the bits right of the picture clear.
    pub(crate) fn row_mut(&mut self, y: u32) -> &mut [u64] {
        let start = y as usize * self.words_per_row;
        self.words.get_mut(start..start + self.words_per_row).unwrap_or(&mut [])
    }

    /// All rows from the top, as [`Bitmap::row_mut`].
    pub(crate) fn rows_mut(&mut self) -> impl Iterator<Item = &mut [u64]> {
        self.words.chunks_mut(self.words_per_row.max(1))
    }

    /// A picture of these rows; the bits right of it are clear. Missing words are paper.
    pub(crate) fn of_words(width: u32, height: u32, mut words: Vec<u64>) -> Self {
        let words_per_row = width.div_ceil(BITS) as usize;
        words.resize(words_per_row * height as usize, 0);
        Self { width, height, words_per_row, words }
    }

    /// The words of all rows.
    pub(crate) fn into_words(self) -> Vec<u64> {
        self.words
    }

    /// A copy of some rows.
    pub(crate) fn band(&self, rows: core::ops::Range<u32>) -> Self {
        self.band_in(rows, &mut Vec::new())
    }

    /// A copy of some rows, made of the memory of `words`.
    pub(crate) fn band_in(&self, rows: core::ops::Range<u32>, words: &mut Vec<u64>) -> Self {
        let rows = rows.start.min(self.height)..rows.end.min(self.height);
        let at = |y: u32| y as usize * self.words_per_row;
        let own = self.words.get(at(rows.start)..at(rows.end)).unwrap_or(&[]);
        let mut words = core::mem::take(words);
        words.clear();
        words.reserve_exact(own.len());
        words.extend_from_slice(own);
        Self { height: rows.end.saturating_sub(rows.start), words, ..*self }
    }

    /// The ink that another picture of the same size has not; beside one of another size all of it.
    pub(crate) fn without(mut self, other: &Self) -> Self {
        if (self.width, self.height) == (other.width, other.height) {
            for (bits, less) in self.words.iter_mut().zip(&other.words) {
                *bits &= !less;
            }
        }
        self
    }

    /// The ink of both of two pictures of one size; of pictures of other sizes that of the first.
    pub(crate) fn united(mut self, other: &Self) -> Self {
        if (self.width, self.height) == (other.width, other.height) {
            for (bits, more) in self.words.iter_mut().zip(&other.words) {
                *bits |= more;
            }
        }
        self
    }

    /// The leftmost ink pixel in a word of a row.
    pub(crate) fn first_of_word(&self, y: u32, word: usize) -> Option<Pixel> {
        let bits = *self.row(y).get(word).filter(|bits| **bits != 0)?;
        Some(Pixel::new(u32::try_from(word).ok()? * BITS + bits.trailing_zeros(), y))
    }

    /// The first ink pixel of the row `y` or below.
    pub(crate) fn first_from(&self, y: u32) -> Option<Pixel> {
        (y..self.height()).find_map(|y| {
            let word = self.row(y).iter().position(|bits| *bits != 0)?;
            self.first_of_word(y, word)
        })
    }

    /// How many ink pixels follow each other to the left and to the right of a pixel, at most `most`.
    pub(crate) fn run_level(&self, at: Pixel, most: u32) -> (u32, u32) {
        let row = self.row(at.y);
        let ((word, _), bit) = (place(at.x), at.x % BITS);
        let here = row.get(word).copied().unwrap_or(0);
        let (mut left, mut right) =
            ((here << (BITS - 1 - bit) << 1).leading_ones(), (here >> bit >> 1).trailing_ones());
        if left == bit {
            for bits in row.get(..word).unwrap_or(&[]).iter().rev() {
                left += bits.leading_ones();
                if *bits != u64::MAX || left >= most {
                    break;
                }
            }
        }
        if right == BITS - 1 - bit {
            for bits in row.get(word + 1..).unwrap_or(&[]) {
                right += bits.trailing_ones();
                if *bits != u64::MAX || right >= most {
                    break;
                }
            }
        }
        (left.min(most), right.min(most))
    }

    /// How many ink pixels follow each other above and below a pixel, at most `most`.
    pub(crate) fn run_upright(&self, at: Pixel, most: u32) -> (u32, u32) {
        let (word, mask) = place(at.x);
        let is_ink = |index: usize| self.words.get(index).is_some_and(|bits| bits & mask != 0);
        let here = at.y as usize * self.words_per_row + word;
        let (mut up, mut down) = (0, 0);
        let mut index = here;
        while let Some(above) =
            index.checked_sub(self.words_per_row).filter(|above| up < most && is_ink(*above))
        {
            (index, up) = (above, up + 1);
        }
        index = here + self.words_per_row;
        while down < most && is_ink(index) {
            (index, down) = (index + self.words_per_row, down + 1);
        }
        (up, down)
    }

    /// The eight neighbours of a pixel, a bit each: right, lower right, below, lower left, left, upper left,
    /// above, upper right, from the lowest bit on.
    pub(crate) fn around(&self, at: Pixel) -> u8 {
        let ((word, _), bit) = (place(at.x), at.x % BITS);
        let inner = word < self.words_per_row && (1..BITS - 1).contains(&bit);
        // Three pixels of a row, the left one in the lowest bit.
        let three = |y: u32| -> u8 {
            if inner {
                let bits = self.words.get(y as usize * self.words_per_row + word).copied().unwrap_or(0);
                return u8::try_from(bits >> (bit - 1) & 0b111).unwrap_or(0);
            }
            let row = self.row(y);
            let here = row.get(word).copied().unwrap_or(0);
            let window = if bit == 0 {
                let left = word.checked_sub(1).and_then(|word| row.get(word)).map_or(0, |bits| bits >> 63);
                here << 1 | left
            } else if bit == 63 {
                let right = row.get(word + 1).map_or(0, |bits| bits & 1);
                here >> 62 | right << 2
            } else {
                here >> (bit - 1)
            };
            u8::try_from(window & 0b111).unwrap_or(0)
        };
        let above = at.y.checked_sub(1).map_or(0, three);
        let (here, below) = (three(at.y), at.y.checked_add(1).map_or(0, three));
        here >> 2
            | below >> 2 << 1
            | (below >> 1 & 1) << 2
            | (below & 1) << 3
            | (here & 1) << 4
            | (above & 1) << 5
            | (above >> 1 & 1) << 6
            | above >> 2 << 7
    }

    fn inside(&self, at: Pixel) -> bool {
        at.x < self.width && at.y < self.height
    }
}

/// The picture in text, `#` for ink and `.` for paper: the inverse of [`Bitmap::from_picture`].
impl fmt::Display for Bitmap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for y in 0..self.height {
            for x in 0..self.width {
                f.write_str(if self.get(Pixel::new(x, y)) { "#" } else { "." })?;
            }
            f.write_str("\n")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outside_is_paper_and_cannot_be_written() {
        let mut dot = Bitmap::from_picture("#").unwrap();
        for outside in [Pixel::new(1, 0), Pixel::new(0, 1), Pixel::new(63, 0), Pixel::new(u32::MAX, u32::MAX)]
        {
            assert!(!dot.get(outside));
            dot.set(outside, true);
        }
        assert_eq!(dot.count(), 1);
    }

    #[test]
    fn ink_is_found_across_words_in_reading_order() {
        let mut wide = Bitmap::new(200, 2).unwrap();
        let marks =
            [Pixel::new(0, 0), Pixel::new(63, 0), Pixel::new(64, 0), Pixel::new(199, 0), Pixel::new(5, 1)];
        for mark in marks {
            wide.set(mark, true);
        }
        assert_eq!(wide.ink().collect::<Vec<_>>(), marks);
        wide.set(Pixel::new(64, 0), false);
        assert_eq!(wide.count(), 4);
    }

    #[test]
    fn a_picture_too_large_is_refused_before_memory_is_taken() {
        assert_eq!(Bitmap::new(1 << 18, 1), Err(SizeError { width: 1 << 18, height: 1 }));
        let error = Bitmap::new(MAX_SIDE_PX, MAX_SIDE_PX).unwrap_err();
        assert!(error.to_string().starts_with("a picture of 131072 x 131072 px is too large"));
    }

    #[test]
    fn runs_are_measured_across_words() {
        let mut cross = Bitmap::new(400, 9).unwrap();
        (50..300).for_each(|x| cross.set(Pixel::new(x, 4), true));
        (1..9).for_each(|y| cross.set(Pixel::new(130, y), true));
        for x in [50, 63, 64, 127, 128, 191, 192, 298, 299] {
            assert_eq!(cross.run_level(Pixel::new(x, 4), 999), (x - 50, 299 - x));
            assert_eq!(cross.run_level(Pixel::new(x, 4), 20), ((x - 50).min(20), (299 - x).min(20)));
        }
        // Beside a run, in the open, and beside the border.
        assert_eq!(cross.run_level(Pixel::new(49, 4), 999), (0, 250));
        assert_eq!(cross.run_level(Pixel::new(300, 4), 999), (250, 0));
        assert_eq!(cross.run_level(Pixel::new(0, 0), 9), (0, 0));
        assert_eq!(cross.run_level(Pixel::new(399, 8), 9), (0, 0));
        assert_eq!(cross.run_upright(Pixel::new(130, 4), 99), (3, 4));
        assert_eq!(cross.run_upright(Pixel::new(130, 4), 2), (2, 2));
        assert_eq!(cross.run_upright(Pixel::new(60, 3), 99), (0, 1));
        assert_eq!(cross.run_upright(Pixel::new(0, 0), 99), (0, 0));
    }

    #[test]
    fn a_picture_without_pixels_is_a_picture() {
        assert_eq!(Bitmap::new(0, 7).unwrap().ink().count(), 0);
        assert_eq!(Bitmap::from_picture("").unwrap().to_string(), "");
    }
}
