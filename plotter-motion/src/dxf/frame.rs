//! [`Vec3`] and [`Frame`]: places in space, and how those of an entity or a block lie in the drawing.

use crate::drawing::Affine;
use crate::drawing::affine::sin_cos;
use crate::{Point, Vec2};
use core::ops::{Add, Mul, Sub};

/// A place or a way in space, in units of the drawing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Vec3 {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) z: f64,
}

impl Vec3 {
    pub(super) const ZERO: Self = Self::new(0.0, 0.0, 0.0);
    /// Up from the sheet: what most entities are drawn across.
    pub(super) const UP: Self = Self::new(0.0, 0.0, 1.0);

    pub(super) const fn new(x: f64, y: f64, z: f64) -> Self {
        Self { x, y, z }
    }

    pub(super) fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    /// As it is seen from above.
    pub(super) fn flat(self) -> Point {
        Point::new(self.x, self.y)
    }

    pub(super) fn length(self) -> f64 {
        libm::sqrt(self.x * self.x + self.y * self.y + self.z * self.z)
    }

    /// Of length 1; `None` without a direction.
    pub(super) fn normalized(self) -> Option<Self> {
        let length = self.length();
        (length > f64::MIN_POSITIVE).then(|| self * (1.0 / length))
    }
}

impl Add for Vec3 {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl Sub for Vec3 {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl Mul<f64> for Vec3 {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }
}

/// Three axes and where they meet: an affine map from what lies in it to what it lies in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub(super) x: Vec3,
    pub(super) y: Vec3,
    pub(super) z: Vec3,
    pub(super) origin: Vec3,
}

impl Frame {
    pub(super) const WORLD: Self =
        Self { x: Vec3::new(1.0, 0.0, 0.0), y: Vec3::new(0.0, 1.0, 0.0), z: Vec3::UP, origin: Vec3::ZERO };

    /// The axes of an entity whose plane lies across `normal`.
    ///
    /// Source: Autodesk, *DXF Reference*, "Arbitrary Axis Algorithm".
    pub(super) fn across(normal: Vec3) -> Self {
        /// Nearer to the z axis than this, the y axis of the drawing gives the first direction.
        const NEAR: f64 = 1.0 / 64.0;
        let Some(z) = normal.normalized() else { return Self::WORLD };
        let is_near = libm::fabs(z.x) < NEAR && libm::fabs(z.y) < NEAR;
        let from = if is_near { Vec3::new(0.0, 1.0, 0.0) } else { Vec3::UP };
        let x = from.cross(z).normalized().unwrap_or(Self::WORLD.x);
        Self { x, y: z.cross(x), z, origin: Vec3::ZERO }
    }

    /// A way within it, seen from outside.
    pub(super) fn way(&self, way: Vec3) -> Vec3 {
        self.x * way.x + self.y * way.y + self.z * way.z
    }

    /// A place within it, seen from outside.
    pub(super) fn place(&self, place: Vec3) -> Vec3 {
        self.origin + self.way(place)
    }

    /// A frame within it, seen from outside.
    pub(super) fn holding(&self, inner: &Self) -> Self {
        Self {
            x: self.way(inner.x),
            y: self.way(inner.y),
            z: self.way(inner.z),
            origin: self.place(inner.origin),
        }
    }

    /// Moved to a place within it.
    pub(super) fn moved(&self, by: Vec3) -> Self {
        Self { origin: self.place(by), ..*self }
    }

    /// Turned counter-clockwise about its z axis.
    pub(super) fn turned(&self, angle_rad: f64) -> Self {
        let (sin, cos) = sin_cos(angle_rad);
        Self { x: self.x * cos + self.y * sin, y: self.y * cos - self.x * sin, ..*self }
    }

    pub(super) fn scaled(&self, by: Vec3) -> Self {
        Self { x: self.x * by.x, y: self.y * by.y, z: self.z * by.z, ..*self }
    }

    /// Where places within it are seen from above.
    pub(super) fn seen_place(self) -> impl Fn(Vec3) -> Point {
        move |place| self.place(place).flat()
    }

    /// What its x and y axes look like from above: the sheet shows nothing of heights.
    pub(super) fn seen(&self) -> Affine {
        let flat = |way: Vec3| Vec2::new(way.x, way.y);
        Affine { x: flat(self.x), y: flat(self.y), origin: self.origin.flat() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_drawn_from_below_is_mirrored() {
        let below = Frame::across(Vec3::new(0.0, 0.0, -1.0));
        let place = below.place(Vec3::new(3.0, 4.0, 0.0));
        assert_eq!((place.x, place.y), (-3.0, 4.0));
        assert_eq!(below.seen().turns_circles(), Some(-1.0));
        assert_eq!(Frame::across(Vec3::UP), Frame::WORLD);
        assert_eq!(Frame::across(Vec3::ZERO), Frame::WORLD);
    }

    #[test]
    fn frames_within_frames() {
        let outer = Frame::WORLD.moved(Vec3::new(10.0, 0.0, 0.0)).turned(core::f64::consts::FRAC_PI_2);
        let inner = Frame::WORLD.moved(Vec3::new(1.0, 2.0, 0.0)).scaled(Vec3::new(2.0, 2.0, 2.0));
        // (1, 1) doubled lies at (3, 4) in the outer one, which is turned: (-4, 3) from (10, 0).
        let place = outer.holding(&inner).place(Vec3::new(1.0, 1.0, 0.0));
        assert_eq!((place.x, place.y), (6.0, 3.0));
    }
}
