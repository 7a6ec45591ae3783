//! [`Window`]: the part of the sheet that is drawn on, and what of a piece lies within it: `IW`.

use super::piece::{Arc, Piece};
use crate::{Point, Segment, Vec2};

/// A rectangle with sides along the axes, plotter units. Its edges belong to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    low: Vec2,
    high: Vec2,
}

/// What of a piece lies within a window, part by part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Visible {
    piece: Piece,
    window: Option<Window>,
    /// The share of its way that has been dealt with; above 1 when all of it has.
    done: f64,
}

impl Window {
    /// The window between two corners.
    pub(super) fn between(a: Vec2, b: Vec2) -> Self {
        Self {
            low: Vec2::new(libm::fmin(a.x, b.x), libm::fmin(a.y, b.y)),
            high: Vec2::new(libm::fmax(a.x, b.x), libm::fmax(a.y, b.y)),
        }
    }

    pub(super) fn holds(self, at: Vec2) -> bool {
        (self.low.x..=self.high.x).contains(&at.x) && (self.low.y..=self.high.y).contains(&at.y)
    }

    /// The next share of an arc's way, above `after`, at which it crosses a side; 1 if it does no more.
    fn next_crossing(self, arc: Arc, after: f64) -> f64 {
        let radius = arc.radius();
        let mut next = 1.0;
        let mut consider = |direction_rad: f64| {
            let share = arc.share_at(direction_rad);
            if share > after && share < next {
                next = share;
            }
        };
        for x in [self.low.x, self.high.x] {
            let cos = (x - arc.centre.x) / radius;
            if libm::fabs(cos) <= 1.0 {
                let angle_rad = libm::acos(cos);
                consider(angle_rad);
                consider(-angle_rad);
            }
        }
        for y in [self.low.y, self.high.y] {
            let sin = (y - arc.centre.y) / radius;
            if libm::fabs(sin) <= 1.0 {
                let angle_rad = libm::asin(sin);
                consider(angle_rad);
                consider(core::f64::consts::PI - angle_rad);
            }
        }
        next
    }
}

impl Visible {
    pub(super) fn new(piece: Piece, window: Option<Window>) -> Self {
        Self { piece, window, done: 0.0 }
    }

    /// The next part that lies within, in the order of drawing.
    pub(super) fn next(&mut self) -> Option<Piece> {
        if self.done >= 1.0 {
            return None;
        }
        let Some(window) = self.window else {
            self.done = 1.0;
            return Some(self.piece);
        };
        match self.piece {
            Piece::Travel { .. } => {
                self.done = 1.0;
                Some(self.piece)
            }
            Piece::Line { from, to } => {
                self.done = 1.0;
                let at = |place: Vec2| Point::ORIGIN + place;
                let line = Segment::new(at(from), at(to));
                let (first, last) = line.shares_in(at(window.low), at(window.high))?;
                // A line that only touches the window leaves no mark but where it is a dot itself.
                (first < last || from == to).then(|| self.piece.part(first, last))
            }
            Piece::Arc(arc) => {
                while self.done < 1.0 {
                    let first = self.done;
                    let last = window.next_crossing(arc, first);
                    self.done = last;
                    if window.holds(arc.place(0.5 * (first + last))) {
                        return Some(self.piece.part(first, last));
                    }
                }
                None
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn parts(piece: Piece) -> Vec<Piece> {
        let window = Window::between(Vec2::new(100.0, 50.0), Vec2::new(0.0, 0.0));
        let mut visible = Visible::new(piece, Some(window));
        core::iter::from_fn(|| visible.next()).collect()
    }

    #[test]
    fn lines_end_at_the_window() {
        let line = |x1, y1, x2, y2| Piece::Line { from: Vec2::new(x1, y1), to: Vec2::new(x2, y2) };
        assert_eq!(parts(line(-50.0, 25.0, 150.0, 25.0)), [line(0.0, 25.0, 100.0, 25.0)]);
        assert_eq!(parts(line(10.0, 10.0, 10.0, 60.0)), [line(10.0, 10.0, 10.0, 50.0)]);
        assert_eq!(parts(line(0.0, 60.0, 100.0, 60.0)), []);
        assert_eq!(parts(line(0.0, 50.0, 100.0, 50.0)), [line(0.0, 50.0, 100.0, 50.0)]); // along its edge
        assert_eq!(parts(line(5.0, 5.0, 5.0, 5.0)), [line(5.0, 5.0, 5.0, 5.0)]);
    }

    #[test]
    fn a_circle_is_cut_into_arcs() {
        // About the middle of the upper side: the lower half is within, and runs from the left to the right.
        let halves = parts(Piece::Arc(Arc::circle(Vec2::new(50.0, 50.0), Vec2::new(20.0, 0.0))));
        assert_eq!(halves.len(), 1);
        let Piece::Arc(half) = halves[0] else { panic!("{halves:?}") };
        assert!((half.from - Vec2::new(30.0, 50.0)).length() < 1e-9);
        assert!((half.sweep_rad - core::f64::consts::PI).abs() < 1e-9);
        // Wide enough to leave on every side: the corners' arcs are seen, in two places here.
        assert_eq!(parts(Piece::Arc(Arc::circle(Vec2::new(50.0, 25.0), Vec2::new(30.0, 0.0)))).len(), 3);
        assert_eq!(parts(Piece::Arc(Arc::circle(Vec2::new(50.0, 25.0), Vec2::new(90.0, 0.0)))).len(), 0);
    }
}
