//! [`Light`]: how bright the bare paper is in each place of a picture in colour, where that differs.
//!
//! A telephone's shade takes away the same part of red, green and blue of paper and ink alike, so a colour
//! divided by that of the paper around it is the pen's again. The paper is the median of a tile, which lines
//! never fill; between the middles of tiles it changes evenly.

use crate::picture::{Colour, Rgb};
use core::cmp::Ordering;

/// Side of a tile, px: a thousand pixels, of which the median is known far better than the noise.
const SIDE_PX: u32 = 32;
/// Light is uneven when the darkest tiles differ from the brightest by this part; a scanner's lamp differs by
/// less.
const UNEVEN: f32 = 0.06;
/// The darkest and the brightest are those beyond which this part of the tiles lies.
const OUTER: f32 = 0.05;
/// From a tile to the next, shade changes by less than this part. What changes more is ink that fills tiles,
/// and nothing is told of the light.
const STEP: f32 = 0.25;
/// Darker paper is none that shade falls on, but a board, whose dust is as light, levels.
const DARKEST_PAPER: f32 = 64.0;
/// A tile that differs more than this part from the median of those around it is full of ink.
const INKED: f32 = 0.1;

/// The paper's colour in the tiles of a picture.
#[derive(Clone, Debug)]
pub(super) struct Light {
    columns: u32,
    rows: u32,
    /// Size of the picture, px.
    size: (u32, u32),
    tiles: Vec<[f32; 3]>,
    /// The paper where it is brightest.
    full: [f32; 3],
}

impl Light {
    /// The light on a picture, where it is uneven.
    pub(super) fn of(picture: &Colour) -> Option<Self> {
        let (width, height) = (picture.width(), picture.height());
        let (columns, rows) = (width / SIDE_PX, height / SIDE_PX);
        if columns < 2 || rows < 2 {
            return None;
        }
        let (size, tiles) = ((width, height), medians(picture, columns, rows));
        let mut light = Self { columns, rows, size, tiles, full: [0.0; 3] };
        light.calm();
        if light.has_steps() {
            return None;
        }
        let mut sorted: Vec<[f32; 3]> = light.tiles.clone();
        // Of equally bright ones by their colours, not by their places.
        let by_colour = |one: &[f32; 3], other: &[f32; 3]| {
            let channels = one.iter().zip(other).map(|(one, other)| one.total_cmp(other));
            channels.fold(sum(one).total_cmp(&sum(other)), Ordering::then)
        };
        sorted.sort_by(by_colour);
        let at = |share: f32| {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of tiles")]
            let index = (share * as_f32(columns * rows)) as usize;
            sorted.get(index.min(sorted.len() - 1)).copied().unwrap_or([255.0; 3])
        };
        let (dark, bright) = (at(OUTER), at(1.0 - OUTER));
        light.full = bright;
        let is_paper = sum(&bright) >= 3.0 * DARKEST_PAPER;
        (is_paper && sum(&dark) < (1.0 - UNEVEN) * sum(&bright)).then_some(light)
    }

    /// The picture as if its light were even.
    pub(super) fn evened(&self, picture: &Colour) -> Colour {
        let mut channels = Vec::with_capacity(3 * picture.pixels().len());
        for (y, row) in (0..).zip(picture.rows()) {
            for (x, pixel) in (0..).zip(row) {
                channels.extend(self.even((x, y), Rgb(*pixel)).0);
            }
        }
        Colour::new(picture.width(), picture.height(), channels).unwrap_or_else(|_| picture.clone())
    }

    /// The colour of a pixel as if the light were even.
    pub(super) fn even(&self, (x, y): (u32, u32), Rgb(colour): Rgb) -> Rgb {
        let (left, across) = place(x, self.size.0, self.columns);
        let (above, down) = place(y, self.size.1, self.rows);
        let tile = |column: u32, row: u32| {
            let index = (row * self.columns + column) as usize;
            self.tiles.get(index).copied().unwrap_or(self.full)
        };
        let near = [(left, above), (left + 1, above), (left, above + 1), (left + 1, above + 1)];
        let [one, two, three, four] = near.map(|(column, row)| tile(column, row));
        let mut out = [0; 3];
        let tiles = one.iter().zip(two).zip(three).zip(four).zip(self.full);
        for ((out, level), ((((one, two), three), four), full)) in out.iter_mut().zip(colour).zip(tiles) {
            let between =
                |one: f32, other: f32, [of_one, of_other]: [f32; 2]| one * of_one + other * of_other;
            let paper = between(between(*one, two, across), between(three, four, across), down).max(1.0);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a byte")]
            let level = (f32::from(level) * full / paper + 0.5).clamp(0.0, 255.0) as u8;
            *out = level;
        }
        Rgb(out)
    }

    /// Takes the median of the tiles around for one that is full of ink.
    fn calm(&mut self) {
        let tiles = self.tiles.clone();
        for row in 0..self.rows {
            for column in 0..self.columns {
                let mut around = [const { Vec::new() }; 3];
                for y in row.saturating_sub(1)..(row + 2).min(self.rows) {
                    for x in column.saturating_sub(1)..(column + 2).min(self.columns) {
                        let tile = tiles.get((y * self.columns + x) as usize).copied().unwrap_or_default();
                        around.iter_mut().zip(tile).for_each(|(levels, level)| levels.push(level));
                    }
                }
                let median = around.map(|mut levels: Vec<f32>| {
                    levels.sort_by(f32::total_cmp);
                    levels.get(levels.len() / 2).copied().unwrap_or(0.0)
                });
                if let Some(tile) = self.tiles.get_mut((row * self.columns + column) as usize)
                    && differ(tile, &median, INKED)
                {
                    *tile = median;
                }
            }
        }
    }

