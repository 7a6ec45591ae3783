//! Ours: shift and rotation from many crossings, with outliers, covariance and refusal.

mod consensus;
mod distortion;
mod equations;
mod error;
mod rival;

pub use error::FitError;

use crate::{Crossing, Field, FrameTransform, marks::MOST_CROSSINGS, sense::Found};
use distortion::{Distortion, PRIOR_RESIDUALS, Ways};
use equations::{Pose, Row, Solution, in_radians, moved_by, single, solve};
use plotter_motion::{Axis, Point, Vec2};
use rival::{LEAST_BESIDE_STROKES, rival, strokes, too_few_beside};

/// Farthest place, mm: a kilometre, larger than any machine. No product below overflows up to there.
const FARTHEST_MM: f64 = 1e6;

/// Most rounds of fitting and choosing anew. Two are usual; the bound ends a choice that goes to and fro.
const MOST_ROUNDS: u32 = 10;

/// Greatest ratio of the deviation by which outliers are sorted out to the expected one. Without it many
/// outliers would widen the bound that should find them.
const GREATEST_SCALE: f64 = 3.0;

/// Greatest swelling, in its standard deviations. By chance one paper in 16,000 swells more.
const GREATEST_SWELLING: f64 = 4.0;

/// A value within this many of its standard deviations may be so: 99.7 % of normal values are.
const SURE: f64 = 3.0;

/// A sheet that is turned by more than this many standard deviations has moved: by chance once in 500
/// million.
const STILL: f64 = 6.0;

/// Fits a turned and shifted sheet to where its marks were found.
///
/// The squares of the distances from each found place to its mark's line are least (point to line, weighted).
/// Marks that were missed or mistaken are sorted out: if not all places agree, the greatest agreement among
/// them is looked for by trying the angle that each pair tells. What is told has a covariance, and there are
/// reasons to tell nothing: too few marks agree, less than half of those along one axis do, the joint would
/// be known too badly, or one wrong place, or a fold, could move it unseen.
///
/// ```
/// use plotter_motion::{Axis, Vec2};
/// use plotter_stitch::{FrameTransform, ReferenceLines, RigidFit, sense::Found};
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
    /// Standard deviation of a found place apart from the sampling, each for itself, mm: the texture of the
    /// paper.
    pub place_mm: f64,
    /// The pen's offset from the optical head, as the head sees it: a mark seems to lie so much farther than
    /// the pen was sent, mm. [`with_pen_seen`](Self::with_pen_seen) measures it.
    pub pen_offset: Vec2,
    /// Standard deviation of what all places of a frame have in common, in each direction, mm: of the pen's
    /// offset from the optical head. No number of marks of one joint makes it smaller, and none shows it.
    pub common_mm: f64,
    /// Standard deviation of the paper's swelling between two frames, where it swells; 0 where it is not to
    /// be looked for.
    pub swelling: f64,
    /// Standard deviation of how far the middle of the joint bows from its chord, where it does, mm; 0 where
    /// it is not to be looked for. It grows with the square of the joint's length: [`on`](Self::on) has it
    /// for each. What marks beside the field cannot show of it is told as
    /// [`sigma_at_mm`](JointEstimate::sigma_at_mm) at the joint's middle.
    pub bow_mm: f64,
    /// A place agrees if it is off by no more than this many standard deviations.
    pub gate: f64,
    /// Least number of crossings that must agree.
    pub least_inliers: u32,
    /// Greatest standard deviation at an end of the joint, mm.
    pub most_sigma_mm: f64,
    /// How far the joint may be off by one place that is just not sorted out, or by a fold that is taken for
    /// shrinking, mm.
    pub most_unseen_mm: f64,
    /// Greatest rotation that is believed, rad.
    pub greatest_angle_rad: f64,
    /// Whether somebody has looked and seen no fold between the marks: then marks that lie nearer to each
    /// other than they were drawn show how far the paper has shrunk.
    pub is_flat: bool,
}

impl Default for RigidFit {
    /// For edges that are rough by 0.02 mm each, which moves their middle by 0.02 / √2, and a pen known to
    /// 0.01 mm; the joint of [`ReferenceLines::strip16`](crate::ReferenceLines::strip16), asked to 0.05 mm
    /// and never off by more than half a pen's width.
    fn default() -> Self {
        Self {
            joint: Field::default().joint(),
            place_mm: 0.0145,
            pen_offset: Vec2::new(0.0, 0.0),
            common_mm: 0.01,
            swelling: 2e-4,
            bow_mm: 0.1,
            gate: 4.0,
            least_inliers: 6,
            most_sigma_mm: 0.05,
            most_unseen_mm: 0.25,
            greatest_angle_rad: 0.01,
            is_flat: false,
        }
    }
}

