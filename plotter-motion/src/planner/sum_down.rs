//! [`sum_down`]: the sum of two squares of speeds, rounded down; [`Sum`]: a row of them.

#[cfg(target_os = "none")]
use crate::extremes::least;
#[cfg(not(target_os = "none"))]
use crate::geom::single;

/// The sum of two numbers not below 0, rounded down to an `f32`: what the rounding added is found without
/// error.
///
/// Source: D. E. Knuth, "The Art of Computer Programming", volume 2, section 4.2.2, theorem B.
pub(super) fn sum_down(a: f32, b: f32) -> f32 {
    let sum = a + b;
    let of_b = sum - a;
    let error = (a - (sum - of_b)) + (b - of_b);
    if error < 0.0 { sum.next_down() } else { sum }
}

/// A square of a speed to which others are added one by one, each time with the outcome of [`sum_down`].
///
/// Where `f64` is in hardware, a row of them takes a third of the time: the sum of two `f32`s of like size is
/// exact in it, and what a lesser one adds to a far greater one is cut off, as are the bits that an `f32`
/// does not have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sum(#[cfg(target_os = "none")] f32, #[cfg(not(target_os = "none"))] f64);

#[cfg(target_os = "none")]
impl Sum {
    pub(super) const fn of(value: f32) -> Self {
        Self(value)
    }

    pub(super) fn plus(self, other: f32) -> Self {
        Self(sum_down(self.0, other))
    }

    /// The lesser of both.
    pub(super) fn at_most(self, most: f32) -> Self {
        Self(least(most, self.0))
    }

    pub(super) const fn value(self) -> f32 {
        self.0
    }
}

#[cfg(not(target_os = "none"))]
impl Sum {
    /// The bits of an `f64`'s fraction that an `f32` does not have.
    const BEYOND: u64 = (1 << 29) - 1;

    pub(super) fn of(value: f32) -> Self {
        Self(value.into())
    }

    pub(super) fn plus(self, other: f32) -> Self {
        Self(f64::from_bits((self.0 + f64::from(other)).to_bits() & !Self::BEYOND))
    }

    /// The lesser of both.
    pub(super) fn at_most(self, most: f32) -> Self {
        let most = f64::from(most);
        Self(if most < self.0 { most } else { self.0 })
    }

    /// Exactly: it is an `f32`.
    pub(super) fn value(self) -> f32 {
        single(self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Any `f32` from 0 on, infinity too, with every exponent alike.
    fn square() -> impl Strategy<Value = f32> {
        (0..=f32::INFINITY.to_bits()).prop_map(f32::from_bits)
    }

    proptest! {
        #[test]
        fn a_row_of_sums_is_the_sums_one_by_one(first in square(), row in proptest::collection::vec((square(), square()), 1..16)) {
            let (mut sum, mut value) = (Sum::default().plus(first), first);
            for (other, most) in row {
                sum = sum.plus(other).at_most(most);
                value = sum_down(value, other).min(most);
                prop_assert_eq!(sum.value(), value);
            }
        }

        #[test]
        fn numbers_of_like_size_too(first in 0.0_f32..1e3, row in proptest::collection::vec(0.0_f32..1e3, 1..64)) {
            let (mut sum, mut value) = (Sum::default().plus(first), first);
            for other in row {
                sum = sum.plus(other);
                value = sum_down(value, other);
                prop_assert_eq!(sum.value(), value);
                prop_assert!(f64::from(value) <= f64::from(first) + 64e3);
            }
        }
    }
}
