//! Points and displacements on the sheet, in millimetres: x to the right, y up, origin at the lower left.
//!
//! A [`Point`] is a place and a [`Vec2`] is a way from one place to another. Two places cannot be added:
//!
//! ```compile_fail
//! # use plotter_motion::Point;
//! let nonsense = Point::new(1.0, 2.0) + Point::new(3.0, 4.0);
//! ```

use crate::root::root;
use core::ops::{Add, AddAssign, Mul, Neg, Sub};

/// A place on the sheet, in mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Point {
    /// To the right, mm.
    pub x: f64,
    /// Up, mm.
    pub y: f64,
}

/// A displacement on the sheet, in mm (or, divided by a time, a velocity in mm/s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Vec2 {
    /// To the right.
    pub x: f64,
    /// Up.
    pub y: f64,
}

impl Point {
    /// The lower left corner of the sheet.
    pub const ORIGIN: Self = Self { x: 0.0, y: 0.0 };

    /// The place `x` mm right of and `y` mm above the origin.
    #[must_use]
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    /// Straight distance to `other`, mm.
    ///
    /// ```
    /// # use plotter_motion::Point;
    /// assert_eq!(Point::new(1.0, 1.0).distance(Point::new(4.0, 5.0)), 5.0);
    /// ```
    #[must_use]
    pub fn distance(self, other: Self) -> f64 {
        (other - self).length()
    }

    /// The place the share `t` of the way from here to `other`: 0 is here, 1 is there.
    #[must_use]
    pub fn lerp(self, other: Self, t: f64) -> Self {
        self + (other - self) * t
    }

    /// The way to another place, rounded: a metre is right to 60 nm. By reference: to move four `f64` takes a
    /// small processor eight instructions.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(crate) fn way_to(&self, other: &Self) -> Vec2Single {
        Vec2Single { x: single(other.x - self.x), y: single(other.y - self.y) }
    }

    /// The place at the end of a way.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(crate) fn after(&self, way: Vec2Single) -> Self {
        Self::new(self.x + f64::from(way.x), self.y + f64::from(way.y))
    }

    /// Whether both coordinates are finite numbers.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite()
    }
}

impl Vec2 {
    /// The displacement by `x` to the right and `y` up.
    #[must_use]
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    /// Length; never negative, and free of overflow for large components.
    #[must_use]
    pub fn length(self) -> f64 {
        libm::hypot(self.x, self.y)
    }

    /// The length of a way of 10⁻¹⁵⁰ to 10¹⁵⁰ mm: without the scaling of `hypot`, which costs more than all
    /// the rest.
    pub(crate) fn length_near(self) -> f64 {
        libm::sqrt(self.length_squared())
    }

    /// Square of the length; cheaper than [`Vec2::length`] where only the order matters.
    #[must_use]
    pub fn length_squared(self) -> f64 {
        self.dot(self)
    }

    /// Scalar product: |a| |b| cos of the angle between.
    #[must_use]
    pub fn dot(self, other: Self) -> f64 {
        self.x * other.x + self.y * other.y
    }

    /// Third component of the vector product: |a| |b| sin of the angle from `self` to `other`, positive
    /// when `other` lies counter-clockwise.
    ///
    /// ```
    /// # use plotter_motion::Vec2;
    /// assert_eq!(Vec2::new(1.0, 0.0).cross(Vec2::new(0.0, 2.0)), 2.0);
    /// ```
    #[must_use]
    pub fn cross(self, other: Self) -> f64 {
        self.x * other.y - self.y * other.x
    }

    /// The same direction with length 1; `None` for a displacement without direction (zero, not finite).
    #[must_use]
    pub fn normalized(self) -> Option<Self> {
        let length = self.length();
        (length > 0.0 && length.is_finite()).then(|| Self::new(self.x / length, self.y / length))
    }

    /// A quarter turn counter-clockwise: the left-hand normal, of the same length.
    #[must_use]
    pub fn perpendicular(self) -> Self {
        Self::new(-self.y, self.x)
    }

    /// Turned counter-clockwise by `angle_rad`.
    #[must_use]
    pub fn rotated(self, angle_rad: f64) -> Self {
        let (sin, cos) = (libm::sin(angle_rad), libm::cos(angle_rad));
        Self::new(self.x * cos - self.y * sin, self.x * sin + self.y * cos)
    }
}

/// A displacement in `f32`, which small processors reckon with in hardware: enough for the length and the
/// direction of a way, where only its end has to be exact. mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Vec2Single {
    pub(crate) x: f32,
    pub(crate) y: f32,
}

impl Vec2Single {
    /// The length of a way of 10⁻¹⁵ to 10¹⁵ mm.
    pub(crate) fn length_near(self) -> f32 {
        root(self.dot(self))
    }

    pub(crate) fn dot(self, other: Self) -> f32 {
        self.x * other.x + self.y * other.y
    }

    pub(crate) fn cross(self, other: Self) -> f32 {
        self.x * other.y - self.y * other.x
    }

    /// A quarter turn counter-clockwise.
    pub(crate) fn perpendicular(self) -> Self {
        Self { x: -self.y, y: self.x }
    }

