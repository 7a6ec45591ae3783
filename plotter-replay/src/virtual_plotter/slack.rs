//! [`Slack`]: where the carriage is in the play of its axes, step by step.

use plotter_motion::kinematics::Backlash;
use plotter_motion::{Axis, Direction};

/// How far each motor has turned, in the gap of its axis, from the flank that it drives towards minus,
/// steps: 0 to the play.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slack {
    x: u16,
    y: u16,
}

impl Slack {
    /// A motor makes a step; says whether the carriage goes with it.
    pub(super) fn moves(&mut self, play: Backlash, axis: Axis, direction: Direction) -> bool {
        let (slack, play) = match axis {
            Axis::X => (&mut self.x, play.x_steps),
            Axis::Y => (&mut self.y, play.y_steps),
        };
        let after = match direction {
            Direction::Plus => slack.saturating_add(1).min(play),
            Direction::Minus => slack.saturating_sub(1),
        };
        core::mem::replace(slack, after) == after
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By how much the carriage goes.
    fn go(slack: &mut Slack, axis: Axis, direction: Direction, steps: u32) -> usize {
        let play = Backlash { x_steps: 5, y_steps: 0 };
        (0..steps).filter(|_| slack.moves(play, axis, direction)).count()
    }

    #[test]
    fn a_gap_is_crossed_before_the_carriage_goes_and_only_where_the_axis_turns_round() {
        let mut slack = Slack::default();
        assert_eq!(go(&mut slack, Axis::X, Direction::Minus, 3), 3); // so it was driven last
        assert_eq!(go(&mut slack, Axis::X, Direction::Plus, 8), 3);
        assert_eq!(go(&mut slack, Axis::X, Direction::Plus, 8), 8);
        // Half of the gap, and back in it.
        assert_eq!(go(&mut slack, Axis::X, Direction::Minus, 2), 0);
        assert_eq!(go(&mut slack, Axis::X, Direction::Plus, 3), 1);
        assert_eq!(go(&mut slack, Axis::X, Direction::Minus, 7), 2);
        assert_eq!(go(&mut slack, Axis::Y, Direction::Plus, 2), 2); // without play
        assert_eq!(go(&mut slack, Axis::Y, Direction::Minus, 2), 2);
    }
}
