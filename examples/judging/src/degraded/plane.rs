//! [`Plane`]: one number for each pixel.

/// Of a bell curve, so many standard deviations to either side are kept: 99.7 %.
const KERNEL_SD: f64 = 3.0;

/// A bell curve wider than this, px, is made of three running means, whose time does not grow with it. Their
/// windows are whole pixels, so that the standard deviation is up to half a pixel off.
const MEANS_FROM_PX: f64 = 4.0;

/// Numbers in rows.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plane {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) values: Vec<f64>,
}

impl Plane {
    pub(crate) fn even(width: usize, height: usize, value: f64) -> Self {
        Self { width, height, values: vec![value; width * height] }
    }

    pub(crate) fn from_fn(width: usize, height: usize, mut value: impl FnMut(f64, f64) -> f64) -> Self {
        let mut values = Vec::with_capacity(width * height);
        for y in 0..height {
            values.extend((0..width).map(|x| value(x as f64, y as f64)));
        }
        Self { width, height, values }
    }

    pub(crate) fn map(&self, change: impl Fn(f64) -> f64) -> Self {
        Self { values: self.values.iter().map(|value| change(*value)).collect(), ..*self }
    }

    pub(crate) fn with(&self, other: &Self, join: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            values: self.values.iter().zip(&other.values).map(|(one, two)| join(*one, *two)).collect(),
            ..*self
        }
    }

    /// The value between the four nearest pixel centres; beyond the edge, that at the edge.
    pub(crate) fn at(&self, x: f64, y: f64) -> f64 {
        let (column, across) = split(x, self.width);
        let (row, down) = split(y, self.height);
        let value = |x: usize, y: usize| {
            let place =
                y.min(self.height.saturating_sub(1)) * self.width + x.min(self.width.saturating_sub(1));
            self.values.get(place).copied().unwrap_or(0.0)
        };
        let between = |row| value(column, row) * (1.0 - across) + value(column + 1, row) * across;
        between(row) * (1.0 - down) + between(row + 1) * down
    }

    /// Each value the mean of its neighbours, weighted by a bell curve of this standard deviation, px.
    pub(crate) fn blurred(&self, sd_px: f64) -> Self {
        self.blurred_apart(sd_px, sd_px)
    }

    /// The same with another standard deviation along rows than along columns.
    pub(crate) fn blurred_apart(&self, across_px: f64, down_px: f64) -> Self {
        self.rows_blurred(across_px).transposed().rows_blurred(down_px).transposed()
    }

    /// The part that begins at a column and row and has this size.
    pub(crate) fn cut(&self, (left, top): (usize, usize), (width, height): (usize, usize)) -> Self {
        let rows = self.values.chunks(self.width.max(1)).skip(top).take(height);
        let values = rows.flat_map(|row| row.iter().skip(left).take(width).copied()).collect();
        Self { width, height, values }
    }

    pub(crate) fn mean(&self) -> f64 {
        self.values.iter().sum::<f64>() / self.values.len().max(1) as f64
    }

    /// Moved and stretched to mean 0 and variance 1.
    pub(crate) fn normalized(&self) -> Self {
        let mean = self.mean();
        let squares: f64 = self.values.iter().map(|value| (value - mean) * (value - mean)).sum();
        let sd = libm::sqrt(squares / self.values.len().max(1) as f64).max(f64::MIN_POSITIVE);
        self.map(|value| (value - mean) / sd)
    }

    fn rows_blurred(&self, sd_px: f64) -> Self {
        if sd_px > MEANS_FROM_PX {
            let reach = reach_of_means(sd_px);
            return self.rows_averaged(reach).rows_averaged(reach).rows_averaged(reach);
        }
        let kernel = bell(sd_px);
        let weighted =
            |near: &[f64]| near.iter().zip(&kernel).map(|(value, weight)| value * weight).sum::<f64>();
        self.rows_with(kernel.len() / 2, |padded, row| row.extend(padded.windows(kernel.len()).map(weighted)))
    }

    /// Each value the mean of those in its row that are at most `reach` away.
    fn rows_averaged(&self, reach: usize) -> Self {
        let count = (2 * reach + 1) as f64;
        self.rows_with(reach, |padded, row| {
            let (first, rest) = padded.split_at(2 * reach);
            let mut sum: f64 = first.iter().sum();
            for (last, first) in rest.iter().zip(padded) {
                sum += last;
                row.push(sum / count);
                sum -= first;
            }
        })
    }

    /// A new plane, made row by row of rows that are continued at both ends by `reach` times their last
    /// value.
    fn rows_with(&self, reach: usize, change: impl Fn(&[f64], &mut Vec<f64>)) -> Self {
        let mut values = Vec::with_capacity(self.values.len());
        let mut padded = Vec::with_capacity(self.width + 2 * reach);
        for row in self.values.chunks(self.width.max(1)) {
            let (first, last) = (row.first().copied().unwrap_or(0.0), row.last().copied().unwrap_or(0.0));
            padded.clear();
            padded.extend(core::iter::repeat_n(first, reach));
            padded.extend_from_slice(row);
            padded.extend(core::iter::repeat_n(last, reach));
            change(&padded, &mut values);
        }
        Self { values, ..*self }
    }

    fn transposed(&self) -> Self {
        let mut values = Vec::with_capacity(self.values.len());
        for x in 0..self.width {
            values.extend(self.values.iter().skip(x).step_by(self.width).copied());
        }
        Self { width: self.height, height: self.width, values }
    }
}

