//! [`Paper`]: how dark the bare paper is, and how rough, tile by tile.

use super::plane::{LEVEL, Plane, rounded};
use crate::parallel::each;

/// Least side of a tile, px: some thousand pixels tell a median to a part of the noise.
const LEAST_SIDE_PX: usize = 48;

/// Tiles along the shorter side of a picture, at most.
const MOST_TILES: usize = 24;

/// Steps of the histograms in a level.
const STEPS: f32 = 16.0;

/// The share of pixels below one standard deviation under the median of noise.
const ONE_SIGMA: f64 = 0.1587;

/// Noise that is never less, levels: a picture is stored in whole ones.
const LEAST_NOISE: f32 = 0.7;

/// A tile may be darker than most by so many levels, and its noise greater by so many times: what differs
/// more is full of ink.
const MOST_OFFSET: f32 = 8.0;
const MOST_NOISE: f32 = 4.0;

/// The darkness that bare paper seems to have, and the standard deviation of its noise, in levels of a plane.
#[derive(Clone, Debug)]
pub(super) struct Paper {
    width: usize,
    height: usize,
    columns: usize,
    rows: usize,
    offsets: Vec<f32>,
    noise: Vec<f32>,
    /// The median of all tiles' noise.
    pub(super) usual_noise: f32,
}

impl Paper {
    /// Measures a plane of darkness: lines are the minority in most tiles.
    pub(super) fn of(darkness: &Plane) -> Self {
        Self::measured(darkness, |offsets| {
            let most = median(offsets.iter().copied()) + MOST_OFFSET * LEVEL;
            offsets.iter().map(|offset| offset.min(most)).collect()
        })
    }

    fn measured(darkness: &Plane, bounded: impl Fn(&[f32]) -> Vec<f32>) -> Self {
        let (width, height) = (darkness.width, darkness.height);
        let side = (width.min(height) / MOST_TILES).max(LEAST_SIDE_PX);
        let along = |length: usize| ((length + side / 2) / side).max(1);
        let (columns, rows) = (along(width), along(height));
        let tiles = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))).collect();
        let cut = |index: usize, of: usize, length: usize| index * length / of..(index + 1) * length / of;
        let found: Vec<(f32, f32)> = each(tiles, |(row, column)| {
            let mut counts = vec![0_u32; 4096];
            let mut total = 0_u32;
            for y in cut(row, rows, height) {
                for value in darkness.row(y).get(cut(column, columns, width)).unwrap_or(&[]) {
                    if let Some(n) = counts.get_mut(usize::from(value >> 4)) {
                        *n += 1;
                    }
                    total += 1;
                }
            }
            let at = |share: f64| {
                let mut below = 0.0;
                let found = counts.iter().position(|n| {
                    below += f64::from(*n);
                    below >= share * f64::from(total)
                });
                f32::from(u16::try_from(found.unwrap_or(0)).unwrap_or(u16::MAX)) * LEVEL / STEPS
            };
            let median = at(0.5);
            (median, median - at(ONE_SIGMA))
        });
        let usual_noise = median(found.iter().map(|(_, noise)| *noise)).max(LEAST_NOISE * LEVEL);
        let offsets = bounded(&found.iter().map(|(offset, _)| *offset).collect::<Vec<_>>());
        let within = |noise: f32| noise.clamp(LEAST_NOISE * LEVEL, MOST_NOISE * usual_noise);
        let noise: Vec<f32> = found.iter().map(|(_, noise)| within(*noise)).collect();
        Self {
            width,
            height,
            columns,
            rows,
            offsets: calmed(&offsets, columns, rows),
            noise: calmed(&noise, columns, rows),
            usual_noise,
        }
    }

    /// The same paper with noise so many times as strong.
    pub(super) fn make_rougher(&mut self, times: f32) {
        self.noise.iter_mut().for_each(|noise| *noise *= times);
    }

    /// The medians alone of a plane of levels, as offsets.
    pub(super) fn medians(levels: &Plane) -> Self {
        Self::measured(levels, |found| found.to_vec())
    }

    /// The median of the tile at a place.
    pub(super) fn at(&self, x: usize, y: usize) -> f32 {
        self.of_tile(&self.offsets, x, y).unwrap_or(0.0)
    }

    /// Takes the paper's own darkness away.
    pub(super) fn take_from(&self, darkness: &mut Plane) {
        darkness.in_rows(|y, row| {
            let offsets = self.row_of(&self.offsets, y);
            row.iter_mut()
                .zip(offsets)
                .for_each(|(value, offset)| *value = rounded(f32::from(*value) - offset));
        });
    }

    /// The noise in row `y`.
    pub(super) fn noise_row(&self, y: usize) -> Vec<f32> {
        self.row_of(&self.noise, y)
    }

    /// The noise at a place, that of its tile.
    pub(super) fn noise_at(&self, x: usize, y: usize) -> f32 {
        self.of_tile(&self.noise, x, y).unwrap_or(self.usual_noise)
    }

    fn of_tile(&self, tiles: &[f32], x: usize, y: usize) -> Option<f32> {
        let index = |at: usize, of: usize, length: usize| (at * of / length.max(1)).min(of.saturating_sub(1));
        let (column, row) = (index(x, self.columns, self.width), index(y, self.rows, self.height));
        tiles.get(row * self.columns + column).copied()
    }

    /// Tiles' values in a row of pixels: between the middles of tiles as the crow flies.
    fn row_of(&self, tiles: &[f32], y: usize) -> Vec<f32> {
        let (upper, down) = place(y, self.rows, self.height);
        let line = |row: usize| tiles.get(row.min(self.rows - 1) * self.columns..).unwrap_or(&[]);
        let along: Vec<f32> = line(upper)
            .iter()
            .zip(line(upper + 1))
            .take(self.columns)
            .map(|(a, b)| a + (b - a) * down)
            .collect();
        let value = |column: usize| along.get(column.min(self.columns - 1)).copied().unwrap_or(0.0);
        (0..self.width)
            .map(|x| {
                let (column, right) = place(x, self.columns, self.width);
                let (a, b) = (value(column), value(column + 1));
                a + (b - a) * right
            })
            .collect()
    }
}

/// The tile whose middle lies before a pixel, and how far the pixel is from there to the next, 0 to 1.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a picture's side"
)]
fn place(at: usize, tiles: usize, length: usize) -> (usize, f32) {
    let along = (at as f32 + 0.5) * tiles as f32 / length.max(1) as f32 - 0.5;
    let along = along.clamp(0.0, tiles.saturating_sub(1) as f32);
    (along as usize, along - libm::floorf(along))
}

/// Each tile as the median of the nine around it: one that ink fills is as its neighbours.
fn calmed(tiles: &[f32], columns: usize, rows: usize) -> Vec<f32> {
    let mut out = Vec::with_capacity(tiles.len());
    for row in 0..rows {
        for column in 0..columns {
            let near = (row.saturating_sub(1)..=(row + 1).min(rows - 1)).flat_map(|row| {
                let columns_near = column.saturating_sub(1)..(column + 2).min(columns);
                tiles.get(row * columns..).unwrap_or(&[]).get(columns_near).unwrap_or(&[]).iter().copied()
            });
            out.push(median(near));
        }
    }
    out
}

fn median(values: impl Iterator<Item = f32>) -> f32 {
    let mut values: Vec<f32> = values.collect();
    values.sort_by(f32::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
