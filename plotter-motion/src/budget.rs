//! [`Budget`]: one greatest error, divided among what makes errors.
//!
//! ```text
//!   asked, mm ├─ vectorization ─┼─ blends ─┼────── control ───────┤
//!                the scan's ink    rounded    standing + moving k²
//!                from the strokes  corners    at the share k of the machine's speed
//! ```

use core::fmt;

/// Costs of the parts of an error, and how much of each is useful. All lengths in mm, none negative.
///
/// Control is taken as `standing + moving k²`: what is there however slowly the machine moves (counts or
/// steps, play, friction), and what its speed adds. A motion made slower as a whole by the factor k has k
/// times its speed and k² times its acceleration; what pushes the pen off its line grows with the latter, and
/// the pen gives way in proportion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BudgetLimits {
    /// Least distance of ink and strokes that a vectorization keeps, mm.
    pub vectorization_least_mm: f64,
    /// Greatest one that is of use, mm.
    pub vectorization_most_mm: f64,
    /// Greatest distance at which corners are rounded that is of use, mm; 0 for a machine that stops in each.
    pub blend_most_mm: f64,
    /// Error of control in slow motion, mm.
    pub standing_mm: f64,
    /// Growth of the error at the machine's own speed and acceleration, mm.
    pub moving_mm: f64,
    /// Least share of the machine's speed that anyone wants to wait for, above 0 and up to 1.
    pub least_speed_share: f64,
    /// How much the vectorization gets of what it shares with the blends, 0 to 1.
    pub vectorization_share: f64,
}

impl Default for BudgetLimits {
    /// A scan at 20 pixels to the millimetre, from half a pixel up, on a machine that stops in each corner,
    /// stands within half a count of 0.025 mm on both axes, and goes as exactly when it is fast.
    fn default() -> Self {
        Self {
            vectorization_least_mm: 0.025,
            vectorization_most_mm: f64::MAX,
            blend_most_mm: 0.0,
            standing_mm: 0.0177,
            moving_mm: 0.0,
            least_speed_share: 0.1,
            vectorization_share: 0.5,
        }
    }
}

/// A part of the error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum BudgetPart {
    /// From the scan's ink to the strokes.
    Vectorization,
    /// From the strokes to the path that is followed, with rounded corners.
    Blend,
    /// From that to where the pen is.
    Control,
}

impl fmt::Display for BudgetPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Vectorization => "vectorization",
            Self::Blend => "blending",
            Self::Control => "control",
        })
    }
}

/// Why an error cannot be promised.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum BudgetError {
    /// It is less than what all parts need at the least.
    TooSmall {
        /// Greatest error asked for, mm.
        asked_mm: f64,
        /// The part that needs most of it.
        limiting: BudgetPart,
        /// Least error that this part needs, mm.
        needs_mm: f64,
        /// Smallest error that can be promised, mm.
        smallest_mm: f64,
    },
    /// The greatest error asked for is not a length.
    NoLength {
        /// Greatest error asked for, mm.
        asked_mm: f64,
    },
    /// A cost is not a number, is negative, or contradicts another.
    Limits {
        /// The part.
        part: BudgetPart,
    },
}

impl fmt::Display for BudgetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::TooSmall { asked_mm, limiting, needs_mm, smallest_mm } => {
                // Rounded up, so that what is written can be asked for.
                let up = |mm: f64| libm::ceil(mm * 1e4) / 1e4;
                write!(
                    f,
                    "{asked_mm} mm cannot be promised: {limiting} alone needs {:.4} mm; the smallest error that can be \
                     promised is {:.4} mm",
                    up(needs_mm),
                    up(smallest_mm)
                )
            }
            Self::NoLength { asked_mm } => {
                write!(f, "{asked_mm} mm is no error to stay below: give a number above 0")
            }
            Self::Limits { part } => {
                write!(f, "{part}: its limits must be finite, not negative, and the least at most the most")
            }
        }
    }
}

impl core::error::Error for BudgetError {}

