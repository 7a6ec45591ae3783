//! [`Stretch`]: a piece of path that becomes a block; [`Way`]: a straight one.

use super::Shape;
use super::block::Bend;
use crate::geom::{Vec2Single, single};
use crate::root::root;
use crate::{Point, Vec2};

/// What becomes a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    pub(super) shape: Shape,
    pub(super) to: Point,
    pub(super) length_mm: f32,
    /// Directions at its ends.
    pub(super) entry: [f32; 2],
    pub(super) exit: [f32; 2],
    /// Square of the speed that was asked for.
    pub(super) feed2: f32,
    pub(super) bend: Bend,
}

/// A straight way as the look-ahead reckons with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Way {
    pub(super) length_mm: f32,
    pub(super) direction: [f32; 2],
}

impl Way {
    pub(super) fn new(way: Vec2Single) -> Self {
        /// Squares below this may have too few bits in `f32`, mm²: those of lengths below 1e-12 mm.
        const LEAST_SQUARE: f32 = 1e-24;
        /// Factor for such short vectors: the shortest, of 1e-45 mm, becomes 1e-30 mm.
        const LONGER: f32 = 1e15;
        let square = way.dot(way);
        if square >= LEAST_SQUARE {
            let length_mm = root(square);
            let share = 1.0 / length_mm;
            return Self { length_mm, direction: [way.x * share, way.y * share] };
        }
        let longer = way.times(LONGER);
        let length = longer.length_near();
        let share = if length > 0.0 { 1.0 / length } else { 0.0 };
        Self { length_mm: length / LONGER, direction: [longer.x * share, longer.y * share] }
    }
}

/// As the look-ahead reckons with it.
pub(super) fn direction(way: Vec2) -> [f32; 2] {
    [single(way.x), single(way.y)]
}
