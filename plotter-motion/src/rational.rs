//! [`Weighted`]: control points of rational curves, on the sheet and in space.

use core::ops::{Add, Mul, Sub};

/// A place multiplied by its weight, and the weight: of these a rational curve is made like any other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Weighted<V> {
    pub(crate) place: V,
    pub(crate) weight: f64,
}

impl<V: Copy + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V>> Weighted<V> {
    pub(crate) fn new(place: V, weight: f64) -> Self {
        Self { place: place * weight, weight }
    }

    pub(crate) fn mixed(self, other: Self, share: f64) -> Self {
        Self {
            place: self.place + (other.place - self.place) * share,
            weight: self.weight + (other.weight - self.weight) * share,
        }
    }

    pub(crate) fn projected(self) -> V {
        self.place * (1.0 / self.weight)
    }
}

/// The Bézier point with the number `ends` of the stretch of a B-spline between two knots: its polar form
/// with so many arguments at the stretch's end and the others at its start, by de Boor's triangle. `row` has
/// the control points of the stretch, one more than the degree, and `knot` gives the knots from that of the
/// first of them on; the stretch lies between knots `degree` and `degree` + 1.
///
/// Source: W. Boehm, "Inserting new knots into B-spline curves" (1980).
pub(crate) fn bezier_point<V>(
    row: &mut [Weighted<V>],
    ends: usize,
    knot: impl Fn(usize) -> f64,
) -> Weighted<V>
where
    V: Copy + Default + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V>,
{
    let degree = row.len().saturating_sub(1);
    let (from, to) = (knot(degree), knot(degree + 1));
    for level in 1..=degree {
        let at = if level <= ends { to } else { from };
        for index in (level..=degree).rev() {
            let (left, right) = (knot(index), knot(index + degree + 1 - level));
            let share = if right > left { (at - left) / (right - left) } else { 0.0 };
            if let Some([before, point]) = row.get_mut(index - 1..=index) {
                *point = before.mixed(*point, share);
            }
        }
    }
    row.last().copied().unwrap_or_default()
}