/// How a sheet lies, and how sure that is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointEstimate {
    /// Frame to machine.
    pub transform: FrameTransform,
    /// How much the paper has swollen since the marks were drawn: 1e-4 are 0.1 mm in a metre.
    pub swelling: f64,
    /// How far the middle of the joint lies beside its chord, mm: to the left of the way from its first end
    /// to the other.
    pub bow_mm: f64,
    /// Covariance of angle, shift along x and shift along y, in rad and mm, without what swelling and bow
    /// add.
    pub covariance: [[f64; 3]; 3],
    /// Which of the found places agree: bit `i` stands for the one with index `i`.
    pub inliers: u64,
    /// How much greater than expected the residuals are; 1 is as expected.
    pub scale: f64,
    distortion: Distortion,
}

impl JointEstimate {
    /// Where a place of the frame near the joint lies on the machine: turned and shifted, and as far beside
    /// as swelling and bow carry it.
    ///
    /// [`transform`](Self::transform) alone is the turn and shift that fit the marks best; on paper that does
    /// nothing else both are the same but for some micrometres.
    #[must_use]
    pub fn to_machine(&self, place: Point) -> Point {
        self.transform.to_machine(place) + self.distortion.moved(place).rotated(self.transform.angle_rad())
    }

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
        let [x, y] = self.distortion.variances(place);
        Vec2::new(
            libm::sqrt((c[1][1] - 2.0 * at.y * c[0][1] + at.y * at.y * c[0][0]).max(0.0) + x),
            libm::sqrt((c[2][2] + 2.0 * at.x * c[0][2] + at.x * at.x * c[0][0]).max(0.0) + y),
        )
    }
}

