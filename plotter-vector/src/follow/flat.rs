//! [`Flat`]: a window in even light, as shares of darkness.

use super::Correction;
use super::paper::transposed;
use super::whole::{floor, inside};
use crate::{picture::Gray, stroke::PxPoint};

/// Side of the tiles in which the paper's level is found, px: wider than any line that is followed but its rims.
const TILE_PX: usize = 25;

/// Where even the lightest place is darker, there is no paper, of 255.
const DARKEST_LIGHT: f32 = 50.0;

/// A window of fewer tiles a side is small.
const SMALL_TILES: usize = 8;

/// The level that paper gets for the second time.
const EVEN_LEVEL: f32 = 200.0;

/// The share of a tile's pixels that are darker than its paper: lines may fill most of it.
const PAPER_SHARE: f32 = 0.9;

/// So many standard deviations is the lightest tenth lighter than the mean.
const LIGHTEST_TENTH: f32 = 1.28;

/// Paper darker than this share of the lightest paper is none: a tile full of ink.
const DARKEST_PAPER: f32 = 0.45;

/// Tiles that may be full of lines one beside the other, and how much lighter their paper is at least and at most than it shows.
const DENSE_TILES: usize = 6;
const LEAST_RAISED: f32 = 1.05;
const MOST_RAISED: f32 = 1.3;

/// A part of a window, each pixel as the share of the paper's light that is missing there: 0 is paper, black ink nearly 1.
/// Places are those of the window without distortion.
#[derive(Clone, Debug, Default)]
pub(super) struct Flat {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
    dark: Vec<f32>,
    /// Standard deviation of the noise, as a share.
    pub(super) noise: f32,
}

impl Flat {
    /// The part of a window within `reach` px of its middle; all of it for `None`.
    pub(super) fn of(window: &Gray, correction: Option<&Correction>, reach: Option<usize>) -> Self {
        let (full_width, full_height) = (window.width() as usize, window.height() as usize);
        let span = |side: usize| match reach {
            Some(reach) if 2 * reach < side => (side / 2 - reach, 2 * reach),
            _ => (0, side),
        };
        let ((left, width), (top, height)) = (span(full_width), span(full_height));
        let mut levels = Vec::with_capacity(width * height);
        for y in top..top + height {
            if let Some(correction) = correction {
                levels.extend((left..left + width).map(|x| correction.level(window, x, y)));
            } else {
                let row = window.pixels().get(y * full_width + left..y * full_width + left + width);
                levels.extend(row.unwrap_or(&[]).iter().map(|level| f32::from(*level)));
            }
        }
        let mut flat = Self { left, top, width, height, dark: levels, noise: 0.0 };
        flat.divide_by_paper();
        if width.min(height) < SMALL_TILES * TILE_PX {
            // The same light falls off within few tiles, in each of them so much that its lightest tenth is all on one side. What is
            // left of it after the first time is even enough.
            flat.dark.iter_mut().for_each(|dark| *dark = EVEN_LEVEL * (1.0 - *dark));
            flat.divide_by_paper();
        }
        flat.noise = flat.measured_noise();
        // The paper's level is that of its lightest tenth, which noise makes lighter.
        let bias = LIGHTEST_TENTH * flat.noise;
        flat.dark.iter_mut().for_each(|dark| *dark -= bias);
        if flat.noise > 0.04 {
            flat.smooth();
            flat.noise *= 0.4;
        }
        flat
    }

    /// Width and height, px.
    pub(super) const fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The window's column and row that it begins at.
    pub(super) const fn origin(&self) -> [usize; 2] {
        [self.left, self.top]
    }

    /// The rows, from the top.
    pub(super) fn rows(&self) -> impl Iterator<Item = &[f32]> {
        self.dark.chunks(self.width.max(1))
    }

