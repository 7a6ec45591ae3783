//! Which switch stands in the way, by a reading of its own: the crate's own answer is what is tested.

use plotter_motion::{Axis, Direction, LimitSwitches};

/// Whether the switch at the end that this axis moves towards is pressed.
pub(crate) fn stands_in_the_way(switches: LimitSwitches, axis: Axis, towards: Direction) -> bool {
    let LimitSwitches { x_min, x_max, y_min, y_max } = switches;
    let [at_least, at_most] = if axis == Axis::X { [x_min, x_max] } else { [y_min, y_max] };
    if towards == Direction::Minus { at_least } else { at_most }
}
