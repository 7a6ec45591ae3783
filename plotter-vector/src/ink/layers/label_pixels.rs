//! Gives each pixel to its pen.
//!
//! In a first pass a table over the colours of the picture tells paper, pixels that are wholly one pen's, and
//! the rest: rims and mixtures. These are decided in a second pass by the whole pixels around them: a rim of
//! black is grey, but it lies beside black, and where yellow meets blue the pixels between are grey too, but
//! lie beside yellow and blue.

use super::bridge_gaps::{grown, grown_by};
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
/// How far a colour may be from the line of a pen that has made it, in Oklab, where the pens around are known.
const MADE: f64 = 1.5 * SAME;
/// Shares from here on may be ink of a pixel that two pens share.
const LEAST_SHARE: f64 = 0.4;

/// How far rims reach beyond whole pixels, px.
const RIM_PX: u32 = 2;
/// Around a core, px, ink is its pen's, or that of others with cores as near: about two widths of a line.
const AROUND_CORES_PX: u32 = 6;

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

/// The ink of each pen. `cores` are those of each, in the middle of its lines: near them a pixel is of no other
/// pen.
pub(super) fn label(
    picture: &Colour,
    histogram: &Histogram,
    lines: &[MixingLine],
    cores: &[Bitmap],
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
    let (mut near, mut around) = (Vec::new(), Vec::new());
    if lines.len() > 1 {
        around.extend(cores.iter().map(|cores| grown_by(cores, AROUND_CORES_PX)));
        let judge = Judge { lines, near: &[], around: &around, places: &places, table };
        judge.keep_near_cores(&mut ink, &mut rims, picture);
        keep_off_rims(&mut ink, &mut rims, lines);
        keep_supported(&mut ink, &mut rims);
        let whole = ink.iter().zip(cores).map(|(whole, cores)| whole.clone().united(cores));
        near.extend(whole.map(|whole| grown_by(&whole, RIM_PX)));
    }
    let judge = Judge { lines, near: &near, around: &around, places: &places, table };
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
            let is_rim = lines.get(pen).is_some_and(|own| own.is_rim_of(line));
            clear &= other == pen || is_rim || distance >= beside + CLEARLY;
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

/// The pixels that both pictures have as ink.
fn shared(ink: Bitmap, other: &Bitmap) -> Bitmap {
    let rest = ink.clone().without(other);
    ink.without(&rest)
}

/// Moves pixels from a pen's whole ones to the rims.
fn move_to_rims(whole: &mut Bitmap, rims: &mut Bitmap, kept: Bitmap) {
    let removed = whole.clone().without(&kept);
    *rims = core::mem::replace(rims, Bitmap::empty()).united(&removed);
    *whole = kept;
}

/// Makes rims of the whole pixels of a pen beside another one whose rims have its colour.
fn keep_off_rims(whole: &mut [Bitmap], rims: &mut Bitmap, lines: &[MixingLine]) {
    let all = whole.to_vec();
    for ((pale, line), own) in lines.iter().enumerate().zip(whole) {
        let darker = lines
            .iter()
            .zip(&all)
            .enumerate()
            .filter(|(other, (darker, _))| *other != pale && line.is_rim_of(darker));
        for (_, (_, darker)) in darker {
            let apart = own.clone().without(&grown_by(darker, RIM_PX));
            let kept = shared(own.clone(), &grown(&apart));
            move_to_rims(own, rims, kept);
        }
    }
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
    /// Within some px of the cores of each pen.
    around: &'a [Bitmap],
    places: &'a [BinLines],
    table: &'a OklabTable,
}

impl Judge<'_> {
    /// The pen of a rim or mixture; `None` where more than half of it is paper.
    fn pen(&self, at: Pixel, colour: Rgb) -> Option<usize> {
        self.likely_pen(at, colour).or_else(|| {
            // What is wholly a pen's colour is ink, even where its pen is not likely; not so the rim of another.
            let nearest = usize::from(self.places.get(bin(colour.0))?.nearest);
            let line = self.lines.get(nearest).filter(|line| line.share(colour) >= WHOLE)?;
            let is_rim = self.lines.iter().any(|other| line.is_rim_of(other));
            (!is_rim && self.lines.len() > 1).then_some(nearest)
        })
    }

    /// The same, of the pens whose ink is near.
    fn likely_pen(&self, at: Pixel, colour: Rgb) -> Option<usize> {
        let place = self.places.get(bin(colour.0)).copied().unwrap_or_default();
        let nearest = usize::from(place.nearest);
        let near = self.near.iter().enumerate().filter(|(_, near)| near.get(at));
        let near: u16 = near.map(|(pen, _)| 1 << pen).sum();
        // The whole pixels near are likely, too; what none of these can have made is another one's.
        let likely = self.likely(at) | near;
        let likely = if self.can_make(likely, colour) { likely } else { u16::MAX };
        let nearest = if likely & 1 << nearest == 0 {
            self.closest(likely, colour).unwrap_or(nearest)
        } else {
            nearest
        };
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
            if let Some((pen, share)) = self.mixed(near, likely, colour) {
                return (share >= 0.5).then_some(pen);
            }
        }
        self.half(nearest, colour)
    }

    /// The pens that have cores around a place; all of them where none has.
    fn likely(&self, at: Pixel) -> u16 {
        let around = self.around.iter().enumerate().filter(|(_, around)| around.get(at));
        let around: u16 = around.map(|(pen, _)| 1 << pen).sum();
        if around == 0 { u16::MAX } else { around }
    }

    /// Makes rims of the whole pixels that have cores of other pens around them and none of their own, where
    /// these pens can have made their colour.
    fn keep_near_cores(&self, whole: &mut [Bitmap], rims: &mut Bitmap, picture: &Colour) {
        for (pen, whole) in whole.iter_mut().enumerate() {
            let strange = whole.ink().filter(|at| {
                let likely = self.likely(*at);
                likely & 1 << pen == 0
                    && picture.pixel(at.x, at.y).is_some_and(|colour| self.can_make(likely, colour))
            });
            let strange: Vec<Pixel> = strange.collect();
            for at in strange {
                whole.set(at, false);
                rims.set(at, true);
            }
        }
    }

    /// Whether one of these pens, or two of them where they meet, can have made a colour.
    fn can_make(&self, pens: u16, colour: Rgb) -> bool {
        let oklab = self.table.oklab(colour);
        let own = |line: &MixingLine| line.distance(colour, oklab) <= MADE;
        self.lines.iter().enumerate().any(|(pen, line)| pens & 1 << pen != 0 && own(line))
            || self.mixed(pens, pens, colour).is_some()
    }

    /// The pen, if it covers half of the pixel.
    fn half(&self, pen: usize, colour: Rgb) -> Option<usize> {
        self.lines.get(pen)?.covers_half(colour).then_some(pen)
    }

    /// The pen of a set whose line is nearest.
    fn closest(&self, pens: u16, colour: Rgb) -> Option<usize> {
        let oklab = self.table.oklab(colour);
        let covers = |pen: usize| self.lines.get(pen).is_some_and(|line| line.covers_half(colour));
        // Of a pen and one that has the colour of its rims, the one that covers half of the pixel.
        let hidden = |pen: usize| {
            (0..self.lines.len()).any(|other| {
                let both = self.lines.get(pen).zip(self.lines.get(other)).filter(|_| pens & 1 << other != 0);
                both.is_some_and(|(line, other_line)| {
                    line.is_rim_of(other_line) && covers(other)
                        || other_line.is_rim_of(line) && !covers(pen) && covers(other)
                })
            })
        };
        let distance = |pen: &usize| self.lines.get(*pen).map_or(1.0, |line| line.distance(colour, oklab));
        let pens = (0..self.lines.len()).filter(|pen| pens & 1 << pen != 0 && !hidden(*pen));
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