    /// Whether a tile differs from the next one as no shade does.
    fn has_steps(&self) -> bool {
        let columns = self.columns as usize;
        let steps = |one: &[f32; 3], other: &[f32; 3]| differ(one, other, STEP);
        let across = self.tiles.chunks(columns).flat_map(|row| row.iter().zip(row.iter().skip(1)));
        let down = self.tiles.iter().zip(self.tiles.iter().skip(columns));
        across.chain(down).any(|(one, other)| steps(one, other))
    }
}

/// Whether a channel differs by this part or more.
fn differ(one: &[f32; 3], other: &[f32; 3], part: f32) -> bool {
    one.iter().zip(other).any(|(one, other)| (one - other).abs() > part * one.max(*other))
}

fn sum(levels: &[f32; 3]) -> f32 {
    levels.iter().sum()
}

/// The tile before the middle of a pixel, of which the last has none behind it, and the parts of that tile and
/// of the next one in the paper there; beyond the outermost middles the change goes on.
///
/// The parts are whole numbers, divided: from the other end they are the same two, so a mirrored picture is
/// evened as the picture is, bit by bit.
fn place(pixel: u32, pixels: u32, tiles: u32) -> (u32, [f32; 2]) {
    let whole = 2 * i64::from(pixels);
    // From the first tile's middle, in parts of which a tile has `whole`.
    let at = (2 * i64::from(pixel) + 1) * i64::from(tiles) - i64::from(pixels);
    let before = (at / whole.max(1)).clamp(0, i64::from(tiles.saturating_sub(2)));
    let behind = at - before * whole;
    #[expect(clippy::cast_precision_loss, reason = "a part of a tile")]
    let part = |of: i64| of as f32 / whole as f32;
    (u32::try_from(before).unwrap_or(0), [part(whole - behind), part(behind)])
}

/// The median of each tile's channels.
fn medians(picture: &Colour, columns: u32, rows: u32) -> Vec<[f32; 3]> {
    // A pixel that lies in two tiles counts in both: so the tiles are the same from the other side.
    let cut = |index: u32, of: u32, length: u32| {
        let (whole, rest) = (length / of, length % of);
        let (from, to) =
            (index * whole + index * rest / of, (index + 1) * whole + ((index + 1) * rest).div_ceil(of));
        from as usize..to as usize
    };
    let width = picture.width() as usize;
    let tile = |(column, row): (u32, u32)| {
        let mut counts = [[0_u32; 256]; 3];
        let mut total = 0;
        for y in cut(row, rows, picture.height()) {
            let line = picture.pixels().get(y * width..).unwrap_or(&[]);
            for pixel in line.get(cut(column, columns, picture.width())).unwrap_or(&[]) {
                for (counts, level) in counts.iter_mut().zip(pixel) {
                    if let Some(count) = counts.get_mut(usize::from(*level)) {
                        *count += 1;
                    }
                }
                total += 1;
            }
        }
        counts.map(|counts| median(&counts, total))
    };
    (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row))).map(tile).collect()
}

/// The level below which half of the pixels lie, between whole ones as if each were spread evenly.
fn median(counts: &[u32; 256], total: u32) -> f32 {
    let half = as_f32(total) / 2.0;
    let mut below = 0.0;
    for (level, count) in (0_u8..=255).zip(counts) {
        let count = as_f32(*count);
        if below + count >= half && count > 0.0 {
            return f32::from(level) + (half - below) / count - 0.5;
        }
        below += count;
    }
    255.0
}

#[expect(clippy::cast_precision_loss, reason = "a picture's side or a tile's pixels")]
fn as_f32(number: u32) -> f32 {
    number as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mirrored(picture: &Colour) -> Colour {
        let rows: Vec<[u8; 3]> = picture.rows().flat_map(|row| row.iter().rev().copied()).collect();
        Colour::new(picture.width(), picture.height(), rows.as_flattened().to_vec()).unwrap()
    }

    #[test]
    fn a_mirrored_sheet_is_evened_as_the_sheet_is() {
        // Tiles of 35 1/3 px, a shade from the left, and lines.
        let (width, height) = (106_u32, 70_u32);
        let pixel = |x: u32, y: u32| {
            let paper = 150 + x.min(105) * y.max(20) / 70;
            let ink = if (x * 3 + y * 5) % 41 < 4 { [0.2, 0.5, 0.8] } else { [1.0, 0.95, 0.9] };
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a level")]
            ink.map(|part| (part * f64::from(paper.min(255))) as u8)
        };
        let pixels: Vec<[u8; 3]> =
            (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect();
        let picture = Colour::new(width, height, pixels.as_flattened().to_vec()).unwrap();
        let even = |picture: &Colour| Light::of(picture).unwrap().evened(picture);
        let back = mirrored(&picture);
        assert_ne!(even(&picture), picture);
        assert_eq!(even(&back), mirrored(&even(&picture)));
    }
}
