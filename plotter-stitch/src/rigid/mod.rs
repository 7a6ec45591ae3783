//! Ours: shift and rotation from many crossings, with outliers, covariance and refusal.

mod consensus;
mod equations;
mod error;

pub use error::FitError;

use crate::{Crossing, Found, FrameTransform, MOST_CROSSINGS};
use equations::{Pose, Row, Solution, in_radians, moved_by, solve};
use plotter_motion::{Axis, Point, Vec2};

/// No machine is so large, mm. Up to here nothing below overflows.
const FARTHEST_MM: f64 = 1e6;

/// Rounds of fitting and choosing anew at the most; two are usual.
const MOST_ROUNDS: u32 = 10;

/// As many residuals as the deviation that is expected counts for against those that are seen.
const PRIOR_RESIDUALS: f64 = 4.0;

/// Places are sorted out by no more than this times the deviation that is expected.
const GREATEST_SCALE: f64 = 3.0;

/// Fits a turned and shifted sheet to where its marks were found.
///
/// The squares of the distances from each found place to its mark's line are least (point to line, weighted). Marks that were missed or
/// mistaken are sorted out: if not all places agree, the greatest agreement among them is looked for by trying the angle that each
/// pair tells. What is told has a covariance, and there are four reasons to tell nothing: too few marks agree, less than half
/// of those along one axis do, the joint would be known too badly, or one wrong place could move it unseen.
///
/// ```
/// use plotter_motion::{Axis, Vec2};
/// use plotter_stitch::{Found, FrameTransform, ReferenceLines, RigidFit};
///
/// let lines = ReferenceLines::strip16();
/// let sheet = FrameTransform::new(0.001, Vec2::new(2.0, -1.0))?;
/// let crossings: Vec<_> = lines.crossings().collect();
/// let mut found: Vec<_> = crossings.iter().enumerate()
///     .map(|(crossing, mark)| Found { crossing, at_mm: mark.place_mm(&sheet), sigma_mm: 0.0 })
///     .collect();
/// found[4].at_mm += 3.0; // a grain of dust
/// found.remove(9); // a mark that was missed
///
/// let estimate = RigidFit::default().estimate(&crossings, &found)?;
/// assert!((estimate.transform.angle_rad() - 0.001).abs() < 1e-12);
/// assert_eq!(estimate.inlier_count(), 14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct RigidFit {
    /// Both ends of the border where the frames meet, in the frame about to be drawn, mm.
    pub joint: [Point; 2],
    /// Standard deviation of a found place apart from the sampling, each for itself, mm: the texture of the paper.
    pub place_mm: f64,
    /// Standard deviation of what all places of a frame have in common, in each direction, mm: the pen's offset from the optical
    /// head. No number of marks makes it smaller.
    pub common_mm: f64,
    /// A place agrees if it is off by no more than this many standard deviations.
    pub gate: f64,
    /// Least number of crossings that must agree.
    pub least_inliers: u32,
    /// Greatest standard deviation at an end of the joint, mm.
    pub most_sigma_mm: f64,
    /// How far the joint may be off by one place that is just not sorted out, mm.
    pub most_unseen_mm: f64,
    /// Greatest rotation that is believed, rad.
    pub greatest_angle_rad: f64,
}

impl Default for RigidFit {
    /// For edges that are rough by 0.02 mm each, which moves their middle by 0.02 / √2, and a pen known to 0.01 mm; the joint of
    /// [`ReferenceLines::strip16`](crate::ReferenceLines::strip16), asked to 0.05 mm and never off by more than half a pen's width.
    fn default() -> Self {
        Self {
            joint: [Point::new(20.0, 0.0), Point::new(20.0, 1000.0)],
            place_mm: 0.0145,
            common_mm: 0.01,
            gate: 4.0,
            least_inliers: 6,
            most_sigma_mm: 0.05,
            most_unseen_mm: 0.25,
            greatest_angle_rad: 0.01,
        }
    }
}

