//! From places on the sheet to positions of the motors, and back: the one border between millimetres and
//! steps.
//!
//! ```text
//!   Point, mm ──motors_at──▶ MotorPoint, steps with fraction ──rounded──▶ StepPoint ──Backlash──▶ pulses
//!       ◀──────point_at─────          (to plan with)                     (the truth)
//! ```

mod backlash;
mod cartesian;
mod corexy;

pub use backlash::{Backlash, BacklashState, Takeup};
pub use cartesian::{Cartesian, MotorScale, ScaleError};
pub use corexy::{BeltSigns, CoreXy};

use crate::steps::whole_steps;
use crate::{Point, StepPoint};

/// Position of both motors in steps, with fraction: what is planned with before it is rounded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorPoint {
    /// First motor, steps.
    pub x: f64,
    /// Second motor, steps.
    pub y: f64,
}

impl MotorPoint {
    /// The nearest whole steps, halves away from zero, saturating; a NaN gives 0, as in
    /// [`from_mm`](crate::toolpath::from_mm).
    #[must_use]
    pub fn rounded(self) -> StepPoint {
        StepPoint::new(whole_steps(self.x), whole_steps(self.y))
    }
}

impl From<StepPoint> for MotorPoint {
    fn from(steps: StepPoint) -> Self {
        Self { x: f64::from(steps.x), y: f64::from(steps.y) }
    }
}

/// How a machine's two motors move its pen.
///
/// Both maps are linear and leave the origin where it is, so they turn velocities and accelerations (mm/s
/// into steps/s, as a place that many millimetres from the origin) as well as places. One undoes the other up
/// to rounding of the last bit; whole steps survive the way to millimetres and back exactly.
pub trait Kinematics {
    /// Where the motors stand when the pen is at `point`. What is not finite stays so.
    fn motors_at(&self, point: Point) -> MotorPoint;

    /// Where the pen is when the motors stand at `motors`.
    fn point_at(&self, motors: MotorPoint) -> Point;

    /// The whole steps nearest to `point`, rounded by [`MotorPoint::rounded`].
    fn steps_at(&self, point: Point) -> StepPoint {
        self.motors_at(point).rounded()
    }
}
