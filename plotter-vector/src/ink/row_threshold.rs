//! [`Survey`] and [`RowThreshold`]: a threshold for pictures that come row by row.

use crate::ink::evened::Evened;
use crate::ink::evenness::Evenness;
use crate::ink::illumination::{Light, TileRow, Tiles};
use crate::parallel::each;
use crate::picture::histogram::half_covered;
use crate::{
    ink::{Polarity, Split, Threshold, ThresholdMethod},
    picture::{Gray, Histogram, Row},
};

/// The first pass over a picture, row by row from the top: what must be known of all of it before the first
/// pixel can be told.
///
/// It holds one row of tiles at most, [`Threshold::window_px`] × 3 / 2 rows of the picture, and for
/// [`ThresholdMethod::Otsu`] and a fixed level no row at all.
#[derive(Clone, Debug)]
pub(crate) struct Survey {
    threshold: Threshold,
    width: usize,
    rows_left: u32,
    histogram: Histogram,
    tiles: Tiles,
    /// Rows of a row of tiles that is not yet complete.
    levels: Vec<u8>,
    measured: Vec<TileRow>,
    seen: Seen,
    /// Of grey levels, where the method is found from them.
    evenness: Option<Evenness>,
    height: u32,
}

/// The second pass: ink of one row after another, in any order.
///
/// Made by [`Survey::finish`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct RowThreshold {
    level: u8,
    ink_is_dark: bool,
    light: Option<Light>,
    has_greys: bool,
    half_covered: u64,
}

/// Half covered pixels are rims where they are more than one in so many of the ink: not where noise, or a
/// stain, is all that a drawing of black and white has of grey.
const RIM_OF_INK: u64 = 20;

impl Survey {
    /// Before the first row of a picture of `width` × `height` px, a size that has been checked.
    pub(crate) fn checked(threshold: Threshold, width: u32, height: u32) -> Self {
        let Threshold { polarity, window_px, min_contrast, method, .. } = threshold;
        let evenness = (method == ThresholdMethod::Auto).then(|| Evenness::new(width, height));
        Self {
            evenness,
            height,
            threshold,
            width: width as usize,
            rows_left: height,
            histogram: Histogram::default(),
            tiles: Tiles::new(width, height, window_px, polarity, min_contrast),
            levels: Vec::new(),
            measured: Vec::new(),
            seen: Seen::default(),
        }
    }

    /// The levels of the next row. A longer row is cut, a shorter one filled with its last level (an empty
    /// one with white); rows below the picture are ignored.
    pub(crate) fn push(&mut self, levels: &[u8]) {
        let Some(rows_left) = self.rows_left.checked_sub(1) else {
            return;
        };
        self.rows_left = rows_left;
        let levels = levels.get(..self.width).unwrap_or(levels);
        let missing = self.width - levels.len();
        let last = levels.last().copied().unwrap_or(u8::MAX);
        self.seen.push(levels);
        if let Some(evenness) = &mut self.evenness {
            evenness.push(self.height - rows_left - 1, levels);
        }
        self.histogram.push(levels);
        self.histogram.add(last, missing as u64);
        if self.threshold.method == ThresholdMethod::Adaptive {
            self.levels.extend_from_slice(levels);
            self.levels.resize(self.levels.len() + missing, last);
            if self.tiles.levels_of_row(self.measured.len()) == Some(self.levels.len()) {
                self.measured.push(self.tiles.measure(&self.levels));
                self.levels.clear();
            }
        }
    }

    /// The next row, of either kind: a black bit is level 0, a white one 255.
    pub(crate) fn push_row(&mut self, row: Row<'_>) {
        match (row, self.threshold.method) {
            (Row::Grey(levels), _) => self.push(levels),
            (Row::Bits(words), ThresholdMethod::Adaptive) => self.push(&levels_of(words, self.width)),
            (Row::Bits(words), _) => {
                let Some(rows_left) = self.rows_left.checked_sub(1) else {
                    return;
                };
                self.rows_left = rows_left;
                let black = words.iter().map(|bits| u64::from(bits.count_ones())).sum();
                self.histogram.add(0, black);
                self.histogram.add(u8::MAX, (self.width as u64).saturating_sub(black));
            }
        }
    }