    /// Sum of two vectors.
    pub(crate) fn plus(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y }
    }

    /// The vector times a number.
    pub(crate) fn times(self, factor: f32) -> Self {
        Self { x: self.x * factor, y: self.y * factor }
    }
}

/// The nearest `f32`.
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn single(value: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "rounded, as it says")]
    let rounded = value as f32;
    rounded
}

impl Sub for Point {
    type Output = Vec2;
    fn sub(self, other: Self) -> Vec2 {
        Vec2::new(self.x - other.x, self.y - other.y)
    }
}

impl Add<Vec2> for Point {
    type Output = Self;
    fn add(self, by: Vec2) -> Self {
        Self::new(self.x + by.x, self.y + by.y)
    }
}

impl Sub<Vec2> for Point {
    type Output = Self;
    fn sub(self, by: Vec2) -> Self {
        Self::new(self.x - by.x, self.y - by.y)
    }
}

impl AddAssign<Vec2> for Point {
    fn add_assign(&mut self, by: Vec2) {
        *self = *self + by;
    }
}

impl Add for Vec2 {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y)
    }
}

impl Sub for Vec2 {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }
}

impl Mul<f64> for Vec2 {
    type Output = Self;
    fn mul(self, by: f64) -> Self {
        Self::new(self.x * by, self.y * by)
    }
}

impl Neg for Vec2 {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y)
    }
}

/// A straight line from one place to another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Segment {
    /// Where it starts.
    pub from: Point,
    /// Where it ends.
    pub to: Point,
}

impl Segment {
    /// The straight line from `from` to `to`.
    #[must_use]
    pub const fn new(from: Point, to: Point) -> Self {
        Self { from, to }
    }

    /// Length, mm.
    #[must_use]
    pub fn length(self) -> f64 {
        self.from.distance(self.to)
    }

    /// The place on the segment nearest to `point`; the start for a segment without length.
    #[must_use]
    pub fn nearest(self, point: Point) -> Point {
        let along = self.to - self.from;
        let square = along.length_squared();
        if square > 0.0 {
            let t = (point - self.from).dot(along) / square;
            self.from.lerp(self.to, t.clamp(0.0, 1.0))
        } else {
            self.from
        }
    }

    /// Between which shares of its way, 0 to 1, it lies in a rectangle, whose sides along the axes belong to
    /// it; `None` where it does not come into it.
    ///
    /// Source: Y.-D. Liang, B. A. Barsky, "A new concept and method for line clipping" (1984).
    ///
    /// ```
    /// # use plotter_motion::{Point, Segment};
    /// let line = Segment::new(Point::new(-5.0, 1.0), Point::new(15.0, 1.0));
    /// // from 5 mm on its way of 20 mm to 15 mm
    /// assert_eq!(line.shares_in(Point::ORIGIN, Point::new(10.0, 2.0)), Some((0.25, 0.75)));
    /// assert_eq!(line.shares_in(Point::ORIGIN, Point::new(10.0, 0.5)), None);
    /// ```
    #[must_use]
    pub fn shares_in(self, least: Point, most: Point) -> Option<(f64, f64)> {
        let (way, low, high) = (self.to - self.from, least - self.from, most - self.from);
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        for (step, low, high) in [(way.x, low.x, high.x), (way.y, low.y, high.y)] {
            if step == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let (enters, leaves) =
                if step > 0.0 { (low / step, high / step) } else { (high / step, low / step) };
            first = libm::fmax(first, enters);
            last = libm::fmin(last, leaves);
        }
        (first <= last).then_some((first, last))
    }

    /// Distance of `point` from the nearest place of the segment, mm.
    ///
    /// ```
    /// # use plotter_motion::{Point, Segment};
    /// let base = Segment::new(Point::new(0.0, 0.0), Point::new(10.0, 0.0));
    /// assert_eq!(base.distance(Point::new(5.0, 2.0)), 2.0); // beside it
    /// assert_eq!(base.distance(Point::new(13.0, 4.0)), 5.0); // past its end: 3-4-5
    /// ```
    #[must_use]
    pub fn distance(self, point: Point) -> f64 {
        self.nearest(point).distance(point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_segment_measures_like_a_point() {
        let dot = Segment::new(Point::new(1.0, 1.0), Point::new(1.0, 1.0));
        assert_eq!(dot.distance(Point::new(4.0, 5.0)), 5.0);
    }

    #[test]
    fn a_zero_displacement_has_no_direction() {
        assert_eq!(Vec2::default().normalized(), None);
        assert_eq!(Vec2::new(f64::NAN, 1.0).normalized(), None);
        assert_eq!(Vec2::new(0.0, -3.0).normalized(), Some(Vec2::new(0.0, -1.0)));
    }

    #[test]
    fn a_quarter_turn_moves_right_to_up() {
        assert_eq!(Vec2::new(2.0, 0.0).perpendicular(), Vec2::new(0.0, 2.0));
        /// The last bit of 2, twice.
        const ROUNDING_MM: f64 = 1e-15;
        let turned = Vec2::new(2.0, 0.0).rotated(core::f64::consts::FRAC_PI_2);
        assert!((turned - Vec2::new(0.0, 2.0)).length() < ROUNDING_MM);
    }
}