/// A place as the whole number below, and the rest.
fn split(value: f64, size: usize) -> (usize, f64) {
    let clamped = value.clamp(0.0, size.saturating_sub(1) as f64);
    let whole = libm::floor(clamped);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole and within the plane")]
    let place = whole as usize;
    (place, clamped - whole)
}

/// How far means over 2 r + 1 values reach, so that three in turn have the standard deviation: the variance
/// of each is ((2 r + 1)² - 1) / 12.
fn reach_of_means(sd_px: f64) -> usize {
    let reach = libm::round((libm::sqrt(4.0 * sd_px * sd_px + 1.0) - 1.0) / 2.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole, not negative, small")]
    let reach = reach as usize;
    reach
}

/// A bell curve's weights at whole distances; their sum is 1.
fn bell(sd_px: f64) -> Vec<f64> {
    if sd_px <= 0.0 {
        return vec![1.0];
    }
    let mut half = vec![1.0];
    let mut away = 1.0;
    while away <= libm::ceil(KERNEL_SD * sd_px) {
        half.push(libm::exp(-away * away / (2.0 * sd_px * sd_px)));
        away += 1.0;
    }
    let sum = 2.0 * half.iter().sum::<f64>() - 1.0;
    half.iter().skip(1).rev().chain(&half).map(|weight| weight / sum).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blurred_dot_keeps_its_sum_and_spreads_by_the_standard_deviation() {
        let dot = Plane::from_fn(41, 31, |x, y| if (x, y) == (20.0, 15.0) { 1.0 } else { 0.0 });
        let soft = dot.blurred_apart(2.0, 1.0);
        assert!((soft.values.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        let variance = |coordinate: fn(f64, f64) -> f64| {
            let squares = Plane::from_fn(41, 31, |x, y| coordinate(x, y) * coordinate(x, y));
            soft.with(&squares, |weight, square| weight * square).values.iter().sum::<f64>()
        };
        // The tails beyond three standard deviations are cut off.
        assert!((variance(|x, _| x - 20.0) - 4.0).abs() < 0.15);
        assert!((variance(|_, y| y - 15.0) - 1.0).abs() < 0.05);
    }

    #[test]
    fn a_wide_blur_has_its_standard_deviation_too() {
        let dot = Plane::from_fn(401, 1, |x, _| if x == 200.0 { 1.0 } else { 0.0 });
        let soft = dot.blurred_apart(30.0, 0.0);
        let places = soft.values.iter().zip(-200..=200);
        let variance: f64 = places.map(|(weight, place)| weight * f64::from(place * place)).sum();
        assert!((soft.values.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!((libm::sqrt(variance) - 30.0).abs() < 0.6, "{variance}");
    }

    #[test]
    fn a_ramp_between_pixels_is_a_ramp() {
        let ramp = Plane::from_fn(9, 7, |x, y| 2.0 * x - 3.0 * y);
        assert!((ramp.at(3.25, 2.5) + 1.0).abs() < 1e-12);
        assert_eq!((ramp.at(-4.0, 0.0), ramp.at(99.0, 0.0)), (0.0, 16.0));
    }
}
