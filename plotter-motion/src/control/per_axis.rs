//! [`PerAxis`]: the marking board's controller on a machine whose motors are its axes.

use super::{LineController, PointToPoint, PointToPointSettings};
use crate::kinematics::BeltSigns;
use crate::{Axis, Demand, Direction, Drive, Duty, StepPoint};
use core::time::Duration;

/// [`PointToPoint`], which thinks in two motors on one belt, for one motor an axis: each axis is driven
/// towards its target until it is within the allowed error, and then gets no drive.
///
/// ```
/// # use plotter_motion::control::{LineController, PerAxis, PointToPointSettings};
/// # use plotter_motion::StepPoint;
/// # use core::time::Duration;
/// let mut controller = PerAxis::new(PointToPointSettings::default());
/// controller.start(Duration::ZERO, StepPoint::new(463, 0)); // 10 mm to the right
/// let demand = controller.tick(Duration::from_millis(5));
/// assert!(demand.x.value() > 0.0 && demand.y.value() == 0.0); // the motor of x alone
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PerAxis {
    belt: PointToPoint,
    signs: BeltSigns,
    position: StepPoint,
}

impl PerAxis {
    /// A controller at rest at the origin.
    #[must_use]
    pub fn new(settings: PointToPointSettings) -> Self {
        Self { belt: PointToPoint::new(settings), signs: settings.signs, position: StepPoint::default() }
    }

    /// What the demand of two motors on a belt is for the axes: an axis that moves at all gets the whole
    /// level.
    fn axes(&self, belt: Demand) -> Demand {
        let (x, y) = self.signs.twice_axes(belt.x.value(), belt.y.value());
        let level = belt.x.value().abs().max(belt.y.value().abs());
        let duty = |axis: f32| Duty::saturating(if axis == 0.0 { 0.0 } else { libm::copysignf(level, axis) });
        Demand { x: duty(x), y: duty(y) }
    }
}

impl LineController for PerAxis {
    fn period(&self) -> Option<Duration> {
        self.belt.period()
    }

    fn start(&mut self, now: Duration, target: StepPoint) -> Demand {
        // Both motors of a belt turn by the sum of both axes, which must be a number too.
        const MOST_COUNTS: i32 = 1 << 29;
        let within = |count: i32| count.clamp(-MOST_COUNTS, MOST_COUNTS);
        let (first, second) = self.signs.motors(within(target.x), within(target.y));
        let demand = self.belt.start(now, StepPoint::new(first, second));
        self.axes(demand)
    }

    fn edge(&mut self, now: Duration, axis: Axis, direction: Direction) -> Demand {
        let sign = direction.sign();
        let (x, y) = match axis {
            Axis::X => (sign, 0),
            Axis::Y => (0, sign),
        };
        self.position = StepPoint::new(self.position.x.saturating_add(x), self.position.y.saturating_add(y));
        // A count of an axis is one of both motors of the belt.
        let (first, second) = self.signs.motors(x, y);
        let mut demand = Demand::NONE;
        for (axis, sign) in [(Axis::X, first), (Axis::Y, second)] {
            let direction = if sign > 0 { Direction::Plus } else { Direction::Minus };
            demand = self.belt.edge(now, axis, direction);
        }
        self.axes(demand)
    }

    fn tick(&mut self, now: Duration) -> Demand {
        let demand = self.belt.tick(now);
        self.axes(demand)
    }

    fn applied(&mut self, _drive: Drive) {}

    fn position(&self) -> StepPoint {
        self.position
    }

    fn has_arrived(&self) -> bool {
        self.belt.has_arrived()
    }
}
