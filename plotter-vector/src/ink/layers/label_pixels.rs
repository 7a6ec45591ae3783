//! Gives each pixel to its pen.
//!
//! In a first pass a table over the colours of the picture tells paper, pixels that are wholly one pen's, and
//! the rest: rims and mixtures. These are decided in a second pass by the whole pixels around them: a rim of
//! black is grey, but it lies beside black, and where yellow meets blue the pixels between are grey too, but
//! lie beside yellow and blue.

use super::bridge_gaps::grown;
use super::find_pens::{SAME, WHOLE, ink_contrast, nearest};
use super::histogram::{BINS, Histogram, LEVELS_PER_BIN, bin};
use super::mixing_line::{MixingLine, mixture};
use crate::picture::oklab::OklabTable;
use crate::{
    ink::MAX_PENS,
    picture::{Bitmap, Colour, Pixel, Rgb},
};

/// A whole pixel is nearer to its line than to any other by this much, in Oklab.
const CLEARLY: f64 = 0.03;
/// How far a whole pixel may be from its line, in Oklab.
const STRAY: f64 = 2.0 * SAME;
/// Shares from here on may be ink of a pixel that two pens share.
const LEAST_SHARE: f64 = 0.4;

/// What the colour of a bin says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Kind {
    /// Paper.
    #[default]
    Paper,
    /// Wholly the pen's of this index.
    Whole(u8),
    /// A rim or a mixture.
    Rim,
}

/// Where the colour of a bin lies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct BinLines {
    /// The pens on whose line it is, a bit each.
    on_lines: u16,
    /// The pens whose line it is near to, a bit each.
    by_lines: u16,
    /// The pen whose line is nearest.
    nearest: u8,
}

/// The ink of each pen.
pub(super) fn label(
    picture: &Colour,
    histogram: &Histogram,
    lines: &[MixingLine],
    table: &OklabTable,
) -> Vec<Bitmap> {
    let (kinds, places) = tables(histogram, lines);
    // A `Colour` has been checked against the same limits, so the empty picture below is never wrong.
    let empty = || Bitmap::new(picture.width(), picture.height()).unwrap_or_else(|_| Bitmap::empty());
    let mut rims = empty();
    let mut ink: Vec<Bitmap> = lines.iter().map(|_| empty()).collect();
    for (y, row) in (0..).zip(picture.rows()) {
        for (word, pixels) in row.chunks(64).enumerate() {
            let mut bits = [0_u64; MAX_PENS];
            let mut rim = 0_u64;
            for (at, pixel) in pixels.iter().enumerate() {
                match kinds.get(bin(*pixel)).copied().unwrap_or_default() {
                    Kind::Paper => {}
                    Kind::Whole(pen) => {
                        if let Some(bits) = bits.get_mut(usize::from(pen)) {
                            *bits |= 1 << at;
                        }
                    }
                    Kind::Rim => rim |= 1 << at,
                }
            }
            if let Some(slot) = rims.row_mut(y).get_mut(word) {
                *slot = rim;
            }
            for (bitmap, bits) in ink.iter_mut().zip(bits).filter(|(_, bits)| *bits != 0) {
                if let Some(slot) = bitmap.row_mut(y).get_mut(word) {
                    *slot = bits;
                }
            }
        }
    }
    let mut near = Vec::new();
    if lines.len() > 1 {
        keep_supported(&mut ink, &mut rims);
        near.extend(ink.iter().map(|whole| grown(&grown(whole))));
    }
    let judge = Judge { lines, near: &near, places: &places, table };
    for at in rims.ink() {
        let pen = picture.pixel(at.x, at.y).and_then(|colour| judge.pen(at, colour));
        if let Some(bitmap) = pen.and_then(|pen| ink.get_mut(pen)) {
            bitmap.set(at, true);
        }
    }
    ink
}

/// What the colour of each bin says, and where it lies.
fn tables(histogram: &Histogram, lines: &[MixingLine]) -> (Vec<Kind>, Vec<BinLines>) {
    let mut kinds = vec![Kind::Paper; BINS];
    let mut places = vec![BinLines::default(); BINS];
    let least_contrast = ink_contrast(histogram) / 2.0;
    let least_share = if lines.len() > 1 { LEAST_SHARE } else { 0.5 };
    for entry in histogram.entries.iter().filter(|entry| entry.contrast >= least_contrast) {
        let may_be_ink =
            |line: &MixingLine| line.share(entry.mean) + line.share_step(LEVELS_PER_BIN - 1) >= least_share;
        if !lines.iter().any(may_be_ink) {
            continue;
        }
        let Some((pen, beside)) = nearest(lines, entry.mean, entry.oklab) else { continue };
        let (mut on_lines, mut by_lines) = (0_u16, 0_u16);
        let mut clear = true;
        for (other, line) in lines.iter().enumerate() {
            let distance = line.distance(entry.mean, entry.oklab);
            on_lines |= u16::from(distance <= SAME) << other;
            by_lines |= u16::from(distance <= STRAY) << other;
            clear &= other == pen || distance >= beside + CLEARLY;
        }
        let share = lines.get(pen).map_or(0.0, |line| line.share(entry.mean));
        let whole = share >= WHOLE && (lines.len() == 1 || (clear && beside <= STRAY));
        let index = u8::try_from(pen).unwrap_or(0);
        if let Some(slot) = kinds.get_mut(entry.bin) {
            *slot = if whole { Kind::Whole(index) } else { Kind::Rim };
        }
        if let Some(slot) = places.get_mut(entry.bin) {
            *slot = BinLines { on_lines, by_lines, nearest: index };
        }
    }
    (kinds, places)
}

