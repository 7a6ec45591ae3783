//! [`Coarse`]: a picture in few pixels, in which a sheet's sides are long and its drawing is gone.

use crate::picture::Gray;

/// The longer side has at most so many pixels: sides of a sheet are hundreds of them, and a line drawn on it
/// is a few.
const MOST_PX: u32 = 640;

/// Lines narrower than twice this and a pixel are closed, coarse px.
const CLOSED_PX: usize = 3;

/// A picture in few pixels.
#[derive(Clone, Debug)]
pub(super) struct Coarse {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Columns and rows of the picture to one of this.
    pub(super) factor: usize,
    levels: Vec<f32>,
}

impl Coarse {
    /// A picture's levels as means of squares; what is left of the last one at the right and below is left
    /// out.
    pub(super) fn of(picture: &Gray) -> Self {
        let factor = picture.width().max(picture.height()).div_ceil(MOST_PX).max(1) as usize;
        let (width, height) = (picture.width() as usize / factor, picture.height() as usize / factor);
        let mut levels = Vec::with_capacity(width * height);
        let mut sums = vec![0_u32; width];
        for (y, row) in (1..).zip(picture.rows().take(height * factor)) {
            for (sum, square) in sums.iter_mut().zip(row.chunks_exact(factor)) {
                *sum += square.iter().map(|level| u32::from(*level)).sum::<u32>();
            }
            if y % factor == 0 {
                let pixels = (factor * factor) as f32;
                levels.extend(sums.iter_mut().map(|sum| core::mem::take(sum) as f32 / pixels));
            }
        }
        Self { width, height, factor, levels }
    }

    /// Without its thin dark lines: the least of the greatest levels around, and smoothed a little.
    pub(super) fn without_lines(&self) -> Self {
        let wide = |levels: &[f32]| extreme(levels, CLOSED_PX, f32::max);
        let narrow = |levels: &[f32]| extreme(levels, CLOSED_PX, f32::min);
        let smooth = |levels: &[f32]| smoothed(&smoothed(levels));
        self.in_rows_and_columns(wide).in_rows_and_columns(narrow).in_rows_and_columns(smooth)
    }

    /// The level of a place, between the four middles around it; none outside. Pixel (i, j) has its middle
    /// at (i + ½, j + ½).
    pub(super) fn at(&self, x: f64, y: f64) -> Option<f32> {
        if !(x >= 0.0 && y >= 0.0 && x <= self.width as f64 && y <= self.height as f64) {
            return None;
        }
        let (column, across) = split(x, self.width);
        let (row, down) = split(y, self.height);
        let level = |column: usize, row: usize| self.get(column, row);
        let upper = level(column, row) * (1.0 - across) + level(column + 1, row) * across;
        let lower = level(column, row + 1) * (1.0 - across) + level(column + 1, row + 1) * across;
        Some(upper * (1.0 - down) + lower * down)
    }

    /// The level of a pixel; beyond the edge that at the edge.
    pub(super) fn get(&self, column: usize, row: usize) -> f32 {
        let column = column.min(self.width.saturating_sub(1));
        let row = row.min(self.height.saturating_sub(1));
        self.levels.get(row * self.width + column).copied().unwrap_or(0.0)
    }

    fn in_rows_and_columns(&self, work: impl Fn(&[f32]) -> Vec<f32>) -> Self {
        self.in_rows(&work).transposed().in_rows(&work).transposed()
    }

    fn in_rows(&self, work: impl Fn(&[f32]) -> Vec<f32>) -> Self {
        let levels = self.levels.chunks(self.width.max(1)).flat_map(work).collect();
        Self { levels, ..*self }
    }

    fn transposed(&self) -> Self {
        let column = |x: usize| self.levels.iter().skip(x).step_by(self.width.max(1)).copied();
        let levels = (0..self.width).flat_map(column).collect();
        Self { width: self.height, height: self.width, levels, ..*self }
    }
}

/// A coordinate as the pixel whose middle lies before it, and how far it is on to the next.
fn split(at: f64, length: usize) -> (usize, f32) {
    let at = (at - 0.5).clamp(0.0, length.saturating_sub(1) as f64);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the picture")]
    let before = at as usize;
    #[expect(clippy::cast_possible_truncation, reason = "a part of a pixel")]
    let part = (at - before as f64) as f32;
    (before, part)
}

/// The extreme of each value and those at most `reach` from it.
fn extreme(levels: &[f32], reach: usize, of: fn(f32, f32) -> f32) -> Vec<f32> {
    let around = |at: usize| levels.get(at.saturating_sub(reach)..levels.len().min(at + reach + 1));
    let extreme = |at: usize| around(at).and_then(|around| around.iter().copied().reduce(of));
    (0..levels.len()).map(|at| extreme(at).unwrap_or(0.0)).collect()
}

/// Each value with its neighbours, by 1 : 2 : 1.
fn smoothed(levels: &[f32]) -> Vec<f32> {
    let level = |at: usize| levels.get(at.min(levels.len().saturating_sub(1))).copied().unwrap_or(0.0);
    let mean = |at: usize| (level(at.saturating_sub(1)) + 2.0 * level(at) + level(at + 1)) / 4.0;
    (0..levels.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_is_the_mean_of_its_square_and_thin_lines_are_gone() {
        // 1280 px become 640; a dark line of 4 px is 2 of those, a dark table of 200 px stays.
        let level = |x: u32| if (600..604).contains(&x) || x < 200 { 20 } else { 220 };
        let levels = (0..8).flat_map(|_| (0..1280).map(level)).collect();
        let coarse = Coarse::of(&Gray::new(1280, 8, levels).unwrap());
        assert_eq!((coarse.width, coarse.height, coarse.factor), (640, 4, 2));
        assert_eq!((coarse.get(301, 1), coarse.get(50, 1), coarse.get(400, 1)), (20.0, 20.0, 220.0));
        let closed = coarse.without_lines();
        assert_eq!((closed.get(301, 1), closed.get(50, 1)), (220.0, 20.0));
        // The step stays between the columns 99 and 100, at 100 from the left.
        assert_eq!(closed.at(100.0, 2.0), Some(120.0));
        assert_eq!(closed.at(-0.1, 2.0), None);
    }
}
