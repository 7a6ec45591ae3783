//! [`Hatch`]: the parallel lines that fill a polygon: `FP`, `RA`, `RR`, `WG`.

use super::piece::{Arc, Piece};
use super::polygon::{Cursor, Polygon};
use crate::Vec2;
use core::f64::consts::{PI, TAU};

/// Most lines in one direction: a sheet of 1.6 m with a pen of 0.1 mm.
pub(super) const MOST_LINES: f64 = 16_384.0;

/// What lies within.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    /// Points within an odd number of sides are filled.
    EvenOdd,
    /// Points that the sides go round, counted with their direction, are filled.
    Winding,
}

/// How lines lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lay {
    /// A place on one of them.
    pub(super) anchor: Vec2,
    /// Their direction, of length 1.
    pub(super) along: Vec2,
    /// Distance between two, units, above 0.
    pub(super) spacing: f64,
    /// Whether each line is drawn back from where the one before ended.
    pub(super) back_and_forth: bool,
    pub(super) rule: Rule,
    /// Whether the same lines follow at a right angle.
    pub(super) crossed: bool,
}

/// A polygon that is being filled with lines.
///
/// ```text
///        ┌─────┐        line i at the distance i · spacing from the anchor:
///   ─ ─ ─│─────│─ ─     its crossings with the sides are found one after the
///   ─ ─ ─│─┐ ┌─│─ ─     other, each the nearest beyond the one before, so that
///        └─┘ └─┘        no list of them is kept
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hatch {
    lay: Lay,
    /// To the left of the lines.
    across: Vec2,
    /// Number of the first line, counted from the anchor; of the line in progress and of the last, counted
    /// from that.
    first: f64,
    line: f64,
    last: f64,
    /// The last crossing: how far along the line, and which of the sides' crossings, by number.
    crossing: Option<(f64, u32)>,
    /// How the line has passed the sides up to there.
    turns: i32,
    /// Where what is within began.
    entered: Option<f64>,
    /// Whether the line is drawn against `along`.
    backward: bool,
}

impl Hatch {
    /// The lines that fill `polygon`; `None` if they are more than [`MOST_LINES`].
    pub(super) fn new<const VERTICES: usize>(polygon: &Polygon<VERTICES>, lay: Lay) -> Option<Self> {
        let across = lay.along.perpendicular();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut widen = |at: Vec2| {
            let height = (at - lay.anchor).dot(across);
            low = libm::fmin(low, height);
            high = libm::fmax(high, height);
        };
        let mut cursor = Cursor::default();
        while let Some(side) = polygon.side(&mut cursor) {
            match side.piece {
                Piece::Arc(arc) => each_rising_part(arc, across, |part| {
                    widen(part.from);
                    widen(part.to);
                }),
                piece => {
                    widen(piece.from());
                    widen(piece.to());
                }
            }
        }
        let (first, last) = (libm::ceil(low / lay.spacing), libm::floor(high / lay.spacing));
        // Without sides, first is +∞ and last −∞: there is nothing to do.
        let last = last - first;
        if last >= MOST_LINES || last.is_nan() {
            return None;
        }
        Some(Self {
            lay,
            across,
            first,
            line: 0.0,
            last,
            crossing: None,
            turns: 0,
            entered: None,
            backward: false,
        })
    }

    /// The next stretch of a line that lies within.
    pub(super) fn next<const VERTICES: usize>(&mut self, polygon: &Polygon<VERTICES>) -> Option<Piece> {
        loop {
            if self.line > self.last {
                if !self.lay.crossed {
                    return None;
                }
                let lay = Lay { crossed: false, along: self.across, ..self.lay };
                *self = Self::new(polygon, lay)?;
                continue;
            }
            let Some((at, number, rises)) = self.next_crossing(polygon) else {
                self.line += 1.0;
                (self.crossing, self.turns, self.entered) = (None, 0, None);
                self.backward = self.lay.back_and_forth && !self.backward;
                continue;
            };
            self.crossing = Some((at, number));
            self.turns += match self.lay.rule {
                Rule::EvenOdd => 1 - 2 * (self.turns & 1),
                Rule::Winding => {
                    if rises {
                        1
                    } else {
                        -1
                    }
                }
            };
            match self.entered {
                None if self.turns != 0 => self.entered = Some(at),
                Some(from) if self.turns == 0 => {
                    self.entered = None;
                    if from < at {
                        return Some(Piece::Line { from: self.place(from), to: self.place(at) });
                    }
                }
                _ => {}
            }
        }
    }

