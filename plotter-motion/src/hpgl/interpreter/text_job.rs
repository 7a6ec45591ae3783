//! [`TextJob`]: draws the characters of a label, one line at a time.

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
    /// Origin of the next character, plotter units.
    pub(super) at: Vec2,
    /// Index of the next character.
    pub(super) next: usize,
    glyph: Option<Glyph>,
}

/// A character that is being drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Glyph {
    strokes: Strokes,
    /// Origin of the character, plotter units.
    at: Vec2,
    /// Position of the pen within a stroke, plotter units, and whether the stroke has a line yet.
    pen: Option<(Vec2, bool)>,
}

/// The strokes of a character that are not drawn yet.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Strokes {
    /// From the built-in font: the character's own strokes, and those of its accent.
    Font(&'static [u8], &'static [u8]),
    /// From a character that the HPGL text has defined (`DL`): its code, and how many of its numbers are used
    /// up.
    Own(u8, usize),
}

/// The next element of a character.
enum Next {
    /// A point of a stroke, as fractions of the width and height of a capital letter. With `begins` it is the
    /// first of its stroke.
    Place { x: f64, y: f64, begins: bool },
    /// The end of a stroke.
    Lift,
    /// The end of the character.
    End,
}

impl TextJob {
    /// A label whose first character has its origin at `at`, plotter units.
    pub(super) fn new(metrics: Metrics, at: Vec2) -> Self {
        Self { metrics, at, next: 0, glyph: None }
    }

    /// The next line of a stroke; `None` after the last of `characters`.
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
            // The low byte is the character's code; the high byte tells that the text has defined it.
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
            // A stroke of a single point is a dot.
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
            // The font has two bytes for each point, and a blank between strokes: see `font::strokes`.
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
