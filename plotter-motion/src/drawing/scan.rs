//! [`Rows`]: parallel lines, and where they lie in areas.

use crate::{Point, Vec2};
use alloc::vec::Vec;

/// Most rows over one area: 10 m of them at 0.1 mm.
const MOST_ROWS: f64 = 100_000.0;
/// Most pieces of rows in one area: a row each 0.3 mm of an A0 sheet may have 350. As strokes they take 200
/// MB.
pub(super) const MOST_SPANS: f64 = 1_000_000.0;

/// Parallel lines at equal distances, numbered: row 0 goes through `base`.
///
/// ```text
///         from      to    from  to
///  row 2 ──┝━━━━━━━━┥─────┝━━━━━┥──▶ way
///  row 1 ─────┝━━━━━━━━━━━━┥───────
///  row 0 ──┼───────────────────────
///        base
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rows {
    pub(crate) base: Point,
    /// Along the rows, of length 1.
    pub(crate) way: Vec2,
    /// From a row to the next one, mm.
    pub(crate) distance_mm: f64,
}

/// That an area is not filled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TooMany {
    /// How many rows or pieces there would be; infinite of places too far away to count the rows.
    pub(crate) lines: f64,
    /// The most that there may be.
    pub(crate) most: f64,
}

/// An edge between two rows or more, seen from the rows.
#[derive(Clone, Copy)]
struct Edge {
    from: Point,
    to: Point,
    from_row: f64,
    to_row: f64,
}

impl Edge {
    /// The first row that it crosses. It is half open, so that a corner on a row counts once.
    fn first(&self) -> f64 {
        libm::ceil(libm::fmin(self.from_row, self.to_row))
    }

    /// The first row behind it.
    fn end(&self) -> f64 {
        libm::ceil(libm::fmax(self.from_row, self.to_row))
    }
}

impl Rows {
    /// How many rows a place lies from row 0.
    fn row(&self, at: Point) -> f64 {
        self.way.perpendicular().dot(at - self.base) / self.distance_mm
    }

    /// How far along the rows a place lies from the base, mm.
    pub(crate) fn along(&self, at: Point) -> f64 {
        self.way.dot(at - self.base)
    }

    /// The place so far along a row, mm.
    pub(crate) fn place(&self, row: f64, along_mm: f64) -> Point {
        self.base + self.way.perpendicular() * (self.distance_mm * row) + self.way * along_mm
    }

    /// The pieces of the rows within an odd number of outlines, which are closed: the number of the row, and
    /// from where to where along it, mm; row by row, each in rising order. A row is within from its first
    /// crossing of the outlines to the second, from the third to the fourth, and so on.
    ///
    /// # Errors
    ///
    /// More rows or pieces than memory should be asked for; nothing is filled then.
    pub(crate) fn fill(
        &self,
        outlines: &[Vec<Point>],
        mut each: impl FnMut(f64, f64, f64),
    ) -> Result<(), TooMany> {
        let rows = || outlines.iter().flatten().map(|at| self.row(*at));
        let (least, most) =
            (rows().fold(f64::INFINITY, libm::fmin), rows().fold(f64::NEG_INFINITY, libm::fmax));
        if outlines.iter().all(Vec::is_empty) {
            return Ok(());
        }
        // Beyond 2^52 the row after a row would be the same.
        let is_counted = |row: f64| libm::fabs(row) < 4_503_599_627_370_496.0;
        if !(most - least <= MOST_ROWS && rows().all(is_counted)) {
            let lines = if most - least <= MOST_ROWS { f64::INFINITY } else { most - least };
            return Err(TooMany { lines, most: MOST_ROWS });
        }
        let mut edges: Vec<Edge> = outlines
            .iter()
            .flat_map(|outline| outline.windows(2))
            .filter_map(|pair| {
                let &[from, to] = pair else { return None };
                let edge = Edge { from, to, from_row: self.row(from), to_row: self.row(to) };
                (edge.first() < edge.end()).then_some(edge)
            })
            .collect();
        let spans = 0.5 * edges.iter().map(|edge| edge.end() - edge.first()).sum::<f64>();
        if spans > MOST_SPANS {
            return Err(TooMany { lines: spans, most: MOST_SPANS });
        }
        edges.sort_by(|a, b| a.first().total_cmp(&b.first()));
        // Row by row, with the edges that it crosses.
        let mut edges = edges.into_iter().peekable();
        let (mut crossed, mut crossings): (Vec<Edge>, Vec<f64>) = (Vec::new(), Vec::new());
        let mut row = f64::NEG_INFINITY;
        loop {
            crossed.retain(|edge| edge.end() > row);
            if crossed.is_empty() {
                let Some(next) = edges.peek() else { return Ok(()) };
                row = next.first();
            }
            while let Some(edge) = edges.next_if(|edge| edge.first() <= row) {
                crossed.push(edge);
            }
            crossings.clear();
            crossings.extend(crossed.iter().map(|edge| {
                let share = (row - edge.from_row) / (edge.to_row - edge.from_row);
                self.along(edge.from.lerp(edge.to, share))
            }));
            crossings.sort_unstable_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                if let &[from, to] = pair
                    && from < to
                {
                    each(row, from, to);
                }
            }
            row += 1.0;
        }
    }
}
