//! [`Bounds`]: the box round a drawing.

use crate::Point;

/// A rectangle, mm. Empty, it has its corners at infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Its lower left corner.
    pub least: Point,
    /// Its upper right corner.
    pub most: Point,
}

impl Default for Bounds {
    fn default() -> Self {
        let most = f64::INFINITY;
        Self { least: Point::new(most, most), most: Point::new(-most, -most) }
    }
}

impl Bounds {
    /// Round one place.
    #[must_use]
    pub const fn at(place: Point) -> Self {
        Self { least: place, most: place }
    }

    /// Between two corners.
    #[must_use]
    pub fn between(a: Point, b: Point) -> Self {
        let mut bounds = Self::at(a);
        bounds.grow(b);
        bounds
    }

    /// Takes a place in.
    pub fn grow(&mut self, place: Point) {
        self.least = Point::new(libm::fmin(self.least.x, place.x), libm::fmin(self.least.y, place.y));
        self.most = Point::new(libm::fmax(self.most.x, place.x), libm::fmax(self.most.y, place.y));
    }

    /// Takes another box in.
    pub fn join(&mut self, other: &Self) {
        if !other.is_empty() {
            self.grow(other.least);
            self.grow(other.most);
        }
    }

    /// Whether nothing is in it.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !(self.least.x <= self.most.x && self.least.y <= self.most.y)
    }

    /// Its width and height, mm; 0 of an empty one.
    #[must_use]
    pub fn size_mm(&self) -> (f64, f64) {
        if self.is_empty() { (0.0, 0.0) } else { (self.most.x - self.least.x, self.most.y - self.least.y) }
    }

    /// Its middle; the origin of an empty one.
    #[must_use]
    pub fn centre(&self) -> Point {
        if self.is_empty() { Point::ORIGIN } else { self.least.lerp(self.most, 0.5) }
    }

    /// Its corners, counter-clockwise from the lower left.
    #[must_use]
    pub const fn corners(&self) -> [Point; 4] {
        let (least, most) = (self.least, self.most);
        [least, Point::new(most.x, least.y), most, Point::new(least.x, most.y)]
    }

    /// Wider on each side.
    pub(super) const fn wider(&self, by_mm: f64) -> Self {
        let (least, most) = (self.least, self.most);
        Self {
            least: Point::new(least.x - by_mm, least.y - by_mm),
            most: Point::new(most.x + by_mm, most.y + by_mm),
        }
    }

    /// Whether a place lies in it or on its border.
    #[must_use]
    pub fn has(&self, place: Point) -> bool {
        (self.least.x..=self.most.x).contains(&place.x) && (self.least.y..=self.most.y).contains(&place.y)
    }

    /// Whether two boxes have a place in common.
    #[must_use]
    pub fn meets(&self, other: &Self) -> bool {
        self.least.x <= other.most.x
            && other.least.x <= self.most.x
            && self.least.y <= other.most.y
            && other.least.y <= self.most.y
    }
}
