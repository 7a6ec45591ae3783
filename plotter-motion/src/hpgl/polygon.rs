//! [`Polygon`]: the polygon buffer: `PM`, and what `EA`, `RA`, `EW`, `WG` and their like put there.

use super::piece::{Arc, Piece};
use crate::Vec2;

/// What a place in the buffer is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Kind {
    /// The first corner of a subpolygon: no side leads to it.
    #[default]
    Start,
    /// A corner; its side is there to be filled only.
    Hidden,
    /// A corner; its side is drawn.
    Drawn,
    /// Not a corner: the centre of the arc that leads to the corner two places on.
    Centre,
    /// Not a corner: the sweep of that arc as x, rad.
    Sweep,
}

/// Subpolygons with straight sides and arcs, at most `VERTICES` places: a corner takes one, an arc two more.
///
/// 17 bytes a place.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Polygon<const VERTICES: usize> {
    x: [f64; VERTICES],
    y: [f64; VERTICES],
    kind: [Kind; VERTICES],
    count: usize,
    /// Where the subpolygon in progress began.
    start: Option<Vec2>,
    /// Where it has come to, and where the pen was last lowered on the way.
    end: Vec2,
    lowered: Vec2,
    /// A part did not fit.
    overflown: bool,
}

/// A side of a polygon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Side {
    pub(super) piece: Piece,
    pub(super) drawn: bool,
}

/// How far the sides of a polygon have been looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Cursor {
    next: usize,
    at: Vec2,
}

impl<const VERTICES: usize> Polygon<VERTICES> {
    pub(super) fn new() -> Self {
        Self {
            x: [0.0; VERTICES],
            y: [0.0; VERTICES],
            kind: [Kind::Start; VERTICES],
            count: 0,
            start: None,
            end: Vec2::default(),
            lowered: Vec2::default(),
            overflown: false,
        }
    }

    /// Empties the buffer.
    pub(super) fn clear(&mut self) {
        self.count = 0;
        self.start = None;
        self.overflown = false;
    }

    /// Begins at this place.
    pub(super) fn begin(&mut self, at: Vec2) {
        self.clear();
        // With no room for a single place, it will be found out with the first side.
        let _ = self.start_at(at);
    }

    /// Whether a part did not fit since the buffer was emptied.
    pub(super) fn is_overflown(&self) -> bool {
        self.overflown
    }

    /// Whether the subpolygon has been closed, so that the next movement goes to the start of another.
    pub(super) fn is_closed(&self) -> bool {
        self.start.is_none()
    }

    /// Adds a side, or begins a subpolygon with it.
    ///
    /// # Errors
    ///
    /// What there was no room for, to be drawn as it comes; the buffer takes nothing more until it is
    /// emptied.
    pub(super) fn push(&mut self, piece: Piece, drawn: bool) -> Result<(), Piece> {
        if self.is_closed() {
            return self.start_at(piece.to());
        }
        let kind = if drawn { Kind::Drawn } else { Kind::Hidden };
        if !drawn {
            self.lowered = piece.to();
        }
        let arc = match piece {
            Piece::Arc(arc) => {
                [Some((arc.centre, Kind::Centre)), Some((Vec2::new(arc.sweep_rad, 0.0), Kind::Sweep))]
            }
            _ => [None, None],
        };
        let stored = self.store(arc.into_iter().flatten().chain([(piece.to(), kind)]));
        stored.then_some(()).ok_or(if drawn { piece } else { Piece::Travel { to: piece.to() } })
    }

    /// Begins a subpolygon here.
    ///
    /// # Errors
    ///
    /// As [`Polygon::push`].
    pub(super) fn start_at(&mut self, at: Vec2) -> Result<(), Piece> {
        self.start = Some(at);
        self.lowered = at;
        self.store([(at, Kind::Start)]).then_some(()).ok_or(Piece::Travel { to: at })
    }

    /// Closes the subpolygon, with a side to its start where there is none yet. It is drawn with the pen
    /// down, but not where what has been drawn since the pen was last lowered is closed in itself: a hole
    /// without a `PM1` before it.
    ///
    /// # Errors
    ///
    /// As [`Polygon::push`].
    pub(super) fn close(&mut self, drawn: bool) -> Result<(), Piece> {
        match self.start {
            Some(start) if self.end != start => {
                let drawn = drawn && self.end != self.lowered;
                let side = self.push(Piece::Line { from: self.end, to: start }, drawn);
                self.start = None;
                side
            }
            _ => {
                self.start = None;
                Ok(())
            }
        }
    }

    /// Stores all of these places, or none if there is no room.
    fn store(&mut self, places: impl IntoIterator<Item = (Vec2, Kind)>) -> bool {
        let before = self.count;
        for (place, kind) in places {
            self.end = place;
            let slots =
                (self.x.get_mut(self.count), self.y.get_mut(self.count), self.kind.get_mut(self.count));
            if let (Some(x), Some(y), Some(slot), false) = (slots.0, slots.1, slots.2, self.overflown) {
                (*x, *y, *slot) = (place.x, place.y, kind);
                self.count += 1;
            } else {
                self.overflown = true;
            }
        }
        if self.overflown {
            self.count = before;
        }
        !self.overflown
    }

    fn at(&self, index: usize) -> Option<(Vec2, Kind)> {
        if index >= self.count {
            return None;
        }
        Some((Vec2::new(*self.x.get(index)?, *self.y.get(index)?), *self.kind.get(index)?))
    }

    /// The next side.
    pub(super) fn side(&self, cursor: &mut Cursor) -> Option<Side> {
        let mut arc = (Vec2::default(), None);
        loop {
            let (place, kind) = self.at(cursor.next)?;
            cursor.next += 1;
            match kind {
                Kind::Start => cursor.at = place,
                Kind::Centre => arc.0 = place,
                Kind::Sweep => arc.1 = Some(place.x),
                Kind::Hidden | Kind::Drawn => {
                    let from = core::mem::replace(&mut cursor.at, place);
                    let piece = match arc {
                        (centre, Some(sweep_rad)) => Piece::Arc(Arc { centre, from, sweep_rad, to: place }),
                        _ => Piece::Line { from, to: place },
                    };
                    return Some(Side { piece, drawn: kind == Kind::Drawn });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn what_does_not_fit_is_given_back() {
        let mut polygon = Polygon::<4>::new();
        let at = |x| Vec2::new(x, 0.0);
        let line = |from, to| Piece::Line { from: at(from), to: at(to) };
        polygon.begin(at(0.0));
        assert_eq!(polygon.push(line(0.0, 1.0), true), Ok(()));
        let circle = Piece::Arc(Arc::circle(at(0.0), at(1.0)));
        assert_eq!(polygon.push(circle, true), Err(circle));
        assert_eq!(polygon.push(line(1.0, 5.0), false), Err(Piece::Travel { to: at(5.0) }));
        assert_eq!(polygon.push(line(5.0, 7.0), true), Err(line(5.0, 7.0)));
        assert_eq!(polygon.close(true), Err(line(7.0, 0.0)));
        assert_eq!(polygon.push(line(0.0, 8.0), true), Err(Piece::Travel { to: at(8.0) }));
        assert!(polygon.is_overflown());
        let mut cursor = Cursor::default();
        let sides: Vec<_> =
            core::iter::from_fn(|| polygon.side(&mut cursor)).map(|side| side.piece).collect();
        assert_eq!(sides, [line(0.0, 1.0)]);
    }
}