    /// The darkness at a place of the window, between four pixels; outside the nearest pixels count.
    pub(super) fn at(&self, place: PxPoint) -> f32 {
        #[expect(clippy::cast_precision_loss, reason = "a window is small")]
        let (x, y) = (place.x - 0.5 - self.left as f64, place.y - 0.5 - self.top as f64);
        let (column, row) = (floor(x), floor(y));
        #[expect(clippy::cast_possible_truncation, reason = "from 0 to 1")]
        let (u, v) = ((x - f64::from(column)) as f32, (y - f64::from(row)) as f32);
        if let (Some(x0), Some(y0)) = (inside(column, self.width), inside(row, self.height))
            && x0 + 1 < self.width
            && y0 + 1 < self.height
        {
            let i = y0 * self.width + x0;
            let (above, below) = (self.dark.get(i..i + 2), self.dark.get(i + self.width..i + self.width + 2));
            if let (Some([a, b]), Some([c, d])) = (above, below) {
                return (a * (1.0 - u) + b * u) * (1.0 - v) + (c * (1.0 - u) + d * u) * v;
            }
        }
        self.nearest(column, row)
    }

    fn nearest(&self, column: i32, row: i32) -> f32 {
        let clamp = |at: i32, side: usize| usize::try_from(at).unwrap_or(0).min(side.saturating_sub(1));
        self.dark
            .get(clamp(row, self.height) * self.width + clamp(column, self.width))
            .copied()
            .unwrap_or(0.0)
    }

    /// Whether a place is at least so far inside.
    pub(super) fn holds(&self, place: PxPoint, margin_px: f64) -> bool {
        #[expect(clippy::cast_precision_loss, reason = "a window is small")]
        let inside = |at: f64, first: usize, side: usize| {
            at - margin_px >= first as f64 && at + margin_px <= (first + side) as f64
        };
        inside(place.x, self.left, self.width) && inside(place.y, self.top, self.height)
    }

    /// From levels to shares of darkness: each level is divided by that of the paper, interpolated between tiles.
    fn divide_by_paper(&mut self) {
        let (columns, rows) = (tiles(self.width), tiles(self.height));
        let mut histograms = vec![[0_u16; 64]; columns * rows];
        for (y, row) in self.dark.chunks(self.width.max(1)).enumerate() {
            for (x, level) in row.iter().enumerate() {
                let tile = tile_of(y, self.height, rows) * columns + tile_of(x, self.width, columns);
                let bin = usize::from(super::whole::level(*level) / 4);
                if let Some(count) = histograms.get_mut(tile).and_then(|bins| bins.get_mut(bin)) {
                    *count = count.saturating_add(1);
                }
            }
        }
        let mut paper: Vec<f32> = histograms.iter().map(paper_level).collect();
        let lightest = paper.iter().copied().fold(1.0_f32, f32::max);
        if lightest < DARKEST_LIGHT {
            // Ink all over, a covered lens, or no light: there is nothing to be seen.
            self.dark.fill(0.0);
            return;
        }
        fill_dark(&mut paper, columns, rows, DARKEST_PAPER * lightest);
        raise_dense(&mut paper, columns, rows);
        let across: Vec<(usize, f32)> = (0..self.width).map(|x| between(x, self.width, columns)).collect();
        let mut levels = vec![0.0; columns];
        for (y, row) in self.dark.chunks_mut(self.width.max(1)).enumerate() {
            let (tile, part) = between(y, self.height, rows);
            let of =
                |row: usize, column: usize| paper.get(row * columns + column).copied().unwrap_or(lightest);
            for (column, level) in levels.iter_mut().enumerate() {
                *level = of(tile, column) * (1.0 - part) + of((tile + 1).min(rows - 1), column) * part;
            }
            for (dark, (tile, part)) in row.iter_mut().zip(&across) {
                let left = levels.get(*tile).copied().unwrap_or(lightest);
                let right = levels.get(tile + 1).copied().unwrap_or(left);
                *dark = 1.0 - *dark / (left * (1.0 - part) + right * part).max(1.0);
            }
        }
    }

