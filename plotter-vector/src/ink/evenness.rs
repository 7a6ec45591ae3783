//! [`Evenness`]: whether one level tells ink from paper all over a picture.

use crate::ink::grain::Grain;
use crate::picture::histogram::otsu;
use crate::picture::{Gray, Histogram};

/// Pixels that are looked at, about: rows of a larger picture are left out, evenly.
const LOOKED_AT: u64 = 1 << 21;

/// Smaller pictures have too few rims to count, px: one level is taken.
const LEAST_PIXELS: u64 = 1 << 12;

/// Least distance of the mean ink from the mean paper, levels: below it noise blurs what is counted here.
const LEAST_CONTRAST: f64 = 60.0;

/// Places between the mean ink and the mean paper, in parts of the way, where the lines must have as many
/// rims as at the level itself, and by how many parts they may differ. Near the ink's own levels grain shows
/// first. What is paler than the last is no line beside that ink, but specks, ruling, and what shines
/// through.
const BETWEEN: [(f64, f64); 6] =
    [(0.1, 0.06), (0.2, 0.04), (0.3, 0.04), (0.4, 0.04), (0.5, 0.04), (0.6, 0.06)];

/// Lines with fewer ink pixels a pair of rims, about their width, are thin: not all are as dark as the ink,
/// and only from here on, towards the paper, their rims count.
const THIN_PX: f64 = 1.6;
const PALE_SIDE: f64 = 0.5;

/// And by so many square roots of their number: what chance adds to rims in noise.
const CHANCE: f64 = 1.5;

/// How far from its mean the paper's outer quarter begins at most, as a part of the contrast: light that
/// falls off puts it far.
const PAPER_SPREADS: f64 = 0.15;

/// A jump between two levels with no change beside it, within a quarter of its own, is a side of an enlarged
/// pixel. A camera and a scanner make none of less than the whole contrast. Jumps of fewer levels than this
/// do not count.
const LEAST_JUMP: u8 = 24;
const CHANGE_BESIDE: u8 = 4;

/// From so many of all jumps on, of which at least so many are no whole contrast, a picture is enlarged.
const LONELY: f64 = 0.6;
const PARTIAL: f64 = 0.15;
const WHOLE_CONTRAST: f64 = 0.75;

/// Counts, for each level, the neighbours in rows and columns between which it lies: the rims of lines there.
///
/// A line that is darker than the paper has its two rims at whichever level between them one looks: so the
/// number is the same all over the gap. Noise and grain add rims, faint lines add theirs to the levels near
/// the paper only, and a shadow takes the paper over the level.
#[derive(Clone, Debug)]
pub(crate) struct Evenness {
    every: u32,
    pixels: u64,
    /// The row above one that is looked at.
    above: Vec<u8>,
    /// How many more rims a level has than the one before.
    more: [i64; 256],
    looked_at: u64,
    jumps: u64,
    /// Jumps with no change beside them, by their levels.
    lonely: [u64; 256],
    grain: Grain,
}

impl Evenness {
    pub(crate) fn new(width: u32, height: u32) -> Self {
        let pixels = u64::from(width) * u64::from(height);
        let every = u32::try_from(pixels / LOOKED_AT).unwrap_or(u32::MAX).saturating_add(1);
        Self {
            every,
            pixels,
            above: Vec::new(),
            more: [0; 256],
            looked_at: 0,
            jumps: 0,
            lonely: [0; 256],
            grain: Grain::new(),
        }
    }

    /// Of all of a picture.
    pub(crate) fn of(gray: &Gray) -> Self {
        let mut evenness = Self::new(gray.width(), gray.height());
        (0..).zip(gray.rows()).for_each(|(y, row)| evenness.push(y, row));
        evenness
    }

    /// Row `y` of the picture.
    pub(crate) fn push(&mut self, y: u32, levels: &[u8]) {
        self.grain.push(levels, y.wrapping_sub(Grain::BEHIND).is_multiple_of(self.every));
        let is_above = y.wrapping_add(1).is_multiple_of(self.every);
        if y.is_multiple_of(self.every) {
            self.look_at(levels);
        }
        if is_above {
            self.above.clear();
            self.above.extend_from_slice(levels);
        }
    }

    fn look_at(&mut self, levels: &[u8]) {
        self.looked_at += levels.len() as u64;
        let mut add = |level: u8, n: i64| {
            if let Some(more) = self.more.get_mut(usize::from(level)) {
                *more += n;
            }
        };
        let across = levels.iter().zip(levels.iter().skip(1));
        for (one, other) in across.chain(levels.iter().zip(&self.above)).filter(|(one, other)| one != other) {
            add(*one.min(other), 1);
            add(*one.max(other), -1);
        }
        for four in levels.windows(4) {
            let [before, one, other, after] = *four else { continue };
            let jump = one.abs_diff(other);
            if jump < LEAST_JUMP {
                continue;
            }
            self.jumps += 1;
            let beside = before.abs_diff(one).max(other.abs_diff(after));
            if beside <= jump / CHANGE_BESIDE
                && let Some(n) = self.lonely.get_mut(usize::from(jump))
            {
                *n += 1;
            }
        }
    }

    /// Whether the picture was enlarged, each of its own pixels to a block.
    #[expect(clippy::cast_precision_loss, reason = "a picture's pixels")]
    pub(crate) fn is_enlarged(&self, contrast: f64) -> bool {
        let lonely: u64 = self.lonely.iter().sum();
        let partial: u64 = (0_u16..)
            .zip(self.lonely)
            .filter(|(jump, _)| f64::from(*jump) < WHOLE_CONTRAST * contrast)
            .map(|(_, n)| n)
            .sum();
        lonely as f64 > LONELY * self.jumps as f64 && partial as f64 > PARTIAL * lonely as f64
    }

