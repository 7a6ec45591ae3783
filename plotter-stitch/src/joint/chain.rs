//! [`Chain`]: where a frame lies on the sheet after many joints.

use crate::FrameTransform;
use plotter_motion::{Point, Vec2};

/// Frames that follow on one another: each lies in the coordinates of the one before as its joint says, and
/// all together on the sheet.
///
/// ```text
/// sheet = step₁ · step₂ · … · stepₙ · frame n        each step: R(angle) · frame + shift
/// ```
///
/// Angles and shifts are added with their rounding errors kept, so ten thousand frames, 9.5 km, end within
/// 1e-6 mm of the exact product (a test holds it against 106 bits). So the 10-byte floats that the source
/// computes with are not needed.
///
/// ```
/// use plotter_motion::{Point, Vec2};
/// use plotter_stitch::{Chain, FrameTransform};
///
/// // Each frame of 950 mm begins 0.01 mm to the right of the end of the one before.
/// let step = FrameTransform::new(0.0, Vec2::new(0.01, 950.0))?;
/// let mut chain = Chain::new();
/// for _ in 0..1000 {
///     chain.push(&step);
/// }
/// assert_eq!(chain.to_sheet(Point::ORIGIN), Point::new(10.0, 950_000.0));
/// assert_eq!(chain.drift(950.0).lateral_mm, 10.0);
/// # Ok::<(), plotter_stitch::joint::TransformError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Chain {
    frames: u32,
    angle_rad: Sum,
    x_mm: Sum,
    y_mm: Sum,
}

/// How far a frame is from where it would lie on a straight and exact sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Drift {
    /// Across the sheet, mm, to the right.
    pub lateral_mm: f64,
    /// Along the sheet, mm: above 0 where the sheet has become too long.
    pub along_mm: f64,
    /// Turned counter-clockwise, rad.
    pub angle_rad: f64,
}

impl Chain {
    /// The first frame: the sheet's coordinates are its own.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// A chain whose first frame lies so on the sheet.
    #[must_use]
    pub fn beginning_at(first: &FrameTransform) -> Self {
        let mut chain = Self::new();
        chain.push(first);
        Self { frames: 0, ..chain }
    }

    /// The next frame, as it lies in the coordinates of the last one.
    pub fn push(&mut self, step: &FrameTransform) {
        let by = step.shift().rotated(self.angle_rad.value());
        self.x_mm.add(by.x);
        self.y_mm.add(by.y);
        self.angle_rad.add(step.angle_rad());
        self.frames = self.frames.saturating_add(1);
    }

    /// How many frames lie before the last one.
    #[must_use]
    pub const fn frames(&self) -> u32 {
        self.frames
    }

    /// The place on the sheet of a place in the last frame.
    #[must_use]
    pub fn to_sheet(&self, frame: Point) -> Point {
        let by = (frame - Point::ORIGIN).rotated(self.angle_rad.value());
        Point::new(self.x_mm.plus(by.x), self.y_mm.plus(by.y))
    }

    /// How the last frame lies on the sheet.
    ///
    /// Sums of finite steps overflow only beyond any sheet; the frame lies nowhere then, and the first one's
    /// pose is told.
    #[must_use]
    pub fn pose(&self) -> FrameTransform {
        let shift = Vec2::new(self.x_mm.value(), self.y_mm.value());
        FrameTransform::new(self.angle_rad.value(), shift).unwrap_or(FrameTransform::IDENTITY)
    }

    /// How far the last frame is from where it should lie, if each is `frame_mm` long.
    #[must_use]
    pub fn drift(&self, frame_mm: f64) -> Drift {
        Drift {
            lateral_mm: self.x_mm.value(),
            along_mm: self.y_mm.plus(-frame_mm * f64::from(self.frames)),
            angle_rad: self.angle_rad.value(),
        }
    }
}

/// A sum of many numbers that is rounded once.
///
/// Source: A. Neumaier, "Rundungsfehleranalyse einiger Verfahren zur Summation endlicher Summen" (1974).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sum {
    high: f64,
    /// What rounding has taken from `high`.
    low: f64,
}

impl Sum {
    fn add(&mut self, value: f64) {
        let sum = self.high + value;
        let (larger, smaller) =
            if libm::fabs(self.high) >= libm::fabs(value) { (self.high, value) } else { (value, self.high) };
        self.low += (larger - sum) + smaller;
        self.high = sum;
    }

    fn value(&self) -> f64 {
        self.high + self.low
    }

    fn plus(mut self, value: f64) -> f64 {
        self.add(value);
        self.value()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_keeps_what_rounding_takes() {
        let mut sum = Sum::default();
        for value in [1.0, 1e100, 1.0, -1e100] {
            sum.add(value);
        }
        assert_eq!(sum.value(), 2.0);
    }

    #[test]
    fn a_quarter_turn_four_times_comes_back() {
        let quarter = FrameTransform::new(core::f64::consts::FRAC_PI_2, Vec2::new(1.0, 0.0)).unwrap();
        let mut chain = Chain::new();
        (0..4).for_each(|_| chain.push(&quarter));
        /// The last bits of 1, a few times.
        const ROUNDING_MM: f64 = 1e-15;
        assert!(chain.to_sheet(Point::ORIGIN).distance(Point::ORIGIN) < ROUNDING_MM);
    }
}