    /// Noise from the differences of neighbours: their median is 0.954 standard deviations of one of them.
    fn measured_noise(&self) -> f32 {
        let mut bins = [0_u32; 256];
        for row in self.rows().step_by(3) {
            for pair in row.windows(2).step_by(2) {
                if let [a, b] = pair
                    && let Some(bin) = bins.get_mut(usize::from(super::whole::level((a - b).abs() * 1000.0)))
                {
                    *bin += 1;
                }
            }
        }
        let half = bins.iter().sum::<u32>() / 2;
        let mut below = 0;
        let median = bins.iter().position(|count| {
            below += count;
            below > half
        });
        #[expect(clippy::cast_precision_loss, reason = "less than 256")]
        let median = median.unwrap_or(0) as f32;
        median / 954.0
    }

    /// The binomial of 3 x 3 px.
    fn smooth(&mut self) {
        let along = binomial(&self.dark, self.width);
        let turned = transposed(&along, self.width, self.height);
        let across = binomial(&turned, self.height);
        self.dark = transposed(&across, self.height, self.width);
    }
}

/// Each row's levels as a quarter of both neighbours and half of their own.
fn binomial(levels: &[f32], width: usize) -> Vec<f32> {
    let row_smoothed = |row: &[f32]| -> Vec<f32> {
        let at = |i: usize| row.get(i.min(row.len() - 1)).copied().unwrap_or(0.0);
        (0..row.len()).map(|i| 0.25 * at(i.saturating_sub(1)) + 0.5 * at(i) + 0.25 * at(i + 1)).collect()
    };
    levels.chunks(width.max(1)).flat_map(row_smoothed).collect()
}

fn tiles(side: usize) -> usize {
    (side / TILE_PX).max(1)
}

fn tile_of(at: usize, side: usize, tiles: usize) -> usize {
    (at * tiles / side.max(1)).min(tiles - 1)
}

/// The tile whose middle is before a pixel, and how far the pixel is on the way to the next one; beyond the outermost middles
/// the light goes on falling as before.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a window"
)]
fn between(at: usize, side: usize, tiles: usize) -> (usize, f32) {
    let place = (at as f32 + 0.5) * tiles as f32 / side.max(1) as f32 - 0.5;
    let tile = (place.max(0.0) as usize).min(tiles.saturating_sub(2));
    (tile, if tiles < 2 { 0.0 } else { place - tile as f32 })
}

/// The level that the given share of pixels is darker than.
fn paper_level(bins: &[u16; 64]) -> f32 {
    let total: u32 = bins.iter().map(|count| u32::from(*count)).sum();
    #[expect(clippy::cast_precision_loss, reason = "pixels of a tile")]
    let share = total as f32 * PAPER_SHARE;
    let (mut below, mut level) = (0.0, 2.0);
    for count in bins {
        let count = f32::from(*count);
        if below + count >= share {
            return level + if count > 0.0 { 4.0 * (share - below) / count - 2.0 } else { 0.0 };
        }
        below += count;
        level += 4.0;
    }
    level
}

/// Between lines that are close together blur leaves no place as light as paper: such tiles take what their neighbours on both sides
/// have, in the mean. Light that falls off from its middle is never less than that.
fn raise_dense(paper: &mut [f32], columns: usize, rows: usize) {
    let before = paper.to_vec();
    let at = |x: Option<usize>, y: Option<usize>| {
        let (x, y) = (x.filter(|x| *x < columns)?, y?);
        before.get(y * columns + x).copied()
    };
    for y in 0..rows {
        for x in 0..columns {
            let Some(own) = at(Some(x), Some(y)) else { continue };
            let mut most = own;
            for one in 1..=DENSE_TILES {
                for other in 1..=DENSE_TILES {
                    #[expect(clippy::cast_precision_loss, reason = "small numbers")]
                    let share = one as f32 / (one + other) as f32;
                    let pairs = [
                        (at(x.checked_sub(one), Some(y)), at(x.checked_add(other), Some(y))),
                        (at(Some(x), y.checked_sub(one)), at(Some(x), y.checked_add(other))),
                    ];
                    for (a, b) in pairs {
                        if let (Some(a), Some(b)) = (a, b) {
                            most = most.max(a + share * (b - a));
                        }
                    }
                }
            }
            // (less is noise)
            if most > LEAST_RAISED * own
                && let Some(level) = paper.get_mut(y * columns + x)
            {
                *level = most.min(MOST_RAISED * own);
            }
        }
    }
}

