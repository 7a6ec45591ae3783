//! [`PxPoint`] and [`PxVec`]: places on a picture, and the ways between them, in pixels.

use super::Pixel;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A place on the picture, px: x to the right, y **down**, (0, 0) in the picture's upper left corner.
///
/// The centre of pixel (i, j) is at (i + 0.5, j + 0.5). Between two places lies a [`PxVec`]; two places
/// cannot be added.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PxPoint {
    /// To the right, px.
    pub x: f64,
    /// Down, px.
    pub y: f64,
}

/// A displacement on the picture, px: from one [`PxPoint`] to another, a direction, or a speed.
///
/// On the sheet, in mm and with y up, it is [`Vec2`](plotter_motion::Vec2).
///
/// ```
/// # use plotter_vector::{PxPoint, PxVec};
/// let way = PxPoint::new(5.0, 6.0) - PxPoint::new(2.0, 2.0);
/// assert_eq!((way, way.length()), (PxVec::new(3.0, 4.0), 5.0));
/// assert_eq!(PxPoint::new(5.0, 6.0) + way * 2.0, PxPoint::new(11.0, 14.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PxVec {
    /// To the right, px.
    pub x: f64,
    /// Down, px.
    pub y: f64,
}

impl PxPoint {
    /// The place `x` px right of and `y` px below the upper left corner.
    #[must_use]
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    /// Straight distance to `other`, px.
    #[must_use]
    pub fn distance(self, other: Self) -> f64 {
        (self - other).length()
    }

    /// Whether `other` is nearer than this, px; quicker than their distance.
    #[inline]
    pub(crate) fn is_within(self, px: f64, other: Self) -> bool {
        px > 0.0 && (self - other).length_squared() < px * px
    }

    /// Whether both coordinates are numbers.
    pub(crate) fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite()
    }
}

impl PxVec {
    /// Right, down, left and up, of length 1.
    pub(crate) const AXES: [Self; 4] =
        [Self::new(1.0, 0.0), Self::new(0.0, 1.0), Self::new(-1.0, 0.0), Self::new(0.0, -1.0)];

    /// The displacement by `x` px to the right and `y` px down.
    #[must_use]
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    /// Length, px; free of overflow for large components.
    #[must_use]
    pub fn length(self) -> f64 {
        libm::hypot(self.x, self.y)
    }

    /// Square of the length, px².
    #[must_use]
    #[inline]
    pub fn length_squared(self) -> f64 {
        self.dot(self)
    }

    /// Length of a way of 10⁻¹⁵⁰ to 10¹⁵⁰ px: without the scaling of `hypot`.
    #[inline]
    pub(crate) fn length_near(self) -> f64 {
        libm::sqrt(self.length_squared())
    }

    /// Scalar product, px²: |a| |b| cos of the angle between.
    #[must_use]
    #[inline]
    pub fn dot(self, other: Self) -> f64 {
        self.x * other.x + self.y * other.y
    }

    /// Third component of the vector product, px²: |a| |b| sin of the angle from `self` to `other`, positive
    /// when `other` lies clockwise as seen.
    ///
    /// ```
    /// # use plotter_vector::PxVec;
    /// assert_eq!(PxVec::new(1.0, 0.0).cross(PxVec::new(0.0, 2.0)), 2.0); // right, then down
    /// ```
    #[must_use]
    #[inline]
    pub fn cross(self, other: Self) -> f64 {
        self.x * other.y - self.y * other.x
    }

    /// The same direction with length 1; `None` where there is none: of no length, or not finite.
    #[must_use]
    pub fn normalized(self) -> Option<Self> {
        let length = self.length();
        (length > 0.0 && length.is_finite()).then(|| self / length)
    }

    /// A quarter turn clockwise as seen, of the same length.
    ///
    /// ```
    /// # use plotter_vector::PxVec;
    /// assert_eq!(PxVec::new(1.0, 0.0).perpendicular(), PxVec::new(0.0, 1.0)); // right, then down
    /// ```
    #[must_use]
    pub fn perpendicular(self) -> Self {
        Self::new(-self.y, self.x)
    }

    /// Turned clockwise as seen by `angle_rad`.
    #[must_use]
    pub fn rotated(self, angle_rad: f64) -> Self {
        let (sin, cos) = libm::sincos(angle_rad);
        Self::new(self.x * cos - self.y * sin, self.x * sin + self.y * cos)
    }
}

impl From<Pixel> for PxPoint {
    /// The pixel's centre.
    fn from(pixel: Pixel) -> Self {
        Self { x: f64::from(pixel.x) + 0.5, y: f64::from(pixel.y) + 0.5 }
    }
}

impl Sub for PxPoint {
    type Output = PxVec;
    #[inline]
    fn sub(self, other: Self) -> PxVec {
        PxVec::new(self.x - other.x, self.y - other.y)
    }
}

impl Sub for Pixel {
    type Output = PxVec;
    /// The displacement in whole px (exact).
    fn sub(self, other: Self) -> PxVec {
        PxVec::new(f64::from(self.x) - f64::from(other.x), f64::from(self.y) - f64::from(other.y))
    }
}

impl Add<PxVec> for PxPoint {
    type Output = Self;
    #[inline]
    fn add(self, by: PxVec) -> Self {
        Self::new(self.x + by.x, self.y + by.y)
    }
}

impl Sub<PxVec> for PxPoint {
    type Output = Self;
    #[inline]
    fn sub(self, by: PxVec) -> Self {
        Self::new(self.x - by.x, self.y - by.y)
    }
}

impl AddAssign<PxVec> for PxPoint {
    fn add_assign(&mut self, by: PxVec) {
        *self = *self + by;
    }
}

impl Add for PxVec {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y)
    }
}

impl Sub for PxVec {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }
}

impl AddAssign for PxVec {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for PxVec {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl Neg for PxVec {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y)
    }
}

impl Mul<f64> for PxVec {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self::new(self.x * factor, self.y * factor)
    }
}

impl Div<f64> for PxVec {
    type Output = Self;
    #[inline]
    fn div(self, divisor: f64) -> Self {
        Self::new(self.x / divisor, self.y / divisor)
    }
}