/// How an error is divided. The parts make no more than what was asked.
///
/// ```
/// # use plotter_motion::budget::{Budget, BudgetLimits};
/// // 0.2 mm for a machine that is 0.02 mm off in slow motion and 0.06 mm more at its own speed.
/// let limits = BudgetLimits {
///     vectorization_least_mm: 0.03,
///     standing_mm: 0.02,
///     moving_mm: 0.06,
///     least_speed_share: 0.5, // 0.06 × 0.25 = 0.015 mm
///     ..BudgetLimits::default()
/// };
/// let budget = Budget::split(0.2, &limits)?;
/// // The least of all is 0.03 + 0.02 + 0.015 = 0.065 mm; of the 0.135 mm that are left, full speed takes 0.045 mm.
/// assert_eq!(budget.speed_share, 1.0);
/// assert!((budget.control_mm - 0.08).abs() < 1e-12);
/// assert!((budget.vectorization_mm - 0.12).abs() < 1e-12);
///
/// // 0.085 mm leave 0.02 mm: half of them for control, 0.045 mm = 0.02 + 0.06 k².
/// let tight = Budget::split(0.085, &limits)?;
/// assert!((tight.control_mm - 0.045).abs() < 1e-12);
/// assert!((tight.speed_share - (0.025_f64 / 0.06).sqrt()).abs() < 1e-12);
///
/// let refused = Budget::split(0.05, &limits).unwrap_err().to_string();
/// assert!(refused.starts_with("0.05 mm cannot be promised: control alone needs 0.035"));
/// # Ok::<(), plotter_motion::budget::BudgetError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// For the vectorization, mm.
    pub vectorization_mm: f64,
    /// For rounded corners, mm; 0 for none.
    pub blend_mm: f64,
    /// For control, mm.
    pub control_mm: f64,
    /// Share of the machine's own speed at which control keeps that, above 0 and up to 1: see
    /// [`Budget::slowed`].
    pub speed_share: f64,
}

impl Budget {
    /// Divides the error `max_error_mm`.
    ///
    /// Every part gets the least that it needs. Of what is left, control takes up to half to come to the
    /// machine's own speed; vectorization and blends share the rest as `vectorization_share` says. What a
    /// part cannot use goes to the others, and what none can use is left over. A greater error gives no part
    /// less.
    ///
    /// # Errors
    ///
    /// [`BudgetError`]: less than the sum of the least, or numbers that are none.
    pub fn split(max_error_mm: f64, limits: &BudgetLimits) -> Result<Self, BudgetError> {
        let asked_mm = max_error_mm;
        if !(asked_mm > 0.0 && asked_mm.is_finite()) {
            return Err(BudgetError::NoLength { asked_mm });
        }
        let least = Self::least(limits)?;
        let smallest_mm = least.promised_mm();
        if asked_mm < smallest_mm {
            let vectorization_limits = least.vectorization_mm > least.control_mm;
            let (limiting, needs_mm) = if vectorization_limits {
                (BudgetPart::Vectorization, least.vectorization_mm)
            } else {
                (BudgetPart::Control, least.control_mm)
            };
            return Err(BudgetError::TooSmall { asked_mm, limiting, needs_mm, smallest_mm });
        }
        let free_mm = asked_mm - smallest_mm;
        // What each part can use beyond the least.
        let faster_mm = limits.standing_mm + limits.moving_mm - least.control_mm;
        let coarser_mm = limits.vectorization_most_mm - least.vectorization_mm;
        let rounder_mm = limits.blend_most_mm;
        let control_mm = faster_mm.max(0.0).min((0.5 * free_mm).max(free_mm - coarser_mm - rounder_mm));
        let rest_mm = free_mm - control_mm;
        let share_mm = (limits.vectorization_share * rest_mm).max(rest_mm - rounder_mm);
        let vectorization_mm = coarser_mm.min(share_mm);
        let blend_mm = rounder_mm.min(rest_mm - vectorization_mm);
        let mut budget = Self {
            vectorization_mm: least.vectorization_mm + vectorization_mm,
            blend_mm: blend_mm.max(0.0),
            control_mm: least.control_mm + control_mm,
            speed_share: 1.0,
        };
        // Rounding of the last bit must not make more of it.
        for _ in 0..4 {
            let over_mm = budget.promised_mm() - asked_mm;
            if over_mm <= 0.0 {
                break;
            }
            budget.vectorization_mm = (budget.vectorization_mm - 2.0 * over_mm).max(least.vectorization_mm);
            budget.blend_mm = (budget.blend_mm - 2.0 * over_mm).max(0.0);
        }
        // Where the others are the least already it is the control's part that was rounded up.
        for most_mm in [asked_mm, asked_mm.next_down()] {
            if budget.promised_mm() > asked_mm {
                let rest_mm = most_mm - budget.vectorization_mm - budget.blend_mm;
                budget.control_mm = budget.control_mm.min(rest_mm).max(least.control_mm);
            }
        }
        budget.speed_share = Self::speed_share(budget.control_mm, limits);
        Ok(budget)
    }

    /// The smallest error that can be promised, mm.
    ///
    /// # Errors
    ///
    /// [`BudgetError::Limits`].
    pub fn smallest_mm(limits: &BudgetLimits) -> Result<f64, BudgetError> {
        Self::least(limits).map(|least| least.promised_mm())
    }

