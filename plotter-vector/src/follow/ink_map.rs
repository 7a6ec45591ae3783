//! [`InkMap`]: what a camera sees of lines, drawn to compare it with a window.

use super::flat::Flat;
use super::lines::count_f64;
use super::paper::each_covered;
use super::whole::{floor, inside};
use crate::stroke::PxPoint;

/// Blur of a web camera, px: standard deviation.
pub(super) const BLUR_PX: f64 = 1.5;

/// Pixels to either side of one that its blur takes in: three standard deviations and a half.
const REACH: usize = 5;

/// Darkness of each pixel of a part of a window.
pub(super) struct InkMap {
    width: usize,
    height: usize,
    left: f64,
    top: f64,
    cells: Vec<f32>,
    kernel: [f32; 2 * REACH + 1],
}

impl InkMap {
    /// Without ink, of a window's size.
    pub(super) fn of(flat: &Flat) -> Self {
        let (width, height) = flat.size();
        let [left, top] = flat.origin().map(count_f64);
        let bell = |i: usize| {
            let off = (count_f64(i) - count_f64(REACH)) / BLUR_PX;
            libm::exp(-0.5 * off * off)
        };
        let sum: f64 = (0..=2 * REACH).map(bell).sum();
        #[expect(clippy::cast_possible_truncation, reason = "a share")]
        let kernel = core::array::from_fn(|i| (bell(i) / sum) as f32);
        Self { width, height, left, top, cells: vec![0.0; width * height], kernel }
    }

    /// Draws a straight line: each pixel is as dark as its darkest line.
    pub(super) fn draw(&mut self, from: PxPoint, to: PxPoint, half_px: f64, dark: f64) {
        let ends = [from, to].map(|at| PxPoint::new(at.x - self.left, at.y - self.top));
        each_covered((self.width, self.height), ends, half_px, |index, covered| {
            #[expect(clippy::cast_possible_truncation, reason = "a share")]
            let ink = (covered.min(2.0 * half_px) * dark) as f32;
            if let Some(cell) = self.cells.get_mut(index) {
                *cell = cell.max(ink);
            }
        });
    }

    /// Takes the map from a window: what that is darker stays, and the sum of its squares.
    pub(super) fn taken_from(&mut self, flat: &Flat) -> f64 {
        let width = self.width.max(1);
        let mut sum = 0.0;
        for (row, cells) in flat.rows().zip(self.cells.chunks_mut(width)) {
            let mut squares = 0.0_f32;
            for (dark, cell) in row.iter().zip(cells) {
                *cell = dark - *cell;
                squares += *cell * *cell;
            }
            sum += f64::from(squares);
        }
        sum
    }

    /// Blurs it as the camera does.
    pub(super) fn blur(&mut self) {
        let width = self.width.max(1);
        // Along rows, then down columns; a row of pixels at a time.
        let mut along = vec![0.0_f32; self.cells.len()];
        for (out, row) in along.chunks_mut(width).zip(self.cells.chunks(width)) {
            for (i, share) in self.kernel.iter().enumerate() {
                let (from, to) = (i.saturating_sub(REACH), REACH.saturating_sub(i));
                let out = out.get_mut(to..).unwrap_or_default();
                add(out, row.get(from..).unwrap_or(&[]), *share);
            }
        }
        self.cells.iter_mut().for_each(|cell| *cell = 0.0);
        for (y, out) in self.cells.chunks_mut(width).enumerate() {
            for (i, share) in self.kernel.iter().enumerate() {
                let row = (y + i).checked_sub(REACH).and_then(|row| along.chunks(width).nth(row));
                add(out, row.unwrap_or(&[]), *share);
            }
        }
    }

    /// The value at a place, between four pixels; outside it is 0.
    pub(super) fn at(&self, place: PxPoint) -> f64 {
        let (x, y) = (place.x - 0.5 - self.left, place.y - 0.5 - self.top);
        let (column, row) = (floor(x), floor(y));
        let (u, v) = (x - f64::from(column), y - f64::from(row));
        let cell = |right: i32, down: i32| {
            let x = inside(column.saturating_add(right), self.width)?;
            let y = inside(row.saturating_add(down), self.height)?;
            self.cells.get(y * self.width + x).map(|cell| f64::from(*cell))
        };
        let cell = |right, down| cell(right, down).unwrap_or(0.0);
        let mix = |from: f64, to: f64, share: f64| from + (to - from) * share;
        mix(mix(cell(0, 0), cell(1, 0), u), mix(cell(0, 1), cell(1, 1), u), v)
    }
}

/// Adds a share of some numbers to others.
fn add(to: &mut [f32], from: &[f32], share: f32) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to += share * from);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::follow::{CameraSettings, Paper, SimulatedCamera};

    #[test]
    fn a_line_looks_as_the_camera_shows_it() {
        let line = [PxPoint::new(-20.0, 31.2), PxPoint::new(160.0, 44.7)];
        let paper = Paper::drawn(120, 80, &[(line.to_vec(), 5.0)]).unwrap();
        let settings = CameraSettings {
            width_px: 120,
            height_px: 80,
            noise_levels: 0.0,
            rim_light: 1.0,
            ..CameraSettings::default()
        };
        let window = SimulatedCamera::new(&paper, settings).window(PxPoint::new(60.0, 40.0));
        let flat = Flat::of(&window, None, None);
        let mut map = InkMap::of(&flat);
        map.draw(line[0], line[1], 2.5, f64::from(flat.at(PxPoint::new(60.0, 37.2))) / 0.9044);
        map.blur();
        let all = 120.0 * 80.0;
        let shown: f64 = flat.rows().flatten().map(|dark| f64::from(dark * dark)).sum();
        let left = map.taken_from(&flat);
        assert!(left < 0.01 * shown, "{left} of {shown} on {all} px");
    }
}