/// Makes rims of the whole pixels that have fewer than three neighbours of their own pen: a few pixels where
/// two pens cross may have a third one's colour.
fn keep_supported(whole: &mut [Bitmap], rims: &mut Bitmap) {
    for bitmap in whole {
        let copy = bitmap.clone();
        for y in 0..copy.height() {
            let above = y.checked_sub(1).map_or(&[][..], |above| copy.row(above));
            let (here, below) = (copy.row(y), copy.row(y + 1));
            let word = |row: &[u64], at: Option<usize>| at.and_then(|at| row.get(at)).copied().unwrap_or(0);
            for at in (0..here.len()).filter(|at| word(here, Some(*at)) != 0) {
                let sides = |row: &[u64]| {
                    let middle = word(row, Some(at));
                    let left = middle << 1 | word(row, at.checked_sub(1)) >> 63;
                    let right = middle >> 1 | word(row, Some(at + 1)) << 63;
                    [left, middle, right]
                };
                let ([a, b, c], [d, own, e], [f, g, h]) = (sides(above), sides(here), sides(below));
                // Three or more of eight, counted in parallel: `one` and `two` are the bits of the sum,
                // `more` says that it has gone beyond three.
                let (mut one, mut two, mut more) = (0_u64, 0_u64, 0_u64);
                for neighbour in [a, b, c, d, e, f, g, h] {
                    let carry = one & neighbour;
                    one ^= neighbour;
                    more |= two & carry;
                    two ^= carry;
                }
                let lonely = own & !(more | (one & two));
                if let Some(bits) = bitmap.row_mut(y).get_mut(at) {
                    *bits &= !lonely;
                }
                if let Some(bits) = rims.row_mut(y).get_mut(at) {
                    *bits |= lonely;
                }
            }
        }
    }
}

/// Decides about rims.
struct Judge<'a> {
    lines: &'a [MixingLine],
    /// Within 2 px of the whole pixels of each pen; none when there is one pen.
    near: &'a [Bitmap],
    places: &'a [BinLines],
    table: &'a OklabTable,
}

impl Judge<'_> {
    /// The pen of a rim or mixture; `None` where more than half of it is paper.
    fn pen(&self, at: Pixel, colour: Rgb) -> Option<usize> {
        let place = self.places.get(bin(colour.0)).copied().unwrap_or_default();
        let nearest = usize::from(place.nearest);
        let near = self.near.iter().enumerate().filter(|(_, near)| near.get(at));
        let near: u16 = near.map(|(pen, _)| 1 << pen).sum();
        // A rim of a pen beside it.
        let rim_of = near & place.on_lines;
        let alone = match rim_of.count_ones() {
            0 if near == 0 => Some(nearest),
            0 => None,
            1 => Some(rim_of.trailing_zeros() as usize),
            _ => self.closest(rim_of, colour),
        };
        if let Some(pen) = alone {
            return self.half(pen, colour);
        }
        // A mixture of two pens beside it.
        if let Some((pen, share)) = self.mixed(near, near, colour) {
            return (share >= 0.5).then_some(pen);
        }
        // What is on no line, which a smeared rim may be, goes to a pen beside it if that is likely; or it is
        // a mixture with a pen that has no whole pixel here.
        if place.on_lines == 0 {
            if let Some(pen) = self.closest(near & place.by_lines, colour) {
                return self.half(pen, colour);
            }
            if let Some((pen, share)) = self.mixed(near, u16::MAX, colour) {
                return (share >= 0.5).then_some(pen);
            }
        }
        self.half(nearest, colour)
    }

    /// The pen, if it covers half of the pixel.
    fn half(&self, pen: usize, colour: Rgb) -> Option<usize> {
        self.lines.get(pen)?.covers_half(colour).then_some(pen)
    }

    /// The pen of a set whose line is nearest.
    fn closest(&self, pens: u16, colour: Rgb) -> Option<usize> {
        let oklab = self.table.oklab(colour);
        let distance = |pen: &usize| self.lines.get(*pen).map_or(1.0, |line| line.distance(colour, oklab));
        let pens = (0..self.lines.len()).filter(|pen| pens & 1 << pen != 0);
        pens.min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// The two pens, one of each set, that make the colour best: the one with the larger share, and their
    /// shares' sum.
    fn mixed(&self, ones: u16, others: u16, colour: Rgb) -> Option<(usize, f64)> {
        let oklab = self.table.oklab(colour);
        let of = |pens: u16| self.lines.iter().enumerate().filter(move |(pen, _)| pens & 1 << pen != 0);
        let mut best: Option<(f64, usize, f64)> = None;
        for (pen, line) in of(ones) {
            // A pair of the same set is asked once.
            for (other_pen, other) in of(others).filter(|(other, _)| *other > pen || ones & 1 << other == 0) {
                let ([share, other_share], made) = mixture(line, other, colour);
                let beside = self.table.oklab(made).distance(oklab);
                if beside <= SAME && best.is_none_or(|(least, ..)| beside < least) {
                    best = Some((
                        beside,
                        if share >= other_share { pen } else { other_pen },
                        share + other_share,
                    ));
                }
            }
        }
        best.map(|(_, pen, share)| (pen, share))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_lonely_pixels_are_not_whole() {
        let mut whole = [Bitmap::from_picture("##...\n##...\n....#\n#...#\n").unwrap()];
        let mut rims = Bitmap::new(5, 4).unwrap();
        keep_supported(&mut whole, &mut rims);
        assert_eq!(whole[0].to_string(), "##...\n##...\n.....\n.....\n");
        assert_eq!(rims.to_string(), ".....\n.....\n....#\n#...#\n");
    }
}
