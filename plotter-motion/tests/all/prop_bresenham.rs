//! Laws of the steps along a straight line.

use crate::figure::Figure;
use plotter_motion::{Bresenham, StepPoint};
use proptest::prelude::*;

/// Greatest distance of a position from the line, measured along the minor axis, steps.
static MOST_OFF: Figure = Figure::of("steps off");

/// A position anywhere or at an end of the range of 32 bits, and one at most 3,000 steps from it.
fn ends() -> impl Strategy<Value = (StepPoint, StepPoint)> {
    let edge = prop_oneof![Just(i32::MIN), Just(i32::MAX), Just(0), any::<i32>()];
    (edge.clone(), edge, -3_000..3_000_i32, -3_000..3_000_i32).prop_map(|(x, y, dx, dy)| {
        let from = StepPoint::new(x, y);
        (from, StepPoint::new(x.saturating_add(dx), y.saturating_add(dy)))
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_line_makes_as_many_steps_as_its_longer_side_and_ends_on_target((from, to) in ends()) {
        let mut line = Bresenham::new(from, to);
        let mut position = (i64::from(from.x), i64::from(from.y));
        let mut steps = 0_u32;
        while let Some(step) = line.next() {
            prop_assert!((-1..=1).contains(&step.x) && (-1..=1).contains(&step.y) && (step.x, step.y) != (0, 0));
            position.0 += i64::from(step.x);
            position.1 += i64::from(step.y);
            steps += 1;
            prop_assert_eq!((i64::from(line.position().x), i64::from(line.position().y)), position);
        }
        prop_assert_eq!(steps, from.x.abs_diff(to.x).max(from.y.abs_diff(to.y)));
        prop_assert_eq!(line.position(), to);
        prop_assert_eq!(line.next(), None);
    }

    #[test]
    fn no_position_is_more_than_half_a_step_of_the_minor_axis_off_the_line((from, to) in ends()) {
        let (dx, dy) = (i128::from(to.x) - i128::from(from.x), i128::from(to.y) - i128::from(from.y));
        for point in Bresenham::new(from, to).points() {
            let (px, py) = (i128::from(point.x) - i128::from(from.x), i128::from(point.y) - i128::from(from.y));
            // |dx py - dy px| / major is the distance along the minor axis.
            MOST_OFF.note((dx * py - dy * px).abs() as f64 / dx.abs().max(dy.abs()).max(1) as f64);
            prop_assert!(2 * (dx * py - dy * px).abs() <= dx.abs().max(dy.abs()));
        }
    }

    /// Lines across the whole range have too many steps to take them all: the first 500 are checked.
    #[test]
    fn lines_of_any_length_begin_within_half_a_step(x in any::<i32>(), y in any::<i32>(), tx in any::<i32>(), ty in any::<i32>()) {
        let (dx, dy) = (i128::from(tx) - i128::from(x), i128::from(ty) - i128::from(y));
        let line = Bresenham::new(StepPoint::new(x, y), StepPoint::new(tx, ty));
        for point in line.points().take(500) {
            let (px, py) = (i128::from(point.x) - i128::from(x), i128::from(point.y) - i128::from(y));
            prop_assert!(2 * (dx * py - dy * px).abs() <= dx.abs().max(dy.abs()));
        }
    }
}
