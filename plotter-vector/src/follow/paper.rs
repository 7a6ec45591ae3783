//! [`Paper`]: the drawing under the simulated camera.

use super::whole::{count, floor, inside, level};
use crate::{Gray, GrayError, PxPoint};

/// A drawing on white paper, as shares of the light that each place reflects. A camera pixel sees a pixel of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Paper {
    width: usize,
    height: usize,
    reflected: Vec<f32>,
}

impl Paper {
    /// The paper of a picture: 255 is white. Outside of the picture all is white.
    #[must_use]
    pub fn of(picture: &Gray) -> Self {
        let reflected = picture.pixels().iter().map(|level| f32::from(*level) / 255.0).collect();
        Self { width: picture.width() as usize, height: picture.height() as usize, reflected }
    }

    /// Strokes of a round pen: polylines in pixels of the paper, each with the width of its pen in px. A pixel is as dark as the
    /// pen covers it.
    ///
    /// # Errors
    /// A size that no picture may have.
    ///
    /// ```
    /// # use plotter_vector::{PxPoint, follow::Paper};
    /// let line = vec![PxPoint::new(0.0, 2.0), PxPoint::new(8.0, 2.0)];
    /// let paper = Paper::drawn(8, 4, &[(line, 2.0)])?;
    /// assert_eq!(paper.picture()?.pixels()[..32].chunks(8).map(|row| row[4]).collect::<Vec<_>>(), [255, 0, 0, 255]);
    /// # Ok::<(), plotter_vector::GrayError>(())
    /// ```
    pub fn drawn(width: u32, height: u32, strokes: &[(Vec<PxPoint>, f64)]) -> Result<Self, GrayError> {
        let mut paper = Self::of(&Gray::new(width, height, vec![255; width as usize * height as usize])?);
        for (stroke, pen_px) in strokes {
            for pair in stroke.windows(2) {
                if let [from, to] = pair {
                    paper.draw(*from, *to, 0.5 * pen_px);
                }
            }
        }
        Ok(paper)
    }

    fn draw(&mut self, from: PxPoint, to: PxPoint, radius_px: f64) {
        each_covered((self.width, self.height), [from, to], radius_px, |index, covered| {
            #[expect(clippy::cast_possible_truncation, reason = "from 0 to 1")]
            let left = 1.0 - covered as f32;
            if let Some(share) = self.reflected.get_mut(index) {
                *share = share.min(left);
            }
        });
    }

    /// Size of the paper, px.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The paper as a picture.
    ///
    /// # Errors
    /// None for papers made of pictures.
    pub fn picture(&self) -> Result<Gray, GrayError> {
        let side = |side: usize| u32::try_from(side).unwrap_or(u32::MAX);
        let levels = self.reflected.iter().map(|share| level(255.0 * share)).collect();
        Gray::new(side(self.width), side(self.height), levels)
    }

    /// As an unfocused lens shows it: each point is a Gaussian spot of this standard deviation, px.
    #[must_use]
    pub(super) fn blurred(&self, sd_px: f64) -> Self {
        if sd_px <= 0.0 {
            return self.clone();
        }
        let reach = count(3.0 * sd_px).max(1);
        #[expect(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "a few pixels")]
        let weight = |i: usize| libm::exp(-0.5 * (i as f64 / sd_px) * (i as f64 / sd_px)) as f32;
        let half: Vec<f32> = (0..=reach).map(weight).collect();
        let sum: f32 = half.iter().skip(1).sum::<f32>() * 2.0 + 1.0;
        let kernel: Vec<f32> = half.iter().skip(1).rev().chain(&half).map(|weight| weight / sum).collect();
        let along = convolved(&self.reflected, self.width, &kernel);
        let turned = transposed(&along, self.width, self.height);
        let across = convolved(&turned, self.height, &kernel);
        Self { reflected: transposed(&across, self.height, self.width), ..*self }
    }

