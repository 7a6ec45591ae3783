//! [`ChosenController`]: the one that a machine's description asks for.

use super::{AxisTrouble, Contouring, LineController, LineTracking, PointToPoint, PointToPointSettings};
use crate::{
    Axis, Demand, Direction, Drive, Machine, StepPoint,
    config::{ControllerChoice, DcConfig, DriveConfig},
};
use core::time::Duration;

/// Any of the controllers, for programs that learn only from a file which one it is.
///
/// It is as large as the largest one. A firmware that has but one takes that itself.
///
/// ```
/// # use plotter_motion::{Machine, MachineConfig, control::ChosenController};
/// let machine = Machine::new(MachineConfig::default())?;
/// assert!(matches!(ChosenController::of(&machine), ChosenController::Contouring(_)));
/// # Ok::<(), plotter_motion::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[expect(clippy::large_enum_variant, reason = "a machine has one, and no heap to put it on")]
pub enum ChosenController {
    /// As published for motors that each move an axis.
    LineTracking(LineTracking),
    /// As published for the motors of a belt.
    PointToPoint(PointToPoint),
    /// Ours.
    Contouring(Contouring),
}

impl ChosenController {
    /// The one that a machine's description names, at rest at the origin. What was published differs with how
    /// the motors move the pen; ours is the same.
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        match (DcConfig::of(machine).control.controller, &machine.config().drive) {
            (ControllerChoice::Published, DriveConfig::Gantry(_) | DriveConfig::Steppers(_)) => {
                Self::LineTracking(LineTracking::new(machine))
            }
            (ControllerChoice::Published, DriveConfig::Belt(_)) => {
                Self::PointToPoint(PointToPoint::new(PointToPointSettings::of(machine)))
            }
            (ControllerChoice::Contouring, _) => Self::Contouring(Contouring::new(machine)),
        }
    }

    fn get(&self) -> &dyn LineController {
        match self {
            Self::LineTracking(controller) => controller,
            Self::PointToPoint(controller) => controller,
            Self::Contouring(controller) => controller,
        }
    }

    fn get_mut(&mut self) -> &mut dyn LineController {
        match self {
            Self::LineTracking(controller) => controller,
            Self::PointToPoint(controller) => controller,
            Self::Contouring(controller) => controller,
        }
    }
}

impl LineController for ChosenController {
    fn period(&self) -> Option<Duration> {
        self.get().period()
    }

    fn start(&mut self, now: Duration, target: StepPoint) -> Demand {
        self.get_mut().start(now, target)
    }

    fn edge(&mut self, now: Duration, axis: Axis, direction: Direction) -> Demand {
        self.get_mut().edge(now, axis, direction)
    }

    fn tick(&mut self, now: Duration) -> Demand {
        self.get_mut().tick(now)
    }

    fn applied(&mut self, drive: Drive) {
        self.get_mut().applied(drive);
    }

    fn position(&self) -> StepPoint {
        self.get().position()
    }

    fn has_arrived(&self) -> bool {
        self.get().has_arrived()
    }

    fn trouble(&self) -> Option<AxisTrouble> {
        self.get().trouble()
    }

    fn reference(&self) -> Option<[f64; 2]> {
        self.get().reference()
    }
}
