//! [`GreatestKept`]: the search for the greatest number that still keeps what has to be kept, a look at a
//! time.

use crate::geom::single;

/// How nearly it is found: to 6e-8 of the range, as fine as `f32`, or until its margin is no more than this;
/// in mm it is a tenth of the nanometre by which a braking may miss its place.
const KEPT_SHARE: f64 = 6e-8;
const KEPT_MARGIN: f64 = 1e-7;

/// The greatest number of a range whose margin is not below 0, by less than [`KEPT_MARGIN`] or
/// [`KEPT_SHARE`] of the range; the least one if there is none. The margin falls.
///
/// By false position as the Illinois algorithm has it (M. Dowell and P. Jarratt, "A modified regula falsi
/// method for computing the root of an equation", BIT 11, 1971), with a halving wherever that gains little: a
/// third of the looks that halvings take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GreatestKept {
    low: f64,
    high: f64,
    /// What the secant is drawn through: where an end stays twice, half of what is there.
    ends: [f64; 2],
    /// The width of the range when the looks were counted from 0.
    width: f64,
    /// The one that is wanted.
    least_width: f32,
    looks: u8,
    /// Which end stayed: the upper one, if the number looked at was kept.
    stayed: Option<bool>,
}

impl GreatestKept {
    /// A search that has begun, with a look at either end.
    pub(super) fn new([low, high]: [f64; 2], margin: impl Fn(f64) -> f64) -> Self {
        let (at_high, width) = (margin(high), high - low);
        let found = Self {
            low: high,
            high,
            ends: [at_high; 2],
            width: 0.0,
            least_width: 0.0,
            looks: 0,
            stayed: None,
        };
        if at_high >= 0.0 {
            return found;
        }
        Self { low, ends: [margin(low), at_high], width, least_width: single(KEPT_SHARE * width), ..found }
    }

    /// Whether no look is left to be taken. Ends: in three looks the range is at most half as wide.
    pub(super) fn is_found(&self) -> bool {
        // Written so that what is no number ends it.
        let is_wide = self.high - self.low > self.least_width.into();
        !is_wide
    }

    /// The greatest number that is known to be kept.
    pub(super) const fn number(&self) -> f64 {
        self.low
    }

    /// All looks that are left at once.
    pub(super) fn whole(mut self, margin: impl Fn(f64) -> f64) -> f64 {
        while !self.is_found() {
            self.look(&margin);
        }
        self.number()
    }

    /// Looks at one number.
    pub(super) fn look(&mut self, margin: impl Fn(f64) -> f64) {
        let (low, high) = (self.low, self.high);
        // The least number stays even if it does not keep everything, but for rounding.
        let is_secant = self.looks < 2 && self.ends[0] > 0.0;
        let share = if is_secant { self.ends[0] / (self.ends[0] - self.ends[1]) } else { 0.5 };
        let share = if share.is_finite() { share.clamp(1e-3, 0.999) } else { 0.5 };
        let at = low + share * (high - low);
        let here = margin(at);
        let is_kept = here >= 0.0;
        if is_kept {
            (self.low, self.ends[0]) = (at, here);
            if here <= KEPT_MARGIN {
                self.high = at;
                return;
            }
        } else {
            (self.high, self.ends[1]) = (at, here);
        }
        // The end that stays is the other one.
        if self.stayed == Some(is_kept) {
            self.ends[usize::from(is_kept)] *= 0.5;
        }
        self.stayed = Some(is_kept);
        self.looks += 1;
        if self.high - self.low <= 0.5 * self.width {
            (self.width, self.looks) = (self.high - self.low, 0);
        } else if self.looks == 3 {
            self.looks = 0;
        }
    }
}
