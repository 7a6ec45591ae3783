//! [`TextJob`]: characters as strokes.

#[cfg(feature = "font")]
use super::super::font;
use super::super::lettering::Metrics;
use super::super::piece::Piece;
use crate::Vec2;

/// Steps of the grid on which characters are drawn, in a capital letter's width and height.
const GRID: (f64, f64) = (8.0, 12.0);

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
    /// What is left of its strokes, and of those of its accent.
    strokes: &'static [u8],
    accent: &'static [u8],
    at: Vec2,
    /// Where the pen has come to within a stroke, and whether it has marked anything.
    pen: Option<(Vec2, bool)>,
}

impl TextJob {
    pub(super) fn new(metrics: Metrics, at: Vec2) -> Self {
        Self { metrics, at, next: 0, glyph: None }
    }

    /// The next stretch of a stroke; `None` after the last of `characters`.
    pub(super) fn next(&mut self, characters: &[u8]) -> Option<Piece> {
        loop {
            if let Some(glyph) = &mut self.glyph {
                if let Some(piece) = glyph.next(&self.metrics) {
                    return Some(piece);
                }
                self.glyph = None;
            }
            let character = *characters.get(self.next)?;
            self.next += 1;
            #[cfg(feature = "font")]
            let (strokes, accent) = font::strokes(character);
            #[cfg(not(feature = "font"))]
            let (strokes, accent): (&str, &str) = {
                let _ = character;
                ("", "")
            };
            self.glyph = Some(Glyph {
                strokes: strokes.as_bytes(),
                accent: accent.as_bytes(),
                at: self.at,
                pen: None,
            });
            self.at = self.at + self.metrics.advance;
        }
    }
}

impl Glyph {
    fn next(&mut self, metrics: &Metrics) -> Option<Piece> {
        loop {
            match *self.strokes {
                [] | [b' ', ..] => {
                    self.strokes = match self.strokes {
                        [] if self.accent.is_empty() && self.pen.is_none() => return None,
                        [] => core::mem::take(&mut self.accent),
                        [_, rest @ ..] => rest,
                    };
                    // A stroke of one place is a dot.
                    if let Some((at, false)) = self.pen.take() {
                        return Some(Piece::Line { from: at, to: at });
                    }
                }
                [x, y, ..] => {
                    self.strokes = self.strokes.get(2..).unwrap_or(&[]);
                    let x = (f64::from(x) - f64::from(b'0')) / GRID.0;
                    let y = (f64::from(y) - f64::from(b'e')) / GRID.1;
                    let to = self.at + metrics.right * x + metrics.up * y;
                    if let Some((from, _)) = self.pen.replace((to, false)) {
                        self.pen = Some((to, true));
                        return Some(Piece::Line { from, to });
                    }
                }
                [_] => self.strokes = &[],
            }
        }
    }
}