    /// All rows at once, instead of [`Survey::push`].
    pub(crate) fn push_all(&mut self, levels: &[u8]) {
        self.seen.push(levels);
        if let Some(evenness) = &mut self.evenness {
            (0..).zip(levels.chunks(self.width.max(1))).for_each(|(y, row)| evenness.push(y, row));
        }
        self.histogram = whole_histogram(levels);
        if self.threshold.method == ThresholdMethod::Adaptive {
            let mut rest = levels;
            let rows = (0..).map_while(|row| {
                let (these, below) = rest.split_at_checked(self.tiles.levels_of_row(row)?)?;
                rest = below;
                Some(these)
            });
            self.measured = measure_all(self.tiles, rows.collect());
        }
        self.rows_left = 0;
    }

    /// Whether no single level tells the ink, as far as all rows say, and the picture is small enough to be
    /// evened.
    pub(crate) fn is_uneven(&self) -> bool {
        let pixels = self.width as u64 * u64::from(self.height);
        pixels <= Evened::MAX_PIXELS && self.needs_more_than_a_level()
    }

    /// The same of a picture of any size.
    pub(crate) fn needs_more_than_a_level(&self) -> bool {
        self.evenness
            .as_ref()
            .is_some_and(|evenness| self.seen.has_greys && !evenness.is_even(&self.histogram))
    }

    /// What is ink, now that all rows are known; `None` for an empty sheet (one level, or below the least
    /// contrast). Rows that never came count as nothing.
    #[must_use]
    pub(crate) fn finish(mut self) -> Option<RowThreshold> {
        let Threshold { polarity, method, min_contrast, .. } = self.threshold;
        let has_greys = self.seen.has_greys;
        let half_covered = half_covered(&self.histogram.counts());
        let level = match method {
            ThresholdMethod::Auto | ThresholdMethod::Otsu => self.histogram.otsu(min_contrast)?,
            ThresholdMethod::Level(level) => level,
            ThresholdMethod::Adaptive => {
                if !self.levels.is_empty() {
                    self.measured.push(self.tiles.measure(&self.levels));
                }
                let light = self.tiles.finish(self.measured)?;
                let (level, ink_is_dark) = (light.level, light.ink_is_dark);
                return Some(RowThreshold {
                    level,
                    ink_is_dark,
                    light: Some(light),
                    has_greys,
                    half_covered,
                });
            }
        };
        let counts = self.histogram.counts();
        let (dark, light) = counts.split_at(usize::from(level) + 1);
        let ink_is_dark = match polarity {
            Polarity::Minority => dark.iter().sum::<u64>() <= light.iter().sum(),
            Polarity::DarkInk => true,
            Polarity::LightInk => false,
        };
        Some(RowThreshold { level, ink_is_dark, light: None, has_greys, half_covered })
    }
}

impl RowThreshold {
    /// Whether the dark side is ink.
    #[must_use]
    pub(crate) const fn ink_is_dark(&self) -> bool {
        self.ink_is_dark
    }

    /// What was decided, with the number of ink pixels that it makes.
    pub(crate) const fn split(&self, ink_pixels: u64) -> Split {
        let Self { level, ink_is_dark, has_greys, .. } = *self;
        Split { level, ink_is_dark, has_greys, ink_pixels }
    }

    /// As [`Split::has_greys`].
    pub(crate) const fn has_greys(&self) -> bool {
        self.has_greys
    }

    /// Whether many a pixel of the ink's rims is about half covered: the lines are drawn with grey levels, or
    /// scanned.
    pub(crate) const fn has_rims(&self, ink_pixels: u64) -> bool {
        self.half_covered * RIM_OF_INK > ink_pixels
    }

