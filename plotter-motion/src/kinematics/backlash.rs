//! [`Backlash`]: extra steps that take up the play of an axis where it turns round.
//!
//! ```text
//!   motor   ──┐     ┌──      the motor's tooth drives one flank of the gap; to drive the other it first
//!   carriage  └┐___┌┘        crosses the gap (the play), during which the carriage stands
//!              play
//! ```

use crate::config::SteppersConfig;
use crate::{Direction, Machine, StepPoint, config::StepperConfig, toolpath::from_mm};

/// The play of both axes, in steps of their motors; 0 for none.
///
/// *Logical* positions are those of the carriage, in steps; *motor* positions are what the motors have
/// stepped. They differ by the play while an axis is driven in the direction other than that in which it was
/// found (homed).
///
/// ```
/// # use plotter_motion::kinematics::{Backlash, BacklashState};
/// # use plotter_motion::StepPoint;
/// let play = Backlash { x_steps: 5, y_steps: 0 };
/// let mut state = BacklashState::default(); // both axes last driven backwards, as homing leaves them
/// let there = play.next(&mut state, StepPoint::new(100, 0)); // turns round: five steps before it moves
/// assert_eq!(there.extra, StepPoint::new(5, 0));
/// assert_eq!(there.motor, StepPoint::new(105, 0));
/// assert_eq!(state.logical(StepPoint::new(105, 0)), StepPoint::new(100, 0));
/// let back = play.next(&mut state, StepPoint::new(80, 0)); // and back
/// assert_eq!((back.extra, back.motor), (StepPoint::new(-5, 0), StepPoint::new(80, 0)));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Backlash {
    /// Of the first motor, steps.
    pub x_steps: u16,
    /// Of the second motor, steps.
    pub y_steps: u16,
}

/// Which way each axis was driven last, and how far its motor is from where the carriage says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BacklashState {
    logical: StepPoint,
    x: Flank,
    y: Flank,
}

/// One axis: the flank of the gap that its motor drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Flank {
    driven: Direction,
    /// Motor position less logical position, steps.
    offset: i32,
}

/// Extra steps before a move that take up play, and where the move then ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Takeup {
    /// Steps of each motor that move no carriage, to be made first; with sign.
    pub extra: StepPoint,
    /// The motors' target, extra steps included.
    pub motor: StepPoint,
}

impl Default for BacklashState {
    /// At the origin, both axes driven backwards last: so homing leaves them, which comes back from the upper
    /// switches.
    fn default() -> Self {
        Self::at(StepPoint::default(), Direction::Minus, Direction::Minus)
    }
}

impl BacklashState {
    /// At `position`, which is both logical and the motors', with the axes driven last as given.
    #[must_use]
    pub const fn at(position: StepPoint, x: Direction, y: Direction) -> Self {
        Self { logical: position, x: Flank { driven: x, offset: 0 }, y: Flank { driven: y, offset: 0 } }
    }

    /// The logical position that belongs to a motor position, while the axes are driven as now.
    #[must_use]
    pub const fn logical(&self, motor: StepPoint) -> StepPoint {
        StepPoint::new(motor.x.saturating_sub(self.x.offset), motor.y.saturating_sub(self.y.offset))
    }
}

impl Backlash {
    /// The play of a checked machine with stepper motors, in whole steps.
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        let steps = |stepper: &StepperConfig| {
            u16::try_from(from_mm(stepper.backlash_mm, stepper.steps_per_mm)).unwrap_or(u16::MAX)
        };
        let SteppersConfig { x, y, .. } = SteppersConfig::of(machine);
        Self { x_steps: steps(&x), y_steps: steps(&y) }
    }

    /// The next move, to the logical position `target`: how many extra steps each motor makes first, and
    /// where the motors then go. An axis that does not move keeps its side of the gap.
    pub fn next(self, state: &mut BacklashState, target: StepPoint) -> Takeup {
        let from = state.logical;
        state.logical = target;
        Takeup {
            extra: StepPoint::new(
                state.x.turn(from.x, target.x, self.x_steps),
                state.y.turn(from.y, target.y, self.y_steps),
            ),
            motor: StepPoint::new(
                target.x.saturating_add(state.x.offset),
                target.y.saturating_add(state.y.offset),
            ),
        }
    }
}

impl Flank {
    /// The extra steps of a move, which are none unless it turns the axis round.
    fn turn(&mut self, from: i32, target: i32, play: u16) -> i32 {
        let direction = match target.cmp(&from) {
            core::cmp::Ordering::Greater => Direction::Plus,
            core::cmp::Ordering::Less => Direction::Minus,
            core::cmp::Ordering::Equal => return 0,
        };
        if direction == self.driven {
            return 0;
        }
        self.driven = direction;
        let extra = direction.sign() * i32::from(play);
        // Back and forth by the same play: the offset is 0 or one play.
        self.offset = self.offset.saturating_add(extra);
        extra
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_that_stands_keeps_its_flank() {
        let play = Backlash { x_steps: 3, y_steps: 7 };
        let mut state = BacklashState::at(StepPoint::default(), Direction::Plus, Direction::Plus);
        let extra = |state: &mut _, x, y| play.next(state, StepPoint::new(x, y)).extra;
        assert_eq!(extra(&mut state, 10, 10), StepPoint::new(0, 0));
        assert_eq!(extra(&mut state, 5, 10), StepPoint::new(-3, 0));
        assert_eq!(extra(&mut state, 5, 5), StepPoint::new(0, -7));
        assert_eq!(extra(&mut state, 5, 4), StepPoint::new(0, 0));
        assert_eq!(extra(&mut state, 6, 5), StepPoint::new(3, 7));
    }
}
