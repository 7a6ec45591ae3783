//! [`Threshold`]: which pixels are ink.
//!
//! A scan is dark lines on light paper, or light lines on a dark ground (a blueprint, a photograph's negative).
//! Otsu's level splits the 256 grey levels in two; the *searched colour* is the one that covers less, for
//! lines are always the minority.

use crate::{Bitmap, Gray};

/// Which side of the level is ink.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Polarity {
    /// The side that covers fewer pixels; dark when both cover the same.
    #[default]
    Minority,
    /// Dark lines on light paper.
    DarkInk,
    /// Light lines on a dark ground.
    LightInk,
}

/// How ink is told from paper. The default finds everything from the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Threshold {
    /// Which side of the level is ink.
    pub polarity: Polarity,
    /// Levels up to this one are dark; `None` takes Otsu's.
    pub level: Option<u8>,
    /// Least distance between the mean dark and the mean light level, in levels: below it the picture is an
    /// empty sheet with noise, and nothing is ink. Not asked when `level` is given.
    pub min_contrast: u8,
}

impl Default for Threshold {
    /// Otsu's level; 24 levels of contrast, a hard pencil's faintest line, where a scanner's noise has 2 to 8.
    fn default() -> Self {
        Self { polarity: Polarity::Minority, level: None, min_contrast: 24 }
    }
}

/// What was decided about a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Split {
    /// Levels up to this one are dark.
    pub level: u8,
    /// Whether the dark side is ink.
    pub ink_is_dark: bool,
    /// Number of ink pixels.
    pub ink_pixels: u64,
}

impl Threshold {
    /// The ink of a picture, and how it was told; no split, and no ink, for a picture of one level or below the
    /// least contrast.
    ///
    /// ```
    /// # use plotter_vector::{Gray, Threshold};
    /// let scan = Gray::new(4, 1, vec![250, 20, 240, 251])?;
    /// let (ink, split) = Threshold::default().apply(&scan);
    /// assert_eq!(ink.to_string(), ".#..\n");
    /// assert!(split.unwrap().ink_is_dark);
    /// # Ok::<(), plotter_vector::GrayError>(())
    /// ```
    #[must_use]
    pub fn apply(self, gray: &Gray) -> (Bitmap, Option<Split>) {
        // A `Gray` has been checked against the same limits, so the empty picture below is never wrong.
        let Ok(mut ink) = Bitmap::new(gray.width(), gray.height()) else {
            return (Bitmap::empty(), None);
        };
        let histogram = histogram(gray.pixels());
        let Some(level) = self.level.or_else(|| otsu(&histogram, self.min_contrast)) else {
            return (ink, None);
        };
        let (dark, light) = histogram.split_at(usize::from(level) + 1);
        let (dark, light): (u64, u64) = (dark.iter().sum(), light.iter().sum());
        let ink_is_dark = match self.polarity {
            Polarity::Minority => dark <= light,
            Polarity::DarkInk => true,
            Polarity::LightInk => false,
        };
        for (y, row) in (0..).zip(gray.rows()) {
            for (word, levels) in ink.row_mut(y).iter_mut().zip(row.chunks(64)) {
                let bits = levels.iter().rev().fold(0, |bits, l| bits << 1 | u64::from(*l <= level));
                let used = u64::MAX >> (64 - levels.len());
                *word = if ink_is_dark { bits } else { !bits & used };
            }
        }
        let ink_pixels = if ink_is_dark { dark } else { light };
        (ink, Some(Split { level, ink_is_dark, ink_pixels }))
    }
}

/// How many pixels have each level.
fn histogram(levels: &[u8]) -> [u64; 256] {
    let mut counts = [0; 256];
    for level in levels {
        if let Some(count) = counts.get_mut(usize::from(*level)) {
            *count += 1;
        }
    }
    counts
}

