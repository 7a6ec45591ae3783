//! [`Block`]: a stretch of path in the look-ahead.

use super::blend::GROWTH;
use super::limits::{Limits, Share, Wish};
use super::{Course, Shape};
use crate::extremes::{greatest, least};
use crate::geom::single;
use crate::root::root;
use crate::{Pen, Point};
use core::time::Duration;

/// What a block is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Kind {
    #[default]
    Line,
    /// A line with the pen up, at a speed that shares of the speeds do not change.
    Jog,
    Arc,
    /// Logarithmic spirals that narrow and widen.
    Narrowing,
    Widening,
    /// A standstill of `length` seconds.
    Dwell,
    SelectPen,
    NewPage,
}

/// A stretch of path with the square of its speeds, or something that is done at a standstill.
///
/// Squares, because v² changes evenly along a path of constant acceleration: no roots are needed to look ahead.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Block {
    to: Point,
    /// Of an arc; of a spiral its pole.
    centre: Point,
    /// mm; seconds of a dwell. In f32 a metre is right to 60 nm.
    length: f32,
    /// Speed that was asked for, mm/s.
    feed_mm_s: f32,
    /// Of an arc or a spiral; f32 says ±2π to 5e-7, and the end is said by `to`.
    sweep_rad: f32,
    /// Square of the speed at its start as it is planned, and the greatest that its corner allows.
    pub(super) entry2: f32,
    pub(super) max_entry2: f32,
    /// Square of the greatest speed at its start for the corner there.
    pub(super) corner2: f32,
    /// Square of the greatest speed on it.
    pub(super) cruise2: f32,
    pub(super) kind: Kind,
    pen: Pen,
    /// Power of the laser, in 65535ths; the number of a pen that is taken.
    power: u16,
}

impl Block {
    pub(super) fn path(shape: Shape, to: Point, length_mm: f32, pen: Pen, power: u16, feed2: f32) -> Self {
        let (kind, centre, sweep_rad) = match shape {
            Shape::Line => (Kind::Line, Point::ORIGIN, 0.0),
            Shape::Arc { centre, sweep_rad } => (Kind::Arc, centre, sweep_rad),
            Shape::Spiral { pole, sweep_rad, growth } if growth < 0.0 => (Kind::Narrowing, pole, sweep_rad),
            Shape::Spiral { pole, sweep_rad, .. } => (Kind::Widening, pole, sweep_rad),
        };
        let (feed_mm_s, sweep_rad) = (root(feed2), sweep_rad);
        Self { to, centre, length: length_mm, feed_mm_s, sweep_rad, kind, pen, power, ..Self::default() }
    }

    pub(super) fn dwell(duration: Duration) -> Self {
        Self { kind: Kind::Dwell, length: duration.as_secs_f32(), ..Self::default() }
    }

    pub(super) fn select_pen(pen: u8) -> Self {
        Self { kind: Kind::SelectPen, power: pen.into(), ..Self::default() }
    }

    pub(super) fn new_page() -> Self {
        Self { kind: Kind::NewPage, ..Self::default() }
    }

    /// mm; seconds of a dwell.
    pub(super) const fn length(&self) -> f32 {
        self.length
    }

    /// Whether it moves.
    pub(super) fn is_path(&self) -> bool {
        matches!(self.kind, Kind::Line | Kind::Jog | Kind::Arc | Kind::Narrowing | Kind::Widening)
    }

    pub(super) fn number(&self) -> u8 {
        u8::try_from(self.power).unwrap_or(u8::MAX)
    }

    /// What its speed is made of.
    pub(super) fn wish(&self, limits: &Limits) -> Wish {
        let share = match (self.kind, self.pen) {
            (Kind::Jog, _) => Share::Jog,
            (_, Pen::Up) => Share::Travel,
            (_, Pen::Down) => Share::Draw,
        };
        Wish { feed_mm_s: self.feed_mm_s, form2: self.form2(limits), share }
    }

    /// Square of the greatest speed that its form allows: on an arc that of its lesser radius.
    fn form2(&self, limits: &Limits) -> f32 {
        /// What the length and the angle may have been rounded by.
        const ROUNDING: f32 = 1e-6;
        if self.kind != Kind::Arc {
            return f32::INFINITY;
        }
        // The length is the angle times the mean of both radii.
        let end_mm = self.to.way_to(&self.centre).length_near();
        let other_mm = 2.0 * self.length / self.sweep_rad.abs() - end_mm;
        limits.accel * greatest(least(end_mm, other_mm), 0.0) * (1.0 - ROUNDING)
    }

    pub(super) fn course(&self) -> Course {
        let (centre, sweep_rad) = (self.centre, self.sweep_rad);
        let shape = match self.kind {
            Kind::Arc => Shape::Arc { centre, sweep_rad },
            Kind::Narrowing => Shape::Spiral { pole: centre, sweep_rad, growth: single(-GROWTH) },
            Kind::Widening => Shape::Spiral { pole: centre, sweep_rad, growth: single(GROWTH) },
            _ => Shape::Line,
        };
        Course {
            shape,
            to: self.to,
            length_mm: self.length,
            feed_mm_s: self.feed_mm_s,
            pen: self.pen,
            laser_power: self.power,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_is_at_most_64_bytes() {
        assert!(size_of::<Block>() <= 64, "{}", size_of::<Block>());
    }
}
