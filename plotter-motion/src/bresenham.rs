//! [`Bresenham`]: a straight line as steps of two motors.
//!
//! ```text
//!  y ▲ . . . . . # #     from (0, 0) to (6, 2): six steps of x, two of them with a step of y,
//!    │ . . # # # . .     each where the line is nearer to the next row
//!    │ # # . . . . .
//!    └──────────────▶ x
//! ```
//!
//! Source: J. E. Bresenham, "Algorithm for computer control of a digital plotter", IBM Systems Journal 4
//! (1965), pages 25 to 30.

use crate::StepPoint;

/// What both motors do at one time: each a step forwards (1), a step back (-1) or none (0); never none of
/// both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct StepPair {
    /// First motor: -1, 0 or 1.
    pub x: i8,
    /// Second motor: -1, 0 or 1.
    pub y: i8,
}

/// The steps of two motors along the straight line between two positions.
///
/// The major axis, the one with more steps, steps every time: max(|dx|, |dy|) steps in all. The other axis is
/// then never more than half a step off the line, and halves go towards the target. In integers, so without
/// any error at the end, for any two positions of 32 bits.
///
/// ```
/// # use plotter_motion::{Bresenham, StepPair, StepPoint};
/// let line = Bresenham::new(StepPoint::new(10, 10), StepPoint::new(13, 9));
/// let steps: Vec<_> = line.collect();
/// // 1/3 of a step down is nearer to 0, 2/3 nearer to 1
/// assert_eq!(steps, [StepPair { x: 1, y: 0 }, StepPair { x: 1, y: -1 }, StepPair { x: 1, y: 0 }]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bresenham {
    position: StepPoint,
    target: StepPoint,
    /// Steps to go.
    remaining: u32,
    /// Steps of the major and of the minor axis in all.
    major: i64,
    minor: i64,
    /// How far the line lies beyond the minor axis' position, in steps times 2 `major`: -`major`..`major`.
    ahead: i64,
    /// The step of the major axis alone, and of both.
    straight: StepPair,
    diagonal: StepPair,
}

impl Bresenham {
    /// The line from one position to another.
    #[must_use]
    pub fn new(from: StepPoint, to: StepPoint) -> Self {
        let (dx, dy) = (to.x.abs_diff(from.x), to.y.abs_diff(from.y));
        let diagonal = StepPair { x: sign(from.x, to.x), y: sign(from.y, to.y) };
        let (major, minor, straight) = if dx >= dy {
            (dx, dy, StepPair { y: 0, ..diagonal })
        } else {
            (dy, dx, StepPair { x: 0, ..diagonal })
        };
        Self {
            position: from,
            target: to,
            remaining: major,
            major: i64::from(major),
            minor: i64::from(minor),
            ahead: 0,
            straight,
            diagonal,
        }
    }

    /// Where the motors stand after the steps taken so far.
    #[must_use]
    pub const fn position(&self) -> StepPoint {
        self.position
    }

    /// Where the line ends.
    #[must_use]
    pub const fn target(&self) -> StepPoint {
        self.target
    }

    /// How many steps are left.
    #[must_use]
    pub const fn remaining(&self) -> u32 {
        self.remaining
    }

    /// The positions passed: the present one, then one a step, the last of them the target.
    ///
    /// ```
    /// # use plotter_motion::{Bresenham, StepPoint};
    /// let line = Bresenham::new(StepPoint::new(0, 0), StepPoint::new(-1, 2));
    /// let passed: Vec<_> = line.points().map(|p| (p.x, p.y)).collect();
    /// assert_eq!(passed, [(0, 0), (-1, 1), (-1, 2)]); // a half goes towards the target
    /// ```
    pub fn points(mut self) -> impl Iterator<Item = StepPoint> {
        let start = self.position;
        core::iter::once(start).chain(core::iter::from_fn(move || self.next().map(|_| self.position)))
    }
}

impl Iterator for Bresenham {
    type Item = StepPair;

    fn next(&mut self) -> Option<StepPair> {
        self.remaining = self.remaining.checked_sub(1)?;
        self.ahead += 2 * self.minor;
        let step = if self.ahead >= self.major {
            self.ahead -= 2 * self.major;
            self.diagonal
        } else {
            self.straight
        };
        // Every position lies between two of 32 bits, so nothing wraps.
        self.position = StepPoint::new(
            self.position.x.wrapping_add(i32::from(step.x)),
            self.position.y.wrapping_add(i32::from(step.y)),
        );
        Some(step)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let steps = usize::try_from(self.remaining);
        (steps.unwrap_or(usize::MAX), steps.ok())
    }
}

impl core::iter::FusedIterator for Bresenham {}

fn sign(from: i32, to: i32) -> i8 {
    match to.cmp(&from) {
        core::cmp::Ordering::Greater => 1,
        core::cmp::Ordering::Equal => 0,
        core::cmp::Ordering::Less => -1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{string::String, vec::Vec};

    /// The positions passed as text, y up; from the origin to the upper right.
    fn picture(line: Bresenham) -> String {
        let (points, corner): (Vec<_>, _) = (line.points().collect(), line.target());
        let mut text = String::new();
        for y in (0..=corner.y).rev() {
            text.extend((0..=corner.x).map(|x| if points.contains(&StepPoint { x, y }) { '#' } else { '.' }));
            text.push('\n');
        }
        text
    }

    #[test]
    fn flat_and_steep_lines_stay_next_to_the_true_one() {
        let to = |x, y| picture(Bresenham::new(StepPoint::default(), StepPoint { x, y }));
        assert_eq!(to(6, 2), ".....##\n..###..\n##.....\n");
        assert_eq!(to(2, 6), "..#\n..#\n.#.\n.#.\n.#.\n#..\n#..\n");
        assert_eq!(to(3, 3), "...#\n..#.\n.#..\n#...\n");
        assert_eq!(to(4, 0), "#####\n");
        assert_eq!(to(0, 0), "#\n");
    }

    #[test]
    fn the_longest_lines_there_are_do_not_overflow() {
        let (low, high) = (StepPoint::new(i32::MIN, i32::MIN), StepPoint::new(i32::MAX, i32::MAX - 1));
        let mut line = Bresenham::new(low, high);
        assert_eq!(line.remaining(), u32::MAX);
        // The one step that y lacks falls into the middle: both move up to there.
        assert!(line.by_ref().take(1_000).all(|step| step == StepPair { x: 1, y: 1 }));
        assert_eq!(line.position(), StepPoint::new(i32::MIN + 1_000, i32::MIN + 1_000));
        let back = Bresenham::new(high, low).next();
        assert_eq!(back, Some(StepPair { x: -1, y: -1 }));
    }
}
