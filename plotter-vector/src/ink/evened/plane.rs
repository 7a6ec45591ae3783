//! [`Plane`]: levels to a 256th, and what is done with all of them at once.

use crate::parallel::each;
use crate::picture::Gray;

/// A level, in a plane.
pub(super) const LEVEL: f32 = 256.0;

/// White, in a plane.
pub(super) const WHITE: u16 = 255 << 8;

/// Rows that a thread takes at a time: enough work for it to begin.
const ROWS_TOGETHER: usize = 32;

/// Half width of a Gaussian's kernel in standard deviations: what lies beyond is below 2 % of its weight.
const REACH: f32 = 2.5;

/// A picture of levels with 8 bits behind the point, row by row.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) values: Vec<u16>,
}

impl Plane {
    pub(super) fn new(width: usize, height: usize) -> Self {
        Self { width, height, values: vec![0; width * height] }
    }

    pub(super) fn row(&self, y: usize) -> &[u16] {
        self.values.get(y * self.width..(y + 1) * self.width).unwrap_or(&[])
    }

    /// The value so far from a place; beyond the edge stands the edge's.
    pub(super) fn near(&self, x: usize, y: usize, dx: isize, dy: isize) -> u16 {
        let x = x.saturating_add_signed(dx).min(self.width.saturating_sub(1));
        let y = y.saturating_add_signed(dy).min(self.height.saturating_sub(1));
        self.values.get(y * self.width + x).copied().unwrap_or(0)
    }

    /// Some rows at a time for each thread: the first one's number, and the rows.
    pub(super) fn in_rows(&mut self, work: impl Fn(usize, &mut [u16]) + Sync) {
        let width = self.width.max(1);
        let parts = self.values.chunks_mut(width * ROWS_TOGETHER).enumerate().collect();
        each(parts, |(index, rows): (usize, &mut [u16])| {
            for (y, row) in (index * ROWS_TOGETHER..).zip(rows.chunks_mut(width)) {
                work(y, row);
            }
        });
    }

    /// A picture's levels through a Gaussian of `sigma_px`; inverted, for light ink.
    pub(super) fn smoothed(gray: &Gray, sigma_px: f32, inverted: bool) -> Self {
        let (width, height) = (gray.width() as usize, gray.height() as usize);
        let mut across = Self::new(width, height);
        let kernel = kernel(sigma_px);
        let rows: Vec<&[u8]> = gray.rows().collect();
        across.in_rows(|y, out| {
            let levels = rows.get(y).copied().unwrap_or(&[]);
            let level = |level: &u8| f32::from(if inverted { !*level } else { *level }) * LEVEL;
            smooth_row(&levels.iter().map(level).collect::<Vec<_>>(), &kernel, out);
        });
        across.smoothed_down(&kernel)
    }

    /// The plane through a Gaussian of `sigma_px`.
    pub(super) fn blurred(&self, sigma_px: f32) -> Self {
        let kernel = kernel(sigma_px);
        self.smoothed_across(&kernel).smoothed_down(&kernel)
    }

    /// Each value and, once more, what it has more than a Gaussian of `sigma_px` around it: what smoothing has
    /// widened is narrow again.
    pub(super) fn sharpen(&mut self, sigma_px: f32) {
        let kernel = kernel(sigma_px);
        let across = self.smoothed_across(&kernel);
        self.in_rows(|y, row| {
            for (value, soft) in row.iter_mut().zip(across.down(y, &kernel)) {
                *value = rounded(2.0 * f32::from(*value) - f32::from(rounded(soft)));
            }
        });
    }

    fn smoothed_across(&self, kernel: &[f32]) -> Self {
        let mut across = Self::new(self.width, self.height);
        across.in_rows(|y, out| {
            smooth_row(&self.row(y).iter().map(|v| f32::from(*v)).collect::<Vec<_>>(), kernel, out);
        });
        across
    }

    fn smoothed_down(&self, kernel: &[f32]) -> Self {
        let mut out = Self::new(self.width, self.height);
        out.in_rows(|y, out| {
            out.iter_mut().zip(self.down(y, kernel)).for_each(|(out, sum)| *out = rounded(sum));
        });
        out
    }

    /// Row `y` through a kernel that stands upright.
    fn down(&self, y: usize, kernel: &[f32]) -> Vec<f32> {
        let reach = kernel.len() / 2;
        let last = self.height.saturating_sub(1);
        let mut sums = vec![0.0_f32; self.width];
        for (tap, weight) in kernel.iter().enumerate() {
            let from = (y + tap).saturating_sub(reach).min(last);
            for (sum, value) in sums.iter_mut().zip(self.row(from)) {
                *sum += weight * f32::from(*value);
            }
        }
        sums
    }

    /// Half as wide and high: of each two by two values what `of` makes of them, two and two.
    pub(super) fn halved(&self, of: impl Fn(u16, u16) -> u16 + Sync) -> Self {
        let mut out = Self::new(self.width.div_ceil(2), self.height.div_ceil(2));
        out.in_rows(|y, out| {
            let (upper, lower) = (self.row(2 * y), self.row((2 * y + 1).min(self.height.saturating_sub(1))));
            for ((out, a), b) in out.iter_mut().zip(upper.chunks(2)).zip(lower.chunks(2)) {
                let two = |pair: &[u16]| match *pair {
                    [one, other] => of(one, other),
                    [one] => one,
                    _ => 0,
                };
                *out = of(two(a), two(b));
            }
        });
        out
    }

