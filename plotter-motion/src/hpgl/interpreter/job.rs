//! [`Job`]: a command that draws more than fits into the queue, piece by piece.

use super::super::hatch::Hatch;
use super::super::piece::{Arc, Piece, turned_deg};
use super::super::polygon::Cursor;
use super::super::scaling::Scaling;
use super::text_job::TextJob;
use crate::Vec2;
use crate::bezier::Bezier;
use crate::toolpath::shapes::unit_circle;

/// What is being drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Job {
    #[default]
    None,
    /// A circle or an arc, chord by chord.
    Round(Round),
    /// A curve, and where it has come to.
    Curve(Bezier, Vec2),
    /// The sides of the polygon.
    Edge(Cursor),
    /// The lines that fill it, and whether the line type applies to them.
    Fill(Hatch, bool),
    /// The characters that are kept.
    Text(TextJob),
}

/// A circle or an arc that the text wants in chords, in user units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Round {
    pub(super) centre: Vec2,
    pub(super) shape: Shape,
    pub(super) chords: u32,
    /// The end of the next chord, from 1.
    pub(super) next: u32,
    /// Where the chord before ended, plotter units.
    pub(super) at: Vec2,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    /// From its rightmost place (leftmost for a negative radius).
    Circle { radius: f64 },
    /// From so far from the centre, by this angle.
    Arc { out: Vec2, sweep_deg: f64 },
}

impl Round {
    /// Where a chord ends, plotter units: chord 0 is where the first one begins.
    pub(super) fn place(&self, chord: u32, scaling: &Scaling) -> Vec2 {
        let out = match self.shape {
            // The last chord ends on the very first place.
            Shape::Circle { radius } => unit_circle(chord, self.chords) * radius,
            Shape::Arc { out, sweep_deg } => {
                turned_deg(out, sweep_deg * (f64::from(chord) / f64::from(self.chords)))
            }
        };
        scaling.place(self.centre + out)
    }

    pub(super) fn next(&mut self, scaling: &Scaling) -> Option<Piece> {
        if self.next > self.chords {
            return None;
        }
        let to = self.place(self.next, scaling);
        let from = core::mem::replace(&mut self.at, to);
        self.next += 1;
        Some(Piece::Line { from, to })
    }
}

impl From<Arc> for Piece {
    fn from(arc: Arc) -> Self {
        Self::Arc(arc)
    }
}
