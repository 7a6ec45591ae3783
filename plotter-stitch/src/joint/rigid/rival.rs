//! Whether a second pose explains what the first one leaves over: strokes of the drawing beside the marks, or
//! the marks beside strokes.

use super::equations::Row;
use crate::marks::MOST_CROSSINGS;
use plotter_motion::Axis;

/// Ink nearer to a mark's place than this is that mark, smeared or roughly drawn, mm: the width of a pen's
/// line.
const APART_MM: f32 = 0.5;

/// Places of one pose are this near to each other, mm, and three of their deviations.
const NEAR_MM: f32 = 0.05;

/// A pose that is turned otherwise is told by two places this far apart, mm, and a third has to agree.
const BASELINE_MM: f32 = 100.0;

/// Axis along which another pose explains places that the told one does not, and at how many crossings.
///
/// Where marks stand in straight rows one stroke imitates a row, and what is left over may be all that is
/// seen of the marks. Dust lies anywhere, hardly ever two grains the same way beside their marks: so two
/// crossings that tell the same other shift are enough, and as many as half of those that agree where the
/// turn is another too, which any two places tell. Of marks with a pattern a stroke imitates one in a row:
/// three of one shift, or two thirds of those that agree, are more than strokes beside some rows come to.
pub(super) fn rival(
    rows: &[Row],
    inliers: u64,
    residuals_mm: &[f32; MOST_CROSSINGS],
    agree: [u32; 2],
    greatest_angle_rad: f32,
) -> Option<(Axis, u32)> {
    for (axis, agree) in [Axis::X, Axis::Y].into_iter().zip(agree) {
        let mut left = [Left::NONE; MOST_CROSSINGS];
        let mut count = 0;
        for (index, (row, &off_mm)) in rows.iter().zip(residuals_mm).enumerate() {
            if inliers >> index & 1 == 0 && row.axis == axis && off_mm.abs() > APART_MM {
                left[count] = Left::of(row, off_mm);
                count += 1;
            }
        }
        let left = &left[..count];
        let in_row = has_straight_row(rows, axis);
        let most = left.iter().enumerate().flat_map(|(index, one)| {
            left[index + 1..].iter().filter_map(move |other| {
                if one.crossing == other.crossing {
                    return None;
                }
                let (one, other) = if other.off_mm < one.off_mm { (other, one) } else { (one, other) };
                let baseline_mm = other.lever_mm - one.lever_mm;
                let slope = if (other.off_mm - one.off_mm).abs() <= one.near_mm(other) {
                    0.0
                } else if baseline_mm.abs() >= BASELINE_MM {
                    (other.off_mm - one.off_mm) / baseline_mm
                } else {
                    return None;
                };
                let supporters = || {
                    left.iter().filter(|third| {
                        let there_mm = one.off_mm + slope * (third.lever_mm - one.lever_mm);
                        let off_mm = third.off_mm - there_mm;
                        // Of one shift all are near to each other, not only to one in their middle: strokes
                        // beside a pattern lie close.
                        off_mm.abs() <= one.near_mm(third) && (slope != 0.0 || off_mm >= 0.0)
                    })
                };
                let crossings =
                    supporters().fold(0_u64, |mask, third| mask | 1 << (third.crossing % 64)).count_ones();
                let least = match (slope == 0.0, in_row) {
                    (true, true) => 2,
                    (true, false) => 3,
                    (false, true) => agree.div_ceil(2).max(3),
                    (false, false) => (2 * agree).div_ceil(3).max(3),
                };
                let is_rival = slope.abs() <= greatest_angle_rad && crossings >= least;
                is_rival.then_some(crossings)
            })
        });
        if let Some(crossings) = most.max() {
            return Some((axis, crossings));
        }
    }
    None
}

/// Whether two marks of an axis stand on one line.
fn has_straight_row(rows: &[Row], axis: Axis) -> bool {
    let of = |index: usize| rows.iter().skip(index).filter(|row| row.axis == axis);
    rows.iter().enumerate().filter(|(_, row)| row.axis == axis).any(|(index, row)| {
        of(index + 1).any(|other| other.crossing != row.crossing && other.mark_mm == row.mark_mm)
    })
}

/// A place that does not agree.
#[derive(Clone, Copy)]
struct Left {
    crossing: usize,
    off_mm: f32,
    lever_mm: f32,
    variance: f32,
}

impl Left {
    const NONE: Self = Self { crossing: 0, off_mm: 0.0, lever_mm: 0.0, variance: 0.0 };

    #[allow(clippy::cast_possible_truncation, reason = "single precision is enough to tell 0.05 mm")]
    fn of(row: &Row, off_mm: f32) -> Self {
        let (lever_mm, weight) = (row.scan_at_mm as f32, row.weight as f32);
        Self { crossing: row.crossing, off_mm, lever_mm, variance: 1.0 / weight }
    }

    fn near_mm(&self, other: &Self) -> f32 {
        NEAR_MM + 3.0 * libm::sqrtf(self.variance + other.variance)
    }
}
