//! [`Paper`]: the drawing under the simulated camera.

use super::whole::{count, floor, inside, level};
use crate::{
    PxVec,
    picture::{Gray, GrayError},
    stroke::PxPoint,
};

/// A drawing on white paper, as shares of the light that each place reflects. A camera pixel sees a pixel of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Paper {
    width: usize,
    height: usize,
    reflected: Vec<f32>,
    /// What lies outside: beside each row to the left and to the right, above and below each column.
    outside: [Vec<f32>; 4],
}

/// Along the rim of a picture the paper is as light as the lightest place so near, px: a line may reach the rim.
const RIM_PX: usize = 32;

/// Where all of the rim so near is darker than this share of the lightest place, it is ink.
const RIM_INK: f32 = 0.5;

/// The paper that goes on outside of a row or column of a picture whose lightest place is `lightest`.
fn beside(rim: &[f32], lightest: f32) -> Vec<f32> {
    let near = |i: usize| rim.get(i.saturating_sub(RIM_PX)..(i + RIM_PX + 1).min(rim.len())).unwrap_or(&[]);
    let paper = |i: usize| near(i).iter().copied().fold(0.0, f32::max);
    let levels = (0..rim.len()).map(paper);
    levels.map(|level| if level < RIM_INK * lightest { lightest } else { level }).collect()
}

impl Paper {
    /// The paper of a picture: 255 is white. Outside of the picture is no ink, and paper as light as at its rim.
    #[must_use]
    pub fn of(picture: &Gray) -> Self {
        let reflected: Vec<f32> = picture.pixels().iter().map(|level| f32::from(*level) / 255.0).collect();
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let lightest = reflected.iter().copied().fold(0.0, f32::max);
        let column = |x: usize| reflected.iter().skip(x).step_by(width.max(1)).copied().collect::<Vec<f32>>();
        let row = |y: usize| reflected.get(y * width..(y + 1) * width).unwrap_or(&[]).to_vec();
        let last = |side: usize| side.saturating_sub(1);
        let outside =
            [column(0), column(last(width)), row(0), row(last(height))].map(|rim| beside(&rim, lightest));
        Self { width, height, reflected, outside }
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
    /// # Ok::<(), plotter_vector::picture::GrayError>(())
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
        let [left, right, above, below] = &self.outside;
        let along = convolved(&self.reflected, self.width, [left, right], &kernel);
        let turned = transposed(&along, self.width, self.height);
        let across = convolved(&turned, self.height, [above, below], &kernel);
        Self { reflected: transposed(&across, self.height, self.width), ..self.clone() }
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
        let share = |x: i32, y: i32| {
            let beside = |side: usize, at: usize| self.outside.get(side).and_then(|rim| rim.get(at)).copied();
            let level = match (inside(x, self.width), inside(y, self.height)) {
                (Some(x), Some(y)) => self.reflected.get(y * self.width + x).copied(),
                (Some(x), None) => beside(if y < 0 { 2 } else { 3 }, x),
                // Beyond a corner it is as beside the nearest row.
                (None, row) => {
                    let row = row.unwrap_or(if y < 0 { 0 } else { self.height.saturating_sub(1) });
                    beside(usize::from(x >= 0), row)
                }
            };
            level.unwrap_or(1.0)
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
            let PxVec { x: dx, y: dy } = at - nearest;
            let off = dx * dx + dy * dy;
            if off < inner {
                found(y * width + x, 1.0);
            } else if off < outside {
                found(y * width + x, (radius_px - at.distance(nearest) + 0.5).clamp(0.0, 1.0));
            }
        }
    }
}

/// Rows folded with a kernel, with what lies to the left and to the right of each.
fn convolved(levels: &[f32], width: usize, [left, right]: [&Vec<f32>; 2], kernel: &[f32]) -> Vec<f32> {
    let reach = kernel.len() / 2;
    let mut folded = Vec::with_capacity(levels.len());
    let mut padded = vec![1.0; width + 2 * reach];
    for (row, (left, right)) in levels.chunks(width.max(1)).zip(left.iter().zip(right)) {
        for (i, level) in padded.iter_mut().enumerate() {
            let inner = i.checked_sub(reach);
            *level = inner.map_or(*left, |i| row.get(i).copied().unwrap_or(*right));
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
    let PxVec { x: dx, y: dy } = to - from;
    let length2 = dx * dx + dy * dy;
    let PxVec { x: px, y: py } = at - from;
    let part = if length2 > 0.0 { ((px * dx + py * dy) / length2).clamp(0.0, 1.0) } else { 0.0 };
    from + PxVec::new(dx, dy) * part
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_paper_goes_on_outside_without_its_lines() {
        // Lighter to the right, with a line from rim to rim and one along the bottom.
        let level = |x: u8, y: u8| if (20..24).contains(&y) || y > 57 { 40 } else { 140 + x / 2 };
        let levels = (0..60).flat_map(|y| (0..100).map(move |x| level(x, y))).collect();
        let paper = Paper::of(&Gray::new(100, 60, levels).unwrap());
        let level_at = |paper: &Paper, x: f32, y: f32| 255.0 * paper.at(x, y);
        for paper in [&paper, &paper.blurred(1.5)] {
            for (x, y, grey) in
                [(-9.0, 22.0, 140.0), (108.0, 22.0, 189.0), (30.5, -20.0, 171.0), (-9.0, -9.0, 140.0)]
            {
                assert!((level_at(paper, x, y) - grey).abs() < 0.6, "{x} {y}: {}", level_at(paper, x, y));
            }
            // Under what is ink all along it is as light as the lightest place.
            assert!((level_at(paper, 30.5, 70.0) - 189.0).abs() < 0.6);
            // No step at the rim.
            assert!((level_at(paper, 0.2, 40.5) - 140.0).abs() < 1.0, "{}", level_at(paper, 0.2, 40.5));
        }
    }
}