    /// Of the line in progress, above the anchor.
    fn height(&self) -> f64 {
        (self.first + self.line) * self.lay.spacing
    }

    fn place(&self, at: f64) -> Vec2 {
        let at = if self.backward { -at } else { at };
        self.lay.anchor + self.lay.along * at + self.across * self.height()
    }

    /// The nearest crossing after the last one: how far along, which one, and whether the side goes up there.
    fn next_crossing<const VERTICES: usize>(&self, polygon: &Polygon<VERTICES>) -> Option<(f64, u32, bool)> {
        let height = self.height();
        let mut nearest: Option<(f64, u32, bool)> = None;
        let mut number = 0_u32;
        let mut consider = |from: f64, to: f64, at: &dyn Fn() -> f64| {
            number += 1;
            // An end belongs to the side that comes up to it from below, so that a corner is crossed once or
            // twice, as it should be, and a side along the line not at all.
            if (from <= height) == (to <= height) {
                return;
            }
            let at = if self.backward { -at() } else { at() };
            let after = self.crossing.is_none_or(|last| (at, number) > last);
            if after && nearest.is_none_or(|(best, which, _)| (at, number) < (best, which)) {
                nearest = Some((at, number, from <= height));
            }
        };
        let mut cursor = Cursor::default();
        while let Some(side) = polygon.side(&mut cursor) {
            let local = |at: Vec2| {
                let way = at - self.lay.anchor;
                Vec2::new(way.dot(self.lay.along), way.dot(self.across))
            };
            match side.piece {
                Piece::Arc(arc) => each_rising_part(arc, self.across, |part| {
                    let (from, to, centre) = (local(part.from), local(part.to), local(arc.centre));
                    consider(from.y, to.y, &|| {
                        let up = height - centre.y;
                        let beside = libm::sqrt(libm::fmax(0.0, part.radius_squared - up * up));
                        if part.right { centre.x + beside } else { centre.x - beside }
                    });
                }),
                piece => {
                    let (from, to) = (local(piece.from()), local(piece.to()));
                    consider(from.y, to.y, &|| {
                        from.x + (to.x - from.x) * ((height - from.y) / (to.y - from.y))
                    });
                }
            }
        }
        nearest
    }
}

/// A part of an arc that only rises or only falls.
struct Rising {
    from: Vec2,
    to: Vec2,
    radius_squared: f64,
    /// Whether it lies right of the centre, seen up.
    right: bool,
}

