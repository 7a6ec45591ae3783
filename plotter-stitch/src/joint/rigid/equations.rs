//! Least squares of three unknowns: a turn and two shifts.

use crate::{FrameTransform, marks::MOST_CROSSINGS};
use nalgebra::{Matrix3, Vector3};
use plotter_motion::{Axis, Vec2};

/// The unknown turn is counted as its way at this distance, mm, so that all three unknowns are of one size.
const LEVER_MM: f64 = 1000.0;

/// A multiplication is a quarter of a division where floats are computed by software.
pub(super) const PER_LEVER: f64 = 1.0 / LEVER_MM;

/// Steps of the iteration at the most; four are usual. The equations are nearly linear: with the matrix of
/// the start, which is off by the turn, each step leaves a hundredth or less of the last one's error.
const MOST_STEPS: u32 = 16;

/// After a step this small the next one would be a hundredth of it, mm: below all rounding that matters.
const STILL_MM: f64 = 1e-8;

/// What was found at one crossing, as an equation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) axis: Axis,
    pub(super) crossing: usize,
    pub(super) mark_mm: f64,
    pub(super) scan_at_mm: f64,
    pub(super) at_mm: f64,
    /// 1 / variance, 1/mm².
    pub(super) weight: f64,
}

impl Row {
    pub(super) const EMPTY: Self =
        Self { axis: Axis::X, crossing: 0, mark_mm: 0.0, scan_at_mm: 0.0, at_mm: 0.0, weight: 0.0 };

    /// How much farther it was found than expected, mm.
    pub(super) fn shift_mm(&self) -> f64 {
        self.at_mm - self.mark_mm
    }
}

/// A pose of the sheet with sine and cosine at hand.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    angle_rad: f64,
    cos: f64,
    sin: f64,
    shift: Vec2,
}

impl Pose {
    pub(super) fn new(angle_rad: f64, shift: Vec2) -> Self {
        Self { angle_rad, cos: libm::cos(angle_rad), sin: libm::sin(angle_rad), shift }
    }

    pub(super) fn angle_rad(&self) -> f64 {
        self.angle_rad
    }

    pub(super) fn shift(&self) -> Vec2 {
        self.shift
    }

    /// The pose from which the head sees what this one says where it is that far beside the pen.
    pub(super) fn shifted(&self, by: Vec2) -> Self {
        Self { shift: self.shift + by, ..*self }
    }

    pub(super) fn transform(&self) -> Option<FrameTransform> {
        FrameTransform::new(self.angle_rad, self.shift).ok()
    }

    /// Distance from the mark to the place that was found, in the frame, mm.
    pub(super) fn residual_mm(&self, row: &Row) -> f64 {
        let (along_mm, across_mm) = (row.at_mm, row.scan_at_mm);
        match row.axis {
            Axis::X => {
                self.cos * (along_mm - self.shift.x) + self.sin * (across_mm - self.shift.y) - row.mark_mm
            }
            Axis::Y => {
                self.cos * (along_mm - self.shift.y) - self.sin * (across_mm - self.shift.x) - row.mark_mm
            }
        }
    }

    /// The residual, and how it changes with the three unknowns.
    ///
    /// ```text
    /// mark of constant x: e = cos α (x - sx) + sin α (y - sy) - a
    /// mark of constant y: e = cos α (y - sy) - sin α (x - sx) - b
    /// ```
    pub(super) fn residual_and_slope(&self, row: &Row) -> (f64, Vector3<f64>) {
        match row.axis {
            Axis::X => {
                let (x, y) = (row.at_mm - self.shift.x, row.scan_at_mm - self.shift.y);
                let across = self.cos * x + self.sin * y;
                let along = self.cos * y - self.sin * x;
                (across - row.mark_mm, Vector3::new(along * PER_LEVER, -self.cos, -self.sin))
            }
            Axis::Y => {
                let (x, y) = (row.scan_at_mm - self.shift.x, row.at_mm - self.shift.y);
                let along = self.cos * x + self.sin * y;
                let across = self.cos * y - self.sin * x;
                (across - row.mark_mm, Vector3::new(-along * PER_LEVER, self.sin, -self.cos))
            }
        }
    }
}

