//! [`Histogram`]: which colours a picture has, and which of them is the paper.

use crate::picture::oklab::OklabTable;
use crate::picture::{Colour, Oklab, Rgb};

/// Bits of each channel that tell the bins apart; the others are averaged.
const BITS: u32 = 5;
/// Levels of a channel in one bin.
pub(super) const LEVELS_PER_BIN: i32 = 1 << (8 - BITS);
/// Number of bins.
pub(super) const BINS: usize = 1 << (3 * BITS);
const LOW: u8 = (1 << (8 - BITS)) - 1;

/// The bin of a colour, below [`BINS`].
#[inline]
pub(super) fn bin([red, green, blue]: [u8; 3]) -> usize {
    let high = |channel: u8| usize::from(channel >> (8 - BITS));
    high(red) << (2 * BITS) | high(green) << BITS | high(blue)
}

/// Colours of a bin that occurs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// The bin.
    pub(super) bin: usize,
    /// Its pixels.
    pub(super) count: u32,
    /// Their mean.
    pub(super) mean: Rgb,
    /// The mean in Oklab.
    pub(super) oklab: Oklab,
    /// How far the mean is from the paper's colour, in Oklab.
    pub(super) contrast: f64,
}

/// The colours of a picture, 32 levels a channel.
#[derive(Clone, Debug)]
pub(super) struct Histogram {
    /// The bins that occur, in their order.
    pub(super) entries: Vec<Entry>,
    /// The most frequent colour.
    pub(super) paper: Rgb,
    /// Half of all pixels are at most this far from the paper's colour, in Oklab: the noise of the sheet.
    pub(super) noise: f64,
}

impl Histogram {
    pub(super) fn new(picture: &Colour, table: &OklabTable) -> Self {
        let counts = count(picture.pixels());
        let entry = |(bin, counts): (usize, &[u32; 4])| {
            let mean = mean(bin, counts)?;
            Some(Entry { bin, count: counts[3], mean, oklab: table.oklab(mean), contrast: 0.0 })
        };
        let mut entries: Vec<Entry> = counts.iter().enumerate().filter_map(entry).collect();
        let paper = paper(&entries, &counts);
        let white = table.oklab(paper);
        entries.iter_mut().for_each(|entry| entry.contrast = entry.oklab.distance(white));
        let noise = median_contrast(&entries);
        Self { entries, paper, noise }
    }
}

/// For each bin the sums of the lower bits of red, green and blue, at most 7 · 2²⁸ each, and the number of
/// pixels.
fn count(pixels: &[[u8; 3]]) -> Vec<[u32; 4]> {
    let mut counts = vec![[0; 4]; BINS];
    for pixel in pixels {
        if let Some([red, green, blue, count]) = counts.get_mut(bin(*pixel)) {
            *red += u32::from(pixel[0] & LOW);
            *green += u32::from(pixel[1] & LOW);
            *blue += u32::from(pixel[2] & LOW);
            *count += 1;
        }
    }
    counts
}

/// The mean colour of a bin, to nearest; `None` for an empty one.
fn mean(bin: usize, [red, green, blue, count]: &[u32; 4]) -> Option<Rgb> {
    let half = count / 2;
    let channel = |shift: u32, low: &u32| {
        let high = (bin >> shift) & ((1 << BITS) - 1);
        let low = (low + half).checked_div(*count)?;
        u8::try_from((high << (8 - BITS)) + low as usize).ok()
    };
    Some(Rgb([channel(2 * BITS, red)?, channel(BITS, green)?, channel(0, blue)?]))
}

/// The most frequent colour: the fullest bin with its 26 neighbours, so that a sheet whose noise lies across
/// a border of bins is met in its middle. White for a picture without pixels.
fn paper(entries: &[Entry], counts: &[[u32; 4]]) -> Rgb {
    // Of equally full bins the lightest.
    let fullest = entries.iter().max_by(|a, b| a.count.cmp(&b.count).then(a.oklab.l.total_cmp(&b.oklab.l)));
    let Some(fullest) = fullest else { return Rgb::WHITE };
    let side = 1_usize << BITS;
    let near = |shift: u32| {
        let at = (fullest.bin >> shift) & (side - 1);
        at.saturating_sub(1)..=(at + 1).min(side - 1)
    };
    let (mut sums, mut total) = ([0_u64; 3], 0_u64);
    for (red, green, blue) in
        near(2 * BITS).flat_map(|r| near(BITS).flat_map(move |g| near(0).map(move |b| (r, g, b))))
    {
        let bin = red << (2 * BITS) | green << BITS | blue;
        let Some(([r, g, b], counts)) =
            counts.get(bin).and_then(|counts| Some((mean(bin, counts)?.0, counts)))
        else {
            continue;
        };
        for (sum, channel) in sums.iter_mut().zip([r, g, b]) {
            *sum += u64::from(channel) * u64::from(counts[3]);
        }
        total += u64::from(counts[3]);
    }
    let channel = |sum: u64| (sum + total / 2).checked_div(total).and_then(|mean| u8::try_from(mean).ok());
    Rgb(sums.map(|sum| channel(sum).unwrap_or(u8::MAX)))
}

fn median_contrast(entries: &[Entry]) -> f64 {
    let mut by_contrast: Vec<(f64, u32)> =
        entries.iter().map(|entry| (entry.contrast, entry.count)).collect();
    by_contrast.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let half = by_contrast.iter().map(|(_, count)| u64::from(*count)).sum::<u64>() / 2;
    let mut below = 0;
    let median = by_contrast.iter().find(|(_, count)| {
        below += u64::from(*count);
        below > half
    });
    median.map_or(0.0, |(contrast, _)| *contrast)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn histogram(pixels: &[[u8; 3]]) -> Histogram {
        let width = u32::try_from(pixels.len()).unwrap();
        let picture = Colour::new(width, 1, pixels.as_flattened().to_vec()).unwrap();
        Histogram::new(&picture, &OklabTable::new())
    }

    #[test]
    fn a_bin_has_the_mean_of_its_colours() {
        let found = histogram(&[[8, 16, 24], [10, 18, 31], [255; 3], [255; 3], [255; 3]]);
        assert_eq!(found.entries.len(), 2);
        // 27.5 goes up.
        assert_eq!((found.entries[0].mean, found.entries[0].count), (Rgb([9, 17, 28]), 2));
        assert_eq!(found.paper, Rgb::WHITE);
    }

    #[test]
    fn noise_across_a_border_of_bins_does_not_shift_the_paper() {
        let noisy: Vec<[u8; 3]> = (0..=8).map(|step| [244 + step, 236 + step, 220 + step]).collect();
        assert_eq!(histogram(&noisy).paper, Rgb([248, 240, 224]));
    }

    #[test]
    fn nothing_is_white_paper() {
        let nothing = histogram(&[]);
        assert_eq!((nothing.paper, nothing.noise, nothing.entries.len()), (Rgb::WHITE, 0.0, 0));
    }
}