    /// Whether the strokes have pits half as deep as the contrast, given how much of the picture is ink.
    #[expect(clippy::cast_precision_loss, reason = "a picture's pixels")]
    pub(crate) fn is_grainy(&self, ink_is_dark: bool, contrast: f64, ink_pixels: u64) -> bool {
        let part = self.looked_at as f64 / self.pixels.max(1) as f64;
        let paper_pixels = self.pixels.saturating_sub(ink_pixels);
        self.grain.is_grainy(ink_is_dark, contrast, ink_pixels as f64 * part, paper_pixels as f64 * part)
    }

    /// Whether one level serves, for a picture with these levels.
    #[expect(clippy::cast_precision_loss, reason = "a picture's pixels")]
    pub(crate) fn is_even(&self, histogram: &Histogram) -> bool {
        let counts = histogram.counts();
        let (Some(level), false) = (otsu(&counts, 0), self.pixels < LEAST_PIXELS) else { return true };
        let levels = || (0_u16..).zip(counts);
        let mean = |is_dark: bool| {
            let class = || levels().filter(move |(at, _)| (*at <= u16::from(level)) == is_dark);
            let pixels: u64 = class().map(|(_, n)| n).sum();
            (class().map(|(at, n)| f64::from(at) * n as f64).sum::<f64>() / pixels.max(1) as f64, pixels)
        };
        let ((dark, dark_pixels), (light, light_pixels)) = (mean(true), mean(false));
        let contrast = light - dark;
        if contrast < LEAST_CONTRAST {
            return false;
        }
        let rims_at = |level: u8| self.more.iter().take(usize::from(level) + 1).sum::<i64>() as f64;
        let rims = rims_at(level);
        let light_paper = light_pixels >= dark_pixels;
        let ink_of_all = dark_pixels.min(light_pixels);
        let ink_pixels = ink_of_all as f64 * self.looked_at as f64 / self.pixels as f64;
        let is_thin = ink_pixels < THIN_PX * rims / 2.0;
        let are_same = BETWEEN.iter().all(|(part, differ)| {
            if is_thin && *part < PALE_SIDE {
                return true;
            }
            let part = if light_paper { *part } else { 1.0 - part };
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between two levels")]
            let between = (dark + contrast * part) as u8;
            (rims_at(between) - rims).abs() <= differ * rims + CHANCE * libm::sqrt(rims.max(0.0))
        });
        // The quarter of the paper that is nearest to the ink.
        let (paper, pixels) = if light_paper { (light, light_pixels) } else { (dark, dark_pixels) };
        let mut outer = 0;
        let mut is_outer = |n: u64| {
            outer += n;
            4 * outer >= pixels
        };
        let from = if light_paper {
            levels().skip(usize::from(level) + 1).find(|(_, n)| is_outer(*n))
        } else {
            (0_u16..=u16::from(level))
                .rev()
                .zip(counts.iter().copied().take(usize::from(level) + 1).rev())
                .find(|(_, n)| is_outer(*n))
        };
        let quarter = from.map_or(paper, |(at, _)| f64::from(at));
        are_same
            && !self.is_enlarged(contrast)
            && !self.is_grainy(light_paper, contrast, ink_of_all)
            && (quarter - paper).abs() <= PAPER_SPREADS * contrast
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a picture of 100 x 100 px of these levels is even.
    fn is_even(level: impl Fn(u32, u32) -> u8) -> bool {
        let mut histogram = Histogram::default();
        let mut evenness = Evenness::new(100, 100);
        for y in 0..100 {
            let row: Vec<u8> = (0..100).map(|x| level(x, y)).collect();
            histogram.push(&row);
            evenness.push(y, &row);
        }
        evenness.is_even(&histogram)
    }

    #[test]
    fn black_lines_on_white_are_even_and_so_are_grey_rims() {
        assert!(is_even(|x, _| if x % 20 == 7 { 0 } else { 255 }));
        assert!(is_even(|x, _| match x % 20 {
            7 => 10,
            6 | 8 => 130,
            _ => 250,
        }));
        assert!(is_even(|_, _| 77));
    }

    #[test]
    fn enlarged_pixels_are_seen() {
        let own = |x: u32, y: u32| match (x + y) % 12 {
            5 => 20,
            4 | 6 => 140,
            _ => 250,
        };
        assert!(is_even(own));
        for k in [2, 3, 5] {
            assert!(!is_even(|x, y| own(x / k, y / k)), "{k}");
        }
    }

    #[test]
    fn a_pale_line_a_shadow_and_noise_are_not() {
        // Half of the lines are half as dark.
        assert!(!is_even(|x, _| match x % 40 {
            7..10 => 0,
            27..30 => 130,
            _ => 255,
        }));
        // The light falls off to a half, and ink with it.
        let shadow = |x: u32| u8::try_from(255 - x * 5 / 4).unwrap();
        assert!(!is_even(|x, _| if x % 20 == 7 { shadow(x) / 2 } else { shadow(x) }));
        let noise = |x: u32, y: u32| u8::try_from((x * 37 + y * 101) % 97).unwrap();
        assert!(!is_even(|x, y| if x % 20 == 7 { 40 } else { 120 } + noise(x, y)));
    }
}
