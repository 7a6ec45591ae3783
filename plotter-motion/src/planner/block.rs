//! [`Block`]: a stretch of path in the look-ahead.

use super::law::{Law, MOST_FORM_SHARE, twice};
use super::limits::{Limits, Share, Wish};
use super::{Course, Shape};
use crate::geom::Vec2Single;
use crate::root::root;
use crate::{Pen, Point};
use core::time::Duration;

/// The kinds of block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Kind {
    #[default]
    Line,
    /// A jog: a line with the pen up, whose speed is not changed by overrides.
    Jog,
    Arc,
    Parabola,
    /// An arc that rises or falls on its way.
    #[cfg(feature = "third-motor")]
    Helix,
    /// A standstill of `length` seconds.
    Dwell,
    SelectPen,
    NewPage,
}

/// How a stretch of path turns, and how much acceleration is left along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Bend {
    /// Greatest acceleration along it, mm/s².
    Line { accel: f32 },
    /// Its turn, rad, and the square of the speed at which turning takes all of the acceleration, mm²/s².
    Arc { sweep_rad: f32, form2: f32 },
    /// Sine of half of its turn; the component along the first motor's axis of the direction towards its
    /// inside; and the square of the speed as of an arc.
    Parabola { lean: f32, inwards: f32, form2: f32 },
    /// Greatest acceleration along it, its turn, 0 of a line, and the square of the greatest speed.
    #[cfg(feature = "third-motor")]
    Rising { accel: f32, sweep_rad: f32, form2: f32 },
}

/// A stretch of path with the squares of its speeds, or something that is done at a standstill.
///
/// Squares, because v² changes linearly along a path of constant acceleration: looking ahead needs no roots.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Block {
    to: Point,
    /// From its end to the centre of an arc, or to the control point of a parabola, mm. The rounding of `f32`
    /// is small beside its length.
    to_centre: Vec2Single,
    /// Length, mm; of a dwell its time, s. In `f32` a metre is right to 60 nm.
    length: f32,
    /// Requested speed, mm/s.
    feed_mm_s: f32,
    /// Turn of an arc, rad: `f32` holds ±2π to 5e-7, and `to` has the exact end. Of a parabola the sine of
    /// half of its turn.
    form: f32,
    /// Of a line the greatest acceleration along it, mm/s². Of a parabola the component along the first
    /// motor's axis of the direction towards its inside.
    accel: f32,
    /// One over the square of the greatest speed that its form allows, s²/mm²; 0 on a line. See [`Law`].
    per_form2: f32,
    /// Squares of the speed at its start: as it is planned, and the greatest that is allowed there.
    pub(super) entry2: f32,
    pub(super) max_entry2: f32,
    /// Square of the greatest speed that the corner at its start allows.
    pub(super) corner2: f32,
    /// Square of the greatest speed on it.
    pub(super) cruise2: f32,
    pub(super) kind: Kind,
    pen: Pen,
    /// Power of the laser in 65535ths, or the number of the pen to take.
    power: u16,
}

/// Greatest part of an arc that is passed with one acceleration, rad. A machine at rest needs at least an
/// eighth of a circle to reach the greatest speed on it. With parts of this size it comes within 1 % of that
/// speed after a sixth.
const ARC_PIECE_RAD: f32 = 0.2;
/// The same for a parabola, rad. It is smaller because a curve in short chords is a row of parabolas: with
/// parts of 0.1 rad such drawings take 0.3 % longer.
const PARABOLA_PIECE_RAD: f32 = 0.05;
/// Most parts of a parabola. More gain nothing, since a sharp corner is passed at nearly one speed.
const MOST_PARABOLA_PIECES: u16 = 6;

