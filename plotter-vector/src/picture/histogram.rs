//! [`Histogram`]: how many pixels have each grey level, and Otsu's level of it.

use core::ops::AddAssign;

/// How many pixels have each of the 256 grey levels; filled row by row, or in parts that are merged.
///
/// ```
/// # use plotter_vector::picture::Histogram;
/// let mut histogram = Histogram::default();
/// histogram.push(&[250, 20, 240, 250]);
/// histogram.push(&[250]);
/// assert_eq!(histogram.counts()[250], 3);
/// assert_eq!(histogram.otsu(24), Some(129)); // between 20 and 239
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Histogram {
    tables: [[u64; 256]; 4],
}

impl Default for Histogram {
    /// No pixels.
    fn default() -> Self {
        Self { tables: [[0; 256]; 4] }
    }
}

/// Counts levels in four tables in turn: neighbours mostly have the same level, and an addition to the same
/// place must wait for the one before.
pub(crate) fn count<T: AddAssign + From<u8>>(tables: &mut [[T; 256]; 4], levels: &[u8]) {
    let [a, b, c, d] = tables;
    let (fours, rest) = levels.as_chunks::<4>();
    for [i, j, k, l] in fours {
        a[usize::from(*i)] += 1.into();
        b[usize::from(*j)] += 1.into();
        c[usize::from(*k)] += 1.into();
        d[usize::from(*l)] += 1.into();
    }
    for level in rest {
        a[usize::from(*level)] += 1.into();
    }
}

impl Histogram {
    /// Counts the levels of a row, or of any part of a picture.
    pub fn push(&mut self, levels: &[u8]) {
        count(&mut self.tables, levels);
    }

    /// Counts one level `pixels` times.
    pub(crate) fn add(&mut self, level: u8, pixels: u64) {
        self.tables[usize::from(level) & 3][usize::from(level)] += pixels;
    }

    /// Adds the counts of another part of the picture.
    pub fn merge(&mut self, other: &Self) {
        let theirs = other.tables.iter().flatten();
        for (count, n) in self.tables.iter_mut().flatten().zip(theirs) {
            *count += n;
        }
    }

    /// Number of pixels of each level.
    #[must_use]
    pub fn counts(&self) -> [u64; 256] {
        let mut counts = [0; 256];
        for table in &self.tables {
            for (count, n) in counts.iter_mut().zip(table) {
                *count += n;
            }
        }
        counts
    }

    /// The level L that splits the pixels into 0..=L and the rest with the greatest variance between the
    /// classes, w₀·w₁·(μ₀ − μ₁)². Of a plateau of equal levels (no pixel between two peaks) the middle is
    /// taken, so that neither class lies on the border. `None` when all pixels have one level, or |μ₀ − μ₁|
    /// is below `min_contrast` levels. Never 255.
    ///
    /// Source: N. Otsu, "A threshold selection method from gray-level histograms" (1979), eq. 18.
    #[must_use]
    pub fn otsu(&self, min_contrast: u8) -> Option<u8> {
        otsu(&self.counts(), min_contrast)
    }
}

/// As [`Histogram::otsu`], of bare counts.
pub(crate) fn otsu(counts: &[u64; 256], min_contrast: u8) -> Option<u8> {
    let exact: u64 = counts.iter().sum();
    // Of 2²⁸ px or more the squares below would not fit: a sample of each level serves, of the rarest one
    // pixel.
    let shift = 36_u32.saturating_sub(exact.leading_zeros());
    let counts = &counts.map(|n| (n >> shift).max(n.min(1)));
    let count: u64 = counts.iter().sum();
    let sum: u64 = (0_u64..).zip(counts).map(|(level, n)| level * n).sum();
    let (mut dark, mut dark_sum) = (0_u64, 0_u64);
    let mut best: Option<(u128, u8, u8, f64)> = None;
    for (level, n) in (0_u8..=255).zip(counts) {
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

/// Pixels of a level in the middle half between the mean of the dark ones and that of the light ones, as
/// [`Histogram::otsu`] tells them: those that ink covers by about half.
pub(crate) fn half_covered(counts: &[u64; 256]) -> u64 {
    let Some(level) = otsu(counts, 0) else { return 0 };
    let (dark, light) = counts.split_at(usize::from(level) + 1);
    let mean = |counts: &[u64], first: u64| {
        let sum: u64 = (first..).zip(counts).map(|(level, count)| level * count).sum();
        sum / counts.iter().sum::<u64>().max(1)
    };
    let (dark, light) = (mean(dark, 0), mean(light, u64::from(level) + 1));
    let quarter = light.saturating_sub(dark) / 4;
    let middle = dark + quarter..=light.saturating_sub(quarter);
    (0..).zip(counts).filter(|(level, _)| middle.contains(level)).map(|(_, count)| count).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_merge_to_the_whole() {
        let levels: Vec<u8> = (0..1003_u32).map(|i| (i * i % 251) as u8).collect();
        let mut whole = Histogram::default();
        whole.push(&levels);
        let mut parts = Histogram::default();
        for part in levels.chunks(97) {
            let mut histogram = Histogram::default();
            histogram.push(part);
            parts.merge(&histogram);
        }
        assert_eq!(whole.counts(), parts.counts());
        assert_eq!(whole.counts().iter().sum::<u64>(), 1003);
    }

    #[test]
    fn the_middle_of_an_empty_gap_is_the_level() {
        let mut histogram = Histogram::default();
        histogram.push(&[10, 10, 20, 201]);
        assert_eq!(histogram.otsu(0), Some((20 + 200) / 2));
    }

    #[test]
    fn a_picture_of_any_size_is_split() {
        for megapixels in [1, 256, 257, 1 << 14] {
            let mut histogram = Histogram::default();
            for (level, share) in [(10, 200), (20, 100), (201, 90), (255, 1_000_000 - 390)] {
                histogram.add(level, share * megapixels);
            }
            assert_eq!(histogram.otsu(24), Some((20 + 200) / 2), "{megapixels}");
        }
    }

    #[test]
    fn a_line_on_a_huge_sheet_is_not_overlooked() {
        let mut histogram = Histogram::default();
        histogram.add(255, 1 << 34);
        histogram.add(0, 5);
        assert_eq!(histogram.otsu(24), Some(127));
    }

    #[test]
    fn one_level_or_little_contrast_has_no_split() {
        let mut histogram = Histogram::default();
        histogram.push(&[7; 5]);
        assert_eq!(histogram.otsu(0), None);
        histogram.push(&[30]);
        assert_eq!((histogram.otsu(23).is_some(), histogram.otsu(24)), (true, None));
    }
}