/// How a sheet lies, and how sure that is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointEstimate {
    /// Frame to machine.
    pub transform: FrameTransform,
    /// Covariance of angle, shift along x and shift along y, in rad and mm.
    pub covariance: [[f64; 3]; 3],
    /// Which of the found places agree: bit `i` stands for the one with index `i`.
    pub inliers: u64,
    /// How much greater than expected the residuals are; 1 is as expected.
    pub scale: f64,
}

impl JointEstimate {
    /// How many places agree.
    #[must_use]
    pub const fn inlier_count(&self) -> u32 {
        self.inliers.count_ones()
    }

    /// Standard deviation of the angle, rad.
    #[must_use]
    pub fn sigma_angle_rad(&self) -> f64 {
        libm::sqrt(self.covariance[0][0])
    }

    /// Standard deviations of the shift, mm.
    #[must_use]
    pub fn sigma_shift_mm(&self) -> Vec2 {
        Vec2::new(libm::sqrt(self.covariance[1][1]), libm::sqrt(self.covariance[2][2]))
    }

    /// Standard deviations, along the machine's axes, of where a place of the frame lies, mm.
    ///
    /// With the place at (x, y) from the shifted origin: x' = sx - y α, y' = sy + x α.
    #[must_use]
    pub fn sigma_at_mm(&self, place: Point) -> Vec2 {
        let at = self.transform.to_machine(place) - (Point::ORIGIN + self.transform.shift());
        let c = &self.covariance;
        Vec2::new(
            libm::sqrt((c[1][1] - 2.0 * at.y * c[0][1] + at.y * at.y * c[0][0]).max(0.0)),
            libm::sqrt((c[2][2] + 2.0 * at.x * c[0][2] + at.x * at.x * c[0][0]).max(0.0)),
        )
    }
}

impl RigidFit {
    /// How the sheet lies, from the places that were found at the crossings of a layout.
    ///
    /// Takes a fixed amount of memory and at most [`MOST_CROSSINGS`] places.
    ///
    /// # Errors
    ///
    /// [`FitError`] says why nothing is told.
    pub fn estimate(&self, crossings: &[Crossing], found: &[Found]) -> Result<JointEstimate, FitError> {
        let mut storage = [Row::EMPTY; MOST_CROSSINGS];
        let rows = self.rows(crossings, found, &mut storage)?;
        let seen = [Axis::X, Axis::Y].map(|axis| crossings_in(rows, all(rows), Some(axis)));
        if seen[0] + seen[1] < self.least_inliers {
            return Err(FitError::TooFew { seen: seen[0] + seen[1], least: self.least_inliers });
        }
        let (solution, inliers) = self.fit(rows, seen[0] + seen[1])?;

        let agree = [Axis::X, Axis::Y].map(|axis| crossings_in(rows, inliers, Some(axis)));
        for (axis, (agree, seen)) in [Axis::X, Axis::Y].into_iter().zip(agree.into_iter().zip(seen)) {
            if agree * 2 <= seen {
                return Err(FitError::Minority { axis, agree, seen });
            }
        }
        let angle_rad = solution.pose.angle_rad();
        if libm::fabs(angle_rad) > self.greatest_angle_rad {
            return Err(FitError::Angle { angle_rad, most_rad: self.greatest_angle_rad });
        }
        let scale = scale(&solution);
        let geometry = FitError::Geometry { agree: agree[0] + agree[1] };
        let transform = solution.pose.transform().ok_or(geometry)?;
        self.check_reliability(rows, inliers, &solution, scale)?;
        let variance = scale * scale * unsteady(&solution);
        let mut covariance = in_radians(&(solution.cofactor * variance));
        covariance[1][1] += self.common_mm * self.common_mm;
        covariance[2][2] += self.common_mm * self.common_mm;
        let estimate = JointEstimate { transform, covariance, inliers, scale };
        for end in self.joint {
            let sigma = estimate.sigma_at_mm(end);
            let sigma_mm = sigma.x.max(sigma.y);
            // A NaN lies in no range.
            if !(0.0..=self.most_sigma_mm).contains(&sigma_mm) {
                return Err(FitError::Unsure { sigma_mm, most_mm: self.most_sigma_mm });
            }
        }
        Ok(estimate)
    }