    /// Whether the ink of a picture of 1 bit a pixel is its black everywhere.
    pub(crate) const fn black_is_ink(&self) -> bool {
        self.light.is_none() && self.ink_is_dark && self.level < u8::MAX
    }

    /// As [`RowThreshold::row`], of a row of either kind of a picture of `width` px.
    pub(crate) fn ink_of(&self, y: u32, row: Row<'_>, width: u32, ink: &mut [u64]) {
        let words = match row {
            Row::Grey(levels) => return self.row(y, levels, ink),
            Row::Bits(words) if self.light.is_some() => {
                return self.row(y, &levels_of(words, width as usize), ink);
            }
            Row::Bits(words) => words,
        };
        let is_ink = |level: u8| (level <= self.level) == self.ink_is_dark;
        let of = |is_ink: bool| if is_ink { u64::MAX } else { 0 };
        let (black, white) = (of(is_ink(0)), of(is_ink(u8::MAX)));
        let mut left = width;
        for (ink, bits) in ink.iter_mut().zip(words) {
            let inside = if left < u64::BITS { !(u64::MAX << left) } else { u64::MAX };
            *ink = (bits & black | !bits & white) & inside;
            left = left.saturating_sub(u64::BITS);
        }
    }

    /// Writes the ink of row `y`, 64 px a word, the leftmost in the lowest bit, as
    /// [`Bitmap::row`](crate::picture::Bitmap::row) gives it. Levels beyond the words are ignored, words
    /// beyond the levels are paper.
    pub(crate) fn row(&self, y: u32, levels: &[u8], ink: &mut [u64]) {
        match (&self.light, self.ink_is_dark) {
            (None, true) => pack(levels, ink, |level| level <= self.level),
            (None, false) => pack(levels, ink, |level| level > self.level),
            (Some(light), dark) => pack_by(levels, &light.ink_levels(y), if dark { 0 } else { u8::MAX }, ink),
        }
    }
}

/// As [`RowThreshold::has_rims`], of a picture in memory.
pub(crate) fn has_rims(gray: &Gray, ink_pixels: u64) -> bool {
    half_covered(&whole_histogram(gray.pixels()).counts()) * RIM_OF_INK > ink_pixels
}

/// The levels that were seen.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    /// The first two of them; twice the same as long as there is but one.
    first: Option<[u8; 2]>,
    /// Whether there are more than two.
    has_greys: bool,
}

impl Seen {
    fn push(&mut self, levels: &[u8]) {
        // Most scans have many at once; of the others parts of 64 are looked at together.
        let mut parts = levels.chunks(64);
        while !self.has_greys
            && let Some(part) = parts.next()
        {
            let [one, other] = *self.first.get_or_insert([part.first().copied().unwrap_or_default(); 2]);
            let is_new = |level: &u8| *level != one && *level != other;
            if part.iter().fold(false, |any, level| any | is_new(level)) {
                let mut new = part.iter().copied().filter(is_new);
                let second = if one == other { new.next() } else { None };
                self.has_greys = new.any(|level| Some(level) != second);
                self.first = Some([one, second.unwrap_or(other)]);
            }
        }
    }
}

/// The levels of a row of bits: a set one is black.
fn levels_of(words: &[u64], width: usize) -> Vec<u8> {
    let bits = words.iter().flat_map(|word| (0..u64::BITS).map(move |bit| word >> bit & 1 == 1));
    bits.take(width).map(|black| if black { 0 } else { u8::MAX }).collect()
}

fn whole_histogram(levels: &[u8]) -> Histogram {
    let parts = each(levels.chunks(1 << 20).collect(), |levels| {
        let mut histogram = Histogram::default();
        histogram.push(levels);
        histogram
    });
    let mut all = Histogram::default();
    parts.iter().for_each(|part| all.merge(part));
    all
}

fn measure_all(tiles: Tiles, rows: Vec<&[u8]>) -> Vec<TileRow> {
    each(rows, |levels| tiles.measure(levels))
}

