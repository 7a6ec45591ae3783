//! [`TextJob`]: characters as strokes.

use super::super::character_set::OWN;
#[cfg(feature = "font")]
use super::super::font;
use super::super::lettering::{LETTER_HEIGHT, LETTER_WIDTH, Metrics, place_of};
use super::super::own_characters::{GRID as OWN_GRID, OwnCharacters};
use super::super::piece::Piece;
use crate::Vec2;

/// The characters of a label that are being drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TextJob {
    pub(super) metrics: Metrics,
    /// Where the next character stands.
    pub(super) at: Vec2,
    /// Which of the characters that are kept is next.
    pub(super) next: usize,
    glyph: Option<Glyph>,
}

/// One character, stroke by stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Glyph {
    strokes: Strokes,
    at: Vec2,
    /// Where the pen has come to within a stroke, and whether it has marked anything.
    pen: Option<(Vec2, bool)>,
}

/// What is left of a character.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Strokes {
    /// Of the font, and of its accent.
    Font(&'static [u8], &'static [u8]),
    /// Of the text's own: which one, and how many of its numbers have been used.
    Own(u8, usize),
}

/// What comes next of a character.
enum Next {
    /// A stroke begins or goes on there, in widths and heights of a capital letter.
    Place {
        x: f64,
        y: f64,
        begins: bool,
    },
    /// The stroke ends.
    Lift,
    End,
}

impl TextJob {
    pub(super) fn new(metrics: Metrics, at: Vec2) -> Self {
        Self { metrics, at, next: 0, glyph: None }
    }

    /// The next stretch of a stroke; `None` after the last of `characters`.
    pub(super) fn next<const BYTES: usize>(
        &mut self,
        characters: &[u16],
        own: &OwnCharacters<BYTES>,
    ) -> Option<Piece> {
        loop {
            if let Some(glyph) = &mut self.glyph {
                if let Some(piece) = glyph.next(&self.metrics, own) {
                    return Some(piece);
                }
                self.glyph = None;
            }
            let character = *characters.get(self.next)?;
            self.next += 1;
            let [_, byte] = character.to_be_bytes();
            let strokes = if character >= OWN { Strokes::Own(byte, 0) } else { Strokes::of_font(byte) };
            self.glyph = Some(Glyph { strokes, at: self.at, pen: None });
            self.at = self.at + self.metrics.advance;
        }
    }
}

impl Glyph {
    fn next<const BYTES: usize>(&mut self, metrics: &Metrics, own: &OwnCharacters<BYTES>) -> Option<Piece> {
        loop {
            let (next, ends) = match self.strokes.next(own) {
                Next::Place { x, y, begins } => (Some((x, y)), begins),
                Next::Lift => (None, true),
                Next::End if self.pen.is_none() => return None,
                Next::End => (None, true),
            };
            let before = if ends { self.pen.take() } else { None };
            if let Some((x, y)) = next {
                let to = self.at + metrics.right * x + metrics.up * y;
                if let Some((from, _)) = self.pen.replace((to, false)) {
                    self.pen = Some((to, true));
                    return Some(Piece::Line { from, to });
                }
            }
            // A stroke of one place is a dot.
            if let Some((at, false)) = before {
                return Some(Piece::Line { from: at, to: at });
            }
        }
    }
}

impl Strokes {
    #[cfg(feature = "font")]
    fn of_font(character: u8) -> Self {
        let (strokes, accent) = font::strokes(character);
        Self::Font(strokes.as_bytes(), accent.as_bytes())
    }

    #[cfg(not(feature = "font"))]
    fn of_font(_: u8) -> Self {
        Self::Font(&[], &[])
    }

    fn next<const BYTES: usize>(&mut self, own: &OwnCharacters<BYTES>) -> Next {
        match self {
            Self::Font(strokes, accent) => match **strokes {
                [x, y, ..] if x != b' ' => {
                    *strokes = strokes.get(2..).unwrap_or(&[]);
                    let place = place_of(x, y);
                    Next::Place { x: place.x / LETTER_WIDTH, y: place.y / LETTER_HEIGHT, begins: false }
                }
                [_, ref rest @ ..] => {
                    *strokes = rest;
                    Next::Lift
                }
                [] if accent.is_empty() => Next::End,
                [] => {
                    *strokes = core::mem::take(accent);
                    Next::Lift
                }
            },
            Self::Own(byte, used) => {
                let Some((place, next)) = own.place(*byte, *used) else { return Next::End };
                *used = next;
                let (x, y) = (f64::from(place.x) / OWN_GRID, f64::from(place.y) / OWN_GRID);
                Next::Place { x, y, begins: place.lifted }
            }
        }
    }
}