    /// What was found, as equations, checked.
    fn rows<'a>(
        &self,
        crossings: &[Crossing],
        found: &[Found],
        storage: &'a mut [Row; MOST_CROSSINGS],
    ) -> Result<&'a [Row], FitError> {
        if found.len() > MOST_CROSSINGS {
            return Err(FitError::TooMany { found: found.len(), most: MOST_CROSSINGS });
        }
        for (row, place) in storage.iter_mut().zip(found) {
            let crossing = crossings
                .get(place.crossing)
                .ok_or(FitError::Crossing { crossing: place.crossing, crossings: crossings.len() })?;
            // A NaN lies in no range.
            let numbers = [crossing.mark_mm, crossing.scan_at_mm, place.at_mm, place.sigma_mm];
            if let Some(value) =
                numbers.into_iter().find(|value| !(-FARTHEST_MM..=FARTHEST_MM).contains(value))
            {
                return Err(FitError::NotFinite { crossing: place.crossing, value });
            }
            let variance =
                (self.place_mm * self.place_mm + place.sigma_mm * place.sigma_mm).max(f64::MIN_POSITIVE);
            *row = Row {
                axis: crossing.axis,
                crossing: place.crossing,
                mark_mm: crossing.mark_mm,
                scan_at_mm: crossing.scan_at_mm,
                at_mm: place.at_mm,
                weight: 1.0 / variance,
            };
        }
        Ok(storage.get(..found.len()).unwrap_or(&[]))
    }

    /// The pose, and the rows that agree with it.
    fn fit(&self, rows: &[Row], seen: u32) -> Result<(Solution, u64), FitError> {
        // All of them, if all of them agree.
        let everything = all(rows);
        let most_squares = self.gate * self.gate * f64::from(seen);
        if everything.count_ones() == seen
            && let Some(solution) = solve(rows, everything, start(rows, everything, 0.0), most_squares)
            && self.agreeing(rows, &solution.pose, self.gate) == everything
        {
            return Ok((solution, everything));
        }
        let (mut mask, angle_rad) = consensus::agreeing(rows, self.greatest_angle_rad);
        let mut pose = start(rows, mask, angle_rad);
        let mut last = None;
        for _ in 0..MOST_ROUNDS {
            let agree = crossings_in(rows, mask, None);
            if agree < self.least_inliers {
                return Err(FitError::NoAgreement { agree, seen, least: self.least_inliers });
            }
            let solution = solve(rows, mask, pose, f64::INFINITY).ok_or(FitError::Geometry { agree })?;
            pose = solution.pose;
            let next = self.agreeing(rows, &pose, self.gate * scale(&solution).clamp(1.0, GREATEST_SCALE));
            if next == mask {
                return Ok((solution, mask));
            }
            last = Some(solution);
            mask = next;
        }
        // It goes to and fro between two choices that differ by a place at the edge of the gate: the last one with its own fit.
        let agree = crossings_in(rows, mask, None);
        let pose = last.map_or(pose, |solution: Solution| solution.pose);
        let solution = solve(rows, mask, pose, f64::INFINITY).ok_or(FitError::Geometry { agree })?;
        if agree < self.least_inliers {
            return Err(FitError::NoAgreement { agree, seen, least: self.least_inliers });
        }
        Ok((solution, mask))
    }

    /// The rows within the gate, the nearest one of each crossing.
    fn agreeing(&self, rows: &[Row], pose: &Pose, gate: f64) -> u64 {
        let mut off = [f64::INFINITY; MOST_CROSSINGS];
        let mut mask = 0_u64;
        for (index, row) in rows.iter().enumerate() {
            let residual_mm = pose.residual_mm(row);
            let square = residual_mm * residual_mm * row.weight;
            if !(0.0..=gate * gate).contains(&square) {
                continue;
            }
            off[index] = square;
            mask |= 1 << index;
            for (other, rival) in rows.iter().enumerate().take(index) {
                if mask >> other & 1 == 1 && rival.crossing == row.crossing {
                    mask &= !(1 << if off[other] <= square { index } else { other });
                }
            }
        }
        mask
    }

    /// Whether any one place could be wrong, and move the joint, without being sorted out.
    ///
    /// A place that is wrong by d has the residual r d only, with its redundancy r = 1 - (share of itself in its own fit): it draws the
    /// fit along. So it stays within the gate up to d = gate / r, and what that moves at the joint is looked at. A place that nothing
    /// else checks has r = 0.
    ///
    /// Source: W. Baarda, "A testing procedure for use in geodetic networks" (1968): redundancy numbers, external reliability.
    fn check_reliability(
        &self,
        rows: &[Row],
        inliers: u64,
        solution: &Solution,
        scale: f64,
    ) -> Result<(), FitError> {
        let ends = self.joint.map(|end| (end - Point::ORIGIN).rotated(solution.pose.angle_rad()));
        let gate = self.gate * scale.clamp(1.0, GREATEST_SCALE);
        let most_square = self.most_unseen_mm * self.most_unseen_mm;
        for (index, row) in rows.iter().enumerate() {
            if inliers >> index & 1 == 0 {
                continue;
            }
            let (_, slope) = solution.pose.residual_and_slope(row);
            // What one unit of it in the equations moves; weighted, that is what one millimetre moves.
            let moved = solution.cofactor * slope;
            let redundancy = (1.0 - moved.dot(&slope) * row.weight).max(f64::MIN_POSITIVE);
            let (square, limit_square) = (gate * gate * row.weight, redundancy * redundancy * most_square);
            for &end in &ends {
                // As squares: gate / √weight / redundancy · weight · |moved|, without roots and divisions.
                let effect_square = square * moved_by(&moved, end).length_squared();
                if !(0.0..=limit_square).contains(&effect_square) {
                    return Err(FitError::Unchecked {
                        crossing: row.crossing,
                        effect_mm: libm::sqrt(effect_square) / redundancy,
                        most_mm: self.most_unseen_mm,
                    });
                }
            }
        }
        Ok(())
    }
}