impl RigidFit {
    /// The default for the marks of a layout: with its joint, and as much bow as a joint of that length has
    /// where paper is bent as much as over the widest field, whose middle then lies 0.1 mm beside the chord.
    ///
    /// ```
    /// # use plotter_stitch::{Field, ReferenceLines, RigidFit};
    /// let half = Field { width_mm: 990.0, ..Field::default() };
    /// assert_eq!(RigidFit::on(&ReferenceLines::strip16_on(&half)).bow_mm, 0.1 / 4.0);
    /// ```
    #[cfg(feature = "alloc")]
    #[cfg_attr(docsrs, doc(cfg(feature = "alloc")))]
    #[must_use]
    pub fn on(lines: &crate::ReferenceLines) -> Self {
        let usual = Self::default();
        let length_mm = |[from, to]: [Point; 2]| from.distance(to);
        let share = length_mm(lines.joint) / length_mm(usual.joint);
        Self { joint: lines.joint, bow_mm: usual.bow_mm * share * share, ..usual }
    }

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
        let Fitted { solution, mask: inliers, distortion, residuals_mm } =
            self.fit(rows, seen[0] + seen[1])?;

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
        let strokes = strokes(rows, &residuals_mm);
        if inliers != all(rows) {
            let turn = single(self.greatest_angle_rad);
            if let Some((axis, crossings)) = rival(rows, inliers, &residuals_mm, agree, turn) {
                return Err(FitError::Ambiguous { axis, crossings });
            }
            if let Some((axis, agree)) = too_few_beside(rows, inliers, self.joint, strokes) {
                return Err(FitError::Strokes { axis, agree, least: LEAST_BESIDE_STROKES });
            }
        }
        let scale = scale(&solution, &distortion);
        let geometry = FitError::Geometry { agree: agree[0] + agree[1] };
        let transform = solution.pose.shifted(-self.pen_offset).transform().ok_or(geometry)?;
        self.check_reliability(rows, inliers, &solution, scale)?;
        let variance = scale * scale * unsteady(&solution);
        let mut covariance = in_radians(&(solution.cofactor * variance));
        covariance[1][1] += self.common_mm * self.common_mm;
        covariance[2][2] += self.common_mm * self.common_mm;
        let [swelling, bow_mm] = distortion.amounts();
        let estimate = JointEstimate { transform, swelling, bow_mm, covariance, inliers, scale, distortion };
        for end in self.joint {
            let sigma = estimate.sigma_at_mm(end);
            let sigma_mm = sigma.x.max(sigma.y);
            // A NaN lies in no range.
            if !(0.0..=self.most_sigma_mm).contains(&sigma_mm) {
                return Err(FitError::Unsure { sigma_mm, most_mm: self.most_sigma_mm });
            }
        }
        // A fold between the marks at both ends takes up paper, which looks as if it had shrunk.
        let sure = SURE * distortion.sigma_swelling();
        let moved_mm = |by: f64| 0.5 * self.joint[0].distance(self.joint[1]) * by.max(0.0);
        let (shrunk, most_mm) = ((sure - swelling).max(0.0), self.most_unseen_mm);
        if moved_mm(shrunk) > most_mm && !self.is_flat {
            return Err(FitError::Shrunk { shrunk, effect_mm: moved_mm(shrunk), most_mm });
        }
        // A stroke at one side may stand where that side's marks would if the paper had swollen.
        let swollen = libm::fabs(swelling) + sure;
        if moved_mm(swollen) > most_mm && strokes != [0; 2] {
            return Err(FitError::Swollen { swelling, effect_mm: moved_mm(swollen), most_mm });
        }
        Ok(estimate)
    }

    /// The same for a pen whose offset is measured: `found` are the marks of a frame, looked for where they
    /// were just drawn, before the paper has moved, and `crossings` are those places.
    ///
    /// An offset of the pen from the head shifts all marks of a joint alike, as the sheet does: no mark of
    /// the joint tells the one from the other. On paper that has not moved it is all that there is. What the
    /// ways of the head up and down do differently is measured along with it.
    ///
    /// ```
    /// use plotter_motion::Vec2;
    /// use plotter_stitch::{ReferenceLines, RigidFit, sense::Found};
    ///
    /// let lines = ReferenceLines::strip16();
    /// let crossings: Vec<_> = lines.crossings().collect();
    /// let seen: Vec<_> = crossings.iter().enumerate()
    ///     .map(|(crossing, mark)| Found { crossing, at_mm: mark.mark_mm + 0.05, sigma_mm: 0.006 })
    ///     .collect();
    /// let fit = RigidFit::default().with_pen_seen(&crossings, &seen)?;
    /// assert!((fit.pen_offset - Vec2::new(0.05, 0.05)).length() < 1e-9);
    /// // Six marks of constant x, each known to 0.0157 mm, which is estimated too.
    /// assert!(fit.common_mm < 0.0157 / 6_f64.sqrt());
    /// # Ok::<(), plotter_stitch::FitError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`estimate`](Self::estimate), and [`FitError::Angle`] if the sheet has been turned since.
    pub fn with_pen_seen(&self, crossings: &[Crossing], found: &[Found]) -> Result<Self, FitError> {
        let seen = Self { pen_offset: Vec2::default(), ..*self }.estimate(crossings, found)?;
        let (angle_rad, most_rad) = (seen.transform.angle_rad(), STILL * seen.sigma_angle_rad());
        if libm::fabs(angle_rad) > most_rad {
            return Err(FitError::Angle { angle_rad, most_rad });
        }
        let mut sums = [[0.0; 2]; 2];
        for (index, place) in found.iter().enumerate() {
            let Some(crossing) = crossings.get(place.crossing) else { continue };
            if seen.inliers >> index & 1 == 1 {
                let weight = 1.0 / (self.place_mm * self.place_mm + place.sigma_mm * place.sigma_mm);
                let [weights, products] = &mut sums[usize::from(crossing.axis == Axis::Y)];
                *weights += weight;
                *products += weight * (place.at_mm - crossing.mark_mm);
            }
        }
        let [x, y] = sums.map(|[weights, products]| products / weights);
        let least = sums[0][0].min(sums[1][0]);
        Ok(Self { pen_offset: Vec2::new(x, y), common_mm: seen.scale / libm::sqrt(least), ..*self })
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
    fn fit(&self, rows: &[Row], seen: u32) -> Result<Fitted, FitError> {
        // All of them, if all of them agree.
        let everything = all(rows);
        let most_squares = self.gate * self.gate * f64::from(seen);
        let mut left_mm = [0.0; MOST_CROSSINGS];
        if everything.count_ones() == seen
            && let Some(solution) =
                solve(rows, everything, start(rows, everything, 0.0), most_squares, &mut left_mm)
        {
            let fitted = self.warped(rows, everything, solution, left_mm);
            if agreeing(rows, &fitted.residuals_mm, self.gate) == everything {
                return Ok(fitted);
            }
        }
        let (mut mask, angle_rad) =
            consensus::agreeing(rows, self.greatest_angle_rad, GREATEST_SWELLING * self.swelling);
        let mut pose = start(rows, mask, angle_rad);
        for round in 0..MOST_ROUNDS {
            let agree = crossings_in(rows, mask, None);
            if agree < self.least_inliers {
                return Err(FitError::NoAgreement { agree, seen, least: self.least_inliers });
            }
            let solution =
                solve(rows, mask, pose, f64::INFINITY, &mut left_mm).ok_or(FitError::Geometry { agree })?;
            pose = solution.pose;
            let fitted = self.warped(rows, mask, solution, left_mm);
            let scale = scale(&solution, &fitted.distortion).clamp(1.0, GREATEST_SCALE);
            let next = agreeing(rows, &fitted.residuals_mm, self.gate * scale);
            // It may go to and fro between two choices that differ by a place at the edge of the gate: the
            // last one with its own fit.
            if next == mask || round + 1 == MOST_ROUNDS {
                return Ok(fitted);
            }
            mask = next;
        }
        Err(FitError::NoAgreement { agree: 0, seen, least: self.least_inliers })
    }

    /// What is left of the residuals once swelling and bow are taken off; those of the rows in `mask` are
    /// given.
    fn warped(
        &self,
        rows: &[Row],
        mask: u64,
        solution: Solution,
        mut residuals_mm: [f32; MOST_CROSSINGS],
    ) -> Fitted {
        for (index, (residual_mm, row)) in residuals_mm.iter_mut().zip(rows).enumerate() {
            if mask >> index & 1 == 0 {
                *residual_mm = single(solution.pose.residual_mm(row));
            }
        }
        let ways = Ways::new(self.joint, self.swelling, self.bow_mm);
        let distortion = Distortion::of(ways, rows, mask, &solution, &mut residuals_mm);
        Fitted { solution, mask, distortion, residuals_mm }
    }

    /// Whether any one place could be wrong, and move the joint, without being sorted out.
    ///
    /// A place that is wrong by d has the residual r d only, with its redundancy r = 1 - (share of itself in
    /// its own fit): it draws the fit along. So it stays within the gate up to d = gate / r, and what that
    /// moves at the joint is looked at. A place that nothing else checks has r = 0.
    ///
    /// Source: W. Baarda, "A testing procedure for use in geodetic networks" (1968): redundancy numbers,
    /// external reliability.
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

/// A pose with what it explains.
struct Fitted {
    solution: Solution,
    /// The rows that it is of.
    mask: u64,
    distortion: Distortion,
    /// What is left of each row, mm; a millionth of some millimetres is enough to choose by.
    residuals_mm: [f32; MOST_CROSSINGS],
}

/// The rows within the gate, the nearest one of each crossing.
fn agreeing(rows: &[Row], residuals_mm: &[f32; MOST_CROSSINGS], gate: f64) -> u64 {
    let mut off = [f32::INFINITY; MOST_CROSSINGS];
    let mut mask = 0_u64;
    let most = single(gate * gate);
    for (index, (row, residual_mm)) in rows.iter().zip(residuals_mm).enumerate() {
        let square = residual_mm * residual_mm * single(row.weight);
        if !(0.0..=most).contains(&square) {
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

/// How much greater the residuals are than their weights say, with the expectation counting for some of them.
fn scale(solution: &Solution, distortion: &Distortion) -> f64 {
    let free = f64::from(solution.rows.saturating_sub(3));
    libm::sqrt(
        (f64::from(PRIOR_RESIDUALS) + f64::from(distortion.squares)) / (f64::from(PRIOR_RESIDUALS) + free),
    )
}

/// How much greater the variance must be told because the scale itself is only estimated: the mean of 1 /
/// scale², to first order.
fn unsteady(solution: &Solution) -> f64 {
    let free = f64::from(solution.rows.saturating_sub(3));
    let all = f64::from(PRIOR_RESIDUALS) + free;
    1.0 + 2.0 * free / (all * all)
}

/// A mask of all rows.
fn all(rows: &[Row]) -> u64 {
    rows.iter().enumerate().fold(0, |mask, (index, _)| mask | 1 << index)
}

/// How many different crossings there are in a mask, of one axis or both.
fn crossings_in(rows: &[Row], mask: u64, axis: Option<Axis>) -> u32 {
    let counts = |index: usize, row: &Row| mask >> index & 1 == 1 && axis.is_none_or(|axis| row.axis == axis);
    let is_again = |index: usize, row: &Row| {
        let mut before = rows.iter().take(index).enumerate();
        before.any(|(before, other)| other.crossing == row.crossing && counts(before, other))
    };
    let mut count = 0;
    for (index, row) in rows.iter().enumerate() {
        count += u32::from(counts(index, row) && !is_again(index, row));
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
