//! [`Merger`]: leaves out vertices that a tolerance does not need.

use crate::geom::single;
use crate::{Point, Segment};

/// Most vertices that one segment stands for. It bounds memory and the work for each vertex, which checks all
/// that were left out.
const MOST: usize = 8;

/// Least share of a segment's length by which it is prolonged into the line that ends it. On a smooth curve
/// more is possible; segments along it then have equal lengths instead of whole numbers of chords. Behind a
/// corner less is possible, and the segment ends in the corner.
const LONGER_SHARE: f64 = 0.1;
/// Halvings of that line in the search for the place, which is then known to a 32nd of the line.
const HALVINGS: u32 = 5;

/// A straight segment that stands for one or more segments of the path. It begins where the previous one
/// ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Merged {
    pub(super) to: Point,
    /// Greatest distance of a vertex left out, mm; rounded up.
    pub(super) deviation_mm: f32,
    pub(super) pace: Pace,
}

/// The values that hold along a line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Pace {
    /// Square of the greatest speed, mm²/s².
    pub(super) cruise2: f32,
    /// Power of the laser, in 65535ths.
    pub(super) power: u16,
}

/// Joins segments as long as one straight line is near enough to all their vertices: the greedy form of
/// polyline simplification (W. E. Reumann, A. P. M. Witkam 1974; here with the distance from the segment
/// itself), with a bounded memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Merger {
    /// The vertices from the start to the segment's end, as vectors from the start, mm. `f32` holds them far
    /// better than any tolerance.
    points: [(f32, f32); MOST],
    count: u8,
    deviation_mm: f32,
    pace: Pace,
    /// Whether the run has had chords of arcs, which have used up their share of the tolerance. It is here,
    /// where there is room for it.
    pub(super) has_arcs: bool,
}

impl Merger {
    /// Takes the line from the end of the path, `at`, to `to`. Gives the segment in progress, which began at
    /// `start`, if it ends at `at`. The line begins the next segment if there was none or that one ends.
    pub(super) fn push(
        &mut self,
        start: Point,
        at: Point,
        to: Point,
        pace: Pace,
        tolerance_mm: f64,
    ) -> Option<Merged> {
        if self.count > 0
            && usize::from(self.count) < MOST
            && self.pace == pace
            && let Some(deviation_mm) = self.deviation(start, to, tolerance_mm)
        {
            self.deviation_mm = deviation_mm;
            self.add(start, to);
            return None;
        }
        let end = if self.pace == pace { self.end_between(start, at, to, tolerance_mm) } else { None };
        let ended = self.end(end.unwrap_or(at));
        *self = Self { pace, has_arcs: self.has_arcs, ..Self::default() };
        self.add(end.unwrap_or(at), to);
        ended
    }

    /// How far along the line from `at` to `to` the segment in progress may go.
    fn end_between(&mut self, start: Point, at: Point, to: Point, tolerance_mm: f64) -> Option<Point> {
        if self.count == 0 {
            return None;
        }
        let (length_mm, way) = ((at - start).length(), to - at);
        let least = LONGER_SHARE * length_mm / way.length();
        if least.is_nan() || least >= 1.0 {
            return None;
        }
        let fits = |share: f64| self.deviation(start, at + way * share, tolerance_mm);
        let mut found = (least, fits(least)?);
        let mut beyond = 1.0;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (found.0 + beyond);
            match fits(middle) {
                Some(deviation_mm) => found = (middle, deviation_mm),
                None => beyond = middle,
            }
        }
        self.deviation_mm = found.1;
        Some(at + way * found.0)
    }

    /// Ends the segment in progress at the end of the path.
    pub(super) fn end(&mut self, at: Point) -> Option<Merged> {
        let Self { deviation_mm, pace, .. } = *self;
        if core::mem::take(&mut self.count) == 0 {
            return None;
        }
        Some(Merged { to: at, deviation_mm, pace })
    }

    fn add(&mut self, start: Point, point: Point) {
        let way = point - start;
        if let Some(slot) = self.points.get_mut(usize::from(self.count)) {
            *slot = (single(way.x), single(way.y));
            self.count += 1;
        }
    }

    /// Greatest distance of the vertices from a segment that ends at `to`; `None` beyond the tolerance.
    fn deviation(&self, start: Point, to: Point, tolerance_mm: f64) -> Option<f32> {
        let segment = Segment::new(Point::ORIGIN, Point::ORIGIN + (to - start));
        let mut most2 = 0.0_f64;
        for &(x, y) in self.points.get(..usize::from(self.count))? {
            let point = Point::new(f64::from(x), f64::from(y));
            let away = point - segment.nearest(point);
            most2 = most2.max(away.length_squared());
            if most2 > tolerance_mm * tolerance_mm {
                return None;
            }
        }
        let deviation_mm = libm::sqrt(most2);
        let rounded = single(deviation_mm);
        Some(if f64::from(rounded) < deviation_mm { rounded.next_up() } else { rounded })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PACE: Pace = Pace { cruise2: 1.0, power: 0 };

    #[test]
    fn a_shallow_bend_is_left_out_and_a_deep_one_stays() {
        let mut merger = Merger::default();
        let (start, at) = (Point::ORIGIN, |x, y| Point::new(x, y));
        assert_eq!(merger.push(start, start, at(1.0, 0.01), PACE, 0.02), None);
        assert_eq!(merger.push(start, at(1.0, 0.01), at(2.0, 0.0), PACE, 0.02), None);
        let merged = merger.push(start, at(2.0, 0.0), at(2.0, 1.0), PACE, 0.02).unwrap();
        assert_eq!(merged.to, at(2.0, 0.0));
        /// What single precision leaves of 0.01.
        const ROUNDING_MM: f32 = 1e-9;
        assert!((merged.deviation_mm - 0.01).abs() < ROUNDING_MM);
        assert_eq!(merger.end(at(2.0, 1.0)).map(|merged| merged.to), Some(at(2.0, 1.0)));
    }

    #[test]
    fn another_speed_ends_the_segment() {
        let mut merger = Merger::default();
        let at = |x| Point::new(x, 0.0);
        merger.push(at(0.0), at(0.0), at(1.0), PACE, 0.1);
        assert!(merger.push(at(0.0), at(1.0), at(2.0), Pace { cruise2: 4.0, power: 0 }, 0.1).is_some());
    }
}