    /// The least of every part.
    fn least(limits: &BudgetLimits) -> Result<Self, BudgetError> {
        let BudgetLimits { vectorization_least_mm, vectorization_most_mm, .. } = *limits;
        let length = |mm: f64| mm >= 0.0 && mm.is_finite();
        let share = |share: f64| (0.0..=1.0).contains(&share);
        let parts = [
            (
                BudgetPart::Vectorization,
                length(vectorization_least_mm)
                    && length(vectorization_most_mm)
                    && vectorization_least_mm <= vectorization_most_mm
                    && share(limits.vectorization_share),
            ),
            (BudgetPart::Blend, length(limits.blend_most_mm)),
            (
                BudgetPart::Control,
                length(limits.standing_mm)
                    && length(limits.moving_mm)
                    && share(limits.least_speed_share)
                    && limits.least_speed_share > 0.0,
            ),
        ];
        if let Some((part, _)) = parts.into_iter().find(|(_, is_right)| !is_right) {
            return Err(BudgetError::Limits { part });
        }
        let speed_share = limits.least_speed_share;
        Ok(Self {
            vectorization_mm: vectorization_least_mm,
            blend_mm: 0.0,
            control_mm: limits.standing_mm + limits.moving_mm * speed_share * speed_share,
            speed_share,
        })
    }

    /// The share of the speed at which control makes `control_mm`.
    fn speed_share(control_mm: f64, limits: &BudgetLimits) -> f64 {
        /// Relative rounding of a sum of errors that still counts as equal: far above the last bits of `f64`,
        /// far below any error.
        const ROUNDING: f64 = 1e-12;
        if control_mm >= (limits.standing_mm + limits.moving_mm) * (1.0 - ROUNDING) {
            return 1.0;
        }
        let share = libm::sqrt(((control_mm - limits.standing_mm) / limits.moving_mm).max(0.0));
        share.clamp(limits.least_speed_share, 1.0)
    }

    /// The sum of the parts, mm: what is promised. No more than what was asked.
    #[must_use]
    pub const fn promised_mm(&self) -> f64 {
        self.vectorization_mm + self.blend_mm + self.control_mm
    }

    /// A machine's greatest speed, acceleration and jerk, slowed down as a whole: `k v`, `k² a` and `k³ j`.
    ///
    /// ```
    /// # use plotter_motion::budget::Budget;
    /// let half = Budget { vectorization_mm: 0.1, blend_mm: 0.0, control_mm: 0.1, speed_share: 0.5 };
    /// assert_eq!(half.slowed(150.0, 3000.0, 80_000.0), (75.0, 750.0, 10_000.0));
    /// ```
    #[must_use]
    pub const fn slowed(&self, speed_mm_s: f64, accel_mm_s2: f64, jerk_mm_s3: f64) -> (f64, f64, f64) {
        let k = self.speed_share;
        (k * speed_mm_s, k * k * accel_mm_s2, k * k * k * jerk_mm_s3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_part_cannot_use_goes_to_the_others() {
        let limits = BudgetLimits {
            vectorization_least_mm: 0.0,
            vectorization_most_mm: 0.1,
            blend_most_mm: 0.2,
            standing_mm: 0.0,
            moving_mm: 0.4,
            least_speed_share: 1e-3,
            ..BudgetLimits::default()
        };
        // 1 mm is more than all can use: 0.1 + 0.2 + 0.4
        let much = Budget::split(1.0, &limits).unwrap();
        assert!((much.promised_mm() - 0.7).abs() < 1e-9 && much.speed_share == 1.0, "{much:?}");
        // 0.5 mm: half would be 0.25 for control, but the others can use 0.3 only, and share 0.25
        let some = Budget::split(0.5, &limits).unwrap();
        assert!(
            (some.control_mm - 0.25).abs() < 1e-6 && (some.vectorization_mm - 0.1).abs() < 1e-6,
            "{some:?}"
        );
        // 0.65 mm: 0.3 for the others, 0.35 for control
        let more = Budget::split(0.65, &limits).unwrap();
        assert!((more.control_mm - 0.35).abs() < 1e-6 && (more.blend_mm - 0.2).abs() < 1e-6, "{more:?}");
    }

    #[test]
    fn what_is_no_length_is_refused() {
        for asked_mm in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let refused = Budget::split(asked_mm, &BudgetLimits::default());
            assert!(matches!(refused, Err(BudgetError::NoLength { .. })), "{asked_mm}");
        }
        let limits = BudgetLimits { moving_mm: f64::NAN, ..BudgetLimits::default() };
        assert_eq!(Budget::split(1.0, &limits), Err(BudgetError::Limits { part: BudgetPart::Control }));
        let limits = BudgetLimits { vectorization_most_mm: 0.01, ..BudgetLimits::default() };
        assert_eq!(
            Budget::smallest_mm(&limits),
            Err(BudgetError::Limits { part: BudgetPart::Vectorization })
        );
    }
}
