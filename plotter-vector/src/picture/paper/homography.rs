//! [`Homography`]: what a camera makes of a flat sheet.

use crate::picture::{PxPoint, PxVec};

/// Determinants below this share of the product of the rows' lengths have no inverse worth having.
const SINGULAR: f64 = 1e-12;

/// A projective map of the plane, row by row: (x, y) goes to (u / w, v / w) with (u, v, w) = H (x, y, 1).
///
/// A place has an image where w is positive. Beyond the line w = 0, the horizon, nothing is seen.
///
/// ```
/// # use plotter_vector::{PxPoint, picture::Homography};
/// // By hand: w = 1 + 0.01 · 25 = 1.25, so that (25, 10) is seen at (25 / 1.25, 10 / 1.25).
/// let view = Homography([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.01, 0.0, 1.0]]);
/// assert_eq!(view.apply(PxPoint::new(25.0, 10.0)), Some(PxPoint::new(20.0, 8.0)));
/// assert_eq!(view.apply(PxPoint::new(-100.0, 10.0)), None); // on the horizon
/// let back = view.inverse().unwrap();
/// assert_eq!(back.apply(PxPoint::new(20.0, 8.0)), Some(PxPoint::new(25.0, 10.0)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Homography(pub [[f64; 3]; 3]);

impl Default for Homography {
    /// Every place stays where it is.
    fn default() -> Self {
        Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    }
}

impl Homography {
    /// The map of the rectangle from (0, 0) to (width, height) onto a quadrilateral, whose corners are given
    /// in the order upper left, upper right, lower right, lower left. `None` where three of them lie in a
    /// line.
    ///
    /// Source: Heckbert, "Fundamentals of texture mapping and image warping", UC Berkeley 1989, section
    /// 2.2.3.
    ///
    /// ```
    /// # use plotter_vector::{PxPoint, picture::Homography};
    /// // A trapezium from (0, 0) to (9, 3) and from (3, 3) to (12, 0): its diagonals cross at (6, 2).
    /// let corners = [(0.0, 0.0), (12.0, 0.0), (9.0, 3.0), (3.0, 3.0)].map(|(x, y)| PxPoint::new(x, y));
    /// let view = Homography::of_quadrilateral((10.0, 10.0), corners).unwrap();
    /// let middle = view.apply(PxPoint::new(5.0, 5.0)).unwrap();
    /// assert!(middle.distance(PxPoint::new(6.0, 2.0)) < 1e-9);
    /// ```
    #[must_use]
    pub fn of_quadrilateral((width, height): (f64, f64), corners: [PxPoint; 4]) -> Option<Self> {
        let [a, b, c, d] = corners;
        let sum = PxVec::new(a.x - b.x + c.x - d.x, a.y - b.y + c.y - d.y);
        let (right, left) = (b - c, d - c);
        let cross = right.cross(left);
        if cross == 0.0 {
            return None;
        }
        let g = sum.cross(left) / cross;
        let h = right.cross(sum) / cross;
        let unit = [
            [b.x - a.x + g * b.x, d.x - a.x + h * d.x, a.x],
            [b.y - a.y + g * b.y, d.y - a.y + h * d.y, a.y],
            [g, h, 1.0],
        ];
        let found = Self(unit.map(|[x, y, one]| [x / width, y / height, one]));
        found.inverse().map(|_| found)
    }

    /// The image of a place; `None` for a place at or beyond the horizon.
    #[must_use]
    pub fn apply(&self, at: PxPoint) -> Option<PxPoint> {
        let [u, v, w] = self.0.map(|[a, b, c]| a * at.x + b * at.y + c);
        let image = PxPoint::new(u / w, v / w);
        (w > 0.0 && image.is_finite()).then_some(image)
    }

    /// The map back, scaled so that places in front of the horizon stay there; `None` where there is none.
    #[must_use]
    pub fn inverse(&self) -> Option<Self> {
        let [[a, b, c], [d, e, f], [g, h, i]] = self.0;
        let determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
        let lengths: f64 =
            self.0.iter().map(|row| libm::sqrt(row.iter().map(|value| value * value).sum())).product();
        let adjugate = [
            [e * i - f * h, c * h - b * i, b * f - c * e],
            [f * g - d * i, a * i - c * g, c * d - a * f],
            [d * h - e * g, b * g - a * h, a * e - b * d],
        ];
        (libm::fabs(determinant) > SINGULAR * lengths)
            .then(|| Self(adjugate.map(|row| row.map(|value| value / determinant))))
    }

