//! [`Affine`]: what moves, turns, scales and mirrors a drawing.

use crate::{Point, Vec2};

/// A map of the plane that keeps straight lines straight and parallel ones parallel: x and y of a place count
/// along its axes, from its origin.
///
/// ```
/// use plotter_motion::{Point, drawing::Affine};
/// // Turned by a quarter, then moved: (1, 0) goes to (0, 1), and on to (10, 1).
/// let map = Affine::turned(std::f64::consts::FRAC_PI_2).then(&Affine::moved(10.0, 0.0));
/// assert!(map.apply(Point::new(1.0, 0.0)).distance(Point::new(10.0, 1.0)) < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Affine {
    /// Where the x axis goes, for each mm along it.
    pub x: Vec2,
    /// Where the y axis goes, for each mm along it.
    pub y: Vec2,
    /// Where the origin goes, mm.
    pub origin: Point,
}

impl Default for Affine {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Affine {
    /// What leaves all where it is.
    pub const IDENTITY: Self = Self { x: Vec2::new(1.0, 0.0), y: Vec2::new(0.0, 1.0), origin: Point::ORIGIN };

    /// Moves by so much, mm.
    #[must_use]
    pub const fn moved(x_mm: f64, y_mm: f64) -> Self {
        Self { origin: Point::new(x_mm, y_mm), ..Self::IDENTITY }
    }

    /// Scales about the origin. A factor below 0 mirrors.
    #[must_use]
    pub const fn scaled(x: f64, y: f64) -> Self {
        Self { x: Vec2::new(x, 0.0), y: Vec2::new(0.0, y), ..Self::IDENTITY }
    }

    /// Turns about the origin, counter-clockwise; exactly for quarters of a turn.
    #[must_use]
    pub fn turned(angle_rad: f64) -> Self {
        let (sin, cos) = sin_cos(angle_rad);
        Self { x: Vec2::new(cos, sin), y: Vec2::new(-sin, cos), ..Self::IDENTITY }
    }

    /// This, and then `next`.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        Self { x: next.way(self.x), y: next.way(self.y), origin: next.apply(self.origin) }
    }

    /// Where a way goes.
    #[must_use]
    pub fn way(&self, way: Vec2) -> Vec2 {
        self.x * way.x + self.y * way.y
    }

    /// Where a place goes.
    #[must_use]
    pub fn apply(&self, place: Point) -> Point {
        self.origin + self.x * place.x + self.y * place.y
    }

    /// Whether circles stay circles: 1 or −1 for whether they turn as before; `None` where they become
    /// ellipses.
    pub(crate) fn turns_circles(&self) -> Option<f64> {
        /// Share of a length by which axes may differ: what rounding makes of maps within maps, and a
        /// millionth of a millimetre of a metre.
        const ROUNDING: f64 = 1e-9;
        let square = self.x.length_squared();
        let is_square = libm::fabs(self.x.dot(self.y)) <= ROUNDING * square
            && libm::fabs(self.y.length_squared() - square) <= ROUNDING * square;
        (is_square && square > 0.0).then(|| if self.x.cross(self.y) < 0.0 { -1.0 } else { 1.0 })
    }

    /// Whether all its numbers are finite, and no area becomes a line.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        let area = self.x.cross(self.y);
        self.origin.is_finite() && area.is_finite() && area != 0.0
    }
}

/// Sine and cosine: exact at quarters of a turn, in which most drawings, blocks and texts are turned.
pub(crate) fn sin_cos(angle_rad: f64) -> (f64, f64) {
    /// Greatest relative error of an angle that was converted from degrees: some last bits of `f64`.
    const NEAR: f64 = 1e-15;
    let quarters = angle_rad / core::f64::consts::FRAC_PI_2;
    let nearest = libm::round(quarters);
    if libm::fabs(quarters - nearest) > NEAR * libm::fmax(1.0, libm::fabs(quarters)) {
        return (libm::sin(angle_rad), libm::cos(angle_rad));
    }
    match libm::fmod(libm::fmod(nearest, 4.0) + 4.0, 4.0) {
        1.0 => (1.0, 0.0),
        2.0 => (0.0, -1.0),
        3.0 => (-1.0, 0.0),
        _ => (0.0, 1.0),
    }
}
