//! [`Paper`]: how dark the bare paper is, and how rough, tile by tile.

use super::plane::{LEVEL, Plane, WHITE, rounded};
use super::sheet_edge::SheetEdge;
use crate::parallel::each;
use core::ops::Range;

/// Least side of a tile, px: some thousand pixels tell a median to a part of the noise.
const LEAST_SIDE_PX: usize = 48;

/// Tiles along the shorter side of a picture, at most.
const MOST_TILES: usize = 24;

/// Steps of the histograms in a level.
const STEPS: f32 = 16.0;

/// The share of pixels below one standard deviation under the median of noise.
const ONE_SIGMA: f64 = 0.1587;

/// Paper is never darker than this, levels.
pub(super) const DARKEST_PAPER: f32 = 8.0;

/// Noise that is never less, levels: a picture is stored in whole ones.
const LEAST_NOISE: f32 = 0.7;

/// A tile whose noise is so many times the usual, in levels of the picture, is full of lines: these spread
/// its darkness, and the paper between them is as elsewhere. A sensor's noise is the same in light and
/// shadow to a few parts in ten; lines of a grid every four widths double that of a picture with 17 levels
/// of contrast.
const FULL_OF_LINES: f32 = 1.5;

/// And so is one that is darker than usual by so many standard deviations of the usual noise: the median of a
/// thousand pixels is that of the paper to a twentieth of one.
const DARKER: f32 = 3.0;

/// The darkness that bare paper seems to have, and the standard deviation of its noise, in levels of a plane.
#[derive(Clone, Debug)]
pub(super) struct Paper {
    tiles: Tiles,
    /// How light the paper is in each tile, a part of white.
    lights: Vec<f32>,
    offsets: Vec<f32>,
    noise: Vec<f32>,
    /// The median of all tiles' noise.
    pub(super) usual_noise: f32,
}

impl Paper {
    /// Measures a plane of darkness, where the sheet is if that is known: lines are the minority in most
    /// tiles. `light` is how light the paper is, in half the size.
    pub(super) fn of(darkness: &Plane, light: &Plane, sheet: Option<SheetEdge>) -> Self {
        let tiles = Tiles::of(darkness);
        let lights = tiles.each(|rows, columns| {
            let rows =
                rows.step_by(2).filter_map(|y| light.row(y / 2).get(columns.start / 2..columns.end / 2));
            let (mut sum, mut count) = (0.0_f32, 0.0_f32);
            for value in rows.flatten() {
                sum += f32::from(*value);
                count += 1.0;
            }
            (sum / count.max(1.0)).max(DARKEST_PAPER * LEVEL) / f32::from(WHITE)
        });
        Self::lit(darkness, lights, sheet)
    }

    /// Measures another plane of darkness in the same light.
    pub(super) fn again(&self, darkness: &Plane, sheet: Option<SheetEdge>) -> Self {
        Self::lit(darkness, self.lights.clone(), sheet)
    }

    fn lit(darkness: &Plane, lights: Vec<f32>, sheet: Option<SheetEdge>) -> Self {
        let tiles = Tiles::of(darkness);
        let found = tiles.measured(darkness, sheet);
        // In levels of the picture, which are a smaller part of darker paper.
        let seen = || found.iter().zip(&lights).filter_map(|(found, light)| Some((found.as_ref()?, light)));
        let usual_noise = median(seen().map(|((_, noise), light)| noise * light)).max(LEAST_NOISE * LEVEL);
        let usual_offset = median(seen().map(|((offset, _), light)| offset * light));
        let (mut offsets, mut noise) = (Vec::new(), Vec::new());
        for (found, light) in found.iter().zip(&lights) {
            let is_paper = |(offset, noise): &&(f32, f32)| {
                noise * light <= FULL_OF_LINES * usual_noise
                    && offset * light <= usual_offset + DARKER * usual_noise
            };
            let usual = (usual_offset / light, usual_noise / light);
            let (offset, sd) = found.as_ref().filter(is_paper).copied().unwrap_or(usual);
            offsets.push(offset);
            noise.push(sd.max(LEAST_NOISE * LEVEL));
        }
        let usual_noise = median(noise.iter().copied());
        let (offsets, noise) = (tiles.calmed(&offsets), tiles.calmed(&noise));
        Self { tiles, lights, offsets, noise, usual_noise }
    }