/// Eight bytes of 0 or 1 gathered into the eight lowest bits, the first in the lowest: bit 8·k is moved to
/// bit 56 + k by the factor's bit 56 − 7·k, and no two products meet there.
fn gather(marks: [u8; 8]) -> u64 {
    u64::from_le_bytes(marks).wrapping_mul(0x0102_0408_1020_4080) >> 56
}

/// The word of 64 marks of 0 or 1.
fn word(marks: &[u8; 64]) -> u64 {
    let (eights, _) = marks.as_chunks::<8>();
    eights.iter().rev().fold(0, |word, marks| word << 8 | gather(*marks))
}

fn pack(levels: &[u8], ink: &mut [u64], is_ink: impl Fn(u8) -> bool) {
    let (full, rest) = levels.as_chunks::<64>();
    let mut marks = [0; 64];
    let mut words = ink.iter_mut();
    for (levels, ink) in full.iter().zip(&mut words) {
        for (mark, level) in marks.iter_mut().zip(levels) {
            *mark = u8::from(is_ink(*level));
        }
        *ink = word(&marks);
    }
    if let Some(ink) = words.next() {
        marks.fill(0);
        for (mark, level) in marks.iter_mut().zip(rest) {
            *mark = u8::from(is_ink(*level));
        }
        *ink = word(&marks);
    }
    words.for_each(|ink| *ink = 0);
}

/// As [`pack`], with a number of ink levels for each pixel; `flip` of all ones inverts the levels first.
fn pack_by(levels: &[u8], ink_levels: &[u8], flip: u8, ink: &mut [u64]) {
    let mut marks = [0; 64];
    let parts = levels.chunks(64).zip(ink_levels.chunks(64)).map(Some);
    for (ink, part) in ink.iter_mut().zip(parts.chain(core::iter::repeat(None))) {
        *ink = part.map_or(0, |(levels, ink_levels)| {
            if let (Ok(levels), Ok(ink_levels)) =
                (<&[u8; 64]>::try_from(levels), <&[u8; 64]>::try_from(ink_levels))
            {
                for ((mark, level), n) in marks.iter_mut().zip(levels).zip(ink_levels) {
                    *mark = u8::from(level ^ flip < *n);
                }
            } else {
                marks.fill(0);
                for ((mark, level), n) in marks.iter_mut().zip(levels).zip(ink_levels) {
                    *mark = u8::from(level ^ flip < *n);
                }
            }
            word(&marks)
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_mark_comes_to_its_bit() {
        for bit in 0..64 {
            let mut marks = [0; 64];
            marks[bit] = 1;
            assert_eq!(word(&marks), 1 << bit);
            marks = [1; 64];
            marks[bit] = 0;
            assert_eq!(word(&marks), !(1 << bit));
        }
    }

    #[test]
    fn rows_of_another_length_stay_inside_their_words() {
        for method in [ThresholdMethod::Level(100), ThresholdMethod::Adaptive] {
            let mut survey = Survey::checked(Threshold { method, ..Threshold::default() }, 70, 2);
            survey.push(&[[0; 9].as_slice(), &[200; 61]].concat());
            survey.push(&[200; 100]);
            survey.push(&[0; 70]);
            let rows = survey.finish().unwrap();
            let mut words = [u64::MAX; 3];
            rows.row(0, &[0; 70], &mut words);
            assert_eq!(words, [u64::MAX, 0b11_1111, 0]);
            rows.row(7, &[], &mut words);
            assert_eq!(words, [0; 3]);
        }
    }

    #[test]
    fn missing_rows_count_as_nothing() {
        for method in [ThresholdMethod::Otsu, ThresholdMethod::Adaptive] {
            let mut survey = Survey::checked(Threshold { method, ..Threshold::default() }, 4, 100);
            survey.push(&[0, 255, 255, 255]);
            assert!(survey.finish().unwrap().ink_is_dark());
            let nothing = Survey::checked(Threshold { method, ..Threshold::default() }, 4, 100);
            assert_eq!(nothing.finish(), None);
        }
    }
}
