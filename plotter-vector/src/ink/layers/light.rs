//! [`Light`]: how bright the bare paper is in each place of a picture in colour, where that differs.
//!
//! A telephone's shade takes away the same part of red, green and blue of paper and ink alike, so a colour
//! divided by that of the paper around it is the pen's again. The paper is the median of a tile, which lines
//! never fill; between the middles of tiles it changes evenly.

use crate::picture::{Colour, Rgb};

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
    /// Size of a tile, px.
    side: (f32, f32),
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
        let side = (as_f32(width) / as_f32(columns), as_f32(height) / as_f32(rows));
        let mut light = Self { columns, rows, side, tiles: medians(picture, columns, rows), full: [0.0; 3] };
        light.calm();
        if light.has_steps() {
            return None;
        }
        let mut sorted: Vec<[f32; 3]> = light.tiles.clone();
        sorted.sort_by(|one, other| sum(one).total_cmp(&sum(other)));
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
        let (left, right) = place(as_f32(x) / self.side.0, self.columns);
        let (above, down) = place(as_f32(y) / self.side.1, self.rows);
        let tile = |column: u32, row: u32| {
            let index = (row * self.columns + column) as usize;
            self.tiles.get(index).copied().unwrap_or(self.full)
        };
        let near = [(left, above), (left + 1, above), (left, above + 1), (left + 1, above + 1)];
        let [one, two, three, four] = near.map(|(column, row)| tile(column, row));
        let mut out = [0; 3];
        let tiles = one.iter().zip(two).zip(three).zip(four).zip(self.full);
        for ((out, level), ((((one, two), three), four), full)) in out.iter_mut().zip(colour).zip(tiles) {
            let (upper, lower) = (one + (two - one) * right, three + (four - three) * right);
            let paper = (upper + (lower - upper) * down).max(1.0);
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

/// The tile before a place, of which the last has none behind it, and how far the place is from its middle to
/// the next one's; beyond the outermost middles the change goes on.
fn place(at: f32, tiles: u32) -> (u32, f32) {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of tiles")]
    let before = ((at - 0.5).max(0.0) as u32).min(tiles.saturating_sub(2));
    (before, at - 0.5 - as_f32(before))
}

/// The median of each tile's channels.
fn medians(picture: &Colour, columns: u32, rows: u32) -> Vec<[f32; 3]> {
    let cut = |index: u32, of: u32, length: u32| {
        let at = |index: u32| (index * (length / of) + index * (length % of) / of) as usize;
        at(index)..at(index + 1)
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
