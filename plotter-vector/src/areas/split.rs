//! [`split_by_width`]: areas and lines of one picture, told apart by their width.

use super::Opening;
use super::disc::index;
use crate::picture::Bitmap;

/// Widest line that can be asked for, px: 10.8 mm at 1200 dots per inch. Wider ones act as this one.
pub const MAX_LINE_PX: u32 = 512;

/// Ink in two parts: each ink pixel is in exactly one of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WidthSplit {
    /// Areas: to be outlined or hatched.
    pub thick: Bitmap,
    /// Lines: to be drawn along their centres. One that runs into an area touches it.
    pub thin: Bitmap,
}

/// Longest leftover that an area keeps, px: half a side of the disc, so that corners down to 60° stay whole.
pub(super) const fn absorbed_px(line_px: u32) -> u32 {
    (line_px + 1).div_ceil(2)
}

/// Splits ink into areas wider than `max_line_px` and lines.
///
/// An area is what a disc of `max_line_px` + 1 px covers that is moved about inside the ink (a morphological
/// *opening*), and what is left around it: corners, slivers and hairs whose farthest pixel is at most half
/// the disc's side away from it. Leftovers that go on farther are lines, from the very edge of the disc's
/// area. So:
///
/// * `thick | thin` is the ink and `thick & thin` is empty;
/// * a straight line of up to `max_line_px` px, in any direction, is thin all along, unless an area is near;
/// * a disc 3 px wider than `max_line_px` is thick (most are that are 1 px wider: it depends on where the
///   centre lies), but for the outermost 2 px where a line runs into it.
///
/// Where lines cross, the ink is wider than each of them (1.41 times at a right angle): to keep crossings out
/// of the areas, ask for 1.5 times the widest line. With 0, all ink is thick.
///
/// Each row depends on a few rows above and below it only, so bands can be split one by one.
/// About 20 operations per word of 64 px where nothing is thick, and a few hundred per word along the edge of
/// areas.
///
/// Sources: opening, J. Serra, *Image Analysis and Mathematical Morphology* (1982), ch. II; keeping the shape
/// by growing back inside the ink, L. Vincent, "Morphological grayscale reconstruction in image analysis"
/// (1993).
///
/// ```
/// # use plotter_vector::{Bitmap, areas::split_by_width};
/// let ink = Bitmap::from_picture(
///     ".#####........\n\
///      .#############\n\
///      .#####........\n\
///      .#####........\n")?;
/// let split = split_by_width(&ink, 2);
/// assert_eq!((split.thick.count(), split.thin.count()), (20, 8));
/// # Ok::<(), plotter_vector::picture::SizeError>(())
/// ```
#[must_use]
pub fn split_by_width(ink: &Bitmap, max_line_px: u32) -> WidthSplit {
    Opening::of_lines(max_line_px).split_of(ink)
}

impl WidthSplit {
    /// Moves those thin pixels to the areas that belong to no line longer than `reach_px`.
    ///
    /// ```text
    ///   area  1 2 3 4 . . .    1 2 3: leftovers by their distance from the area, inside the ink
    ///   area  1   ▲            a line gives back what leads down to the area, one number at a step;
    ///   area  1 2              what is left and hangs together with the area stays there
    /// ```
    pub(super) fn give_leftovers_to_areas(&mut self, reach_px: u32) {
        let mut spread = Spread::new(&self.thin);
        let mut layers = Vec::new();
        let mut candidates = self.thin_words_beside_areas();
        for _ in 0..reach_px {
            let layer = Spread::step(&candidates, &self.thick, &self.thin);
            if layer.is_empty() {
                break;
            }
            self.take(&layer);
            candidates = spread.around(&layer);
            layers.push(layer);
        }
        for (below, layer) in layers.iter().enumerate().rev() {
            // Down from the layer above, and a step sideways for what lies in a line's lee; not along the
            // area's rim.
            for _ in 0..=usize::from(below > 0) {
                let lines: Vec<_> =
                    layer.iter().filter_map(|part| Spread::touching(*part, &self.thin)).collect();
                self.give_back(&lines);
            }
        }
        // A pixel at a line's side may have none behind it; with only line before it, it is no part of the
        // area.
        let stayed = |layer: &Vec<(WordIndex, u64)>| -> Vec<_> {
            layer.iter().map(|(place, bits)| (*place, bits & place.of(&self.thick))).collect()
        };
        let stayed: Vec<_> = layers.iter().skip(1).map(stayed).collect();
        stayed.iter().for_each(|layer| self.give_back(layer));
        for layer in &stayed {
            let held: Vec<_> = layer.iter().filter_map(|part| Spread::touching(*part, &self.thick)).collect();
            self.take(&held);
        }
    }