    /// The medians alone of a plane of levels, as offsets.
    pub(super) fn medians(levels: &Plane) -> Self {
        let tiles = Tiles::of(levels);
        let found: Vec<(f32, f32)> =
            tiles.measured(levels, None).into_iter().map(Option::unwrap_or_default).collect();
        let usual_noise = median(found.iter().map(|(_, noise)| *noise)).max(LEAST_NOISE * LEVEL);
        let offsets: Vec<f32> = found.iter().map(|(offset, _)| *offset).collect();
        let offsets = tiles.calmed(&offsets);
        Self { tiles, lights: Vec::new(), noise: vec![usual_noise; offsets.len()], offsets, usual_noise }
    }

    /// The same paper with noise so many times as strong.
    pub(super) fn make_rougher(&mut self, times: f32) {
        self.noise.iter_mut().for_each(|noise| *noise *= times);
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

    fn of_tile(&self, values: &[f32], x: usize, y: usize) -> Option<f32> {
        values.get(self.tiles.at(x, y)).copied()
    }

    fn row_of(&self, values: &[f32], y: usize) -> Vec<f32> {
        self.tiles.row_of(values, y)
    }
}

/// A plane in tiles.
#[derive(Clone, Copy, Debug)]
struct Tiles {
    width: usize,
    height: usize,
    columns: usize,
    rows: usize,
}

impl Tiles {
    fn of(plane: &Plane) -> Self {
        let (width, height) = (plane.width, plane.height);
        let side = (width.min(height) / MOST_TILES).max(LEAST_SIDE_PX);
        let along = |length: usize| ((length + side / 2) / side).max(1);
        Self { width, height, columns: along(width), rows: along(height) }
    }

    /// What `of` says of each tile, given its rows and columns.
    fn each<T: Send>(&self, of: impl Fn(Range<usize>, Range<usize>) -> T + Sync) -> Vec<T> {
        let tiles = (0..self.rows).flat_map(|row| (0..self.columns).map(move |column| (row, column)));
        let cut = |index: usize, of: usize, length: usize| index * length / of..(index + 1) * length / of;
        each(tiles.collect(), |(row, column)| {
            of(cut(row, self.rows, self.height), cut(column, self.columns, self.width))
        })
    }

    /// The median of each tile, and how far above the standard deviation below it is; none of a tile that
    /// lies mostly beside the sheet.
    fn measured(&self, plane: &Plane, sheet: Option<SheetEdge>) -> Vec<Option<(f32, f32)>> {
        self.each(|rows, columns| {
            let mut counts = vec![0_u32; 4096];
            let (mut total, all) = (0_u32, rows.len() * columns.len());
            for y in rows {
                let on_sheet = sheet.map_or(0..plane.width, |sheet| sheet.columns(y, plane.width));
                let from = columns.start.max(on_sheet.start);
                let own = from..columns.end.min(on_sheet.end).max(from);
                for value in plane.row(y).get(own).unwrap_or(&[]) {
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
            (2 * total as usize >= all).then(|| (median, median - at(ONE_SIGMA)))
        })
    }

    /// The number of the tile at a place.
    fn at(&self, x: usize, y: usize) -> usize {
        let index = |at: usize, of: usize, length: usize| (at * of / length.max(1)).min(of.saturating_sub(1));
        index(y, self.rows, self.height) * self.columns + index(x, self.columns, self.width)
    }

    /// Tiles' values in a row of pixels: between the middles of tiles as the crow flies.
    fn row_of(&self, values: &[f32], y: usize) -> Vec<f32> {
        let (upper, down) = place(y, self.rows, self.height);
        let line = |row: usize| values.get(row.min(self.rows - 1) * self.columns..).unwrap_or(&[]);
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

    /// Each tile as the median of the nine around it: one that ink fills is as its neighbours.
    fn calmed(&self, values: &[f32]) -> Vec<f32> {
        let mut out = Vec::with_capacity(values.len());
        for row in 0..self.rows {
            for column in 0..self.columns {
                let near = (row.saturating_sub(1)..=(row + 1).min(self.rows - 1)).flat_map(|row| {
                    let columns_near = column.saturating_sub(1)..(column + 2).min(self.columns);
                    values.get(row * self.columns..).unwrap_or(&[]).get(columns_near).unwrap_or(&[]).iter()
                });
                out.push(median(near.copied()));
            }
        }
        out
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

fn median(values: impl Iterator<Item = f32>) -> f32 {
    let mut values: Vec<f32> = values.collect();
    values.sort_by(f32::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