/// How much greater the residuals are than their weights say, with the expectation counting for some of them.
fn scale(solution: &Solution) -> f64 {
    let free = f64::from(solution.rows.saturating_sub(3));
    libm::sqrt((PRIOR_RESIDUALS + solution.squares) / (PRIOR_RESIDUALS + free))
}

/// How much greater the variance must be told because the scale itself is only estimated: the mean of 1 / scale², to first order.
fn unsteady(solution: &Solution) -> f64 {
    let free = f64::from(solution.rows.saturating_sub(3));
    let all = PRIOR_RESIDUALS + free;
    1.0 + 2.0 * free / (all * all)
}

/// A mask of all rows.
fn all(rows: &[Row]) -> u64 {
    rows.iter().enumerate().fold(0, |mask, (index, _)| mask | 1 << index)
}

/// How many different crossings there are in a mask, of one axis or both.
fn crossings_in(rows: &[Row], mask: u64, axis: Option<Axis>) -> u32 {
    let counts = |index: usize, row: &Row| mask >> index & 1 == 1 && axis.is_none_or(|axis| row.axis == axis);
    let mut count = 0;
    for (index, row) in rows.iter().enumerate() {
        let is_again = rows
            .iter()
            .enumerate()
            .take(index)
            .any(|(before, other)| counts(before, other) && other.crossing == row.crossing);
        count += u32::from(counts(index, row) && !is_again);
    }
    count
}

/// Turned by that angle, and shifted by the mean of what the rows then say.
fn start(rows: &[Row], mask: u64, angle_rad: f64) -> Pose {
    let mean_mm = |axis: Axis| {
        let (mut sum_mm, mut scans_mm, mut count) = (0.0, 0.0, 0.0);
        for (_, row) in
            rows.iter().enumerate().filter(|(index, row)| mask >> index & 1 == 1 && row.axis == axis)
        {
            sum_mm += row.shift_mm();
            scans_mm += row.scan_at_mm;
            count += 1.0;
        }
        let turned_mm = if axis == Axis::X { angle_rad * scans_mm } else { -angle_rad * scans_mm };
        if count > 0.0 { (sum_mm + turned_mm) / count } else { 0.0 }
    };
    Pose::new(angle_rad, Vec2::new(mean_mm(Axis::X), mean_mm(Axis::Y)))
}