    /// Makes pixels thick.
    fn take(&mut self, pixels: &[(WordIndex, u64)]) {
        for (place, bits) in pixels {
            place.add(&mut self.thick, *bits);
            place.remove(&mut self.thin, *bits);
        }
    }

    /// Makes pixels thin.
    fn give_back(&mut self, pixels: &[(WordIndex, u64)]) {
        for (place, bits) in pixels {
            place.add(&mut self.thin, *bits);
            place.remove(&mut self.thick, *bits);
        }
    }

    /// Words with thin ink in rows at most one from a row with areas: the first step cannot reach others.
    fn thin_words_beside_areas(&self) -> Vec<WordIndex> {
        let height = self.thin.height();
        let is_thick: Vec<bool> =
            (0..height).map(|y| self.thick.row(y).iter().any(|bits| *bits != 0)).collect();
        let mut words = Vec::new();
        for y in 0..height as usize {
            let near = is_thick.get(y.saturating_sub(1)..(y + 2).min(is_thick.len())).unwrap_or(&[]);
            if near.contains(&true) {
                let row = self.thin.row(index(y)).iter().enumerate();
                words.extend(
                    row.filter(|(_, bits)| **bits != 0).map(|(word, _)| WordIndex { y: index(y), word }),
                );
            }
        }
        words
    }
}

/// A word of a picture.
#[derive(Clone, Copy, Debug)]
struct WordIndex {
    y: u32,
    word: usize,
}

impl WordIndex {
    fn of(self, picture: &Bitmap) -> u64 {
        picture.row(self.y).get(self.word).copied().unwrap_or(0)
    }

    fn add(self, picture: &mut Bitmap, pixels: u64) {
        picture.row_mut(self.y).iter_mut().skip(self.word).take(1).for_each(|bits| *bits |= pixels);
    }

    fn remove(self, picture: &mut Bitmap, pixels: u64) {
        picture.row_mut(self.y).iter_mut().skip(self.word).take(1).for_each(|bits| *bits &= !pixels);
    }
}

/// Grows a set of pixels by one pixel at a time, looking only at the words where something can change.
struct Spread {
    words: usize,
    height: u32,
    /// Round in which a word was last listed.
    listed: Vec<u32>,
    round: u32,
}

impl Spread {
    fn new(picture: &Bitmap) -> Self {
        let words = picture.row(0).len();
        let height = picture.height();
        Self { words, height, listed: vec![0; words * height as usize], round: 0 }
    }

    /// The pixels of `mask`, in the given words, that touch a pixel of `set`.
    fn step(words: &[WordIndex], set: &Bitmap, mask: &Bitmap) -> Vec<(WordIndex, u64)> {
        words.iter().filter_map(|place| Self::touching((*place, place.of(mask)), set)).collect()
    }

    /// Those of some pixels in a word that touch a pixel of `set`.
    fn touching((place, pixels): (WordIndex, u64), set: &Bitmap) -> Option<(WordIndex, u64)> {
        if pixels == 0 {
            return None;
        }
        let rows = [place.y.checked_sub(1), Some(place.y), place.y.checked_add(1)];
        let around = rows.into_iter().flatten().fold(0, |around, y| {
            let row = set.row(y);
            let bits = |word: Option<usize>| word.and_then(|word| row.get(word)).copied().unwrap_or(0);
            let own = bits(Some(place.word));
            let (left, right) = (bits(place.word.checked_sub(1)), bits(place.word.checked_add(1)));
            around | own | own << 1 | own >> 1 | left >> 63 | right << 63
        });
        (around & pixels != 0).then_some((place, around & pixels))
    }

