//! [`Lens`]: radial distortion.

use crate::stroke::PxPoint;

/// A lens that shows straight lines bent: what is seen at the distance r from the middle lies at r (1 + k (r / R)²), where R
/// is the distance of the window's corner. The first term of D. C. Brown, "Decentering distortion of lenses" (1966).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Lens {
    /// How much farther the paper at the corner is than it seems, as a share: positive for a barrel (cheap wide lenses
    /// have 0.02 to 0.1), negative for a pincushion.
    pub barrel: f64,
}

impl Lens {
    /// Where what is seen at a place lies, both from the window's middle, px.
    ///
    /// ```
    /// # use plotter_vector::{PxPoint, follow::Lens};
    /// let lens = Lens { barrel: 0.05 };
    /// assert_eq!(lens.straightened(PxPoint::new(200.0, 0.0), 200.0), PxPoint::new(210.0, 0.0));
    /// ```
    #[must_use]
    pub fn straightened(self, seen: PxPoint, corner_px: f64) -> PxPoint {
        let share = libm::hypot(seen.x, seen.y) / corner_px;
        let farther = 1.0 + self.barrel * share * share;
        PxPoint::new(seen.x * farther, seen.y * farther)
    }
}