/// Divides an arc where it is highest and lowest, `up` being up: at most three parts.
fn each_rising_part(arc: Arc, up: Vec2, mut part: impl FnMut(Rising)) {
    let top_rad = libm::atan2(up.y, up.x);
    let (top, bottom) = (arc.share_at(top_rad), arc.share_at(top_rad + PI));
    let (first, second) = (libm::fmin(top, bottom), libm::fmax(top, bottom));
    let turn = TAU / libm::fabs(arc.sweep_rad);
    let mut from = 0.0;
    for to in [first, second, first + turn, 1.0] {
        let to = libm::fmin(to, 1.0);
        if to <= from {
            continue;
        }
        let middle = arc.place(0.5 * (from + to)) - arc.centre;
        part(Rising {
            from: arc.place(from),
            to: arc.place(to),
            radius_squared: (arc.from - arc.centre).length_squared(),
            right: up.cross(middle) < 0.0,
        });
        from = to;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn lay(angle_deg: f64, spacing: f64) -> Lay {
        Lay {
            anchor: Vec2::default(),
            along: crate::hpgl::piece::turned_deg(Vec2::new(1.0, 0.0), angle_deg),
            spacing,
            back_and_forth: false,
            rule: Rule::EvenOdd,
            crossed: false,
        }
    }

    fn square<const N: usize>(polygon: &mut Polygon<N>, low: f64, high: f64) {
        let mut from = Vec2::new(low, low);
        polygon.start_at(from).unwrap();
        for (x, y) in [(high, low), (high, high), (low, high)] {
            polygon.push(Piece::Line { from, to: Vec2::new(x, y) }, true).unwrap();
            from = Vec2::new(x, y);
        }
        polygon.close(true).unwrap();
    }

    fn lines<const N: usize>(polygon: &Polygon<N>, lay: Lay) -> Vec<(f64, f64, f64, f64)> {
        let mut hatch = Hatch::new(polygon, lay).unwrap();
        let rounded = |at: f64| libm::round(at * 1e3) / 1e3 + 0.0;
        core::iter::from_fn(|| hatch.next(polygon))
            .map(|line| {
                (rounded(line.from().x), rounded(line.from().y), rounded(line.to().x), rounded(line.to().y))
            })
            .collect()
    }

    #[test]
    fn a_hole_is_left_out_or_not_as_the_rule_says() {
        let mut polygon = Polygon::<16>::new();
        square(&mut polygon, 0.0, 30.0);
        square(&mut polygon, 10.0, 20.0);
        let lay = Lay { anchor: Vec2::new(0.0, 5.0), ..lay(0.0, 10.0) };
        assert_eq!(
            lines(&polygon, lay),
            [
                (0.0, 5.0, 30.0, 5.0),
                (0.0, 15.0, 10.0, 15.0),
                (20.0, 15.0, 30.0, 15.0),
                (0.0, 25.0, 30.0, 25.0)
            ]
        );
        let all = lines(&polygon, Lay { rule: Rule::Winding, back_and_forth: true, ..lay });
        assert_eq!(all, [(0.0, 5.0, 30.0, 5.0), (30.0, 15.0, 0.0, 15.0), (0.0, 25.0, 30.0, 25.0)]);
        assert_eq!(lines(&polygon, Lay { crossed: true, ..lay }).len(), 4 + 3 + 1);
    }

    #[test]
    fn an_arc_is_met_where_it_is() {
        let mut polygon = Polygon::<8>::new();
        polygon.start_at(Vec2::new(15.0, 10.0)).unwrap();
        polygon.push(Piece::Arc(Arc::circle(Vec2::new(10.0, 10.0), Vec2::new(5.0, 0.0))), true).unwrap();
        polygon.close(true).unwrap();
        // At 3 and 4 above the centre of a circle of 5, the half chords are 4 and 3.
        let lay = Lay { anchor: Vec2::new(0.0, 0.5), ..lay(0.0, 1.0) };
        let all = lines(&polygon, Lay { anchor: Vec2::new(0.0, 13.0), spacing: 100.0, ..lay });
        assert_eq!(all, [(6.0, 13.0, 14.0, 13.0)]);
        assert_eq!(lines(&polygon, lay).len(), 10);
        // Up and down: the right half too begins at the bottom.
        let upright = lines(
            &polygon,
            Lay { anchor: Vec2::new(14.0, 0.0), along: Vec2::new(0.0, 1.0), spacing: 100.0, ..lay },
        );
        assert_eq!(upright, [(14.0, 7.0, 14.0, 13.0)]);
    }

    #[test]
    fn corners_on_a_line_do_not_turn_it_inside_out() {
        let mut polygon = Polygon::<8>::new();
        let corners = [(0.0, 0.0), (10.0, 10.0), (20.0, 0.0), (30.0, 10.0), (40.0, 0.0), (20.0, -10.0)];
        let mut from = Vec2::default();
        polygon.start_at(from).unwrap();
        for (x, y) in corners {
            polygon.push(Piece::Line { from, to: Vec2::new(x, y) }, true).unwrap();
            from = Vec2::new(x, y);
        }
        polygon.close(true).unwrap();
        let within: f64 = lines(&polygon, lay(0.0, 10.0)).iter().map(|(from, _, to, _)| to - from).sum();
        assert_eq!(within, 40.0);
    }

    #[test]
    fn an_empty_polygon_and_one_that_is_too_big() {
        let mut polygon = Polygon::<8>::new();
        assert_eq!(lines(&polygon, lay(30.0, 1.0)), []);
        square(&mut polygon, 0.0, 1e6);
        assert_eq!(Hatch::new(&polygon, lay(0.0, 1.0)), None);
    }
}
