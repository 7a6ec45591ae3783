//! [`Homography`]: what a camera makes of a flat sheet.

use serde::{Deserialize, Serialize};

/// Determinants below this share of the product of the rows' lengths have no inverse worth having.
const SINGULAR: f64 = 1e-12;

/// A projective map of the plane, row by row: (x, y) goes to (u / w, v / w) with (u, v, w) = H (x, y, 1).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Homography(pub [[f64; 3]; 3]);

impl Homography {
    /// The map of the rectangle from (0, 0) to (width, height) onto a quadrilateral, whose corners are given
    /// in the order upper left, upper right, lower right, lower left. `None` where three of them lie in a
    /// line.
    ///
    /// Source: Heckbert, "Fundamentals of texture mapping and image warping", UC Berkeley 1989, section
    /// 2.2.3.
    #[must_use]
    pub fn of_quadrilateral((width, height): (f64, f64), corners: [(f64, f64); 4]) -> Option<Self> {
        let [a, b, c, d] = corners;
        let (sum_x, sum_y) = (a.0 - b.0 + c.0 - d.0, a.1 - b.1 + c.1 - d.1);
        let (right, left) = ((b.0 - c.0, b.1 - c.1), (d.0 - c.0, d.1 - c.1));
        let cross = right.0 * left.1 - left.0 * right.1;
        if cross == 0.0 {
            return None;
        }
        let g = (sum_x * left.1 - left.0 * sum_y) / cross;
        let h = (right.0 * sum_y - sum_x * right.1) / cross;
        let unit = [
            [b.0 - a.0 + g * b.0, d.0 - a.0 + h * d.0, a.0],
            [b.1 - a.1 + g * b.1, d.1 - a.1 + h * d.1, a.1],
            [g, h, 1.0],
        ];
        let found = Self(unit.map(|[x, y, one]| [x / width, y / height, one]));
        found.inverse().map(|_| found)
    }

    /// The image of a place; `None` for a place at or beyond the horizon.
    #[must_use]
    pub fn apply(&self, (x, y): (f64, f64)) -> Option<(f64, f64)> {
        let [u, v, w] = self.0.map(|[a, b, c]| a * x + b * y + c);
        (w > 0.0 && (u / w).is_finite() && (v / w).is_finite()).then_some((u / w, v / w))
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
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUNDING: f64 = 1e-9;

    fn near(found: Option<(f64, f64)>, wanted: (f64, f64)) -> bool {
        found.is_some_and(|(x, y)| (x - wanted.0).abs() < ROUNDING && (y - wanted.1).abs() < ROUNDING)
    }

    #[test]
    fn corners_go_to_corners_and_back() {
        let corners = [(12.0, 9.0), (95.0, 14.0), (88.0, 170.0), (3.0, 150.0)];
        let map = Homography::of_quadrilateral((80.0, 120.0), corners).unwrap();
        let back = map.inverse().unwrap();
        for (corner, image) in [(0.0, 0.0), (80.0, 0.0), (80.0, 120.0), (0.0, 120.0)].into_iter().zip(corners)
        {
            assert!(near(map.apply(corner), image) && near(back.apply(image), corner), "{corner:?}");
        }
    }

    #[test]
    fn the_middle_of_a_trapezium_is_where_its_diagonals_cross() {
        // From (0, 0) to (9, 3) and from (3, 3) to (12, 0), wide side on top: at (6, 2) by similar triangles.
        let corners = [(0.0, 0.0), (12.0, 0.0), (9.0, 3.0), (3.0, 3.0)];
        let map = Homography::of_quadrilateral((10.0, 10.0), corners).unwrap();
        assert!(near(map.apply((5.0, 5.0)), (6.0, 2.0)));
    }

    #[test]
    fn corners_in_a_line_have_no_map() {
        assert_eq!(
            Homography::of_quadrilateral((1.0, 1.0), [(0.0, 0.0), (1.0, 1.0), (2.0, 2.0), (3.0, 3.0)]),
            None
        );
        assert_eq!(Homography([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]).inverse(), None);
    }
}