    /// The changed words and their neighbours, each once.
    fn around(&mut self, changed: &[(WordIndex, u64)]) -> Vec<WordIndex> {
        self.round += 1;
        let mut around = Vec::new();
        for (place, _) in changed {
            for y in place.y.saturating_sub(1)..(place.y + 2).min(self.height) {
                for word in place.word.saturating_sub(1)..(place.word + 2).min(self.words) {
                    let listed = self.listed.get_mut(y as usize * self.words + word);
                    if let Some(listed) = listed.filter(|listed| **listed != self.round) {
                        *listed = self.round;
                        around.push(WordIndex { y, word });
                    }
                }
            }
        }
        around
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Pixel;
    use proptest::prelude::*;

    fn split(text: &str, max_line_px: u32) -> (String, String) {
        let split = split_by_width(&Bitmap::from_picture(text).unwrap(), max_line_px);
        (split.thick.to_string(), split.thin.to_string())
    }

    #[test]
    fn a_line_that_runs_into_an_area_stays_a_line_and_touches_it() {
        let (thick, thin) = split(
            "..............\n\
             .#####........\n\
             .#####........\n\
             .#############\n\
             .#####........\n\
             .#####........\n",
            3,
        );
        assert_eq!(
            thick,
            "..............\n\
             .#####........\n\
             .#####........\n\
             .#####........\n\
             .#####........\n\
             .#####........\n"
        );
        assert_eq!(
            thin,
            "..............\n\
             ..............\n\
             ..............\n\
             ......########\n\
             ..............\n\
             ..............\n"
        );
    }

    #[test]
    fn corners_and_short_hairs_belong_to_the_area() {
        let area = "....#.......\n\
                    .##########.\n\
                    .##########.\n\
                    .##########.\n\
                    .##########.\n\
                    .##########.\n\
                    .##########.\n\
                    .##########.\n\
                    .##########.\n\
                    .##########.\n\
                    .......#....\n";
        let (thick, thin) = split(area, 8);
        assert_eq!(thick, area);
        assert!(!thin.contains('#'));
    }

    #[test]
    fn lines_alone_come_back_as_they_are() {
        let lines = "#...#\n.#.#.\n..#..\n#####\n#####\n";
        let (thick, thin) = split(lines, 2);
        assert!(!thick.contains('#'));
        assert_eq!(thin, lines);
    }

    #[test]
    fn with_no_width_for_lines_all_ink_is_area() {
        let ink = "#..\n.##\n";
        assert_eq!(split(ink, 0).0, ink);
    }

    #[test]
    fn pictures_without_pixels_and_lines_wider_than_possible_are_fine() {
        for (width, height) in [(0, 0), (0, 3), (3, 0), (1, 1)] {
            let split = split_by_width(&Bitmap::new(width, height).unwrap(), u32::MAX);
            assert_eq!((split.thick.count(), split.thin.count()), (0, 0));
        }
    }

    /// Bars of all widths, some of them scratched out again.
    fn bars() -> impl Strategy<Value = Bitmap> {
        let bar = (0_u32..140, 0_u32..160, 1_u32..60, 1_u32..60, 0..4_u8);
        proptest::collection::vec(bar, 1..9).prop_map(|bars| {
            let mut ink = Bitmap::new(140, 160).unwrap();
            for (left, top, width, height, paper) in bars {
                for y in top..(top + height).min(160) {
                    (left..(left + width).min(140)).for_each(|x| ink.set(Pixel::new(x, y), paper != 0));
                }
            }
            ink
        })
    }

    proptest! {
        #[test]
        fn a_band_with_its_context_is_split_as_in_the_whole(
            ink in bars(),
            max_line_px in 0_u32..16,
            start in 0_u32..140,
            count in 1_u32..60,
        ) {
            let whole = split_by_width(&ink, max_line_px);
            // 24 for the disc of 25 px, 4 x 13 for what is left beside it.
            prop_assert_eq!(Opening::of_lines(24).rows_of_context(), 76);
            let context = Opening::of_lines(max_line_px).rows_of_context();
            let end = (start + count).min(ink.height());
            let (from, to) = (start.saturating_sub(context), (end + context).min(ink.height()));
            let band = split_by_width(&ink.band(from..to), max_line_px);
            prop_assert_eq!(band.thick.band(start - from..end - from), whole.thick.band(start..end));
            prop_assert_eq!(band.thin.band(start - from..end - from), whole.thin.band(start..end));
        }
    }
}
