//! [`Told`]: motors that were where a recording tells, in place of a controller of motors.

use core::time::Duration;
use plotter_motion::control::LineController;
use plotter_motion::{Axis, Demand, Direction, Drive, StepPoint};

/// Counts, and has arrived at a target where the counts are its own. A controller of motors goes by when each
/// edge came, which a recording without edges does not tell: all else of a firmware can be run on it again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Told {
    position: StepPoint,
    target: StepPoint,
}

impl LineController for Told {
    fn period(&self) -> Option<Duration> {
        None
    }

    fn start(&mut self, _now: Duration, target: StepPoint) -> Demand {
        self.target = target;
        Demand::NONE
    }

    fn edge(&mut self, _now: Duration, axis: Axis, direction: Direction) -> Demand {
        let coordinate = match axis {
            Axis::X => &mut self.position.x,
            Axis::Y => &mut self.position.y,
        };
        *coordinate = coordinate.wrapping_add(direction.sign());
        Demand::NONE
    }

    fn tick(&mut self, _now: Duration) -> Demand {
        Demand::NONE
    }

    fn applied(&mut self, _drive: Drive) {}

    fn position(&self) -> StepPoint {
        self.position
    }

    fn has_arrived(&self) -> bool {
        self.position == self.target
    }
}