/// How much greater an unknown's variance may be than if the others were known; more tells nothing.
const MOST_INFLATION: f64 = 1e9;

/// The inverse of a normal matrix; none if it is singular or nearly so.
fn inverse(normal: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let inverse = normal.try_inverse()?;
    let inflation = normal.diagonal().component_mul(&inverse.diagonal());
    // A NaN lies in no range.
    inflation.iter().all(|inflation| (0.0..MOST_INFLATION).contains(inflation)).then_some(inverse)
}

/// A pose and how sure it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solution {
    pub(super) pose: Pose,
    /// Covariance of the unknowns as the weights say it.
    pub(super) cofactor: Matrix3<f64>,
    /// Weighted sum of the squares of all residuals; it should be as great as the number of rows less three.
    pub(super) squares: f64,
    pub(super) rows: u32,
}

/// The pose with the least weighted squares over those rows that are in `mask`; none if they do not determine
/// it, or if the squares are seen to be above `most_squares` on the way.
///
/// Gauss and Newton's iteration with the matrix of its start. What is left of those rows is put into
/// `residuals_mm`.
pub(super) fn solve(
    rows: &[Row],
    mask: u64,
    start: Pose,
    most_squares: f64,
    residuals_mm: &mut [f32; MOST_CROSSINGS],
) -> Option<Solution> {
    let numbered = || rows.iter().enumerate().filter(|(index, _)| mask >> index & 1 == 1);
    let chosen = || numbered().map(|(_, row)| row);
    let mut normal = Matrix3::zeros();
    for row in chosen() {
        let (_, slope) = start.residual_and_slope(row);
        let weighted = slope * row.weight;
        // Symmetric, and each multiplication is dear where floats of this precision are made by software.
        for column in 0..3 {
            for row in column..3 {
                normal[(row, column)] += weighted[column] * slope[row];
            }
        }
    }
    normal.fill_upper_triangle_with_lower_triangle();
    let cofactor = inverse(&normal)?;
    let mut pose = start;
    for turn in 0..MOST_STEPS {
        let (mut right, mut squares, mut count) = (Vector3::zeros(), 0.0, 0);
        for (index, row) in numbered() {
            let (residual, slope) = pose.residual_and_slope(row);
            residuals_mm[index] = single(residual);
            let weighted = residual * row.weight;
            right += slope * weighted;
            squares += weighted * residual;
            count += 1;
        }
        // The start is still far off; one step from it only what is not linear.
        if turn > 0 && squares > most_squares {
            return None;
        }
        let step = cofactor * right;
        pose = Pose::new(
            pose.angle_rad - step.x * PER_LEVER,
            Vec2::new(pose.shift.x - step.y, pose.shift.y - step.z),
        );
        if step.iter().all(|step| libm::fabs(*step) < STILL_MM) {
            return Some(Solution { pose, cofactor, squares, rows: count });
        }
    }
    None
}

#[allow(clippy::cast_possible_truncation, reason = "single precision is what is wanted")]
pub(super) fn single(value: f64) -> f32 {
    value as f32
}

/// A covariance of the unknowns as one of angle, rad, and shifts, mm.
pub(super) fn in_radians(covariance: &Matrix3<f64>) -> [[f64; 3]; 3] {
    let unit = Matrix3::from_diagonal(&Vector3::new(PER_LEVER, 1.0, 1.0));
    (unit * covariance * unit).into()
}

/// How far a place moves with the three unknowns, mm; the place from the shifted origin.
pub(super) fn moved_by(unknowns: &Vector3<f64>, place: Vec2) -> Vec2 {
    let turn = unknowns.x * PER_LEVER;
    Vec2::new(unknowns.y - turn * place.y, unknowns.z + turn * place.x)
}