    /// Row `y` of this plane of half the size, stretched to the whole: between middles as the crow flies.
    pub(super) fn doubled_row(&self, y: usize, out: &mut [f32]) {
        let near = |i: usize, length: usize| -> (usize, usize) {
            let other = if i.is_multiple_of(2) { (i / 2).saturating_sub(1) } else { i / 2 + 1 };
            ((i / 2).min(length.saturating_sub(1)), other.min(length.saturating_sub(1)))
        };
        let (at, beside) = near(y, self.height);
        let (upper, lower) = (self.row(at), self.row(beside));
        let column = |x: usize| {
            let value = |row: &[u16]| f32::from(row.get(x).copied().unwrap_or_default());
            0.75 * value(upper) + 0.25 * value(lower)
        };
        for (x, out) in out.iter_mut().enumerate() {
            let (at, beside) = near(x, self.width);
            *out = 0.75 * column(at) + 0.25 * column(beside);
        }
    }

    /// The closing: the least of the greatest values in windows of `radius_px`. Beyond the edge stand the
    /// edge's values, also for the greatest ones there: where the light falls off toward the edge it stays.
    pub(super) fn closed(&self, radius_px: usize) -> Self {
        let (width, height) = (self.width + 2 * radius_px, self.height + 2 * radius_px);
        let mut wide = Self::new(width, height);
        let inside = |at: usize, length: usize| at.saturating_sub(radius_px).min(length.saturating_sub(1));
        wide.in_rows(|y, out| {
            let row = self.row(inside(y, self.height));
            for (x, out) in out.iter_mut().enumerate() {
                *out = row.get(inside(x, self.width)).copied().unwrap_or(0);
            }
        });
        let wide = wide.extreme(radius_px, false).extreme(radius_px, true);
        let mut out = Self::new(self.width, self.height);
        out.in_rows(|y, out| {
            let row = wide.row(y + radius_px).iter().skip(radius_px);
            out.iter_mut().zip(row).for_each(|(out, value)| *out = *value);
        });
        out
    }

    /// The greatest value within `radius_px` columns and rows of each, or with `least` the least one.
    ///
    /// The windows double: the best of 2 n values is that of two windows of n.
    pub(super) fn extreme(mut self, radius_px: usize, least: bool) -> Self {
        let best = move |a: u16, b: u16| if least { a.min(b) } else { a.max(b) };
        let length = 2 * radius_px + 1;
        self.in_rows(|_, row| {
            // As wide a rim on each side as the window reaches, of the row's ends.
            let (first, last) = (row.first().copied().unwrap_or(0), row.last().copied().unwrap_or(0));
            let mut wide = vec![first; radius_px];
            wide.extend_from_slice(row);
            wide.resize(row.len() + 2 * radius_px, last);
            let mut span = 1;
            while span < length {
                let step = span.min(length - span);
                for x in 0..wide.len().saturating_sub(step) {
                    if let (Some(a), Some(b)) = (wide.get(x).copied(), wide.get(x + step).copied())
                        && let Some(slot) = wide.get_mut(x)
                    {
                        *slot = best(a, b);
                    }
                }
                span += step;
            }
            row.iter_mut().zip(wide).for_each(|(out, value)| *out = value);
        });
        let width = self.width.max(1);
        let edge = |y: usize| self.row(y).to_vec();
        let mut tall = Vec::with_capacity(width * (self.height + 2 * radius_px));
        let first = edge(0);
        (0..radius_px).for_each(|_| tall.extend_from_slice(&first));
        let last = edge(self.height.saturating_sub(1));
        tall.append(&mut self.values);
        (0..radius_px).for_each(|_| tall.extend_from_slice(&last));
        let mut span = 1;
        while span < length {
            let step = span.min(length - span);
            let shift = step * width;
            for start in (0..tall.len().saturating_sub(shift)).step_by(width) {
                let (upper, lower) = tall.split_at_mut(start + shift);
                if let Some(upper) = upper.get_mut(start..start + width) {
                    upper.iter_mut().zip(lower).for_each(|(a, b)| *a = best(*a, *b));
                }
            }
            span += step;
        }
        tall.truncate(width * self.height);
        Self { values: tall, ..self }
    }
}

/// A row through a kernel; beyond its ends stand their values.
fn smooth_row(values: &[f32], kernel: &[f32], out: &mut [u16]) {
    let reach = kernel.len() / 2;
    let (first, last) = (values.first().copied().unwrap_or(0.0), values.last().copied().unwrap_or(0.0));
    let mut wide = vec![first; reach];
    wide.extend_from_slice(values);
    wide.resize(values.len() + 2 * reach, last);
    let mut sums = vec![0.0_f32; values.len()];
    for (tap, weight) in kernel.iter().enumerate() {
        for (sum, value) in sums.iter_mut().zip(wide.get(tap..).unwrap_or(&[])) {
            *sum += weight * value;
        }
    }
    out.iter_mut().zip(sums).for_each(|(out, sum)| *out = rounded(sum));
}

/// The weights of a Gaussian, together 1.
fn kernel(sigma_px: f32) -> Vec<f32> {
    #[expect(clippy::cast_possible_truncation, reason = "some pixels")]
    let reach = libm::ceilf(REACH * sigma_px) as i16;
    let weight = |x: i16| libm::expf(-f32::from(x) * f32::from(x) / (2.0 * sigma_px * sigma_px));
    let weights: Vec<f32> = (-reach..=reach).map(weight).collect();
    let sum: f32 = weights.iter().sum();
    weights.iter().map(|weight| weight / sum).collect()
}

/// The nearest value of a plane.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "it is clamped to the type's range"
)]
pub(super) fn rounded(value: f32) -> u16 {
    (value + 0.5).clamp(0.0, 65_535.0) as u16
}

/// How many whole pixels a length has.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some pixels")]
pub(super) fn whole(px: f32) -> usize {
    px.max(0.0) as usize
}

/// The mean of two values.
pub(super) fn mean(a: u16, b: u16) -> u16 {
    a / 2 + b / 2 + (a & b & 1)
}