/// The level L that splits a histogram into 0..=L and the rest with the greatest variance between the classes,
/// w₀·w₁·(μ₀ − μ₁)². Of a plateau of equal levels (no pixel between two peaks) the middle is taken, so that
/// neither class lies on the border. `None` when all pixels have one level, or |μ₀ − μ₁| is below `min_contrast`.
///
/// Source: N. Otsu, "A threshold selection method from gray-level histograms" (1979), eq. 18.
fn otsu(histogram: &[u64; 256], min_contrast: u8) -> Option<u8> {
    let count: u64 = histogram.iter().sum();
    let sum: u64 = (0_u64..).zip(histogram).map(|(level, n)| level * n).sum();
    let (mut dark, mut dark_sum) = (0_u64, 0_u64);
    let mut best: Option<(u128, u8, u8, f64)> = None;
    for (level, n) in (0_u8..=255).zip(histogram) {
        dark += n;
        dark_sum += u64::from(level) * n;
        let light = count - dark;
        if dark == 0 || light == 0 {
            continue;
        }
        // w₀·w₁·(μ₀ − μ₁)² = (S₀·n₁ − S₁·n₀)² / (n₀·n₁) up to the constant n²; a wide integer keeps plateaus
        // exactly level: the square has at most 2·(28 + 8 + 28) bits.
        let cross = (u128::from(dark_sum) * u128::from(light))
            .abs_diff(u128::from(sum - dark_sum) * u128::from(dark));
        let classes = u128::from(dark) * u128::from(light);
        let variance = cross.checked_mul(cross).map_or(u128::MAX, |square| square / classes);
        #[expect(clippy::cast_precision_loss, reason = "only compared with a contrast of whole levels")]
        let contrast = cross as f64 / classes as f64;
        match &mut best {
            Some((most, _, last, _)) if variance == *most => *last = level,
            Some((most, ..)) if variance < *most => {}
            _ => best = Some((variance, level, level, contrast)),
        }
    }
    let (_, first, last, contrast) = best?;
    (contrast >= f64::from(min_contrast)).then(|| first + (last - first) / 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pixel;

    fn gray(width: u32, levels: &[u8]) -> Gray {
        let height = u32::try_from(levels.len()).unwrap() / width;
        Gray::new(width, height, levels.to_vec()).unwrap()
    }

    #[test]
    fn one_level_is_an_empty_sheet() {
        for level in [0, 127, 255] {
            let (ink, split) = Threshold::default().apply(&gray(3, &[level; 9]));
            assert_eq!((ink.count(), split), (0, None));
        }
    }

    #[test]
    fn the_minority_is_ink_on_either_ground() {
        let dark = gray(4, &[9, 200, 200, 200]);
        let light = gray(4, &[246, 55, 55, 55]);
        for (scan, ink_is_dark) in [(dark, true), (light, false)] {
            let (ink, split) = Threshold::default().apply(&scan);
            assert_eq!(ink.to_string(), "#...\n");
            assert_eq!(split.unwrap().ink_is_dark, ink_is_dark);
        }
    }

    #[test]
    fn dark_is_ink_when_both_cover_the_same() {
        let (ink, _) = Threshold::default().apply(&gray(4, &[9, 9, 200, 200]));
        assert_eq!(ink.to_string(), "##..\n");
    }

    #[test]
    fn otsu_splits_two_peaks_in_the_middle_of_the_gap() {
        let (_, split) = Threshold::default().apply(&gray(4, &[10, 10, 20, 201]));
        assert_eq!(split.unwrap().level, (20 + 200) / 2);
    }

    #[test]
    fn noise_on_an_empty_sheet_is_not_ink() {
        let (ink, split) = Threshold::default().apply(&gray(4, &[250, 255, 252, 248]));
        assert_eq!((ink.count(), split), (0, None));
    }

    #[test]
    fn light_ink_does_not_leak_past_the_last_column() {
        let mut levels = vec![255; 70];
        levels[3] = 0;
        let light = Threshold { polarity: Polarity::LightInk, ..Threshold::default() };
        let (ink, split) = light.apply(&gray(70, &levels));
        assert_eq!((ink.count(), split.unwrap().ink_pixels), (69, 69));
        assert_eq!(ink.ink().last(), Some(Pixel::new(69, 0)));
    }
}