/// Tiles without paper take that of their neighbours.
fn fill_dark(paper: &mut [f32], columns: usize, rows: usize, least: f32) {
    for _ in 0..columns + rows {
        let before = paper.to_vec();
        let known = |x: usize, y: usize| before.get(y * columns + x).copied().filter(|level| *level >= least);
        let mut changed = false;
        for y in 0..rows {
            for x in 0..columns {
                if known(x, y).is_some() {
                    continue;
                }
                let near: Vec<f32> = (y.saturating_sub(1)..=(y + 1).min(rows - 1))
                    .flat_map(|v| (x.saturating_sub(1)..=(x + 1).min(columns - 1)).map(move |u| (u, v)))
                    .filter_map(|(u, v)| known(u, v))
                    .collect();
                #[expect(clippy::cast_precision_loss, reason = "at most eight")]
                if let (Some(level), false) = (paper.get_mut(y * columns + x), near.is_empty()) {
                    *level = near.iter().sum::<f32>() / near.len() as f32;
                    changed = true;
                }
            }
        }
        if !changed {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::follow::{CameraSettings, Paper, SimulatedCamera};

    #[test]
    fn a_line_is_as_dark_at_the_rim_as_in_the_middle() {
        // Light falls from 200 to 100 across the window; ink reflects a tenth.
        let light = |x: u32| 200.0 - x as f32 / 2.0;
        let level = |x: u32, y: u32| if (48..52).contains(&y) { 0.1 * light(x) } else { light(x) };
        let levels =
            (0..100).flat_map(|y| (0..200).map(move |x| crate::follow::whole::level(level(x, y)))).collect();
        let flat = Flat::of(&Gray::new(200, 100, levels).unwrap(), None, None);
        for x in [3.0, 50.0, 100.0, 150.0, 197.0] {
            let (ink, paper) = (flat.at(PxPoint::new(x, 50.0)), flat.at(PxPoint::new(x, 20.0)));
            assert!((ink - 0.9).abs() < 0.03 && paper.abs() < 0.06, "{x}: {ink} {paper}");
        }
    }

    #[test]
    fn paper_between_dense_lines_is_no_lighter_than_it_is() {
        // Lines of 4 px, 4 px apart, under 1.5 px of blur: the gaps are 0.2 dark, and are no paper.
        let lines: Vec<_> = (0..14)
            .map(|i| 100.0 + 8.0 * f64::from(i))
            .map(|x| (vec![PxPoint::new(x, 60.0), PxPoint::new(x, 240.0)], 4.0))
            .collect();
        let paper = Paper::drawn(300, 300, &lines).unwrap();
        let mut camera = SimulatedCamera::new(&paper, CameraSettings::default());
        let flat = Flat::of(&camera.window(PxPoint::new(150.0, 150.0)), None, None);
        let mean =
            |x: f64| (0..120_u8).map(|y| flat.at(PxPoint::new(x, 90.0 + f64::from(y)))).sum::<f32>() / 120.0;
        for x in [124.0, 148.0, 172.0, 196.0] {
            let (line, gap) = (mean(x), mean(x + 4.0));
            assert!((line - 0.77).abs() < 0.05 && (gap - 0.2).abs() < 0.05, "{x}: {line} {gap}");
        }
    }
}
