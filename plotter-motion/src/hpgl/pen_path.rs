//! [`PenPath`]: pieces of the pen's way in, what a plotter marks of them out.

use super::line_type::{Dashes, LineType, Phase};
use super::piece::Piece;
use super::window::{Visible, Window};
use crate::Vec2;

/// Dashes and dots that one event may give: where there would be more, lines are drawn whole. With a travel to
/// each they are about as many operations as the lines of the densest filling.
const MOST_PARTS: u32 = 30_000;

/// Takes pieces one at a time, divides them by the line type, cuts them at the window, and adds the travels
/// that this makes necessary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PenPath {
    pub(super) line_type: LineType,
    pub(super) window: Option<Window>,
    phase: Phase,
    /// Dashes and dots that may follow.
    parts_left: u32,
    /// Where the piece before ended: a pattern goes on from there only.
    end: Vec2,
    /// Where what has been given out has taken the pen.
    given: Vec2,
    dashes: Option<Dashes>,
    visible: Option<Visible>,
    /// To be given after the travel to its beginning.
    next: Option<Piece>,
}

impl PenPath {
    pub(super) fn new() -> Self {
        Self {
            line_type: LineType::Solid,
            window: None,
            phase: Phase::default(),
            parts_left: MOST_PARTS,
            end: Vec2::default(),
            given: Vec2::default(),
            dashes: None,
            visible: None,
            next: None,
        }
    }

    /// Where what has been given out has taken the pen.
    pub(super) const fn given(&self) -> Vec2 {
        self.given
    }

    /// Another line type, which begins anew.
    pub(super) fn set_line_type(&mut self, line_type: LineType) {
        self.line_type = line_type;
        self.phase = Phase::default();
    }

    /// Whether there is nothing to give.
    pub(super) fn is_empty(&self) -> bool {
        self.dashes.is_none() && self.visible.is_none() && self.next.is_none()
    }

    /// Another event: as many dashes and dots as ever.
    pub(super) fn refill(&mut self) {
        self.parts_left = MOST_PARTS;
    }

    /// Takes a piece; the line type applies to it if `patterned`.
    pub(super) fn push(&mut self, piece: Piece, patterned: bool) {
        if let Piece::Travel { to } = piece {
            self.phase = Phase::default();
            if self.window.is_none_or(|window| window.holds(to)) {
                self.next = Some(piece);
            }
        } else {
            if piece.from() != self.end {
                self.phase = Phase::default();
            }
            if !patterned || self.parts_left == 0 || self.line_type == LineType::Solid {
                // One dash, after which the pattern stands where it did.
                self.parts_left = self.parts_left.saturating_sub(1);
                self.visible = Some(Visible::new(piece, self.window));
            } else {
                self.dashes = Some(Dashes::new(piece, self.line_type, self.phase));
            }
        }
        self.end = piece.to();
    }

    /// The next that is to be done; each piece begins where the one before ended.
    pub(super) fn next(&mut self) -> Option<Piece> {
        loop {
            if let Some(piece) = self.next.take() {
                return Some(self.give(piece));
            }
            if let Some(visible) = &mut self.visible {
                let Some(piece) = visible.next() else {
                    self.visible = None;
                    continue;
                };
                if piece.from() == self.given {
                    return Some(self.give(piece));
                }
                self.next = Some(piece);
                return Some(self.give(Piece::Travel { to: piece.from() }));
            }
            let dashes = self.dashes.as_mut()?;
            match if self.parts_left > 0 { dashes.next() } else { dashes.rest() } {
                Some(piece) => {
                    self.parts_left = self.parts_left.saturating_sub(1);
                    self.visible = Some(Visible::new(piece, self.window));
                }
                None => {
                    self.phase = dashes.phase();
                    self.dashes = None;
                }
            }
        }
    }

    fn give(&mut self, piece: Piece) -> Piece {
        self.given = piece.to();
        piece
    }
}