    /// The map by `first`, then by this one: the product of their matrices.
    ///
    /// ```
    /// # use plotter_vector::{PxPoint, picture::Homography};
    /// let doubled = Homography([[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]]);
    /// let moved = Homography([[1.0, 0.0, 3.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    /// assert_eq!(moved.after(&doubled).apply(PxPoint::new(5.0, 1.0)), Some(PxPoint::new(13.0, 2.0)));
    /// ```
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        let [one, two, three] = first.0;
        Self(self.0.map(|[a, b, c]| {
            let mut row = [0.0; 3];
            for (value, ((one, two), three)) in row.iter_mut().zip(one.iter().zip(two).zip(three)) {
                *value = a * one + b * two + c * three;
            }
            row
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Rounding of some tens of operations on places of a thousand px, px.
    const ROUNDING_PX: f64 = 1e-6;

    fn near(found: Option<PxPoint>, wanted: PxPoint) -> bool {
        found.is_some_and(|found| found.distance(wanted) < ROUNDING_PX)
    }

    fn place(x: f64, y: f64) -> PxPoint {
        PxPoint::new(x, y)
    }

    /// Maps of a sheet of 800 x 1000 px whose corners are each moved by up to 150 px, and places on the
    /// sheet.
    fn view() -> impl Strategy<Value = (Homography, [PxPoint; 4])> {
        proptest::array::uniform8(-150.0..150.0_f64).prop_map(|[a, b, c, d, e, f, g, h]| {
            let corners = [
                place(200.0 + a, 200.0 + b),
                place(1000.0 + c, 200.0 + d),
                place(1000.0 + e, 1200.0 + f),
                place(200.0 + g, 1200.0 + h),
            ];
            (Homography::of_quadrilateral((800.0, 1000.0), corners).unwrap(), corners)
        })
    }

    proptest! {
        #[test]
        fn corners_go_to_corners_and_every_place_comes_back(
            (view, corners) in view(), x in 0.0..800.0_f64, y in 0.0..1000.0_f64,
        ) {
            let back = view.inverse().unwrap();
            let rectangle = [(0.0, 0.0), (800.0, 0.0), (800.0, 1000.0), (0.0, 1000.0)];
            for ((x, y), corner) in rectangle.into_iter().zip(corners) {
                prop_assert!(near(view.apply(place(x, y)), corner));
                prop_assert!(near(back.apply(corner), place(x, y)));
            }
            prop_assert!(near(view.apply(place(x, y)).and_then(|at| back.apply(at)), place(x, y)));
        }

        #[test]
        fn one_after_another_is_both_in_turn(
            (first, _) in view(), (second, _) in view(), x in 0.0..800.0_f64, y in 0.0..1000.0_f64,
        ) {
            // The second takes the first one's picture for its sheet: most of it lies there.
            let in_turn = first.apply(place(x, y)).and_then(|at| second.apply(at));
            if let Some(in_turn) = in_turn {
                prop_assert!(near(second.after(&first).apply(place(x, y)), in_turn));
            }
            // What was done is undone from the last to the first.
            let back = second.after(&first).inverse().unwrap();
            let undone = first.inverse().unwrap().after(&second.inverse().unwrap());
            if let (Some(one), Some(other)) = (back.apply(place(x, y)), undone.apply(place(x, y))) {
                prop_assert!((one - other).length() < ROUNDING_PX * one.distance(place(0.0, 0.0)).max(1e3));
            }
        }
    }

    #[test]
    fn corners_in_a_line_have_no_map() {
        let line = [(0.0, 0.0), (1.0, 1.0), (2.0, 2.0), (3.0, 3.0)].map(|(x, y)| place(x, y));
        assert_eq!(Homography::of_quadrilateral((1.0, 1.0), line), None);
        assert_eq!(Homography([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]).inverse(), None);
    }
}