impl Block {
    pub(super) fn path(
        shape: Shape,
        to: Point,
        length_mm: f32,
        (pen, power): (Pen, u16),
        feed2: f32,
        bend: Bend,
    ) -> Self {
        let (kind, centre) = match shape {
            Shape::Line => (Kind::Line, to),
            #[cfg(feature = "third-motor")]
            Shape::Arc { centre, .. } if matches!(bend, Bend::Rising { .. }) => (Kind::Helix, centre),
            Shape::Arc { centre, .. } => (Kind::Arc, centre),
            Shape::Parabola { control } => (Kind::Parabola, control),
        };
        let (form, accel, per_form2) = match bend {
            Bend::Line { accel } => (0.0, accel, 0.0),
            Bend::Arc { sweep_rad, form2 } => (sweep_rad, 0.0, 1.0 / form2),
            Bend::Parabola { lean, inwards, form2 } => (lean, inwards, 1.0 / form2),
            #[cfg(feature = "third-motor")]
            Bend::Rising { accel, sweep_rad, form2 } => (sweep_rad, accel, 1.0 / form2),
        };
        let (feed_mm_s, to_centre) = (root(feed2), to.way_to(&centre));
        Self {
            to,
            to_centre,
            length: length_mm,
            feed_mm_s,
            form,
            accel,
            per_form2,
            kind,
            pen,
            power,
            ..Self::default()
        }
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

    /// Length, mm; of a dwell its time, s.
    pub(super) const fn length(&self) -> f32 {
        self.length
    }

    /// Whether it moves.
    pub(super) fn is_path(&self) -> bool {
        #[cfg(feature = "third-motor")]
        if self.kind == Kind::Helix {
            return true;
        }
        matches!(self.kind, Kind::Line | Kind::Jog | Kind::Arc | Kind::Parabola)
    }

    pub(super) fn number(&self) -> u8 {
        u8::try_from(self.power).unwrap_or(u8::MAX)
    }

    /// The values that its greatest speed follows from.
    pub(super) fn wish(&self) -> Wish {
        let share = match (self.kind, self.pen) {
            (Kind::Jog, _) => Share::Jog,
            (_, Pen::Up) => Share::Travel,
            (_, Pen::Down) => Share::Draw,
        };
        Wish { feed_mm_s: self.feed_mm_s, form2: self.form2(), share }
    }

    /// Square of the greatest speed that its form allows.
    pub(super) fn form2(&self) -> f32 {
        if self.per_form2 > 0.0 { MOST_FORM_SHARE / self.per_form2 } else { f32::INFINITY }
    }

    /// How hard the machine may speed up and brake along it.
    pub(super) fn law(&self, limits: &Limits) -> Law {
        match self.kind {
            Kind::Arc => limits.arc(self.per_form2),
            Kind::Parabola => limits.parabola(self.per_form2, self.form, self.accel, self.length),
            _ => Law::Line(self.accel),
        }
    }

    /// Number of its parts of equal length. Each part is passed with one acceleration at a time.
    pub(super) fn pieces(&self) -> u16 {
        let (turn_rad, piece_rad, most) = match self.kind {
            Kind::Arc => (self.form.abs(), ARC_PIECE_RAD, u16::MAX),
            // Twice the sine of half of it.
            Kind::Parabola => (2.0 * self.form, PARABOLA_PIECE_RAD, MOST_PARABOLA_PIECES),
            _ => return 1,
        };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 120")]
        let whole = (turn_rad / piece_rad) as u16;
        (whole + 1).min(most)
    }

    /// Square of the greatest speed at its end if it is entered at `from2`, or at its start if it is left at
    /// that. A result above `enough2` need not be exact: it may be any number from `enough2` on.
    pub(super) fn reach2(&self, from2: f32, enough2: f32, limits: &Limits) -> f32 {
        let (law, pieces) = (self.law(limits), self.pieces());
        let piece_mm = self.length / f32::from(pieces);
        let mut speed2 = from2;
        for piece in 0..pieces {
            speed2 = law.on_part(piece, pieces).reach2(speed2, piece_mm);
            if speed2 >= enough2 {
                break;
            }
        }
        speed2
    }

    /// If its acceleration is the same at every speed: how much the square of the speed can change along it.
    pub(super) fn even_reach2(&self) -> Option<f32> {
        if !self.is_path() {
            return Some(0.0);
        }
        (self.per_form2 <= 0.0).then(|| twice(self.accel) * self.length)
    }

    /// Square of the least speed at which it can be left if it is entered at `from2`, with the machine
    /// braking as hard as it can.
    pub(super) fn forced2(&self, from2: f32, limits: &Limits) -> f32 {
        let (law, pieces) = (self.law(limits), self.pieces());
        let twice_mm = 2.0 * self.length / f32::from(pieces);
        let mut speed2 = from2;
        for piece in (0..pieces).rev() {
            speed2 -= law.on_part(piece, pieces).accel_at(speed2) * twice_mm;
            if speed2 <= 0.0 {
                return 0.0;
            }
        }
        speed2
    }

    pub(super) fn course(&self) -> Course {
        let centre = self.to.after(self.to_centre);
        let shape = match self.kind {
            Kind::Arc => Shape::Arc { centre, sweep_rad: self.form },
            #[cfg(feature = "third-motor")]
            Kind::Helix => Shape::Arc { centre, sweep_rad: self.form },
            Kind::Parabola => Shape::Parabola { control: centre },
            _ => Shape::Line,
        };
        Course {
            shape,
            to: self.to,
            length_mm: self.length,
            feed_mm_s: self.feed_mm_s,
            pen: self.pen,
            laser_power: self.power,
            #[cfg(feature = "third-motor")]
            to_z_mm: None,
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