    /// The share of the light that a place reflects, between four pixels.
    pub(super) fn at(&self, x: f32, y: f32) -> f32 {
        let (x, y) = (x - 0.5, y - 0.5);
        let (left, top) = (below(x), below(y));
        #[expect(clippy::cast_precision_loss, reason = "a paper has less than 2^24 px a side")]
        let (right_part, low_part) = (x - left as f32, y - top as f32);
        let mixed = |above: [f32; 2], low: [f32; 2]| {
            let between = |[left, right]: [f32; 2]| left * (1.0 - right_part) + right * right_part;
            between(above) * (1.0 - low_part) + between(low) * low_part
        };
        // Nearly all places are inside.
        if let (Ok(column), Ok(row)) = (usize::try_from(left), usize::try_from(top))
            && column + 1 < self.width
        {
            let i = row * self.width + column;
            let pair = |i: usize| self.reflected.get(i..i + 2);
            if let (Some([a, b]), Some([c, d])) = (pair(i), pair(i + self.width)) {
                return mixed([*a, *b], [*c, *d]);
            }
        }
        let share = |x: i32, y: i32| match (inside(x, self.width), inside(y, self.height)) {
            (Some(x), Some(y)) => self.reflected.get(y * self.width + x).copied().unwrap_or(1.0),
            _ => 1.0,
        };
        let (right, low) = (left.saturating_add(1), top.saturating_add(1));
        mixed([share(left, top), share(right, top)], [share(left, low), share(right, low)])
    }
}

/// The whole number at or below, saturating. (`f32::floor` is a call where the processor has no instruction for it.)
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "saturates far outside of a paper"
)]
fn below(at: f32) -> i32 {
    let whole = at as i32;
    if whole as f32 > at { whole.saturating_sub(1) } else { whole }
}

/// The pixels under a straight line of a round pen: the index of each in a picture of this width and height, and how much of it the
/// pen covers, from 0 to 1.
pub(super) fn each_covered(
    (width, height): (usize, usize),
    [from, to]: [PxPoint; 2],
    radius_px: f64,
    mut found: impl FnMut(usize, f64),
) {
    // The pen's rim, and a little more and less so that rounding decides nothing: only there a pixel is covered in part.
    let square = |radius_px: f64| radius_px * radius_px.max(0.0);
    let (outside, inner) = (square(radius_px + 0.5 + 1e-6), square(radius_px - 0.5 - 1e-6));
    let reach = radius_px + 1.0;
    let rows = floor(from.y.min(to.y) - reach)..=floor(from.y.max(to.y) + reach);
    let columns = floor(from.x.min(to.x) - reach)..=floor(from.x.max(to.x) + reach);
    for y in rows.filter_map(|y| inside(y, height)) {
        for x in columns.clone().filter_map(|x| inside(x, width)) {
            #[expect(clippy::cast_precision_loss, reason = "a pixel's number is small")]
            let at = PxPoint::new(x as f64 + 0.5, y as f64 + 0.5);
            let nearest = nearest(at, from, to);
            let (dx, dy) = at.minus(nearest);
            let off = dx * dx + dy * dy;
            if off < inner {
                found(y * width + x, 1.0);
            } else if off < outside {
                found(y * width + x, (radius_px - at.distance(nearest) + 0.5).clamp(0.0, 1.0));
            }
        }
    }
}

/// Rows folded with a kernel; outside of them all is white.
fn convolved(levels: &[f32], width: usize, kernel: &[f32]) -> Vec<f32> {
    let reach = kernel.len() / 2;
    let mut folded = Vec::with_capacity(levels.len());
    let mut padded = vec![1.0; width + 2 * reach];
    for row in levels.chunks(width.max(1)) {
        if let Some(middle) = padded.get_mut(reach..reach + row.len()) {
            middle.copy_from_slice(row);
        }
        folded.extend(
            padded.windows(kernel.len()).map(|near| near.iter().zip(kernel).map(|(a, b)| a * b).sum::<f32>()),
        );
    }
    folded
}

/// Columns as rows.
pub(super) fn transposed(levels: &[f32], width: usize, height: usize) -> Vec<f32> {
    let at = |x: usize, y: usize| levels.get(y * width + x).copied().unwrap_or(1.0);
    (0..width).flat_map(|x| (0..height).map(move |y| (x, y))).map(|(x, y)| at(x, y)).collect()
}

/// The point of a piece of a straight line that is nearest.
pub(super) fn nearest(at: PxPoint, from: PxPoint, to: PxPoint) -> PxPoint {
    let (dx, dy) = to.minus(from);
    let length2 = dx * dx + dy * dy;
    let (px, py) = at.minus(from);
    let part = if length2 > 0.0 { ((px * dx + py * dy) / length2).clamp(0.0, 1.0) } else { 0.0 };
    from.along((dx, dy), part)
}
